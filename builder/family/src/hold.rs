//! Feet of a blend: as high as between both, never under the ground, and still while they stand.

use glam::{Vec2, Vec3};
use kernels::align::rotate;

use actor::feet::SHARE_STEP;

use crate::pair::Blend;
use crate::pair::Pair;
use crate::recorded::Recorded;
use crate::root::{Route, touch};

/// A foot that is higher than this does not stand, in body heights: 2 cm of 1.8 m.
const HIGH: f32 = 0.011;

/// For each foot and frame of a blend whether it stands: where it does in either, and both have it near the ground.
pub(crate) fn stands(recorded: &Recorded, pair: &Pair, blend: &Blend) -> Vec<Vec<bool>> {
    let shares = [1.0 - blend.lambda, blend.lambda];
    let high = HIGH * recorded.body();
    let stands = |foot: usize, k: usize| {
        let at = blend.seen[k].at;
        let either = [0, 1].into_iter().any(|side| shares[side] > 0.0 && pair.members[side].stands_at(foot, at[side]));
        either && wanted_height(pair, blend, foot, k) < high
    };
    let mut all: Vec<Vec<bool>> =
        (0..recorded.feet.count()).map(|foot| (0..blend.poses.len()).map(|k| stands(foot, k)).collect()).collect();
    all.iter_mut().for_each(|foot| without_gaps(foot, pair.members[0].cyclic));
    all
}

/// Single frames in which a foot seems to lift are none.
fn without_gaps(stands: &mut [bool], cyclic: bool) {
    let count = stands.len();
    for k in 0..count {
        let inside = k > 0 && k + 1 < count || cyclic;
        if !stands[k] && inside && stands[(k + count - 1) % count] && stands[(k + 1) % count] {
            stands[k] = true;
        }
    }
}

/// How high the lowest point of a sole is to be, in metres above the ground.
fn wanted_height(pair: &Pair, blend: &Blend, foot: usize, k: usize) -> f32 {
    let heights = [0, 1].map(|side| {
        let member = pair.members[side];
        member.number_at(&member.lowest[foot], blend.seen[k].at[side]).max(0.0)
    });
    heights[0] + (heights[1] - heights[0]) * blend.lambda
}

/// Moves the feet of all frames, which are seen from the frame that moves along.
pub(crate) fn hold(recorded: &Recorded, pair: &Pair, blend: &mut Blend, route: &Route, stands: &[Vec<bool>]) {
    let cyclic = pair.members[0].cyclic;
    for (foot, own) in stands.iter().enumerate() {
        let held = held(own, route, foot, cyclic);
        for k in 0..blend.poses.len() {
            let up = wanted_height(pair, blend, foot, k) - recorded.lowest(foot, &blend.poses[k]);
            let by = Vec3::new(held[k].x, up, held[k].y);
            for vertex in recorded.feet.vertices(foot) {
                blend.poses[k][vertex.vertex as usize] += by * (f32::from(vertex.leg) * SHARE_STEP);
            }
        }
    }
}

/// How far a foot is moved along the ground in each frame, in axes that turn along, in metres.
fn held(stands: &[bool], route: &Route, foot: usize, cyclic: bool) -> Vec<Vec2> {
    let count = stands.len();
    let mut held = vec![Vec2::ZERO; count];
    let stances = stances(stands, cyclic);
    if stances.is_empty() {
        return held;
    }
    let turn = |k: usize| route.placements[k % count].heading + whole_turns(k / count, route, cyclic);
    // Unrolled: frames of a stance count on beyond the end.
    let mut ends = Vec::new();
    for &(first, last) in &stances {
        let mut places = vec![Vec2::ZERO];
        for k in first..last {
            let slip = rotate(whole_turns(k / count, route, cyclic), route.slips[foot][k % count]);
            places.push(places[places.len() - 1] - slip);
        }
        let mean = places.iter().sum::<Vec2>() / places.len() as f32;
        let own: Vec<Vec2> = places.iter().zip(first..).map(|(&place, k)| rotate(-turn(k), place - mean)).collect();
        own.iter().zip(first..).for_each(|(&by, k)| held[k % count] = by);
        ends.push((first, last, own[0], own[own.len() - 1]));
    }
    for (index, &(_, from, _, before)) in ends.iter().enumerate() {
        let (to, after) = match ends.get(index + 1) {
            Some(&(to, _, after, _)) => (to, after),
            None if cyclic => (ends[0].0 + count, ends[0].2),
            None => {
                (from + 1..count).for_each(|k| held[k] = before);
                continue;
            }
        };
        for k in from + 1..to {
            let u = (k - from) as f32 / (to - from) as f32;
            held[k % count] = before.lerp(after, u * u * (3.0 - 2.0 * u));
        }
    }
    if !cyclic {
        let (first, _, after, _) = ends[0];
        held[..first].fill(after);
    }
    held
}

fn whole_turns(rounds: usize, route: &Route, cyclic: bool) -> f32 {
    let end = route.placements[route.placements.len() - 1].heading;
    if cyclic { rounds as f32 * end } else { 0.0 }
}

/// First and last frame of each stance; one over the end counts on beyond it.
fn stances(stands: &[bool], cyclic: bool) -> Vec<(usize, usize)> {
    let count = stands.len();
    let begins =
        |k: usize| stands[k] && (if cyclic { !stands[(k + count - 1) % count] } else { k == 0 || !stands[k - 1] });
    let goes_on = |k: usize| if cyclic { stands[k % count] } else { k < count && stands[k] };
    let stance = |first: usize| {
        let last = (first + 1..first + count).take_while(|&k| goes_on(k)).last().unwrap_or(first);
        (first, last)
    };
    (0..count).filter(|&k| begins(k)).map(stance).collect()
}

/// How far what touches slides while it stands, on average from frame to frame in metres, and the largest mean of a step.
pub(crate) fn slide(recorded: &Recorded, poses: &[Vec<Vec3>], stands: &[Vec<bool>]) -> Option<f32> {
    let body = recorded.body();
    let (mut sum, mut total) = (0.0, 0.0);
    for (foot, own) in stands.iter().enumerate() {
        for k in (1..poses.len()).filter(|&k| own[k % own.len()] && own[k - 1]) {
            for vertex in recorded.sole(foot) {
                let (before, after) = (poses[k - 1][vertex], poses[k][vertex]);
                if touch(before.y, body) > 0.0 && touch(after.y, body) > 0.0 {
                    sum += (after - before).with_y(0.0).length();
                    total += 1.0;
                }
            }
        }
    }
    (total > 0.0).then(|| sum / total)
}
