//! A grab over the ground: handles do not go below it, and a surface that has come to rest below it is held there.

use glam::Vec3;

use crate::error::EditError;
use crate::floor::{ROUNDS, layer, lift, lowest};
use crate::grab::{By, Editor, Grab, REST};

impl Grab {
    /// From now on nothing goes below `ground`, the height in metres of what the body stands on, or below where it is lowest.
    pub fn stand_on(&mut self, ground: f32) {
        (self.ground, self.floor) = (ground, ground.min(lowest(&self.pose)));
    }

    /// Where the handles may go of where they are wanted; a note for each that may not.
    pub(crate) fn allowed(&self, to: &[Vec3], notes: &mut Vec<String>) -> Vec<Vec3> {
        let allowed = |(&to, &vertex): (&Vec3, &u32)| {
            if to.y < self.floor {
                notes.push(format!("vertex {vertex} stops at the ground"));
            }
            // What is not finite is refused, not moved.
            if to.is_finite() { to.with_y(to.y.max(self.floor)) } else { to }
        };
        to.iter().zip(&self.grip().handles).map(allowed).collect()
    }
}

impl Editor {
    /// Holds where the ground is what of a grab without bones has come to rest below it: whether there was anything, so that it has to
    /// come to rest again.
    pub(crate) fn hold_above(&mut self, grab: &mut Grab) -> Result<bool, EditError> {
        if matches!(grab.by, By::Bones(_)) || grab.rounds == ROUNDS {
            return Ok(false);
        }
        let moved = grab.moved();
        let layer = layer(&moved, grab.floor, grab.held.vertices());
        if layer.is_empty() {
            return Ok(false);
        }
        grab.rounds += 1;
        let by = layer.iter().map(|&vertex| moved[vertex as usize].with_y(grab.floor) - grab.pose[vertex as usize]);
        grab.stopped.extend(by);
        let held: Vec<u32> = grab.held.vertices().iter().copied().chain(layer).collect();
        grab.held = self.deformer.hold(&grab.pose, &held, REST)?;
        if let (By::Modes { .. }, Some(space)) = (&grab.by, &self.space) {
            let mut anew = self.by_modes(space, &grab.pose, grab.grip(), &grab.held);
            anew.set_prior(grab.drawn.prior(self.prior));
            if let By::Modes { learned, .. } = &mut grab.by {
                **learned = anew;
            }
        }
        Ok(true)
    }

    /// Lifts what is still below the ground.
    pub(crate) fn lift(&mut self, grab: &mut Grab, anchor: f32) -> Result<(), EditError> {
        let mut moved = grab.moved();
        if lift(&mut self.deformer, &mut moved, grab.held.vertices(), anchor, grab.floor)? {
            grab.displacements = moved.iter().zip(&grab.pose).map(|(&moved, &point)| moved - point).collect();
        }
        Ok(())
    }
}
