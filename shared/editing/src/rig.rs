//! A rig: bones, the joints between them, and which vertices they move.

use glam::{Mat3, Vec3};

use crate::error::EditError;
use crate::rigid::Rigid;
use crate::rotation::Fit;
use crate::skin::{INFLUENCES, Influences};

/// Bones at most: their indices are bytes.
pub const MOST_BONES: usize = 255;
/// What a vertex has for a bone that it tells nothing of any.
pub const NO_BONE: u8 = u8::MAX;

/// A bone: a part of the body that moves nearly as a rigid one.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    /// Its name; unique within the rig.
    pub name: String,
    /// The bone that it hangs on, before it in the list; itself for the first one.
    pub parent: usize,
    /// Where it meets its parent, in the rest pose, in metres; of the first bone its middle.
    pub joint: Vec3,
    /// Which limb it belongs to; 0 is the trunk.
    pub limb: u32,
    /// Least and largest coordinates of the rotation vector against the parent that were recorded, in radians, in the
    /// parent's frame, the rest pose being zero.
    pub range: [Vec3; 2],
    /// Covariance of that rotation vector, in radians squared.
    pub spread: Mat3,
    /// How far the two bones' ideas of the joint lie apart, root of the mean square in metres.
    pub gap: f32,
}

/// Bones over a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    bones: Vec<Bone>,
    influences: Vec<Influences>,
    /// The bone that each vertex moves with as one rigid piece, or [`NO_BONE`]: by these alone bones are found in a frame.
    core: Vec<u8>,
    rest: Vec<Vec3>,
}

impl Rig {
    /// A rig of `bones`, parents first, that move the vertices of the pose `rest` by `influences`; `core` has for each vertex
    /// the bone that it moves with as one rigid piece, or [`NO_BONE`].
    ///
    /// # Errors
    /// [`EditError::Rig`] where they do not fit together or a number is not finite.
    pub fn new(
        bones: Vec<Bone>,
        influences: Vec<Influences>,
        core: Vec<u8>,
        rest: Vec<Vec3>,
    ) -> Result<Self, EditError> {
        let refuse = |reason: String| Err(EditError::Rig(reason));
        if bones.is_empty() || bones.len() > MOST_BONES {
            return refuse(format!("it has {} bones, but 1 to {MOST_BONES} are allowed", bones.len()));
        }
        if influences.len() != rest.len() {
            return refuse(format!(
                "it has weights for {} vertices, but the mesh has {}",
                influences.len(),
                rest.len()
            ));
        }
        if core.len() != rest.len() || core.iter().any(|&bone| bone != NO_BONE && bone as usize >= bones.len()) {
            return refuse("the vertices' bones are none".into());
        }
        if let Some(bone) = (0..bones.len()).find(|&bone| !core.contains(&(bone as u8))) {
            return refuse(format!("no vertex moves with {:?} as one piece", bones[bone].name));
        }
        for (index, bone) in bones.iter().enumerate() {
            let name = &bone.name;
            if (index == 0) != (bone.parent == index) || bone.parent > index {
                return refuse(format!("the parent of {name:?} must come before it"));
            }
            if bones[..index].iter().any(|other| other.name == *name) {
                return refuse(format!("two bones are called {name:?}"));
            }
            let numbers = [bone.joint, bone.range[0], bone.range[1]];
            if !(numbers.iter().all(|v| v.is_finite()) && bone.spread.is_finite() && bone.gap.is_finite()) {
                return refuse(format!("a number of {name:?} is not finite"));
            }
        }
        let beyond = |one: &Influences| {
            (0..INFLUENCES).any(|k| one.joints[k] as usize >= bones.len())
                || (one.weights.iter().sum::<f32>() - 1.0).abs() > 1e-3
                || one.weights.iter().any(|&w| w.is_nan() || w < 0.0)
        };
        if let Some(vertex) = influences.iter().position(beyond) {
            return refuse(format!("the weights of vertex {vertex} are none"));
        }
        Ok(Self { bones, influences, core, rest })
    }

    /// The bones, parents first.
    #[must_use]
    pub fn bones(&self) -> &[Bone] {
        &self.bones
    }

    /// Bones and weights of each vertex.
    #[must_use]
    pub fn influences(&self) -> &[Influences] {
        &self.influences
    }

    /// The bone that each vertex moves with as one rigid piece, or [`NO_BONE`].
    #[must_use]
    pub fn core(&self) -> &[u8] {
        &self.core
    }

    /// The rest pose.
    #[must_use]
    pub fn rest(&self) -> &[Vec3] {
        &self.rest
    }

    /// The bone that moves `vertex`, which must exist, most.
    #[must_use]
    pub fn bone_of(&self, vertex: u32) -> usize {
        let Influences { joints, weights } = &self.influences[vertex as usize];
        let most = (1..INFLUENCES).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
        joints[most] as usize
    }

    /// Where each bone is in `pose`: the rigid transforms from the rest pose that fit the bone's own vertices best. Cloth that
    /// only follows tells nothing of where a bone is.
    #[must_use]
    pub fn fit(&self, pose: &[Vec3]) -> Vec<Rigid> {
        let mut fits = vec![Fit::default(); self.bones.len()];
        for ((&bone, &from), &to) in self.core.iter().zip(&self.rest).zip(pose) {
            if bone != NO_BONE {
                fits[bone as usize].add(from, to, 1.0);
            }
        }
        fits.iter().map(Fit::rigid).collect()
    }

    /// Where the joints are once the bones are at `motions`: between what the two bones of each say.
    #[must_use]
    pub fn joints(&self, motions: &[Rigid]) -> Vec<Vec3> {
        let at = |bone: &Bone, index: usize| {
            0.5 * (motions[index].apply(bone.joint) + motions[bone.parent].apply(bone.joint))
        };
        self.bones.iter().enumerate().map(|(index, bone)| at(bone, index)).collect()
    }

    /// Where each bone ends once the bones are at `motions`: at the next joint of its limb, or in the middle of its own
    /// vertices where it is the last.
    #[must_use]
    pub fn ends(&self, motions: &[Rigid]) -> Vec<Vec3> {
        let mut middles = vec![(Vec3::ZERO, 0.0_f32); self.bones.len()];
        for (&bone, &point) in self.core.iter().zip(&self.rest).filter(|(bone, _)| **bone != NO_BONE) {
            middles[bone as usize].0 += point;
            middles[bone as usize].1 += 1.0;
        }
        let end = |index: usize| {
            let next = |other: &&Bone| other.parent == index && other.limb == self.bones[index].limb;
            let joint = self.bones[index + 1..].iter().find(next).map(|next| next.joint);
            motions[index].apply(joint.unwrap_or(middles[index].0 / middles[index].1.max(1.0)))
        };
        (0..self.bones.len()).map(end).collect()
    }

    /// Whether `bone` is `ancestor` or hangs on it.
    #[must_use]
    pub fn hangs_on(&self, mut bone: usize, ancestor: usize) -> bool {
        while bone > ancestor {
            bone = self.bones[bone].parent;
        }
        bone == ancestor
    }
}
