//! What the torso of a target is told by: what hangs on it, such as a skirt, lies on the legs, and swings after all that moved a moment ago.

use glam::Quat;

use crate::displace::LEVER;
use crate::space::{Space, numbers_at};
use crate::subject::{Root, Subject};

/// How long ago that moment is, in seconds.
const BEFORE: f64 = 0.12;

/// A limb whose end is on average no higher than this between the lowest one's and the hips is a leg: hands hang higher.
const LOW: f32 = 0.5;

/// What tells each part of the target.
pub struct Inputs {
    /// Parts that tell the torso: itself, which comes first, and the legs. Of where arms are nothing follows for what hangs on the
    /// hips, and they go where they never were.
    of_torso: Vec<usize>,
}

impl Inputs {
    /// Of a source that stands upright about its hips; its part `order[k]` tells part k of the target, or the whole body is one part.
    pub fn of(source: &Subject, order: Option<&[usize]>) -> Self {
        let heights: Vec<f32> = source.parts.limbs.iter().map(|limb| height(source, limb.tip)).collect();
        let lowest = heights.iter().copied().fold(0.0, f32::min);
        let is_leg = |part: usize| part > 0 && heights[part - 1] < (1.0 - LOW) * lowest;
        let order = order.unwrap_or_default();
        let legs = (1..order.len()).filter(|&part| is_leg(order[part]));
        Self { of_torso: std::iter::once(0).chain(legs).collect() }
    }

    /// The numbers by which each part is told at a time, from `own`, those of the source's parts at that time: limbs by themselves; the torso by
    /// itself and the legs, by how these have changed since a moment before, and by how the body has gone and turned since. All are in
    /// metres.
    pub fn at(&self, subject: &Subject, spaces: &[Space], time: f64, own: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let some = |all: &[Vec<f64>]| self.of_torso.iter().flat_map(|&part| all[part].iter().copied()).collect();
        let mut torso: Vec<f64> = some(own);
        let changes = since(subject, time, &torso, &|time| some(&numbers_at(subject, spaces, time)));
        torso.extend(changes);
        std::iter::once(torso).chain(own.iter().skip(1).cloned()).collect()
    }
}

/// How high a vertex is above the hips on average, in metres.
fn height(subject: &Subject, vertex: u32) -> f32 {
    let above = |(frame, root): (usize, &Root)| subject.poses.frame(frame as u32)[vertex as usize].y - root.centre.y;
    subject.roots.iter().enumerate().map(above).sum::<f32>() / subject.roots.len().max(1) as f32
}

/// What has changed of the numbers `at` a time, which are `now`. Before a sequence's first frame it goes on as if it were turned by half a circle about it.
fn since(subject: &Subject, time: f64, now: &[f64], at: &dyn Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let [first, last] = ends(subject, time);
    let then = time - BEFORE * f64::from(subject.timeline.fps());
    let mirrored = (2.0 * first - then).clamp(first, last);
    let (before, [from, to]) = if then >= first {
        (at(then), [then, time])
    } else {
        let [middle, after] = [first, mirrored].map(at);
        (middle.iter().zip(after).map(|(middle, after)| 2.0 * middle - after).collect(), [first, mirrored])
    };
    let changes = now.iter().zip(before).map(|(now, before)| now - before);
    changes.chain(gone(&subject.root_at(from), &subject.root_at(to), subject)).collect()
}

/// First and last frame of the sequence at a time.
fn ends(subject: &Subject, time: f64) -> [f64; 2] {
    let sequence = subject.timeline.sequence_of(time as u32);
    sequence.map_or([time; 2], |own| [own.first_frame, own.end_frame() - 1].map(f64::from))
}

/// How far a body has gone, as it faces at the end, and how far it has turned, at the end of a lever.
fn gone(from: &Root, to: &Root, subject: &Subject) -> [f64; 4] {
    let way = Quat::from_rotation_y(-to.heading) * (to.centre - from.centre);
    [way.x, way.y, way.z, (to.heading - from.heading) * LEVER * subject.size].map(f64::from)
}
