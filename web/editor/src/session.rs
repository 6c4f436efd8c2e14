//! The edits of one actor on a page: a document, the frames that it reaches, and what is being dragged.

use actor::pose_source::{PoseError, PoseSource};
use bundle::{decode_learned_space, decode_rig};
use editing::{EditDocument, EditError, Editor, Edits, Grab, PreparedError, Recording, StoredRig, StoredSpace};
use glam::Vec3;
use thiserror::Error;

use crate::scene::Known;

/// Why something cannot be edited.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SessionError {
    /// The edits make no sense, or none for this actor.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// A recorded pose was not given, or is damaged.
    #[error("a recorded pose is missing: {0}")]
    Pose(#[from] PoseError),
    /// Nothing is being dragged.
    #[error("nothing is being dragged")]
    Nothing,
    /// What was handed over does not fit together.
    #[error("what the editor knows of the actor does not fit together; load the page again")]
    Misfit,
}

impl From<PreparedError> for SessionError {
    fn from(error: PreparedError) -> Self {
        match error {
            PreparedError::Pose(error) => Self::Pose(error),
            PreparedError::Edit(error) => Self::Edit(error),
        }
    }
}

/// Recorded poses that were given.
#[derive(Default)]
struct Given(Vec<(u32, Vec<Vec3>)>);

impl Given {
    fn has(&self, frame: u32) -> bool {
        self.0.iter().any(|(given, _)| *given == frame)
    }
}

impl PoseSource for Given {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        let given = self.0.iter().find(|(given, _)| *given == frame).ok_or(PoseError::NotLoaded(frame))?;
        pose.copy_from_slice(&given.1);
        Ok(())
    }
}

/// Edits one actor.
pub struct Session {
    known: Known,
    /// The rig as long as its rest pose is not there.
    stored: Option<StoredRig>,
    rig_trouble: Option<String>,
    /// The learned space as long as the poses that it is made of are not all there, and those that are.
    learning: Option<(StoredSpace, Vec<Option<Vec<Vec3>>>)>,
    has_space: bool,
    edits: Option<Edits>,
    given: Given,
    /// The edit that is being dragged, what of it, and the frame as it was recorded.
    held: Option<(usize, Grab, Vec<Vec3>)>,
}

impl Session {
    /// Edits an actor; `rig` and `learned` are the bundle's sections, or empty.
    ///
    /// # Errors
    /// A mesh that cannot be factorised.
    pub fn new(known: Known, rig: &[u8], learned: &[u8]) -> Result<Self, SessionError> {
        let (n, frames) = (known.topology.vertex_count(), known.timeline.frame_count());
        let (stored, rig_trouble) = match (rig.is_empty(), decode_rig(rig, n, frames)) {
            (true, _) => (None, None),
            (false, Ok(stored)) => (Some(stored), None),
            (false, Err(reason)) => (None, Some(format!("the rig {reason}"))),
        };
        // Edits that go by a space that cannot be used say that there is none.
        let learning = decode_learned_space(learned, frames).ok().map(|space| {
            let poses = vec![None; space.frames.len()];
            (space, poses)
        });
        let has_space = learning.is_some();
        let (edits, given, held) = (None, Given::default(), None);
        let mut session = Self { known, stored, rig_trouble, learning, has_space, edits, given, held };
        if session.stored.is_none() {
            session.open(None)?;
        }
        Ok(session)
    }

    fn open(&mut self, rig: Option<editing::Rig>) -> Result<(), SessionError> {
        let Known { timeline, topology, order, .. } = &self.known;
        let editor = Editor::new(topology, order.as_deref(), rig)?;
        let nothing = EditDocument { version: editing::document::VERSION, edits: Vec::new() };
        self.edits = Some(Edits::new(timeline, topology.weights(), editor, nothing)?);
        Ok(())
    }

    /// Whether bones move the body.
    #[must_use]
    pub fn has_rig(&self) -> bool {
        self.edits.as_ref().is_some_and(|edits| edits.editor().rig().is_some())
    }

    /// Whether edits may go by the ways in which the actor was seen to move.
    #[must_use]
    pub fn has_space(&self) -> bool {
        self.has_space
    }

    /// Why a rig that the actor has cannot be used.
    #[must_use]
    pub fn rig_trouble(&self) -> Option<&str> {
        self.rig_trouble.as_deref()
    }

    /// Frames whose recorded poses have to be given next ([`Self::give`]).
    #[must_use]
    pub fn needs(&self) -> Vec<u32> {
        let Some(edits) = &self.edits else { return self.stored.iter().map(|stored| stored.rest_frame).collect() };
        let count = edits.document().edits.len();
        let mut frames: Vec<u32> = Vec::new();
        if let Some((space, poses)) = self.learning.as_ref().filter(|_| edits.document().wants_space()) {
            let missing = space.frames.iter().zip(poses).filter(|(_, pose)| pose.is_none());
            frames.extend(missing.map(|(&frame, _)| frame));
        }
        for frame in (0..count).flat_map(|edit| edits.needs((&self.known.timeline, &self.known.feet), edit)) {
            if !self.given.has(frame) && !frames.contains(&frame) {
                frames.push(frame);
            }
        }
        frames
    }

    /// Takes the recorded pose of a frame.
    ///
    /// # Errors
    /// A pose that is none of this mesh; a mesh that cannot be factorised.
    pub fn give(&mut self, frame: u32, pose: Vec<Vec3>) -> Result<(), SessionError> {
        if pose.len() != self.known.topology.vertex_count() || !pose.iter().all(|point| point.is_finite()) {
            return Err(SessionError::Misfit);
        }
        if let Some(stored) = self.stored.take_if(|stored| stored.rest_frame == frame) {
            let rig = stored.rig(pose.clone()).map_err(|error| self.rig_trouble = Some(error.to_string())).ok();
            self.open(rig)?;
        }
        self.learn(frame, &pose);
        if !self.given.has(frame) {
            self.given.0.push((frame, pose));
        }
        self.forget();
        Ok(())
    }

    /// Takes a pose that the learned space is made of; with the last of them it is there.
    fn learn(&mut self, frame: u32, pose: &[Vec3]) {
        let Some((space, poses)) = &mut self.learning else { return };
        if let Some(at) = space.frames.iter().position(|&of| of == frame) {
            poses[at].get_or_insert(pose.to_vec());
        }
        let Some(edits) = self.edits.as_mut().filter(|_| poses.iter().all(Option::is_some)) else { return };
        let poses: Vec<Vec<Vec3>> = poses.iter_mut().filter_map(Option::take).collect();
        let made = space.space(&poses, self.known.topology.weights());
        self.has_space = made.and_then(|space| edits.learn(space)).is_ok();
        self.learning = None;
    }

    /// Poses of frames that no edit is of are not kept.
    fn forget(&mut self) {
        let Some(edits) = &self.edits else { return };
        let known = (&self.known.timeline, &self.known.feet);
        let kept: Vec<u32> = (0..edits.document().edits.len()).flat_map(|edit| edits.needs(known, edit)).collect();
        self.given.0.retain(|(frame, _)| kept.contains(frame));
    }

    /// Takes a document in place of the one before; what is being dragged is let go.
    ///
    /// # Errors
    /// What is wrong with it, in a sentence; the document before stays.
    pub fn replace(&mut self, document: EditDocument) -> Result<(), SessionError> {
        let edits = self.edits.as_mut().ok_or(SessionError::Misfit)?;
        edits.replace(&self.known.timeline, document)?;
        self.held = None;
        self.forget();
        Ok(())
    }

    /// Frames that edit `edit` reaches; none where it is off, or none.
    #[must_use]
    pub fn reached(&self, edit: usize) -> Vec<u32> {
        let (Some(edits), timeline) = (&self.edits, &self.known.timeline) else { return Vec::new() };
        let frames = edits.frame(edit).and_then(|frame| timeline.sequence_of(frame));
        let frames = frames.map_or(0..0, |sequence| sequence.first_frame..sequence.end_frame());
        frames.filter(|&frame| edits.reaches_by(timeline, edit, frame)).collect()
    }

    /// One step of making edit `edit` of its own frame, which [`Self::make`] would do at once; whether it is made.
    ///
    /// # Errors
    /// Its frame was not given; an edit that cannot be made.
    pub fn settle(&mut self, edit: usize) -> Result<bool, SessionError> {
        let Self { known, edits, given, .. } = self;
        let edits = edits.as_mut().ok_or(SessionError::Misfit)?;
        let mut recording = Recording { source: given, timeline: &known.timeline, feet: &known.feet };
        Ok(edits.settle(&mut recording, edit)?)
    }

    /// Edits `pose`, which is `frame` as it was recorded.
    ///
    /// # Errors
    /// A pose that was needed was not given, or is not of this mesh; an edit that cannot be made.
    pub fn make(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), SessionError> {
        if pose.len() != self.known.topology.vertex_count() || frame >= self.known.timeline.frame_count() {
            return Err(SessionError::Misfit);
        }
        let Self { known, edits, given, .. } = self;
        let edits = edits.as_mut().ok_or(SessionError::Misfit)?;
        let mut recording = Recording { source: given, timeline: &known.timeline, feet: &known.feet };
        Ok(edits.apply(&mut recording, frame, pose)?)
    }

    /// What is not as it was wanted, in sentences, of the edits that were made so far.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        self.edits.as_ref().map_or_else(Vec::new, Edits::notes)
    }

    /// Takes hold of what edit `edit` grabs, to be dragged.
    ///
    /// # Errors
    /// Its frame was not given; an edit that cannot be made, or is none.
    pub fn grab(&mut self, edit: usize) -> Result<(), SessionError> {
        let Self { known, edits, given, .. } = self;
        let edits = edits.as_mut().ok_or(SessionError::Misfit)?;
        let mut recording = Recording { source: given, timeline: &known.timeline, feet: &known.feet };
        let (grab, recorded) = edits.grab(&mut recording, edit)?;
        self.held = Some((edit, grab, recorded));
        Ok(())
    }

    /// Drags it to `to`, one place for each handle, in metres as the frame was recorded; its frame with all edits.
    ///
    /// # Errors
    /// Nothing is held; places that are not finite, or of another number.
    pub fn drag(&mut self, to: &[Vec3]) -> Result<Vec<Vec3>, SessionError> {
        let Self { known, edits, given, held, .. } = self;
        let (Some((edit, grab, recorded)), Some(edits)) = (held, edits) else { return Err(SessionError::Nothing) };
        edits.drag(*edit, (grab, recorded), to)?;
        let frame = edits.frame(*edit).ok_or(SessionError::Nothing)?;
        let mut pose = recorded.clone();
        let mut recording = Recording { source: given, timeline: &known.timeline, feet: &known.feet };
        edits.apply(&mut recording, frame, &mut pose)?;
        Ok(pose)
    }

    /// Whether each foot stands in `frame`, as edits of it that say nothing of pins have it.
    #[must_use]
    pub fn stands(&mut self, frame: u32) -> Vec<bool> {
        let Self { known: Known { timeline, feet, topology, .. }, given, .. } = self;
        let found = editing::floor::standing_in((timeline, feet), given, frame, topology.vertex_count());
        found.unwrap_or_else(|_| (0..feet.count()).map(|foot| feet.stands(frame, foot)).collect())
    }

    /// The vertices of a foot's sole.
    #[must_use]
    pub fn sole(&self, foot: usize) -> Vec<u32> {
        editing::soles::sole(&self.known.feet, foot).collect()
    }

    /// Where the bones of the rig are in `pose`, wherever that stands: of each where it begins and ends. Empty without a rig.
    #[must_use]
    pub fn bones(&self, pose: &[Vec3]) -> Vec<Vec3> {
        let rig = self.edits.as_ref().and_then(|edits| edits.editor().rig());
        let Some(rig) = rig.filter(|rig| rig.rest().len() == pose.len()) else { return Vec::new() };
        let motions = rig.fit(pose);
        rig.joints(&motions).into_iter().zip(rig.ends(&motions)).flat_map(|(joint, end)| [joint, end]).collect()
    }
}
