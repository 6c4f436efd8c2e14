//! The joints of a glTF file's skins, posed by a clip, without any mesh.

use std::path::Path;

use glam::Mat4;

use super::animation::clips;
use super::clips::join;
use super::document::Document;
use super::inflate::inflate_all;
use super::nodes::Nodes;
use crate::import::error::ImportError;
use crate::import::paths::stem;
use crate::import::warning::Warning;

/// Joints of all skins of a file, and what else they hang on.
pub struct Skeleton {
    /// Names; "node 3" where a node has none.
    pub names: Vec<String>,
    /// The joint that each hangs on, before it.
    pub parents: Vec<Option<usize>>,
    /// World matrices at rest.
    pub rest: Vec<Mat4>,
    /// Names of the clips.
    pub clips: Vec<String>,
    nodes: Nodes,
    moving: Vec<super::Clip>,
    joints: Vec<usize>,
    /// Sentences for the user.
    pub warnings: Vec<Warning>,
}

impl Skeleton {
    /// Reads the skins and clips of a file.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let document = Document::open(path)?;
        let inflated = inflate_all(&document)?;
        let document = document.with_inflated(inflated);
        let nodes = Nodes::read(&document)?;
        let mut warnings = Vec::new();
        let moving = clips(&document, &nodes, &stem(path), &mut warnings)?;
        let moving = join(moving, &document, &stem(path), &mut warnings);
        let joints = joints(&document, &nodes)?;
        let place = |node: usize| joints.iter().position(|&joint| joint == node);
        let parents = joints.iter().map(|&joint| nodes.upwards(joint).skip(1).find_map(place)).collect();
        let names = joints.iter().map(|&joint| nodes.name(joint).trim_matches('"').to_owned()).collect();
        let world = nodes.world_from_nodes(&nodes.rest);
        let rest = joints.iter().map(|&joint| world[joint]).collect();
        let clips = moving.iter().map(|clip| clip.name.clone()).collect();
        Ok(Self { names, parents, rest, clips, nodes, moving, joints, warnings })
    }

    /// Number of frames of a clip at `rate` frames a second; 0 where there is no such clip.
    #[must_use]
    pub fn frame_count(&self, clip: usize, rate: f64) -> u64 {
        self.moving.get(clip).map_or(0, |clip| clip.frame_count(rate))
    }

    /// World matrices of the joints in a frame of a clip; at rest where there is no such clip.
    #[must_use]
    pub fn pose(&self, clip: usize, frame: usize, rate: f64) -> Vec<Mat4> {
        let Some(clip) = self.moving.get(clip) else { return self.rest.clone() };
        let world = self.nodes.world_from_nodes(&clip.apply_frame(frame, rate, &self.nodes.rest).transforms);
        self.joints.iter().map(|&joint| world[joint]).collect()
    }
}

/// The nodes that are joints of a skin, parents first; where nothing joins them, what they hang on, too.
fn joints(document: &Document, nodes: &Nodes) -> Result<Vec<usize>, ImportError> {
    let mut is_joint = vec![false; nodes.parent.len()];
    for (k, skin) in document.root().skins.iter().enumerate() {
        for &joint in &skin.joints {
            document.get(joint, "node", &format!("skin {k}"))?;
            is_joint[joint.value()] = true;
        }
    }
    let chosen =
        |is_joint: &[bool]| -> Vec<usize> { nodes.order().iter().copied().filter(|&node| is_joint[node]).collect() };
    let found = chosen(&is_joint);
    let is_root = |&&joint: &&usize| !nodes.upwards(joint).skip(1).any(|above| is_joint[above]);
    if found.iter().filter(is_root).count() > 1 {
        found.iter().flat_map(|&joint| nodes.upwards(joint)).for_each(|node| is_joint[node] = true);
    }
    Ok(chosen(&is_joint))
}
