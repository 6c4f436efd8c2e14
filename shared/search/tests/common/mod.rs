//! Small random graphs whose frames walk over the ground, made without any pose.

use actor::blend::transition_placement;
use actor::contacts::Contacts;
use actor::graph::{EssentialGraph, Transition};
use actor::motion::Motion;
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use fixtures::Random;
use glam::{Vec2, Vec3};
use kernels::align::Placement;
use search::{Scene, SearchGraph};

pub mod random_scene {
    use super::*;

    /// A graph with its motion.
    #[allow(dead_code, reason = "the benchmark reads all of it")]
    pub struct Made {
        pub timeline: Timeline,
        pub graph: EssentialGraph,
        pub motion: Motion,
        pub search_graph: SearchGraph,
    }

    impl Made {
        pub fn borrowed(&self) -> Scene<'_> {
            Scene { graph: &self.graph, timeline: &self.timeline, search_graph: &self.search_graph }
        }
    }

    /// Sequences of these lengths at 25 fps that walk with a bend each, and about `edges` transitions. The first sequence
    /// shows behaviour `a`, the others `b`; the last one is cyclic.
    pub fn make(seed: u64, lengths: &[u32], edges: usize) -> Made {
        let mut random = Random::new(seed);
        let (mut sequences, mut first_frame) = (Vec::new(), 0);
        let mut motion = Motion { centres: vec![], facings: vec![], wraps: vec![] };
        for (index, &frame_count) in lengths.iter().enumerate() {
            let cyclic = index + 1 == lengths.len();
            let labels = vec![if index == 0 { "a" } else { "b" }.to_owned()];
            sequences.push(Sequence { name: format!("s{index}"), labels, first_frame, frame_count, cyclic });
            first_frame += frame_count;
            let (pace, bend) = (random.range(0.03, 0.1), random.range(-0.1, 0.1));
            let (mut place, mut heading) = (Vec2::ZERO, random.range(-3.0, 3.0));
            for _ in 0..frame_count {
                motion.centres.push(Vec3::new(place.x, random.range(0.9, 1.0), place.y));
                motion.facings.push(heading);
                place += pace * Vec2::new(heading.sin(), heading.cos());
                heading += bend;
            }
            let (first, last) = (motion.centres.len() - frame_count as usize, motion.centres.len() - 1);
            let turn = heading - motion.facings[first];
            let from = Vec2::new(motion.centres[first].x, motion.centres[first].z);
            assert!(last >= first);
            motion.wraps.push(if cyclic { Placement::turning(turn, from, place) } else { Placement::IDENTITY });
        }
        let timeline = Timeline::new(25.0, sequences).unwrap();
        let transitions = transitions(&timeline, &motion, &mut random, edges);
        let graph = EssentialGraph::new(0.01, transitions, &timeline).unwrap();
        let search_graph = SearchGraph::new(&graph, &timeline, &motion).unwrap();
        Made { timeline, graph, motion, search_graph }
    }

    fn transitions(timeline: &Timeline, motion: &Motion, random: &mut Random, edges: usize) -> Vec<Transition> {
        let frames = timeline.frame_count() as usize;
        let mut ends: Vec<(u32, u32)> =
            (0..edges).map(|_| (random.below(frames) as u32, random.below(frames) as u32)).collect();
        ends.sort_unstable();
        ends.dedup();
        let mut made = Vec::new();
        for (from, to) in ends {
            let moves = [Move::Both, Move::Source, Move::Destination];
            let warp = TemporalWarp::new((0..2 + random.below(4)).map(|_| moves[random.below(3)]).collect());
            let (li, lj) = warp.lengths();
            let holds = timeline.offset(from, li as i64 - 1).is_some() && timeline.offset(to, 1 - lj as i64).is_some();
            if holds && from != to {
                let mut ground = motion;
                let placement =
                    transition_placement(timeline, &mut ground, (from, to), &warp, &Contacts::default()).unwrap();
                made.push(Transition { from, to, deformation: random.range(0.05, 2.0), warp, placement, turn: 0.0 });
            }
        }
        made
    }
}

/// One that the exhaustive oracle gets to the end of.
pub fn small_scene(seed: u64) -> random_scene::Made {
    random_scene::make(seed, &[9, 7, 8], 26)
}
