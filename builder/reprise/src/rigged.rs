//! What edits of a packed capture go by: the rig, estimated, corrected as a file says, and rounded as bundles store it; and the ways in
//! which the capture was seen to move.

use actor::capture::Capture;
use capture_io::import::Warning;
use editing::{StoredRig, StoredSpace};
use job::Job;
use rig::{Learned, RigError, RigFile, RigOptions, SpaceOptions, estimate, learn_space};
use serde::Serialize;

use crate::options::PackError;

/// What came of the rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RigSummary {
    /// Bones.
    pub bones: usize,
    /// Whether it was taken for a human's.
    pub human: bool,
    /// What skinning with the bones misses: root of the mean square, in millimetres.
    pub misfit_mm: f32,
}

/// What came of the learned space.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpaceSummary {
    /// Modes.
    pub modes: usize,
    /// Recorded frames that they are made of.
    pub frames: usize,
    /// What they miss of the capture: root of the mean square, in millimetres.
    pub misfit_mm: f32,
    /// What one pose misses of it, in the same way.
    pub moves_mm: f32,
}

/// The ways in which `capture` was seen to move; a warning in their place where it does not move but as a whole.
pub(crate) fn stored_space(capture: &Capture) -> Result<(StoredSpace, SpaceSummary), Warning> {
    let frames: Vec<u32> = (0..capture.timeline.frame_count()).collect();
    let Some(Learned { space, misfit, moves }) =
        learn_space(&capture.topology, &capture.poses, &frames, &SpaceOptions::default())
    else {
        let text = "no learned space: the capture moves as a whole, so edits that go by it are as rigid as possible";
        return Err(Warning::new("W_LEARNED", text.into()));
    };
    let (misfit_mm, moves_mm) = (1000.0 * misfit, 1000.0 * moves);
    let summary = SpaceSummary { modes: space.modes.len(), frames: space.frames.len(), misfit_mm, moves_mm };
    Ok((space, summary))
}

/// The rig of `capture`; a warning in its place where nothing moves against anything else.
pub(crate) fn stored_rig(
    capture: &Capture,
    file: &RigFile,
    job: &Job,
) -> Result<Result<(StoredRig, RigSummary), Warning>, PackError> {
    job.begin("rig")?;
    let mut options = RigOptions::default();
    options.parts = file.parts.unwrap_or(options.parts);
    let refuse = |error: RigError| PackError::Option(format!("the rig: {error}"));
    let found = match estimate(&capture.topology, &capture.poses, &options) {
        Ok(found) => found,
        Err(error @ RigError::Rigid { .. }) => return Ok(Err(Warning::new("W_RIG", error.to_string()))),
        Err(error) => return Err(refuse(error)),
    };
    let rig = file.correct(&found.rig).map_err(refuse)?;
    // The rest pose comes first among the key frames.
    let rest_frame = found.keys.first().copied().unwrap_or_default();
    let summary = RigSummary { bones: rig.bones().len(), human: found.is_human, misfit_mm: 1000.0 * found.misfit[0] };
    Ok(Ok((StoredRig::of(&rig, rest_frame), summary)))
}
