//! Group 0 of the picture's passes: camera, ground and theme; the twin of `shaders/frame.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use kernels::srgb::linear_from_srgb;
use wgpu::{BufferUsages, ShaderStages};

use super::context::{Gpu, UNIFORM};
use crate::camera::View;

/// `Frame` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct FrameUniform {
    /// Projection times view.
    pub clip_from_world: [f32; 16],
    /// The eye, metres.
    pub eye: [f32; 3],
    /// Height of the ground, metres.
    pub ground: f32,
    /// Direction towards the key light.
    pub key: [f32; 3],
    /// Radius in metres within which the ground is seen.
    pub reach: f32,
    /// Point (X, Z) around which the ground fades.
    pub focus: [f32; 2],
    /// Lower corner (X, Z) of the shadow's square.
    pub shadow_origin: [f32; 2],
    /// Its side, metres.
    pub shadow_size: f32,
    /// 1 as it is, 0 without.
    pub shadow_strength: f32,
    /// 1 with the grid, 0 without.
    pub grid: f32,
    /// 1 where the theme is dark.
    pub dark: f32,
    /// Background, linear light.
    pub background: [f32; 4],
    /// The ground beneath the actor; its alpha is how much it covers.
    pub floor: [f32; 4],
    /// The grid's lines.
    pub line: [f32; 4],
    /// Ghosts.
    pub accent: [f32; 4],
    /// Recorded frames.
    pub recorded: [f32; 4],
    /// Synthetic frames.
    pub synthetic: [f32; 4],
}

/// How the page looks, as the user or the page chose it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Dark or light.
    pub dark: bool,
    /// Whether the actor is tinted by recorded and synthetic.
    pub tint: bool,
    /// Whether the parts of the body have their colours, once they are known.
    pub parts: bool,
    /// Whether the grid is drawn.
    pub grid: bool,
    /// Whether the path walked so far is drawn.
    pub path: bool,
    /// Colour of the background in sRGB, 0 to 1, in place of the theme's.
    pub background: Option<[f32; 3]>,
}

impl Default for Look {
    fn default() -> Self {
        Self { dark: false, tint: false, parts: false, grid: true, path: true, background: None }
    }
}

impl Look {
    /// Background in linear light.
    #[must_use]
    pub fn clear(&self) -> wgpu::Color {
        let [r, g, b, _] = self.background().map(f64::from);
        wgpu::Color { r, g, b, a: 1.0 }
    }

    fn background(&self) -> [f32; 4] {
        match (self.background, self.dark) {
            (Some([r, g, b]), _) => [r, g, b, 1.0].map(linear_from_srgb),
            (None, true) => rgb(0x16181c, 1.0),
            (None, false) => rgb(0xeeeeec, 1.0),
        }
    }

    /// The frame's uniform for what `view` sees of an actor that stands at `focus`.
    #[must_use]
    pub fn uniform(&self, view: &View, ground: f32, focus: Vec2, reach: f32) -> FrameUniform {
        let forward = (view.target - view.eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        let key = (Vec3::Y * 0.75 - right * 0.55 - forward * 0.55).normalize_or(Vec3::Y);
        let theme = |light: u32, dark: u32, alpha: f32| rgb(if self.dark { dark } else { light }, alpha);
        FrameUniform {
            clip_from_world: view.clip_from_world.to_cols_array(),
            eye: view.eye.to_array(),
            ground,
            key: key.to_array(),
            reach,
            focus: focus.to_array(),
            grid: f32::from(u8::from(self.grid)),
            dark: f32::from(u8::from(self.dark)),
            shadow_strength: if self.dark { 1.25 } else { 1.0 },
            background: self.background(),
            floor: theme(0xfbfaf8, 0x2a2d33, 0.9),
            line: theme(0x8f949c, 0x7d8592, if self.dark { 0.32 } else { 0.42 }),
            accent: theme(0x2f6fed, 0x7aa7ff, 1.0),
            recorded: theme(0x1f9d61, 0x3ecf8e, 1.0),
            synthetic: theme(0xd64545, 0xff7a70, 1.0),
            ..Default::default()
        }
    }
}

/// `hex` (sRGB) in linear light, with alpha.
fn rgb(hex: u32, alpha: f32) -> [f32; 4] {
    let channel = |shift: u32| linear_from_srgb(((hex >> shift) & 255) as f32 / 255.0);
    [channel(16), channel(8), channel(0), alpha]
}

/// The buffer that holds a frame's uniform, and its group.
pub struct FrameGroup {
    /// Layout of group 0.
    pub layout: wgpu::BindGroupLayout,
    /// Group 0.
    pub group: wgpu::BindGroup,
    buffer: wgpu::Buffer,
}

impl FrameGroup {
    /// An empty one.
    #[must_use]
    pub fn new(gpu: &Gpu) -> Self {
        let layout = gpu.layout("reprise.frame.layout", ShaderStages::VERTEX_FRAGMENT, &[UNIFORM]);
        let buffer = gpu.buffer("reprise.frame.uniform", size_of::<FrameUniform>() as u64, BufferUsages::UNIFORM);
        let group = gpu.group("reprise.frame.group", &layout, &[buffer.as_entire_binding()]);
        Self { layout, group, buffer }
    }

    /// Uploads `uniform`.
    pub fn write(&self, gpu: &Gpu, uniform: &FrameUniform) {
        gpu.queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(uniform));
    }
}
