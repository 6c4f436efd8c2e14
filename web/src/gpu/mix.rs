//! One picture over another in some share: a scanned frame gives way to the registered mesh without a jump.

use wgpu::{BlendComponent, BlendFactor, BlendState, CompareFunction, ShaderStages, TextureUsages};

use super::context::{Gpu, Pass, SAMPLER, TEXTURE, extent, view};
use super::target::Target;
use crate::shaders;

/// A picture that was kept, to be laid over another one.
pub struct Mix {
    size: [u32; 2],
    kept: wgpu::Texture,
    group: wgpu::BindGroup,
    pipeline: wgpu::RenderPipeline,
}

impl Mix {
    /// For pictures of the size of `target`.
    #[must_use]
    pub fn new(gpu: &Gpu, target: &Target) -> Self {
        let layout = gpu.layout("reprise.mix.layout", ShaderStages::FRAGMENT, &[TEXTURE, SAMPLER]);
        let usage = TextureUsages::COPY_DST | TextureUsages::TEXTURE_BINDING;
        let kept = gpu.target("reprise.mix.picture", target.size, gpu.format, 1, usage);
        let sampler = gpu.sampler("reprise.mix.sampler", wgpu::AddressMode::ClampToEdge, 1);
        let picture = view("reprise.mix.picture", &kept);
        let resources = [wgpu::BindingResource::TextureView(&picture), wgpu::BindingResource::Sampler(&sampler)];
        let group = gpu.group("reprise.mix.group", &layout, &resources);
        let share = BlendComponent {
            src_factor: BlendFactor::Constant,
            dst_factor: BlendFactor::OneMinusConstant,
            ..BlendComponent::REPLACE
        };
        let pipeline = gpu.pipeline(&Pass {
            depth: Some((CompareFunction::Always, false)),
            blend: Some(BlendState { color: share, alpha: share }),
            // Covers all of a target with what it samples.
            ..Pass::of_picture(gpu, "reprise.mix.pipeline", shaders::MIPMAP, &[&layout])
        });
        Self { size: target.size, kept, group, pipeline }
    }

    /// Whether it is for pictures of the size of `target`.
    #[must_use]
    pub fn fits(&self, target: &Target) -> bool {
        self.size == target.size
    }

    /// Keeps the picture that was drawn into `target`.
    pub fn keep(&self, encoder: &mut wgpu::CommandEncoder, target: &Target) {
        encoder.copy_texture_to_texture(target.picture.as_image_copy(), self.kept.as_image_copy(), extent(self.size));
    }

    /// Lays `share` of what was kept over the picture.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, share: f32) {
        let share = f64::from(share);
        pass.set_blend_constant(wgpu::Color { r: share, g: share, b: share, a: share });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl Drop for Mix {
    fn drop(&mut self) {
        self.kept.destroy();
    }
}
