//! What is asked of single unknowns beside the system itself.

use super::factor::{Factor, Workspace};
use super::{CholeskyError, Real, SolveScratch, Symbolic, SymmetricEntries};

/// Places of rows that no constraint names.
const NONE: u32 = u32::MAX;

/// What is asked of single rows of `x` beside `A x = b`, whatever the values that are wanted there: those are given when
/// the system is solved.
///
/// - A *soft* constraint of weight `w` adds `w (x_i - d_i)^2` to what is minimised, `x^T A x - 2 b^T x`: a row of a weighted
///   diagonal, `(A + W) x = b + W d`.
/// - A *hard* constraint is `x_i = d_i`: the unknown is eliminated, and what its column comes to moves to the right side.
///
/// Weights are in the unit of the matrix: beside cotangent Laplacians, whose diagonal is about 4 to 6, a weight of 30 holds a
/// vertex to a fraction of a millimetre.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constraints {
    rows: Vec<u32>,
    /// Infinite where hard.
    weights: Vec<f64>,
}

impl Constraints {
    /// None yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks for a row softly, with a positive weight. Constraints are numbered as they are made.
    pub fn soft(&mut self, row: u32, weight: f64) {
        self.rows.push(row);
        // Not to be taken for a hard one.
        self.weights.push(if weight == f64::INFINITY { f64::NAN } else { weight });
    }

    /// Holds a row.
    pub fn hard(&mut self, row: u32) {
        self.rows.push(row);
        self.weights.push(f64::INFINITY);
    }

    /// Forgets all constraints.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.weights.clear();
    }

    /// The rows that are constrained, in the order of the constraints.
    #[must_use]
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// The constraints' weights, infinite where they are hard.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }
}

/// The factor of a matrix under constraints, and what its right sides need.
///
/// Changing constraints changes numbers only: the analysis of the pattern serves them all.
///
/// ```
/// use kernels::cholesky::{
///     ConstrainedFactor, Constraints, EliminationOrder, SolveScratch, Symbolic, SymmetricMatrix, SymmetricPattern, Workspace,
/// };
///
/// // A chain of five places, each of which wants to be in the middle between its neighbours.
/// let pattern = SymmetricPattern::from_edges(5, &[[0, 1], [1, 2], [2, 3], [3, 4]])?;
/// let mut matrix = SymmetricMatrix::zeros(&pattern);
/// for &[a, b] in pattern.edges() {
///     matrix.add_equation(&pattern, &[(a, 1.0), (b, -1.0)], 1.0)?;
/// }
/// let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern))?;
/// let mut workspace = Workspace::default();
///
/// // One end is held, the other one drawn.
/// let mut constraints = Constraints::new();
/// constraints.hard(0);
/// constraints.soft(4, 0.25);
/// let mut factor = ConstrainedFactor::<f64>::new(&symbolic, &matrix, &constraints, &mut workspace)?;
///
/// // Two columns at once, x and y.
/// let wanted = [1.0, 0.0, 9.0, 4.0];
/// let mut places = [0.0; 10];
/// let mut scratch = SolveScratch::default();
/// factor.solve(&symbolic, &wanted, 2, &mut places, &mut scratch)?;
/// for (k, place) in places.chunks(2).enumerate() {
///     assert!((place[0] - (1.0 + k as f64)).abs() < 1e-12 && (place[1] - 0.5 * k as f64).abs() < 1e-12);
/// }
///
/// // Drawn harder: no factorisation is needed.
/// factor.set_weight(&symbolic, 4, 1e6, &mut workspace)?;
/// places.fill(0.0);
/// factor.solve(&symbolic, &wanted, 2, &mut places, &mut scratch)?;
/// assert!((places[8] - 9.0).abs() < 1e-5);
/// # Ok::<(), kernels::cholesky::CholeskyError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ConstrainedFactor<S = f32> {
    factor: Factor<S>,
    constraints: Constraints,
    /// Entries of the matrix between a free row and one that a hard constraint holds.
    couplings: Vec<Coupling<S>>,
}

#[derive(Clone, Copy, Debug)]
struct Coupling<S> {
    row: u32,
    constraint: u32,
    entry: S,
}

impl<S: Real> ConstrainedFactor<S> {
    /// Factorises `matrix` under `constraints`.
    ///
    /// # Errors
    /// [`CholeskyError::Constraint`] where a constraint is none; otherwise as [`Symbolic::factorise`].
    pub fn new(
        symbolic: &Symbolic,
        matrix: &impl SymmetricEntries,
        constraints: &Constraints,
        workspace: &mut Workspace,
    ) -> Result<Self, CholeskyError> {
        let mut factor = Self { factor: Factor::default(), constraints: Constraints::default(), couplings: Vec::new() };
        factor.refactorise(symbolic, matrix, constraints, workspace)?;
        Ok(factor)
    }

    /// Factorises another matrix, or under other constraints, in the same memory. Where that fails, all stays as it was.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn refactorise(
        &mut self,
        symbolic: &Symbolic,
        matrix: &impl SymmetricEntries,
        constraints: &Constraints,
        workspace: &mut Workspace,
    ) -> Result<(), CholeskyError> {
        symbolic.check_size(matrix)?;
        number_constraints(symbolic, constraints, &mut workspace.constraint_of_row)?;
        symbolic.set_lower(matrix, &mut workspace.lower);
        constrain(symbolic, constraints, workspace);
        symbolic.factorise_lower(workspace, &mut self.factor)?;
        // Into the memory that is there.
        self.constraints.rows.clone_from(&constraints.rows);
        self.constraints.weights.clone_from(&constraints.weights);
        self.couplings.clear();
        self.couplings.extend(workspace.couplings.iter().map(|&(row, constraint, entry)| Coupling {
            row,
            constraint,
            entry: S::from_f64(entry),
        }));
        Ok(())
    }

    /// The constraints, weights as they are now.
    #[must_use]
    pub fn constraints(&self) -> &Constraints {
        &self.constraints
    }

    /// Replaces `x`, `k` right sides, by the solutions under the constraints.
    ///
    /// `x` holds `k` numbers for each row, row after row; `wanted` the `k` numbers that each constraint wants, in the order
    /// of the constraints. Rows under a hard constraint get what is wanted to the bit, whatever their right side is. Nothing
    /// is allocated once `scratch` has been used for as many rows.
    ///
    /// # Errors
    /// [`CholeskyError::Shape`] where lengths do not fit.
    pub fn solve(
        &self,
        symbolic: &Symbolic,
        wanted: &[S],
        k: usize,
        x: &mut [S],
        scratch: &mut SolveScratch<S>,
    ) -> Result<(), CholeskyError> {
        CholeskyError::check_length("factor", self.factor.values.len(), symbolic.value_count())?;
        CholeskyError::check_length("wanted values", wanted.len(), self.constraints.rows.len() * k)?;
        CholeskyError::check_length("right side", x.len(), symbolic.row_count() * k)?;
        let wanted_by = |constraint: usize| &wanted[constraint * k..][..k];
        for coupling in &self.couplings {
            let own = &mut x[coupling.row as usize * k..][..k];
            for (own, &wanted) in own.iter_mut().zip(wanted_by(coupling.constraint as usize)) {
                *own -= wanted * coupling.entry;
            }
        }
        for (constraint, (&row, &weight)) in self.constraints.rows.iter().zip(&self.constraints.weights).enumerate() {
            let own = &mut x[row as usize * k..][..k];
            if weight == f64::INFINITY {
                own.copy_from_slice(wanted_by(constraint));
                continue;
            }
            for (own, &wanted) in own.iter_mut().zip(wanted_by(constraint)) {
                *own += wanted * S::from_f64(weight);
            }
        }
        symbolic.solve(&self.factor, x, k, scratch)
    }

    /// Sets the weight of the soft constraint on `row`, without factorising: see [`Symbolic::update`]. A weight of zero
    /// releases the row; a row that had no constraint gets one, the last.
    ///
    /// # Errors
    /// [`CholeskyError::Constraint`] where the row is under a hard constraint, or the weight is not finite or negative;
    /// otherwise as [`Symbolic::update`]. All stays as it was.
    pub fn set_weight(
        &mut self,
        symbolic: &Symbolic,
        row: u32,
        weight: f64,
        workspace: &mut Workspace,
    ) -> Result<(), CholeskyError> {
        let known = self.constraints.rows.iter().position(|&other| other == row);
        let index = known.unwrap_or(self.constraints.rows.len());
        let before = known.map_or(0.0, |index| self.constraints.weights[index]);
        let refuse = |reason| Err(CholeskyError::Constraint { index, row, reason });
        if before == f64::INFINITY {
            return refuse("it is a hard one");
        }
        if !(weight.is_finite() && weight >= 0.0) {
            return refuse("its weight is not a positive number");
        }
        if symbolic.position.get(row as usize).is_some_and(|&at| at as usize >= symbolic.free_count()) {
            return refuse("the row is left out");
        }
        symbolic.update(&mut self.factor, weight - before, &[(row, 1.0)], workspace)?;
        if known.is_none() {
            self.constraints.soft(row, weight);
        }
        self.constraints.weights[index] = weight;
        Ok(())
    }
}

/// Sets `constraint_of_row`, by position, having checked the constraints.
fn number_constraints(
    symbolic: &Symbolic,
    constraints: &Constraints,
    constraint_of_row: &mut Vec<u32>,
) -> Result<(), CholeskyError> {
    constraint_of_row.clear();
    constraint_of_row.resize(symbolic.free_count(), NONE);
    for (index, (&row, &weight)) in constraints.rows.iter().zip(&constraints.weights).enumerate() {
        let refuse = |reason| Err(CholeskyError::Constraint { index, row, reason });
        let Some(&position) = symbolic.position.get(row as usize) else {
            return Err(CholeskyError::NoRow { row, row_count: symbolic.row_count() });
        };
        // Zero is what a released row has.
        if weight.is_nan() || weight < 0.0 {
            return refuse("its weight is not a positive number");
        }
        match constraint_of_row.get_mut(position as usize) {
            Some(slot) if *slot == NONE => *slot = index as u32,
            Some(_) => return refuse("the row has one already"),
            None => return refuse("the row is left out"),
        }
    }
    Ok(())
}

/// Adds the weights of soft constraints to the diagonal of the lower triangle, and cuts off the rows of hard ones.
fn constrain(symbolic: &Symbolic, constraints: &Constraints, workspace: &mut Workspace) {
    let Workspace { lower, constraint_of_row, couplings, .. } = workspace;
    let hard = |position: usize| {
        let constraint = constraint_of_row[position];
        (constraint != NONE && constraints.weights[constraint as usize] == f64::INFINITY).then_some(constraint)
    };
    couplings.clear();
    for column in 0..symbolic.free_count() {
        let [start, end] = [0, 1].map(|next| symbolic.column_start[column + next] as usize);
        let own = hard(column);
        match constraint_of_row[column] {
            NONE => {}
            _ if own.is_some() => lower[start] = 1.0,
            constraint => lower[start] += constraints.weights[constraint as usize],
        }
        for entry in start + 1..end {
            let row = symbolic.rows[entry] as usize;
            let held = match (own, hard(row)) {
                (None, None) => continue,
                (Some(_), Some(_)) => None,
                (Some(constraint), None) => Some((row, constraint)),
                (None, Some(constraint)) => Some((column, constraint)),
            };
            let entry = std::mem::take(&mut lower[entry]);
            couplings.extend(held.map(|(free, constraint)| (symbolic.order[free], constraint, entry)));
        }
    }
}
