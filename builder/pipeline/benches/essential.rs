//! The essential graph of dense digraphs.
//!
//! `cargo bench -p reprise-pipeline --bench essential`. `RAYON_NUM_THREADS=1` for one thread.

#![allow(clippy::unwrap_used, reason = "nothing to recover in a benchmark")]

mod synthetic;

use criterion::{Criterion, criterion_group, criterion_main};
use job::Job;
use pipeline::essential::essential_edges;
use pipeline::essential::sparse::{Candidates, essential_of, row_candidates};
use pipeline::transitions::{TransitionOptions, optimal_transitions};

/// As the essential graph rounds 0.01.
const ALPHA: f64 = 167_772.0 / 16_777_216.0;

fn essential(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("essential graph");
    group.sample_size(10);
    for frames in [1_000, 2_633] {
        let (timeline, distances) = (synthetic::timeline(frames), synthetic::distances(frames));
        // Short segments, to be quick: the graph's size and density are what counts.
        let options = TransitionOptions { longest_seconds: 0.5, ..Default::default() };
        let transitions = optimal_transitions(&distances, &timeline, &options, &Job::silent()).unwrap();
        let kept = essential_edges(&transitions, &timeline, 0.01).unwrap().edges.len();
        let candidates = || {
            let mut candidates = Candidates::new();
            for from in 0..frames as u32 {
                let next = timeline.next(from).map(|next| transitions.costs_from(next as usize));
                candidates.push_row(row_candidates(
                    &timeline,
                    ALPHA,
                    from,
                    transitions.costs_from(from as usize),
                    next,
                ));
            }
            candidates
        };
        let count = candidates().len();
        group.bench_function(format!("{frames} frames, {count} candidates"), |bencher| bencher.iter(candidates));
        let found = candidates();
        group.bench_function(format!("{frames} frames, {kept} of {count} candidates stay"), |bencher| {
            bencher.iter(|| essential_of(&found, &timeline, ALPHA, &Job::silent()).unwrap());
        });
        group.bench_function(format!("{frames} frames, {kept} transitions stay"), |bencher| {
            bencher.iter(|| essential_edges(&transitions, &timeline, 0.01).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, essential);
criterion_main!(benches);
