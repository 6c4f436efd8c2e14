//! The class `Editor`.

use editing::EditDocument;
use glam::Vec3;
use js_sys::Float32Array;
use searcher::page::{error, read_json};
use wasm_bindgen::prelude::*;

use crate::scene::Known;
use crate::session::{Session, SessionError};

/// Edits one actor.
#[wasm_bindgen]
pub struct Editor {
    inner: Session,
}

impl From<SessionError> for JsValue {
    fn from(failure: SessionError) -> Self {
        let kind = match failure {
            SessionError::Edit(_) | SessionError::Nothing => "bad-argument",
            SessionError::Pose(_) => "not-loaded",
            SessionError::Misfit => "damaged",
        };
        error(kind, &failure.to_string())
    }
}

/// Checks of a document of edits what can be checked without the actor.
///
/// # Errors
/// What is wrong with it, in a sentence.
#[wasm_bindgen]
pub fn check_edits(text: &str) -> Result<(), JsValue> {
    parse(text).map(|_| ()).map_err(JsValue::from)
}

fn parse(text: &str) -> Result<EditDocument, SessionError> {
    Ok(EditDocument::parse(text, read_json)?)
}

fn points(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(Vec3::from_slice).collect()
}

fn array(points: &[Vec3]) -> Float32Array {
    Float32Array::from(bytemuck::cast_slice::<Vec3, f32>(points))
}

#[wasm_bindgen]
impl Editor {
    /// Edits with what a player's `editable`, `rig` and `learned` have handed over.
    ///
    /// # Errors
    /// It does not fit together.
    #[wasm_bindgen(constructor)]
    pub fn new(words: &[u32], rig: &[u8], learned: &[u8]) -> Result<Self, JsValue> {
        console_error_panic_hook::set_once();
        let known = Known::from_words(words).ok_or(SessionError::Misfit)?;
        Ok(Self { inner: Session::new(known, rig, learned)? })
    }

    /// Whether bones move the body.
    #[must_use]
    pub fn has_rig(&self) -> bool {
        self.inner.has_rig()
    }

    /// Whether edits may go by the ways in which the actor was seen to move.
    #[must_use]
    pub fn has_space(&self) -> bool {
        self.inner.has_space()
    }

    /// Why a rig that the actor has cannot be used; empty where it can be.
    #[must_use]
    pub fn rig_trouble(&self) -> String {
        self.inner.rig_trouble().unwrap_or_default().into()
    }

    /// Frames whose recorded poses have to be given next.
    #[must_use]
    pub fn needs(&self) -> Vec<u32> {
        self.inner.needs()
    }

    /// Takes the recorded pose of a frame.
    ///
    /// # Errors
    /// It is none of this mesh.
    pub fn give(&mut self, frame: u32, pose: &[f32]) -> Result<(), JsValue> {
        Ok(self.inner.give(frame, points(pose))?)
    }

    /// Takes a document of edits, as JSON, in place of the one before.
    ///
    /// # Errors
    /// What is wrong with it, in a sentence; the one before stays.
    pub fn replace(&mut self, text: &str) -> Result<(), JsValue> {
        Ok(self.inner.replace(parse(text)?)?)
    }

    /// Frames that edit `edit` reaches.
    #[must_use]
    pub fn reached(&self, edit: usize) -> Vec<u32> {
        self.inner.reached(edit)
    }

    /// One step of making edit `edit` of its own frame, so that the page can do other work between; whether it is made.
    ///
    /// # Errors
    /// Its frame was not given.
    pub fn settle(&mut self, edit: usize) -> Result<bool, JsValue> {
        Ok(self.inner.settle(edit)?)
    }

    /// Frame `frame` with its edits; `pose` is what was recorded.
    ///
    /// # Errors
    /// A pose that was needed was not given.
    pub fn make(&mut self, frame: u32, pose: &[f32]) -> Result<Float32Array, JsValue> {
        let mut pose = points(pose);
        self.inner.make(frame, &mut pose)?;
        Ok(array(&pose))
    }

    /// What is not as it was wanted, in sentences.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        self.inner.notes()
    }

    /// Takes hold of what edit `edit` grabs, to be dragged.
    ///
    /// # Errors
    /// There is no such edit, or its frame was not given.
    pub fn grab(&mut self, edit: usize) -> Result<(), JsValue> {
        Ok(self.inner.grab(edit)?)
    }

    /// Drags its handles to these places, as the frame was recorded; the frame with all edits.
    ///
    /// # Errors
    /// Nothing is held, or these are no places.
    pub fn drag(&mut self, to: &[f32]) -> Result<Float32Array, JsValue> {
        Ok(array(&self.inner.drag(&points(to))?))
    }

    /// Whether each foot stands in a frame: 1 where it does.
    #[must_use]
    pub fn stands(&mut self, frame: u32) -> Vec<u8> {
        self.inner.stands(frame).into_iter().map(u8::from).collect()
    }

    /// The vertices of a foot's sole.
    #[must_use]
    pub fn sole(&self, foot: usize) -> Vec<u32> {
        self.inner.sole(foot)
    }

    /// Where bones begin and end in a pose; empty without a rig.
    #[must_use]
    pub fn bones(&self, pose: &[f32]) -> Float32Array {
        array(&self.inner.bones(&points(pose)))
    }
}
