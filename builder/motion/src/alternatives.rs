//! Variations as alternatives of recorded stretches: their differences from the recording, in a few modes over the surface, as the
//! player adds them ([`actor::alternatives`]).

use std::ops::Range;

use actor::alternatives::{Alternatives, COEFFICIENT_STEP, HEADING_STEP, MODE_STEPS, MOST_MODES, Stretch};
use actor::capture::Capture;
use actor::feet::{Feet, SHARE_STEP};
use glam::Vec3;
use job::{Job, Stopped};
use kernels::scalar::sin_cos;
use learn::dense::Matrix;
use learn::symmetric::eigen;
use rayon::prelude::*;

use crate::vary::{CUTS, Varied};

/// Frames that modes are learned from, at most: the time of it grows with the square.
const LEARNED: usize = 600;
/// Modes are added until so much is missing (root mean square), as a part of the body's height: half a millimetre of 1.8 m.
const MISSING: f64 = 0.000_28;
/// What rounding of modes, and of coefficients, may add to that, likewise: each mode is rounded the finer the more it moves, so that
/// all together miss this in the fewest bytes (thesis section 4.5 does so with textures; it is the filling of waters in reverse).
const ROUNDED: [f64; 2] = [0.000_1, 0.000_03];
/// A sole counts so many times as much as other surface: what stands must not slide.
const SOLE: f32 = 8.0;

/// What came of storing variations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stored {
    /// Mean distance of a vertex from where the variation has it, in metres.
    pub error: f64,
    /// The largest one.
    pub most: f64,
}

/// The alternatives that the first `count` variations of sequences are; `headings` says which way the body faces in each frame, in radians.
///
/// # Errors
/// It was asked to stop.
pub fn alternatives(
    capture: &Capture,
    feet: &Feet,
    headings: &[f32],
    varied: &[Varied],
    count: usize,
    job: &Job<'_>,
) -> Result<(Alternatives, Stored), Stopped> {
    let making = Making { capture, feet, headings, weights: weights(capture, feet) };
    let mut found = Vec::new();
    let mut samples = Vec::new();
    let total: usize = varied.iter().map(|one| one.frames().len() * count).sum();
    let stride = total.div_ceil(LEARNED).max(1);
    for (done, one) in varied.iter().enumerate() {
        job.tell("learning differences", done as u64, varied.len() as u64)?;
        found.push(making.stretches(one, count, stride, &mut samples));
    }
    let modes = making.modes(&samples);
    let mut stored = Sums::default();
    let mut stretches = Vec::new();
    for (done, (one, found)) in varied.iter().zip(&found).enumerate() {
        job.tell("storing variations", done as u64, varied.len() as u64)?;
        making.store(one, found, &modes, &mut stretches, &mut stored);
    }
    stretches.sort_by_key(|stretch| (stretch.first, stretch.last));
    let bytes = modes.iter().map(|mode| mode.bytes.clone()).collect();
    let all = Alternatives::new(bytes, stretches, capture.topology.vertex_count(), &capture.timeline);
    // What was made of this capture fits it.
    Ok((all.unwrap_or_default(), stored.mean()))
}

/// A stretch, and the variations that differ in it.
struct FoundStretch {
    ends: Range<u32>,
    variations: Vec<usize>,
}

/// A mode as it is stored, and as frames are compared with it.
struct Mode {
    bytes: Vec<[i8; 3]>,
    shape: Vec<Vec3>,
    /// Steps of its coefficient that one unit of the shape is.
    unit: f32,
    /// Its coefficients are multiples of this, a power of two.
    multiple: f32,
}

impl Mode {
    /// The mode of a shape of which one unit moves the surface by a metre in the mean square: parts rounded to `step`, coefficients
    /// to `coefficient`, or finer.
    fn of(shape: Vec<Vec3>, step: f64, coefficient: f64) -> Self {
        let most = shape.iter().map(|part| part.abs().max_element()).fold(f32::MIN_POSITIVE, f32::max);
        let largest = (most / step as f32).ceil().clamp(1.0, MODE_STEPS);
        let byte = |part: f32| (part / most * largest).round() as i8;
        let bytes = shape.iter().map(|part| part.to_array().map(byte)).collect();
        let unit = most * MODE_STEPS / (largest * COEFFICIENT_STEP);
        let multiple = (coefficient as f32 * unit).max(1.0).log2().floor().clamp(0.0, 12.0);
        let multiple = 2.0_f32.powi(multiple as i32);
        Self { bytes, shape, unit, multiple }
    }
}

struct Making<'a> {
    capture: &'a Capture,
    feet: &'a Feet,
    headings: &'a [f32],
    /// How much each vertex counts; the sum is 1.
    weights: Vec<f32>,
}

/// How much each vertex counts.
fn weights(capture: &Capture, feet: &Feet) -> Vec<f32> {
    let mut weights = capture.topology.weights().to_vec();
    for foot in 0..feet.count() {
        for vertex in feet.vertices(foot) {
            weights[vertex.vertex as usize] *= 1.0 + SOLE * f32::from(vertex.sole) * SHARE_STEP;
        }
    }
    let sum: f32 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum.max(f32::MIN_POSITIVE));
    weights
}

impl Making<'_> {
    /// A pose's difference from the recorded one, seen by a body that faces +Z.
    fn difference(&self, frame: u32, pose: &[Vec3]) -> Vec<Vec3> {
        let heading = stored_heading(self.headings[frame as usize]);
        let (sin, cos) = sin_cos(-f32::from(heading) * HEADING_STEP);
        let recorded = self.capture.poses.frame(frame);
        let turned = |moved: Vec3| Vec3::new(cos * moved.x + sin * moved.z, moved.y, cos * moved.z - sin * moved.x);
        pose.iter().zip(recorded).map(|(own, was)| turned(*own - *was)).collect()
    }

    /// The stretches between frames that all variations of a cut have as recorded; every so many of their differences go to
    /// `samples`.
    fn stretches(
        &self,
        varied: &Varied,
        count: usize,
        stride: usize,
        samples: &mut Vec<Vec<Vec3>>,
    ) -> Vec<FoundStretch> {
        let frames = varied.frames();
        let mut differs = vec![vec![false; frames.len()]; count];
        for (number, differs) in differs.iter_mut().enumerate() {
            let poses = varied.poses(number, &self.capture.poses, self.feet);
            for (k, pose) in poses.iter().enumerate() {
                let frame = frames.start + k as u32;
                differs[k] = pose != self.capture.poses.frame(frame);
                // Other frames of each variation.
                if differs[k] && (k + number * 7) % stride == 0 {
                    samples.push(self.difference(frame, pose));
                }
            }
        }
        let mut found = Vec::new();
        for cut in 0..CUTS {
            let of_cut: Vec<usize> = (cut..count).step_by(CUTS).collect();
            let any = |k: usize| of_cut.iter().any(|&number| differs[number][k]);
            let mut k = 0;
            while k < frames.len() {
                let from = k;
                while k < frames.len() && any(k) {
                    k += 1;
                }
                // What differs up to an end of its sequence has nothing to meet there.
                if k > from && from > 0 && k < frames.len() {
                    let variations =
                        of_cut.iter().copied().filter(|&number| differs[number][from..k].contains(&true)).collect();
                    let ends = frames.start + from as u32 - 1..frames.start + k as u32;
                    match found.iter_mut().find(|one: &&mut FoundStretch| one.ends == ends) {
                        // Cuts of a short sequence are alike.
                        Some(same) => same.variations.extend::<Vec<usize>>(variations),
                        None => found.push(FoundStretch { ends, variations }),
                    }
                }
                k += 1;
            }
        }
        found
    }

    /// The principal components of differences, as few as are enough.
    fn modes(&self, samples: &[Vec<Vec3>]) -> Vec<Mode> {
        let count = samples.len();
        if count == 0 {
            return Vec::new();
        }
        let root: Vec<f64> = self.weights.iter().map(|weight| f64::from(*weight).sqrt()).collect();
        let rows = Matrix::from_fn(count, 3 * root.len(), |row, column| {
            f64::from(samples[row][column / 3][column % 3]) * root[column / 3]
        });
        let found = eigen(rows.times_transposed(&rows).values(), count);
        let height = height(self.capture);
        let mut missing: f64 = found.values.iter().filter(|value| **value > 0.0).sum();
        let mut kept = 0;
        for value in &found.values {
            let is_enough = missing <= (MISSING * height).powi(2) * count as f64;
            if kept == MOST_MODES || is_enough || *value <= f64::MIN_POSITIVE {
                break;
            }
            missing -= value;
            kept += 1;
        }
        let [parts, coefficients] = ROUNDED.map(|missing| missing * height / (kept as f64).sqrt());
        let mode = |(value, vector): (&f64, &Vec<f64>)| {
            let mut shape = vec![Vec3::ZERO; root.len()];
            for (sample, entry) in samples.iter().zip(vector) {
                let share = (entry / value.sqrt()) as f32;
                shape.iter_mut().zip(sample).for_each(|(sum, moved)| *sum += share * *moved);
            }
            // Rounding to a step misses a root of a twelfth of it, in each of three coordinates.
            let step = 2.0 * parts / (value / count as f64).sqrt();
            Mode::of(shape, step, 12.0_f64.sqrt() * coefficients)
        };
        found.values.iter().zip(&found.vectors).take(kept).map(mode).collect()
    }

    /// Adds the stretches of a sequence, as they are stored.
    fn store(
        &self,
        varied: &Varied,
        found: &[FoundStretch],
        modes: &[Mode],
        stretches: &mut Vec<Stretch>,
        sums: &mut Sums,
    ) {
        let mut own: Vec<Stretch> = found
            .iter()
            .map(|stretch| Stretch {
                first: stretch.ends.start,
                last: stretch.ends.end,
                headings: (stretch.ends.start + 1..stretch.ends.end)
                    .map(|frame| stored_heading(self.headings[frame as usize]))
                    .collect(),
                coefficients: Vec::new(),
            })
            .collect();
        let most = found.iter().flat_map(|stretch| &stretch.variations).max().map_or(0, |most| most + 1);
        for number in 0..most {
            let poses = varied.poses(number, &self.capture.poses, self.feet);
            for (stretch, own) in found.iter().zip(&mut own) {
                if !stretch.variations.contains(&number) {
                    continue;
                }
                let first = varied.frames().start;
                let row = |frame: u32| self.row(frame, &poses[(frame - first) as usize], modes);
                let rows: Vec<Row> = (own.first + 1..own.last).into_par_iter().map(row).collect();
                rows.iter().for_each(|row| sums.add(row));
                own.coefficients.push(rows.into_iter().flat_map(|row| row.coefficients).collect());
            }
        }
        stretches.extend(own);
    }

    /// A frame's coefficients, and what they miss.
    fn row(&self, frame: u32, pose: &[Vec3], modes: &[Mode]) -> Row {
        let mut left = self.difference(frame, pose);
        let mut coefficients = Vec::with_capacity(modes.len());
        for mode in modes {
            let product = |((shape, moved), weight): ((&Vec3, &Vec3), &f32)| f64::from(shape.dot(*moved) * weight);
            let value: f64 = mode.shape.iter().zip(&left).zip(&self.weights).map(product).sum();
            let steps = (value as f32 * mode.unit / mode.multiple).round() * mode.multiple;
            // The largest multiple that can be stored.
            let most = 32_768.0 - mode.multiple;
            let stored = steps.clamp(-most, most) as i16;
            coefficients.push(stored);
            // As it will be added.
            let step = f32::from(stored) * COEFFICIENT_STEP / MODE_STEPS;
            left.iter_mut().zip(&mode.bytes).for_each(|(left, part)| *left -= step * Vec3::from(part.map(f32::from)));
        }
        let lengths = || left.iter().map(|left| f64::from(left.length()));
        Row {
            coefficients,
            missing: lengths().sum::<f64>() / left.len().max(1) as f64,
            most: lengths().fold(0.0, f64::max),
        }
    }
}

struct Row {
    coefficients: Vec<i16>,
    missing: f64,
    most: f64,
}

#[derive(Default)]
struct Sums {
    frames: f64,
    missing: f64,
    most: f64,
}

impl Sums {
    fn add(&mut self, row: &Row) {
        self.frames += 1.0;
        self.missing += row.missing;
        self.most = self.most.max(row.most);
    }

    fn mean(&self) -> Stored {
        Stored { error: self.missing / self.frames.max(1.0), most: self.most }
    }
}

/// A heading as it is stored, between half a turn to the right and to the left.
fn stored_heading(heading: f32) -> i16 {
    (heading / HEADING_STEP).round() as i64 as i16
}

fn height(capture: &Capture) -> f64 {
    let heights = || capture.poses.frame(0).iter().map(|point| point.y);
    f64::from(heights().fold(f32::MIN, f32::max) - heights().fold(f32::MAX, f32::min)).max(f64::MIN_POSITIVE)
}
