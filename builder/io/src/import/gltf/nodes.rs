//! The node hierarchy: local transforms, world matrices, what is shown.

use glam::{Mat4, Quat, Vec3, Vec4};
use gltf::json::{Index, Node};

use super::channel::unit;
use super::document::Document;
use crate::import::error::ImportError;

/// Most nodes of all scenes together.
const MAX_SCENE_NODES: usize = 1 << 26;

/// A node's transform against its parent, and whether it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    pub translation: Vec3,
    pub rotation: Quat,
    pub scale: Vec3,
    /// Whether the node and what is below it are shown (`KHR_node_visibility`).
    pub visible: bool,
    /// Used instead of the parts above where the file gives a matrix. The parts are then the matrix's own, so that a
    /// channel that moves the node (against the format's rules) only has to take the matrix away.
    pub matrix: Option<Mat4>,
}

impl Transform {
    fn read(node: &Node) -> Self {
        let matrix = node.matrix.map(|m| Mat4::from_cols_array(&m));
        let (scale, rotation, translation) = matrix.map_or_else(
            || {
                let rotation = node.rotation.map_or(Quat::IDENTITY, |r| unit(Vec4::from_array(r.0)));
                let scale = node.scale.map_or(Vec3::ONE, Vec3::from_array);
                (scale, rotation, node.translation.map_or(Vec3::ZERO, Vec3::from_array))
            },
            |matrix| parts(&matrix),
        );
        let extensions = node.extensions.as_ref().map(|e| &e.others);
        let visible = extensions.and_then(|e| e.get("KHR_node_visibility")?.get("visible")?.as_bool()).unwrap_or(true);
        Self { translation, rotation, scale, visible, matrix }
    }

    fn made_of_parts(&self) -> Mat4 {
        Mat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    fn parent_from_node(&self) -> Mat4 {
        self.matrix.unwrap_or_else(|| self.made_of_parts())
    }

    /// Whether the node has a matrix that its parts do not make up: a shear.
    pub fn is_sheared(&self) -> bool {
        self.matrix.is_some_and(|matrix| {
            let largest = matrix.to_cols_array().iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
            !matrix.abs_diff_eq(self.made_of_parts(), 1e-4 * largest)
        })
    }

    /// Whether the transform mirrors; one that flattens does not.
    fn mirrors(&self) -> bool {
        match self.matrix {
            Some(matrix) => matrix.determinant() < 0.0,
            // Signs are looked at one by one: a scale of (0, -1, 1) says as much as can be known.
            None => self.scale.to_array().iter().filter(|&&s| s < 0.0).count() % 2 == 1,
        }
    }
}

/// Scale, rotation and translation of a matrix; a shear is lost.
fn parts(matrix: &Mat4) -> (Vec3, Quat, Vec3) {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(Vec4::truncate);
    let mirror = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    let scale = Vec3::new(mirror * x.length(), y.length(), z.length());
    let (x, y, z) = ((mirror * x).try_normalize(), y.try_normalize(), z.try_normalize());
    // Axes that have no length follow from the others, so that a flat matrix still has a rotation.
    let x = x.or_else(|| y?.cross(z?).try_normalize()).or_else(|| y.or(z).map(|axis| axis.any_orthonormal_vector()));
    let x = x.unwrap_or(Vec3::X);
    let y = y.and_then(|y| y.reject_from_normalized(x).try_normalize()).or_else(|| z?.cross(x).try_normalize());
    let y = y.unwrap_or_else(|| x.any_orthonormal_vector());
    let z = x.cross(y);
    (scale, Quat::from_mat3(&glam::Mat3::from_cols(x, y, z)).normalize(), matrix.w_axis.truncate())
}

/// All nodes of a file, parents before children.
pub(super) struct Nodes {
    /// Local transforms at rest.
    pub rest: Vec<Transform>,
    /// For each scene the nodes that it draws, depth first in the file's order; one list for files without scenes.
    pub scenes: Vec<Vec<usize>>,
    /// The scene that is shown by default.
    pub scene: usize,
    /// Parent of each node.
    pub parent: Vec<Option<usize>>,
    /// All nodes, every parent before its children.
    order: Vec<usize>,
    names: Vec<String>,
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
        let rest = nodes.iter().map(Transform::read).collect();
        let name = |(index, node): (usize, &Node)| match &node.name {
            Some(name) if !name.is_empty() => format!("\"{name}\""),
            _ => format!("node {index}"),
        };
        let names = nodes.iter().enumerate().map(name).collect();
        let (scenes, scene) = scenes(document, &roots)?;
        Ok(Self { rest, scenes, scene, parent, order, names })
    }

    /// World matrices of all nodes for the local transforms `transforms`.
    pub fn world_from_nodes(&self, transforms: &[Transform]) -> Vec<Mat4> {
        self.down(Mat4::IDENTITY, |&world, node| world * transforms[node].parent_from_node())
    }

    /// Whether each node is shown: itself and all above it.
    pub fn shown(&self, transforms: &[Transform]) -> Vec<bool> {
        self.down(true, |&shown, node| shown && transforms[node].visible)
    }

    /// Whether each node's world matrix mirrors.
    pub fn mirrored(&self, transforms: &[Transform]) -> Vec<bool> {
        self.down(false, |&mirrored, node| mirrored != transforms[node].mirrors())
    }

    /// All nodes, every parent before its children.
    #[cfg(feature = "mocap")]
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// The node and all above it, from below.
    pub fn upwards(&self, node: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(node), |&node| self.parent.get(node).copied().flatten())
    }

    /// A node's name for messages.
    pub fn name(&self, node: usize) -> &str {
        self.names.get(node).map_or("a node", String::as_str)
    }

    /// A value for each node from that of its parent; `top` stands above the roots.
    fn down<T: Clone>(&self, top: T, step: impl Fn(&T, usize) -> T) -> Vec<T> {
        let mut values = vec![top.clone(); self.order.len()];
        for &node in &self.order {
            values[node] = step(self.parent[node].map_or(&top, |parent| &values[parent]), node);
        }
        values
    }
}

/// The nodes of each scene, and which scene is the file's; all roots where there is no scene.
fn scenes(document: &Document, roots: &[usize]) -> Result<(Vec<Vec<usize>>, usize), ImportError> {
    let root = document.root();
    if let Some(index) = root.scene {
        document.get(index, "scene", "the file")?;
    }
    if root.scenes.is_empty() {
        return Ok((vec![depth_first(document, roots)], 0));
    }
    if root.scenes.len().saturating_mul(root.nodes.len()) > MAX_SCENE_NODES {
        let reason = format!("{} scenes of {} nodes", root.scenes.len(), root.nodes.len());
        return Err(ImportError::TooLarge { path: document.path().to_owned(), reason });
    }
    let mut scenes = Vec::new();
    for (index, scene) in root.scenes.iter().enumerate() {
        let mut tops = Vec::new();
        for node in &scene.nodes {
            document.get(*node, "node", &format!("scene {index}"))?;
            if !tops.contains(&node.value()) {
                tops.push(node.value());
            }
        }
        scenes.push(depth_first(document, &tops));
    }
    Ok((scenes, root.scene.map_or(0, |scene| Index::value(&scene))))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_come_apart_and_together() {
        let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.5);
        for scale in [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 2.0, 0.5), Vec3::new(1.0, -2.0, 3.0), Vec3::splat(-0.1)]
        {
            let matrix = Mat4::from_scale_rotation_translation(scale, turn, Vec3::new(5.0, -6.0, 7.0));
            let (s, r, t) = parts(&matrix);
            let again = Mat4::from_scale_rotation_translation(s, r, t);
            assert!(again.abs_diff_eq(matrix, 1e-5), "{matrix} {again}");
        }
        // Flat and empty matrices still have parts that are numbers.
        for scale in [Vec3::new(0.0, 1.0, 1.0), Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO] {
            let (s, r, t) = parts(&Mat4::from_scale_rotation_translation(scale, turn, Vec3::ONE));
            assert!(s.is_finite() && r.is_finite() && t.is_finite() && (r.length() - 1.0).abs() < 1e-5);
        }
    }
}
