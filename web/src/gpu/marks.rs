//! Draws what the page's tools mark on the ground; the twin of `shaders/marks.wgsl`.

use bytemuck::{Pod, Zeroable};
use wgpu::BufferUsages;

use super::context::{Gpu, Pass};
use super::grid::{OVER, PAINT};
use crate::shaders;

/// A corner of a triangle, as the page writes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct MarkCorner {
    /// Place on the ground (X, Z), metres.
    pub ground: [f32; 2],
    /// sRGB and opacity.
    pub colour: [u8; 4],
}

const CORNER: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<MarkCorner>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Unorm8x4],
};

/// Most corners that are drawn: a page that draws more has gone wrong.
pub const MOST: usize = 1 << 17;

/// The marks' pipeline and their buffer.
pub struct Marks {
    pipeline: wgpu::RenderPipeline,
    corners: wgpu::Buffer,
    count: u32,
}

impl Marks {
    /// None.
    #[must_use]
    pub fn new(gpu: &Gpu, frame: &wgpu::BindGroupLayout) -> Self {
        let pipeline = gpu.pipeline(&Pass {
            vertices: &[CORNER],
            topology: wgpu::PrimitiveTopology::TriangleList,
            depth: PAINT,
            blend: Some(OVER),
            ..Pass::of_picture(gpu, "reprise.marks.pipeline", shaders::MARKS, &[frame])
        });
        Self { pipeline, corners: gpu.buffer("reprise.marks.corners", 4096, BufferUsages::VERTEX), count: 0 }
    }

    /// Uploads triangles: 12 bytes a corner as in [`MarkCorner`], later ones over earlier ones; an incomplete triangle
    /// at the end is left out.
    pub fn write(&mut self, gpu: &Gpu, bytes: &[u8]) {
        let triangles = (bytes.len() / (3 * size_of::<MarkCorner>())).min(MOST / 3);
        let bytes = bytes.get(..triangles * 3 * size_of::<MarkCorner>()).unwrap_or_default();
        if bytes.len() as u64 > self.corners.size() {
            self.corners = gpu.buffer("reprise.marks.corners", bytes.len() as u64 * 2, BufferUsages::VERTEX);
        }
        gpu.queue.write_buffer(&self.corners, 0, bytes);
        self.count = triangles as u32 * 3;
    }

    /// Draws them; group 0 is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.count > 0 {
            pass.set_pipeline(&self.pipeline);
            pass.set_vertex_buffer(0, self.corners.slice(..));
            pass.draw(0..self.count, 0..1);
        }
    }
}
