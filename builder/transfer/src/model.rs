//! What is learned from pairs of poses, and how the target moves by it (thesis sections 5.4 to 5.6).

use std::sync::atomic::{AtomicU64, Ordering};

use actor::timeline::Sequence;
use glam::Vec3;
use job::Job;
use learn::dense::Matrix;
use learn::regression::RegressionOptions;
use rayon::prelude::*;

use crate::carried::Carried;
use crate::correct::Examples;
use crate::displace::{Displacement, LEVER};
use crate::error::TransferError;
use crate::inputs::Inputs;
use crate::limbs::matching;
use crate::map::Map;
use crate::pair::{Pair, TransferOptions};
use crate::rebuild::Rebuilder;
use crate::space::{Space, numbers, numbers_at, spaces, spaces_of};
use crate::stand::Stance;
use crate::subject::Subject;
use crate::upright::upright;

/// The noise's deviation at least, relative to the body's size: 3 mm of 1.8 m.
const FLOOR: f64 = 0.0017;
/// Steps of the search for parameters.
const STEPS: usize = 40;

/// How a target moves when a source does.
pub struct Model<'a> {
    source: Subject<'a>,
    target: Subject<'a>,
    /// Of each part of the target: the source's numbers, what they mean, and the target's shape.
    sources: Vec<Space>,
    inputs: Inputs,
    maps: Vec<Map>,
    targets: Vec<Space>,
    /// What the bones alone make of a pose, and of each part what shapes are beside that.
    carried: Option<(Carried, Vec<Space>)>,
    displacement: Displacement,
    rebuilder: Rebuilder,
    /// Poses by whose lengths shapes are corrected.
    examples: Option<Examples>,
    stance: Option<Stance>,
    /// Pairs that were learned from.
    pub learned: usize,
}

impl<'a> Model<'a> {
    /// Learns from pairs, those of a sequence in its order.
    ///
    /// # Errors
    /// Too few pairs, poses that are all alike, or being asked to stop.
    pub fn learn(
        source: &'a Subject<'a>,
        target: &'a Subject<'a>,
        pairs: &[Pair],
        options: &TransferOptions,
        job: &Job<'_>,
    ) -> Result<Self, TransferError> {
        if pairs.len() < TransferError::FEWEST {
            return Err(TransferError::FewPairs(pairs.len()));
        }
        check(source, target, pairs)?;
        job.begin("learning to move")?;
        let most = options.pairs.max(TransferError::FEWEST).min(pairs.len());
        let indices: Vec<usize> = (0..most).map(|k| k * pairs.len() / most).collect();
        let chosen: Vec<Pair> = indices.iter().map(|&index| pairs[index]).collect();
        let order = if options.whole { None } else { matching(source, target, pairs) };
        let upright = if options.bones { upright(source, target, pairs) } else { None };
        let has_bones = upright.is_some();
        let [source, target] = upright.unwrap_or_else(|| [source, target].map(|own| own.with_roots(own.roots.clone())));
        let frames = |of: fn(&Pair) -> u32| chosen.iter().map(of).collect::<Vec<u32>>();
        let own = spaces(&source, &frames(|pair| pair.source as u32), order.is_none());
        let targets = spaces(&target, &frames(|pair| pair.target), order.is_none());
        let sources: Vec<Space> = match &order {
            Some(order) => order.iter().map(|&part| own[part].clone()).collect(),
            None => own,
        };
        if sources.iter().all(|space| space.width() == 0) {
            return Err(TransferError::Still("source"));
        }
        if targets.iter().all(|space| space.width() == 0) {
            return Err(TransferError::Still("target"));
        }
        let x: Vec<Vec<Vec<f64>>> = chosen.par_iter().map(|pair| numbers_at(&source, &sources, pair.source)).collect();
        let carried = if has_bones { Carried::learn(&source, &target, &chosen) } else { None };
        let carried = carried.map(|carried| {
            let rests: Vec<Vec<Vec3>> = chosen.par_iter().map(|pair| carried.rest(&source, &target, pair)).collect();
            let spaces = spaces_of(&target, &rests, order.is_none());
            (carried, spaces, rests)
        });
        let y: Vec<Vec<Vec<f64>>> = match &carried {
            None => chosen.par_iter().map(|pair| numbers(&target, &targets, pair.target)).collect(),
            Some((_, spaces, rests)) => {
                rests.par_iter().map(|rest| spaces.iter().map(|space| space.numbers(rest)).collect()).collect()
            }
        };
        let inputs = Inputs::of(&source, order.as_deref());
        let told: Vec<Vec<Vec<f64>>> = if carried.is_some() {
            chosen.par_iter().zip(&x).map(|(pair, x)| inputs.at(&source, &sources, pair.source, x)).collect()
        } else {
            x.clone()
        };
        job.tell("learning to move", 1, 2)?;
        let floor = FLOOR * f64::from(target.size);
        let gain = f64::from(target.size / source.size.max(f32::MIN_POSITIVE));
        let regression = RegressionOptions { kernel: options.kernel, floor, gain, steps: STEPS };
        let maps: Vec<Map> = (0..sources.len())
            .into_par_iter()
            .map(|part| map(&told, &y, part, &regression, carried.is_some()))
            .collect();
        let carried = carried.map(|(carried, spaces, _)| (carried, spaces));
        let poses = chosen.iter().zip(&x).map(|(pair, x)| pose(&source, pair.source, x));
        let learned: Vec<(usize, Vec<f64>)> = indices.into_iter().zip(poses).collect();
        let displacement = Displacement::fit(&source, &target, pairs, &learned, floor);
        let weights: Vec<&[f32]> = match order {
            Some(_) => (0..target.parts.count()).map(|part| target.parts.weights(part)).collect(),
            None => Vec::new(),
        };
        let rebuilder = Rebuilder::new(target.topology, &target.own(middle(&targets, &chosen, &target)), &weights)
            .map_err(|error| TransferError::Surface(error.to_string()))?;
        let examples = || Examples::of(&target, &frames(|pair| pair.target), &targets, &rebuilder, &weights);
        let examples = options.correct.then(examples);
        let stance = if options.hold { Stance::of(&source, &target) } else { None };
        Ok(Self {
            source,
            target,
            sources,
            inputs,
            maps,
            targets,
            carried,
            displacement,
            rebuilder,
            examples,
            stance,
            learned: chosen.len(),
        })
    }

    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.maps.len()
    }

    /// Whether bones carry the pose: both have a human's.
    #[must_use]
    pub fn has_bones(&self) -> bool {
        self.carried.is_some()
    }

    /// What a metre of the source's way is for the target.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.displacement.ratio
    }

    /// Whether soles are held: both actors have the same number of feet.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.stance.is_some()
    }

    /// Times of the source, in frames of the whole capture, of the frames that a sequence of it becomes.
    #[must_use]
    pub fn times(&self, sequence: &Sequence) -> Vec<f64> {
        let step = f64::from(self.source.timeline.fps() / self.target.timeline.fps());
        let last = f64::from(sequence.frame_count - 1);
        let count = (last / step + 1e-4) as u32 + 1;
        (0..count).map(|k| f64::from(sequence.first_frame) + (f64::from(k) * step).min(last)).collect()
    }

    /// The target as the source is at these times, one after another: a frame each, in metres. The number of threads changes nothing.
    ///
    /// # Errors
    /// Being asked to stop, or a surface that cannot be solved for.
    pub fn frames(&self, times: &[f64], job: &Job<'_>) -> Result<Vec<Vec<Vec3>>, TransferError> {
        job.begin("moving the target")?;
        let made = AtomicU64::new(0);
        let frame = |&time: &f64| -> Result<Vec<Vec3>, TransferError> {
            job.tell("moving the target", made.fetch_add(1, Ordering::Relaxed), times.len() as u64)?;
            self.still(time)
        };
        let mut poses = times.par_iter().map(frame).collect::<Result<Vec<_>, TransferError>>()?;
        if let Some(stance) = &self.stance {
            stance.hold(&self.target, &self.source, times, &mut poses);
        }
        Ok(poses)
    }

    /// How far the target's soles move from frame to frame while the source's stand, in metres, on average: of `poses` at `times`.
    #[must_use]
    pub fn slide(&self, times: &[f64], poses: &[Vec<Vec3>]) -> Option<f32> {
        let stance = Stance::of(&self.source, &self.target)?;
        Some(stance.slide(&self.target, &self.source, times, poses))
    }

    /// The target as the source is at a time, alone: no sole is held.
    ///
    /// # Errors
    /// A surface that cannot be solved for.
    pub fn still(&self, time: f64) -> Result<Vec<Vec3>, TransferError> {
        let inputs = numbers_at(&self.source, &self.sources, time);
        let root = self.displacement.at(&self.source.root_at(time), &pose(&self.source, time, &inputs));
        let body = root.body();
        Ok(self.shape_of(time, &inputs)?.into_iter().map(|point| body.place(point)).collect())
    }

    /// The target's shape in its body's own frame, as the source is at a time.
    ///
    /// # Errors
    /// A surface that cannot be solved for.
    pub fn shape(&self, time: f64) -> Result<Vec<Vec3>, TransferError> {
        self.shape_of(time, &numbers_at(&self.source, &self.sources, time))
    }

    fn shape_of(&self, time: f64, own: &[Vec<f64>]) -> Result<Vec<Vec3>, TransferError> {
        let told = if self.has_bones() { &self.inputs.at(&self.source, &self.sources, time, own) } else { own };
        let predicted: Vec<Vec<f64>> = self.maps.iter().zip(told).map(|(map, input)| map.predict(input)).collect();
        let spaces = self.carried.as_ref().map_or(&self.targets, |(_, spaces)| spaces);
        let shapes =
            spaces.iter().zip(&predicted).map(|(space, predicted)| (space.vertices.as_slice(), space.shape(predicted)));
        let parts: Vec<(&[u32], Vec<Vec3>)> = match &self.carried {
            None => shapes.collect(),
            Some((carried, _)) => {
                let pose = carried.pose(&self.source.own_at(time));
                shapes.map(|(vertices, rest)| (vertices, pose.with(vertices, &rest))).collect()
            }
        };
        let surface = self.rebuilder.surface(&parts).map_err(|error| TransferError::Surface(error.to_string()))?;
        let Some(examples) = &self.examples else { return Ok(surface) };
        // What bones carry is told apart by what came of it.
        let came = || self.targets.iter().map(|space| space.numbers(&surface)).collect();
        let numbers = if self.has_bones() { came() } else { predicted };
        examples.correct(&self.rebuilder, &surface, &numbers)
    }
}

/// All numbers of a pose that may tell where the body is: those of its parts, its height and its tilt, all in metres.
fn pose(subject: &Subject, time: f64, parts: &[Vec<f64>]) -> Vec<f64> {
    let root = subject.root_at(time);
    let tilt = root.tilt * (LEVER * subject.size);
    parts.iter().flatten().copied().chain([root.centre.y, tilt.x, tilt.y, tilt.z].map(f64::from)).collect()
}

fn map(x: &[Vec<Vec<f64>>], y: &[Vec<Vec<f64>>], part: usize, options: &RegressionOptions, is_rest: bool) -> Map {
    let rows = |of: &[Vec<Vec<f64>>]| Matrix::from_fn(of.len(), of[0][part].len(), |row, k| of[row][part][k]);
    if is_rest { Map::rest(&rows(x), &rows(y), options) } else { Map::learn(&rows(x), &rows(y), options) }
}

/// The frame of the target that is nearest to its mean shape: triangles of the mean itself may have shrunk to nothing.
fn middle(spaces: &[Space], pairs: &[Pair], target: &Subject) -> u32 {
    let far = |frame: u32| numbers(target, spaces, frame).iter().flatten().map(|number| number * number).sum::<f64>();
    let stride = pairs.len().div_ceil(100).max(1);
    let frames = pairs.iter().step_by(stride).map(|pair| (far(pair.target), pair.target));
    frames.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, frame)| frame)
}

fn check(source: &Subject, target: &Subject, pairs: &[Pair]) -> Result<(), TransferError> {
    for pair in pairs {
        let ends = [("source", pair.source as u32, source), ("target", pair.target, target)];
        for (which, frame, subject) in ends {
            let count = subject.timeline.frame_count();
            if frame >= count {
                return Err(TransferError::Frame { which, frame, count });
            }
        }
    }
    Ok(())
}
