//! Draws the path walked so far; the twin of `shaders/trail.wgsl`.

use wgpu::BufferUsages;

use super::context::{Gpu, Pass};
use super::grid::{OVER, PAINT};
use crate::shaders;
use crate::trail::RibbonCorner;

const CORNER: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<RibbonCorner>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32, 2 => Float32, 3 => Float32],
};

/// The ribbon's pipeline and its buffer.
pub struct Trail {
    pipeline: wgpu::RenderPipeline,
    corners: wgpu::Buffer,
    count: u32,
}

impl Trail {
    /// Empty.
    #[must_use]
    pub fn new(gpu: &Gpu, frame: &wgpu::BindGroupLayout) -> Self {
        let pipeline = gpu.pipeline(&Pass {
            vertices: &[CORNER],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            depth: PAINT,
            blend: Some(OVER),
            ..Pass::of_picture(gpu, "reprise.trail.pipeline", shaders::TRAIL, &[frame])
        });
        Self { pipeline, corners: gpu.buffer("reprise.trail.corners", 4096, BufferUsages::VERTEX), count: 0 }
    }

    /// Uploads `strip`.
    pub fn write(&mut self, gpu: &Gpu, strip: &[RibbonCorner]) {
        let bytes: &[u8] = bytemuck::cast_slice(strip);
        if bytes.len() as u64 > self.corners.size() {
            self.corners = gpu.buffer("reprise.trail.corners", bytes.len() as u64 * 2, BufferUsages::VERTEX);
        }
        gpu.queue.write_buffer(&self.corners, 0, bytes);
        self.count = strip.len() as u32;
    }

    /// Draws it; group 0 is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.count > 2 {
            pass.set_pipeline(&self.pipeline);
            pass.set_vertex_buffer(0, self.corners.slice(..));
            pass.draw(0..self.count, 0..1);
        }
    }
}
