//! Reading a bundle while it arrives.

use glam::Vec3;

use super::alternatives::Coding as AlternativesCoding;
use super::encode::is_permutation;
use super::error::BundleError;
use super::found_parts::FoundParts;
use super::geometry::decode::{ChunkBytes, FrameDecoder};
use super::geometry::model::Model;
use super::header::{ENTRY_BYTES, FIXED_BYTES, Header, SectionEntry};
use super::kind::SectionKind;
use super::limits::MAX_CORNERS;
use super::meta::Meta;
use super::scanned::{ArrivedScans, ScannedIndex};
use super::sections::{self, SectionInfo};
use super::{
    AlternativesDecoder, Appearance, Textures, appearance, body_parts, contacts, families, feet, files, found_parts,
    graph, integers, layout, learned, motion, rig, surface, ties, turns,
};
use actor::alternatives::Alternatives;
use actor::contacts::{Contacts, Held};
use actor::feet::Feet;
use actor::files::{FileFaces, FilePlace};
use actor::graph::EssentialGraph;
use actor::motion::Motion;
use actor::pose_source::{PoseError, PoseSource};
use actor::surface::{Image, Surface};
use actor::ties::Ties;
use actor::timeline::Timeline;
use editing::{StoredRig, StoredSpace};
use kernels::topology::Topology;

/// A bundle, or as much of it as has arrived.
///
/// Bytes are pushed as they come; each part can be asked for as soon as it is complete and has been checked. Positions
/// stay compressed: [`PoseSource::read`] decodes a frame when it is wanted.
#[derive(Debug, Default)]
pub struct BundleReader {
    /// Bytes of the header, or of the section that is arriving.
    arriving: Vec<u8>,
    /// Sections that are complete.
    complete: usize,
    received: u64,
    /// Bytes of a section that this version does not know and that are still to come.
    to_skip: u64,
    failure: Option<BundleError>,
    header: Option<Header>,
    meta: Option<Meta>,
    timeline: Option<Timeline>,
    topology: Option<Topology>,
    surface: Option<Surface>,
    image_arrived: Vec<bool>,
    model: Option<Model>,
    chunks: Vec<Option<ChunkBytes>>,
    decoder: Option<FrameDecoder>,
    first_pose: Option<Vec<Vec3>>,
    graph: Option<EssentialGraph>,
    order: Option<Vec<u32>>,
    file_vertices: Option<Vec<u32>>,
    /// The section as it is: only exports want it.
    file_faces: Option<Vec<u8>>,
    file_place: FilePlace,
    /// The section as it is: the page hands it on.
    rig: Option<Vec<u8>>,
    /// The section as it is: the page hands it on.
    learned: Option<Vec<u8>>,
    /// The section as it is: it is read in pieces.
    alternatives: Option<(Vec<u8>, AlternativesCoding)>,
    /// The sections as they are: read when they are asked for.
    body_parts: Option<Vec<u8>>,
    found_parts: Option<Vec<u8>>,
    /// The section as it is: the page reads it by itself.
    families: Option<Vec<u8>>,
    motion: Option<Motion>,
    contacts: Contacts,
    feet: Feet,
    ties: Ties,
    turns: Vec<f32>,
    looks: [ArrivedTextures; 2],
    scanned: ArrivedScans,
}

/// Models of textures that have arrived.
#[derive(Debug, Default)]
struct ArrivedTextures {
    appearance: Option<Appearance>,
    modes: Vec<Option<Vec<u8>>>,
}

impl BundleReader {
    /// Nothing has arrived yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A whole bundle.
    ///
    /// # Errors
    /// Anything that is wrong with it.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, BundleError> {
        let mut reader = Self::new();
        reader.push(bytes)?;
        reader.finish()?;
        Ok(reader)
    }

    /// Takes the next bytes, any number of them.
    ///
    /// # Errors
    /// The first thing that is wrong, and the same again from then on.
    pub fn push(&mut self, bytes: &[u8]) -> Result<(), BundleError> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        self.received += bytes.len() as u64;
        let result = self.take(bytes);
        if let Err(failure) = &result {
            self.failure = Some(failure.clone());
            self.arriving = Vec::new();
        }
        result
    }

    /// Says that no more bytes will come.
    ///
    /// # Errors
    /// What was wrong before, or that the bundle is cut off.
    pub fn finish(&self) -> Result<(), BundleError> {
        match &self.failure {
            Some(failure) => Err(failure.clone()),
            None if self.is_complete() => Ok(()),
            None => Err(BundleError::Truncated { received: self.received, total: self.bytes_total().unwrap_or(0) }),
        }
    }

    /// Whether everything has arrived.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.header.as_ref().is_some_and(|header| self.complete == header.sections.len())
    }

    /// Whether everything has arrived but the groups of scanned frames, which lie behind all else.
    #[must_use]
    pub fn is_playable(&self) -> bool {
        self.header.as_ref().is_some_and(|header| {
            self.complete + layout::count(header, SectionKind::ScannedGroup) >= header.sections.len()
        })
    }

    /// Which frames there are as they were scanned; `None` also where the bundle has none.
    #[must_use]
    pub fn scanned(&self) -> Option<&ScannedIndex> {
        self.scanned.index.as_ref()
    }

    /// The section of group `ordinal` of scanned frames, once it has arrived.
    #[must_use]
    pub fn scanned_group(&self, ordinal: u32) -> Option<&[u8]> {
        self.scanned.group(ordinal)
    }

    /// The section of group `ordinal` from `bytes`, which were fetched by themselves.
    ///
    /// # Errors
    /// They are not those that the header tells of.
    pub fn check_scanned_group<'a>(&self, ordinal: u32, bytes: &'a [u8]) -> Result<&'a [u8], BundleError> {
        let entry = self.header.as_ref().and_then(|header| header.scanned_entry(ordinal));
        let entry = entry.ok_or_else(|| BundleError::header("has no such group of scanned frames"))?;
        sections::check(entry, bytes)?;
        Ok(bytes)
    }

    /// Bytes that have arrived.
    #[must_use]
    pub fn bytes_received(&self) -> u64 {
        self.received
    }

    /// Bytes of the whole bundle, once its header has arrived.
    #[must_use]
    pub fn bytes_total(&self) -> Option<u64> {
        self.header.as_ref().map(|header| header.total)
    }

    /// The header.
    #[must_use]
    pub fn header(&self) -> Option<&Header> {
        self.header.as_ref()
    }

    /// The sections, arrived or not, in the order of the file.
    #[must_use]
    pub fn sections(&self) -> Vec<SectionInfo> {
        self.header.iter().flat_map(|header| header.sections.iter().map(SectionInfo::from)).collect()
    }

    /// Names and counts.
    #[must_use]
    pub fn meta(&self) -> Option<&Meta> {
        self.meta.as_ref()
    }

    /// The sequences.
    #[must_use]
    pub fn timeline(&self) -> Option<&Timeline> {
        self.timeline.as_ref()
    }

    /// The welded connectivity.
    #[must_use]
    pub fn topology(&self) -> Option<&Topology> {
        self.topology.as_ref()
    }

    /// What is drawn. Its images have no bytes until they arrive: see [`Self::image`].
    #[must_use]
    pub fn surface(&self) -> Option<&Surface> {
        self.surface.as_ref()
    }

    /// An image, once its bytes have arrived.
    #[must_use]
    pub fn image(&self, index: usize) -> Option<&Image> {
        let arrived = self.image_arrived.get(index).copied().unwrap_or(false);
        self.surface.as_ref()?.images.get(index).filter(|_| arrived)
    }

    /// Vertex positions in metres of the frame that is drawn first.
    #[must_use]
    pub fn first_pose(&self) -> Option<&[Vec3]> {
        self.first_pose.as_deref()
    }

    /// The essential graph.
    #[must_use]
    pub fn graph(&self) -> Option<&EssentialGraph> {
        self.graph.as_ref()
    }

    /// The fill-reducing elimination order of the vertices; `None` also where the bundle has none.
    #[must_use]
    pub fn order(&self) -> Option<&[u32]> {
        self.order.as_deref()
    }

    /// The welded vertex of each vertex of the input files; `None` also where the bundle does not say.
    #[must_use]
    pub fn file_vertices(&self) -> Option<&[u32]> {
        self.file_vertices.as_deref()
    }

    /// The faces of the input files; `None` also where they are the triangles of the drawn mesh, as far as the bundle says.
    ///
    /// # Errors
    /// A section that does not hold faces of this surface.
    pub fn file_faces(&self) -> Result<Option<FileFaces>, BundleError> {
        let (Some(bytes), Some(surface), Some(topology)) = (&self.file_faces, &self.surface, &self.topology) else {
            return Ok(None);
        };
        let vertex_count = topology.vertex_count();
        let every: Vec<u32>;
        let file_vertices = match &self.file_vertices {
            Some(file_vertices) => file_vertices,
            None => {
                every = (0..vertex_count as u32).collect();
                &every
            }
        };
        let faces = files::decode_faces(bytes, surface, file_vertices, vertex_count);
        faces.map(Some).map_err(|reason| BundleError::section(SectionKind::FileFaces, reason))
    }

    /// The place, the unit and the axes of the input files; those of the capture where the bundle does not say.
    #[must_use]
    pub fn file_place(&self) -> FilePlace {
        self.file_place
    }

    /// The section of the rig, for [`super::decode_rig`]; `None` also where the bundle has none.
    #[must_use]
    pub fn rig_bytes(&self) -> Option<&[u8]> {
        self.rig.as_deref()
    }

    /// Bones, joints and weights, by which edits move the body; `None` also where the bundle has none.
    ///
    /// # Errors
    /// A section that does not hold a rig of this mesh.
    pub fn rig(&self) -> Result<Option<StoredRig>, BundleError> {
        let (Some(bytes), Some(topology), Some(timeline)) = (&self.rig, &self.topology, &self.timeline) else {
            return Ok(None);
        };
        let stored = rig::decode(bytes, topology.vertex_count(), timeline.frame_count());
        stored.map(Some).map_err(|reason| BundleError::section(SectionKind::Rig, reason))
    }

    /// The section of the learned space, for [`super::decode_learned_space`]; `None` also where the bundle has none.
    #[must_use]
    pub fn learned_bytes(&self) -> Option<&[u8]> {
        self.learned.as_deref()
    }

    /// The ways in which the actor was seen to move; `None` also where the bundle has none.
    ///
    /// # Errors
    /// A section that does not hold a space of this capture.
    pub fn learned(&self) -> Result<Option<StoredSpace>, BundleError> {
        let (Some(bytes), Some(timeline)) = (&self.learned, &self.timeline) else { return Ok(None) };
        let stored = learned::decode(bytes, timeline.frame_count());
        stored.map(Some).map_err(|reason| BundleError::section(SectionKind::LearnedSpace, reason))
    }

    /// The number of the part of the body that each vertex belongs to, as it was painted; `None` also where the bundle does not say.
    ///
    /// # Errors
    /// A section that does not hold parts of this mesh.
    pub fn body_parts(&self) -> Result<Option<Vec<u8>>, BundleError> {
        let (Some(bytes), Some(topology)) = (&self.body_parts, &self.topology) else { return Ok(None) };
        let parts = body_parts::decode(bytes, topology);
        parts.map(Some).map_err(|reason| BundleError::section(SectionKind::BodyParts, reason))
    }

    /// The parts of the body that were found, where the bundle says; `None` also where it does not.
    ///
    /// # Errors
    /// A section that does not hold parts of this mesh.
    pub fn found_parts(&self) -> Result<Option<FoundParts>, BundleError> {
        let (Some(bytes), Some(topology)) = (&self.found_parts, &self.topology) else { return Ok(None) };
        let parts = found_parts::decode(bytes, topology);
        parts.map(Some).map_err(|reason| BundleError::section(SectionKind::FoundParts, reason))
    }

    /// The section of families as it is, for whoever reads it elsewhere; `None` also where the bundle has none.
    #[must_use]
    pub fn families_bytes(&self) -> Option<&[u8]> {
        self.families.as_deref()
    }

    /// The sequences with their families; `None` where they have not arrived.
    ///
    /// # Errors
    /// A section of families that does not hold families of these sequences.
    pub fn timeline_with_families(&self) -> Result<Option<Timeline>, BundleError> {
        let Some(timeline) = self.timeline().cloned() else { return Ok(None) };
        let Some(bytes) = &self.families else { return Ok(Some(timeline)) };
        families::decode(bytes, timeline)
            .map(Some)
            .map_err(|reason| BundleError::section(SectionKind::Families, reason))
    }

    /// A reader of the alternatives of recorded stretches; `None` also where the bundle has none, or they were taken before.
    ///
    /// # Errors
    /// A section that does not hold any.
    pub fn take_alternatives(&mut self) -> Result<Option<AlternativesDecoder>, BundleError> {
        let (Some(topology), Some(timeline)) = (&self.topology, &self.timeline) else { return Ok(None) };
        let Some((bytes, coding)) = self.alternatives.take() else { return Ok(None) };
        let decoder = AlternativesDecoder::new(bytes, coding, topology, timeline);
        decoder.map(Some).map_err(|reason| BundleError::section(SectionKind::Alternatives, reason))
    }

    /// All of them at once; `None` also where there are none.
    ///
    /// # Errors
    /// A section that is damaged.
    pub fn read_alternatives(&mut self) -> Result<Option<Alternatives>, BundleError> {
        let Some(mut decoder) = self.take_alternatives()? else { return Ok(None) };
        loop {
            let read = decoder.advance().map_err(|reason| BundleError::section(SectionKind::Alternatives, reason))?;
            if read.is_some() {
                return Ok(read);
            }
        }
    }

    /// Where the actor is and which way it faces in every frame; `None` also where the bundle does not say. Then
    /// [`actor::motion::MotionMeter`] measures it.
    #[must_use]
    pub fn motion(&self) -> Option<&Motion> {
        self.motion.as_ref()
    }

    /// What the textures of all frames share; `None` also where the bundle has none.
    #[must_use]
    pub fn appearance(&self) -> Option<&Appearance> {
        self.appearance_of(Textures::Aligned)
    }

    /// The same for the textures as they were captured, where the bundle has these models to compare with.
    #[must_use]
    pub fn appearance_of(&self, textures: Textures) -> Option<&Appearance> {
        self.looks[textures as usize].appearance.as_ref()
    }

    /// Bytes of section `ordinal` of the modes, for a [`super::ModeDecoder`], once they have arrived.
    #[must_use]
    pub fn mode_bytes(&self, ordinal: u32) -> Option<&[u8]> {
        self.mode_bytes_of(Textures::Aligned, ordinal)
    }

    /// As [`Self::mode_bytes`], of either models.
    #[must_use]
    pub fn mode_bytes_of(&self, textures: Textures, ordinal: u32) -> Option<&[u8]> {
        self.looks[textures as usize].modes.get(ordinal as usize)?.as_deref()
    }

    /// Whether the positions of `frame` have arrived.
    #[must_use]
    pub fn frame_loaded(&self, frame: u32) -> bool {
        self.locate(frame).is_some_and(|(chunk, _)| self.chunks[chunk].is_some())
    }

    fn take(&mut self, mut bytes: &[u8]) -> Result<(), BundleError> {
        loop {
            let skipped = self.to_skip.min(bytes.len() as u64);
            self.to_skip -= skipped;
            bytes = &bytes[skipped as usize..];
            if self.to_skip > 0 {
                return Ok(());
            }
            let wanted = self.wanted();
            if self.is_complete() {
                let rest =
                    if bytes.is_empty() { Ok(()) } else { Err(BundleError::header("is followed by too many bytes")) };
                return rest;
            }
            let taken = wanted.saturating_sub(self.arriving.len()).min(bytes.len());
            let (now, later) = bytes.split_at(taken);
            self.arriving.extend_from_slice(now);
            bytes = later;
            let Some(header) = &self.header else {
                self.try_header()?;
                if self.header.is_none() && bytes.is_empty() {
                    return Ok(());
                }
                continue;
            };
            if self.arriving.len() < wanted {
                return Ok(());
            }
            let entry = header.sections[self.complete];
            let stored = std::mem::take(&mut self.arriving);
            if let Some(kind) = entry.kind {
                let raw = sections::open(&entry, stored)?;
                self.accept(kind, &entry, raw)?;
            }
            self.next_section();
        }
    }

    /// Bytes that `arriving` must hold before it can be read.
    fn wanted(&self) -> usize {
        match &self.header {
            Some(header) => header.sections.get(self.complete).map_or(0, |entry| match entry.kind {
                Some(_) => entry.stored as usize,
                None => 0,
            }),
            None => match self.arriving.get(16..20).and_then(|bytes| bytes.first_chunk::<4>()) {
                // The count has been checked before more than the fixed part is asked for.
                Some(count) if self.arriving.len() >= FIXED_BYTES => {
                    FIXED_BYTES + ENTRY_BYTES * u32::from_le_bytes(*count) as usize
                }
                _ => FIXED_BYTES,
            },
        }
    }

    fn try_header(&mut self) -> Result<(), BundleError> {
        if let Some(header) = Header::parse(&self.arriving)? {
            layout::check_order(&header)?;
            self.arriving = Vec::new();
            self.header = Some(header);
            self.begin_section();
        }
        Ok(())
    }

    fn next_section(&mut self) {
        self.complete += 1;
        self.begin_section();
    }

    /// Sections of unknown kinds are passed over without being kept.
    fn begin_section(&mut self) {
        let entry = self.header.as_ref().and_then(|header| header.sections.get(self.complete));
        if let Some(entry) = entry.filter(|entry| entry.kind.is_none()) {
            self.to_skip = entry.stored;
        }
    }

    fn accept(&mut self, kind: SectionKind, entry: &SectionEntry, raw: Vec<u8>) -> Result<(), BundleError> {
        let wrong = |reason: &str| BundleError::Inconsistent {
            kind: Some(kind),
            ordinal: entry.ordinal,
            reason: reason.into(),
        };
        if kind == SectionKind::Meta {
            return self.accept_meta(&raw);
        }
        // The order of sections was checked with the header: what a section needs is there.
        let (Some(meta), Some(timeline)) = (&self.meta, &self.timeline) else { return Err(wrong("came too early")) };
        if kind == SectionKind::Surface {
            let (topology, surface) = surface::decode(&raw, meta)?;
            self.image_arrived = vec![false; surface.images.len()];
            (self.topology, self.surface) = (Some(topology), Some(surface));
            return Ok(());
        }
        if kind == SectionKind::Graph {
            let graph = graph::decode(&raw, meta.transition_count, timeline)?;
            let (contacts, feet) = (std::mem::take(&mut self.contacts), std::mem::take(&mut self.feet));
            let ties = std::mem::take(&mut self.ties);
            let graph = graph.with_contacts(contacts).with_feet(feet).with_ties(ties);
            self.graph = Some(graph.with_turns(&std::mem::take(&mut self.turns)));
            return Ok(());
        }
        if matches!(kind, SectionKind::Contacts | SectionKind::EarlierContacts) {
            let held = if kind == SectionKind::Contacts { Held::WhatCannotStep } else { Held::Alike };
            let contacts = contacts::decode(&raw, timeline).map_err(wrong)?.held(held);
            match self.graph.take() {
                Some(graph) => self.graph = Some(graph.with_contacts(contacts)),
                None => self.contacts = contacts,
            }
            return Ok(());
        }
        if kind == SectionKind::Feet {
            let feet = feet::decode(&raw, meta.vertex_count, timeline).map_err(wrong)?;
            match self.graph.take() {
                Some(graph) => self.graph = Some(graph.with_feet(feet)),
                None => self.feet = feet,
            }
            return Ok(());
        }
        if kind == SectionKind::Turns {
            let turns = turns::decode(&raw, meta.transition_count).map_err(wrong)?;
            match self.graph.take() {
                Some(graph) => self.graph = Some(graph.with_turns(&turns)),
                None => self.turns = turns,
            }
            return Ok(());
        }
        if kind == SectionKind::FilePlace {
            self.file_place = files::decode_place(&raw).map_err(wrong)?;
            return Ok(());
        }
        if kind == SectionKind::Motion {
            self.motion = Some(motion::decode(&raw, timeline).map_err(wrong)?);
            return Ok(());
        }
        let Some(topology) = &self.topology else { return Err(wrong("came too early")) };
        let (ordinal, looks) = (entry.ordinal as usize, Textures::of(kind));
        match kind {
            SectionKind::Model => {
                let model = Model::decode(&raw, topology, meta.group > 1).map_err(wrong)?;
                self.decoder = Some(FrameDecoder::new(meta.group, meta.step));
                self.model = Some(model);
            }
            SectionKind::Geometry => {
                let frame_count = meta.chunks.get(ordinal).map_or(0, |chunk| chunk.frame_count);
                let chunk = ChunkBytes::new(raw, frame_count).map_err(wrong)?;
                *self.chunks.get_mut(ordinal).ok_or_else(|| wrong("is not declared"))? = Some(chunk);
                self.accept_first_pose(ordinal).map_err(|_| wrong("does not hold its frames"))?;
            }
            SectionKind::Image => {
                let image = self.surface.as_mut().and_then(|surface| surface.images.get_mut(ordinal));
                image.ok_or_else(|| wrong("is not declared"))?.bytes = raw;
                self.image_arrived[ordinal] = true;
            }
            SectionKind::Order => {
                let order = integers::decode(&raw, meta.vertex_count, meta.vertex_count).map_err(wrong)?;
                if !is_permutation(&order, topology.vertex_count()) {
                    return Err(wrong("does not name every vertex once"));
                }
                self.order = Some(order);
            }
            SectionKind::FileVertices => {
                self.file_vertices = Some(integers::decode(&raw, MAX_CORNERS, meta.vertex_count).map_err(wrong)?);
            }
            SectionKind::Ties => {
                let ties = ties::decode(&raw, topology).map_err(wrong)?;
                match self.graph.take() {
                    Some(graph) => self.graph = Some(graph.with_ties(ties)),
                    None => self.ties = ties,
                }
            }
            SectionKind::FileFaces => self.file_faces = Some(raw),
            SectionKind::Rig => self.rig = Some(raw),
            SectionKind::LearnedSpace => self.learned = Some(raw),
            SectionKind::EarlierAlternatives => {
                self.alternatives.get_or_insert((raw, AlternativesCoding::Earlier));
            }
            SectionKind::Alternatives => self.alternatives = Some((raw, AlternativesCoding::Later)),
            SectionKind::BodyParts => self.body_parts = Some(raw),
            SectionKind::FoundParts => self.found_parts = Some(raw),
            SectionKind::Families => self.families = Some(raw),
            SectionKind::Scanned | SectionKind::ScannedGroup => {
                self.scanned.take((kind, entry.ordinal), raw, timeline, self.header.as_ref()).map_err(wrong)?;
            }
            SectionKind::EarlierAppearance
            | SectionKind::EarlierNaive
            | SectionKind::Appearance
            | SectionKind::Naive => {
                let (coding, modes) = appearance::Coding::of(kind);
                let materials = self.surface.as_ref().map_or(0, |surface| surface.materials.len());
                let appearance =
                    appearance::decode::head(&raw, coding, timeline.frame_count(), materials).map_err(wrong)?;
                let count = self.header.as_ref().map_or(0, |header| layout::count(header, modes));
                if count != appearance.section_count() as usize {
                    return Err(wrong("declares another number of modes than there are"));
                }
                self.looks[looks as usize] = ArrivedTextures { appearance: Some(appearance), modes: vec![None; count] };
            }
            SectionKind::EarlierMode
            | SectionKind::EarlierNaiveMode
            | SectionKind::AppearanceMode
            | SectionKind::NaiveMode => {
                let mode = self.looks[looks as usize].modes.get_mut(ordinal);
                *mode.ok_or_else(|| wrong("is not declared"))? = Some(raw);
            }
            SectionKind::Meta
            | SectionKind::Surface
            | SectionKind::Graph
            | SectionKind::Motion
            | SectionKind::Contacts
            | SectionKind::EarlierContacts
            | SectionKind::Feet
            | SectionKind::Turns
            | SectionKind::FilePlace => {}
        }
        Ok(())
    }

    fn accept_meta(&mut self, raw: &[u8]) -> Result<(), BundleError> {
        let (meta, timeline) = Meta::decode(raw)?;
        if let Some(header) = &self.header {
            layout::check_counts(header, &meta)?;
        }
        self.chunks = meta.chunks.iter().map(|_| None).collect();
        (self.meta, self.timeline) = (Some(meta), Some(timeline));
        Ok(())
    }

    fn accept_first_pose(&mut self, arrived: usize) -> Result<(), PoseError> {
        let (Some(meta), Some(topology)) = (&self.meta, &self.topology) else { return Ok(()) };
        let first = meta.first_frame;
        if self.locate(first).is_some_and(|(chunk, _)| chunk == arrived) {
            let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
            self.read(first, &mut pose)?;
            self.first_pose = Some(pose);
        }
        Ok(())
    }

    /// The chunk that holds `frame`, and which of its frames that is.
    fn locate(&self, frame: u32) -> Option<(usize, u32)> {
        let chunks = &self.meta.as_ref()?.chunks;
        let after = chunks.partition_point(|chunk| chunk.first_frame <= frame);
        let chunk = chunks.get(after.checked_sub(1)?)?;
        let local = frame - chunk.first_frame;
        (local < chunk.frame_count).then_some((after - 1, local))
    }
}

impl PoseSource for BundleReader {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        if self.meta.is_none() {
            return Err(PoseError::NotLoaded(frame));
        }
        let (index, local) = self.locate(frame).ok_or(PoseError::OutOfRange(frame))?;
        let (Some(model), Some(decoder), Some(chunk)) = (&self.model, &mut self.decoder, &self.chunks[index]) else {
            return Err(PoseError::NotLoaded(frame));
        };
        decoder.read(model, index, chunk, local, pose).map_err(|_| PoseError::Damaged(frame))
    }
}
