//! The class `Driver`.

use editor::scene::Known;
use glam::Vec3;
use js_sys::{Array, Float32Array, JsString, Uint8Array};
use searcher::page::error;
use wasm_bindgen::prelude::*;

use crate::error::DriverError;
use crate::session::{Began, Session};

/// Drives one actor by motion capture.
#[wasm_bindgen]
pub struct Driver {
    inner: Session,
    began: Option<Began>,
}

impl From<DriverError> for JsValue {
    fn from(failure: DriverError) -> Self {
        error(if matches!(failure, DriverError::Misfit) { "damaged" } else { "bad-argument" }, &failure.to_string())
    }
}

fn points(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(Vec3::from_slice).collect()
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
        Ok(Self { inner: Session::new(known, rig)?, began: None })
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

    /// Takes the clip of these files, names and contents, in place of the one before. How many frames it has, and the recorded
    /// frame whose looks they have.
    ///
    /// # Errors
    /// What is wrong with it, in a sentence; the one before stays.
    pub fn begin(&mut self, names: Vec<JsString>, contents: Vec<Uint8Array>) -> Result<Vec<u32>, JsValue> {
        let names: Vec<String> = names.iter().map(String::from).collect();
        let contents: Vec<Vec<u8>> = contents.iter().map(Uint8Array::to_vec).collect();
        let files: Vec<(&str, &[u8])> =
            names.iter().zip(&contents).map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
        let began = self.inner.begin(&files)?;
        let numbers = vec![began.count as u32, began.like];
        self.began = Some(began);
        Ok(numbers)
    }

    /// Frame after frame, for each foot of the actor 1 where it stands.
    #[must_use]
    pub fn stands(&self) -> Vec<u8> {
        self.began.iter().flat_map(|began| &began.stands).map(|&stands| stands.into()).collect()
    }

    /// Where the actor may go on afterwards, the best first: frame, nodes of the blend and radians of each.
    #[must_use]
    pub fn exits(&self) -> Float32Array {
        let exits = self.began.iter().flat_map(|began| &began.exits);
        let numbers: Vec<f32> =
            exits.flat_map(|exit| [exit.to as f32, exit.nodes as f32, exit.radians]).collect();
        Float32Array::from(numbers.as_slice())
    }

    /// What whoever dropped the clip should know, in sentences.
    #[must_use]
    pub fn notes(&self) -> Array {
        self.began.iter().flat_map(|began| &began.notes).map(JsValue::from).collect()
    }

    /// Vertex positions of a frame of the clip.
    ///
    /// # Errors
    /// There is no such frame, or it cannot be solved for.
    pub fn make(&mut self, frame: usize) -> Result<Float32Array, JsValue> {
        Ok(Float32Array::from(bytemuck::cast_slice::<Vec3, f32>(&self.inner.make(frame)?)))
    }

    /// Nodes and radians of a blend from `pose` to the clip's beginning.
    ///
    /// # Errors
    /// There is no clip.
    pub fn entry(&mut self, pose: &[f32]) -> Result<Vec<f32>, JsValue> {
        let (nodes, radians) = self.inner.entry(&points(pose))?;
        Ok(vec![nodes as f32, radians])
    }
}
