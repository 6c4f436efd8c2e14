//! Scanned frames on the device: a few groups, each with a mesh and images of its own. One may stand for the actor, or two that the
//! registered mesh carries from the one to the other.

use actor::carry::{Carried, Surface};
use bundle::ScannedHead;
use glam::Vec3;
use kernels::align::Placement;

use super::context::Gpu;
use super::mesh::{DrawnCorner, Mesh, Shape, Worn};
use super::pose::{ActorUniform, Numbered, PoseGroup};
use crate::brought::{Brought, changed, placed};

/// A group as it was read.
pub struct Scan {
    corners: Vec<DrawnCorner>,
    /// Over corners.
    triangles: Vec<[u32; 3]>,
    poses: Vec<Vec<Vec3>>,
    /// How the registered mesh carries the vertices of one frame after the other; less where it does not.
    carried: Vec<Carried>,
    /// Which image each frame wears; empty where there is none.
    pub worn: Vec<u32>,
    /// Whether it brings colours.
    captured: bool,
}

impl Scan {
    /// The group of which the index tells `head`, with its parts one after the other; `None` where they do not fit together.
    #[must_use]
    pub fn new(head: &ScannedHead, corners: &[u8], triangles: &[u32], poses: &[f32], carried: &[u8]) -> Option<Self> {
        let corners: Vec<DrawnCorner> =
            corners.chunks_exact(size_of::<DrawnCorner>()).map(bytemuck::pod_read_unaligned).collect();
        let vertices = head.vertices as usize;
        let fits = corners.len() == head.corners as usize
            && triangles.len() == 3 * head.triangles as usize
            && poses.len() == 3 * vertices * head.frames as usize
            && corners.iter().all(|corner| corner.vertex < head.vertices)
            && triangles.iter().all(|&corner| corner < head.corners);
        fits.then(|| Self {
            carried: carried.chunks_exact(size_of::<Carried>()).map(bytemuck::pod_read_unaligned).collect(),
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
    /// How it is brought to where it is shown.
    pub brought: Brought,
    /// How much of it is seen, from 0 to 1.
    pub share: f32,
}

/// The registered mesh at the moment that is shown.
#[derive(Clone, Copy)]
pub struct Carrier<'a> {
    /// Its triangles.
    pub triangles: &'a [[u32; 3]],
    /// The frame before the moment.
    pub before: Numbered<'a>,
    /// The frame after it.
    pub after: Numbered<'a>,
    /// 0 is the one, 1 the other.
    pub weight: f32,
}

/// A group that is here.
struct Held {
    ordinal: u32,
    shape: Shape,
    /// Triangles over vertices.
    triangles: Vec<[u32; 3]>,
    poses: Vec<Vec<Vec3>>,
    carried: Vec<Carried>,
    /// By frame.
    worn: Vec<u32>,
    looks: Vec<Worn>,
    /// How much of it may be seen: what comes late comes little by little.
    risen: f32,
}

/// Group and frame, and how it was brought.
type Shown = ((u32, u32), std::mem::Discriminant<Brought>);

/// What is drawn of a scanned frame.
#[derive(Default)]
struct Slot {
    pose: Option<PoseGroup>,
    /// What was written last.
    shown: Option<Shown>,
    share: f32,
}

/// Scanned frames that are drawn at once.
const SLOTS: usize = 2;

/// All that are here, and those that are drawn.
#[derive(Default)]
pub struct Scans {
    held: Vec<Held>,
    slots: [Slot; SLOTS],
}

impl Scans {
    /// Takes group `ordinal` with a texture for each of its images; those that are not `wanted` go. One that was waited for, as `late` says,
    /// is seen little by little.
    pub fn take(
        &mut self,
        gpu: &Gpu,
        mesh: &Mesh,
        (ordinal, scan): (u32, Scan),
        mut textures: Vec<wgpu::Texture>,
        (wanted, late): (&[u32], bool),
    ) {
        let shown: Vec<u32> = self.slots.iter().filter_map(|slot| Some(slot.shown?.0.0)).collect();
        self.held.retain(|held| {
            held.ordinal != ordinal && (wanted.contains(&held.ordinal) || shown.contains(&held.ordinal))
        });
        let vertex = |corner: u32| scan.corners[corner as usize].vertex;
        let triangles = scan.triangles.iter().map(|triangle| triangle.map(vertex)).collect();
        if textures.is_empty() {
            textures.push(mesh.textures().white(gpu));
        }
        let looks = textures.into_iter().map(|texture| mesh.worn(gpu, texture, scan.captured)).collect();
        let shape = Shape::new(gpu, &scan.corners, &scan.triangles);
        let risen = if late { 0.0 } else { 1.0 };
        let Scan { poses, carried, worn, .. } = scan;
        self.held.push(Held { ordinal, shape, triangles, poses, carried, worn, looks, risen });
    }

    /// Whether group `ordinal` is here.
    #[must_use]
    pub fn holds(&self, ordinal: u32) -> bool {
        self.held.iter().any(|held| held.ordinal == ordinal)
    }

    /// How much of group `ordinal` may be seen, which comes little by little where it came late; `step` more from now on.
    pub fn rise(&mut self, ordinal: u32, step: f32) -> f32 {
        let Some(held) = self.held.iter_mut().find(|held| held.ordinal == ordinal) else { return 0.0 };
        held.risen = (held.risen + step).min(1.0);
        held.risen
    }

    /// Writes the frames that are wanted and here, in place of those before. Where the one is that stands as it was scanned, and whether
    /// anything changed.
    pub fn show(
        &mut self,
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        wanted: [Option<Wanted>; SLOTS],
        carrier: Carrier<'_>,
        uniform: ActorUniform,
    ) -> (Option<Vec<Vec3>>, bool) {
        let (mut stands, mut changed) = (None, false);
        for (slot, wanted) in self.slots.iter_mut().zip(wanted) {
            let before = slot.shown.take();
            let share = std::mem::replace(&mut slot.share, 0.0);
            let written = wanted.and_then(|wanted| {
                let held = self.held.iter().find(|held| held.ordinal == wanted.place.0)?;
                slot.write(gpu, layout, (wanted, before), held, carrier, uniform)
            });
            let Some((world, moved)) = written else {
                changed |= before.is_some();
                continue;
            };
            changed |= moved || before != slot.shown || share != slot.share;
            stands = stands.or(world);
        }
        (stands, changed)
    }

    /// How much is seen of what is drawn: 0 where there is nothing.
    #[must_use]
    pub fn share(&self) -> f32 {
        self.shares().into_iter().sum()
    }

    /// How much is seen of each frame that may be drawn.
    #[must_use]
    pub fn shares(&self) -> [f32; SLOTS] {
        std::array::from_fn(|number| if self.drawn(number).is_some() { self.slots[number].share } else { 0.0 })
    }

    /// Whether what is drawn is carried by the registered mesh.
    #[must_use]
    pub fn is_carried(&self) -> bool {
        let placed = std::mem::discriminant(&Brought::Placed(0, Placement::IDENTITY));
        self.slots.iter().any(|slot| slot.shown.is_some_and(|(_, brought)| brought != placed))
    }

    /// What is drawn in place of the actor: its shape, where it is, and what it wears.
    #[must_use]
    pub fn drawn(&self, number: usize) -> Option<(&Shape, &wgpu::BindGroup, &Worn)> {
        let slot = self.slots.get(number)?;
        let ((ordinal, frame), _) = slot.shown?;
        let held = self.held.iter().find(|held| held.ordinal == ordinal)?;
        let image = held.worn.get(frame as usize).copied().unwrap_or(0);
        Some((&held.shape, slot.pose.as_ref()?.group(), held.looks.get(image as usize)?))
    }
}

impl Slot {
    /// Writes what is `wanted` of `held`, after what was shown `before`; where it stands if not carried, and whether anything changed. `None`
    /// where it cannot be shown.
    fn write(
        &mut self,
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        (wanted, before): (Wanted, Option<Shown>),
        held: &Held,
        carrier: Carrier<'_>,
        uniform: ActorUniform,
    ) -> Option<(Option<Vec<Vec3>>, bool)> {
        let frame = wanted.place.1 as usize;
        let scanned = held.poses.get(frame)?;
        let shown = (wanted.place, std::mem::discriminant(&wanted.brought));
        if self.pose.as_ref().is_none_or(|group| group.room() < scanned.len()) {
            self.pose = Some(PoseGroup::new(gpu, layout, scanned.len()));
        }
        let group = self.pose.as_mut()?;
        if before != Some(shown) {
            group.forget();
        }
        let carried = held.carried.chunks_exact(scanned.len().max(1)).nth(frame);
        let mut stand = |number: u64, world: Vec<Vec3>| {
            let numbered = Numbered { number, pose: &world };
            let changed = group.write(gpu, &held.triangles, numbered, numbered, uniform);
            (Some(world), changed)
        };
        let written = match wanted.brought {
            Brought::Placed(number, placement) => stand(number, placed(scanned, placement)),
            Brought::Changed(placement) => {
                let by = if carrier.weight < 0.5 { carrier.before } else { carrier.after };
                let surface = Surface::new(carrier.triangles, by.pose);
                stand(by.number, changed(&surface, carried?, placed(scanned, placement)))
            }
            Brought::Blended => {
                let carried = carried?;
                let placed = |by: Numbered<'_>| {
                    // What is there already is not looked at.
                    if group.has(by.number) {
                        return Vec::new();
                    }
                    let surface = Surface::new(carrier.triangles, by.pose);
                    carried.iter().map(|one| surface.place(one).unwrap_or_default()).collect::<Vec<_>>()
                };
                let poses = [placed(carrier.before), placed(carrier.after)];
                let [from, to] = [(carrier.before.number, &poses[0]), (carrier.after.number, &poses[1])]
                    .map(|(number, pose)| Numbered { number, pose });
                (None, group.write(gpu, &held.triangles, from, to, ActorUniform { weight: carrier.weight, ..uniform }))
            }
        };
        (self.shown, self.share) = (Some(shown), wanted.share);
        Some(written)
    }
}
