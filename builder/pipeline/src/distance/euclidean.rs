//! The Euclidean residual of a block of vertices, for comparison with the deformation.

use kernels::lanes::lane_sum;

use super::alignment::{BLOCK, VertexBlock};

/// The weighted sum of squared distances over a block, with j turned about +Y by twice the angle of (`cos`, `sin`).
///
/// Thesis equation 2.2, but with heights, too: both are already centred in the ground plane and scaled by the roots of
/// the weights.
#[inline(always)]
pub(super) fn residual(i: &VertexBlock, j: &VertexBlock, cos: f32, sin: f32) -> f64 {
    let (turn_cos, turn_sin) = (cos.mul_add(cos, -(sin * sin)), 2.0 * cos * sin);
    let mut values = [0.0; BLOCK];
    for v in 0..BLOCK {
        let dx = i.x[v] - turn_cos.mul_add(j.x[v], turn_sin * j.z[v]);
        let dy = i.y[v] - j.y[v];
        let dz = i.z[v] - turn_cos.mul_add(j.z[v], -(turn_sin * j.x[v]));
        values[v] = dx.mul_add(dx, dy.mul_add(dy, dz * dz));
    }
    lane_sum(&values)
}
