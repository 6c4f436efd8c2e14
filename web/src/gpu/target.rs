//! What a picture is drawn into: a multisampled colour buffer and depth, resolved into a texture of its own.
//!
//! The canvas gets a copy: drawing through an sRGB view of the canvas itself left its colours unencoded in Chromium.

use wgpu::TextureUsages;

use super::context::{DEPTH, Gpu, SAMPLES, extent, view};

/// Buffers of one size.
pub struct Target {
    /// Size in pixels.
    pub size: [u32; 2],
    /// The picture that was drawn last.
    pub picture: wgpu::Texture,
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
            picture: gpu.target(size, gpu.format, 1, TextureUsages::COPY_SRC),
            colour: gpu.target(size, gpu.format, SAMPLES, TextureUsages::empty()),
            depth: gpu.target(size, DEPTH, SAMPLES, TextureUsages::empty()),
        }
    }

    /// Begins a picture of colour `clear`.
    pub fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, clear: wgpu::Color) -> wgpu::RenderPass<'e> {
        let (picture, colour, depth) = (view(&self.picture), view(&self.colour), view(&self.depth));
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &colour,
                depth_slice: None,
                resolve_target: Some(&picture),
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

    /// Copies the picture into `canvas`, of the same size and of the same format but for the sRGB encoding.
    pub fn copy_to(&self, gpu: &Gpu, canvas: &wgpu::Texture) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let (from, to) = (self.picture.as_image_copy(), canvas.as_image_copy());
        encoder.copy_texture_to_texture(from, to, extent(self.size));
        gpu.queue.submit([encoder.finish()]);
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        // The browser's garbage collector would take its time, and these are the largest buffers.
        self.picture.destroy();
        self.colour.destroy();
        self.depth.destroy();
    }
}
