//! The learned space of a capture: the ways in which its surface was seen to move (Tejera et al. (2013), III-B).
//!
//! Modes are displacements of all vertices. They are stored as sums of differences between recorded frames, so that a bundle,
//! which has the frames anyway, needs a few kilobytes for them ([`StoredSpace`]). The paper's equation 5 takes them of
//! differential coordinates; those are linear in positions, and modes of positions span what counts.

use glam::{Vec3, Vec3Swizzles};
use kernels::align::{align_heading, centre_of_mass};

use crate::error::EditError;
use crate::rotation::turn_by;

/// Modes, and frames that they are made of, at most.
pub const MOST_MODES: usize = 96;
/// See there.
pub const MOST_FRAMES: usize = 128;
/// Shares of a mode are whole multiples of its step, at most so many.
pub const SHARE_STEPS: i16 = 2047;
/// Modes that a part of the body has for itself, at most.
const PART_MODES: usize = 16;

/// The modes, once the poses are there that they are made of.
#[derive(Clone, Debug)]
pub struct Space {
    /// The pose on which all others were laid: which way modes face.
    reference: Vec<Vec3>,
    modes: Vec<Vec<Vec3>>,
    variances: Vec<f64>,
}

impl Space {
    /// Displacements of all vertices, mode by mode, as the reference pose faces.
    #[must_use]
    pub fn modes(&self) -> &[Vec<Vec3>] {
        &self.modes
    }

    /// The variance of each mode's coefficient over the capture.
    #[must_use]
    pub fn variances(&self) -> &[f64] {
        &self.variances
    }

    /// The modes as `pose` faces; `weights` are the topology's.
    pub(crate) fn facing(&self, pose: &[Vec3], weights: &[f32]) -> Vec<Vec<Vec3>> {
        let turn = turn_by(Vec3::Y * align_heading(pose, &self.reference, weights));
        self.modes.iter().map(|mode| mode.iter().map(|&moved| turn * moved).collect()).collect()
    }
}

/// Modes of each part of the body alone, and their variances: of each those that move it most. `share` says how much of a vertex belongs to
/// a part: between two of them modes fade, for a surface that moved with one alone to its very border would tear there.
///
/// A part that has all modes to itself moves as it was seen to, whatever the others do: the covariance of its points is the same.
pub(crate) fn by_part(
    (modes, variances): &(Vec<Vec<Vec3>>, Vec<f64>),
    parts: u32,
    share: impl Fn(usize, u32) -> f32,
) -> (Vec<Vec<Vec3>>, Vec<f64>) {
    let mut of_parts = (Vec::new(), Vec::new());
    let count = modes.first().map_or(0, Vec::len);
    for part in 0..parts {
        let shares: Vec<f32> = (0..count).map(|vertex| share(vertex, part)).collect();
        let inside = |mode: &Vec<Vec3>| -> f64 {
            mode.iter().zip(&shares).map(|(&moved, &share)| f64::from((moved * share).length_squared())).sum()
        };
        let mut moved: Vec<f64> = modes.iter().zip(variances).map(|(mode, variance)| variance * inside(mode)).collect();
        for _ in 0..PART_MODES.min(modes.len()) {
            let most = (0..moved.len()).fold(0, |most, k| if moved[k] > moved[most] { k } else { most });
            if moved[most] <= 0.0 {
                break;
            }
            moved[most] = 0.0;
            let own = modes[most].iter().zip(&shares).map(|(&moved, &share)| moved * share);
            of_parts.0.push(own.collect());
            of_parts.1.push(variances[most]);
        }
    }
    of_parts
}

/// One mode: the sum of shares times what a frame differs from the first one.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredMode {
    /// The variance of its coefficient; positive.
    pub variance: f32,
    /// What a share is counted in; positive.
    pub step: f32,
    /// One for each frame but the first, at most [`SHARE_STEPS`] either way.
    pub shares: Vec<i16>,
}

/// A learned space as it is stored beside a capture.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredSpace {
    /// Frames over the whole capture, each once; the first one is the reference.
    pub frames: Vec<u32>,
    /// The modes, those that vary most first.
    pub modes: Vec<StoredMode>,
}

impl StoredSpace {
    /// Whether it is one of a capture with so many frames; the reason where it is none.
    ///
    /// # Errors
    /// See there.
    pub fn check(&self, frame_count: u32) -> Result<(), &'static str> {
        let positive = |number: f32| number.is_finite() && number > 0.0;
        if !(2..=MOST_FRAMES).contains(&self.frames.len()) || !(1..=MOST_MODES).contains(&self.modes.len()) {
            return Err("has no modes, or too many");
        }
        let is_twice = |at: usize| self.frames[..at].contains(&self.frames[at]);
        if self.frames.iter().any(|&frame| frame >= frame_count) || (0..self.frames.len()).any(is_twice) {
            return Err("is made of a frame that does not exist, or of one twice");
        }
        for mode in &self.modes {
            if mode.shares.len() + 1 != self.frames.len() || !positive(mode.variance) || !positive(mode.step) {
                return Err("has a mode that is none");
            }
            if mode.shares.iter().any(|share| !(-SHARE_STEPS..=SHARE_STEPS).contains(share)) {
                return Err("has a share beyond all steps");
            }
        }
        Ok(())
    }

    /// The space, once the recorded poses of its frames are there, in their order; `weights` are the topology's.
    ///
    /// # Errors
    /// Poses that are none of this mesh, or not finite; shares that make no finite mode.
    pub fn space(&self, poses: &[Vec<Vec3>], weights: &[f32]) -> Result<Space, EditError> {
        let wrong = |reason: &str| EditError::Space(reason.into());
        let [reference, others @ ..] = poses else { return Err(wrong("it has no frames")) };
        let fits = |pose: &Vec<Vec3>| pose.len() == weights.len() && pose.iter().all(|point| point.is_finite());
        if poses.len() != self.frames.len() || !poses.iter().all(fits) {
            return Err(wrong("its frames are those of another mesh"));
        }
        let differences: Vec<Vec<Vec3>> = others.iter().map(|pose| difference(reference, pose, weights)).collect();
        let mut modes = Vec::with_capacity(self.modes.len());
        for stored in &self.modes {
            let mut mode = vec![Vec3::ZERO; reference.len()];
            for (difference, &share) in differences.iter().zip(&stored.shares) {
                let share = stored.step * f32::from(share);
                mode.iter_mut().zip(difference).for_each(|(sum, &part)| *sum += part * share);
            }
            if !mode.iter().all(|moved| moved.is_finite()) {
                return Err(wrong("a mode is not finite"));
            }
            modes.push(mode);
        }
        let variances = self.modes.iter().map(|mode| f64::from(mode.variance)).collect();
        Ok(Space { reference: reference.clone(), modes, variances })
    }
}

/// What `pose` differs from `reference` by, once it is turned and moved over the ground onto that.
#[must_use]
pub fn difference(reference: &[Vec3], pose: &[Vec3], weights: &[f32]) -> Vec<Vec3> {
    let turn = turn_by(Vec3::Y * align_heading(reference, pose, weights));
    let ground = |pose: &[Vec3]| centre_of_mass(pose, weights).xz();
    let (from, to) = (ground(pose), ground(reference));
    let [from, to] = [from, to].map(|at| Vec3::new(at.x, 0.0, at.y));
    pose.iter().zip(reference).map(|(&point, &reference)| turn * (point - from) + to - reference).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stored() -> StoredSpace {
        let mode = StoredMode { variance: 0.5, step: 0.01, shares: vec![100, -50] };
        StoredSpace { frames: vec![4, 1, 2], modes: vec![mode] }
    }

    #[test]
    fn modes_are_sums_of_what_frames_differ_by() {
        let weights = [0.25; 4];
        let reference = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let lifted = |by: f32| reference.iter().map(|&p| p + Vec3::Y * by * p.y).collect::<Vec<_>>();
        // Where an actor stands and which way it faces is no way to move.
        let turn = turn_by(Vec3::Y * 1.2);
        let elsewhere: Vec<Vec3> = lifted(0.3).iter().map(|&p| turn * p + Vec3::new(3.0, 0.0, -2.0)).collect();
        let space = stored().space(&[reference.clone(), elsewhere, lifted(0.2)], &weights).unwrap();
        let wanted = reference.iter().map(|p| Vec3::Y * (0.3 - 0.5 * 0.2) * p.y);
        space.modes()[0].iter().zip(wanted).for_each(|(a, b)| assert!(a.distance(b) < 1e-5, "{a} {b}"));
        let turned: Vec<Vec3> = reference.iter().map(|&p| turn * p).collect();
        let facing = space.facing(&turned, &weights);
        facing[0].iter().zip(&space.modes()[0]).for_each(|(a, b)| assert!(a.distance(turn * *b) < 1e-5));
    }

    #[test]
    fn parts_have_the_modes_that_move_them_most() {
        let mode = |a: f32, b: f32| vec![Vec3::Y * a, Vec3::Y * a, Vec3::X * b];
        let modes = (vec![mode(1.0, 0.0), mode(0.5, 2.0)], vec![0.1, 0.2]);
        let (own, variances) = by_part(&modes, 3, |vertex, part| f32::from(u8::from([0, 0, 2][vertex] == part)));
        assert_eq!(variances, [0.1, 0.2, 0.2], "the first mode does not move the second part, and part 1 is none");
        assert_eq!(own, [mode(1.0, 0.0), mode(0.5, 0.0), mode(0.0, 2.0)]);
    }

    #[test]
    fn what_is_no_space_is_refused() {
        assert_eq!(stored().check(5), Ok(()));
        assert!(stored().check(4).unwrap_err().contains("frame"));
        let refused = |change: &dyn Fn(&mut StoredSpace)| {
            let mut space = stored();
            change(&mut space);
            space.check(5).unwrap_err()
        };
        assert!(refused(&|space| space.frames[2] = 4).contains("twice"));
        assert!(refused(&|space| space.modes[0].variance = f32::NAN).contains("none"));
        assert!(refused(&|space| space.modes[0].step = -1.0).contains("none"));
        assert!(refused(&|space| space.modes[0].shares[0] = 3000).contains("share"));
        assert!(refused(&|space| space.modes.clear()).contains("no modes"));
        let poses = vec![vec![Vec3::ZERO; 3]; 3];
        assert!(stored().space(&poses, &[0.25; 4]).unwrap_err().to_string().contains("another mesh"));
        let mut large = stored();
        large.modes[0].step = 1e30;
        let far = vec![vec![Vec3::ZERO; 2], vec![Vec3::ZERO, Vec3::Y * 1e20], vec![Vec3::ZERO; 2]];
        assert!(large.space(&far, &[0.5; 2]).unwrap_err().to_string().contains("finite"));
    }
}
