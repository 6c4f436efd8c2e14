//! Frames that are made elsewhere: a clip of motion capture is performed before the actor goes on from where it ends.

use glam::{Vec2, Vec3};
use kernels::align::{Placement, centre_of_mass};
use synthesis::FrameKind;

use super::loading::Origin;
use super::produce::ShownFrame;
use super::{Player, PlayerError};

impl Player {
    /// From now on the actor stands in recorded frame `frame`, placed, and goes on from there; but first `count` frames are
    /// shown that are still to be [given](Self::give).
    ///
    /// # Errors
    /// There is no such frame, or a transition is under way.
    pub fn expect(&mut self, frame: u32, placement: Placement, count: u32) -> Result<(), PlayerError> {
        let (actor, _) = self.ready(frame)?;
        if self.producer.walker().is_some_and(|walker| walker.inside().is_some()) {
            return Err(PlayerError::NotLoaded);
        }
        self.leave_variety();
        self.goal = None;
        self.producer.stand(&actor, frame, placement);
        (self.expected, self.playing) = (count, true);
        Ok(())
    }

    /// Takes the next of the expected frames: world positions, the recorded frames `from` and `to` whose looks it has, as much
    /// of the latter as `lambda` says, and its turn about +Y. Without positions it takes none. How many frames wait to be shown, how many
    /// are to come.
    pub fn give(&mut self, pose: Vec<Vec3>, [from, to]: [u32; 2], lambda: f32, heading: f32) -> [u32; 2] {
        let shape = self.loading.actor.as_ref().map(|actor| std::rc::Rc::clone(&actor.topology));
        if let Some(topology) = shape.filter(|shape| self.expected > 0 && pose.len() == shape.vertex_count()) {
            self.expected -= 1;
            let centre = centre_of_mass(&pose, topology.weights());
            let (source_frame, destination_frame) = (from, to);
            // It belongs to no transition of the graph.
            let synthetic =
                FrameKind::Synthetic { transition: u32::MAX, node: 0, lambda, source_frame, destination_frame };
            let kind = if lambda > 0.0 { synthetic } else { FrameKind::Recorded { frame: from } };
            let placement = Placement { heading, translation: Vec2::ZERO };
            let ground = Vec2::new(centre.x, centre.z);
            let number = self.producer.count();
            self.given.push_back(ShownFrame { number, pose, kind, placement, ground, origin: Origin::Made });
        }
        [self.given.len() as u32, self.expected]
    }

    /// Whether frames are shown, or to be shown, that are none of the actor's own.
    pub(super) fn is_given(&self) -> bool {
        self.expected > 0 || !self.given.is_empty()
    }

    /// Forgets them.
    pub(super) fn forget_given(&mut self) {
        self.given.clear();
        self.expected = 0;
    }
}
