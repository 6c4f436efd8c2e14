//! Frames as few numbers, and differences of numbers as frames.
//!
//! A row holds the shape's principal components in the body's own frame, and how the body stands off its own smoothed way: sway,
//! height, turn and tilt. All are in metres (turns at the end of a lever), so that they count by what is seen.

use actor::capture::Poses;
use glam::{Quat, Vec3};
use learn::dense::Matrix;
use learn::symmetric::eigen;
use rayon::prelude::*;

use crate::body::{BodyFrame, body_frames, body_size};
use crate::smooth::smoothed;

/// Components are added until this much is missing (root mean square): 2 mm of 1.8 m.
const MISSING: f64 = 0.0011;
/// Components at most.
const MOST: usize = 40;
/// Coordinates that are summed up at a time.
const PIECE: usize = 3072;
/// Vertices that are looked at to find components, at most.
const LOOKED_AT: usize = 2000;
/// How far from its axis a turn counts: 30 cm of 1.8 m.
const LEVER: f64 = 0.17;
/// Deviation of what smooths the way, in seconds: shorter than a step, longer than a sway.
const SMOOTH: f64 = 0.35;
/// Numbers of how the body stands.
const STANCE: usize = 7;

/// Frames of one sequence as rows.
#[derive(Clone, Debug)]
pub struct Numbers {
    /// The frames, every so many of the sequence's.
    pub frames: Vec<u32>,
    /// Frames of the capture from one of them to the next.
    pub stride: u32,
    /// A row a frame: mean zero, varying by one in all.
    pub rows: Matrix,
    /// What a number of a row is in metres.
    pub scale: f64,
    /// How far from its axis a turn counts, in metres.
    lever: f64,
    /// Components of the shape in the body's own frame, in metres a metre: three coordinates a vertex, one after the other.
    modes: Vec<Vec<f32>>,
    /// How the body is turned on its smoothed way, and where it is, for each frame of the sequence from the first of `frames`.
    ways: Vec<(f64, BodyFrame)>,
}

impl Numbers {
    /// Numbers of every `stride`-th frame of `first..end`; `None` where these are not three, or do not move.
    #[must_use]
    pub fn of(poses: &Poses, areas: &[f32], frames: std::ops::Range<u32>, stride: u32, fps: f32) -> Option<Self> {
        let all: Vec<u32> = frames.clone().collect();
        let chosen: Vec<u32> = frames.step_by(stride as usize).collect();
        if chosen.len() < 3 {
            return None;
        }
        let size = body_size(poses, &all);
        let (body, lever) = (body_frames(poses, &all, areas, size), LEVER * f64::from(size));
        let stances = stances(&body, SMOOTH * f64::from(fps), lever);
        let own = |&frame: &u32| -> Vec<Vec3> {
            let body = &body[(frame - all[0]) as usize];
            poses.frame(frame).iter().map(|&point| body.own(point)).collect()
        };
        let shapes: Vec<Vec<Vec3>> = chosen.par_iter().map(own).collect();
        let (coefficients, modes) = components(shapes, areas, MISSING * f64::from(size));
        let mut rows =
            Matrix::from_fn(chosen.len(), modes.len() + STANCE, |row, column| match column.checked_sub(modes.len()) {
                None => coefficients[(row, column)],
                Some(number) => stances[row * stride as usize].1[number],
            });
        let scale = normalise(&mut rows).filter(|scale| *scale > 1e-6 * f64::from(size))?;
        let ways = stances.iter().zip(&body).map(|((heading, _), body)| (*heading, *body)).collect();
        Some(Self { frames: chosen, stride, rows, scale, lever, modes, ways })
    }

    /// Number of the shape's components.
    #[must_use]
    pub fn components(&self) -> usize {
        self.modes.len()
    }

    /// The same on some vertices.
    #[must_use]
    pub fn thinned(&self, vertices: &[u32]) -> Self {
        let some =
            |mode: &Vec<f32>| vertices.iter().flat_map(|&vertex| &mode[3 * vertex as usize..][..3]).copied().collect();
        let modes = self.modes.iter().map(some).collect();
        let (frames, rows, ways) = (self.frames.clone(), self.rows.clone(), self.ways.clone());
        Self { frames, rows, ways, modes, ..*self }
    }

    /// `recorded`, the pose of the frame `offset` frames after the first one, moved by the difference `by` of two rows.
    #[must_use]
    pub fn moved(&self, recorded: &[Vec3], offset: usize, by: &[f64]) -> Vec<Vec3> {
        let (shape, stance) = by.split_at(self.modes.len());
        let shape: Vec<f32> = shape.iter().map(|number| (number * self.scale) as f32).collect();
        let stance: Vec<f32> = stance.iter().map(|number| (number * self.scale) as f32).collect();
        let (heading, body) = self.ways[offset];
        // Turned on the spot: the tilt about the body's centre, the turn about what is up.
        let turn = stance[3] / self.lever as f32;
        let tilt = Vec3::new(stance[4], stance[5], stance[6]) / self.lever as f32;
        let yaw = Quat::from_rotation_y(heading as f32);
        let rotation = Quat::from_rotation_y(turn) * yaw * Quat::from_scaled_axis(tilt) * yaw.inverse() * body.rotation;
        let centre = body.centre + yaw * Vec3::new(stance[0], stance[1], stance[2]);
        let moved = BodyFrame { rotation, centre };
        let sums = self.summed(&shape, recorded.len());
        let place = |(&point, by): (&Vec3, &[f32; 3])| moved.place(body.own(point) + Vec3::from_array(*by));
        recorded.iter().zip(sums.as_chunks::<3>().0).map(place).collect()
    }

    /// How the shape's numbers move pairs of vertices against each other along ways, given in the world of the frame `offset` frames after the first one:
    /// x' A x is the mean square of (own - other) . way, for the difference x of two rows.
    pub fn along(&self, offset: usize, ways: &[([usize; 2], Vec3)]) -> Matrix {
        let back = self.ways[offset].1.rotation.inverse();
        let own: Vec<([usize; 2], Vec3)> = ways.iter().map(|(ends, way)| (*ends, back * *way)).collect();
        let part =
            |mode: &[f32], vertex: usize| Vec3::new(mode[3 * vertex], mode[3 * vertex + 1], mode[3 * vertex + 2]);
        let share = self.scale / (ways.len().max(1) as f64).sqrt();
        // A row a mode.
        let moves = Matrix::from_fn(self.modes.len(), own.len(), |mode, pair| {
            let ([a, b], way) = own[pair];
            let mode = &self.modes[mode];
            share * f64::from((part(mode, a) - part(mode, b)).dot(way))
        });
        moves.gram()
    }

    /// The sum of the modes times `amounts`: so many of them after each other for a piece of the surface that it need not be read from afar again.
    fn summed(&self, amounts: &[f32], vertices: usize) -> Vec<f32> {
        let mut sums = vec![0.0; 3 * vertices];
        for (piece, sums) in sums.chunks_mut(PIECE).enumerate() {
            for (mode, amount) in self.modes.iter().zip(amounts) {
                sums.iter_mut().zip(&mode[piece * PIECE..]).for_each(|(sum, part)| *sum += amount * part);
            }
        }
        sums
    }
}

/// The heading of the smoothed way, and how the body stands off it, for each frame.
fn stances(body: &[BodyFrame], deviation: f64, lever: f64) -> Vec<(f64, [f64; STANCE])> {
    let mut headings: Vec<f64> = Vec::with_capacity(body.len());
    for frame in body {
        let q = frame.rotation;
        let heading = 2.0 * f64::from(q.y).atan2(f64::from(q.w));
        let before = headings.last().copied().unwrap_or(heading);
        headings.push(heading - ((heading - before) / std::f64::consts::TAU).round() * std::f64::consts::TAU);
    }
    let ways: Vec<Vec<f64>> = body
        .iter()
        .zip(&headings)
        .map(|(frame, heading)| frame.centre.as_dvec3().to_array().into_iter().chain([*heading]).collect())
        .collect();
    let smooth = smoothed(&ways, deviation);
    let stance = |(frame, (way, smooth)): (&BodyFrame, (&Vec<f64>, &Vec<f64>))| {
        let heading = smooth[3];
        let yaw = Quat::from_rotation_y(heading as f32);
        let off = Vec3::from_array(std::array::from_fn(|axis| (way[axis] - smooth[axis]) as f32));
        let off = (yaw.inverse() * off).as_dvec3();
        let tilt = Quat::from_rotation_y(way[3] as f32).inverse() * frame.rotation;
        // Both signs are the same rotation; this one is the short way round.
        let tilt = (tilt * tilt.w.signum()).normalize().to_scaled_axis().as_dvec3() * lever;
        (heading, [off.x, off.y, off.z, (way[3] - heading) * lever, tilt.x, tilt.y, tilt.z])
    };
    body.iter().zip(ways.iter().zip(&smooth)).map(stance).collect()
}

/// Coefficients, a row a shape, and modes of shapes, so many that less than `allowed` is missing, in metres.
fn components(mut shapes: Vec<Vec<Vec3>>, areas: &[f32], allowed: f64) -> (Matrix, Vec<Vec<f32>>) {
    let count = shapes.len();
    for vertex in 0..areas.len() {
        let mean = shapes.iter().map(|shape| shape[vertex]).sum::<Vec3>() / count as f32;
        shapes.iter_mut().for_each(|shape| shape[vertex] -= mean);
    }
    // As many vertices as tell how frames are alike.
    let stride = areas.len().div_ceil(LOOKED_AT).max(1);
    let looked: Vec<usize> = (0..areas.len()).step_by(stride).collect();
    let total = looked.iter().map(|&vertex| areas[vertex]).sum::<f32>().max(f32::MIN_POSITIVE);
    let weighted = |row: usize, column: usize| {
        let vertex = looked[column / 3];
        f64::from(shapes[row][vertex][column % 3]) * f64::from(areas[vertex] / total).sqrt()
    };
    let gram = Matrix::from_fn(count, 3 * looked.len(), weighted).gram();
    let found = eigen(gram.values(), count);
    let mut missing: f64 = found.values.iter().filter(|&&value| value > 0.0).sum();
    let mut kept = 0;
    while kept < MOST.min(count - 1) && missing > allowed * allowed * count as f64 && found.values[kept] > 0.0 {
        missing -= found.values[kept];
        kept += 1;
    }
    let coefficients = Matrix::from_fn(count, kept, |row, k| found.vectors[k][row] * found.values[k].sqrt());
    let mode = |k: usize| {
        let mut mode = vec![Vec3::ZERO; areas.len()];
        for (shape, entry) in shapes.iter().zip(&found.vectors[k]) {
            let share = (entry / found.values[k].sqrt()) as f32;
            mode.iter_mut().zip(shape).for_each(|(sum, point)| *sum += *point * share);
        }
        mode.into_iter().flat_map(|point| point.to_array()).collect()
    };
    (coefficients, (0..kept).into_par_iter().map(mode).collect())
}

/// Takes away the mean of each column, and scales all so that they vary by one together; what one is then, or `None` where
/// nothing varies.
fn normalise(rows: &mut Matrix) -> Option<f64> {
    let (n, m) = (rows.rows(), rows.columns());
    for column in 0..m {
        let mean = (0..n).map(|row| rows[(row, column)]).sum::<f64>() / n as f64;
        (0..n).for_each(|row| rows[(row, column)] -= mean);
    }
    let scale = (rows.dot(rows) / n as f64).sqrt();
    if !(scale > 0.0 && scale.is_finite()) {
        return None;
    }
    rows.values_mut().iter_mut().for_each(|value| *value /= scale);
    Some(scale)
}
