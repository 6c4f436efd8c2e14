//! Editing, as more methods of the class `Player`: what the module that edits needs, and the frames that it makes.

use editor::scene::words;
use glam::Vec3;
use js_sys::{Float32Array, Uint8Array, Uint32Array};
use wasm_bindgen::prelude::*;

use super::player::{Player, array};
use crate::player::PlayerError;
use crate::player::body_parts::BodyParts;

#[wasm_bindgen]
impl Player {
    /// What an `Editor` needs to know of the actor.
    ///
    /// # Errors
    /// The graph has not arrived.
    pub fn editable(&self) -> Result<Uint32Array, JsValue> {
        let loading = self.inner.loading();
        let (Some(actor), Some(graph)) = (&loading.actor, &loading.graph) else {
            return Err(PlayerError::NotLoaded.into());
        };
        let words = words(&actor.timeline, &actor.topology, graph.feet(), loading.order());
        Ok(Uint32Array::from(words.as_slice()))
    }

    /// The bundle's section of the rig; empty where there is none.
    #[must_use]
    pub fn rig(&self) -> Uint8Array {
        Uint8Array::from(self.inner.loading().rig().unwrap_or_default())
    }

    /// The names of the body's parts, one a line; none where the bundle has none, or what it has makes no sense.
    #[must_use]
    pub fn parts(&self) -> String {
        let parts = BodyParts::of(self.inner.loading()).ok().flatten();
        parts.map_or(String::new(), |parts| parts.names.join("\n"))
    }

    /// The bundle's section of the learned space; empty where there is none.
    #[must_use]
    pub fn learned(&self) -> Uint8Array {
        Uint8Array::from(self.inner.loading().learned().unwrap_or_default())
    }

    /// The bundle's section of families: JSON; empty where there is none, or it has not arrived.
    #[must_use]
    pub fn families(&self) -> Uint8Array {
        Uint8Array::from(self.inner.loading().families().unwrap_or_default())
    }

    /// From now on `positions` stand in for frame `frame`; without any, what was recorded.
    ///
    /// # Errors
    /// There is no such frame, or they are none of this mesh.
    pub fn set_edited(&mut self, frame: u32, positions: &[f32]) -> Result<(), JsValue> {
        let pose: Vec<Vec3> = positions.chunks_exact(3).map(Vec3::from_slice).collect();
        Ok(self.inner.set_edited(frame, (!pose.is_empty()).then_some(pose))?)
    }

    /// The actor goes on from `frame`, at heading, x and z; before that `count` frames are shown that `give` takes.
    ///
    /// # Errors
    /// There is no such frame, or a transition is under way.
    pub fn expect(&mut self, frame: u32, heading: f32, x: f32, z: f32, count: u32) -> Result<(), JsValue> {
        let placement = kernels::align::Placement { heading, translation: glam::Vec2::new(x, z) };
        Ok(self.inner.expect(frame, placement, count)?)
    }

    /// Takes the next frame that is expected, in the world, and the numbers that a `Driver` tells of it. How many frames wait to be
    /// shown, and how many are to come.
    pub fn give(&mut self, positions: &[f32], from: u32, to: u32, lambda: f32, heading: f32) -> Vec<u32> {
        let pose = positions.chunks_exact(3).map(Vec3::from_slice).collect();
        self.inner.give(pose, [from, to], lambda, heading).to_vec()
    }

    /// Positions of `frame` as walks show it: edited where it is, in the place where it was recorded.
    ///
    /// # Errors
    /// It has not arrived.
    pub fn pose_of(&mut self, frame: u32) -> Result<Float32Array, JsValue> {
        Ok(array(&self.inner.pose_of(frame)?))
    }

    /// No frame is edited any more.
    ///
    /// # Errors
    /// A frame that is shown cannot be read.
    pub fn clear_edited(&mut self) -> Result<(), JsValue> {
        Ok(self.inner.clear_edited()?)
    }

    /// Stands still in the recorded frame that is shown: the frame, and its placement as heading, x and z; nothing in a
    /// transition.
    pub fn hold(&mut self) -> Float32Array {
        let held = self.inner.hold().map(|(frame, placement)| {
            let [x, z] = placement.translation.to_array();
            vec![frame as f32, placement.heading, x, z]
        });
        Float32Array::from(held.unwrap_or_default().as_slice())
    }
}
