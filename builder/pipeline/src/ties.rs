//! Finds the [`Ties`] of a capture: components of the mesh that stay where they are on another one.
//!
//! A component may follow each of those that are near it in all of some poses. It follows the one in whose rigid frame, there
//! where both are nearest, it moves least over the capture; and none where that is much. What follows what is a tree, grown
//! from the largest component by the firmest ties first (Prim 1957).

use actor::capture::Poses;
use actor::ties::{MOST_TIED, Tie, Ties};
use glam::{Mat3, Vec3};
use kernels::rotation::least_turn;
use kernels::topology::Topology;
use rayon::prelude::*;

/// Poses in which two components have to be near, spread over the capture.
const POSES: usize = 8;
/// Poses over which it is measured how firm a tie is.
const MEASURED: usize = 64;
/// Vertices of a component that are looked at.
const SAMPLES: usize = 64;
/// Components nearer than this may be tied, in body heights: 9 cm of 1.8 m.
const NEAR: f32 = 0.05;
/// What moves less than this is tied, in body heights: root mean square, 2.7 cm of 1.8 m.
const FIRM: f32 = 0.015;
/// Touches as much as what touches most: up to this many body heights further away, 2 cm of 1.8 m.
const TOUCHES: f32 = 0.011;
/// Fewer vertices do not tell how a patch turns.
const FEWEST: usize = 8;
/// Components that one may follow, the nearest ones.
const TRIED: usize = 6;

/// A tie that may be made.
struct Candidate {
    /// How far it moves, in body heights.
    moves: f32,
    component: u32,
    follows: u32,
    tie: Tie,
}

/// The ties of a capture.
#[must_use]
pub fn ties(topology: &Topology, poses: &Poses) -> Ties {
    let count = topology.component_count();
    if count < 2 {
        return Ties::default();
    }
    let mut members = vec![Vec::new(); count];
    let mut weights = vec![0.0_f64; count];
    for ((vertex, &component), &weight) in (0_u32..).zip(topology.component_of_vertex()).zip(topology.weights()) {
        members[component as usize].push(vertex);
        weights[component as usize] += f64::from(weight);
    }
    let seen = Seen { topology, members: &members, near: spread(poses, POSES), measured: spread(poses, MEASURED) };
    let candidates: Vec<Candidate> =
        (0..count as u32).into_par_iter().flat_map_iter(|component| seen.candidates(component)).collect();
    Ties::new(tree(&weights, candidates), topology).unwrap_or_default()
}

/// The ties that are made: the firmest first of those that lead to what is placed already.
fn tree(weights: &[f64], mut candidates: Vec<Candidate>) -> Vec<Tie> {
    candidates.retain(|candidate| candidate.moves < FIRM);
    candidates.sort_by(|a, b| {
        a.moves.total_cmp(&b.moves).then(a.component.cmp(&b.component)).then(a.follows.cmp(&b.follows))
    });
    let mut placed = vec![false; weights.len()];
    let mut by_weight: Vec<usize> = (0..weights.len()).collect();
    by_weight.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]).then(a.cmp(&b)));
    let mut ties = Vec::new();
    for root in by_weight {
        placed[root] = true;
        let next = |placed: &[bool]| {
            candidates.iter().position(|c| !placed[c.component as usize] && placed[c.follows as usize])
        };
        while let Some(at) = next(&placed) {
            placed[candidates[at].component as usize] = true;
            ties.push(candidates[at].tie.clone());
        }
    }
    ties
}

fn spread(poses: &Poses, most: usize) -> Vec<&[Vec3]> {
    let count = poses.len().min(most);
    (0..count).map(|index| poses.frame((index * (poses.len() - 1) / (count - 1).max(1)) as u32)).collect()
}

/// What ties are found from.
struct Seen<'a> {
    topology: &'a Topology,
    members: &'a [Vec<u32>],
    near: Vec<&'a [Vec3]>,
    measured: Vec<&'a [Vec3]>,
}

impl Seen<'_> {
    /// The ties by which `component` may follow others.
    fn candidates(&self, component: u32) -> Vec<Candidate> {
        let body = self.body();
        let members = &self.members[component as usize];
        let samples: Vec<u32> = members.iter().copied().step_by(members.len().div_ceil(SAMPLES)).collect();
        // For each sample and each other component the nearest vertex.
        let mut nearest = vec![(f32::INFINITY, 0_u32); samples.len() * self.members.len()];
        for (row, &sample) in nearest.chunks_exact_mut(self.members.len()).zip(&samples) {
            for (vertex, &other) in (0_u32..).zip(self.topology.component_of_vertex()) {
                let best = &mut row[other as usize];
                if other != component {
                    let far = self.far(sample, vertex, best.0);
                    if far < best.0 {
                        *best = (far, vertex);
                    }
                }
            }
        }
        let least = |other: usize| {
            nearest.iter().skip(other).step_by(self.members.len()).map(|pair| pair.0).fold(f32::INFINITY, f32::min)
        };
        let mut others: Vec<(f32, usize)> = (0..self.members.len()).map(|other| (least(other), other)).collect();
        others.retain(|other| other.0 < NEAR * body);
        others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        others.truncate(TRIED);
        let candidate = |(least, other): (f32, usize)| {
            let pairs = samples.iter().zip(nearest.iter().skip(other).step_by(self.members.len()));
            let touching: Vec<[u32; 2]> = pairs
                .filter(|(_, pair)| pair.0 <= least + TOUCHES * body)
                .map(|(&from, &(_, to))| [from, to])
                .collect();
            let tie = self.tie(&touching, other);
            Candidate { moves: self.moves(&tie) / body, component, follows: other as u32, tie }
        };
        others.into_iter().map(candidate).collect()
    }

    /// The largest distance of two vertices in all poses; no less than `enough` where it is that.
    fn far(&self, a: u32, b: u32, enough: f32) -> f32 {
        let mut most = 0.0_f32;
        for pose in &self.near {
            most = most.max(pose[a as usize].distance(pose[b as usize]));
            if most >= enough {
                break;
            }
        }
        most
    }

    /// Height of the body in metres.
    fn body(&self) -> f32 {
        let heights = || self.near.iter().take(1).flat_map(|pose| pose.iter()).map(|point| point.y);
        (heights().fold(f32::MIN, f32::max) - heights().fold(f32::MAX, f32::min)).max(f32::MIN_POSITIVE)
    }

    /// The tie of vertices that touch vertices of `other`, spread over where they do.
    fn tie(&self, touching: &[[u32; 2]], other: usize) -> Tie {
        let pose = self.near[0];
        let mut chosen = vec![touching[0]];
        let mut far = vec![f32::INFINITY; touching.len()];
        // The pair that is farthest from those that are chosen (Gonzalez 1985).
        while chosen.len() < MOST_TIED.min(touching.len()) {
            let last = pose[chosen[chosen.len() - 1][0] as usize];
            for (far, pair) in far.iter_mut().zip(touching) {
                *far = far.min(pose[pair[0] as usize].distance(last));
            }
            let farthest = (0..touching.len()).max_by(|&a, &b| far[a].total_cmp(&far[b]).then(b.cmp(&a)));
            chosen.push(touching[farthest.unwrap_or(0)]);
        }
        let end = |of: usize| {
            let mut vertices: Vec<u32> = chosen.iter().map(|pair| pair[of]).collect();
            vertices.sort_unstable();
            vertices.dedup();
            vertices
        };
        let (contact, mut patch) = (end(0), end(1));
        let middle = mean(&patch, pose);
        let mut beside: Vec<(f32, u32)> =
            self.members[other].iter().map(|&vertex| (pose[vertex as usize].distance(middle), vertex)).collect();
        beside.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, vertex) in beside {
            if patch.len() >= FEWEST {
                break;
            }
            if let Err(at) = patch.binary_search(&vertex) {
                patch.insert(at, vertex);
            }
        }
        Tie { contact, patch }
    }

    /// How far what follows moves in the frame of the patch: root mean square in metres.
    fn moves(&self, tie: &Tie) -> f32 {
        let places: Vec<Vec3> = self.measured.iter().map(|pose| place(tie, self.measured[0], pose)).collect();
        let middle = places.iter().sum::<Vec3>() / places.len() as f32;
        (places.iter().map(|place| place.distance_squared(middle)).sum::<f32>() / places.len() as f32).sqrt()
    }
}

/// Where the centre of a tie's contact is in `pose`, seen from the patch as it stands in `reference`, in metres from the
/// patch's centre.
#[must_use]
pub fn place(tie: &Tie, reference: &[Vec3], pose: &[Vec3]) -> Vec3 {
    let [from, to] = [reference, pose].map(|pose| mean(&tie.patch, pose));
    let mut covariance = Mat3::ZERO;
    for &vertex in &tie.patch {
        let (a, b) = (reference[vertex as usize] - from, pose[vertex as usize] - to);
        covariance += Mat3::from_cols(b * a.x, b * a.y, b * a.z);
    }
    least_turn(&covariance).conjugate() * (mean(&tie.contact, pose) - to)
}

fn mean(vertices: &[u32], pose: &[Vec3]) -> Vec3 {
    vertices.iter().map(|&vertex| pose[vertex as usize]).sum::<Vec3>() / vertices.len() as f32
}
