//! Frames as they were scanned: the page brings groups of them, decoded by the browser.

use js_sys::Array;
use wasm_bindgen::prelude::*;
use web_sys::ImageBitmap;

use super::Stage;
use crate::bindings::player::Player;

#[wasm_bindgen]
impl Stage {
    /// The groups that are wanted and not here, the most urgent first.
    #[must_use]
    pub fn scans_wanted(&self, player: &Player) -> Vec<u32> {
        if self.lost() || self.template {
            return Vec::new();
        }
        let scans = &self.scene.scans;
        player.inner.scans_ahead().into_iter().filter(|&group| !scans.holds(group)).collect()
    }

    /// Takes group `ordinal` from the `bytes` of its section, with its images decoded; whether that could be done. Those that are not
    /// wanted any more go.
    pub fn take_scan(&mut self, player: &Player, ordinal: u32, bytes: &[u8], bitmaps: &Array) -> bool {
        let group = player.inner.scans().and_then(|index| index.read(ordinal, bytes).ok());
        let Some(group) = group.filter(|_| !self.lost()) else { return false };
        let bitmaps = bitmaps.iter().filter_map(|bitmap| bitmap.dyn_into::<ImageBitmap>().ok());
        let textures: Vec<wgpu::Texture> = bitmaps.filter_map(|bitmap| self.texture_of(&bitmap)).collect();
        if group.worn.iter().any(|&image| image as usize >= textures.len()) {
            return false;
        }
        let (scene, wanted) = (&mut self.scene, player.inner.scans_ahead());
        scene.scans.take(&scene.gpu, &scene.mesh, (ordinal, group), textures, &wanted);
        self.due = true;
        true
    }

    /// Whether the last picture showed a frame as it was scanned.
    #[must_use]
    pub fn shows_scan(&self) -> bool {
        self.scene.scans.drawn().is_some()
    }
}
