//! Mesh files, one a frame: all must hold the same faces as the first.

use std::path::{Path, PathBuf};

use glam::Vec3;
use rayon::prelude::*;

use super::error::ImportError;
use super::images::{ImageStore, read_file};
use super::inputs::ending;
use super::manifest::UpAxis;
use super::mesh::{FaceList, FileMesh, Frame, plain_material};
use super::warning::Warning;
use super::{mtl, obj, ply};

/// Turns positions of the input into metres, +Y up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    pub up: UpAxis,
    /// Metres per unit.
    pub unit: f32,
}

impl Axes {
    /// `p` in metres, +Y up.
    pub fn metres_from_input(self, p: Vec3) -> Vec3 {
        match self.up {
            UpAxis::Y => p * self.unit,
            UpAxis::Z => Vec3::new(p.x, p.z, -p.y) * self.unit,
        }
    }
}

/// What all frames are compared with.
pub(super) struct Reference<'a> {
    pub path: &'a Path,
    pub vertex_count: usize,
    pub faces: &'a FaceList,
    pub uvs: &'a [[f32; 2]],
    pub colours: &'a [[u8; 4]],
}

/// What a frame does differently.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Differences {
    /// Texture coordinates or vertex colours change.
    pub attributes: bool,
    /// The texture that the frame's own material library or comment names.
    pub texture: Option<PathBuf>,
}

/// Reads one OBJ or PLY file.
pub(super) fn read_frame(path: &Path) -> Result<Frame, ImportError> {
    let bytes = read_file(path)?;
    match ending(path).as_str() {
        "obj" => obj::parse(&bytes, path),
        "ply" => ply::parse(&bytes, path),
        _ => Err(ImportError::UnknownFormat { path: path.to_owned() }),
    }
}

/// The mesh that `frame`, read from `path`, shares with the frames after it; warnings about missing libraries.
pub(super) fn shared_mesh(frame: &Frame, path: &Path, warnings: &mut Vec<Warning>) -> Result<FileMesh, ImportError> {
    if frame.faces.sizes.is_empty() {
        return Err(ImportError::NoTriangles { path: path.to_owned() });
    }
    let mut images = ImageStore::default();
    let mut materials = Vec::new();
    let mut untextured = 0;
    for (mut material, texture) in looks(frame, path, warnings)? {
        match texture {
            Some(_) if frame.uvs.is_empty() => untextured += 1,
            Some(texture) => material.image = Some(images.load(&texture)?),
            None => {}
        }
        materials.push(material);
    }
    if untextured > 0 {
        warnings.push(Warning::new(
            "W_NO_UV",
            format!("{}: has a texture but no texture coordinates: it is drawn without", path.display()),
        ));
    }
    Ok(FileMesh {
        vertex_count: frame.positions.len(),
        faces: frame.faces.clone(),
        uvs: frame.uvs.clone(),
        colours: frame.colours.clone(),
        material_of_face: frame.material_of_face.clone(),
        materials,
        images: images.images,
    })
}

/// The texture that `frame` itself names, if any.
pub(super) fn own_texture(frame: &Frame, path: &Path) -> Result<Option<PathBuf>, ImportError> {
    Ok(looks(frame, path, &mut Vec::new())?.into_iter().find_map(|(_, texture)| texture))
}

/// Materials and texture files of `frame`, one per material name.
fn looks(
    frame: &Frame,
    path: &Path,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<(actor::surface::Material, Option<PathBuf>)>, ImportError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut library = Vec::new();
    for name in &frame.libraries {
        for file in library_files(folder, name) {
            if file.is_file() {
                library.extend(mtl::parse(&read_file(&file)?, &file)?);
            } else {
                warnings.push(Warning::new(
                    "W_MATERIAL_MISSING",
                    format!("{}: the material library {} is missing", path.display(), file.display()),
                ));
            }
        }
    }
    let names = frame.material_names.iter().enumerate();
    Ok(names
        .map(|(k, name)| {
            if let Some(texture) = frame.material_textures.get(k) {
                return (plain_material(name), Some(folder.join(texture)));
            }
            match library.iter().find(|m| m.material.name == *name) {
                Some(found) => (found.material.clone(), found.texture.as_ref().map(|t| folder.join(t))),
                None => (plain_material(name), None),
            }
        })
        .collect())
}

/// `mtllib` may name one file with spaces, or several without.
fn library_files(folder: &Path, statement: &str) -> Vec<PathBuf> {
    let whole = folder.join(statement);
    if whole.is_file() { vec![whole] } else { statement.split_ascii_whitespace().map(|w| folder.join(w)).collect() }
}

/// Reads the frames `paths`, the first of them frame `first_frame` of its sequence, into `out`; in parallel.
pub(super) fn read_frames(
    paths: &[PathBuf],
    first_frame: usize,
    first: &Frame,
    reference: &Reference<'_>,
    axes: Axes,
    out: &mut [Vec3],
) -> Result<Vec<Differences>, ImportError> {
    let results: Vec<Result<Differences, ImportError>> = paths
        .par_iter()
        .zip(out.par_chunks_mut(reference.vertex_count.max(1)))
        .enumerate()
        .map(|(k, (path, out))| {
            let frame = read_frame(path)?;
            check_same_mesh(&frame, path, first_frame + k, reference)?;
            place(&frame.positions, path, first_frame + k, axes, out)?;
            let attributes = frame.uvs != reference.uvs || frame.colours != reference.colours;
            let same_looks = frame.libraries == first.libraries && frame.material_textures == first.material_textures;
            let texture = if same_looks { None } else { own_texture(&frame, path)? };
            Ok(Differences { attributes, texture })
        })
        .collect();
    // The first error in the order of the frames, whatever thread was first.
    results.into_iter().collect()
}

fn check_same_mesh(frame: &Frame, path: &Path, number: usize, reference: &Reference<'_>) -> Result<(), ImportError> {
    let (path, reference_path) = (path.to_owned(), reference.path.to_owned());
    let (found, expected) = (frame.positions.len(), reference.vertex_count);
    if found != expected {
        return Err(ImportError::VertexCount { path, frame: number, found, expected, reference: reference_path });
    }
    match frame.faces.first_difference(reference.faces) {
        Some(face) => Err(ImportError::FaceList { path, frame: number, face, reference: reference_path }),
        None => Ok(()),
    }
}

/// Beyond this many metres from the origin a coordinate is a fault of the file or of the unit.
const MAX_DISTANCE: f32 = 1e6;

/// Writes `positions` of the input to `out` in metres, +Y up.
pub(super) fn place(
    positions: &[Vec3],
    path: &Path,
    frame: usize,
    axes: Axes,
    out: &mut [Vec3],
) -> Result<(), ImportError> {
    for (vertex, (slot, &position)) in out.iter_mut().zip(positions).enumerate() {
        *slot = axes.metres_from_input(position);
        // Written so that NaN fails.
        if !(slot.abs().max_element() <= MAX_DISTANCE && slot.is_finite()) {
            return Err(ImportError::NotFinite { path: path.to_owned(), frame, element: format!("vertex {vertex}") });
        }
    }
    Ok(())
}
