//! What the torso of a target is told by: what hangs on it, such as a skirt, lies on the legs, and swings after all that moved a moment ago.

use glam::Quat;

use crate::displace::LEVER;
use crate::space::{Space, numbers_at};
use crate::subject::{Root, Subject};

/// How long ago those moments are, in seconds.
const BEFORE: [f64; 1] = [0.12];

/// The numbers by which each part is told at a time, from `own`, those of the parts at that time: limbs by themselves; the torso, which comes first, by
/// all parts, by how all of them have changed since some moments before, and by how the body has gone and turned since. All are in metres.
pub fn inputs(subject: &Subject, spaces: &[Space], time: f64, own: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut torso = own.concat();
    for before in BEFORE {
        torso.extend(since(subject, spaces, time, before, own));
    }
    std::iter::once(torso).chain(own.iter().skip(1).cloned()).collect()
}

/// What has changed in `seconds`. Before a sequence's first frame it goes on as if it were turned by half a circle about it.
fn since(subject: &Subject, spaces: &[Space], time: f64, seconds: f64, own: &[Vec<f64>]) -> Vec<f64> {
    let [first, last] = ends(subject, time);
    let then = time - seconds * f64::from(subject.timeline.fps());
    let mirrored = (2.0 * first - then).clamp(first, last);
    let (before, [from, to]) = if then >= first {
        (numbers_at(subject, spaces, then).concat(), [then, time])
    } else {
        let [middle, after] = [first, mirrored].map(|time| numbers_at(subject, spaces, time).concat());
        (middle.iter().zip(after).map(|(middle, after)| 2.0 * middle - after).collect(), [first, mirrored])
    };
    let changes = own.iter().flatten().zip(before).map(|(now, before)| now - before);
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
