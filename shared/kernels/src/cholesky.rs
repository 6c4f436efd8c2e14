//! Sparse Cholesky factors of Laplacians: one elimination order and one symbolic factorisation per topology, a numeric
//! factorisation per pose.
//!
//! All of it is our own for the page's sake: a general library's would be a sixth of all that the page loads, and no
//! faster in WebAssembly. It is sequential and in double precision; the factor is kept in single precision, laid out for
//! three right sides at once: factorising in single precision would lose digits, solving in it does not.

mod numeric;
mod order;
mod structure;

use glam::Vec4;
use thiserror::Error;

use crate::laplacian::{Laplacian, LaplacianPattern};
use crate::sort::{key, numbers, sort};
use crate::topology::Topology;
use numeric::Scratch;
use structure::Structure;

/// Vertices whose diagonal is below this fraction of the mean one are held by nothing.
const LEAST_DIAGONAL: f64 = 1e-9;

/// Tries at a matrix that is not positive definite: so many pivots are raised one by one, then the whole diagonal.
const SINGLE_PIVOTS: usize = 8;
const MOST_ATTEMPTS: usize = SINGLE_PIVOTS + 8;

/// Marks a diagonal entry among numbers of edges.
const DIAGONAL: u32 = u32::MAX;

/// Entries of a factor for each vertex at most: surfaces have 50 to 100, whatever a bundle's order claims to be.
pub const MOST_ENTRIES: usize = 1024;

/// Columns of the factor that are worked on together.
const PANEL: usize = 4;

/// Why numbers are not an elimination order, or a matrix has no factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CholeskyError {
    /// An order does not name every vertex once.
    #[error("the elimination order does not name each of the {0} vertices once")]
    Order(usize),
    /// The order, or a mesh that is no surface, makes a factor that nobody should wait for.
    #[error("eliminated in this order, the mesh's Laplacian fills in: its factor has more than {0} entries")]
    Fill(usize),
    /// The matrix holds something that is not a number.
    #[error("the pose's Laplacian is not finite")]
    NotFinite,
}

/// A fill-reducing order of elimination for the Laplacians of `topology`: all vertices, each once; the last vertex of
/// each connected component in it becomes its anchor.
#[must_use]
pub fn elimination_order(topology: &Topology) -> Vec<u32> {
    let mut pairs = Vec::with_capacity(topology.triangles().len() * 6);
    for &[a, b, c] in topology.triangles() {
        for (k, l) in [(a, b), (b, c), (c, a)] {
            if k != l {
                pairs.extend([key([0, 0, k, l]), key([0, 0, l, k])]);
            }
        }
    }
    sort(&mut pairs);
    pairs.dedup();
    let mut neighbours = vec![Vec::new(); topology.vertex_count()];
    for [_, _, vertex, neighbour] in pairs.into_iter().map(numbers) {
        neighbours[vertex as usize].push(neighbour);
    }
    order::minimum_degree(neighbours)
}

/// `order` with the anchor of each component, its last vertex, moved to the end.
///
/// # Errors
/// [`CholeskyError::Order`] where `order` does not name every vertex once.
pub(crate) fn anchors_last(topology: &Topology, order: &[u32]) -> Result<Vec<u32>, CholeskyError> {
    let n = topology.vertex_count();
    let mut seen = vec![false; n];
    let mut last = vec![u32::MAX; topology.component_count()];
    for &vertex in order {
        match seen.get_mut(vertex as usize) {
            Some(seen) if !*seen => *seen = true,
            _ => return Err(CholeskyError::Order(n)),
        }
        last[topology.component_of_vertex()[vertex as usize] as usize] = vertex;
    }
    if order.len() != n {
        return Err(CholeskyError::Order(n));
    }
    let is_anchor = |vertex: u32| last[topology.component_of_vertex()[vertex as usize] as usize] == vertex;
    let mut free: Vec<u32> = order.iter().copied().filter(|&vertex| !is_anchor(vertex)).collect();
    free.extend(last);
    Ok(free)
}

/// The structure that the factors of all poses share.
#[derive(Debug)]
pub struct SymbolicCholesky {
    structure: Structure,
    /// Lower triangle, column by column: each column's diagonal first, then its edges.
    column_start: Vec<u32>,
    rows: Vec<u32>,
    edge_of_entry: Vec<u32>,
    panels: Vec<Panel>,
    /// Panels of each supernode.
    first_panel: Vec<u32>,
    panel_values: usize,
    tallest: usize,
}

/// Up to [`PANEL`] neighbouring columns of a supernode.
#[derive(Clone, Copy, Debug)]
struct Panel {
    /// Its first column, counted within the supernode.
    column: u32,
    width: u32,
    /// Where its numbers begin in [`Factor::values`]: the inverses of the diagonal, what is below it within the panel
    /// row by row, then the rows below, `width` numbers each.
    start: u32,
}

/// The Cholesky factor of a pose's Laplacian.
#[derive(Clone, Debug, Default)]
pub struct Factor {
    values: Vec<f32>,
    /// Pivots that had to be raised because the Laplacian was not positive definite: 0 on good meshes.
    pub regularised: usize,
}

/// Memory that factorising needs and keeps.
#[derive(Default)]
pub struct Workspace {
    lower: Vec<f64>,
    values: Vec<f64>,
    scratch: Scratch,
}

impl SymbolicCholesky {
    /// Analyses a pattern.
    ///
    /// # Errors
    /// [`CholeskyError::Fill`] where the factor would have more than [`MOST_ENTRIES`] entries a vertex.
    pub fn new(pattern: &LaplacianPattern) -> Result<Self, CholeskyError> {
        let n = pattern.free_count();
        let (mut column_start, mut rows, mut edge_of_entry) = (vec![0], Vec::new(), Vec::new());
        for column in 0..n {
            rows.push(column as u32);
            edge_of_entry.push(DIAGONAL);
            let (neighbours, edges) = pattern.row(column);
            let below = neighbours.partition_point(|&row| (row as usize) < column);
            rows.extend_from_slice(&neighbours[below..]);
            edge_of_entry.extend_from_slice(&edges[below..]);
            column_start.push(rows.len() as u32);
        }
        let most = MOST_ENTRIES.saturating_mul(n);
        let mut symbolic = Self {
            structure: Structure::new(n, most, |row| pattern.row(row).0).ok_or(CholeskyError::Fill(most))?,
            column_start,
            rows,
            edge_of_entry,
            panels: Vec::new(),
            first_panel: vec![0],
            panel_values: 0,
            tallest: 0,
        };
        symbolic.lay_out_panels();
        Ok(symbolic)
    }

    /// Numbers in a factor.
    #[must_use]
    pub fn value_count(&self) -> usize {
        self.panel_values
    }

    /// Factorises `laplacian`, of the same pattern.
    ///
    /// A matrix that is not positive definite is regularised where it fails to be, which [`Factor::regularised`] tells;
    /// such a factor is still a good preconditioner.
    ///
    /// # Errors
    /// [`CholeskyError::NotFinite`].
    pub fn factorise(&self, laplacian: &Laplacian, workspace: &mut Workspace) -> Result<Factor, CholeskyError> {
        let n = self.structure.columns();
        let diagonal_sum: f64 = laplacian.diagonal.iter().map(|&d| f64::from(d)).sum();
        let mean = (diagonal_sum / n.max(1) as f64).max(f64::from(f32::MIN_POSITIVE));
        if !mean.is_finite() {
            return Err(CholeskyError::NotFinite);
        }
        let loose = self.set_lower(laplacian, mean, &mut workspace.lower);
        for attempt in 0..MOST_ATTEMPTS {
            let Workspace { lower, values, scratch } = &mut *workspace;
            let matrix = (self.column_start.as_slice(), self.rows.as_slice(), lower.as_slice());
            let Err(pivot) = numeric::factorise(&self.structure, matrix, values, scratch) else {
                return Ok(Factor { values: self.pack(values), regularised: loose + attempt });
            };
            if attempt < SINGLE_PIVOTS {
                workspace.lower[self.column_start[pivot.min(n - 1)] as usize] += mean;
            } else {
                let shift = mean * 1e-6 * 10_f64.powi((attempt - SINGLE_PIVOTS) as i32);
                for &start in &self.column_start[..n] {
                    workspace.lower[start as usize] += shift;
                }
            }
        }
        Err(CholeskyError::NotFinite)
    }

    /// Sets the lower triangle. Vertices that nothing holds (all their triangles are degenerate) have no diagonal: they
    /// get the mean one; their number.
    fn set_lower(&self, laplacian: &Laplacian, mean: f64, lower: &mut Vec<f64>) -> usize {
        let mut loose = 0;
        lower.clear();
        for column in 0..self.structure.columns() {
            let entries = self.column_start[column] as usize..self.column_start[column + 1] as usize;
            let start = lower.len();
            lower.extend(self.edge_of_entry[entries].iter().map(|&edge| match edge {
                DIAGONAL => f64::from(laplacian.diagonal[column]),
                edge => -f64::from(laplacian.weights[edge as usize]),
            }));
            if lower[start] <= mean * LEAST_DIAGONAL {
                lower[start] += mean;
                loose += 1;
            }
        }
        loose
    }

    /// Replaces `x` by `(L L^T)^-1 x`: three right sides, one per lane, in elimination order.
    pub fn solve(&self, factor: &Factor, x: &mut [Vec4], scratch: &mut Vec<Vec4>) {
        scratch.resize(self.tallest, Vec4::ZERO);
        for supernode in 0..self.structure.supernodes() {
            let node = self.structure.supernode(supernode);
            let columns = node.columns();
            let below = &mut scratch[..node.height()];
            below[..columns].copy_from_slice(&x[node.start..node.end]);
            below[columns..].fill(Vec4::ZERO);
            for (panel, values) in self.panels_of(supernode, factor) {
                let rows = &mut below[panel.column as usize..];
                match panel.width {
                    4 => forward::<4>(values, rows),
                    3 => forward::<3>(values, rows),
                    2 => forward::<2>(values, rows),
                    _ => forward::<1>(values, rows),
                }
            }
            x[node.start..node.end].copy_from_slice(&below[..columns]);
            for (&row, &sum) in node.rows.iter().zip(&below[columns..]) {
                x[row as usize] += sum;
            }
        }
        for supernode in (0..self.structure.supernodes()).rev() {
            let node = self.structure.supernode(supernode);
            let columns = node.columns();
            let below = &mut scratch[..node.height()];
            below[..columns].copy_from_slice(&x[node.start..node.end]);
            for (value, &row) in below[columns..].iter_mut().zip(node.rows) {
                *value = x[row as usize];
            }
            for (panel, values) in self.panels_of(supernode, factor).rev() {
                let rows = &mut below[panel.column as usize..];
                match panel.width {
                    4 => backward::<4>(values, rows),
                    3 => backward::<3>(values, rows),
                    2 => backward::<2>(values, rows),
                    _ => backward::<1>(values, rows),
                }
            }
            x[node.start..node.end].copy_from_slice(&below[..columns]);
        }
    }

    fn panels_of<'a>(
        &'a self,
        supernode: usize,
        factor: &'a Factor,
    ) -> impl DoubleEndedIterator<Item = (&'a Panel, &'a [f32])> {
        let range = self.first_panel[supernode] as usize..self.first_panel[supernode + 1] as usize;
        self.panels[range].iter().map(|panel| (panel, &factor.values[panel.start as usize..]))
    }

    fn lay_out_panels(&mut self) {
        for supernode in 0..self.structure.supernodes() {
            let node = self.structure.supernode(supernode);
            let (columns, height) = (node.columns(), node.height());
            self.tallest = self.tallest.max(height);
            for column in (0..columns).step_by(PANEL) {
                let width = PANEL.min(columns - column);
                self.panels.push(Panel { column: column as u32, width: width as u32, start: self.panel_values as u32 });
                self.panel_values += head(width) + (height - column - width) * width;
            }
            self.first_panel.push(self.panels.len() as u32);
        }
    }

    /// The factor's numbers in the order of the panels.
    fn pack(&self, values: &[f64]) -> Vec<f32> {
        let mut packed = Vec::with_capacity(self.panel_values);
        for supernode in 0..self.structure.supernodes() {
            let node = self.structure.supernode(supernode);
            let (first, height) = (node.value_start, node.height());
            let range = self.first_panel[supernode] as usize..self.first_panel[supernode + 1] as usize;
            for panel in &self.panels[range] {
                let (column, width) = (panel.column as usize, panel.width as usize);
                let entry = |row: usize, j: usize| values[first + (column + j) * height + row] as f32;
                packed.extend((0..width).map(|j| (1.0 / values[first + (column + j) * height + column + j]) as f32));
                for row in 1..width {
                    packed.extend((0..row).map(|j| entry(column + row, j)));
                }
                for row in column + width..height {
                    packed.extend((0..width).map(|j| entry(row, j)));
                }
            }
        }
        packed
    }
}

/// Numbers at the head of a panel: the inverse diagonal and what lies below it within the panel.
const fn head(width: usize) -> usize {
    width * (width + 1) / 2
}

#[inline(always)]
fn forward<const W: usize>(values: &[f32], rows: &mut [Vec4]) {
    let (own, below) = rows.split_at_mut(W);
    let (head, values) = values.split_at(head(W));
    let mut y = [Vec4::ZERO; W];
    let mut next = W;
    for j in 0..W {
        let mut sum = own[j];
        for k in 0..j {
            sum -= y[k] * head[next];
            next += 1;
        }
        y[j] = sum * head[j];
        own[j] = y[j];
    }
    for (row, entries) in below.iter_mut().zip(values.chunks_exact(W)) {
        let mut sum = *row;
        for j in 0..W {
            sum -= y[j] * entries[j];
        }
        *row = sum;
    }
}

#[inline(always)]
fn backward<const W: usize>(values: &[f32], rows: &mut [Vec4]) {
    let (own, below) = rows.split_at_mut(W);
    let (head, values) = values.split_at(head(W));
    let mut sums = [Vec4::ZERO; W];
    for (&row, entries) in below.iter().zip(values.chunks_exact(W)) {
        for j in 0..W {
            sums[j] += row * entries[j];
        }
    }
    for j in (0..W).rev() {
        let mut sum = own[j] - sums[j];
        for k in j + 1..W {
            sum -= own[k] * head[W + k * (k - 1) / 2 + j];
        }
        own[j] = sum * head[j];
    }
}
