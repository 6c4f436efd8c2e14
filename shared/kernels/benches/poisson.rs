//! Poisson interpolation at 5,000 and 10,000 vertices: `cargo bench -p reprise-kernels --bench poisson`.
//!
//! Marks (docs/performance.md): a solve of three right sides at 10,000 vertices 0.7 ms, a factorisation 10 ms, an
//! in-between 2 ms.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

use std::f32::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Quat, Vec3, Vec4};
use kernels::cholesky::{Factor, Workspace, elimination_order};
use kernels::gradients::{PairGradients, TriangleBatches};
use kernels::laplacian::{Laplacian, LaplacianPattern};
use kernels::poisson::{KeyedPose, PoissonInterpolator};
use kernels::topology::Topology;

/// A body as a single skin: a star of five bent limbs, 1.8 m across, of about `vertices` vertices.
struct Body {
    topology: Topology,
    /// Of each vertex: its limb, its distance along it, and its offset from the limb's axis.
    places: Vec<(usize, f32, Vec3)>,
}

const LIMBS: usize = 5;

impl Body {
    fn new(vertices: usize) -> Self {
        let around = ((vertices as f32 / 40.0).sqrt() * 1.6) as u32;
        let rings = vertices as u32 / (around * LIMBS as u32);
        let mut places = vec![(0, 0.0, Vec3::new(0.0, 0.0, 0.06)), (0, 0.0, Vec3::new(0.0, 0.0, -0.06))];
        let mut triangles = Vec::new();
        let at = |limb: u32, ring: u32, step: u32| 2 + (limb * rings + ring) * around + step % around;
        for limb in 0..LIMBS as u32 {
            for ring in 0..rings {
                for step in 0..around {
                    let angle = TAU * (step as f32 + 0.5 * (ring % 2) as f32) / around as f32;
                    let along = 0.05 + 0.85 * ring as f32 / rings as f32;
                    let bump = 1.0 + 0.15 * (13.0 * along + 3.0 * angle).sin();
                    places.push((limb as usize, along, 0.06 * bump * Vec3::new(0.0, angle.cos(), angle.sin())));
                    if ring > 0 {
                        triangles.push([at(limb, ring - 1, step), at(limb, ring, step), at(limb, ring, step + 1)]);
                        triangles.push([
                            at(limb, ring - 1, step),
                            at(limb, ring, step + 1),
                            at(limb, ring - 1, step + 1),
                        ]);
                    }
                }
            }
            for step in 0..around {
                // Front half to one pole, back half to the other: the limbs meet in both.
                let pole = u32::from(step >= around / 2);
                triangles.push([pole, at(limb, 0, step), at(limb, 0, step + 1)]);
            }
        }
        let count = places.len();
        Self { topology: Topology::new(count as u32, triangles, vec![1.0; count]).unwrap(), places }
    }

    /// A pose of a motion at `time` in seconds: limbs swing and curl.
    fn pose(&self, time: f32) -> Vec<Vec3> {
        let place = |&(limb, along, offset): &(usize, f32, Vec3)| {
            let phase = time * 4.0 + limb as f32;
            let curl = 1.2 * phase.sin() * along;
            let swing = Quat::from_rotation_z(TAU * limb as f32 / LIMBS as f32 + 0.3 * phase.cos());
            swing * (Quat::from_rotation_y(curl) * (along * Vec3::X + offset))
        };
        self.places.iter().map(place).collect()
    }
}

fn benches(criterion: &mut Criterion) {
    for vertices in [5_000, 10_000] {
        let body = Body::new(vertices);
        let topology = &body.topology;
        let mut group = criterion.benchmark_group(format!("poisson/{}", topology.vertex_count()));
        let (source, destination) = (body.pose(0.0), body.pose(0.15));
        let triangles = TriangleBatches::new(topology.triangles());
        let order = elimination_order(topology);
        let pattern = LaplacianPattern::new(topology, &triangles, &order).unwrap();
        let symbolic = pattern.symbolic().unwrap();
        let mut workspace = Workspace::default();
        let mut laplacian = Laplacian::default();
        pattern.assemble(&triangles, &source, &mut laplacian);
        let factor: Factor = symbolic.factorise_regularised(&laplacian, &mut workspace).unwrap();
        let right = vec![Vec4::ONE; pattern.free_count()];

        group.bench_function("order", |b| b.iter(|| elimination_order(black_box(topology))));
        group.bench_function("symbolic", |b| b.iter(|| black_box(&pattern).symbolic()));
        group.bench_function("laplacian", |b| {
            b.iter(|| pattern.assemble(&triangles, black_box(&source), &mut laplacian))
        });
        group.bench_function("factorise", |b| {
            b.iter(|| symbolic.factorise_regularised::<f32>(black_box(&laplacian), &mut workspace).unwrap());
        });
        let (mut x, mut scratch) = (right.clone(), Vec::new());
        group.bench_function("solve", |b| {
            b.iter(|| {
                x.copy_from_slice(&right);
                symbolic.solve_in_order(&factor, black_box(&mut x), &mut scratch);
            });
        });
        let mut product = right.clone();
        group.bench_function("multiply", |b| b.iter(|| pattern.multiply(&laplacian, black_box(&right), &mut product)));
        let mut gradients = PairGradients::default();
        group.bench_function("gradients", |b| {
            b.iter(|| gradients.set(&triangles, black_box(&source), &destination));
        });

        let mut out = source.clone();
        group.bench_function("in-between, cold", |b| {
            b.iter_batched_ref(
                || PoissonInterpolator::new(topology, Some(&order)).unwrap(),
                |interpolator| {
                    let source = KeyedPose { frame: 0, pose: &source };
                    let destination = KeyedPose { frame: 1000, pose: &destination };
                    interpolator.interpolate(source, destination, 0.5, &mut out).unwrap()
                },
                criterion::BatchSize::LargeInput,
            );
        });
        // A transition of 40 frames at 50 fps, frame after frame, as a player makes it.
        let frames = 40;
        let side = |from: f32| -> Vec<Vec<Vec3>> { (0..frames).map(|k| body.pose(from + 0.02 * k as f32)).collect() };
        let (sources, destinations) = (side(0.0), side(0.15));
        let mut interpolator = PoissonInterpolator::new(topology, Some(&order)).unwrap();
        group.bench_function("transition of 40 in-betweens", |b| {
            b.iter(|| play(&mut interpolator, &sources, &destinations));
        });
        // Two such transitions at once, each on a thread of its own: solves are sequential, frames are not.
        let mut interpolators = [(); 2].map(|()| PoissonInterpolator::new(topology, Some(&order)).unwrap());
        group.bench_function("two transitions of 40 in-betweens on two threads", |b| {
            b.iter(|| {
                std::thread::scope(|scope| {
                    for interpolator in &mut interpolators {
                        scope.spawn(|| play(interpolator, &sources, &destinations));
                    }
                });
            });
        });
        group.finish();
    }
}

/// Makes the in-betweens of a transition, frame after frame, as a player does.
fn play(interpolator: &mut PoissonInterpolator, sources: &[Vec<Vec3>], destinations: &[Vec<Vec3>]) {
    let mut out = sources[0].clone();
    interpolator.restart();
    for (k, (source, destination)) in sources.iter().zip(destinations).enumerate() {
        let source = KeyedPose { frame: k as u32, pose: source };
        let destination = KeyedPose { frame: 1000 + k as u32, pose: destination };
        let lambda = (k + 1) as f32 / (sources.len() + 1) as f32;
        interpolator.interpolate(source, destination, lambda, &mut out).unwrap();
    }
}

criterion_group! {
    name = poisson;
    config = Criterion::default().sample_size(20);
    targets = benches
}
criterion_main!(poisson);
