//! Solving with a factor.

use super::symbolic::{Panel, head};
use super::{CholeskyError, Factor, Real, RightSides, Symbolic};

/// Right sides that are solved for at once.
const SIDES: usize = 4;

/// Memory that solving needs and keeps.
#[derive(Clone, Debug)]
pub struct SolveScratch<S: Real = f32> {
    one: Vec<S>,
    below_one: Vec<S>,
    four: Vec<S::Four>,
    below_four: Vec<S::Four>,
}

impl<S: Real> Default for SolveScratch<S> {
    fn default() -> Self {
        Self { one: Vec::new(), below_one: Vec::new(), four: Vec::new(), below_four: Vec::new() }
    }
}

impl Symbolic {
    /// Replaces `x`, `k` right sides, by the solutions of `A x = b`.
    ///
    /// `x` holds `k` numbers for each row, row after row, in the pattern's numbering; rows that are left out get zeros.
    /// Nothing is allocated once `scratch` has been used for as many rows.
    ///
    /// # Errors
    /// [`CholeskyError::Shape`] where the factor is one of another pattern or `x` has another length.
    pub fn solve<S: Real>(
        &self,
        factor: &Factor<S>,
        x: &mut [S],
        k: usize,
        scratch: &mut SolveScratch<S>,
    ) -> Result<(), CholeskyError> {
        CholeskyError::check_length("factor", factor.values.len(), self.value_count())?;
        CholeskyError::check_length("right side", x.len(), self.row_count() * k)?;
        let (free, left_out) = self.order.split_at(self.free_count());
        for &row in left_out {
            x[row as usize * k..][..k].fill(S::default());
        }
        if k == 1 {
            scratch.one.clear();
            scratch.one.extend(free.iter().map(|&row| x[row as usize]));
            self.solve_lanes(&factor.values, &mut scratch.one, &mut scratch.below_one);
            for (&row, &value) in free.iter().zip(&scratch.one) {
                x[row as usize] = value;
            }
            return Ok(());
        }
        for first in (0..k).step_by(SIDES) {
            let sides = SIDES.min(k - first);
            let place = |row: u32| row as usize * k + first..row as usize * k + first + sides;
            scratch.four.clear();
            scratch.four.extend(free.iter().map(|&row| {
                let mut numbers = [S::default(); SIDES];
                numbers[..sides].copy_from_slice(&x[place(row)]);
                S::four(numbers)
            }));
            self.solve_lanes(&factor.values, &mut scratch.four, &mut scratch.below_four);
            for (&row, &four) in free.iter().zip(&scratch.four) {
                x[place(row)].copy_from_slice(&S::numbers(four)[..sides]);
            }
        }
        Ok(())
    }

    /// Replaces `x` by `A^-1 x`: four right sides, one per lane, a number for each row that is not left out, in the order
    /// of elimination. The fastest way for who keeps vectors in that order.
    ///
    /// # Panics
    /// Where the factor is one of another pattern, or `x` is shorter than the rows.
    pub fn solve_in_order<S: Real>(&self, factor: &Factor<S>, x: &mut [S::Four], scratch: &mut Vec<S::Four>) {
        self.solve_lanes(&factor.values, x, scratch);
    }

    fn solve_lanes<S: Real, V: RightSides<S>>(&self, values: &[S], x: &mut [V], scratch: &mut Vec<V>) {
        scratch.resize(self.tallest, V::default());
        for supernode in 0..self.structure.supernodes() {
            let node = self.structure.supernode(supernode);
            let columns = node.columns();
            let below = &mut scratch[..node.height()];
            below[..columns].copy_from_slice(&x[node.start..node.end]);
            below[columns..].fill(V::default());
            for (panel, values) in self.panels_of(supernode, values) {
                let rows = &mut below[panel.column as usize..];
                match panel.width {
                    4 => forward::<4, S, V>(values, rows),
                    3 => forward::<3, S, V>(values, rows),
                    2 => forward::<2, S, V>(values, rows),
                    _ => forward::<1, S, V>(values, rows),
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
            for (panel, values) in self.panels_of(supernode, values).rev() {
                let rows = &mut below[panel.column as usize..];
                match panel.width {
                    4 => backward::<4, S, V>(values, rows),
                    3 => backward::<3, S, V>(values, rows),
                    2 => backward::<2, S, V>(values, rows),
                    _ => backward::<1, S, V>(values, rows),
                }
            }
            x[node.start..node.end].copy_from_slice(&below[..columns]);
        }
    }

    /// The panels of a supernode, and the numbers from each of them on.
    fn panels_of<'a, S>(
        &'a self,
        supernode: usize,
        values: &'a [S],
    ) -> impl DoubleEndedIterator<Item = (&'a Panel, &'a [S])> {
        self.panels(supernode).iter().map(|panel| (panel, &values[panel.start as usize..]))
    }
}

#[inline(always)]
fn forward<const W: usize, S: Real, V: RightSides<S>>(values: &[S], rows: &mut [V]) {
    let (own, below) = rows.split_at_mut(W);
    let (head, values) = values.split_at(head(W));
    let mut y = [V::default(); W];
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
fn backward<const W: usize, S: Real, V: RightSides<S>>(values: &[S], rows: &mut [V]) {
    let (own, below) = rows.split_at_mut(W);
    let (head, values) = values.split_at(head(W));
    let mut sums = [V::default(); W];
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
