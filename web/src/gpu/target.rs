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
            picture: gpu.target("reprise.picture.resolved", size, gpu.format, 1, TextureUsages::COPY_SRC),
            colour: gpu.target("reprise.picture.colour", size, gpu.format, SAMPLES, TextureUsages::empty()),
            depth: gpu.target("reprise.picture.depth", size, DEPTH, SAMPLES, TextureUsages::empty()),
        }
    }

    /// Begins the pass `label`, a picture of colour `clear`.
    pub fn begin<'e>(
        &self,
        gpu: &Gpu,
        encoder: &'e mut wgpu::CommandEncoder,
        label: &'static str,
        clear: wgpu::Color,
    ) -> wgpu::RenderPass<'e> {
        let picture = view("reprise.picture.resolved", &self.picture);
        let colour = view("reprise.picture.colour", &self.colour);
        let depth = view("reprise.picture.depth", &self.depth);
        let colour = wgpu::RenderPassColorAttachment {
            view: &colour,
            depth_slice: None,
            resolve_target: Some(&picture),
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Discard },
        };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        };
        gpu.render_pass(encoder, label, colour, Some(depth))
    }

    /// Copies the picture into `canvas`, of the same size and of the same format but for the sRGB encoding.
    pub fn copy_to(&self, gpu: &Gpu, canvas: &wgpu::Texture) {
        let mut encoder = gpu.encoder("reprise.picture.copy");
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
