//! Variety: whenever a walk comes to a stretch that has alternatives, two of them are drawn and mixed, by an angle that is drawn, too: what
//! is shown is never the same again.
//!
//! What alternatives differ by from the recording are samples d of one process about it (thesis section 6.6). For small differences
//! it is Gaussian, so that d(a) cos x + d(b) sin x is another sample of it for every angle x.

use std::sync::Arc;

use actor::alternatives::Alternatives;
use actor::pose_source::{PoseError, PoseSource};
use glam::Vec3;
use kernels::random::{mix, signed};
use kernels::scalar::sin_cos;

/// Which alternative is shown now, and how the next one is drawn. The same seed draws the same for the same walk.
#[derive(Clone, Debug)]
pub struct Varied {
    alternatives: Arc<Alternatives>,
    seed: u64,
    /// Share of the stored differences that is added: 0 is the recording.
    amount: f32,
    /// Draws so far.
    drawn: u64,
    present: Option<Present>,
}

/// What is shown now.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Present {
    stretch: usize,
    /// Two alternatives and how much of each.
    shares: [(usize, f32); 2],
}

impl Varied {
    /// Draws from `alternatives` by `seed`; `amount` is the share of their differences that is added, from 0 to 1.
    #[must_use]
    pub fn new(alternatives: Arc<Alternatives>, seed: u64, amount: f32) -> Self {
        let amount = if amount.is_finite() { amount.clamp(0.0, 1.0) } else { 0.0 };
        Self { alternatives, seed, amount, drawn: 0, present: None }
    }

    /// Takes another amount, from the next stretch on.
    pub fn set_amount(&mut self, amount: f32) {
        self.amount = if amount.is_finite() { amount.clamp(0.0, 1.0) } else { 0.0 };
    }

    /// The share of the differences that is added.
    #[must_use]
    pub fn amount(&self) -> f32 {
        self.amount
    }

    /// The stretch that is shown now and the alternative that it has most of, by number; `None` where it is as recorded.
    #[must_use]
    pub fn present(&self) -> Option<(usize, usize)> {
        self.present.map(|Present { stretch, shares: [a, b] }| (stretch, if a.1.abs() >= b.1.abs() { a.0 } else { b.0 }))
    }

    /// The recording again, at once: whether anything changes.
    pub fn leave(&mut self) -> bool {
        self.present.take().is_some()
    }

    /// See [`PoseSource::enters`].
    pub fn enters(&mut self, frame: u32) -> bool {
        let stretches = self.alternatives.stretches();
        let before = self.present;
        if let Some(Present { stretch, .. }) = before {
            let stretch = &stretches[stretch];
            if stretch.first < frame && frame < stretch.last {
                return false;
            }
            self.present = None;
        }
        if self.amount > 0.0 {
            self.draw(self.alternatives.beginning(frame));
        }
        before.is_some() || self.present.is_some()
    }

    /// Draws one of these stretches, and a mixture of its alternatives.
    fn draw(&mut self, beginning: std::ops::Range<usize>) {
        let choice = mix(self.seed, self.drawn);
        let Some(stretch) = choice.checked_rem(beginning.len() as u64).map(|k| beginning.start + k as usize) else {
            return;
        };
        self.drawn += 1;
        let count = self.alternatives.stretches()[stretch].coefficients.len();
        let shares = mixture(choice, count).map(|(alternative, share)| (alternative, self.amount * share));
        self.present = Some(Present { stretch, shares });
    }

    /// Adds to the recorded `pose` of `frame` what it is more now.
    pub fn add(&self, frame: u32, pose: &mut [Vec3]) {
        if let Some(Present { stretch, shares }) = &self.present {
            self.alternatives.add_mixed(*stretch, shares, frame, pose);
        }
    }
}

/// Two of `count` alternatives, and how much there is of each: the squares of shares add up to 1. Of one alternative there is some share.
#[must_use]
pub fn mixture(seed: u64, count: usize) -> [(usize, f32); 2] {
    let (sin, cos) = sin_cos(std::f32::consts::PI * signed(seed, 0));
    let below = |draw: u64, count: usize| mix(seed, draw).checked_rem(count as u64).unwrap_or(0) as usize;
    let first = below(1, count);
    let Some(others) = count.checked_sub(1).filter(|others| *others > 0) else { return [(0, cos), (0, 0.0)] };
    [(first, cos), ((first + 1 + below(2, others)) % count, sin)]
}

/// Poses of a source with variety.
pub struct VariedPoses<'a, S> {
    /// The recording.
    pub recorded: &'a mut S,
    /// What is shown of it.
    pub varied: Varied,
}

impl<S: PoseSource> PoseSource for VariedPoses<'_, S> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        self.recorded.read(frame, pose)?;
        self.varied.add(frame, pose);
        Ok(())
    }

    fn enters(&mut self, frame: u32) -> bool {
        self.recorded.enters(frame) | self.varied.enters(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::alternatives::Stretch;
    use actor::timeline::{Sequence, Timeline};

    fn varied(seed: u64) -> Varied {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 30, cyclic: true };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let stretch = |first: u32, last: u32| {
            let between = (last - first - 1) as usize;
            Stretch {
                first,
                last,
                headings: vec![0; between],
                coefficients: (1..4).map(|c| vec![c; between]).collect(),
            }
        };
        let stretches = vec![stretch(0, 10), stretch(0, 15), stretch(10, 29), stretch(15, 29)];
        let modes = vec![vec![[127, 0, 0]]];
        Varied::new(Arc::new(Alternatives::new(modes, stretches, 1, &timeline).unwrap()), seed, 1.0)
    }

    #[test]
    fn what_is_shown_never_comes_again() {
        let mut varied = varied(1);
        let mut shown: Vec<Vec<f32>> = vec![Vec::new(); 4];
        for frame in (0..300).flat_map(|_| 0..30) {
            let before = varied.present();
            let changed = varied.enters(frame);
            let now = varied.present();
            assert!(changed || before == now);
            let mut pose = [Vec3::ZERO];
            varied.add(frame, &mut pose);
            let Some((stretch, _)) = now else {
                assert_eq!(pose[0], Vec3::ZERO);
                continue;
            };
            let ends = &varied.alternatives.stretches()[stretch];
            assert!((ends.first..ends.last).contains(&frame));
            match frame - ends.first {
                0 => assert_eq!(pose[0], Vec3::ZERO, "it begins in the recording"),
                1 => shown[stretch].push(pose[0].x),
                _ => assert_eq!(shown[stretch].last(), Some(&pose[0].x), "it goes on as it began"),
            }
        }
        for one in &mut shown {
            assert!(one.len() > 80, "every stretch is shown");
            let square = one.iter().map(|x| x * x).sum::<f32>() / one.len() as f32;
            // One to three steps of 0.1 mm: their mean square is that of mixtures, too.
            assert!((square.sqrt() * 1e4 - (14.0_f32 / 3.0).sqrt()).abs() < 0.4, "{square}");
            one.sort_by(f32::total_cmp);
            assert!(one.windows(2).all(|pair| pair[0] != pair[1]));
        }
    }

    #[test]
    fn mixtures_are_of_two_that_differ_and_as_far_as_one() {
        for (seed, count) in (0..200).map(|k| (k, 2 + k as usize % 5)) {
            let [(a, x), (b, y)] = mixture(seed, count);
            assert!(a != b && a < count && b < count && (x * x + y * y - 1.0).abs() < 1e-5);
        }
        assert_eq!((mixture(3, 1)[0].0, mixture(3, 1)[1], mixture(3, 0)[0].0), (0, (0, 0.0), 0));
    }

    #[test]
    fn the_same_seed_draws_the_same_and_nothing_is_drawn_without_an_amount() {
        let walk = |mut varied: Varied| -> Vec<Option<(usize, usize)>> {
            (0..300)
                .map(|step| {
                    varied.enters(step % 30);
                    varied.present()
                })
                .collect()
        };
        assert_eq!(walk(varied(3)), walk(varied(3)));
        assert_ne!(walk(varied(3)), walk(varied(4)));
        let mut none = varied(3);
        none.set_amount(0.0);
        assert!(walk(none).iter().all(Option::is_none));
        let mut left = varied(3);
        while left.present().is_none() {
            left.enters(0);
        }
        assert!(left.leave() && left.present().is_none() && !left.leave());
    }
}
