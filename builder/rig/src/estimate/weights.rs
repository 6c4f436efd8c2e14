//! Skin weights from motion: how much of each bone's motion each vertex shares.
//!
//! This work is based on: Le and Deng (2012), section 4: of each vertex the weights, not negative and with a sum of 1, that
//! bring it nearest to where it was recorded, of at most four bones; then each bone's transforms anew, the weights held.

use editing::rotation::Fit;
use editing::{INFLUENCES, Influences, Rigid};
use glam::Vec3;
use rayon::prelude::*;

use super::clusters::error;
use super::keys::Keys;

/// Candidates for each vertex: those that explain it best alone.
const CANDIDATES: usize = 8;
/// Sweeps over pairs of weights.
const SWEEPS: usize = 60;

/// Weights of every vertex among the bones that `candidates` names for it.
#[must_use]
pub fn weights(
    keys: &Keys,
    motions: &[Vec<Rigid>],
    candidates: impl Fn(usize) -> Vec<usize> + Sync,
) -> Vec<Influences> {
    let one = |v: usize| {
        let mut near: Vec<(f32, usize)> =
            candidates(v).into_iter().map(|bone| (error(keys, v, &motions[bone]), bone)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.truncate(CANDIDATES);
        let mut bones: Vec<usize> = near.into_iter().map(|(_, bone)| bone).collect();
        let mut shares = shares(keys, motions, v, &bones);
        let mut order: Vec<usize> = (0..bones.len()).collect();
        order.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]).then(a.cmp(&b)));
        order.truncate(INFLUENCES);
        bones = order.iter().map(|&k| bones[k]).collect();
        shares = self::shares(keys, motions, v, &bones);
        let at =
            |k: usize| (bones.get(k).map_or(bones[0], |&bone| bone) as u8, shares.get(k).map_or(0.0, |&w| w as f32));
        Influences { joints: std::array::from_fn(|k| at(k).0), weights: std::array::from_fn(|k| at(k).1) }
    };
    (0..keys.poses[0].len()).into_par_iter().map(one).collect()
}

/// The least `w^T G w` over weights that are not negative and have a sum of 1, where `G` holds the products of what each bone
/// misses: pair after pair, each exactly.
fn shares(keys: &Keys, motions: &[Vec<Rigid>], v: usize, bones: &[usize]) -> Vec<f64> {
    let m = bones.len();
    let rest = keys.poses[0][v];
    let mut products = vec![0.0; m * m];
    let mut missed = vec![Vec3::ZERO; m];
    for (key, pose) in keys.poses.iter().enumerate() {
        for (missed, &bone) in missed.iter_mut().zip(bones) {
            *missed = motions[bone][key].apply(rest) - pose[v];
        }
        for a in 0..m {
            for b in 0..m {
                products[a * m + b] += f64::from(missed[a].dot(missed[b]));
            }
        }
    }
    // A tie between bones that move alike goes to all of them.
    let ridge = 1e-4 * (0..m).map(|k| products[k * m + k]).fold(0.0, f64::max) + 1e-12;
    (0..m).for_each(|k| products[k * m + k] += ridge);
    let mut w = vec![0.0; m];
    w[0] = 1.0;
    for _ in 0..SWEEPS {
        let mut moved = 0.0_f64;
        for a in 0..m {
            for b in a + 1..m {
                let slope = |k: usize| (0..m).map(|j| products[k * m + j] * w[j]).sum::<f64>();
                let curve = products[a * m + a] + products[b * m + b] - 2.0 * products[a * m + b];
                if curve <= 0.0 {
                    continue;
                }
                let step = ((slope(b) - slope(a)) / curve).clamp(-w[a], w[b]);
                w[a] += step;
                w[b] -= step;
                moved = moved.max(step.abs());
            }
        }
        if moved < 1e-5 {
            break;
        }
    }
    let sum: f64 = w.iter().sum();
    w.iter().map(|w| (w / sum).max(0.0)).collect()
}

/// The transforms of the bones anew, one after the other, the weights held.
pub fn refit(keys: &Keys, motions: &mut [Vec<Rigid>], influences: &[Influences]) {
    let rest = &keys.poses[0];
    let bones = motions.len();
    let mut movers: Vec<Vec<(u32, f32)>> = vec![Vec::new(); bones];
    for (v, one) in influences.iter().enumerate() {
        for (&bone, &weight) in one.joints.iter().zip(&one.weights) {
            if weight > 1e-3 {
                movers[bone as usize].push((v as u32, weight));
            }
        }
    }
    let by_key: Vec<Vec<Rigid>> = (0..keys.poses.len())
        .into_par_iter()
        .map(|key| {
            let mut own: Vec<Rigid> = motions.iter().map(|motions| motions[key]).collect();
            for bone in 0..bones {
                let mut fit = Fit::default();
                for &(v, weight) in &movers[bone] {
                    let v = v as usize;
                    // What the other bones leave to this one.
                    let left =
                        keys.poses[key][v] - blend(&influences[v], &own, rest[v]) + own[bone].apply(rest[v]) * weight;
                    fit.add(rest[v], left / weight, weight * weight);
                }
                if movers[bone].len() >= 3 {
                    own[bone] = fit.rigid();
                }
            }
            own
        })
        .collect();
    for (bone, motions) in motions.iter_mut().enumerate() {
        motions.iter_mut().zip(&by_key).for_each(|(motion, own)| *motion = own[bone]);
    }
}

/// Linear blend skinning of one vertex.
#[must_use]
pub fn blend(influences: &Influences, motions: &[Rigid], rest: Vec3) -> Vec3 {
    let parts = influences.joints.iter().zip(&influences.weights).filter(|(_, weight)| **weight > 0.0);
    parts.map(|(&bone, &weight)| motions[bone as usize].apply(rest) * weight).sum()
}

/// Root of the mean square, in metres, of what linear blend skinning misses over all vertices and key frames, and its 95th
/// percentile.
#[must_use]
pub fn misfit(keys: &Keys, motions: &[Vec<Rigid>], influences: &[Influences]) -> [f32; 2] {
    let rest = &keys.poses[0];
    let mut off: Vec<f32> = (0..keys.poses.len())
        .into_par_iter()
        .flat_map_iter(|key| {
            let own: Vec<Rigid> = motions.iter().map(|motions| motions[key]).collect();
            let pose = &keys.poses[key];
            (0..rest.len()).map(move |v| blend(&influences[v], &own, rest[v]).distance(pose[v])).collect::<Vec<_>>()
        })
        .collect();
    let mean = off.iter().map(|&off| f64::from(off * off)).sum::<f64>() / off.len().max(1) as f64;
    off.sort_by(f32::total_cmp);
    [mean.sqrt() as f32, off.get(off.len() * 95 / 100).copied().unwrap_or_default()]
}

/// The same for the vertices that each bone moves most: root of the mean square, in metres.
#[must_use]
pub fn misfit_by_bone(keys: &Keys, motions: &[Vec<Rigid>], influences: &[Influences]) -> Vec<f32> {
    let mut sums = vec![(0.0_f64, 0_usize); motions.len()];
    for (key, pose) in keys.poses.iter().enumerate() {
        let own: Vec<Rigid> = motions.iter().map(|motions| motions[key]).collect();
        for ((influences, &rest), &point) in influences.iter().zip(&keys.poses[0]).zip(pose) {
            let most =
                (1..INFLUENCES).fold(0, |a, b| if influences.weights[b] > influences.weights[a] { b } else { a });
            let sum = &mut sums[influences.joints[most] as usize];
            sum.0 += f64::from(blend(influences, &own, rest).distance_squared(point));
            sum.1 += 1;
        }
    }
    sums.iter().map(|&(sum, count)| (sum / count.max(1) as f64).sqrt() as f32).collect()
}
