//! Alternatives of recorded stretches: motion that differs from the recording, but begins and ends in it, so that it needs no
//! transition and the graph stays as it is.
//!
//! Thesis section 6.6: variations with pinned ends. Here they are stored as differences from the recording, in a few modes over the
//! surface: the pose of frame n in alternative a is
//!
//! ```text
//! recorded(n) + turned by heading(n) of (sum over k of smooth(a, n, k) * mode(k))
//! smooth(a, n, k) = (coefficient(a, n - 1, k) + 2 coefficient(a, n, k) + coefficient(a, n + 1, k)) / 4
//! ```
//!
//! Coefficients are rounded, each frame by itself: somebody who hardly moves would be seen to tremble. The mean over three frames leaves a quarter of
//! that acceleration, and of differences, which go on for many frames, all but nothing.

use glam::Vec3;

use crate::timeline::Timeline;
use kernels::modes;
use kernels::scalar::sin_cos;

/// Modes at most.
pub const MOST_MODES: usize = 96;
/// Alternatives of a stretch at most.
pub const MOST_ALTERNATIVES: usize = 256;
/// Metres that a coefficient of one moves a vertex whose part of a mode is [`MODE_STEPS`].
pub const COEFFICIENT_STEP: f32 = 1e-4;
/// The largest part of a mode.
pub const MODE_STEPS: f32 = 127.0;
/// Radians that a heading of one is.
pub const HEADING_STEP: f32 = std::f32::consts::PI / 32_768.0;

/// A stretch of a sequence and its alternatives.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stretch {
    /// Its first frame, which is as recorded.
    pub first: u32,
    /// Its last frame, which is as recorded.
    pub last: u32,
    /// For each frame between: which way the body faces, in [`HEADING_STEP`].
    pub headings: Vec<i16>,
    /// For each alternative, frame after frame, a coefficient a mode.
    pub coefficients: Vec<Vec<i16>>,
}

impl Stretch {
    /// Frames between its ends.
    #[must_use]
    pub fn between(&self) -> usize {
        (self.last - self.first).saturating_sub(1) as usize
    }
}

/// All alternatives of a capture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Alternatives {
    /// Mode after mode, a vector a vertex, in `COEFFICIENT_STEP / MODE_STEPS`.
    modes: Vec<Vec<[i8; 3]>>,
    /// By first frame.
    stretches: Vec<Stretch>,
}

impl Alternatives {
    /// Alternatives over a mesh of so many vertices. `None` where their numbers do not fit, stretches are not in the order of their
    /// first frames, or one leaves its sequence.
    #[must_use]
    pub fn new(
        modes: Vec<Vec<[i8; 3]>>,
        stretches: Vec<Stretch>,
        vertex_count: usize,
        timeline: &Timeline,
    ) -> Option<Self> {
        let holds = |stretch: &Stretch| {
            let within = timeline
                .sequence_of(stretch.first)
                .is_some_and(|sequence| stretch.last > stretch.first && stretch.last < sequence.end_frame());
            within
                && stretch.headings.len() == stretch.between()
                && (1..=MOST_ALTERNATIVES).contains(&stretch.coefficients.len())
                && stretch.coefficients.iter().all(|one| one.len() == stretch.between() * modes.len())
        };
        let fits = modes.len() <= MOST_MODES && modes.iter().all(|mode| mode.len() == vertex_count);
        let ordered = stretches.is_sorted_by_key(|stretch| stretch.first);
        (fits && ordered && stretches.iter().all(holds)).then_some(Self { modes, stretches })
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.stretches.is_empty()
    }

    /// The modes: a vector a vertex, in `COEFFICIENT_STEP / MODE_STEPS` metres.
    #[must_use]
    pub fn modes(&self) -> &[Vec<[i8; 3]>] {
        &self.modes
    }

    /// The stretches, by first frame.
    #[must_use]
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// Adds to the recorded `pose` of `frame` what it is more in an alternative of a stretch, times `amount`. Outside of the stretch, and
    /// for numbers that do not exist, nothing is added.
    pub fn add(&self, (stretch, alternative): (usize, usize), frame: u32, amount: f32, pose: &mut [Vec3]) {
        let mut shares = vec![0.0; self.stretches.get(stretch).map_or(0, |stretch| stretch.coefficients.len())];
        if let Some(share) = shares.get_mut(alternative) {
            *share = amount;
        }
        self.add_mixed(&[(stretch, shares)], frame, pose);
    }

    /// Adds the coefficients of the frame `between` frames after the first one between a stretch's ends, mixed and smoothed; beyond its
    /// ends nothing differs.
    fn add_smooth_row(&self, stretch: &Stretch, between: usize, shares: &[f32], row: &mut [f32]) {
        let width = self.modes.len();
        for (rows, share) in stretch.coefficients.iter().zip(shares) {
            for (near, weight) in [(between.checked_sub(1), 0.25), (Some(between), 0.5), (Some(between + 1), 0.25)] {
                let rows = near.and_then(|near| rows.get(near * width..)).unwrap_or_default();
                for (sum, coefficient) in row.iter_mut().zip(rows) {
                    *sum += weight * share * f32::from(*coefficient);
                }
            }
        }
    }

    /// Adds to the recorded `pose` of `frame` what it is more in the alternatives of stretches, given by number with shares of each of their
    /// alternatives. What alternatives differ by are samples of one process: mixed by shares whose squares add up to 1, they are
    /// another sample of it, as far as differences are small.
    pub fn add_mixed(&self, mixed: &[(usize, Vec<f32>)], frame: u32, pose: &mut [Vec3]) {
        let mut row = vec![0.0; self.modes.len()];
        let mut heading = None;
        for (stretch, shares) in mixed {
            let Some(stretch) = self.stretches.get(*stretch) else { continue };
            let Some(between) = frame.checked_sub(stretch.first + 1).map(|between| between as usize) else { continue };
            // A frame has one heading, whatever stretch it lies in.
            let Some(&own) = stretch.headings.get(between) else { continue };
            heading = Some(own);
            self.add_smooth_row(stretch, between, shares, &mut row);
        }
        let Some(heading) = heading else { return };
        let (sin, cos) = sin_cos(f32::from(heading) * HEADING_STEP);
        let own: Vec<(f32, &[i8])> = row
            .iter()
            .zip(&self.modes)
            .filter(|(coefficient, _)| **coefficient != 0.0)
            .map(|(coefficient, mode)| (coefficient * (COEFFICIENT_STEP / MODE_STEPS), mode.as_flattened()))
            .collect();
        // A bundle's mesh and modes have as many vertices; any other pose is left as far as it goes.
        let Some(vertices) = own.first().map(|(_, mode)| pose.len().min(mode.len() / 3)) else { return };
        let mut sums = vec![0.0; 3 * vertices];
        modes::sum_up(&own, &mut sums);
        for (place, moved) in pose.iter_mut().zip(sums.as_chunks::<3>().0) {
            let [x, y, z] = *moved;
            *place += Vec3::new(cos * x + sin * z, y, cos * z - sin * x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timeline::Sequence;

    fn alternatives() -> Option<Alternatives> {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 10, cyclic: false };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let coefficients = vec![vec![10, 0, 20, 0, 0, -40]];
        let stretch = Stretch { first: 2, last: 6, headings: vec![0, 0, 16_384], coefficients };
        let modes = vec![vec![[127, 0, 0], [0, 0, 0]], vec![[0, 0, 0], [0, 0, 127]]];
        Alternatives::new(modes, vec![stretch], 2, &timeline)
    }

    #[test]
    fn differences_are_added_between_the_ends() {
        let alternatives = alternatives().unwrap();
        let added = |frame, amount| {
            let mut pose = [Vec3::ZERO; 2];
            alternatives.add((0, 0), frame, amount, &mut pose);
            pose
        };
        assert_eq!([0, 2, 6, 9].map(|frame| added(frame, 1.0)), [[Vec3::ZERO; 2]; 4]);
        // Half of its own, a quarter of those beside it.
        assert!(added(3, 1.0)[0].distance(Vec3::X * 1e-3) < 1e-8, "{:?}", added(3, 1.0));
        assert!(added(4, 1.0)[0].distance(Vec3::X * 1.25e-3) < 1e-8 && (added(4, 1.0)[1].z + 1e-3).abs() < 1e-8);
        // Turned by a quarter, what leads along Z leads along X.
        assert!(added(5, 0.5)[1].distance(Vec3::X * -1e-3) < 1e-8, "{:?}", added(5, 0.5));
        // Of what does not exist nothing is added.
        let mut mixed = [Vec3::ZERO; 2];
        alternatives.add_mixed(&[(0, vec![0.5, 1.0]), (9, vec![1.0])], 3, &mut mixed);
        alternatives.add((0, 7), 3, 1.0, &mut mixed);
        assert!(mixed[0].distance(Vec3::X * 5e-4) < 1e-8, "{mixed:?}");
        // Of several stretches the sum.
        let mut twice = [Vec3::ZERO; 2];
        alternatives.add_mixed(&[(0, vec![0.5]), (0, vec![1.0])], 3, &mut twice);
        assert!(twice[0].distance(Vec3::X * 1.5e-3) < 1e-8, "{twice:?}");
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let good = alternatives().unwrap();
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 4, cyclic: false };
        let short = Timeline::new(25.0, vec![sequence]).unwrap();
        assert_eq!(Alternatives::new(good.modes.clone(), good.stretches.clone(), 2, &short), None);
        let mut stretches = good.stretches.clone();
        stretches[0].coefficients[0].pop();
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 10, cyclic: false };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        assert_eq!(Alternatives::new(good.modes.clone(), stretches, 2, &timeline), None);
        assert_eq!(Alternatives::new(good.modes.clone(), good.stretches.clone(), 3, &timeline), None);
    }
}
