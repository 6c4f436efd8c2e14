//! glTF files that hold one pose each: the frames of a sequence, with a texture within each file.

use std::path::{Path, PathBuf};

use actor::surface::{Image, ImageFormat};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::error::ImportError;
use super::frames::{Axes, Reference, Seen, attributes_differ, check_area, check_same_mesh, place};
use super::gltf::GltfFile;
use super::mesh::FileMesh;
use super::scratch::Scratch;
use super::warning::{Note, Warning};
use super::worn::NamedTexture;

/// What the frames of a sequence of glTF files are compared with, and where their own textures go.
pub(super) struct StillReader {
    first: FileMesh,
    /// Where textures are written to; none where the first file has none.
    scratch: Option<Scratch>,
    /// Tells the textures of several sequences apart.
    sequence: usize,
}

impl StillReader {
    /// For sequence number `sequence`, which begins with `path`; `scratch` is made where it is needed.
    pub fn new(path: &Path, sequence: usize, scratch: &mut Option<Scratch>) -> Result<Self, ImportError> {
        let first = GltfFile::open(path)?.mesh().clone();
        if main_image(&first).is_some() && scratch.is_none() {
            *scratch = Some(Scratch::new()?);
        }
        let scratch = scratch.clone().filter(|_| main_image(&first).is_some());
        Ok(Self { first, scratch, sequence })
    }

    /// The texture of a frame: written to a file where it is another than the first frame's; else none, for now.
    fn texture(&self, mesh: &FileMesh, frame: usize) -> Result<Option<NamedTexture>, ImportError> {
        let (Some(scratch), Some(image)) = (&self.scratch, main_image(mesh)) else { return Ok(None) };
        if main_image(&self.first).is_some_and(|first| first.bytes == image.bytes) {
            return Ok(Some(NamedTexture::Missing(SAME.into())));
        }
        scratch.write(&self.name(frame, image), &image.bytes).map(|path| Some(NamedTexture::Found(path)))
    }

    fn name(&self, frame: usize, image: &Image) -> String {
        let ending = match image.format {
            ImageFormat::Png => "png",
            ImageFormat::Jpeg => "jpg",
            ImageFormat::WebP => "webp",
        };
        format!("sequence_{}_{frame:06}.{ending}", self.sequence)
    }

    /// Completes the textures of all frames: those that wear the first frame's get its file. All are left to the mesh
    /// where none differs.
    pub fn finish(&mut self, textures: &mut Vec<Option<NamedTexture>>) -> Result<(), ImportError> {
        let differ = textures.iter().any(|texture| !matches!(texture, Some(NamedTexture::Missing(_))));
        let (Some(scratch), Some(image), true) = (&self.scratch, main_image(&self.first), differ) else {
            textures.clear();
            return Ok(());
        };
        let first = scratch.write(&self.name(0, image), &image.bytes)?;
        for texture in textures {
            if matches!(texture, Some(NamedTexture::Missing(_))) {
                *texture = Some(NamedTexture::Found(first.clone()));
            }
        }
        Ok(())
    }
}

/// Stands for the first frame's texture until it is known whether it has to be written.
const SAME: &str = "the first frame's";

/// The texture of the first material that has one.
fn main_image(mesh: &FileMesh) -> Option<&Image> {
    let index = mesh.materials.iter().find_map(|material| material.image)?;
    mesh.images.get(index as usize)
}

/// Reads the frames `paths`, the first of them frame `first_frame` of its sequence, into `out`; in parallel.
pub(super) fn read_stills(
    paths: &[PathBuf],
    first_frame: usize,
    stills: &StillReader,
    reference: &Reference<'_>,
    axes: Axes,
    out: &mut [Vec3],
) -> Vec<Result<Seen, ImportError>> {
    paths
        .par_iter()
        .zip(out.par_chunks_mut(reference.mesh.vertex_count.max(1)))
        .enumerate()
        .map(|(k, (path, out))| {
            let (file, frame) = (GltfFile::open(path)?, first_frame + k);
            let mesh = file.mesh();
            check_same_mesh(mesh.vertex_count, &mesh.faces, path, frame, reference)?;
            let pose: Vec<DVec3> = file.pose(0, 1.0, 0)?.iter().map(|p| p.as_dvec3()).collect();
            place(&pose, path, frame, axes, out)?;
            check_area(&mesh.faces, path, frame, out)?;
            let prefix = format!("{}: ", path.display());
            let told = |w: &Warning| Note::new(w.code, w.message.strip_prefix(&prefix).unwrap_or(&w.message));
            let mut notes: Vec<Note> = file.warnings().iter().map(told).collect();
            if mesh.uvs != reference.mesh.uvs || mesh.colours != reference.mesh.colours {
                notes.push(attributes_differ());
            }
            let colours = |mesh: &FileMesh| mesh.materials.iter().map(|m| m.base_colour).collect::<Vec<_>>();
            if mesh.material_of_face != reference.mesh.material_of_face || colours(mesh) != colours(reference.mesh) {
                let message = "materials differ from those of the first frame: the first frame's are used";
                notes.push(Note::new("W_MATERIALS_DIFFER", message));
            }
            Ok(Seen { texture: stills.texture(mesh, frame)?, notes })
        })
        .collect()
}
