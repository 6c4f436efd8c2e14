//! Where two parts meet, and which of them hang together.

use std::collections::BTreeSet;

use editing::Rigid;
use glam::{DMat3, DVec3, Vec3};

use super::clusters::Clusters;
use super::keys::Keys;

/// Pull of each key frame towards the middle of the border: a hinge says nothing of where along it the joint is.
const PULL: f64 = 0.02;
/// How much wider the gap of parts that do not touch counts.
const APART: f32 = 1.3;

/// A joint between two parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// The parts.
    pub parts: [usize; 2],
    /// Where it is in the rest pose, in metres.
    pub place: Vec3,
    /// How far apart the two parts put it, root of the mean square over the key frames, in metres.
    pub gap: f32,
    /// The gap as it counts for the tree: parts that do not touch have to agree better.
    pub loose: f32,
}

/// The point of the rest pose that two motions agree on best, pulled towards `middle` in each key frame by `pull`; and how far they disagree.
#[must_use]
pub fn agree(a: &[Rigid], b: &[Rigid], (middle, pull): (Vec3, f64)) -> (Vec3, f32) {
    let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (a, b) in a.iter().zip(b) {
        let turn = DMat3::from_quat(a.rotation.as_dquat()) - DMat3::from_quat(b.rotation.as_dquat());
        let shift = (b.translation - a.translation).as_dvec3();
        matrix += turn.transpose() * turn + DMat3::IDENTITY * pull;
        right += turn.transpose() * shift + middle.as_dvec3() * pull;
    }
    let place = (matrix.inverse() * right).as_vec3();
    let place = if place.is_finite() { place } else { middle };
    let sum: f32 = a.iter().zip(b).map(|(a, b)| a.apply(place).distance_squared(b.apply(place))).sum();
    (place, (sum / a.len().max(1) as f32).sqrt())
}

/// Joints between all parts that touch, and between those that touch the same part: a thigh meets the pelvis under a skirt.
#[must_use]
pub fn candidates(keys: &Keys, clusters: &Clusters, around: &[Vec<u32>]) -> Vec<Joint> {
    let rest = &keys.poses[0];
    let (members, beside) = (clusters.members(), clusters.beside(around));
    let mut joints = Vec::new();
    for a in 0..members.len() {
        let touches = |b: &usize| beside[a].contains_key(b);
        let further: BTreeSet<usize> = beside[a].keys().flat_map(|&other| beside[other].keys().copied()).collect();
        for b in further.iter().chain(beside[a].keys()).copied().collect::<BTreeSet<_>>().into_iter().filter(|&b| b > a)
        {
            // Between parts that do not touch lies what hides the joint: its middle says little.
            let (towards, factor) = match touches(&b) {
                true => ((border(clusters, around, rest, [a, b]), PULL), 1.0),
                false => ((between(rest, [&members[a], &members[b]]), 0.02 * PULL), APART),
            };
            let (place, gap) = agree(&clusters.motions[a], &clusters.motions[b], towards);
            joints.push(Joint { parts: [a, b], place, gap, loose: gap * factor });
        }
    }
    joints
}

/// The middle of the vertices of two parts that touch the other one.
fn border(clusters: &Clusters, around: &[Vec<u32>], rest: &[Vec3], [a, b]: [usize; 2]) -> Vec3 {
    let touches = |v: &usize| {
        let own = clusters.of_vertex[*v];
        let other = if own == a { b } else { a };
        (own == a || own == b) && around[*v].iter().any(|&u| clusters.of_vertex[u as usize] == other)
    };
    let border: Vec<Vec3> = (0..rest.len()).filter(touches).map(|v| rest[v]).collect();
    border.iter().sum::<Vec3>() / border.len().max(1) as f32
}

/// The middle between the vertices of two parts that are nearest to each other.
fn between(rest: &[Vec3], [a, b]: [&[u32]; 2]) -> Vec3 {
    let mut nearest = (f32::INFINITY, Vec3::ZERO);
    for &a in a {
        for &b in b {
            let [a, b] = [a, b].map(|v| rest[v as usize]);
            if a.distance_squared(b) < nearest.0 {
                nearest = (a.distance_squared(b), 0.5 * (a + b));
            }
        }
    }
    nearest.1
}

/// The tree of all parts whose joints gape least (Kruskal).
#[must_use]
pub fn tree(parts: usize, mut joints: Vec<Joint>) -> Vec<Joint> {
    joints.sort_by(|a, b| a.loose.total_cmp(&b.loose).then(a.parts.cmp(&b.parts)));
    let mut tree_of: Vec<usize> = (0..parts).collect();
    joints.retain(|joint| {
        let [a, b] = joint.parts.map(|part| tree_of[part]);
        if a != b {
            tree_of.iter_mut().filter(|tree| **tree == b).for_each(|tree| *tree = a);
        }
        a != b
    });
    joints
}

/// The joints of `tree` on the way from part `from` to part `to`, in order.
#[must_use]
pub fn way(tree: &[Joint], from: usize, to: usize) -> Vec<Joint> {
    fn go(tree: &[Joint], at: usize, to: usize, before: Option<usize>, way: &mut Vec<Joint>) -> bool {
        if at == to {
            return true;
        }
        for joint in tree.iter().filter(|joint| joint.parts.contains(&at)) {
            let next = if joint.parts[0] == at { joint.parts[1] } else { joint.parts[0] };
            if Some(next) == before {
                continue;
            }
            way.push(Joint { parts: [at, next], ..*joint });
            if go(tree, next, to, Some(at), way) {
                return true;
            }
            way.pop();
        }
        false
    }
    let mut found = Vec::new();
    go(tree, from, to, None, &mut found);
    found
}
