//! Where a limb is joined to the torso: where the surface no longer turns with the limb.

use actor::capture::Poses;
use glam::{DMat3, DQuat, Vec3};
use kernels::rotation::best_rotation;
use rayon::prelude::*;

use crate::extremities::{Extremities, Extremity};
use crate::measured::Measured;

/// Bands that are looked at are this wide, relative to the body's size: 5 cm of 1.8 m.
const BAND: f32 = 0.028;
/// A limb turns as a whole up to this share of the way to its pass.
const WHOLE: f32 = 0.8;
/// It ends where what is left of that turn is this share.
const LEFT: f64 = 0.5;
/// Nothing beyond this multiple of the way to the pass belongs to it.
const BEYOND: f32 = 1.4;
/// A limb that turns by less than this against the torso, in radians, tells nothing: it ends at its pass.
const STILL: f64 = 0.03;
/// Limbs that reach and end at places so much alike are a pair.
const ALIKE: f32 = 0.12;

/// How far from its tip each limb ends, in metres.
pub fn hinges(found: &Extremities, poses: &Poses, frames: &[u32], body: &Measured) -> Vec<f32> {
    let cores: Vec<DQuat> = turns(&found.core, poses, frames);
    let mut radii: Vec<f32> = found.limbs.par_iter().map(|limb| hinge(limb, &cores, poses, frames, body)).collect();
    // What a pair disagrees on belongs to the torso.
    let own = radii.clone();
    for (k, limb) in found.limbs.iter().enumerate() {
        let unlike = |a: f32, b: f32| (a - b).abs() / a.max(b);
        let twin = (0..own.len()).filter(|&other| other != k).min_by(|&a, &b| {
            unlike(limb.reach, found.limbs[a].reach).total_cmp(&unlike(limb.reach, found.limbs[b].reach))
        });
        if let Some(twin) = twin
            && unlike(limb.reach, found.limbs[twin].reach) < ALIKE
            && unlike(own[k], own[twin]) < ALIKE
        {
            radii[k] = own[k].min(own[twin]);
        }
    }
    radii
}

fn hinge(limb: &Extremity, cores: &[DQuat], poses: &Poses, frames: &[u32], body: &Measured) -> f32 {
    let width = (BAND * body.size).max(1.5 * body.edge);
    let pass = limb.pass.min(limb.stop);
    let last = ((BEYOND * pass).min(limb.stop) / width) as usize;
    let mut bands: Vec<Vec<u32>> = vec![Vec::new(); last + 1];
    for (vertex, &distance) in limb.distances.iter().enumerate() {
        if let Some(band) = bands.get_mut((distance / width) as usize) {
            band.push(vertex as u32);
        }
    }
    let turn: Vec<f64> = bands.par_iter().map(|band| turning(&turns(band, poses, frames), cores)).collect();
    let at = |k: usize| (k as f32 + 0.5) * width;
    let whole = ((WHOLE * pass / width) as usize).min(last);
    let enough = LEFT * turn[whole];
    if turn[whole] < STILL {
        return pass;
    }
    for k in whole..last {
        if turn[k + 1] < enough {
            let share = ((turn[k] - enough) / (turn[k] - turn[k + 1]).max(1e-12)).clamp(0.0, 1.0);
            return (at(k) + share as f32 * width).min(limb.stop);
        }
    }
    pass
}

/// How some vertices are turned in each frame, from the first one.
fn turns(vertices: &[u32], poses: &Poses, frames: &[u32]) -> Vec<DQuat> {
    let points = |frame: u32| -> Vec<Vec3> {
        let pose = poses.frame(frame);
        let centre = vertices.iter().map(|&v| pose[v as usize]).sum::<Vec3>() / vertices.len().max(1) as f32;
        vertices.iter().map(|&v| pose[v as usize] - centre).collect()
    };
    let first = frames.first().map(|&frame| points(frame)).unwrap_or_default();
    let turn = |&frame: &u32| {
        let mut sum = DMat3::ZERO;
        for (from, to) in first.iter().zip(points(frame)) {
            let (from, to) = (from.as_dvec3(), to.as_dvec3());
            sum += DMat3::from_cols(to * from.x, to * from.y, to * from.z);
        }
        best_rotation(&sum)
    };
    frames.iter().map(turn).collect()
}

/// How much turns differ from those of the core, in radians: the deviation from their mean.
fn turning(turns: &[DQuat], cores: &[DQuat]) -> f64 {
    let relative: Vec<DQuat> = turns.iter().zip(cores).map(|(turn, core)| core.inverse() * *turn).collect();
    let Some(&first) = relative.first() else { return 0.0 };
    let mut mean = first;
    for _ in 0..3 {
        let sum = relative.iter().fold(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), |sum, &turn| {
            sum + if turn.dot(mean) < 0.0 { -turn } else { turn }
        });
        mean = sum.normalize();
    }
    let apart = |turn: &DQuat| {
        let angle = 2.0 * turn.dot(mean).abs().min(1.0).acos();
        angle * angle
    };
    (relative.iter().map(apart).sum::<f64>() / relative.len() as f64).sqrt()
}
