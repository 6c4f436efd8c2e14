//! Variations as alternatives of recorded stretches: their differences from the recording, in a few modes over the surface, as the
//! player adds them ([`actor::alternatives`]).

use std::ops::Range;

use actor::alternatives::{Alternatives, COEFFICIENT_STEP, HEADING_STEP, MODE_STEPS, MOST_MODES, Stretch};
use actor::capture::Capture;
use actor::feet::{Feet, SHARE_STEP};
use glam::Vec3;
use job::{Job, Stopped};
use kernels::scalar::sin_cos;
use learn::dense::{Cholesky, Matrix};
use learn::symmetric::eigen;
use rayon::prelude::*;

use crate::seen::Seen;
use crate::vary::{CUTS, Varied};

/// Frames that modes are learned from, at most: the time of it grows with the square.
const LEARNED: usize = 300;
/// Vertices that modes and coefficients are found by, at most, besides those of soles.
const LOOKED_AT: usize = 1000;
/// What is missing is measured in every so many frames.
const MEASURED: usize = 5;
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
    let making = Making::new(capture, feet, headings);
    let mut found = Vec::new();
    let mut samples = Vec::new();
    let total: usize = varied.iter().map(|one| one.frames().len() * count).sum();
    let stride = total.div_ceil(LEARNED).max(1);
    for (done, one) in varied.iter().enumerate() {
        job.tell("learning differences", done as u64, varied.len() as u64)?;
        found.push(making.stretches(one, count, stride, &mut samples));
    }
    let modes = making.modes(&samples);
    let fitting = Fitting::new(&making, &modes);
    let mut stored = Sums::default();
    let mut stretches = Vec::new();
    for (done, (one, found)) in varied.iter().zip(&found).enumerate() {
        job.tell("storing variations", done as u64, varied.len() as u64)?;
        making.store(one, found, &fitting, &mut stretches, &mut stored);
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

/// A mode as it is stored.
struct Mode {
    bytes: Vec<[i8; 3]>,
    /// Its coefficients are multiples of this, a power of two.
    multiple: f32,
}

impl Mode {
    /// The mode of a shape of which one unit moves the surface by a metre in the mean square: parts rounded to `step`, coefficients
    /// to `coefficient`, or finer.
    fn of(shape: &[Vec3], step: f64, coefficient: f64) -> Self {
        let most = shape.iter().map(|part| part.abs().max_element()).fold(f32::MIN_POSITIVE, f32::max);
        let largest = (most / step as f32).ceil().clamp(1.0, MODE_STEPS);
        let byte = |part: f32| (part / most * largest).round() as i8;
        let bytes = shape.iter().map(|part| part.to_array().map(byte)).collect();
        let unit = most * MODE_STEPS / (largest * COEFFICIENT_STEP);
        let multiple = (coefficient as f32 * unit).max(1.0).log2().floor().clamp(0.0, 12.0);
        Self { bytes, multiple: 2.0_f32.powi(multiple as i32) }
    }
}

struct Making<'a> {
    capture: &'a Capture,
    feet: &'a Feet,
    headings: &'a [f32],
    /// Vertices that modes and coefficients are found by, ascending.
    looked: Vec<u32>,
    /// The root of how much each of them counts.
    roots: Vec<f64>,
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

impl<'a> Making<'a> {
    fn new(capture: &'a Capture, feet: &'a Feet, headings: &'a [f32]) -> Self {
        let weights = weights(capture, feet);
        let mut sole = vec![false; weights.len()];
        for foot in 0..feet.count() {
            feet.vertices(foot).iter().for_each(|vertex| sole[vertex.vertex as usize] |= vertex.sole > 0);
        }
        let stride = weights.len().div_ceil(LOOKED_AT).max(1);
        let looked: Vec<u32> = (0..weights.len())
            .filter(|&vertex| sole[vertex] || vertex % stride == 0)
            .map(|vertex| vertex as u32)
            .collect();
        // Each but those of soles stands for those that are left out.
        let share = |&vertex: &u32| if sole[vertex as usize] { 1.0 } else { stride as f64 };
        let shares: Vec<f64> =
            looked.iter().map(|vertex| share(vertex) * f64::from(weights[*vertex as usize])).collect();
        let sum = shares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let roots = shares.iter().map(|share| (share / sum).sqrt()).collect();
        Self { capture, feet, headings, looked, roots }
    }

    /// A pose's difference from the recorded one, seen by a body that faces +Z.
    fn difference(&self, frame: u32, pose: &[Vec3], recorded: &[Vec3]) -> Vec<Vec3> {
        let heading = stored_heading(self.headings[frame as usize]);
        let (sin, cos) = sin_cos(-f32::from(heading) * HEADING_STEP);
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
        let seen = Seen::new(varied, &self.capture.poses, self.feet, None);
        let mut differs = vec![vec![false; frames.len()]; count];
        for (number, differs) in differs.iter_mut().enumerate() {
            let variation = seen.variation(number);
            for (differs, frame) in differs.iter_mut().zip(frames.clone()) {
                *differs = variation.differs(frame);
            }
            // Other frames of each variation.
            let chosen = |&k: &usize| differs[k] && (k + number * 7) % stride == 0;
            let sample = |k: usize| {
                let frame = frames.start + k as u32;
                self.difference(frame, &variation.pose(frame), self.capture.poses.frame(frame))
            };
            let chosen: Vec<usize> = (0..frames.len()).filter(chosen).collect();
            samples.par_extend(chosen.into_par_iter().map(sample));
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
        let rows = Matrix::from_fn(count, 3 * self.looked.len(), |row, column| {
            f64::from(samples[row][self.looked[column / 3] as usize][column % 3]) * self.roots[column / 3]
        });
        let found = eigen(rows.gram().values(), count);
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
            let mut shape = vec![Vec3::ZERO; self.capture.topology.vertex_count()];
            for (sample, entry) in samples.iter().zip(vector) {
                let share = (entry / value.sqrt()) as f32;
                shape.iter_mut().zip(sample).for_each(|(sum, moved)| *sum += share * *moved);
            }
            // Rounding to a step misses a root of a twelfth of it, in each of three coordinates.
            let step = 2.0 * parts / (value / count as f64).sqrt();
            Mode::of(&shape, step, 12.0_f64.sqrt() * coefficients)
        };
        found.values[..kept].par_iter().zip(&found.vectors[..kept]).map(mode).collect()
    }

    /// Adds the stretches of a sequence, as they are stored.
    fn store(
        &self,
        varied: &Varied,
        found: &[FoundStretch],
        fitting: &Fitting,
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
        let seen = Seen::new(varied, &self.capture.poses, self.feet, Some(&self.looked));
        for number in 0..most {
            let variation = seen.variation(number);
            for (stretch, own) in found.iter().zip(&mut own) {
                if !stretch.variations.contains(&number) {
                    continue;
                }
                let difference = |frame: u32| self.difference(frame, &variation.pose(frame), &seen.recorded(frame));
                let differences: Vec<Vec<Vec3>> = (own.first + 1..own.last).into_par_iter().map(difference).collect();
                own.coefficients.push(fitting.fitted(&differences, sums));
            }
        }
        stretches.extend(own);
    }
}

/// How differences become coefficients: by least squares over the modes as they are stored.
struct Fitting {
    /// A row a mode: what one step of its coefficient moves each vertex by, times the root of how much that counts.
    steps: Matrix,
    multiples: Vec<f32>,
    normal: Option<Cholesky>,
    roots: Vec<f64>,
}

impl Fitting {
    fn new(making: &Making, modes: &[Mode]) -> Self {
        let step = f64::from(COEFFICIENT_STEP / MODE_STEPS);
        let steps = Matrix::from_fn(modes.len(), 3 * making.looked.len(), |row, column| {
            let byte = modes[row].bytes[making.looked[column / 3] as usize][column % 3];
            step * f64::from(byte) * making.roots[column / 3]
        });
        let mut normal = steps.gram();
        let least = 1e-9 * (0..modes.len()).map(|k| normal[(k, k)]).fold(f64::MIN_POSITIVE, f64::max);
        (0..modes.len()).for_each(|k| normal[(k, k)] += least);
        let multiples = modes.iter().map(|mode| mode.multiple).collect();
        Self { steps, multiples, normal: Cholesky::of(&normal), roots: making.roots.clone() }
    }

    /// Coefficients, frame after frame; `sums` is told what they miss.
    fn fitted(&self, differences: &[Vec<Vec3>], sums: &mut Sums) -> Vec<i16> {
        let (count, width) = (differences.len(), self.multiples.len());
        let rows = Matrix::from_fn(count, 3 * self.roots.len(), |row, column| {
            f64::from(differences[row][column / 3][column % 3]) * self.roots[column / 3]
        });
        let Some(normal) = self.normal.as_ref().filter(|_| width > 0) else { return vec![0; count * width] };
        let found = normal.solve(&self.steps.times_transposed(&rows));
        let stored = |row: usize, mode: usize| {
            let multiple = self.multiples[mode];
            let steps = (found[(mode, row)] as f32 / multiple).round() * multiple;
            // The largest multiple that can be stored.
            let most = 32_768.0 - multiple;
            steps.clamp(-most, most) as i16
        };
        let coefficients: Vec<i16> = (0..count * width).map(|at| stored(at / width, at % width)).collect();
        for row in (0..count).step_by(MEASURED) {
            let own = &coefficients[row * width..(row + 1) * width];
            let shown = Matrix::from_fn(1, width, |_, mode| f64::from(own[mode])).times(&self.steps);
            sums.add(rows.row(row), shown.values(), &self.roots);
        }
        coefficients
    }
}

#[derive(Default)]
struct Sums {
    frames: f64,
    missing: f64,
    most: f64,
}

impl Sums {
    /// A frame as it is and as it is stored, both times the roots of what counts.
    fn add(&mut self, own: &[f64], stored: &[f64], roots: &[f64]) {
        let left = |(k, root): (usize, &f64)| {
            let squares = (3 * k..3 * k + 3).map(|at| (own[at] - stored[at]).powi(2)).sum::<f64>();
            squares.sqrt() / root.max(f64::MIN_POSITIVE)
        };
        let lengths: Vec<f64> = roots.iter().enumerate().map(left).collect();
        self.frames += 1.0;
        self.missing += lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
        self.most = lengths.into_iter().fold(self.most, f64::max);
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

#[cfg(test)]
mod tests {
    use super::*;
    use actor::capture::Poses;
    use actor::surface::Surface;
    use actor::timeline::{Sequence, Timeline};
    use kernels::random::signed;
    use kernels::topology::Topology;

    #[test]
    fn coefficients_are_those_of_the_modes_as_they_are_stored() {
        let vertices = 3000;
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 1, cyclic: false };
        let poses = Poses::from_positions(vertices, (0..vertices).map(|k| Vec3::Y * k as f32 * 6e-4).collect());
        let capture = Capture {
            name: "t".into(),
            topology: Topology::new(vertices as u32, vec![[0, 1, 2]], vec![1.0; vertices]).unwrap(),
            surface: Surface::default(),
            timeline: Timeline::new(25.0, vec![sequence]).unwrap(),
            poses,
            vertex_of_file_vertex: Vec::new(),
        };
        let feet = Feet::default();
        let making = Making::new(&capture, &feet, &[0.0]);
        assert!(making.looked.len() <= LOOKED_AT);
        let mode = |seed: u64| {
            let byte = |k: usize| (127.0 * signed(seed, k as u64)) as i8;
            Mode { bytes: (0..vertices).map(|v| [3 * v, 3 * v + 1, 3 * v + 2].map(byte)).collect(), multiple: 4.0 }
        };
        // Modes that are far from orthogonal.
        let (first, second) = (mode(1), mode(2));
        let mixed = |k: usize| std::array::from_fn(|axis| first.bytes[k][axis] / 2 + second.bytes[k][axis] / 2);
        let modes = [Mode { bytes: (0..vertices).map(mixed).collect(), multiple: 4.0 }, first];
        let fitting = Fitting::new(&making, &modes);
        let difference = |own: [f32; 2]| -> Vec<Vec3> {
            let step = COEFFICIENT_STEP / MODE_STEPS;
            let moved = |&vertex: &u32| {
                let part = |mode: usize| Vec3::from(modes[mode].bytes[vertex as usize].map(f32::from));
                step * (own[0] * part(0) + own[1] * part(1))
            };
            making.looked.iter().map(moved).collect()
        };
        let mut sums = Sums::default();
        let found = fitting.fitted(&[difference([400.0, -120.0]), difference([-7.0, 901.0])], &mut sums);
        assert_eq!(found, [400, -120, -8, 900]);
        assert!(sums.mean().most < 1e-6, "the first frame is looked at, and has nothing to round");
    }
}
