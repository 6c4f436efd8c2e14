//! Where a sequence repeats: from one landing of a foot to the next of the same foot, and how well the ends meet.

use glam::{Vec2, Vec3};
use kernels::align::{Placement, align_heading};

use crate::recorded::{Recorded, Track};
use crate::twist::Twist;

/// A cycle takes so long, in seconds.
const SECONDS: [f32; 2] = [0.3, 3.0];
/// Gaps between stances, and stances, that are shorter than this are none, in seconds.
pub(crate) const FLICKER: f32 = 0.06;
/// An end is looked for so far from where the foot lands, in seconds.
const BESIDE: f32 = 0.04;
/// Vertices that are looked at when ends are compared, roughly.
const LOOKED_AT: usize = 600;

/// A part of a track that repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// The foot that lands at both ends.
    pub foot: usize,
    /// Its first place on the track.
    pub from: usize,
    /// The place after its last one, where it begins again.
    pub to: usize,
    /// How far poses about both ends lie apart, once they are turned and moved onto each other: root mean square, in metres.
    pub apart: f32,
    /// Where it leads to.
    pub twist: Twist,
    /// Length of its way in metres.
    pub way: f32,
}

impl Cycle {
    /// Its frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.to - self.from
    }
}

/// All cycles of a track that begin where `foot` lands, in order.
#[must_use]
pub fn cycles(recorded: &Recorded, track: &Track, foot: usize) -> Vec<Cycle> {
    let least = recorded.frames(FLICKER);
    // A foot that stands when the recording begins has landed before it.
    let landings = |foot: usize| -> Vec<usize> {
        let all = track.stances(recorded.feet, foot, least);
        all.iter().map(|stance| stance.0).filter(|&at| at > 0).collect()
    };
    let own = landings(foot);
    let others: Vec<Vec<usize>> = (0..recorded.feet.count()).filter(|&k| k != foot).map(landings).collect();
    let [shortest, longest] = SECONDS.map(|seconds| recorded.frames(seconds));
    let steps_once = |from: usize, to: usize| {
        let between = |landings: &&Vec<usize>| landings.iter().filter(|&&at| from < at && at < to).count() == 1;
        others.iter().filter(|landings| !landings.is_empty()).all(|landings| between(&landings))
    };
    let is_cycle =
        |pair: &&[usize]| (shortest..=longest).contains(&(pair[1] - pair[0])) && steps_once(pair[0], pair[1]);
    let pairs: Vec<&[usize]> = own.windows(2).filter(is_cycle).collect();
    pairs.into_iter().filter_map(|pair| best_end(recorded, track, foot, pair[0], pair[1])).collect()
}

/// The cycle from `from` whose end, near `to`, meets its beginning best.
fn best_end(recorded: &Recorded, track: &Track, foot: usize, from: usize, to: usize) -> Option<Cycle> {
    let beside = recorded.frames(BESIDE);
    let ends = to.saturating_sub(beside)..(to + beside + 1).min(track.len());
    ends.map(|to| measured(recorded, track, foot, from, to)).min_by(|a, b| a.apart.total_cmp(&b.apart))
}

/// What can be said of the cycle from one place of a track to another.
#[must_use]
pub fn measured(recorded: &Recorded, track: &Track, foot: usize, from: usize, to: usize) -> Cycle {
    let weights = recorded.topology.weights();
    let (first, last) = (track.pose(recorded, from), track.pose(recorded, to));
    let turn = align_heading(&last, &first, weights);
    let end = Placement::turning(turn, recorded.centre(&first), recorded.centre(&last));
    let mut sum = apart(&first, &last, &end);
    let mut count = 1.0;
    // Steps are compared, too.
    for beside in [-1_i64, 1] {
        let [before, after] =
            [from, to].map(|at| usize::try_from(at as i64 + beside).ok().filter(|&at| at < track.len()));
        if let (Some(before), Some(after)) = (before, after) {
            sum += apart(&track.pose(recorded, before), &track.pose(recorded, after), &end);
            count += 1.0;
        }
    }
    let twist = twist_between(&end, recorded.centre(&first));
    Cycle { foot, from, to, apart: (sum / count).sqrt(), twist, way: way(&twist) }
}

/// The twist in axes whose origin is at `origin`, where the cycle begins.
fn twist_between(end: &Placement, origin: Vec2) -> Twist {
    let begin = Placement { heading: 0.0, translation: origin };
    Twist::to(&begin.inverse().after(&end.after(&begin)))
}

/// Length of the arc that a twist leads along, in metres.
#[must_use]
pub fn way(twist: &Twist) -> f32 {
    twist.step.length()
}

/// Mean square distance of two poses, the first one moved by `placement`.
fn apart(first: &[Vec3], last: &[Vec3], placement: &Placement) -> f32 {
    let stride = first.len().div_ceil(LOOKED_AT).max(1);
    let pairs = first.iter().zip(last).step_by(stride);
    let count = first.len().div_ceil(stride) as f32;
    pairs.map(|(a, b)| placement.apply(*a).distance_squared(*b)).sum::<f32>() / count
}

/// The direction of a cycle's way at its beginning, as an angle about +Y from +Z; `None` where it goes nowhere.
#[must_use]
pub fn heading(twist: &Twist, least: f32) -> Option<f32> {
    (twist.step.length() > least).then(|| twist.step.x.atan2(twist.step.y))
}
