//! Shapes: the vertices of a primitive before its node moves them, with morph targets and skin.

use glam::{Mat4, Vec3};
use gltf::json::accessor::Accessor;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, Skin};

use super::document::Document;
use crate::import::error::ImportError;

/// The vertices of a primitive.
pub(super) struct Shape {
    positions: Vec<Vec3>,
    /// Offsets of each morph target, one per vertex; empty where a target moves nothing.
    targets: Vec<Vec<Vec3>>,
    influences: Option<Influences>,
}

/// The joints that pull at each vertex.
struct Influences {
    /// Influences per vertex.
    width: usize,
    /// Joint within the skin, and weight; the weights of a vertex have a sum of 1.
    joints: Vec<(u32, f32)>,
}

/// Joints of a skin.
pub(super) struct Joints {
    nodes: Vec<usize>,
    joint_from_mesh: Vec<Mat4>,
}

impl Shape {
    /// Reads the vertices of `primitive`; `skin` says with how many joints, where it is skinned.
    pub fn read(
        document: &Document,
        primitive: &Primitive,
        skin: Option<&Joints>,
        user: &str,
    ) -> Result<Self, ImportError> {
        let position = attribute(primitive, &Semantic::Positions);
        let position = position.ok_or_else(|| document.wrong(format!("{user} has no POSITION")))?;
        let positions = vectors(document, position, user)?;
        let mut targets = Vec::new();
        for target in primitive.targets.iter().flatten() {
            let offsets = target.positions.map_or(Ok(Vec::new()), |index| vectors(document, index, user))?;
            if !offsets.is_empty() && offsets.len() != positions.len() {
                return Err(document.wrong(format!("{user}: a morph target has another number of vertices")));
            }
            targets.push(offsets);
        }
        let influences = match skin {
            Some(skin) => Influences::read(document, primitive, positions.len(), skin.nodes.len(), user)?,
            None => None,
        };
        Ok(Self { positions, targets, influences })
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Appends the vertices to `pose`, morphed by `weights` and moved by `matrices`: one per joint where the shape
    /// is skinned, else the node's alone.
    pub fn pose(&self, weights: &[f32], world_from_node: Mat4, world_from_joints: &[Mat4], pose: &mut Vec<Vec3>) {
        for (vertex, &rest) in self.positions.iter().enumerate() {
            let mut point = rest;
            for (offsets, &weight) in self.targets.iter().zip(weights) {
                if let Some(&offset) = offsets.get(vertex) {
                    point += offset * weight;
                }
            }
            pose.push(match &self.influences {
                Some(influences) => influences.of_vertex(vertex).fold(Vec3::ZERO, |sum, &(joint, weight)| {
                    let matrix = world_from_joints.get(joint as usize).copied().unwrap_or(Mat4::IDENTITY);
                    sum + matrix.transform_point3(point) * weight
                }),
                None => world_from_node.transform_point3(point),
            });
        }
    }
}

impl Influences {
    fn read(
        document: &Document,
        primitive: &Primitive,
        vertex_count: usize,
        joint_count: usize,
        user: &str,
    ) -> Result<Option<Self>, ImportError> {
        let mut sets = Vec::new();
        for set in 0.. {
            let joints = attribute(primitive, &Semantic::Joints(set));
            let weights = attribute(primitive, &Semantic::Weights(set));
            let Some((joints, weights)) = joints.zip(weights) else { break };
            let joints = document.whole_numbers::<4>(joints, user)?;
            let weights = document.floats::<4>(weights, user)?;
            if joints.len() != vertex_count || weights.len() != vertex_count {
                return Err(document.wrong(format!("{user}: JOINTS or WEIGHTS do not match the vertices")));
            }
            sets.push((joints, weights));
        }
        if sets.is_empty() {
            return Ok(None);
        }
        let width = 4 * sets.len();
        let mut all = Vec::with_capacity(vertex_count * width);
        for vertex in 0..vertex_count {
            let first = all.len();
            for (joints, weights) in &sets {
                all.extend(joints[vertex].iter().copied().zip(weights[vertex]));
            }
            let of_vertex = &mut all[first..];
            for &mut (joint, ref mut weight) in of_vertex.iter_mut() {
                if !(*weight > 0.0 && weight.is_finite()) {
                    *weight = 0.0;
                } else if joint as usize >= joint_count {
                    let place = format!("{user}, vertex {vertex}, joint");
                    let path = document.path().to_owned();
                    return Err(ImportError::IndexRange { path, place, index: joint.into(), count: joint_count });
                }
            }
            let sum: f32 = of_vertex.iter().map(|(_, weight)| weight).sum();
            if sum > 0.0 {
                of_vertex.iter_mut().for_each(|(_, weight)| *weight /= sum);
            } else if let Some((_, weight)) = of_vertex.first_mut() {
                // A vertex that no joint holds follows the first one named, as renderers do.
                *weight = 1.0;
            }
        }
        Ok(Some(Self { width, joints: all }))
    }

    fn of_vertex(&self, vertex: usize) -> impl Iterator<Item = &(u32, f32)> {
        let all = self.joints.get(vertex * self.width..(vertex + 1) * self.width).unwrap_or_default();
        all.iter().filter(|(_, weight)| *weight > 0.0)
    }
}

impl Joints {
    /// Reads a skin.
    pub fn read(document: &Document, skin: &Skin, user: &str) -> Result<Self, ImportError> {
        for joint in &skin.joints {
            document.get(*joint, "node", user)?;
        }
        let nodes: Vec<usize> = skin.joints.iter().map(|joint| joint.value()).collect();
        let joint_from_mesh = match skin.inverse_bind_matrices {
            Some(index) => {
                let matrices = document.floats::<16>(index, user)?;
                matrices.iter().map(Mat4::from_cols_array).collect()
            }
            None => vec![Mat4::IDENTITY; nodes.len()],
        };
        if joint_from_mesh.len() < nodes.len() {
            return Err(document.wrong(format!("{user} has fewer inverse bind matrices than joints")));
        }
        Ok(Self { nodes, joint_from_mesh })
    }

    /// The matrix of each joint for the nodes' world matrices.
    pub fn world_from_mesh(&self, world_from_nodes: &[Mat4]) -> Vec<Mat4> {
        let joints = self.nodes.iter().zip(&self.joint_from_mesh);
        joints.map(|(&node, &bind)| world_from_nodes.get(node).copied().unwrap_or(Mat4::IDENTITY) * bind).collect()
    }
}

/// The accessor of an attribute.
pub(super) fn attribute(primitive: &Primitive, semantic: &Semantic) -> Option<Index<Accessor>> {
    primitive.attributes.get(&Checked::Valid(semantic.clone())).copied()
}

fn vectors(document: &Document, index: Index<Accessor>, user: &str) -> Result<Vec<Vec3>, ImportError> {
    Ok(document.floats::<3>(index, user)?.into_iter().map(Vec3::from_array).collect())
}
