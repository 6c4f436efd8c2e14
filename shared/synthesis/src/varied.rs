//! Variety: whenever a walk comes to a stretch that has alternatives, one of them is drawn, and never the same twice in a row.

use std::sync::Arc;

use actor::alternatives::Alternatives;
use actor::pose_source::{PoseError, PoseSource};
use glam::Vec3;
use kernels::random::mix;

/// Which alternative is shown now, and how the next one is drawn. The same seed draws the same for the same walk.
#[derive(Clone, Debug)]
pub struct Varied {
    alternatives: Arc<Alternatives>,
    seed: u64,
    /// Share of the stored differences that is added: 0 is the recording.
    amount: f32,
    /// Draws so far.
    drawn: u64,
    /// The stretch, its alternative, and the amount that it was begun with.
    present: Option<(usize, usize, f32)>,
    /// What was drawn last of each stretch: an alternative's number and one, or 0 for the recording.
    last: Vec<u16>,
}

impl Varied {
    /// Draws from `alternatives` by `seed`; `amount` is the share of their differences that is added, from 0 to 1.
    #[must_use]
    pub fn new(alternatives: Arc<Alternatives>, seed: u64, amount: f32) -> Self {
        let last = vec![0; alternatives.stretches().len()];
        let amount = if amount.is_finite() { amount.clamp(0.0, 1.0) } else { 0.0 };
        Self { alternatives, seed, amount, drawn: 0, present: None, last }
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

    /// The stretch that is shown now and its alternative, by number; `None` where it is as recorded.
    #[must_use]
    pub fn present(&self) -> Option<(usize, usize)> {
        self.present.map(|(stretch, alternative, _)| (stretch, alternative))
    }

    /// The recording again, at once: whether anything changes.
    pub fn leave(&mut self) -> bool {
        self.present.take().is_some()
    }

    /// See [`PoseSource::enters`].
    pub fn enters(&mut self, frame: u32) -> bool {
        let stretches = self.alternatives.stretches();
        let before = self.present;
        if let Some((stretch, ..)) = before {
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

    /// Draws one of the alternatives of these stretches, or the recording, which counts as one more of each.
    fn draw(&mut self, beginning: std::ops::Range<usize>) {
        let stretches = self.alternatives.stretches();
        let choices: Vec<(usize, u16)> = beginning
            .flat_map(|stretch| (0..=stretches[stretch].coefficients.len() as u16).map(move |choice| (stretch, choice)))
            .filter(|&(stretch, choice)| self.last[stretch] != choice)
            .collect();
        if choices.is_empty() {
            return;
        }
        let (stretch, choice) = choices[(mix(self.seed, self.drawn) % choices.len() as u64) as usize];
        self.drawn += 1;
        self.last[stretch] = choice;
        self.present = choice.checked_sub(1).map(|alternative| (stretch, alternative.into(), self.amount));
    }

    /// Adds to the recorded `pose` of `frame` what it is more now.
    pub fn add(&self, frame: u32, pose: &mut [Vec3]) {
        if let Some((stretch, alternative, amount)) = self.present {
            self.alternatives.add((stretch, alternative), frame, amount, pose);
        }
    }
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
    fn alternatives_are_never_the_same_twice_in_a_row() {
        let mut varied = varied(1);
        let mut shown: Vec<Vec<Option<usize>>> = vec![Vec::new(); 4];
        let mut recorded = 0;
        for frame in (0..200).flat_map(|_| 0..30) {
            let before = varied.present();
            let changed = varied.enters(frame);
            let now = varied.present();
            assert!(changed || before == now);
            let mut pose = [Vec3::ZERO];
            varied.add(frame, &mut pose);
            match now {
                Some((stretch, alternative)) => {
                    let ends = &varied.alternatives.stretches()[stretch];
                    assert!((ends.first..ends.last).contains(&frame));
                    if frame == ends.first {
                        assert_eq!(pose[0], Vec3::ZERO, "it begins in the recording");
                        shown[stretch].push(Some(alternative));
                    }
                }
                None => recorded += 1,
            }
        }
        assert!(recorded > 300, "the recording is shown as well");
        assert!(shown.iter().all(|one| one.len() > 30));
        let again = |one: &Vec<Option<usize>>| one.windows(2).filter(|pair| pair[0] == pair[1]).count();
        // What the recording was in between may come again.
        assert!(shown.iter().all(|one| again(one) < one.len() / 3));
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
