//! Ghosts: poses drawn translucent where the actor would arrive.

use glam::Vec3;
use wgpu::CompareFunction;

use super::context::{Gpu, Pass};
use super::grid::OVER;
use super::mesh::{Mesh, SHAPE};
use super::pose::{ActorUniform, Numbered, PoseGroup};
use crate::shaders;

/// Most ghosts at once.
pub const MOST: usize = 16;

/// One ghost.
pub struct Ghost {
    /// The frame that it shows.
    pub frame: u32,
    /// Its vertices in the world, metres.
    pub pose: Vec<Vec3>,
    group: PoseGroup,
}

/// All ghosts and their pipelines.
pub struct Ghosts {
    depth: wgpu::RenderPipeline,
    colour: wgpu::RenderPipeline,
    shown: Vec<Ghost>,
}

impl Ghosts {
    /// None yet.
    #[must_use]
    pub fn new(gpu: &Gpu, frame: &wgpu::BindGroupLayout, pose: &wgpu::BindGroupLayout) -> Self {
        let layouts = [frame, pose];
        let pass = |label| Pass { vertices: SHAPE, ..Pass::of_picture(gpu, label, shaders::GHOST, &layouts) };
        let depth = gpu.pipeline(&Pass { colour: false, ..pass("reprise.ghost.depth") });
        let colour = gpu.pipeline(&Pass {
            depth: Some((CompareFunction::LessEqual, false)),
            blend: Some(OVER),
            ..pass("reprise.ghost.colour")
        });
        Self { depth, colour, shown: Vec::new() }
    }

    /// Shows `poses`, each with its frame, in place of those before; at most [`MOST`].
    pub fn set(
        &mut self,
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        triangles: &[[u32; 3]],
        poses: Vec<(u32, Vec<Vec3>)>,
    ) {
        let mut groups: Vec<_> = self.shown.drain(..).map(|ghost| ghost.group).collect();
        for (frame, pose) in poses.into_iter().take(MOST) {
            let mut group = groups.pop().unwrap_or_else(|| PoseGroup::new(gpu, layout, pose.len()));
            group.forget();
            let numbered = Numbered { number: 0, pose: &pose };
            let uniform = ActorUniform { weight: 0.0, opacity: 1.0, ..Default::default() };
            group.write(gpu, triangles, numbered, numbered, uniform);
            self.shown.push(Ghost { frame, pose, group });
        }
    }

    /// The ghosts shown.
    #[must_use]
    pub fn shown(&self) -> &[Ghost] {
        &self.shown
    }

    /// Draws them after the actor; group 0 is set. Each is a shell: what lies behind its own front is not seen.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, mesh: &Mesh) {
        for ghost in &self.shown {
            pass.set_bind_group(1, ghost.group.group(), &[]);
            for pipeline in [&self.depth, &self.colour] {
                pass.set_pipeline(pipeline);
                mesh.draw_shape(pass);
            }
        }
    }
}
