//! Search over the ground: `cargo bench -p reprise-search --bench search`.
//!
//! With `REPRISE_BUNDLE=actor.reprise` also the five standard paths and ten key poses on that bundle, with their deviations
//! by time; `builder performer --frames 1500` and `builder pack` make the one that the figures in docs are of.
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs, reason = "a benchmark")]

#[path = "../tests/common/mod.rs"]
#[allow(dead_code, reason = "shared with tests")]
mod ground;

use std::hint::black_box;
use std::time::Instant;

use actor::graph::EssentialGraph;
use actor::motion::Motion;
use actor::timeline::Timeline;
use bundle::BundleReader;
use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use search::{
    Anytime, Curve, Direction, FrameRef, Goal, Key, KeysRequest, Measure, PATH_REALISM, PathTask, Progress, Request,
    Scene, SearchGraph, Shape, Target, depth_first, to_targets,
};

fn small(criterion: &mut Criterion) {
    let made = ground::random_scene::make(5, &[300, 300, 300], 20_000);
    let curve = Curve::new(&[Vec3::ZERO, Vec3::Z * 4.0, Vec3::new(3.0, 0.0, 5.0)], Shape::Spline, true, None);
    let start = PathTask::start_on(&made.search_graph, &curve, 0).unwrap();
    let task = PathTask::new(&made.search_graph, curve, vec![], vec![start], PATH_REALISM);
    criterion.bench_function("path: 1000 expanded states", |bench| {
        bench.iter(|| {
            let mut search = Anytime::new(&task, &made.search_graph);
            search.advance(&task, &made.search_graph, 1000);
            black_box(search.expanded())
        });
    });
    criterion.bench_function("backward table of least steps", |bench| {
        bench.iter(|| black_box(to_targets(&made.graph, &made.timeline, &[7], Measure::Steps)));
    });
    against_the_oracle();
}

/// How far the tool is from the exhaustive oracle on small graphs, by states expanded.
fn against_the_oracle() {
    let (mut worst, mut solved, mut expanded) = (1.0_f64, 0, 0);
    for seed in 0..24 {
        let made = ground::small_scene(seed);
        let curve = Curve::new(&[Vec3::ZERO, Vec3::new(0.2, 0.0, 0.7)], Shape::Polyline, true, None);
        let start = PathTask::start_on(&made.search_graph, &curve, 0).unwrap();
        let task = PathTask::new(&made.search_graph, curve, vec![], vec![start], PATH_REALISM);
        let oracle = depth_first(&task, &made.search_graph, 20_000_000);
        let mut search = Anytime::new(&task, &made.search_graph);
        search.advance(&task, &made.search_graph, 20_000);
        if let (true, Some(best), Some(found)) = (oracle.complete, oracle.found, search.best()) {
            worst = worst.max(found.cost / best.cost);
            (solved, expanded) = (solved + 1, expanded + search.expanded());
        }
    }
    println!(
        "oracle: {solved} of 24 small graphs exhausted; the tool at worst {worst:.4} times the best after at most 20,000 states, {} on average",
        expanded / solved.max(1)
    );
}

/// The five standard paths.
fn standard_paths() -> Vec<(&'static str, Vec<Vec3>, Shape)> {
    let ground = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let tau = std::f32::consts::TAU;
    let around =
        |count: usize, point: &dyn Fn(f32) -> Vec3| (0..=count).map(|k| point(k as f32 / count as f32)).collect();
    vec![
        ("line", vec![ground(0.0, 0.0), ground(0.0, 10.0)], Shape::Polyline),
        ("circle", around(24, &|t| ground(1.6 - 1.6 * (t * tau).cos(), 1.6 * (t * tau).sin())), Shape::Spline),
        ("slalom", around(40, &|t| ground((2.0 * t * tau).sin() * 0.8, t * 9.0)), Shape::Spline),
        (
            "right angles",
            vec![ground(0.0, 0.0), ground(0.0, 3.0), ground(3.0, 3.0), ground(3.0, 6.0), ground(4.0, 6.0)],
            Shape::Polyline,
        ),
        ("figure eight", around(48, &|t| ground(1.35 * (2.0 * t * tau).sin(), 2.2 * (t * tau).sin())), Shape::Spline),
    ]
}

fn on_a_bundle(_: &mut Criterion) {
    let Ok(path) = std::env::var("REPRISE_BUNDLE") else {
        println!("skipped: REPRISE_BUNDLE names no bundle");
        return;
    };
    let reader = BundleReader::from_bytes(&std::fs::read(path).unwrap()).unwrap();
    let (timeline, graph) = (reader.timeline().unwrap().clone(), reader.graph().unwrap().clone());
    let motion: Motion = reader.motion().unwrap().clone();
    let began = Instant::now();
    let search_graph = SearchGraph::new(&graph, &timeline, &motion).unwrap();
    println!(
        "search_graph of {} transitions: {:.0} ms",
        graph.transitions().len(),
        began.elapsed().as_secs_f64() * 1e3
    );
    for (name, points, shape) in standard_paths() {
        follow(&search_graph, name, &points, shape);
    }
    key_poses(&graph, &timeline, &search_graph);
}

fn follow(search_graph: &SearchGraph, name: &str, points: &[Vec3], shape: Shape) {
    let curve = Curve::new(points, shape, true, None);
    let starts = (0..search_graph.frame_count()).step_by(8).filter(|&frame| search_graph.live[frame as usize]);
    let starts = starts.filter_map(|frame| PathTask::start_on(search_graph, &curve, frame)).collect();
    let task = PathTask::new(search_graph, curve, vec![], starts, PATH_REALISM);
    let began = Instant::now();
    let mut search = Anytime::new(&task, search_graph);
    let (mut slowest, mut first) = (0.0_f64, None);
    for most in [0.1, 0.5, 2.0, 10.0] {
        while began.elapsed().as_secs_f64() < most && search.progress() == Progress::Running {
            let slice = Instant::now();
            search.advance(&task, search_graph, 50);
            slowest = slowest.max(slice.elapsed().as_secs_f64());
            let whole = search.best().is_some_and(|best| best.end.travelled >= task.curve.length());
            first = first.or_else(|| whole.then(|| (began.elapsed().as_secs_f64(), search.expanded())));
        }
        let report = task.judge(search_graph, search.best().unwrap());
        println!(
            "{name}, {:.1} m, after {most} s ({} states): J_c {:.3}, off {:.1} cm mean, {:.1} cm max; aside {:.1} and {:.1} cm",
            report.length,
            search.expanded(),
            search.best().unwrap().cost,
            report.mean * 100.0,
            report.max * 100.0,
            report.mean_aside * 100.0,
            report.max_aside * 100.0
        );
    }
    println!("{name}: first whole walk (s, states) {first:?}, slowest slice of 50 states {:.2} ms", slowest * 1e3);
}

/// The papers' table: ten key poses of all over the capture, at times that differ from the recorded ones.
fn key_poses(graph: &EssentialGraph, timeline: &Timeline, search_graph: &SearchGraph) {
    let n = f64::from(timeline.frame_count());
    let shares = [0.12, 0.25, 0.012, 0.064, 0.15, 0.66, 0.29, 0.47, 0.95, 0.79];
    let times = [0.0, 250.0, 460.0, 510.0, 610.0, 890.0, 970.0, 1420.0, 1520.0, 1800.0].map(|frame| frame / 50.0);
    let key = |(share, time): (f64, f64)| {
        let mut frame = (share * n) as u32;
        while !search_graph.main[frame as usize] {
            frame += 1;
        }
        Key { pose: FrameRef::Number(frame), time }
    };
    let poses = shares.into_iter().zip(times).map(key).collect();
    let request = Request::new(Target::Keys(KeysRequest { poses }));
    let scene = Scene { graph, timeline, search_graph };
    let began = Instant::now();
    let mut direction = Direction::new(&scene, None, &request, u32::MAX).unwrap();
    while direction.advance(&scene, 500).unwrap() == Progress::Running {}
    let answer = direction.best(&scene);
    let Goal::Keys { rows, mean_error } = &answer.parts[0].goal else { return };
    println!("key poses: mean error {mean_error} frames in {:.0} ms", began.elapsed().as_secs_f64() * 1e3);
    rows.iter()
        .for_each(|row| println!("  frame {:>5}: wanted {:>5}, reached {:?}", row.frame, row.wanted, row.reached));
}

criterion_group!(benches, small, on_a_bundle);
criterion_main!(benches);
