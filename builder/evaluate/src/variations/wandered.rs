//! Wandering with variety: what a walk of five minutes repeats where each stretch is shown with another mixture of its alternatives.

use std::sync::Arc;

use actor::alternatives::Alternatives;
use actor::graph::{EssentialGraph, Transition};
use actor::motion::Motion;
use actor::timeline::Timeline;
use actor::walk::steps_of;
use glam::Vec3;
use job::Job;
use search::{Scene, SearchGraph};
use synthesis::Varied;

use super::super::EvaluateError;
use super::super::document::{Cell, Table};
use super::super::motion::Borrowed;
use super::super::subject::Subject;
use super::super::wandering::{edges, longest_repeat, walk};
use super::SEEDS;
use super::lasting::ALIKE;

/// Vertices that are looked at, at most.
const LOOKED_AT: usize = 250;

/// How long a walk repeats what it showed within ten seconds before, for some seeds.
pub fn table(subject: &Subject, all: &Arc<Alternatives>, job: &Job) -> Result<Table, EvaluateError> {
    let caption = "Walks of five minutes: the longest run that begins again within ten seconds, the same frames and transitions as recorded; exactly \
                   the same with variety, alternatives of all sequences being mixed; and with variety within 1 mm, on average over the surface. A \
                   transition differs by what the frames that it blends differ by.";
    let columns = ["seed", "as recorded s", "with variety s", "within 1 mm s"];
    let mut table = Table::new("variations_wandering", caption, &columns);
    let graph = subject.graph(subject.options.transition.choice, job)?;
    let capture = &subject.capture;
    let timeline = &capture.timeline;
    let motion = Motion::measure(timeline, capture.topology.weights(), &mut Borrowed(&capture.poses))?;
    let search_graph = SearchGraph::new(&graph, timeline, &motion)?;
    let scene = Scene { graph: &graph, timeline, search_graph: &search_graph };
    for seed in subject.options.seed..subject.options.seed + SEEDS {
        job.tell("wandering", seed - subject.options.seed, SEEDS)?;
        let Some(walk) = walk(&scene, seed) else { break };
        let steps = edges(&walk, &graph, timeline);
        let differences = differences(
            &steps,
            Varied::new(Arc::clone(all), seed, 1.0),
            &graph,
            timeline,
            capture.topology.vertex_count(),
        );
        let repeats = |alike: f64| {
            let same = |before: usize, now: usize| {
                steps[before] == steps[now] && apart(&differences[before], &differences[now]) <= alike
            };
            Cell::Number(longest_repeat(steps.len(), timeline.fps(), same) as f64 / f64::from(timeline.fps()), 2)
        };
        table.rows.push(vec![Cell::Count(seed), repeats(f64::INFINITY), repeats(0.0), repeats(ALIKE)]);
    }
    Ok(table)
}

/// How some vertices differ from the recording in each step. A transition blends frames of both sides, each as it is shown with what was drawn
/// before; that of differences is what a linear blend makes of them.
fn differences(
    steps: &[(u32, u32)],
    mut varied: Varied,
    graph: &EssentialGraph,
    timeline: &Timeline,
    vertices: usize,
) -> Vec<Vec<Vec3>> {
    let stride = vertices.div_ceil(LOOKED_AT).max(1);
    let added = |varied: &Varied, frame: Option<u32>| {
        let mut pose = vec![Vec3::ZERO; vertices];
        if let Some(frame) = frame {
            varied.add(frame, &mut pose);
        }
        pose.into_iter().step_by(stride)
    };
    let mut of_step = |&(frame, node): &(u32, u32)| -> Vec<Vec3> {
        let transition =
            frame.checked_sub(timeline.frame_count()).and_then(|index| graph.transitions().get(index as usize));
        let Some(transition) = transition else {
            varied.enters(frame);
            return added(&varied, Some(frame)).collect();
        };
        let [source, destination] = blended(transition, node, timeline);
        let share = node as f32 / steps_of(transition) as f32;
        added(&varied, source).zip(added(&varied, destination)).map(|(from, to)| from.lerp(to, share)).collect()
    };
    steps.iter().map(&mut of_step).collect()
}

/// The frames that a node of a transition blends.
fn blended(transition: &Transition, node: u32, timeline: &Timeline) -> [Option<u32>; 2] {
    let (_, length) = transition.warp.lengths();
    let nodes = transition.warp.nodes();
    let (source, destination) = nodes.take(node as usize + 1).last().unwrap_or_default();
    let behind = length as i64 - 1 - destination as i64;
    [timeline.offset(transition.from, source as i64), timeline.offset(transition.to, -behind)]
}

/// Mean distance of the vertices that are looked at, in metres.
fn apart(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.distance(*b))).sum::<f64>() / a.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use actor::alternatives::Stretch;
    use actor::graph::DEFAULT_ALPHA;
    use actor::temporal_warp::TemporalWarp;
    use actor::timeline::Sequence;
    use kernels::align::Placement;

    use super::*;

    #[test]
    fn what_has_alternatives_is_not_the_same_again() {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 50, cyclic: true };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let stretch = Stretch { first: 0, last: 49, headings: vec![0; 48], coefficients: vec![vec![500; 48]; 3] };
        let all = Alternatives::new(vec![vec![[127, 0, 0]; 2]], vec![stretch], 2, &timeline).unwrap();
        let graph = EssentialGraph::new(DEFAULT_ALPHA, Vec::new(), &timeline).unwrap();
        let steps: Vec<(u32, u32)> = (0..150).map(|step| (step % 50, 0)).collect();
        let repeat = |all: Alternatives| {
            let found = differences(&steps, Varied::new(Arc::new(all), 3, 1.0), &graph, &timeline, 2);
            longest_repeat(steps.len(), 25.0, |a, b| steps[a] == steps[b] && apart(&found[a], &found[b]) == 0.0)
        };
        // The ends of a stretch are as recorded: the last frame of a pass and the first of the next.
        assert_eq!((repeat(Alternatives::default()), repeat(all)), (100, 2));
    }

    #[test]
    fn a_transition_differs_by_what_it_blends() {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 50, cyclic: false };
        let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
        let stretch = Stretch { first: 0, last: 49, headings: vec![0; 48], coefficients: vec![vec![500; 48]; 3] };
        let all = Alternatives::new(vec![vec![[127, 0, 0]; 2]], vec![stretch], 2, &timeline).unwrap();
        let transition = Transition {
            from: 30,
            to: 20,
            deformation: 1.0,
            warp: TemporalWarp::even(5, 5),
            placement: Placement::IDENTITY,
            turn: 0.0,
        };
        assert_eq!(blended(&transition, 1, &timeline), [Some(31), Some(17)]);
        assert_eq!(blended(&transition, 4, &timeline), [Some(34), Some(20)]);
        let graph = EssentialGraph::new(DEFAULT_ALPHA, vec![transition], &timeline).unwrap();
        let steps: Vec<(u32, u32)> = (0..=30).map(|frame| (frame, 0)).chain((1..4).map(|node| (50, node))).collect();
        let found = differences(&steps, Varied::new(Arc::new(all), 3, 1.0), &graph, &timeline, 2);
        // The alternative moves all frames but the ends by as much: so does the transition from one of them to another.
        let moved = found[30][0].x;
        assert!(moved.abs() > 1e-3);
        assert!(found[31..].iter().all(|step| (step[0].x - moved).abs() < 1e-6), "{:?}", &found[29..]);
    }
}
