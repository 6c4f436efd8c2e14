//! The joints of a glTF file's skins as a clip.

use std::path::Path;

use driving::clip::{MOST_FRAMES, MOST_JOINTS, MOST_POSITIONS};
use driving::{Clip, ClipError, ClipJoint, Stance};
use glam::{Mat4, Quat};
use mocap::clip_error;

use super::error::MocapError;
use crate::import::{Skeleton, Warning};

/// Frames a second that clips are sampled at where nothing else is said.
const RATE: f32 = 60.0;

/// Reads the clip `wanted`, or the first one.
pub(super) fn read(
    path: &Path,
    wanted: Option<&str>,
    rate: Option<f32>,
    warnings: &mut Vec<Warning>,
) -> Result<Clip, MocapError> {
    let skeleton = Skeleton::open(path)?;
    warnings.extend(skeleton.warnings.iter().cloned());
    let no_clip = |reason: String| MocapError::NoClip { path: path.to_owned(), reason };
    if skeleton.names.is_empty() {
        return Err(no_clip("the file has no skin, and so no skeleton".into()));
    }
    let known = || skeleton.clips.join(", ");
    let clip = match wanted {
        _ if skeleton.clips.is_empty() => return Err(no_clip("the file has no clip".into())),
        None => 0,
        Some(name) => skeleton
            .clips
            .iter()
            .position(|clip| clip == name)
            .ok_or_else(|| no_clip(format!("there is no clip {name:?}; there are: {}", known())))?,
    };
    if wanted.is_none() && skeleton.clips.len() > 1 {
        let message =
            format!("{}: clip {:?} is taken; --take names another: {}", path.display(), skeleton.clips[0], known());
        warnings.push(Warning::new("W_MOCAP_CLIP", message));
    }
    let file = path.display().to_string();
    let rate = rate.unwrap_or(RATE);
    let (frames, joints) = (skeleton.frame_count(clip, rate.into()), skeleton.names.len());
    let check = |what, count: u64, most: usize| match count > most as u64 {
        true => Err(clip_error(&file)(ClipError::TooMany { what, count: count as usize, most })),
        false => Ok(()),
    };
    check("joints", joints as u64, MOST_JOINTS)?;
    check("frames", frames, MOST_FRAMES)?;
    check("positions", frames.saturating_mul(joints as u64), MOST_POSITIONS)?;
    let poses = (0..frames as usize).map(|frame| stance(&skeleton.pose(clip, frame, rate.into()))).collect();
    let names = skeleton.names.iter().zip(&skeleton.parents);
    let joints = names.map(|(name, &parent)| ClipJoint { name: name.clone(), parent }).collect();
    Ok(Clip::new(joints, rate, poses, Some(stance(&skeleton.rest))).map_err(clip_error(&file))?)
}

fn stance(matrices: &[Mat4]) -> Stance {
    let rotation = |matrix: &Mat4| {
        let (_, rotation, _) = matrix.to_scale_rotation_translation();
        // What is scaled to nothing points nowhere.
        if rotation.is_finite() && rotation.length_squared() > 0.5 { rotation.normalize() } else { Quat::IDENTITY }
    };
    Stance {
        positions: matrices.iter().map(|matrix| matrix.w_axis.truncate()).collect(),
        rotations: matrices.iter().map(rotation).collect(),
    }
}
