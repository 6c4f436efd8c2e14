//! Scanned frames on the device: a few groups, each with a mesh and images of its own, one of which may stand for the actor.

use bundle::ScannedGroup;
use glam::Vec3;
use kernels::align::Placement;

use super::context::Gpu;
use super::mesh::{Mesh, Shape, Worn};
use super::pose::{ActorUniform, Numbered, PoseGroup};

/// A group that is here.
struct Held {
    ordinal: u32,
    shape: Shape,
    /// Triangles over vertices.
    triangles: Vec<[u32; 3]>,
    poses: Vec<Vec<Vec3>>,
    /// By frame.
    worn: Vec<u32>,
    looks: Vec<Worn>,
}

/// All that are here, and the one that is drawn.
#[derive(Default)]
pub struct Scans {
    held: Vec<Held>,
    pose: Option<PoseGroup>,
    /// Group and frame that were written last, and are drawn.
    shown: Option<(u32, u32)>,
}

impl Scans {
    /// Takes group `ordinal` with a texture for each of its images; those that are not `wanted` go.
    pub fn take(
        &mut self,
        gpu: &Gpu,
        mesh: &Mesh,
        (ordinal, group): (u32, ScannedGroup),
        mut textures: Vec<wgpu::Texture>,
        wanted: &[u32],
    ) {
        let shown = self.shown.map(|(group, _)| group);
        self.held
            .retain(|held| held.ordinal != ordinal && (wanted.contains(&held.ordinal) || shown == Some(held.ordinal)));
        let vertex = |corner: u32| group.corners.get(corner as usize).map_or(0, |corner| corner.vertex);
        let triangles = group.triangles.iter().map(|triangle| triangle.map(vertex)).collect();
        if textures.is_empty() {
            textures.push(mesh.textures().white(gpu));
        }
        let captured = !(group.worn.is_empty() && group.colours.is_empty());
        let looks = textures.into_iter().map(|texture| mesh.worn(gpu, texture, captured)).collect();
        let shape = Shape::of_scan(gpu, &group);
        self.held.push(Held { ordinal, shape, triangles, poses: group.poses, worn: group.worn, looks });
    }

    /// Whether group `ordinal` is here.
    #[must_use]
    pub fn holds(&self, ordinal: u32) -> bool {
        self.held.iter().any(|held| held.ordinal == ordinal)
    }

    /// Writes frame `place` of what is here, moved by `placement`, in place of what was drawn before; `None` draws none. What is written
    /// in the world, and whether anything changed.
    pub fn show(
        &mut self,
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        wanted: Option<((u32, u32), u64, Placement)>,
        uniform: ActorUniform,
    ) -> (Option<Vec<Vec3>>, bool) {
        let before = self.shown.take();
        let found = wanted.and_then(|((ordinal, frame), number, placement)| {
            let held = self.held.iter().find(|held| held.ordinal == ordinal)?;
            Some((held, held.poses.get(frame as usize)?, (ordinal, frame), number, placement))
        });
        let Some((held, pose, place, number, placement)) = found else { return (None, before.is_some()) };
        let mut world = pose.clone();
        placement.apply_all(&mut world);
        if self.pose.as_ref().is_none_or(|group| group.room() < world.len()) {
            self.pose = Some(PoseGroup::new(gpu, layout, world.len()));
        }
        let Some(group) = &mut self.pose else { return (None, before.is_some()) };
        if before != Some(place) {
            group.forget();
        }
        let numbered = Numbered { number, pose: &world };
        let changed = group.write(gpu, &held.triangles, numbered, numbered, uniform);
        self.shown = Some(place);
        (Some(world), changed || before != Some(place))
    }

    /// What is drawn in place of the actor: its shape, where it is, and what it wears.
    #[must_use]
    pub fn drawn(&self) -> Option<(&Shape, &wgpu::BindGroup, &Worn)> {
        let (ordinal, frame) = self.shown?;
        let held = self.held.iter().find(|held| held.ordinal == ordinal)?;
        let image = held.worn.get(frame as usize).copied().unwrap_or(0);
        Some((&held.shape, self.pose.as_ref()?.group(), held.looks.get(image as usize)?))
    }
}
