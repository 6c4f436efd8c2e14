//! The ponytail: a chain of points that follows the head with a lag.
//!
//! Position-based dynamics at small fixed steps (M. Macklin et al., "Small steps in physics simulation", 2019).

use glam::{Quat, Vec3};

use super::skeleton::{JOINT_COUNT, NEUTRAL, joint};
use rig::Rigid;

/// Length of the last joint's bone, whose end carries no joint.
const TIP: Vec3 = Vec3::new(0.0, -0.1, 0.008);
const STEPS: usize = 8;
/// Largest angle of each link against where it would be if the hair were stiff, in radians.
const LARGEST_BEND: [f32; 3] = [0.6, 1.15, 1.5];

/// State of the chain; carry it from frame to frame.
#[derive(Clone, Debug)]
pub struct Ponytail {
    points: [Vec3; 4],
    previous: [Vec3; 4],
    /// Where the chain would be if it were stiff, in the step before.
    rest: [Vec3; 4],
    head: Rigid,
}

fn offsets() -> [Vec3; 3] {
    let at = |k: usize| NEUTRAL[joint::TAIL + k];
    [at(1) - at(0), at(2) - at(1), TIP]
}

fn rest_points(head: &Rigid) -> [Vec3; 4] {
    let mut local = [NEUTRAL[joint::TAIL] - NEUTRAL[joint::HEAD]; 4];
    for (k, offset) in offsets().into_iter().enumerate() {
        local[k + 1] = local[k] + offset;
    }
    local.map(|point| head.apply(point))
}

impl Ponytail {
    /// A chain at rest on the head of `world`.
    #[must_use]
    pub fn new(world: &[Rigid; JOINT_COUNT]) -> Self {
        let head = world[joint::HEAD];
        let points = rest_points(&head);
        Self { points, previous: points, rest: points, head }
    }

    /// Moves the chain on by `seconds` to the head of `world`, and writes its joints there.
    pub fn advance(&mut self, world: &mut [Rigid; JOINT_COUNT], seconds: f32) {
        let (from, to) = (self.head, world[joint::HEAD]);
        let chest = world[joint::CHEST];
        let dt = seconds / STEPS as f32;
        for step in 1..=STEPS {
            let share = step as f32 / STEPS as f32;
            let head = Rigid {
                rotation: from.rotation.slerp(to.rotation, share),
                translation: from.translation.lerp(to.translation, share),
            };
            self.step(&head, &chest, dt);
        }
        self.head = to;
        self.write(world);
    }

    fn step(&mut self, head: &Rigid, chest: &Rigid, dt: f32) {
        let rest = rest_points(head);
        let lengths = offsets().map(Vec3::length);
        for k in 1..4 {
            let velocity = (self.points[k] - self.previous[k]) / dt;
            let carried = velocity - (rest[k] - self.rest[k]) / dt;
            // Hair is springy near the tie and hangs freely at the tip.
            let stiffness = [0.0, 160.0, 42.0, 14.0][k];
            let acceleration =
                (rest[k] - self.points[k]) * stiffness + Vec3::NEG_Y * 9.81 - carried * 4.6 - velocity * 0.7;
            self.previous[k] = self.points[k];
            self.points[k] += (velocity + acceleration * dt) * dt;
        }
        self.rest = rest;
        self.previous[0] = self.points[0];
        self.points[0] = rest[0];
        for k in 1..4 {
            let link = self.points[k] - self.points[k - 1];
            let stiff = (rest[k] - rest[k - 1]).normalize_or(Vec3::NEG_Y);
            self.points[k] = self.points[k - 1] + limited(link, stiff, LARGEST_BEND[k - 1]) * lengths[k - 1];
            // Stay out of neck and back.
            let local = chest.inverse().apply(self.points[k]);
            let back =
                -0.135 - 0.02 * (local.y / 0.2).clamp(0.0, 1.0) + 0.06 * ((local.x.abs() - 0.12) / 0.1).clamp(0.0, 1.0);
            if local.z > back && local.y < 0.3 {
                self.points[k] = chest.apply(Vec3::new(local.x, local.y, back));
            }
        }
    }

    fn write(&self, world: &mut [Rigid; JOINT_COUNT]) {
        let head = world[joint::HEAD].rotation;
        let mut rotation = head;
        for (k, offset) in offsets().into_iter().enumerate() {
            let wanted = (self.points[k + 1] - self.points[k]).normalize_or(Vec3::NEG_Y);
            let now = (rotation * offset).normalize_or(Vec3::NEG_Y);
            rotation = (Quat::from_rotation_arc(now, wanted) * rotation).normalize();
            world[joint::TAIL + k] = Rigid { rotation, translation: self.points[k] };
        }
    }
}

/// The direction of `link`, turned back towards `stiff` where it is more than `largest` radians away.
fn limited(link: Vec3, stiff: Vec3, largest: f32) -> Vec3 {
    let link = link.normalize_or(stiff);
    let aside = (link - stiff * link.dot(stiff)).normalize_or_zero();
    if link.dot(stiff) >= largest.cos() { link } else { stiff * largest.cos() + aside * largest.sin() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::bind_pose;

    #[test]
    fn links_keep_their_lengths_and_come_to_rest() {
        let mut world = bind_pose();
        let mut tail = Ponytail::new(&world);
        world[joint::HEAD].translation.x += 0.3;
        let mut last = Vec3::ZERO;
        for _ in 0..200 {
            last = tail.points[3];
            tail.advance(&mut world, 0.02);
        }
        assert!(last.distance(tail.points[3]) < 1e-4, "the tip still moves");
        for (k, offset) in offsets().into_iter().enumerate() {
            assert!((tail.points[k].distance(tail.points[k + 1]) - offset.length()).abs() < 2e-3);
        }
    }

    #[test]
    fn bends_are_limited() {
        let turned = limited(Vec3::X, Vec3::NEG_Y, 0.6);
        assert!((turned.angle_between(Vec3::NEG_Y) - 0.6).abs() < 1e-4 && turned.x > 0.0);
        assert_eq!(limited(Vec3::NEG_Y, Vec3::NEG_Y, 0.6), Vec3::NEG_Y);
    }
}
