//! Meshes drawn by handles, soft and hard, against a sparse factorisation of faer in double precision.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

mod common;

use common::meshes::{bent, together, tube};
use faer::Mat;
use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use fixtures::{Random, captured};
use glam::Vec3;
use kernels::cholesky::{
    CholeskyError, ConstrainedFactor, Constraints, EliminationOrder, Real, SolveScratch, Symbolic, SymmetricEntries,
    SymmetricMatrix, SymmetricPattern, Workspace, elimination_order,
};
use kernels::gradients::TriangleBatches;
use kernels::laplacian::{Laplacian, LaplacianPattern};
use kernels::topology::Topology;

/// A mesh, its pose, and the pose's Laplacian with weights of a thousandth at least, as rotations need them.
struct Case {
    pose: Vec<Vec3>,
    pattern: LaplacianPattern,
    laplacian: Laplacian,
    /// The same in double precision.
    matrix: SymmetricMatrix,
    /// In the order that a bundle stores.
    order: EliminationOrder,
}

fn case(topology: Topology, pose: Vec<Vec3>, ties: &[[u32; 2]]) -> Case {
    let triangles = TriangleBatches::new(topology.triangles());
    let pattern = LaplacianPattern::unheld(&topology, &triangles, ties).unwrap();
    let mut laplacian = Laplacian::default();
    pattern.assemble(&triangles, &pose, &mut laplacian);
    pattern.change_weights(&mut laplacian, |_, weight| weight.max(1e-3));
    let order = EliminationOrder::new(topology.vertex_count(), elimination_order(&topology)).unwrap();
    Case { pose, matrix: pattern.matrix(&laplacian), pattern, laplacian, order }
}

/// A frame of a capture.
fn body() -> Case {
    let (topology, mut poses) = captured("crane", &[40]);
    case(topology, poses.remove(0), &[])
}

/// Every so many vertices is a handle, every third of them hard; the uppermost are drawn aside by 0.2 m.
fn handles(case: &Case, every: usize) -> (Constraints, Vec<f64>) {
    let (mut constraints, mut wanted) = (Constraints::new(), Vec::new());
    for (index, vertex) in (0..case.pose.len()).step_by(every).enumerate() {
        match index % 3 {
            0 => constraints.hard(vertex as u32),
            _ => constraints.soft(vertex as u32, 30.0),
        }
        let aside = if case.pose[vertex].y > 1.0 { Vec3::X * 0.2 } else { Vec3::ZERO };
        wanted.extend((case.pose[vertex] + aside).to_array().map(f64::from));
    }
    (constraints, wanted)
}

/// The same by faer, hard constraints cut out of the matrix by hand.
fn by_faer(
    pattern: &SymmetricPattern,
    matrix: &impl SymmetricEntries,
    constraints: &Constraints,
    wanted: &[f64],
    right: &[f64],
) -> Vec<f64> {
    let n = pattern.row_count();
    let mut held = vec![None; n];
    let mut x = Mat::from_fn(n, 3, |row, axis| right[row * 3 + axis]);
    let mut diagonal: Vec<f64> = (0..n).map(|row| matrix.diagonal(row)).collect();
    for (index, (&row, &weight)) in constraints.rows().iter().zip(constraints.weights()).enumerate() {
        let row = row as usize;
        if weight.is_infinite() {
            held[row] = Some(index);
            continue;
        }
        diagonal[row] += weight;
        (0..3).for_each(|axis| x[(row, axis)] += weight * wanted[index * 3 + axis]);
    }
    let mut triplets = Vec::new();
    for (edge, ends) in pattern.edges().iter().enumerate() {
        let entry = matrix.off_diagonal(edge);
        for [free, other] in [[ends[0], ends[1]], [ends[1], ends[0]]].map(|ends| ends.map(|end| end as usize)) {
            match (held[free], held[other]) {
                (None, None) => triplets.push(Triplet::new(free, other, entry)),
                (None, Some(index)) => (0..3).for_each(|axis| x[(free, axis)] -= entry * wanted[index * 3 + axis]),
                _ => {}
            }
        }
    }
    for row in 0..n {
        triplets.push(Triplet::new(row, row, if held[row].is_some() { 1.0 } else { diagonal[row] }));
        if let Some(index) = held[row] {
            (0..3).for_each(|axis| x[(row, axis)] = wanted[index * 3 + axis]);
        }
    }
    let sparse = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets).unwrap();
    let symbolic = SymbolicLlt::try_new(sparse.symbolic(), faer::Side::Lower).unwrap();
    let factor = Llt::try_new_with_symbolic(symbolic, sparse.as_ref(), faer::Side::Lower).unwrap();
    factor.solve_in_place(x.as_mut());
    (0..n * 3).map(|at| x[(at / 3, at % 3)]).collect()
}

fn ours<S: Real>(
    symbolic: &Symbolic,
    matrix: &impl SymmetricEntries,
    (constraints, wanted): (&Constraints, &[f64]),
    right: &[f64],
) -> Vec<f64> {
    let factor = ConstrainedFactor::<S>::new(symbolic, matrix, constraints, &mut Workspace::default()).unwrap();
    let [wanted, mut x] = [wanted, right].map(|list| list.iter().map(|&x| S::from_f64(x)).collect::<Vec<_>>());
    factor.solve(symbolic, &wanted, 3, &mut x, &mut SolveScratch::default()).unwrap();
    x.into_iter().map(S::to_f64).collect()
}

fn worst(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
#[ignore = "reads ../shared/data"]
fn laplacian_editing_of_a_body() {
    let case = body();
    let symbolic = Symbolic::new(case.pattern.symmetric(), &case.order).unwrap();
    let right: Vec<f64> = case
        .pattern
        .multiply_points(&case.laplacian, &case.pose)
        .iter()
        .flat_map(|v| v.to_array().map(f64::from))
        .collect();
    for every in [case.pose.len() / 4, 200, 50] {
        let (constraints, wanted) = handles(&case, every);
        let expected = by_faer(case.pattern.symmetric(), &case.matrix, &constraints, &wanted, &right);
        let double = ours::<f64>(&symbolic, &case.matrix, (&constraints, &wanted), &right);
        let single = ours::<f32>(&symbolic, &case.matrix, (&constraints, &wanted), &right);
        let (double, single) = (worst(&double, &expected), worst(&single, &expected));
        println!("{} handles: {double:.1e} m off in double precision, {single:.1e} in single", wanted.len() / 3);
        assert!(double < 1e-10 && single < 1e-4);
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn the_square_of_a_laplacian_needs_double_precision() {
    // L^T M^-1 L: an equation for each row of L, with the inverse of the vertex' area as weight.
    let case = body();
    let pattern = case.pattern.symmetric();
    let squared_pattern = pattern.squared();
    let mut squared = SymmetricMatrix::zeros(&squared_pattern);
    let mut right = vec![0.0; 3 * case.pose.len()];
    let area = 1.0 / case.pose.len() as f64;
    for row in 0..pattern.row_count() {
        let (columns, edges) = pattern.row(row);
        let mut equation = vec![(row as u32, case.matrix.diagonal()[row])];
        equation.extend(columns.iter().zip(edges).map(|(&c, &edge)| (c, case.matrix.off_diagonal()[edge as usize])));
        squared.add_equation(&squared_pattern, &equation, 1e-3 / area).unwrap();
    }
    let pose: Vec<f64> = case.pose.iter().flat_map(|p| p.to_array().map(f64::from)).collect();
    squared.multiply(&squared_pattern, &pose, 3, &mut right).unwrap();
    let symbolic = Symbolic::new(&squared_pattern, &EliminationOrder::minimum_degree(&squared_pattern)).unwrap();
    println!("{} numbers in the factor", symbolic.value_count());
    for every in [case.pose.len() / 4, 200, 50] {
        let (constraints, wanted) = handles(&case, every);
        let expected = by_faer(&squared_pattern, &squared, &constraints, &wanted, &right);
        let double = ours::<f64>(&symbolic, &squared, (&constraints, &wanted), &right);
        let single = ours::<f32>(&symbolic, &squared, (&constraints, &wanted), &right);
        let (double, single) = (worst(&double, &expected), worst(&single, &expected));
        println!("{} handles: {double:.1e} m off in double precision, {single:.1e} in single", wanted.len() / 3);
        assert!(double < 1e-8);
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn handles_taken_and_released_one_by_one() {
    let case = body();
    let symbolic = Symbolic::new(case.pattern.symmetric(), &case.order).unwrap();
    let mut workspace = Workspace::default();
    let (mut constraints, mut wanted) = handles(&case, 500);
    let mut factor = ConstrainedFactor::<f32>::new(&symbolic, &case.matrix, &constraints, &mut workspace).unwrap();
    // Released, softened, and further ones that were none.
    for vertex in [500, 1500, 1] {
        factor.set_weight(&symbolic, vertex, 0.0, &mut workspace).map_err(|error| (vertex, error)).ok();
    }
    for vertex in (7..case.pose.len() as u32).step_by(case.pose.len() / 24) {
        factor.set_weight(&symbolic, vertex, 30.0, &mut workspace).unwrap();
    }
    let now = factor.constraints().clone();
    for &vertex in &now.rows()[constraints.rows().len()..] {
        wanted.extend(case.pose[vertex as usize].to_array().map(f64::from));
    }
    constraints.clone_from(&now);
    let right: Vec<f64> = case
        .pattern
        .multiply_points(&case.laplacian, &case.pose)
        .iter()
        .flat_map(|v| v.to_array().map(f64::from))
        .collect();
    let expected = by_faer(case.pattern.symmetric(), &case.matrix, &constraints, &wanted, &right);
    let wanted: Vec<f32> = wanted.iter().map(|&x| x as f32).collect();
    let mut x: Vec<f32> = right.iter().map(|&x| x as f32).collect();
    factor.solve(&symbolic, &wanted, 3, &mut x, &mut SolveScratch::default()).unwrap();
    let x: Vec<f64> = x.into_iter().map(f64::from).collect();
    println!("{} constraints after changes: {:.1e} m off", now.rows().len(), worst(&x, &expected));
    assert!(worst(&x, &expected) < 2e-4);
}

#[test]
fn ties_hold_parts_together() {
    let parts = [tube(12, 9), tube(5, 5)];
    let (topology, points) = together(&parts, 0);
    let second = parts[0].0.len() as u32;
    let pose = bent(&points, 1.0, 0.5, 0.01, &mut Random::new(2));
    let mut hold = Constraints::new();
    hold.hard(0);
    let ties = [[4, second + 3], [second, 11]];
    let mut workspace = Workspace::default();
    for (ties, weight, held) in [(&ties[..0], 0.0, false), (&ties, 0.0, false), (&ties, 0.5, true)] {
        let mut case = case(topology.clone(), pose.clone(), ties);
        let is_tie = |[a, b]: [u32; 2]| ties.contains(&[a, b]) || ties.contains(&[b, a]);
        case.pattern.change_weights(&mut case.laplacian, |ends, own| if is_tie(ends) { weight } else { own });
        let symbolic = Symbolic::new(case.pattern.symmetric(), &case.order).unwrap();
        let matrix = case.pattern.matrix(&case.laplacian);
        let found = ConstrainedFactor::<f32>::new(&symbolic, &matrix, &hold, &mut workspace);
        match found {
            Ok(_) => assert!(held),
            Err(CholeskyError::NotPositive { row, .. }) => assert!(!held && row >= second, "{row}"),
            Err(error) => panic!("{error}"),
        }
    }
    // With anchors: one for each part that hangs together, which ties make fewer.
    let triangles = TriangleBatches::new(topology.triangles());
    let order = elimination_order(&topology);
    let free = |ties: &[[u32; 2]]| LaplacianPattern::tied(&topology, &triangles, &order, ties).unwrap().free_count();
    assert_eq!(free(&[]), topology.vertex_count() - 2);
    assert_eq!(free(&ties), topology.vertex_count() - 1);
    let far = [[0, topology.vertex_count() as u32]];
    let error = LaplacianPattern::tied(&topology, &triangles, &order, &far).unwrap_err();
    assert!(matches!(error, CholeskyError::NoRow { .. }));
    assert_eq!(LaplacianPattern::unheld(&topology, &triangles, &far).unwrap_err(), error);
}

#[test]
fn weights_of_all_kinds() {
    let (topology, points) = together(&[tube(6, 5)], 1);
    let triangles = TriangleBatches::new(topology.triangles());
    let mut random = Random::new(4);
    let pose = bent(&points, 1.0, 0.5, 0.01, &mut random);
    let order = elimination_order(&topology);
    let unheld = LaplacianPattern::unheld(&topology, &triangles, &[]).unwrap();
    let ordered = LaplacianPattern::new(&topology, &triangles, &order).unwrap();
    let edges = unheld.symmetric().edges().len();
    let mut laplacian = Laplacian::default();

    unheld.assemble_uniform(&mut laplacian);
    assert!(laplacian.weights().iter().all(|&weight| weight == 1.0));
    for vertex in 0..topology.vertex_count() {
        let neighbours = unheld.symmetric().row(vertex).0.len();
        assert_eq!(laplacian.diagonal()[vertex], neighbours as f32);
    }
    let given: Vec<f32> = (0..edges).map(|_| 1.5 + random.signed()).collect();
    unheld.assemble_given(&given, &mut laplacian).unwrap();
    assert_eq!(laplacian.weights(), given);
    let short = unheld.assemble_given(&given[1..], &mut Laplacian::default());
    assert!(matches!(short, Err(CholeskyError::Shape { what: "weights", .. })));

    // The same Laplacian whatever the numbering: L x by vertex.
    let mut renumbered = Laplacian::default();
    unheld.assemble(&triangles, &pose, &mut laplacian);
    ordered.assemble(&triangles, &pose, &mut renumbered);
    let x: Vec<Vec3> = points.iter().map(|_| random.vector()).collect();
    let [a, b] = [unheld.multiply_points(&laplacian, &x), ordered.multiply_points(&renumbered, &x)];
    assert!(a.iter().zip(&b).all(|(a, b)| a.distance(*b) < 1e-5));
    // In double precision its rows sum to nothing.
    let matrix = ordered.matrix(&renumbered);
    let mut sums = vec![0.0; topology.vertex_count()];
    matrix.multiply(ordered.symmetric(), &vec![1.0; topology.vertex_count()], 1, &mut sums).unwrap();
    assert!(sums.iter().all(|sum| sum.abs() < 1e-14));
}
