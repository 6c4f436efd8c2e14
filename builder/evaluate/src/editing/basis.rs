//! The learned space of Tejera, Casas and Hilton (2013), section III-B: principal components of aligned poses.

use glam::{Vec3, Vec3Swizzles};
use kernels::align::{align_heading, centre_of_mass, rotate};
use learn::symmetric::eigen;
use rayon::prelude::*;

/// Modes of the position of all vertices.
pub struct Basis {
    /// Displacements of all vertices, of length 1 together.
    pub modes: Vec<Vec<Vec3>>,
    /// The variance of each mode's coefficient over the poses, in square metres.
    pub variances: Vec<f64>,
}

impl Basis {
    /// The first `count` components of `poses`; of the vertices of which `inside` is true alone.
    pub fn of(poses: &[Vec<Vec3>], inside: &[bool], count: usize) -> Self {
        let n = poses.len();
        let Some(vertices) = poses.first().map(Vec::len) else {
            return Self { modes: Vec::new(), variances: Vec::new() };
        };
        let mean: Vec<Vec3> =
            (0..vertices).map(|v| poses.iter().map(|pose| pose[v]).sum::<Vec3>() / n as f32).collect();
        let off = |pose: &[Vec3]| -> Vec<Vec3> {
            (0..vertices).map(|v| if inside[v] { pose[v] - mean[v] } else { Vec3::ZERO }).collect()
        };
        let rows: Vec<Vec<Vec3>> = poses.par_iter().map(|pose| off(pose)).collect();
        let product = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| f64::from(a.dot(*b))).sum::<f64>();
        let gram: Vec<f64> = (0..n * n).into_par_iter().map(|at| product(&rows[at / n], &rows[at % n])).collect();
        let found = eigen(&gram, n);
        let kept = found.values.iter().take(count).take_while(|&&value| value > 1e-7 * found.values[0]).count();
        let mode = |k: usize| -> Vec<Vec3> {
            let scale = 1.0 / found.values[k].sqrt();
            let weights: Vec<f32> = found.vectors[k].iter().map(|weight| (weight * scale) as f32).collect();
            (0..vertices).map(|v| rows.iter().zip(&weights).map(|(row, &weight)| row[v] * weight).sum()).collect()
        };
        Self {
            modes: (0..kept).into_par_iter().map(mode).collect(),
            variances: found.values[..kept].iter().map(|value| value / n as f64).collect(),
        }
    }

    /// Both bases in one.
    pub fn with(mut self, other: Self) -> Self {
        self.modes.extend(other.modes);
        self.variances.extend(other.variances);
        self
    }
}

/// `pose`, turned and moved over the ground onto `onto`.
pub fn aligned(onto: &[Vec3], pose: &[Vec3], weights: &[f32]) -> Vec<Vec3> {
    let turn = align_heading(onto, pose, weights);
    let to = centre_of_mass(onto, weights).xz() - rotate(turn, centre_of_mass(pose, weights).xz());
    let moved = |point: &Vec3| {
        let ground = rotate(turn, point.xz()) + to;
        Vec3::new(ground.x, point.y, ground.y)
    };
    pose.iter().map(moved).collect()
}

/// Root of the mean square distance of the vertices `of`, in metres.
pub fn apart(a: &[Vec3], b: &[Vec3], of: &[u32]) -> f64 {
    let sum: f64 = of.iter().map(|&v| f64::from(a[v as usize].distance_squared(b[v as usize]))).sum();
    (sum / of.len().max(1) as f64).sqrt()
}
