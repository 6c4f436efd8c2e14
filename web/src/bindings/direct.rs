//! Directing, as more methods of the class `Player`: what the module that searches needs, and the walks that it finds.

use js_sys::{Float32Array, Uint32Array};
use searcher::page::{error, json};
use searcher::walk::from_numbers;
use wasm_bindgen::prelude::*;

use super::player::{Player, array};

#[wasm_bindgen]
impl Player {
    /// Works for about `milliseconds` on what a `Searcher` needs to know of the actor; that, once it is all there.
    ///
    /// # Errors
    /// The graph or a frame has not arrived.
    pub fn known(&mut self, milliseconds: f64) -> Result<Option<Uint32Array>, JsValue> {
        let words = self.inner.known(milliseconds)?;
        Ok(words.map(|words| Uint32Array::from(words.as_slice())))
    }

    /// Works for about `milliseconds` on where the middle of `vertices` is in every frame; that, once it is all there.
    ///
    /// # Errors
    /// A frame has not arrived, or there is no such vertex.
    pub fn middles(&mut self, vertices: &[u32], milliseconds: f64) -> Result<Option<Float32Array>, JsValue> {
        let middles = self.inner.middles(vertices, milliseconds)?;
        Ok(middles.map(|points| array(&points)))
    }

    /// Sets off on a walk that a `Searcher` has found; the walk as JSON. With `anywhere` the actor is put where the walk begins.
    ///
    /// # Errors
    /// There is no walk, or the actor has moved on since the search began.
    pub fn set_off(&mut self, walk: &[f64], anywhere: bool) -> Result<String, JsValue> {
        let (start, found) = from_numbers(walk).ok_or_else(no_walk)?;
        json(&self.inner.set_off(&start, found, anywhere)?)
    }

    /// Goes on with a walk that a `Searcher` has found where the walk under way ends; whether it could.
    ///
    /// # Errors
    /// It is no walk of this actor.
    pub fn go_on(&mut self, walk: &[f64]) -> Result<bool, JsValue> {
        let (start, found) = from_numbers(walk).ok_or_else(no_walk)?;
        Ok(self.inner.go_on(&start, found)?)
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

fn no_walk() -> JsValue {
    error("bad-argument", "these numbers are no walk")
}
