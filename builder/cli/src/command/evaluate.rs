//! `builder evaluate`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use evaluate::scanned::evaluate_scan;
use evaluate::{Document, EvaluateError, EvaluateOptions, Section, Subject, evaluate, html};
use job::{Job, Progress};
use performer::{PerformerError, PerformerOptions, ScannedOptions, write_performer, write_scanned};

use super::args::{EvaluateArguments, EvaluateSection};
use super::failure::Failure;
use super::output::write_whole;
use super::pack::import_options;
use super::terminal::Terminal;
use super::work;

/// Frames, vertices and width of the textures of the built-in performer where it is scanned, if nothing else is asked for.
const SCANNED: (usize, usize, usize) = (40, 6000, 512);

/// Evaluates a capture and writes the report into a folder.
pub fn run(arguments: &EvaluateArguments, terminal: &Terminal) -> Result<(), Failure> {
    let start = std::time::Instant::now();
    is_scan(arguments)?;
    let out = &arguments.output;
    fs::create_dir_all(out).with_context(|| format!("cannot make {}", out.display())).map_err(Failure::Input)?;
    // Kept until the end: it is removed when it is dropped.
    let performer = if arguments.inputs.is_empty() { Some(perform(arguments, terminal)?) } else { None };
    let inputs = match &performer {
        Some(folder) => vec![folder.path.to_string_lossy().into_owned()],
        None => arguments.inputs.clone(),
    };
    let (report, work) = (|step: Progress| terminal.progress(step), work::open(&arguments.work)?);
    let job = Job::new(&report).with_work(work.as_ref());
    let document = document(&inputs, arguments, &job)?;
    let json = serde_json::to_string_pretty(&document.json()).map_err(|error| Failure::Internal(error.into()))?;
    let tables = document.sections.iter().flat_map(|section| &section.tables);
    let files = tables.map(|table| (format!("{}.csv", table.name), table.csv()));
    // The page comes last, so that a folder with it is complete.
    let all = files.chain([("report.json".into(), json + "\n"), ("index.html".into(), html::page(&document, true))]);
    for (name, text) in all {
        write_whole(&out.join(name), text.as_bytes()).map_err(Failure::Input)?;
    }
    terminal.log(&format!("{} in {:.0} s", out.join("index.html").display(), start.elapsed().as_secs_f64()));
    Ok(())
}

/// Whether a scan is evaluated, which no other section takes.
fn is_scan(arguments: &EvaluateArguments) -> Result<bool, Failure> {
    let scans = arguments.sections.contains(&EvaluateSection::Scans);
    if scans && arguments.sections.iter().any(|section| *section != EvaluateSection::Scans) {
        let message = "--sections scans stands alone: it takes a scan, and the other sections a capture of one mesh";
        return Err(Failure::Usage(message.into()));
    }
    Ok(scans)
}

fn document(inputs: &[String], arguments: &EvaluateArguments, job: &Job) -> Result<Document, Failure> {
    let failure = |error: EvaluateError| match error {
        error if error.is_stopped() => Failure::Stopped { work: arguments.work.work.clone() },
        error if error.is_input() => Failure::Input(error.into()),
        error => Failure::Internal(error.into()),
    };
    let import = import_options(&arguments.import);
    if is_scan(arguments)? {
        return evaluate_scan(inputs, &import, job).map_err(failure);
    }
    let options = EvaluateOptions {
        sections: sections(arguments),
        seed: arguments.seed,
        clips: arguments.clips.clone(),
        ..Default::default()
    };
    let subject = Subject::read(inputs, &import, options, job).map_err(failure)?;
    evaluate(&subject, job).map_err(failure)
}

fn sections(arguments: &EvaluateArguments) -> Vec<Section> {
    if arguments.sections.is_empty() {
        return Section::ALL.to_vec();
    }
    let mut sections: Vec<Section> = arguments
        .sections
        .iter()
        .map(|section| match section {
            EvaluateSection::Poses => Section::Poses,
            EvaluateSection::Transitions => Section::Transitions,
            EvaluateSection::Graphs => Section::Graphs,
            EvaluateSection::Blending => Section::Blending,
            EvaluateSection::Interpolation => Section::Interpolation,
            EvaluateSection::Walks => Section::Walks,
            EvaluateSection::Scaling => Section::Scaling,
            EvaluateSection::Appearance => Section::Appearance,
            EvaluateSection::Motion => Section::Motion,
            EvaluateSection::Wandering => Section::Wandering,
            EvaluateSection::Transfer => Section::Transfer,
            EvaluateSection::Families => Section::Families,
            EvaluateSection::Variations => Section::Variations,
            EvaluateSection::Editing => Section::Editing,
            EvaluateSection::Scans => Section::Scans,
        })
        .collect();
    sections.sort_unstable();
    sections.dedup();
    sections
}

/// A folder that is removed when it is no longer needed.
struct Temporary {
    path: PathBuf,
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // What cannot be removed is left to the system's own cleaning of temporary files.
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Writes the built-in performer's capture into a temporary folder.
fn perform(arguments: &EvaluateArguments, terminal: &Terminal) -> Result<Temporary, Failure> {
    let scanned = is_scan(arguments)?;
    let mut default = PerformerOptions::default();
    if scanned {
        (default.frames, default.vertices, default.texture_size) = SCANNED;
    }
    let size = |asked: Option<u32>, default: usize| asked.map_or(default, |number| number as usize);
    let options = PerformerOptions {
        frames: size(arguments.frames, default.frames),
        vertices: size(arguments.vertices, default.vertices),
        seed: arguments.seed,
        ..default
    };
    let path = std::env::temp_dir().join(format!("reprise-evaluate-{}", std::process::id()));
    if Path::new(&path).exists() {
        return Err(Failure::Input(anyhow!("{} is in the way; remove it", path.display())));
    }
    let folder = Temporary { path };
    let progress = |step: performer::Progress| {
        // It is over in seconds, before it is asked again whether to go on.
        let _ =
            terminal.progress(Progress { what: "performer", done: step.frames_done as u64, total: step.frames as u64 });
    };
    let written = if scanned {
        write_scanned(&options, &ScannedOptions::default(), &folder.path, &progress)
    } else {
        write_performer(&options, &folder.path, &progress)
    };
    written.map_err(|error| match error {
        PerformerError::Option { .. } => Failure::Usage(error.to_string()),
        _ => Failure::Input(error.into()),
    })?;
    Ok(folder)
}
