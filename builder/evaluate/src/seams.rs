//! The seam report: how much the surface changes where recorded and synthetic frames meet, against the capture's own
//! change from frame to frame.
//!
//! Geometry is the root mean square way of the vertices from a frame to the next, velocity that of the change of this
//! way, both per frame. A transition has a seam where it leaves its source and one where it arrives.

use actor::blend::ease;
use actor::graph::Transition;
use glam::Vec3;
use job::Stopped;
use rayon::prelude::*;

use super::EvaluateError;
use super::performance::{Performance, Recordings};
use super::statistics::percentile;

/// The changes at one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Root mean square way of the vertices from the frame before, in metres.
    pub geometry: f64,
    /// Root mean square change of that way, in metres per frame.
    pub velocity: f64,
}

impl Change {
    /// The change between three frames in a row, at the middle one: the greater way, and the change of way.
    #[must_use]
    pub fn of(before: &[Vec3], at: &[Vec3], after: &[Vec3]) -> Self {
        let (mut first, mut second, mut turn) = (0.0_f64, 0.0_f64, 0.0_f64);
        for ((&b, &m), &a) in before.iter().zip(at).zip(after) {
            first += f64::from((m - b).length_squared());
            second += f64::from((a - m).length_squared());
            turn += f64::from(((a - m) - (m - b)).length_squared());
        }
        let count = at.len().max(1) as f64;
        Self { geometry: (first.max(second) / count).sqrt(), velocity: (turn / count).sqrt() }
    }
}

/// How much a capture itself changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Own {
    /// Changes of geometry of all frames between two others.
    pub geometry: Vec<f64>,
    /// Changes of velocity.
    pub velocity: Vec<f64>,
}

impl Own {
    /// Measures all frames that have one before and one after in their sequence.
    #[must_use]
    pub fn of(recordings: &Recordings) -> Self {
        let changes: Vec<Change> = (0..recordings.timeline.frame_count())
            .into_par_iter()
            .filter_map(|frame| {
                // The wrap of a cyclic sequence was not recorded.
                let sequence = recordings.timeline.sequence_of(frame)?;
                let inner = frame > sequence.first_frame && frame + 1 < sequence.end_frame();
                let pose = |frame| recordings.poses.frame(frame);
                inner.then(|| Change::of(pose(frame - 1), pose(frame), pose(frame + 1)))
            })
            .collect();
        Self {
            geometry: changes.iter().map(|change| change.geometry).collect(),
            velocity: changes.iter().map(|change| change.velocity).collect(),
        }
    }

    /// The percentile `share` of both.
    #[must_use]
    pub fn percentile(&self, share: f64) -> Change {
        Change {
            geometry: percentile(&self.geometry, share).unwrap_or(0.0),
            velocity: percentile(&self.velocity, share).unwrap_or(0.0),
        }
    }
}

/// How the weight of the destination grows along a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ease {
    /// Evenly, as in the papers (thesis algorithm 2).
    Linear,
    /// From rest to rest, as in ours.
    Smooth,
}

impl Ease {
    /// The destination's weight at `t` of a blend, from 0 to 1.
    #[must_use]
    pub fn weight(self, t: f32) -> f32 {
        match self {
            Self::Linear => t,
            Self::Smooth => ease(t),
        }
    }
}

/// The seams of one transition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seams {
    /// Index of the transition in its graph.
    pub transition: usize,
    /// The change at the frame that it leaves from; none at the beginning of a sequence.
    pub start: Option<Change>,
    /// The change at the frame that it arrives at; none at the end of a sequence.
    pub end: Option<Change>,
}

impl Seams {
    /// The greater change of velocity of both.
    #[must_use]
    pub fn worst_velocity(&self) -> f64 {
        [self.start, self.end].iter().flatten().map(|change| change.velocity).fold(0.0, f64::max)
    }
}

/// Measures the seams of some of the transitions of a graph, given by index.
///
/// # Errors
/// Transitions of another capture.
pub fn measure(
    recordings: Recordings,
    order: &[u32],
    transitions: &[Transition],
    chosen: &[usize],
    ease: Ease,
    progress: &(dyn Fn(f64) -> Result<(), Stopped> + Sync),
) -> Result<Vec<Seams>, EvaluateError> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    // Chunks in order, each with a stage of its own, whose factors of neighbouring frames are of use to each other.
    let chunks: Vec<Vec<Seams>> = chosen
        .par_chunks(16)
        .map(|chunk| {
            let mut stage = Performance::new(recordings, order)?;
            let seams = chunk.iter().map(|&index| seams_of(&mut stage, index, &transitions[index], ease));
            let seams = seams.collect::<Result<Vec<_>, EvaluateError>>();
            let before = done.fetch_add(chunk.len(), std::sync::atomic::Ordering::Relaxed);
            progress((before + chunk.len()) as f64 / chosen.len() as f64)?;
            seams
        })
        .collect::<Result<_, EvaluateError>>()?;
    Ok(chunks.into_iter().flatten().collect())
}

fn seams_of(
    stage: &mut Performance,
    index: usize,
    transition: &Transition,
    ease: Ease,
) -> Result<Seams, EvaluateError> {
    let recordings = stage.recordings;
    let blends = recordings.blends(transition)?;
    let mut seams = Seams { transition: index, start: None, end: None };
    let [.., before_last, last] = blends.as_slice() else { return Ok(seams) };
    let (first, second) = (&blends[0], &blends[1]);
    let part = 1.0 / last.node as f32;
    let inner = |frame: u32, step: i64| recordings.timeline.offset(frame, step).filter(|&f| f.abs_diff(frame) == 1);
    if let Some(frame) = inner(transition.from, -1) {
        let after = stage.pose(second, ease.weight(part))?;
        let (before, at) = (recordings.placed(frame, first.placements[0]), stage.pose(first, 0.0)?);
        seams.start = Some(Change::of(&before, &at, &after));
    }
    if let Some(frame) = inner(transition.to, 1) {
        let before = stage.pose(before_last, ease.weight(1.0 - part))?;
        let (at, after) = (stage.pose(last, 1.0)?, recordings.placed(frame, last.placements[1]));
        seams.end = Some(Change::of(&before, &at, &after));
    }
    Ok(seams)
}

/// What a seam report says of some seams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeamSummary {
    /// Number of seams.
    pub count: u64,
    /// How many of them change geometry, or velocity, more than the capture's own 99th percentile.
    pub above: [u64; 2],
    /// Medians of both.
    pub median: Change,
    /// Their 99th percentiles.
    pub high: Change,
    /// The greatest.
    pub greatest: Change,
}

impl SeamSummary {
    /// The summary of `seams` against the capture's own 99th percentile.
    #[must_use]
    pub fn of(seams: &[Seams], limit: Change) -> Self {
        let changes: Vec<Change> = seams.iter().flat_map(|seams| [seams.start, seams.end]).flatten().collect();
        let geometry: Vec<f64> = changes.iter().map(|change| change.geometry).collect();
        let velocity: Vec<f64> = changes.iter().map(|change| change.velocity).collect();
        let above = |values: &[f64], limit: f64| values.iter().filter(|value| **value > limit).count() as u64;
        let at = |share| Change {
            geometry: percentile(&geometry, share).unwrap_or(0.0),
            velocity: percentile(&velocity, share).unwrap_or(0.0),
        };
        Self {
            count: changes.len() as u64,
            above: [above(&geometry, limit.geometry), above(&velocity, limit.velocity)],
            median: at(0.5),
            high: at(0.99),
            greatest: at(1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_known_motion() {
        let at = |x: f32| vec![Vec3::new(x, 0.0, 0.0), Vec3::new(x, 1.0, 2.0)];
        let even = Change::of(&at(0.0), &at(1.0), &at(2.0));
        assert_eq!((even.geometry, even.velocity), (1.0, 0.0));
        let stop = Change::of(&at(0.0), &at(3.0), &at(3.0));
        assert_eq!((stop.geometry, stop.velocity), (3.0, 3.0));
    }

    #[test]
    fn ease_begins_and_ends_at_rest() {
        for ease in [Ease::Linear, Ease::Smooth] {
            assert_eq!((ease.weight(0.0), ease.weight(0.5), ease.weight(1.0)), (0.0, 0.5, 1.0));
        }
        assert!(Ease::Smooth.weight(0.01) < 0.001);
    }

    #[test]
    fn summaries_count_what_is_above() {
        let change = |velocity| Some(Change { geometry: 1.0, velocity });
        let seams = [
            Seams { transition: 0, start: change(1.0), end: change(3.0) },
            Seams { transition: 1, start: None, end: change(5.0) },
        ];
        let summary = SeamSummary::of(&seams, Change { geometry: 1.0, velocity: 2.0 });
        assert_eq!((summary.count, summary.above), (3, [0, 2]));
        assert_eq!((summary.median.velocity, summary.greatest.velocity), (3.0, 5.0));
        assert_eq!(seams[0].worst_velocity(), 3.0);
    }
}
