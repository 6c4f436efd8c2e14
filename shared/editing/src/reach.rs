//! Inverse kinematics: how the bones turn so that points of the body reach their targets.
//!
//! Bones turn *relative to a frame as it was recorded*: where nothing turns, nothing moves. Unknown are a rotation of each
//! free bone against its parent and a shift of the root. What is minimised is the distance to the targets, rotations as rare
//! as the recorded ones make them (their covariance), those beyond the recorded range, and the root's shift; by damped
//! Gauss-Newton steps, a dense system of a few dozen unknowns each.

use glam::{DMat3, Mat3, Quat, Vec3};

use crate::dense::solve_dense;
use crate::rig::{Bone, Rig};
use crate::rigid::Rigid;
use crate::rotation::{cross_matrix, log_change, rotation_vector, turn_by};

/// Weight of rotations as rare as the recorded ones beside squared metres.
const PRIOR: f32 = 2e-4;
/// Variance that each rotation has beside what was recorded: 4 degrees.
const LEAST_VARIANCE: f32 = 0.0049;
/// How much rarer rotations of a limb are that only holds what stays, and of one that holds nothing.
const STAYING: f32 = 6.0;
/// How much rarer rotations of the trunk are where a limb is dragged.
const TRUNK: f32 = 8.0;
const IDLE: f32 = 60.0;
/// How much rarer rotations about a bone's own axis are in the trunk: a head that is pulled down bows.
const TWIST: f32 = 12.0;
/// Weight of the root's shift.
const SHIFT: f32 = 0.05;
/// Weight of what is beyond the recorded range, and how far that reaches beyond what was recorded: 15 degrees.
const LIMIT: f32 = 0.05;
const SLACK: f32 = 0.26;
/// A step that changes less than this many radians and metres is the last.
const STILL: f32 = 1e-4;

/// How the bones are turned against a frame as it was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Bend {
    /// Shift of the root in metres.
    pub shift: Vec3,
    /// Rotation of each bone against its parent, in the frame's axes turned with the parent.
    pub turns: Vec<Quat>,
}

impl Bend {
    /// No bone is turned.
    #[must_use]
    pub fn none(bones: usize) -> Self {
        Self { shift: Vec3::ZERO, turns: vec![Quat::IDENTITY; bones] }
    }

    /// The rotation vectors of all bones.
    #[must_use]
    pub fn logarithms(&self) -> Vec<Vec3> {
        self.turns.iter().map(|turn| logarithm(*turn)).collect()
    }
}

/// The rotation vector of the short way.
#[must_use]
pub fn logarithm(turn: Quat) -> Vec3 {
    rotation_vector(if turn.w < 0.0 { -turn } else { turn })
}

/// What is asked of a point, or of a mean of points: to be at `to`, by axis as firmly as `weight` says.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Points as the frame has them, the bones that carry them, and their shares, which sum to 1.
    pub parts: Vec<(usize, f32, Vec3)>,
    /// Where their mean is to be, in metres.
    pub to: Vec3,
    /// Weight along each axis beside 1 for a handle.
    pub weight: Vec3,
    /// Whether it asks for no height where the mean is above `to`.
    pub is_floor: bool,
}

/// What a limb does in an edit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It holds a handle.
    Dragged,
    /// It holds pins: it bends so that they stay.
    Stays,
    /// It goes along.
    Idle,
}

impl Role {
    /// The role of `limb` among limbs that are dragged and limbs that hold pins.
    #[must_use]
    pub fn of(limb: u32, dragged: &[u32], staying: &[u32]) -> Self {
        match (dragged.contains(&limb), staying.contains(&limb)) {
            (true, _) => Self::Dragged,
            (false, true) => Self::Stays,
            (false, false) => Self::Idle,
        }
    }
}

/// A rig in a frame as it was recorded.
#[derive(Clone, Debug)]
pub struct Reach {
    parents: Vec<usize>,
    joints: Vec<Vec3>,
    /// Which bones may turn.
    free: Vec<bool>,
    /// By bone: how rare a rotation is, in the frame's axes.
    rarity: Vec<Mat3>,
    /// By bone: from the frame's axes to the parent's rest frame, and the rotation against the parent as recorded.
    rest: Vec<(Quat, Quat)>,
    range: Vec<[Vec3; 2]>,
    /// Bones that rather keep their direction in the world.
    steady: Vec<bool>,
    /// Bones of limbs that only go along.
    idle: Vec<bool>,
    shifts: bool,
}

impl Reach {
    /// A rig whose bones are at `motions` in a frame. `free` says which bones may turn, `role` what each limb does, and
    /// `steady` which bones rather keep their direction.
    #[must_use]
    pub fn new(rig: &Rig, motions: &[Rigid], free: Vec<bool>, role: impl Fn(u32) -> Role, steady: Vec<bool>) -> Self {
        let bones = rig.bones();
        let joints = rig.joints(motions);
        let mut rarity = Vec::with_capacity(bones.len());
        let mut rest = Vec::with_capacity(bones.len());
        let idle = |bone: &Bone| bone.limb != 0 && role(bone.limb) == Role::Idle;
        let idle = bones.iter().map(idle).collect();
        for (index, bone) in bones.iter().enumerate() {
            let parent = if index == 0 { Quat::IDENTITY } else { motions[bone.parent].rotation };
            let axes = Mat3::from_quat(parent);
            let spread = bone.spread + Mat3::from_diagonal(Vec3::splat(LEAST_VARIANCE));
            let scale = match role(bone.limb) {
                Role::Dragged => 1.0,
                _ if bone.limb == 0 => TRUNK,
                Role::Stays => STAYING,
                Role::Idle => IDLE,
            };
            let mut own = axes * spread.inverse() * axes.transpose() * scale;
            if bone.limb == 0 {
                let next = (index + 1..bones.len()).find(|&k| bones[k].parent == index && bones[k].limb == 0);
                let along = next.map_or(Vec3::Y, |next| joints[next] - joints[index]).normalize_or(Vec3::Y);
                let twist = Mat3::from_cols(along * along.x, along * along.y, along * along.z);
                own += twist * (TWIST / LEAST_VARIANCE.max(0.04));
            }
            rarity.push(own * PRIOR);
            rest.push((parent.conjugate(), parent.conjugate() * motions[index].rotation));
        }
        let range = bones.iter().map(|bone| [bone.range[0] - SLACK, bone.range[1] + SLACK]).collect();
        let shifts = free[0];
        let parents = bones.iter().map(|bone| bone.parent).collect();
        let none = Bend::none(bones.len());
        Self { parents, joints, free, rarity, rest, range, steady, idle, shifts }.allowing(&none)
    }

    /// The same where no bone is beyond its range that is turned by `bend`: what is there already is not taken back.
    #[must_use]
    pub fn allowing(mut self, bend: &Bend) -> Self {
        for index in 1..self.range.len() {
            let (beyond, _) = self.beyond(index, bend.turns[index]);
            let [low, high] = &mut self.range[index];
            (*low, *high) = (*low + beyond.min(Vec3::ZERO), *high + beyond.max(Vec3::ZERO));
        }
        self
    }

    /// From now on `limb` bends as one that holds what stays, not as one that only goes along.
    pub(crate) fn rouse(&mut self, rig: &Rig, limb: u32) {
        for index in (0..self.idle.len()).filter(|&index| rig.bones()[index].limb == limb) {
            if std::mem::take(&mut self.idle[index]) {
                self.rarity[index] *= STAYING / IDLE;
            }
        }
    }

    /// Where `bend` takes what each bone carries, relative to the frame as it was recorded.
    #[must_use]
    pub fn motions(&self, bend: &Bend) -> Vec<Rigid> {
        let mut motions: Vec<Rigid> = Vec::with_capacity(self.joints.len());
        for (index, (&joint, &turn)) in self.joints.iter().zip(&bend.turns).enumerate() {
            let about = Rigid { rotation: turn, translation: joint - turn * joint };
            motions.push(match motions.get(self.parents[index]) {
                Some(parent) => parent.after(&about),
                None => Rigid { translation: about.translation + bend.shift, ..about },
            });
        }
        motions
    }

    /// Bends further towards the targets, by up to `steps` steps. Rotations are rare as seen from `centre`.
    pub fn solve(&self, targets: &[Target], centre: &Bend, bend: &mut Bend, steps: usize) {
        let mut damping = 1e-3;
        let mut cost = self.cost(targets, centre, bend);
        for _ in 0..steps {
            let (matrix, gradient) = self.normal(targets, centre, bend);
            let mut moved = false;
            for _ in 0..8 {
                let Some(step) = solve_dense(&matrix, &gradient, damping) else {
                    damping *= 10.0;
                    continue;
                };
                let next = self.stepped(bend, &step);
                let next_cost = self.cost(targets, centre, &next);
                if next_cost < cost {
                    moved = step.iter().any(|s| s.abs() > f64::from(STILL));
                    (*bend, cost) = (next, next_cost);
                    damping = (damping * 0.2).max(1e-6);
                    break;
                }
                damping *= 10.0;
            }
            if !moved {
                break;
            }
        }
    }

    /// Which bones may turn.
    #[must_use]
    pub fn free(&self) -> &[bool] {
        &self.free
    }

    /// Where a target's mean point is.
    #[must_use]
    pub fn place(target: &Target, motions: &[Rigid]) -> Vec3 {
        target.parts.iter().map(|&(bone, share, point)| motions[bone].apply(point) * share).sum()
    }

    /// How far a target's mean point is off.
    fn off(target: &Target, motions: &[Rigid]) -> Vec3 {
        let off = Self::place(target, motions) - target.to;
        if target.is_floor && off.y >= 0.0 { off.with_y(0.0) } else { off }
    }

    /// First unknown of each bone that may turn; the root's shift, if it may, comes first.
    fn unknowns(&self) -> (Vec<Option<usize>>, usize) {
        let mut count = if self.shifts { 3 } else { 0 };
        let first = self
            .free
            .iter()
            .map(|&free| {
                free.then(|| {
                    count += 3;
                    count - 3
                })
            })
            .collect();
        (first, count)
    }

    fn stepped(&self, bend: &Bend, step: &[f64]) -> Bend {
        let three = |at: usize| Vec3::new(step[at] as f32, step[at + 1] as f32, step[at + 2] as f32);
        let mut next = bend.clone();
        if self.shifts {
            next.shift += three(0);
        }
        for (turn, first) in next.turns.iter_mut().zip(self.unknowns().0) {
            if let Some(first) = first {
                *turn = (turn_by(three(first)) * *turn).normalize();
            }
        }
        next
    }

    fn cost(&self, targets: &[Target], centre: &Bend, bend: &Bend) -> f64 {
        let motions = self.motions(bend);
        let mut cost = f64::from(SHIFT * (bend.shift - centre.shift).length_squared());
        for target in targets {
            let off = Self::off(target, &motions);
            cost += f64::from((off * off * target.weight).element_sum());
        }
        for index in 0..self.joints.len() {
            let away = logarithm(bend.turns[index]) - logarithm(centre.turns[index]);
            cost += f64::from(away.dot(self.rarity[index] * away));
            cost += f64::from(LIMIT * self.beyond(index, bend.turns[index]).0.length_squared());
            if self.steady[index] {
                cost += f64::from(STEADY * logarithm(motions[index].rotation).length_squared());
            }
        }
        cost
    }

    /// How far a bone is turned beyond its range, by coordinate, and the rotation vector that says so.
    fn beyond(&self, index: usize, turn: Quat) -> (Vec3, Vec3) {
        if index == 0 {
            return (Vec3::ZERO, Vec3::ZERO);
        }
        let (to_rest, recorded) = self.rest[index];
        // In the parent's rest frame, as the range is.
        let now = logarithm(to_rest * turn * to_rest.conjugate() * recorded);
        let [low, high] = self.range[index];
        ((now - high).max(Vec3::ZERO) + (now - low).min(Vec3::ZERO), now)
    }

    /// The normal equations of a Gauss-Newton step: the matrix, row by row, and what is on its right.
    fn normal(&self, targets: &[Target], centre: &Bend, bend: &Bend) -> (Vec<f64>, Vec<f64>) {
        let motions = self.motions(bend);
        let (first, count) = self.unknowns();
        let mut equations = Equations { matrix: vec![0.0; count * count], right: vec![0.0; count], count };
        if self.shifts {
            equations.add(&[(0, Mat3::IDENTITY)], bend.shift - centre.shift, Mat3::from_diagonal(Vec3::splat(SHIFT)));
        }
        for target in targets {
            let off = Self::off(target, &motions);
            // What is above the floor may rise and sink.
            let is_above = target.is_floor && off.y == 0.0;
            let weight = if is_above { target.weight.with_y(0.0) } else { target.weight };
            let blocks = self.target_blocks(target, &motions, &first);
            equations.add(&blocks, off, Mat3::from_diagonal(weight));
        }
        for (index, &unknown) in first.iter().enumerate() {
            if self.steady[index] {
                let now = logarithm(motions[index].rotation);
                let blocks = self.turn_blocks(index, &motions, &first, log_change(now));
                equations.add(&blocks, now, Mat3::from_diagonal(Vec3::splat(STEADY)));
            }
            let Some(unknown) = unknown else { continue };
            let now = logarithm(bend.turns[index]);
            let away = now - logarithm(centre.turns[index]);
            equations.add(&[(unknown, log_change(now))], away, self.rarity[index]);
            let (beyond, angle) = self.beyond(index, bend.turns[index]);
            if beyond != Vec3::ZERO {
                let is_beyond = Vec3::from(beyond.to_array().map(|b| if b == 0.0 { 0.0 } else { 1.0 }));
                let change = Mat3::from_diagonal(is_beyond) * log_change(angle) * Mat3::from_quat(self.rest[index].0);
                equations.add(&[(unknown, change)], beyond, Mat3::from_diagonal(Vec3::splat(LIMIT)));
            }
        }
        (equations.matrix, equations.right)
    }

    /// How a target's mean point moves with each unknown.
    fn target_blocks(&self, target: &Target, motions: &[Rigid], first: &[Option<usize>]) -> Vec<(usize, Mat3)> {
        let mut blocks = Vec::new();
        if self.shifts {
            blocks.push((0, Mat3::IDENTITY));
        }
        for &(bone, share, point) in &target.parts {
            let place = motions[bone].apply(point);
            self.each_above(bone, |above| {
                if let Some(unknown) = first[above] {
                    let arm = place - motions[above].apply(self.joints[above]);
                    blocks.push((unknown, -cross_matrix(arm) * self.axes(above, motions) * share));
                }
            });
        }
        blocks
    }

    /// How a bone's direction turns with each unknown, seen through `change`.
    fn turn_blocks(&self, bone: usize, motions: &[Rigid], first: &[Option<usize>], change: Mat3) -> Vec<(usize, Mat3)> {
        let mut blocks = Vec::new();
        self.each_above(bone, |above| {
            blocks.extend(first[above].map(|unknown| (unknown, change * self.axes(above, motions))));
        });
        blocks
    }

    /// The axes about which a bone turns: the frame's, turned with its parent.
    fn axes(&self, bone: usize, motions: &[Rigid]) -> Mat3 {
        if bone == 0 { Mat3::IDENTITY } else { Mat3::from_quat(motions[self.parents[bone]].rotation) }
    }

    fn each_above(&self, mut bone: usize, mut visit: impl FnMut(usize)) {
        loop {
            visit(bone);
            if bone == 0 {
                return;
            }
            bone = self.parents[bone];
        }
    }
}

/// Weight of a steady bone's direction in the world.
const STEADY: f32 = 0.01;

struct Equations {
    matrix: Vec<f64>,
    right: Vec<f64>,
    count: usize,
}

impl Equations {
    /// Adds the residual `off` of this `weight`, which changes with the unknowns as the blocks say.
    fn add(&mut self, blocks: &[(usize, Mat3)], off: Vec3, weight: Mat3) {
        let (off, weight) = (off.as_dvec3(), weight.as_dmat3());
        let blocks: Vec<(usize, DMat3)> = blocks.iter().map(|&(at, block)| (at, block.as_dmat3())).collect();
        for &(row, block) in &blocks {
            let left = block.transpose() * weight;
            let pull = left * off;
            (0..3).for_each(|k| self.right[row + k] -= pull[k]);
            for &(column, other) in &blocks {
                let product = left * other;
                for j in 0..3 {
                    for k in 0..3 {
                        self.matrix[(row + k) * self.count + column + j] += product.col(j)[k];
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skin::Influences;

    /// Four bones in a bent row, a fifth beside.
    fn rig() -> Rig {
        let joints = [
            Vec3::ZERO,
            Vec3::new(0.0, 0.3, 0.02),
            Vec3::new(0.05, 0.6, 0.0),
            Vec3::new(0.1, 0.9, 0.1),
            Vec3::new(0.2, 0.3, 0.0),
        ];
        let bones = [0, 0, 1, 2, 1].iter().zip(joints).enumerate().map(|(index, (&parent, joint))| Bone {
            name: format!("b{index}"),
            parent,
            joint,
            limb: u32::from(index == 4),
            range: [Vec3::splat(-0.2), Vec3::splat(0.2)],
            spread: Mat3::from_diagonal(Vec3::new(0.1, 0.02, 0.05)),
            gap: 0.0,
        });
        let rest: Vec<Vec3> = (0..20).map(|k| joints[k % 5] + Vec3::new(0.1, 0.05 * k as f32, 0.1)).collect();
        let influences = (0..20).map(|k| Influences { joints: [(k % 5) as u8; 4], weights: [1.0, 0.0, 0.0, 0.0] });
        Rig::new(bones.collect(), influences.collect(), (0..20).map(|k| k % 5).collect(), rest).unwrap()
    }

    fn reach(rig: &Rig) -> Reach {
        let motion = Rigid { rotation: Quat::from_rotation_y(0.7), translation: Vec3::new(1.0, 0.0, 2.0) };
        let steady = vec![false, false, false, true, false];
        Reach::new(rig, &[motion; 5], vec![true; 5], |_| Role::Stays, steady)
    }

    fn target(reach: &Reach) -> Target {
        let point = reach.joints[3] + Vec3::new(0.0, 0.1, 0.0);
        Target {
            parts: vec![(3, 0.7, point), (4, 0.3, point)],
            to: point + Vec3::new(0.3, -0.4, 0.2),
            weight: Vec3::new(1.0, 1.0, 0.5),
            is_floor: false,
        }
    }

    #[test]
    fn the_gradient_is_that_of_central_differences() {
        let rig = rig();
        let reach = reach(&rig);
        let targets = [target(&reach)];
        let centre = Bend::none(5);
        let mut bend = Bend::none(5);
        for (k, turn) in bend.turns.iter_mut().enumerate() {
            *turn = Quat::from_scaled_axis(Vec3::new(0.5 - 0.1 * k as f32, 0.3, -0.7));
        }
        bend.shift = Vec3::new(0.1, -0.2, 0.3);
        let (_, right) = reach.normal(&targets, &centre, &bend);
        for k in 0..right.len() {
            let at = |h: f64| {
                let mut step = vec![0.0; right.len()];
                step[k] = h;
                reach.cost(&targets, &centre, &reach.stepped(&bend, &step))
            };
            let h = 2e-3;
            // The right side is minus half the cost's gradient.
            let difference = -(at(h) - at(-h)) / (4.0 * h);
            assert!((difference - right[k]).abs() < 5e-3 * right[k].abs().max(0.02), "{k}: {difference} {}", right[k]);
        }
    }

    #[test]
    fn a_near_target_is_reached_and_no_target_moves_nothing() {
        let rig = rig();
        let reach = reach(&rig);
        let mut bend = Bend::none(5);
        reach.solve(&[], &Bend::none(5), &mut bend, 5);
        assert_eq!(bend, Bend::none(5));
        let mut target = target(&reach);
        target.parts = vec![(3, 1.0, target.parts[0].2)];
        target.to = target.parts[0].2 + Vec3::new(0.05, -0.03, 0.04);
        target.weight = Vec3::ONE * 100.0;
        reach.solve(std::slice::from_ref(&target), &Bend::none(5), &mut bend, 20);
        assert!(Reach::place(&target, &reach.motions(&bend)).distance(target.to) < 2e-3);
    }
}
