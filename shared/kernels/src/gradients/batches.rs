//! Triangles in batches of eight, as the vector code takes them.

use glam::Vec3;

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
        let mut first = Lanes3::default();
        let mut second = Lanes3::default();
        for lane in 0..LANES {
            let [a, b, c] = [0, 1, 2].map(|corner| pose[self.corners[corner][lane] as usize]);
            first.x.0[lane] = b.x - a.x;
            first.y.0[lane] = b.y - a.y;
            first.z.0[lane] = b.z - a.z;
            second.x.0[lane] = c.x - a.x;
            second.y.0[lane] = c.y - a.y;
            second.z.0[lane] = c.z - a.z;
        }
        [first, second]
    }

    /// Edges of positions held four by four, as [`Self::edges`].
    #[inline(always)]
    pub(crate) fn edges4(&self, positions: &[glam::Vec4]) -> [Lanes3; 2] {
        let mut first = Lanes3::default();
        let mut second = Lanes3::default();
        for lane in 0..LANES {
            let [a, b, c] = [0, 1, 2].map(|corner| positions[self.corners[corner][lane] as usize]);
            let (b, c) = (b - a, c - a);
            first.x.0[lane] = b.x;
            first.y.0[lane] = b.y;
            first.z.0[lane] = b.z;
            second.x.0[lane] = c.x;
            second.y.0[lane] = c.y;
            second.z.0[lane] = c.z;
        }
        [first, second]
    }
}
