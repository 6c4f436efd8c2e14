//! How the body of a blend gets on: so that the foot that stands is left behind where it stands.
//!
//! Two gaits at one phase need not have the same feet on the ground. The mean of their speeds would have feet slide by
//! centimetres; what is taken instead is the speed at which the foot that is down stays, and in flight what leads from one to the
//! next. Not in the paper, which does not say.

use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::align::{Placement, rotate};

use crate::pair::Blend;
use crate::recorded::Recorded;

/// A sole touches the ground up to the first height, and not above the second, in body heights: 5 and 20 mm of 1.8 m.
const TOUCHES: [f32; 2] = [0.003, 0.011];
/// The speed changes over so many seconds.
const SMOOTH: f32 = 0.03;

/// Where a blend is, frame by frame.
#[derive(Clone, Debug)]
pub(crate) struct Route {
    /// Placements of all frames, and of one more: where it begins again, or is held.
    pub placements: Vec<Placement>,
    /// For each foot and frame how far it goes from here to the next one while it is on the ground, in metres along (X, Z).
    pub slips: Vec<Vec<Vec2>>,
}

/// How firmly a point at a height above the ground touches it.
pub(crate) fn touch(height: f32, body: f32) -> f32 {
    let t = ((height / body - TOUCHES[0]) / (TOUCHES[1] - TOUCHES[0])).clamp(0.0, 1.0);
    1.0 - t * t * (3.0 - 2.0 * t)
}

/// The route of a blend whose feet stand as `stands` says, for each foot and frame.
pub(crate) fn route(recorded: &Recorded, blend: &Blend, stands: &[Vec<bool>], cyclic: bool) -> Route {
    let frames = blend.poses.len();
    let steps = blend.seen.len() - 1;
    let along: Vec<Placement> = blend.seen.iter().map(|seen| seen.along.placement()).collect();
    let next = |k: usize| if cyclic { (k + 1) % frames } else { k + 1 };
    let body = recorded.body();
    let mut slips = vec![vec![Vec2::ZERO; steps]; stands.len()];
    // In axes that turn along.
    let mut wanted: Vec<Option<(Vec2, f32)>> = vec![None; steps];
    for k in 0..steps {
        let (mut sum, mut total) = (Vec2::ZERO, 0.0_f32);
        for (foot, own) in stands.iter().enumerate().filter(|(_, own)| own[k] && own[next(k)]) {
            debug_assert_eq!(own.len(), frames);
            let (slip, weight) =
                slip(recorded, foot, body, [&blend.poses[k], &blend.poses[next(k)]], [along[k], along[k + 1]]);
            slips[foot][k] = slip;
            (sum, total) = (sum + slip * weight, total + weight);
        }
        if total > 0.0 {
            wanted[k] = Some((rotate(-along[k].heading, -sum / total), total.min(1.0)));
        }
    }
    let corrections = smoothed(&filled(&wanted, cyclic), SMOOTH * recorded.timeline.fps(), cyclic);
    let mut aside = Vec2::ZERO;
    let mut placements = Vec::with_capacity(steps + 1);
    for k in 0..=steps {
        placements.push(Placement { translation: along[k].translation + aside, ..along[k] });
        if let Some(&correction) = corrections.get(k) {
            let step = rotate(along[k].heading, correction);
            aside += step;
            slips.iter_mut().enumerate().filter(|(foot, _)| stands[*foot][k] && stands[*foot][next(k)]).for_each(
                |(_, own)| {
                    own[k] += step;
                },
            );
        }
    }
    Route { placements, slips }
}

/// How far what touches the ground of a foot goes from one frame to the next, and how firmly it stands.
fn slip(
    recorded: &Recorded,
    foot: usize,
    body: f32,
    [before, after]: [&[Vec3]; 2],
    [here, there]: [Placement; 2],
) -> (Vec2, f32) {
    let (mut sum, mut total, mut firmest) = (Vec2::ZERO, 0.0, 0.0_f32);
    let low = recorded.lowest(foot, before).max(recorded.lowest(foot, after)).max(0.0);
    for vertex in recorded.sole(foot) {
        // What is lowest touches, be it above the ground a little.
        let weight = touch(before[vertex].y - low, body) * touch(after[vertex].y - low, body);
        sum += (there.apply(after[vertex]) - here.apply(before[vertex])).xz() * weight;
        total += weight;
        firmest = firmest.max(weight);
    }
    if total > 0.0 { (sum / total, touch(low / 2.0, body) * firmest) } else { (Vec2::ZERO, 0.0) }
}

/// What is not known: of what repeats it goes from the last known to the next one, for a step is carried through its flight; a jump
/// flies as both do on average. Nothing is known: zeros.
fn filled(wanted: &[Option<(Vec2, f32)>], cyclic: bool) -> Vec<Vec2> {
    let count = wanted.len();
    let known: Vec<usize> = (0..count).filter(|&k| wanted[k].is_some()).collect();
    let value = |k: usize| wanted[k % count].map_or(Vec2::ZERO, |(value, _)| value);
    let (Some(&first), Some(&last), true) = (known.first(), known.last(), cyclic) else {
        return (0..count).map(value).collect();
    };
    let fill = |k: usize| {
        let next = known.partition_point(|&other| other < k);
        // Frames before the first known one lie behind the last one of the round before.
        let (before, k) = if next > 0 { (known[next - 1], k) } else { (last, k + count) };
        let after = known.get(next).map_or(first + count, |&after| if k >= count { after + count } else { after });
        value(before).lerp(value(after), (k - before) as f32 / (after - before) as f32)
    };
    (0..count).map(|k| if wanted[k].is_some() { value(k) } else { fill(k) }).collect()
}

/// Gaussian means over `deviation` frames.
pub(crate) fn smoothed(values: &[Vec2], deviation: f32, cyclic: bool) -> Vec<Vec2> {
    let reach = (3.0 * deviation).ceil() as i64;
    let count = values.len() as i64;
    let at = |k: i64| values[(if cyclic { k.rem_euclid(count) } else { k.clamp(0, count - 1) }) as usize];
    let weight = |beside: i64| (-0.5 * (beside as f32 / deviation.max(1e-3)).powi(2)).exp();
    let total: f32 = (-reach..=reach).map(weight).sum();
    (0..count).map(|k| (-reach..=reach).map(|beside| at(k + beside) * weight(beside)).sum::<Vec2>() / total).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_goes_on_around_the_end() {
        let known = |x: f32| Some((Vec2::new(x, 0.0), 1.0));
        let wanted = [None, known(1.0), None, None, known(4.0), None];
        for (cyclic, expected) in [(true, [2.0, 1.0, 2.0, 3.0, 4.0, 3.0]), (false, [0.0, 1.0, 0.0, 0.0, 4.0, 0.0])] {
            let filled = filled(&wanted, cyclic);
            assert!(filled.iter().zip(expected).all(|(value, x)| (value.x - x).abs() < 1e-5), "{filled:?}");
        }
        assert_eq!(filled(&[None, None], true), [Vec2::ZERO; 2]);
    }

    #[test]
    fn means_keep_what_is_even() {
        let even = vec![Vec2::ONE; 9];
        let means = smoothed(&even, 1.5, false);
        assert!(means.iter().all(|mean| mean.distance(Vec2::ONE) < 1e-6));
    }
}
