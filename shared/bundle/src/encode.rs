//! Writing a bundle.

use glam::Vec3;
use serde::Serialize;

use super::appearance::{AppearanceInput, AppearanceReport, Textures, encode as appearance};
use super::error::EncodeError;
use super::found_parts::FoundParts;
use super::geometry::encode::{Geometry, encode as encode_geometry};
use super::geometry::quantise::Grid;
use super::header::Header;
use super::kind::SectionKind;
use super::limits::{
    MAX_BYTES, MAX_CORNERS, MAX_IMAGES, MAX_MATERIALS, MAX_SECTION_BYTES, MAX_TRANSITIONS, MAX_TRIANGLES, MAX_VERTICES,
};
use super::meta::{Meta, SequenceMeta};
use super::scanned::ScannedFrames;
use super::sections::{Draft, assemble};
use super::{
    alternatives, body_parts, contacts, families, feet, files, found_parts, graph, integers, learned, motion, rig,
    surface, ties, turns,
};
use actor::alternatives::Alternatives;
use actor::capture::Capture;
use actor::files::Files;
use actor::graph::EssentialGraph;
use actor::motion::Motion;
use actor::pose_source::{PoseError, PoseSource};
use editing::{StoredRig, StoredSpace};

/// Frames from one independent frame to the next: decoding any frame touches at most three others.
const GROUP: u32 = 4;

/// What is written.
#[derive(Clone, Debug)]
pub struct BundleInput<'a> {
    /// The capture.
    pub capture: &'a Capture,
    /// Its essential graph.
    pub graph: &'a EssentialGraph,
    /// The frame that the player draws first.
    pub first_frame: u32,
    /// The largest distance in metres that a vertex may move; see [`default_max_error`].
    pub max_error: f32,
    /// A fill-reducing elimination order of the vertices, for the player's Poisson systems.
    pub poisson_order: Option<&'a [u32]>,
    /// The program that writes, with its version.
    pub generator: String,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EncodeReport {
    /// Bytes of the whole file.
    pub bytes: u64,
    /// Bytes by kind of section, the header first.
    pub sections: Vec<SectionSize>,
    /// Bytes that must arrive before the first pose can be drawn, without its textures.
    pub bytes_to_first_pose: u64,
    /// Root mean square distance in metres between stored and captured vertices, over all frames.
    pub rms_error: f64,
    /// Largest distance in metres between a stored and a captured vertex.
    pub max_error: f64,
    /// Mean bytes of a frame's positions, the shared model not counted.
    pub bytes_per_frame: f64,
    /// What became of the textures, where they were given as models.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub appearance: Option<AppearanceReport>,
}

/// Bytes of all sections of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SectionSize {
    /// Name of the kind.
    pub name: &'static str,
    /// Their bytes in the file.
    pub stored: u64,
}

/// Half a millimetre for an actor of 1.8 m, in proportion to the height of the pose in `first_frame`.
#[must_use]
pub fn default_max_error(capture: &Capture, first_frame: u32) -> f32 {
    if first_frame as usize >= capture.poses.len() {
        return 0.0005;
    }
    let (low, high) = bounds([capture.poses.frame(first_frame)].into_iter());
    let extent = high - low;
    // Something flat, such as cloth on the ground, is measured along its longer side.
    let height = if extent.y > 0.1 * extent.max_element() { extent.y } else { extent.max_element() };
    if height > 0.0 && height.is_finite() { 0.0005 * height / 1.8 } else { 0.0005 }
}

/// The bundle's bytes. The same input gives the same bytes.
///
/// # Errors
/// Input whose parts do not fit together, coordinates that cannot be stored within the error bound, or more of
/// something than the format allows.
pub fn encode(input: &BundleInput) -> Result<(Vec<u8>, EncodeReport), EncodeError> {
    encode_with_appearance(input, None)
}

/// As [`encode`], with the models of the capture's textures.
///
/// # Errors
/// As [`encode`]; models that do not fit the capture.
pub fn encode_with_appearance(
    input: &BundleInput,
    appearance: Option<&AppearanceInput>,
) -> Result<(Vec<u8>, EncodeReport), EncodeError> {
    encode_with_looks(input, appearance.map_or(&[], std::slice::from_ref))
}

/// As [`encode`], with the models of the capture's aligned textures, then those of the textures as captured, to compare
/// with; or only the former, or neither.
///
/// # Errors
/// As [`encode`]; models that do not fit the capture.
pub fn encode_with_looks(
    input: &BundleInput,
    looks: &[AppearanceInput],
) -> Result<(Vec<u8>, EncodeReport), EncodeError> {
    encode_with_files(input, looks, &Files::default())
}

/// As [`encode_with_looks`], with what exports need to know of the files that the capture came from.
///
/// # Errors
/// As [`encode_with_looks`]; faces that are not the capture's.
pub fn encode_with_files(
    input: &BundleInput,
    looks: &[AppearanceInput],
    files: &Files,
) -> Result<(Vec<u8>, EncodeReport), EncodeError> {
    encode_with_extras(input, looks, files, &Extras::default())
}

/// As [`encode_with_files`], with the rig by which edits move the body.
///
/// # Errors
/// As [`encode_with_files`]; a rig that is not the capture's.
pub fn encode_with_rig(
    input: &BundleInput,
    looks: &[AppearanceInput],
    files: &Files,
    rig: Option<&StoredRig>,
) -> Result<(Vec<u8>, EncodeReport), EncodeError> {
    encode_with_extras(input, looks, files, &Extras { rig, ..Extras::default() })
}

/// What a bundle may have besides.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct Extras<'a> {
    /// The rig by which edits move the body.
    pub rig: Option<&'a StoredRig>,
    /// The ways in which the capture was seen to move, by which edits move the body, too.
    pub learned: Option<&'a StoredSpace>,
    /// Motion that differs from recorded stretches.
    pub alternatives: Option<&'a Alternatives>,
    /// The part of the body that each vertex belongs to, as it was painted.
    pub body_parts: Option<&'a [u8]>,
    /// The parts of the body as they were found.
    pub found_parts: Option<&'a FoundParts>,
    /// Frames as they were scanned.
    pub scanned: Option<&'a ScannedFrames>,
}

/// As [`encode_with_files`], with what a bundle may have besides.
///
/// # Errors
/// As [`encode_with_files`]; what is not the capture's.
pub fn encode_with_extras(
    input: &BundleInput,
    looks: &[AppearanceInput],
    files: &Files,
    extras: &Extras,
) -> Result<(Vec<u8>, EncodeReport), EncodeError> {
    let capture = input.capture;
    check(input)?;
    let (lowest, highest) = bounds(capture.poses.iter());
    let largest = lowest.abs().max(highest.abs()).max_element();
    let grid = Grid::new(input.max_error, largest).ok_or_else(|| farthest(capture, largest))?;
    let geometry = encode_geometry(capture, &grid, GROUP, input.first_frame);
    let meta = Meta {
        name: capture.name.clone(),
        generator: input.generator.clone(),
        fps: capture.timeline.fps(),
        sequences: sequences(capture),
        vertex_count: capture.topology.vertex_count() as u32,
        corner_count: capture.surface.corners.len() as u32,
        triangle_count: capture.surface.triangles.len() as u32,
        image_count: capture.surface.images.len() as u32,
        transition_count: input.graph.transitions().len() as u32,
        lowest: lowest.into(),
        highest: highest.into(),
        first_frame: input.first_frame,
        max_error: input.max_error,
        step: grid.step,
        group: geometry.group,
        chunks: geometry.chunks.clone(),
    };
    let (rms_error, max_error) = (geometry.rms_error, geometry.max_error);
    let mut drafts = drafts(input, &meta, geometry)?;
    drafts.extend(extras.rig.map(|rig| rig_draft(rig, capture)).transpose()?);
    drafts.extend(extras.learned.map(|space| learned_draft(space, capture)).transpose()?);
    drafts.extend(extras.alternatives.map(|all| alternatives_draft(all, capture)).transpose()?.flatten());
    drafts.extend(extras.body_parts.map(|parts| parts_draft(parts, capture)).transpose()?);
    drafts.extend(extras.found_parts.map(|parts| found_parts_draft(parts, capture)).transpose()?);
    add_files(&mut drafts, files, capture)?;
    let mut appearance = None;
    for (textures, models) in [Textures::Aligned, Textures::Naive].into_iter().zip(looks) {
        let report = add_appearance(&mut drafts, textures, models, capture)?;
        appearance = appearance.or(Some(report));
    }
    if let Some(scanned) = extras.scanned {
        drafts.push(scanned.draft(&capture.timeline)?);
    }
    if let Some(large) = drafts.iter().find(|draft| draft.raw.len() as u64 > MAX_SECTION_BYTES) {
        let count = large.raw.len() as u64;
        return Err(EncodeError::TooLarge { what: "bytes in one section", count, limit: MAX_SECTION_BYTES });
    }
    let groups = extras.scanned.into_iter().flat_map(ScannedFrames::told);
    let (mut bytes, header) = assemble(drafts, groups);
    if header.total > MAX_BYTES {
        return Err(EncodeError::TooLarge { what: "bytes", count: header.total, limit: MAX_BYTES });
    }
    extras.scanned.into_iter().flat_map(ScannedFrames::here).for_each(|group| bytes.extend_from_slice(group));
    let report = EncodeReport { appearance, ..report(&header, capture.poses.len(), rms_error, max_error) };
    Ok((bytes, report))
}

/// The section of a rig of this capture.
fn rig_draft(stored: &StoredRig, capture: &Capture) -> Result<Draft, EncodeError> {
    let wrong = |reason: &str| EncodeError::Inconsistent(format!("the rig {reason}"));
    let vertex_count = capture.topology.vertex_count();
    if stored.influences.len() != vertex_count || stored.core.len() != vertex_count {
        return Err(wrong("is one of another mesh"));
    }
    let raw = rig::encode(stored).ok_or_else(|| wrong("has too many bones"))?;
    // What a reader would refuse is not written.
    rig::decode(&raw, vertex_count, capture.timeline.frame_count()).map_err(wrong)?;
    Ok(Draft { kind: SectionKind::Rig, ordinal: 0, raw })
}

/// The section of a space that was learned from this capture.
fn learned_draft(space: &StoredSpace, capture: &Capture) -> Result<Draft, EncodeError> {
    let raw = learned::encode(space, capture.timeline.frame_count());
    let raw = raw.ok_or_else(|| EncodeError::Inconsistent("the learned space is that of another capture".into()))?;
    Ok(Draft { kind: SectionKind::LearnedSpace, ordinal: 0, raw })
}

/// The section of alternatives of this capture; `None` where there are none.
fn alternatives_draft(all: &Alternatives, capture: &Capture) -> Result<Option<Draft>, EncodeError> {
    if all.is_empty() {
        return Ok(None);
    }
    let (modes, stretches) = (all.modes().to_vec(), all.stretches().to_vec());
    if Alternatives::new(modes, stretches, capture.topology.vertex_count(), &capture.timeline).is_none() {
        return Err(EncodeError::Inconsistent("the alternatives are those of another capture".into()));
    }
    Ok(Some(Draft { kind: SectionKind::Alternatives, ordinal: 0, raw: alternatives::encode(all, &capture.topology) }))
}

/// The section of painted parts of this capture.
fn parts_draft(parts: &[u8], capture: &Capture) -> Result<Draft, EncodeError> {
    let raw = body_parts::encode(parts, &capture.topology);
    let raw = raw.ok_or_else(|| EncodeError::Inconsistent("the painted parts are those of another mesh".into()))?;
    Ok(Draft { kind: SectionKind::BodyParts, ordinal: 0, raw })
}

/// The section of parts that were found on this capture.
fn found_parts_draft(parts: &FoundParts, capture: &Capture) -> Result<Draft, EncodeError> {
    let raw = found_parts::encode(parts, &capture.topology);
    let raw =
        raw.ok_or_else(|| EncodeError::Inconsistent("the parts that were found are those of another mesh".into()))?;
    Ok(Draft { kind: SectionKind::FoundParts, ordinal: 0, raw })
}

/// What the page does not need comes behind what it does.
fn add_files(drafts: &mut Vec<Draft>, files: &Files, capture: &Capture) -> Result<(), EncodeError> {
    let file_vertices = &capture.vertex_of_file_vertex;
    if let Some(faces) = &files.faces {
        let wrong = |reason: &str| EncodeError::Inconsistent(format!("the faces of the files {reason}"));
        faces.check(&capture.surface, file_vertices).map_err(wrong)?;
        let raw = files::encode_faces(faces, &capture.surface, file_vertices, capture.topology.vertex_count());
        drafts.push(Draft { kind: SectionKind::FileFaces, ordinal: 0, raw });
    }
    if !files.place.is_plain() {
        drafts.push(Draft { kind: SectionKind::FilePlace, ordinal: 0, raw: files::encode_place(&files.place) });
    }
    Ok(())
}

/// What the first pose is painted with comes right after it; what refines that, or is there to compare with, comes last.
fn add_appearance(
    drafts: &mut Vec<Draft>,
    textures: Textures,
    input: &AppearanceInput,
    capture: &Capture,
) -> Result<AppearanceReport, EncodeError> {
    let coded = appearance::encode(input, capture.timeline.frame_count(), capture.surface.materials.len())?;
    let soon =
        drafts.iter().position(|draft| draft.kind == SectionKind::Geometry).filter(|_| textures == Textures::Aligned);
    let first = soon.map_or(drafts.len(), |first| first + 1);
    drafts.insert(first, Draft { kind: textures.kind(), ordinal: 0, raw: coded.head });
    for (ordinal, raw) in (0..).zip(coded.modes) {
        let place = if ordinal == 0 { first + 1 } else { drafts.len() };
        drafts.insert(place, Draft { kind: textures.modes_kind(), ordinal, raw });
    }
    Ok(coded.report)
}

/// The sections in the order of the file: what draws the first pose, then its images, then the rest of the motion
/// outwards from the first pose, then what leads elsewhere.
fn drafts(input: &BundleInput, meta: &Meta, geometry: Geometry) -> Result<Vec<Draft>, EncodeError> {
    let capture = input.capture;
    let unwritable = |error: postcard::Error| EncodeError::Inconsistent(error.to_string());
    let one = |kind: SectionKind, raw: Vec<u8>| Draft { kind, ordinal: 0, raw };
    let first = meta
        .chunks
        .iter()
        .position(|chunk| (chunk.first_frame..chunk.first_frame + chunk.frame_count).contains(&input.first_frame))
        .unwrap_or(0);
    let mut chunks: Vec<Draft> = (0..)
        .zip(geometry.chunk_bytes)
        .map(|(ordinal, raw)| Draft { kind: SectionKind::Geometry, ordinal, raw })
        .collect();
    chunks.rotate_left(first);
    let mut chunks = chunks.into_iter();

    let mut drafts = vec![
        one(SectionKind::Meta, meta.encode().map_err(unwritable)?),
        one(SectionKind::Surface, surface::encode(&capture.surface, &capture.topology).map_err(unwritable)?),
        one(SectionKind::Model, geometry.model),
    ];
    drafts.extend(chunks.next());
    let images = capture.surface.images.iter();
    drafts.extend((0..).zip(images).map(|(ordinal, image)| Draft {
        kind: SectionKind::Image,
        ordinal,
        raw: image.bytes.clone(),
    }));
    drafts.extend(chunks);
    let graph = graph::encode(input.graph)
        .map_err(|transition| EncodeError::Inconsistent(format!("transition {transition} leads too far away")))?;
    if input.graph.contacts().parts() > 0 {
        let contacts = contacts::encode(input.graph.contacts(), capture.timeline.frame_count());
        let contacts = contacts.ok_or_else(|| EncodeError::Inconsistent("a contact is too far out".into()))?;
        let steers = input.graph.contacts().steers();
        drafts.push(one(if steers { SectionKind::Contacts } else { SectionKind::EarlierContacts }, contacts));
    }
    if input.graph.feet().count() > 0 {
        drafts.push(one(SectionKind::Feet, feet::encode(input.graph.feet(), capture.timeline.frame_count())));
    }
    if !input.graph.ties().all().is_empty() {
        drafts.push(one(SectionKind::Ties, ties::encode(input.graph.ties())));
    }
    if let Some(turns) = turns::encode(input.graph.transitions()) {
        drafts.push(one(SectionKind::Turns, turns));
    }
    drafts.push(one(SectionKind::Graph, graph));
    if let Some(motion) = motion_of(capture).as_ref().and_then(motion::encode) {
        drafts.push(one(SectionKind::Motion, motion));
    }
    if !capture.timeline.families().is_empty() {
        drafts.push(one(SectionKind::Families, families::encode(capture.timeline.families())));
    }
    if let Some(order) = input.poisson_order {
        drafts.push(one(SectionKind::Order, integers::encode(order)));
    }
    if !capture.vertex_of_file_vertex.is_empty() {
        drafts.push(one(SectionKind::FileVertices, integers::encode(&capture.vertex_of_file_vertex)));
    }
    Ok(drafts)
}

/// The capture's motion; `None` where it cannot be measured, which a reader will find out in the same way.
fn motion_of(capture: &Capture) -> Option<Motion> {
    let mut source = Borrowed(capture);
    Motion::measure(&capture.timeline, capture.topology.weights(), &mut source).ok()
}

/// The poses of a capture that is only read.
struct Borrowed<'a>(&'a Capture);

impl PoseSource for Borrowed<'_> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        if frame as usize >= self.0.poses.len() {
            return Err(PoseError::OutOfRange(frame));
        }
        pose.copy_from_slice(self.0.poses.frame(frame));
        Ok(())
    }
}

fn sequences(capture: &Capture) -> Vec<SequenceMeta> {
    let sequences = capture.timeline.sequences().iter();
    sequences
        .map(|sequence| SequenceMeta {
            name: sequence.name.clone(),
            labels: sequence.labels.clone(),
            frame_count: sequence.frame_count,
            cyclic: sequence.cyclic,
        })
        .collect()
}

fn report(header: &Header, frame_count: usize, rms_error: f64, max_error: f64) -> EncodeReport {
    let mut sections = vec![SectionSize { name: "header", stored: header.byte_length() as u64 }];
    for kind in SectionKind::ALL {
        let stored = header.sections.iter().filter(|s| s.kind == Some(kind)).map(|s| s.stored).sum();
        sections.push(SectionSize { name: kind.name(), stored });
    }
    let first = header.sections.iter().find(|section| section.kind == Some(SectionKind::Geometry));
    let geometry: u64 =
        sections.iter().filter(|size| size.name == SectionKind::Geometry.name()).map(|size| size.stored).sum();
    EncodeReport {
        bytes: header.total,
        sections,
        bytes_to_first_pose: first.map_or(0, |section| section.offset + section.stored),
        rms_error,
        max_error,
        bytes_per_frame: geometry as f64 / frame_count.max(1) as f64,
        appearance: None,
    }
}

fn bounds<'a>(poses: impl Iterator<Item = &'a [Vec3]>) -> (Vec3, Vec3) {
    let start = (Vec3::MAX, Vec3::MIN);
    poses.flatten().fold(start, |(low, high), &position| (low.min(position), high.max(position)))
}

/// The error for a capture that is too large for its error bound: it names the vertex that lies farthest out.
fn farthest(capture: &Capture, largest: f32) -> EncodeError {
    for (frame, pose) in (0..).zip(capture.poses.iter()) {
        if let Some(vertex) = pose.iter().position(|position| position.abs().max_element() == largest) {
            return EncodeError::Position { frame, vertex: vertex as u32 };
        }
    }
    EncodeError::Inconsistent("the capture has no frames".into())
}

/// Everything that the format or a reader takes for granted.
fn check(input: &BundleInput) -> Result<(), EncodeError> {
    let (capture, wrong) = (input.capture, |what: &str| Err(EncodeError::Inconsistent(what.into())));
    let frame_count = capture.timeline.frame_count();
    if capture.poses.len() != frame_count as usize || input.graph.frame_count() != frame_count {
        return wrong("poses, timeline and graph have different numbers of frames");
    }
    if input.first_frame >= frame_count {
        return Err(EncodeError::FirstFrame { first_frame: input.first_frame, frame_count });
    }
    if !(input.max_error.is_finite() && input.max_error > 0.0) {
        return Err(EncodeError::MaxError(input.max_error));
    }
    let vertex_count = capture.topology.vertex_count();
    if capture.poses.vertex_count() != vertex_count {
        return wrong("poses and topology have different numbers of vertices");
    }
    check_sizes(input)?;
    check_surface(capture)?;
    for (frame, pose) in (0..).zip(capture.poses.iter()) {
        if let Some(vertex) = pose.iter().position(|position| !position.is_finite()) {
            return Err(EncodeError::Position { frame, vertex: vertex as u32 });
        }
    }
    if input.poisson_order.is_some_and(|order| !is_permutation(order, vertex_count)) {
        return wrong("the elimination order does not name every vertex once");
    }
    if capture.vertex_of_file_vertex.iter().any(|&vertex| vertex as usize >= vertex_count) {
        return wrong("a vertex of the file belongs to no vertex of the topology");
    }
    Ok(())
}

fn check_sizes(input: &BundleInput) -> Result<(), EncodeError> {
    let surface = &input.capture.surface;
    let sizes = [
        ("vertices", input.capture.topology.vertex_count(), MAX_VERTICES),
        ("corners", surface.corners.len(), MAX_CORNERS),
        ("triangles", surface.triangles.len(), MAX_TRIANGLES),
        ("images", surface.images.len(), MAX_IMAGES),
        ("materials", surface.materials.len(), MAX_MATERIALS),
        ("parts", surface.parts.len(), MAX_MATERIALS),
        ("transitions", input.graph.transitions().len(), MAX_TRANSITIONS),
        ("vertices in its files", input.capture.vertex_of_file_vertex.len(), MAX_CORNERS),
    ];
    for (what, count, limit) in sizes {
        if count > limit as usize {
            return Err(EncodeError::TooLarge { what, count: count as u64, limit: u64::from(limit) });
        }
    }
    Ok(())
}

fn check_surface(capture: &Capture) -> Result<(), EncodeError> {
    let (surface, triangles) = (&capture.surface, capture.topology.triangles());
    let wrong = |what: &str| Err(EncodeError::Inconsistent(format!("the surface {what}")));
    if surface.triangles.len() != triangles.len() {
        return wrong("and the topology have different numbers of triangles");
    }
    let mut used = vec![false; surface.corners.len()];
    for (drawn, welded) in surface.triangles.iter().zip(triangles) {
        for (&corner, &vertex) in drawn.iter().zip(welded) {
            if surface.corners.get(corner as usize).is_none_or(|corner| corner.vertex != vertex) {
                return wrong("has a triangle that is not the topology's");
            }
            used[corner as usize] = true;
        }
    }
    if used.contains(&false) {
        return wrong("has a corner that no triangle uses");
    }
    let finite = surface.corners.iter().all(|corner| corner.uv.iter().all(|uv| uv.abs() < 1e30))
        && surface.materials.iter().all(|material| material.base_colour.iter().all(|factor| factor.is_finite()));
    if !finite {
        return wrong("has a texture coordinate or a colour that is not finite");
    }
    surface::check_parts(&surface.parts, &surface.materials, surface.images.len(), triangles.len() as u32)
        .or_else(wrong)
}

pub(super) fn is_permutation(order: &[u32], count: usize) -> bool {
    let mut seen = vec![false; count];
    order.len() == count
        && order.iter().all(|&vertex| seen.get_mut(vertex as usize).is_some_and(|seen| !std::mem::replace(seen, true)))
}
