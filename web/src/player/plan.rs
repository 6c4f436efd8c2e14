//! Planning: where a click would lead, worked out once. Hovering, clicking, previews, ghosts and links all ask here.

use std::rc::Rc;

use actor::graph::{EssentialGraph, rounded_alpha};
use actor::walk::Walk;
use glam::Vec3;
use kernels::align::Placement;
use search::{behaviours, find_behaviour, frames_of, plan_walk};

use super::loading::Actor;
use super::report::PlanReport;
use super::{Player, PlayerError};

impl Player {
    /// The cheapest walk from the present to frame `to`, without leaving.
    ///
    /// # Errors
    /// No walk, no such frame, or the graph has not arrived.
    pub fn plan(&mut self, to: u32) -> Result<PlanReport, PlayerError> {
        let (actor, graph) = self.ready(to)?;
        Ok(PlanReport::new(&*self.planned(&actor, &graph, to)?, to, &graph, &actor.timeline))
    }

    /// The frame of a behaviour, a label or the name of a sequence, that is reached at the least cost from the present.
    ///
    /// # Errors
    /// No such behaviour, no walk to it, or the graph has not arrived.
    pub fn nearest(&mut self, behaviour: &str) -> Result<u32, PlayerError> {
        let (actor, graph) = self.ready(0)?;
        let behaviours = behaviours(&actor.timeline);
        let number = find_behaviour(&behaviours, behaviour)?;
        let frames = frames_of(&behaviours[number], &actor.timeline);
        let from = self.departure(&graph);
        let walk = self.plans.search(|| plan_walk(&graph, &actor.timeline, from, &frames));
        let Some(walk) = walk else {
            let to = frames.first().copied().unwrap_or(from);
            return Err(PlayerError::Unreachable { from, to });
        };
        let to = walk.end(&graph).unwrap_or(from);
        // It is the cheapest one there, too: who goes there need not search again.
        self.plans.keep(from, to, Some(walk));
        Ok(to)
    }

    /// From now on plans weigh a frame's duration by `alpha`, where it is above 0; else as the actor came. A walk under way goes
    /// on.
    ///
    /// # Errors
    /// The graph has not arrived.
    pub fn set_quickness(&mut self, alpha: f64) -> Result<(), PlayerError> {
        let graph = self.loading.graph.as_mut().ok_or(PlayerError::NotLoaded)?;
        let own = *self.own_alpha.get_or_insert(graph.alpha());
        let alpha = if alpha > 0.0 { alpha } else { own };
        // What makes no sense changes nothing.
        if graph.alpha() != rounded_alpha(alpha) && Rc::make_mut(graph).set_alpha(alpha).is_ok() {
            self.plans.forget();
        }
        Ok(())
    }

    /// Searches for walks to poses and behaviours so far.
    #[must_use]
    pub fn plans(&self) -> u64 {
        self.plans.searches()
    }

    /// Leaves for frame `to` by the cheapest walk; a transition under way is finished first.
    ///
    /// # Errors
    /// As [`Self::plan`]; what was under way goes on then.
    pub fn go_to(&mut self, to: u32) -> Result<PlanReport, PlayerError> {
        let (actor, graph) = self.ready(to)?;
        let walk = self.planned(&actor, &graph, to)?;
        self.leave(&actor, &graph, to, &walk)?;
        if self.next.is_none() {
            self.finish_route();
        }
        Ok(PlanReport::new(&walk, to, &graph, &actor.timeline))
    }

    /// Frame `frame` in the world, where it would stand if the actor went there from the present.
    ///
    /// # Errors
    /// As [`Self::plan`], and a frame that cannot be read.
    pub fn ghost(&mut self, frame: u32) -> Result<Vec<Vec3>, PlayerError> {
        let mut pose = self.pose_of(frame)?;
        self.arrival(frame)?.apply_all(&mut pose);
        Ok(pose)
    }

    /// Placement of frame `to` if the actor goes there from the present.
    ///
    /// # Errors
    /// As [`Self::plan`].
    pub fn arrival(&mut self, to: u32) -> Result<Placement, PlayerError> {
        let (actor, graph) = self.ready(to)?;
        let walk = self.planned(&actor, &graph, to)?;
        let (from, start) = self.leaves()?;
        self.think_ahead(&actor, &graph, &walk);
        if let Some(arrival) = self.plans.arrival(from, to, start) {
            return Ok(arrival);
        }
        let arrival = self.producer.arrival(&mut self.loading, &actor, &graph, &walk.legs)?;
        self.plans.keep_arrival(from, to, [start, arrival]);
        Ok(arrival)
    }

    /// Whoever asks where `walk` arrives may soon click: a standing actor begins with the work for its first transition.
    fn think_ahead(&mut self, actor: &Actor, graph: &EssentialGraph, walk: &Walk) {
        if !self.playing && walk.transition_count() > 0 {
            self.producer.prepare_for(&mut self.loading, actor, graph, &walk.legs);
        }
    }

    fn planned(&mut self, actor: &Actor, graph: &EssentialGraph, to: u32) -> Result<Rc<Walk>, PlayerError> {
        let from = self.departure(graph);
        let walk = self.plans.walk(from, to, || plan_walk(graph, &actor.timeline, from, &[to]));
        walk.ok_or(PlayerError::Unreachable { from, to })
    }
}
