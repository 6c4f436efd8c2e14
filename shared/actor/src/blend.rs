//! `Blend` of thesis algorithm 2 (TVCG algorithm 1), without the poses: where the source and destination of a
//! transition stand, node by node of its warp.

use glam::Vec2;

use super::ground::{Ground, recorded_step};
use crate::contacts::Contacts;
use crate::graph::{EssentialGraph, Transition};
use crate::pose_source::PoseError;
use crate::temporal_warp::TemporalWarp;
use crate::timeline::Timeline;
use crate::walk::Leg;
use kernels::align::{Placement, rotate};
use kernels::scalar::half_turn;

/// A node of a transition under way.
///
/// The actor's centre of mass follows the blended displacements of both sides. Source and destination are re-aligned
/// about the vertical axis at each node; the rotations act on all that remains of their segments, so headings
/// accumulate. Heights are not touched: interpolation blends them. What stands on the ground on both sides stays where it
/// is, and the centre of mass moves over it ([`Contacts`]; not in the papers).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Index t of the node, from 0.
    pub node: usize,
    /// Frames n and m that the node blends.
    pub frames: [u32; 2],
    /// Where both are to be placed.
    pub placements: [Placement; 2],
    /// Weight of the destination: [`ease`] of `t / (L - 1)`.
    pub lambda: f32,
    /// Centre of mass P in metres along (X, Z).
    pub centre: Vec2,
    /// Centres of mass of both frames as they were recorded.
    recorded: [Vec2; 2],
}

impl Blend {
    /// The first node of a transition that leaves from frame `from`, which stands at `placement`.
    ///
    /// # Errors
    /// A segment that leaves its sequence, or a frame that cannot be read.
    pub fn begin(
        timeline: &Timeline,
        ground: &mut impl Ground,
        (from, to): (u32, u32),
        warp: &TemporalWarp,
        placement: Placement,
    ) -> Result<Self, PoseError> {
        let (_, lj) = warp.lengths();
        let first = timeline.offset(to, 1 - lj as i64).ok_or(PoseError::OutOfRange(to))?;
        let recorded = [ground.centre(from)?, ground.centre(first)?];
        let centre = ground_point(placement, recorded[0]);
        let heading = placement.heading + ground.heading(from, first)?;
        let destination = Placement::turning(heading, recorded[1], centre);
        let lambda = if warp.moves().is_empty() { 1.0 } else { 0.0 };
        Ok(Self { node: 0, frames: [from, first], placements: [placement, destination], lambda, centre, recorded })
    }

    /// The node after this one; `None` at the end of the warp.
    ///
    /// # Errors
    /// A segment that leaves its sequence, or a frame that cannot be read.
    pub fn next(
        &self,
        timeline: &Timeline,
        ground: &mut impl Ground,
        warp: &TemporalWarp,
        contacts: &Contacts,
    ) -> Result<Option<Self>, PoseError> {
        let Some(step) = warp.moves().get(self.node) else { return Ok(None) };
        let mut frames = self.frames;
        let mut placements = self.placements;
        let mut centres = [Vec2::ZERO; 2];
        let mut displacements = [Vec2::ZERO; 2];
        for (side, advances) in [step.advances_source(), step.advances_destination()].into_iter().enumerate() {
            if advances {
                let (frame, recorded) =
                    recorded_step(timeline, ground, frames[side])?.ok_or(PoseError::OutOfRange(frames[side]))?;
                frames[side] = frame;
                placements[side] = placements[side].after(&recorded);
            }
            centres[side] = ground.centre(frames[side])?;
            if advances {
                displacements[side] = ground_point(placements[side], centres[side]) - self.centre;
            }
        }
        let node = self.node + 1;
        let lambda = ease(node as f32 / warp.moves().len() as f32);
        let apart = placements[0].heading + ground.heading(frames[0], frames[1])? - placements[1].heading;
        let apart = half_turn(apart);
        let headings = [placements[0].heading - lambda * apart, placements[1].heading + (1.0 - lambda) * apart];
        let free = displacements[0].lerp(displacements[1], self.lambda);
        let mut next = Self { node, frames, placements, lambda, centre: self.centre, recorded: centres };
        for (placement, heading) in next.placements.iter_mut().zip(headings) {
            placement.heading = heading;
        }
        next.centre += self.held(&next, contacts, free);
        for side in 0..2 {
            next.placements[side] = Placement::turning(headings[side], centres[side], next.centre);
        }
        Ok(Some(next))
    }

    /// The step of the centre of mass from here to `next` that keeps still, as well as one step can, what stands on both
    /// sides of both nodes; `free` is the step where nothing does.
    fn held(&self, next: &Self, contacts: &Contacts, free: Vec2) -> Vec2 {
        let (mut sum, mut weight) = (Vec2::ZERO, 0.0);
        for part in 0..contacts.parts() {
            let ((before, stood), (after, stands)) = (self.standing(part, contacts), next.standing(part, contacts));
            let firmly = stood.min(stands);
            sum += firmly * (before - after);
            weight += firmly;
        }
        (sum + (1.0 - weight).max(0.0) * free) / weight.max(1.0)
    }

    /// Where a part of the blended surface is, seen from the centre of mass, and how firmly it stands on both sides.
    fn standing(&self, part: usize, contacts: &Contacts) -> (Vec2, f32) {
        let side = |side: usize| {
            let contact = contacts.of(self.frames[side]).get(part).copied().unwrap_or_default();
            (rotate(self.placements[side].heading, contact.point - self.recorded[side]), contact.weight)
        };
        let ((source, stands), (destination, as_well)) = (side(0), side(1));
        (source.lerp(destination, self.lambda), stands * as_well)
    }
}

/// `3 t^2 - 2 t^3`: from 0 to 1, at rest at both ends.
///
/// The papers' weight grows evenly (thesis algorithm 2): at the first node of a blend the surface then takes on the
/// velocity (destination - source) / (L - 1) at once, and loses it at the last, which is seen where L is small.
#[must_use]
pub fn ease(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// Placement of the destination's recorded frames after a transition whose source frames stand as they were recorded:
/// [`Transition::placement`]. No pose is interpolated.
///
/// # Errors
/// A segment that leaves its sequence, or a frame that cannot be read.
pub fn transition_placement(
    timeline: &Timeline,
    ground: &mut impl Ground,
    ends: (u32, u32),
    warp: &TemporalWarp,
    contacts: &Contacts,
) -> Result<Placement, PoseError> {
    let mut blend = Blend::begin(timeline, ground, ends, warp, Placement::IDENTITY)?;
    while let Some(next) = blend.next(timeline, ground, warp, contacts)? {
        blend = next;
    }
    let heading = half_turn(blend.placements[1].heading);
    Ok(Placement { heading, ..blend.placements[1] })
}

/// Placement of the last frame of `legs`, the actor standing at `start` on their first one. Reads no pose but at the wraps of
/// cyclic sequences.
///
/// # Errors
/// Legs that do not belong to `graph`, or a frame at a wrap that cannot be read.
pub fn arrival(
    graph: &EssentialGraph,
    timeline: &Timeline,
    ground: &mut impl Ground,
    start: Placement,
    legs: &[Leg],
) -> Result<Placement, PoseError> {
    let mut placement = start;
    for leg in legs {
        match *leg {
            Leg::Recorded { first, steps, .. } => {
                let mut frame = first;
                for _ in 0..steps {
                    let (next, step) = recorded_step(timeline, ground, frame)?.ok_or(PoseError::OutOfRange(frame))?;
                    frame = next;
                    placement = placement.after(&step);
                }
            }
            Leg::Synthetic(index) => placement = placement.after(&transition(graph, index)?.placement),
            // Within a sequence recorded frames stand as they do, whichever way they are gone through.
            Leg::Back { .. } => {}
        }
    }
    Ok(placement)
}

/// The transition that a leg names.
pub fn transition(graph: &EssentialGraph, index: u32) -> Result<&Transition, PoseError> {
    graph.transitions().get(index as usize).ok_or(PoseError::OutOfRange(index))
}

fn ground_point(placement: Placement, point: Vec2) -> Vec2 {
    let moved = placement.apply(glam::Vec3::new(point.x, 0.0, point.y));
    Vec2::new(moved.x, moved.z)
}
