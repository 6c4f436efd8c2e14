//! Components of the mesh that stay together in the recordings do so in transitions.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that panics has failed; what it measured is printed"
)]

use actor::capture::{Capture, Poses};
use actor::graph::EssentialGraph;
use actor::pose_source::{PoseError, PoseSource};
use actor::ties::{Tie, Ties};
use actor::walk::Walk;
use capture_io::import::{ImportOptions, import};
use glam::Vec3;
use job::Job;
use kernels::align::Placement;
use kernels::random::mix;
use pipeline::distance;
use pipeline::graph::{GraphOptions, essential_graph};
use search::cheapest_walk;
use synthesis::Synthesiser;

/// Pairs of frames drawn at random; all transitions of the walks between them are looked at.
const DRAWN: u64 = 150;
/// Gaps below this share of the body's height are none that could be seen.
const SEEN: f64 = 1e-3;

struct Recorded<'a>(&'a Poses);

impl PoseSource for Recorded<'_> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        pose.copy_from_slice(self.0.frame(frame));
        Ok(())
    }
}

/// Vertices of a tie's contact with those of the patch that are nearest in the first frame.
fn pairs(tie: &Tie, pose: &[Vec3]) -> Vec<[usize; 2]> {
    let nearest = |&from: &u32| {
        let far = |to: &&u32| pose[from as usize].distance(pose[**to as usize]);
        let to = tie.patch.iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap();
        [from as usize, *to as usize]
    };
    tie.contact.iter().map(nearest).collect()
}

fn gap(pairs: &[[usize; 2]], pose: &[Vec3]) -> f64 {
    pairs.iter().map(|&[a, b]| f64::from(pose[a].distance(pose[b]))).sum::<f64>() / pairs.len() as f64
}

/// Mean gap of each tie, over all frames that `each` visits.
fn means(ties: &[Vec<[usize; 2]>], each: impl FnOnce(&mut dyn FnMut(&[Vec3]))) -> Vec<f64> {
    let (mut sums, mut count) = (vec![0.0; ties.len()], 0);
    each(&mut |pose| {
        sums.iter_mut().zip(ties).for_each(|(sum, pairs)| *sum += gap(pairs, pose));
        count += 1;
    });
    sums.iter().map(|sum| sum / f64::from(count)).collect()
}

/// All blended frames of transitions on cheapest walks.
fn blended(capture: &Capture, graph: &EssentialGraph, visit: &mut dyn FnMut(&[Vec3])) {
    let timeline = &capture.timeline;
    let mut synthesiser = Synthesiser::new(&capture.topology, None).unwrap();
    let frame = |index: u64| (mix(7, index) % u64::from(timeline.frame_count())) as u32;
    let mut pose = vec![Vec3::ZERO; capture.topology.vertex_count()];
    let walk = |index: u64| cheapest_walk(graph, timeline, frame(2 * index), frame(2 * index + 1));
    for walk in (0..DRAWN).filter_map(walk) {
        for leg in walk.legs.iter().filter(|leg| leg.transition().is_some()) {
            let start = (leg.ends(graph).unwrap().0, Placement::IDENTITY);
            let alone = Walk { legs: vec![*leg], ..Walk::default() };
            synthesiser.begin_walk(graph, timeline, start, &alone).unwrap();
            let mut source = Recorded(&capture.poses);
            while let Some(info) = synthesiser.next_frame(graph, timeline, &mut source, &mut pose).unwrap() {
                if info.kind.is_synthetic() {
                    visit(&pose);
                }
            }
        }
    }
}

/// Mean and worst quotient of blended and recorded gaps, without ties and with them; and how many ties there are.
fn quotients(file: &str, fps: Option<f32>) -> ([[f64; 2]; 2], usize) {
    let inputs = [fixtures::data().join(file).to_str().unwrap().to_owned()];
    let options = ImportOptions { fps, ..ImportOptions::default() };
    let capture = import(&inputs, &options, &Job::silent()).unwrap().capture;
    let measured =
        distance::measure(&capture.topology, &capture.poses, &distance::DistanceOptions::default(), &Job::silent())
            .unwrap();
    let graph = essential_graph(&capture, &measured, &GraphOptions::default(), &Job::silent()).unwrap().graph;
    let pose = capture.poses.frame(0);
    let heights = || pose.iter().map(|point| f64::from(point.y));
    let least = SEEN * (heights().fold(f64::MIN, f64::max) - heights().fold(f64::MAX, f64::min));
    let ties: Vec<_> = graph.ties().all().iter().map(|tie| pairs(tie, pose)).collect();
    let own = means(&ties, |visit| capture.poses.iter().for_each(visit));
    let of = |graph: &EssentialGraph| {
        let gaps = means(&ties, |visit| blended(&capture, graph, visit));
        let worst = gaps.iter().zip(&own).filter(|(gap, _)| **gap > least).map(|(gap, own)| gap / own.max(least));
        let quotient = gaps.iter().sum::<f64>() / own.iter().sum::<f64>();
        [quotient, worst.fold(0.0, f64::max)]
    };
    let found = [of(&graph.clone().with_ties(Ties::default())), of(&graph)];
    println!("{file}: {} ties; times recorded, mean and worst: {found:.3?}", ties.len());
    (found, ties.len())
}

/// Gaps are at most 1.2 times the recorded ones, on average and for the worst tie.
fn hold_together([_, tied]: [[f64; 2]; 2]) {
    assert!(tied[0] < 1.2 && tied[1] < 1.2, "{tied:?}");
}

#[test]
#[ignore = "reads ../shared/data"]
fn parts_hold_together() {
    let (lumberjack, ties) = quotients("gltf/lumberjack/lumberjack.glb", None);
    assert!(ties >= 3, "{ties}");
    hold_together(lumberjack);
    assert!(lumberjack[0][1] > 1.3, "{lumberjack:?}");
    let (robot, ties) = quotients("gltf/robot-expressive/RobotExpressive.glb", None);
    assert!(ties > 40, "{ties}");
    hold_together(robot);
    // At fewer frames a second: it has 76 clips.
    let (knight, ties) = quotients("gltf/kaykit-knight/Knight.glb", Some(10.0));
    assert!(ties > 20, "{ties}");
    hold_together(knight);
    assert!(knight[0][1] > 1.2, "{knight:?}");
}

#[test]
#[ignore = "reads ../shared/data"]
fn what_is_one_part_has_no_ties() {
    for file in ["gltf/fox/Fox.glb", "gltf/cesium-man/CesiumMan.glb"] {
        assert_eq!(quotients(file, None).1, 0, "{file}");
    }
}
