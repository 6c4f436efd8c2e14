//! The deformation graph: nodes on the template, each with a rigid motion, that carry the vertices near them.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use geometry::mesh::Mesh;
use glam::{DMat3, DQuat, DVec3, Vec3};
use kernels::components::connected_components;
use kernels::random::mix;
use kernels::rotation::best_rotation;
use rayon::prelude::*;

/// Nodes that carry a vertex.
pub const CARRIERS: usize = 4;
/// Reach of a node, in distances between nodes.
const REACH: f32 = 2.2;
/// Nodes of other parts that a node of a part is joined with, which would float freely otherwise.
const TIES: usize = 2;
const NONE: u32 = u32::MAX;

/// Nodes, and which of them carries what.
#[derive(Clone, Debug)]
pub struct Graph {
    /// The vertex on which each node sits.
    pub nodes: Vec<u32>,
    /// For each vertex its nodes, and their shares, which sum to 1; a node may be named with a share of 0.
    pub carriers: Vec<[(u32, f32); CARRIERS]>,
    /// Pairs of nodes (a < b) that should move alike.
    pub edges: Vec<[u32; 2]>,
}

impl Graph {
    /// Nodes at least `distance` metres apart along the edges of `mesh`, in an order that `seed` decides.
    #[must_use]
    pub fn new(mesh: &Mesh, distance: f32, seed: u64) -> Self {
        let neighbours = mesh.neighbours();
        let nodes = spread(mesh, &neighbours, distance, seed);
        let reach = REACH * distance;
        let near: Vec<Vec<(u32, f32)>> = nodes.par_iter().map(|&node| within(mesh, &neighbours, node, reach)).collect();
        let mut candidates: Vec<Vec<(u32, f32)>> = vec![Vec::new(); mesh.positions.len()];
        for (node, reached) in near.iter().enumerate() {
            for &(vertex, at) in reached {
                candidates[vertex as usize].push((node as u32, at));
            }
        }
        let carriers: Vec<_> = candidates.into_iter().map(|candidates| shares(candidates, reach)).collect();
        let edges = edges(mesh, &nodes, &carriers);
        Self { nodes, carriers, edges }
    }

    /// Each node's rigid motion that fits best how `rest` was moved to `moved` around it.
    #[must_use]
    pub fn fit(&self, rest: &[Vec3], moved: &[Vec3]) -> Vec<Motion> {
        let mut sums = vec![DMat3::ZERO; self.nodes.len()];
        for (vertex, carriers) in self.carriers.iter().enumerate() {
            for &(node, share) in carriers.iter().filter(|(_, share)| *share > 0.0) {
                let centre = self.nodes[node as usize] as usize;
                let from = (rest[vertex] - rest[centre]).as_dvec3() * f64::from(share);
                let to = (moved[vertex] - moved[centre]).as_dvec3();
                sums[node as usize] += DMat3::from_cols(to * from.x, to * from.y, to * from.z);
            }
        }
        let of = |(&node, sum): (&u32, &DMat3)| Motion {
            rotation: best_rotation(sum),
            translation: (moved[node as usize] - rest[node as usize]).as_dvec3(),
        };
        self.nodes.iter().zip(&sums).map(of).collect()
    }
}

/// The rigid motion of a node about its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Rotation about the node.
    pub rotation: DQuat,
    /// Translation of the node.
    pub translation: DVec3,
}

impl Motion {
    /// No motion.
    pub const NONE: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };
}

/// Vertices that are at least `distance` apart, and within that of every vertex of their part.
fn spread(mesh: &Mesh, neighbours: &[Vec<u32>], distance: f32, seed: u64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.sort_by_key(|&vertex| (mix(seed, u64::from(vertex)), vertex));
    let mut covered = vec![false; mesh.positions.len()];
    let mut nodes = Vec::new();
    for vertex in order {
        if !covered[vertex as usize] {
            nodes.push(vertex);
            within(mesh, neighbours, vertex, distance).iter().for_each(|&(near, _)| covered[near as usize] = true);
        }
    }
    nodes
}

/// Vertices less than `reach` from `start` along edges, and how far they are.
fn within(mesh: &Mesh, neighbours: &[Vec<u32>], start: u32, reach: f32) -> Vec<(u32, f32)> {
    let mut least = std::collections::BTreeMap::from([(start, 0.0_f32)]);
    let mut open = BinaryHeap::from([Reverse((0_u32, start))]);
    let mut found = Vec::new();
    while let Some(Reverse((bits, vertex))) = open.pop() {
        // Distances are not negative, and so in the order of their bits.
        let at = f32::from_bits(bits);
        if least.get(&vertex).is_some_and(|&known| known < at) {
            continue;
        }
        found.push((vertex, at));
        for &next in &neighbours[vertex as usize] {
            let beyond = at + mesh.positions[vertex as usize].distance(mesh.positions[next as usize]);
            if beyond < reach && least.get(&next).is_none_or(|&known| beyond < known) {
                least.insert(next, beyond);
                open.push(Reverse((beyond.to_bits(), next)));
            }
        }
    }
    found
}

/// The nearest nodes and their shares: (1 - (d / reach)^2)^3 (method of Sumner 2007 with a smoother kernel).
fn shares(mut candidates: Vec<(u32, f32)>, reach: f32) -> [(u32, f32); CARRIERS] {
    candidates.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    candidates.truncate(CARRIERS);
    let weight = |at: f32| (1.0 - (at / reach).powi(2)).max(0.0).powi(3);
    let sum: f32 = candidates.iter().map(|&(_, at)| weight(at)).sum();
    let first = candidates.first().map_or(0, |candidate| candidate.0);
    std::array::from_fn(|k| match candidates.get(k) {
        Some(&(node, at)) if sum > 0.0 => (node, weight(at) / sum),
        _ => (first, 0.0),
    })
}

/// Pairs of nodes that carry a vertex together, and ties from each part to the others.
fn edges(mesh: &Mesh, nodes: &[u32], carriers: &[[(u32, f32); CARRIERS]]) -> Vec<[u32; 2]> {
    let mut edges = BTreeSet::new();
    for carriers in carriers {
        for (k, &(a, share)) in carriers.iter().enumerate() {
            for &(b, other) in &carriers[k + 1..] {
                if a != b && share > 0.0 && other > 0.0 {
                    edges.insert([a.min(b), a.max(b)]);
                }
            }
        }
    }
    let pairs = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]);
    let (part_of_vertex, parts) = connected_components(mesh.positions.len(), pairs);
    if parts > 1 {
        let part = |node: u32| part_of_vertex[nodes[node as usize] as usize];
        let place = |node: u32| mesh.positions[nodes[node as usize] as usize];
        let mut sizes = vec![0_usize; parts];
        part_of_vertex.iter().for_each(|&part| sizes[part as usize] += 1);
        let largest = (0..parts).rev().max_by_key(|&k| sizes[k]).map_or(NONE, |k| k as u32);
        for node in (0..nodes.len() as u32).filter(|&node| part(node) != largest) {
            let mut others: Vec<u32> = (0..nodes.len() as u32).filter(|&other| part(other) != part(node)).collect();
            let distance = |other: &u32| place(*other).distance(place(node));
            others.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
            edges.extend(others.iter().take(TIES).map(|&other| [node.min(other), node.max(other)]));
        }
    }
    edges.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::sheet;

    #[test]
    fn nodes_are_apart_and_carry_all() {
        let mesh = sheet(20);
        let graph = Graph::new(&mesh, 0.2, 1);
        assert!((12..40).contains(&graph.nodes.len()), "{}", graph.nodes.len());
        for (k, &a) in graph.nodes.iter().enumerate() {
            for &b in &graph.nodes[k + 1..] {
                assert!(mesh.positions[a as usize].distance(mesh.positions[b as usize]) > 0.2 / 1.5);
            }
        }
        for carriers in &graph.carriers {
            assert!((carriers.iter().map(|carrier| carrier.1).sum::<f32>() - 1.0).abs() < 1e-5);
        }
        let (_, parts) = connected_components(graph.nodes.len(), graph.edges.iter().copied());
        assert_eq!(parts, 1);
    }

    #[test]
    fn parts_are_tied_to_each_other() {
        let (mut mesh, other) = (sheet(6), sheet(3));
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(other.positions.iter().map(|p| *p + Vec3::Y));
        mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        let graph = Graph::new(&mesh, 0.3, 1);
        let (_, parts) = connected_components(graph.nodes.len(), graph.edges.iter().copied());
        assert_eq!(parts, 1);
    }

    #[test]
    fn a_rigid_motion_is_found_again() {
        let mesh = sheet(10);
        let graph = Graph::new(&mesh, 0.25, 3);
        let rotation = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -2.0, 0.9);
        let shift = DVec3::new(0.3, -0.2, 1.0);
        let moved: Vec<Vec3> = mesh.positions.iter().map(|p| (rotation * p.as_dvec3() + shift).as_vec3()).collect();
        for motion in graph.fit(&mesh.positions, &moved) {
            assert!(motion.rotation.angle_between(rotation) < 1e-4);
        }
    }
}
