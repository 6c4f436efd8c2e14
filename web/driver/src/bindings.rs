//! The class `Driver`.

use editor::scene::Known;
use glam::{Vec2, Vec3};
use js_sys::{Float32Array, JsString, Uint8Array};
use kernels::align::Placement;
use searcher::page::error;
use wasm_bindgen::prelude::*;

use crate::error::DriverError;
use crate::perform::Performed;
use crate::session::Session;

/// Drives one actor by motion capture.
#[wasm_bindgen]
pub struct Driver {
    inner: Session,
    notes: Vec<String>,
    worn: [f32; 4],
}

impl From<DriverError> for JsValue {
    fn from(failure: DriverError) -> Self {
        error(if matches!(failure, DriverError::Misfit) { "damaged" } else { "bad-argument" }, &failure.to_string())
    }
}

fn points(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(Vec3::from_slice).collect()
}

fn array(points: &[Vec3]) -> Float32Array {
    Float32Array::from(bytemuck::cast_slice::<Vec3, f32>(points))
}

#[wasm_bindgen]
impl Driver {
    /// Drives an actor with what a player's `editable` and `rig` have handed over.
    ///
    /// # Errors
    /// The actor has no rig, or one that cannot be used.
    #[wasm_bindgen(constructor)]
    pub fn new(words: &[u32], rig: &[u8]) -> Result<Self, JsValue> {
        console_error_panic_hook::set_once();
        let known = Known::from_words(words).ok_or(DriverError::Misfit)?;
        Ok(Self { inner: Session::new(known, rig)?, notes: Vec::new(), worn: [0.0; 4] })
    }

    /// The next frame whose recorded pose has to be given; nothing once the actor can be driven.
    #[must_use]
    pub fn needs(&self) -> Option<u32> {
        self.inner.needs().first().copied()
    }

    /// Takes the recorded pose of the frame that is needed.
    ///
    /// # Errors
    /// The actor cannot be driven.
    pub fn give(&mut self, pose: &[f32]) -> Result<(), JsValue> {
        Ok(self.inner.give(points(pose))?)
    }

    /// Takes the clip of these files, names and contents, in place of the one before. How many frames it has.
    ///
    /// # Errors
    /// What is wrong with it, in a sentence; the one before stays.
    pub fn begin(&mut self, names: Vec<JsString>, contents: Vec<Uint8Array>) -> Result<u32, JsValue> {
        let names: Vec<String> = names.iter().map(String::from).collect();
        let contents: Vec<Vec<u8>> = contents.iter().map(Uint8Array::to_vec).collect();
        let files: Vec<(&str, &[u8])> =
            names.iter().zip(&contents).map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
        let began = self.inner.begin(&files)?;
        self.notes = began.notes;
        Ok(began.count as u32)
    }

    /// What whoever dropped the clip should know, in sentences.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Vertex positions of a frame of the clip, as it is before it is placed.
    ///
    /// # Errors
    /// There is no such frame, or it cannot be solved for.
    pub fn make(&mut self, frame: usize) -> Result<Float32Array, JsValue> {
        Ok(array(&self.inner.make(frame)?))
    }

    /// Prepares to perform the clip from `frame`, whose recorded pose this is. The recorded frames whose poses are needed: the first
    /// one and how many, for the way in and for the way back.
    ///
    /// # Errors
    /// There is no clip, or no way back.
    pub fn prepare(&mut self, frame: u32, pose: &[f32]) -> Result<Vec<u32>, JsValue> {
        let windows = self.inner.prepare(frame, &points(pose))?;
        Ok(windows.into_iter().flat_map(|window| [window.first, window.count]).collect())
    }

    /// Edits the clip's ends towards the recorded frames that they are blended with; takes the poses of both windows that were prepared. How
    /// far postures in the middle of the way in and of the way back are apart, as driven and now, in metres.
    ///
    /// # Errors
    /// It was not prepared, or the poses do not fit.
    pub fn aim(&mut self, before: &[f32], after: &[f32]) -> Result<Vec<f32>, JsValue> {
        Ok(self.inner.aim(&[points(before), points(after)])?.concat())
    }

    /// Makes one more frame that the blends at the clip's ends need; whether there was one to be made.
    ///
    /// # Errors
    /// A frame that cannot be made.
    pub fn make_ahead(&mut self) -> Result<bool, JsValue> {
        Ok(self.inner.make_ahead()?)
    }

    /// Begins to perform where the actor stands, at heading, x and z; with the poses of both windows. A clip that was not aimed is aimed
    /// now. The frame that it ends with,
    /// heading, x and z of that, and how many frames lead there.
    ///
    /// # Errors
    /// It was not prepared, or the poses do not fit.
    pub fn perform(
        &mut self,
        before: &[f32],
        after: &[f32],
        heading: f32,
        x: f32,
        z: f32,
    ) -> Result<Vec<f32>, JsValue> {
        let placement = Placement { heading, translation: Vec2::new(x, z) };
        let (to, home, length) = self.inner.perform([points(before), points(after)], placement)?;
        let [x, z] = home.translation.to_array();
        Ok(vec![to as f32, home.heading, x, z, length as f32])
    }

    /// The next frame of the performance, in the world; empty at its end.
    ///
    /// # Errors
    /// A frame that cannot be made.
    pub fn next_frame(&mut self) -> Result<Float32Array, JsValue> {
        let Some(Performed { pose, worn: ([from, to], lambda), heading }) = self.inner.next_frame()? else {
            return Ok(Float32Array::new_with_length(0));
        };
        self.worn = [from as f32, to as f32, lambda, heading];
        Ok(array(&pose))
    }

    /// Recorded frames whose looks the last frame has, how much those of the second count, and the frame's turn about +Y.
    #[must_use]
    pub fn worn(&self) -> Vec<f32> {
        self.worn.to_vec()
    }
}
