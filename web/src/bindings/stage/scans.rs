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

    /// The scanned frames whose colours should flow into each other before they are mixed, both of which are here; none where there is
    /// nothing to do.
    #[must_use]
    pub fn flow_wanted(&self, player: &Player) -> Vec<u32> {
        let wanted = player.inner.scans_flowing().filter(|&ends| {
            let scans = &self.scene.scans;
            places(player, ends).is_some_and(|ends| ends.iter().all(|end| scans.holds(end.0)) && !scans.flows(ends))
        });
        wanted.map_or(Vec::new(), |ends| ends.to_vec())
    }

    /// Takes how frames `from` and `to` flow into each other, as the module found it that reads scanned frames; nothing where they do not.
    pub fn take_flow(&mut self, player: &Player, from: u32, to: u32, flow: &[u8]) {
        if let Some(ends) = places(player, [from, to]) {
            self.scene.scans.take_flow(ends, flow);
        }
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

/// Group and frame of scanned frames.
fn places(player: &Player, frames: [u32; 2]) -> Option<[(u32, u32); 2]> {
    let index = player.inner.scans()?;
    Some([index.place_of(frames[0])?, index.place_of(frames[1])?])
}
