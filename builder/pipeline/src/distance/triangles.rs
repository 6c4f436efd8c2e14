//! What the pose distance needs to know of each triangle in each frame.
//!
//! A triangle's frame has its x axis along an edge and its z axis along the normal. Both edges from the triangle's
//! first corner then lie in the plane, as the columns of the upper triangular matrix P = [a b; 0 c] with a, c > 0.

use glam::{DMat3, DQuat, DVec3, Vec3};

/// Triangles of a block.
pub(super) const BLOCK: usize = 128;

/// A triangle is degenerate where its area is below this, times the mean of its frame.
pub(super) const DEGENERATE: f64 = 1e-12;

/// Some triangles of a frame, as a structure of arrays.
#[derive(Clone)]
pub(super) struct TriangleBlock {
    /// The triangle's frame, `world_from_triangle`, as a unit quaternion.
    pub(super) w: [f32; BLOCK],
    pub(super) x: [f32; BLOCK],
    pub(super) y: [f32; BLOCK],
    pub(super) z: [f32; BLOCK],
    /// The in-plane edges P.
    pub(super) a: [f32; BLOCK],
    pub(super) b: [f32; BLOCK],
    pub(super) c: [f32; BLOCK],
    /// 1 / a and 1 / c.
    pub(super) inverse_a: [f32; BLOCK],
    pub(super) inverse_c: [f32; BLOCK],
    /// ln det P.
    pub(super) log_det: [f32; BLOCK],
}

impl TriangleBlock {
    /// `triangles`, at most [`BLOCK`], none degenerate, in `pose`. The rest of the block does not deform.
    pub(super) fn new(triangles: &[[u32; 3]], pose: &[Vec3]) -> Self {
        let (zero, one) = ([0.0; BLOCK], [1.0; BLOCK]);
        let mut block = Self {
            w: one,
            x: zero,
            y: zero,
            z: zero,
            a: one,
            b: zero,
            c: one,
            inverse_a: one,
            inverse_c: one,
            log_det: zero,
        };
        for (m, &corners) in triangles.iter().enumerate().take(BLOCK) {
            block.set(m, corners.map(|vertex| pose[vertex as usize].as_dvec3()));
        }
        block
    }

    fn set(&mut self, m: usize, [p, q, r]: [DVec3; 3]) {
        let (first, second) = (q - p, r - p);
        let a = first.length();
        let x_axis = first / a;
        let z_axis = first.cross(second).normalize();
        let y_axis = z_axis.cross(x_axis);
        let (b, c) = (second.dot(x_axis), second.dot(y_axis));
        let frame = DQuat::from_mat3(&DMat3::from_cols(x_axis, y_axis, z_axis));
        (self.w[m], self.x[m], self.y[m], self.z[m]) = (frame.w as f32, frame.x as f32, frame.y as f32, frame.z as f32);
        (self.a[m], self.b[m], self.c[m]) = (a as f32, b as f32, c as f32);
        (self.inverse_a[m], self.inverse_c[m]) = ((1.0 / a) as f32, (1.0 / c) as f32);
        self.log_det[m] = (a * c).ln() as f32;
    }
}

/// Areas of `triangles` in `pose`.
pub(super) fn areas(triangles: &[[u32; 3]], pose: &[Vec3]) -> Vec<f64> {
    let area = |corners: &[u32; 3]| {
        let [p, q, r] = corners.map(|vertex| pose[vertex as usize].as_dvec3());
        (q - p).cross(r - p).length() / 2.0
    };
    triangles.iter().map(area).collect()
}

/// `corners`, turned so that the edge along the x axis is the shortest one of `pose`: P is then as far from singular
/// as the triangle allows.
pub(super) fn turned_to_shortest_edge(corners: [u32; 3], pose: &[Vec3]) -> [u32; 3] {
    let length = |k: usize| pose[corners[k] as usize].distance_squared(pose[corners[(k + 1) % 3] as usize]);
    let mut first = 0;
    for k in 1..3 {
        if length(k) < length(first) {
            first = k;
        }
    }
    [corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]]
}
