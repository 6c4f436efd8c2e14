//! Frames as they were scanned, for the page that fetches them.

use wasm_bindgen::prelude::*;

use super::error::bundle_error;
use super::player::Player;

#[wasm_bindgen]
impl Player {
    /// The first byte in the bundle and the bytes of group `ordinal` of scanned frames; empty where there is none. Those of the first
    /// one lie where all else ends.
    #[must_use]
    pub fn scan_section(&self, ordinal: u32) -> Vec<u32> {
        // A bundle has less than 4 GiB.
        self.inner.scan_section(ordinal).map_or(Vec::new(), |(start, length)| vec![start as u32, length as u32])
    }

    /// Triangles of the registered mesh, which carries scanned frames.
    #[must_use]
    pub fn carrier(&self) -> Vec<u32> {
        let actor = self.inner.actor();
        actor.map_or(Vec::new(), |actor| actor.topology.triangles().as_flattened().to_vec())
    }

    /// What the index tells of group `ordinal`, for the module that reads the `bytes` of its section.
    ///
    /// # Errors
    /// The bytes are not that section, or are damaged.
    pub fn scan_head(&self, ordinal: u32, bytes: &[u8]) -> Result<Vec<u32>, JsValue> {
        self.inner.scan_head(ordinal, bytes).map_err(bundle_error)
    }
}
