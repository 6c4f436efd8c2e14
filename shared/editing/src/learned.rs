//! A surface that moves as its capture was seen to (Tejera et al. (2013), equation 7), with rotations.
//!
//! With the modes U of a [`crate::space::Space`], least is
//! `sum of w_ij |x_i - x_j - R_ij (q_i - q_j)|^2 + sum of a |x_i - q_i|^2 + lambda r^T V^-1 r`, `q = p + U r`: the edges are those of
//! the pose p moved by modes, each turned as its ends are; V are the modes' variances. What is held goes where it is wanted.
//!
//! For rotations that stay, x and r are linear in what is wanted. A mode whose held vertices have no part in it misses some of its
//! edges; what it misses pulls at the held vertices alone (`levers`), for elsewhere the surface is at rest. So the system for r, of one
//! row a mode, is made of what the levers say, and a drag is one small system and one solve of the surface. Rotations are found in
//! turn with that, and the system is made anew for them where there is time.

use glam::{Mat3, Quat, Vec3};
use kernels::cholesky::CholeskyError;

use crate::deform::{Deformer, Held};
use crate::dense::solve_dense;

/// The prior's weight in square metres: lambda. Chosen by held-out frames (`docs/results`).
pub const PRIOR: f64 = 1e-4;
/// Modes that are solved for at once: three numbers each, four at a time.
const ABREAST: usize = 4;
/// Steps by which a rotation is followed.
const TURN_STEPS: usize = 2;

/// A pose that moves by modes.
pub(crate) struct Learned {
    modes: Vec<Vec<Vec3>>,
    variances: Vec<f64>,
    /// The modes of the held vertices alone.
    held_modes: Vec<Vec<Vec3>>,
    prior: f64,
    /// What holds the held vertices against each mode, for the rotations of [`Self::prepare`].
    levers: Vec<Vec<Vec3>>,
    /// What those rotations alone ask of each mode.
    turned: Vec<f64>,
    normal: Vec<f64>,
    turns: Vec<Quat>,
    /// r, as it was found last.
    shares: Vec<f64>,
    /// U r.
    rest: Vec<Vec3>,
}

/// A system that is being made.
pub(crate) struct System {
    /// As [`changes`] has them.
    changes: Option<Vec<Mat3>>,
    /// The first mode that is not in it yet.
    first: usize,
}

impl Learned {
    /// A pose of `count` vertices of which `held` is held, by `modes` as it faces. Its system is made by [`Self::prepare`], or by a descent.
    pub(crate) fn new(held: &Held, count: usize, (modes, variances): (Vec<Vec<Vec3>>, Vec<f64>), prior: f64) -> Self {
        let of_held = |mode: &Vec<Vec3>| held.vertices().iter().map(|&v| mode[v as usize]).collect();
        Self {
            held_modes: modes.iter().map(of_held).collect(),
            modes,
            variances,
            prior,
            levers: Vec::new(),
            turned: Vec::new(),
            normal: Vec::new(),
            turns: vec![Quat::IDENTITY; count],
            shares: Vec::new(),
            rest: vec![Vec3::ZERO; count],
        }
    }

    /// How each vertex is turned.
    pub(crate) fn turns(&self) -> &[Quat] {
        &self.turns
    }

    /// What the modes move each vertex by.
    pub(crate) fn rest(&self) -> &[Vec3] {
        &self.rest
    }

    /// Weighs the prior otherwise from now on, in square metres.
    pub(crate) fn set_prior(&mut self, prior: f64) {
        let count = self.modes.len();
        // A system that is there has it on its diagonal.
        let there = if self.normal.is_empty() { 0 } else { self.levers.len() };
        for (k, variance) in self.variances.iter().enumerate().take(there) {
            self.normal[k * count + k] += (prior - self.prior) / variance;
        }
        self.prior = prior;
    }

    /// Nothing is turned.
    pub(crate) fn begin(&mut self) {
        self.turns.fill(Quat::IDENTITY);
    }

    /// Turns and what modes move, as they were found.
    pub(crate) fn take(&mut self, turns: Vec<Quat>, rest: Vec<Vec3>) {
        (self.turns, self.rest) = (turns, rest);
    }

    /// Back to the pose that was grabbed.
    pub(crate) fn still(&mut self, deformer: &mut Deformer, held: &Held, pose: &[Vec3]) -> Result<(), CholeskyError> {
        let was_turned = self.turns.iter().any(|turn| *turn != Quat::IDENTITY);
        self.turns.fill(Quat::IDENTITY);
        self.rest.fill(Vec3::ZERO);
        if was_turned && self.turned.iter().any(|turned| *turned != 0.0) {
            self.prepare(deformer, held, pose)?;
        }
        Ok(())
    }

    /// Makes the system for the rotations as they are now.
    pub(crate) fn prepare(&mut self, deformer: &mut Deformer, held: &Held, pose: &[Vec3]) -> Result<(), CholeskyError> {
        let mut system = self.begin_system(deformer);
        while !self.add_some(&mut system, deformer, held, pose)? {}
        Ok(())
    }

    /// A system that no mode is in yet, for the rotations as they are now.
    pub(crate) fn begin_system(&mut self, deformer: &Deformer) -> System {
        self.levers.clear();
        self.turned.clear();
        self.normal = vec![0.0; self.modes.len() * self.modes.len()];
        System { changes: changes(deformer, &self.turns), first: 0 }
    }

    /// Adds the next few modes; whether all are there.
    pub(crate) fn add_some(
        &mut self,
        system: &mut System,
        deformer: &mut Deformer,
        held: &Held,
        pose: &[Vec3],
    ) -> Result<bool, CholeskyError> {
        let end = (system.first + ABREAST).min(self.modes.len());
        if system.first == end {
            return Ok(true);
        }
        let changes = system.changes.as_deref();
        let moved = deformer.fields(held, &self.modes[system.first..end], changes)?;
        for (k, moved) in (system.first..).zip(moved) {
            self.add(deformer, held, pose, (k, &moved), changes);
        }
        system.first = end;
        Ok(end == self.modes.len())
    }

    /// What mode `k` adds to the system: `moved` is what solves for it, beside the mode itself.
    fn add(
        &mut self,
        deformer: &Deformer,
        held: &Held,
        pose: &[Vec3],
        (k, moved): (usize, &[Vec3]),
        changes: Option<&[Mat3]>,
    ) {
        let mode = &self.modes[k];
        let mut pulls: Vec<Vec3> = moved.iter().map(|&moved| moved * held.anchor()).collect();
        let mut turned_back = pulls.clone();
        let mut turned = 0.0;
        for (edge, (&[i, j], &weight)) in deformer.edges().iter().zip(held.weights()).enumerate() {
            let (i, j) = (i as usize, j as usize);
            let mut missed = moved[i] - moved[j];
            let change = changes.map(|changes| changes[edge]);
            if let Some(change) = change {
                missed -= change * (mode[i] - mode[j]);
            }
            missed *= weight;
            pulls[i] += missed;
            pulls[j] -= missed;
            if let Some(change) = change {
                let back = missed + change.transpose() * missed;
                turned_back[i] += back;
                turned_back[j] -= back;
                turned += f64::from(missed.dot(change * (pose[i] - pose[j])));
            }
        }
        let count = self.modes.len();
        let at_held = |field: &[Vec3]| -> Vec<Vec3> { held.vertices().iter().map(|&v| field[v as usize]).collect() };
        let levers = at_held(&pulls);
        for other in 0..=k {
            self.normal[k * count + other] = -match changes {
                Some(_) => product(&self.modes[other], &turned_back),
                // Where nothing turns only what is held pulls.
                None => product(&self.held_modes[other], &levers),
            };
        }
        self.normal[k * count + k] += self.prior / self.variances[k];
        self.levers.push(levers);
        self.turned.push(turned);
    }

    /// Drags what is held by `wanted`; displacements of all vertices after one iteration.
    pub(crate) fn pull(
        &mut self,
        deformer: &mut Deformer,
        held: &Held,
        pose: &[Vec3],
        wanted: &[Vec3],
    ) -> Result<Vec<Vec3>, CholeskyError> {
        self.iterate(deformer, held, pose, wanted, true)
    }

    /// What is least, for the rotations and modes as they are.
    pub(crate) fn energy(&self, deformer: &Deformer, held: &Held, pose: &[Vec3], displacements: &[Vec3]) -> f64 {
        let mut sum = 0.0;
        for (&[i, j], &weight) in deformer.edges().iter().zip(held.weights()) {
            let (i, j) = (i as usize, j as usize);
            let rest = (pose[i] + self.rest[i]) - (pose[j] + self.rest[j]);
            let turned = 0.5 * (self.turns[i] * rest + self.turns[j] * rest);
            let missed = pose[i] - pose[j] + (displacements[i] - displacements[j]) - turned;
            sum += f64::from(weight * missed.length_squared());
        }
        let costs = self.shares.iter().zip(&self.variances).map(|(share, variance)| share * share / variance);
        sum + self.prior * costs.sum::<f64>()
    }

    /// Modes, then the surface, then its rotations.
    pub(crate) fn iterate(
        &mut self,
        deformer: &mut Deformer,
        held: &Held,
        pose: &[Vec3],
        wanted: &[Vec3],
        with_modes: bool,
    ) -> Result<Vec<Vec3>, CholeskyError> {
        let right: Vec<f64> =
            self.levers.iter().zip(&self.turned).map(|(levers, turned)| turned - product(levers, wanted)).collect();
        // A system that cannot be solved leaves the modes out: as rigid as possible.
        let found = if with_modes { solve_dense(&self.normal, &right, 0.0) } else { None };
        let shares = found.unwrap_or_default();
        self.shares.clone_from(&shares);
        self.rest.fill(Vec3::ZERO);
        for (mode, &share) in self.modes.iter().zip(&shares) {
            let share = share as f32;
            self.rest.iter_mut().zip(mode).for_each(|(rest, &mode)| *rest += mode * share);
        }
        let by_modes: Vec<Vec3> = pose.iter().zip(&self.rest).map(|(&point, &rest)| point + rest).collect();
        let vertices = held.vertices().iter().zip(wanted);
        let left: Vec<Vec3> = vertices.map(|(&v, &wanted)| wanted - self.rest[v as usize]).collect();
        let told = vec![Vec3::ZERO; pose.len()];
        let mut displacements = deformer.solve(held, &by_modes, &self.turns, &told, &left)?;
        deformer.follow(held, &by_modes, &displacements, &mut self.turns, TURN_STEPS);
        displacements.iter_mut().zip(&self.rest).for_each(|(moved, &rest)| *moved += rest);
        for (&vertex, &wanted) in held.vertices().iter().zip(wanted) {
            displacements[vertex as usize] = wanted;
        }
        Ok(displacements)
    }
}

/// For each edge how its ends' mean turn differs from none; nothing where nothing turns.
fn changes(deformer: &Deformer, turns: &[Quat]) -> Option<Vec<Mat3>> {
    if turns.iter().all(|turn| *turn == Quat::IDENTITY) {
        return None;
    }
    let matrices: Vec<Mat3> = turns.iter().map(|&turn| Mat3::from_quat(turn)).collect();
    let mean = |&[i, j]: &[u32; 2]| (matrices[i as usize] + matrices[j as usize]) * 0.5 - Mat3::IDENTITY;
    Some(deformer.edges().iter().map(mean).collect())
}

/// The sum of products, four sums abreast in a fixed order.
fn product(a: &[Vec3], b: &[Vec3]) -> f64 {
    let mut sums = [0.0_f64; 4];
    for (a, b) in a.chunks(4).zip(b.chunks(4)) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += f64::from(a.dot(*b));
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

#[cfg(test)]
#[path = "learned/tests.rs"]
mod tests;
