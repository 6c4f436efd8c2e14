//! Which entries a symmetric matrix has.

use super::CholeskyError;
use crate::sort::{key, numbers, sort};

/// The sparsity of a symmetric matrix: its whole diagonal, and the entries (i, j) and (j, i) for each *edge* between two
/// rows i < j.
///
/// Edges are numbered by their smaller row, then by their larger one. Numbers over a pattern are kept one per row (the
/// diagonal) and one per edge: see [`SymmetricMatrix`](super::SymmetricMatrix).
///
/// ```
/// use kernels::cholesky::SymmetricPattern;
///
/// // Two triangles side by side, and a third row that hangs on nothing.
/// let pattern = SymmetricPattern::from_triangles(5, &[[0, 1, 2], [2, 1, 3]])?;
/// assert_eq!(pattern.edges(), [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
/// assert_eq!(pattern.row(2), (&[0, 1, 3][..], &[1, 2, 4][..]));
/// assert_eq!(pattern.edge(3, 2), Some(4));
/// // Tied to the others after all.
/// let tied = pattern.with_edges(&[[4, 0]])?;
/// assert_eq!(tied.edge(0, 4), Some(2));
/// # Ok::<(), kernels::cholesky::CholeskyError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SymmetricPattern {
    /// Each edge once, its smaller row first, in order.
    edges: Vec<[u32; 2]>,
    /// Compressed rows: where each begins, its columns without the diagonal in order, and their edges.
    row_start: Vec<u32>,
    columns: Vec<u32>,
    edge_of_entry: Vec<u32>,
}

impl SymmetricPattern {
    /// The pattern of `row_count` rows with these edges, in any order, either way round and as often as one likes. An edge
    /// from a row to itself says nothing: the diagonal is always there.
    ///
    /// # Errors
    /// [`CholeskyError::NoRow`] where an edge names a row that does not exist.
    pub fn from_edges(row_count: usize, edges: &[[u32; 2]]) -> Result<Self, CholeskyError> {
        let mut gathered = Gathered::new(row_count, edges.len());
        for &edge in edges {
            gathered.join(edge)?;
        }
        Ok(gathered.finish())
    }

    /// The pattern of matrices that join all corners of each triangle, such as Laplacians of a mesh of `vertex_count`
    /// vertices: a row for each vertex.
    ///
    /// # Errors
    /// [`CholeskyError::NoRow`] where a triangle names a vertex that does not exist.
    pub fn from_triangles(vertex_count: usize, triangles: &[[u32; 3]]) -> Result<Self, CholeskyError> {
        let mut gathered = Gathered::new(vertex_count, 3 * triangles.len());
        for &[a, b, c] in triangles {
            for side in [[a, b], [b, c], [c, a]] {
                gathered.join(side)?;
            }
        }
        Ok(gathered.finish())
    }

    /// The pattern of sums `a a^T`, each `a` with entries in the rows of one of `groups`: normal equations of least
    /// squares, a group for each equation.
    ///
    /// # Errors
    /// [`CholeskyError::NoRow`] where a group names a row that does not exist.
    pub fn from_groups<'a>(
        row_count: usize,
        groups: impl IntoIterator<Item = &'a [u32]>,
    ) -> Result<Self, CholeskyError> {
        let mut gathered = Gathered::new(row_count, 0);
        for group in groups {
            for (k, &a) in group.iter().enumerate() {
                for &b in &group[k..] {
                    gathered.join([a, b])?;
                }
            }
        }
        Ok(gathered.finish())
    }

    /// The same pattern with further edges, such as ties between parts that do not hang together.
    ///
    /// # Errors
    /// [`CholeskyError::NoRow`] where an edge names a row that does not exist.
    pub fn with_edges(&self, edges: &[[u32; 2]]) -> Result<Self, CholeskyError> {
        let mut gathered = Gathered::new(self.row_count(), self.edges.len() + edges.len());
        for &edge in self.edges.iter().chain(edges) {
            gathered.join(edge)?;
        }
        Ok(gathered.finish())
    }

    /// The pattern of the product of two matrices of this pattern: rows that share a neighbour are joined. The bi-Laplacian
    /// `L^T M^-1 L` has it.
    #[must_use]
    pub fn squared(&self) -> Self {
        let mut gathered = Gathered::new(self.row_count(), 6 * self.edges.len());
        for row in 0..self.row_count() {
            let around = self.row(row).0;
            gathered.keys.extend(around.iter().map(|&other| edge_key([row as u32, other])));
            for (k, &a) in around.iter().enumerate() {
                gathered.keys.extend(around[k + 1..].iter().map(|&b| edge_key([a, b])));
            }
        }
        gathered.finish()
    }

    /// The pattern of edges that are in order, each once, and name rows that exist.
    pub(crate) fn from_sorted(row_count: usize, edges: Vec<[u32; 2]>) -> Self {
        let mut row_start = vec![0; row_count + 1];
        for &[a, b] in &edges {
            row_start[a as usize + 1] += 1;
            row_start[b as usize + 1] += 1;
        }
        for row in 0..row_count {
            row_start[row + 1] += row_start[row];
        }
        let mut next = row_start.clone();
        let (mut columns, mut edge_of_entry) = (vec![0; 2 * edges.len()], vec![0; 2 * edges.len()]);
        let mut put = |row: u32, column: u32, edge: u32| {
            let at = next[row as usize] as usize;
            next[row as usize] += 1;
            (columns[at], edge_of_entry[at]) = (column, edge);
        };
        // Edges are in order, so that each row gets its smaller columns in order, then its larger ones.
        (0..).zip(&edges).for_each(|(edge, &[a, b])| put(b, a, edge));
        (0..).zip(&edges).for_each(|(edge, &[a, b])| put(a, b, edge));
        Self { edges, row_start, columns, edge_of_entry }
    }

    /// Number of rows n.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.row_start.len() - 1
    }

    /// The edges, their smaller row first, in the order in which they are numbered.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The columns of a row without the diagonal, in order, and the edges to them.
    #[must_use]
    pub fn row(&self, row: usize) -> (&[u32], &[u32]) {
        let entries = self.row_start[row] as usize..self.row_start[row + 1] as usize;
        (&self.columns[entries.clone()], &self.edge_of_entry[entries])
    }

    /// Number of the edge between two rows, where there is one.
    #[must_use]
    pub fn edge(&self, a: u32, b: u32) -> Option<usize> {
        if a as usize >= self.row_count() {
            return None;
        }
        let (columns, edges) = self.row(a as usize);
        columns.binary_search(&b).ok().map(|at| edges[at] as usize)
    }

    /// The edges of all rows' entries, row after row.
    pub(crate) fn edge_of_entry(&self) -> &[u32] {
        &self.edge_of_entry
    }

    /// Where the entries of a row are in [`Self::edge_of_entry`].
    pub(crate) fn entries(&self, row: usize) -> std::ops::Range<usize> {
        self.row_start[row] as usize..self.row_start[row + 1] as usize
    }
}

/// Edges on their way into a pattern.
struct Gathered {
    row_count: usize,
    keys: Vec<u128>,
}

impl Gathered {
    fn new(row_count: usize, capacity: usize) -> Self {
        Self { row_count, keys: Vec::with_capacity(capacity) }
    }

    fn join(&mut self, ends: [u32; 2]) -> Result<(), CholeskyError> {
        if let Some(&row) = ends.iter().find(|&&row| row as usize >= self.row_count) {
            return Err(CholeskyError::NoRow { row, row_count: self.row_count });
        }
        if ends[0] != ends[1] {
            self.keys.push(edge_key(ends));
        }
        Ok(())
    }

    fn finish(mut self) -> SymmetricPattern {
        sort(&mut self.keys);
        self.keys.dedup();
        let ends = |key| {
            let [_, _, a, b] = numbers(key);
            [a, b]
        };
        SymmetricPattern::from_sorted(self.row_count, self.keys.into_iter().map(ends).collect())
    }
}

fn edge_key([a, b]: [u32; 2]) -> u128 {
    key([0, 0, a.min(b), a.max(b)])
}
