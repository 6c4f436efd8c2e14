//! What the actor wears: textures as they were decoded, rebuilt from modes, or captured.

use bundle::Textures;
use wasm_bindgen::prelude::*;
use web_sys::ImageBitmap;

use super::Stage;
use crate::bindings::player::Player;
use crate::gpu::appearance::{Setting, TextureRebuild, Wanted};
use crate::gpu::context::{Gpu, extent};
use crate::gpu::mesh::Mesh;
use searcher::page::now;

#[wasm_bindgen]
impl Stage {
    /// Brings the actor's texture up to what the player shows; true where it may have to be asked again.
    pub fn dress(&mut self, player: &Player) -> bool {
        // What has not arrived is not worn: the aligned ones come first.
        let of = self.textures[0];
        let of = if player.inner.modes(of)[0].is_empty() { Textures::Aligned } else { of };
        let (Some(appearance), Some(picture)) = (player.inner.appearance(of), player.inner.picture()) else {
            return false;
        };
        if self.lost() || self.original {
            return false;
        }
        let (scene, slow) = (&mut self.scene, self.adapter.device_type == wgpu::DeviceType::Cpu);
        let looks = scene.looks[of as usize]
            .get_or_insert_with(|| TextureRebuild::new(&scene.gpu, appearance, scene.mesh.textures(), slow, now));
        if std::mem::replace(&mut self.textures[1], of) != of {
            looks.take_off();
        }
        looks.take(&scene.gpu, player.inner.modes(of));
        let layers = &appearance.layers;
        let wanted = if self.cross_fade {
            let [(colours, lambda), (warps, _)] = [0, 1].map(|layer| picture.ends(&layers[layer]));
            let [[a, b], [c, d]] = [colours, warps];
            Wanted::CrossFaded([a, c], [b, d], lambda)
        } else {
            Wanted::Interpolated([0, 1].map(|layer| picture.weights(&layers[layer])))
        };
        self.due |= looks.show(&scene.gpu, &mut scene.mesh, wanted);
        looks.busy()
    }

    /// How the texture is rebuilt: `half`, `direct` or `poisson`; nothing where it is not. Given a word, it stays so;
    /// with any other the device's speed decides.
    pub fn texture_setting(&mut self, wanted: Option<String>) -> Option<String> {
        let looks = self.scene.looks[self.textures[1] as usize].as_mut()?;
        if let Some(wanted) = wanted {
            looks.keep(Setting::ALL.into_iter().find(|setting| setting.word() == wanted));
        }
        Some(looks.setting().word().into())
    }

    /// Takes texture `index`, decoded by the browser.
    pub fn set_image(&mut self, index: usize, bitmap: ImageBitmap) {
        self.take_image(&bitmap, |mesh, gpu, texture| mesh.set_image(gpu, index, texture));
    }

    /// Shows a texture as captured in place of what is rebuilt from modes; without one, what is rebuilt again.
    pub fn set_original(&mut self, player: &Player, bitmap: Option<ImageBitmap>) {
        self.original = false;
        if let (Some(bitmap), Some(appearance)) = (&bitmap, player.inner.appearance(Textures::Aligned)) {
            let material = appearance.material as usize;
            self.original = self.take_image(bitmap, |mesh, gpu, texture| mesh.paint(gpu, material, texture));
        }
        self.scene.looks.iter_mut().flatten().for_each(TextureRebuild::take_off);
    }

    /// Makes a texture of `bitmap` for the mesh; whether that could be done.
    fn take_image(&mut self, bitmap: &ImageBitmap, put: impl FnOnce(&mut Mesh, &Gpu, &wgpu::Texture)) -> bool {
        let Some(texture) = self.texture_of(bitmap) else { return false };
        put(&mut self.scene.mesh, &self.scene.gpu, &texture);
        self.due = true;
        true
    }

    /// A texture of `bitmap` with all its levels; `None` where that cannot be done.
    pub(super) fn texture_of(&self, bitmap: &ImageBitmap) -> Option<wgpu::Texture> {
        let size = [bitmap.width(), bitmap.height()];
        if self.lost() || size.contains(&0) || size.iter().any(|&side| side > 8192) {
            return None;
        }
        let gpu = &self.scene.gpu;
        let texture = self.scene.mesh.textures().create(gpu, size);
        let source = wgpu::CopyExternalImageSourceInfo {
            source: wgpu::ExternalImageSource::ImageBitmap(bitmap.clone()),
            origin: wgpu::Origin2d::ZERO,
            flip_y: false,
        };
        let destination = wgpu::CopyExternalImageDestInfo {
            texture: &texture,
            mip_level: 0,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
            color_space: wgpu::PredefinedColorSpace::Srgb,
            premultiplied_alpha: false,
        };
        gpu.queue.copy_external_image_to_texture(&source, destination, extent(size));
        self.scene.mesh.textures().fill_levels(gpu, &texture);
        Some(texture)
    }
}
