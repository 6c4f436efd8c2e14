//! Training on one thread: `cargo bench -p reprise-learn --bench training`.
//!
//! A dynamical model of 168 frames of four motions, and the maps of five parts from 350 pairs, each a linear process and one of a neural network for
//! what it leaves over, as transfer learns them. Marks: 2 s each.
#![allow(clippy::unwrap_used, reason = "helpers of benchmarks fail as tests do")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use kernels::random::{mix, signed};
use learn::dense::Matrix;
use learn::gpdm::{Gpdm, GpdmOptions};
use learn::kernel::Kernel;
use learn::regression::{Regression, RegressionOptions};

/// Frames of each motion, and numbers of a frame.
const FRAMES: [usize; 4] = [56, 56, 28, 28];
const NUMBERS: usize = 40;
/// Pairs, parts, and numbers of a part in source and target.
const PAIRS: usize = 350;
const PARTS: u64 = 5;
const OF_PART: usize = 20;

/// Number `column` of a body at a phase: swings that get smaller and quicker, with something that never repeats.
fn number(kind: u64, column: usize, phase: f64) -> f64 {
    let draw = |k: u64| f64::from(signed(mix(kind, column as u64), k));
    let size = 1.0 / (1.0 + column as f64);
    size * ((phase + 3.0 * draw(1)).sin() + 0.5 * draw(2) * (2.0 * phase + 3.0 * draw(3)).cos() + draw(4))
}

fn motions() -> Matrix {
    let mut row = 0;
    let mut values = Vec::new();
    for (kind, &frames) in FRAMES.iter().enumerate() {
        for frame in 0..frames {
            let phase = frame as f64 * std::f64::consts::TAU / 28.0;
            let noise = |column: usize| 0.003 * f64::from(signed(9, (row * NUMBERS + column) as u64));
            values.push(
                (0..NUMBERS).map(|column| number(kind as u64, column, phase) + noise(column)).collect::<Vec<_>>(),
            );
            row += 1;
        }
    }
    let mean = |column: usize| values.iter().map(|row| row[column]).sum::<f64>() / row as f64;
    let means: Vec<f64> = (0..NUMBERS).map(mean).collect();
    let mut all = Matrix::from_fn(row, NUMBERS, |row, column| values[row][column] - means[column]);
    let scale = (row as f64 / all.dot(&all)).sqrt();
    all.values_mut().iter_mut().for_each(|value| *value *= scale);
    all
}

/// Pairs of a part, in metres.
fn pairs(part: u64) -> [Matrix; 2] {
    let phase = |row: usize| row as f64 * 0.23;
    let x =
        Matrix::from_fn(PAIRS, OF_PART, |row, column| 0.1 * number(part + 10 * (row / 70) as u64, column, phase(row)));
    let y = Matrix::from_fn(PAIRS, OF_PART, |row, column| {
        let (own, other) = (x[(row, column)], x[(row, (column + 1) % OF_PART)]);
        0.9 * own + 3.0 * own * other + 0.002 * f64::from(signed(part, (row * OF_PART + column) as u64))
    });
    [x, y]
}

fn maps() {
    for part in 0..PARTS {
        let [x, y] = pairs(part);
        let options = |kernel| RegressionOptions { kernel, floor: 0.003, gain: 1.5, steps: 80 };
        let linear = Regression::train(&x, &y, &options(Kernel::Linear)).unwrap();
        let made: Vec<Vec<f64>> = (0..PAIRS).map(|row| linear.predict(x.row(row))).collect();
        let left = Matrix::from_fn(PAIRS, OF_PART, |row, column| y[(row, column)] - made[row][column]);
        black_box(Regression::train(&x, &left, &options(Kernel::NeuralNetwork)));
    }
}

fn training(criterion: &mut Criterion) {
    let frames = motions();
    let mut group = criterion.benchmark_group("training");
    group.sample_size(10);
    group.bench_function("model of 168 frames", |b| {
        let options = GpdmOptions { dimensions: 3, ..GpdmOptions::default() };
        b.iter(|| Gpdm::train(black_box(frames.clone()), &FRAMES, &options));
    });
    group.bench_function("maps of 5 parts from 350 pairs", |b| b.iter(maps));
    group.finish();
}

criterion_group!(benches, training);
criterion_main!(benches);
