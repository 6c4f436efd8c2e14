//! Skin weights by diffusion over the surface, and dual quaternion skinning.
//!
//! This work is based on: L. Kavan et al., "Geometric skinning with approximate dual quaternion blending", 2008. The
//! weights spread from the nearest bone by implicit heat flow on the mesh, so they are smooth over joints and never
//! jump from one limb to another through the air.

use glam::{Quat, Vec3};
use rayon::prelude::*;

use super::body::Body;
use super::skeleton::{JOINT_COUNT, Rigid, joint};
use geometry::mesh::Mesh;

/// At most this many joints move a vertex.
pub const INFLUENCES: usize = 4;

/// Joints and weights of one vertex; the weights sum to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Influences {
    /// Joints.
    pub joints: [u8; INFLUENCES],
    /// Their weights.
    pub weights: [f32; INFLUENCES],
}

/// Skin weights of every vertex of `mesh`, which is the figure in the bind pose.
#[must_use]
pub fn weights(body: &Body, mesh: &Mesh) -> Vec<Influences> {
    let nearest: Vec<usize> = mesh.positions.par_iter().map(|&p| nearest_joint(body, p)).collect();
    let neighbours = mesh.neighbours();
    let columns: Vec<Vec<f32>> = (0..JOINT_COUNT)
        .into_par_iter()
        .map(|index| {
            let start: Vec<f32> = nearest.iter().map(|&j| if j == index { 1.0 } else { 0.0 }).collect();
            if start.iter().all(|&w| w == 0.0) { start } else { diffuse(mesh, &neighbours, &start, spread(index)) }
        })
        .collect();
    (0..mesh.positions.len()).map(|vertex| strongest(&columns, vertex)).collect()
}

/// Length in metres over which weights spread.
fn spread(index: usize) -> f32 {
    match index {
        joint::PELVIS..=joint::CHEST => 0.05,
        joint::NECK | joint::HEAD => 0.022,
        8 | 12 => 0.016,
        15 | 16 | 19 | 20 => 0.01,
        joint::TAIL.. => 0.03,
        _ => 0.028,
    }
}

/// Heat flow of `values` over the mesh by implicit Euler steps, each solved by Jacobi sweeps.
pub(super) fn diffuse(mesh: &Mesh, neighbours: &[Vec<u32>], values: &[f32], length: f32) -> Vec<f32> {
    let mut now = values.to_vec();
    let steps = 3;
    for _ in 0..steps {
        let before = now.clone();
        for _ in 0..14 {
            now = (0..now.len())
                .map(|vertex| {
                    let (mut sum, mut weight) = (before[vertex], 1.0);
                    for &other in &neighbours[vertex] {
                        let distance = mesh.positions[vertex].distance(mesh.positions[other as usize]).max(1e-4);
                        // A sum over about six neighbours of (f_j - f_i) / d^2 is 1.5 times the Laplacian.
                        let pull = length * length / (distance * distance * 1.5 * steps as f32) * 2.0;
                        sum += pull * now[other as usize];
                        weight += pull;
                    }
                    sum / weight
                })
                .collect();
        }
    }
    now
}

fn strongest(columns: &[Vec<f32>], vertex: usize) -> Influences {
    let mut order: Vec<usize> = (0..JOINT_COUNT).collect();
    order.sort_by(|&a, &b| columns[b][vertex].total_cmp(&columns[a][vertex]).then(a.cmp(&b)));
    let sum: f32 = order[..INFLUENCES].iter().map(|&j| columns[j][vertex]).sum();
    Influences {
        joints: std::array::from_fn(|k| order[k] as u8),
        weights: std::array::from_fn(|k| columns[order[k]][vertex] / sum),
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

/// A rigid motion as a dual quaternion.
#[derive(Clone, Copy)]
struct DualQuat {
    real: Quat,
    dual: Quat,
}

impl DualQuat {
    fn new(rigid: &Rigid) -> Self {
        let t = rigid.translation * 0.5;
        Self { real: rigid.rotation, dual: Quat::from_xyzw(t.x, t.y, t.z, 0.0) * rigid.rotation }
    }
}

/// How the vertices of the bind pose move to a pose.
pub struct Skin {
    motions: [DualQuat; JOINT_COUNT],
}

impl Skin {
    /// The skin in the pose `world`.
    #[must_use]
    pub fn new(body: &Body, world: &[Rigid; JOINT_COUNT]) -> Self {
        Self { motions: std::array::from_fn(|index| DualQuat::new(&world[index].after(&body.bind_inverse()[index]))) }
    }

    /// The rigid motion of a vertex.
    #[must_use]
    pub fn motion(&self, influences: &Influences) -> Rigid {
        let first = self.motions[influences.joints[0] as usize];
        let (mut real, mut dual) = (first.real * 0.0, first.real * 0.0);
        for (&index, &weight) in influences.joints.iter().zip(&influences.weights) {
            let motion = &self.motions[index as usize];
            // The double cover: blend on the hemisphere of the strongest joint.
            let weight = if first.real.dot(motion.real) < 0.0 { -weight } else { weight };
            real += motion.real * weight;
            dual += motion.dual * weight;
        }
        let scale = 1.0 / real.length();
        let (real, dual) = (real * scale, dual * scale);
        let translation = dual * real.conjugate() * 2.0;
        Rigid { rotation: real, translation: Vec3::new(translation.x, translation.y, translation.z) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blends_of_one_motion_are_that_motion() {
        let body = Body::default();
        let motion = Rigid { rotation: Quat::from_rotation_y(2.5), translation: Vec3::new(1.0, 0.2, -3.0) };
        let world = body.bind().map(|bind| motion.after(&bind));
        let skin = Skin::new(&body, &world);
        let influences = Influences { joints: [0, 5, 13, 22], weights: [0.4, 0.3, 0.2, 0.1] };
        let moved = skin.motion(&influences).apply(Vec3::new(0.3, 1.0, 0.1));
        assert!(moved.distance(motion.apply(Vec3::new(0.3, 1.0, 0.1))) < 1e-5);
    }
}
