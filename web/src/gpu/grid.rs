//! The ground: no horizon, a faint grid of one metre, the shadow on it.

use super::context::{Gpu, Pass};
use super::shadow::Shadow;
use crate::shaders;

/// Blending of premultiplied colours over what is there.
pub const OVER: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;
/// No depth test: drawn first, or over everything before it.
pub const PAINT: Option<(wgpu::CompareFunction, bool)> = Some((wgpu::CompareFunction::Always, false));

/// The ground's pipeline.
pub struct Grid {
    pipeline: wgpu::RenderPipeline,
}

impl Grid {
    /// Its shadow comes from `shadow`.
    #[must_use]
    pub fn new(gpu: &Gpu, frame: &wgpu::BindGroupLayout, shadow: &Shadow) -> Self {
        let pipeline = gpu.pipeline(&Pass {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            // Painted first and never tested: feet that sink in by a millimetre stay whole.
            depth: PAINT,
            blend: Some(OVER),
            ..Pass::of_picture(gpu, "reprise.ground.pipeline", shaders::GROUND, &[frame, &shadow.layout])
        });
        Self { pipeline }
    }

    /// Draws the ground; group 0 is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shadow: &Shadow) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &shadow.group, &[]);
        pass.draw(0..4, 0..1);
    }
}
