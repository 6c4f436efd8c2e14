//! Following the walks that searches find: where one would leave from, setting off, going on, and standing somewhere.

use actor::graph::EssentialGraph;
use actor::walk::Walk;
use glam::{Vec2, Vec3Swizzles};
use kernels::align::{Placement, centre_of_mass};

use super::loading::Actor;
use super::report::PlanReport;
use super::{Goal, Player, PlayerError};

impl Player {
    /// Where a walk from the present would begin: the frame, and its placement. That is the end of a transition under
    /// way.
    ///
    /// # Errors
    /// There is no actor or no graph yet, or a frame cannot be read.
    pub fn leaves(&mut self) -> Result<(u32, Placement), PlayerError> {
        let (actor, graph) = self.ready(0)?;
        Ok(self.producer.departure(&mut self.loading, &actor, &graph)?)
    }

    /// Sets off on `walk`, which begins where [`Self::leaves`] says now, and arrives at its end.
    ///
    /// # Errors
    /// The walk begins elsewhere, or is empty.
    pub fn follow(&mut self, start: u32, walk: &Walk) -> Result<PlanReport, PlayerError> {
        let (actor, graph) = self.ready(start)?;
        let from = self.departure(&graph);
        let to = walk.end(&graph).filter(|_| from == start).ok_or(PlayerError::Unreachable { from, to: start })?;
        self.leave(&actor, &graph, to, walk)?;
        Ok(PlanReport::new(walk, to, &graph, &actor.timeline))
    }

    /// Leaves for frame `to` by `walk`, which begins at the present.
    pub(super) fn leave(
        &mut self,
        actor: &Actor,
        graph: &EssentialGraph,
        to: u32,
        walk: &Walk,
    ) -> Result<(), PlayerError> {
        let left = self.producer.retarget(actor, graph, walk);
        left.map_err(|_| PlayerError::Unreachable { from: self.departure(graph), to })?;
        self.goal = Some(Goal::Target(to));
        self.playing = true;
        self.stalled = None;
        Ok(())
    }

    /// Goes on with `walk` where the walk under way ends. False where none is under way, or it ends elsewhere.
    pub fn extend(&mut self, start: u32, walk: &Walk) -> bool {
        let (Ok((actor, graph)), Some(Goal::Target(end))) = (self.ready(start), self.goal) else { return false };
        let Some(to) = walk.end(&graph) else { return false };
        if end != start || self.producer.extend(&actor, &graph, walk).is_err() {
            return false;
        }
        self.goal = Some(Goal::Target(to));
        true
    }

    /// Stands in `frame` with the centre of mass over `ground` (X, Z), turned by `heading`; a walk is dropped.
    ///
    /// # Errors
    /// As [`Self::seek`].
    pub fn stand(&mut self, frame: u32, ground: Vec2, heading: f32) -> Result<(), PlayerError> {
        let actor = self.loading.actor.clone().ok_or(PlayerError::NotLoaded)?;
        let recorded = self.recorded_pose(frame)?;
        let centre = centre_of_mass(&recorded, actor.topology.weights());
        self.stand_in(frame, Placement::turning(heading, centre.xz(), ground))
    }

    /// Stands in `frame`, placed; a walk is dropped.
    ///
    /// # Errors
    /// As [`Self::seek`], and a placement that is not finite.
    pub fn stand_in(&mut self, frame: u32, placement: Placement) -> Result<(), PlayerError> {
        if !(placement.translation.is_finite() && placement.heading.is_finite()) {
            return Err(PlayerError::NoFrame(frame));
        }
        self.leave_variety();
        let frame = self.recorded(frame, placement)?;
        self.goal = None;
        self.playing = false;
        self.show_at(frame, None, 0.0);
        Ok(())
    }
}
