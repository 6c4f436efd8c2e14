//! How bones are pulled: inverse kinematics to the handles, over the ground and with feet held, the skin, and one solve of the surface.

use glam::Vec3;

use crate::carry::spread;
use crate::error::EditError;
use crate::floor::above;
use crate::grab::{Bones, By, Editor, FIRST_STEPS, Grab, SHORT, far};
use crate::reach::{Bend, Reach, Target};
use crate::rigid::Rigid;
use crate::stand::stand;

/// Further than this share of its size the surface is not stretched beyond what the bones reach.
pub(crate) const STRETCH: f32 = 0.03;
/// The bones are not pulled further than so many sizes.
const PULL: f32 = 1.2;

impl Editor {
    /// Inverse kinematics of at least `steps` steps, the skin, and the surface.
    pub(crate) fn pull_bones(
        &mut self,
        grab: &mut Grab,
        to: &[Vec3],
        steps: usize,
        notes: &mut Vec<String>,
    ) -> Result<(), EditError> {
        let (By::Bones(bones), Some(rig)) = (&mut grab.by, &self.rig) else { return Ok(()) };
        let Bones { reach, bend, eased, carried, targets, skinned } = bones.as_mut();
        for ((target, &to), &handle) in targets.iter_mut().zip(to).zip(&grab.grip.handles) {
            let from = grab.pose[handle as usize];
            // What is far away must not pull the feet from where they stand.
            target.to = from + (to - from).clamp_length_max(PULL * grab.size);
        }
        let (steps, none) = (if grab.is_first { FIRST_STEPS } else { steps }, Bend::none(rig.bones().len()));
        let body = (rig, grab.pose.as_slice(), carried.as_slice());
        reach.solve(targets, &none, bend, steps);
        let (mut turns, mut told) = above(body, grab.floor, (reach, targets, &none, bend), steps);
        let motions = reach.motions(bend);
        let most = STRETCH * grab.size;
        if limit(&mut targets[..carried.len()], &motions, most) {
            reach.solve(targets, &none, bend, steps);
            (turns, told) = above(body, grab.floor, (reach, targets, &none, bend), steps);
        }
        eased.clone_from(bend);
        if !grab.grip.eased.is_empty() {
            let mut goals = targets.clone();
            stand(reach, (&mut goals, true), (&none, eased), (rig, &grab.pose, &grab.grip.eased));
            (turns, told) = above(body, grab.floor, (reach, &mut goals, &none, eased), steps);
            if limit(&mut targets[..carried.len()], &reach.motions(eased), most) {
                goals.truncate(0);
                goals.extend_from_slice(targets);
                stand(reach, (&mut goals, true), (&none, eased), (rig, &grab.pose, &grab.grip.eased));
                (turns, told) = above(body, grab.floor, (reach, &mut goals, &none, eased), steps);
            }
        }
        let mut beyond = Vec::with_capacity(carried.len());
        for (index, (target, &to)) in targets.iter().zip(to).enumerate() {
            let handle = grab.grip.handles[index] as usize;
            // With less to pull at it the body may have gone back further.
            beyond.push((target.to - grab.pose[handle] - told[handle]).clamp_length_max(most));
            let place = grab.pose[handle] + told[handle] + beyond[index];
            if place.distance(to) > SHORT {
                grab.wanted[index] = place - grab.pose[handle];
                notes.push(far(handle as u32, place.distance(to)));
            }
        }
        let drawn = spread(carried.iter().map(|one| one.near.as_slice()), &beyond, told.len());
        let still = grab.grip.pins.iter().map(|_| Vec3::ZERO);
        let partly = grab.grip.eased.iter().map(|&(vertex, firm)| told[vertex as usize] * (1.0 - firm));
        let wanted: Vec<Vec3> = grab.wanted.iter().copied().chain(still).chain(partly).collect();
        grab.displacements = self.deformer.solve_over(&grab.held, &grab.pose, (&turns, &told), &drawn, &wanted)?;
        *skinned = told;
        Ok(())
    }
}

/// Takes targets back that are farther than `most` from where `motions` bring their points; whether there were any.
fn limit(targets: &mut [Target], motions: &[Rigid], most: f32) -> bool {
    let mut is_short = false;
    for target in targets {
        let place = Reach::place(target, motions);
        let off = target.to - place;
        if off.length() > most {
            (target.to, is_short) = (place + off.normalize_or_zero() * most, true);
        }
    }
    is_short
}
