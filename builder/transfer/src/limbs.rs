//! Which limb of one actor is which of the other: the ones whose ends are at the same places when both do the same.

use glam::{Quat, Vec2, Vec3};

use crate::pair::Pair;
use crate::subject::Subject;

/// More limbs than these are not tried in all orders.
const MOST: usize = 6;
/// Pairs that are looked at, at most.
const LOOKED_AT: usize = 60;

/// For each part of the target the part of the source that is the same (0: the torso), or `None` where the bodies have other
/// numbers of limbs, or too many to tell. Parts that were painted with the same numbers are the same.
pub fn matching(source: &Subject, target: &Subject, pairs: &[Pair]) -> Option<Vec<usize>> {
    let count = target.parts.limbs.len();
    if count > 0 && source.parts.painted == target.parts.painted && !target.parts.painted.is_empty() {
        return Some((0..=count).collect());
    }
    if count == 0 || count > MOST || source.parts.limbs.len() != count {
        return None;
    }
    let stride = pairs.len().div_ceil(LOOKED_AT).max(1);
    let chosen: Vec<&Pair> = pairs.iter().step_by(stride).collect();
    let source_ends: Vec<Vec<Vec3>> = chosen.iter().map(|pair| ends(source, pair.source as u32)).collect();
    let target_ends: Vec<Vec<Vec3>> = chosen.iter().map(|pair| ends(target, pair.target)).collect();
    let travels = travel(source) && travel(target);
    let misfit = |order: &[usize]| misfit(&source_ends, &target_ends, order, travels);
    let orders = orders(count).into_iter().map(|order| (misfit(&order), order));
    let (_, best) = orders.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(std::iter::once(0).chain(best.into_iter().map(|limb| limb + 1)).collect())
}

/// Where the ends of all limbs are in the frame that is turned as the body faces, in body sizes.
fn ends(subject: &Subject, frame: u32) -> Vec<Vec3> {
    let root = subject.roots[frame as usize];
    let (pose, back) = (subject.poses.frame(frame), Quat::from_rotation_y(-root.heading));
    let end = |tip: u32| back * (pose[tip as usize] - root.centre) / subject.size;
    subject.parts.limbs.iter().map(|limb| end(limb.tip)).collect()
}

/// Whether an actor goes so far that the direction in which it goes is its front.
fn travel(subject: &Subject) -> bool {
    let at = |frame: usize| subject.roots[frame].centre;
    (1..subject.roots.len())
        .map(|frame| at(frame).distance(at(frame - 1)))
        .filter(|step| *step < subject.size)
        .sum::<f32>()
        > subject.size
}

/// How far ends are apart in one order, at the turn about +Y that is best; none where both bodies know their front.
fn misfit(source: &[Vec<Vec3>], target: &[Vec<Vec3>], order: &[usize], fronts_are_known: bool) -> f32 {
    let (mut same, mut across, mut rest) = (Vec2::ZERO, 0.0, 0.0);
    for (source, target) in source.iter().zip(target) {
        for (limb, end) in target.iter().enumerate() {
            let other = source[order[limb]];
            let (a, b) = (Vec2::new(other.x, other.z), Vec2::new(end.x, end.z));
            same += Vec2::new(a.dot(b), a.perp_dot(b));
            across += a.length_squared() + b.length_squared();
            rest += (other.y - end.y).powi(2);
        }
    }
    across - 2.0 * if fronts_are_known { same.x } else { same.length() } + rest
}

/// All orders of `count` things.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let mut orders = vec![Vec::new()];
    for _ in 0..count {
        orders = orders
            .into_iter()
            .flat_map(|order: Vec<usize>| {
                let free: Vec<usize> = (0..count).filter(|k| !order.contains(k)).collect();
                free.into_iter().map(move |k| order.iter().copied().chain([k]).collect())
            })
            .collect();
    }
    orders
}
