//! Triangles in batches of eight, as the vector code takes them.

use glam::{Vec3, Vec4};

use crate::lanes::{LANES, Lanes3};

/// All triangles of a topology, eight by eight.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TriangleBatches {
    batches: Vec<Batch>,
    triangle_count: usize,
}

/// Eight triangles: their first, second and third corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Batch {
    corners: [[u32; LANES]; 3],
}

impl TriangleBatches {
    /// The batches of `triangles`; the last one is filled up with points, which have no area and hence no weight.
    #[must_use]
    pub fn new(triangles: &[[u32; 3]]) -> Self {
        let batches = triangles
            .chunks(LANES)
            .map(|chunk| {
                let mut corners = [[0; LANES]; 3];
                for (lane, triangle) in chunk.iter().enumerate() {
                    for corner in 0..3 {
                        corners[corner][lane] = triangle[corner];
                    }
                }
                Batch { corners }
            })
            .collect();
        Self { batches, triangle_count: triangles.len() }
    }

    /// The batches, in the order of the triangles.
    #[must_use]
    pub fn batches(&self) -> &[Batch] {
        &self.batches
    }

    /// Number of triangles M, without the filling.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangle_count
    }
}

impl Batch {
    /// Corners by corner, then by lane.
    #[must_use]
    pub fn corners(&self) -> &[[u32; LANES]; 3] {
        &self.corners
    }

    /// Edges of a pose from the first corner to the second and to the third.
    #[inline(always)]
    pub(crate) fn edges(&self, pose: &[Vec3]) -> [Lanes3; 2] {
        self.edges_of(|vertex| pose[vertex as usize].extend(0.0))
    }

    /// Edges of positions held four by four, as [`Self::edges`].
    #[inline(always)]
    pub(crate) fn edges4(&self, positions: &[Vec4]) -> [Lanes3; 2] {
        self.edges_of(|vertex| positions[vertex as usize])
    }

    #[inline(always)]
    fn edges_of(&self, position: impl Fn(u32) -> Vec4) -> [Lanes3; 2] {
        let (mut first, mut second) = ([Vec4::ZERO; LANES], [Vec4::ZERO; LANES]);
        for lane in 0..LANES {
            let start = position(self.corners[0][lane]);
            first[lane] = position(self.corners[1][lane]) - start;
            second[lane] = position(self.corners[2][lane]) - start;
        }
        [Lanes3::of(&first), Lanes3::of(&second)]
    }
}
