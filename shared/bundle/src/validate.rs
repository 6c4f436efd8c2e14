//! Saying what is wrong with a bundle, with codes that stay the same: they are listed in `docs/bundle-format.md`.

use glam::Vec3;

use super::appearance::{ModeDecoder, Textures};
use super::error::BundleError;
use super::kind::{SectionKind, VERSION_MINOR};
use super::reader::BundleReader;
use actor::pose_source::PoseSource;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// The bundle plays, but not as it should.
    Warning,
    /// The bundle, or a part of it, cannot be used.
    Error,
}

/// Something that [`validate`] found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// A code that stays the same, for programs.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// A sentence for people.
    pub message: String,
}

impl Finding {
    fn new(code: &'static str, severity: Severity, message: String) -> Self {
        Self { code, severity, message }
    }
}

impl From<&BundleError> for Finding {
    fn from(error: &BundleError) -> Self {
        let code = match error {
            BundleError::NotOurs => "not-reprise",
            BundleError::TooNew { .. } => "too-new",
            BundleError::UnknownSection { .. } => "unknown-section",
            BundleError::Damaged { .. } => "damaged",
            BundleError::Truncated { .. } => "truncated",
            BundleError::Inconsistent { .. } => "inconsistent",
        };
        Self::new(code, Severity::Error, error.to_string())
    }
}

/// Reads all of `bytes`, every frame included, and says what is wrong; nothing, if nothing is.
#[must_use]
pub fn validate(bytes: &[u8]) -> Vec<Finding> {
    let mut reader = match BundleReader::from_bytes(bytes) {
        Ok(reader) => reader,
        Err(error) => return vec![Finding::from(&error)],
    };
    let mut findings = header_findings(&reader);
    findings.extend(frame_findings(&mut reader));
    findings.extend(graph_findings(&reader));
    findings.extend(appearance_findings(&reader));
    findings.extend(file_findings(&reader));
    findings.extend(rig_findings(&mut reader));
    findings.extend(learned_findings(&reader));
    findings.extend(scanned_findings(&reader));
    let families = reader.timeline_with_families().err();
    let parts = reader.body_parts().err().or(reader.found_parts().err());
    let damaged = [parts, families, reader.read_alternatives().err()].into_iter().flatten();
    findings.extend(damaged.map(|error| Finding::new("inconsistent", Severity::Error, error.to_string())));
    findings
}

fn header_findings(reader: &BundleReader) -> Vec<Finding> {
    let mut findings = Vec::new();
    if let Some(header) = reader.header().filter(|header| header.minor > VERSION_MINOR) {
        let message = format!("the bundle has minor version {}, this program knows {VERSION_MINOR}", header.minor);
        findings.push(Finding::new("later-minor-version", Severity::Note, message));
    }
    for section in reader.sections().iter().filter(|section| section.name == "unknown") {
        let message = format!("a section of kind {} is not known here and was skipped", section.number);
        findings.push(Finding::new("skipped-section", Severity::Note, message));
    }
    findings
}

fn frame_findings(reader: &mut BundleReader) -> Vec<Finding> {
    let Some(meta) = reader.meta().cloned() else { return Vec::new() };
    let (lowest, highest) = meta.bounds();
    let slack = Vec3::splat(meta.max_error * 1.01);
    let mut pose = vec![Vec3::ZERO; meta.vertex_count as usize];
    let (mut findings, mut outside) = (Vec::new(), 0);
    for frame in 0..reader.timeline().map_or(0, |timeline| timeline.frame_count()) {
        match reader.read(frame, &mut pose) {
            Err(error) => findings.push(Finding::new("damaged-frame", Severity::Error, error.to_string())),
            Ok(()) => {
                let inside = |p: &Vec3| p.cmpge(lowest - slack).all() && p.cmple(highest + slack).all();
                outside += u32::from(!pose.iter().all(inside));
            }
        }
    }
    if outside > 0 {
        let message = format!("{outside} frames leave the box that the bundle declares");
        findings.push(Finding::new("outside-bounds", Severity::Warning, message));
    }
    findings
}

fn graph_findings(reader: &BundleReader) -> Vec<Finding> {
    let mut findings = Vec::new();
    if reader.graph().is_some_and(|graph| graph.transitions().is_empty()) {
        let message = "the graph has no transitions: the actor cannot leave a sequence".into();
        findings.push(Finding::new("no-transitions", Severity::Warning, message));
    }
    if reader.order().is_none() {
        let message = "there is no elimination order: the player has to find one by itself".into();
        findings.push(Finding::new("no-order", Severity::Note, message));
    }
    findings
}

fn file_findings(reader: &BundleReader) -> Option<Finding> {
    let error = reader.file_faces().err()?;
    Some(Finding::new("inconsistent", Severity::Error, error.to_string()))
}

/// Groups of scanned frames that cannot be read.
fn scanned_findings(reader: &BundleReader) -> Vec<Finding> {
    let Some(index) = reader.scanned() else { return Vec::new() };
    let wrong = |ordinal: u32| {
        let reason = index.read(ordinal, reader.scanned_group(ordinal)?).err()?;
        let kind = Some(SectionKind::ScannedGroup);
        let error = BundleError::Inconsistent { kind, ordinal, reason: reason.into() };
        Some(Finding::new("damaged-scan", Severity::Error, error.to_string()))
    };
    (0..index.groups.len() as u32).filter_map(wrong).collect()
}

fn rig_findings(reader: &mut BundleReader) -> Option<Finding> {
    let wrong = |reason: String| Some(Finding::new("inconsistent", Severity::Error, reason));
    let stored = match reader.rig() {
        Ok(stored) => stored?,
        Err(error) => return wrong(error.to_string()),
    };
    let mut rest = vec![Vec3::ZERO; reader.meta()?.vertex_count as usize];
    // A frame that cannot be read was found before.
    reader.read(stored.rest_frame, &mut rest).ok()?;
    let error = stored.rig(rest).err()?;
    wrong(BundleError::section(SectionKind::Rig, error.to_string()).to_string())
}

fn learned_findings(reader: &BundleReader) -> Option<Finding> {
    let error = reader.learned().err()?;
    Some(Finding::new("inconsistent", Severity::Error, error.to_string()))
}

fn appearance_findings(reader: &BundleReader) -> Vec<Finding> {
    let both = [Textures::Aligned, Textures::Naive].into_iter();
    both.flat_map(|textures| mode_findings(reader, textures)).collect()
}

fn mode_findings(reader: &BundleReader, textures: Textures) -> Vec<Finding> {
    let Some(appearance) = reader.appearance_of(textures) else { return Vec::new() };
    let mut decoder = ModeDecoder::default();
    let mut error_of = |ordinal: u32| {
        let (layer, _) = appearance.place(ordinal)?;
        let bytes = reader.mode_bytes_of(textures, ordinal)?;
        let error = decoder.advance(bytes, appearance, layer, usize::MAX).err()?;
        let message = format!("section {} {ordinal} {error}", textures.modes_kind().name());
        Some(Finding::new("damaged-mode", Severity::Error, message))
    };
    // Modes are read one after the other: what follows a damaged one cannot be told.
    (0..appearance.section_count()).find_map(&mut error_of).into_iter().collect()
}
