//! `Blend` of thesis algorithm 2 (TVCG algorithm 1), without the poses: where the source and destination of a
//! transition stand, node by node of its warp.

use glam::Vec2;

use super::ground::{Ground, Next, recorded_step};
use crate::contacts::{Contact, Contacts, Facings};
use crate::graph::{EssentialGraph, TURN_STEP, Transition};
use crate::hold::{Stance, carried, turned};
use crate::pose_source::PoseError;
pub use crate::temporal_warp::ease;
use crate::temporal_warp::{PLACES_A_FRAME, Pace, TemporalWarp};
use crate::timeline::Timeline;
use crate::walk::Leg;
use kernels::align::{Placement, rotate};
use kernels::scalar::half_turn;

/// A node of a transition under way.
///
/// The actor's centre of mass follows the blended displacements of both sides. Source and destination are re-aligned
/// about the vertical axis at each node; the rotations act on all that remains of their segments, so headings
/// accumulate. Heights are not touched: interpolation blends them. Where it is known what stands on the ground, the
/// transition leads to where the foot stays that cannot step, and the centre of mass goes from where the source alone would
/// have it to where the destination will ([`Contacts::steers`]; not in the papers). Both sides are gone through at a smooth
/// [`Pace`], so that they stand between frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Index t of the node, from 0.
    pub node: usize,
    /// Frames n and m that the node blends, or those right before.
    pub frames: [u32; 2],
    /// The frames after them, and how far the node is on the way there.
    pub next: [Next; 2],
    /// Where both are to be placed.
    pub placements: [Placement; 2],
    /// Where the source would stand had it been played on alone from the first node; and the destination, its first frame
    /// standing as it was recorded.
    pub alone: [Placement; 2],
    /// Where the frame stands that the transition leaves.
    pub start: Placement,
    /// Weight of the destination: [`ease`] of `t / (L - 1)`.
    pub lambda: f32,
    /// Centre of mass P in metres along (X, Z).
    pub centre: Vec2,
    /// Centres of mass of both sides as they were recorded.
    recorded: [Vec2; 2],
    /// Frames of each segment that lie behind.
    places: [u32; 2],
    paces: [Pace; 2],
    /// [`Transition::turn`].
    turn: f32,
    /// Where the destination's first frame stands once the last one stands where the transition leads, if that is known.
    towards: Option<Placement>,
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
        Ok(Self {
            node: 0,
            frames: [from, first],
            next: [from, first].map(none_after),
            placements: [placement, destination],
            alone: [placement, Placement::IDENTITY],
            start: placement,
            lambda,
            centre,
            recorded,
            places: [0; 2],
            paces: [0, 1].map(|side| Pace::of(warp, side, timeline.fps())),
            turn: 0.0,
            towards: None,
        })
    }

    /// The first node of a transition of a graph with `contacts`, as [`Self::begin`].
    ///
    /// # Errors
    /// As there.
    pub fn of(
        timeline: &Timeline,
        ground: &mut impl Ground,
        transition: &Transition,
        placement: Placement,
        contacts: &Contacts,
    ) -> Result<Self, PoseError> {
        let (ends, warp) = ((transition.from, transition.to), &transition.warp);
        let mut blend = Self { turn: transition.turn, ..Self::begin(timeline, ground, ends, warp, placement)? };
        if contacts.steers() {
            let mut alone = Placement::IDENTITY;
            let mut frame = blend.frames[1];
            // Counted: a segment may go round a short loop more than once.
            for _ in 1..warp.lengths().1 {
                let (next, step) = recorded_step(timeline, ground, frame)?.ok_or(PoseError::OutOfRange(frame))?;
                (frame, alone) = (next, alone.after(&step));
            }
            blend.towards = Some(placement.after(&transition.placement).after(&alone.inverse()));
        }
        Ok(blend)
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
        let node = self.node + 1;
        if node > warp.moves().len() {
            return Ok(None);
        }
        let mut next = Self { node, lambda: ease(node as f32 / warp.moves().len() as f32), ..*self };
        for side in 0..2 {
            next.advance(timeline, ground, warp, side)?;
        }
        let lambda = next.lambda;
        let displacements = [0, 1].map(|side| ground_point(next.placements[side], next.recorded[side]) - self.centre);
        let apart = half_turn(next.placements[0].heading + next.turn(ground)? - next.placements[1].heading);
        let besides = (lambda - self.lambda) * self.turn;
        let headings = [-lambda, 1.0 - lambda].map(|share| share * apart + besides);
        let headings = [0, 1].map(|side: usize| next.placements[side].heading + headings[side]);
        let free = displacements[0].lerp(displacements[1], self.lambda);
        for (placement, heading) in next.placements.iter_mut().zip(headings) {
            placement.heading = heading;
        }
        next.centre = match self.towards {
            Some(towards) => next.between(towards),
            None => self.centre + self.held(&next, contacts, free),
        };
        for side in 0..2 {
            next.placements[side] = Placement::turning(headings[side], next.recorded[side], next.centre);
        }
        Ok(Some(next))
    }

    /// The centre of mass on its way from where the source has it, played on alone, to where the destination will have it.
    fn between(&self, towards: Placement) -> Vec2 {
        let [source, destination] = [self.alone[0], towards.after(&self.alone[1])];
        ground_point(source, self.recorded[0]).lerp(ground_point(destination, self.recorded[1]), self.lambda)
    }

    /// The recorded frame that a side is nearest to.
    #[must_use]
    pub fn nearest(&self, side: usize) -> u32 {
        if self.next[side].share < 0.5 { self.frames[side] } else { self.next[side].frame }
    }

    /// Moves a side on to where it is at the node, where it stands being left as it was.
    fn advance(
        &mut self,
        timeline: &Timeline,
        ground: &mut impl Ground,
        warp: &TemporalWarp,
        side: usize,
    ) -> Result<(), PoseError> {
        let place = self.paces[side].place(warp, side, self.node);
        let after =
            |frame: u32, ground: &mut _| recorded_step(timeline, ground, frame)?.ok_or(PoseError::OutOfRange(frame));
        while self.places[side] < place / PLACES_A_FRAME {
            let (frame, recorded) = after(self.frames[side], ground)?;
            self.frames[side] = frame;
            self.placements[side] = self.placements[side].after(&recorded);
            self.alone[side] = self.alone[side].after(&recorded);
            self.places[side] += 1;
        }
        let share = (place % PLACES_A_FRAME) as f32 / PLACES_A_FRAME as f32;
        self.recorded[side] = ground.centre(self.frames[side])?;
        self.next[side] = none_after(self.frames[side]);
        if share > 0.0 {
            let (frame, step) = after(self.frames[side], ground)?;
            self.next[side] = Next { frame, step, share };
            self.recorded[side] = self.recorded[side].lerp(ground_point(step, ground.centre(frame)?), share);
        }
        Ok(())
    }

    /// The angle by which the destination must be turned to lie best on the source, both as they were recorded: between
    /// frames from those around, each counting as much as it is near.
    fn turn(&self, ground: &mut impl Ground) -> Result<f32, PoseError> {
        let [source, destination] = self.next;
        let first = ground.heading(self.frames[0], self.frames[1])?;
        let mut turn = first;
        for (beyond, there) in [(false, true), (true, false), (true, true)] {
            let of = |next: &Next, is_beyond: bool| if is_beyond { next.share } else { 1.0 - next.share };
            let share = of(&source, beyond) * of(&destination, there);
            if share > 0.0 {
                let fixed = if beyond { source.frame } else { self.frames[0] };
                let moving = if there { destination.frame } else { self.frames[1] };
                // How the next frames stand beside those that they follow.
                let turned = f32::from(u8::from(beyond)) * source.step.heading
                    - f32::from(u8::from(there)) * destination.step.heading;
                turn += share * half_turn(ground.heading(fixed, moving)? + turned - first);
            }
        }
        Ok(turn)
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
            let contact = self.contact(side, part, contacts);
            (rotate(self.placements[side].heading, contact.point - self.recorded[side]), contact.weight)
        };
        let ((source, stands), (destination, as_well)) = (side(0), side(1));
        (source.lerp(destination, self.lambda), stands * as_well)
    }

    /// A part of one side, between frames.
    fn contact(&self, side: usize, part: usize, contacts: &Contacts) -> Contact {
        let of = |frame: u32| contacts.of(frame).get(part).copied().unwrap_or_default();
        let (here, next) = (of(self.frames[side]), self.next[side]);
        if next.share <= 0.0 {
            return here;
        }
        let mut there = of(next.frame);
        there.point = ground_point(next.step, there.point);
        let weight = here.weight + (there.weight - here.weight) * next.share;
        // What does not stand has no point.
        let point = match (here.weight > 0.0, there.weight > 0.0) {
            (true, true) => here.point.lerp(there.point, next.share),
            (true, false) => here.point,
            _ => there.point,
        };
        Contact { point, weight }
    }

    /// Which way a part of one side points, between frames.
    fn facing(&self, side: usize, part: usize, facings: &Facings) -> f32 {
        let (here, next) = (facings.of(self.frames[side], part), self.next[side]);
        if next.share <= 0.0 {
            return here;
        }
        here + next.share * half_turn(next.step.heading + facings.of(next.frame, part) - here)
    }
}

/// Nothing is looked at after `frame`.
fn none_after(frame: u32) -> Next {
    Next { frame, step: Placement::IDENTITY, share: 0.0 }
}

/// Placement of the destination's recorded frames after a transition whose source frames stand as they were recorded:
/// [`Transition::placement`] of one that does not turn besides. No pose is interpolated.
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
    let nodes = nodes(timeline, ground, (ends, warp, 0.0), contacts)?;
    Ok(leads_to(&nodes, timeline, contacts))
}

/// [`Transition::placement`] and [`Transition::turn`]: so that what cannot step neither goes nor turns.
///
/// # Errors
/// As [`transition_placement`].
pub fn transition_way(
    timeline: &Timeline,
    ground: &mut impl Ground,
    ends: (u32, u32),
    warp: &TemporalWarp,
    (contacts, facings): (&Contacts, &Facings),
) -> Result<(Placement, f32), PoseError> {
    let straight = nodes(timeline, ground, (ends, warp, 0.0), contacts)?;
    if !contacts.steers() {
        return Ok((leads_to(&straight, timeline, contacts), 0.0));
    }
    let turn = turned(&stances(&straight, contacts, facings), timeline.fps());
    let turn = (turn / TURN_STEP).round() * TURN_STEP;
    let nodes = nodes(timeline, ground, (ends, warp, turn), contacts)?;
    Ok((leads_to(&nodes, timeline, contacts), turn))
}

/// The nodes of a transition that begins as it was recorded, from its ends, its warp, and how far it turns besides.
fn nodes(
    timeline: &Timeline,
    ground: &mut impl Ground,
    (ends, warp, turn): ((u32, u32), &TemporalWarp, f32),
    contacts: &Contacts,
) -> Result<Vec<Blend>, PoseError> {
    let first = Blend { turn, ..Blend::begin(timeline, ground, ends, warp, Placement::IDENTITY)? };
    let mut nodes = vec![first];
    let nothing = Contacts::default();
    let held = if contacts.steers() { &nothing } else { contacts };
    while let Some(next) = nodes[nodes.len() - 1].next(timeline, ground, warp, held)? {
        nodes.push(next);
    }
    Ok(nodes)
}

/// Where a transition of these nodes leads.
fn leads_to(nodes: &[Blend], timeline: &Timeline, contacts: &Contacts) -> Placement {
    let mut placement = nodes.last().map_or(Placement::IDENTITY, |last| last.placements[1]);
    if contacts.steers() {
        placement.translation += carried(&stances(nodes, contacts, &Facings::default()), timeline.fps());
    }
    Placement { heading: half_turn(placement.heading), ..placement }
}

/// How each part stands in a transition of these nodes: in the source, played on alone, and in the destination, played alone
/// into where the nodes lead.
fn stances(nodes: &[Blend], contacts: &Contacts, facings: &Facings) -> Vec<Stance> {
    let mut stances = vec![Stance::default(); contacts.parts()];
    let Some(last) = nodes.last() else { return stances };
    let destination = last.placements[1].after(&last.alone[1].inverse());
    for (part, stance) in stances.iter_mut().enumerate() {
        for node in nodes {
            let alone = [node.alone[0], destination.after(&node.alone[1])];
            for side in 0..2 {
                let contact = node.contact(side, part, contacts);
                let heading = alone[side].heading + node.facing(side, part, facings);
                stance.see(side, contact.weight, ground_point(alone[side], contact.point), heading);
            }
        }
    }
    stances
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
