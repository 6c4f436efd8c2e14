//! What a long random walk shows: how much of the capture, how evenly, for how long at a stretch, and what it repeats.

use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};

/// Seconds of a place: a piece of a sequence whose visits are counted together.
const PLACE: f64 = 0.5;
/// What is shown again sooner than this is a repetition, in seconds.
pub const SOON: f64 = 10.0;

/// What a walk shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Wandered {
    /// Share of the frames that can be left and reached again that are shown as they were recorded.
    pub coverage: f64,
    /// Share of the steps that are synthetic.
    pub synthetic: f64,
    /// Steps of each recorded stretch between two transitions.
    pub stretches: Vec<f64>,
    /// Transitions taken.
    pub transitions: usize,
    /// For each behaviour the visits of its place that is visited most over those of the one visited least; infinite where a
    /// place is never visited.
    pub unevenness: Vec<(String, f64)>,
    /// Steps of the longest run of edges that begins again, exactly the same, within ten seconds.
    pub repeat: usize,
}

impl Wandered {
    /// Measures `walk`, which begins with frame `start`; `main` says which frames can be left and reached again.
    #[must_use]
    pub fn of(walk: &Walk, start: u32, graph: &EssentialGraph, timeline: &Timeline, main: &[bool]) -> Self {
        let edges = edges(walk, graph, timeline);
        let mut visits = vec![0_u32; main.len()];
        let mut visit = |frame: u32| visits[frame as usize] += 1;
        visit(start);
        let (mut stretches, mut stretch, mut transitions) = (Vec::new(), 0.0, 0);
        for leg in &walk.legs {
            match *leg {
                Leg::Recorded { first, steps, .. } => {
                    (1..=i64::from(steps)).filter_map(|step| timeline.offset(first, step)).for_each(&mut visit);
                    stretch += f64::from(steps);
                }
                Leg::Back { first, last, steps } => {
                    (last..first).for_each(&mut visit);
                    stretch += f64::from(steps);
                }
                Leg::Synthetic(index) => {
                    graph.transitions().get(index as usize).into_iter().for_each(|transition| visit(transition.to));
                    // What comes before the first transition is no stretch of wandering.
                    if transitions > 0 {
                        stretches.push(stretch);
                    }
                    (stretch, transitions) = (0.0, transitions + 1);
                }
            }
        }
        let shown = (0..main.len()).filter(|&frame| main[frame] && visits[frame] > 0).count();
        let all = main.iter().filter(|&&main| main).count();
        let synthetic = edges.iter().filter(|edge| edge.1 > 0).count();
        Self {
            coverage: shown as f64 / all.max(1) as f64,
            synthetic: synthetic as f64 / edges.len().max(1) as f64,
            stretches,
            transitions,
            unevenness: unevenness(timeline, main, &visits),
            repeat: longest_repeat(edges.len(), timeline.fps(), |before, now| edges[before] == edges[now]),
        }
    }
}

/// The edges of a walk, step by step: a recorded frame and 0, or a transition beyond all frames and its node.
pub fn edges(walk: &Walk, graph: &EssentialGraph, timeline: &Timeline) -> Vec<(u32, u32)> {
    let mut edges = Vec::new();
    for leg in &walk.legs {
        match *leg {
            Leg::Recorded { first, steps, .. } => {
                let frames = (0..i64::from(steps)).filter_map(|step| timeline.offset(first, step));
                edges.extend(frames.map(|frame| (frame, 0)));
            }
            Leg::Back { first, last, .. } => edges.extend((last + 1..=first).rev().map(|frame| (frame, 0))),
            Leg::Synthetic(index) => {
                let steps = graph.transitions().get(index as usize).map_or(0, steps_of);
                edges.extend((1..=steps).map(|node| (timeline.frame_count() + index, node)));
            }
        }
    }
    edges
}

/// The longest run of `count` steps all of which are the `same` as those at most [`SOON`] before.
pub fn longest_repeat(count: usize, fps: f32, same: impl Fn(usize, usize) -> bool) -> usize {
    let run = |offset: usize| {
        let (mut run, mut longest) = (0, 0);
        for at in offset..count {
            run = if same(at - offset, at) { run + 1 } else { 0 };
            longest = longest.max(run);
        }
        longest
    };
    (1..=(SOON * f64::from(fps)) as usize).map(run).max().unwrap_or(0)
}

/// For each behaviour the most over the least visited of its places. A behaviour is a label, or a sequence without one.
fn unevenness(timeline: &Timeline, main: &[bool], visits: &[u32]) -> Vec<(String, f64)> {
    let mut behaviours: Vec<(String, Vec<f64>)> = Vec::new();
    let place = ((PLACE * f64::from(timeline.fps())).round() as usize).max(1);
    for sequence in timeline.sequences() {
        let frames: Vec<u32> =
            (sequence.first_frame..sequence.end_frame()).filter(|&frame| main[frame as usize]).collect();
        if frames.is_empty() {
            continue;
        }
        // Places of about the same size.
        let count = (frames.len() / place).max(1);
        let mean = |piece: usize| {
            let piece = &frames[piece * frames.len() / count..(piece + 1) * frames.len() / count];
            piece.iter().map(|&frame| f64::from(visits[frame as usize])).sum::<f64>() / piece.len() as f64
        };
        let places: Vec<f64> = (0..count).map(mean).collect();
        let names = if sequence.labels.is_empty() { vec![sequence.name.clone()] } else { sequence.labels.clone() };
        for name in names {
            match behaviours.iter_mut().find(|behaviour| behaviour.0 == name) {
                Some(behaviour) => behaviour.1.extend(&places),
                None => behaviours.push((name, places.clone())),
            }
        }
    }
    let ratio = |places: Vec<f64>| {
        let most = places.iter().copied().fold(0.0, f64::max);
        most / places.iter().copied().fold(f64::INFINITY, f64::min)
    };
    behaviours.into_iter().map(|(name, places)| (name, ratio(places))).collect()
}

#[cfg(test)]
mod tests {
    use actor::graph::Transition;
    use actor::temporal_warp::{Move, TemporalWarp};
    use actor::timeline::Sequence;
    use kernels::align::Placement;

    use super::*;

    #[test]
    fn a_loop_is_measured() {
        let sequence = |name: &str, first_frame| Sequence {
            name: name.into(),
            labels: vec![],
            first_frame,
            frame_count: 8,
            cyclic: false,
        };
        let timeline = Timeline::new(4.0, vec![sequence("a", 0), sequence("b", 8)]).unwrap();
        let transition = |from, to| Transition {
            from,
            to,
            deformation: 1.0,
            warp: TemporalWarp::new(vec![Move::Both; 2]),
            placement: Placement::IDENTITY,
            turn: 0.0,
        };
        let graph = EssentialGraph::new(0.01, vec![transition(5, 10), transition(13, 2)], &timeline).unwrap();
        let recorded = |first, last: u32| Leg::Recorded { first, last, steps: last - first };
        let round = [recorded(2, 5), Leg::Synthetic(0), recorded(10, 13), Leg::Synthetic(1)];
        let legs: Vec<Leg> = round.iter().copied().cycle().take(12).collect();
        let walk = Walk::of_legs(legs, &graph).unwrap();
        let main: Vec<bool> = (0..16).map(|frame| (2..=5).contains(&(frame % 8))).collect();
        let wandered = Wandered::of(&walk, 2, &graph, &timeline, &main);
        assert_eq!(wandered.coverage, 1.0);
        assert_eq!(wandered.synthetic, 0.4);
        assert_eq!(wandered.stretches, [3.0; 5]);
        assert_eq!(wandered.transitions, 6);
        // Three rounds of ten steps; the second and third are the first again.
        assert_eq!(wandered.repeat, 20);
        assert!(wandered.unevenness.iter().all(|(_, ratio)| *ratio < 1.2));
        let short = Wandered::of(&Walk::default(), 2, &graph, &timeline, &main);
        assert_eq!((short.coverage, short.synthetic, short.repeat), (0.125, 0.0, 0));
        assert!(short.unevenness.iter().all(|(_, ratio)| ratio.is_infinite() || ratio.is_nan()));
    }
}
