//! What the factors of all matrices of one pattern share.

use super::structure::Structure;
use super::{CholeskyError, EliminationOrder, SymmetricEntries, SymmetricPattern};

/// Entries of a factor for each row at most: surfaces have 50 to 100, whatever a bundle's order claims to be.
pub const MOST_ENTRIES: usize = 1024;

/// Columns of the factor that are worked on together.
const PANEL: usize = 4;

/// Marks a diagonal entry among numbers of edges.
pub(super) const DIAGONAL: u32 = u32::MAX;

/// The analysis of a pattern under an order of elimination: done once, for matrices of any numbers.
///
/// Rows are numbered as in the pattern wherever they are named, except where positions in the order of elimination are
/// spoken of.
#[derive(Debug)]
pub struct Symbolic {
    pub(super) structure: Structure,
    /// Rows in the order of elimination, and where each row is in it; those that are left out come last.
    pub(super) order: Vec<u32>,
    pub(super) position: Vec<u32>,
    /// Numbers of rows and edges of the pattern.
    size: [usize; 2],
    /// Lower triangle, column by column of the order of elimination: each column's diagonal first, then its edges.
    pub(super) column_start: Vec<u32>,
    pub(super) rows: Vec<u32>,
    pub(super) edge_of_entry: Vec<u32>,
    panels: Vec<Panel>,
    /// Panels of each supernode.
    first_panel: Vec<u32>,
    panel_values: usize,
    pub(super) tallest: usize,
}

/// Up to [`PANEL`] neighbouring columns of a supernode.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panel {
    /// Its first column, counted within the supernode.
    pub column: u32,
    pub width: u32,
    /// Where its numbers begin in a factor's: the inverses of the diagonal, what is below it within the panel row by row,
    /// then the rows below, `width` numbers each.
    pub start: u32,
}

impl Symbolic {
    /// Analyses `pattern`, whose rows are eliminated in `order`.
    ///
    /// # Errors
    /// [`CholeskyError::Order`] where the order is one of another number of rows, [`CholeskyError::Fill`] where the factor
    /// would have more than [`MOST_ENTRIES`] entries a row.
    pub fn new(pattern: &SymmetricPattern, order: &EliminationOrder) -> Result<Self, CholeskyError> {
        Self::of_first(pattern, order, pattern.row_count())
    }

    /// Analyses the part of `pattern` that the first `free_count` rows of `order` make. The other rows are left out: their
    /// unknowns are held at zero, and are zero in solutions.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_first(
        pattern: &SymmetricPattern,
        order: &EliminationOrder,
        free_count: usize,
    ) -> Result<Self, CholeskyError> {
        let row_count = pattern.row_count();
        if order.rows().len() != row_count || free_count > row_count {
            return Err(CholeskyError::Order(row_count));
        }
        let (order, position) = (order.rows().to_vec(), order.positions());
        let (mut column_start, mut rows, mut edge_of_entry) = (vec![0], Vec::new(), Vec::new());
        for column in 0..free_count {
            rows.push(column as u32);
            edge_of_entry.push(DIAGONAL);
            let (neighbours, edges) = pattern.row(order[column] as usize);
            for (&neighbour, &edge) in neighbours.iter().zip(edges) {
                let row = position[neighbour as usize];
                if (column + 1..free_count).contains(&(row as usize)) {
                    rows.push(row);
                    edge_of_entry.push(edge);
                }
            }
            column_start.push(rows.len() as u32);
        }
        // Places in a factor are numbers of 32 bits.
        let most = MOST_ENTRIES.saturating_mul(free_count).min(u32::MAX as usize / 2);
        let neighbours = |row: usize| pattern.row(order[row] as usize).0.iter().map(|&row| position[row as usize]);
        let structure = Structure::new(free_count, most, neighbours).ok_or(CholeskyError::Fill(most))?;
        let mut symbolic = Self {
            structure,
            order,
            position,
            size: [row_count, pattern.edges().len()],
            column_start,
            rows,
            edge_of_entry,
            panels: Vec::new(),
            first_panel: vec![0],
            panel_values: 0,
            tallest: 0,
        };
        symbolic.lay_out_panels();
        if symbolic.panel_values > u32::MAX as usize { Err(CholeskyError::Fill(most)) } else { Ok(symbolic) }
    }

    /// Number of rows of the pattern, those that are left out included.
    #[must_use]
    pub fn row_count(&self) -> usize {
        self.size[0]
    }

    /// Number of rows that are not left out.
    #[must_use]
    pub fn free_count(&self) -> usize {
        self.structure.columns()
    }

    /// Numbers in a factor.
    #[must_use]
    pub fn value_count(&self) -> usize {
        self.panel_values
    }

    pub(super) fn check_size(&self, matrix: &impl SymmetricEntries) -> Result<(), CholeskyError> {
        let [rows, edges] = matrix.size();
        CholeskyError::check_length("diagonal", rows, self.size[0])?;
        CholeskyError::check_length("off-diagonal", edges, self.size[1])
    }

    /// Sets `lower` to the numbers of the lower triangle.
    pub(super) fn set_lower(&self, matrix: &impl SymmetricEntries, lower: &mut Vec<f64>) {
        lower.clear();
        for column in 0..self.free_count() {
            let entries = self.column_start[column] as usize..self.column_start[column + 1] as usize;
            lower.extend(self.edge_of_entry[entries].iter().map(|&edge| match edge {
                DIAGONAL => matrix.diagonal(self.order[column] as usize),
                edge => matrix.off_diagonal(edge as usize),
            }));
        }
    }

    /// The panels of a supernode.
    #[inline(always)]
    pub(super) fn panels(&self, supernode: usize) -> &[Panel] {
        &self.panels[self.first_panel[supernode] as usize..self.first_panel[supernode + 1] as usize]
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
}

/// Numbers at the head of a panel: the inverse diagonal and what lies below it within the panel.
pub(super) const fn head(width: usize) -> usize {
    width * (width + 1) / 2
}
