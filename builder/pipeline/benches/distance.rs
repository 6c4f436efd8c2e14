//! Pose distances between all pairs of frames: nanoseconds per pair of triangles.
//!
//! `cargo bench -p reprise-pipeline --bench distance`. `RAYON_NUM_THREADS=1` for one thread.

#![allow(clippy::unwrap_used, reason = "nothing to recover in a benchmark")]

mod synthetic;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use job::Job;
use pipeline::distance::{DistanceOptions, pose_distances};

fn distance(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pose distances");
    group.sample_size(10);
    for (frames, vertices) in [(300, 5_000), (300, 1_000)] {
        let (topology, poses) = synthetic::capture(frames, vertices);
        let pairs = (frames * (frames - 1) / 2) as u64;
        group.throughput(Throughput::Elements(pairs * topology.triangles().len() as u64));
        group.bench_function(format!("{frames} frames x {} triangles", topology.triangles().len()), |bencher| {
            bencher.iter(|| pose_distances(&topology, &poses, &DistanceOptions::default(), &Job::silent()).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, distance);
criterion_main!(benches);
