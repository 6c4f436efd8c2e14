//! Factors of any symmetric matrix against general dense and sparse solutions of faer.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod systems;

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use kernels::cholesky::{
    CholeskyError, EliminationOrder, Factor, SolveScratch, Symbolic, SymmetricMatrix, SymmetricPattern, Workspace,
    solve_once,
};
use proptest::prelude::*;
use systems::{Random, dense, dense_solve, difference, doubles, laplacian, patterns, positive, sheet, singles};

/// Three orders of elimination: a good one, the rows', and any.
fn orders(pattern: &SymmetricPattern, random: &mut Random) -> [EliminationOrder; 3] {
    let n = pattern.row_count();
    [
        EliminationOrder::minimum_degree(pattern),
        EliminationOrder::natural(n),
        EliminationOrder::new(n, random.shuffled(n)).unwrap(),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn solutions_are_those_of_the_dense_matrix(pattern in patterns(), seed: u64, k in 1..10_usize) {
        let mut random = Random::new(seed);
        let matrix = positive(&pattern, 0.2, &mut random);
        let right = random.numbers(pattern.row_count() * k);
        let expected = dense_solve(&dense(&pattern, &matrix), &right, k);
        let mut workspace = Workspace::default();
        let (mut double, mut single) = (SolveScratch::default(), SolveScratch::default());
        for order in orders(&pattern, &mut random) {
            let symbolic = Symbolic::new(&pattern, &order).unwrap();
            let factor = symbolic.factorise(&matrix, &mut workspace).unwrap();
            let mut x = right.clone();
            symbolic.solve(&factor, &mut x, k, &mut double).unwrap();
            prop_assert!(difference(&x, &expected) < 1e-11, "{}", difference(&x, &expected));
            let factor: Factor = symbolic.factorise(&matrix, &mut workspace).unwrap();
            let mut x = singles(&right);
            symbolic.solve(&factor, &mut x, k, &mut single).unwrap();
            prop_assert!(difference(&doubles(&x), &expected) < 2e-4, "{}", difference(&doubles(&x), &expected));
        }
        let x = solve_once(&pattern, &matrix, &right, k).unwrap();
        prop_assert!(difference(&x, &expected) < 1e-11);
        let mut product = vec![0.0; right.len()];
        matrix.multiply(&pattern, &x, k, &mut product).unwrap();
        prop_assert!(difference(&product, &right) < 1e-10);
    }

    #[test]
    fn patterns_have_the_entries_of_what_they_are_made_for(pattern in patterns(), seed: u64) {
        let mut random = Random::new(seed);
        let n = pattern.row_count();
        let joined = |pattern: &SymmetricPattern| {
            let mut full = vec![false; n * n];
            for row in 0..n {
                let (columns, edges) = pattern.row(row);
                full[row * n + row] = true;
                for (&column, &edge) in columns.iter().zip(edges) {
                    full[row * n + column as usize] = true;
                    let (a, b) = (column.min(row as u32), column.max(row as u32));
                    assert_eq!(pattern.edges()[edge as usize], [a, b]);
                    assert_eq!(pattern.edge(row as u32, column), Some(edge as usize));
                }
            }
            full
        };
        let once = joined(&pattern);
        let product: Vec<bool> =
            (0..n * n).map(|at| (0..n).any(|k| once[at / n * n + k] && once[k * n + at % n])).collect();
        prop_assert_eq!(joined(&pattern.squared()), product);

        let groups: Vec<Vec<u32>> =
            (0..random.below(6)).map(|_| (0..random.below(5)).map(|_| random.below(n) as u32).collect()).collect();
        let grouped = SymmetricPattern::from_groups(n, groups.iter().map(Vec::as_slice)).unwrap();
        let shared = |a: usize, b: usize| {
            groups.iter().any(|group| group.contains(&(a as u32)) && group.contains(&(b as u32)))
        };
        let expected: Vec<bool> = (0..n * n).map(|at| at / n == at % n || shared(at / n, at % n)).collect();
        prop_assert_eq!(joined(&grouped), expected);
        let extra = [[random.below(n) as u32, random.below(n) as u32]];
        let both = pattern.with_edges(&extra).unwrap();
        let mut expected = once;
        for [a, b] in [extra[0], [extra[0][1], extra[0][0]]] {
            expected[a as usize * n + b as usize] = true;
        }
        prop_assert_eq!(joined(&both), expected);
    }

    #[test]
    fn rows_that_are_left_out_are_held_at_zero(pattern in patterns(), seed: u64, share in 0.0..1.0_f64) {
        let mut random = Random::new(seed);
        let (n, k) = (pattern.row_count(), 2);
        let matrix = positive(&pattern, 0.2, &mut random);
        let free = ((n as f64 * share) as usize).min(n);
        let order = EliminationOrder::new(n, random.shuffled(n)).unwrap();
        let symbolic = Symbolic::of_first(&pattern, &order, free).unwrap();
        prop_assert_eq!((symbolic.row_count(), symbolic.free_count()), (n, free));
        let factor = symbolic.factorise(&matrix, &mut Workspace::default()).unwrap();
        let right = random.numbers(n * k);
        let mut x = right.clone();
        symbolic.solve(&factor, &mut x, k, &mut SolveScratch::default()).unwrap();
        // The same of the block of the free rows alone.
        let full = dense(&pattern, &matrix);
        let rows = &order.rows()[..free];
        let block = faer::Mat::from_fn(free, free, |a, b| full[(rows[a] as usize, rows[b] as usize)]);
        let block_right: Vec<f64> = rows.iter().flat_map(|&row| right[row as usize * k..][..k].to_vec()).collect();
        let mut expected = vec![0.0; n * k];
        for (&row, values) in rows.iter().zip(dense_solve(&block, &block_right, k).chunks(k)) {
            expected[row as usize * k..][..k].copy_from_slice(values);
        }
        prop_assert!(difference(&x, &expected) < 1e-11);
        prop_assert!(order.rows()[free..].iter().all(|&row| x[row as usize * k..][..k] == [0.0, 0.0]));
    }

    #[test]
    fn what_is_not_positive_definite_is_named(pattern in patterns(), seed: u64) {
        let mut random = Random::new(seed);
        let n = pattern.row_count();
        let mut matrix = positive(&pattern, 0.2, &mut random);
        for _ in 0..1 + random.below(3) {
            matrix.diagonal_mut()[random.below(n)] -= 4.0 * random.next();
        }
        let order = EliminationOrder::new(n, random.shuffled(n)).unwrap();
        // Elimination written out in that order.
        let mut full = dense(&pattern, &matrix);
        let mut expected = None;
        for (at, &row) in order.rows().iter().enumerate() {
            let row = row as usize;
            let pivot = full[(row, row)];
            if pivot <= 0.0 {
                expected = Some((row as u32, pivot));
                break;
            }
            for &a in &order.rows()[at + 1..] {
                for &b in &order.rows()[at + 1..] {
                    let (a, b) = (a as usize, b as usize);
                    let product = full[(a, row)] * full[(row, b)] / pivot;
                    full[(a, b)] -= product;
                }
            }
        }
        let symbolic = Symbolic::new(&pattern, &order).unwrap();
        let mut workspace = Workspace::default();
        match (symbolic.factorise::<f64>(&matrix, &mut workspace), expected) {
            (Ok(_), None) => {}
            (Err(CholeskyError::NotPositive { row, pivot }), Some((wanted, left))) => {
                prop_assert_eq!(row, wanted);
                prop_assert!((pivot - left).abs() < 1e-8 * (1.0 + left.abs()), "{pivot} and {left}");
            }
            (found, expected) => prop_assert!(false, "{found:?} and {expected:?}"),
        }
        // Regularised it may have a factor all the same.
        if let Ok(factor) = symbolic.factorise_regularised::<f64>(&matrix, &mut workspace) {
            prop_assert_eq!(factor.regularised > 0, expected.is_some());
        }
    }
}

#[test]
fn large_sheets_against_a_sparse_factorisation() {
    let (width, height, k) = (61, 47, 3);
    let n = (width * height) as usize;
    let pattern = SymmetricPattern::from_triangles(n, &sheet(width, height)).unwrap();
    // The Laplacian and its square, both screened.
    let mut random = Random::new(3);
    let weights: Vec<f64> = pattern.edges().iter().map(|_| 0.2 + random.next()).collect();
    let mut flat = laplacian(&pattern, &weights);
    let squared_pattern = pattern.squared();
    let mut squared = SymmetricMatrix::zeros(&squared_pattern);
    for row in 0..n {
        let (columns, edges) = pattern.row(row);
        let mut equation: Vec<(u32, f64)> =
            columns.iter().zip(edges).map(|(&column, &edge)| (column, -weights[edge as usize])).collect();
        equation.push((row as u32, flat.diagonal()[row]));
        squared.add_equation(&squared_pattern, &equation, 0.5).unwrap();
    }
    for (pattern, matrix) in [(&pattern, &mut flat), (&squared_pattern, &mut squared)] {
        matrix.diagonal_mut().iter_mut().for_each(|entry| *entry += 1e-3);
        let right = random.numbers(n * k);
        let found = solve_once(pattern, matrix, &right, k).unwrap();
        let mut triplets: Vec<Triplet<usize, usize, f64>> =
            (0..n).map(|row| Triplet::new(row, row, matrix.diagonal()[row])).collect();
        for (&[a, b], &entry) in pattern.edges().iter().zip(matrix.off_diagonal()) {
            triplets.push(Triplet::new(b as usize, a as usize, entry));
        }
        let sparse = SparseColMat::try_new_from_triplets(n, n, &triplets).unwrap();
        let symbolic = SymbolicLlt::try_new(sparse.symbolic(), faer::Side::Lower).unwrap();
        let factor = Llt::try_new_with_symbolic(symbolic, sparse.as_ref(), faer::Side::Lower).unwrap();
        let mut x = faer::Mat::from_fn(n, k, |row, side| right[row * k + side]);
        factor.solve_in_place(x.as_mut());
        let expected: Vec<f64> = (0..n * k).map(|at| x[(at / k, at % k)]).collect();
        assert!(difference(&found, &expected) < 1e-9, "{}", difference(&found, &expected));
    }
}

#[test]
fn a_component_that_nothing_holds_is_found_at_any_size() {
    for (width, height) in [(2, 2), (5, 4), (20, 30), (70, 60)] {
        let n = (width * height) as usize;
        let triangles = sheet(width, height);
        // Two sheets; only the first one is held.
        let both: Vec<[u32; 3]> = triangles.iter().flat_map(|t| [*t, t.map(|vertex| vertex + n as u32)]).collect();
        let pattern = SymmetricPattern::from_triangles(2 * n, &both).unwrap();
        let mut random = Random::new(u64::from(width));
        for scale in [1e-6, 1.0, 1e6] {
            let weights: Vec<f64> = pattern.edges().iter().map(|_| scale * (0.01 + random.next())).collect();
            let mut matrix = laplacian(&pattern, &weights);
            matrix.diagonal_mut()[0] += scale;
            let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern)).unwrap();
            match symbolic.factorise::<f64>(&matrix, &mut Workspace::default()) {
                Err(CholeskyError::NotPositive { row, .. }) => assert!(row as usize >= n, "row {row} is held"),
                found => panic!("{width} x {height}, {scale}: {:?}", found.map(|_| ())),
            }
            // With a thousandth of a weight it is held well enough.
            matrix.diagonal_mut()[n] += 1e-3 * scale;
            symbolic.factorise::<f64>(&matrix, &mut Workspace::default()).unwrap();
        }
    }
}

#[test]
fn a_failed_factorisation_leaves_the_factor_before() {
    let pattern = SymmetricPattern::from_triangles(12, &sheet(4, 3)).unwrap();
    let mut random = Random::new(1);
    let mut matrix = positive(&pattern, 0.5, &mut random);
    let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern)).unwrap();
    let mut workspace = Workspace::default();
    let mut factor: Factor<f64> = symbolic.factorise(&matrix, &mut workspace).unwrap();
    let right = random.numbers(12);
    let solved = |factor: &Factor<f64>| {
        let mut x = right.clone();
        symbolic.solve(factor, &mut x, 1, &mut SolveScratch::default()).unwrap();
        x
    };
    let before = solved(&factor);
    for (row, value) in [(7, -1.0), (3, f64::NAN), (5, f64::INFINITY)] {
        let good = std::mem::replace(&mut matrix.diagonal_mut()[row], value);
        let error = symbolic.refactorise(&matrix, &mut workspace, &mut factor).unwrap_err();
        let finite = CholeskyError::NotFiniteRow { row: row as u32 };
        assert!(if value.is_finite() { matches!(error, CholeskyError::NotPositive { .. }) } else { error == finite });
        assert_eq!(solved(&factor), before);
        matrix.diagonal_mut()[row] = good;
    }
    // An entry off the diagonal is found in the row that is eliminated first.
    matrix.off_diagonal_mut()[4] = f64::NAN;
    let error = symbolic.refactorise(&matrix, &mut workspace, &mut factor).unwrap_err();
    let ends = pattern.edges()[4];
    assert!(matches!(error, CholeskyError::NotFiniteRow { row } if ends.contains(&row)), "{error}");
    assert_eq!(solved(&factor), before);
}

#[test]
fn what_does_not_fit_is_refused() {
    let no_row = Err(CholeskyError::NoRow { row: 3, row_count: 3 });
    assert_eq!(SymmetricPattern::from_edges(3, &[[0, 1], [3, 1]]), no_row);
    assert_eq!(SymmetricPattern::from_triangles(3, &[[0, 1, 3]]), no_row);
    assert_eq!(SymmetricPattern::from_groups(3, [&[0, 1, 3][..]]), no_row);
    let pattern = SymmetricPattern::from_edges(3, &[[0, 1], [1, 0], [2, 2]]).unwrap();
    assert_eq!(pattern.edges(), [[0, 1]]);
    assert_eq!(pattern.with_edges(&[[0, 3]]), no_row);
    assert_eq!(
        (pattern.edge(1, 0), pattern.edge(1, 2), pattern.edge(3, 0), pattern.edge(0, 3)),
        (Some(0), None, None, None)
    );

    let order = |rows: &[u32]| EliminationOrder::new(3, rows.to_vec());
    for bad in [&[0, 1][..], &[0, 1, 1], &[0, 1, 3], &[0, 1, 2, 0]] {
        assert_eq!(order(bad), Err(CholeskyError::Order(3)));
    }
    let other = EliminationOrder::natural(4);
    assert!(matches!(Symbolic::new(&pattern, &other), Err(CholeskyError::Order(3))));
    assert!(matches!(Symbolic::of_first(&pattern, &order(&[0, 1, 2]).unwrap(), 4), Err(CholeskyError::Order(3))));

    let mut matrix = SymmetricMatrix::zeros(&pattern);
    assert_eq!(matrix.add(&pattern, 0, 2, 1.0), Err(CholeskyError::NoEntry { row: 0, column: 2 }));
    assert_eq!(matrix.add(&pattern, 3, 3, 1.0), Err(CholeskyError::NoEntry { row: 3, column: 3 }));
    let error = matrix.add_equation(&pattern, &[(0, 1.0), (1, 1.0), (2, 1.0)], 1.0);
    assert_eq!(error, Err(CholeskyError::NoEntry { row: 0, column: 2 }));
    assert_eq!(matrix, SymmetricMatrix::zeros(&pattern), "nothing half-added");
    // A row that is named twice counts twice.
    matrix.add_equation(&pattern, &[(0, 1.0), (1, 3.0), (0, 2.0)], 2.0).unwrap();
    assert_eq!((matrix.diagonal(), matrix.off_diagonal()), (&[18.0, 18.0, 0.0][..], &[18.0][..]));

    let shape = |what, found, expected| CholeskyError::Shape { what, found, expected };
    let symbolic = Symbolic::new(&pattern, &EliminationOrder::natural(3)).unwrap();
    matrix.diagonal_mut().fill(20.0);
    let mut workspace = Workspace::default();
    let factor: Factor = symbolic.factorise(&matrix, &mut workspace).unwrap();
    let mut scratch = SolveScratch::default();
    assert_eq!(symbolic.solve(&factor, &mut [0.0; 5], 2, &mut scratch), Err(shape("right side", 5, 6)));
    let none = symbolic.solve(&Factor::default(), &mut [0.0; 6], 2, &mut scratch);
    assert!(matches!(none, Err(CholeskyError::Shape { what: "factor", .. })));
    symbolic.solve(&factor, &mut [], 0, &mut scratch).unwrap();
    let larger = SymmetricMatrix::zeros(&SymmetricPattern::from_edges(4, &[[0, 1]]).unwrap());
    let error = symbolic.factorise::<f32>(&larger, &mut workspace).unwrap_err();
    assert_eq!(error, shape("diagonal", 4, 3));
    let nothing = SymmetricPattern::from_edges(0, &[]).unwrap();
    assert_eq!(solve_once(&nothing, &SymmetricMatrix::zeros(&nothing), &[], 3), Ok(vec![]));
}
