//! Where a clip's ends are edited towards the recording: the middle of each blend (paper V-C).

use actor::timeline::Timeline;
use driving::Aim;
use editing::Rigid;
use glam::Vec3;

use crate::actor::DrivenActor;
use crate::clip::{DrivenClip, Exit};
use crate::perform::Window;

/// An edit made for one frame holds for so many after it: playing may skip some.
const LATE: i64 = 3;

/// How a clip is to be performed.
pub struct Wanted {
    /// The recorded frames of both blends.
    pub windows: [Window; 2],
    /// Nodes of the way in.
    pub nodes: usize,
    /// Where the actor goes on.
    pub exit: Exit,
    /// The frame from which the clip's ends were edited; nothing where they were not yet.
    pub aimed: Option<u32>,
}

impl Wanted {
    /// Whether the edit of the clip's ends is good for leaving from `frame`, too.
    #[must_use]
    pub fn holds(&self, timeline: &Timeline, frame: u32, exit: Exit) -> bool {
        let late = |first: u32| (0..=LATE).any(|late| timeline.offset(first, late) == Some(frame));
        self.exit == exit && self.aimed.is_some_and(late)
    }
}

/// What is blended in the middle of the way in, and of the way back: the step of the recorded window, and the clip's frame.
pub(crate) fn middles(wanted: &Wanted, count: usize) -> [[usize; 2]; 2] {
    let [before, after] = wanted.windows.map(|window| window.count as usize);
    let entry = wanted.nodes.min(count);
    // As blends go over both sides evenly, what is halfway on the one is blended with what is halfway on the other.
    let back = (count - after.min(count) + after / 2).min(count.saturating_sub(1));
    [[before / 2, entry / 2], [after / 2, back]]
}

/// The edits of both ends, and how the bones have moved in the recorded frames that they lead to; nothing where the poses of the windows are
/// none of this mesh.
pub(crate) fn aims(
    actor: &DrivenActor,
    clip: &DrivenClip,
    wanted: &Wanted,
    recorded: &[Vec<Vec3>; 2],
) -> Option<(Vec<Aim>, Vec<Vec<Rigid>>)> {
    let vertices = actor.known.topology.vertex_count();
    let pose = |window: usize, frame: usize| {
        let fits = recorded[window].len() == wanted.windows[window].count as usize * vertices;
        recorded[window].chunks_exact(vertices.max(1)).nth(frame).filter(|_| fits)
    };
    let keys = middles(wanted, clip.count());
    let mut aims: Vec<Aim> = Vec::new();
    let mut blended = Vec::new();
    for (window, [of_recorded, of_clip]) in keys.into_iter().enumerate() {
        let frames = 0..wanted.windows[window].count as usize;
        let motions = frames.map(|frame| Some(actor.body.rig.fit(pose(window, frame)?))).collect::<Option<Vec<_>>>()?;
        aims.push(clip.aim(actor, motions.get(of_recorded)?, of_clip, window == 0));
        blended.push(motions);
    }
    // Where the clip is short the one edit has faded where the other is whole.
    let between = aims[1].frame.saturating_sub(aims[0].frame);
    aims.iter_mut().for_each(|aim| aim.fades = aim.fades.min(between));
    let nodes = [wanted.nodes, wanted.windows[1].count as usize];
    for (window, aim) in aims.iter_mut().enumerate() {
        aim.strength = clip.strength(actor, aim, &blended[window], nodes[window]);
    }
    let middle = |(window, motions): (usize, Vec<Vec<Rigid>>)| motions.into_iter().nth(keys[window][0]);
    let all = blended.into_iter().enumerate().map(middle).collect::<Option<Vec<_>>>()?;
    Some((aims, all))
}
