//! From a recording to a capture: weld, topology, drawn surface, timeline.

use std::collections::HashMap;

use actor::capture::{Capture, Poses};
use actor::files::FileFaces;
use actor::surface::{Corner, Part, Surface};
use actor::timeline::{Sequence, Timeline};
use glam::Vec3;
use kernels::align::{Placement, align_heading, centre_of_mass};
use kernels::topology::{Topology, barycentric_areas};

use super::error::ImportError;
use super::faces;
use super::loops::{self, Meets};
use super::mesh::{FileMesh, FileTriangle};
use super::per_vertex;
use super::plan::{Plan, PlannedSequence};
use super::read::Recording;
use super::warning::Warning;
use super::weld::weld;

/// Default welding tolerance as a part of the body's size (the diagonal of the first frame's box).
const WELD_PART: f64 = 1e-5;
/// The last frame of a cyclic sequence repeats the first where they agree to this part of the body's size.
const REPEAT_PART: f32 = 1e-3;

/// What a recording comes to.
pub(super) struct Assembled {
    pub capture: Capture,
    /// The faces of its files where they are not simply the drawn triangles.
    pub faces: Option<FileFaces>,
    /// For each sequence whether its last frame was dropped for repeating the first.
    pub dropped: Vec<bool>,
    /// The number of each vertex's part of the body, where they were painted.
    pub parts: Option<Vec<u8>>,
}

/// The capture, and what comes with it.
pub(super) fn assemble(
    plan: &Plan,
    recording: Recording,
    weld_tolerance: Option<f32>,
    warnings: &mut Vec<Warning>,
) -> Result<Assembled, ImportError> {
    let Recording { mesh, mut positions, frame_counts, .. } = recording;
    let file_vertices = mesh.vertex_count;
    let path = plan.sequences.first().map(|s| s.source.path().to_owned()).unwrap_or_default();
    let first = positions.get(..file_vertices).unwrap_or_default();
    let size = body_size(first);
    warn_about_size(size, warnings);
    warn_about_sizes(plan, &positions, file_vertices, &frame_counts, warnings);
    let mut triangles = mesh.triangles(first);

    let tolerance = weld_tolerance.map_or(WELD_PART * f64::from(size), f64::from);
    let representative = weld(&positions, file_vertices, tolerance);
    let (vertex_of_file_vertex, kept) = number_vertices(&representative);
    warn_about_welds(file_vertices, kept.len(), tolerance, warnings);
    let welded = |triangle: &FileTriangle| welded_corners(&mesh, triangle, &vertex_of_file_vertex);
    let before = triangles.len();
    triangles.retain(|t| {
        let [a, b, c] = welded(t);
        a != b && b != c && c != a
    });
    if before > triangles.len() {
        let dropped = before - triangles.len();
        warnings.push(Warning::new(
            "W_TRIANGLES_DROPPED",
            format!("{dropped} of {before} triangles have two corners at one place and are left out"),
        ));
    }
    if triangles.is_empty() {
        return Err(ImportError::NoTriangles { path });
    }
    let corners: Vec<[u32; 3]> = triangles.iter().map(welded).collect();
    let surface = surface(&mesh, &triangles, &vertex_of_file_vertex);
    let faces = faces::faces(&mesh, &triangles, &surface, &vertex_of_file_vertex);

    keep_vertices(&mut positions, file_vertices, &kept);
    let vertex_count = kept.len();
    let weights = match &plan.weights {
        Some(file) => per_vertex::weights(file, file_vertices, &kept)?,
        None => barycentric_areas(&corners, positions.get(..vertex_count).unwrap_or_default()),
    };
    let parts = plan.parts.as_ref().map(|file| per_vertex::parts(file, file_vertices, &kept)).transpose()?;
    if plan.weights.is_none() && weights.iter().all(|&area| area == 0.0) {
        return Err(ImportError::NoTriangles { path });
    }
    let topology = Topology::new(vertex_count as u32, corners, weights)?;
    warn_about_loose_vertices(&topology, warnings);

    let Played { poses, frame_counts, cyclic, dropped } =
        play(plan, &topology, positions, frame_counts, size, warnings);
    let timeline = timeline(plan, &frame_counts, &cyclic)?;
    let capture = Capture { name: plan.name.clone(), topology, surface, timeline, poses, vertex_of_file_vertex };
    Ok(Assembled { capture, faces, dropped, parts })
}

/// Diagonal of the box around `pose`.
fn body_size(pose: &[Vec3]) -> f32 {
    let low = pose.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = pose.iter().copied().reduce(Vec3::max).unwrap_or_default();
    low.distance(high)
}

fn warn_about_size(size: f32, warnings: &mut Vec<Warning>) {
    if !(0.05..=20.0).contains(&size) {
        warnings.push(Warning::new(
            "W_SIZE",
            format!(
                "the subject measures {size:.3} m: if that is not so, give the unit (0.01 for centimetres, 0.001 for \
             millimetres)"
            ),
        ));
    }
}

/// Sizes of the body that differ by more than this are different units, or one of them is damaged.
const MOST_GROWTH: f32 = 20.0;

fn warn_about_sizes(
    plan: &Plan,
    positions: &[Vec3],
    file_vertices: usize,
    frame_counts: &[usize],
    warnings: &mut Vec<Warning>,
) {
    let sizes: Vec<f32> = positions.chunks_exact(file_vertices.max(1)).map(body_size).collect();
    let mut sorted = sizes.clone();
    sorted.sort_by(f32::total_cmp);
    let Some(&usual) = sorted.get(sorted.len() / 2) else { return };
    let odd = |size: f32| size > MOST_GROWTH * usual || MOST_GROWTH * size < usual;
    let frames: Vec<usize> = (0..sizes.len()).filter(|&frame| odd(sizes[frame])).collect();
    let Some(&first) = frames.first() else { return };
    let (sequence, frame) = within(plan, frame_counts, first);
    warnings.push(Warning::new(
        "W_SIZE_CHANGES",
        format!(
            "frame {frame} of sequence \"{}\" measures {:.3} m, most others {usual:.3} m, and so do {} frames in all: do all \
             files have one unit, and does a vertex lie far away?",
            sequence.map(|s| s.name.as_str()).unwrap_or_default(),
            sizes[first],
            frames.len()
        ),
    ));
}

/// The sequence that holds frame `frame` of the capture, and its number there.
fn within<'a>(plan: &'a Plan, frame_counts: &[usize], frame: usize) -> (Option<&'a PlannedSequence>, usize) {
    let mut rest = frame;
    for (sequence, &count) in plan.sequences.iter().zip(frame_counts) {
        if rest < count {
            return (Some(sequence), rest);
        }
        rest -= count;
    }
    (None, rest)
}

fn warn_about_welds(file_vertices: usize, kept: usize, tolerance: f64, warnings: &mut Vec<Warning>) {
    if kept < file_vertices {
        warnings.push(Warning::new(
            "W_WELDED",
            format!(
                "{file_vertices} vertices of the files are {kept} vertices of the body: those within {:.4} mm of each other in \
                 every frame are one (--weld 0 keeps apart all that differ at all)",
                tolerance * 1000.0
            ),
        ));
    }
}

/// Numbers the representatives in the order of their file vertices: the number of each file vertex, and the file
/// vertex of each number.
fn number_vertices(representative: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut vertex_of_file_vertex = vec![0; representative.len()];
    let mut kept = Vec::new();
    for (v, &r) in representative.iter().enumerate() {
        if v == r as usize {
            vertex_of_file_vertex[v] = kept.len() as u32;
            kept.push(r);
        } else {
            // A representative comes before its group.
            vertex_of_file_vertex[v] = vertex_of_file_vertex[r as usize];
        }
    }
    (vertex_of_file_vertex, kept)
}

fn welded_corners(mesh: &FileMesh, triangle: &FileTriangle, vertex_of_file_vertex: &[u32]) -> [u32; 3] {
    triangle.corners.map(|corner| vertex_of_file_vertex[mesh.faces.vertices[corner] as usize])
}

/// The drawn mesh; corners are numbered in the order of their first use.
fn surface(mesh: &FileMesh, triangles: &[FileTriangle], vertex_of_file_vertex: &[u32]) -> Surface {
    let mut surface = Surface { materials: mesh.materials.clone(), images: mesh.images.clone(), ..Surface::default() };
    let mut index_of_corner: HashMap<(u32, [u32; 2], [u8; 4]), u32> = HashMap::new();
    for triangle in triangles {
        let corners = triangle.corners.map(|place| {
            let file_vertex = mesh.faces.vertices[place] as usize;
            let vertex = vertex_of_file_vertex[file_vertex];
            let uv = mesh.uvs.get(place).copied().unwrap_or([0.0, 0.0]);
            let colour = mesh.colours.get(file_vertex).copied().unwrap_or([255; 4]);
            let next = surface.corners.len() as u32;
            let index = *index_of_corner.entry((vertex, uv.map(|x| (x + 0.0).to_bits()), colour)).or_insert(next);
            if index == next {
                surface.corners.push(Corner { vertex, uv, colour });
            }
            index
        });
        surface.triangles.push(corners);
    }
    for (first, triangle) in triangles.iter().enumerate() {
        match surface.parts.last_mut() {
            Some(part) if part.material == triangle.material => part.triangle_count += 1,
            _ => surface.parts.push(Part {
                material: triangle.material,
                first_triangle: first as u32,
                triangle_count: 1,
            }),
        }
    }
    surface
}

/// Keeps only the vertices `kept` of every frame of `positions`, in place.
fn keep_vertices(positions: &mut Vec<Vec3>, file_vertices: usize, kept: &[u32]) {
    if kept.len() == file_vertices {
        return;
    }
    let frames = positions.len().checked_div(file_vertices).unwrap_or(0);
    for frame in 0..frames {
        // What is written lies at or before what is read: vertices only move forwards.
        for (k, &v) in kept.iter().enumerate() {
            positions[frame * kept.len() + k] = positions[frame * file_vertices + v as usize];
        }
    }
    positions.truncate(frames * kept.len());
    positions.shrink_to_fit();
}

fn warn_about_loose_vertices(topology: &Topology, warnings: &mut Vec<Warning>) {
    let mut used = vec![false; topology.vertex_count()];
    for &vertex in topology.triangles().iter().flatten() {
        used[vertex as usize] = true;
    }
    let loose = used.iter().filter(|&&used| !used).count();
    if loose > 0 {
        warnings.push(Warning::new(
            "W_LOOSE_VERTICES",
            format!("{loose} of {} vertices belong to no triangle; they are kept", used.len()),
        ));
    }
}

/// The poses that are played, and what is known of each sequence.
struct Played {
    /// Without the frames that close a loop.
    poses: Poses,
    /// Frames that are left.
    frame_counts: Vec<usize>,
    /// Whether it is a loop.
    cyclic: Vec<bool>,
    /// Whether its last frame was left out.
    dropped: Vec<bool>,
}

fn play(
    plan: &Plan,
    topology: &Topology,
    mut positions: Vec<Vec3>,
    mut frame_counts: Vec<usize>,
    size: f32,
    warnings: &mut Vec<Warning>,
) -> Played {
    let (n, weights) = (topology.vertex_count(), topology.weights());
    let (mut cyclic, mut dropped) = (Vec::new(), Vec::new());
    let (mut loops, mut almost) = (Vec::new(), Vec::new());
    let (mut read, mut write) = (0, 0);
    for (sequence, count) in plan.sequences.iter().zip(&mut frame_counts) {
        let frames = &positions[read * n..(read + *count) * n];
        let repeats = sequence.cyclic != Some(false) && *count > 1 && repeats(frames, n, weights, REPEAT_PART * size);
        let is_loop = sequence.cyclic.unwrap_or_else(|| {
            let meets = loops::meets(frames, n, weights, repeats);
            match meets {
                Meets::InStep => loops.push(sequence.name.as_str()),
                Meets::InPlace => almost.push(sequence.name.as_str()),
                Meets::No => {}
            }
            meets == Meets::InStep
        });
        let drop = is_loop && repeats;
        let kept = *count - usize::from(drop);
        positions.copy_within(read * n..(read + kept) * n, write * n);
        read += *count;
        write += kept;
        if drop && sequence.cyclic == Some(true) {
            warnings.push(Warning::new(
                "W_FRAME_REPEATED",
                format!("\"{}\": the last frame repeats the first and is left out", sequence.name),
            ));
        }
        *count = kept;
        cyclic.push(is_loop);
        dropped.push(drop);
    }
    warn_about_loops(&loops, &almost, warnings);
    positions.truncate(write * n);
    Played { poses: Poses::from_positions(n, positions), frame_counts, cyclic, dropped }
}

fn warn_about_loops(loops: &[&str], almost: &[&str], warnings: &mut Vec<Warning>) {
    if !loops.is_empty() {
        warnings.push(Warning::new(
            "W_CYCLIC",
            format!(
                "the end meets the beginning in {} of the sequences, which are played as loops (without a last frame that \
                 repeats the first): {}; if they are none, say --cyclic none, or cyclic = false in a manifest",
                loops.len(),
                loops.join(", ")
            ),
        ));
    }
    if !almost.is_empty() {
        warnings.push(Warning::new(
            "W_CYCLIC_PERHAPS",
            format!(
                "the end is where the beginning is, but at another speed, in {} of the sequences: {}; if they are loops, name \
                 them (--cyclic NAMES, or cyclic = true in a manifest)",
                almost.len(),
                almost.join(", ")
            ),
        ));
    }
}

/// Whether the last of `frames` is the first one, turned about the vertical and moved along the ground.
fn repeats(frames: &[Vec3], vertex_count: usize, weights: &[f32], tolerance: f32) -> bool {
    let first = &frames[..vertex_count];
    let mut last = frames[frames.len() - vertex_count..].to_vec();
    let heading = align_heading(first, &last, weights);
    let ground = |p: Vec3| glam::Vec2::new(p.x, p.z);
    let from = ground(centre_of_mass(&last, weights));
    let to = ground(centre_of_mass(first, weights));
    Placement::turning(heading, from, to).apply_all(&mut last);
    let worst = first.iter().zip(&last).map(|(a, b)| a.as_dvec3().distance(b.as_dvec3())).fold(0.0, f64::max);
    worst <= f64::from(tolerance)
}

fn timeline(plan: &Plan, frame_counts: &[usize], cyclic: &[bool]) -> Result<Timeline, ImportError> {
    let mut first_frame = 0;
    let mut sequences = Vec::new();
    for ((sequence, &count), &cyclic) in plan.sequences.iter().zip(frame_counts).zip(cyclic) {
        let frame_count = count as u32;
        sequences.push(Sequence {
            name: sequence.name.clone(),
            labels: sequence.labels.clone(),
            first_frame,
            frame_count,
            cyclic,
        });
        first_frame += frame_count;
    }
    Ok(Timeline::new(plan.fps, sequences)?)
}
