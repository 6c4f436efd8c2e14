//! Components of textures, and flow between two.
//!
//! `cargo bench -p reprise-appearance --bench appearance`. `RAYON_NUM_THREADS=1` for one thread. What rebuilding a
//! texture costs is in the bench of the same name of `reprise-bundle`.

#![allow(clippy::unwrap_used, missing_docs, reason = "nothing to recover in a benchmark")]

use std::hint::black_box;

use appearance::Charts;
use appearance::flow::{FlowGrid, FlowOptions};
use criterion::{Criterion, criterion_group, criterion_main};
use learn::pca::components;
use learn::store::Store;

/// Textures with a few smooth waves each, and noise.
fn textures(frames: usize, columns: usize) -> Store {
    let store = Store::new(frames, columns, 2.0).unwrap();
    for frame in 0..frames {
        let value = |k: usize| {
            let hash = (k as u32 ^ (frame as u32) << 20).wrapping_mul(0x9E37_79B9).rotate_left(13);
            let noise = (hash.wrapping_mul(0x85EB_CA6B) >> 8) as f32 / (1 << 24) as f32;
            0.5 + 0.3 * (0.001 * k as f32 + 0.1 * frame as f32).sin() + 0.02 * noise
        };
        store.write(frame, &(0..columns).map(value).collect::<Vec<_>>()).unwrap();
    }
    store
}

fn pattern(x: f32, y: f32) -> f32 {
    let waves = [(0.31, 0.11, 0.3), (-0.13, 0.27, 1.1), (0.07, -0.05, 2.0), (0.55, 0.42, 0.7), (-0.4, 0.6, 1.9)];
    0.5 + 0.09 * waves.iter().map(|&(a, b, c): &(f32, f32, f32)| (a * x + b * y + c).sin()).sum::<f32>()
}

fn appearance(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("appearance");
    group.sample_size(10);
    {
        let (frames, columns) = (300, 3 * 512 * 512);
        let (store, all) = (textures(frames, columns), (0..frames).collect::<Vec<_>>());
        group.bench_function("50 components of 300 textures of 512 x 512", |bencher| {
            bencher.iter(|| black_box(components(&store, &all, 50).unwrap()));
        });
    }
    let size = 1024;
    let plane = |shift: f32| -> Vec<f32> {
        let texels = (0..size * size).map(|k| ((k % size) as f32, (k / size) as f32));
        texels.map(|(x, y)| pattern(x + shift * (0.02 * y).sin(), y + shift * (0.017 * x).cos())).collect()
    };
    let (a, b) = (plane(0.0), plane(4.0));
    let grid = FlowGrid::new(&Charts::whole(size, size), FlowOptions::default());
    group.bench_function("making a texture of 1024 x 1024 ready", |bencher| {
        bencher.iter(|| black_box(grid.prepare(&a, None)));
    });
    let (a, b) = (grid.prepare(&a, None), grid.prepare(&b, None));
    group.bench_function("flow of two textures of 1024 x 1024", |bencher| {
        bencher.iter(|| black_box(grid.flow(&a, &b)));
    });
    group.finish();
}

criterion_group!(benches, appearance);
criterion_main!(benches);
