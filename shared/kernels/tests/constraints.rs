//! Systems under soft and hard constraints against their dense twins.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod systems;

use kernels::cholesky::{
    CholeskyError, ConstrainedFactor, Constraints, EliminationOrder, Real, SolveScratch, Symbolic, SymmetricMatrix,
    SymmetricPattern, Workspace,
};
use proptest::prelude::*;
use systems::{Random, dense, dense_solve, difference, doubles, laplacian, patterns, positive, sheet, singles};

/// Some rows under soft constraints and some under hard ones.
fn some_constraints(rows: usize, random: &mut Random) -> Constraints {
    let mut constraints = Constraints::new();
    let count = random.below(rows + 1);
    for &row in random.shuffled(rows).iter().take(count) {
        if random.next() < 0.5 {
            constraints.hard(row);
        } else {
            constraints.soft(row, 0.01 + 30.0 * random.next());
        }
    }
    constraints
}

/// The same by a dense system in which hard rows are written as `x_i = d_i`.
fn plain(
    pattern: &SymmetricPattern,
    matrix: &SymmetricMatrix,
    constraints: &Constraints,
    wanted: &[f64],
    right: &[f64],
    k: usize,
) -> Vec<f64> {
    let (mut full, mut right) = (dense(pattern, matrix), right.to_vec());
    for (index, (&row, &weight)) in constraints.rows().iter().zip(constraints.weights()).enumerate() {
        let row = row as usize;
        if weight.is_finite() {
            full[(row, row)] += weight;
        } else {
            (0..full.ncols()).for_each(|column| full[(row, column)] = f64::from(u8::from(row == column)));
        }
        for side in 0..k {
            let wanted = wanted[index * k + side];
            let own = &mut right[row * k + side];
            *own = if weight.is_finite() { *own + weight * wanted } else { wanted };
        }
    }
    dense_solve(&full, &right, k)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn solutions_are_those_of_the_dense_system(pattern in patterns(), seed: u64, k in 1..6_usize) {
        let mut random = Random::new(seed);
        let n = pattern.row_count();
        let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern)).unwrap();
        let mut workspace = Workspace::default();
        let first = positive(&pattern, 0.2, &mut random);
        let mut factor =
            ConstrainedFactor::<f64>::new(&symbolic, &first, &Constraints::new(), &mut workspace).unwrap();
        // The same memory again and again, for other matrices and constraints.
        for _ in 0..3 {
            let matrix = positive(&pattern, 0.2, &mut random);
            let constraints = some_constraints(n, &mut random);
            factor.refactorise(&symbolic, &matrix, &constraints, &mut workspace).unwrap();
            let (wanted, right) = (random.numbers(constraints.rows().len() * k), random.numbers(n * k));
            let expected = plain(&pattern, &matrix, &constraints, &wanted, &right, k);
            let mut x = right.clone();
            factor.solve(&symbolic, &wanted, k, &mut x, &mut SolveScratch::default()).unwrap();
            prop_assert!(difference(&x, &expected) < 1e-11, "{}", difference(&x, &expected));
            check_hard(&constraints, &wanted, &x, k);

            let single = ConstrainedFactor::<f32>::new(&symbolic, &matrix, &constraints, &mut workspace).unwrap();
            let (wanted, mut x) = (singles(&wanted), singles(&right));
            single.solve(&symbolic, &wanted, k, &mut x, &mut SolveScratch::default()).unwrap();
            prop_assert!(difference(&doubles(&x), &expected) < 2e-4);
            check_hard(&constraints, &wanted, &x, k);
        }
    }

    #[test]
    fn weights_that_change_give_the_factor_anew(pattern in patterns(), seed: u64) {
        let mut random = Random::new(seed);
        let (n, k) = (pattern.row_count(), 2);
        let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern)).unwrap();
        let mut workspace = Workspace::default();
        let matrix = positive(&pattern, 0.2, &mut random);
        let constraints = some_constraints(n, &mut random);
        let mut double = ConstrainedFactor::<f64>::new(&symbolic, &matrix, &constraints, &mut workspace).unwrap();
        let mut single = ConstrainedFactor::<f32>::new(&symbolic, &matrix, &constraints, &mut workspace).unwrap();
        for _ in 0..12 {
            let row = random.below(n) as u32;
            let weight = if random.next() < 0.4 { 0.0 } else { 10.0 * random.next() };
            let place = constraints.rows().iter().position(|&other| other == row);
            if let Some(index) = place.filter(|&index| constraints.weights()[index].is_infinite()) {
                let error = double.set_weight(&symbolic, row, weight, &mut workspace);
                let refused = CholeskyError::Constraint { index, row, reason: "it is a hard one" };
                prop_assert_eq!(error, Err(refused));
                continue;
            }
            double.set_weight(&symbolic, row, weight, &mut workspace).unwrap();
            single.set_weight(&symbolic, row, weight, &mut workspace).unwrap();
        }
        prop_assert_eq!(double.constraints(), single.constraints());
        let now = double.constraints().clone();
        let (wanted, right) = (random.numbers(now.rows().len() * k), random.numbers(n * k));
        let expected = plain(&pattern, &matrix, &now, &wanted, &right, k);
        let mut x = right.clone();
        double.solve(&symbolic, &wanted, k, &mut x, &mut SolveScratch::default()).unwrap();
        prop_assert!(difference(&x, &expected) < 1e-10, "{}", difference(&x, &expected));
        let (wanted, mut x) = (singles(&wanted), singles(&right));
        single.solve(&symbolic, &wanted, k, &mut x, &mut SolveScratch::default()).unwrap();
        prop_assert!(difference(&doubles(&x), &expected) < 2e-3, "{}", difference(&doubles(&x), &expected));
    }
}

/// Hard constraints are met to the bit.
fn check_hard<S: Real>(constraints: &Constraints, wanted: &[S], x: &[S], k: usize) {
    for (index, (&row, &weight)) in constraints.rows().iter().zip(constraints.weights()).enumerate() {
        assert!(weight.is_finite() || x[row as usize * k..][..k] == wanted[index * k..][..k]);
    }
}

#[test]
fn parts_that_are_tied_follow_each_other() {
    // Two sheets of which one is drawn up; a tie takes the other one along.
    let (width, height) = (5, 4);
    let n = width * height;
    let both: Vec<[u32; 3]> = sheet(width, height).iter().flat_map(|t| [*t, t.map(|vertex| vertex + n)]).collect();
    let apart = SymmetricPattern::from_triangles(2 * n as usize, &both).unwrap();
    let tied = apart.with_edges(&[[3, n + 7]]).unwrap();
    let mut constraints = Constraints::new();
    constraints.hard(0);
    let mut workspace = Workspace::default();
    let mut attempt = |pattern: &SymmetricPattern| {
        let matrix = laplacian(pattern, &vec![1.0; pattern.edges().len()]);
        let symbolic = Symbolic::new(pattern, &EliminationOrder::minimum_degree(pattern))?;
        let factor = ConstrainedFactor::<f64>::new(&symbolic, &matrix, &constraints, &mut workspace)?;
        let mut x = vec![0.0; 2 * n as usize];
        factor.solve(&symbolic, &[1.0], 1, &mut x, &mut SolveScratch::default())?;
        Ok(x)
    };
    assert!(matches!(attempt(&apart), Err(CholeskyError::NotPositive { row, .. }) if row >= n));
    assert!(attempt(&tied).unwrap().iter().all(|x| (x - 1.0_f64).abs() < 1e-10));
}

#[test]
fn constraints_that_are_none_are_refused() {
    let pattern = SymmetricPattern::from_edges(3, &[[0, 1], [1, 2]]).unwrap();
    let matrix = laplacian(&pattern, &[1.0, 1.0]);
    let symbolic = Symbolic::new(&pattern, &EliminationOrder::natural(3)).unwrap();
    let mut workspace = Workspace::default();
    let mut good = Constraints::new();
    good.hard(0);
    let mut factor = ConstrainedFactor::<f64>::new(&symbolic, &matrix, &good, &mut workspace).unwrap();
    let refused = |row, reason| CholeskyError::Constraint { index: 1, row, reason };
    type Change<'a> = &'a dyn Fn(&mut Constraints);
    let cases: [(Change, CholeskyError); 6] = [
        (&|c| c.soft(1, -1.0), refused(1, "its weight is not a positive number")),
        (&|c| c.soft(1, f64::NAN), refused(1, "its weight is not a positive number")),
        (&|c| c.soft(1, f64::INFINITY), refused(1, "its weight is not a positive number")),
        (&|c| c.soft(0, 1.0), refused(0, "the row has one already")),
        (&|c| c.hard(0), refused(0, "the row has one already")),
        (&|c| c.hard(3), CholeskyError::NoRow { row: 3, row_count: 3 }),
    ];
    let mut scratch = SolveScratch::default();
    for (make, expected) in cases {
        let mut constraints = good.clone();
        make(&mut constraints);
        let error = factor.refactorise(&symbolic, &matrix, &constraints, &mut workspace).unwrap_err();
        assert_eq!(error, expected);
        // The factor before still stands.
        assert_eq!(factor.constraints(), &good);
        let mut x = [0.0; 3];
        factor.solve(&symbolic, &[5.0], 1, &mut x, &mut scratch).unwrap();
        assert!(x.iter().all(|x| (x - 5.0).abs() < 1e-12));
    }
    let out = Symbolic::of_first(&pattern, &EliminationOrder::natural(3), 2).unwrap();
    let mut left_out = Constraints::new();
    left_out.soft(2, 1.0);
    let error = ConstrainedFactor::<f64>::new(&out, &matrix, &left_out, &mut workspace).unwrap_err();
    assert_eq!(error, CholeskyError::Constraint { index: 0, row: 2, reason: "the row is left out" });
    for weight in [-1.0, f64::NAN, f64::INFINITY] {
        let error = factor.set_weight(&symbolic, 1, weight, &mut workspace).unwrap_err();
        assert_eq!(error, refused(1, "its weight is not a positive number"));
    }
    let shape = CholeskyError::Shape { what: "wanted values", found: 2, expected: 1 };
    assert_eq!(factor.solve(&symbolic, &[5.0, 1.0], 1, &mut [0.0; 3], &mut scratch), Err(shape));
    let shape = CholeskyError::Shape { what: "right side", found: 2, expected: 3 };
    assert_eq!(factor.solve(&symbolic, &[5.0], 1, &mut [0.0; 2], &mut scratch), Err(shape));
    let gone = factor.set_weight(&symbolic, 3, 1.0, &mut workspace);
    assert_eq!(gone, Err(CholeskyError::NoRow { row: 3, row_count: 3 }));
}
