//! The actor's texture, rebuilt from its modes whenever their coefficients change.
//!
//! `basis` adds up modes, `dealign` moves what they give by the warp, `pace` chooses how much of that the device can do in
//! time. One rebuild is under way at a time: a slow device shows a texture that lags, not a page that does.

pub mod basis;
mod bound;
pub mod dealign;
mod pace;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bundle::Appearance;
use texture::basis::Mode;
use texture::transform::AREA;
use wgpu::TextureFormat;

use self::basis::Basis;
use self::bound::storage;
use self::dealign::{Dealign, Motion};
use self::pace::Pace;
pub use self::pace::Setting;
use super::context::{Gpu, extent};
use super::mesh::Mesh;
use super::texture::Textures;

/// Coefficients of a moment, as weights of each layer's steps.
pub type Weights = [Vec<f32>; 2];

/// What the texture should show.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// Coefficients interpolated: colours and warps of one texture.
    Interpolated(Weights),
    /// The textures of two frames, the second one over the first as much as this says: what linear blending gives.
    CrossFaded(Weights, Weights, f32),
}

/// The rebuilt texture of one material.
pub struct TextureRebuild {
    appearance: Appearance,
    layers: [Basis; 2],
    dealign: Dealign,
    /// The finished texture, with all its levels.
    texture: wgpu::Texture,
    /// Colour of places that no mode knows.
    fill: [f32; 3],
    pace: Pace,
    now: fn() -> f64,
    shown: Option<(Wanted, [usize; 2], Setting)>,
    /// When the rebuild under way began, and the bits of when it was done; 0 before that.
    under_way: Option<(f64, Arc<AtomicU64>)>,
}

impl TextureRebuild {
    /// Without modes yet. `slow` is true for a device without a GPU, `now` tells milliseconds.
    #[must_use]
    pub fn new(gpu: &Gpu, appearance: &Appearance, textures: &Textures, slow: bool, now: fn() -> f64) -> Self {
        let mask = &appearance.mask;
        let masks: Vec<wgpu::Texture> = mask.levels.iter().map(|level| flags(gpu, level)).collect();
        let texture = textures.create(gpu, [1, 1]);
        Self {
            layers: [0, 1].map(|layer| Basis::new(gpu, &appearance.layers[layer], mask, &masks)),
            dealign: Dealign::new(gpu, mask, masks),
            texture,
            fill: [0.5; 3],
            pace: Pace::new(slow),
            now,
            shown: None,
            under_way: None,
            appearance: appearance.clone(),
        }
    }

    /// The finished texture.
    #[must_use]
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// What the device manages.
    #[must_use]
    pub fn setting(&self) -> Setting {
        self.pace.setting()
    }

    /// Keeps to `setting`, however long it takes; `None` chooses again.
    pub fn keep(&mut self, setting: Option<Setting>) {
        self.pace.keep(setting);
    }

    /// Takes the modes that are new.
    pub fn take(&mut self, gpu: &Gpu, modes: &[Vec<Mode>; 2]) {
        for (layer, modes) in self.layers.iter_mut().zip(modes) {
            for mode in modes.iter().skip(layer.mode_count()) {
                layer.push(gpu, mode);
            }
        }
        if let (Some(mean), true) = (modes[0].first(), self.fill == [0.5; 3]) {
            self.fill = mean_colour(&self.appearance, mean);
        }
    }

    /// Rebuilds the texture, with which `mesh` is painted, where it shows something else than `wanted`; unless the last
    /// rebuild is still under way. True where the texture changed.
    pub fn show(&mut self, gpu: &Gpu, mesh: &mut Mesh, wanted: Wanted) -> bool {
        if let Some((start, done)) = &self.under_way {
            let done = f64::from_bits(done.load(Ordering::Relaxed));
            if done == 0.0 {
                return false;
            }
            self.pace.note(done - start);
            self.under_way = None;
        }
        let counts = [0, 1].map(|layer| self.layers[layer].mode_count());
        let setting = self.pace.setting();
        let wanted = (wanted, counts, setting);
        if self.shown.as_ref() == Some(&wanted) || counts[0] == 0 {
            return false;
        }
        let size = self.layers[0].size(setting == Setting::Half);
        let same = [self.texture.width(), self.texture.height()] == size;
        if !same {
            self.texture = mesh.textures().create(gpu, size);
        }
        if !same || self.shown.is_none() {
            mesh.paint(gpu, self.appearance.material as usize, &self.texture);
        }
        match &wanted.0 {
            Wanted::Interpolated(weights) => self.rebuild(gpu, weights, 1.0, setting),
            Wanted::CrossFaded(from, to, lambda) => {
                self.rebuild(gpu, from, 1.0, setting);
                self.rebuild(gpu, to, *lambda, setting);
            }
        }
        mesh.textures().fill_levels(gpu, &self.texture);
        let now = self.now;
        let done = Arc::new(AtomicU64::new(0));
        let told = Arc::clone(&done);
        gpu.queue.on_submitted_work_done(move || told.store(now().to_bits(), Ordering::Relaxed));
        self.under_way = Some((now(), done));
        self.shown = Some(wanted);
        true
    }

    /// Another texture is on the mesh now: the next one shown is painted on it anew.
    pub fn take_off(&mut self) {
        self.shown = None;
    }

    /// Whether a rebuild is under way, so that the picture may have to be brought up to date.
    #[must_use]
    pub fn busy(&self) -> bool {
        self.under_way.is_some()
    }

    fn rebuild(&mut self, gpu: &Gpu, weights: &Weights, opacity: f32, setting: Setting) {
        let mut encoder = gpu.encoder("reprise.texture.commands");
        let half = setting == Setting::Half;
        self.layers[0].rebuild(gpu, &mut encoder, "reprise.basis.colours", &weights[0], half);
        self.layers[1].rebuild(gpu, &mut encoder, "reprise.basis.warps", &weights[1], false);
        let sources = [self.layers[0].restored(half), self.layers[1].restored(false)];
        let [r, g, b] = self.fill;
        let motion = Motion {
            fill: [r, g, b, opacity],
            texel: if half { 2.0 } else { 1.0 },
            cell: (1 << self.appearance.layers[1].level) as f32,
            padding: [0.0; 2],
        };
        self.dealign.run(gpu, &mut encoder, sources, &self.texture, motion, setting == Setting::Poisson);
        gpu.queue.submit([encoder.finish()]);
    }
}

/// A mask's level as a texture.
fn flags(gpu: &Gpu, level: &texture::mask::Level) -> wgpu::Texture {
    let size = [level.width as u32, level.height as u32];
    let texture = storage(gpu, "reprise.cycle.mask", size, TextureFormat::R8Uint, wgpu::TextureUsages::COPY_DST);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size[0]), rows_per_image: None };
    gpu.queue.write_texture(texture.as_image_copy(), &level.flags, layout, extent(size));
    texture
}

fn mean_colour(appearance: &Appearance, mean: &Mode) -> [f32; 3] {
    let layer = &appearance.layers[0];
    let mut sums = [0.0; 3];
    for entry in mean.entries.iter().filter(|entry| ((**entry & 0xffff) as usize).is_multiple_of(AREA)) {
        sums[((entry & 0xffff) as usize / AREA).min(2)] += (*entry as i32 >> 16) as f32;
    }
    // The constant wave of a block is its mean times the block's side.
    let scale = layer.steps.first().copied().unwrap_or(0.0) / (16.0 * layer.blocks.len().max(1) as f32);
    let columns = basis::turn(layer);
    [0, 1, 2].map(|colour| (0..3).map(|channel| sums[channel] * columns[channel][colour] * scale).sum())
}
