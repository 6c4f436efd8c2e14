//! Reads all frames of a plan into one block of file-vertex positions.

use std::path::PathBuf;

use actor::timeline::Timeline;
use glam::{DVec3, Vec3};
use job::{Job, Stopped};
use rayon::prelude::*;

use super::error::ImportError;
use super::frames::{Axes, First, Reference, Seen, check_area, check_same_mesh, place, read_frames, shared_mesh};
use super::gltf::GltfFile;
use super::inputs::Source;
use super::layers::unpacked;
use super::mesh::FileMesh;
use super::places::{coarse, offset_of, recentred};
use super::plan::{Plan, PlannedSequence};
use super::scratch::Scratch;
use super::stills::{StillReader, read_stills};
use super::topologies;
use super::warning::{Notes, Warning};
use super::worn::NamedTexture;

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
    /// Positions of the file vertices in metres, +Y up, near the origin, frame after frame.
    pub positions: Vec<Vec3>,
    /// What was taken off all positions, in metres, +Y up.
    pub offset: DVec3,
    /// Number of frames of each sequence.
    pub frame_counts: Vec<usize>,
    /// For each sequence the texture that each of its frames names itself; empty where none does.
    pub textures: Vec<Vec<Option<NamedTexture>>>,
    /// Textures that files hold within themselves, written out.
    pub scratch: Option<Scratch>,
}

/// Reads the frames of `plan`; sentences for the user go to `warnings`.
pub(super) fn read(plan: &Plan, job: &Job, warnings: &mut Vec<Warning>) -> Result<Recording, ImportError> {
    let Some(first) = plan.sequences.first() else { return Err(ImportError::NoInput) };
    let reference_path = first.source.path().to_owned();
    let (mesh, pose, narrow) = mesh_and_pose(&first.source)?;
    let mut axes = Axes { up: plan.up, unit: plan.metres_per_unit(), offset: DVec3::ZERO };
    let place = pose.iter().map(|&p| axes.metres_from_input(p));
    warnings.extend(coarse(place.clone(), &reference_path).filter(|_| narrow));
    if let Some(offset) = offset_of(place) {
        axes.offset = offset;
        warnings.push(recentred(offset, &reference_path));
    }
    let counts: Vec<u64> = plan.sequences.iter().map(|s| s.source.frame_count(plan.fps)).collect();
    let (mut positions, total) = reserve(plan, &counts, mesh.vertex_count)?;

    let mut scratch = None;
    let mut textures = Vec::new();
    let mut notes = Notes::default();
    let mut done = 0;
    let mut rest = positions.as_mut_slice();
    for (index, (sequence, &count)) in plan.sequences.iter().zip(&counts).enumerate() {
        let (out, tail) = rest.split_at_mut(count as usize * mesh.vertex_count);
        rest = tail;
        let report = |frames: usize| job.tell("reading frames", done + frames as u64, total);
        let mut reader =
            Reader { sequence, reference: Reference { path: &reference_path, mesh: &mesh }, axes, notes: &mut notes };
        textures.push(match &sequence.source {
            Source::Files(paths) => reader.files(paths, out, &report)?,
            Source::Stills(paths) => reader.stills(paths, out, &report, (index, &mut scratch))?,
            Source::Clip { file, clip } => {
                reader.clip(file, *clip, plan.fps, out, &report)?;
                warnings.extend(file.rate_warning(*clip, plan.fps));
                Vec::new()
            }
        });
        if !sequence.layers.is_empty() && sequence.textures.files.is_empty() {
            *textures.last_mut().unwrap_or(&mut Vec::new()) = unpacked(&sequence.layers, index, &mut scratch)?;
        }
        done += count;
    }
    warnings.extend(notes.into_warnings());
    let frame_counts = counts.iter().map(|&count| count as usize).collect();
    Ok(Recording { mesh, positions, offset: axes.offset, frame_counts, textures, scratch })
}

/// The mesh of a source, its first pose as the file has it, and whether that was written with 32 bits.
fn mesh_and_pose(source: &Source) -> Result<(FileMesh, Vec<DVec3>, bool), ImportError> {
    let still = |file: &GltfFile, clip: usize| -> Result<_, ImportError> {
        let pose = file.pose(clip, 1.0, 0)?.iter().map(|p| p.as_dvec3()).collect();
        Ok((file.mesh().clone(), pose, true))
    };
    let (mesh, pose, narrow) = match source {
        Source::Files(paths) => {
            let path = paths.first().ok_or(ImportError::NoInput)?;
            let first = First::read(path)?;
            (shared_mesh(&first, path)?, first.frame.positions, first.frame.narrow)
        }
        Source::Stills(paths) => still(&GltfFile::open(paths.first().ok_or(ImportError::NoInput)?)?, 0)?,
        Source::Clip { file, clip } => still(file, *clip)?,
    };
    if mesh.vertex_count > MAX_VERTICES {
        let reason = format!("{} vertices, of at most {MAX_VERTICES}", mesh.vertex_count);
        return Err(ImportError::TooLarge { path: source.path().to_owned(), reason });
    }
    Ok((mesh, pose, narrow))
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

/// Reads the frames of one sequence.
struct Reader<'a> {
    sequence: &'a PlannedSequence,
    reference: Reference<'a>,
    axes: Axes,
    notes: &'a mut Notes,
}

impl Reader<'_> {
    /// OBJ or PLY files; the texture of each.
    fn files(
        &mut self,
        paths: &[PathBuf],
        out: &mut [Vec3],
        report: &dyn Fn(usize) -> Result<(), Stopped>,
    ) -> Result<Vec<Option<NamedTexture>>, ImportError> {
        let Some(path) = paths.first() else { return Ok(Vec::new()) };
        let first = First::read(path)?;
        let mut textures = Vec::with_capacity(paths.len());
        let vertices = self.reference.mesh.vertex_count.max(1);
        for (batch, out) in paths.chunks(BATCH).zip(out.chunks_mut(BATCH * vertices)) {
            let seen = read_frames(batch, textures.len(), &first, &self.reference, self.axes, out);
            let seen = self.note(batch, seen).map_err(|error| topologies::explained(error, self.sequence, paths))?;
            textures.extend(seen);
            report(textures.len())?;
        }
        Ok(if textures.iter().any(Option::is_some) { textures } else { Vec::new() })
    }

    /// glTF files that hold a pose each; the texture of each.
    fn stills(
        &mut self,
        paths: &[PathBuf],
        out: &mut [Vec3],
        report: &dyn Fn(usize) -> Result<(), Stopped>,
        (index, scratch): (usize, &mut Option<Scratch>),
    ) -> Result<Vec<Option<NamedTexture>>, ImportError> {
        let Some(path) = paths.first() else { return Ok(Vec::new()) };
        let mut stills = StillReader::new(path, index, scratch)?;
        let vertices = self.reference.mesh.vertex_count.max(1);
        let mut textures = Vec::with_capacity(paths.len());
        for (batch, out) in paths.chunks(BATCH).zip(out.chunks_mut(BATCH * vertices)) {
            let seen = read_stills(batch, textures.len(), &stills, &self.reference, self.axes, out);
            let seen = self.note(batch, seen).map_err(|error| topologies::explained(error, self.sequence, paths))?;
            textures.extend(seen);
            report(textures.len())?;
        }
        stills.finish(&mut textures)?;
        Ok(textures)
    }

    /// The textures of frames; the first error in their order, whatever thread was first.
    fn note(
        &mut self,
        paths: &[PathBuf],
        seen: Vec<Result<Seen, ImportError>>,
    ) -> Result<Vec<Option<NamedTexture>>, ImportError> {
        let mut textures = Vec::with_capacity(seen.len());
        for (path, seen) in paths.iter().zip(seen) {
            let Seen { texture, notes } = seen?;
            self.notes.add(path, notes);
            textures.push(texture);
        }
        Ok(textures)
    }

    /// Bakes a clip, frame by frame in parallel.
    fn clip(
        &self,
        file: &GltfFile,
        clip: usize,
        fps: f32,
        out: &mut [Vec3],
        report: &dyn Fn(usize) -> Result<(), Stopped>,
    ) -> Result<(), ImportError> {
        self.check_clip_mesh(file)?;
        let (vertices, axes) = (file.mesh().vertex_count.max(1), self.axes);
        for (batch, out) in out.chunks_mut(BATCH * vertices).enumerate() {
            let results: Vec<Result<(), ImportError>> = out
                .par_chunks_mut(vertices)
                .enumerate()
                .map(|(k, out)| {
                    let frame = batch * BATCH + k;
                    let pose: Vec<DVec3> =
                        file.pose(clip, f64::from(fps), frame)?.iter().map(|p| p.as_dvec3()).collect();
                    place(&pose, file.path(), frame, axes, out)?;
                    check_area(&file.mesh().faces, file.path(), frame, out)
                })
                .collect();
            results.into_iter().collect::<Result<(), _>>()?;
            report(batch * BATCH + out.len() / vertices)?;
        }
        Ok(())
    }

    fn check_clip_mesh(&self, file: &GltfFile) -> Result<(), ImportError> {
        let mesh = file.mesh();
        if file.path() == self.reference.path {
            return Ok(());
        }
        check_same_mesh(mesh.vertex_count, &mesh.faces, file.path(), 0, &self.reference)
            .map_err(|error| topologies::explained(error, self.sequence, &[]))
    }
}
