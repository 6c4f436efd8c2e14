//! The soft contact shadow: what covers the ground seen from above, blurred narrowly where it touches and widely where
//! it only hangs over.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use wgpu::{BlendComponent, BlendFactor, BlendOperation, BufferUsages, ShaderStages, TextureFormat, TextureUsages};

use super::context::{Gpu, Pass, SAMPLER, TEXTURE, UNIFORM, view};
use super::frame::FrameGroup;
use super::mesh::{SHAPE, Shape};
use crate::shaders;

const FORMAT: TextureFormat = TextureFormat::Rg8Unorm;
/// Side of the map in texels.
const SIDE: u32 = 256;
/// Standard deviations of the two blurs, in parts of the actor's height.
const NARROW: f32 = 0.014;
const WIDE: f32 = 0.085;
/// Taps of a standard deviation: `FALL` in `blur.wgsl` is half of its inverse square.
pub const TAPS_PER_DEVIATION: f32 = 2.5;

/// `Blur` of `blur.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct BlurUniform {
    /// Step of a tap for red.
    pub red: [f32; 2],
    /// Step of a tap for green.
    pub green: [f32; 2],
}

/// The square of ground that the shadow covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    /// Lower corner (X, Z).
    pub origin: Vec2,
    /// Side in metres.
    pub side: f32,
    /// Height of the actor in metres, which the blurs follow.
    pub height: f32,
}

impl Square {
    /// Around every vertex of `poses`, with room for the blur of an actor `height` metres high.
    ///
    /// The side grows in steps, so that the map's texels do not swim while the actor moves its arms.
    #[must_use]
    pub fn around<'a>(poses: impl IntoIterator<Item = &'a [Vec3]>, height: f32) -> Self {
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for p in poses.into_iter().flatten() {
            low = low.min(Vec2::new(p.x, p.z));
            high = high.max(Vec2::new(p.x, p.z));
        }
        if !(low.is_finite() && high.is_finite()) {
            return Self { origin: Vec2::ZERO, side: 1.0, height };
        }
        let step = (height * 0.5).max(1e-3);
        let side = ((high - low).max_element() + 6.0 * WIDE * height).max(step);
        let side = (side / step).ceil() * step;
        let texel = side / SIDE as f32;
        let origin = ((low + high - side) * 0.5 / texel).floor() * texel;
        Self { origin, side, height }
    }
}

/// Pipelines and textures of the shadow.
pub struct Shadow {
    occlusion: wgpu::RenderPipeline,
    blur: wgpu::RenderPipeline,
    blurs: [wgpu::Buffer; 2],
    groups: [wgpu::BindGroup; 2],
    maps: [wgpu::TextureView; 2],
    /// Layout of the group in which the ground reads the finished map.
    pub layout: wgpu::BindGroupLayout,
    /// That group.
    pub group: wgpu::BindGroup,
}

impl Shadow {
    /// Nothing covered yet.
    #[must_use]
    pub fn new(gpu: &Gpu, frame: &wgpu::BindGroupLayout, pose: &wgpu::BindGroupLayout) -> Self {
        let most = BlendComponent {
            src_factor: BlendFactor::One,
            dst_factor: BlendFactor::One,
            operation: BlendOperation::Max,
        };
        let occlusion = gpu.pipeline(&Pass {
            vertices: SHAPE,
            blend: Some(wgpu::BlendState { color: most, alpha: most }),
            ..Pass::of_texture("reprise.occlusion.pipeline", shaders::OCCLUSION, &[frame, pose], FORMAT)
        });
        let blur_layout = gpu.layout("reprise.blur.layout", ShaderStages::FRAGMENT, &[UNIFORM, TEXTURE, SAMPLER]);
        let blur = gpu.pipeline(&Pass::of_texture("reprise.blur.pipeline", shaders::BLUR, &[&blur_layout], FORMAT));
        let maps = [(); 2].map(|()| {
            let label = "reprise.blur.map";
            view(label, &gpu.target(label, [SIDE; 2], FORMAT, 1, TextureUsages::TEXTURE_BINDING))
        });
        let sampler = gpu.sampler("reprise.blur.sampler", wgpu::AddressMode::ClampToEdge, 1);
        let blurs = [(); 2]
            .map(|()| gpu.buffer("reprise.blur.uniform", size_of::<BlurUniform>() as u64, BufferUsages::UNIFORM));
        let groups = [0, 1].map(|direction: usize| {
            gpu.group(
                "reprise.blur.group",
                &blur_layout,
                &[
                    blurs[direction].as_entire_binding(),
                    wgpu::BindingResource::TextureView(&maps[direction]),
                    wgpu::BindingResource::Sampler(&sampler),
                ],
            )
        });
        let layout = gpu.layout("reprise.ground.shadow_layout", ShaderStages::FRAGMENT, &[TEXTURE, SAMPLER]);
        let finished = [wgpu::BindingResource::TextureView(&maps[0]), wgpu::BindingResource::Sampler(&sampler)];
        let group = gpu.group("reprise.ground.shadow_group", &layout, &finished);
        Self { occlusion, blur, blurs, groups, maps, layout, group }
    }

    /// Draws the map of `square`.
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        frame: &FrameGroup,
        pose: &wgpu::BindGroup,
        shape: &Shape,
        square: Square,
    ) {
        let step = square.height / square.side / TAPS_PER_DEVIATION;
        for (buffer, axis) in self.blurs.iter().zip([Vec2::X, Vec2::Y]) {
            let uniform =
                BlurUniform { red: (axis * NARROW * step).to_array(), green: (axis * WIDE * step).to_array() };
            gpu.queue.write_buffer(buffer, 0, bytemuck::bytes_of(&uniform));
        }
        {
            let mut pass = gpu.pass_into(encoder, "reprise.occlusion.pass", &self.maps[0], wgpu::Color::TRANSPARENT);
            pass.set_pipeline(&self.occlusion);
            pass.set_bind_group(0, &frame.group, &[]);
            pass.set_bind_group(1, pose, &[]);
            shape.draw(&mut pass);
        }
        for (group, target) in self.groups.iter().zip([&self.maps[1], &self.maps[0]]) {
            let mut pass = gpu.pass_into(encoder, "reprise.blur.pass", target, wgpu::Color::TRANSPARENT);
            pass.set_pipeline(&self.blur);
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_holds_the_actor_and_its_blur() {
        let pose = [Vec3::new(-0.4, 0.0, 2.0), Vec3::new(0.5, 1.7, 2.3)];
        let square = Square::around([&pose[..]], 1.7);
        for p in pose {
            let inside = (Vec2::new(p.x, p.z) - square.origin) / square.side;
            assert!(inside.min_element() > 0.1 && inside.max_element() < 0.9, "{inside}");
        }
        assert_eq!(Square::around([], 1.7), Square { origin: Vec2::ZERO, side: 1.0, height: 1.7 });
    }
}
