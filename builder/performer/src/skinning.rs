//! Which joint of the skeleton owns a vertex of the figure, and how far its weights spread.

use glam::Vec3;
use rayon::prelude::*;

use super::body::Body;
use super::skeleton::{JOINT_COUNT, joint};
use geometry::mesh::Mesh;
use rig::Influences;

/// Skin weights of every vertex of `mesh`, which is the figure in the bind pose.
#[must_use]
pub fn weights(body: &Body, mesh: &Mesh) -> Vec<Influences> {
    let owners: Vec<usize> = mesh.positions.par_iter().map(|&p| nearest_joint(body, p)).collect();
    rig::spread(mesh, &owners, &std::array::from_fn::<f32, JOINT_COUNT, _>(reach))
}

/// Length in metres over which weights spread.
fn reach(index: usize) -> f32 {
    match index {
        joint::PELVIS..=joint::CHEST => 0.05,
        joint::NECK | joint::HEAD => 0.022,
        8 | 12 => 0.016,
        15 | 16 | 19 | 20 => 0.01,
        joint::TAIL.. => 0.03,
        _ => 0.028,
    }
}

/// The joint whose bone owns a point: first the part of the body, then the bone along it.
fn nearest_joint(body: &Body, p: Vec3) -> usize {
    let fields = body.fields(p);
    let at = |index: usize| body.bind()[index].translation;
    let beyond = |index: usize| {
        // Past the joint, seen along the bisector of the bones that meet there.
        let (before, here, after) = (at(index - 1), at(index), at(index + 1));
        let along = (here - before).normalize_or_zero() + (after - here).normalize_or_zero();
        (p - here).dot(along) > 0.0
    };
    let side = usize::from(p.x < 0.0);
    if fields.tail < fields.hair.min(fields.head) - 0.002 {
        return if p.y < at(joint::TAIL + 2).y {
            joint::TAIL + 2
        } else if p.z < at(joint::TAIL + 1).z + 0.035 {
            joint::TAIL + 1
        } else {
            joint::TAIL
        };
    }
    let arm = joint::ARM[side];
    let shoulder = at(arm + 1);
    let along = (at(arm + 2) - shoulder).normalize_or_zero();
    let out = if side == 0 { Vec3::X } else { Vec3::NEG_X };
    let on_arm = (p - shoulder).dot((along + out).normalize_or_zero()) > 0.0 && (p - shoulder).dot(along) < 1.0;
    if on_arm
        && fields.arms[side].min(fields.shirt) < 0.03
        && (p - shoulder).reject_from_normalized(along).length() < 0.14
        && p.y > 0.6
    {
        let distance_to_arm = distance_to_chain(
            p,
            &[shoulder, at(arm + 2), at(arm + 3), at(arm + 3) + (at(arm + 3) - at(arm + 2)).normalize_or_zero() * 0.2],
        );
        if distance_to_arm < 0.12 {
            return if beyond_wrist(body, p, arm + 3) {
                arm + 3
            } else if beyond(arm + 2) {
                arm + 2
            } else {
                arm + 1
            };
        }
    }
    if p.y > at(joint::CHEST).y {
        let local = p - at(joint::HEAD);
        if local.y + 0.3 * local.z.max(-0.05) > 0.0
            || fields.hair.min(fields.head) < fields.shirt && p.y > at(joint::HEAD).y - 0.03
        {
            return joint::HEAD;
        }
        if p.y > at(joint::NECK).y - 0.01 && p.x.abs() < 0.075 {
            return joint::NECK;
        }
        return if p.x.abs() > 0.085 && p.y > 1.33 { arm } else { joint::CHEST };
    }
    let leg = joint::LEG[side];
    let lower = fields.legs[side].min(fields.shoes[side]);
    if lower < fields.shirt.min(fields.skirt) && p.y < at(leg).y - 0.02 {
        if fields.shoes[side] < fields.legs[side] || p.y < at(leg + 2).y - 0.005 {
            let local = body.to_joint(p, leg + 2);
            return if local.z > 0.112 - 0.35 * (local.y + 0.085) { leg + 3 } else { leg + 2 };
        }
        return if beyond(leg + 2) {
            leg + 2
        } else if beyond(leg + 1) {
            leg + 1
        } else {
            leg
        };
    }
    if p.y > at(joint::SPINE).y - 0.01 { joint::SPINE } else { joint::PELVIS }
}

fn beyond_wrist(body: &Body, p: Vec3, hand: usize) -> bool {
    body.to_joint(p, hand).y < -0.002
}

fn distance_to_chain(p: Vec3, chain: &[Vec3]) -> f32 {
    chain.windows(2).map(|pair| geometry::sdf::cone(p, pair[0], pair[1], 0.0, 0.0)).fold(f32::INFINITY, f32::min)
}
