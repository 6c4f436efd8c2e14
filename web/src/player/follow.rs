//! Following the walks that searches find: where one would leave from, setting off, going on, and standing somewhere.

use actor::walk::Walk;
use glam::{Vec2, Vec3Swizzles};
use kernels::align::{Placement, centre_of_mass};

use super::plan::{Goal, Plan, PlanReport, Route, Stretch};
use super::{Player, PlayerError};

impl Player {
    /// Where a walk from the present would begin: the frame, and its placement. That is the end of a transition under
    /// way.
    ///
    /// # Errors
    /// There is no actor or no graph yet, or a frame cannot be read.
    pub fn leaves(&mut self) -> Result<(u32, Placement), PlayerError> {
        let (actor, graph) = self.ready(0)?;
        let inside = self.route.as_ref().is_some_and(|route| route.inside().is_some());
        let end = if inside {
            self.producer.transition_end(&mut self.loading, &actor.timeline, &graph)?
        } else {
            self.next.as_ref().or(self.last.as_ref()).map(|frame| frame.placement)
        };
        Ok((self.departure(&graph), end.unwrap_or(Placement::IDENTITY)))
    }

    /// Sets off on `walk`, which begins where [`Self::leaves`] says now, and arrives at its end.
    ///
    /// # Errors
    /// The walk begins elsewhere, or is empty.
    pub fn follow(&mut self, start: u32, walk: &Walk) -> Result<PlanReport, PlayerError> {
        let (actor, graph) = self.ready(start)?;
        let from = self.departure(&graph);
        let plan = Plan::of_walk(start, walk, &graph);
        let Some(to) = walk_end(start, walk, &graph) else { return Err(PlayerError::Unreachable { from, to: start }) };
        if from != start {
            return Err(PlayerError::Unreachable { from, to: start });
        }
        let goal = Goal::Target(to);
        self.route = Some(match &self.route {
            Some(route) => route.redirected(&plan, goal),
            None => Route::new(&plan, goal),
        });
        self.playing = true;
        self.stalled = None;
        Ok(plan.report(to, &graph, &actor.timeline))
    }

    /// Goes on with `walk` where the walk under way ends. False where none is under way, or it ends elsewhere.
    pub fn extend(&mut self, start: u32, walk: &Walk) -> bool {
        let (Ok((_, graph)), Some(route)) = (self.ready(start), &mut self.route) else { return false };
        let (Goal::Target(end), Some(to)) = (route.goal, walk_end(start, walk, &graph)) else { return false };
        if end != start {
            return false;
        }
        route.goal = Goal::Target(to);
        route.extend(walk.legs.iter().copied().map(Stretch::Walk));
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
        let frame = self.recorded(frame, placement)?;
        self.route = None;
        self.playing = false;
        self.show_at(frame, None, 0.0);
        Ok(())
    }
}

/// The frame that `walk` ends with; `None` where it has no legs.
fn walk_end(start: u32, walk: &Walk, graph: &actor::graph::EssentialGraph) -> Option<u32> {
    use actor::walk::Leg;
    walk.legs
        .iter()
        .try_fold(start, |_, leg| match *leg {
            Leg::Recorded { last, .. } => Some(last),
            Leg::Synthetic(edge) => graph.transitions().get(edge as usize).map(|transition| transition.to),
        })
        .filter(|_| !walk.legs.is_empty())
}
