//! Directing: a request becomes a walk by a search that is worked on in slices, and the walk becomes the route.
//!
//! The search needs to know where every frame and every transition leads on the ground; that is prepared in slices too, once
//! for the centre of mass, and anew whenever other vertices are to follow a path. A slice looks at the clock after every few
//! dozen states, so that the page's frames stay short.

use std::rc::Rc;

use actor::graph::EssentialGraph;
use actor::motion::{MotionMeter, measure_group};
use actor::pose_source::PoseError;
use actor::walk::{Leg, Walk};
use kernels::align::Placement;
use search::{
    Answer, DEFAULT_EFFORT, Direction, GroundPose, Progress, Request, RequestError, Scene, SearchGraph,
    SearchGraphBuilder, Start,
};
use serde::Serialize;
use thiserror::Error;

use super::directing::Preparing;
use super::loading::{Actor, Source};
use super::report::{LegReport, PlanReport, report_legs};
use super::{Player, PlayerError};

/// States expanded between two looks at the clock: well below a millisecond in a browser.
const STATES: u32 = 20;
/// Frames measured and transitions surveyed between two looks.
const FRAMES: u32 = 2;
const TRANSITIONS: usize = 200;
/// Metres and radians by which the actor may have moved since the search began.
const SAME: f32 = 1e-3;

/// Why a request is not worked on.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DirectError {
    /// The request makes no sense, or none for this actor.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// What it needs is not there.
    #[error(transparent)]
    Player(#[from] PlayerError),
}

impl From<PoseError> for DirectError {
    fn from(error: PoseError) -> Self {
        Self::Player(error.into())
    }
}

/// Where a search begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// Where the actor would leave from now.
    Here,
    /// Wherever suits the request best.
    Anywhere,
    /// Where the answer before ends: its walk is to be gone on with.
    End,
}

/// An answer as the page reads it.
#[derive(Clone, Debug, Serialize)]
pub struct AnswerReport {
    /// What the search says.
    #[serde(flatten)]
    pub answer: Answer,
    /// The walk's legs as in plans.
    pub legs: Vec<LegReport>,
    /// Where the walk leads on the ground, leg by leg.
    pub track: Vec<TrackPiece>,
}

/// A leg of a walk on the ground.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackPiece {
    /// Whether it is synthesised.
    pub synthetic: bool,
    /// The centre of mass (X, Z), metres.
    pub points: Vec<[f32; 2]>,
}

impl Player {
    /// Gets ready for searches in which `vertices` follow paths (the centre of mass, where there are none), for about
    /// `milliseconds`; whether that is done.
    ///
    /// # Errors
    /// The graph or a frame has not arrived, or there is no such vertex.
    pub fn prepare_search(&mut self, vertices: &[u32], milliseconds: f64) -> Result<bool, DirectError> {
        let (actor, graph) = self.ready(0)?;
        self.directing.follow(vertices, actor.topology.vertex_count())?;
        let now = self.producer.now;
        let end = now() + milliseconds;
        while self.directing.search_graph.is_none() {
            self.prepare_more(&actor, &graph)?;
            if now() >= end {
                break;
            }
        }
        Ok(self.directing.search_graph.is_some())
    }

    fn prepare_more(&mut self, actor: &Actor, graph: &EssentialGraph) -> Result<(), DirectError> {
        let Some(motion) = self.directing.motion.clone() else { return self.measure_more(actor) };
        let (timeline, directing, source) = (&actor.timeline, &mut self.directing, &mut self.loading.source);
        let survey = |group| -> Result<_, PoseError> {
            Ok(Some(Preparing::Surveying(Box::new(SearchGraphBuilder::new(graph, timeline, &motion, group)?))))
        };
        directing.preparing = match directing.preparing.take() {
            Some(Preparing::Surveying(mut survey)) => {
                if survey.advance(graph, timeline, &motion, TRANSITIONS)? {
                    directing.search_graph = Some(Rc::new(survey.finish()));
                    return Ok(());
                }
                Some(Preparing::Surveying(survey))
            }
            Some(Preparing::Grouping(mut points)) => {
                let (vertices, count) = (&directing.group, actor.topology.vertex_count());
                match measure_group(timeline, source, count, vertices, &mut points, FRAMES)? {
                    true => survey(Some((vertices.clone(), points)))?,
                    false => Some(Preparing::Grouping(points)),
                }
            }
            _ if directing.group.is_empty() => survey(None)?,
            _ => Some(Preparing::Grouping(Vec::new())),
        };
        Ok(())
    }

    /// Learns the motion: the bundle knows it, or some more poses are measured.
    fn measure_more(&mut self, actor: &Actor) -> Result<(), DirectError> {
        if let Source::Bundle(reader) = &self.loading.source
            && let Some(motion) = reader.motion()
        {
            self.directing.motion = Some(Rc::new(motion.clone()));
            return Ok(());
        }
        let (timeline, source) = (&actor.timeline, &mut self.loading.source);
        let mut meter = match self.directing.preparing.take() {
            Some(Preparing::Measuring(meter)) => meter,
            _ => Box::new(MotionMeter::new(actor.topology.weights())),
        };
        match meter.advance(timeline, source, FRAMES) {
            Ok(true) => self.directing.motion = Some(Rc::new(meter.finish(timeline, source)?)),
            other => {
                self.directing.preparing = Some(Preparing::Measuring(meter));
                other?;
            }
        }
        Ok(())
    }

    /// Begins to search for a walk that does what `request` asks; a search under way is dropped.
    ///
    /// # Errors
    /// The request makes no sense for this actor, or [`Self::prepare_search`] is not done.
    pub fn search(&mut self, request: &Request, from: Origin) -> Result<(), DirectError> {
        let start = match from {
            Origin::Anywhere => None,
            Origin::Here => {
                let (frame, placement) = self.leaves()?;
                Some(Start { frame, placement })
            }
            Origin::End => {
                let answer = self.answer()?;
                let [heading, x, z] = answer.end_placement;
                let placement = Placement { heading, translation: glam::Vec2::new(x, z) };
                Some(Start { frame: answer.end_frame, placement })
            }
        };
        self.directing.direction = None;
        let (actor, graph, search_graph) = self.scene()?;
        let scene = Scene { graph: &graph, timeline: &actor.timeline, search_graph: &search_graph };
        self.directing.direction = Some(Direction::new(&scene, start, request, DEFAULT_EFFORT)?);
        Ok(())
    }

    /// Searches on for about `milliseconds`.
    ///
    /// # Errors
    /// No search is under way.
    pub fn search_on(&mut self, milliseconds: f64) -> Result<Progress, DirectError> {
        let (actor, graph, search_graph) = self.scene()?;
        let scene = Scene { graph: &graph, timeline: &actor.timeline, search_graph: &search_graph };
        let direction = self.directing.direction.as_mut().ok_or(PlayerError::NotLoaded)?;
        let now = self.producer.now;
        let end = now() + milliseconds;
        loop {
            let progress = direction.advance(&scene, STATES)?;
            if progress != Progress::Running || now() >= end {
                return Ok(progress);
            }
        }
    }

    /// Drops the search under way.
    pub fn stop_search(&mut self) {
        self.directing.direction = None;
    }

    /// The best answer so far.
    ///
    /// # Errors
    /// No search is under way.
    pub fn answer(&self) -> Result<Answer, DirectError> {
        let (actor, graph, search_graph) = self.scene()?;
        let scene = Scene { graph: &graph, timeline: &actor.timeline, search_graph: &search_graph };
        let direction = self.directing.direction.as_ref().ok_or(PlayerError::NotLoaded)?;
        Ok(direction.best(&scene))
    }

    /// The best answer so far, with what the page draws of it.
    ///
    /// # Errors
    /// No search is under way.
    pub fn answer_report(&self) -> Result<AnswerReport, DirectError> {
        let answer = self.answer()?;
        let (_, graph, search_graph) = self.scene()?;
        let [heading, x, z] = answer.start_placement;
        let placement = Placement { heading, translation: glam::Vec2::new(x, z) };
        let track = track(&search_graph, answer.start_frame, placement, &answer.walk);
        Ok(AnswerReport { legs: report_legs(&answer.walk.legs, &graph), track, answer })
    }

    /// Sets off on the best walk so far. Where the search chose the start, the actor is put there first.
    ///
    /// # Errors
    /// No search is under way, its walk is empty, or the actor is not where the walk begins any more.
    pub fn set_off(&mut self, anywhere: bool) -> Result<PlanReport, DirectError> {
        let answer = self.answer()?;
        let [heading, x, z] = answer.start_placement;
        let wanted = Placement { heading, translation: glam::Vec2::new(x, z) };
        let (frame, placement) = self.leaves()?;
        let off = (placement.heading - wanted.heading).abs() + placement.translation.distance(wanted.translation);
        if frame != answer.start_frame || off > SAME {
            if !anywhere {
                return Err(PlayerError::Unreachable { from: frame, to: answer.start_frame }.into());
            }
            self.stand_in(answer.start_frame, wanted)?;
        }
        Ok(self.follow(answer.start_frame, &answer.walk)?)
    }

    /// Goes on with the best walk so far where the walk under way ends; whether it could.
    ///
    /// # Errors
    /// No search is under way.
    pub fn go_on(&mut self) -> Result<bool, DirectError> {
        let answer = self.answer()?;
        Ok(self.extend(answer.start_frame, &answer.walk))
    }

    fn scene(&self) -> Result<(Actor, Rc<EssentialGraph>, Rc<SearchGraph>), DirectError> {
        let (actor, graph) = self.ready(0)?;
        let search_graph = self.directing.search_graph.clone().ok_or(PlayerError::NotLoaded)?;
        Ok((actor, graph, search_graph))
    }
}

/// Where `walk` leads on the ground from `start`, standing at `placement`.
fn track(search_graph: &SearchGraph, start: u32, placement: Placement, walk: &Walk) -> Vec<TrackPiece> {
    let (mut frame, mut ground_pose) = (start, GroundPose::from(&placement));
    let ground = |ground_pose: &GroundPose, point| {
        let place = ground_pose.apply(point);
        [place.x, place.z]
    };
    let mut pieces = Vec::with_capacity(walk.legs.len());
    for leg in &walk.legs {
        let transition = leg.transition();
        let here = search_graph.points.get(frame as usize).copied().unwrap_or_default();
        let mut piece = TrackPiece { synthetic: transition.is_some(), points: vec![ground(&ground_pose, here)] };
        if let Leg::Back { first, last, .. } = *leg {
            let frames = search_graph.points.get(last as usize..first as usize).unwrap_or_default();
            piece.points.extend(frames.iter().rev().map(|&point| ground(&ground_pose, point)));
            frame = last;
        }
        let steps = match *leg {
            Leg::Recorded { steps, .. } => steps,
            Leg::Synthetic(_) => 1,
            Leg::Back { .. } => 0,
        };
        for _ in 0..steps {
            let Some(index) = search_graph.from(frame).find(|&index| search_graph.edge(index).transition == transition)
            else {
                break;
            };
            piece.points.extend(search_graph.samples(index).iter().map(|sample| ground(&ground_pose, sample.point)));
            let edge = search_graph.edge(index);
            (frame, ground_pose) = (edge.to, ground_pose.after(&edge.ground_pose));
        }
        pieces.push(piece);
    }
    pieces
}
