//! Dual quaternion skinning.
//!
//! This work is based on: L. Kavan et al., "Geometric skinning with approximate dual quaternion blending", 2008.

use glam::{Quat, Vec3};

use crate::rigid::Rigid;

/// At most this many joints move a vertex.
pub const INFLUENCES: usize = 4;

/// Joints and weights of one vertex; the weights sum to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influences {
    /// Joints.
    pub joints: [u8; INFLUENCES],
    /// Their weights.
    pub weights: [f32; INFLUENCES],
}

impl Influences {
    /// How much of the vertex the bones of which `counts` is true move together.
    pub(crate) fn sum(&self, counts: impl Fn(usize) -> bool) -> f32 {
        let own = self.joints.iter().zip(&self.weights).filter(|&(&joint, _)| counts(joint as usize));
        own.map(|(_, weight)| weight).sum()
    }
}

/// A rigid motion as a dual quaternion.
#[derive(Clone, Copy)]
struct DualQuat {
    real: Quat,
    dual: Quat,
}

impl DualQuat {
    fn new(rigid: &Rigid) -> Self {
        let t = rigid.translation * 0.5;
        Self { real: rigid.rotation, dual: Quat::from_xyzw(t.x, t.y, t.z, 0.0) * rigid.rotation }
    }
}

/// How the vertices of the bind pose move to a pose.
pub struct Skin {
    motions: Vec<DualQuat>,
}

impl Skin {
    /// The skin in the pose in which the joints stand at `world`; `bind_inverse` takes them from where they stand in the
    /// bind pose to the origin. Joints that one of the two lacks move nothing.
    #[must_use]
    pub fn new(bind_inverse: &[Rigid], world: &[Rigid]) -> Self {
        Self { motions: world.iter().zip(bind_inverse).map(|(now, bind)| DualQuat::new(&now.after(bind))).collect() }
    }

    /// The rigid motion of a vertex, whose joints must be among those of [`Skin::new`].
    #[must_use]
    pub fn motion(&self, influences: &Influences) -> Rigid {
        let first = self.motions[influences.joints[0] as usize];
        let (mut real, mut dual) = (first.real * 0.0, first.real * 0.0);
        for (&index, &weight) in influences.joints.iter().zip(&influences.weights) {
            let motion = &self.motions[index as usize];
            // The double cover: blend on the hemisphere of the strongest joint.
            let weight = if first.real.dot(motion.real) < 0.0 { -weight } else { weight };
            real += motion.real * weight;
            dual += motion.dual * weight;
        }
        let scale = 1.0 / real.length();
        let (real, dual) = (real * scale, dual * scale);
        let translation = dual * real.conjugate() * 2.0;
        Rigid { rotation: real, translation: Vec3::new(translation.x, translation.y, translation.z) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blends_of_one_motion_are_that_motion() {
        let bind: Vec<Rigid> = (0..24)
            .map(|k| Rigid {
                rotation: Quat::from_rotation_z(0.3 * k as f32),
                translation: Vec3::splat(0.1 * k as f32),
            })
            .collect();
        let motion = Rigid { rotation: Quat::from_rotation_y(2.5), translation: Vec3::new(1.0, 0.2, -3.0) };
        let world: Vec<Rigid> = bind.iter().map(|bind| motion.after(bind)).collect();
        let inverse: Vec<Rigid> = bind.iter().map(Rigid::inverse).collect();
        let skin = Skin::new(&inverse, &world);
        let influences = Influences { joints: [0, 5, 13, 22], weights: [0.4, 0.3, 0.2, 0.1] };
        let moved = skin.motion(&influences).apply(Vec3::new(0.3, 1.0, 0.1));
        assert!(moved.distance(motion.apply(Vec3::new(0.3, 1.0, 0.1))) < 1e-5);
    }
}
