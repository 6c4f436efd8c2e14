//! The solver under handles, at 10,000 vertices: `cargo bench -p reprise-kernels --bench solver`.
//!
//! What taking a handle costs (a factorisation, or a change of the factor), and what each step of a drag costs (a solve of
//! three right sides).
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

#[path = "../tests/common/meshes.rs"]
#[allow(dead_code, reason = "a part of it is used")]
mod meshes;

use std::hint::black_box;

use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main, measurement::WallTime};
use kernels::cholesky::{
    ConstrainedFactor, Constraints, EliminationOrder, Real, SolveScratch, Symbolic, SymmetricMatrix, SymmetricPattern,
    Workspace,
};
use kernels::gradients::TriangleBatches;
use kernels::laplacian::{Laplacian, LaplacianPattern};
use meshes::{together, tube};

/// 195 handles, a third of them hard.
const HANDLES: usize = 195;

fn handles(vertices: usize) -> Constraints {
    let mut constraints = Constraints::new();
    for index in 0..HANDLES {
        let vertex = (index * vertices / HANDLES) as u32;
        if index % 3 == 0 { constraints.hard(vertex) } else { constraints.soft(vertex, 30.0) }
    }
    constraints
}

fn system<S: Real>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    pattern: &SymmetricPattern,
    matrix: &SymmetricMatrix,
) {
    let order = EliminationOrder::minimum_degree(pattern);
    let symbolic = Symbolic::new(pattern, &order).unwrap();
    println!("{name}: {} numbers in a factor", symbolic.value_count());
    let n = pattern.row_count();
    let constraints = handles(n);
    let mut workspace = Workspace::default();
    let mut factor = ConstrainedFactor::<S>::new(&symbolic, matrix, &constraints, &mut workspace).unwrap();
    group.bench_function(format!("{name}: symbolic"), |b| b.iter(|| Symbolic::new(black_box(pattern), &order)));
    group.bench_function(format!("{name}: factorise"), |b| {
        b.iter(|| factor.refactorise(&symbolic, black_box(matrix), &constraints, &mut workspace).unwrap());
    });
    let mut heavier = 30.0;
    group.bench_function(format!("{name}: change a weight"), |b| {
        b.iter(|| {
            heavier = 61.0 - heavier;
            let row = constraints.rows()[100];
            factor.set_weight(&symbolic, row, heavier, &mut workspace).unwrap();
        });
    });
    let mut scratch = SolveScratch::default();
    for k in [1, 3] {
        let wanted = vec![S::from_f64(1.0); HANDLES * k];
        let mut x = vec![S::default(); n * k];
        group.bench_function(format!("{name}: solve for {k}"), |b| {
            b.iter(|| {
                x.fill(S::default());
                factor.solve(&symbolic, black_box(&wanted), k, &mut x, &mut scratch).unwrap();
            });
        });
    }
}

fn benches(criterion: &mut Criterion) {
    let (topology, points) = together(&[tube(125, 80)], 0);
    let n = topology.vertex_count();
    let triangles = TriangleBatches::new(topology.triangles());
    let pattern = LaplacianPattern::unheld(&topology, &triangles, &[]).unwrap();
    let mut laplacian = Laplacian::default();
    pattern.assemble(&triangles, &points, &mut laplacian);
    let matrix = pattern.matrix(&laplacian);
    let pattern = pattern.symmetric();
    let squared_pattern = pattern.squared();
    let mut squared = SymmetricMatrix::zeros(&squared_pattern);
    let mut group = criterion.benchmark_group(format!("solver/{n}"));
    let square = |squared: &mut SymmetricMatrix| {
        squared.clear();
        for row in 0..n {
            let (columns, edges) = pattern.row(row);
            let mut equation = vec![(row as u32, matrix.diagonal()[row])];
            equation.extend(columns.iter().zip(edges).map(|(&c, &edge)| (c, matrix.off_diagonal()[edge as usize])));
            squared.add_equation(&squared_pattern, &equation, 1.0).unwrap();
        }
    };
    group.bench_function("square a Laplacian", |b| b.iter(|| square(&mut squared)));
    square(&mut squared);
    system::<f32>(&mut group, "Laplacian, f32", pattern, &matrix);
    system::<f64>(&mut group, "Laplacian, f64", pattern, &matrix);
    system::<f64>(&mut group, "squared, f64", &squared_pattern, &squared);
    group.finish();
}

criterion_group! {
    name = solver;
    config = Criterion::default().sample_size(20);
    targets = benches
}
criterion_main!(solver);
