//! Variety: whenever a walk comes to a stretch that has alternatives, all of them are mixed by shares that are drawn: what is shown is
//! never the same again.
//!
//! What alternatives differ by from the recording are samples d of one process about it (thesis section 6.6). For small differences
//! it is Gaussian, so that the sum of u(a) d(a) over all alternatives a is another sample of it for every vector u of length 1.
//!
//! Walks seldom come to the first frame of a stretch: transitions lead into its middle. There the recording, or the mixture that was shown
//! of the same stretch, goes over into a new one.

use std::sync::Arc;

use actor::alternatives::Alternatives;
use actor::pose_source::{PoseError, PoseSource};
use glam::Vec3;
use kernels::random::{mix, signed};

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
    /// The frame that was entered last.
    entered: Option<u32>,
}

/// Frames over which one mixture goes over into another.
const EASE: u32 = 12;

/// What is shown now.
#[derive(Clone, Debug, PartialEq)]
struct Present {
    stretch: usize,
    /// How much of each alternative.
    shares: Vec<f32>,
    /// The same before, and the frame from which on it goes over.
    before: Vec<f32>,
    since: u32,
}

impl Present {
    /// How much of each alternative is shown in a frame.
    fn at(&self, frame: u32) -> Vec<f32> {
        let x = (frame.abs_diff(self.since) as f32 / EASE as f32).min(1.0);
        let share = x * x * (3.0 - 2.0 * x);
        self.shares.iter().zip(&self.before).map(|(now, before)| before + share * (now - before)).collect()
    }
}

impl Varied {
    /// Draws from `alternatives` by `seed`; `amount` is the share of their differences that is added, from 0 to 1.
    #[must_use]
    pub fn new(alternatives: Arc<Alternatives>, seed: u64, amount: f32) -> Self {
        let amount = if amount.is_finite() { amount.clamp(0.0, 1.0) } else { 0.0 };
        Self { alternatives, seed, amount, drawn: 0, present: None, entered: None }
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
        let Present { stretch, shares, .. } = self.present.as_ref()?;
        let most = (0..shares.len()).max_by(|&a, &b| shares[a].abs().total_cmp(&shares[b].abs()));
        most.map(|most| (*stretch, most))
    }

    /// The recording again, at once: whether anything changes.
    pub fn leave(&mut self) -> bool {
        self.entered = None;
        self.present.take().is_some()
    }

    /// See [`PoseSource::enters`].
    pub fn enters(&mut self, frame: u32) -> bool {
        let jumped = self.entered.replace(frame).is_none_or(|before| before.abs_diff(frame) > 1);
        let inside = |stretch: usize| {
            let stretch = &self.alternatives.stretches()[stretch];
            stretch.first < frame && frame < stretch.last
        };
        let before = self.present.take_if(|present| !inside(present.stretch) || jumped);
        if self.present.is_some() {
            return false;
        }
        let was = before.is_some();
        let left = before.filter(|present| inside(present.stretch));
        if self.amount > 0.0 {
            self.draw(frame, left.as_ref());
        }
        // What was shown goes on where nothing new is drawn.
        if self.present.is_none() {
            self.present = left;
        }
        was || self.present.is_some()
    }

    /// Draws a mixture of a stretch that begins in `frame`; or of one that has been come into the middle of, where there is time for it.
    fn draw(&mut self, frame: u32, left: Option<&Present>) {
        let stretches = self.alternatives.stretches();
        let mut choices: Vec<usize> = self.alternatives.beginning(frame).collect();
        if choices.is_empty() {
            let time = |k: &usize| stretches[*k].first < frame && frame + 2 * EASE < stretches[*k].last;
            choices = match left {
                Some(left) => Some(left.stretch).filter(time).into_iter().collect(),
                None => (0..stretches.len()).filter(time).collect(),
            };
        }
        let choice = mix(self.seed, self.drawn);
        let Some(stretch) = choice.checked_rem(choices.len() as u64).map(|k| choices[k as usize]) else { return };
        self.drawn += 1;
        let count = stretches[stretch].coefficients.len();
        let shares: Vec<f32> = mixture(choice, count).into_iter().map(|share| self.amount * share).collect();
        let begins = stretches[stretch].first == frame;
        let before = match left.filter(|left| left.stretch == stretch) {
            Some(left) => left.at(frame),
            None if begins => shares.clone(),
            None => vec![0.0; count],
        };
        self.present = Some(Present { stretch, shares, before, since: frame });
    }

    /// Adds to the recorded `pose` of `frame` what it is more now.
    pub fn add(&self, frame: u32, pose: &mut [Vec3]) {
        if let Some(present) = &self.present {
            self.alternatives.add_mixed(present.stretch, &present.at(frame), frame, pose);
        }
    }
}

/// How much there is of each of `count` alternatives: a vector of length 1, whose directions are all about as likely. Of one alternative
/// there is some share.
#[must_use]
pub fn mixture(seed: u64, count: usize) -> Vec<f32> {
    // Sums of four even numbers are nearly normal.
    let about_normal = |k: u64| (4 * k..4 * k + 4).map(|draw| signed(seed, draw)).sum();
    let mut shares: Vec<f32> = (0..count.max(2) as u64).map(about_normal).collect();
    let length = shares.iter().map(|share| share * share).sum::<f32>().sqrt().max(f32::MIN_POSITIVE);
    shares.iter_mut().for_each(|share| *share /= length);
    shares.truncate(count);
    shares
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
                // Smoothed over three frames, of which one is recorded.
                1 => shown[stretch].push(pose[0].x / 0.75),
                _ if frame + 1 == ends.last => {}
                _ => assert!((shown[stretch].last().unwrap() - pose[0].x).abs() < 1e-9, "it goes on as it began"),
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
    fn who_comes_into_the_middle_of_a_stretch_goes_over_into_a_mixture() {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 100, cyclic: true };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let coefficients = vec![vec![900; 98], vec![-700; 98], vec![500; 98]];
        let stretch = Stretch { first: 0, last: 99, headings: vec![0; 98], coefficients };
        let all = Alternatives::new(vec![vec![[127, 0, 0]]], vec![stretch], 1, &timeline).unwrap();
        let mut varied = Varied::new(Arc::new(all), 5, 1.0);
        let shown = |varied: &Varied, frame: u32| {
            let mut pose = [Vec3::ZERO];
            varied.add(frame, &mut pose);
            pose[0].x
        };
        // Passes from frame 20 to frame 80 and back into 20 by a transition.
        let mut ends = Vec::new();
        for pass in 0..20 {
            let landed = shown(&varied, 20);
            assert!(varied.enters(20), "something new is drawn");
            assert!((shown(&varied, 20) - landed).abs() < 1e-6, "nothing jumps in pass {pass}");
            assert!(pass > 0 || landed == 0.0, "it came from the recording");
            let mut before = landed;
            for frame in 21..=80 {
                assert!(!varied.enters(frame));
                let now = shown(&varied, frame);
                assert!((now - before).abs() < 0.03, "{before} to {now}");
                before = now;
            }
            ends.push(before);
        }
        ends.sort_by(f32::total_cmp);
        assert!(ends.windows(2).all(|pair| pair[0] != pair[1]) && ends[19] - ends[0] > 0.05, "{ends:?}");
        // Too late for it: what is left of the stretch is too short.
        let mut late = Varied { drawn: 0, present: None, entered: None, ..varied };
        assert!(!late.enters(90) && late.present().is_none());
    }

    #[test]
    fn mixtures_are_as_far_as_one_alternative_and_go_everywhere() {
        let mut sums = [0.0; 3];
        for seed in 0..2000 {
            let shares = mixture(seed, 2 + seed as usize % 7);
            assert!((shares.iter().map(|share| share * share).sum::<f32>() - 1.0).abs() < 1e-5);
            let three = mixture(seed, 3);
            sums.iter_mut().zip(&three).for_each(|(sum, share)| *sum += share.abs());
        }
        // An even direction in space has half of its length along each axis.
        assert!(sums.iter().all(|sum| (sum / 2000.0 - 0.5).abs() < 0.03), "{sums:?}");
        assert!(mixture(3, 1).len() == 1 && mixture(3, 1)[0].abs() < 1.0 && mixture(3, 0).is_empty());
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
