//! A rig as it is stored beside a capture: its rest pose is one of the capture's own frames.

use glam::Vec3;

use crate::error::EditError;
use crate::rig::{Bone, Rig};
use crate::skin::{INFLUENCES, Influences};

/// Weights of [`StoredRig`] are whole multiples of one over this; those of a vertex sum to it.
pub const WEIGHT_STEPS: u8 = 255;

/// Bones and weights over a mesh, without the rest pose.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredRig {
    /// The frame, over the whole capture, whose recorded pose is the rest pose.
    pub rest_frame: u32,
    /// The bones, parents first.
    pub bones: Vec<Bone>,
    /// Bones of each vertex and their weights, none of which is 0: at most [`INFLUENCES`].
    pub influences: Vec<Vec<(u8, u8)>>,
    /// As [`Rig::core`].
    pub core: Vec<u8>,
}

impl StoredRig {
    /// `rig`, whose rest pose is that of `rest_frame`; its weights are rounded.
    #[must_use]
    pub fn of(rig: &Rig, rest_frame: u32) -> Self {
        let influences = rig.influences().iter().map(rounded).collect();
        Self { rest_frame, bones: rig.bones().to_vec(), influences, core: rig.core().to_vec() }
    }

    /// The rig, once `rest` is there: the recorded pose of its rest frame.
    ///
    /// # Errors
    /// Bones and weights that do not fit together, or do not fit `rest`.
    pub fn rig(self, rest: Vec<Vec3>) -> Result<Rig, EditError> {
        let influences = self.influences.iter().map(|own| {
            let mut influences = Influences::default();
            let first = own.first().map_or(0, |&(bone, _)| bone);
            for (k, joint) in influences.joints.iter_mut().enumerate() {
                let (bone, weight) = own.get(k).copied().unwrap_or((first, 0));
                *joint = bone;
                influences.weights[k] = f32::from(weight) / f32::from(WEIGHT_STEPS);
            }
            influences
        });
        Rig::new(self.bones, influences.collect(), self.core, rest)
    }
}

/// Weights as whole steps, which sum to [`WEIGHT_STEPS`]: what rounding leaves goes to those that it took most of.
fn rounded(influences: &Influences) -> Vec<(u8, u8)> {
    let exact = influences.weights.map(|weight| weight.clamp(0.0, 1.0) * f32::from(WEIGHT_STEPS));
    let mut steps = exact.map(|exact| exact.floor() as i32);
    let mut order: [usize; INFLUENCES] = std::array::from_fn(|k| k);
    order.sort_by(|&a, &b| (exact[b] - exact[b].floor()).total_cmp(&(exact[a] - exact[a].floor())));
    let left = i32::from(WEIGHT_STEPS) - steps.iter().sum::<i32>();
    order.iter().cycle().take(left.clamp(0, 8) as usize).for_each(|&k| steps[k] += 1);
    // A sum that is not 1 within a step is no rig's.
    let all = influences.joints.iter().zip(steps).filter(|(_, steps)| *steps > 0);
    all.map(|(&joint, steps)| (joint, steps.min(i32::from(WEIGHT_STEPS)) as u8)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_rounded_to_a_sum_of_one() {
        for weights in [[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [0.25; 4], [0.334, 0.333, 0.333, 0.0]] {
            let own = rounded(&Influences { joints: [3, 1, 2, 0], weights });
            assert_eq!(own.iter().map(|&(_, weight)| u32::from(weight)).sum::<u32>(), 255);
            for (k, &(joint, weight)) in own.iter().enumerate() {
                assert_eq!(joint, [3, 1, 2, 0][k]);
                assert!((f32::from(weight) / 255.0 - weights[k]).abs() <= 1.0 / 255.0);
            }
        }
    }
}
