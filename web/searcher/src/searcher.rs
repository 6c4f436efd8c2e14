//! A request becomes a walk by a search that is worked on in slices.
//!
//! The search needs to know where every frame and every transition leads on the ground; that is prepared in slices too, once
//! for the centre of mass, and anew whenever other vertices are to follow a path. A slice looks at the clock after every few
//! dozen states, so that the page's frames stay short.

use actor::graph::rounded_alpha;
use actor::pose_source::PoseError;
use glam::{Vec2, Vec3};
use kernels::align::Placement;
use search::{
    Answer, DEFAULT_EFFORT, Direction, Progress, Request, RequestError, Scene, SearchGraph, SearchGraphBuilder, Start,
    limits,
};
use thiserror::Error;

use crate::report::{AnswerReport, report_legs, track};
use crate::scene::Known;

/// States expanded between two looks at the clock: well below a millisecond in a browser.
const STATES: u32 = 20;
/// Transitions surveyed between two looks.
const TRANSITIONS: usize = 200;

/// Why there is no search, or no answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SearchError {
    /// The request makes no sense, or none for this actor.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// [`Searcher::prepare`] is not done, or no search is under way.
    #[error("no search is under way")]
    Nothing,
    /// What was handed over does not fit together.
    #[error("what the search knows of the actor does not fit together; load the page again")]
    Misfit,
}

impl From<PoseError> for SearchError {
    fn from(_: PoseError) -> Self {
        Self::Misfit
    }
}

/// Where a search begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// Where the actor would leave from.
    Here(Start),
    /// Wherever suits the request best.
    Anywhere,
    /// Where the answer before ends: its walk is to be gone on with.
    End,
}

/// Searches for one actor.
pub struct Searcher {
    known: Known,
    /// The actor's own weight of a frame's duration, for requests that name none.
    alpha: f64,
    /// The vertices that are followed; empty for the centre of mass.
    group: Vec<u32>,
    /// The search graph, and what makes it as long as it is not there.
    survey: Option<Box<SearchGraphBuilder>>,
    search_graph: Option<Box<SearchGraph>>,
    direction: Option<Direction>,
}

impl Searcher {
    /// Searches in which the centre of mass follows paths.
    ///
    /// # Errors
    /// What is known does not fit together.
    pub fn new(known: Known) -> Result<Self, SearchError> {
        let survey = Some(survey(&known, None)?);
        let alpha = known.graph.alpha();
        Ok(Self { known, alpha, group: Vec::new(), survey, search_graph: None, direction: None })
    }

    /// Whether it is these vertices (the centre of mass, where there are none) that follow paths now; where not,
    /// [`Self::follow`] changes that.
    ///
    /// # Errors
    /// There are too many, or there is no such vertex.
    pub fn follows(&self, vertices: &[u32]) -> Result<bool, SearchError> {
        let (what, count, limit) = ("vertices", vertices.len(), limits::MAX_VERTICES);
        if count > limit {
            return Err(RequestError::TooMany { what, count, limit }.into());
        }
        match vertices.iter().find(|&&vertex| vertex >= self.known.vertex_count) {
            Some(&vertex) => Err(RequestError::UnknownVertex(vertex).into()),
            None => Ok(self.group == vertices),
        }
    }

    /// From now on `vertices` follow paths: `points` are their middle in every frame, in metres as it was recorded. The search
    /// under way is dropped.
    ///
    /// # Errors
    /// As [`Self::follows`], and points that are not one a frame.
    pub fn follow(&mut self, vertices: &[u32], points: Vec<Vec3>) -> Result<(), SearchError> {
        if self.follows(vertices)? {
            return Ok(());
        }
        let group = (!vertices.is_empty()).then(|| (vertices.to_vec(), points));
        self.survey = Some(survey(&self.known, group)?);
        (self.group, self.search_graph, self.direction) = (vertices.to_vec(), None, None);
        Ok(())
    }

    /// Gets ready until `is_over` says that it is enough for now; whether that is done.
    ///
    /// # Errors
    /// What is known does not fit together.
    pub fn prepare(&mut self, mut is_over: impl FnMut() -> bool) -> Result<bool, SearchError> {
        let Known { graph, timeline, motion, .. } = &self.known;
        while let Some(mut survey) = self.survey.take() {
            if survey.advance(graph, timeline, motion, TRANSITIONS)? {
                self.search_graph = Some(Box::new(survey.finish()));
                break;
            }
            self.survey = Some(survey);
            if is_over() {
                break;
            }
        }
        Ok(self.search_graph.is_some())
    }

    /// Begins to search for a walk that does what `request` asks; a search under way is dropped.
    ///
    /// # Errors
    /// The request makes no sense for this actor, or [`Self::prepare`] is not done.
    pub fn begin(&mut self, request: &Request, from: Origin) -> Result<(), SearchError> {
        let start = match from {
            Origin::Anywhere => None,
            Origin::Here(start) => Some(start),
            Origin::End => {
                let answer = self.answer()?;
                Some(Start { frame: answer.end_frame, placement: placement_of(answer.end_placement) })
            }
        };
        self.direction = None;
        self.hurry(request.quickness.unwrap_or(self.alpha));
        self.direction = Some(Direction::new(&self.scene()?, start, request, DEFAULT_EFFORT)?);
        Ok(())
    }

    /// Weighs a frame's duration as a request wants it. What it may not be is refused with the request.
    fn hurry(&mut self, alpha: f64) {
        let graph = &mut self.known.graph;
        if graph.alpha() == rounded_alpha(alpha) || graph.set_alpha(alpha).is_err() {
            return;
        }
        if let Some(search_graph) = &mut self.search_graph {
            search_graph.set_alpha(graph.alpha());
        }
    }

    /// Searches on until `is_over` says that it is enough for now.
    ///
    /// # Errors
    /// No search is under way.
    pub fn advance(&mut self, mut is_over: impl FnMut() -> bool) -> Result<Progress, SearchError> {
        let mut direction = self.direction.take().ok_or(SearchError::Nothing)?;
        let scene = self.scene()?;
        let progress = loop {
            let progress = direction.advance(&scene, STATES)?;
            if progress != Progress::Running || is_over() {
                break progress;
            }
        };
        self.direction = Some(direction);
        Ok(progress)
    }

    /// Works on what the best answer so far needs besides, until `is_over` says that it is enough for now; whether that is done.
    ///
    /// # Errors
    /// No search is under way.
    pub fn polish(&mut self, is_over: impl FnMut() -> bool) -> Result<bool, SearchError> {
        let mut direction = self.direction.take().ok_or(SearchError::Nothing)?;
        let done = direction.polish(&self.scene()?, is_over);
        self.direction = Some(direction);
        Ok(done)
    }

    /// Drops the search under way.
    pub fn stop(&mut self) {
        self.direction = None;
    }

    /// The best answer so far.
    ///
    /// # Errors
    /// No search is under way.
    pub fn answer(&self) -> Result<Answer, SearchError> {
        let direction = self.direction.as_ref().ok_or(SearchError::Nothing)?;
        Ok(direction.best(&self.scene()?))
    }

    /// The best answer so far, with what the page draws of it.
    ///
    /// # Errors
    /// No search is under way.
    pub fn report(&self) -> Result<AnswerReport, SearchError> {
        let mut answer = self.answer()?;
        let Scene { graph, search_graph, .. } = self.scene()?;
        let placement = placement_of(answer.start_placement);
        let track = track(search_graph, answer.start_frame, placement, &answer.walk);
        // The page takes it from the walk's numbers.
        answer.walk.bend.clear();
        Ok(AnswerReport { legs: report_legs(&answer.walk.legs, graph), track, answer })
    }

    fn scene(&self) -> Result<Scene<'_>, SearchError> {
        let search_graph = self.search_graph.as_deref().ok_or(SearchError::Nothing)?;
        Ok(Scene { graph: &self.known.graph, timeline: &self.known.timeline, search_graph })
    }
}

fn survey(known: &Known, group: Option<(Vec<u32>, Vec<Vec3>)>) -> Result<Box<SearchGraphBuilder>, PoseError> {
    SearchGraphBuilder::new(&known.graph, &known.timeline, &known.motion, group).map(Box::new)
}

fn placement_of([heading, x, z]: [f32; 3]) -> Placement {
    Placement { heading, translation: Vec2::new(x, z) }
}
