//! Mesh files, one a frame: all must hold the same faces as the first.

use std::f32::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use glam::{DVec3, Quat, Vec3};
use rayon::prelude::*;

#[cfg(feature = "gltf")]
use super::drc;
use super::error::ImportError;
use super::formats::disguised;
use super::images::read_file;
use super::looks::{Look, looks};
use super::manifest::UpAxis;
use super::mesh::{FaceList, FileMesh, MeshFile};
use super::paths::ending;
use super::warning::Note;
use super::worn::NamedTexture;
use super::{obj, ply, vologram};

/// Turns positions of the input into metres, +Y up, near the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    pub up: UpAxis,
    /// Metres per unit.
    pub unit: f64,
    /// What is taken off, in metres, +Y up.
    pub offset: DVec3,
}

impl Axes {
    /// `p` in metres, +Y up, where it was recorded.
    pub fn metres_from_input(self, p: DVec3) -> DVec3 {
        match self.up {
            UpAxis::Y => p * self.unit,
            UpAxis::Z => DVec3::new(p.x, p.z, -p.y) * self.unit,
        }
    }

    /// How the input's axes are turned against ours.
    pub fn rotation(self) -> Quat {
        match self.up {
            UpAxis::Y => Quat::IDENTITY,
            UpAxis::Z => Quat::from_rotation_x(-FRAC_PI_2),
        }
    }
}

/// What all frames are compared with.
pub(super) struct Reference<'a> {
    pub path: &'a Path,
    pub mesh: &'a FileMesh,
}

/// The first frame of a sequence, and how it looks.
pub(super) struct First {
    path: PathBuf,
    pub frame: MeshFile,
    pub looks: Vec<Look>,
    /// The material whose texture is followed from frame to frame: the first that has one.
    main: usize,
}

impl First {
    /// Reads the frame at `path`.
    pub fn read(path: &Path) -> Result<Self, ImportError> {
        let frame = read_frame(path)?;
        let looks = looks(&frame, path, &mut Vec::new())?;
        let main = looks.iter().position(|look| look.texture.is_some()).unwrap_or(0);
        Ok(Self { path: path.to_owned(), frame, looks, main })
    }

    /// The texture that the frame names itself.
    pub fn named(&self) -> Option<NamedTexture> {
        self.worn(&self.looks)
    }

    /// Whether the frame has texture coordinates and names no texture for them.
    pub fn wants_texture(&self) -> bool {
        !self.frame.uvs.is_empty() && self.named().is_none()
    }

    /// Whether other materials than the main one look otherwise in a frame with `looks`, or that one has another colour.
    fn others_differ(&self, looks: &[Look]) -> bool {
        let same = |(k, (a, b)): (usize, (&Look, &Look))| {
            let textures = k == self.main || a.texture == b.texture;
            textures && a.material.base_colour == b.material.base_colour && a.uv == b.uv
        };
        looks.len() != self.looks.len() || !looks.iter().zip(&self.looks).enumerate().all(same)
    }

    /// The texture that a frame with `looks` wears.
    fn worn(&self, looks: &[Look]) -> Option<NamedTexture> {
        let main = looks.get(self.main).and_then(|look| look.texture.clone());
        main.or_else(|| looks.iter().find_map(|look| look.texture.clone()))
    }
}

/// What a frame is like, beside its positions.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Seen {
    /// The texture that the frame's own material library or comment names.
    pub texture: Option<NamedTexture>,
    /// What is unusual.
    pub notes: Vec<Note>,
}

/// Reads one OBJ, PLY or Draco file, or a frame of a vologram.
pub(super) fn read_frame(path: &Path) -> Result<MeshFile, ImportError> {
    if let Some((file, number)) = vologram::frame_at(path) {
        return vologram::read_frame(file, number);
    }
    let bytes = read_file(path)?;
    if let Some(told) = disguised(&bytes, path) {
        return Err(ImportError::UnknownFormat { path: path.to_owned(), told });
    }
    match ending(path).as_str() {
        "obj" => obj::parse(&bytes, path),
        "ply" => ply::parse(&bytes, path),
        #[cfg(feature = "gltf")]
        "drc" => drc::parse(&bytes, path),
        _ => Err(ImportError::unknown_format(path)),
    }
}

/// The mesh that `first`, read from `path`, shares with the frames after it. Its textures are not loaded yet.
pub(super) fn shared_mesh(first: &First, path: &Path) -> Result<FileMesh, ImportError> {
    let First { frame, looks, .. } = first;
    if frame.faces.sizes.is_empty() {
        return Err(ImportError::NoTriangles { path: path.to_owned() });
    }
    Ok(FileMesh {
        vertex_count: frame.positions.len(),
        faces: frame.faces.clone(),
        uvs: frame.uvs.clone(),
        normals: frame.normals.clone(),
        colours: frame.colours.clone(),
        material_of_face: frame.material_of_face.clone(),
        materials: looks.iter().map(|look| look.material.clone()).collect(),
        images: Vec::new(),
        textures: looks.iter().map(|look| look.texture.clone()).collect(),
        uv_transforms: looks.iter().map(|look| look.uv).collect(),
        bare_corners: frame.bare_corners.clone(),
        names_no_library: frame.libraries.is_empty()
            && frame.material_names.iter().any(|name| !name.is_empty())
            && frame.material_textures.is_empty()
            && ending(path) == "obj",
    })
}

/// Reads the frames `paths`, the first of them frame `first_frame` of its sequence, into `out`; in parallel.
pub(super) fn read_frames(
    paths: &[PathBuf],
    first_frame: usize,
    first: &First,
    reference: &Reference<'_>,
    axes: Axes,
    out: &mut [Vec3],
) -> Vec<Result<Seen, ImportError>> {
    paths
        .par_iter()
        .zip(out.par_chunks_mut(reference.mesh.vertex_count.max(1)))
        .enumerate()
        .map(|(k, (path, out))| {
            let mut frame = read_frame(path)?;
            check_same_mesh(frame.positions.len(), &frame.faces, path, first_frame + k, reference)?;
            place(&frame.positions, path, first_frame + k, axes, out)?;
            check_area(&frame.faces, path, first_frame + k, out)?;
            let mut notes = std::mem::take(&mut frame.notes);
            let looks = looks_like_first(&frame, path, first, &mut notes)?;
            let mesh = reference.mesh;
            if frame.uvs != mesh.uvs || frame.colours != mesh.colours {
                notes.push(attributes_differ());
            }
            let others_differ = looks.as_ref().is_some_and(|looks| first.others_differ(looks));
            // Materials that change their names only keep their faces.
            if others_differ || !same_materials(&frame.material_of_face, &mesh.material_of_face) {
                let message = "materials other than the one with the texture of the frame differ from those of the first \
                               frame: the first frame's are used";
                notes.push(Note::new("W_MATERIALS_DIFFER", message));
            }
            let texture = first.worn(looks.as_deref().unwrap_or(&first.looks));
            Ok(Seen { texture, notes })
        })
        .collect()
}

pub(super) fn attributes_differ() -> Note {
    let message = "texture coordinates or colours differ from those of the first frame: the first frame's are used";
    Note::new("W_ATTRIBUTES_DIFFER", message)
}

/// The looks of a frame; `None` where it names what the first names, so that they are the first's.
fn looks_like_first(
    frame: &MeshFile,
    path: &Path,
    first: &First,
    notes: &mut Vec<Note>,
) -> Result<Option<Vec<Look>>, ImportError> {
    let of =
        |frame: &MeshFile| (frame.libraries.clone(), frame.material_textures.clone(), frame.material_names.clone());
    // The first frame itself tells what is unusual about them.
    let same = of(frame) == of(&first.frame) && path != first.path;
    if same { Ok(None) } else { looks(frame, path, notes).map(Some) }
}

/// Whether faces wear the same materials; an empty list is all material 0.
fn same_materials(a: &[u32], b: &[u32]) -> bool {
    match (a, b) {
        ([], other) | (other, []) => other.iter().all(|&material| material == 0),
        _ => a == b,
    }
}

/// What a frame with another mesh than the first is refused for.
pub(super) fn check_same_mesh(
    vertex_count: usize,
    faces: &FaceList,
    path: &Path,
    number: usize,
    reference: &Reference<'_>,
) -> Result<(), ImportError> {
    let (path, reference_path) = (path.to_owned(), reference.path.to_owned());
    let (found, expected) = (vertex_count, reference.mesh.vertex_count);
    if found != expected {
        return Err(ImportError::VertexCount {
            path,
            frame: number,
            found,
            expected,
            reference: reference_path,
            more: String::new(),
        });
    }
    match faces.first_difference(&reference.mesh.faces) {
        Some(face) => {
            Err(ImportError::FaceList { path, frame: number, face, reference: reference_path, more: String::new() })
        }
        None => Ok(()),
    }
}

/// Beyond this many metres from where the capture stands a coordinate is a fault of the file or of the unit.
const MAX_DISTANCE: f64 = 1e6;

/// Writes `positions` of the input to `out` in metres, +Y up, near the origin.
pub(super) fn place(
    positions: &[DVec3],
    path: &Path,
    frame: usize,
    axes: Axes,
    out: &mut [Vec3],
) -> Result<(), ImportError> {
    for (vertex, (slot, &position)) in out.iter_mut().zip(positions).enumerate() {
        let place = axes.metres_from_input(position) - axes.offset;
        // Written so that NaN fails.
        if !(place.abs().max_element() <= MAX_DISTANCE && place.is_finite()) {
            return Err(ImportError::NotFinite { path: path.to_owned(), frame, element: format!("vertex {vertex}") });
        }
        *slot = place.as_vec3();
    }
    Ok(())
}

/// Refuses a frame in which nothing is left of the surface, as where its scale is 0.
pub(super) fn check_area(faces: &FaceList, path: &Path, frame: usize, pose: &[Vec3]) -> Result<(), ImportError> {
    let corner = |&v: &u32| pose.get(v as usize).copied().unwrap_or_default().as_dvec3();
    let has_area = |face: &[u32]| {
        let points: Vec<_> = face.iter().map(corner).collect();
        points.windows(2).any(|w| (w[0] - points[0]).cross(w[1] - points[0]).length_squared() > 0.0)
    };
    if faces.iter().any(has_area) {
        return Ok(());
    }
    Err(ImportError::Collapsed { path: path.to_owned(), frame })
}
