//! Reading and rebuilding textures of 1024 x 1024 texels from 34 colour and 16 warp modes, on the processor.

#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs, reason = "a benchmark may fail loudly")]

#[path = "../tests/captures/mod.rs"]
mod captures;
#[path = "../tests/looks/mod.rs"]
mod looks;

use std::hint::black_box;

use bundle::{AppearanceInput, AppearanceQuality, BundleInput, BundleReader, ModeDecoder, encode_with_appearance};
use criterion::{Criterion, criterion_group, criterion_main};
use texture::basis::Mode;
use texture::dealign::Aligned;

const FRAMES: u32 = 200;

fn appearance(criterion: &mut Criterion) {
    let capture = captures::cloth(4, 3, &[FRAMES]);
    let graph = captures::graph(&capture.timeline);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 0.001,
        poisson_order: None,
        generator: "bench".into(),
    };
    let model = looks::model([1024, 1024], [34, 16], FRAMES as usize);
    let looks = AppearanceInput { model: &model, material: 0, quality: AppearanceQuality::default() };
    let (bytes, report) = encode_with_appearance(&input, Some(&looks)).unwrap();
    let report = report.appearance.unwrap();
    let texels = model.active_count();
    println!("{texels} active texels, {:.0} bytes a frame, {report:?}", report.bytes_per_frame);
    drop(model);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    let appearance = reader.appearance().unwrap();
    let read = |decoder: &mut ModeDecoder, ordinal: u32| -> (usize, Mode) {
        let (layer, _) = appearance.place(ordinal).unwrap();
        let bytes = reader.mode_bytes(ordinal).unwrap();
        (layer, decoder.advance(bytes, appearance, layer, usize::MAX).unwrap().unwrap())
    };
    let mut group = criterion.benchmark_group("appearance");
    group.sample_size(10);
    group.bench_function("mean texture read", |bencher| {
        bencher.iter(|| black_box(read(&mut ModeDecoder::default(), 0)))
    });
    group.bench_function("all modes read", |bencher| {
        bencher.iter(|| {
            let mut decoder = ModeDecoder::default();
            (0..appearance.section_count()).for_each(|ordinal| drop(black_box(read(&mut decoder, ordinal))));
        });
    });
    let (mut modes, mut decoder) = ([Vec::new(), Vec::new()], ModeDecoder::default());
    for ordinal in 0..appearance.section_count() {
        let (layer, mode) = read(&mut decoder, ordinal);
        modes[layer].push(mode);
    }
    let entries: usize = modes.iter().flatten().map(|mode| mode.entries.len()).sum();
    println!("{entries} waves, {} blocks of colours", appearance.layers[0].blocks.len());
    let rebuild = |layer: usize, side: usize| {
        let own = &appearance.layers[layer];
        own.rebuild(&appearance.mask, &modes[layer], &own.weights(10, 60, 0.4), side)
    };
    group.bench_function("colours summed", |bencher| bencher.iter(|| black_box(rebuild(0, 16))));
    group.bench_function("colours summed at half the size", |bencher| bencher.iter(|| black_box(rebuild(0, 8))));
    let (texture, warp) = (rebuild(0, 16), rebuild(1, 16));
    let aligned = Aligned { texture, warp, texel: 1.0, cell: 4.0, fill: [0.5; 3] };
    group.bench_function("moved directly", |bencher| bencher.iter(|| black_box(aligned.dealign(&appearance.mask, 0))));
    group.bench_function("moved with gradients", |bencher| {
        bencher.iter(|| black_box(aligned.dealign(&appearance.mask, 1)));
    });
    group.finish();
}

criterion_group!(benches, appearance);
criterion_main!(benches);
