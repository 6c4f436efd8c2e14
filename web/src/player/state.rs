//! What the player tells: the picture, the state, the facts.

use bundle::Textures;
use glam::{Vec2, Vec3};
use kernels::sort::{key, numbers, sort};
use search::behaviours;
use searcher::report::{LegReport, report_legs};
use serde::Serialize;
use synthesis::FrameKind;

use super::produce::ShownFrame;
use super::{Goal, Player, PlayerError};
use crate::trail::TrailPoint;

/// The frames that the picture lies between.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// The frame before.
    pub before: &'a ShownFrame,
    /// The frame after; the same one where the actor stands.
    pub after: &'a ShownFrame,
    /// 0 is the one, 1 the other.
    pub weight: f64,
}

impl Picture<'_> {
    /// The centre of mass on the ground (X, Z).
    #[must_use]
    pub fn ground(&self) -> Vec2 {
        self.before.ground.lerp(self.after.ground, self.weight as f32)
    }

    /// 0 where recorded, 1 where synthesised.
    #[must_use]
    pub fn synthetic(&self) -> f32 {
        let [before, after] = [self.before, self.after].map(|frame| f32::from(u8::from(frame.kind.is_synthetic())));
        before + (after - before) * self.weight as f32
    }

    /// World positions of the welded vertices, as drawn.
    #[must_use]
    pub fn pose(&self) -> Vec<Vec3> {
        let weight = self.weight as f32;
        self.before.pose.iter().zip(&self.after.pose).map(|(a, b)| a.lerp(*b, weight)).collect()
    }
}

/// A transition as the page reads it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TransitionReport {
    /// Frame that it leaves from.
    pub from: u32,
    /// Frame that it arrives at.
    pub to: u32,
    /// Weight of the destination.
    pub lambda: f32,
    /// Recorded frame of the source side.
    pub source: u32,
    /// Recorded frame of the destination side.
    pub destination: u32,
}

/// The state as the page reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct State {
    /// The recorded frame, fractional.
    pub frame: f64,
    /// `paused`, `recorded` or `synthetic`.
    pub mode: &'static str,
    /// Where the actor is going.
    pub target: Option<u32>,
    /// The walk under way.
    pub walk: Option<Vec<LegReport>>,
    /// Index of its leg under way.
    pub leg: usize,
    /// Part of that leg that is done.
    pub leg_progress: f32,
    /// Until the target, at normal speed.
    pub remaining_seconds: f64,
    /// The transition under way.
    pub transition: Option<TransitionReport>,
    /// Centre of mass, metres.
    pub x: f32,
    /// Centre of mass, metres.
    pub z: f32,
    /// Turn of the recorded frame about +Y, radians.
    pub heading: f32,
    /// Median time of the last synthetic frames.
    pub synthesis_ms: f64,
    /// The alternative of the recorded stretch that most is shown of, from 1; none where it is as recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alternative: Option<usize>,
}

/// A sequence as the page reads it.
#[derive(Clone, Debug, Serialize)]
struct SequenceInfo<'a> {
    name: &'a str,
    first: u32,
    count: u32,
    cyclic: bool,
    labels: &'a [String],
}

/// An image as the page reads it.
#[derive(Clone, Debug, Serialize)]
struct ImageInfo {
    media_type: &'static str,
    width: u32,
    height: u32,
    ready: bool,
}

/// The actor as the page reads it.
#[derive(Clone, Debug, Serialize)]
pub struct Info<'a> {
    name: &'a str,
    fps: f32,
    frames: u32,
    vertices: usize,
    triangles: usize,
    transitions: usize,
    density: f64,
    alpha: f64,
    sequences: Vec<SequenceInfo<'a>>,
    /// Names of all behaviours: the labels, then the sequences whose name is no label.
    behaviours: Vec<String>,
    images: Vec<ImageInfo>,
    /// Modes of colours and of warps in the textures; `null` where no texture changes, or it has not arrived.
    appearance: Option<[usize; 2]>,
    /// Modes of textures that were not aligned, to compare with.
    naive: Option<usize>,
    /// Frames that there are as they were scanned; none where the registered mesh is all that is shown.
    scanned: u32,
    /// Whether the actor has alternatives of what was recorded.
    varies: bool,
    main: usize,
}

impl Player {
    /// What is shown; `None` before the first pose has arrived.
    #[must_use]
    pub fn picture(&self) -> Option<Picture<'_>> {
        let before = self.last.as_ref()?;
        let after = self.next.as_ref().unwrap_or(before);
        Some(Picture { before, after, weight: self.clock.weight() })
    }

    /// The frame that is nearer to what is shown.
    pub(super) fn nearer(&self) -> Option<&ShownFrame> {
        let picture = self.picture()?;
        Some(if picture.weight < 0.5 { picture.before } else { picture.after })
    }

    /// Where the centre of mass is on the ground (X, Z).
    #[must_use]
    pub fn ground(&self) -> Option<Vec2> {
        self.picture().map(|picture| picture.ground())
    }

    /// The path walked so far, oldest first.
    pub fn trail(&self) -> impl Iterator<Item = &TrailPoint> {
        self.trail.iter()
    }

    /// Seconds played since the beginning.
    #[must_use]
    pub fn played(&self) -> f64 {
        self.clock.played()
    }

    /// What happened since the last call.
    pub fn take_events(&mut self) -> Vec<super::events::Event> {
        self.events.take()
    }

    /// The state.
    #[must_use]
    pub fn state(&self) -> Option<State> {
        let picture = self.picture()?;
        let graph = self.loading.graph.as_deref();
        let nearer = self.nearer()?;
        let target = match self.goal {
            Some(Goal::Target(frame)) => Some(frame),
            Some(Goal::PlayOn | Goal::Stop) | None => None,
        };
        let edge = self.producer.walker().filter(|_| self.goal.is_some()).zip(graph);
        let (leg, leg_progress) = edge.map_or((0, 0.0), |(walker, graph)| walker.progress(graph));
        let ahead = if self.next.is_some() { 1.0 - self.clock.weight() } else { 0.0 };
        let frames = edge.map_or(0.0, |(walker, graph)| f64::from(walker.remaining(graph)) + ahead);
        let ground = picture.ground();
        Some(State {
            frame: fractional(&picture),
            mode: match (self.playing, self.next.as_ref().unwrap_or(nearer).kind.is_synthetic()) {
                (false, _) => "paused",
                (true, true) => "synthetic",
                (true, false) => "recorded",
            },
            target,
            walk: edge.filter(|_| target.is_some()).map(|(walker, graph)| report_legs(walker.legs(), graph)),
            leg,
            leg_progress,
            remaining_seconds: if target.is_some() { frames / self.clock.fps() } else { 0.0 },
            transition: graph.and_then(|graph| transition(&picture, graph)),
            x: ground.x,
            z: ground.y,
            heading: nearer.placement.heading,
            synthesis_ms: self.producer.synthesis_ms(),
            alternative: self.alternative().map(|(_, alternative)| alternative + 1),
        })
    }

    /// What the actor is; `None` before its first pose has arrived.
    #[must_use]
    pub fn info(&self) -> Option<Info<'_>> {
        let actor = self.loading.actor.as_ref()?;
        let timeline = &actor.timeline;
        let graph = self.loading.graph.as_deref();
        let sequences = timeline.sequences().iter().map(|sequence| SequenceInfo {
            name: &sequence.name,
            first: sequence.first_frame,
            count: sequence.frame_count,
            cyclic: sequence.cyclic,
            labels: &sequence.labels,
        });
        let images = actor.surface.images.iter().enumerate().map(|(index, image)| ImageInfo {
            media_type: image.format.media_type(),
            width: image.width,
            height: image.height,
            ready: self.loading.image(index).is_some(),
        });
        let main = self.main.as_deref().unwrap_or_default();
        Some(Info {
            name: &actor.name,
            fps: timeline.fps(),
            frames: timeline.frame_count(),
            vertices: actor.topology.vertex_count(),
            triangles: actor.topology.triangles().len(),
            transitions: graph.map_or(0, |graph| graph.transitions().len()),
            density: graph.map_or(0.0, |graph| graph.density(timeline)),
            alpha: self.own_alpha.or(graph.map(actor::graph::EssentialGraph::alpha)).unwrap_or(0.0),
            sequences: sequences.collect(),
            behaviours: behaviours(timeline).into_iter().map(|behaviour| behaviour.name).collect(),
            images: images.collect(),
            naive: self.appearance(Textures::Naive).map(|a| a.layers[0].mode_count()),
            appearance: self.appearance(Textures::Aligned).map(|a| [0, 1].map(|layer| a.layers[layer].mode_count())),
            scanned: self.scans().map_or(0, bundle::ScannedIndex::frame_count),
            varies: self.loading.varies(),
            main: main.iter().filter(|&&inside| inside).count(),
        })
    }

    /// Encoded bytes of texture `image`.
    ///
    /// # Errors
    /// It has not arrived, or does not exist.
    pub fn image(&self, image: usize) -> Result<&[u8], PlayerError> {
        self.loading.image(image).map(|image| image.bytes.as_slice()).ok_or(PlayerError::NotLoaded)
    }

    /// The `most` cheapest transitions as [from, to, deformation, frames], cheapest first.
    #[must_use]
    pub fn arcs(&self, most: usize) -> Vec<f32> {
        let Some(graph) = &self.loading.graph else { return Vec::new() };
        // Costs are not negative: their bits order them. Transitions are in order already.
        let cost = |transition: &actor::graph::Transition| transition.deformation.to_bits();
        let transitions = graph.transitions();
        let mut order: Vec<_> =
            (0..).zip(transitions).map(|(edge, transition)| key([0, 0, cost(transition), edge])).collect();
        sort(&mut order);
        let arc = |&place: &u128| {
            let transition = &transitions[numbers(place)[3] as usize];
            let frames = transition.warp.duration() as f32;
            [transition.from as f32, transition.to as f32, transition.deformation, frames]
        };
        order.iter().take(most).flat_map(arc).collect()
    }
}

/// The recorded frame that is shown, fractional between neighbours.
fn fractional(picture: &Picture<'_>) -> f64 {
    let weight = picture.weight;
    match (picture.before.kind, picture.after.kind) {
        (FrameKind::Recorded { frame: a }, FrameKind::Recorded { frame: b }) if b == a + 1 => f64::from(a) + weight,
        (FrameKind::Recorded { frame: a }, FrameKind::Recorded { frame: b }) if b + 1 == a => f64::from(a) - weight,
        (before, after) => f64::from(if weight < 0.5 { before } else { after }.frame()),
    }
}

fn transition(picture: &Picture<'_>, graph: &actor::graph::EssentialGraph) -> Option<TransitionReport> {
    let of = |kind: FrameKind| match kind {
        FrameKind::Synthetic { transition, lambda, source_frame, destination_frame, .. } => {
            Some((transition, lambda, source_frame, destination_frame))
        }
        FrameKind::Recorded { .. } => None,
    };
    let (before, after) = (of(picture.before.kind), of(picture.after.kind));
    let (edge, mut lambda, source, destination) = after.or(before.filter(|before| before.1 < 1.0))?;
    if after.is_some() {
        let begin = before.filter(|before| before.0 == edge).map_or(0.0, |before| before.1);
        lambda = begin + (lambda - begin) * picture.weight as f32;
    }
    let transition = graph.transitions().get(edge as usize)?;
    Some(TransitionReport { from: transition.from, to: transition.to, lambda, source, destination })
}
