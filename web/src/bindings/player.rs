//! The class `Player`.

use glam::Vec3;
use js_sys::{Float32Array, Uint8Array};
use searcher::page::{json, now};
use wasm_bindgen::prelude::*;

use super::error::{ErrorKind, bundle_error, error};
use crate::player::Player as Inner;
use crate::player::loading::Loading;

/// The actor and its clock, without any GPU.
#[wasm_bindgen]
pub struct Player {
    #[wasm_bindgen(skip)]
    #[doc(hidden)]
    pub inner: Inner,
}

impl Default for Player {
    fn default() -> Self {
        Self::new()
    }
}

pub(super) fn array(points: &[Vec3]) -> Float32Array {
    Float32Array::from(bytemuck::cast_slice::<Vec3, f32>(points))
}

#[wasm_bindgen]
impl Player {
    /// Without an actor yet.
    #[wasm_bindgen(constructor)]
    #[must_use]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self { inner: Inner::new(Loading::default(), now) }
    }

    /// The next bytes of the bundle.
    ///
    /// # Errors
    /// They are no bundle, one of a later version, or damaged.
    pub fn push(&mut self, bytes: &[u8]) -> Result<(), JsValue> {
        self.inner.push(bytes).map_err(bundle_error)
    }

    /// No more bytes will come.
    ///
    /// # Errors
    /// The bundle is cut off, or was wrong before.
    pub fn finish(&self) -> Result<(), JsValue> {
        self.inner.loading().finish().map_err(bundle_error)
    }

    /// Reads on in the textures' modes for about `milliseconds`; true where there is more to read at once.
    ///
    /// # Errors
    /// One is damaged.
    pub fn refine(&mut self, milliseconds: f64) -> Result<bool, JsValue> {
        Ok(self.inner.refine(milliseconds)?)
    }

    /// Whether the positions of `frame` have arrived.
    #[must_use]
    pub fn loaded(&self, frame: u32) -> bool {
        self.inner.loading().loaded(frame)
    }

    /// How much has arrived.
    #[must_use]
    pub fn phase(&self) -> String {
        self.inner.loading().phase().word().into()
    }

    /// What the actor is, as JSON.
    ///
    /// # Errors
    /// Its first pose has not arrived.
    pub fn info(&self) -> Result<String, JsValue> {
        match self.inner.info() {
            Some(info) => json(&info),
            None => Err(error(ErrorKind::NotLoaded, "the actor has not arrived yet")),
        }
    }

    /// Encoded bytes of texture `index`.
    ///
    /// # Errors
    /// They have not arrived.
    pub fn image(&self, index: usize) -> Result<Uint8Array, JsValue> {
        Ok(Uint8Array::from(self.inner.image(index)?))
    }

    /// Goes on by `seconds`; true where the picture changes.
    pub fn tick(&mut self, seconds: f64) -> bool {
        self.inner.tick(seconds)
    }

    /// Plays on.
    pub fn play(&mut self) {
        self.inner.play();
    }

    /// Stands still.
    pub fn pause(&mut self) {
        self.inner.pause();
    }

    /// Whether it plays.
    #[must_use]
    pub fn playing(&self) -> bool {
        self.inner.playing()
    }

    /// From now on plans weigh a frame's duration by `alpha`, where it is above 0; else as the actor came.
    ///
    /// # Errors
    /// The graph has not arrived.
    pub fn set_quickness(&mut self, alpha: f64) -> Result<(), JsValue> {
        Ok(self.inner.set_quickness(alpha)?)
    }

    /// How much recorded stretches vary where the actor has alternatives: 0 is as recorded, 1 as they were made.
    pub fn set_variety(&mut self, amount: f64) {
        self.inner.set_variety(amount);
    }

    /// Plays `speed` times as fast.
    pub fn set_speed(&mut self, speed: f64) {
        self.inner.set_speed(speed);
    }

    /// Whether playing goes on for ever.
    pub fn set_loop(&mut self, on: bool) {
        self.inner.set_loop(on);
    }

    /// Jumps to `frame`.
    ///
    /// # Errors
    /// It has not arrived.
    pub fn seek(&mut self, frame: f64) -> Result<(), JsValue> {
        Ok(self.inner.seek(frame)?)
    }

    /// The cheapest walk to frame `to`, as JSON.
    ///
    /// # Errors
    /// There is none.
    pub fn plan(&mut self, to: u32) -> Result<String, JsValue> {
        json(&self.inner.plan(to)?)
    }

    /// The frame of a behaviour, a label or the name of a sequence, that is reached at the least cost.
    ///
    /// # Errors
    /// There is no such behaviour, or no walk to it.
    pub fn nearest(&mut self, behaviour: &str) -> Result<u32, JsValue> {
        Ok(self.inner.nearest(behaviour)?)
    }

    /// Searches for walks to poses and behaviours so far.
    #[must_use]
    pub fn plans(&self) -> f64 {
        self.inner.plans() as f64
    }

    /// Leaves for frame `to`; the walk as JSON.
    ///
    /// # Errors
    /// There is none.
    pub fn go_to(&mut self, to: u32) -> Result<String, JsValue> {
        json(&self.inner.go_to(to)?)
    }

    /// Stops, and drops the target.
    pub fn cancel(&mut self) {
        self.inner.cancel();
    }

    /// The state as JSON.
    ///
    /// # Errors
    /// There is no pose yet.
    pub fn state(&self) -> Result<String, JsValue> {
        match self.inner.state() {
            Some(state) => json(&state),
            None => Err(error(ErrorKind::NotLoaded, "the actor has not arrived yet")),
        }
    }

    /// What happened since the last call, as JSON.
    ///
    /// # Errors
    /// None in practice.
    pub fn events(&mut self) -> Result<String, JsValue> {
        json(&self.inner.take_events())
    }

    /// World positions of the welded vertices, as drawn.
    ///
    /// # Errors
    /// There is no pose yet.
    pub fn pose(&self) -> Result<Float32Array, JsValue> {
        let picture =
            self.inner.picture().ok_or_else(|| error(ErrorKind::NotLoaded, "the actor has not arrived yet"))?;
        Ok(array(&picture.pose()))
    }

    /// Positions of `frame` as they were recorded.
    ///
    /// # Errors
    /// It has not arrived.
    pub fn recorded_pose(&mut self, frame: u32) -> Result<Float32Array, JsValue> {
        Ok(array(&self.inner.recorded_pose(frame)?))
    }

    /// Placement [heading, x, z] of frame `to` if the actor goes there from the present.
    ///
    /// # Errors
    /// There is no walk.
    pub fn arrival(&mut self, to: u32) -> Result<Float32Array, JsValue> {
        let placement = self.inner.arrival(to)?;
        let [x, z] = placement.translation.to_array();
        Ok(Float32Array::from([placement.heading, x, z].as_slice()))
    }

    /// All frames of the cheapest walk from `from`, as it was recorded, to `to`, one after another.
    ///
    /// # Errors
    /// There is no walk.
    pub fn synthesise(&mut self, from: u32, to: u32) -> Result<Float32Array, JsValue> {
        Ok(array(&self.inner.synthesise(from, to)?))
    }

    /// Medians in milliseconds of what the player does most, as JSON.
    ///
    /// # Errors
    /// None in practice.
    #[cfg(feature = "bench")]
    pub fn bench(&mut self) -> Result<String, JsValue> {
        json(&self.inner.bench(now)?)
    }

    /// The `max` cheapest transitions as [from, to, deformation, frames].
    #[must_use]
    pub fn arcs(&self, max: usize) -> Float32Array {
        Float32Array::from(self.inner.arcs(max).as_slice())
    }
}
