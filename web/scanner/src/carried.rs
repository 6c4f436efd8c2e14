//! How the registered mesh carries a scanned frame: each vertex lies over the nearest triangle that faces as it does.

use actor::carry::{Carried, Surface};
use glam::Vec3;

/// Cells along the longest side of the body: less where its triangles are large.
const CELLS: [f32; 4] = [64.0, 16.0, 4.0, 1.0];
/// Cells that a triangle touches on average at most.
const TOUCHED: usize = 16;
/// Triangles that are looked at for a point, on average, and for all at least: more than ever in a body, so that a damaged one cannot keep
/// the page busy.
const LOOKS: (usize, usize) = (2000, 1 << 22);
/// How many times as far away a triangle counts that faces away from the vertex: the other side of what is thin, or another limb.
const AWAY: f32 = 4.0;

/// How the mesh of `triangles` at `pose` carries each of `points`, which face as `normals` say; empty where there is nothing to carry them.
#[must_use]
pub fn carried(triangles: &[[u32; 3]], pose: &[Vec3], points: &[Vec3], normals: &[Vec3]) -> Vec<Carried> {
    let surface = Surface::new(triangles, pose);
    let grid = CELLS.into_iter().find_map(|cells| Grid::new(&surface, triangles.len(), pose, cells));
    let Some(grid) = grid else { return Vec::new() };
    let mut looks = points.len().saturating_mul(LOOKS.0).max(LOOKS.1);
    let mut found = Vec::with_capacity(points.len());
    for (&point, &normal) in points.iter().zip(normals) {
        let Some((number, foot)) = grid.nearest(&surface, (point, normal), &mut looks) else { return Vec::new() };
        found.extend(surface.carry(point, number, foot));
    }
    found
}

/// Triangles by the cells that the boxes around them touch.
struct Grid {
    low: Vec3,
    side: f32,
    count: [usize; 3],
    /// Where the triangles of each cell begin in `triangles`; one more than there are cells.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Grid {
    fn new(surface: &Surface<'_>, triangles: usize, pose: &[Vec3], cells: f32) -> Option<Self> {
        let low = pose.iter().fold(Vec3::INFINITY, |low, &p| low.min(p));
        let high = pose.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
        let extent = high - low;
        if !extent.is_finite() || extent.max_element() <= 0.0 || triangles == 0 {
            return None;
        }
        let side = extent.max_element() / cells;
        let count = (extent / side).to_array().map(|cells| cells as usize + 1);
        let mut grid =
            Self { low, side, count, starts: vec![0; count.iter().product::<usize>() + 1], triangles: Vec::new() };
        let mut touched = 0;
        for number in 0..triangles {
            grid.each_cell(surface, number, |grid, cell| {
                grid.starts[cell + 1] += 1;
                touched += 1;
            });
            if cells > 1.0 && touched > TOUCHED * triangles {
                return None;
            }
        }
        for cell in 1..grid.starts.len() {
            grid.starts[cell] += grid.starts[cell - 1];
        }
        let mut next = grid.starts.clone();
        grid.triangles = vec![0; grid.starts.last().map_or(0, |&all| all as usize)];
        for number in 0..triangles {
            grid.each_cell(surface, number, |grid, cell| {
                grid.triangles[next[cell] as usize] = number as u32;
                next[cell] += 1;
            });
        }
        Some(grid)
    }

    fn each_cell(&mut self, surface: &Surface<'_>, number: usize, mut take: impl FnMut(&mut Self, usize)) {
        let Some([a, b, c]) = surface.corners(number) else { return };
        let (from, to) = (self.cell(a.min(b).min(c)), self.cell(a.max(b).max(c)));
        for x in from[0]..=to[0] {
            for y in from[1]..=to[1] {
                for z in from[2]..=to[2] {
                    take(self, self.number([x, y, z]));
                }
            }
        }
    }

    /// The cell of a point, the nearest one where it lies outside.
    fn cell(&self, point: Vec3) -> [usize; 3] {
        let place = ((point - self.low) / self.side).to_array();
        std::array::from_fn(|axis| (place[axis].max(0.0) as usize).min(self.count[axis] - 1))
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.count[1] + y) * self.count[2] + z
    }

    /// The triangle nearest to `point`, and its nearest point; what faces away from `normal` counts as farther. `None` where there is none,
    /// or more were looked at than `looks`.
    fn nearest(
        &self,
        surface: &Surface<'_>,
        (point, normal): (Vec3, Vec3),
        looks: &mut usize,
    ) -> Option<(u32, [f32; 2])> {
        let mut best: Option<(f32, u32, [f32; 2])> = None;
        let middle = self.cell(point);
        let most = self.count.into_iter().max().unwrap_or(1);
        for ring in 0..=most {
            // What lies beyond the rings that were looked at is farther away than this, also from a point outside of the grid.
            let seen = ring.saturating_sub(1) as f32 * self.side;
            if best.is_some_and(|(far, ..)| far <= seen) || *looks == 0 {
                break;
            }
            self.each_of_ring(middle, ring, |number| {
                let Some([a, b, c]) = surface.corners(number as usize) else { return };
                *looks = looks.saturating_sub(1);
                let foot = foot_in(point, [a, b, c]);
                let near = a * (1.0 - foot[0] - foot[1]) + b * foot[0] + c * foot[1];
                let away = (b - a).cross(c - a).dot(normal) < 0.0;
                let far = near.distance(point) * if away { AWAY } else { 1.0 };
                // Of equally near ones the first.
                if best.is_none_or(|(least, first, _)| far < least || (far == least && number < first)) {
                    best = Some((far, number, foot));
                }
            });
        }
        best.filter(|_| *looks > 0).map(|(_, number, foot)| (number, foot))
    }

    fn each_of_ring(&self, middle: [usize; 3], ring: usize, mut take: impl FnMut(u32)) {
        let range = |axis: usize| middle[axis].saturating_sub(ring)..=(middle[axis] + ring).min(self.count[axis] - 1);
        let edge = |axis: usize, at: usize| at.abs_diff(middle[axis]) == ring;
        for x in range(0) {
            for y in range(1) {
                let on_side = edge(0, x) || edge(1, y);
                for z in range(2).filter(|&z| on_side || edge(2, z)) {
                    let cell = self.number([x, y, z]);
                    let (start, end) = (self.starts[cell] as usize, self.starts[cell + 1] as usize);
                    self.triangles[start..end].iter().for_each(|&number| take(number));
                }
            }
        }
    }
}

/// Barycentric coordinates of the point of triangle (a, b, c) that is nearest to `p`: those of the second and third corner.
fn foot_in(p: Vec3, [a, b, c]: [Vec3; 3]) -> [f32; 2] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (bb, bc, cc) = (ab.dot(ab), ab.dot(ac), ac.dot(ac));
    let (pb, pc) = (ap.dot(ab), ap.dot(ac));
    let area = bb * cc - bc * bc;
    let (v, w) = ((pb * cc - pc * bc) / area, (pc * bb - pb * bc) / area);
    if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return [v, w];
    }
    // On one of the sides; so it is where there is no area.
    let along = |from: Vec3, side: Vec3| {
        let length = side.length_squared();
        if length > 0.0 { ((p - from).dot(side) / length).clamp(0.0, 1.0) } else { 0.0 }
    };
    let (first, second, third) = (along(a, ab), along(b, c - b), along(a, ac));
    let sides = [[first, 0.0], [1.0 - second, second], [0.0, third]];
    let far = |[v, w]: [f32; 2]| (ap - ab * v - ac * w).length_squared();
    sides.into_iter().reduce(|best, side| if far(side) < far(best) { side } else { best }).unwrap_or_default()
}
