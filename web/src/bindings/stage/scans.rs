//! Frames as they were scanned: the page brings groups of them, decoded by the browser.

use wasm_bindgen::prelude::*;
use web_sys::ImageBitmap;

use super::Stage;
use crate::bindings::player::Player;
use crate::gpu::scans::Scan;

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

    /// Takes the next image of the group that [`Self::take_scan`] will take, decoded.
    pub fn add_scan_image(&mut self, bitmap: &ImageBitmap) {
        let texture = self.texture_of(bitmap);
        self.scan_images.extend(texture);
    }

    /// Takes group `ordinal` with the images that were added, as the module hands it over that has read it, `carried` by the registered
    /// mesh (24 bytes a vertex, one frame after the other); whether that could be done.
    /// Those that are not wanted any more go.
    pub fn take_scan(
        &mut self,
        player: &Player,
        ordinal: u32,
        corners: &[u8],
        triangles: &[u32],
        poses: &[f32],
        carried: &[u8],
    ) -> bool {
        let textures = std::mem::take(&mut self.scan_images);
        let head = player.inner.scans().and_then(|index| index.groups.get(ordinal as usize));
        let scan = head.and_then(|head| Scan::new(head, corners, triangles, poses, carried));
        let Some(scan) = scan.filter(|scan| scan.worn.iter().all(|&image| (image as usize) < textures.len())) else {
            return false;
        };
        let (scene, wanted) = (&mut self.scene, player.inner.scans_ahead());
        // What is shown without it gives way little by little.
        let late = player.inner.scan().into_iter().flatten().any(|scan| scan.place.0 == ordinal);
        scene.scans.take(&scene.gpu, &scene.mesh, (ordinal, scan), textures, (&wanted, late));
        self.due = true;
        true
    }

    /// How much of the last picture's actor came from scanned frames, from 0 to 1; the rest was the registered mesh.
    #[must_use]
    pub fn scan_shown(&self) -> f32 {
        self.scene.scans.share()
    }

    /// Whether the registered mesh carried what came from scanned frames in the last picture.
    #[must_use]
    pub fn scan_carried(&self) -> bool {
        self.scene.scans.is_carried()
    }
}
