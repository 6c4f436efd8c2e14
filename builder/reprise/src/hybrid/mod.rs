//! A driven sequence beside the recorded ones: where it is entered and left best, and its beginning and end edited towards the recording
//! there.
//!
//! Tejera, Casas and Hilton (2013), V-B and V-C. What differs: places are told by what a transition costs in the graph, from the best
//! matches by the paper's measure on; what is edited is the frame in the middle of the transition, towards the recorded frame that is blended
//! with it: the clip's bones before feet are planted (`driving::towards`, as the page does), and the surface by the rig, whose rotations
//! fade over a window. Of these the one that makes the way
//! cheaper is kept; none where neither does, or where the surface would accelerate more on it.

mod bones;
mod edit;
mod error;
mod places;
mod seam;
mod tried;

use std::ops::Range;

use actor::capture::{Capture, Poses};
use actor::graph::DEFAULT_ALPHA;
use actor::timeline::{Sequence, Timeline};
use driving::Aim;
use driving::strain::Strain;
use glam::Vec3;
use job::Job;
use serde::Serialize;

pub use self::error::HybridError;
pub use self::tried::{DrivenFrames, EditedBy, Remake};

use self::bones::{aims_of_bones, by_bones};
use self::edit::by_surface;
use self::places::places;
use self::seam::{Way, best_way};
use self::tried::Tried;

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
    /// What they are edited by.
    pub by: Option<EditedBy>,
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
    /// The edits of the clip's bones that its frames have.
    pub aims: Vec<Aim>,
}

/// Joins driven frames to the recording `capture`.
///
/// # Errors
/// Frames of another mesh; what cannot be measured; being stopped.
pub fn join(capture: &Capture, driven: DrivenFrames<'_>, job: &Job) -> Result<Hybrid, HybridError> {
    let mut joined =
        Joining { both: beside(capture, driven.name, driven.poses)?, driven, aims: Vec::new(), solved: 0..0 };
    let mut ends = Vec::new();
    for inwards in [true, false] {
        job.begin(if inwards { "the way in" } else { "the way out" })?;
        if let Some(report) = joined.end(inwards, job)? {
            ends.push(report);
        }
    }
    let Joining { both, aims, .. } = joined;
    let first = capture.timeline.frame_count();
    let poses = (first..both.timeline.frame_count()).map(|frame| both.poses.frame(frame).to_vec()).collect();
    Ok(Hybrid { poses, ends, aims })
}

/// A driven sequence that is being joined.
struct Joining<'a> {
    /// The recording, and the driven frames as its last sequence.
    both: Capture,
    driven: DrivenFrames<'a>,
    /// Edits of bones that are kept.
    aims: Vec<Aim>,
    /// Frames of the whole capture whose surface was edited.
    solved: Range<u32>,
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

impl Joining<'_> {
    /// One end of the driven sequence.
    fn end(&mut self, inwards: bool, job: &Job) -> Result<Option<EndReport>, HybridError> {
        let Some(before) = best_place(&self.both, inwards, job)? else { return Ok(None) };
        let recorded = if inwards { before.from } else { before.to };
        let Some(sequence) = self.both.timeline.sequence_of(recorded).cloned() else { return Ok(None) };
        let driven = self.both.timeline.sequences().last().map_or(0, |own| own.first_frame);
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
        let mut best = self.turned(&before, inwards, job)?;
        let solved = by_surface(&self.both, &self.driven.body.rig, &before, inwards)?;
        let least = best.as_ref().map_or(&before, |(way, _)| way).cost.cost(DEFAULT_ALPHA);
        if let Some(way) = self.worth(&solved, (&before, least), inwards, job)? {
            best = Some((way, solved));
        }
        let changed = best.as_ref().map_or(0, |(_, tried)| tried.poses.len() as u32);
        let (by, after) = (best.as_ref().map(|(_, tried)| tried.by), best.as_ref().map(|(way, _)| said(way)));
        if let Some((_, tried)) = best {
            self.keep(tried);
        }
        Ok(Some(EndReport { inwards, before: said(&before), sequence: sequence.name, after, by, changed }))
    }

    /// The edit of the clip's bones, as much of it as is worth while.
    fn turned(&mut self, before: &Way, inwards: bool, job: &Job) -> Result<Option<(Way, Tried)>, HybridError> {
        let Some((aim, strengths)) = aims_of_bones(&self.both, self.driven, &self.aims, before, inwards) else {
            return Ok(None);
        };
        for strength in strengths {
            let aim = aim.with(strength);
            let Some(tried) = by_bones(&self.both, self.driven, (&self.aims, &self.solved), aim) else { continue };
            if let Some(way) = self.worth(&tried, (before, before.cost.cost(DEFAULT_ALPHA)), inwards, job)? {
                return Ok(Some((way, tried)));
            }
        }
        Ok(None)
    }

    /// The best way with an edit, where it costs less than `least` and is as smooth as the one `before`: what the page asks of bones, asked
    /// of the surface.
    fn worth(
        &mut self,
        tried: &Tried,
        (before, least): (&Way, f64),
        inwards: bool,
        job: &Job,
    ) -> Result<Option<Way>, HybridError> {
        let kept = self.both.poses.clone();
        replace(&mut self.both, tried.first, &tried.poses);
        let way = best_way(&self.both, before.recorded.clone(), before.driven.clone(), inwards, job);
        self.both.poses = kept;
        let strain = |way: &Way| Strain { acceleration: way.acceleration[0], ..Strain::default() };
        let is_worth = |way: &Way| way.cost.cost(DEFAULT_ALPHA) < least && strain(way).is_as_smooth(&strain(before));
        Ok(way?.filter(is_worth))
    }

    fn keep(&mut self, tried: Tried) {
        replace(&mut self.both, tried.first, &tried.poses);
        match tried.aim {
            Some(aim) => self.aims.push(aim),
            None => self.solved = tried.first..tried.first + tried.poses.len() as u32,
        }
    }
}

/// The cheapest way between the recording and one end of the last sequence of `both`, of those around the places that match best.
fn best_place(both: &Capture, inwards: bool, job: &Job) -> Result<Option<Way>, HybridError> {
    let around = (AROUND * both.timeline.fps()).ceil() as u32;
    let cost = |way: &Way| way.cost.cost(DEFAULT_ALPHA);
    let mut found: Option<Way> = None;
    for place in places(both, inwards) {
        let way = best_way(both, place.stretch(both, around), place.of_driven(both, around), inwards, job)?;
        if let Some(way) = way.filter(|way| found.as_ref().is_none_or(|best| cost(way) < cost(best))) {
            found = Some(way);
        }
    }
    Ok(found)
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
