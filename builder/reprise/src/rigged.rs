//! The rig of a capture that is packed: estimated, corrected as a file says, and rounded as bundles store it.

use actor::capture::Capture;
use capture_io::import::Warning;
use editing::StoredRig;
use job::Job;
use rig::{RigError, RigFile, RigOptions, estimate};
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
