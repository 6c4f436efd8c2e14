//! Which way a body faces, by its toes: where it goes may be backwards or aside.

use actor::capture::Poses;
use glam::{Vec2, Vec3, Vec3Swizzles};
use motion::body::BodyFrame;
use parts::{Limb, Parts};

/// What is within this of the end of a leg is its foot, in body sizes: 27 cm of 1.8 m.
const FOOT: f32 = 0.15;
/// Frames that are looked at.
const LOOKED_AT: usize = 40;
/// Toes that point to one side by less than this share of a foot tell nothing.
const SURE: f32 = 0.1;

/// The direction of the toes of the two lowest limbs, in the frames `bodies`, as an angle about +Y from +Z: on average over frames.
/// `None` of a body that has no two limbs, or whose ends point nowhere.
pub fn toes(poses: &Poses, bodies: &[BodyFrame], parts: &Parts, size: f32) -> Option<f32> {
    let count = bodies.len();
    let frames: Vec<usize> = (0..LOOKED_AT.min(count)).map(|k| k * count / LOOKED_AT.min(count)).collect();
    let mut limbs: Vec<(f32, &Limb)> = parts
        .limbs
        .iter()
        .map(|limb| (frames.iter().map(|&frame| poses.frame(frame as u32)[limb.tip as usize].y).sum(), limb))
        .collect();
    limbs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(_, first), (_, second), ..] = limbs.as_slice() else { return None };
    let direction = |limb: &Limb, frame: usize| -> Vec2 {
        let pose = poses.frame(frame as u32);
        let tip = pose[limb.tip as usize];
        let is_foot = |v: &usize| limb.weights[*v] > 0.0 && pose[*v].distance(tip) < FOOT * size;
        let (mut sum, mut found) = (Vec3::ZERO, 0.0);
        for v in (0..pose.len()).filter(is_foot) {
            sum += pose[v];
            found += 1.0;
        }
        let toe = tip - sum / f32::max(found, 1.0);
        (bodies[frame].rotation.inverse() * toe).xz() / (FOOT * size)
    };
    let both = |&frame: &usize| direction(first, frame) + direction(second, frame);
    let mean = frames.iter().map(both).sum::<Vec2>() / (2 * frames.len().max(1)) as f32;
    (mean.length() > SURE).then(|| mean.x.atan2(mean.y))
}
