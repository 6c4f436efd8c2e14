//! glTF and GLB: every animation clip of the scene's meshes, baked to vertex positions.
//!
//! ```text
//! container -> document -> extensions          what the file is, and what of it is read
//!                 |  views (meshopt)
//!              nodes, animation (channel)
//!              drawn (primitive: Draco; shape; material: texture, uv)
//!                 |
//!              orientation, flipbook           which side is out, which meshes are shown in turn
//!                 |
//!              instance -> pose
//! ```
//!
//! All drawn meshes of the scene together are one mesh: the file vertices are those of the nodes, depth first in the
//! file's order, and of each node's primitives in order, each with the vertices of its POSITION accessor. Meshes that are
//! shown in turn are there once, at the place of the first.

mod accessor;
mod animation;
mod animation_json;
mod channel;
mod clips;
mod container;
mod document;
mod drawn;
mod extensions;
mod flipbook;
mod inflate;
mod instance;
mod material;
mod moved;
mod nodes;
mod orientation;
mod primitive;
mod scenes;
mod shape;
#[cfg(feature = "mocap")]
mod skeleton;
mod texture;
mod uv;
mod views;

use std::path::{Path, PathBuf};

use glam::Vec3;

use self::animation::Clip;
use self::document::Document;
use self::drawn::Reader;
use self::flipbook::Shown;
use self::inflate::inflate_all;
use self::instance::{Instances, Turn, assemble, assemble_scenes};
use self::nodes::Nodes;
use self::shape::Joints;
#[cfg(feature = "mocap")]
pub use self::skeleton::Skeleton;
use super::error::ImportError;
use super::mesh::FileMesh;
use super::paths::stem;
use super::warning::Warning;

/// An opened glTF file; what is needed to pose its meshes at any time.
pub(super) struct GltfFile {
    path: PathBuf,
    nodes: Nodes,
    skins: Vec<Joints>,
    clips: Vec<Clip>,
    /// Number of scenes that are the frames of the only clip; 0 where clips have keyframes.
    scene_frames: usize,
    /// Node and skin of everything that was read, for [`Shown::pages`].
    drawn: Vec<(usize, Option<usize>)>,
    shown: Shown,
    instances: Instances,
    mesh: FileMesh,
    warnings: Vec<Warning>,
}

impl GltfFile {
    /// Opens a file and reads all but the poses.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let document = Document::open(path)?;
        let inflated = inflate_all(&document)?;
        let document = document.with_inflated(inflated);
        let mut warnings = Vec::new();
        extensions::check(&document, &mut warnings)?;
        let nodes = Nodes::read(&document)?;
        let skins = document.root().skins.iter().enumerate();
        let skins = skins.map(|(k, skin)| Joints::read(&document, skin, &format!("skin {k}")));
        let skins = skins.collect::<Result<Vec<_>, _>>()?;
        let stem = stem(path);
        let clips = animation::clips(&document, &nodes, &stem, &mut warnings)?;

        let mut reader = Reader::new(&document, &skins);
        let still = clips.iter().all(|clip| clip.channels.is_empty());
        let mut scenes = scenes::read(&document, &nodes, &mut reader, still, &mut warnings)?;
        let clips = clips::moving(clips, &document, &nodes, &skins, scenes.iter().flatten(), &mut warnings)?;
        let mut clips = clips::join(clips, &document, &stem, &mut warnings);
        for drawn in &mut scenes {
            if let Some(node) = orientation::settle(&nodes, &skins, &clips, drawn) {
                warnings.push(Warning::new(
                    "W_GLTF_MIRRORED",
                    format!(
                        "{}: {} is mirrored in some frames only: its triangles are inside out in those",
                        path.display(),
                        nodes.name(node)
                    ),
                ));
            }
        }
        let scene_frames = if scenes.len() > 1 { scenes.len() } else { 0 };
        let (instances, mesh, shown, of_drawn);
        if scene_frames > 0 {
            (shown, of_drawn) = (Shown::default(), Vec::new());
            let materials = reader.finish(&mut warnings);
            (instances, mesh) = assemble_scenes(&document, scenes, materials, &mut warnings)?;
        } else {
            let drawn = scenes.pop().unwrap_or_default();
            shown = Shown::find(&document, &nodes, &skins, &clips, &drawn, &mut warnings)?;
            shown.settle(&nodes, &drawn, &mut clips);
            of_drawn = drawn.iter().map(|drawn| (drawn.node, drawn.skin)).collect();
            let materials = reader.finish(&mut warnings);
            (instances, mesh) = assemble(&document, drawn, &shown, materials, &mut warnings)?;
        }
        if clips.is_empty() {
            clips.push(Clip::still(&stem));
        }
        let path = path.to_owned();
        Ok(Self { path, nodes, skins, clips, scene_frames, drawn: of_drawn, shown, instances, mesh, warnings })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Sentences for the user.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Names of the clips; a file without animations has one, of one frame.
    pub fn clip_names(&self) -> Vec<String> {
        self.clips.iter().map(|clip| clip.name.clone()).collect()
    }

    /// Number of frames of a clip at `fps`.
    pub fn frame_count(&self, clip: usize, fps: f32) -> u64 {
        if self.scene_frames > 0 {
            return self.scene_frames as u64;
        }
        self.clips.get(clip).map_or(0, |clip| clip.frame_count(f64::from(fps)))
    }

    /// What all frames share.
    pub fn mesh(&self) -> &FileMesh {
        &self.mesh
    }

    /// A sentence where a clip jumps from pose to pose at another rate than `fps`, so that frames repeat or miss some.
    pub fn rate_warning(&self, clip: usize, fps: f32) -> Option<Warning> {
        let clip = self.clips.get(clip)?;
        let rate = clip.key_rate()?;
        let frames_a_key = f64::from(fps) / rate;
        // What adds up to a quarter of a frame over the whole clip shows.
        let drift = (frames_a_key - frames_a_key.round().max(1.0)).abs() * rate * (clip.end - clip.start);
        let rate = (100.0 * rate).round() / 100.0;
        (drift > 0.25).then(|| {
            Warning::new(
                "W_GLTF_FPS",
                format!(
                    "{}: \"{}\" jumps from pose to pose {rate} times a second, and is read {fps} times a second: some poses \
                     come twice or not at all; --fps {rate} shows each once",
                    self.path.display(),
                    clip.name
                ),
            )
        })
    }

    /// Positions of the file vertices, in the file's units, at frame `frame` of a clip.
    ///
    /// # Errors
    /// Where the frame shows more or fewer of those meshes that are shown in turn.
    pub fn pose(&self, clip: usize, fps: f64, frame: usize) -> Result<Vec<Vec3>, ImportError> {
        let mut pose = Vec::with_capacity(self.mesh.vertex_count);
        let Some(clip) = self.clips.get(clip) else { return Ok(pose) };
        let animated = clip.apply_frame(frame, fps, &self.nodes.rest);
        let world = self.nodes.world_from_nodes(&animated.transforms);
        let joints: Vec<_> = self.skins.iter().map(|skin| skin.world_from_mesh(&world)).collect();
        let mut open_pages: Vec<Vec<usize>> = Vec::new();
        for book in &self.shown.books {
            let pages = self.shown.pages(book, &self.nodes, &self.skins, &self.drawn, &animated.transforms);
            if pages.len() != book.shown {
                let all = book.pages.len();
                let reason = format!("of {all} meshes that are shown in turn, frame {frame} shows {}", pages.len());
                return Err(ImportError::ChangingMesh { path: self.path.clone(), reason });
            }
            open_pages.push(pages);
        }
        let page_of = |turn| match turn {
            Turn::Always => 0,
            Turn::Scene => frame,
            Turn::Book { book, place } => open_pages[book][place],
        };
        for page in self.instances.shown(page_of) {
            let driven = animated.weights.iter().rev().find(|(node, _)| *node == page.node);
            let weights = driven.map_or(page.weights.as_slice(), |(_, weights)| weights);
            let of_skin = page.skin.and_then(|skin| joints.get(skin)).map_or(&[][..], Vec::as_slice);
            page.shape.pose(weights, world[page.node], of_skin, &mut pose);
        }
        Ok(pose)
    }
}
