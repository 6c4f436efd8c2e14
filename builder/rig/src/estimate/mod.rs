//! A rig from the capture itself: bones, joints and weights from how the surface moves.
//!
//! ```text
//! poses -> keys -> clusters (rigid parts) -> joints -> tree -> human or plain skeleton -> weights -> Rig
//! ```
//!
//! Where the input brings no skeleton, its motion is enough: parts that move as rigid ones are found by splitting, two parts
//! meet where their motions agree, and the tree of joints that gape least leaves cloth at its ends. On the ways between the
//! ends of a human body the joints of a human are found and named; any other body keeps all its parts.

pub(crate) mod clusters;
mod human;
mod joints;
pub(crate) mod keys;
mod linked;
pub(crate) mod skeleton;
mod tips;
pub(crate) mod weights;

use actor::capture::Poses;
use editing::rig::NO_BONE;
use editing::{Bone, EditError, Rig, Rigid};
use glam::{Mat3, Vec3};
use kernels::topology::Topology;
use thiserror::Error;

use clusters::Clusters;
use keys::Keys;
use skeleton::{Segment, Skeleton};

/// How a rig is estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RigOptions {
    /// Rigid parts that the surface is split into at most; from 2 to 120.
    pub parts: usize,
    /// Key frames at most.
    pub keys: usize,
}

impl Default for RigOptions {
    fn default() -> Self {
        Self { parts: 26, keys: 60 }
    }
}

/// Why no rig is found.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RigError {
    /// Nothing moves against anything else.
    #[error(
        "no rig can be found: over all {frames} frames the surface moves as one rigid piece; a rig needs recorded motion of limbs"
    )]
    Rigid {
        /// Frames of the capture.
        frames: usize,
    },
    /// An option is out of range.
    #[error("a rig has from 2 to 120 parts, not {0}")]
    Parts(usize),
    /// A skeleton is asked for, but none came.
    #[error(
        "a rig from the file is asked for, but the file has no skeleton whose bones move the surface: leave `from` out of the rig file"
    )]
    NoSkeleton,
    /// A correction that does not fit.
    #[error("bone {name:?}: {reason}")]
    Correction {
        /// The bone.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// What was found does not make a rig.
    #[error(transparent)]
    Rig(#[from] EditError),
}

/// Rigid parts that miss less than this share of the size are all there is.
const EXACT: f32 = 1e-3;

/// An estimated rig, and how good it is.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The rig.
    pub rig: Rig,
    /// Whether it was taken for that of a human.
    pub is_human: bool,
    /// Whether bones and weights are those of a skeleton that came with the surface.
    pub is_given: bool,
    /// Rigid parts that were found; bones, where they are given.
    pub parts: usize,
    /// Key frames.
    pub keys: Vec<u32>,
    /// What skinning with all parts misses, over vertices and key frames: root of the mean square and 95th percentile, in
    /// metres.
    pub parts_misfit: [f32; 2],
    /// The same with the rig's own bones.
    pub misfit: [f32; 2],
    /// The same by bone, of the vertices that it moves most: root of the mean square, in metres.
    pub bone_misfit: Vec<f32>,
}

/// Estimates the rig of a surface from its poses.
///
/// # Errors
/// A surface that moves as one piece.
pub fn estimate(topology: &Topology, poses: &Poses, options: &RigOptions) -> Result<Estimate, RigError> {
    if !(2..=120).contains(&options.parts) {
        return Err(RigError::Parts(options.parts));
    }
    let size = size(poses.frame(0));
    let keys = Keys::choose(poses, topology.weights(), options.keys.max(2), 1e-4 * size);
    let around = linked::neighbours(topology, &keys.poses[0]);
    // As fine as positions of a bundle are stored, or nearly.
    let clusters = clusters::split(&keys, &around, options.parts, 3e-4 * size);
    let parts = clusters.motions.len();
    if parts < 2 {
        return Err(RigError::Rigid { frames: poses.len() });
    }
    let tree = joints::tree(parts, joints::candidates(&keys, &clusters, &around));
    let rest = &keys.poses[0];
    let (middle, tips) = tips::tips(rest, &around, 8);
    let parts_misfit = parts_misfit(&keys, &clusters, &around);
    // What its rigid parts explain to the millimetre is no human body, whatever it looks like: it keeps them all.
    let is_machine = parts_misfit[0] < EXACT * size;
    let human = if is_machine { None } else { human::human(&keys, &clusters, &tree, &tips) };
    let skeleton = human.unwrap_or_else(|| {
        let far = tips.iter().filter(|(_, distance)| *distance > 0.15 * size);
        let ends: Vec<usize> = far.map(|&(tip, _)| clusters.of_vertex[tip as usize]).collect();
        let loosest = 0.012 * size;
        skeleton::plain(&clusters, &tree, rest, clusters.of_vertex[middle as usize], &ends, loosest)
    });
    let motions = segment_motions(&keys, &clusters, &skeleton);
    let influences = weights::weights(&keys, &motions, |v| skeleton.near(skeleton.of_part[clusters.of_vertex[v]], 2));
    let misfit = weights::misfit(&keys, &motions, &influences);
    let bone_misfit = weights::misfit_by_bone(&keys, &motions, &influences);
    let bones = skeleton.segments.iter().enumerate();
    let bones =
        bones.map(|(index, segment)| bone(segment, &motions[index], &motions[segment.parent], index == 0)).collect();
    let mut of_part = vec![NO_BONE; parts];
    for (index, segment) in skeleton.segments.iter().enumerate() {
        segment.core.iter().for_each(|&part| of_part[part] = index as u8);
    }
    let core = clusters.of_vertex.iter().map(|&part| of_part[part]).collect();
    let rig = Rig::new(bones, influences, core, rest.clone())?;
    Ok(Estimate {
        rig,
        is_human: skeleton.is_human,
        is_given: false,
        parts,
        keys: keys.frames,
        parts_misfit,
        misfit,
        bone_misfit,
    })
}

/// What skinning with all parts misses after each part's transforms were found once more (Le and Deng 2012, section 4.3).
fn parts_misfit(keys: &Keys, clusters: &Clusters, around: &[Vec<u32>]) -> [f32; 2] {
    let beside = clusters.beside(around);
    let candidates = |v: usize| {
        let own = clusters.of_vertex[v];
        std::iter::once(own).chain(beside[own].keys().copied()).collect()
    };
    let mut motions = clusters.motions.clone();
    let influences = weights::weights(keys, &motions, candidates);
    weights::refit(keys, &mut motions, &influences);
    let influences = weights::weights(keys, &motions, candidates);
    weights::misfit(keys, &motions, &influences)
}

/// By segment and key frame, how its core moves.
fn segment_motions(keys: &Keys, clusters: &Clusters, skeleton: &Skeleton) -> Vec<Vec<Rigid>> {
    let members = clusters.members();
    let of = |segment: &Segment| {
        let vertices: Vec<u32> = segment.core.iter().flat_map(|&part| members[part].iter().copied()).collect();
        clusters::fit(keys, &vertices)
    };
    skeleton.segments.iter().map(of).collect()
}

pub(crate) fn bone(segment: &Segment, own: &[Rigid], parent: &[Rigid], is_root: bool) -> Bone {
    let Segment { name, parent: index, joint, gap, limb, .. } = segment.clone();
    let turns: Vec<Vec3> = own
        .iter()
        .zip(parent)
        .map(|(own, parent)| if is_root { own.rotation } else { parent.rotation.conjugate() * own.rotation })
        .map(editing::reach::logarithm)
        .collect();
    let count = turns.len().max(1) as f32;
    let mean = turns.iter().sum::<Vec3>() / count;
    let mut spread = Mat3::ZERO;
    for turn in &turns {
        let off = *turn - mean;
        spread += Mat3::from_cols(off * off.x, off * off.y, off * off.z) * (1.0 / count);
    }
    let low = turns.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = turns.iter().copied().reduce(Vec3::max).unwrap_or_default();
    Bone { name, parent: index, joint, limb, range: [low, high], spread, gap }
}

pub(crate) fn size(pose: &[Vec3]) -> f32 {
    let low = pose.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = pose.iter().copied().reduce(Vec3::max).unwrap_or_default();
    (high - low).max_element()
}

#[cfg(test)]
mod tests;
