//! What several tests share: comparisons.
#![allow(dead_code, reason = "each test binary uses its part")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

pub mod exact;
pub mod meshes;

use glam::{DVec3, Vec3, Vec3Swizzles};
use kernels::align::{Placement, align_heading, centre_of_mass};
use kernels::topology::Topology;

/// `moving`, turned and moved to lie best on `fixed`.
pub fn aligned(topology: &Topology, fixed: &[Vec3], moving: &[Vec3]) -> Vec<Vec3> {
    let heading = align_heading(fixed, moving, topology.weights());
    let [from, to] = [moving, fixed].map(|pose| centre_of_mass(pose, topology.weights()));
    let mut out = moving.to_vec();
    Placement::turning(heading, from.xz(), to.xz()).apply_all(&mut out);
    out
}

/// Largest distance between corresponding vertices.
pub fn largest_difference(a: &[Vec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.as_dvec3().distance(*b)).fold(0.0, f64::max)
}
