//! `builder register`: a scan, of which every frame has its own mesh, becomes a capture of one mesh and one atlas.
//!
//! ```text
//! Scans -> survey -> tree, template -> register -> unite -> Writer -> a folder that import reads
//!                                        |           '-> frames on a template of their own -> a folder beside
//!                                        '-> projection of textures
//! ```

use std::path::Path;
use std::time::Instant;

use capture_io::import::{ScannedTexture, Scans, scans};
use job::Job;
use registration::cut::Group;
use registration::register::{Found, Survey, register as register_frames, survey, template};
use registration::tree::Tree;
use registration::unite::unite;
use registration::written::write;

use super::scan_others::{joined, others, told_of_others};
pub use super::scan_report::{FrameReport, LostReport, OtherReport, RegisterReport};
pub(crate) use super::scan_source::Frames;
use super::scan_source::first_of;
pub use super::scan_source::{OtherCaptures, RegisterError, ScanOptions};
pub use super::scan_truth::{TruthError, TruthReport};
pub(crate) use super::scan_warnings::{check_lost, lost_reports, told_of_frames};
use super::scan_warnings::{colourless, parts, told_of_registered, told_of_templates};
use super::scan_writer::Writer;

/// Registers the scan that `inputs` name, and writes it as the folder `out`. Frames that cannot be brought onto the one mesh, but onto
/// another, are written as the options say.
///
/// # Errors
/// Scans that cannot be read, or of which most cannot be brought onto one mesh; a folder that cannot be written. Nothing is
/// half-written.
pub fn register(
    inputs: &[String],
    options: &ScanOptions,
    out: &Path,
    job: &Job,
) -> Result<RegisterReport, RegisterError> {
    let mut scans = scans(inputs, &options.import)?;
    let mut warnings = std::mem::take(&mut scans.warnings);
    let source = Frames(&scans);
    let start = Instant::now();
    let survey = survey(&source, &options.register, job)?;
    let tree = tree(&scans, &survey, options)?;
    let root = survey.frames[tree.root];
    let template = template(&source, root)?.ok_or(RegisterError::Nothing(scans.frame_count()))?;
    let compared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let writer = Writer::new(&scans, &template, root, out, options)?;
    let emit = |found: Found<Option<ScannedTexture>>| writer.take(found);
    let registered = register_frames(&source, &survey, &tree, &template, &options.register, job, &emit)?;
    let united = unite(&source, &survey, Group { template, root, registered }, &options.register, job)?;
    let main = &united.main;
    let (sequences, alone) = parts(&scans, &main.registered);
    check_lost(&scans, &main.registered.lost, alone.len(), main.root)?;
    let writer = settled(writer, root, (&source, main), (options, out), job)?;
    let others = others(&source, &united.others, (options, out), job)?;
    warnings.extend(told_of_frames(&scans, &survey, main.root, &main.registered.lost));
    warnings.extend(told_of_templates(&scans, std::iter::once(main).chain(&united.others)));
    warnings.extend(writer.is_colourless().then(colourless));
    warnings.extend(joined(&scans, main, root));
    warnings.extend(told_of_others(&scans, main.root, &others));
    warnings.extend(told_of_registered(&scans, &main.registered, &alone));
    let written =
        sequences.iter().flat_map(|s| (s.frames.0..=s.frames.1).map(|frame| first_of(&scans, s.number) + frame));
    let written = written.collect();
    let named = sequences.iter().map(|s| (s.name.clone(), s.frames.1 - s.frames.0 + 1)).collect();
    let (texture_size, frames) = (writer.texture_size(), writer.frames(&main.registered));
    let manifest = writer.finish(sequences)?;
    let count = survey.frames.len();
    Ok(RegisterReport {
        manifest,
        name: scans.name.clone(),
        frames: scans.frame_count(),
        template: main.root,
        vertices: main.template.surface.mesh.positions.len(),
        triangles: main.template.surface.mesh.triangles.len(),
        meshes: survey.groups.iter().max().map_or(0, |last| last + 1),
        texture_size,
        sequences: named,
        registered: frames,
        lost: lost_reports(&scans, &main.registered.lost),
        others,
        written,
        dissimilarity: (0..count * count).map(|k| survey.dissimilarity.get(k / count, k % count)).collect(),
        compared: survey.frames,
        warnings,
        seconds: [compared, start.elapsed().as_secs_f64()],
    })
}

/// `writer`, which has the frames that were tracked from its template, the frame `root`, with those that were joined later; or
/// another one with all of them, where another template took its place.
fn settled<'a>(
    writer: Writer<'a>,
    root: usize,
    (source, main): (&Frames<'a>, &Group),
    (options, out): (&ScanOptions, &Path),
    job: &Job,
) -> Result<Writer<'a>, RegisterError> {
    let writer = if main.root == root {
        writer
    } else {
        drop(writer);
        Writer::new(source.0, &main.template, main.root, out, options)?
    };
    let through = |frame: usize| main.registered.tracked.iter().any(|t| t.frame == frame && t.through.is_some());
    let emit = |found: Found<Option<ScannedTexture>>| writer.take(found);
    write(source, main, |frame| main.root != root || through(frame), &options.register, job, &emit)?;
    Ok(writer)
}

pub(crate) fn tree(scans: &Scans, survey: &Survey, options: &ScanOptions) -> Result<Tree, RegisterError> {
    if survey.frames.is_empty() {
        return Err(RegisterError::Nothing(scans.frame_count()));
    }
    let last = scans.frame_count() - 1;
    if let Some(wanted) = options.register.template.filter(|wanted| !survey.frames.contains(wanted)) {
        let lost = survey.lost.iter().find(|(frame, _)| *frame == wanted);
        let reason = lost.map_or_else(|| "there is no such frame".into(), |(_, why)| why.to_string());
        return Err(RegisterError::Template { wanted, reason, last });
    }
    Ok(survey.tree(options.register.template))
}
