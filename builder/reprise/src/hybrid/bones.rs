//! The clip's bones edited towards the recorded frame that they are blended with, as the page does it: `driving::towards`.

use std::ops::Range;

use actor::capture::Capture;
use driving::strength::STRENGTHS;
use driving::{Aim, End, Masses, strength};

use super::seam::Way;
use super::tried::{DrivenFrames, EditedBy, Tried};

/// The driven frame in the middle of `way` as the recorded one that it is blended with, beside the edits `aims`: the edit, and how much of it
/// may be worth while, the most first; nothing where that would make the bones' way more abrupt, however little is done of it.
pub(super) fn aims_of_bones(
    both: &Capture,
    driven: DrivenFrames<'_>,
    aims: &[Aim],
    way: &Way,
    inwards: bool,
) -> Option<(Aim, Vec<f32>)> {
    let [source, destination] = way.middle();
    let (recorded, key) = if inwards { (source, destination) } else { (destination, source) };
    let (first, fps) = (both.timeline.sequences().last()?.first_frame, both.timeline.fps());
    let [wanted, own] = [recorded, key].map(|frame| driven.body.rig.fit(both.poses.frame(frame)));
    let at = key.checked_sub(first)? as usize;
    let mut aim = Aim::new(driven.body, [&wanted, &own], (at, fps), inwards);
    if let Some(other) = aims.first() {
        // Where the clip is short the one edit has faded where the other is whole.
        aim.fades = aim.fades.min(at.saturating_sub(other.frame));
    }
    let [source, destination] = way.blended();
    let (recorded, nodes) = if inwards { (source, destination) } else { (destination, source) };
    let end = if inwards { nodes.start } else { nodes.end }.checked_sub(first)? as usize;
    let motions: Vec<_> = recorded.map(|frame| driven.body.rig.fit(both.poses.frame(frame))).collect();
    let end = End { recorded: &motions, nodes: nodes.len(), first: end };
    let most = strength((driven.body, &Masses::new(driven.body)), (driven.free, fps), &aim, &end);
    Some((aim, STRENGTHS.into_iter().filter(|strength| *strength <= most).collect()))
}

/// The frames that `aim` changes beside the edits `aims`; nothing where it changes frames whose surface was edited, `solved`, or none.
pub(super) fn by_bones(
    both: &Capture,
    driven: DrivenFrames<'_>,
    (aims, solved): (&[Aim], &Range<u32>),
    aim: Aim,
) -> Option<Tried> {
    let first = both.timeline.sequences().last()?.first_frame;
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
