//! The class `Searcher`.

use glam::{Vec2, Vec3};
use kernels::align::Placement;
use search::{Progress, Request, Start};
use wasm_bindgen::prelude::*;

use crate::page::{error, json, now, read_json};
use crate::scene::Known;
use crate::searcher::{Origin, SearchError, Searcher as Inner};
use crate::walk::numbers;

/// Searches for one actor.
#[wasm_bindgen]
pub struct Searcher {
    inner: Inner,
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
    /// Searches with what a player's `known` has handed over, and the families of its sequences as JSON.
    ///
    /// # Errors
    /// It does not fit together.
    #[wasm_bindgen(constructor)]
    pub fn new(words: &[u32], families: &str) -> Result<Self, JsValue> {
        console_error_panic_hook::set_once();
        let known = Known::from_words(words).and_then(|known| known.with_families(&read_json(families)?));
        let known = known.ok_or(SearchError::Misfit)?;
        Ok(Self { inner: Inner::new(known)? })
    }

    /// Whether it is these vertices (the centre of mass, where there are none) that follow paths now.
    ///
    /// # Errors
    /// There are too many, or there is no such vertex.
    pub fn follows(&self, vertices: &[u32]) -> Result<bool, JsValue> {
        Ok(self.inner.follows(vertices)?)
    }

    /// From now on `vertices` follow paths; `points` are their middle in every frame, as a player's `middles` has found it.
    ///
    /// # Errors
    /// As [`Self::follows`], and points that are not one a frame.
    pub fn follow(&mut self, vertices: &[u32], points: &[f32]) -> Result<(), JsValue> {
        let points = points.chunks_exact(3).map(Vec3::from_slice).collect();
        Ok(self.inner.follow(vertices, points)?)
    }

    /// Gets ready for about `milliseconds`; whether that is done.
    ///
    /// # Errors
    /// None in practice.
    pub fn prepare(&mut self, milliseconds: f64) -> Result<bool, JsValue> {
        Ok(self.inner.prepare(is_over(milliseconds))?)
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
        Ok(self.inner.begin(&parse(text)?, from)?)
    }

    /// Searches on for about `milliseconds`: `running`, `ended`, or `proven` to be the best.
    ///
    /// # Errors
    /// No search is under way.
    pub fn advance(&mut self, milliseconds: f64) -> Result<String, JsValue> {
        let word = match self.inner.advance(is_over(milliseconds))? {
            Progress::Running => "running",
            Progress::Ended => "ended",
            Progress::Proven => "proven",
        };
        Ok(word.into())
    }

    /// Drops the search under way.
    pub fn stop(&mut self) {
        self.inner.stop();
    }

    /// The best answer so far, as JSON.
    ///
    /// # Errors
    /// No search is under way.
    pub fn answer(&self) -> Result<String, JsValue> {
        json(&self.inner.report()?)
    }

    /// The walk of the best answer so far, as a player's `set_off` takes it.
    ///
    /// # Errors
    /// No search is under way.
    pub fn walk(&self) -> Result<Vec<f64>, JsValue> {
        Ok(numbers(&self.inner.answer()?))
    }
}

/// The request that `text` holds as JSON, which the browser reads: another parser would weigh 30 KB.
fn parse(text: &str) -> Result<Request, JsValue> {
    Ok(Request::parse(text, read_json).map_err(SearchError::from)?)
}
