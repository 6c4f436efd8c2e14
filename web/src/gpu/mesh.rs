//! The drawn mesh: corners, parts and materials, the same for every pose; the twin of `shaders/actor.wgsl`.

use actor::surface::{Material, Surface};
use bytemuck::{Pod, Zeroable};
use wgpu::{BufferUsages, ShaderStages};

use super::context::{Gpu, Pass, SAMPLER, TEXTURE, UNIFORM};
use super::texture::Textures;
use crate::shaders;

/// `Material` of `actor.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct MaterialUniform {
    /// Linear light, straight alpha.
    pub base_colour: [f32; 4],
    /// 1 where the colour was captured, 0 where the surface is lit.
    pub captured: f32,
    /// Up to the size that a uniform has.
    pub padding: [f32; 3],
}

/// Colour of a surface that brings none: warm clay, in linear light.
const CLAY: [f32; 4] = [0.56, 0.335, 0.225, 1.0];

/// A corner as it is uploaded; the twin of what the module makes that reads scanned frames.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct DrawnCorner {
    /// Its vertex.
    pub vertex: u32,
    uv: [f32; 2],
    colour: [u8; 4],
    /// Of the body's part; transparent where that is not known.
    part: [u8; 4],
}

const CORNER: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<DrawnCorner>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Uint32, 1 => Float32x2, 2 => Unorm8x4, 3 => Unorm8x4],
};

/// Layout of a pass that only wants to know a corner's vertex.
const VERTEX_ONLY: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<DrawnCorner>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Uint32],
};

/// The vertex buffers of a pass over the mesh that needs no colour.
pub const SHAPE: &[wgpu::VertexBufferLayout<'static>] = &[VERTEX_ONLY];

struct Part {
    indices: std::ops::Range<u32>,
    material: usize,
}

struct DrawnMaterial {
    image: Option<usize>,
    double_sided: bool,
    uniform: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// Triangles over corners.
pub struct Shape {
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
}

impl Shape {
    /// Uploads triangles over `corners`.
    #[must_use]
    pub fn new(gpu: &Gpu, corners: &[DrawnCorner], triangles: &[[u32; 3]]) -> Self {
        Self {
            corners: gpu.buffer_of("reprise.actor.corners", bytemuck::cast_slice(corners), BufferUsages::VERTEX),
            indices: gpu.buffer_of("reprise.actor.triangles", bytemuck::cast_slice(triangles), BufferUsages::INDEX),
            index_count: triangles.len() as u32 * 3,
        }
    }

    /// Draws it with the pipeline that is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.bind(pass);
        pass.draw_indexed(0..self.index_count, 0, 0..1);
    }

    fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

impl Drop for Shape {
    fn drop(&mut self) {
        // The browser's garbage collector would keep the device's memory for a while.
        self.corners.destroy();
        self.indices.destroy();
    }
}

/// What a scanned frame looks like.
pub struct Worn {
    group: wgpu::BindGroup,
    texture: wgpu::Texture,
}

impl Drop for Worn {
    fn drop(&mut self) {
        self.texture.destroy();
    }
}

/// Buffers, materials and pipelines of the mesh.
pub struct Mesh {
    shape: Shape,
    parts: Vec<Part>,
    materials: Vec<DrawnMaterial>,
    layout: wgpu::BindGroupLayout,
    /// Culling back faces, and drawing both sides.
    pipelines: [wgpu::RenderPipeline; 2],
    textures: Textures,
    source: Vec<Material>,
}

impl Mesh {
    /// Uploads `surface`. Textures arrive later, by [`Self::set_image`].
    #[must_use]
    pub fn new(gpu: &Gpu, surface: &Surface, frame: &wgpu::BindGroupLayout, pose: &wgpu::BindGroupLayout) -> Self {
        let layout = gpu.layout("reprise.actor.material_layout", ShaderStages::FRAGMENT, &[UNIFORM, TEXTURE, SAMPLER]);
        let layouts = [frame, pose, &layout];
        let pipelines = [Some(wgpu::Face::Back), None].map(|cull| {
            let pass = Pass::of_picture(gpu, "reprise.actor.pipeline", shaders::ACTOR, &layouts);
            gpu.pipeline(&Pass { vertices: &[CORNER], cull, ..pass })
        });
        let textures = Textures::new(gpu);
        let coloured = surface.corners.iter().any(|corner| corner.colour[..3] != [255; 3]);
        let white = Textures::whole(&textures.white(gpu));
        let materials = surface
            .materials
            .iter()
            .map(|material| {
                let uniform =
                    gpu.buffer("reprise.actor.material", size_of::<MaterialUniform>() as u64, BufferUsages::UNIFORM);
                let bare = MaterialUniform {
                    base_colour: bare_colour(material, coloured),
                    captured: f32::from(u8::from(coloured)),
                    padding: [0.0; 3],
                };
                gpu.queue.write_buffer(&uniform, 0, bytemuck::bytes_of(&bare));
                let group = group(gpu, &layout, &textures, &uniform, &white);
                DrawnMaterial {
                    image: material.image.map(|image| image as usize),
                    double_sided: material.double_sided,
                    uniform,
                    group,
                }
            })
            .collect();
        let corners: Vec<_> = surface.corners.iter().map(|corner| drawn(corner, [0; 4])).collect();
        Self {
            shape: Shape::new(gpu, &corners, &surface.triangles),
            parts: surface.parts.iter().map(|part| drawn_part(part, surface)).collect(),
            materials,
            layout,
            pipelines,
            textures,
            source: surface.materials.clone(),
        }
    }

    /// Takes the texture of image `image`; its materials show it from now on.
    pub fn set_image(&mut self, gpu: &Gpu, image: usize, texture: &wgpu::Texture) {
        for material in 0..self.materials.len() {
            if self.materials[material].image == Some(image) {
                self.set_texture(gpu, material, texture);
            }
        }
    }

    /// Paints material `material` with `texture`; its image no longer counts.
    pub fn paint(&mut self, gpu: &Gpu, material: usize, texture: &wgpu::Texture) {
        if material < self.materials.len() {
            self.materials[material].image = None;
            self.set_texture(gpu, material, texture);
        }
    }

    /// Takes the colour of the body's part for each vertex, in sRGB.
    pub fn paint_parts(&mut self, gpu: &Gpu, surface: &Surface, colour_of: &dyn Fn(u32) -> [u8; 3]) {
        let part = |vertex: u32| {
            let [r, g, b] = colour_of(vertex);
            [r, g, b, 255]
        };
        let corners: Vec<_> = surface.corners.iter().map(|corner| drawn(corner, part(corner.vertex))).collect();
        self.shape = Shape::new(gpu, &corners, &surface.triangles);
    }

    /// Makes textures, and the smaller levels of those made by others.
    #[must_use]
    pub fn textures(&self) -> &Textures {
        &self.textures
    }

    fn set_texture(&mut self, gpu: &Gpu, material: usize, texture: &wgpu::Texture) {
        let view = Textures::whole(texture);
        let (drawn, source) = (&mut self.materials[material], &self.source[material]);
        let uniform = MaterialUniform { base_colour: source.base_colour, captured: 1.0, padding: [0.0; 3] };
        gpu.queue.write_buffer(&drawn.uniform, 0, bytemuck::bytes_of(&uniform));
        drawn.group = group(gpu, &self.layout, &self.textures, &drawn.uniform, &view);
    }

    /// Draws all parts in their materials; group 0 and 1 are set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.shape.bind(pass);
        for part in &self.parts {
            let Some(material) = self.materials.get(part.material) else { continue };
            pass.set_pipeline(&self.pipelines[usize::from(material.double_sided)]);
            pass.set_bind_group(2, &material.group, &[]);
            pass.draw_indexed(part.indices.clone(), 0, 0..1);
        }
    }

    /// The shape, for passes that want no colour.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Draws the whole shape with the pipeline that is set.
    pub fn draw_shape(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.shape.draw(pass);
    }

    /// A look for scanned frames: `texture`, or the colours of vertices, or clay where nothing was `captured`.
    #[must_use]
    pub fn worn(&self, gpu: &Gpu, texture: wgpu::Texture, captured: bool) -> Worn {
        let uniform = MaterialUniform {
            base_colour: if captured { [1.0; 4] } else { CLAY },
            captured: f32::from(u8::from(captured)),
            padding: [0.0; 3],
        };
        let buffer = gpu.buffer_of("reprise.actor.material", bytemuck::bytes_of(&uniform), BufferUsages::UNIFORM);
        let view = Textures::whole(&texture);
        Worn { group: group(gpu, &self.layout, &self.textures, &buffer, &view), texture }
    }

    /// Draws a scanned frame; groups 0 and 1 are set. Both sides are seen, for scans have holes.
    pub fn draw_scan(&self, pass: &mut wgpu::RenderPass<'_>, shape: &Shape, worn: &Worn) {
        pass.set_pipeline(&self.pipelines[1]);
        pass.set_bind_group(2, &worn.group, &[]);
        shape.draw(pass);
    }
}

fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    textures: &Textures,
    uniform: &wgpu::Buffer,
    view: &wgpu::TextureView,
) -> wgpu::BindGroup {
    gpu.group(
        "reprise.actor.material_group",
        layout,
        &[
            uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(view),
            wgpu::BindingResource::Sampler(&textures.sampler),
        ],
    )
}

fn drawn(corner: &actor::surface::Corner, part: [u8; 4]) -> DrawnCorner {
    DrawnCorner { vertex: corner.vertex, uv: corner.uv, colour: corner.colour, part }
}

fn drawn_part(part: &actor::surface::Part, surface: &Surface) -> Part {
    let count = surface.triangles.len() as u32;
    let first = part.first_triangle.min(count);
    let end = part.first_triangle.saturating_add(part.triangle_count).min(count);
    Part { indices: first * 3..end * 3, material: part.material as usize }
}

/// The colour of `material` while it has no texture: its own, or clay where it brings none.
fn bare_colour(material: &Material, coloured: bool) -> [f32; 4] {
    let [r, g, b, _] = material.base_colour;
    let grey = (r - g).abs() < 0.02 && (g - b).abs() < 0.02;
    let textured = material.image.is_some();
    if (grey && r > 0.3 || textured) && !coloured { CLAY } else { material.base_colour }
}
