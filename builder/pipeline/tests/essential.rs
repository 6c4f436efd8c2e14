//! The essential graph against Floyd and Warshall's algorithm word for word.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that panics has failed; what it measured is printed"
)]

mod common;

use actor::graph::rounded_alpha;
use actor::timeline::Timeline;
use fixtures::{Captured, Random, crane_and_jumping};
use job::Job;
use pipeline::distance::{DistanceOptions, pose_distances};
use pipeline::essential::hidden_paths::hidden_paths;
use pipeline::essential::live::{SLACK_SECONDS, one_for_all};
use pipeline::essential::sparse::{Candidates, Thinning, by_all_paths, by_searches, row_candidates};
use pipeline::essential::{Essential, essential_edges, motion_graph, reach, strongly_connected};
use pipeline::transitions::{TransitionCost, TransitionMatrix, TransitionOptions, optimal_transitions};

/// E of the complete digraph: transitions and recorded steps.
fn direct_costs(transitions: &TransitionMatrix, timeline: &Timeline, alpha: f64) -> Vec<Vec<f64>> {
    let n = timeline.frame_count();
    let mut costs = vec![vec![f64::INFINITY; n as usize]; n as usize];
    for i in 0..n {
        for (j, transition) in transitions.row(i as usize) {
            if j != i as usize {
                costs[i as usize][j] = f64::from(transition.deformation) + alpha * f64::from(transition.duration);
            }
        }
        if let Some(next) = timeline.next(i).filter(|&next| next != i) {
            costs[i as usize][next as usize] = alpha;
        }
    }
    costs
}

/// Shortest paths of any number of edges; infinite from a node to itself, so that detours are detours.
fn floyd_warshall(mut lengths: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = lengths.len();
    for k in 0..n {
        for i in 0..n {
            for j in 0..n {
                if i != j {
                    lengths[i][j] = lengths[i][j].min(lengths[i][k] + lengths[k][j]);
                }
            }
        }
    }
    lengths
}

fn plain_essential(transitions: &TransitionMatrix, timeline: &Timeline, alpha: f64) -> Vec<(u32, u32)> {
    let direct = direct_costs(transitions, timeline, alpha);
    let lengths = floyd_warshall(direct.clone());
    let n = direct.len();
    let mut edges = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let detour = (0..n).map(|k| lengths[i][k] + lengths[k][j]).fold(f64::INFINITY, f64::min);
        let recorded = timeline.next(i as u32) == Some(j as u32);
        if direct[i][j].is_finite() && !recorded && direct[i][j] < detour {
            edges.push((i as u32, j as u32));
        }
    }
    edges
}

fn check(transitions: &TransitionMatrix, timeline: &Timeline, alpha: f64) -> Essential {
    let found = essential_edges(transitions, timeline, alpha).unwrap();
    let alpha = rounded_alpha(alpha);
    assert_eq!(found.edges, plain_essential(transitions, timeline, alpha));
    assert_eq!(found.edges, hidden_paths(transitions, timeline, alpha), "by hidden paths");
    for (decide, how) in [(by_all_paths as Decide, "all paths"), (searches, "searches")] {
        assert_eq!(found.edges, from_candidates(transitions, timeline, alpha, decide), "from candidates by {how}");
    }
    for (band, more) in [(1, 0), (3, 0), (7, 40), (64, 1000)] {
        let decide = |candidates: &Candidates, timeline: &Timeline, alpha| {
            searches(&thinned(candidates, timeline, alpha, band, more), timeline, alpha)
        };
        let edges = from_candidates(transitions, timeline, alpha, decide);
        assert_eq!(found.edges, edges, "from bands of {band} rows, thinned out beyond {more}");
    }

    // The certificate: paths through the edges kept are as short as any.
    let all = direct_costs(transitions, timeline, alpha);
    let kept = TransitionMatrix::from_fn(all.len(), |i, j| {
        transitions.get(i, j).filter(|_| found.edges.binary_search(&(i as u32, j as u32)).is_ok())
    });
    let shortest = floyd_warshall(all);
    assert_eq!(floyd_warshall(direct_costs(&kept, timeline, alpha)), shortest);

    let n = shortest.len();
    let reached = |i: usize, j: usize| shortest[i][j].is_finite();
    let unreachable = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&(i, j)| i != j && !reached(i, j));
    assert_eq!(found.unreachable_pairs, unreachable.count() as u64);
    let dead_ends: Vec<u32> = (0..n).filter(|&i| (0..n).all(|j| !reached(i, j))).map(|i| i as u32).collect();
    assert_eq!(found.dead_ends, dead_ends);
    let unreached: Vec<u32> = (0..n).filter(|&j| (0..n).all(|i| !reached(i, j))).map(|j| j as u32).collect();
    assert_eq!(found.unreached, unreached);

    let components = strongly_connected(timeline, &found.edges);
    let reach = reach(&components, timeline, &found.edges);
    assert_eq!((reach.unreachable_pairs, &reach.dead_ends), (found.unreachable_pairs, &found.dead_ends));
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&(i, j)| i != j) {
        let together = components.component_of_frame[i] == components.component_of_frame[j];
        assert_eq!(together, reached(i, j) && reached(j, i), "{i} and {j}");
    }
    let size = |component| components.component_of_frame.iter().filter(|&&other| other == component).count();
    assert!((0..n as u32).all(|component| size(component) <= components.largest_frames().count()));
    found
}

type Decide = fn(&Candidates, &Timeline, f64) -> Candidates;

fn searches(candidates: &Candidates, timeline: &Timeline, alpha: f64) -> Candidates {
    by_searches(candidates, timeline, alpha, &Job::silent()).unwrap()
}

/// What is left of candidates that come in bands of rows.
fn thinned(candidates: &Candidates, timeline: &Timeline, alpha: f64, band: usize, more: usize) -> Candidates {
    let job = Job::silent();
    let mut thinning = Thinning::new(timeline, alpha, more, &job);
    let frames: Vec<u32> = (0..candidates.frame_count()).collect();
    for band in frames.chunks(band) {
        thinning.push(&band.iter().map(|&frame| candidates.from(frame).to_vec()).collect::<Vec<_>>()).unwrap();
    }
    let left = thinning.left();
    assert!(left.frame_count() == candidates.frame_count() && left.len() <= candidates.len());
    left
}

/// By way of candidates; the next row is not always at hand.
fn from_candidates(
    transitions: &TransitionMatrix,
    timeline: &Timeline,
    alpha: f64,
    decide: impl Fn(&Candidates, &Timeline, f64) -> Candidates,
) -> Vec<(u32, u32)> {
    let mut candidates = Candidates::new();
    for from in 0..timeline.frame_count() {
        let next = timeline.next(from).filter(|_| from % 4 != 3).map(|next| transitions.costs_from(next as usize));
        candidates.push_row(row_candidates(timeline, alpha, from, transitions.costs_from(from as usize), next));
    }
    let kept = decide(&candidates, timeline, alpha);
    (0..timeline.frame_count()).flat_map(|from| kept.from(from).iter().map(move |&(to, _)| (from, to))).collect()
}

fn random_transitions(n: usize, density: f32, levels: usize, random: &mut Random) -> TransitionMatrix {
    TransitionMatrix::from_fn(n, |_, _| {
        (random.unit() < density).then(|| {
            let duration = 1 + random.below(12) as u16;
            let deformation = random.below(levels) as f32 / 1024.0;
            TransitionCost { deformation, duration, source_length: duration, destination_length: duration }
        })
    })
}

#[test]
fn matches_floyd_warshall_on_random_graphs() {
    let mut random = Random::new(1);
    let mut edges = 0;
    for round in 0..400 {
        let lengths: Vec<_> =
            (0..1 + random.below(5)).map(|_| (1 + random.below(9) as u32, random.unit() < 0.3)).collect();
        let timeline = common::timeline(25.0, &lengths);
        let density = [0.05, 0.3, 1.0][round % 3];
        // Few levels make many ties.
        let levels = [1, 8, 1_000_000][round / 3 % 3];
        let transitions = random_transitions(timeline.frame_count() as usize, density, levels, &mut random);
        let alpha = [1.0 / 1024.0, 0.01, 1e-6, 2.0][round % 4];
        edges += check(&transitions, &timeline, alpha).edges.len();
    }
    assert!(edges > 1_000, "{edges}");
}

#[test]
fn matches_floyd_warshall_over_several_blocks() {
    let mut random = Random::new(2);
    for (lengths, levels) in
        [(vec![(64, false), (64, true)], 1_000), (vec![(70, false), (61, true), (52, false)], 1_000_000)]
    {
        let timeline = common::timeline(25.0, &lengths);
        let transitions = random_transitions(timeline.frame_count() as usize, 0.7, levels, &mut random);
        assert!(check(&transitions, &timeline, 0.01).edges.len() > 10);
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn matches_floyd_warshall_on_a_real_capture() {
    let Captured { topology, poses, timeline } = crane_and_jumping(3);
    let distances = pose_distances(&topology, &poses, &DistanceOptions::default(), &Job::silent()).unwrap();
    let transitions =
        optimal_transitions(&distances, &timeline, &TransitionOptions::default(), &Job::silent()).unwrap();
    let mut before = 0;
    for alpha in [0.001, 0.01, 0.1] {
        let found = check(&transitions, &timeline, alpha);
        let baseline = motion_graph(&transitions, &timeline, alpha);
        println!(
            "{} frames, alpha {alpha}: {} transitions stay, {} in the motion graph, {} dead ends, {} unreached",
            poses.len(),
            found.edges.len(),
            baseline.len(),
            found.dead_ends.len(),
            found.unreached.len()
        );
        // Thesis figure 3.2: the dearer time is, the more shortcuts pay.
        assert!(found.edges.len() > before);
        before = found.edges.len();
    }
}

#[test]
fn a_transition_gives_way_to_recorded_frames_that_cost_the_same() {
    let timeline = common::timeline(25.0, &[(6, false)]);
    let only = |duration, deformation| {
        TransitionMatrix::from_fn(6, |i, j| {
            let cost = TransitionCost { deformation, duration, source_length: 2, destination_length: 2 };
            ((i, j) == (0, 5)).then_some(cost)
        })
    };
    let alpha = 1.0 / 64.0;
    assert_eq!(check(&only(5, 0.0), &timeline, alpha).edges, []);
    assert_eq!(check(&only(4, 1.0 / 64.0), &timeline, alpha).edges, []);
    assert_eq!(check(&only(4, 0.0), &timeline, alpha).edges, [(0, 5)]);
}

#[test]
fn the_motion_graph_holds_strict_minima() {
    let timeline = common::timeline(25.0, &[(5, false), (5, false)]);
    let cost = |deformation| TransitionCost { deformation, duration: 3, source_length: 3, destination_length: 3 };
    let transitions = TransitionMatrix::from_fn(10, |i, j| {
        let inside = i < 5 && j >= 5;
        inside.then(|| cost(if (i, j) == (2, 7) { 0.5 } else { 1.0 + (i + j) as f32 }))
    });
    assert_eq!(motion_graph(&transitions, &timeline, 0.01), [(0, 5), (2, 7)]);
    let flat = TransitionMatrix::from_fn(10, |i, j| (i < 5 && j >= 5).then(|| cost(1.0)));
    assert_eq!(motion_graph(&flat, &timeline, 0.01), []);
}

#[test]
fn refuses_alphas_that_are_no_cost() {
    let timeline = common::timeline(25.0, &[(3, false)]);
    let transitions = TransitionMatrix::from_fn(3, |_, _| None);
    for alpha in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-9, 1e6] {
        assert!(essential_edges(&transitions, &timeline, alpha).is_err());
    }
    let found = essential_edges(&transitions, &timeline, 0.01).unwrap();
    assert_eq!((found.edges.len(), found.unreachable_pairs), (0, 3));
    assert_eq!((found.dead_ends, found.unreached), (vec![2], vec![0]));
}

/// The least and the largest alpha, and one of the capture's own between them.
const RANGE: [f64; 3] = [0.01, 0.2, 0.03];

fn check_one_for_all(transitions: &TransitionMatrix, timeline: &Timeline) {
    let [least, most, own] = RANGE.map(rounded_alpha);
    let at = |alpha: f64| {
        let edges = essential_edges(transitions, timeline, alpha).unwrap().edges;
        let mut essential = Candidates::new();
        for from in 0..timeline.frame_count() {
            let row = edges.iter().filter(|edge| edge.0 == from);
            essential.push_row(row.map(|&(_, to)| (to, transitions.get(from as usize, to as usize).unwrap())));
        }
        essential
    };
    let others = [most, least].map(|alpha| (alpha, at(alpha)));
    let kept = one_for_all(&at(own), &others, timeline);
    // All that is essential at the own alpha, and nothing that is essential nowhere.
    let all = [&at(own), &others[0].1, &others[1].1];
    for from in 0..timeline.frame_count() {
        assert!(all[0].from(from).iter().all(|&(to, cost)| kept.get(from, to) == Some(cost)));
        assert!(kept.from(from).iter().all(|&(to, _)| all.iter().any(|set| set.get(from, to).is_some())));
        assert!(kept.from(from).windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
    // No way is dearer by more than the slack for each transition of the best one.
    let slack = f64::from((SLACK_SECONDS * timeline.fps()).round());
    for (alpha, essential) in &others {
        let within = TransitionMatrix::from_fn(timeline.frame_count() as usize, |i, j| kept.get(i as u32, j as u32));
        let lengths = floyd_warshall(direct_costs(&within, timeline, *alpha));
        for from in 0..timeline.frame_count() {
            for &(to, cost) in essential.from(from) {
                let (way, best) = (lengths[from as usize][to as usize], cost.cost(*alpha));
                assert!(way <= best + alpha * slack + 1e-9, "{from} to {to} at {alpha}: {way} for {best}");
            }
        }
    }
}

#[test]
fn one_graph_serves_every_alpha() {
    let mut random = Random::new(5);
    for round in 0..60 {
        let lengths: Vec<_> =
            (0..1 + random.below(4)).map(|_| (4 + random.below(20) as u32, random.unit() < 0.3)).collect();
        let timeline = common::timeline(25.0, &lengths);
        let levels = [8, 1_000_000][round % 2];
        let transitions = random_transitions(timeline.frame_count() as usize, 0.5, levels, &mut random);
        check_one_for_all(&transitions, &timeline);
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn one_graph_serves_every_alpha_of_a_real_capture() {
    let Captured { topology, poses, timeline } = crane_and_jumping(3);
    let distances = pose_distances(&topology, &poses, &DistanceOptions::default(), &Job::silent()).unwrap();
    let transitions =
        optimal_transitions(&distances, &timeline, &TransitionOptions::default(), &Job::silent()).unwrap();
    check_one_for_all(&transitions, &timeline);
}
