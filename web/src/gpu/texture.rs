//! Textures of the materials, with mipmaps made on the GPU.

use wgpu::{ShaderStages, TextureFormat, TextureUsages};

use super::context::{Gpu, Pass, SAMPLER, TEXTURE, extent, named, view};
use crate::shaders;

/// Format of the textures: sRGB, so that filtering happens in linear light.
pub const COLOUR: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// Makes textures and their smaller levels.
pub struct Textures {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    level_sampler: wgpu::Sampler,
    /// Sampler of all material textures.
    pub sampler: wgpu::Sampler,
}

impl Textures {
    /// The pipeline that makes levels.
    #[must_use]
    pub fn new(gpu: &Gpu) -> Self {
        let layout = gpu.layout("reprise.mipmap.layout", ShaderStages::FRAGMENT, &[TEXTURE, SAMPLER]);
        let pipeline = gpu.pipeline(&Pass::of_texture("reprise.mipmap.pipeline", shaders::MIPMAP, &[&layout], COLOUR));
        Self {
            pipeline,
            layout,
            level_sampler: gpu.sampler("reprise.mipmap.sampler", wgpu::AddressMode::ClampToEdge, 1),
            sampler: gpu.sampler("reprise.actor.sampler", wgpu::AddressMode::Repeat, 8),
        }
    }

    /// An empty texture of `size` pixels with all its levels, to be filled at level 0 and given to [`Self::fill_levels`].
    #[must_use]
    pub fn create(&self, gpu: &Gpu, size: [u32; 2]) -> wgpu::Texture {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: named("reprise.actor.texture"),
            size: extent(size),
            mip_level_count: level_count(size),
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOUR,
            usage: TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_DST
                | TextureUsages::COPY_SRC
                | TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    }

    /// A single white texel: the texture of materials without one.
    #[must_use]
    pub fn white(&self, gpu: &Gpu) -> wgpu::Texture {
        let texture = self.create(gpu, [1, 1]);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4), rows_per_image: None };
        gpu.queue.write_texture(texture.as_image_copy(), &[255; 4], layout, extent([1, 1]));
        texture
    }

    /// Makes every level of `texture` from the one above it.
    pub fn fill_levels(&self, gpu: &Gpu, texture: &wgpu::Texture) {
        let mut encoder = gpu.encoder("reprise.mipmap.commands");
        let level = |level: u32| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                label: named("reprise.mipmap.level"),
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        };
        for smaller in 1..texture.mip_level_count() {
            let above = level(smaller - 1);
            let group = gpu.group(
                "reprise.mipmap.group",
                &self.layout,
                &[wgpu::BindingResource::TextureView(&above), wgpu::BindingResource::Sampler(&self.level_sampler)],
            );
            let mut pass =
                gpu.pass_into(&mut encoder, "reprise.mipmap.pass", &level(smaller), wgpu::Color::TRANSPARENT);
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        gpu.queue.submit([encoder.finish()]);
    }

    /// The resources of a material's texture in its group.
    #[must_use]
    pub fn whole(texture: &wgpu::Texture) -> wgpu::TextureView {
        view("reprise.actor.texture", texture)
    }
}

/// Levels of a texture down to a single texel.
fn level_count(size: [u32; 2]) -> u32 {
    size[0].max(size[1]).max(1).ilog2() + 1
}

#[cfg(test)]
mod tests {
    use super::level_count;

    #[test]
    fn levels_end_at_one_texel() {
        assert_eq!(level_count([1, 1]), 1);
        assert_eq!(level_count([1024, 512]), 11);
        assert_eq!(level_count([3, 5]), 3);
    }
}
