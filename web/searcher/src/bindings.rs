//! The class `Searcher`.

use glam::{Vec2, Vec3};
use kernels::align::Placement;
use search::{Progress, Request, Start};
use wasm_bindgen::prelude::*;

use crate::page::{error, json, now, read_json};
use crate::scene::{Known, Reading};
use crate::searcher::{Origin, SearchError, Searcher as Inner};
use crate::walk::numbers;

/// Transitions that are read between two looks at the clock.
const TRANSITIONS: usize = 500;

/// Searches for one actor.
#[wasm_bindgen]
pub struct Searcher {
    state: State,
    families: String,
}

/// How far a searcher is.
enum State {
    Reading(Box<Reading>),
    Read(Box<Known>),
    Ready(Box<Inner>),
    /// What it was told does not fit together.
    Misfit,
}

impl From<SearchError> for JsValue {
    fn from(failure: SearchError) -> Self {
        let kind = match failure {
            SearchError::Request(_) => "bad-argument",
            SearchError::Nothing => "not-loaded",
            SearchError::Misfit => "damaged",
        };
        error(kind, &failure.to_string())
    }
}

/// Whether `milliseconds` from now are over.
fn is_over(milliseconds: f64) -> impl FnMut() -> bool {
    let end = now() + milliseconds;
    move || now() >= end
}

/// Checks of a request what can be checked without the actor.
///
/// # Errors
/// What is wrong with it, in a sentence.
#[wasm_bindgen]
pub fn check_request(text: &str) -> Result<(), JsValue> {
    parse(text).map(|_| ())
}

#[wasm_bindgen]
impl Searcher {
    /// Will search with what a player's `known` has handed over, and the families of its sequences as JSON, once
    /// [`Self::read`] has read it.
    ///
    /// # Errors
    /// It does not fit together.
    #[wasm_bindgen(constructor)]
    pub fn new(words: Vec<u32>, families: String) -> Result<Self, JsValue> {
        console_error_panic_hook::set_once();
        let reading = Reading::new(words).ok_or(SearchError::Misfit)?;
        Ok(Self { state: State::Reading(Box::new(reading)), families })
    }

    /// Reads on for about `milliseconds` what the constructor was given; whether that is done.
    ///
    /// # Errors
    /// It does not fit together.
    pub fn read(&mut self, milliseconds: f64) -> Result<bool, JsValue> {
        let is_over = is_over(milliseconds);
        let state = std::mem::replace(&mut self.state, State::Misfit);
        self.state = self.read_on(state, is_over).ok_or(SearchError::Misfit)?;
        Ok(matches!(self.state, State::Ready(_)))
    }

    /// The state after `state`: what takes long in one piece has a call of its own.
    fn read_on(&self, state: State, mut is_over: impl FnMut() -> bool) -> Option<State> {
        match state {
            State::Reading(mut reading) => {
                while !reading.advance(TRANSITIONS)? {
                    if is_over() {
                        return Some(State::Reading(reading));
                    }
                }
                let known = reading.finish()?.with_families(&read_json(&self.families)?)?;
                Some(State::Read(Box::new(known)))
            }
            State::Read(known) => Inner::new(*known).ok().map(|inner| State::Ready(Box::new(inner))),
            State::Ready(inner) => Some(State::Ready(inner)),
            State::Misfit => None,
        }
    }

    fn inner(&self) -> Result<&Inner, SearchError> {
        if let State::Ready(inner) = &self.state { Ok(inner) } else { Err(SearchError::Nothing) }
    }

    fn inner_mut(&mut self) -> Result<&mut Inner, SearchError> {
        if let State::Ready(inner) = &mut self.state { Ok(inner) } else { Err(SearchError::Nothing) }
    }

    /// Whether it is these vertices (the centre of mass, where there are none) that follow paths now.
    ///
    /// # Errors
    /// There are too many, or there is no such vertex.
    pub fn follows(&self, vertices: &[u32]) -> Result<bool, JsValue> {
        Ok(self.inner()?.follows(vertices)?)
    }

    /// From now on `vertices` follow paths; `points` are their middle in every frame, as a player's `middles` has found it.
    ///
    /// # Errors
    /// As [`Self::follows`], and points that are not one a frame.
    pub fn follow(&mut self, vertices: &[u32], points: &[f32]) -> Result<(), JsValue> {
        let points = points.chunks_exact(3).map(Vec3::from_slice).collect();
        Ok(self.inner_mut()?.follow(vertices, points)?)
    }

    /// Gets ready for about `milliseconds`; whether that is done.
    ///
    /// # Errors
    /// None in practice.
    pub fn prepare(&mut self, milliseconds: f64) -> Result<bool, JsValue> {
        Ok(self.inner_mut()?.prepare(is_over(milliseconds))?)
    }

    /// Begins a search for what the request asks: `here`, `anywhere` or from the `end` of the last answer. `here` is where
    /// the actor would leave from: its frame, heading, x and z.
    ///
    /// # Errors
    /// The request makes no sense for this actor, or the search is not prepared.
    pub fn begin(&mut self, text: &str, from: &str, here: &[f32]) -> Result<(), JsValue> {
        let from = match (from, here) {
            ("here", &[frame, heading, x, z]) => {
                let placement = Placement { heading, translation: Vec2::new(x, z) };
                Origin::Here(Start { frame: frame as u32, placement })
            }
            ("anywhere", _) => Origin::Anywhere,
            ("end", _) => Origin::End,
            _ => return Err(error("bad-argument", "a search begins here, anywhere, or at the end")),
        };
        Ok(self.inner_mut()?.begin(&parse(text)?, from)?)
    }

    /// Searches on for about `milliseconds`: `running`, `ended`, or `proven` to be the best.
    ///
    /// # Errors
    /// No search is under way.
    pub fn advance(&mut self, milliseconds: f64) -> Result<String, JsValue> {
        let word = match self.inner_mut()?.advance(is_over(milliseconds))? {
            Progress::Running => "running",
            Progress::Ended => "ended",
            Progress::Proven => "proven",
        };
        Ok(word.into())
    }

    /// Works for about `milliseconds` on what the best answer so far needs besides, so that [`Self::answer`] takes no time; whether
    /// that is done.
    ///
    /// # Errors
    /// No search is under way.
    pub fn polish(&mut self, milliseconds: f64) -> Result<bool, JsValue> {
        Ok(self.inner_mut()?.polish(is_over(milliseconds))?)
    }

    /// Drops the search under way.
    pub fn stop(&mut self) {
        if let State::Ready(inner) = &mut self.state {
            inner.stop();
        }
    }

    /// The best answer so far, as JSON.
    ///
    /// # Errors
    /// No search is under way.
    pub fn answer(&self) -> Result<String, JsValue> {
        json(&self.inner()?.report()?)
    }

    /// The walk of the best answer so far, as a player's `set_off` takes it.
    ///
    /// # Errors
    /// No search is under way.
    pub fn walk(&self) -> Result<Vec<f64>, JsValue> {
        Ok(numbers(&self.inner()?.answer()?))
    }
}

/// The request that `text` holds as JSON, which the browser reads: another parser would weigh 30 KB.
fn parse(text: &str) -> Result<Request, JsValue> {
    Ok(Request::parse(text, read_json).map_err(SearchError::from)?)
}
