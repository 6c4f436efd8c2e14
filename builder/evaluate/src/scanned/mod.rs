//! Section 15: a scan brought onto one mesh, against the truth where it is known (Prada and others 2016; `docs/scans.md`).
//!
//! It takes a scan, of which every frame has its own mesh, and no [`Subject`](crate::Subject): the other sections are about what
//! comes after.

mod tables;
mod views;

use std::path::{Path, PathBuf};

use capture_io::import::{ImportOptions, ScannedFrame, Scans, scans};
use image::{RgbaImage, imageops};
use job::Job;
use registration::candidates::CandidateOptions;
use reprise::scan_headings::wrong_headings;
use reprise::scan_windows::scan_windows;
use reprise::scans::{FrameReport, RegisterReport, ScanOptions, register};

use self::views::{Difference, HEADINGS, SIZE, Worn};
use crate::clay::{Camera, png};
use crate::document::{Document, Picture, SectionReport};
use crate::{EvaluateError, Section};

/// Frames whose pictures are compared, as far apart as they can be.
const COMPARED: usize = 12;
/// Frames that are tracked from wrong headings.
const TURNED: usize = 4;
/// Frames that are shown.
const SHOWN: usize = 6;

/// Thresholds of candidate windows, in dissimilarities of consecutive frames: the paper's, and others for scans that have none by it.
const THRESHOLDS: [f32; 5] = [3.0, 4.5, 6.0, 9.0, 12.0];
/// Candidate windows that are tracked.
const WINDOWS: usize = 8;

/// What pictures of a frame say.
struct Seen {
    frame: usize,
    /// Scan against template, both in the frame's own texture: the mean over views, and decibels.
    own: (Difference, f64),
    /// Scan against template in the texture of the template's frame, which shows what slid.
    first: (Difference, f64),
}

/// Registers the scan that `inputs` name and says how well that went. Where a folder `truth` with a folder `scan` in it lies beside, as
/// `builder performer --scanned` writes it, frames are held against it.
///
/// # Errors
/// Scans that cannot be read, or of which most are lost.
pub fn evaluate_scan(inputs: &[String], import: &ImportOptions, job: &Job) -> Result<Document, EvaluateError> {
    let folder = tempfile::tempdir().map_err(|error| EvaluateError::Folder(error.to_string()))?;
    let mut options = ScanOptions::default();
    options.import = import.clone();
    options.truth = truth_beside(inputs);
    let report = register(inputs, &options, &folder.path().join("capture"), job)?;
    let trials = wrong_headings(inputs, &options, TURNED, job)?;
    let windows = scan_windows(inputs, &options, (&CandidateOptions::default(), &THRESHOLDS, WINDOWS), job)?;
    let before = scans(inputs, import)?;
    let after = scans(&[report.manifest.to_string_lossy().into_owned()], &ImportOptions::default())?;
    let seen = seen(&report, (&before, &after), job)?;
    let mut section = SectionReport::new(Section::Scans.number(), Section::Scans.title());
    section.text = vec![text(&report, options.truth.is_some())];
    section.tables =
        vec![tables::overall(&report, &seen, &trials), tables::takes(&report, &before), tables::frames(&report)];
    section.tables.extend([
        tables::views(&seen),
        tables::headings(&trials),
        tables::candidates(&windows),
        tables::windows(&windows),
        tables::window_times(&windows),
        tables::lost(&report),
        tables::times(&report),
    ]);
    section.pictures = pictures(&report, (&before, &after))?;
    let fact = |name: &str, value: String| (name.to_owned(), value);
    Ok(Document {
        title: format!("{}: evaluation", report.name),
        lead: "A scan of which every frame has its own mesh, brought onto one mesh (after Prada and others 2016)."
            .into(),
        facts: vec![
            fact("Frames", format!("{} of {}", report.registered.len(), report.frames)),
            fact("Template", format!("frame {}", report.template)),
            fact("Mesh", format!("{} vertices, {} triangles", report.vertices, report.triangles)),
            fact("Truth", if options.truth.is_some() { "yes" } else { "no" }.into()),
            fact("Builder", env!("CARGO_PKG_VERSION").into()),
        ],
        sections: vec![section],
    })
}

/// The folder `truth` beside the only one of `inputs`, where it is a scan's.
fn truth_beside(inputs: &[String]) -> Option<PathBuf> {
    let [input] = inputs else { return None };
    let input = Path::new(input);
    let folder = if input.is_dir() { input } else { input.parent()? };
    let folder = folder.join("truth");
    folder.join("scan").is_dir().then_some(folder)
}

fn text(report: &RegisterReport, truth: bool) -> String {
    let truth = if truth {
        "Errors are distances of the template's vertices, with detail, to where they are in truth; what lies in webs of the \
         template's frame, and the template's frame itself, are left out."
    } else {
        "Where every point is in truth is not known: no figure here tells a surface that only slid along itself."
    };
    format!(
        "{truth} Pictures are drawn without light from {} sides, {} frames of {} that are as far apart as they can be; they are \
         compared where scan and template both cover a pixel in full.",
        HEADINGS.len(),
        report.written.len().div_ceil(stride(report.written.len())),
        report.written.len()
    )
}

/// Every so many frames one is compared, of `count`.
fn stride(count: usize) -> usize {
    count.div_ceil(COMPARED).max(1)
}

/// A frame of the scan and what it became; `k` counts the frames that were written.
fn pair(
    report: &RegisterReport,
    (before, after): (&Scans, &Scans),
    k: usize,
) -> Result<[ScannedFrame; 2], EvaluateError> {
    Ok([before.read(report.written[k])?, after.read(k)?])
}

/// The template's own frame as it was written: its texture is the one that others are held against.
fn first(report: &RegisterReport, after: &Scans) -> Result<Option<ScannedFrame>, EvaluateError> {
    let own = report.written.iter().position(|&frame| frame == report.template);
    Ok(own.map(|k| after.read(k)).transpose()?)
}

fn seen(report: &RegisterReport, both: (&Scans, &Scans), job: &Job) -> Result<Vec<Seen>, EvaluateError> {
    let (count, first) = (report.written.len(), first(report, both.1)?);
    let mut all = Vec::new();
    for k in (0..count).step_by(stride(count)) {
        job.tell("comparing pictures", k as u64, count as u64)?;
        let [scan, template] = pair(report, both, k)?;
        let worn = [
            Worn::own(&scan)?,
            Worn::own(&template)?,
            Worn::in_texture_of(&template, first.as_ref().unwrap_or(&template))?,
        ];
        if !worn.iter().all(Worn::is_coloured) {
            continue;
        }
        let views = HEADINGS.map(|heading| {
            let camera = Camera::framing(&scan.positions, SIZE, heading);
            worn.each_ref().map(|worn| worn.draw(&camera))
        });
        let [own, first] = [1, 2].map(|other| {
            let differences = views.each_ref().map(|drawn| Difference::of(&drawn[0], &drawn[other]));
            Difference::mean(&differences)
        });
        all.push(Seen { frame: report.written[k], own, first });
    }
    Ok(all)
}

/// How bad a frame is: its error, where that is known, or what of it is not covered.
fn badness(frame: &FrameReport) -> f64 {
    frame.truth.map_or(frame.uncovered, |truth| truth.mean)
}

/// The worst frame of each of the worst sequences, from two sides.
fn pictures(report: &RegisterReport, both: (&Scans, &Scans)) -> Result<Vec<Picture>, EvaluateError> {
    let sequence = |frame: &FrameReport| both.0.place_of(frame.frame).map(|place| place.0);
    let mut frames: Vec<&FrameReport> = report.registered.iter().collect();
    frames.sort_by(|a, b| badness(b).total_cmp(&badness(a)).then(a.frame.cmp(&b.frame)));
    let mut shown: Vec<&FrameReport> = Vec::new();
    for frame in frames {
        if shown.len() < SHOWN && !shown.iter().any(|other| sequence(other) == sequence(frame)) {
            shown.push(frame);
        }
    }
    let first = first(report, both.1)?;
    let mut pictures = Vec::new();
    for frame in shown {
        let Some(k) = report.written.iter().position(|&written| written == frame.frame) else { continue };
        let [scan, template] = pair(report, both, k)?;
        let worn = [
            Worn::own(&scan)?,
            Worn::own(&template)?,
            Worn::in_texture_of(&template, first.as_ref().unwrap_or(&template))?,
        ];
        let size = [SIZE[0] * 6, SIZE[1]];
        let mut picture = RgbaImage::new(size[0], size[1]);
        for (column, (heading, worn)) in [HEADINGS[0], HEADINGS[2]]
            .iter()
            .flat_map(|heading| worn.iter().map(move |worn| (heading, worn)))
            .enumerate()
        {
            let camera = Camera::framing(&scan.positions, SIZE, *heading);
            imageops::overlay(&mut picture, &worn.draw(&camera).picture(), i64::from(SIZE[0]) * column as i64, 0);
        }
        let error = frame.truth.map_or(String::new(), |truth| format!(", {:.1} mm off the truth", 1000.0 * truth.mean));
        let caption = format!(
            "Frame {}{error}: the scan, the template in the frame's texture, and in that of frame {}, which shows what slid",
            frame.frame, report.template
        );
        pictures.push(Picture { png: png(&picture).map_err(EvaluateError::Picture)?, size, caption });
    }
    Ok(pictures)
}
