//! What edits of a packed capture go by: the rig, estimated, corrected as a file says, and rounded as bundles store it; and the ways in
//! which the capture was seen to move.

use actor::capture::{Capture, Poses};
use capture_io::import::{FileSkeleton, Warning};
use editing::{Rig, StoredRig, StoredSpace};
use job::Job;
use kernels::topology::Topology;
use rig::{
    Estimate, GivenBone, Learned, RigError, RigFile, RigOptions, RigOrigin, SpaceOptions, estimate, given, learn_space,
};
use serde::Serialize;

use crate::options::PackError;

/// What came of the rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RigSummary {
    /// Bones.
    pub bones: usize,
    /// Whether it was taken for a human's.
    pub human: bool,
    /// Whether it is the skeleton that the capture's file brings.
    pub given: bool,
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

/// A skeleton that misses more than this share of the body's size does not move the surface, or not alone.
const MOST_MISFIT: f32 = 0.02;

/// A rig as it was found, as `file` corrects it, and what the user should know of it.
pub struct FoundRig {
    /// As it was found.
    pub estimate: Estimate,
    /// As it was corrected.
    pub rig: Rig,
    /// A sentence where it is not that of the capture's file.
    pub warning: Option<Warning>,
}

/// The rig of a capture: the skeleton that its file brings where that moves its surface, else what is estimated; corrected as `file` says.
/// It is estimated, too, where a number of parts is asked for.
///
/// # Errors
/// A surface that moves as one piece; corrections that do not fit.
pub fn found_rig(
    (topology, poses): (&Topology, &Poses),
    skeleton: Option<&FileSkeleton>,
    file: &RigFile,
    parts: Option<usize>,
) -> Result<FoundRig, RigError> {
    let mut options = RigOptions::default();
    let asked = parts.or(file.parts);
    options.parts = asked.unwrap_or(options.parts);
    let by_motion = asked.is_some() || file.from == Some(RigOrigin::Motion);
    let mut warning = None;
    let mut own = None;
    if let Some(skeleton) = skeleton.filter(|_| !by_motion) {
        let bones = skeleton.bones.iter().zip(&skeleton.joints);
        let bones = bones.map(|(bone, &joint)| GivenBone {
            name: bone.name.clone(),
            parent: bone.parent,
            joint,
            role: bone.role,
        });
        let bones: Vec<GivenBone> = bones.collect();
        own = given(topology, poses, (&bones, &skeleton.influences), &options)?;
        let low = poses.frame(0).iter().copied().reduce(glam::Vec3::min).unwrap_or_default();
        let high = poses.frame(0).iter().copied().reduce(glam::Vec3::max).unwrap_or_default();
        let most = MOST_MISFIT * (high - low).max_element();
        if let Some(found) = own.take_if(|found| found.misfit[0] > most && file.from.is_none()) {
            warning = Some(Warning::new(
                "W_RIG_FILE",
                format!(
                    "the skeleton of the file misses the surface by {:.0} mm: other things move it, too; the rig is estimated from the                      motion (from = \"file\" in a rig file takes the skeleton all the same)",
                    1000.0 * found.misfit[0]
                ),
            ));
        }
    }
    let estimate = match own {
        Some(own) => own,
        None if file.from == Some(RigOrigin::File) && !by_motion => return Err(RigError::NoSkeleton),
        None => estimate(topology, poses, &options)?,
    };
    let rig = file.correct(&estimate.rig)?;
    Ok(FoundRig { estimate, rig, warning })
}

/// The rig of `capture`; none where nothing moves against anything else. What the user should know of it goes to `warnings`.
pub(crate) fn stored_rig(
    capture: &Capture,
    skeleton: Option<&FileSkeleton>,
    file: &RigFile,
    job: &Job,
    warnings: &mut Vec<Warning>,
) -> Result<Option<(StoredRig, RigSummary)>, PackError> {
    job.begin("rig")?;
    let found = found_rig((&capture.topology, &capture.poses), skeleton, file, None);
    let FoundRig { estimate: found, rig, warning } = match found {
        Ok(found) => found,
        Err(error @ RigError::Rigid { .. }) => {
            warnings.push(Warning::new("W_RIG", error.to_string()));
            return Ok(None);
        }
        Err(error) => return Err(PackError::Option(format!("the rig: {error}"))),
    };
    warnings.extend(warning);
    // The rest pose comes first among the key frames.
    let rest_frame = found.keys.first().copied().unwrap_or_default();
    let (human, given) = (found.is_human, found.is_given);
    let summary = RigSummary { bones: rig.bones().len(), human, given, misfit_mm: 1000.0 * found.misfit[0] };
    Ok(Some((StoredRig::of(&rig, rest_frame), summary)))
}
