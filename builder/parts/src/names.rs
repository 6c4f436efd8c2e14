//! Names of parts: the arms and legs of a body that stands upright, each with its side; numbers where that cannot be told.

use actor::capture::Poses;
use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::body::Parts;
use crate::measured::spread;

/// Frames that are looked at.
const LOOKED_AT: usize = 40;
/// What is within this of the end of a leg is its foot, in body sizes: 27 cm of 1.8 m.
const FOOT: f32 = 0.15;
/// Arms end above this part of how high the body reaches, on average over frames, and so much higher than legs.
const LOW: f32 = 0.25;
const APART: f32 = 0.1;

/// What is seen of a body in one frame.
struct Seen {
    /// The ends of limbs, from the middle of the body.
    ends: Vec<Vec3>,
    /// To the body's left, on the ground; longer where toes say more clearly where the front is.
    left: Vec2,
}

impl Parts {
    /// A name for each part, the torso's first, all of them different. Which side is left is told by the toes.
    #[must_use]
    pub fn names(&self, poses: &Poses) -> Vec<String> {
        if !self.painted.is_empty() {
            return self.painted.iter().map(|number| format!("part {number}")).collect();
        }
        let mut names = vec!["torso".to_owned()];
        names.extend((1..self.count()).map(|limb| format!("limb {limb}")));
        if let Some(sides) = self.human(poses) {
            names[1..].iter_mut().zip(sides).for_each(|(name, human)| *name = human.to_owned());
        }
        names
    }

    /// Names of four limbs that are two legs and two arms; `None` where they are not.
    fn human(&self, poses: &Poses) -> Option<[&'static str; 4]> {
        if self.limbs.len() != 4 {
            return None;
        }
        let tips: Vec<u32> = self.limbs.iter().map(|limb| limb.tip).collect();
        let frames = spread(poses.len(), LOOKED_AT);
        let height = |limb: usize| {
            let heights = frames.iter().map(|&frame| height(poses.frame(frame), tips[limb]));
            heights.sum::<f32>() / frames.len() as f32
        };
        let heights: Vec<f32> = (0..4).map(height).collect();
        let mut order = [0, 1, 2, 3];
        order.sort_by(|&a, &b| heights[a].total_cmp(&heights[b]).then(a.cmp(&b)));
        if heights[order[2]] < LOW || heights[order[2]] - heights[order[1]] < APART {
            return None;
        }
        let feet = [tips[order[0]], tips[order[1]]];
        let seen: Vec<Seen> = frames.iter().map(|&frame| Seen::of(poses.frame(frame), &tips, feet)).collect();
        // How far to the left of the other one a limb is.
        let left =
            |a: usize, b: usize| seen.iter().map(|one| (one.ends[a] - one.ends[b]).xz().dot(one.left)).sum::<f32>();
        let mut names = [""; 4];
        for (pair, words) in
            [([order[0], order[1]], ["left leg", "right leg"]), ([order[2], order[3]], ["left arm", "right arm"])]
        {
            let turned = usize::from(left(pair[0], pair[1]) < 0.0);
            (names[pair[0]], names[pair[1]]) = (words[turned], words[1 - turned]);
        }
        Some(names)
    }
}

impl Seen {
    fn of(pose: &[Vec3], tips: &[u32], feet: [u32; 2]) -> Self {
        let middle = pose.iter().sum::<Vec3>() / pose.len().max(1) as f32;
        let ends = tips.iter().map(|&tip| pose[tip as usize] - middle).collect();
        let (low, high) = reach(pose);
        let near = FOOT * (high - low).max_element();
        let front: Vec2 = feet.iter().map(|&foot| toe(pose, pose[foot as usize], near)).sum();
        // Up crossed with the front.
        Self { ends, left: Vec2::new(front.y, -front.x) }
    }
}

/// Where the toes of a foot point that ends at `tip`, on the ground.
fn toe(pose: &[Vec3], tip: Vec3, near: f32) -> Vec2 {
    let foot = pose.iter().filter(|point| point.distance(tip) < near);
    let (sum, count) = foot.fold((Vec3::ZERO, 0.0), |(sum, count), &point| (sum + point, count + 1.0));
    (tip - sum / f32::max(count, 1.0)).xz()
}

/// How high a vertex is over the lowest point, as a part of how high the body reaches.
fn height(pose: &[Vec3], vertex: u32) -> f32 {
    let (low, high) = reach(pose);
    (pose[vertex as usize].y - low.y) / (high.y - low.y).max(f32::MIN_POSITIVE)
}

/// The corners of the box about a pose.
fn reach(pose: &[Vec3]) -> (Vec3, Vec3) {
    let low = pose.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    (low, pose.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max))
}
