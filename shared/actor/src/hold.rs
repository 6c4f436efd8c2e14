//! How far a transition carries the body so that a foot which has to stay can stay.
//!
//! Not in the papers. A blend follows the centre of mass; where the destination has a foot elsewhere below it than the source,
//! that foot has to go there. One that is in the air for a while in both takes its step then. One that never is would slide,
//! or hop: for the one of these that stands most, the body goes where it is needed instead, as smoothly as the blend itself, and
//! turns as far as that foot would otherwise turn on the ground.

use glam::Vec2;

/// How long a step takes, in seconds.
const STEP: f32 = 0.2;
/// The furthest that a body is carried, in metres.
const FURTHEST: f32 = 0.5;
/// The furthest that a body is turned, in radians.
const FURTHEST_TURN: f32 = 0.6;
/// What stands at least this firmly stands: firmness falls with every millimetre that a foot moves, and feet of captured bodies
/// always move a little. A body that is carried in part slides its foot the rest of the way.
const FIRM: f32 = 0.5;
/// What stands for less than this is no foot that could be held, in nodes.
const LEAST: f32 = 1.0;

/// How a part of the surface stands in a transition.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stance {
    /// For each side how firmly it stands at each node.
    weights: [Vec<f32>; 2],
    /// For each side the sum of its places, each counting as firmly as it stands.
    sums: [Vec2; 2],
    /// The same of the directions in which it points, as unit vectors (cosine, sine).
    pointing: [Vec2; 2],
}

impl Stance {
    /// At the next node a side has it at `place`, in metres along (X, Z), pointing to `heading`, where it stands so firmly.
    pub fn see(&mut self, side: usize, weight: f32, place: Vec2, heading: f32) {
        self.weights[side].push(weight);
        self.sums[side] += weight * place;
        self.pointing[side] += weight * Vec2::from_angle(heading);
    }

    fn total(&self, side: usize) -> f32 {
        self.weights[side].iter().sum()
    }

    /// How much it stands while it could best step, from 0 to 1: steps take `width` nodes.
    fn in_the_way(&self, width: usize) -> f32 {
        let stands = |(a, b): (&f32, &f32)| (a.max(*b) / FIRM).min(1.0);
        let stands: Vec<f32> = self.weights[0].iter().zip(&self.weights[1]).map(stands).collect();
        let steps = stands.windows(width.clamp(1, stands.len().max(1)));
        steps.map(|step| step.iter().sum::<f32>() / step.len() as f32).fold(1.0, f32::min)
    }

    /// From where the destination has it to where the source has it.
    fn apart(&self) -> Vec2 {
        self.sums[0] / self.total(0) - self.sums[1] / self.total(1)
    }

    /// From how it points in the destination to how it points in the source, in radians.
    fn turned(&self) -> f32 {
        let [source, destination] = self.pointing;
        destination.angle_to(source)
    }
}

/// Which part has least time to step, and how much of it has to stay, from 0 to 1; of parts alike, the one that stands longest.
fn held(stances: &[Stance], fps: f32) -> Option<(&Stance, f32)> {
    let width = ((STEP * fps).round() as usize).max(1);
    let stand = stances.iter().filter(|stance| stance.total(0) >= LEAST && stance.total(1) >= LEAST);
    let measured = stand.map(|stance| (stance, stance.in_the_way(width), stance.total(0).min(stance.total(1))));
    let held = measured.max_by(|a, b| (a.1 * a.2).total_cmp(&(b.1 * b.2)));
    held.map(|(stance, hold, _)| (stance, hold))
}

/// How far the destination has to be carried along (X, Z), in metres, so that the part stays that has least time to step.
pub(crate) fn carried(stances: &[Stance], fps: f32) -> Vec2 {
    held(stances, fps).map_or(Vec2::ZERO, |(held, hold)| hold * held.apart().clamp_length_max(FURTHEST))
}

/// How far the destination has to be turned about +Y, in radians, so that this part does not turn on the ground.
pub(crate) fn turned(stances: &[Stance], fps: f32) -> f32 {
    held(stances, fps).map_or(0.0, |(held, hold)| hold * held.turned().clamp(-FURTHEST_TURN, FURTHEST_TURN))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A foot that stands so firmly, in the destination 0.1 m away from where the source has it; half of its nodes may be in the
    /// air.
    fn foot(firmly: f32, lifts: bool) -> Stance {
        let mut stance = Stance::default();
        for node in 0..10 {
            let weight = if lifts && node >= 5 { 0.0 } else { firmly };
            (0..2).for_each(|side| stance.see(side, weight, Vec2::new(side as f32 * 0.1, 0.0), 0.0));
        }
        stance
    }

    #[test]
    fn a_foot_that_cannot_step_stays_altogether_though_it_moves_a_little() {
        for firmly in [0.5, 0.7, 1.0] {
            let carried = carried(&[foot(firmly, false)], 25.0);
            assert!((carried - Vec2::new(-0.1, 0.0)).length() < 1e-6, "{firmly}: {carried}");
        }
        let half = carried(&[foot(0.25, false)], 25.0);
        assert!((half - Vec2::new(-0.05, 0.0)).length() < 1e-6, "{half}");
    }

    #[test]
    fn a_foot_that_can_step_is_held_as_much_as_it_stands_meanwhile() {
        assert_eq!(carried(&[foot(1.0, true)], 25.0), Vec2::ZERO);
        // Steps take ten nodes, of which it stands in five.
        let half = carried(&[foot(1.0, true)], 50.0);
        assert!((half - Vec2::new(-0.05, 0.0)).length() < 1e-6, "{half}");
    }
}
