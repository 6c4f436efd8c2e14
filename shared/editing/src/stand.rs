//! Bones in the frames around an edited one: goals are met, and feet brought back to where they stand.

use glam::Vec3;

use crate::carry::pin_targets;
use crate::reach::{Bend, Reach, Target};
use crate::rig::Rig;

/// Steps by which feet are brought back to where they stand, and handles to where they are wanted.
pub(crate) const STEPS: usize = 12;

/// Bends so that `goals` are reached, unless they are `reached`, and feet brought back to where they stand: first those that stand; then,
/// from where that has taken them, those that are about to stand or have stood, as far as they are firm. So nothing jumps where a foot
/// begins to be held.
pub(crate) fn stand(
    reach: &Reach,
    (goals, mut reached): (&mut Vec<Target>, bool),
    (centre, bend): (&Bend, &mut Bend),
    (rig, pose, pins): (&Rig, &[Vec3], &[(u32, f32)]),
) {
    reached |= goals.is_empty();
    let mut firmest = f32::INFINITY;
    loop {
        let next = pins.iter().map(|(_, firm)| *firm).filter(|firm| *firm < firmest).fold(0.0, f32::max);
        if next <= 0.0 {
            break;
        }
        firmest = next;
        let own: Vec<u32> = pins.iter().filter(|(_, firm)| *firm == next).map(|(pin, _)| *pin).collect();
        let mut targets = pin_targets(rig, pose, &own);
        let begun = reach.motions(bend);
        for target in &mut targets {
            target.to = Reach::place(target, &begun).lerp(target.to, next.min(1.0));
        }
        let drifts = |target: &Target| Reach::place(target, &begun).distance(target.to) > 1e-5;
        let moves = !reached || targets.iter().any(drifts);
        goals.extend(targets);
        if moves {
            reach.solve(goals, centre, bend, STEPS);
        }
        reached = true;
    }
    if !reached {
        reach.solve(goals, centre, bend, STEPS);
    }
}
