//! The passes that move the aligned texture by the warp: `appearance_residual`, `appearance_cycle`, `appearance_texture`;
//! the twin of `Aligned::dealign`.

use bytemuck::{Pod, Zeroable};
use texture::mask::{LEVELS, Mask};
use wgpu::{BufferUsages, ShaderStages, TextureFormat, TextureUsages};

use super::bound::{numbers, storage, unfiltered, written};
use crate::gpu::context::{Gpu, Pass, UNIFORM, named, view};
use crate::gpu::texture::COLOUR;
use crate::shaders;

/// `Move` of `appearance_move.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct Motion {
    /// Colour where nothing is known, and how much the result covers what was drawn before.
    pub fill: [f32; 4],
    /// Texels of the full size along a texel of the aligned texture.
    pub texel: f32,
    /// Texels of the full size along a texel of the warp.
    pub cell: f32,
    /// Up to the size that a uniform has.
    pub padding: [f32; 2],
}

/// Texels along a workgroup.
pub const TILE: u32 = 8;
/// Format of complex numbers, packed.
const COMPLEX: TextureFormat = TextureFormat::Rgba32Uint;

/// Label of what stands for no correction.
const NONE: &str = "reprise.cycle.none";

/// Textures and groups of the multigrid cycle.
struct Cycle {
    down: Vec<wgpu::BindGroup>,
    up: Vec<wgpu::BindGroup>,
    right: wgpu::TextureView,
    solution: wgpu::TextureView,
}

/// Pipelines, and what they keep between frames.
pub struct Dealign {
    motion: wgpu::Buffer,
    residual_layout: wgpu::BindGroupLayout,
    residual: wgpu::ComputePipeline,
    cycle_layout: wgpu::BindGroupLayout,
    ways: [wgpu::ComputePipeline; 2],
    texture_layout: wgpu::BindGroupLayout,
    texture: wgpu::RenderPipeline,
    /// No correction: outside of a single texel there is nothing to add.
    none: wgpu::TextureView,
    sizes: Vec<[u32; 2]>,
    masks: Vec<wgpu::TextureView>,
    /// Made when it is first wanted: a slow device never needs its memory.
    cycle: Option<Cycle>,
}

impl Dealign {
    /// For textures of which `mask` says what is active, with the same as textures.
    pub fn new(gpu: &Gpu, mask: &Mask, masks: Vec<wgpu::Texture>) -> Self {
        let field = unfiltered(wgpu::TextureSampleType::Float { filterable: false });
        let residual_layout = gpu.layout(
            "reprise.residual.layout",
            ShaderStages::COMPUTE,
            &[UNIFORM, field, field, numbers(), written(COMPLEX)],
        );
        let cycle_bindings = [UNIFORM, numbers(), numbers(), numbers(), numbers(), written(COMPLEX)];
        let cycle_layout = gpu.layout("reprise.cycle.layout", ShaderStages::COMPUTE, &cycle_bindings);
        let texture_layout =
            gpu.layout("reprise.texture.layout", ShaderStages::FRAGMENT, &[UNIFORM, field, field, numbers()]);
        let texture = gpu.pipeline(&Pass {
            // A second frame is drawn over the first; its alpha keeps the texture opaque.
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            ..Pass::of_texture("reprise.texture.pipeline", shaders::APPEARANCE_TEXTURE, &[&texture_layout], COLOUR)
        });
        Self {
            motion: gpu.buffer("reprise.texture.motion", size_of::<Motion>() as u64, BufferUsages::UNIFORM),
            residual: gpu.compute("reprise.residual.pipeline", shaders::APPEARANCE_RESIDUAL, "main", &residual_layout),
            residual_layout,
            ways: [
                gpu.compute("reprise.cycle.down", shaders::APPEARANCE_CYCLE, "down", &cycle_layout),
                gpu.compute("reprise.cycle.up", shaders::APPEARANCE_CYCLE, "up", &cycle_layout),
            ],
            cycle_layout,
            texture,
            texture_layout,
            none: view(NONE, &storage(gpu, NONE, [1, 1], COMPLEX, TextureUsages::COPY_DST)),
            sizes: mask.levels.iter().map(|level| [level.width as u32, level.height as u32]).collect(),
            masks: masks.iter().map(|mask| view("reprise.cycle.mask", mask)).collect(),
            cycle: None,
        }
    }

    /// Moves the texture `sources[0]` by the warp `sources[1]` into `target`, over what is there as far as its opacity says;
    /// with its gradients, or directly.
    pub fn run(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        sources: [&wgpu::Texture; 2],
        target: &wgpu::Texture,
        motion: Motion,
        gradients: bool,
    ) {
        gpu.queue.write_buffer(&self.motion, 0, bytemuck::bytes_of(&motion));
        let sources = sources.map(|source| view("reprise.basis.restored", source));
        let [aligned, warp] = [0, 1].map(|source: usize| wgpu::BindingResource::TextureView(&sources[source]));
        if gradients {
            let cycle = self.cycle.take().unwrap_or_else(|| self.make_cycle(gpu));
            let group = gpu.group(
                "reprise.residual.group",
                &self.residual_layout,
                &[
                    self.motion.as_entire_binding(),
                    aligned.clone(),
                    warp.clone(),
                    wgpu::BindingResource::TextureView(&self.masks[0]),
                    wgpu::BindingResource::TextureView(&cycle.right),
                ],
            );
            self.solve(gpu, encoder, &group, &cycle);
            self.cycle = Some(cycle);
        }
        let solution = self.cycle.as_ref().filter(|_| gradients);
        let correction = solution.map_or(&self.none, |cycle| &cycle.solution);
        let correction = wgpu::BindingResource::TextureView(correction);
        let group = gpu.group(
            "reprise.texture.group",
            &self.texture_layout,
            &[self.motion.as_entire_binding(), aligned, warp, correction],
        );
        let level = target.create_view(&wgpu::TextureViewDescriptor {
            label: named("reprise.texture.level"),
            mip_level_count: Some(1),
            ..Default::default()
        });
        let load = if motion.fill[3] < 1.0 { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
        let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
        let colour = wgpu::RenderPassColorAttachment { view: &level, depth_slice: None, resolve_target: None, ops };
        let mut pass = gpu.render_pass(encoder, "reprise.texture.pass", colour, None);
        pass.set_pipeline(&self.texture);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }

    fn solve(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, residual: &wgpu::BindGroup, cycle: &Cycle) {
        let mut pass = gpu.compute_pass(encoder, "reprise.cycle.pass");
        let mut run = |pipeline: &wgpu::ComputePipeline, group: &wgpu::BindGroup, level: usize| {
            let [width, height] = self.sizes[level].map(|side| side.div_ceil(TILE));
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(width, height, 1);
        };
        run(&self.residual, residual, 0);
        for (level, group) in cycle.down.iter().enumerate() {
            run(&self.ways[0], group, level + 1);
        }
        for (level, group) in cycle.up.iter().enumerate().rev() {
            run(&self.ways[1], group, level);
        }
    }

    fn make_cycle(&self, gpu: &Gpu) -> Cycle {
        let fields = |label| -> Vec<_> {
            let field = |size: &[u32; 2]| storage(gpu, label, *size, COMPLEX, TextureUsages::STORAGE_BINDING);
            self.sizes.iter().map(|size| view(label, &field(size))).collect()
        };
        let [rights, solutions] = ["reprise.cycle.right", "reprise.cycle.solution"].map(fields);
        let group = |level: usize, below: &wgpu::TextureView, written: &wgpu::TextureView| {
            let last = u32::from(level + 1 == LEVELS);
            let uniform = [0.25_f32.powi(level as i32).to_bits(), last];
            let uniform = gpu.buffer_of("reprise.cycle.uniform", bytemuck::cast_slice(&uniform), BufferUsages::UNIFORM);
            let smaller = &self.masks[(level + 1).min(LEVELS - 1)];
            let [mask, right, smaller, below, written] =
                [&self.masks[level], &rights[level], smaller, below, written].map(wgpu::BindingResource::TextureView);
            gpu.group(
                "reprise.cycle.group",
                &self.cycle_layout,
                &[uniform.as_entire_binding(), mask, right, smaller, below, written],
            )
        };
        Cycle {
            down: (0..LEVELS - 1).map(|level| group(level, &self.none, &rights[level + 1])).collect(),
            up: (0..LEVELS)
                .map(|level| group(level, solutions.get(level + 1).unwrap_or(&self.none), &solutions[level]))
                .collect(),
            right: rights[0].clone(),
            solution: solutions[0].clone(),
        }
    }
}
