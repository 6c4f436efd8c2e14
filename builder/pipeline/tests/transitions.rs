//! Optimal transitions against every path of small grids, and against a plain dynamic programme on larger input.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that panics has failed; what it measured is printed"
)]

mod common;

use std::ops::ControlFlow;

use actor::timeline::Timeline;
use fixtures::{Captured, Random, crane_and_jumping};
use job::{Job, Progress};
use pipeline::distance::{DistanceMatrix, DistanceOptions, pose_distances};
use pipeline::transitions::{
    HASTE_SPEED, LengthChoice, TransitionCost, TransitionMatrix, TransitionOptions, WarpFinder, optimal_transitions,
};

/// A path's sum of distances and number of nodes. Distances in the tests are small multiples of 2^-20, so sums are exact.
type Cost = (f64, usize);

fn transitions(distances: &DistanceMatrix, timeline: &Timeline, options: &TransitionOptions) -> TransitionMatrix {
    optimal_transitions(distances, timeline, options, &Job::new(&within)).unwrap()
}

/// Options for segments of `shortest` to `longest` frames at 1 frame a second.
fn options(shortest: usize, longest: usize, slope: Option<u8>, choice: LengthChoice) -> TransitionOptions {
    TransitionOptions { shortest_seconds: shortest as f32, longest_seconds: longest as f32, slope, choice }
}

fn random_distances(frames: usize, levels: usize, random: &mut Random) -> DistanceMatrix {
    let unit = if levels < 100 { 0.25 } else { 1.0 / 1_048_576.0 };
    DistanceMatrix::from_fn(frames, |_, _| random.below(levels) as f32 * unit)
}

/// d^2 / (w^2 T) + T, in frames; a path of one node is all haste.
fn haste((sum, nodes): Cost, fps: f32) -> f64 {
    let (mean, steps) = (sum / nodes as f64, (nodes - 1) as f64);
    let hurry = f64::from(fps) / HASTE_SPEED;
    if nodes > 1 { mean * mean * (hurry * hurry) / steps + steps } else { f64::INFINITY }
}

/// The transition (i, j) chosen among all lengths, where `cost(li, lj)` is the cost of the best path.
fn choose(
    lengths: impl Iterator<Item = (usize, usize)>,
    (choice, fps): (LengthChoice, f32),
    cost: impl Fn(usize, usize) -> Option<Cost>,
) -> Option<TransitionCost> {
    let mut best: Option<(Cost, usize, usize)> = None;
    for (li, lj) in lengths {
        let Some(new) = cost(li, lj) else { continue };
        let better = best.is_none_or(|(old, old_li, old_lj)| {
            let (a, b) = match choice {
                LengthChoice::Total => (new.0, old.0),
                LengthChoice::Mean => (new.0 * old.1 as f64, old.0 * new.1 as f64),
                LengthChoice::Haste => (haste(new, fps), haste(old, fps)),
            };
            a < b || (a == b && (new.0, new.1, li, lj) < (old.0, old.1, old_li, old_lj))
        });
        if better {
            best = Some((new, li, lj));
        }
    }
    best.map(|((deformation, duration), li, lj)| TransitionCost {
        deformation: deformation as f32,
        duration: duration as u16,
        source_length: li as u16,
        destination_length: lj as u16,
    })
}

/// Distances between the frames of two segments; `None` where one leaves its sequence.
fn window(
    distances: &DistanceMatrix,
    timeline: &Timeline,
    i: u32,
    j: u32,
    li: usize,
    lj: usize,
) -> Option<Vec<Vec<f64>>> {
    let fits = |frame, length| length <= timeline.sequence_of(frame).unwrap().frame_count as usize;
    if !fits(i, li) || !fits(j, lj) {
        return None;
    }
    (0..li as i64)
        .map(|k| {
            let row = timeline.offset(i, k)? as usize;
            let columns = (0..lj as i64).map(|l| timeline.offset(j, l + 1 - lj as i64));
            columns.map(|column| Some(f64::from(distances.get(row, column? as usize)))).collect()
        })
        .collect()
}

/// The best of all paths to the far corner of `window`, by trying every one.
fn enumerate(window: &[Vec<f64>], slope: Option<u8>) -> Option<Cost> {
    fn walk(
        window: &[Vec<f64>],
        at: (usize, usize),
        run: usize,
        last: u8,
        sum: Cost,
        slope: Option<u8>,
        best: &mut Option<Cost>,
    ) {
        let (k, l) = at;
        let Some(node) = window.get(k).and_then(|row| row.get(l)) else { return };
        let sum = (sum.0 + node, sum.1 + 1);
        if (k, l) == (window.len() - 1, window[0].len() - 1) {
            let better = best.is_none_or(|best| sum.0 < best.0 || (sum.0 == best.0 && sum.1 < best.1));
            if better {
                *best = Some(sum);
            }
            return;
        }
        walk(window, (k + 1, l + 1), 1, 0, sum, slope, best);
        // Straight steps follow a diagonal one or one of their own kind, p in all.
        let allowed = |kind| match slope {
            None => true,
            Some(p) => (last == 0 || last == kind) && (1..usize::from(p)).contains(&run),
        };
        if allowed(1) {
            walk(window, (k + 1, l), run + 1, 1, sum, slope, best);
        }
        if allowed(2) {
            walk(window, (k, l + 1), run + 1, 2, sum, slope, best);
        }
    }
    let mut best = None;
    walk(window, (0, 0), 0, 3, (0.0, 0), slope, &mut best);
    best
}

/// The best path to the far corner of `window`, by thesis equation 2.53 word for word.
fn plain_programme(window: &[Vec<f64>], slope: Option<u8>) -> Option<Cost> {
    let (rows, columns) = (window.len(), window[0].len());
    let mut least: Vec<Vec<Option<Cost>>> = vec![vec![None; columns]; rows];
    for k in 0..rows {
        for l in 0..columns {
            let mut candidates = Vec::new();
            let mut offer = |back: (usize, usize), nodes: Vec<f64>| {
                if k >= back.0
                    && l >= back.1
                    && let Some(before) = least[k - back.0][l - back.1]
                {
                    candidates.push((before.0 + nodes.iter().sum::<f64>(), before.1 + nodes.len()));
                }
            };
            let column = |count: usize| (0..count.min(k + 1)).map(|back| window[k - back][l]).collect();
            let row = |count: usize| (0..count.min(l + 1)).map(|back| window[k][l - back]).collect();
            match slope {
                None => [(1, 1), (1, 0), (0, 1)].into_iter().for_each(|back| offer(back, vec![window[k][l]])),
                Some(p) => {
                    for q in 1..=usize::from(p) {
                        offer((q, 1), column(q));
                        offer((1, q), row(q));
                    }
                }
            }
            if (k, l) == (0, 0) {
                candidates.push((window[0][0], 1));
            }
            least[k][l] = candidates.into_iter().min_by(|a, b| a.partial_cmp(b).unwrap());
        }
    }
    least[rows - 1][columns - 1]
}

fn check(
    distances: &DistanceMatrix,
    timeline: &Timeline,
    (shortest, longest): (usize, usize),
    options: &TransitionOptions,
    pairs: impl Iterator<Item = (u32, u32)>,
    best_path: fn(&[Vec<f64>], Option<u8>) -> Option<Cost>,
) {
    let found = transitions(distances, timeline, options);
    for (i, j) in pairs {
        let lengths = (shortest..=longest).flat_map(|li| (shortest..=longest).map(move |lj| (li, lj)));
        let want = choose(lengths, (options.choice, timeline.fps()), |li, lj| {
            best_path(&window(distances, timeline, i, j, li, lj)?, options.slope)
        });
        assert_eq!(found.get(i as usize, j as usize), want, "{i} to {j}, {options:?}");
    }
}

fn all_pairs(n: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)))
}

const SLOPES: [Option<u8>; 6] = [Some(1), Some(2), Some(3), Some(4), Some(5), None];

/// No stage is ever more than done.
fn within(progress: Progress) -> ControlFlow<()> {
    assert!(progress.done <= progress.total, "{progress:?}");
    ControlFlow::Continue(())
}

#[test]
fn matches_every_path_of_small_grids() {
    let mut random = Random::new(1);
    let timeline = common::timeline(1.0, &[(9, false), (6, true), (4, false), (1, false)]);
    for slope in SLOPES {
        for choice in LengthChoice::ALL {
            // Few levels make many ties.
            for levels in [3, 1_000_000] {
                let distances = random_distances(20, levels, &mut random);
                check(&distances, &timeline, (2, 5), &options(2, 5, slope, choice), all_pairs(20), enumerate);
                check(&distances, &timeline, (1, 4), &options(1, 4, slope, choice), all_pairs(20), enumerate);
            }
        }
    }
}

#[test]
fn matches_a_plain_programme_on_larger_grids() {
    let mut random = Random::new(2);
    let timeline = common::timeline(1.0, &[(170, false), (31, true), (23, false), (12, true)]);
    let distances = random_distances(236, 1_000_000, &mut random);
    for slope in SLOPES {
        for choice in LengthChoice::ALL {
            let pairs: Vec<_> = (0..30).map(|_| (random.below(236) as u32, random.below(236) as u32)).collect();
            check(&distances, &timeline, (6, 25), &options(6, 25, slope, choice), pairs.into_iter(), plain_programme);
        }
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn matches_a_plain_programme_on_a_real_capture() {
    let Captured { topology, poses, timeline } = crane_and_jumping(5);
    let distances = pose_distances(&topology, &poses, &DistanceOptions::default(), &Job::silent()).unwrap();
    let multiples = DistanceMatrix::from_fn(distances.frame_count(), |i, j| {
        (distances.get(i, j) * 1_048_576.0).round() / 1_048_576.0
    });
    let mut random = Random::new(3);
    for choice in LengthChoice::ALL {
        let options = TransitionOptions { shortest_seconds: 0.6, longest_seconds: 3.0, choice, ..Default::default() };
        let pairs: Vec<_> = (0..200).map(|_| (random.below(65) as u32, random.below(65) as u32)).collect();
        check(&multiples, &timeline, (3, 15), &options, pairs.into_iter(), plain_programme);
        let found = transitions(&distances, &timeline, &options);
        let count = all_pairs(65).filter(|&(i, j)| found.get(i as usize, j as usize).is_some()).count();
        println!("{choice:?}: {count} transitions between {} frames", poses.len());
        assert!(count > 1_000);
    }
}

#[test]
fn default_lengths_are_the_papers() {
    for (fps, shortest, longest) in [(50.0, 15, 100), (24.0, 8, 48), (25.0, 8, 50), (30.0, 9, 60), (60.0, 18, 120)] {
        let lengths = TransitionOptions::default().lengths(&common::timeline(fps, &[(1, false)])).unwrap();
        assert_eq!((lengths.shortest, lengths.longest), (shortest, longest), "{fps} fps");
    }
}

#[test]
fn warps_cost_what_the_matrix_says() {
    let mut random = Random::new(4);
    let timeline = common::timeline(1.0, &[(40, false), (17, true)]);
    for levels in [3, 1_000_000] {
        let distances = random_distances(57, levels, &mut random);
        for slope in SLOPES {
            let options = options(4, 14, slope, LengthChoice::Total);
            let found = transitions(&distances, &timeline, &options);
            let finder = WarpFinder::new(&distances, &timeline, &options).unwrap();
            for (i, j) in all_pairs(57) {
                let Some(cost) = found.get(i as usize, j as usize) else { continue };
                let (li, lj) = (usize::from(cost.source_length), usize::from(cost.destination_length));
                let warp = finder.find(i, j, li, lj).unwrap();
                assert_eq!(warp.lengths(), (li, lj));
                assert_eq!(warp.duration(), usize::from(cost.duration));
                let window = window(&distances, &timeline, i, j, li, lj).unwrap();
                let sum: f64 = warp.nodes().map(|(k, l)| window[k][l]).sum();
                assert_eq!(sum as f32, cost.deformation);
            }
        }
    }
}

#[test]
fn refuses_what_makes_no_sense() {
    let timeline = common::timeline(1.0, &[(9, false)]);
    let distances = random_distances(9, 100, &mut Random::new(5));
    let refused = |options| optimal_transitions(&distances, &timeline, &options, &Job::silent()).is_err();
    assert!(refused(options(0, 3, Some(3), LengthChoice::Total)));
    assert!(refused(options(4, 3, Some(3), LengthChoice::Total)));
    assert!(refused(options(4, 30_000, Some(3), LengthChoice::Total)));
    assert!(refused(options(2, 3, Some(0), LengthChoice::Total)));
    assert!(refused(options(2, 3, Some(6), LengthChoice::Total)));
    let options = options(2, 3, Some(1), LengthChoice::Total);
    let finder = WarpFinder::new(&distances, &timeline, &options).unwrap();
    for (from, to, li, lj) in [(0, 9, 2, 2), (8, 4, 2, 2), (0, 0, 2, 2), (0, 4, 2, 3), (0, 4, 0, 2), (0, 4, 4, 4)] {
        assert!(finder.find(from, to, li, lj).is_err(), "{from} {to} {li} {lj}");
    }
    assert!(finder.find(0, 4, 3, 3).is_ok());
}
