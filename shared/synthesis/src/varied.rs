//! Variety: whenever a walk comes to a stretch that has alternatives, all of them are mixed by shares that are drawn: what is shown is
//! never the same again.
//!
//! What alternatives differ by from the recording are samples d of one process about it (thesis section 6.6). For small differences
//! it is Gaussian, so that the sum of u(a) d(a) over all alternatives a is another sample of it for every vector u of length 1.
//!
//! A sequence is cut into stretches in several ways. All that a frame lies in are shown at once, their differences added up: where one
//! begins and ends in the recording, another one is in its middle. Each is as much smaller as there are more of them, so that the sum
//! is as far from the recording as one alone.
//!
//! The mixture of each stretch is drawn before anybody comes there, and anew once it is left: a transition that leads into its middle
//! blends towards what is shown afterwards.

use std::sync::Arc;

use actor::alternatives::Alternatives;
use actor::pose_source::{PoseError, PoseSource};
use glam::Vec3;
use kernels::random::{mix, signed};

/// How stretches are shown, and how their mixtures are drawn. The same seed draws the same for the same walk.
#[derive(Clone, Debug)]
pub struct Varied {
    alternatives: Arc<Alternatives>,
    seed: u64,
    /// Share of the stored differences that is added: 0 is the recording.
    amount: f32,
    /// For each stretch what is shown of it.
    shown: Vec<Shown>,
    /// The frame that was entered last; `None` where the recording is shown.
    entered: Option<u32>,
}

/// Frames over which one mixture goes over into another.
const EASE: u32 = 12;

/// What is shown of a stretch.
#[derive(Clone, Debug, PartialEq)]
struct Shown {
    /// Times that it was drawn.
    drawn: u64,
    /// How much of each alternative.
    shares: Vec<f32>,
    /// The same before, and the frame from which on it goes over.
    before: Option<(Vec<f32>, u32)>,
}

impl Shown {
    /// How much of each alternative is shown in a frame.
    fn at(&self, frame: u32) -> Vec<f32> {
        let Some((before, since)) = &self.before else { return self.shares.clone() };
        let x = (frame.abs_diff(*since) as f32 / EASE as f32).min(1.0);
        let share = x * x * (3.0 - 2.0 * x);
        self.shares.iter().zip(before).map(|(now, before)| before + share * (now - before)).collect()
    }
}

impl Varied {
    /// Draws from `alternatives` by `seed`; `amount` is the share of their differences that is added, from 0 to 1.
    #[must_use]
    pub fn new(alternatives: Arc<Alternatives>, seed: u64, amount: f32) -> Self {
        let mut varied = Self { alternatives, seed, amount: 0.0, shown: Vec::new(), entered: None };
        varied.shown =
            vec![Shown { drawn: 0, shares: Vec::new(), before: None }; varied.alternatives.stretches().len()];
        varied.set_amount(amount);
        varied
    }

    /// Takes another amount, at once wherever the actor is not.
    pub fn set_amount(&mut self, amount: f32) {
        self.amount = if amount.is_finite() { amount.clamp(0.0, 1.0) } else { 0.0 };
        for stretch in 0..self.shown.len() {
            if !self.entered.is_some_and(|frame| self.inside(stretch, frame)) {
                self.shown[stretch].shares = self.mixed(stretch, self.shown[stretch].drawn);
            }
        }
    }

    /// The share of the differences that is added.
    #[must_use]
    pub fn amount(&self) -> f32 {
        self.amount
    }

    /// The stretch that is shown now, the one that began last, and the alternative that it has most of, by number; `None` where it is as recorded.
    #[must_use]
    pub fn present(&self) -> Option<(usize, usize)> {
        let frame = self.entered?;
        let stretch = (0..self.shown.len()).rev().find(|&stretch| self.is_shown(stretch, frame))?;
        let shares = &self.shown[stretch].shares;
        let most = (0..shares.len()).max_by(|&a, &b| shares[a].abs().total_cmp(&shares[b].abs()));
        most.map(|most| (stretch, most))
    }

    /// Whether a frame is shown otherwise than it was recorded.
    #[must_use]
    pub fn differs(&self, frame: u32) -> bool {
        self.entered.is_some() && (0..self.shown.len()).any(|stretch| self.is_shown(stretch, frame))
    }

    /// The recording again, at once: whether anything changes.
    pub fn leave(&mut self) -> bool {
        self.entered.take().is_some() && self.amount > 0.0 && !self.shown.is_empty()
    }

    /// See [`PoseSource::enters`].
    pub fn enters(&mut self, frame: u32) -> bool {
        let Some(before) = self.entered.replace(frame) else { return self.amount > 0.0 && !self.shown.is_empty() };
        let jumped = before.abs_diff(frame) > 1;
        let mut changed = false;
        for stretch in 0..self.shown.len() {
            if !self.inside(stretch, before) {
                continue;
            }
            let stays = self.inside(stretch, frame);
            let has_time = frame + 2 * EASE < self.alternatives.stretches()[stretch].last;
            if !stays || jumped && has_time {
                let drawn = self.shown[stretch].drawn + 1;
                let was = stays.then(|| (self.shown[stretch].at(frame), frame));
                self.shown[stretch] = Shown { drawn, shares: self.mixed(stretch, drawn), before: was };
                changed = true;
            }
        }
        changed
    }

    /// Adds to the recorded `pose` of `frame` what it is more now.
    pub fn add(&self, frame: u32, pose: &mut [Vec3]) {
        if self.entered.is_none() {
            return;
        }
        let inside = (0..self.shown.len()).filter(|&stretch| self.is_shown(stretch, frame));
        let shares: Vec<(usize, Vec<f32>)> = inside.map(|stretch| (stretch, self.shown[stretch].at(frame))).collect();
        self.alternatives.add_mixed(&shares, frame, pose);
    }

    /// Whether a frame lies between the ends of a stretch, where it differs from the recording.
    fn inside(&self, stretch: usize, frame: u32) -> bool {
        let stretch = &self.alternatives.stretches()[stretch];
        stretch.first < frame && frame < stretch.last
    }

    /// The same of a stretch of which anything is shown.
    fn is_shown(&self, stretch: usize, frame: u32) -> bool {
        self.inside(stretch, frame)
            && (self.shown[stretch].before.is_some() || self.shown[stretch].shares.iter().any(|share| *share != 0.0))
    }

    /// A mixture of a stretch, the one of this number.
    fn mixed(&self, stretch: usize, drawn: u64) -> Vec<f32> {
        let stretches = self.alternatives.stretches();
        let own = &stretches[stretch];
        let middle = own.first + (own.last - own.first) / 2;
        let together = stretches.iter().filter(|other| other.first <= middle && middle < other.last).count().max(1);
        let amount = self.amount / (together as f32).sqrt();
        let seed = mix(mix(self.seed, stretch as u64), drawn);
        mixture(seed, own.coefficients.len()).into_iter().map(|share| amount * share).collect()
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
        let mut shown: Vec<Vec<f32>> = vec![Vec::new(); 30];
        for frame in (0..3000).flat_map(|_| 0..30) {
            varied.enters(frame);
            let mut pose = [Vec3::ZERO];
            varied.add(frame, &mut pose);
            shown[frame as usize].push(pose[0].x);
            assert_eq!(varied.differs(frame), varied.present().is_some());
            assert_eq!(varied.differs(frame), frame != 0 && frame != 29, "it begins and ends in the recording");
        }
        for (frame, one) in shown.iter_mut().enumerate() {
            let square = one.iter().map(|x| x * x).sum::<f32>() / one.len() as f32;
            // One to three steps of 0.1 mm: their mean square is that of mixtures, too, and of halves of two of them.
            let whole = 14.0 / 3.0;
            match frame {
                0 | 29 => assert_eq!(square, 0.0),
                2..=8 | 17..=27 => assert!((square * 1e8 - whole).abs() < 0.3, "frame {frame}: {square}"),
                // Where two end and begin the other two go on.
                10 | 15 => assert!((square * 1e8 - whole / 2.0).abs() < 0.2, "frame {frame}: {square}"),
                _ => assert!(square > 0.0),
            }
            if square > 0.0 {
                one.sort_by(f32::total_cmp);
                let same = one.windows(2).filter(|pair| pair[0] == pair[1]).count();
                assert!(same < 30, "frame {frame}: {same} of 3000 are the same to the last bit");
            }
        }
    }

    #[test]
    fn who_comes_into_the_middle_of_a_stretch_sees_what_was_drawn_before() {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 200, cyclic: true };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let coefficients = vec![vec![900; 98], vec![-700; 98], vec![500; 98]];
        let stretch =
            |first: u32| Stretch { first, last: first + 99, headings: vec![0; 98], coefficients: coefficients.clone() };
        let all = Alternatives::new(vec![vec![[127, 0, 0]]], vec![stretch(0), stretch(99)], 1, &timeline).unwrap();
        let mut varied = Varied::new(Arc::new(all), 5, 1.0);
        let shown = |varied: &Varied, frame: u32| {
            let mut pose = [Vec3::ZERO];
            varied.add(frame, &mut pose);
            pose[0].x
        };
        assert_eq!(shown(&varied, 40), 0.0, "the recording, until somebody comes");
        varied.enters(150);
        // Passes from frame 20 to frame 80 and back into 20 by a transition, or from frame 120 of the other one.
        let mut ends = Vec::new();
        for pass in 0..20 {
            if pass % 2 == 1 {
                (120..140).for_each(|frame| _ = varied.enters(frame));
            }
            let landed = shown(&varied, 20);
            varied.enters(20);
            assert!((shown(&varied, 20) - landed).abs() < 1e-6, "nothing jumps in pass {pass}");
            let mut before = landed;
            for frame in 21..=80 {
                assert!(!varied.enters(frame));
                let now = shown(&varied, frame);
                assert!((now - before).abs() < 0.03, "{before} to {now}");
                before = now;
            }
            assert!(pass % 2 == 1 || pass == 0 || (before - landed).abs() > 1e-4, "it goes over into another one");
            ends.push(before);
        }
        ends.sort_by(f32::total_cmp);
        assert!(ends.windows(2).all(|pair| pair[0] != pair[1]) && ends[19] - ends[0] > 0.05, "{ends:?}");
        // Too late for another one: what is left of the stretch is too short.
        let (landed, was) = (shown(&varied, 90), varied.present());
        assert!(!varied.enters(90) && varied.present() == was && shown(&varied, 90) == landed);
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
        assert!(left.enters(4) && left.present().is_some());
        assert!(left.differs(5) && left.leave() && left.present().is_none() && !left.differs(5) && !left.leave());
    }
}
