//! Changes of a matrix taken over into its factor, against factors made anew.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod systems;

use kernels::cholesky::{
    CholeskyError, EliminationOrder, Factor, Real, SolveScratch, Symbolic, SymmetricMatrix, SymmetricPattern, Workspace,
};
use proptest::prelude::*;
use systems::{Random, difference, doubles, laplacian, patterns, positive, sheet, singles};

fn solved<S: Real>(symbolic: &Symbolic, factor: &Factor<S>, right: &[S]) -> Vec<S> {
    let mut x = right.to_vec();
    symbolic.solve(factor, &mut x, 1, &mut SolveScratch::default()).unwrap();
    x
}

/// A change that fits the pattern: a row, an edge, or a triangle of rows.
fn some_change(pattern: &SymmetricPattern, random: &mut Random) -> Vec<(u32, f64)> {
    let row = random.below(pattern.row_count());
    let mut w = vec![(row as u32, random.signed())];
    let columns = pattern.row(row).0;
    if !columns.is_empty() && random.next() < 0.7 {
        let other = columns[random.below(columns.len())];
        w.push((other, random.signed()));
        let third = pattern.row(other as usize).0.iter().find(|&&third| pattern.edge(third, row as u32).is_some());
        w.extend(third.map(|&third| (third, random.signed())));
    }
    w
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn changed_factors_are_those_of_the_changed_matrix(pattern in patterns(), seed: u64, share in 0.5..1.0_f64) {
        let mut random = Random::new(seed);
        let n = pattern.row_count();
        let order = EliminationOrder::new(n, random.shuffled(n)).unwrap();
        // Some rows may be left out.
        let free = if share < 0.8 { (n as f64 * share) as usize } else { n };
        let symbolic = Symbolic::of_first(&pattern, &order, free).unwrap();
        let mut workspace = Workspace::default();
        let mut matrix = positive(&pattern, 0.5, &mut random);
        let mut double: Factor<f64> = symbolic.factorise(&matrix, &mut workspace).unwrap();
        let mut single: Factor = symbolic.factorise(&matrix, &mut workspace).unwrap();
        let mut added = Vec::new();
        for _ in 0..20 {
            // What was added is taken away again, a while later.
            let (weight, w) = if added.len() > 3 && random.next() < 0.5 {
                let (weight, w): (f64, Vec<(u32, f64)>) = added.swap_remove(random.below(added.len()));
                (-weight, w)
            } else {
                let change = (5.0 * random.next(), some_change(&pattern, &mut random));
                added.push(change.clone());
                change
            };
            symbolic.update(&mut double, weight, &w, &mut workspace).unwrap();
            symbolic.update(&mut single, weight, &w, &mut workspace).unwrap();
            matrix.add_equation(&pattern, &w, weight).unwrap();
        }
        let anew: Factor<f64> = symbolic.factorise(&matrix, &mut workspace).unwrap();
        let right = random.numbers(n);
        let expected = solved(&symbolic, &anew, &right);
        let found = solved(&symbolic, &double, &right);
        prop_assert!(difference(&found, &expected) < 1e-11, "{}", difference(&found, &expected));
        let found = doubles(&solved(&symbolic, &single, &singles(&right)));
        prop_assert!(difference(&found, &expected) < 1e-3, "{}", difference(&found, &expected));
    }

    #[test]
    fn taking_too_much_away_changes_nothing(pattern in patterns(), seed: u64, excess in 0.0..2.0_f64) {
        let mut random = Random::new(seed);
        let n = pattern.row_count();
        let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern)).unwrap();
        let mut workspace = Workspace::default();
        let matrix = positive(&pattern, 0.5, &mut random);
        let mut factor: Factor<f64> = symbolic.factorise(&matrix, &mut workspace).unwrap();
        let right = random.numbers(n);
        let before = solved(&symbolic, &factor, &right);
        // 1 / (w^T A^-1 w) is what can be taken away.
        let w = some_change(&pattern, &mut random);
        let mut vector = vec![0.0; n];
        w.iter().for_each(|&(row, value)| vector[row as usize] += value);
        let inverse = solved(&symbolic, &factor, &vector);
        let most = 1.0 / vector.iter().zip(&inverse).map(|(a, b)| a * b).sum::<f64>();
        let error = symbolic.update(&mut factor, -most * (1.0 + excess), &w, &mut workspace);
        let refused = matches!(error, Err(CholeskyError::Downdate { .. }));
        prop_assert!(refused, "{error:?}");
        prop_assert_eq!(&solved(&symbolic, &factor, &right), &before);
        // A hundredth less is fine.
        symbolic.update(&mut factor, -most * 0.99, &w, &mut workspace).unwrap();
        symbolic.update(&mut factor, most * 0.99, &w, &mut workspace).unwrap();
        let after = solved(&symbolic, &factor, &right);
        prop_assert!(difference(&after, &before) < 1e-9, "{}", difference(&after, &before));
    }
}

#[test]
fn a_tie_may_be_given_its_weight_afterwards() {
    let (width, height) = (9, 7);
    let n = (width * height) as usize;
    let pattern = SymmetricPattern::from_triangles(n, &sheet(width, height)).unwrap().with_edges(&[[0, 62]]).unwrap();
    let tie = pattern.edge(0, 62).unwrap();
    let weights = |tie_weight: f64| -> Vec<f64> {
        (0..pattern.edges().len()).map(|edge| if edge == tie { tie_weight } else { 1.0 }).collect()
    };
    let screened = |tie_weight: f64| -> SymmetricMatrix {
        let mut matrix = laplacian(&pattern, &weights(tie_weight));
        matrix.diagonal_mut().iter_mut().for_each(|entry| *entry += 0.1);
        matrix
    };
    let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern)).unwrap();
    let mut workspace = Workspace::default();
    let mut factor: Factor<f64> = symbolic.factorise(&screened(0.0), &mut workspace).unwrap();
    let right = Random::new(5).numbers(n);
    for (change, now) in [(7.0, 7.0), (-4.0, 3.0), (-3.0, 0.0)] {
        symbolic.update(&mut factor, change, &[(0, 1.0), (62, -1.0)], &mut workspace).unwrap();
        let anew = symbolic.factorise(&screened(now), &mut workspace).unwrap();
        let difference = difference(&solved(&symbolic, &factor, &right), &solved(&symbolic, &anew, &right));
        assert!(difference < 1e-12, "{difference}");
    }
}

#[test]
fn changes_that_do_not_fit_are_refused() {
    // A chain: the first and the last row are not joined, whatever is eliminated.
    let pattern = SymmetricPattern::from_edges(4, &[[0, 1], [1, 2], [2, 3]]).unwrap();
    let symbolic = Symbolic::new(&pattern, &EliminationOrder::natural(4)).unwrap();
    let mut workspace = Workspace::default();
    let mut matrix = SymmetricMatrix::zeros(&pattern);
    matrix.diagonal_mut().fill(2.0);
    let mut factor: Factor<f64> = symbolic.factorise(&matrix, &mut workspace).unwrap();
    let mut update = |weight: f64, w: &[(u32, f64)]| symbolic.update(&mut factor, weight, w, &mut workspace);
    assert_eq!(update(1.0, &[(4, 1.0)]), Err(CholeskyError::NoRow { row: 4, row_count: 4 }));
    assert_eq!(update(f64::NAN, &[(2, 1.0)]), Err(CholeskyError::NotFiniteRow { row: 2 }));
    assert_eq!(update(1.0, &[(0, 1.0), (3, f64::INFINITY)]), Err(CholeskyError::NotFiniteRow { row: 3 }));
    assert_eq!(update(0.0, &[(0, 1.0)]), Ok(()));
    assert_eq!(update(1.0, &[]), Ok(()));
    assert_eq!(update(-2.0, &[(1, 1.0)]), Err(CholeskyError::Downdate { row: 1 }));
    let other = &mut Factor::<f64>::default();
    let shape = symbolic.update(other, 1.0, &[(0, 1.0)], &mut Workspace::default());
    assert!(matches!(shape, Err(CholeskyError::Shape { what: "factor", .. })));
    let mut x = [2.0; 4];
    symbolic.solve(&factor, &mut x, 1, &mut SolveScratch::default()).unwrap();
    assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-14));

    // A long chain falls into several supernodes: the entry (0, 39) is in none.
    let edges: Vec<[u32; 2]> = (0..39).map(|row| [row, row + 1]).collect();
    let pattern = SymmetricPattern::from_edges(40, &edges).unwrap();
    let symbolic = Symbolic::new(&pattern, &EliminationOrder::natural(40)).unwrap();
    let mut matrix = SymmetricMatrix::zeros(&pattern);
    matrix.diagonal_mut().fill(2.0);
    let mut factor: Factor<f64> = symbolic.factorise(&matrix, &mut workspace).unwrap();
    let error = symbolic.update(&mut factor, 1.0, &[(39, 1.0), (0, 1.0)], &mut workspace);
    assert_eq!(error, Err(CholeskyError::NoEntry { row: 39, column: 0 }));
}
