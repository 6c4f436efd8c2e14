//! How unlike two frames are, and by which turn they are most alike: all pairs (Prada 2016, section 4 and A.1).
//!
//! D_st(R) = <EDT_s^2, R chi_t> + <chi_s, R EDT_t^2> for a turn R about +Y is a correlation over the angle: a product of
//! frequencies. d_st is its least value.

use std::f32::consts::TAU;

use glam::Vec2;
use rayon::prelude::*;

use super::descriptor::{Complex, Descriptor};

/// Dissimilarities of all pairs of frames, and turns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dissimilarity {
    frames: usize,
    values: Vec<f32>,
    turns: Vec<f32>,
}

impl Dissimilarity {
    /// Of all pairs of `descriptors`, which were made with the same options.
    #[must_use]
    pub fn new(descriptors: &[Descriptor]) -> Self {
        let of = |s: usize, t: usize| least(&correlations(&descriptors[s], &descriptors[t]), angles(&descriptors[s]));
        Self::of_pairs(descriptors.len(), of)
    }

    /// Of windows of `reach` frames to both sides about each frame, weighted by a quintic B-spline (A.1). `sequence` says of
    /// each frame which sequence it belongs to: windows end where that does.
    #[must_use]
    pub fn windowed(descriptors: &[Descriptor], sequence: &[usize], reach: usize) -> Self {
        let kernel = kernel(reach);
        let of = |s: usize, t: usize| {
            let (mut sums, mut share) = (Vec::<Complex>::new(), 0.0);
            for (at, &weight) in kernel.iter().enumerate() {
                let (Some(a), Some(b)) = ((s + at).checked_sub(reach), (t + at).checked_sub(reach)) else { continue };
                let inside = |k: usize, centre: usize| sequence.get(k) == Some(&sequence[centre]);
                if inside(a, s) && inside(b, t) {
                    let found = correlations(&descriptors[a], &descriptors[b]);
                    sums.resize(found.len(), Complex::ZERO);
                    sums.iter_mut().zip(found).for_each(|(sum, found)| *sum += found * weight);
                    share += weight;
                }
            }
            sums.iter_mut().for_each(|sum| *sum /= share);
            least(&sums, angles(&descriptors[s]))
        };
        Self::of_pairs(descriptors.len(), of)
    }

    fn of_pairs(frames: usize, of: impl Fn(usize, usize) -> (f32, f32) + Sync) -> Self {
        let rows: Vec<Vec<(f32, f32)>> =
            (0..frames).into_par_iter().map(|s| (0..=s).map(|t| of(s, t)).collect()).collect();
        let (mut values, mut turns) = (vec![0.0; frames * frames], vec![0.0; frames * frames]);
        for (s, row) in rows.iter().enumerate() {
            for (t, &(value, turn)) in row.iter().enumerate() {
                (values[s * frames + t], turns[s * frames + t]) = (value, turn);
                (values[t * frames + s], turns[t * frames + s]) = (value, -turn);
            }
        }
        Self { frames, values, turns }
    }

    /// Of values without turns, for tests of what follows.
    #[cfg(test)]
    pub(crate) fn of_values(frames: usize, of: impl Fn(usize, usize) -> f32 + Sync) -> Self {
        Self::of_pairs(frames, |s, t| (of(s, t), 0.0))
    }

    /// Of some of the frames alone, in the order in which `frames` names them.
    #[must_use]
    pub fn only(&self, frames: &[usize]) -> Self {
        let of = |values: &[f32]| {
            frames.iter().flat_map(|s| frames.iter().map(move |t| values[s * self.frames + t])).collect()
        };
        Self { frames: frames.len(), values: of(&self.values), turns: of(&self.turns) }
    }

    /// Frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// d_st, square metres on a person.
    #[must_use]
    pub fn get(&self, s: usize, t: usize) -> f32 {
        self.values[s * self.frames + t]
    }

    /// The turn about +Y, in radians, that brings frame `from` to where frame `to` is.
    #[must_use]
    pub fn turn(&self, from: usize, to: usize) -> f32 {
        self.turns[to * self.frames + from]
    }
}

fn angles(descriptor: &Descriptor) -> usize {
    2 * descriptor.options.resolution
}

/// Frequencies of the correlation over the angle by which `t` is turned.
fn correlations(s: &Descriptor, t: &Descriptor) -> Vec<Complex> {
    let cells = s.surface.len() / s.options.frequencies.max(1);
    let product = |a: &[Complex], b: &[Complex]| {
        // Four sums side by side, so that they can be made at once.
        let mut sums = [Complex::ZERO; 4];
        for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
            for k in 0..4 {
                sums[k] += Vec2::new(a[k].dot(b[k]), a[k].y * b[k].x - a[k].x * b[k].y);
            }
        }
        sums[0] + sums[1] + sums[2] + sums[3]
    };
    let of = |f: usize| {
        let range = f * cells..(f + 1) * cells;
        product(&s.distances[range.clone()], &t.surface[range.clone()])
            + product(&s.surface[range.clone()], &t.distances[range])
    };
    (0..s.options.frequencies).map(of).collect()
}

/// The least value over all turns and the turn, from the frequencies.
fn least(frequencies: &[Complex], angles: usize) -> (f32, f32) {
    let value = |turn: f32| {
        let of = |(f, c): (usize, &Complex)| {
            let wave = Vec2::from_angle(TAU * turn * f as f32 / angles as f32);
            // Frequency 0 and the highest of an even number have no twin.
            let twin = if f == 0 || 2 * f == angles { 1.0 } else { 2.0 };
            twin * (c.x * wave.x - c.y * wave.y)
        };
        frequencies.iter().enumerate().map(of).sum::<f32>() / angles as f32
    };
    let values: Vec<f32> = (0..angles).map(|turn| value(turn as f32)).collect();
    let best = (0..angles).min_by(|&a, &b| values[a].total_cmp(&values[b]).then(a.cmp(&b))).unwrap_or(0);
    let beside = |step: usize| values.get((best + step) % angles.max(1)).copied().unwrap_or(0.0);
    let (before, at, after) = (beside(angles - 1), beside(0), beside(1));
    // Between samples, where a parabola through three of them is least.
    let bend = before - 2.0 * at + after;
    let off = if bend > 1e-12 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    let turn = (best as f32 + off) / angles as f32 * TAU;
    (at, if turn > TAU / 2.0 { turn - TAU } else { turn })
}

/// A quintic B-spline over 2 `reach` + 1 frames, which sums to 1.
fn kernel(reach: usize) -> Vec<f32> {
    let power = |x: f64| x.max(0.0).powi(5);
    // The centred cardinal B-spline of order 6 by truncated powers, on [-3, 3].
    let spline = |x: f64| {
        let binomials = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
        binomials.iter().enumerate().map(|(k, b)| b * power(x + 3.0 - k as f64)).sum::<f64>() / 120.0
    };
    let values: Vec<f64> =
        (0..=2 * reach).map(|k| spline((k as f64 - reach as f64) * 3.0 / (reach as f64 + 1.0))).collect();
    let sum: f64 = values.iter().sum();
    values.iter().map(|value| (value / sum) as f32).collect()
}

#[cfg(test)]
mod tests {
    use geometry::mesh::Mesh;
    use glam::{Quat, Vec3};
    use kernels::random::signed;

    use super::*;
    use crate::descriptor::{DescriptorOptions, Grid};
    use crate::surface::Surface;

    /// A body of some random blobs, turned.
    fn body(seed: u64, turn: f32) -> Surface {
        let mut mesh = Mesh::default();
        for blob in 0..5 {
            let random = |k: u64| signed(seed, 10 * blob + k);
            let centre = Vec3::new(0.5 * random(0), 0.8 * random(1), 0.5 * random(2));
            let first = mesh.positions.len() as u32;
            let corners = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
            mesh.positions.extend(corners.map(|c| Quat::from_rotation_y(turn) * (centre + c * 0.2)));
            for [a, b, c] in [[0, 1, 2], [2, 1, 3], [3, 1, 5], [5, 1, 0], [0, 2, 4], [2, 3, 4], [3, 5, 4], [5, 0, 4]] {
                mesh.triangles.push([first + a, first + b, first + c]);
            }
        }
        Surface::new(mesh, None)
    }

    /// D_st of every turn by whole cells, as section 4 has it.
    fn plain(s: &Grid, t: &Grid, angles: usize) -> Vec<f32> {
        let turned = |turn: usize| {
            let mut sum = 0.0;
            for row in (0..s.surface.len()).step_by(angles) {
                for a in 0..angles {
                    let b = (a + angles - turn) % angles;
                    sum += f64::from(s.distances[row + a] * t.surface[row + b]);
                    sum += f64::from(s.surface[row + a] * t.distances[row + b]);
                }
            }
            sum as f32
        };
        (0..angles).map(turned).collect()
    }

    #[test]
    fn frequencies_give_what_the_plain_sum_gives() {
        for farthest in [f32::INFINITY, 0.15] {
            let options = DescriptorOptions { resolution: 16, frequencies: 17, farthest };
            let bodies = [body(1, 0.0), body(1, 1.1), body(2, 0.0)];
            let grids: Vec<Grid> = bodies.iter().map(|body| Grid::new(body, 1.0, &options)).collect();
            let descriptors: Vec<Descriptor> = bodies.iter().map(|body| Descriptor::new(body, 1.0, &options)).collect();
            let found = Dissimilarity::new(&descriptors);
            for s in 0..3 {
                for t in 0..3 {
                    let values = plain(&grids[s], &grids[t], 32);
                    let wanted = values.iter().copied().fold(f32::INFINITY, f32::min);
                    let got = found.get(s, t);
                    assert!((got - wanted).abs() < 1e-4 * wanted.max(1e-2), "{s} {t}: {got} for {wanted}");
                }
            }
        }
    }

    #[test]
    fn turns_are_found_with_their_sign() {
        for turn in [0.0, 0.4, 1.9, -1.2, -2.9] {
            let options = DescriptorOptions::default();
            let of = |turn: f32| Descriptor::new(&body(3, turn), 1.0, &options);
            let found = Dissimilarity::new(&[of(0.0), of(turn)]);
            assert!((found.turn(0, 1) - turn).abs() < 0.06, "{} for {turn}", found.turn(0, 1));
            assert!((found.turn(0, 1) + found.turn(1, 0)).abs() < 1e-6);
        }
    }

    #[test]
    fn windows_are_sums_along_the_diagonal() {
        let options = DescriptorOptions { resolution: 8, frequencies: 9, farthest: 0.15 };
        let descriptors: Vec<Descriptor> = (0..7).map(|k| Descriptor::new(&body(k, 0.0), 1.0, &options)).collect();
        let (sequence, weights) = ([0, 0, 0, 0, 1, 1, 1], kernel(1));
        assert!((weights[0] - weights[2]).abs() < 1e-7 && weights[1] > weights[0]);
        let windowed = Dissimilarity::windowed(&descriptors, &sequence, 1);
        // Frames 1 and 5 have both neighbours within their sequences.
        let mut sums = vec![Complex::ZERO; 9];
        for (k, weight) in weights.iter().enumerate() {
            let found = correlations(&descriptors[k], &descriptors[4 + k]);
            sums.iter_mut().zip(found).for_each(|(sum, found)| *sum += found * *weight);
        }
        assert!((windowed.get(1, 5) - least(&sums, 16).0).abs() < 1e-6);
        assert_eq!(Dissimilarity::windowed(&descriptors, &sequence, 0), Dissimilarity::new(&descriptors));
    }
}
