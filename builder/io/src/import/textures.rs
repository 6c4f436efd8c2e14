//! Which texture each frame wears.
//!
//! What the user names wins; then what the mesh files themselves name (MTL, PLY comments, glTF); then, for mesh files
//! with texture coordinates, images beside them.

use std::path::{Path, PathBuf};

use super::error::ImportError;
use super::images::{ImageStore, size_of};
use super::inputs::Source;
use super::mesh::FileMesh;
use super::nearby;
use super::pairing::{self, Worn};
use super::plan::{Plan, PlannedSequence};
use super::warning::Warning;
use super::worn::NamedTexture;

/// The textures of a sequence.
enum Textures {
    /// None is known outside of the mesh itself.
    None,
    /// One for all frames.
    One(PathBuf),
    /// One a frame.
    Each(Vec<Worn>),
}

impl Textures {
    fn first(&self) -> Option<&PathBuf> {
        match self {
            Self::None => None,
            Self::One(path) => Some(path),
            Self::Each(worn) => worn.first().map(|worn| &worn.path),
        }
    }
}

/// Settles the textures of a capture: sets the static ones of `mesh`, and returns what every frame of the whole capture
/// wears where frames have their own.
///
/// `own` are the textures that each sequence's files name, `frame_counts` the sequences' frames.
pub(super) fn settle(
    plan: &Plan,
    mesh: &mut FileMesh,
    own: &[Vec<Option<NamedTexture>>],
    frame_counts: &[usize],
    warnings: &mut Vec<Warning>,
) -> Result<Option<Vec<Worn>>, ImportError> {
    let mut of_sequence = Vec::new();
    let mut replaced = false;
    for ((sequence, own), &count) in plan.sequences.iter().zip(own).zip(frame_counts) {
        let (textures, found_outside) = choose(sequence, own, count, mesh, warnings)?;
        replaced |= found_outside && of_sequence.is_empty();
        of_sequence.push(textures);
    }
    let first = of_sequence.iter().find_map(Textures::first).cloned();
    let named = mesh.textures.iter().flatten().next().is_some();
    if mesh.uvs.is_empty() {
        if first.is_some() || named {
            let path = plan.sequences.first().map(|s| s.source.path().display().to_string()).unwrap_or_default();
            warnings.push(Warning::new(
                "W_NO_UV",
                format!("{path}: has a texture but no texture coordinates: it is drawn without texture"),
            ));
        }
        warn_about_library(plan, mesh, warnings);
        return Ok(None);
    }
    if replaced {
        set_texture(mesh, first.as_ref())?;
    } else {
        load_named(mesh, first.as_ref(), plan)?;
        if mesh.images.is_empty() {
            set_texture(mesh, first.as_ref())?;
        }
    }
    warn_about_library(plan, mesh, warnings);
    warn_about_bare_corners(plan, mesh, warnings);
    per_frame(plan, &of_sequence, frame_counts, warnings)
}

/// The textures of a sequence, and whether they come from elsewhere than its mesh files.
fn choose(
    sequence: &PlannedSequence,
    own: &[Option<NamedTexture>],
    count: usize,
    mesh: &FileMesh,
    warnings: &mut Vec<Warning>,
) -> Result<(Textures, bool), ImportError> {
    match sequence.textures.files.as_slice() {
        [] => {}
        [only] => return Ok((Textures::One(only.clone()), true)),
        _ => {
            let paired = pairing::named(&sequence.textures, sequence, count, warnings)?;
            return Ok((each(&paired, sequence, warnings), true));
        }
    }
    let found: Vec<Option<PathBuf>> =
        own.iter().map(|own| own.as_ref().and_then(NamedTexture::found).cloned()).collect();
    if found.iter().any(Option::is_some) {
        return Ok((each(&found, sequence, warnings), false));
    }
    if let Some((frame, texture)) = own.iter().enumerate().find_map(|(frame, own)| Some((frame, own.as_ref()?))) {
        return Err(missing(sequence, frame, texture));
    }
    match &sequence.source {
        Source::Files(paths) if !mesh.uvs.is_empty() => {
            let beside = nearby::images(sequence, paths, warnings)?;
            Ok((each(&beside, sequence, warnings), true))
        }
        _ => Ok((Textures::None, false)),
    }
}

/// `paired`, one a frame or one for all; what is lost is told.
fn each(paired: &[Option<PathBuf>], sequence: &PlannedSequence, warnings: &mut Vec<Warning>) -> Textures {
    let Some(worn) = pairing::filled(paired, sequence, warnings) else { return Textures::None };
    match worn.first() {
        Some(first) if worn.iter().all(|other| other.path == first.path) => Textures::One(first.path.clone()),
        _ => Textures::Each(worn),
    }
}

fn missing(sequence: &PlannedSequence, frame: usize, texture: &NamedTexture) -> ImportError {
    let path = sequence.source.files().get(frame).map_or(sequence.source.path(), PathBuf::as_path).to_owned();
    let texture = match texture {
        NamedTexture::Missing(written) => written.clone(),
        NamedTexture::Found(path) => path.display().to_string(),
    };
    ImportError::TextureMissing { path, texture }
}

/// Gives every material the texture `path`.
fn set_texture(mesh: &mut FileMesh, path: Option<&PathBuf>) -> Result<(), ImportError> {
    let Some(path) = path else { return Ok(()) };
    let mut store = ImageStore::default();
    let image = store.load(path)?;
    mesh.images = store.images;
    for material in &mut mesh.materials {
        material.image = Some(image);
        // A colour beside a texture would tint it; what comes without a texture is some exporter's grey.
        material.base_colour[..3].fill(1.0);
    }
    Ok(())
}

/// Loads the textures that the first mesh file names for its materials; `first` stands in for the one that other frames
/// have and the first has lost.
fn load_named(mesh: &mut FileMesh, first: Option<&PathBuf>, plan: &Plan) -> Result<(), ImportError> {
    if mesh.textures.is_empty() {
        return Ok(());
    }
    let mut store = ImageStore::default();
    let main = mesh.textures.iter().position(Option::is_some);
    for (k, texture) in mesh.textures.iter().enumerate() {
        let Some(material) = mesh.materials.get_mut(k) else { continue };
        material.image = match (texture, first) {
            (Some(NamedTexture::Found(path)), _) => Some(store.load(path)?),
            (Some(NamedTexture::Missing(_)), Some(first)) if main == Some(k) => Some(store.load(first)?),
            (Some(lost @ NamedTexture::Missing(_)), _) => {
                let sequence = plan.sequences.first().ok_or(ImportError::NoInput)?;
                return Err(missing(sequence, 0, lost));
            }
            (None, _) => None,
        };
    }
    mesh.images = store.images;
    move_uvs(mesh);
    Ok(())
}

/// Moves texture coordinates as the statements of their textures say.
fn move_uvs(mesh: &mut FileMesh) {
    if mesh.uv_transforms.iter().all(|transform| *transform == Default::default()) {
        return;
    }
    let mut corner = 0;
    for (face, &size) in mesh.faces.sizes.iter().enumerate() {
        let material = mesh.material_of_face.get(face).copied().unwrap_or(0) as usize;
        let transform = mesh.uv_transforms.get(material).copied().unwrap_or_default();
        for uv in mesh.uvs.iter_mut().skip(corner).take(size as usize) {
            *uv = transform.apply(*uv);
        }
        corner += size as usize;
    }
}

fn warn_about_library(plan: &Plan, mesh: &FileMesh, warnings: &mut Vec<Warning>) {
    if mesh.names_no_library && mesh.images.is_empty() {
        let path = plan.sequences.first().map(|s| s.source.path().display().to_string()).unwrap_or_default();
        warnings.push(Warning::new(
            "W_MATERIAL_MISSING",
            format!("{path}: names materials (usemtl), but no library that describes them (mtllib): it is drawn white"),
        ));
    }
}

fn warn_about_bare_corners(plan: &Plan, mesh: &FileMesh, warnings: &mut Vec<Warning>) {
    let textured = |k: usize| mesh.materials.get(k).is_some_and(|material| material.image.is_some());
    let bare: usize = mesh.bare_corners.iter().enumerate().filter(|(k, _)| textured(*k)).map(|(_, &count)| count).sum();
    if bare > 0 {
        let path = plan.sequences.first().map(|s| s.source.path().display().to_string()).unwrap_or_default();
        warnings.push(Warning::new(
            "W_NO_UV",
            format!(
                "{path}: {bare} of {} face corners have no texture coordinate: they show a corner of the texture",
                mesh.faces.vertices.len()
            ),
        ));
    }
}

/// What every frame of the whole capture wears; `None` where all wear the same, or where some have no texture.
fn per_frame(
    plan: &Plan,
    of_sequence: &[Textures],
    frame_counts: &[usize],
    warnings: &mut Vec<Warning>,
) -> Result<Option<Vec<Worn>>, ImportError> {
    let first = of_sequence.iter().find_map(Textures::first);
    let same = |textures: &Textures| match textures {
        Textures::None => true,
        Textures::One(path) => Some(path) == first,
        Textures::Each(_) => false,
    };
    if of_sequence.iter().all(same) {
        return Ok(None);
    }
    if let Some(bare) = of_sequence.iter().position(|textures| matches!(textures, Textures::None)) {
        let name = plan.sequences.get(bare).map(|s| s.name.as_str()).unwrap_or_default();
        warnings.push(Warning::new(
            "W_TEXTURES_INCOMPLETE",
            format!("the textures change, but sequence \"{name}\" has none: one texture is used for all frames"),
        ));
        return Ok(None);
    }
    let mut all: Vec<Worn> = Vec::new();
    for (textures, &count) in of_sequence.iter().zip(frame_counts) {
        match textures {
            Textures::None => {}
            Textures::One(path) => all.extend((0..count).map(|_| Worn { path: path.clone(), own: true })),
            Textures::Each(worn) => all.extend(worn.iter().cloned()),
        }
    }
    check_sizes(&all)?;
    Ok(Some(all))
}

/// All textures of a capture must have one size.
fn check_sizes(textures: &[Worn]) -> Result<(), ImportError> {
    let mut expected = None;
    let mut last: Option<&Path> = None;
    for (frame, Worn { path, .. }) in textures.iter().enumerate() {
        if last.replace(path) == Some(path) {
            continue;
        }
        let (width, height) = size_of(path)?;
        let (w, h) = *expected.get_or_insert((width, height));
        if (w, h) != (width, height) {
            let reason =
                format!("frame {frame}: it has {width} x {height} pixels, the first frame's texture {w} x {h}");
            return Err(ImportError::Image { path: path.clone(), reason });
        }
    }
    Ok(())
}
