//! Directing: what the module that searches needs to know of the actor, and setting off on the walks that it finds.
//!
//! That module has a memory of its own. The motion of all frames is in the bundle, or measured from the poses, some frames at
//! a time; so is the middle of other vertices that are to follow a path.

use std::rc::Rc;

use actor::motion::{Motion, MotionMeter, measure_group};
use actor::walk::Walk;
use glam::Vec3;
use search::Start;
use searcher::scene::Telling;

use super::loading::{Actor, Recorded};
use super::report::PlanReport;
use super::{Player, PlayerError};

/// Frames measured between two looks at the clock.
const FRAMES: u32 = 2;
/// Transitions told between two looks at the clock.
const TOLD: usize = 2000;
/// Metres and radians by which the actor may have moved since the search began.
const SAME: f32 = 1e-3;

impl Player {
    /// Works for about `milliseconds` on what searches need to know; that as words, once it is all there.
    ///
    /// # Errors
    /// The graph or a frame has not arrived.
    pub fn known(&mut self, milliseconds: f64) -> Result<Option<Vec<u32>>, PlayerError> {
        let (actor, graph) = self.ready(0)?;
        let end = (self.now)() + milliseconds;
        let motion = loop {
            match self.measure_more(&actor)? {
                Some(motion) => break motion,
                None if (self.now)() >= end => return Ok(None),
                None => {}
            }
        };
        let begin = || Box::new(Telling::new(&actor.timeline, &graph, actor.topology.vertex_count() as u32));
        let mut telling = self.directing.telling.take().unwrap_or_else(begin);
        while !telling.advance(&graph, TOLD) {
            if (self.now)() >= end {
                self.directing.telling = Some(telling);
                return Ok(None);
            }
        }
        Ok(Some(telling.finish(&actor.timeline, &graph, &motion)))
    }

    /// Learns the motion: the bundle knows it, or some more poses are measured.
    fn measure_more(&mut self, actor: &Actor) -> Result<Option<Rc<Motion>>, PlayerError> {
        let directing = &mut self.directing;
        if let Recorded::Bundle(reader) = &self.loading.source.recorded
            && let Some(motion) = reader.motion()
        {
            directing.motion.get_or_insert_with(|| Rc::new(motion.clone()));
        }
        if directing.motion.is_none() {
            let (timeline, source) = (&actor.timeline, &mut self.loading.source.recorded);
            let meter = directing.meter.get_or_insert_with(|| Box::new(MotionMeter::new(actor.topology.weights())));
            if meter.advance(timeline, source, FRAMES)?
                && let Some(meter) = directing.meter.take()
            {
                directing.motion = Some(Rc::new(meter.finish(timeline, source)?));
            }
        }
        Ok(directing.motion.clone())
    }

    /// Works for about `milliseconds` on where the middle of `vertices` is in every frame as it was recorded; that, once it is
    /// all there.
    ///
    /// # Errors
    /// A frame has not arrived, or there is no such vertex.
    pub fn middles(&mut self, vertices: &[u32], milliseconds: f64) -> Result<Option<Vec<Vec3>>, PlayerError> {
        let (actor, _) = self.ready(0)?;
        let directing = &mut self.directing;
        let count = actor.topology.vertex_count();
        if let Some(&vertex) = vertices.iter().find(|&&vertex| vertex as usize >= count) {
            return Err(PlayerError::NoVertex(vertex));
        }
        if directing.group != vertices {
            (directing.group, directing.middles) = (vertices.to_vec(), Vec::new());
        }
        let end = (self.now)() + milliseconds;
        let source = &mut self.loading.source.recorded;
        while !measure_group(&actor.timeline, source, count, vertices, &mut directing.middles, FRAMES)? {
            if (self.now)() >= end {
                return Ok(None);
            }
        }
        Ok(Some(std::mem::take(&mut directing.middles)))
    }

    /// Sets off on a walk that a search has `found` from `start`. Where it may begin `anywhere`, the actor is put there
    /// first.
    ///
    /// # Errors
    /// The walk is empty or none of this actor, or the actor is not where it begins any more.
    pub fn set_off(&mut self, start: &Start, found: Walk, anywhere: bool) -> Result<PlanReport, PlayerError> {
        let (frame, placement) = self.leaves()?;
        let wanted = start.placement;
        let walk = self.walk_of(start, found)?;
        let off = (placement.heading - wanted.heading).abs() + placement.translation.distance(wanted.translation);
        if frame != start.frame || off > SAME {
            if !anywhere {
                return Err(PlayerError::Unreachable { from: frame, to: start.frame });
            }
            self.stand_in(start.frame, wanted)?;
        }
        self.follow(start.frame, &walk)
    }

    /// Goes on with a walk `found` from `start` where the walk under way ends; whether it could.
    ///
    /// # Errors
    /// It is no walk of this actor.
    pub fn go_on(&mut self, start: &Start, found: Walk) -> Result<bool, PlayerError> {
        let walk = self.walk_of(start, found)?;
        Ok(self.extend(start.frame, &walk))
    }

    /// What was found, with its sums.
    fn walk_of(&mut self, start: &Start, found: Walk) -> Result<Walk, PlayerError> {
        let (_, graph) = self.ready(start.frame)?;
        let unreachable = PlayerError::Unreachable { from: start.frame, to: start.frame };
        let walk = Walk::of_legs(found.legs, &graph).map_err(|_| unreachable)?;
        Ok(Walk { bend: found.bend, ..walk })
    }
}
