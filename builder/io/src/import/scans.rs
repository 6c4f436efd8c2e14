//! Frames that each have their own mesh: read one by one, whenever they are asked for, and never held against each other.

use std::path::PathBuf;

use actor::surface::Material;
use glam::{DVec3, Vec2, Vec3};

use super::ImportOptions;
use super::error::ImportError;
use super::frames::{Axes, First, check_area, place, shared_mesh};
use super::gltf::GltfFile;
use super::inputs::Source;
use super::layers::TextureLayer;
use super::mesh::{FileMesh, FileTriangle};
use super::nearby;
use super::pairing;
use super::places::{offset_of, recentred};
use super::plan::{Plan, PlannedSequence, plan};
use super::sheet::{Cell, Picture, ScannedTexture, Sheet};
use super::warning::Warning;
use super::worn::NamedTexture;

/// A body of this many units is measured in millimetres, or in centimetres; between them and beyond nothing is assumed.
const MILLIMETRES: std::ops::Range<f64> = 600.0..6000.0;
const CENTIMETRES: std::ops::Range<f64> = 60.0..600.0;

/// Sequences of frames of which none is read yet.
#[derive(Debug)]
pub struct Scans {
    /// Name of the subject.
    pub name: String,
    /// Frames per second.
    pub fps: f32,
    /// The sequences.
    pub sequences: Vec<ScannedSequence>,
    /// Sentences about what the user should know.
    pub warnings: Vec<Warning>,
    axes: Axes,
}

/// A sequence of scanned frames.
#[derive(Clone, Debug)]
pub struct ScannedSequence {
    /// Its name.
    pub name: String,
    /// Its labels.
    pub labels: Vec<String>,
    /// Whether its end meets its beginning, where that is said.
    pub cyclic: Option<bool>,
    /// The file of each frame.
    pub files: Vec<PathBuf>,
    /// The texture of each frame, where it is not the frame's file that says it; empty where none is.
    textures: Vec<Option<Outside>>,
    still: bool,
}

/// A texture that the frame's own file does not name.
#[derive(Clone, Debug)]
enum Outside {
    Image(PathBuf),
    Layer(TextureLayer),
}

impl Outside {
    fn read(&self) -> Result<ScannedTexture, ImportError> {
        match self {
            Self::Image(path) => Ok(Picture::read(path)?.into()),
            Self::Layer(layer) => {
                let (path, bytes, layer) = (layer.path().to_owned(), layer.bytes()?, Some(layer).cloned());
                Ok(Picture { path, bytes, layer }.into())
            }
        }
    }
}

/// A frame as its file holds it: nothing is welded.
#[derive(Clone, Debug, Default)]
pub struct ScannedFrame {
    /// Vertices in metres, +Y up, near the origin.
    pub positions: Vec<Vec3>,
    /// Triangles over them.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of each triangle's corners, v downwards; empty where there are none.
    pub uvs: Vec<[Vec2; 3]>,
    /// sRGB colours of the vertices; empty where there are none.
    pub colours: Vec<[u8; 4]>,
    /// Its texture: those of all materials side by side, where they are several.
    pub texture: Option<ScannedTexture>,
}

/// Finds the scanned frames of `inputs`, as [`import`](super::import) finds those of one mesh.
///
/// # Errors
/// Inputs that are not found, and glTF files with clips, whose frames share one mesh.
pub fn scans(inputs: &[String], options: &ImportOptions) -> Result<Scans, ImportError> {
    let Plan { name, fps, up, unit, sequences, families, mut warnings, .. } = plan(inputs, options)?;
    if !families.is_empty() {
        let names: Vec<&str> = families.iter().map(|family| family.name.as_str()).collect();
        let message = format!(
            "families ({}) are not made of frames that are brought onto one mesh first: builder register, then write the \
             [[family]] into the manifest of what it made",
            names.join(", ")
        );
        warnings.push(Warning::new("W_FAMILY_SCAN", message));
    }
    let axes = Axes { up, unit: unit.to_string().parse().unwrap_or(f64::from(unit)), offset: DVec3::ZERO };
    let sequences = sequences.into_iter().map(|planned| sequence(planned, &mut warnings));
    let sequences: Vec<ScannedSequence> = sequences.collect::<Result<_, _>>()?;
    let mut scans = Scans { name, fps, sequences, warnings: Vec::new(), axes };
    if let Some((path, pose)) = scans.first_pose()? {
        let (low, high) = pose
            .iter()
            .filter(|p| p.is_finite())
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let size = low.distance(high) * scans.axes.unit;
        let assumed = if MILLIMETRES.contains(&size) { Some(("millimetres", 0.001)) } else { None };
        let assumed = assumed.or_else(|| CENTIMETRES.contains(&size).then_some(("centimetres", 0.01)));
        if let (Some((word, unit)), 1.0, None) = (assumed, unit, options.unit) {
            scans.axes.unit = unit;
            let message = format!(
                "{}: the subject would measure {size:.0} m: lengths are taken for {word}; --unit says it for certain",
                path.display()
            );
            warnings.push(Warning::new("W_UNIT_ASSUMED", message));
        }
        if let Some(offset) = offset_of(pose.iter().map(|&p| scans.axes.metres_from_input(p))) {
            scans.axes.offset = offset;
            warnings.push(recentred(offset, &path));
        }
    }
    scans.warnings = warnings;
    Ok(scans)
}

fn sequence(planned: PlannedSequence, warnings: &mut Vec<Warning>) -> Result<ScannedSequence, ImportError> {
    let textures = textures(&planned, warnings)?;
    let PlannedSequence { name, labels, cyclic, source, .. } = planned;
    let (files, still) = match source {
        Source::Files(files) => (files, false),
        Source::Stills(files) => (files, true),
        Source::Clip { file, .. } => {
            return Err(ImportError::Option(format!(
                "{}: frames of a clip share one mesh: pack it as it is, or export one file a frame to have it registered",
                file.path().display()
            )));
        }
    };
    Ok(ScannedSequence { name, labels, cyclic, files, textures, still })
}

/// The textures of a sequence that its frames' files do not name: those that the user or a manifest names, or that lie beside.
fn textures(planned: &PlannedSequence, warnings: &mut Vec<Warning>) -> Result<Vec<Option<Outside>>, ImportError> {
    let frames = planned.source.files();
    let found = match planned.textures.files.as_slice() {
        [] if !planned.layers.is_empty() => {
            return Ok(planned.layers.iter().cloned().map(|layer| Some(Outside::Layer(layer))).collect());
        }
        [] => match &planned.source {
            // Where the first frame names its own, the others do, too.
            Source::Files(files) if !files.is_empty() && First::read(&files[0])?.wants_texture() => {
                nearby::images(planned, files, warnings)?
            }
            _ => return Ok(Vec::new()),
        },
        [only] => vec![Some(only.clone()); frames.len()],
        _ => pairing::named(&planned.textures, planned, frames.len(), warnings)?,
    };
    let Some(worn) = pairing::filled(&found, planned, warnings) else { return Ok(Vec::new()) };
    Ok(worn.into_iter().map(|worn| Some(Outside::Image(worn.path))).collect())
}

impl Scans {
    /// Frames of all sequences.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.sequences.iter().map(|sequence| sequence.files.len()).sum()
    }

    /// Sequence of a frame counted over all sequences, and its number there.
    #[must_use]
    pub fn place_of(&self, frame: usize) -> Option<(usize, usize)> {
        let mut rest = frame;
        for (k, sequence) in self.sequences.iter().enumerate() {
            if rest < sequence.files.len() {
                return Some((k, rest));
            }
            rest -= sequence.files.len();
        }
        None
    }

    /// Reads a frame, counted over all sequences.
    ///
    /// # Errors
    /// A file that cannot be read, or holds no surface; a texture that is named and missing.
    pub fn read(&self, frame: usize) -> Result<ScannedFrame, ImportError> {
        let Some((sequence, number)) = self.place_of(frame) else { return Err(ImportError::NoInput) };
        let of = &self.sequences[sequence];
        let path = &of.files[number];
        let (mesh, recorded, sheet) = self.file(sequence, number)?;
        let mut positions = vec![Vec3::ZERO; recorded.len()];
        place(&recorded, path, number, self.axes, &mut positions)?;
        check_area(&mesh.faces, path, number, &positions)?;
        let corners = &mesh.faces.vertices;
        let triangles = mesh.triangles(&positions);
        let uvs = if mesh.uvs.is_empty() {
            Vec::new()
        } else {
            let moved = |material: u32| mesh.uv_transforms.get(material as usize).copied().unwrap_or_default();
            let of = |t: &FileTriangle| {
                let corners = t.corners.map(|corner| moved(t.material).apply(mesh.uvs[corner]).into());
                sheet.as_ref().map_or(corners, |sheet| sheet.place(t.material, corners))
            };
            triangles.iter().map(of).collect()
        };
        let texture = match of.textures.get(number) {
            Some(Some(outside)) => Some(outside.read()?),
            _ => sheet.map(|sheet| sheet.texture),
        };
        let triangles = triangles.iter().map(|t| t.corners.map(|corner| corners[corner])).collect();
        Ok(ScannedFrame { positions, triangles, uvs, colours: mesh.colours, texture })
    }

    /// The first frame that holds a surface, and its positions as they are recorded.
    fn first_pose(&self) -> Result<Option<(PathBuf, Vec<DVec3>)>, ImportError> {
        for (k, sequence) in self.sequences.iter().enumerate() {
            for (number, path) in sequence.files.iter().enumerate() {
                match self.file(k, number) {
                    Ok((_, positions, _)) => return Ok(Some((path.clone(), positions))),
                    Err(ImportError::NoTriangles { .. }) => {}
                    Err(error) => return Err(error),
                }
            }
        }
        Ok(None)
    }

    /// Mesh, positions as they are recorded, and the textures of a frame, where its own file says them.
    fn file(&self, sequence: usize, number: usize) -> Result<(FileMesh, Vec<DVec3>, Option<Sheet>), ImportError> {
        let (of, path) = (&self.sequences[sequence], &self.sequences[sequence].files[number]);
        if of.still {
            let file = GltfFile::open(path)?;
            let pose = file.pose(0, 1.0, 0)?.iter().map(|p| p.as_dvec3()).collect();
            let mesh = file.mesh().clone();
            let picture = |material: &Material| {
                let image = material.image.and_then(|image| mesh.images.get(image as usize))?;
                Some(Picture { path: path.clone(), bytes: image.bytes.clone(), layer: None })
            };
            let looks = looks(&mesh, |number| Ok(mesh.materials.get(number).and_then(picture)))?;
            return Ok((mesh, pose, Sheet::of(looks)));
        }
        let first = First::read(path)?;
        let mesh = shared_mesh(&first, path)?;
        if !of.textures.is_empty() {
            return Ok((mesh, first.frame.positions, None));
        }
        let looks = looks(&mesh, |number| match mesh.textures.get(number).cloned().flatten() {
            Some(NamedTexture::Found(path)) => Picture::read(&path).map(Some),
            Some(NamedTexture::Missing(texture)) => Err(ImportError::TextureMissing { path: path.clone(), texture }),
            None => Ok(None),
        })?;
        Ok((mesh, first.frame.positions, Sheet::of(looks)))
    }
}

/// What each material of a mesh looks like; those that no face has are taken to look like the first one that one has.
fn looks(
    mesh: &FileMesh,
    picture: impl Fn(usize) -> Result<Option<Picture>, ImportError>,
) -> Result<Vec<Cell>, ImportError> {
    let count = mesh.materials.len().max(1);
    let mut used = vec![mesh.material_of_face.is_empty(); count];
    for &material in &mesh.material_of_face {
        if let Some(used) = used.get_mut(material as usize) {
            *used = true;
        }
    }
    let mut looks = Vec::with_capacity(count);
    for number in 0..count {
        let [red, green, blue, _] = mesh.materials.get(number).map_or([1.0; 4], |material| material.base_colour);
        let tint = [red, green, blue];
        let picture = used[number].then(|| picture(number)).transpose()?;
        looks.push(picture.map(|picture| Cell { picture, tint }));
    }
    let first = looks.iter().flatten().next().cloned();
    Ok(looks.into_iter().filter_map(|look| look.or_else(|| first.clone())).collect())
}
