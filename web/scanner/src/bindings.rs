//! What JavaScript calls.

use wasm_bindgen::prelude::*;

use crate::opened::Opened;

/// A group of scanned frames that was read.
#[wasm_bindgen]
pub struct Scan {
    inner: Opened,
}

#[wasm_bindgen]
impl Scan {
    /// Reads the section `bytes` of the group of which a player's `scan_head` told `words`.
    ///
    /// # Errors
    /// It is none.
    #[wasm_bindgen(constructor)]
    pub fn new(words: &[u32], bytes: &[u8]) -> Result<Self, JsValue> {
        console_error_panic_hook::set_once();
        Opened::read(words, bytes).map(|inner| Self { inner }).map_err(|reason| js_sys::Error::new(reason).into())
    }

    /// Where its images lie in the section: beginning and end of each.
    #[must_use]
    pub fn images(&self) -> Vec<u32> {
        self.inner.images.clone()
    }

    /// Its corners, as the device reads them.
    #[must_use]
    pub fn corners(&self) -> Vec<u8> {
        self.inner.corners.clone()
    }

    /// Its triangles over corners.
    #[must_use]
    pub fn triangles(&self) -> Vec<u32> {
        self.inner.triangles.clone()
    }

    /// How the registered mesh, its `triangles` at `pose`, carries the vertices of frame `frame`: 24 bytes each.
    #[must_use]
    pub fn carried(&self, frame: u32, triangles: &[u32], pose: &[f32]) -> Vec<u8> {
        self.inner.carried(frame, triangles, pose)
    }

    /// Vertex positions of one frame after the other.
    #[must_use]
    pub fn poses(&self) -> Vec<f32> {
        self.inner.poses.clone()
    }
}
