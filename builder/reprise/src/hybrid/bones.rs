//! The clip's bones edited towards the recorded frame that they are blended with, as the page does it: `driving::towards`.

use std::ops::Range;

use actor::capture::Capture;
use driving::Aim;

use super::seam::Way;
use super::tried::{DrivenFrames, EditedBy, Tried};

/// The driven frame in the middle of `way` as the recorded one that it is blended with, beside the edits `aims`; nothing where that would
/// change frames whose surface was edited, `solved`, or none.
pub(super) fn by_bones(
    both: &Capture,
    driven: DrivenFrames<'_>,
    (aims, solved): (&[Aim], &Range<u32>),
    way: &Way,
    inwards: bool,
) -> Option<Tried> {
    let [source, destination] = way.middle();
    let (recorded, key) = if inwards { (source, destination) } else { (destination, source) };
    let first = both.timeline.sequences().last()?.first_frame;
    let [wanted, own] = [recorded, key].map(|frame| driven.body.rig.fit(both.poses.frame(frame)));
    let at = key.checked_sub(first)? as usize;
    let mut aim = Aim::new(driven.body, [&wanted, &own], (at, both.timeline.fps()), inwards);
    if let Some(other) = aims.first() {
        // Where the clip is short the one edit has faded where the other is whole.
        aim.fades = aim.fades.min(at.saturating_sub(other.frame));
    }
    let before = (driven.remade)(aims)?;
    let mut all = aims.to_vec();
    all.push(aim.clone());
    let after = (driven.remade)(&all)?;
    let changes = |&frame: &usize| before[frame] != after[frame];
    let from = (0..after.len()).find(changes)?;
    let to = (0..after.len()).rev().find(changes)? + 1;
    let frames = first + from as u32..first + to as u32;
    let overlaps = frames.start < solved.end && solved.start < frames.end;
    let poses = after.get(from..to)?.to_vec();
    (!overlaps).then_some(Tried { first: frames.start, poses, by: EditedBy::Bones, aim: Some(aim) })
}
