//! The skeleton's truth beside the built-in performer's capture: joint rotations and planted feet.

use std::fs;
use std::path::{Path, PathBuf};

use actor::timeline::Timeline;
use glam::{Quat, Vec3};
use serde::Deserialize;
use thiserror::Error;

/// Truth of every frame of a capture.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Names of the joints; joint 0 is the pelvis.
    pub joints: Vec<String>,
    /// The frames, as the capture counts them.
    pub frames: Vec<TruthFrame>,
}

/// Truth of a frame.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TruthFrame {
    /// Rotation of each joint against its parent as a quaternion x, y, z, w; the pelvis's against the world.
    pub rotations: Vec<[f32; 4]>,
    /// Positions of the joints in metres.
    pub joints: Vec<[f32; 3]>,
    /// Whether the left and the right foot stand on the ground.
    pub planted: [bool; 2],
}

#[derive(Deserialize)]
struct Constants {
    joints: Vec<String>,
}

#[derive(Deserialize)]
struct Take {
    frames: Vec<TruthFrame>,
}

/// Why the truth beside a capture cannot be used.
#[derive(Debug, Error)]
pub enum TruthError {
    /// A file cannot be read.
    #[error("cannot read {path}: {source}; remove the folder to evaluate without the skeleton's truth")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file does not hold what it should.
    #[error("{path} is not a truth file: {why}; remove the folder to evaluate without the skeleton's truth")]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
}

impl Truth {
    /// Reads the folder `truth` beside the manifest of `inputs`; `None` where there is none, or several inputs.
    ///
    /// # Errors
    /// A truth that is there but cannot be read or is of other frames.
    pub fn beside(inputs: &[String], timeline: &Timeline) -> Result<Option<Self>, TruthError> {
        let [input] = inputs else { return Ok(None) };
        let input = Path::new(input);
        let folder = if input.is_dir() { input } else { input.parent().unwrap_or(Path::new(".")) };
        let folder = folder.join("truth");
        if !folder.join("capture.json").is_file() {
            return Ok(None);
        }
        let constants: Constants = read(folder.join("capture.json"))?;
        let mut frames = Vec::new();
        for sequence in timeline.sequences() {
            let path = folder.join(&sequence.name).join("motion.json");
            let take: Take = read(path.clone())?;
            let joints = constants.joints.len();
            let complete = |frame: &TruthFrame| frame.rotations.len() == joints && frame.joints.len() == joints;
            let finite = |frame: &TruthFrame| {
                frame.rotations.iter().flatten().chain(frame.joints.iter().flatten()).all(|value| value.is_finite())
            };
            if take.frames.len() != sequence.frame_count as usize {
                let why = format!("it has {} frames, the sequence {}", take.frames.len(), sequence.frame_count);
                return Err(TruthError::Content { path, why });
            }
            if let Some(frame) = take.frames.iter().position(|frame| !(complete(frame) && finite(frame))) {
                let why = format!("frame {frame} does not hold {joints} joints");
                return Err(TruthError::Content { path, why });
            }
            frames.extend(take.frames);
        }
        Ok(Some(Self { joints: constants.joints, frames }))
    }

    /// Joints that stand for a pose: all but those of loose hair, which no pose decides.
    #[must_use]
    pub fn pose_joints(&self) -> Vec<usize> {
        (0..self.joints.len()).filter(|&joint| !self.joints[joint].starts_with("tail")).collect()
    }

    /// Rotation of a joint against its parent; the pelvis's without its heading, as poses are compared.
    #[must_use]
    pub fn rotation(&self, frame: usize, joint: usize) -> Quat {
        let rotation = Quat::from_array(self.frames[frame].rotations[joint]).normalize();
        if joint > 0 {
            return rotation;
        }
        // The twist about +Y, taken off.
        let heading = Quat::from_xyzw(0.0, rotation.y, 0.0, rotation.w);
        if heading.length_squared() < 1e-12 { rotation } else { heading.normalize().conjugate() * rotation }
    }

    /// Position of the joint of this name in metres.
    #[must_use]
    pub fn position(&self, frame: usize, name: &str) -> Option<Vec3> {
        let joint = self.joints.iter().position(|joint| joint == name)?;
        Some(Vec3::from_array(self.frames[frame].joints[joint]))
    }
}

fn read<T: for<'de> Deserialize<'de>>(path: PathBuf) -> Result<T, TruthError> {
    let text = fs::read_to_string(&path).map_err(|source| TruthError::Read { path: path.clone(), source })?;
    serde_json::from_str(&text).map_err(|error| TruthError::Content { path, why: error.to_string() })
}
