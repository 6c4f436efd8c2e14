//! Which nodes move which vertices.

use glam::Mat4;

use super::GltfFile;
use super::instance::Turn;
use crate::import::bones::Moved;

impl GltfFile {
    /// The nodes, and what moves each file vertex: the joints of its skin, or the node that draws it.
    pub fn moved(&self) -> Moved {
        let mut by = Vec::with_capacity(self.mesh.vertex_count);
        let first = |turn| match turn {
            Turn::Always | Turn::Scene => 0,
            Turn::Book { place, .. } => place,
        };
        for page in self.instances.shown(first) {
            let joints = page.skin.and_then(|skin| self.skins.get(skin)).map_or(&[][..], |skin| skin.nodes());
            for vertex in 0..page.shape.len() {
                let held = page.shape.held(vertex);
                by.push(match held {
                    Some(held) => held.filter_map(|(joint, weight)| Some((*joints.get(joint)?, weight))).collect(),
                    None => vec![(page.node, 1.0)],
                });
            }
        }
        let count = self.nodes.parent.len();
        let mut is_joint = vec![false; count];
        self.skins.iter().flat_map(|skin| skin.nodes()).for_each(|&node| is_joint[node] = true);
        let names = (0..count).map(|node| self.nodes.name(node).trim_matches('"').to_owned()).collect();
        Moved { is_joint, names, parents: self.nodes.parent.clone(), order: self.nodes.order().to_vec(), by }
    }

    /// World matrices of all nodes in a frame of a clip; at rest where there is no such clip.
    pub fn world(&self, clip: usize, fps: f64, frame: usize) -> Vec<Mat4> {
        let Some(clip) = self.clips.get(clip) else { return self.nodes.world_from_nodes(&self.nodes.rest) };
        self.nodes.world_from_nodes(&clip.apply_frame(frame, fps, &self.nodes.rest).transforms)
    }
}
