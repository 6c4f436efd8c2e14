//! Driven clips: sequences that nobody recorded, beside those that were.
//!
//! A clip's frames follow those of the recording; what makes them hands them over one by one. Two transitions join it to the
//! graph: one from where the actor is when it is told to perform, one back to a recorded frame that resembles the clip's end.

use std::rc::Rc;

use actor::blend::transition_placement;
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround};
use actor::temporal_warp::TemporalWarp;
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, Walk};
use glam::Vec3;
use synthesis::FrameKind;

use super::loading::Actor;
use super::{Goal, Player, PlayerError};

/// A clip.
pub struct Clip {
    name: String,
    /// The recorded frame whose looks it has.
    like: u32,
    /// Its frames, as far as they were made.
    poses: Vec<Option<Vec<Vec3>>>,
    stands: Vec<bool>,
    /// Where the actor may go on after it: frame, nodes of the blend and radians of each.
    exits: Vec<[f32; 3]>,
    /// Index of the transition that leaves it, once that was made.
    exit: Option<u32>,
}

/// All clips, in the order of their frames.
#[derive(Default)]
pub struct Driven {
    /// Frames that were recorded; 0 as long as there is no clip.
    recorded: u32,
    clips: Vec<Clip>,
    /// The graph of the recording alone.
    pub graph: Option<Rc<EssentialGraph>>,
}

impl Driven {
    /// Whether `frame` belongs to a clip.
    #[must_use]
    pub fn has(&self, frame: u32) -> bool {
        !self.clips.is_empty() && frame >= self.recorded
    }

    /// Which clip `frame` belongs to, and which of its frames it is.
    fn find(&self, frame: u32) -> Option<(usize, usize)> {
        let mut at = frame.checked_sub(self.recorded).filter(|_| self.has(frame))? as usize;
        for (index, clip) in self.clips.iter().enumerate() {
            if at < clip.poses.len() {
                return Some((index, at));
            }
            at -= clip.poses.len();
        }
        None
    }

    /// The first frame of a clip.
    fn first(&self, clip: usize) -> u32 {
        self.recorded + self.clips[..clip].iter().map(|clip| clip.poses.len() as u32).sum::<u32>()
    }

    /// The pose of `frame`, which belongs to a clip, once it was made.
    #[must_use]
    pub fn pose(&self, frame: u32) -> Option<&[Vec3]> {
        let (clip, at) = self.find(frame)?;
        self.clips[clip].poses[at].as_deref()
    }

    /// The recorded frame whose looks `frame` has.
    #[must_use]
    pub fn worn(&self, frame: u32) -> u32 {
        self.find(frame).map_or(frame, |(clip, _)| self.clips[clip].like)
    }

    /// The sequences of all clips.
    fn sequences(&self) -> Vec<Sequence> {
        let mut first_frame = self.recorded;
        let sequence = |clip: &Clip| {
            let frame_count = clip.poses.len() as u32;
            first_frame += frame_count;
            let first_frame = first_frame - frame_count;
            Sequence { name: clip.name.clone(), labels: Vec::new(), first_frame, frame_count, cyclic: false }
        };
        self.clips.iter().map(sequence).collect()
    }
}

impl Player {
    /// Adds a clip of as many frames as `stands` has for each foot, after all others; its frames are still to come
    /// ([`Self::set_edited`]). `exits` are where the actor may go on afterwards, the best first. The first frame.
    ///
    /// # Errors
    /// The actor has not arrived, or the clip has no frame.
    pub fn drive(
        &mut self,
        name: &str,
        (count, like): (u32, u32),
        mut stands: Vec<bool>,
        exits: &[f32],
    ) -> Result<u32, PlayerError> {
        let (actor, graph) = self.ready(like)?;
        stands.resize(count as usize * graph.feet().count(), false);
        let driven = &mut self.loading.source.driven;
        if driven.clips.is_empty() {
            (driven.recorded, driven.graph) = (actor.timeline.frame_count(), Some(graph));
        }
        let poses = vec![None; count as usize];
        let exits = exits.chunks_exact(3).map(|exit| [exit[0], exit[1], exit[2]]).collect();
        driven.clips.push(Clip { name: name.into(), like, poses, stands, exits, exit: None });
        let first = driven.first(driven.clips.len() - 1);
        let extended = self.extend_by(&actor, None);
        if extended.is_err() {
            self.loading.source.driven.clips.pop();
        }
        extended.map(|()| first)
    }

    /// Lays timeline and graph out anew: those of the recording, then all clips, with the transitions that were added so far
    /// and one `more`.
    fn extend_by(&mut self, actor: &Actor, more: Option<Transition>) -> Result<(), PlayerError> {
        let driven = &self.loading.source.driven;
        let (Some(base), Some(graph)) = (&driven.graph, &self.loading.graph) else { return Err(PlayerError::NotLoaded) };
        let sequences = [actor.recorded.sequences(), &driven.sequences()].concat();
        let wrong = |_| PlayerError::NoFrame(driven.recorded);
        let timeline = Timeline::new(actor.timeline.fps(), sequences).map_err(|_| PlayerError::NoFrame(driven.recorded))?;
        let stands: Vec<bool> = driven.clips.iter().flat_map(|clip| &clip.stands).copied().collect();
        let added = graph.transitions()[base.transitions().len()..].iter().cloned().chain(more).collect();
        let mut extended = base.extended(&timeline, base.feet().clone().followed_by(&stands), added).map_err(wrong)?;
        extended.set_alpha(graph.alpha()).map_err(wrong)?;
        self.loading.graph = Some(Rc::new(extended));
        if let Some(actor) = &mut self.loading.actor {
            actor.timeline = Rc::new(timeline);
        }
        self.plans.forget();
        Ok(())
    }

    /// Takes a frame of a clip, in metres.
    pub(super) fn set_driven(&mut self, frame: u32, pose: Vec<Vec3>) {
        if let Some((clip, at)) = self.loading.source.driven.find(frame) {
            self.loading.source.driven.clips[clip].poses[at] = Some(pose);
        }
    }

    /// Performs the clip whose first frame is `first`, from where the actor is: blended in over so many `nodes`, between
    /// postures that are so many `radians` apart; then the actor goes back to what was recorded and plays on. The frames between
    /// which it blends: from and to of the way in, from and to of the way back.
    ///
    /// # Errors
    /// There is no such clip, or the frames of its beginning or its end have not been made.
    pub fn perform(&mut self, first: u32, nodes: u32, radians: f32) -> Result<[u32; 4], PlayerError> {
        let (actor, graph) = self.ready(first)?;
        let Some((clip, 0)) = self.loading.source.driven.find(first) else { return Err(PlayerError::NoFrame(first)) };
        let exit = self.exit(&actor, clip)?;
        let from = self.departure(&graph);
        let count = self.loading.source.driven.clips[clip].poses.len() as u32;
        let nodes = nodes.clamp(1, count);
        let left = (1..nodes).take_while(|&step| actor.timeline.offset(from, step.into()).is_some()).count();
        let to = first + nodes - 1;
        let entry = self.join(&actor, (from, to), (left + 1, nodes as usize), radians)?;
        let (actor, graph) = self.ready(first)?;
        let legs = [vec![Leg::Synthetic(entry)], self.back(&actor, &graph, to, exit)].concat();
        let left = self.producer.retarget(&actor, &graph, &Walk { legs, ..Walk::default() });
        left.map_err(|_| PlayerError::Unreachable { from, to })?;
        (self.goal, self.playing, self.stalled) = (Some(Goal::PlayOn), true, None);
        let out = &graph.transitions()[exit as usize];
        Ok([from, to, out.from, out.to])
    }

    /// Recorded frames of a clip from `frame` to where the transition `exit` leaves, and that.
    fn back(&self, actor: &Actor, graph: &EssentialGraph, frame: u32, exit: u32) -> Vec<Leg> {
        let from = graph.transitions()[exit as usize].from;
        let steps = from.saturating_sub(frame);
        // Past where it leaves the clip is gone back.
        let way = match frame.saturating_sub(from) {
            0 => Leg::Recorded { first: frame, last: from, steps },
            back => Leg::Back { first: frame, last: from, steps: back },
        };
        let stays = frame == from || actor.timeline.sequence_index(frame) != actor.timeline.sequence_index(from);
        [if stays { vec![] } else { vec![way] }, vec![Leg::Synthetic(exit)]].concat()
    }

    /// The transition that leaves a clip, made when it is first needed.
    fn exit(&mut self, actor: &Actor, clip: usize) -> Result<u32, PlayerError> {
        let driven = &self.loading.source.driven;
        let first = driven.first(clip);
        let Clip { poses, exits, exit, .. } = &driven.clips[clip];
        if let Some(exit) = *exit {
            return Ok(exit);
        }
        let count = poses.len() as u32;
        let main = self.main.as_deref().unwrap_or_default();
        let fits = |&&[to, nodes, _]: &&[f32; 3]| {
            let to = to as u32;
            let is_main = main.get(to as usize).copied().unwrap_or(false);
            is_main && actor.recorded.offset(to, 1 - nodes as i64).is_some()
        };
        let best = exits.iter().find(fits).or_else(|| exits.iter().find(|exit| actor.recorded.offset(exit[0] as u32, 1 - exit[1] as i64).is_some()));
        let Some(&[to, nodes, radians]) = best else { return Err(PlayerError::Unreachable { from: first, to: first }) };
        let nodes = (nodes as u32).clamp(1, count);
        let ends = (first + count - nodes, to as u32);
        let made = self.join(actor, ends, (nodes as usize, nodes as usize), radians)?;
        self.loading.source.driven.clips[clip].exit = Some(made);
        Ok(made)
    }

    /// Adds a transition between two frames over segments of so many frames; its index.
    fn join(
        &mut self,
        actor: &Actor,
        (from, to): (u32, u32),
        (li, lj): (usize, usize),
        radians: f32,
    ) -> Result<u32, PlayerError> {
        let graph = self.loading.graph.clone().ok_or(PlayerError::NotLoaded)?;
        let warp = TemporalWarp::even(li, lj);
        let mut memory = PoseMemory::default();
        let mut ground = PosesOnGround::new(&mut self.loading.source, actor.topology.weights(), &mut memory);
        let placement = transition_placement(&actor.timeline, &mut ground, (from, to), &warp, graph.contacts())?;
        // About what a pose distance adds up to where both sides are so far apart in the middle.
        let deformation = 0.5 * radians * warp.duration() as f32;
        self.extend_by(actor, Some(Transition { from, to, deformation, warp, placement }))?;
        Ok(graph.transitions().len() as u32)
    }

    /// Legs from where the actor can leave back to what was recorded, and the frame that they end with: none where it is there.
    pub(super) fn home(&mut self, actor: &Actor) -> Result<(Vec<Leg>, u32), PlayerError> {
        let graph = self.graph(actor).ok_or(PlayerError::NotLoaded)?;
        let from = self.departure(&graph);
        let Some((clip, _)) = self.loading.source.driven.find(from) else { return Ok((Vec::new(), from)) };
        let exit = self.exit(actor, clip)?;
        let graph = self.graph(actor).ok_or(PlayerError::NotLoaded)?;
        Ok((self.back(actor, &graph, from, exit), graph.transitions()[exit as usize].to))
    }

    /// `walk`, which begins in a recorded frame, after the `legs` that lead there.
    pub(super) fn after_home(graph: &EssentialGraph, legs: Vec<Leg>, walk: &Walk) -> Walk {
        if legs.is_empty() {
            return walk.clone();
        }
        let steps: u32 = legs.iter().map(|leg| leg.steps(graph)).sum();
        let bend = match walk.bend.as_slice() {
            [] => Vec::new(),
            bend => [vec![[0.0; 3]; steps as usize], bend.to_vec()].concat(),
        };
        Walk { legs: [legs, walk.legs.clone()].concat(), bend, ..walk.clone() }
    }

    /// Removes the clip whose first frame is `first`; the frames of those after it move up. An actor that has to do with any clip
    /// stands where it is, in a recorded frame.
    ///
    /// # Errors
    /// There is no such clip.
    pub fn undrive(&mut self, first: u32) -> Result<(), PlayerError> {
        let (actor, _) = self.ready(first)?;
        let Some((clip, 0)) = self.loading.source.driven.find(first) else { return Err(PlayerError::NoFrame(first)) };
        self.leave_clips(&actor)?;
        let driven = &mut self.loading.source.driven;
        driven.clips.remove(clip);
        driven.clips.iter_mut().for_each(|clip| clip.exit = None);
        let alpha = self.loading.graph.as_ref().map(|graph| graph.alpha());
        self.loading.graph.clone_from(&driven.graph);
        if let (Some(graph), Some(alpha)) = (&mut self.loading.graph, alpha) {
            // It was taken before.
            let _ = Rc::make_mut(graph).set_alpha(alpha);
        }
        self.producer.forget_poses();
        self.extend_by(&actor, None)
    }

    /// Stands in a recorded frame where a clip, or a transition to or from one, is shown or on the way.
    fn leave_clips(&mut self, actor: &Actor) -> Result<(), PlayerError> {
        let driven = &self.loading.source.driven;
        let own = driven.graph.as_ref().map_or(0, |graph| graph.transitions().len() as u32);
        let has = |frame: u32| driven.has(frame);
        let is_on_way = |leg: &Leg| match *leg {
            Leg::Synthetic(edge) => edge >= own,
            Leg::Recorded { first, .. } | Leg::Back { first, .. } => has(first),
        };
        let is_shown = |kind: FrameKind| kind.transition().is_some_and(|edge| edge >= own) || has(kind.frame());
        let shown = [&self.last, &self.next].into_iter().flatten().any(|frame| is_shown(frame.kind));
        if !shown && !self.producer.walker().is_some_and(|walker| walker.legs().iter().any(is_on_way)) {
            return Ok(());
        }
        let like = self.nearer().map(|shown| driven.worn(shown.kind.frame()));
        match like.filter(|_| shown) {
            Some(frame) => self.seek(f64::from(frame.min(actor.recorded.frame_count() - 1))),
            None => {
                self.drop_route();
                Ok(())
            }
        }
    }
}
