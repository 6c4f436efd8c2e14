//! Writing the capture: PLY frames, textures, the manifest and the ground truth.

use std::fs;
use std::path::{Path, PathBuf};

use image::{ExtendedColorType, ImageEncoder, codecs::png};
use rayon::prelude::*;
use serde::Serialize;

use super::artefacts::{self, Drift, Hole, Light};
use super::between::Asked;
use super::figure::Figure;
use super::motion::BEHAVIOURS;
use super::perform::{PerformedFrame, Take};
use super::skeleton::{JOINT_COUNT, JOINT_NAMES, PARENTS};
use super::{PerformerError, PerformerOptions};
use geometry::mesh::vertex_normals;
use job::files::write_whole;

/// Writes one capture into one folder.
pub(super) struct Writer<'a> {
    figure: &'a Figure,
    options: &'a PerformerOptions,
    out: PathBuf,
    /// All that comes after the vertices in a PLY file; the same for all frames.
    faces: Vec<u8>,
    header: String,
    around: Vec<Vec<u32>>,
    normals: Vec<glam::Vec3>,
}

/// Ground truth of one take.
#[derive(Serialize)]
struct TakeTruth<'a> {
    name: &'a str,
    behaviour: &'a str,
    fps: f32,
    frames: Vec<FrameTruth>,
}

/// Ground truth of one frame.
#[derive(Serialize)]
struct FrameTruth {
    /// Position of the pelvis in metres.
    root: [f32; 3],
    /// Rotation of each joint against its parent as a quaternion x, y, z, w; the pelvis's is against the world.
    rotations: Vec<[f32; 4]>,
    /// Positions of the joints in metres.
    joints: Vec<[f32; 3]>,
    /// Whether the left and the right foot stand on the ground.
    planted: [bool; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    light: Option<Light>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hole: Option<Hole>,
}

/// What a written frame adds to the truth of its take; drift and noise as bytes.
struct Written {
    truth: FrameTruth,
    drift: Vec<u8>,
    noise: Vec<u8>,
}

/// What stays the same in all takes.
#[derive(Serialize)]
struct Constants<'a> {
    joints: &'a [&'a str],
    parents: &'a [usize],
    /// How the numbers of the truth files are to be read.
    note: &'a str,
    seed: u64,
    artefacts: [(&'a str, bool); 4],
    /// What else the performer was asked for: with it, the same capture can be made again.
    asked: Asked,
}

impl<'a> Writer<'a> {
    /// Makes the folder and writes what all takes share.
    pub(super) fn new(figure: &'a Figure, options: &'a PerformerOptions, out: &Path) -> Result<Self, PerformerError> {
        let own_textures = options.artefacts.change_texture();
        let name = if own_textures { String::new() } else { "comment TextureFile ../texture.png\n".into() };
        let header = format!(
            "ply\nformat binary_little_endian 1.0\n{name}element vertex {}\nproperty float x\nproperty float y\n\
             property float z\nelement face {}\nproperty list uchar int vertex_indices\n\
             property list uchar float texcoord\nend_header\n",
            figure.mesh.positions.len(),
            figure.mesh.triangles.len()
        );
        let mut faces = Vec::with_capacity(figure.mesh.triangles.len() * 38);
        for (triangle, uvs) in figure.mesh.triangles.iter().zip(&figure.atlas.uvs) {
            faces.push(3);
            faces.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
            faces.push(6);
            // PLY counts v upwards.
            faces.extend(uvs.iter().flat_map(|uv| [uv.x, 1.0 - uv.y]).flat_map(f32::to_le_bytes));
        }
        let around = figure.mesh.triangles_of_vertices();
        let normals = vertex_normals(&figure.mesh.positions, &figure.mesh.triangles);
        let writer = Self { figure, options, out: out.to_owned(), faces, header, around, normals };
        writer.folder("truth")?;
        // The manifest comes last; one of an earlier capture would lie until then.
        let _ = fs::remove_file(out.join("capture.toml"));
        if !own_textures {
            writer.colour_image("texture.png", &figure.texture())?;
        }
        let a = options.artefacts;
        let constants = Constants {
            joints: &JOINT_NAMES,
            parents: &PARENTS,
            note: "joint 0 is the pelvis; rotations are x, y, z, w against the parent; drift and noise are \
                   little-endian f32, frame after frame, three and one numbers a vertex, in metres in the rest pose",
            seed: options.seed,
            artefacts: [("noise", a.noise), ("drift", a.drift), ("light", a.light), ("holes", a.holes)],
            asked: Asked {
                frames: options.frames,
                vertices: options.vertices,
                texture_size: options.texture_size,
                fps: options.fps,
                figure: options.figure,
            },
        };
        writer.json("truth/capture.json", &constants)?;
        Ok(writer)
    }

    /// Writes the frames of a take with their artefacts and truth; `wrote` is called after each frame.
    pub(super) fn take(
        &self,
        take: &Take,
        frames: &[PerformedFrame],
        wrote: &(dyn Fn() + Sync),
    ) -> Result<(), PerformerError> {
        self.folder(&take.name)?;
        self.folder(&format!("truth/{}", take.name))?;
        let truths: Vec<Result<Written, PerformerError>> = frames
            .par_iter()
            .enumerate()
            .map(|(index, frame)| {
                let truth = self.frame(take, index, frame);
                wrote();
                truth
            })
            .collect();
        let (mut list, mut drift, mut noise) = (Vec::new(), Vec::new(), Vec::new());
        for truth in truths {
            let written = truth?;
            list.push(written.truth);
            drift.extend(written.drift);
            noise.extend(written.noise);
        }
        if self.options.artefacts.drift {
            self.bytes(&format!("truth/{}/drift.f32", take.name), &drift)?;
        }
        if self.options.artefacts.noise {
            self.bytes(&format!("truth/{}/noise.f32", take.name), &noise)?;
        }
        let behaviour = BEHAVIOURS[take.behaviour].0;
        let truth = TakeTruth { name: &take.name, behaviour, fps: self.options.fps, frames: list };
        self.json(&format!("truth/{}/motion.json", take.name), &truth)
    }

    fn frame(&self, take: &Take, index: usize, frame: &PerformedFrame) -> Result<Written, PerformerError> {
        let (on, fps) = (self.options.artefacts, self.options.fps);
        let drift: Option<Drift> =
            on.drift.then(|| artefacts::drift(self.figure, &self.around, &self.normals, take, index, fps));
        let light = on.light.then(|| Light::new(take, index, fps));
        let hole = if on.holes { Hole::new(self.figure, take, index) } else { None };
        let mut positions = frame.positions.clone();
        if let Some(drift) = &drift {
            artefacts::apply_drift(self.figure, drift, &mut positions);
        }
        let heights = if on.noise { artefacts::noise(self.figure, take, index, fps) } else { Vec::new() };
        if on.noise {
            artefacts::apply_noise(self.figure, &heights, &mut positions);
        }
        let mut file = Vec::with_capacity(self.header.len() + positions.len() * 12 + self.faces.len());
        file.extend(self.header.as_bytes());
        file.extend(positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
        file.extend(&self.faces);
        self.bytes(&format!("{}/frame_{index:05}.ply", take.name), &file)?;
        if on.change_texture() {
            let (image, mask) =
                artefacts::frame_texture(self.figure, frame, drift.as_ref(), light.as_ref(), hole.as_ref());
            self.colour_image(&format!("{}/texture_{index:05}.png", take.name), &image)?;
            if let Some(mask) = mask {
                let path = format!("truth/{}/hidden_{index:05}.png", take.name);
                self.image(&path, &mask, ExtendedColorType::L8)?;
            }
        }
        let little = |values: &mut dyn Iterator<Item = f32>| values.flat_map(f32::to_le_bytes).collect::<Vec<u8>>();
        let ways = drift.map_or(Vec::new(), |d| little(&mut d.ways.iter().flat_map(|way| way.to_array())));
        let noise = little(&mut heights.iter().copied());
        Ok(Written { truth: frame_truth(frame, light, hole), drift: ways, noise })
    }

    /// Writes the manifest and returns its path.
    pub(super) fn finish(&self, takes: &[Take]) -> Result<PathBuf, PerformerError> {
        let own_textures = self.options.artefacts.change_texture();
        let mut text = format!("name = \"Performer\"\nfps = {}\nup = \"y\"\nunit = 1.0\n", self.options.fps);
        if !own_textures {
            text.push_str("texture = \"texture.png\"\n");
        }
        for take in takes {
            let (name, last) = (&take.name, take.frames - 1);
            let label = BEHAVIOURS[take.behaviour].0;
            // Takes begin and end at rest; none is made as a loop, and what is measured on them is measured so.
            text.push_str(&format!(
                "\n[[sequence]]\nname = \"{name}\"\ninput = \"{name}/frame_%05d.ply:0:{last}\"\nlabels = [\"{label}\"]\n\
                 cyclic = false\n"
            ));
            if own_textures {
                text.push_str(&format!("texture = \"{name}/texture_%05d.png:0:{last}\"\n"));
            }
        }
        let path = self.out.join("capture.toml");
        write_whole(&path, text.as_bytes()).map_err(|source| PerformerError::Write { path: path.clone(), source })?;
        Ok(path)
    }

    fn folder(&self, name: &str) -> Result<(), PerformerError> {
        let path = self.out.join(name);
        fs::create_dir_all(&path).map_err(|source| PerformerError::Write { path, source })
    }

    fn bytes(&self, name: &str, bytes: &[u8]) -> Result<(), PerformerError> {
        let path = self.out.join(name);
        fs::write(&path, bytes).map_err(|source| PerformerError::Write { path, source })
    }

    fn json(&self, name: &str, value: &impl Serialize) -> Result<(), PerformerError> {
        let text = serde_json::to_vec(value)
            .map_err(|error| PerformerError::Write { path: self.out.join(name), source: error.into() })?;
        self.bytes(name, &text)
    }

    fn colour_image(&self, name: &str, image: &[[u8; 3]]) -> Result<(), PerformerError> {
        self.image(name, image.as_flattened(), ExtendedColorType::Rgb8)
    }

    fn image(&self, name: &str, texels: &[u8], colour: ExtendedColorType) -> Result<(), PerformerError> {
        let size = self.figure.atlas.size as u32;
        let mut file = Vec::new();
        png::PngEncoder::new(&mut file)
            .write_image(texels, size, size, colour)
            .map_err(|source| PerformerError::Image { path: self.out.join(name), source })?;
        self.bytes(name, &file)
    }
}

fn frame_truth(frame: &PerformedFrame, light: Option<Light>, hole: Option<Hole>) -> FrameTruth {
    let rotations = (0..JOINT_COUNT)
        .map(|index| {
            let own = frame.joints[index].rotation;
            if index == 0 { own } else { frame.joints[PARENTS[index]].rotation.conjugate() * own }.to_array()
        })
        .collect();
    FrameTruth {
        root: frame.joints[0].translation.to_array(),
        rotations,
        joints: frame.joints.iter().map(|joint| joint.translation.to_array()).collect(),
        planted: frame.planted,
        light,
        hole,
    }
}
