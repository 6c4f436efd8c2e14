//! Variations as they look, frame by frame: the whole surface, or some of its vertices where only a measure is wanted.

use std::borrow::Cow;
use std::f64::consts::SQRT_2;
use std::ops::Range;

use actor::capture::Poses;
use actor::feet::Feet;
use glam::Vec3;
use rayon::prelude::*;

use crate::hold::{Held, Sole, mean};
use crate::numbers::Numbers;
use crate::reach::Differences;
use crate::smooth::between;

/// What was learned of a sequence, and drawn.
#[derive(Debug)]
pub struct Varied {
    pub(crate) frames: Range<u32>,
    pub(crate) fps: f32,
    pub(crate) models: Vec<Model>,
    /// Stretches in which a variation keeps the recording, for all that was drawn went too far.
    pub rejected: usize,
    /// Stretches in all variations.
    pub stretches: usize,
    /// The share of slides that were accepted.
    pub accepted: f64,
}

/// A part of a sequence with a model of its own.
#[derive(Debug)]
pub(crate) struct Model {
    pub numbers: Numbers,
    /// For each variation a row a learned frame: how its numbers differ from the recorded ones.
    pub differences: Differences,
}

impl Varied {
    /// The frames of the sequence that is varied.
    #[must_use]
    pub fn frames(&self) -> Range<u32> {
        self.frames.clone()
    }

    /// Frames a second.
    #[must_use]
    pub fn fps(&self) -> f32 {
        self.fps
    }

    /// How frames are numbers, part after part of the sequence, and how those of each variation differ from the recorded ones.
    fn models(&self) -> impl Iterator<Item = (&Numbers, &Differences)> {
        self.models.iter().map(|model| (&model.numbers, &model.differences))
    }

    /// The poses of variation `number`, one for each frame of the sequence.
    #[must_use]
    pub fn poses(&self, number: usize, poses: &Poses, feet: &Feet) -> Vec<Vec<Vec3>> {
        let seen = Seen::new(self, poses, feet, None);
        let variation = seen.variation(number);
        self.frames.clone().into_par_iter().map(|frame| variation.pose(frame)).collect()
    }

    /// The mean distance between the shapes of two variations, in metres (root mean square over the surface), over all pairs.
    #[must_use]
    pub fn diversity(&self) -> f64 {
        let (mut sum, mut pairs) = (0.0, 0.0);
        for model in &self.models {
            let shape = model.numbers.components();
            let count = model.differences.len();
            for a in 0..count {
                for b in 0..a {
                    for (one, other) in model.differences[a].iter().zip(&model.differences[b]) {
                        let apart = one[..shape].iter().zip(&other[..shape]).map(|(a, b)| (a - b) * (a - b));
                        sum += apart.sum::<f64>().sqrt() * model.numbers.scale;
                        pairs += 1.0;
                    }
                }
            }
        }
        sum / f64::max(pairs, 1.0)
    }
}

/// The variations of a sequence on some vertices.
pub struct Seen<'a> {
    varied: &'a Varied,
    poses: &'a Poses,
    feet: &'a Feet,
    /// The vertices; `None` are all.
    vertices: Option<&'a [u32]>,
    /// For each model, how numbers are these vertices; and those of soles.
    numbers: Vec<Cow<'a, Numbers>>,
    of_soles: Vec<Numbers>,
    soles: Vec<u32>,
    /// The feet as far as they are among the vertices.
    own_feet: Vec<Vec<Sole>>,
}

/// One variation of them.
pub struct Variation<'a> {
    seen: &'a Seen<'a>,
    number: usize,
    held: Held,
}

impl<'a> Seen<'a> {
    /// The variations `varied` of `poses` on `vertices`, which ascend, or on all.
    #[must_use]
    pub fn new(varied: &'a Varied, poses: &'a Poses, feet: &'a Feet, vertices: Option<&'a [u32]>) -> Self {
        let soles: Vec<u32> = (0..feet.count())
            .flat_map(|foot| feet.vertices(foot).iter().filter(|vertex| vertex.sole > 0).map(|vertex| vertex.vertex))
            .collect();
        let models = || varied.models().map(|(numbers, _)| numbers);
        let numbers = models().map(|own| vertices.map_or(Cow::Borrowed(own), |some| Cow::Owned(own.thinned(some))));
        let place = |vertex: u32| match vertices {
            Some(vertices) => vertices.binary_search(&vertex).ok(),
            None => Some(vertex as usize),
        };
        let own = |foot: usize| feet.vertices(foot).iter().filter_map(|&foot| Some((place(foot.vertex)?, foot)));
        Self {
            varied,
            poses,
            feet,
            vertices,
            numbers: numbers.collect(),
            of_soles: models().map(|own| own.thinned(&soles)).collect(),
            own_feet: (0..feet.count()).map(|foot| own(foot).collect()).collect(),
            soles,
        }
    }

    /// A recorded pose on these vertices.
    #[must_use]
    pub fn recorded(&self, frame: u32) -> Vec<Vec3> {
        let pose = self.poses.frame(frame);
        self.vertices.map_or_else(|| pose.to_vec(), |some| some.iter().map(|&vertex| pose[vertex as usize]).collect())
    }

    /// Variation `number`.
    #[must_use]
    pub fn variation(&'a self, number: usize) -> Variation<'a> {
        let frames = self.varied.frames();
        // How far the variation carries each foot off, frame by frame.
        let carried = |frame: u32| -> Vec<Vec3> {
            let recorded = self.poses.frame(frame);
            let own: Vec<Vec3> = self.soles.iter().map(|&vertex| recorded[vertex as usize]).collect();
            let Some(moved) = self.moved(&self.of_soles, number, frame, &own) else {
                return vec![Vec3::ZERO; self.feet.count()];
            };
            let mut pose = recorded.to_vec();
            self.soles.iter().zip(&moved).for_each(|(&vertex, &place)| pose[vertex as usize] = place);
            let carried =
                |foot: usize| mean(self.feet.vertices(foot), &pose) - mean(self.feet.vertices(foot), recorded);
            (0..self.feet.count()).map(carried).collect()
        };
        let carried: Vec<Vec<Vec3>> = frames.clone().into_par_iter().map(carried).collect();
        Variation { seen: self, number, held: Held::new(self.feet, frames.start, self.varied.fps(), &carried) }
    }

    /// What the frame of a variation is by its models, before feet stand; `None` where it is recorded.
    fn moved<N: std::borrow::Borrow<Numbers>>(
        &self,
        numbers: &[N],
        number: usize,
        frame: u32,
        recorded: &[Vec3],
    ) -> Option<Vec<Vec3>> {
        self.varied.models().zip(numbers).find_map(|((_, differences), numbers)| {
            let (offset, by) = by(numbers.borrow(), &differences[number], frame)?;
            Some(numbers.borrow().moved(recorded, offset, &by))
        })
    }
}

/// How the numbers of a frame differ, and which of its model it is; `None` where the model knows nothing of it, or it is recorded.
fn by(numbers: &Numbers, differences: &[Vec<f64>], frame: u32) -> Option<(usize, Vec<f64>)> {
    let (first, last) = (*numbers.frames.first()?, *numbers.frames.last()?);
    if !(first..=last).contains(&frame) {
        return None;
    }
    let offset = frame - first;
    let by = between(differences, f64::from(offset) / f64::from(numbers.stride));
    // What rounds to nothing is the recording itself, bit for bit.
    let seen = by.iter().any(|number| number.abs() * numbers.scale > 1e-7 / SQRT_2);
    seen.then_some((offset as usize, by))
}

impl Variation<'_> {
    /// Whether the variation differs from the recording in a frame.
    #[must_use]
    pub fn differs(&self, frame: u32) -> bool {
        let mut models = self.seen.varied.models();
        models.any(|(numbers, differences)| by(numbers, &differences[self.number], frame).is_some())
    }

    /// Its pose in a frame of the sequence.
    #[must_use]
    pub fn pose(&self, frame: u32) -> Vec<Vec3> {
        let seen = self.seen;
        let recorded = seen.recorded(frame);
        let Some(mut pose) = seen.moved(&seen.numbers, self.number, frame, &recorded) else { return recorded };
        let k = (frame - seen.varied.frames().start) as usize;
        self.held.apply(&seen.own_feet, k, &recorded, &mut pose);
        pose
    }
}
