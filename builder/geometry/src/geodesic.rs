//! How far it is along a surface: shortest ways over a graph of its edges (Dijkstra 1959), and how much its hills stand out.
//!
//! Ways along edges alone are up to a tenth too long, in some directions more than in others;
//! [`SurfaceGraph::with_diagonals`] adds the ways across pairs of triangles, which takes most of that away.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// A graph over the vertices of a surface, its edges with their lengths in metres.
#[derive(Clone, Debug)]
pub struct SurfaceGraph {
    /// For each vertex its neighbours and how far they are.
    of: Vec<Vec<(u32, f32)>>,
}

/// A hill of a function over a surface: a place from which it falls on all sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The vertex at its top.
    pub top: u32,
    /// The vertex of the pass by which it meets a higher hill; none of the highest of a component.
    pub pass: Option<u32>,
    /// How far its top stands above that pass; above the lowest place of its component where there is no pass.
    pub persistence: f32,
}

impl SurfaceGraph {
    /// The graph of the sides of `triangles` over `vertex_count` vertices, and of the further edges `ties`; `length` is how long
    /// an edge is.
    #[must_use]
    pub fn new(
        vertex_count: usize,
        triangles: &[[u32; 3]],
        ties: &[[u32; 2]],
        length: impl Fn(u32, u32) -> f32,
    ) -> Self {
        let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        edges.iter_mut().for_each(|edge| edge.sort_unstable());
        edges.sort_unstable();
        edges.dedup();
        let mut of = vec![Vec::new(); vertex_count];
        for &[a, b] in edges.iter().chain(ties) {
            let length = length(a, b);
            of[a as usize].push((b, length));
            of[b as usize].push((a, length));
        }
        Self { of }
    }

    /// The same with the straight ways from corner to corner across pairs of triangles that share a side, where these two,
    /// unfolded into a plane, are convex.
    #[must_use]
    pub fn with_diagonals(mut self, triangles: &[[u32; 3]], length: impl Fn(u32, u32) -> f32) -> Self {
        let mut opposite: HashMap<[u32; 2], u32> = HashMap::with_capacity(2 * triangles.len());
        let mut found: Vec<(u32, u32, f32)> = Vec::new();
        for &[a, b, c] in triangles {
            for (from, to, corner) in [(a, b, c), (b, c, a), (c, a, b)] {
                let side = [from.min(to), from.max(to)];
                if let Some(other) = opposite.insert(side, corner)
                    && let Some(across) = across(side, [corner, other], &length)
                {
                    found.push((corner, other, across));
                }
            }
        }
        for (a, b, length) in found {
            self.of[a as usize].push((b, length));
            self.of[b as usize].push((a, length));
        }
        self
    }

    /// Neighbours of a vertex, and how far they are.
    #[must_use]
    pub fn neighbours(&self, vertex: u32) -> &[(u32, f32)] {
        &self.of[vertex as usize]
    }

    /// Lengths of the shortest ways from any of `sources`; infinite from `limit` on.
    #[must_use]
    pub fn distances(&self, sources: &[u32], limit: f32) -> Vec<f32> {
        let mut distances = vec![f32::INFINITY; self.of.len()];
        let mut queue = BinaryHeap::new();
        for &source in sources {
            distances[source as usize] = 0.0;
            queue.push(Reverse((0_u32, source)));
        }
        while let Some(Reverse((bits, vertex))) = queue.pop() {
            let distance = f32::from_bits(bits);
            if distance > distances[vertex as usize] {
                continue;
            }
            for &(next, length) in &self.of[vertex as usize] {
                let there = distance + length;
                if there < distances[next as usize] && there < limit {
                    distances[next as usize] = there;
                    // The bits of floats that are not negative are in their order.
                    queue.push(Reverse((there.to_bits(), next)));
                }
            }
        }
        distances
    }

    /// The hills of `heights`, one a vertex, by falling persistence (Edelsbrunner, Letscher and Zomorodian 2002): the water
    /// falls, islands rise and grow together, and where two meet the lower one ends. Vertices of no finite height are left out.
    #[must_use]
    pub fn peaks(&self, heights: &[f32]) -> Vec<Peak> {
        let mut order: Vec<u32> = (0..self.of.len() as u32).filter(|&v| heights[v as usize].is_finite()).collect();
        order.sort_by(|&a, &b| heights[b as usize].total_cmp(&heights[a as usize]).then(a.cmp(&b)));
        const WATER: u32 = u32::MAX;
        // Of each island, by its root: its top, and its lowest vertex so far.
        let mut parent = vec![WATER; self.of.len()];
        let (mut top, mut lowest) = (vec![0_u32; self.of.len()], vec![0_u32; self.of.len()]);
        let mut peaks = Vec::new();
        for &vertex in &order {
            (parent[vertex as usize], top[vertex as usize]) = (vertex, vertex);
            let mut own = vertex;
            for &(next, _) in &self.of[vertex as usize] {
                if parent[next as usize] == WATER {
                    continue;
                }
                let other = root(&mut parent, next);
                if other == own {
                    continue;
                }
                let higher = |a: u32, b: u32| {
                    let [a, b] = [top[a as usize], top[b as usize]];
                    (heights[a as usize], b) > (heights[b as usize], a)
                };
                let (stays, ends) = if higher(other, own) { (other, own) } else { (own, other) };
                let summit = top[ends as usize];
                if summit != vertex {
                    let persistence = heights[summit as usize] - heights[vertex as usize];
                    peaks.push(Peak { top: summit, pass: Some(vertex), persistence });
                }
                parent[ends as usize] = stays;
                own = stays;
            }
            lowest[own as usize] = vertex;
        }
        for &vertex in &order {
            if parent[vertex as usize] == vertex {
                let summit = top[vertex as usize];
                let persistence = heights[summit as usize] - heights[lowest[vertex as usize] as usize];
                peaks.push(Peak { top: summit, pass: None, persistence });
            }
        }
        peaks.sort_by(|a, b| b.persistence.total_cmp(&a.persistence).then(a.top.cmp(&b.top)));
        peaks
    }
}

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        parent[vertex as usize] = parent[parent[vertex as usize] as usize];
        vertex = parent[vertex as usize];
    }
    vertex
}

/// How far two corners are apart over the side between them, once their triangles lie in one plane; `None` where the straight way
/// leaves them.
fn across([from, to]: [u32; 2], corners: [u32; 2], length: &impl Fn(u32, u32) -> f32) -> Option<f32> {
    let side = length(from, to);
    // Along the side, and how far off it.
    let [near, far] = corners.map(|corner| {
        let (a, b) = (length(from, corner), length(to, corner));
        let along = (a * a - b * b + side * side) / (2.0 * side);
        (along, (a * a - along * along).max(0.0).sqrt())
    });
    let height = near.1 + far.1;
    let crossing = near.0 + (far.0 - near.0) * near.1 / height;
    (height > 0.0 && (0.0..=side).contains(&crossing)).then(|| (near.0 - far.0).hypot(height))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    /// A sheet of `n` by `n` vertices, 1 apart.
    fn sheet(n: u32) -> (Vec<Vec2>, Vec<[u32; 3]>) {
        let points = (0..n * n).map(|k| Vec2::new((k % n) as f32, (k / n) as f32)).collect();
        let quad = |k: u32| [[k, k + 1, k + n], [k + 1, k + n + 1, k + n]];
        let triangles = (0..n * (n - 1)).filter(|k| k % n < n - 1).flat_map(quad).collect();
        (points, triangles)
    }

    #[test]
    fn diagonals_make_ways_nearly_straight() {
        let (points, triangles) = sheet(20);
        let length = |a: u32, b: u32| points[a as usize].distance(points[b as usize]);
        let edges = SurfaceGraph::new(400, &triangles, &[], length);
        let worst = |graph: &SurfaceGraph| {
            let distances = graph.distances(&[0], f32::INFINITY);
            (1..400).map(|v| distances[v] / points[v].length()).fold(0.0, f32::max)
        };
        assert!(worst(&edges) > 1.3, "{}", worst(&edges));
        let finer = edges.with_diagonals(&triangles, length);
        assert!(worst(&finer) < 1.09, "{}", worst(&finer));
        assert!(finer.distances(&[0], 3.0)[19].is_infinite());
    }

    #[test]
    fn hills_end_where_they_meet_a_higher_one() {
        let (points, triangles) = sheet(20);
        let length = |a: u32, b: u32| points[a as usize].distance(points[b as usize]);
        let graph = SurfaceGraph::new(400, &triangles, &[], length);
        let hill = |p: &Vec2, at: Vec2, height: f32| (height - p.distance(at)).max(0.0);
        let heights: Vec<f32> = points
            .iter()
            .map(|p| {
                let [a, b] = [hill(p, Vec2::new(4.0, 4.0), 6.0), hill(p, Vec2::new(13.0, 4.0), 5.0)];
                a.max(b).max(hill(p, Vec2::new(8.0, 16.0), 2.0))
            })
            .collect();
        let peaks = graph.peaks(&heights);
        let tops: Vec<u32> = peaks.iter().take(3).map(|peak| peak.top).collect();
        assert_eq!(tops, [4 * 20 + 4, 4 * 20 + 13, 16 * 20 + 8]);
        assert_eq!((peaks[0].pass, peaks[0].persistence), (None, 6.0));
        assert_eq!((peaks[1].persistence, peaks[2].persistence), (4.0, 2.0));
        assert!(peaks.get(3).is_none_or(|peak| peak.persistence == 0.0));
        assert_eq!(heights[peaks[1].pass.unwrap() as usize], 1.0);
    }
}
