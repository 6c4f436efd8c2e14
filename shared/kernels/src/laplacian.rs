//! Cotangent Laplacians of poses over a topology's fixed sparsity.
//!
//! This work is based on: Boukhayma, thesis (2017), equation 2.40: `(L v)_k = sum over l of w_kl (v_k - v_l)` with
//! `w_kl` half the sum of the cotangents opposite to the edge. Weights are not clamped.
//!
//! One vertex of each connected component, its *anchor*, is held, which takes the null vectors away. Everything lies in
//! elimination order (see [`crate::cholesky`]), anchors last and left out.

use glam::{Vec3, Vec4};

use crate::cholesky::{CholeskyError, anchors_last};
use crate::gradients::{TriangleBatches, frame};
use crate::lanes::{LANES, Lanes};
use crate::sort::{key, numbers, sort};
use crate::topology::Topology;

/// Narrowest triangle that is weighted as it is, height over longest edge. Single precision cannot hold the weights of
/// narrower ones (their three cotangents cancel); they are weighted as if they were this wide.
const NARROWEST: f32 = 1e-3;

/// Triangles below this fraction of the mean area have no weight.
const DEGENERATE: f64 = 1e-12;

/// Which entries the Laplacian of any pose has, and where each triangle's weights go.
#[derive(Clone, Debug)]
pub struct LaplacianPattern {
    /// Vertices in elimination order, anchors last.
    order: Vec<u32>,
    /// Place of each vertex in elimination order; anchors take the last ones.
    position_of_vertex: Vec<u32>,
    free_count: usize,
    /// Edges as positions, each once.
    edges: Vec<[u32; 2]>,
    /// Edge opposite to each corner of each triangle, as the triangles' batches; the filling points to edge 0.
    edge_of_corner: Vec<[[u32; LANES]; 3]>,
    /// Compressed rows of the free vertices: their free neighbours.
    row_start: Vec<u32>,
    columns: Vec<u32>,
    edge_of_entry: Vec<u32>,
}

/// The Laplacian of a pose.
#[derive(Clone, Debug, Default)]
pub struct Laplacian {
    /// Half cotangents at the three corners of each triangle, by batch.
    pub(crate) half_cotangents: Vec<[Lanes; 3]>,
    /// Weight of each edge of the pattern.
    pub(crate) weights: Vec<f32>,
    /// Diagonal entries of the free vertices.
    pub(crate) diagonal: Vec<f32>,
    entries: Vec<f32>,
}

impl LaplacianPattern {
    /// The pattern of the Laplacians over `topology`, whose triangles are `triangles`. Vertices are eliminated in the
    /// order `order`; the last one of each component is its anchor, and is not.
    ///
    /// # Errors
    /// [`CholeskyError::Order`] where `order` does not name every vertex once.
    pub fn new(topology: &Topology, triangles: &TriangleBatches, order: &[u32]) -> Result<Self, CholeskyError> {
        let order = anchors_last(topology, order)?;
        let mut position_of_vertex = vec![0; order.len()];
        for (position, &vertex) in order.iter().enumerate() {
            position_of_vertex[vertex as usize] = position as u32;
        }
        let (edges, edge_of_corner) = number_edges(triangles, &position_of_vertex);
        let free_count = order.len() - topology.component_count();
        let (row_start, columns, edge_of_entry) = rows(&edges, free_count);
        Ok(Self { order, position_of_vertex, free_count, edges, edge_of_corner, row_start, columns, edge_of_entry })
    }

    /// The vertices in the order of elimination, the anchors last.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Number of vertices that are not anchors.
    #[must_use]
    pub fn free_count(&self) -> usize {
        self.free_count
    }

    /// Place of each vertex in elimination order.
    #[must_use]
    pub fn position_of_vertex(&self) -> &[u32] {
        &self.position_of_vertex
    }

    /// The free neighbours of a free vertex, in order, and the edges to them.
    pub(crate) fn row(&self, row: usize) -> (&[u32], &[u32]) {
        let entries = self.row_start[row] as usize..self.row_start[row + 1] as usize;
        (&self.columns[entries.clone()], &self.edge_of_entry[entries])
    }

    /// Sets `laplacian` to that of `pose`, in metres.
    pub fn assemble(&self, triangles: &TriangleBatches, pose: &[Vec3], laplacian: &mut Laplacian) {
        set_half_cotangents(triangles, pose, &mut laplacian.half_cotangents);
        laplacian.weights.clear();
        laplacian.weights.resize(self.edges.len(), 0.0);
        for (edges, cotangents) in self.edge_of_corner.iter().zip(&laplacian.half_cotangents) {
            for corner in 0..3 {
                for lane in 0..LANES {
                    laplacian.weights[edges[corner][lane] as usize] += cotangents[corner].0[lane];
                }
            }
        }
        laplacian.diagonal.clear();
        laplacian.diagonal.resize(self.position_of_vertex.len(), 0.0);
        for (&[k, l], &weight) in self.edges.iter().zip(&laplacian.weights) {
            laplacian.diagonal[k as usize] += weight;
            laplacian.diagonal[l as usize] += weight;
        }
        laplacian.diagonal.truncate(self.free_count);
        laplacian.entries.clear();
        laplacian.entries.extend(self.edge_of_entry.iter().map(|&edge| laplacian.weights[edge as usize]));
    }

    /// `out = L x` for the free vertices, the anchors held at zero.
    pub fn multiply(&self, laplacian: &Laplacian, x: &[Vec4], out: &mut [Vec4]) {
        for row in 0..self.free_count {
            let entries = self.row_start[row] as usize..self.row_start[row + 1] as usize;
            let mut sum = x[row] * laplacian.diagonal[row];
            for (&column, &weight) in self.columns[entries.clone()].iter().zip(&laplacian.entries[entries]) {
                sum -= x[column as usize] * weight;
            }
            out[row] = sum;
        }
    }
}

/// Numbers the edges by the positions of their ends, and gives the edge opposite to each corner.
fn number_edges(triangles: &TriangleBatches, position_of_vertex: &[u32]) -> (Vec<[u32; 2]>, Vec<[[u32; LANES]; 3]>) {
    let mut sides = Vec::with_capacity(triangles.triangle_count() * 3);
    for triangle in 0..triangles.triangle_count() {
        let corners = triangles.batches()[triangle / LANES].corners();
        let [a, b, c] = corners.map(|corner| position_of_vertex[corner[triangle % LANES] as usize]);
        for (corner, (k, l)) in [(b, c), (c, a), (a, b)].into_iter().enumerate() {
            sides.push(key([k.min(l), k.max(l), triangle as u32, corner as u32]));
        }
    }
    sort(&mut sides);
    let mut edges: Vec<[u32; 2]> = Vec::new();
    let mut edge_of_corner = vec![[[0; LANES]; 3]; triangles.batches().len()];
    for [k, l, triangle, corner] in sides.into_iter().map(numbers) {
        let (triangle, corner) = (triangle as usize, corner as usize);
        if edges.last() != Some(&[k, l]) {
            edges.push([k, l]);
        }
        edge_of_corner[triangle / LANES][corner][triangle % LANES] = edges.len() as u32 - 1;
    }
    (edges, edge_of_corner)
}

/// Compressed rows: where each begins, its columns in order, and their edges.
fn rows(edges: &[[u32; 2]], free_count: usize) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    // A triangle that names a vertex twice has an edge from it to itself, which says nothing.
    let says_something = |[k, l]: [u32; 2]| k != l && (l as usize) < free_count;
    let edges = || (0..).zip(edges).map(|(edge, &ends)| (edge, ends)).filter(|&(_, ends)| says_something(ends));
    let mut row_start = vec![0; free_count + 1];
    for (_, [k, l]) in edges() {
        row_start[k as usize + 1] += 1;
        row_start[l as usize + 1] += 1;
    }
    for row in 0..free_count {
        row_start[row + 1] += row_start[row];
    }
    let mut next = row_start.clone();
    let entries = row_start[free_count] as usize;
    let (mut columns, mut edge_of_entry) = (vec![0; entries], vec![0; entries]);
    let mut put = |row: u32, column: u32, edge: u32| {
        let at = next[row as usize] as usize;
        next[row as usize] += 1;
        (columns[at], edge_of_entry[at]) = (column, edge);
    };
    // Edges are in order, so that each row gets its smaller columns in order, then its larger ones.
    edges().for_each(|(edge, [k, l])| put(l, k, edge));
    edges().for_each(|(edge, [k, l])| put(k, l, edge));
    (row_start, columns, edge_of_entry)
}

fn set_half_cotangents(triangles: &TriangleBatches, pose: &[Vec3], half_cotangents: &mut Vec<[Lanes; 3]>) {
    half_cotangents.clear();
    let mut areas = Vec::with_capacity(triangles.batches().len());
    let mut sum = 0.0;
    let half = Lanes::splat(0.5);
    for batch in triangles.batches() {
        let frame = frame(batch, pose);
        let (a, b) = (frame.a, frame.b);
        let area = a * frame.c * half;
        sum += area.0.iter().map(|&area| f64::from(area)).sum::<f64>();
        areas.push(area);
        let longest = a.max((b * b + frame.c * frame.c).sqrt());
        let longest = longest.max(((a - b) * (a - b) + frame.c * frame.c).sqrt());
        let a = a.max(longest * Lanes::splat(NARROWEST));
        let c = frame.c.max(longest * Lanes::splat(NARROWEST) * longest / a);
        let half_inverse = half / c;
        let first = b * half_inverse;
        let second = (a - b) * half_inverse;
        let third = (c * c - b * (a - b)) * half_inverse / a;
        half_cotangents.push([first, second, third]);
    }
    let least = Lanes::splat((DEGENERATE * sum / triangles.triangle_count() as f64) as f32);
    for (cotangents, &area) in half_cotangents.iter_mut().zip(&areas) {
        for cotangent in cotangents {
            // Not `area < least`: what is not a number has no weight either, and nor has the filling.
            *cotangent = area.zip(*cotangent, |area, cotangent| if area > least.0[0] { cotangent } else { 0.0 });
        }
    }
}
