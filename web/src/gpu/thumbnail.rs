//! Thumbnails: a pose alone, three-quarter view, on a transparent background.

use glam::{Vec2, Vec3};

use super::context::Gpu;
use super::frame::{FrameGroup, Look};
use super::mesh::Mesh;
use super::pose::{ActorUniform, Numbered, PoseGroup};
use super::readback::read;
use super::scene::{Measures, Scene};
use super::target::Target;
use crate::camera::{Camera, Subject};

/// Draws thumbnails, one after another.
pub struct Thumbnails {
    frame: FrameGroup,
    pose: PoseGroup,
    target: Target,
}

impl Thumbnails {
    /// For poses of `vertex_count` vertices in `scene`.
    #[must_use]
    pub fn new(scene: &Scene, vertex_count: usize) -> Self {
        let gpu = &scene.gpu;
        Self {
            frame: FrameGroup::new(gpu),
            pose: PoseGroup::new(gpu, &scene.pose_layout, vertex_count),
            target: Target::new(gpu, [1, 1]),
        }
    }

    /// Draws `pose` into `size` pixels and hands RGBA with straight alpha to `then`; `None` on a loss.
    pub fn draw(
        &mut self,
        scene: &Scene,
        pose: &[Vec3],
        size: [u32; 2],
        then: impl FnOnce(Option<Vec<u8>>) + wgpu::WasmNotSend + 'static,
    ) {
        let gpu = &scene.gpu;
        let size = size.map(|side| side.clamp(1, 1024));
        if self.target.size != size {
            self.target = Target::new(gpu, size);
        }
        self.pose.forget();
        let numbered = Numbered { number: 0, pose };
        self.pose.write(gpu, &scene.triangles, numbered, numbered, ActorUniform::default());
        let subject = subject(pose, scene.measures);
        let mut camera = Camera::new(subject);
        camera.set_aspect(size[0] as f32 / size[1] as f32);
        let look = Look { tint: false, ..scene.look };
        self.frame.write(gpu, &look.uniform(&camera.view(), scene.measures.floor, subject.ground, 1.0));
        let mut encoder = gpu.encoder("reprise.thumbnail.commands");
        self.record(gpu, &mut encoder, &scene.mesh);
        gpu.queue.submit([encoder.finish()]);
        read(gpu, &self.target.picture, size, true, then);
    }

    fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, mesh: &Mesh) {
        let mut pass = self.target.begin(gpu, encoder, "reprise.thumbnail.pass", wgpu::Color::TRANSPARENT);
        pass.set_bind_group(0, &self.frame.group, &[]);
        pass.set_bind_group(1, self.pose.group(), &[]);
        mesh.draw(&mut pass);
    }
}

/// What a thumbnail frames: all thumbnails at one scale where the pose allows, so that a duck is lower than a jump.
fn subject(pose: &[Vec3], measures: Measures) -> Subject {
    let low = pose.iter().fold(Vec3::INFINITY, |low, &p| low.min(p));
    let high = pose.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
    let middle = (low + high) / 2.0;
    // A camera fills two thirds of its height with the subject; a thumbnail has no room to spare.
    let height = measures.height.max(high.y - measures.floor) * 0.76;
    let floor = measures.floor + height * 0.12;
    let width = Vec2::new(high.x - low.x, high.z - low.z).max_element().min(measures.height) * 0.8;
    Subject { ground: Vec2::new(middle.x, middle.z), floor, height, width }
}
