//! What a picture is drawn into: a multisampled colour buffer and depth, resolved into the picture's own view.

use wgpu::TextureUsages;

use super::context::{DEPTH, Gpu, SAMPLES, view};

/// Buffers of one size.
pub struct Target {
    /// Size in pixels.
    pub size: [u32; 2],
    colour: wgpu::Texture,
    depth: wgpu::Texture,
}

impl Target {
    /// Buffers for pictures of `size` pixels.
    #[must_use]
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let size = size.map(|side| side.clamp(1, 8192));
        Self {
            size,
            colour: gpu.target(size, gpu.format, SAMPLES, TextureUsages::empty()),
            depth: gpu.target(size, DEPTH, SAMPLES, TextureUsages::empty()),
        }
    }

    /// Begins a picture of colour `clear`, which ends in `picture`.
    pub fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        picture: &wgpu::TextureView,
        clear: wgpu::Color,
    ) -> wgpu::RenderPass<'e> {
        let (colour, depth) = (view(&self.colour), view(&self.depth));
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &colour,
                depth_slice: None,
                resolve_target: Some(picture),
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Discard },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        // The browser's garbage collector would take its time, and these are the largest buffers.
        self.colour.destroy();
        self.depth.destroy();
    }
}
