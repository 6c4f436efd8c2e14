//! Directing, as more methods of the class `Player`.

use js_sys::Float32Array;
use search::Progress;
use wasm_bindgen::prelude::*;

use super::error::{ErrorKind, error, json};
use super::player::Player;
use super::request::parse;
use crate::player::direct::Origin;

#[wasm_bindgen]
impl Player {
    /// Gets ready for searches in which `vertices` follow paths (the centre of mass, where there are none), for about
    /// `milliseconds`; whether that is done.
    ///
    /// # Errors
    /// The graph or a frame has not arrived, or there is no such vertex.
    pub fn prepare_search(&mut self, vertices: &[u32], milliseconds: f64) -> Result<bool, JsValue> {
        Ok(self.inner.prepare_search(vertices, milliseconds)?)
    }

    /// Checks of a request what can be checked without the actor.
    ///
    /// # Errors
    /// What is wrong with it, in a sentence.
    pub fn check_request(&self, text: &str) -> Result<(), JsValue> {
        parse(text).map(|_| ())
    }

    /// Begins a search for what the request asks, `here`, `anywhere` or from the `end` of the last answer.
    ///
    /// # Errors
    /// The request makes no sense for this actor, or the search is not prepared.
    pub fn search(&mut self, text: &str, from: &str) -> Result<(), JsValue> {
        let from = match from {
            "here" => Origin::Here,
            "anywhere" => Origin::Anywhere,
            "end" => Origin::End,
            _ => return Err(error(ErrorKind::BadArgument, "a search begins here, anywhere, or at the end")),
        };
        Ok(self.inner.search(&parse(text)?, from)?)
    }

    /// Searches on for about `milliseconds`: `running`, `ended`, or `proven` to be the best.
    ///
    /// # Errors
    /// No search is under way.
    pub fn search_on(&mut self, milliseconds: f64) -> Result<String, JsValue> {
        let word = match self.inner.search_on(milliseconds)? {
            Progress::Running => "running",
            Progress::Ended => "ended",
            Progress::Proven => "proven",
        };
        Ok(word.into())
    }

    /// Drops the search under way.
    pub fn stop_search(&mut self) {
        self.inner.stop_search();
    }

    /// The best answer so far, as JSON.
    ///
    /// # Errors
    /// No search is under way.
    pub fn answer(&self) -> Result<String, JsValue> {
        json(&self.inner.answer_report()?)
    }

    /// Sets off on the best walk so far; the walk as JSON. With `anywhere` the actor is put where the walk begins.
    ///
    /// # Errors
    /// There is no walk, or the actor has moved on since the search began.
    pub fn set_off(&mut self, anywhere: bool) -> Result<String, JsValue> {
        json(&self.inner.set_off(anywhere)?)
    }

    /// Goes on with the best walk so far where the walk under way ends; whether it could.
    ///
    /// # Errors
    /// No search is under way.
    pub fn go_on(&mut self) -> Result<bool, JsValue> {
        Ok(self.inner.go_on()?)
    }

    /// Where a walk would leave from now: the frame, and its placement as heading, x and z.
    ///
    /// # Errors
    /// There is no actor yet.
    pub fn leaves(&mut self) -> Result<Float32Array, JsValue> {
        let (frame, placement) = self.inner.leaves()?;
        let [x, z] = placement.translation.to_array();
        Ok(Float32Array::from([frame as f32, placement.heading, x, z].as_slice()))
    }

    /// Stands in `frame`, placed by heading, x and z; a walk is dropped.
    ///
    /// # Errors
    /// There is no such frame, or it has not arrived.
    pub fn stand(&mut self, frame: u32, heading: f32, x: f32, z: f32) -> Result<(), JsValue> {
        let translation = glam::Vec2::new(x, z);
        Ok(self.inner.stand_in(frame, kernels::align::Placement { heading, translation })?)
    }
}
