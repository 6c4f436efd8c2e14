//! Walks as they are shown: every frame made as the player makes it, and measured.

use actor::capture::{Capture, Poses};
use actor::graph::EssentialGraph;
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};
use kernels::align::Placement;
use rayon::prelude::*;
use synthesis::Synthesiser;

use super::series::{Look, Series};
use super::standing::{Slid, slid, standing};
use crate::EvaluateError;

/// Recorded frames that a walk is shown with before its first and after its last, so that its outer seams are seen too.
const AROUND: u32 = 4;

/// A walk and the frame that it begins with.
#[derive(Clone, Debug)]
pub struct Begun {
    /// The frame.
    pub start: u32,
    /// The walk.
    pub walk: Walk,
}

impl Begun {
    /// The same with some recorded frames before and after it, where there are any in its sequences.
    #[must_use]
    pub fn with_surroundings(&self, graph: &EssentialGraph, timeline: &Timeline) -> Self {
        let recorded = |first: u32, last: u32| Leg::Recorded { first, last, steps: last - first };
        let mut legs = self.walk.legs.clone();
        let mut start = self.start;
        if let Some(sequence) = timeline.sequence_of(start) {
            start = sequence.first_frame.max(start.saturating_sub(AROUND));
            legs.insert(0, recorded(start, self.start));
        }
        let end = self.walk.end(graph).unwrap_or(self.start);
        if let Some(sequence) = timeline.sequence_of(end) {
            legs.push(recorded(end, (end + AROUND).min(sequence.end_frame() - 1)));
        }
        Self { start, walk: Walk { legs, ..self.walk.clone() } }
    }
}

/// A walk's frames, measured.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// How its frames move.
    pub series: Series,
    /// The transition that each interval belongs to; `None` for a recorded step.
    pub transitions: Vec<Option<u32>>,
    /// How far feet slide that stand, in each interval.
    pub slid: Vec<Slid>,
    /// Frames at which a transition begins or ends.
    pub seams: Vec<usize>,
}

/// Shows all of `walks` and measures them, `most` frames of each.
///
/// # Errors
/// A mesh that cannot be interpolated, or walks of another graph.
pub fn show(
    capture: &Capture,
    order: &[u32],
    graph: &EssentialGraph,
    walks: &[Begun],
    most: usize,
    progress: &(dyn Fn(f64) -> Result<(), job::Stopped> + Sync),
) -> Result<Vec<Shown>, EvaluateError> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    let look = Look::of(&capture.poses, capture.topology.weights());
    let chunks: Vec<Vec<Shown>> = walks
        .par_chunks(8)
        .map(|chunk| {
            let mut synthesiser = Synthesiser::new(&capture.topology, Some(order))?;
            let shown = chunk.iter().map(|begun| show_one(capture, &look, graph, begun, most, &mut synthesiser));
            let shown = shown.collect::<Result<Vec<_>, EvaluateError>>()?;
            let before = done.fetch_add(chunk.len(), std::sync::atomic::Ordering::Relaxed);
            progress((before + chunk.len()) as f64 / walks.len() as f64)?;
            Ok(shown)
        })
        .collect::<Result<_, EvaluateError>>()?;
    Ok(chunks.into_iter().flatten().collect())
}

fn show_one(
    capture: &Capture,
    look: &Look,
    graph: &EssentialGraph,
    begun: &Begun,
    most: usize,
    synthesiser: &mut Synthesiser,
) -> Result<Shown, EvaluateError> {
    let mut shown = Shown::default();
    let mut stands = Vec::new();
    for leg in &begun.walk.legs {
        stands.extend(standing(graph, &capture.timeline, leg));
        let (transition, steps) = match *leg {
            Leg::Recorded { steps, .. } | Leg::Back { steps, .. } => (None, steps),
            Leg::Synthetic(index) => (Some(index), graph.transitions().get(index as usize).map_or(0, steps_of)),
        };
        let at = shown.transitions.len();
        if at > 0 && steps > 0 && at < most && (transition.is_some() || shown.transitions[at - 1].is_some()) {
            shown.seams.push(at);
        }
        shown.transitions.extend(std::iter::repeat_n(transition, steps as usize));
    }
    shown.transitions.truncate(most);
    synthesiser.begin_walk(graph, &capture.timeline, (begun.start, Placement::IDENTITY), &begun.walk)?;
    let mut pose = vec![glam::Vec3::ZERO; capture.topology.vertex_count()];
    let mut before: Option<Vec<glam::Vec3>> = None;
    let mut source = Borrowed(&capture.poses);
    while shown.series.way.len() < shown.transitions.len() {
        if synthesiser.next_frame(graph, &capture.timeline, &mut source, &mut pose)?.is_none() {
            break;
        }
        shown.series.push(&pose, look);
        if let (Some(before), Some(stands)) = (&before, stands.get(shown.slid.len())) {
            shown.slid.push(slid(graph.feet(), stands, look, [before, &pose]));
        }
        before.get_or_insert_with(|| pose.clone()).clone_from(&pose);
    }
    Ok(shown)
}

/// Poses that many threads read.
pub(crate) struct Borrowed<'a>(pub &'a Poses);

impl PoseSource for Borrowed<'_> {
    fn read(&mut self, frame: u32, pose: &mut [glam::Vec3]) -> Result<(), PoseError> {
        if frame as usize >= self.0.len() {
            return Err(PoseError::OutOfRange(frame));
        }
        pose.copy_from_slice(self.0.frame(frame));
        Ok(())
    }
}
