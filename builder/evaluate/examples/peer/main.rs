//! Our side of the comparisons in `tests/peers`: reads numpy files, does one job, prints its seconds.
//!
//! ```text
//! peer export BUNDLE OUT       poses.npy (n, N, 3) and faces.npy (M, 3) of a bundle, into the folder OUT
//! peer dtw SERIES LENGTH OUT   sums of the best warps of all windows of LENGTH of a series, |a - b| as distance
//! peer paths COSTS OUT         the essential edges of a digraph of costs (n, n), as (from, to)
//! peer between POSES FACES I J COUNT OUT   COUNT Poisson in-betweens of frames I and J; the middle one is written
//! peer decode BUNDLE           all frames of a bundle, in order
//! peer pca ROWS COUNT OUT      variances of the first COUNT components of rows (n, columns)
//! peer flow A B OUT            the flow (height, width, 2) from a texture (height, width) to another, 0 to 1
//! ```
#![allow(clippy::print_stdout, reason = "the result is what is printed")]

mod npy;

use std::time::Instant;

use actor::pose_source::PoseSource;
use actor::timeline::{Sequence, Timeline};
use anyhow::{Context, Result, bail};
use appearance::Charts;
use appearance::flow::{FlowGrid, FlowOptions};
use bundle::BundleReader;
use glam::Vec3;
use job::Job;
use kernels::poisson::{KeyedPose, PoissonInterpolator};
use kernels::topology::{Topology, barycentric_areas};
use learn::pca::components;
use learn::store::Store;
use pipeline::distance::DistanceMatrix;
use pipeline::essential::essential_edges;
use pipeline::transitions::{LengthChoice, TransitionCost, TransitionMatrix, TransitionOptions, optimal_transitions};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let seconds = match words.as_slice() {
        ["export", bundle, out] => export(bundle, out)?,
        ["dtw", series, length, out] => dtw(series, length.parse()?, out)?,
        ["paths", costs, out] => paths(costs, out)?,
        ["between", poses, faces, i, j, count, out] => {
            between(poses, faces, i.parse()?, j.parse()?, count.parse()?, out)?
        }
        ["decode", bundle] => decode(bundle)?,
        ["pca", rows, count, out] => pca(rows, count.parse()?, out)?,
        ["flow", a, b, out] => flow(a, b, out)?,
        _ => bail!("see the head of builder/evaluate/examples/peer/main.rs"),
    };
    println!("{seconds}");
    Ok(())
}

fn pca(rows: &str, count: usize, out: &str) -> Result<f64> {
    let rows = npy::read::<f32>(rows)?;
    let (n, columns) = (rows.shape[0], rows.shape[1]);
    let store = Store::new(n, columns, 2.0)?;
    for (row, values) in rows.values.chunks_exact(columns).enumerate() {
        store.write(row, values)?;
    }
    let all: Vec<usize> = (0..n).collect();
    let (found, seconds) = timed(|| components(&store, &all, count));
    let variances = found?.variances;
    npy::write(out, &[variances.len()], variances.into_iter().map(|v| v as f32))?;
    Ok(seconds)
}

fn flow(a: &str, b: &str, out: &str) -> Result<f64> {
    let textures = [npy::read::<f32>(a)?, npy::read::<f32>(b)?];
    let (height, width) = (textures[0].shape[0], textures[0].shape[1]);
    let grid = FlowGrid::new(&Charts::whole(width, height), FlowOptions::default());
    let (flow, seconds) = timed(|| {
        let [a, b] = textures.each_ref().map(|texture| grid.prepare(&texture.values, None));
        grid.flow(&a, &b)
    });
    npy::write(out, &[height, width, 2], flow.x.iter().zip(&flow.y).flat_map(|(x, y)| [*x, *y]))?;
    Ok(seconds)
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

fn sequences(lengths: impl Iterator<Item = u32>, fps: f32) -> Result<Timeline> {
    let mut first_frame = 0;
    let sequences = lengths.enumerate().map(|(index, frame_count)| {
        first_frame += frame_count;
        let name = index.to_string();
        Sequence { name, labels: vec![], first_frame: first_frame - frame_count, frame_count, cyclic: false }
    });
    Ok(Timeline::new(fps, sequences.collect())?)
}

fn export(bundle: &str, out: &str) -> Result<f64> {
    let mut reader = BundleReader::from_bytes(&std::fs::read(bundle)?)?;
    let topology = reader.topology().context("the bundle ends early")?.clone();
    let frames = reader.timeline().context("the bundle ends early")?.frame_count();
    let mut poses = Vec::new();
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    for frame in 0..frames {
        reader.read(frame, &mut pose)?;
        poses.extend(pose.iter().flat_map(|p| p.to_array()));
    }
    let shape = [frames as usize, pose.len(), 3];
    npy::write(format!("{out}/poses.npy"), &shape, poses.into_iter())?;
    let faces = topology.triangles();
    npy::write(format!("{out}/faces.npy"), &[faces.len(), 3], faces.iter().flatten().copied())?;
    Ok(0.0)
}

fn dtw(series: &str, length: usize, out: &str) -> Result<f64> {
    let series = npy::read::<f32>(series)?.values;
    let n = series.len();
    let distances = DistanceMatrix::from_fn(n, |i, j| (series[i] - series[j]).abs());
    let timeline = sequences(std::iter::once(n as u32), 100.0)?;
    let seconds = length as f32 / 100.0;
    let options = TransitionOptions {
        shortest_seconds: seconds,
        longest_seconds: seconds,
        slope: None,
        choice: LengthChoice::Total,
    };
    let (found, time) = timed(|| optimal_transitions(&distances, &timeline, &options, &Job::silent()));
    let found = found?;
    // By first frames of both windows.
    let windows = n + 1 - length;
    let cost = |i: usize, j: usize| found.get(i, j + length - 1).map_or(f32::NAN, |cost| cost.deformation);
    let pairs = (0..windows).flat_map(|i| (0..windows).map(move |j| (i, j)));
    npy::write(out, &[windows, windows], pairs.map(|(i, j)| cost(i, j)))?;
    Ok(time)
}

fn paths(costs: &str, out: &str) -> Result<f64> {
    let costs = npy::read::<f32>(costs)?;
    let n = *costs.shape.first().context("no matrix")?;
    let transitions = TransitionMatrix::from_fn(n, |i, j| {
        let deformation = costs.values[i * n + j];
        let cost = TransitionCost { deformation, duration: 1, source_length: 1, destination_length: 1 };
        deformation.is_finite().then_some(cost)
    });
    let timeline = sequences(std::iter::repeat_n(1, n), 1.0)?;
    // The least weight of a frame, so that costs are those given.
    let alpha = actor::graph::ALPHA_RESOLUTION;
    let (found, time) = timed(|| essential_edges(&transitions, &timeline, alpha));
    let edges = found?.edges;
    npy::write(out, &[edges.len(), 2], edges.iter().flat_map(|&(from, to)| [from, to]))?;
    Ok(time)
}

fn between(poses: &str, faces: &str, i: usize, j: usize, count: usize, out: &str) -> Result<f64> {
    let (poses, faces) = (npy::read::<f32>(poses)?, npy::read::<u32>(faces)?);
    let vertices = *poses.shape.get(1).context("no poses")?;
    let pose = |frame: usize| -> Vec<Vec3> {
        let floats = &poses.values[frame * vertices * 3..(frame + 1) * vertices * 3];
        floats.chunks_exact(3).map(|p| Vec3::new(p[0], p[1], p[2])).collect()
    };
    let (source, destination) = (pose(i), pose(j));
    let triangles: Vec<[u32; 3]> = faces.values.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    let weights = barycentric_areas(&triangles, &source);
    let topology = Topology::new(vertices as u32, triangles, weights)?;
    let mut interpolator = PoissonInterpolator::new(&topology, None)?;
    let mut pose = vec![Vec3::ZERO; vertices];
    let mut run = |lambda: f32| {
        interpolator.restart();
        let keyed = |frame: usize, pose| KeyedPose { frame: frame as u32, pose };
        interpolator.interpolate(keyed(i, &source), keyed(j, &destination), lambda, &mut pose).map(|_| ())
    };
    let (made, time) = timed(|| (0..count).try_for_each(|index| run((index + 1) as f32 / (count + 1) as f32)));
    made?;
    run(0.5)?;
    npy::write(out, &[vertices, 3], pose.iter().flat_map(|p| p.to_array()))?;
    Ok(time)
}

fn decode(bundle: &str) -> Result<f64> {
    let bytes = std::fs::read(bundle)?;
    let mut reader = BundleReader::from_bytes(&bytes)?;
    let frames = reader.timeline().context("the bundle ends early")?.frame_count();
    let mut pose = vec![Vec3::ZERO; reader.topology().context("the bundle ends early")?.vertex_count()];
    let (read, time) = timed(|| (0..frames).try_for_each(|frame| reader.read(frame, &mut pose)));
    read?;
    Ok(time)
}
