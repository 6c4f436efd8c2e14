//! The essential graph of dense digraphs.
//!
//! `cargo bench -p reprise-builder --bench essential`. `RAYON_NUM_THREADS=1` for one thread.

#![allow(clippy::unwrap_used, reason = "nothing to recover in a benchmark")]

mod synthetic;

use criterion::{Criterion, criterion_group, criterion_main};
use pipeline::essential::essential_edges;
use pipeline::transitions::{TransitionOptions, optimal_transitions};

fn essential(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("essential graph");
    group.sample_size(10);
    for frames in [1_000, 2_633] {
        let (timeline, distances) = (synthetic::timeline(frames), synthetic::distances(frames));
        // Short segments, to be quick: the graph's size and density are what counts.
        let options = TransitionOptions { longest_seconds: 0.5, ..Default::default() };
        let transitions = optimal_transitions(&distances, &timeline, &options, &|_| ()).unwrap();
        let kept = essential_edges(&transitions, &timeline, 0.01).unwrap().edges.len();
        group.bench_function(format!("{frames} frames, {kept} transitions stay"), |bencher| {
            bencher.iter(|| essential_edges(&transitions, &timeline, 0.01).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, essential);
criterion_main!(benches);
