//! Optimal transitions between all pairs of frames: cells of dynamic time warping a second.
//!
//! `cargo bench -p reprise-pipeline --bench transitions`. `RAYON_NUM_THREADS=1` for one thread. A cell is a node of the
//! grid of a start cell that a path within the slope limit can reach and that lies within both sequences.

#![allow(clippy::unwrap_used, reason = "nothing to recover in a benchmark")]

mod synthetic;

use actor::timeline::Timeline;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use job::Job;
use pipeline::transitions::{LengthChoice, TransitionOptions, optimal_transitions};

fn cells(timeline: &Timeline, longest: usize, slope: usize) -> u64 {
    let in_cone = |rows: usize, columns: usize| -> u64 {
        (0..columns).map(|l| rows.min(slope * l + 1).saturating_sub(l.div_ceil(slope)) as u64).sum()
    };
    // Start cells by the frames left in their sequences.
    let mut left = vec![0_u64; longest + 1];
    for sequence in timeline.sequences() {
        for rest in 1..=sequence.frame_count as usize {
            left[rest.min(longest)] += 1;
        }
    }
    let pairs = (1..=longest).flat_map(|rows| (1..=longest).map(move |columns| (rows, columns)));
    pairs.map(|(rows, columns)| left[rows] * left[columns] * in_cone(rows, columns)).sum()
}

fn transitions(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("transitions");
    group.sample_size(10);
    let frames = 500;
    let (timeline, distances) = (synthetic::timeline(frames), synthetic::distances(frames));
    group.throughput(Throughput::Elements(cells(&timeline, 100, 3)));
    for choice in [LengthChoice::Total, LengthChoice::Mean] {
        let options = TransitionOptions { choice, ..Default::default() };
        group.bench_function(format!("{frames} frames, lengths 15 to 100, {choice:?}"), |bencher| {
            bencher.iter(|| optimal_transitions(&distances, &timeline, &options, &Job::silent()).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, transitions);
criterion_main!(benches);
