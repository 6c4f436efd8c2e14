//! Dynamic time warping over grids: all end cells of eight neighbouring start cells at a time.
//!
//! Thesis section 2.5.2. The grid of the start cell (i, c) has the node (k, l) for frames i + k and c + l. With the
//! slope limit p (thesis equation 2.53), a move is a diagonal step and then up to p - 1 straight ones, and all the
//! nodes it passes count. With g the least key to a node that ends a move and e a node's own key:
//!
//! ```text
//! step(k, l)   = g(k - 1, l - 1) + e       a move's diagonal step
//! down_1(k, l) = step(k - 1, l) + e        ... and its first straight step in the source
//! down_2(k, l) = down_1(k - 1, l) + e      ... and so on to down_(p - 1); likewise across_q in the destination
//! g(k, l)      = min(step, down_1 .. down_(p - 1), across_1 .. across_(p - 1))
//! ```

/// Start cells of a block.
pub(super) const LANES: usize = 8;

/// A value for each start cell of a block.
pub(super) type Lanes = [f64; LANES];

const NONE: Lanes = [f64::INFINITY; LANES];

#[inline(always)]
fn add(a: Lanes, b: Lanes) -> Lanes {
    let mut sum = NONE;
    for lane in 0..LANES {
        sum[lane] = a[lane] + b[lane];
    }
    sum
}

#[inline(always)]
fn min(a: Lanes, b: Lanes) -> Lanes {
    let mut least = NONE;
    for lane in 0..LANES {
        least[lane] = if a[lane] < b[lane] { a[lane] } else { b[lane] };
    }
    least
}

/// What a column of the grid leaves for the next one, with the slope limit p = STRAIGHTS + 1.
#[derive(Default)]
pub(super) struct Columns<const STRAIGHTS: usize> {
    /// g(k, l).
    least: Vec<Lanes>,
    /// step(k, l), then across_1(k, l) .. across_(p - 2)(k, l).
    across: Vec<[Lanes; STRAIGHTS]>,
}

/// The keys of the nodes around some start cells: row k holds those of (i + k, first column ..).
pub(super) struct Nodes<'a> {
    pub(super) keys: &'a [f64],
    pub(super) width: usize,
    pub(super) rows: usize,
}

impl Nodes<'_> {
    #[inline(always)]
    fn at(&self, row: usize, column: usize) -> Lanes {
        let start = row * self.width + column;
        let mut lanes = NONE;
        lanes.copy_from_slice(&self.keys[start..start + LANES]);
        lanes
    }
}

/// What becomes of the nodes of a column that can end a path.
pub(super) trait Lowest {
    /// Called with the least keys to a node.
    fn visit(&mut self, least: Lanes);
}

/// A slope limit: how a grid's column follows from the one before.
pub(super) trait Slope {
    /// Forgets all columns; grids of `rows` rows follow.
    fn reset(&mut self, rows: usize);

    /// Fills in column `column` of the grids that start at columns `start..` of `nodes`, after the column before it,
    /// and shows `lowest` the least key to each of the nodes that can be reached, from row `from` on.
    fn fill(&mut self, nodes: &Nodes, start: usize, column: usize, from: usize, lowest: &mut impl Lowest);

    /// The least keys of the column last filled in, by row.
    fn least(&self) -> &[Lanes];
}

/// The slope limit p = STRAIGHTS + 1, for p >= 2.
impl<const STRAIGHTS: usize> Slope for Columns<STRAIGHTS> {
    #[inline(always)]
    fn reset(&mut self, rows: usize) {
        self.least.clear();
        self.least.resize(rows, NONE);
        self.across.clear();
        self.across.resize(rows, [NONE; STRAIGHTS]);
    }

    #[inline(always)]
    fn fill(&mut self, nodes: &Nodes, start: usize, column: usize, from: usize, lowest: &mut impl Lowest) {
        if column == 0 {
            self.least[0] = nodes.at(0, start);
            if from == 0 {
                lowest.visit(self.least[0]);
            }
            return;
        }
        // No path leaves the cone of slopes 1 / p to p.
        let p = STRAIGHTS + 1;
        let (first, end) = (column.div_ceil(p), nodes.rows.min(p * column + 1));
        if first >= end {
            return;
        }
        let mut diagonal = std::mem::replace(&mut self.least[first - 1], NONE);
        // step(k - 1, l), then down_1(k - 1, l) .. down_(p - 2)(k - 1, l).
        let mut above = [NONE; STRAIGHTS];
        let (least, across) = (&mut self.least[first..end], &mut self.across[first..end]);
        for (offset, (least, left)) in least.iter_mut().zip(across).enumerate() {
            let row = first + offset;
            let node = nodes.at(row, start + column);
            let step = add(diagonal, node);
            // The last straight steps need not be told apart.
            let mut best = min(step, add(min(above[STRAIGHTS - 1], left[STRAIGHTS - 1]), node));
            for q in (1..STRAIGHTS).rev() {
                (above[q], left[q]) = (add(above[q - 1], node), add(left[q - 1], node));
                best = min(best, min(above[q], left[q]));
            }
            (above[0], left[0]) = (step, step);
            diagonal = std::mem::replace(least, best);
            if row >= from {
                lowest.visit(best);
            }
        }
    }

    #[inline(always)]
    fn least(&self) -> &[Lanes] {
        &self.least
    }
}

/// The slope limit p = 1: diagonal steps only.
#[derive(Default)]
pub(super) struct Diagonal {
    least: Vec<Lanes>,
}

impl Slope for Diagonal {
    #[inline(always)]
    fn reset(&mut self, rows: usize) {
        self.least.clear();
        self.least.resize(rows, NONE);
    }

    #[inline(always)]
    fn fill(&mut self, nodes: &Nodes, start: usize, column: usize, from: usize, lowest: &mut impl Lowest) {
        let before = match column.checked_sub(1) {
            None => [0.0; LANES],
            Some(before) => self.least.get_mut(before).map_or(NONE, |least| std::mem::replace(least, NONE)),
        };
        // A grid of fewer rows than columns ends early.
        if column < nodes.rows {
            self.least[column] = add(before, nodes.at(column, start + column));
            if column >= from {
                lowest.visit(self.least[column]);
            }
        }
    }

    #[inline(always)]
    fn least(&self) -> &[Lanes] {
        &self.least
    }
}

/// No slope limit: thesis equation 2.52.
#[derive(Default)]
pub(super) struct Unlimited {
    least: Vec<Lanes>,
}

impl Slope for Unlimited {
    #[inline(always)]
    fn reset(&mut self, rows: usize) {
        self.least.clear();
        self.least.resize(rows, NONE);
    }

    #[inline(always)]
    fn fill(&mut self, nodes: &Nodes, start: usize, column: usize, from: usize, lowest: &mut impl Lowest) {
        let mut diagonal = if column == 0 { [0.0; LANES] } else { NONE };
        let mut above = NONE;
        for (row, least) in self.least.iter_mut().enumerate() {
            above = add(min(min(diagonal, *least), above), nodes.at(row, start + column));
            diagonal = std::mem::replace(least, above);
            if row >= from {
                lowest.visit(above);
            }
        }
    }

    #[inline(always)]
    fn least(&self) -> &[Lanes] {
        &self.least
    }
}
