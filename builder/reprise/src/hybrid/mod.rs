//! A driven sequence beside the recorded ones: where it is entered and left best, and its beginning and end edited towards the recording
//! there.
//!
//! Tejera, Casas and Hilton (2013), V-B and V-C. What differs: places are told by what a transition costs in the graph, from the best
//! matches by the paper's measure on; what is edited is the frame in the middle of the transition, towards the recorded frame that is blended
//! with it, and by the rig, whose rotations fade over a window. An edit that does not make the way cheaper is not kept.

mod edit;
mod error;
mod places;
mod seam;

use actor::capture::{Capture, Poses};
use actor::graph::DEFAULT_ALPHA;
use actor::timeline::{Sequence, Timeline};
use editing::Rig;
use glam::Vec3;
use job::Job;
use pipeline::feet::feet;
use serde::Serialize;

pub use self::error::HybridError;

use self::edit::{Towards, edited, towards};
use self::places::places;
use self::seam::{Way, best_way};

/// Seconds of the recording around a place, and of the driven sequence from its end, that ways are looked for in.
const AROUND: f32 = 1.2;

/// How good the best way between the recording and a driven sequence is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WayReport {
    /// The recorded frame, counted within its sequence, and the driven one.
    pub frames: [u32; 2],
    /// What the transition costs: deformation in radians and, for each of its frames, alpha.
    pub cost: f64,
    /// How many frames it has.
    pub duration: u16,
    /// How far the poses in its middle are from each other: mean over the vertices, laid on one another over the ground, in
    /// millimetres.
    pub apart_mm: f32,
    /// Mean acceleration of the surface, in metres per second squared: the largest of any frame of the way, and of any frame that it is
    /// blended of.
    pub acceleration: [f32; 2],
}

/// One end of a driven sequence.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EndReport {
    /// Whether this is the way into it; else the way out.
    pub inwards: bool,
    /// The recorded sequence that is met there.
    pub sequence: String,
    /// The best way with the frames as they were driven.
    pub before: WayReport,
    /// The best way once they are edited; nothing where an edit would not make it cheaper.
    pub after: Option<WayReport>,
    /// How many frames of the driven sequence were changed.
    pub changed: u32,
}

/// A driven sequence that was joined to the recording.
#[derive(Clone, Debug)]
pub struct Hybrid {
    /// Its frames.
    pub poses: Vec<Vec<Vec3>>,
    /// Its ends, where there is a way at all.
    pub ends: Vec<EndReport>,
}

/// Joins `driven`, frames that are called `name`, to the recording `capture`, whose bones are those of `rig`.
///
/// # Errors
/// Frames of another mesh; what cannot be measured; being stopped.
pub fn join(
    capture: &Capture,
    rig: &Rig,
    (name, driven): (&str, &[Vec<Vec3>]),
    job: &Job,
) -> Result<Hybrid, HybridError> {
    let mut both = beside(capture, name, driven)?;
    let mut ends = Vec::new();
    for inwards in [true, false] {
        job.begin(if inwards { "the way in" } else { "the way out" })?;
        if let Some(report) = join_end(&mut both, rig, inwards, job)? {
            ends.push(report);
        }
    }
    let first = capture.timeline.frame_count();
    let poses = (first..both.timeline.frame_count()).map(|frame| both.poses.frame(frame).to_vec()).collect();
    Ok(Hybrid { poses, ends })
}

/// `capture` with one sequence more, the last one.
fn beside(capture: &Capture, name: &str, driven: &[Vec<Vec3>]) -> Result<Capture, HybridError> {
    let misfit = |error: &dyn std::fmt::Display| HybridError::Misfit(error.to_string());
    let mut sequences = capture.timeline.sequences().to_vec();
    let is_taken = |name: &str| capture.timeline.sequences().iter().any(|sequence| sequence.name == name);
    let mut own = name.to_owned();
    while is_taken(&own) {
        own.push('+');
    }
    sequences.push(Sequence {
        name: own,
        labels: Vec::new(),
        first_frame: capture.timeline.frame_count(),
        frame_count: driven.len() as u32,
        cyclic: false,
    });
    let timeline = Timeline::new(capture.timeline.fps(), sequences).map_err(|error| misfit(&error))?;
    let mut poses = capture.poses.clone();
    for pose in driven {
        if pose.len() != capture.topology.vertex_count() {
            return Err(misfit(&"they have another number of vertices"));
        }
        poses.push(pose);
    }
    Capture::new(&*capture.name, capture.topology.clone(), capture.surface.clone(), timeline, poses)
        .map_err(|error| misfit(&error))
}

/// One end of the last sequence of `both`.
fn join_end(both: &mut Capture, rig: &Rig, inwards: bool, job: &Job) -> Result<Option<EndReport>, HybridError> {
    let around = (AROUND * both.timeline.fps()).ceil() as u32;
    let mut found: Option<Way> = None;
    for place in places(both, inwards) {
        let way = best_way(both, place.stretch(both, around), place.of_driven(both, around), inwards, job)?;
        let cost = |way: &Way| way.cost.cost(DEFAULT_ALPHA);
        if let Some(way) = way.filter(|way| found.as_ref().is_none_or(|best| cost(way) < cost(best))) {
            found = Some(way);
        }
    }
    let Some(before) = found else { return Ok(None) };
    let recorded = if inwards { before.from } else { before.to };
    let Some(sequence) = both.timeline.sequence_of(recorded).cloned() else { return Ok(None) };
    let driven = both.timeline.sequences().last().map_or(0, |own| own.first_frame);
    let said = |way: &Way| {
        let [recorded, of_driven] = if inwards { [way.from, way.to] } else { [way.to, way.from] };
        WayReport {
            frames: [recorded - sequence.first_frame, of_driven - driven],
            cost: way.cost.cost(DEFAULT_ALPHA),
            duration: way.cost.duration,
            apart_mm: way.apart_mm,
            acceleration: way.acceleration,
        }
    };
    let standing = feet(&both.topology, &both.timeline, &both.poses);
    let Towards { document, frames } = towards(both, (rig, &standing), &before, inwards);
    let changed = edited(both, (rig, &standing), document, frames.clone())?;
    let kept: Vec<Vec<Vec3>> = frames.clone().map(|frame| both.poses.frame(frame).to_vec()).collect();
    replace(both, frames.start, &changed);
    let after = best_way(both, before.recorded.clone(), before.driven.clone(), inwards, job)?;
    let is_cheaper = |way: &Way| way.cost.cost(DEFAULT_ALPHA) < before.cost.cost(DEFAULT_ALPHA);
    let after = after.filter(is_cheaper);
    if after.is_none() {
        replace(both, frames.start, &kept);
    }
    let changed = if after.is_some() { changed.len() as u32 } else { 0 };
    let (before, after) = (said(&before), after.as_ref().map(said));
    Ok(Some(EndReport { inwards, sequence: sequence.name, before, after, changed }))
}

/// Puts `poses` in place of the frames of `both` from `first` on.
fn replace(both: &mut Capture, first: u32, poses: &[Vec<Vec3>]) {
    let mut all = Poses::new(both.topology.vertex_count());
    for frame in 0..both.timeline.frame_count() {
        let own = frame.checked_sub(first).and_then(|at| poses.get(at as usize));
        all.push(own.map_or(both.poses.frame(frame), Vec::as_slice));
    }
    both.poses = all;
}
