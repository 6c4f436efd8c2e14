//! Variations of a sequence: alternatives of its stretches, which begin and end in recorded poses.
//!
//! Thesis section 6.6 with a recipe that holds on real captures: the noise is set after training, samples are tethered to the
//! recording, smoothed, and decoded as *differences* from it, so that no detail is lost.

use std::ops::Range;

use actor::capture::Poses;
use job::{Job, Stopped};
use kernels::random::mix;
use kernels::topology::Topology;
use learn::dense::Matrix;
use learn::gpdm::{Gpdm, GpdmOptions};
use learn::stretch::{StretchOptions, sample_stretch};
use rayon::prelude::*;

use crate::body::body_size;
use crate::layers::Layers;
use crate::numbers::Numbers;
use crate::reach::{Differences, Looked, least, lift};
use crate::seen::Model;
pub use crate::seen::Varied;
use crate::smooth::{ramp, smoothed};

/// Frames a second that are learned from, at most.
const LEARNED: f32 = 25.0;
/// Frames of one model: the time of its training grows with the cube.
const MODEL: usize = 150;
/// Steps of its training: what is drawn with more of them is no better, for only differences of its frames count.
const TRAINED: usize = 120;
/// The amount that samples are drawn with: so near to the recording, they tear and shake less than what is drawn farther off. They are
/// lengthened to [`MOST`] and held within bounds there; another amount has a share of that, the same in every sequence.
const DRAWN: f64 = 0.06;
/// The amount at which variations keep within bounds; larger ones go no farther than these.
const MOST: f64 = 0.25;
/// They grow with this power of the amount: with the amount itself, who stands would hardly vary at half of [`MOST`].
const GROWS: f64 = 2.0 / 3.0;
/// How far samples easily leave the recording, in mean steps, for each unit of the amount: one step at 0.12.
const TETHER: f64 = 1.0 / 0.12;
/// Deviations of what smooths samples, in learned frames: the first that does not shake, or the last.
const SMOOTH: [f64; 4] = [2.0, 3.0, 5.0, 8.0];
/// What shakes no more than this, over the recording, does not.
const SHAKES: f64 = 1.04;
/// Samples come in and go out over so many learned frames.
const RAMP: f64 = 5.0;
/// Ways in which a sequence is cut into stretches: frames that are held in one are free in the other.
pub(crate) const CUTS: usize = 2;
/// A place that is farther than this from all that was seen, in mean steps, is rejected.
const FAR: f64 = 3.0;
/// A sample's way may be so much shorter or longer than the recorded one.
const LENGTHS: Range<f64> = 0.6..1.6;

/// How sequences are varied.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct VaryOptions {
    /// How much: about the noise of a step in mean steps, 0.06 to 0.25; variations are as far from the recording as its power of 2/3 is large.
    pub amount: f64,
    /// Variations of each sequence.
    pub count: usize,
    /// Seed of all that is drawn.
    pub seed: u64,
    /// Dimensions of the space that is learned.
    pub dimensions: usize,
    /// Length of a stretch between two recorded poses, in seconds.
    pub stretch: f32,
}

impl Default for VaryOptions {
    fn default() -> Self {
        Self { amount: 0.12, count: 20, seed: 1, dimensions: 5, stretch: 2.4 }
    }
}

/// Varies the frames `frames` of a sequence. Sequences that are too short, or do not move, have variations that are the recording.
///
/// # Errors
/// It was asked to stop.
pub fn vary(
    poses: &Poses,
    topology: &Topology,
    (frames, fps): (Range<u32>, f32),
    options: &VaryOptions,
    job: &Job<'_>,
) -> Result<Varied, Stopped> {
    let stride = (fps / LEARNED).round().max(1.0) as u32;
    let length = frames.len().div_ceil(stride as usize);
    let parts = length.div_ceil(MODEL).max(1);
    let mut varied =
        Varied { frames: frames.clone(), fps, models: Vec::new(), rejected: 0, stretches: 0, accepted: 0.0 };
    let mut slides = 0.0;
    for part in 0..parts {
        job.tell("learning motion", part as u64, parts as u64)?;
        let cut = |part: usize| frames.start + (part * length / parts) as u32 * stride;
        // One frame is in both, and held in both.
        let end = if part + 1 == parts { frames.end } else { cut(part + 1) + 1 };
        let Some(numbers) = Numbers::of(poses, topology.weights(), cut(part)..end, stride, fps) else { continue };
        let trained = GpdmOptions { dimensions: options.dimensions, steps: TRAINED };
        let count = numbers.rows.rows();
        let Some(model) = Gpdm::train(numbers.rows.clone(), &[count], &trained) else { continue };
        let stretch = ((options.stretch * fps / stride as f32).round() as usize).clamp(8, MODEL);
        let seed = mix(options.seed, u64::from(frames.start) << 20 | part as u64);
        let mut drawn = draw(&model, stretch, seed, options, job)?;
        let size = f64::from(body_size(poses, &numbers.frames));
        drawn.reach(&numbers, topology, poses, size);
        let share = (options.amount / MOST).clamp(0.0, 1.0).powf(GROWS);
        drawn.differences.iter_mut().flatten().flatten().for_each(|number| *number *= share);
        varied.rejected += drawn.rejected;
        varied.stretches += drawn.stretches;
        varied.accepted += drawn.accepted;
        slides += 1.0;
        varied.models.push(Model { numbers, differences: drawn.differences });
    }
    varied.accepted /= f64::max(slides, 1.0);
    Ok(varied)
}

struct Drawn {
    differences: Differences,
    /// The stretches of each cut.
    cuts: Vec<Vec<Range<usize>>>,
    rejected: usize,
    stretches: usize,
    accepted: f64,
}

impl Drawn {
    /// Sees to it that variations go as far as is asked for, and no farther than edges allow and than is meant.
    fn reach(&mut self, numbers: &Numbers, topology: &Topology, poses: &Poses, size: f64) {
        let looked = Looked::new(numbers, topology, poses);
        let layers = Layers::new(numbers, topology, poses, size);
        for (cut, stretches) in self.cuts.iter().enumerate() {
            let of_cut = || (cut..self.differences.len()).step_by(CUTS);
            let mut own: Differences = of_cut().map(|number| self.differences[number].clone()).collect();
            lift(&mut own, stretches, least(size), &|own| looked.distance(own));
            own.par_iter_mut().for_each(|one| looked.hold_edges(one, stretches));
            layers.hold(&mut own, stretches);
            looked.hold_apart(&mut own, stretches, size);
            for (number, one) in of_cut().zip(own) {
                self.differences[number] = one;
            }
        }
    }
}

/// Draws `options.count` rows of differences, as far as the largest amount has them.
fn draw(model: &Gpdm, stretch: usize, seed: u64, options: &VaryOptions, job: &Job<'_>) -> Result<Drawn, Stopped> {
    let count = model.places.rows();
    let samples = options.count.div_ceil(CUTS);
    let stretches: Vec<(usize, Range<usize>)> =
        (0..CUTS).flat_map(|cut| cuts(count, stretch, cut).into_iter().map(move |range| (cut, range))).collect();
    job.begin("drawing variations")?;
    let chains: Vec<Result<(Vec<Matrix>, f64), Stopped>> = stretches
        .par_iter()
        .enumerate()
        .map(|(number, (_, range))| {
            job.tell("drawing variations", number as u64, stretches.len() as u64)?;
            let seed = mix(seed, number as u64);
            let options = StretchOptions { amount: DRAWN, tether: TETHER * DRAWN, samples, seed };
            Ok(sample_stretch(model, range.clone(), &options))
        })
        .collect();
    let chains = chains.into_iter().collect::<Result<Vec<_>, Stopped>>()?;
    let width = model.frames.columns();
    let still = vec![vec![0.0; width]; count];
    let cuts = (0..CUTS).map(|cut| cuts(count, stretch, cut)).collect();
    let differences = vec![still; options.count];
    let mut drawn = Drawn { differences, cuts, rejected: 0, stretches: 0, accepted: 0.0 };
    drawn.accepted = chains.iter().map(|chain| chain.1).sum::<f64>() / chains.len().max(1) as f64;
    for (number, differences) in drawn.differences.iter_mut().enumerate() {
        for ((cut, range), (samples, _)) in stretches.iter().zip(&chains) {
            let Some(sample) = samples.get(number / CUTS).filter(|_| *cut == number % CUTS) else { continue };
            drawn.stretches += 1;
            let recorded = model.places.of_rows(&range.clone().collect::<Vec<_>>());
            if !acceptable(model, &recorded, sample) {
                drawn.rejected += 1;
                continue;
            }
            for deviation in SMOOTH {
                let mut stretch = decoded(model, &recorded, &softened(&recorded, sample, deviation));
                stretch.iter_mut().flatten().for_each(|number| *number *= MOST / DRAWN);
                let shakes = shakes(model, range.start, &stretch) > SHAKES;
                differences[range.clone()].clone_from_slice(&stretch);
                if !shakes {
                    break;
                }
            }
        }
    }
    Ok(drawn)
}

/// Stretches of about `length` frames over `count` frames, each from the last frame of the one before; those of cut 1 begin in the
/// middle of those of cut 0. None is shorter than these: the first and the last of cut 1 are half as long again, for who has half of the time
/// to go as far and back is accelerated four times as much.
fn cuts(count: usize, length: usize, cut: usize) -> Vec<Range<usize>> {
    let last = count.saturating_sub(1);
    let pieces = (last as f64 / length as f64).round().max(1.0) as usize;
    let mut bounds: Vec<usize> = (0..=pieces).map(|piece| piece * last / pieces).collect();
    if cut > 0 {
        let half = last / pieces / 2;
        let inner = bounds[1..pieces].iter().take(pieces.saturating_sub(2)).map(|bound| bound + half);
        bounds = std::iter::once(0).chain(inner).chain([last]).collect();
    }
    bounds.windows(2).map(|pair| pair[0]..pair[1] + 1).collect()
}

/// Whether a sample is motion like that which was seen.
fn acceptable(model: &Gpdm, recorded: &Matrix, sample: &Matrix) -> bool {
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    let nearest = |place: &[f64]| {
        (0..model.places.rows()).map(|row| distance(model.places.row(row), place)).fold(f64::INFINITY, f64::min)
    };
    let way =
        |places: &Matrix| (1..places.rows()).map(|row| distance(places.row(row - 1), places.row(row))).sum::<f64>();
    let near = (0..sample.rows()).all(|row| nearest(sample.row(row)) <= FAR * model.mean_step);
    near && LENGTHS.contains(&(way(sample) / way(recorded).max(f64::MIN_POSITIVE)))
}

/// How the frames of places differ from those of the recorded ones.
fn decoded(model: &Gpdm, recorded: &Matrix, places: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let difference = |(k, place): (usize, &Vec<f64>)| {
        let (own, was) = (model.frame(place), model.frame(recorded.row(k)));
        own.iter().zip(&was).map(|(own, was)| own - was).collect()
    };
    places.iter().enumerate().map(difference).collect()
}

/// The mean acceleration of a stretch with these differences over that of the recording.
fn shakes(model: &Gpdm, first: usize, differences: &[Vec<f64>]) -> f64 {
    let bend = |of: &dyn Fn(usize, usize) -> f64, k: usize| {
        let columns = 0..model.frames.columns();
        columns.map(|c| (of(k - 1, c) + of(k + 1, c) - 2.0 * of(k, c)).powi(2)).sum::<f64>().sqrt()
    };
    let inner = 1..differences.len() - 1;
    let recorded = |k: usize, column: usize| model.frames[(first + k, column)];
    let varied = |k: usize, column: usize| recorded(k, column) + differences[k][column];
    let sum = |of: &dyn Fn(usize, usize) -> f64| inner.clone().map(|k| bend(of, k)).sum::<f64>();
    sum(&varied) / sum(&recorded).max(f64::MIN_POSITIVE)
}

/// Places of a sample without its shaking, at rest on the recording at both ends.
fn softened(recorded: &Matrix, sample: &Matrix, deviation: f64) -> Vec<Vec<f64>> {
    let off: Vec<Vec<f64>> = (0..sample.rows())
        .map(|row| sample.row(row).iter().zip(recorded.row(row)).map(|(own, was)| own - was).collect())
        .collect();
    let last = sample.rows() - 1;
    let soft = smoothed(&off, deviation);
    let place = |(row, soft): (usize, &Vec<f64>)| {
        let share = ramp(row.min(last - row) as f64 / RAMP);
        soft.iter().zip(recorded.row(row)).map(|(off, was)| was + share * off).collect()
    };
    soft.iter().enumerate().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seen::Seen;
    use actor::feet::{Feet, FootVertex};
    use actor::timeline::{Sequence, Timeline};
    use glam::Vec3;
    use kernels::random::signed;

    /// A rod that swings and bends, on a walk.
    fn rod(frames: u32) -> Poses {
        let mut poses = Poses::new(40);
        for frame in 0..frames {
            let time = f64::from(frame) / 25.0;
            let pose: Vec<Vec3> = (0..40_u32)
                .map(|k| {
                    let up = f64::from(k / 4) * 0.2;
                    let bend = (5.0 * time + up).sin() * 0.1 * up + 0.003 * f64::from(signed(2, u64::from(frame)));
                    let corner = [(0.05, 0.05), (0.05, -0.05), (-0.05, 0.05), (-0.05, -0.05)][k as usize % 4];
                    Vec3::new((bend + corner.0) as f32, up as f32, (corner.1 + 0.5 * time) as f32)
                })
                .collect();
            poses.push(&pose);
        }
        poses
    }

    fn rod_topology() -> Topology {
        Topology::new(40, (1..39).map(|k| [k - 1, k, k + 1]).collect(), vec![1.0; 40]).unwrap()
    }

    #[test]
    fn variations_differ_and_meet_the_recording() {
        let poses = rod(50);
        let options = VaryOptions { count: 2, dimensions: 3, ..VaryOptions::default() };
        let vary = || vary(&poses, &rod_topology(), (0..50, 25.0), &options, &Job::silent()).unwrap();
        let varied = vary();
        assert!(varied.rejected < varied.stretches, "{} of {}", varied.rejected, varied.stretches);
        assert!(varied.diversity() > 1e-4);
        let one = varied.poses(1, &poses, &Feet::default());
        assert_eq!(one.len(), 50);
        assert!(one[0] == poses.frame(0) && one[49] == poses.frame(49), "the ends are the recorded ones, bit for bit");
        let off = |k: usize| one[k].iter().zip(poses.frame(k as u32)).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        let most = (0..50).map(off).fold(0.0, f32::max);
        assert!(most > 0.001 && most < 0.3, "{most}");
        assert_eq!(one, vary().poses(1, &poses, &Feet::default()), "the same seed gives the same motion");
    }

    #[test]
    fn some_vertices_go_where_they_go_with_all() {
        let poses = rod(50);
        let options = VaryOptions { count: 2, dimensions: 3, ..VaryOptions::default() };
        let varied = vary(&poses, &rod_topology(), (0..50, 25.0), &options, &Job::silent()).unwrap();
        // A foot that stands in the middle.
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 50, cyclic: false };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let foot = (0..8).map(|vertex| FootVertex { vertex, leg: 255, sole: if vertex < 4 { 255 } else { 0 } });
        let stands = (0..50).map(|frame| (20..30).contains(&frame)).collect();
        let feet = Feet::new(vec![foot.collect()], stands, 40, &timeline).unwrap();
        let some = [1, 5, 6, 20, 39];
        let (all, seen) = (Seen::new(&varied, &poses, &feet, None), Seen::new(&varied, &poses, &feet, Some(&some)));
        let (all, seen) = (all.variation(1), seen.variation(1));
        assert!((1..49).any(|frame| all.differs(frame)) && !all.differs(0) && !all.differs(49));
        for frame in 0..50 {
            let (whole, seen) = (all.pose(frame), seen.pose(frame));
            for (place, &vertex) in seen.iter().zip(&some) {
                assert!(place.distance(whole[vertex as usize]) < 1e-6, "frame {frame}, vertex {vertex}");
            }
            assert_eq!(all.differs(frame), whole != poses.frame(frame), "frame {frame}");
        }
        let shaped = all.pose(25)[0] - all.pose(25)[1];
        assert!(
            shaped.distance(poses.frame(25)[0] - poses.frame(25)[1]) < 1e-6,
            "a sole that stands is shaped as recorded"
        );
    }

    #[test]
    fn variations_are_no_farther_apart_than_is_meant() {
        let poses = rod(80);
        let topology = rod_topology();
        let numbers = Numbers::of(&poses, topology.weights(), 0..80, 1, 25.0).unwrap();
        let width = numbers.rows.columns();
        // Far off, and smooth.
        let one = |sign: f64| -> Vec<Vec<f64>> {
            (0..80).map(|k| vec![sign * (std::f64::consts::PI * f64::from(k) / 79.0).sin(); width]).collect()
        };
        let looked = Looked::new(&numbers, &topology, &poses);
        let size = f64::from(body_size(&poses, &numbers.frames));
        let apart = |far: f64| {
            let mut all = vec![one(far), one(-far)];
            looked.hold_apart(&mut all, std::slice::from_ref(&(0..80)), size);
            looked.distance(&all)
        };
        let (near, far, farther) = (apart(0.01), apart(1.0), apart(2.0));
        assert!(near < far && far < farther * 1.001, "it grows: {near} {far} {farther}");
        // Two that differ by 26 mm of 1.8 m are 18 mm off.
        assert!(farther < 1.05 * 0.0145 / std::f64::consts::SQRT_2 * size, "{farther} of {size}");
    }

    #[test]
    fn the_amount_says_how_far() {
        let poses = rod(50);
        let off = |amount: f64| {
            let options = VaryOptions { count: 2, dimensions: 3, amount, ..VaryOptions::default() };
            let varied = vary(&poses, &rod_topology(), (0..50, 25.0), &options, &Job::silent()).unwrap();
            varied.diversity()
        };
        let [little, usual, most] = [0.0625, 0.125, 0.25].map(off);
        assert!(little > 1e-4);
        let twice = 2.0_f64.powf(GROWS);
        assert!(
            (usual / little - twice).abs() < 1e-9 && (most / usual - twice).abs() < 1e-9,
            "{little} {usual} {most}"
        );
        assert_eq!(off(0.5), most, "bounds hold the largest amount");
    }

    #[test]
    fn what_cannot_be_varied_is_the_recording() {
        let poses = rod(3);
        let options = VaryOptions { count: 2, ..VaryOptions::default() };
        let varied = vary(&poses, &rod_topology(), (0..3, 25.0), &options, &Job::silent()).unwrap();
        let one = varied.poses(0, &poses, &Feet::default());
        assert!((0..3).all(|k| one[k] == poses.frame(k as u32)));
        let still = Poses::from_positions(40, rod(1).frame(0).repeat(50));
        let varied = vary(&still, &rod_topology(), (0..50, 25.0), &options, &Job::silent()).unwrap();
        assert!(varied.poses(1, &still, &Feet::default()).iter().all(|pose| pose == still.frame(0)));
    }

    #[test]
    fn cuts_cover_all_frames() {
        for (count, length) in [(150, 60), (61, 60), (20, 60), (9, 60), (200, 33)] {
            for cut in 0..CUTS {
                let cuts = cuts(count, length, cut);
                assert_eq!((cuts[0].start, cuts.last().unwrap().end), (0, count), "{count} {length} {cut}");
                assert!(cuts.windows(2).all(|pair| pair[0].end == pair[1].start + 1));
                let whole = count - 1 < length;
                assert!(cuts.iter().all(|cut| whole || 4 * cut.len() > 3 * length), "{count} {length}: {cuts:?}");
            }
        }
    }
}
