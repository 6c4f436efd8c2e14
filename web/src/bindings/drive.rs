//! Driven clips, as more methods of the class `Player`. Their frames come by `set_edited`.

use wasm_bindgen::prelude::*;

use super::player::Player;

#[wasm_bindgen]
impl Player {
    /// Adds a clip of `count` frames that look like the recorded frame `like`: for each of its frames and each foot whether that
    /// stands, and where the actor may go on afterwards, as a `Driver` says. Its first frame.
    ///
    /// # Errors
    /// The actor has not arrived.
    pub fn drive(&mut self, name: &str, count: u32, like: u32, stands: &[u8], exits: &[f32]) -> Result<u32, JsValue> {
        let stands = stands.iter().map(|&stands| stands != 0).collect();
        Ok(self.inner.drive(name, (count, like), stands, exits)?)
    }

    /// Performs the clip that begins with frame `first`: blended in over so many nodes between postures so many radians apart.
    /// Frames: from and to of the way in, from and to of the way back.
    ///
    /// # Errors
    /// The frames of its beginning or of its end have not been made.
    pub fn perform(&mut self, first: u32, nodes: u32, radians: f32) -> Result<Vec<u32>, JsValue> {
        Ok(self.inner.perform(first, nodes, radians)?.to_vec())
    }

    /// Removes the clip that begins with frame `first`.
    ///
    /// # Errors
    /// There is none.
    pub fn undrive(&mut self, first: u32) -> Result<(), JsValue> {
        Ok(self.inner.undrive(first)?)
    }
}
