//! Pictures as bytes for the page.

use js_sys::{Promise, Uint8ClampedArray};
use wasm_bindgen::prelude::*;

use super::Stage;
use crate::bindings::error::{ErrorKind, error};
use crate::bindings::player::Player;
use crate::gpu::readback::read;

#[wasm_bindgen]
impl Stage {
    /// A picture of recorded frame `frame` alone, RGBA with straight alpha on a transparent background.
    ///
    /// # Errors
    /// It has not arrived, or the device is lost.
    #[wasm_bindgen(unchecked_return_type = "Promise<Uint8ClampedArray>")]
    pub fn thumbnail(&mut self, player: &mut Player, frame: u32, width: u32, height: u32) -> Result<Promise, JsValue> {
        self.alive()?;
        let pose = player.inner.recorded_pose(frame)?;
        Ok(pixels_promise(|then| self.thumbnails.draw(&self.scene, &pose, [width, height], then)))
    }

    /// RGBA of the texture that was rebuilt last.
    ///
    /// # Errors
    /// There is none, or the device is lost.
    #[wasm_bindgen(unchecked_return_type = "Promise<Uint8ClampedArray>")]
    pub fn read_texture(&self) -> Result<Promise, JsValue> {
        self.alive()?;
        let missing = || error(ErrorKind::NotLoaded, "the actor's texture has no modes");
        let texture = self.scene.looks[self.textures[1] as usize].as_ref().ok_or_else(missing)?.texture();
        let size = [texture.width(), texture.height()];
        Ok(pixels_promise(|then| read(&self.scene.gpu, texture, size, false, then)))
    }

    /// RGBA of the last picture.
    ///
    /// # Errors
    /// The device is lost.
    #[wasm_bindgen(unchecked_return_type = "Promise<Uint8ClampedArray>")]
    pub fn read_pixels(&self) -> Result<Promise, JsValue> {
        self.alive()?;
        let target = &self.target;
        Ok(pixels_promise(|then| read(&self.scene.gpu, &target.picture, target.size, false, then)))
    }

    fn alive(&self) -> Result<(), JsValue> {
        if self.lost() { Err(error(ErrorKind::DeviceLost, "the graphics device was lost")) } else { Ok(()) }
    }
}

/// RGBA bytes as the page gets them.
fn pixels_promise(start: impl FnOnce(Box<dyn FnOnce(Option<Vec<u8>>)>)) -> Promise {
    let mut start = Some(start);
    Promise::new(&mut |resolve, reject| {
        let then = Box::new(move |bytes: Option<Vec<u8>>| {
            let settled = match bytes {
                Some(bytes) => resolve.call1(&JsValue::NULL, &Uint8ClampedArray::from(bytes.as_slice())),
                None => reject.call1(&JsValue::NULL, &error(ErrorKind::DeviceLost, "the graphics device was lost")),
            };
            // Settling a promise does not throw.
            drop(settled);
        });
        if let Some(start) = start.take() {
            start(then);
        }
    })
}
