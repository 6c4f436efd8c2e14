//! Writing and reading a bundle: the real capture where it is there, and a cloth of 5,000 vertices.

#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs, reason = "a benchmark may fail loudly")]

#[path = "../tests/captures/mod.rs"]
mod captures;

use std::hint::black_box;

use actor::capture::Capture;
use actor::graph::EssentialGraph;
use actor::pose_source::PoseSource;
use bundle::{BundleInput, BundleReader, EncodeReport, default_max_error, encode};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;

fn bundle(criterion: &mut Criterion) {
    let mut captures = vec![captures::cloth(50, 100, &[66])];
    captures.push(captures::crane_and_jumping());
    for capture in &captures {
        reading(criterion, capture);
    }
    // The cloth only: writing the real capture takes seconds, and the builder reports that figure for every bundle.
    writing(criterion, &captures[0]);
}

fn bundle_of(capture: &Capture) -> (Vec<u8>, EncodeReport) {
    let graph = EssentialGraph::new(0.01, Vec::new(), &capture.timeline).unwrap();
    let max_error = default_max_error(capture, 0);
    let generator = "bench".into();
    encode(&BundleInput { capture, graph: &graph, first_frame: 0, max_error, poisson_order: None, generator }).unwrap()
}

fn print_sizes(capture: &Capture, report: &EncodeReport) {
    println!(
        "{}: {} vertices, {:.0} bytes a frame, model {} bytes, rms {:.3} mm, max {:.3} mm",
        capture.name,
        capture.poses.vertex_count(),
        report.bytes_per_frame,
        report.sections.iter().find(|size| size.name == "model").map_or(0, |size| size.stored),
        report.rms_error * 1e3,
        report.max_error * 1e3,
    );
}

fn reading(criterion: &mut Criterion, capture: &Capture) {
    let (bytes, report) = bundle_of(capture);
    print_sizes(capture, &report);
    let vertices = capture.poses.vertex_count();
    let frames = capture.poses.len() as u32;
    let mut pose = vec![Vec3::ZERO; vertices];
    let mut group = criterion.benchmark_group("bundle");
    group.throughput(Throughput::Elements(vertices as u64));
    // Frames that lie far apart share no reference: each costs the most that a frame can.
    for (name, stride) in [("frame in order", 1), ("frame at random", 13 * 4)] {
        let mut reader = BundleReader::from_bytes(&bytes).unwrap();
        let mut frame = 1;
        group.bench_function(BenchmarkId::new(name, &capture.name), |bencher| {
            bencher.iter(|| {
                frame = (frame + stride) % frames;
                reader.read(black_box(frame), &mut pose).unwrap();
            });
        });
    }
    group.bench_function(BenchmarkId::new("open", &capture.name), |bencher| {
        bencher.iter(|| BundleReader::from_bytes(black_box(&bytes)).unwrap());
    });
    group.finish();
}

fn writing(criterion: &mut Criterion, capture: &Capture) {
    let mut group = criterion.benchmark_group("bundle");
    group.sample_size(10);
    group.bench_function(BenchmarkId::new("write", &capture.name), |bencher| bencher.iter(|| bundle_of(capture)));
    group.finish();
}

criterion_group!(benches, bundle);
criterion_main!(benches);
