//! The passes `appearance_basis`: a layer's mean and modes, and their sum; the twin of `Layer::rebuild`.

use bytemuck::{Pod, Zeroable};
use texture::basis::{Block, CHROMA, Layer, Mode};
use texture::mask::Mask;
use texture::transform::{AREA, OPPONENT, SIDE, cosines};
use wgpu::{BufferUsages, ShaderStages, TextureFormat, TextureUsages};

use super::bound::{numbers, storage, written};
use crate::gpu::context::{Gpu, STORAGE, UNIFORM, view};
use crate::shaders;

/// Workgroups along the first axis.
pub const ROW: u32 = 32768;
/// Blocks of a workgroup that adds up waves.
pub const GROUP: u32 = 64;
/// Bytes of a block's waves.
const BLOCK_BYTES: u64 = 4 * 3 * AREA as u64;

/// `Layer` of `appearance_basis.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct LayerUniform {
    /// Columns of the matrix from what is stored to colours.
    pub turn: [[f32; 4]; 3],
    /// Stored blocks.
    pub blocks: u32,
    /// Modes, the mean counted.
    pub modes: u32,
    /// Texels along a restored block.
    pub side: u32,
    /// Up to the size that a uniform has.
    pub padding: u32,
}

/// A layer restored at one size.
struct Output {
    uniform: wgpu::Buffer,
    cosines: wgpu::Buffer,
    restored: wgpu::Texture,
    mask: wgpu::TextureView,
    side: u32,
    group: Option<wgpu::BindGroup>,
}

/// A layer's modes on the device.
pub struct Basis {
    layout: wgpu::BindGroupLayout,
    /// `add`, `along_rows`, `along_columns`.
    pipelines: [wgpu::ComputePipeline; 3],
    turn: [[f32; 4]; 3],
    blocks: u32,
    places: wgpu::Buffer,
    offsets: wgpu::Buffer,
    entries: wgpu::Buffer,
    weights: wgpu::Buffer,
    sums: wgpu::Buffer,
    rows: wgpu::Buffer,
    /// Entries and modes that are there.
    filled: u64,
    modes: usize,
    /// Full size, half size.
    outputs: Vec<Output>,
}

/// Columns of the matrix from what is stored to colours, or to warps.
pub fn turn(layer: &Layer) -> [[f32; 4]; 3] {
    if layer.channels < 3 {
        return [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0; 4]];
    }
    let scaled = |channel: usize, scale: f32| {
        let [r, g, b] = OPPONENT[channel].map(|value| value * scale);
        [r, g, b, 0.0]
    };
    [scaled(0, 1.0), scaled(1, CHROMA), scaled(2, CHROMA)]
}

impl Basis {
    /// Without modes yet; `masks` are the textures of `mask`.
    pub fn new(gpu: &Gpu, layer: &Layer, mask: &Mask, masks: &[wgpu::Texture]) -> Self {
        let scratch = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: false },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let output = written(TextureFormat::Rgba16Float);
        let bindings = [UNIFORM, STORAGE, STORAGE, STORAGE, STORAGE, STORAGE, numbers(), output, scratch, scratch];
        let layout = gpu.layout("reprise.basis.layout", ShaderStages::COMPUTE, &bindings);
        let pipeline = |label, entry| gpu.compute(label, shaders::APPEARANCE_BASIS, entry, &layout);
        let pipelines = [
            pipeline("reprise.basis.add", "add"),
            pipeline("reprise.basis.along_rows", "along_rows"),
            pipeline("reprise.basis.along_columns", "along_columns"),
        ];
        // What a device has no room for, in textures of more than some 3,000 texels across, stays as it is.
        let room = gpu.device.limits().max_storage_buffer_binding_size / BLOCK_BYTES;
        let stored = &layer.blocks[..layer.blocks.len().min(room as usize)];
        let place = |(index, block): (usize, &Block)| {
            let scale = layer.scales.get(index).copied().unwrap_or(1.0);
            [u32::from(block.x) | u32::from(block.y) << 16, scale.to_bits()]
        };
        let places: Vec<[u32; 2]> = stored.iter().enumerate().map(place).collect();
        let blocks = places.len() as u32;
        let restored_at = |side: usize| {
            let level = layer.level + usize::from(side < SIDE);
            let own = &mask.levels[level];
            Output {
                uniform: gpu.buffer("reprise.basis.uniform", size_of::<LayerUniform>() as u64, BufferUsages::UNIFORM),
                cosines: gpu.buffer_of(
                    "reprise.basis.cosines",
                    bytemuck::cast_slice(&cosines(side)),
                    BufferUsages::STORAGE,
                ),
                restored: storage(
                    gpu,
                    "reprise.basis.restored",
                    [own.width as u32, own.height as u32],
                    TextureFormat::Rgba16Float,
                    TextureUsages::STORAGE_BINDING,
                ),
                mask: view("reprise.basis.mask", &masks[level]),
                side: side as u32,
                group: None,
            }
        };
        let sizes: &[usize] = if layer.channels == 3 { &[SIDE, SIDE / 2] } else { &[SIDE] };
        Self {
            outputs: sizes.iter().map(|&side| restored_at(side)).collect(),
            layout,
            pipelines,
            turn: turn(layer),
            places: gpu.buffer_of("reprise.basis.places", bytemuck::cast_slice(&places), BufferUsages::STORAGE),
            offsets: gpu.buffer(
                "reprise.basis.offsets",
                u64::from(blocks + 1) * 4 * layer.steps.len() as u64,
                BufferUsages::STORAGE,
            ),
            entries: gpu.buffer("reprise.basis.entries", 1 << 20, BufferUsages::STORAGE | BufferUsages::COPY_SRC),
            sums: gpu.buffer("reprise.basis.sums", u64::from(blocks) * BLOCK_BYTES, BufferUsages::STORAGE),
            rows: gpu.buffer("reprise.basis.rows", u64::from(blocks) * BLOCK_BYTES, BufferUsages::STORAGE),
            weights: gpu.buffer("reprise.basis.weights", 4 * layer.steps.len() as u64, BufferUsages::STORAGE),
            blocks,
            filled: 0,
            modes: 0,
        }
    }

    /// Modes that are there, the mean counted.
    pub fn mode_count(&self) -> usize {
        self.modes
    }

    /// Takes the next mode. One that the device has no room for is passed over.
    pub fn push(&mut self, gpu: &Gpu, mode: &Mode) {
        let length = mode.entries.len() as u64;
        let needed = (self.filled + length) * 4;
        let fits = needed <= gpu.device.limits().max_storage_buffer_binding_size;
        if fits && needed > self.entries.size() {
            let room = (needed * 2).min(gpu.device.limits().max_storage_buffer_binding_size);
            let larger = gpu.buffer("reprise.basis.entries", room, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
            let mut encoder = gpu.encoder("reprise.basis.growth");
            encoder.copy_buffer_to_buffer(&self.entries, 0, &larger, 0, self.filled * 4);
            gpu.queue.submit([encoder.finish()]);
            self.entries = larger;
        }
        let first = self.filled as u32;
        let offsets = mode.offsets.iter().take(self.blocks as usize + 1);
        let offsets: Vec<u32> = offsets.map(|&offset| first + if fits { offset } else { 0 }).collect();
        let at = self.modes as u64 * u64::from(self.blocks + 1) * 4;
        gpu.queue.write_buffer(&self.offsets, at, bytemuck::cast_slice(&offsets));
        if fits {
            gpu.queue.write_buffer(&self.entries, self.filled * 4, bytemuck::cast_slice(&mode.entries));
            self.filled += length;
        }
        self.modes += 1;
        for output in &mut self.outputs {
            let uniform = LayerUniform {
                turn: self.turn,
                blocks: self.blocks,
                modes: self.modes as u32,
                side: output.side,
                padding: 0,
            };
            gpu.queue.write_buffer(&output.uniform, 0, bytemuck::bytes_of(&uniform));
            let restored = view("reprise.basis.restored", &output.restored);
            output.group = Some(gpu.group(
                "reprise.basis.group",
                &self.layout,
                &[
                    output.uniform.as_entire_binding(),
                    output.cosines.as_entire_binding(),
                    self.places.as_entire_binding(),
                    self.offsets.as_entire_binding(),
                    self.entries.as_entire_binding(),
                    self.weights.as_entire_binding(),
                    wgpu::BindingResource::TextureView(&output.mask),
                    wgpu::BindingResource::TextureView(&restored),
                    self.sums.as_entire_binding(),
                    self.rows.as_entire_binding(),
                ],
            ));
        }
    }

    /// Adds up the modes with `weights`, at full or at half the size, in the pass `label`.
    pub fn rebuild(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        label: &'static str,
        weights: &[f32],
        half: bool,
    ) {
        let Some(group) = self.output(half).group.as_ref().filter(|_| self.blocks > 0) else { return };
        let room = self.weights.size() as usize / 4;
        gpu.queue.write_buffer(&self.weights, 0, bytemuck::cast_slice(&weights[..weights.len().min(room)]));
        gpu.clear(encoder, "reprise.basis.clear", &self.sums);
        let mut pass = gpu.compute_pass(encoder, label);
        pass.set_bind_group(0, group, &[]);
        let blocks = [self.blocks.min(ROW), self.blocks.div_ceil(ROW)];
        let groups = [[self.blocks.div_ceil(GROUP), self.modes as u32], blocks, blocks];
        for (pipeline, [across, down]) in self.pipelines.iter().zip(groups) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(across, down, 1);
        }
    }

    /// What [`Self::rebuild`] wrote.
    pub fn restored(&self, half: bool) -> &wgpu::Texture {
        &self.output(half).restored
    }

    /// Texels across and down of what [`Self::rebuild`] writes.
    pub fn size(&self, half: bool) -> [u32; 2] {
        let restored = self.restored(half);
        [restored.width(), restored.height()]
    }

    fn output(&self, half: bool) -> &Output {
        &self.outputs[usize::from(half).min(self.outputs.len() - 1)]
    }
}
