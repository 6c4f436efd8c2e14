//! A surface some of whose vertices are held: the ways to find the others that the paper compares.
//!
//! All have one energy, that of edges in cotangent weights ([`Deformer`]). With a [`Basis`] U and a prior it is
//! `sum of w_ij |x_i - x_j - R_ij (q_i - q_j)|^2 + lambda r^T V^-1 r`, `q = p + U r`: equation 7 for displacements of the pose p, its modes
//! weighed by their variances V; rotations R of the surface itself are found in turn with x and r, or are none.

use editing::Deformer;
use editing::deform::Held;
use glam::{Quat, Vec3};
use kernels::cholesky::CholeskyError;
use learn::dense::{Cholesky, Matrix};
use rayon::prelude::*;

use super::basis::Basis;

/// How firmly what nothing holds stays where it is.
const ANCHOR: f32 = 1e-5;

/// A pose whose vertices `held` are to go somewhere.
pub struct Surface<'a> {
    deformer: &'a mut Deformer,
    pose: &'a [Vec3],
    held: Held,
    wanted: Vec<Vec3>,
    still: Vec<Vec3>,
}

impl<'a> Surface<'a> {
    /// The vertices `held` of `pose` are to be where `target` has them.
    pub fn new(
        deformer: &'a mut Deformer,
        pose: &'a [Vec3],
        held: &[u32],
        target: &[Vec3],
    ) -> Result<Self, CholeskyError> {
        let wanted = held.iter().map(|&v| target[v as usize] - pose[v as usize]).collect();
        let held = deformer.hold(pose, held, ANCHOR)?;
        Ok(Self { deformer, pose, held, wanted, still: vec![Vec3::ZERO; pose.len()] })
    }

    /// Differential coordinates as they are (equation 4), and as rigid as possible after so many iterations.
    pub fn rigid(&mut self, iterations: usize) -> Result<Vec<Vec3>, CholeskyError> {
        let mut turns = vec![Quat::IDENTITY; self.pose.len()];
        let mut moved = self.displaced(self.pose, &turns, &self.wanted.clone())?;
        for _ in 0..iterations {
            turns = self.deformer.turns(&self.held, self.pose, &moved);
            moved = self.displaced(self.pose, &turns, &self.wanted.clone())?;
        }
        Ok(self.pose.iter().zip(&moved).map(|(point, moved)| *point + *moved).collect())
    }

    /// Equation 7 with the prior's weight `lambda`, after so many iterations of rotations.
    pub fn learned(&mut self, basis: &Basis, lambda: f64, iterations: usize) -> Result<Vec<Vec3>, CholeskyError> {
        let mut turns = vec![Quat::IDENTITY; self.pose.len()];
        let mut found = self.least(basis, lambda, &turns)?;
        for _ in 0..iterations {
            let (at, rest) = &found;
            let moved: Vec<Vec3> = at.iter().zip(rest).map(|(at, rest)| *at - *rest).collect();
            turns = self.deformer.turns(&self.held, rest, &moved);
            found = self.least(basis, lambda, &turns)?;
        }
        Ok(found.0)
    }

    /// The surface of least energy for these rotations, and what it would be if nothing held it: x and q.
    fn least(&mut self, basis: &Basis, lambda: f64, turns: &[Quat]) -> Result<(Vec<Vec3>, Vec<Vec3>), CholeskyError> {
        let own = self.solved(self.pose, turns, &self.wanted.clone())?;
        let mut fields = Vec::with_capacity(basis.modes.len());
        for mode in &basis.modes {
            // What is held has no part in a mode.
            let back: Vec<Vec3> = self.held.vertices().iter().map(|&v| -mode[v as usize]).collect();
            fields.push(self.solved(mode, turns, &back)?);
        }
        let misses = self.misses(self.pose, &own, turns);
        let of_modes: Vec<Vec<Vec3>> =
            (0..fields.len()).into_par_iter().map(|k| self.misses(&basis.modes[k], &fields[k], turns)).collect();
        let product = |a: &[Vec3], b: &[Vec3]| {
            let parts = self.held.weights().iter().zip(a).zip(b);
            parts.map(|((weight, a), b)| f64::from(weight * a.dot(*b))).sum::<f64>()
        };
        let count = fields.len();
        let all: Vec<f64> = (0..count * count)
            .into_par_iter()
            .map(|at| product(&of_modes[at / count], &of_modes[at % count]))
            .collect();
        let normal = Matrix::from_fn(count, count, |a, b| {
            all[a * count + b] + if a == b { lambda / basis.variances[a] } else { 0.0 }
        });
        let right = Matrix::from_fn(count, 1, |k, _| -product(&of_modes[k], &misses));
        let shares = Cholesky::of(&normal).map(|factor| factor.solve(&right));
        let (mut at, mut rest) = (own, self.pose.to_vec());
        if let Some(shares) = shares {
            for (k, (field, mode)) in fields.iter().zip(&basis.modes).enumerate() {
                let share = shares[(k, 0)] as f32;
                at.iter_mut().zip(field).for_each(|(at, field)| *at += *field * share);
                rest.iter_mut().zip(mode).for_each(|(rest, mode)| *rest += *mode * share);
            }
        }
        Ok((at, rest))
    }

    /// `pose` with what is held displaced by `wanted`, its edges turned.
    fn solved(&mut self, pose: &[Vec3], turns: &[Quat], wanted: &[Vec3]) -> Result<Vec<Vec3>, CholeskyError> {
        let moved = self.displaced(pose, turns, wanted)?;
        Ok(pose.iter().zip(moved).map(|(point, moved)| *point + moved).collect())
    }

    fn displaced(&mut self, pose: &[Vec3], turns: &[Quat], wanted: &[Vec3]) -> Result<Vec<Vec3>, CholeskyError> {
        self.deformer.solve(&self.held, pose, turns, &self.still, wanted)
    }

    /// For each edge what `at` misses of that of `rest`, turned.
    fn misses(&self, rest: &[Vec3], at: &[Vec3], turns: &[Quat]) -> Vec<Vec3> {
        let edge = |&[i, j]: &[u32; 2]| {
            let (i, j) = (i as usize, j as usize);
            let turned = rest[i] - rest[j];
            at[i] - at[j] - 0.5 * (turns[i] * turned + turns[j] * turned)
        };
        self.deformer.edges().iter().map(edge).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::topology::Topology;

    /// A strip of quads along X.
    fn strip(count: u32) -> (Topology, Vec<Vec3>) {
        let pose = (0..2 * count).map(|v| Vec3::new((v / 2) as f32 * 0.1, 0.0, (v % 2) as f32 * 0.1)).collect();
        let quads = (0..count - 1).flat_map(|k| [[2 * k, 2 * k + 1, 2 * k + 2], [2 * k + 1, 2 * k + 3, 2 * k + 2]]);
        (Topology::new(2 * count, quads.collect(), vec![1.0; 2 * count as usize]).unwrap(), pose)
    }

    #[test]
    fn a_pose_of_the_space_is_found_from_its_handles() {
        let (topology, pose) = strip(20);
        let bent = |amount: f32| -> Vec<Vec3> { pose.iter().map(|p| *p + Vec3::Y * amount * p.x * p.x).collect() };
        let poses = [bent(0.0), bent(0.1), bent(0.2), bent(-0.1)];
        let basis = Basis::of(&poses, &[true; 40], 4);
        assert_eq!(basis.modes.len(), 1, "there is one way to bend");
        let target = bent(0.3);
        let mut deformer = Deformer::new(&topology, None).unwrap();
        let held = [0, 1, 38, 39];
        let mut surface = Surface::new(&mut deformer, &pose, &held, &target).unwrap();
        let off = |found: &[Vec3]| found.iter().zip(&target).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        let learned = surface.learned(&basis, 1e-9, 0).unwrap();
        let plain = surface.rigid(0).unwrap();
        assert!(off(&learned) < 2e-3 && off(&plain) > 0.05, "{} {}", off(&learned), off(&plain));
        // Nothing wanted is nothing moved.
        let mut still = Surface::new(&mut deformer, &pose, &held, &pose).unwrap();
        for found in [still.learned(&basis, 1e-3, 3).unwrap(), still.rigid(2).unwrap()] {
            found.iter().zip(&pose).for_each(|(a, b)| assert!(a.distance(*b) < 1e-4));
        }
    }
}
