//! Frames that could not be brought onto the one mesh: joined through another template, or a capture of their own beside.

use std::path::{Path, PathBuf};

use capture_io::import::{ScannedTexture, Scans, Warning};
use job::Job;
use registration::cut::Group;
use registration::register::Found;
use registration::written::write;

use super::scan_report::{FrameReport, OtherReport};
use super::scan_source::{Frames, OtherCaptures, RegisterError, ScanOptions};
use super::scan_warnings::{parts, told};
use super::scan_writer::Writer;

/// Writes each of `groups` as a capture of its own, where `options` want them written; `out` is the folder of the whole.
pub(crate) fn others(
    source: &Frames,
    groups: &[Group],
    (options, out): (&ScanOptions, &Path),
    job: &Job,
) -> Result<Vec<OtherReport>, RegisterError> {
    groups.iter().map(|group| other(source, group, (options, out), job)).collect()
}

fn other(
    source: &Frames,
    group: &Group,
    (options, out): (&ScanOptions, &Path),
    job: &Job,
) -> Result<OtherReport, RegisterError> {
    let (sequences, _) = parts(source.0, &group.registered);
    let mesh = &group.template.surface.mesh;
    let plain = || group.registered.tracked.iter().map(|tracked| FrameReport::new(tracked, None)).collect();
    let mut report = OtherReport {
        manifest: None,
        template: group.root,
        vertices: mesh.positions.len(),
        triangles: mesh.triangles.len(),
        sequences: sequences.iter().map(|s| (s.name.clone(), s.frames.1 - s.frames.0 + 1)).collect(),
        registered: Vec::new(),
    };
    let path = match &options.others {
        OtherCaptures::Beside => free(out),
        OtherCaptures::At(path) => free(path),
        OtherCaptures::Nowhere => {
            report.registered = plain();
            return Ok(report);
        }
    };
    let writer = Writer::new(source.0, &group.template, group.root, &path, options)?;
    let emit = |found: Found<Option<ScannedTexture>>| writer.take(found);
    write(source, group, |_| true, &options.register, job, &emit)?;
    report.registered = writer.frames(&group.registered);
    report.manifest = Some(writer.finish(sequences)?);
    Ok(report)
}

/// The first of the names `base-2`, `base-3` and so on that is free.
fn free(base: &Path) -> PathBuf {
    let name = base.file_name().map_or_else(|| "capture".into(), |name| name.to_string_lossy().into_owned());
    let taken = |path: &Path| path.is_file() || path.read_dir().is_ok_and(|mut entries| entries.next().is_some());
    let named = |number: usize| base.with_file_name(format!("{name}-{number}"));
    (2..).map(named).find(|path| !taken(path)).unwrap_or_else(|| named(2))
}

/// What the user should know of frames that were joined through another template; `first` is the one that was tried first.
pub(crate) fn joined(scans: &Scans, main: &Group, first: usize) -> Option<Warning> {
    let frames: Vec<usize> =
        main.registered.tracked.iter().filter(|tracked| tracked.through.is_some()).map(|t| t.frame).collect();
    let through = |frame: usize| {
        let tracked = main.registered.tracked.iter().find(|tracked| tracked.frame == frame);
        tracked.and_then(|tracked| tracked.through).unwrap_or(main.root)
    };
    told(scans, "W_SCAN_JOINED", &frames, |frame| {
        let replaced = if main.root == first {
            String::new()
        } else {
            format!(", which is the template instead of frame {first}, for it can be brought onto more frames")
        };
        format!(
            "it was brought onto the mesh of frame {}{replaced} through that of frame {}",
            main.root,
            through(frame)
        )
    })
}

/// What the user should know of frames that have a mesh of their own.
pub(crate) fn told_of_others(scans: &Scans, root: usize, others: &[OtherReport]) -> Vec<Warning> {
    let of = |other: &OtherReport| {
        let frames: Vec<usize> = other.registered.iter().map(|frame| frame.frame).collect();
        told(scans, "W_SCAN_OTHER", &frames, |_| {
            let own = other.template;
            let written = match other.manifest.as_ref().and_then(|manifest| manifest.parent()) {
                Some(folder) => format!(
                    "written as a capture of its own, {}, of which builder pack makes an actor",
                    folder.display()
                ),
                None => "not written; builder register writes it as a capture of its own".into(),
            };
            format!(
                "it fits the mesh of frame {own}, but that and the mesh of frame {root} cannot be brought onto each other: it is \
                 left out here and {written}"
            )
        })
    };
    others.iter().filter_map(of).collect()
}
