//! Scanned frames on the device: a few groups, each with a mesh and images of its own, one of which may stand for the actor.

use bundle::ScannedHead;
use glam::Vec3;
use kernels::align::Placement;

use super::context::Gpu;
use super::mesh::{DrawnCorner, Mesh, Shape, Worn};
use super::pose::{ActorUniform, Numbered, PoseGroup};

/// A group as it was read.
pub struct Scan {
    corners: Vec<DrawnCorner>,
    /// Over corners.
    triangles: Vec<[u32; 3]>,
    poses: Vec<Vec<Vec3>>,
    /// Which image each frame wears; empty where there is none.
    pub worn: Vec<u32>,
    /// Whether it brings colours.
    captured: bool,
}

impl Scan {
    /// The group of which the index tells `head`, with its parts one after the other; `None` where they do not fit together.
    #[must_use]
    pub fn new(head: &ScannedHead, corners: &[u8], triangles: &[u32], poses: &[f32]) -> Option<Self> {
        let corners: Vec<DrawnCorner> =
            corners.chunks_exact(size_of::<DrawnCorner>()).map(bytemuck::pod_read_unaligned).collect();
        let vertices = head.vertices as usize;
        let fits = corners.len() == head.corners as usize
            && triangles.len() == 3 * head.triangles as usize
            && poses.len() == 3 * vertices * head.frames as usize
            && corners.iter().all(|corner| corner.vertex < head.vertices)
            && triangles.iter().all(|&corner| corner < head.corners);
        fits.then(|| Self {
            corners,
            triangles: triangles.as_chunks::<3>().0.to_vec(),
            poses: poses
                .chunks_exact(3 * vertices)
                .map(|pose| pose.as_chunks::<3>().0.iter().map(|&p| p.into()).collect())
                .collect(),
            worn: head.worn.clone(),
            captured: head.coloured || !head.images.is_empty(),
        })
    }
}

/// A scanned frame that is wanted in the actor's place.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Group and frame.
    pub place: (u32, u32),
    /// Equal numbers are equal poses.
    pub number: u64,
    /// Where it stands.
    pub placement: Placement,
    /// How much of it is seen, from 0 to 1; the rest is the registered mesh.
    pub share: f32,
}

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
    share: f32,
}

impl Scans {
    /// Takes group `ordinal` with a texture for each of its images; those that are not `wanted` go.
    pub fn take(
        &mut self,
        gpu: &Gpu,
        mesh: &Mesh,
        (ordinal, scan): (u32, Scan),
        mut textures: Vec<wgpu::Texture>,
        wanted: &[u32],
    ) {
        let shown = self.shown.map(|(group, _)| group);
        self.held
            .retain(|held| held.ordinal != ordinal && (wanted.contains(&held.ordinal) || shown == Some(held.ordinal)));
        let vertex = |corner: u32| scan.corners[corner as usize].vertex;
        let triangles = scan.triangles.iter().map(|triangle| triangle.map(vertex)).collect();
        if textures.is_empty() {
            textures.push(mesh.textures().white(gpu));
        }
        let looks = textures.into_iter().map(|texture| mesh.worn(gpu, texture, scan.captured)).collect();
        let shape = Shape::new(gpu, &scan.corners, &scan.triangles);
        self.held.push(Held { ordinal, shape, triangles, poses: scan.poses, worn: scan.worn, looks });
    }

    /// Whether group `ordinal` is here.
    #[must_use]
    pub fn holds(&self, ordinal: u32) -> bool {
        self.held.iter().any(|held| held.ordinal == ordinal)
    }

    /// Writes the frame that is wanted, if it is here, in place of what was drawn before; `None` draws none. What is written in the world,
    /// and whether anything changed.
    pub fn show(
        &mut self,
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        wanted: Option<Wanted>,
        uniform: ActorUniform,
    ) -> (Option<Vec<Vec3>>, bool) {
        let before = self.shown.take();
        let found = wanted.and_then(|Wanted { place, number, placement, share }| {
            let held = self.held.iter().find(|held| held.ordinal == place.0)?;
            self.share = share;
            Some((held, held.poses.get(place.1 as usize)?, place, number, placement))
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

    /// How much is seen of what is drawn: 0 where there is nothing.
    #[must_use]
    pub fn share(&self) -> f32 {
        if self.drawn().is_some() { self.share } else { 0.0 }
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
