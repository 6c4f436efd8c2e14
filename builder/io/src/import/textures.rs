//! Which texture each frame wears.
//!
//! What the user names wins; then what the mesh files themselves name (MTL, PLY comments, glTF); then, for mesh files
//! with texture coordinates, images beside them: one named like each frame, or a single one for all.

use std::path::{Path, PathBuf};

use super::error::ImportError;
use super::images::{ImageStore, is_image, size_of};
use super::inputs::{Source, list};
use super::mesh::FileMesh;
use super::plan::{Plan, PlannedSequence};
use super::warning::Warning;

/// Settles the textures of a capture: sets the static ones of `mesh`, and returns one file per frame of the whole
/// capture where frames have their own.
///
/// `own` are the textures that each sequence's files name, `frame_counts` the sequences' frames.
pub(super) fn settle(
    plan: &Plan,
    mesh: &mut FileMesh,
    own: &[Vec<PathBuf>],
    frame_counts: &[usize],
    warnings: &mut Vec<Warning>,
) -> Result<Option<Vec<PathBuf>>, ImportError> {
    let mut of_sequence = Vec::new();
    let mut replace = false;
    for ((sequence, own), &count) in plan.sequences.iter().zip(own).zip(frame_counts) {
        let (textures, found_outside) = choose(sequence, own, mesh)?;
        if textures.len() > 1 && textures.len() != count {
            return Err(ImportError::TextureCount {
                input: textures.first().map(|p| p.display().to_string()).unwrap_or_default(),
                found: textures.len(),
                expected: count,
                sequence: sequence.name.clone(),
            });
        }
        replace |= found_outside && of_sequence.is_empty();
        of_sequence.push(textures);
    }
    let Some(first) = of_sequence.iter().flatten().next() else { return Ok(None) };
    if mesh.uvs.is_empty() {
        warnings.push(Warning::new(
            "W_NO_UV",
            format!("{}: the mesh has no texture coordinates: it is drawn without texture", first.display()),
        ));
        return Ok(None);
    }
    if replace || mesh.images.is_empty() {
        set_texture(mesh, first)?;
    }
    per_frame(plan, &of_sequence, frame_counts, warnings)
}

/// The textures of a sequence, and whether they come from elsewhere than its mesh files.
fn choose(sequence: &PlannedSequence, own: &[PathBuf], mesh: &FileMesh) -> Result<(Vec<PathBuf>, bool), ImportError> {
    if !sequence.textures.is_empty() {
        return Ok((sequence.textures.clone(), true));
    }
    if !own.is_empty() {
        return Ok((own.to_vec(), false));
    }
    match &sequence.source {
        Source::Files(paths) if !mesh.uvs.is_empty() => Ok((beside(paths)?, true)),
        _ => Ok((Vec::new(), false)),
    }
}

/// Images in the folder of the frames: one named like each frame, or a single one for all.
fn beside(frames: &[PathBuf]) -> Result<Vec<PathBuf>, ImportError> {
    let Some(folder) = frames.first().and_then(|f| f.parent()) else { return Ok(Vec::new()) };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let images: Vec<PathBuf> = list(folder)?.into_iter().filter(|p| is_image(p) && p.is_file()).collect();
    let named_like = |frame: &PathBuf| images.iter().find(|image| image.file_stem() == frame.file_stem()).cloned();
    let one_each: Option<Vec<PathBuf>> = frames.iter().map(named_like).collect();
    Ok(match (one_each, images.as_slice()) {
        (Some(one_each), _) => one_each,
        (None, [only]) => vec![only.clone()],
        _ => Vec::new(),
    })
}

/// Gives every material the texture `path`.
fn set_texture(mesh: &mut FileMesh, path: &Path) -> Result<(), ImportError> {
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

/// One texture per frame of the whole capture; `None` where all frames wear the same, or where some have none.
fn per_frame(
    plan: &Plan,
    of_sequence: &[Vec<PathBuf>],
    frame_counts: &[usize],
    warnings: &mut Vec<Warning>,
) -> Result<Option<Vec<PathBuf>>, ImportError> {
    let first = of_sequence.iter().flatten().next();
    if of_sequence.iter().flatten().all(|texture| Some(texture) == first) {
        return Ok(None);
    }
    if let Some(bare) = of_sequence.iter().position(Vec::is_empty) {
        let name = plan.sequences.get(bare).map(|s| s.name.as_str()).unwrap_or_default();
        warnings.push(Warning::new(
            "W_TEXTURES_INCOMPLETE",
            format!("the textures change, but sequence \"{name}\" has none: one texture is used for all frames"),
        ));
        return Ok(None);
    }
    let mut all = Vec::new();
    for (textures, &count) in of_sequence.iter().zip(frame_counts) {
        all.extend((0..count).filter_map(|k| textures.get(k.min(textures.len() - 1)).cloned()));
    }
    check_sizes(&all)?;
    Ok(Some(all))
}

/// All textures of a capture must have one size.
fn check_sizes(textures: &[PathBuf]) -> Result<(), ImportError> {
    let mut expected = None;
    let mut last: Option<&PathBuf> = None;
    for (frame, path) in textures.iter().enumerate() {
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
