//! A clip as the actor does it: what its frames are made of, and where it joins the recording.

use driving::plant::{Free, Planted, bones};
use driving::{Aim, Apart, End, Likeness, Look, Mapping, MappingFile, Plan, Role, strength};
use editing::Rigid;
use glam::Vec3;
use mocap::Options;

use crate::actor::DrivenActor;
use crate::error::DriverError;

/// Seconds that a clip may last.
const MOST_SECONDS: u32 = 600;
/// What is recorded after the frame at which the actor comes back should last so long, in seconds: it goes on there.
const GOES_ON: f32 = 1.0;
/// What it costs that it does not, and that a blend has no room at all, in metres.
const ENDS: f32 = 0.3;
const NO_ROOM: f32 = 0.5;
/// Time over which speeds are told at a clip's ends, in seconds.
const STEP: f32 = 0.1;

/// Where the actor goes on after a clip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exit {
    /// The recorded frame at which the blend arrives.
    pub to: u32,
    /// Nodes of the blend.
    pub nodes: usize,
}

/// A clip that is being made.
pub struct DrivenClip {
    free: Free,
    /// As it is performed.
    planted: Planted,
    /// Its bones as it was driven, before any edit.
    motions: Vec<Vec<Rigid>>,
    /// Frames at its ends that were made ahead of time, as they are performed.
    made: Vec<Option<Vec<Vec3>>>,
    /// Sentences for whoever dropped it.
    pub notes: Vec<String>,
    /// The recorded frame whose looks it has.
    pub like: u32,
}

impl DrivenClip {
    /// The clip in `files`, done by `actor`.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn new(actor: &DrivenActor, files: &[(&str, &[u8])]) -> Result<Self, DriverError> {
        let file = || files.last().map_or("the clip", |(name, _)| name).to_owned();
        let (clip, notes) = mocap::read(files, &Options::default())?;
        let mut notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
        let mapping = Mapping::of(&clip, &MappingFile::default());
        let mapping = mapping.map_err(|_| DriverError::NoLegs(file()))?;
        let missing: Vec<&str> = mapping.missing().into_iter().map(Role::name).collect();
        if !missing.is_empty() {
            notes.push(format!("the skeleton has no {}: these parts stay as they are", missing.join(", ")));
        }
        let fps = actor.known.timeline.fps();
        let seconds = (clip.len() as f32 / clip.rate()) as u32;
        if seconds > MOST_SECONDS {
            return Err(DriverError::Long { file: file(), seconds, most: MOST_SECONDS });
        }
        let plan = Plan::new((&clip, &mapping), &actor.body, fps);
        let Plan { free, planted, stands } = plan.map_err(|cause| DriverError::Clip { file: file(), cause })?;
        if !stands {
            notes.push("no foot ever stands, as in a walk on the spot: nothing is planted".into());
        }
        let motions = bones(&actor.body, &planted);
        let like = like(actor, &motions);
        let made = vec![None; motions.len()];
        Ok(Self { free, planted, motions, made, notes, like })
    }

    /// Edits the clip's ends towards recorded postures, in place of those before; none takes it back to how it was driven. How far the body
    /// is from each posture as it was driven, and now, in metres: means over its joints, as seen from the body.
    pub fn edit(&mut self, actor: &DrivenActor, aims: &[Aim], recorded: &[Vec<Rigid>]) -> Vec<[f32; 2]> {
        let planted = self.free.planted(&actor.body, aims);
        for (frame, made) in self.made.iter_mut().enumerate() {
            if planted.frames[frame] != self.planted.frames[frame] {
                *made = None;
            }
        }
        self.planted = planted;
        let look = |motions: &[Rigid]| Look::new(&actor.body, motions);
        let apart = |a: &Look, b: &Look| driving::join::apart([[a; 2], [b; 2]], 1.0).metres;
        let measured = aims.iter().zip(recorded).map(|(aim, recorded)| {
            let (wanted, driven) = (look(recorded), look(&self.motions[aim.frame]));
            let edited = look(&actor.body.motions(&self.planted.frames[aim.frame].pose));
            [apart(&driven, &wanted), apart(&edited, &wanted)]
        });
        measured.collect()
    }

    /// The edit of one of its ends: in `frame` the body is to stand as in `recorded`.
    #[must_use]
    pub fn aim(&self, actor: &DrivenActor, recorded: &[Rigid], frame: usize, inwards: bool) -> Aim {
        let fps = actor.known.timeline.fps();
        Aim::new(&actor.body, [recorded, &self.motions[frame]], (frame, fps), inwards)
    }

    /// How much of `aim` is done where so many frames of this end are blended with the `recorded` ones.
    #[must_use]
    pub fn strength(&self, actor: &DrivenActor, aim: &Aim, recorded: &[Vec<Rigid>], nodes: usize) -> f32 {
        let first = if aim.inwards { 0 } else { self.count() };
        let free = (&self.free, actor.known.timeline.fps());
        strength((&actor.body, &actor.masses), free, aim, &End { recorded, nodes: nodes.min(self.count()), first })
    }

    /// Frames.
    #[must_use]
    pub fn count(&self) -> usize {
        self.motions.len()
    }

    /// Vertex positions of a frame, in metres; `None` beyond the last one.
    ///
    /// # Errors
    /// A surface that cannot be solved for.
    pub fn make(&self, actor: &mut DrivenActor, frame: usize) -> Result<Option<Vec<Vec3>>, DriverError> {
        if let Some(Some(made)) = self.made.get(frame) {
            return Ok(Some(made.clone()));
        }
        let Some(planted) = self.planted.frames.get(frame) else { return Ok(None) };
        Ok(Some(actor.surface.frame(&actor.body, planted, &mut actor.solver)?))
    }

    /// Makes one more frame ahead of time, of those that blends of so many nodes at its beginning and its end need; whether there was
    /// one to be made.
    ///
    /// # Errors
    /// As [`Self::make`].
    pub fn make_ahead(&mut self, actor: &mut DrivenActor, nodes: [usize; 2]) -> Result<bool, DriverError> {
        let count = self.count();
        let mut ends = (0..nodes[0].min(count)).chain(count.saturating_sub(nodes[1])..count);
        let Some(next) = ends.find(|&frame| self.made[frame].is_none()) else { return Ok(false) };
        self.made[next] = self.make(actor, next)?;
        Ok(true)
    }

    /// Frame after frame, for each foot of the actor whether it stands.
    #[must_use]
    pub fn stands(&self, actor: &DrivenActor) -> Vec<bool> {
        let stand = |feet: &[driving::plant::Standing; 2], side: Option<usize>| {
            side.is_some_and(|side| feet[side].flat.is_some())
        };
        let frames = self.planted.frames.iter();
        frames.flat_map(|frame| actor.sides.iter().map(|&side| stand(&frame.feet, side))).collect()
    }

    /// The postures of two frames, the first of them a moment before the second.
    fn moment(&self, actor: &DrivenActor, frame: usize) -> ([Look; 2], f32) {
        let fps = actor.known.timeline.fps();
        let step = ((STEP * fps).round() as usize).clamp(1, (self.count() - 1).max(1));
        let frame = frame.clamp(step.min(self.count() - 1), self.count() - 1);
        let looks = [frame.saturating_sub(step), frame].map(|frame| Look::new(&actor.body, &self.motions[frame]));
        (looks, step as f32 / fps)
    }

    /// How many nodes a blend from the recorded `pose` to the clip's beginning has.
    #[must_use]
    pub fn entry(&self, actor: &DrivenActor, pose: &[Vec3]) -> usize {
        let fps = actor.known.timeline.fps();
        let from = Look::new(&actor.body, &actor.body.rig.fit(pose));
        let to = Look::new(&actor.body, &self.motions[0]);
        let apart = driving::join::apart([[&from; 2], [&to; 2]], 1.0);
        apart.blend(fps).min(self.count()).max(2)
    }

    /// Where the actor goes on after the clip: where what was recorded looks most as the clip's end does. `None` where nothing
    /// recorded is longer than a moment.
    #[must_use]
    pub fn exit(&self, actor: &DrivenActor) -> Option<Exit> {
        let fps = actor.known.timeline.fps();
        let mut best: Option<(f32, Exit)> = None;
        let shortest = Apart { metres: 0.0 }.blend(fps);
        let (looks, seconds) = self.moment(actor, (self.count() - 1).saturating_sub(shortest / 2));
        for (at, (frame, _, look)) in actor.recorded.iter().enumerate() {
            let Some(before) = self.recorded_before(actor, at, seconds) else { continue };
            let lag = (frame - actor.recorded[before].0) as f32 / fps;
            let recorded = [&actor.recorded[before].2, look];
            // Speeds are held against each other over times that are nearly alike.
            let apart = driving::join::apart([[&looks[0], &looks[1]], recorded], lag.max(seconds));
            let nodes = apart.blend(fps).min(self.count()).max(2);
            let timeline = &actor.known.timeline;
            let to = (1..=nodes as i64 / 2).rev().find_map(|steps| timeline.offset(*frame, steps)).unwrap_or(*frame);
            let room = (1..=nodes).rev().find(|&room| timeline.offset(to, 1 - room as i64).is_some()).unwrap_or(1);
            let ends = timeline.offset(to, (GOES_ON * fps) as i64).is_none();
            let short = 1.0 - room as f32 / nodes as f32;
            let cost = apart.metres + f32::from(u8::from(ends)) * ENDS + short * NO_ROOM;
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, Exit { to, nodes: room }));
            }
        }
        best.map(|(_, exit)| exit)
    }

    /// The recorded frame about `seconds` before that of index `at`, in its sequence.
    fn recorded_before(&self, actor: &DrivenActor, at: usize, seconds: f32) -> Option<usize> {
        let timeline = &actor.known.timeline;
        let frame = actor.recorded[at].0;
        let lag = (seconds * timeline.fps()).round() as u32;
        let before = (0..at).rev().find(|&before| frame - actor.recorded[before].0 >= lag.max(1))?;
        (timeline.sequence_index(actor.recorded[before].0) == timeline.sequence_index(frame)).then_some(before)
    }
}

/// The recorded frame that resembles the clip most on average: the same as in the builder, where it has been looked at.
fn like(actor: &DrivenActor, motions: &[Vec<Rigid>]) -> u32 {
    let likeness = Likeness::new(&actor.body.rig, motions);
    let wanted: Vec<u32> = Likeness::samples(actor.known.timeline.frame_count() as usize).collect();
    let looked = actor.recorded.iter().filter(|(frame, ..)| wanted.binary_search(frame).is_ok());
    let apart = looked.map(|(frame, seen, _)| (likeness.apart(&actor.body.rig, &seen.motions), *frame));
    apart.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, frame)| frame)
}
