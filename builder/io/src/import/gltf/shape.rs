//! Shapes: the vertices of a primitive before its node moves them, with morph targets and skin.

use glam::{Mat4, Vec3};
use gltf::json::Skin;
use gltf::json::mesh::{MorphTarget, Semantic};

use super::document::Document;
use super::primitive::PrimitiveData;
use crate::import::error::ImportError;

/// The vertices of a primitive.
#[derive(Default)]
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
    /// Reads the vertices of a primitive with the morph targets `targets`; `skin` says with how many joints, where it is
    /// skinned.
    pub fn read(
        document: &Document,
        data: &PrimitiveData<'_>,
        targets: &[MorphTarget],
        skin: Option<&Joints>,
    ) -> Result<Self, ImportError> {
        let user = data.user;
        let positions = data.floats::<3>(&Semantic::Positions)?;
        let positions = positions.ok_or_else(|| document.wrong(format!("{user} has no POSITION")))?;
        let positions: Vec<Vec3> = positions.into_iter().map(Vec3::from_array).collect();
        let mut offsets_of_targets = Vec::new();
        for target in targets {
            let offsets = target.positions.map_or(Ok(Vec::new()), |index| document.floats::<3>(index, user))?;
            if !offsets.is_empty() && offsets.len() != positions.len() {
                return Err(document.wrong(format!("{user}: a morph target has another number of vertices")));
            }
            offsets_of_targets.push(offsets.into_iter().map(Vec3::from_array).collect());
        }
        let influences = match skin {
            Some(skin) => Influences::read(document, data, positions.len(), skin.nodes.len())?,
            None => None,
        };
        Ok(Self { positions, targets: offsets_of_targets, influences })
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Number of morph targets.
    pub fn target_count(&self) -> usize {
        self.targets.len()
    }

    /// The joints that hold a vertex, and by how much; `None` where the shape is not skinned.
    pub fn held(&self, vertex: usize) -> Option<impl Iterator<Item = (usize, f32)>> {
        let influences = self.influences.as_ref()?;
        Some(influences.of_vertex(vertex).map(|&(joint, weight)| (joint as usize, weight)))
    }

    /// For each vertex whether the joints that hold it mirror, by the sign of `signs` (one per joint) that outweighs the
    /// other; `None` where the shape is not skinned.
    pub fn mirrored_vertices(&self, signs: &[f32]) -> Option<Vec<bool>> {
        let influences = self.influences.as_ref()?;
        let sign = |vertex: usize| -> f32 {
            let of_vertex = influences.of_vertex(vertex);
            of_vertex.map(|&(joint, weight)| weight * signs.get(joint as usize).copied().unwrap_or(1.0)).sum()
        };
        Some((0..self.len()).map(|vertex| sign(vertex) < 0.0).collect())
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
        data: &PrimitiveData<'_>,
        vertex_count: usize,
        joint_count: usize,
    ) -> Result<Option<Self>, ImportError> {
        let user = data.user;
        let mut sets = Vec::new();
        for set in 0.. {
            let joints = data.whole_numbers(&Semantic::Joints(set))?;
            let Some((joints, weights)) = joints.zip(data.floats::<4>(&Semantic::Weights(set))?) else { break };
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

    /// The nodes that move the joints.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// Whether each joint mirrors, where `mirrored` says so of the nodes' world matrices.
    pub fn mirrored<'a>(&'a self, mirrored: &'a [bool]) -> impl Iterator<Item = bool> + 'a {
        let joints = self.nodes.iter().zip(&self.joint_from_mesh);
        joints.map(|(&node, bind)| mirrored.get(node).copied().unwrap_or(false) != (bind.determinant() < 0.0))
    }

    /// The matrix of each joint for the nodes' world matrices.
    pub fn world_from_mesh(&self, world_from_nodes: &[Mat4]) -> Vec<Mat4> {
        let joints = self.nodes.iter().zip(&self.joint_from_mesh);
        joints.map(|(&node, &bind)| world_from_nodes.get(node).copied().unwrap_or(Mat4::IDENTITY) * bind).collect()
    }
}
