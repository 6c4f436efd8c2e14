//! What a way between a stretch of the recording and one of the driven sequence costs, and how the surface accelerates on it.

use std::ops::Range;

use actor::capture::{Capture, Poses};
use actor::graph::{DEFAULT_ALPHA, EssentialGraph};
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, Walk};
use capture_io::export::play_from;
use glam::Vec3;
use job::Job;
use kernels::align::Placement;
use pipeline::distance::{DistanceOptions, Measured, measure};
use pipeline::essential::sparse::Candidates;
use pipeline::graph::{GraphOptions, graph_of};
use pipeline::transitions::{TransitionCost, TransitionOptions, optimal_transitions};

use super::error::HybridError;
use super::places::laid;

/// Frames that are played before a transition and after it.
const BESIDE: u32 = 8;

/// The best way, with frames of the whole capture.
pub(super) struct Way {
    pub from: u32,
    pub to: u32,
    pub cost: TransitionCost,
    /// See [`super::WayReport`].
    pub apart_mm: f32,
    pub acceleration: [f32; 2],
    /// Where it was looked for.
    pub recorded: Range<u32>,
    pub driven: Range<u32>,
}

impl Way {
    /// The frames that are blended in its middle: of the source, and of the destination.
    pub(super) fn middle(&self) -> [u32; 2] {
        let half = |length: u16| u32::from(length) / 2;
        [self.from + half(self.cost.source_length), self.to - half(self.cost.destination_length)]
    }

    /// The frames that are blended: of the source, and of the destination.
    pub(super) fn blended(&self) -> [Range<u32>; 2] {
        let [source, destination] = [self.cost.source_length, self.cost.destination_length].map(u32::from);
        [self.from..self.from + source, (self.to + 1).saturating_sub(destination)..self.to + 1]
    }
}

/// The cheapest way from the one of these stretches to the other; nothing where both are too short for any.
pub(super) fn best_way(
    both: &Capture,
    recorded: Range<u32>,
    driven: Range<u32>,
    inwards: bool,
    job: &Job,
) -> Result<Option<Way>, HybridError> {
    let wrong = |error: &dyn std::fmt::Display| HybridError::Measure(error.to_string());
    let frames: Vec<u32> = recorded.clone().chain(driven.clone()).collect();
    let of_recorded = recorded.len() as u32;
    let small = part(both, &frames, of_recorded)?;
    let measured = measure(&small.topology, &small.poses, &DistanceOptions::default(), job).map_err(|e| wrong(&e))?;
    let transitions = optimal_transitions(&measured.distances, &small.timeline, &TransitionOptions::default(), job)
        .map_err(|e| wrong(&e))?;
    let (first, second) = (0..of_recorded, of_recorded..frames.len() as u32);
    let (sources, destinations) = if inwards { (first, second) } else { (second, first) };
    let mut best: Option<(u32, u32, TransitionCost)> = None;
    for from in sources {
        for (to, cost) in transitions.row(from as usize).filter(|(to, _)| destinations.contains(&(*to as u32))) {
            if best.is_none_or(|(_, _, other)| cost.cost(DEFAULT_ALPHA) < other.cost(DEFAULT_ALPHA)) {
                best = Some((from, to as u32, cost));
            }
        }
    }
    let Some((from, to, cost)) = best else { return Ok(None) };
    let acceleration = accelerations(&small, &measured, (from, to, cost))?;
    let [from, to] = [from, to].map(|frame| frames[frame as usize]);
    let mut way = Way { from, to, cost, apart_mm: 0.0, acceleration, recorded, driven };
    let [a, b] = way.middle().map(|frame| both.poses.frame(frame));
    let off = laid(a, b, both.topology.weights()).iter().zip(a).map(|(b, a)| a.distance(*b)).sum::<f32>();
    way.apart_mm = 1000.0 * off / a.len().max(1) as f32;
    Ok(Some(way))
}

/// These frames of `both` as two sequences, the first of `first` frames.
fn part(both: &Capture, frames: &[u32], first: u32) -> Result<Capture, HybridError> {
    let misfit = |error: &dyn std::fmt::Display| HybridError::Misfit(error.to_string());
    let sequence = |name: &str, first_frame, frame_count| Sequence {
        name: name.into(),
        labels: Vec::new(),
        first_frame,
        frame_count,
        cyclic: false,
    };
    let sequences = vec![sequence("recorded", 0, first), sequence("driven", first, frames.len() as u32 - first)];
    let timeline = Timeline::new(both.timeline.fps(), sequences).map_err(|error| misfit(&error))?;
    let mut poses = Poses::new(both.topology.vertex_count());
    frames.iter().for_each(|&frame| poses.push(both.poses.frame(frame)));
    Capture::new("part", both.topology.clone(), both.surface.clone(), timeline, poses).map_err(|error| misfit(&error))
}

/// The largest mean acceleration on the way, and in the frames that it is blended of.
fn accelerations(
    small: &Capture,
    measured: &Measured,
    (from, to, cost): (u32, u32, TransitionCost),
) -> Result<[f32; 2], HybridError> {
    let wrong = |error: &dyn std::fmt::Display| HybridError::Measure(error.to_string());
    let mut only = Candidates::new();
    for frame in 0..small.timeline.frame_count() {
        only.push_row((frame == from).then_some((to, cost)));
    }
    let graph = graph_of(small, measured, &only, &GraphOptions::default(), Default::default());
    let graph = graph.map_err(|error| wrong(&error))?.graph;
    let (source, destination) = (ends(small, from), ends(small, to));
    let (first, last) = (from.saturating_sub(BESIDE).max(source.start), (to + BESIDE).min(destination.end - 1));
    let shown = played(small, &graph, first, (from, to), last).map_err(|error| wrong(&error))?;
    let blended = |range: Range<u32>| {
        let poses: Vec<&[Vec3]> = range.map(|frame| small.poses.frame(frame)).collect();
        largest(&poses, small.timeline.fps())
    };
    let begin = (to + 1).saturating_sub(cost.destination_length.into()).max(destination.start);
    let recorded = blended(first..(from + u32::from(cost.source_length)).min(source.end)).max(blended(begin..last + 1));
    let shown: Vec<&[Vec3]> = shown.iter().map(Vec::as_slice).collect();
    Ok([largest(&shown, small.timeline.fps()), recorded])
}

fn ends(small: &Capture, frame: u32) -> Range<u32> {
    small.timeline.sequence_of(frame).map_or(frame..frame + 1, |own| own.first_frame..own.end_frame())
}

/// All frames of the walk from `first` by the graph's only transition to `last`.
fn played(
    small: &Capture,
    graph: &EssentialGraph,
    first: u32,
    (from, to): (u32, u32),
    last: u32,
) -> Result<Vec<Vec<Vec3>>, Box<dyn std::error::Error>> {
    let mut legs = Vec::new();
    if from > first {
        legs.push(Leg::Recorded { first, last: from, steps: from - first });
    }
    legs.push(Leg::Synthetic(0));
    if last > to {
        legs.push(Leg::Recorded { first: to, last, steps: last - to });
    }
    let walk = Walk::of_legs(legs, graph)?;
    let mut source = small.poses.clone();
    let begin = (first, Placement::IDENTITY);
    let mut played = play_from(&mut source, (&small.topology, None), graph, &small.timeline, begin, &walk)?;
    let mut poses = Vec::new();
    while let Some(pose) = played.next_pose()? {
        poses.push(pose.to_vec());
    }
    Ok(poses)
}

/// The largest mean over the vertices of second differences, in metres per second squared.
fn largest(poses: &[&[Vec3]], fps: f32) -> f32 {
    let of = |three: &[&[Vec3]]| {
        let bend = |v: usize| (three[0][v] + three[2][v] - 2.0 * three[1][v]).length();
        (0..three[0].len()).map(bend).sum::<f32>() / three[0].len().max(1) as f32
    };
    fps * fps * poses.windows(3).map(of).fold(0.0, f32::max)
}
