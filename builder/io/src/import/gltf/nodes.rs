//! The node hierarchy: local transforms, world matrices.

use glam::{Mat4, Quat, Vec3, Vec4};

use super::animation::unit;
use super::document::Document;
use crate::import::error::ImportError;

/// A node's transform against its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    pub translation: Vec3,
    pub rotation: Quat,
    pub scale: Vec3,
    /// Used instead where the file gives a matrix; such nodes are not animated.
    matrix: Option<Mat4>,
}

impl Transform {
    fn parent_from_node(&self) -> Mat4 {
        let parts = || Mat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation);
        self.matrix.unwrap_or_else(parts)
    }
}

/// All nodes of a file, parents before children.
pub(super) struct Nodes {
    /// Local transforms at rest.
    pub rest: Vec<Transform>,
    /// Nodes that the scene draws, depth first in the file's order.
    pub drawn: Vec<usize>,
    /// All nodes, every parent before its children.
    order: Vec<usize>,
    parent: Vec<Option<usize>>,
}

impl Nodes {
    /// Reads the hierarchy; refuses nodes with two parents and circles.
    pub fn read(document: &Document) -> Result<Self, ImportError> {
        let nodes = &document.root().nodes;
        let mut parent = vec![None; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            for child in node.children.iter().flatten() {
                document.get(*child, "node", &format!("node {index}"))?;
                if parent[child.value()].replace(index).is_some() {
                    return Err(document.wrong(format!("node {child} is the child of two nodes")));
                }
            }
        }
        let roots: Vec<usize> = (0..nodes.len()).filter(|&k| parent[k].is_none()).collect();
        let order = depth_first(document, &roots);
        if order.len() < nodes.len() {
            return Err(document.wrong("the nodes form a circle"));
        }
        let rest = nodes.iter().map(|node| Transform {
            translation: node.translation.map_or(Vec3::ZERO, Vec3::from_array),
            rotation: node.rotation.map_or(Quat::IDENTITY, |r| unit(Vec4::from_array(r.0))),
            scale: node.scale.map_or(Vec3::ONE, Vec3::from_array),
            matrix: node.matrix.map(|m| Mat4::from_cols_array(&m)),
        });
        let rest = rest.collect();
        Ok(Self { rest, drawn: drawn(document, &roots)?, order, parent })
    }

    /// World matrices of all nodes for the local transforms `transforms`.
    pub fn world_from_nodes(&self, transforms: &[Transform]) -> Vec<Mat4> {
        let mut world = vec![Mat4::IDENTITY; self.order.len()];
        for &node in &self.order {
            let local = transforms[node].parent_from_node();
            world[node] = self.parent[node].map_or(local, |parent| world[parent] * local);
        }
        world
    }
}

/// The nodes of the file's scene; of all roots where there is no scene.
fn drawn(document: &Document, roots: &[usize]) -> Result<Vec<usize>, ImportError> {
    let root = document.root();
    let scene = match root.scene {
        Some(index) => Some(document.get(index, "scene", "the file")?),
        None => root.scenes.first(),
    };
    let Some(scene) = scene else { return Ok(depth_first(document, roots)) };
    let mut tops = Vec::new();
    for node in &scene.nodes {
        document.get(*node, "node", "the scene")?;
        if !tops.contains(&node.value()) {
            tops.push(node.value());
        }
    }
    Ok(depth_first(document, &tops))
}

/// `tops` and everything below them, each node before its children, children in the file's order.
fn depth_first(document: &Document, tops: &[usize]) -> Vec<usize> {
    let nodes = &document.root().nodes;
    let mut seen = vec![false; nodes.len()];
    let mut stack: Vec<usize> = tops.iter().rev().copied().collect();
    let mut order = Vec::new();
    while let Some(node) = stack.pop() {
        if std::mem::replace(&mut seen[node], true) {
            continue;
        }
        order.push(node);
        stack.extend(nodes[node].children.iter().flatten().rev().map(|child| child.value()));
    }
    order
}
