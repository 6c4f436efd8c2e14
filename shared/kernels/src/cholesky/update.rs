//! Small changes of a matrix, taken over into its factor.
//!
//! This work is based on: Davis and Hager, "Modifying a sparse Cholesky factorization" (1999): a change `w w^T` touches
//! the columns on the way from its first row up to the root of the elimination tree alone. Numbers follow method C1 of
//! Gill, Golub, Murray and Saunders, "Methods for modifying matrix factorizations" (1974), whose pivots cannot turn negative
//! where the changed matrix is positive definite.

use super::factor::Workspace;
use super::symbolic::head;
use super::{CholeskyError, Factor, Real, Symbolic};

impl Symbolic {
    /// Takes the change of a factored matrix `A` to `A + weight w w^T` over into its factor; `w` is given by its entries,
    /// those of a row that is named twice being added. With one entry that is a change of the diagonal; with 1 and -1 at both
    /// ends of an edge, one of that edge's weight in a Laplacian.
    ///
    /// It costs about as much as a solve, a small part of a factorisation. Entries in rows that are left out do not count.
    ///
    /// Each change rounds the factor once more, and what is taken away (`weight` below 0) takes digits with it: factorise
    /// anew from time to time.
    ///
    /// # Errors
    /// The factor stays as it was in each case. [`CholeskyError::Downdate`] where the changed matrix is not positive
    /// definite, or the factor would lose more than half of its digits; [`CholeskyError::NoEntry`] where the change needs an entry that the factor
    /// lacks: all pairs of rows that are edges of the pattern are safe. [`CholeskyError::NoRow`],
    /// [`CholeskyError::NotFiniteRow`], and [`CholeskyError::Shape`] for a factor of another pattern.
    pub fn update<S: Real>(
        &self,
        factor: &mut Factor<S>,
        weight: f64,
        w: &[(u32, f64)],
        workspace: &mut Workspace,
    ) -> Result<(), CholeskyError> {
        CholeskyError::check_length("factor", factor.values.len(), self.value_count())?;
        let Some(first) = self.first_touched(weight, w)? else { return Ok(()) };
        let vector = &mut workspace.vector;
        vector.resize(self.free_count(), 0.0);
        let sign = weight.signum();
        let outcome = if sign < 0.0 {
            // A change that fails half-way would leave half a factor: it is tried without writing.
            self.scatter(weight, w, vector);
            self.sweep(first, sign, vector, Trial(&factor.values))
        } else {
            Ok(())
        };
        if outcome.is_ok() {
            self.clear(first, vector);
            self.scatter(weight, w, vector);
            self.sweep(first, sign, vector, Change(&mut factor.values))?;
        }
        self.clear(first, vector);
        outcome
    }

    /// The first position that a change touches, having checked it; `None` where it changes nothing.
    fn first_touched(&self, weight: f64, w: &[(u32, f64)]) -> Result<Option<usize>, CholeskyError> {
        let mut first = None;
        for &(row, value) in w {
            let Some(&position) = self.position.get(row as usize) else {
                return Err(CholeskyError::NoRow { row, row_count: self.row_count() });
            };
            if !(value * value * weight).is_finite() {
                return Err(CholeskyError::NotFiniteRow { row });
            }
            if value != 0.0 && (position as usize) < self.free_count() {
                first = Some(first.map_or(position, |first: u32| first.min(position)));
            }
        }
        let Some(first) = first.filter(|_| weight != 0.0) else { return Ok(None) };
        let node = self.structure.supernode(self.structure.owner(first as usize));
        for &(row, value) in w {
            let position = self.position[row as usize];
            let reached = (position as usize) < node.end || node.rows.binary_search(&position).is_ok();
            if value != 0.0 && (position as usize) < self.free_count() && !reached {
                return Err(CholeskyError::NoEntry { row, column: self.order[first as usize] });
            }
        }
        Ok(Some(first as usize))
    }

    fn scatter(&self, weight: f64, w: &[(u32, f64)], vector: &mut [f64]) {
        let root = weight.abs().sqrt();
        for &(row, value) in w {
            if let Some(sum) = vector.get_mut(self.position[row as usize] as usize) {
                *sum += root * value;
            }
        }
    }

    /// Sets to zero what a change that begins at `first` has touched.
    fn clear(&self, first: usize, vector: &mut [f64]) {
        for (index, from) in self.path_to_root(first) {
            vector[from..self.structure.supernode(index).end].fill(0.0);
        }
    }

    /// The supernodes on the way from a column to the root, and their first column on it.
    fn path_to_root(&self, first: usize) -> impl Iterator<Item = (usize, usize)> {
        let step = |from: usize| (self.structure.owner(from), from);
        std::iter::successors(Some(step(first)), move |&(index, _)| {
            self.structure.supernode(index).rows.first().map(|&row| step(row as usize))
        })
    }

    /// Changes a factor column by column. With `t` the inverse of what is left of the change, `p` its first entry over the
    /// pivot's root:
    ///
    /// ```text
    /// t' = t + p^2    l_jj' = l_jj sqrt(t' / t)    w' = w - p l_j    l_j' = sqrt(t' / t) (l_j + (p / t') w')
    /// ```
    fn sweep<S: Real>(
        &self,
        first: usize,
        sign: f64,
        w: &mut [f64],
        mut values: impl Values<S>,
    ) -> Result<(), CholeskyError> {
        let mut t = sign;
        for (index, from) in self.path_to_root(first) {
            let node = self.structure.supernode(index);
            for panel in self.panels(index) {
                let (column, width) = (panel.column as usize, panel.width as usize);
                let start = panel.start as usize;
                for j in 0..width {
                    let position = node.start + column + j;
                    if position < from || w[position] == 0.0 {
                        continue;
                    }
                    let p = w[position] * values.get(start + j).to_f64();
                    let next = t + p * p;
                    // Half of the digits at least: what is left is `next / sign` of the matrix, seen from the change.
                    let left = next * sign;
                    if left.is_nan() || left <= S::EPSILON.sqrt() {
                        return Err(CholeskyError::Downdate { row: self.order[position] });
                    }
                    let ratio = (next / t).sqrt();
                    let gain = p / next;
                    t = next;
                    values.set(start + j, S::from_f64(values.get(start + j).to_f64() / ratio));
                    let mut change = |place: usize, w: &mut f64| {
                        let entry = values.get(place).to_f64();
                        *w -= p * entry;
                        values.set(place, S::from_f64(ratio * (entry + gain * *w)));
                    };
                    for row in j + 1..width {
                        change(start + width + row * (row - 1) / 2 + j, &mut w[node.start + column + row]);
                    }
                    let mut place = start + head(width) + j;
                    for row in node.start + column + width..node.end {
                        change(place, &mut w[row]);
                        place += width;
                    }
                    for &row in node.rows {
                        change(place, &mut w[row as usize]);
                        place += width;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Numbers of a factor that may be changed.
trait Values<S> {
    fn get(&self, place: usize) -> S;
    fn set(&mut self, place: usize, value: S);
}

/// Changes that are not made.
struct Trial<'a, S>(&'a [S]);

impl<S: Copy> Values<S> for Trial<'_, S> {
    fn get(&self, place: usize) -> S {
        self.0[place]
    }

    fn set(&mut self, _: usize, _: S) {}
}

/// Changes that are.
struct Change<'a, S>(&'a mut [S]);

impl<S: Copy> Values<S> for Change<'_, S> {
    fn get(&self, place: usize) -> S {
        self.0[place]
    }

    fn set(&mut self, place: usize, value: S) {
        self.0[place] = value;
    }
}
