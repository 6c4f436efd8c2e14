//! A performance: from where the actor is into the clip, through it, and back to a recorded frame.
//!
//! The walk goes over a timeline of its own, of three sequences: the recorded frames that the way in blends from, the clip, and the
//! recorded frames that the way back blends to. It is synthesised as any walk is, its feet planned by the same steps.

use actor::blend::transition_placement;
use actor::contacts::Contacts;
use actor::feet::Feet;
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround};
use actor::pose_source::{PoseError, PoseSource};
use actor::temporal_warp::TemporalWarp;
use actor::timeline::{Sequence, Timeline};
use actor::walk::Leg;
use glam::Vec3;
use kernels::align::Placement;
use synthesis::{FrameKind, Synthesiser};

use crate::actor::DrivenActor;
use crate::clip::{DrivenClip, Exit};
use crate::error::DriverError;

/// Recorded frames of which a blend needs the poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first one.
    pub first: u32,
    /// How many, going on as their sequence does.
    pub count: u32,
}

/// A frame of a performance.
#[derive(Clone, Debug, PartialEq)]
pub struct Performed {
    /// Vertex positions in the world, in metres.
    pub pose: Vec<Vec3>,
    /// Recorded frames whose looks it has, and how much those of the second count.
    pub worn: ([u32; 2], f32),
    /// Turn of the frame about +Y, in radians.
    pub heading: f32,
}

/// What is read while the walk is made.
struct Source<'a> {
    actor: &'a mut DrivenActor,
    clip: &'a DrivenClip,
    /// Poses of both windows.
    recorded: &'a [Vec<Vec3>; 2],
    /// Vertices of all poses of the first window: as many times three numbers.
    counts: [u32; 3],
}

impl PoseSource for Source<'_> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        let [before, clip, _] = self.counts;
        let window = |window: usize, frame: u32| {
            let vertices = pose.len();
            self.recorded[window].get(frame as usize * vertices..).and_then(|rest| rest.get(..vertices))
        };
        if frame < before {
            pose.copy_from_slice(window(0, frame).ok_or(PoseError::NotLoaded(frame))?);
        } else if frame < before + clip {
            let made = self.clip.make(self.actor, (frame - before) as usize).ok().flatten();
            pose.copy_from_slice(&made.ok_or(PoseError::Damaged(frame))?);
        } else {
            pose.copy_from_slice(window(1, frame - before - clip).ok_or(PoseError::NotLoaded(frame))?);
        }
        Ok(())
    }
}

/// A performance under way.
pub struct Performance {
    timeline: Timeline,
    graph: EssentialGraph,
    synthesiser: Synthesiser,
    windows: [Window; 2],
    recorded: [Vec<Vec3>; 2],
    counts: [u32; 3],
    exit: Exit,
    /// Frames that will be shown after the one that it begins with.
    pub length: u32,
    /// Where the frame that it ends with stands.
    pub home: Placement,
}

/// How a performance of a clip of `count` frames begins in `frame` and ends: the two windows.
#[must_use]
pub fn windows(actor: &DrivenActor, count: usize, frame: u32, nodes: usize, exit: Exit) -> [Window; 2] {
    let timeline = &actor.known.timeline;
    let ahead = (1..nodes.min(count)).take_while(|&step| timeline.offset(frame, step as i64).is_some()).count() as u32;
    let back = exit.nodes.min(count) as u32;
    let first = timeline.offset(exit.to, 1 - i64::from(back)).unwrap_or(exit.to);
    [Window { first: frame, count: ahead + 1 }, Window { first, count: back }]
}

impl Performance {
    /// Begins where the actor stands in the first frame of the first of the `windows`, placed; `recorded` are the poses of both,
    /// one after another. The way in has so many `nodes`.
    ///
    /// # Errors
    /// Poses that do not fit, or cannot be blended.
    pub fn begin(
        (actor, clip): (&mut DrivenActor, &DrivenClip),
        windows: [Window; 2],
        recorded: [Vec<Vec3>; 2],
        (nodes, exit): (usize, Exit),
        placement: Placement,
    ) -> Result<Self, DriverError> {
        let misfit = || DriverError::Misfit;
        let known = &actor.known;
        let vertices = known.topology.vertex_count();
        let fits = |k: usize| recorded[k].len() == windows[k].count as usize * vertices;
        if !(fits(0) && fits(1) && recorded.iter().flatten().all(|point| point.is_finite())) {
            return Err(misfit());
        }
        let counts = [windows[0].count, clip.count() as u32, windows[1].count];
        let timeline = timeline(known.timeline.fps(), counts).ok_or_else(misfit)?;
        let feet = feet(actor, clip, windows, &timeline).ok_or_else(misfit)?;
        let entry = nodes.min(clip.count()) as u32;
        let ways = [
            (0, counts[0] + entry - 1, TemporalWarp::even(counts[0] as usize, entry as usize)),
            (
                (counts[0] + counts[1]).saturating_sub(counts[2]).max(counts[0] + entry - 1),
                counts.iter().sum::<u32>() - 1,
                TemporalWarp::even(counts[2] as usize, counts[2] as usize),
            ),
        ];
        // Where the clip is too short for both blends the second one begins where the first one ends, and waits at the end.
        let left = (counts[0] + counts[1]) - ways[1].0;
        let [way_in, mut way_back] = ways;
        way_back.2 = TemporalWarp::even(left.min(counts[2]) as usize, counts[2] as usize);
        let mut synthesiser = Synthesiser::new(&known.topology, known.order.as_deref())
            .map_err(|error| DriverError::Surface(error.into()))?;
        let weights = known.topology.weights().to_vec();
        let mut transitions = Vec::new();
        for (from, to, warp) in [way_in, way_back] {
            let mut source = Source { actor, clip, recorded: &recorded, counts };
            let mut memory = PoseMemory::default();
            let mut ground = PosesOnGround::new(&mut source, &weights, &mut memory);
            let placement = transition_placement(&timeline, &mut ground, (from, to), &warp, &Contacts::default());
            let placement = placement.map_err(|_| misfit())?;
            transitions.push(Transition { from, to, deformation: 0.0, warp, placement, turn: 0.0 });
        }
        let (to, from) = (transitions[0].to, transitions[1].from);
        let home = placement.after(&transitions[0].placement).after(&transitions[1].placement);
        let graph = EssentialGraph::new(0.0, transitions, &timeline).map_err(|_| misfit())?.with_feet(feet);
        let mut legs = vec![Leg::Synthetic(0)];
        if from > to {
            legs.push(Leg::Recorded { first: to, last: from, steps: from - to });
        }
        legs.push(Leg::Synthetic(1));
        synthesiser.stand(0, placement);
        synthesiser.retarget(&graph, &timeline, &legs).map_err(|_| misfit())?;
        let length = legs.iter().map(|leg| leg.steps(&graph)).sum();
        Ok(Self { timeline, graph, synthesiser, windows, recorded, counts, exit, length, home })
    }

    /// The next frame; `None` at the end.
    ///
    /// # Errors
    /// A frame that cannot be made.
    pub fn next(&mut self, actor: &mut DrivenActor, clip: &DrivenClip) -> Result<Option<Performed>, DriverError> {
        let mut pose = vec![Vec3::ZERO; actor.known.topology.vertex_count()];
        let like = clip.like;
        let mut source = Source { actor, clip, recorded: &self.recorded, counts: self.counts };
        let made = self.synthesiser.next_frame(&self.graph, &self.timeline, &mut source, &mut pose);
        let Some(info) = made.map_err(|_| DriverError::Misfit)? else { return Ok(None) };
        let timeline = &actor.known.timeline;
        let worn = |frame: u32| self.worn(timeline, like, frame);
        let worn = match info.kind {
            FrameKind::Recorded { frame } => ([worn(frame); 2], 0.0),
            FrameKind::Synthetic { source_frame, destination_frame, lambda, .. } => {
                ([worn(source_frame), worn(destination_frame)], lambda)
            }
        };
        Ok(Some(Performed { pose, worn, heading: info.placement.heading }))
    }

    /// The recorded frame that `frame` of this timeline is, or whose looks it has.
    fn worn(&self, timeline: &Timeline, like: u32, frame: u32) -> u32 {
        let [before, clip, _] = self.counts;
        let of = |window: Window, step: u32| timeline.offset(window.first, step.into()).unwrap_or(self.exit.to);
        match frame {
            _ if frame < before => of(self.windows[0], frame),
            _ if frame < before + clip => like,
            _ => of(self.windows[1], frame - before - clip),
        }
    }
}

fn timeline(fps: f32, counts: [u32; 3]) -> Option<Timeline> {
    let mut first_frame = 0;
    let sequence = |frame_count: u32| {
        first_frame += frame_count;
        let first_frame = first_frame - frame_count;
        Sequence { name: String::new(), labels: Vec::new(), first_frame, frame_count, cyclic: false }
    };
    Timeline::new(fps, counts.map(sequence).to_vec()).ok()
}

/// The actor's feet over that timeline.
fn feet(actor: &DrivenActor, clip: &DrivenClip, windows: [Window; 2], timeline: &Timeline) -> Option<Feet> {
    let (known, count) = (&actor.known, actor.known.feet.count());
    let recorded = |window: Window| {
        let frames =
            (0..window.count).map(move |step| known.timeline.offset(window.first, step.into()).unwrap_or(window.first));
        frames.flat_map(move |frame| (0..count).map(move |foot| known.feet.stands(frame, foot)))
    };
    let stands = recorded(windows[0]).chain(clip.stands(actor)).chain(recorded(windows[1])).collect();
    let vertices = (0..count).map(|foot| known.feet.vertices(foot).to_vec()).collect();
    Feet::new(vertices, stands, known.topology.vertex_count(), timeline)
}
