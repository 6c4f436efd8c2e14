//! An idle that lasts: what is shown of it in ten minutes, and how near that comes to what had been shown before.

use std::sync::Arc;

use actor::alternatives::Alternatives;
use actor::timeline::Sequence;
use glam::Vec3;
use rayon::prelude::*;
use synthesis::Varied;

/// Vertices that are looked at, at most.
const LOOKED_AT: usize = 250;
/// Every so many frames are.
const EVERY: usize = 2;
/// What is no farther than this from what was shown before is taken for the same, on average over the surface: 1 mm.
pub const ALIKE: f64 = 1e-3;

/// What ten minutes show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lasting {
    /// Times that the sequence was gone through.
    pub passes: usize,
    /// Mean distance of a vertex between two passes, in metres.
    pub apart: f64,
    /// The same of those two that are nearest to each other.
    pub nearest: f64,
    /// The longest passage in which every frame is within [`ALIKE`] of one pass before, in seconds.
    pub longest: f64,
}

/// A pass: for each frame that is looked at, how some vertices differ from the recording.
type Pass = Vec<Vec<Vec3>>;

/// What is shown of `sequence`, on a mesh of `vertices`, when it is gone through again and again for `seconds`, its alternatives drawn by
/// `seed`.
pub fn lasting(
    all: &Arc<Alternatives>,
    (sequence, vertices): (&Sequence, usize),
    fps: f32,
    seconds: f64,
    seed: u64,
) -> Lasting {
    let mut varied = Varied::new(Arc::clone(all), seed, 1.0);
    let passes = (seconds * f64::from(fps)) as usize / sequence.frame_count.max(1) as usize;
    let stride = vertices.div_ceil(LOOKED_AT).max(1);
    let mut pose = vec![Vec3::ZERO; vertices];
    let shown: Vec<Pass> = (0..passes)
        .map(|_| {
            let mut pass = Pass::new();
            for frame in sequence.first_frame..sequence.end_frame() {
                varied.enters(frame);
                if ((frame - sequence.first_frame) as usize).is_multiple_of(EVERY) {
                    pose.fill(Vec3::ZERO);
                    varied.add(frame, &mut pose);
                    pass.push(pose.iter().step_by(stride).copied().collect());
                }
            }
            pass
        })
        .collect();
    measured(&shown, EVERY as f64 / f64::from(fps))
}

/// What passes have in common; a frame lasts `seconds`.
fn measured(shown: &[Pass], seconds: f64) -> Lasting {
    let of_shift = |shift: usize| {
        let (mut nearest, mut sum, mut run, mut longest) = (f64::INFINITY, 0.0, 0, 0);
        for (before, now) in shown.iter().zip(&shown[shift..]) {
            let mut pass = 0.0;
            for (a, b) in before.iter().zip(now) {
                let apart =
                    a.iter().zip(b).map(|(a, b)| f64::from(a.distance(*b))).sum::<f64>() / a.len().max(1) as f64;
                run = if apart <= ALIKE { run + 1 } else { 0 };
                longest = longest.max(run);
                pass += apart / now.len().max(1) as f64;
            }
            nearest = f64::min(nearest, pass);
            sum += pass;
        }
        (nearest, sum, longest)
    };
    let shifts: Vec<(f64, f64, usize)> = (1..shown.len()).into_par_iter().map(of_shift).collect();
    let pairs = (shown.len() * shown.len().saturating_sub(1) / 2).max(1);
    Lasting {
        passes: shown.len(),
        apart: shifts.iter().map(|shift| shift.1).sum::<f64>() / pairs as f64,
        nearest: shifts.iter().map(|shift| shift.0).fold(f64::INFINITY, f64::min),
        longest: shifts.iter().map(|shift| shift.2).max().unwrap_or(0) as f64 * seconds,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_that_come_again_are_found() {
        let pass = |height: f32| vec![vec![height * Vec3::Y; 3]; 10];
        let found = measured(&[pass(0.0), pass(0.01), pass(0.03), pass(0.0305)], 0.1);
        assert_eq!((found.passes, found.longest), (4, 1.0));
        assert!((found.nearest - 0.0005).abs() < 1e-8);
        assert!((found.apart - (10.0 + 30.0 + 30.5 + 20.0 + 20.5 + 0.5) / 6e3).abs() < 1e-7, "{found:?}");
        // Half of a pass, and on into the next one.
        let half = |height: f32| [vec![vec![Vec3::Y; 3]; 5], vec![vec![height * Vec3::Y; 3]; 5]].concat();
        assert_eq!(measured(&[half(0.1), half(0.2)], 0.1).longest, 0.5);
    }

    #[test]
    fn what_has_no_alternatives_repeats_itself() {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 50, cyclic: false };
        let found = lasting(&Arc::new(Alternatives::default()), (&sequence, 9), 25.0, 60.0, 1);
        assert_eq!((found.passes, found.apart, found.nearest), (30, 0.0, 0.0));
        assert!(found.longest >= 57.0, "{found:?}");
    }
}
