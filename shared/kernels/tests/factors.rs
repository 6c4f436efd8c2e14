//! Laplacians and their Cholesky factors.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

mod common;

use common::meshes::{bent, together, tube};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;
use fixtures::Random;
use glam::{Vec3, Vec4};
use kernels::cholesky::{CholeskyError, Factor, Workspace, elimination_order};
use kernels::gradients::TriangleBatches;
use kernels::laplacian::{Laplacian, LaplacianPattern};
use kernels::topology::Topology;

struct Case {
    topology: Topology,
    pose: Vec<Vec3>,
    triangles: TriangleBatches,
    pattern: LaplacianPattern,
    laplacian: Laplacian,
}

fn case(seed: u64) -> Case {
    let mut random = Random::new(seed);
    let (topology, points) = together(&[tube(9, 7), tube(4, 5)], 1);
    let pose = bent(&points, 1.0, 0.5, 0.02, &mut random);
    let triangles = TriangleBatches::new(topology.triangles());
    let pattern = LaplacianPattern::new(&topology, &triangles, &elimination_order(&topology)).unwrap();
    let mut laplacian = Laplacian::default();
    pattern.assemble(&triangles, &pose, &mut laplacian);
    Case { topology, pose, triangles, pattern, laplacian }
}

fn random_vectors(count: usize, seed: u64) -> Vec<Vec4> {
    let mut random = Random::new(seed);
    (0..count).map(|_| random.vector().extend(0.0)).collect()
}

#[test]
fn a_laplacian_times_a_vector_is_the_sum_over_its_triangles() {
    for seed in 0..4 {
        let case = case(seed);
        let n = case.pattern.free_count();
        assert_eq!(n, case.topology.vertex_count() - 3, "one anchor for each component");
        let x = random_vectors(n, seed);
        let mut product = vec![Vec4::ZERO; n];
        case.pattern.multiply(&case.laplacian, &x, &mut product);

        let at = |vertex: u32| case.pattern.position_of_vertex()[vertex as usize] as usize;
        let value = |vertex: u32| x.get(at(vertex)).map_or(glam::DVec3::ZERO, |v| v.truncate().as_dvec3());
        let mut expected = vec![glam::DVec3::ZERO; case.topology.vertex_count()];
        for t in case.topology.triangles() {
            for corner in 0..3 {
                let [o, k, l] = [0, 1, 2].map(|step| t[(corner + step) % 3]);
                let [po, pk, pl] = [o, k, l].map(|vertex| case.pose[vertex as usize].as_dvec3());
                let weight = 0.5 * (pk - po).dot(pl - po) / (pk - po).cross(pl - po).length();
                expected[at(k)] += weight * (value(k) - value(l));
                expected[at(l)] += weight * (value(l) - value(k));
            }
        }
        for (found, expected) in product.iter().zip(&expected) {
            assert!(found.truncate().as_dvec3().distance(*expected) < 1e-4 * (1.0 + expected.length()));
        }
    }
}

#[test]
fn factors_solve_their_laplacian() {
    for seed in 0..4 {
        let case = case(seed);
        let symbolic = case.pattern.symbolic().unwrap();
        let factor: Factor = symbolic.factorise(&case.laplacian, &mut Workspace::default()).unwrap();
        assert_eq!(factor.regularised, 0);
        let x = random_vectors(case.pattern.free_count(), seed + 10);
        let mut solved = vec![Vec4::ZERO; x.len()];
        case.pattern.multiply(&case.laplacian, &x, &mut solved);
        symbolic.solve_in_order(&factor, &mut solved, &mut Vec::new());
        let error = solved.iter().zip(&x).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(error < 1e-4, "{error}");
    }
}

#[test]
fn any_order_of_elimination_gives_the_same_solution() {
    let mut random = Random::new(7);
    for (rings, around) in [(3, 3), (5, 4), (9, 8), (14, 31)] {
        let (topology, points) = together(&[tube(rings, around), tube(4, 3)], 1);
        let pose = bent(&points, 1.0, 0.5, 0.02, &mut random);
        let n = topology.vertex_count() as u32;
        let mut shuffled: Vec<u32> = (0..n).collect();
        for last in (1..n as usize).rev() {
            shuffled.swap(last, ((random.signed() + 1.0) * 0.5 * last as f32) as usize);
        }
        let orders = [elimination_order(&topology), (0..n).collect(), (0..n).rev().collect(), shuffled];
        for order in orders {
            let triangles = TriangleBatches::new(topology.triangles());
            let pattern = LaplacianPattern::new(&topology, &triangles, &order).unwrap();
            let mut laplacian = Laplacian::default();
            pattern.assemble(&triangles, &pose, &mut laplacian);
            let symbolic = pattern.symbolic().unwrap();
            let factor: Factor = symbolic.factorise(&laplacian, &mut Workspace::default()).unwrap();
            let x = random_vectors(pattern.free_count(), 3);
            let mut solved = vec![Vec4::ZERO; x.len()];
            pattern.multiply(&laplacian, &x, &mut solved);
            symbolic.solve_in_order(&factor, &mut solved, &mut Vec::new());
            let error = solved.iter().zip(&x).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            assert_eq!(factor.regularised, 0);
            assert!(error < 1e-3, "{error} with {rings} rings of {around}");
        }
    }
}

#[test]
fn laplacians_do_not_see_rigid_motions() {
    let case = case(2);
    let turn = glam::Quat::from_rotation_y(1.0);
    let moved: Vec<Vec3> = case.pose.iter().map(|p| turn * *p + Vec3::new(0.5, 0.0, 1.0)).collect();
    let mut other = Laplacian::default();
    case.pattern.assemble(&case.triangles, &moved, &mut other);
    let x = random_vectors(case.pattern.free_count(), 5);
    let [mut a, mut b] = [x.clone(), x.clone()];
    case.pattern.multiply(&case.laplacian, &x, &mut a);
    case.pattern.multiply(&other, &x, &mut b);
    assert!(a.iter().zip(&b).all(|(a, b)| a.distance(*b) < 1e-3 * (1.0 + a.length())));
}

/// The approximate minimum degree order of faer.
fn order_of_faer(topology: &Topology) -> Vec<u32> {
    let n = topology.vertex_count();
    let mut columns = vec![std::collections::BTreeSet::new(); n];
    for &[a, b, c] in topology.triangles() {
        for (k, l) in [(a, b), (b, c), (c, a)] {
            columns[k as usize].insert(l);
            columns[l as usize].insert(k);
        }
    }
    let rows: Vec<u32> = columns.iter().flatten().copied().collect();
    let ends = columns.iter().scan(0, |end, column| {
        *end += column.len() as u32;
        Some(*end)
    });
    let start: Vec<u32> = std::iter::once(0).chain(ends).collect();
    let pattern = SymbolicSparseColMatRef::<u32>::new_checked(n, n, &start, None, &rows);
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let mut memory = MemBuffer::new(amd::order_scratch::<u32>(n, rows.len()));
    let stack = MemStack::new(&mut memory);
    amd::order(&mut order, &mut inverse, pattern, amd::Control::default(), stack).unwrap();
    order
}

#[test]
fn factors_are_no_larger_than_in_the_order_of_faer() {
    for (rings, around) in [(30, 20), (80, 60)] {
        let (topology, _) = together(&[tube(rings, around)], 0);
        let triangles = TriangleBatches::new(topology.triangles());
        let size = |order: &[u32]| {
            LaplacianPattern::new(&topology, &triangles, order).unwrap().symbolic().unwrap().value_count()
        };
        let (ours, theirs) = (size(&elimination_order(&topology)), size(&order_of_faer(&topology)));
        println!("{} vertices: {ours} numbers, faer's order {theirs}", topology.vertex_count());
        assert!(ours as f64 <= theirs as f64 * 1.1, "{ours} and {theirs}");
    }
}

#[test]
fn an_order_that_fills_in_is_refused() {
    // Shuffled, a surface of so many vertices has more than a thousand entries a vertex.
    let (topology, _) = together(&[tube(160, 120)], 0);
    let triangles = TriangleBatches::new(topology.triangles());
    let mut order = elimination_order(&topology);
    let mut random = Random::new(9);
    for last in (1..order.len()).rev() {
        order.swap(last, ((random.signed() + 1.0) * 0.5 * last as f32) as usize);
    }
    let pattern = LaplacianPattern::new(&topology, &triangles, &order).unwrap();
    assert!(matches!(pattern.symbolic(), Err(CholeskyError::Fill(_))));
}
