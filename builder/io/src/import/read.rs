//! Reads all frames of a plan into one block of file-vertex positions.

use std::path::PathBuf;

use actor::timeline::Timeline;
use glam::Vec3;
use rayon::prelude::*;

use super::error::ImportError;
use super::frames::{Axes, Differences, Reference, place, read_frame, read_frames, shared_mesh};
use super::gltf::GltfFile;
use super::inputs::Source;
use super::mesh::{FileMesh, Frame};
use super::plan::{Plan, PlannedSequence};
use super::warning::Warning;
use super::{Progress, frames};

/// No capture has more file vertices.
const MAX_VERTICES: usize = 1 << 24;
/// No capture has more positions: 24 GB of them.
const MAX_POSITIONS: u64 = 1 << 31;
/// Frames that are read between two reports of progress.
const BATCH: usize = 32;

/// All frames, before welding.
pub(super) struct Recording {
    /// What the frames share.
    pub mesh: FileMesh,
    /// Positions of the file vertices in metres, +Y up, frame after frame.
    pub positions: Vec<Vec3>,
    /// Number of frames of each sequence.
    pub frame_counts: Vec<usize>,
    /// For each sequence the textures that its own files name: none, one for all frames, or one a frame.
    pub textures: Vec<Vec<PathBuf>>,
}

/// Reads the frames of `plan`; sentences for the user go to `warnings`.
pub(super) fn read(
    plan: &Plan,
    progress: &dyn Fn(Progress),
    warnings: &mut Vec<Warning>,
) -> Result<Recording, ImportError> {
    let axes = Axes { up: plan.up, unit: plan.unit };
    let Some(first) = plan.sequences.first() else { return Err(ImportError::NoInput) };
    let reference_path = first.source.path().to_owned();
    let mesh = mesh_of(&first.source, warnings)?;
    let counts: Vec<u64> = plan.sequences.iter().map(|s| s.source.frame_count(plan.fps)).collect();
    let (mut positions, total) = reserve(plan, &counts, mesh.vertex_count)?;

    let reference = Reference {
        path: &reference_path,
        vertex_count: mesh.vertex_count,
        faces: &mesh.faces,
        uvs: &mesh.uvs,
        colours: &mesh.colours,
    };
    let mut textures = Vec::new();
    let mut done = 0;
    let mut rest = positions.as_mut_slice();
    for (sequence, &count) in plan.sequences.iter().zip(&counts) {
        let (out, tail) = rest.split_at_mut(count as usize * mesh.vertex_count);
        rest = tail;
        let report = |frames: usize| progress(Progress { what: "reading frames", done: done + frames as u64, total });
        textures.push(match &sequence.source {
            Source::Files(paths) => read_files(paths, &reference, axes, out, &report, warnings)?,
            Source::Clip { file, clip } => {
                check_clip_mesh(file, &reference)?;
                warnings.extend(file.rate_warning(*clip, plan.fps));
                bake(file, *clip, plan.fps, axes, out, &report)?;
                Vec::new()
            }
        });
        done += count;
    }
    let frame_counts = counts.iter().map(|&count| count as usize).collect();
    Ok(Recording { mesh, positions, frame_counts, textures })
}

fn mesh_of(source: &Source, warnings: &mut Vec<Warning>) -> Result<FileMesh, ImportError> {
    let mesh = match source {
        Source::Files(paths) => {
            let path = paths.first().ok_or(ImportError::NoInput)?;
            shared_mesh(&read_frame(path)?, path, warnings)?
        }
        Source::Clip { file, .. } => file.mesh().clone(),
    };
    if mesh.vertex_count > MAX_VERTICES {
        let reason = format!("{} vertices, of at most {MAX_VERTICES}", mesh.vertex_count);
        return Err(ImportError::TooLarge { path: source.path().to_owned(), reason });
    }
    Ok(mesh)
}

/// Memory for the positions of `counts` frames, and the number of frames; refuses what is too much.
fn reserve(plan: &Plan, counts: &[u64], vertex_count: usize) -> Result<(Vec<Vec3>, u64), ImportError> {
    let too_large = |sequence: Option<&PlannedSequence>, reason: String| {
        let path = sequence.map(|s| s.source.path().to_owned()).unwrap_or_default();
        let name = sequence.map(|s| s.name.as_str()).unwrap_or_default();
        ImportError::TooLarge { path, reason: format!("with sequence \"{name}\" there are {reason}") }
    };
    let mut total = 0_u64;
    for (sequence, &count) in plan.sequences.iter().zip(counts) {
        total = total.saturating_add(count);
        if total > u64::from(Timeline::MAX_FRAMES) {
            let reason = format!("{total} frames, of at most {}", Timeline::MAX_FRAMES);
            return Err(too_large(Some(sequence), reason));
        }
    }
    let size = total * vertex_count as u64;
    let reason = || format!("{total} frames of {vertex_count} vertices, which do not fit into memory");
    let mut positions = Vec::new();
    if size > MAX_POSITIONS || positions.try_reserve_exact(size as usize).is_err() {
        return Err(too_large(plan.sequences.last(), reason()));
    }
    positions.resize(size as usize, Vec3::ZERO);
    Ok((positions, total))
}

fn read_files(
    paths: &[PathBuf],
    reference: &Reference<'_>,
    axes: Axes,
    out: &mut [Vec3],
    report: &dyn Fn(usize),
    warnings: &mut Vec<Warning>,
) -> Result<Vec<PathBuf>, ImportError> {
    let Some(first_path) = paths.first() else { return Ok(Vec::new()) };
    let first: Frame = read_frame(first_path)?;
    let mut differences: Vec<Differences> = Vec::with_capacity(paths.len());
    let vertices = reference.vertex_count.max(1);
    for (batch, out) in paths.chunks(BATCH).zip(out.chunks_mut(BATCH * vertices)) {
        let found = read_frames(batch, differences.len(), &first, reference, axes, out)?;
        differences.extend(found);
        report(differences.len());
    }
    if let Some(frame) = differences.iter().position(|d| d.attributes) {
        warnings.push(Warning::new(
            "W_ATTRIBUTES_DIFFER",
            format!(
                "{}: texture coordinates or colours differ from those of the first frame: the first frame's are used",
                paths.get(frame).unwrap_or(first_path).display()
            ),
        ));
    }
    let Some(own) = frames::own_texture(&first, first_path)? else { return Ok(Vec::new()) };
    let one_each: Vec<PathBuf> = differences.into_iter().map(|d| d.texture.unwrap_or_else(|| own.clone())).collect();
    Ok(if one_each.iter().all(|texture| *texture == own) { vec![own] } else { one_each })
}

fn check_clip_mesh(file: &GltfFile, reference: &Reference<'_>) -> Result<(), ImportError> {
    if file.path() == reference.path {
        return Ok(());
    }
    let mesh = file.mesh();
    let (path, reference_path) = (file.path().to_owned(), reference.path.to_owned());
    let (found, expected) = (mesh.vertex_count, reference.vertex_count);
    if found != expected {
        return Err(ImportError::VertexCount { path, frame: 0, found, expected, reference: reference_path });
    }
    match mesh.faces.first_difference(reference.faces) {
        Some(face) => Err(ImportError::FaceList { path, frame: 0, face, reference: reference_path }),
        None => Ok(()),
    }
}

/// Bakes a clip, frame by frame in parallel.
fn bake(
    file: &GltfFile,
    clip: usize,
    fps: f32,
    axes: Axes,
    out: &mut [Vec3],
    report: &dyn Fn(usize),
) -> Result<(), ImportError> {
    let vertices = file.mesh().vertex_count.max(1);
    for (batch, out) in out.chunks_mut(BATCH * vertices).enumerate() {
        let results: Vec<Result<(), ImportError>> = out
            .par_chunks_mut(vertices)
            .enumerate()
            .map(|(k, out)| {
                let frame = batch * BATCH + k;
                let pose = file.pose(clip, f64::from(fps), frame)?;
                place(&pose, file.path(), frame, axes, out)?;
                check_area(file, frame, out)
            })
            .collect();
        results.into_iter().collect::<Result<(), _>>()?;
        report(batch * BATCH + out.len() / vertices);
    }
    Ok(())
}

/// Refuses a frame in which nothing is left of the surface, as where its scale is 0.
fn check_area(file: &GltfFile, frame: usize, pose: &[Vec3]) -> Result<(), ImportError> {
    let corner = |&v: &u32| pose.get(v as usize).copied().unwrap_or_default().as_dvec3();
    let has_area = |face: &[u32]| {
        let points: Vec<_> = face.iter().map(corner).collect();
        points.windows(2).any(|w| (w[0] - points[0]).cross(w[1] - points[0]).length_squared() > 0.0)
    };
    if file.mesh().faces.iter().any(has_area) {
        return Ok(());
    }
    Err(ImportError::Collapsed { path: file.path().to_owned(), frame })
}
