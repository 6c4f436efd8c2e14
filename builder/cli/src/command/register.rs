//! `builder register`.

use evaluate::html;
use evaluate::scans::scan_page;
use job::Job;
use reprise::scans::{RegisterReport, ScanOptions, TruthReport, register};

use super::args::RegisterArguments;
use super::failure::Failure;
use super::output::{print_json, write_whole};
use super::pack::import_options;
use super::terminal::Terminal;
use super::work;

/// Registers a scan and says what came out.
pub fn run(arguments: &RegisterArguments, terminal: &Terminal) -> Result<(), Failure> {
    let options = options(arguments)?;
    let (report, work) = (|progress| terminal.progress(progress), work::open(&arguments.work)?);
    let job = Job::new(&report).with_work(work.as_ref());
    let found = register(&arguments.inputs, &options, &arguments.output, &job).map_err(|error| {
        if error.is_stopped() {
            Failure::Stopped { work: arguments.work.work.clone() }
        } else {
            Failure::Input(error.into())
        }
    })?;
    if let Some(path) = &arguments.report {
        let page = scan_page(&found, &arguments.inputs, &options.import);
        let page = page.map_err(|error| Failure::Input(error.into()))?;
        write_whole(path, html::page(&page, false).as_bytes()).map_err(Failure::Input)?;
    }
    for warning in &found.warnings {
        terminal.log(&format!("warning: {warning}"));
    }
    terminal.log(&summary(&found));
    for other in &found.others {
        let folder = other.manifest.as_ref().and_then(|manifest| manifest.parent());
        let folder = folder.map_or_else(|| "not written".into(), |folder| folder.display().to_string());
        let (frames, root) = (other.registered.len(), other.template);
        terminal.log(&format!("{folder}: {frames} of the frames that were lost, on the mesh of frame {root}"));
    }
    if arguments.json { print_json(&found) } else { Ok(()) }
}

fn options(arguments: &RegisterArguments) -> Result<ScanOptions, Failure> {
    for (name, value) in [("--colour", arguments.colour), ("--detail", arguments.detail)] {
        if !(value >= 0.0 && value.is_finite()) {
            return Err(Failure::Usage(format!("{name} must not be negative")));
        }
    }
    let mut options = ScanOptions::default();
    options.import = import_options(&arguments.import);
    options.register.template = arguments.template_frame;
    options.register.track.colour = arguments.colour;
    options.register.detail = arguments.detail;
    options.truth.clone_from(&arguments.truth);
    options.texture_size = arguments.texture_size.map(|size| size as usize);
    Ok(options)
}

fn summary(report: &RegisterReport) -> String {
    let worst = |of: fn(&reprise::scans::FrameReport) -> f64| report.registered.iter().map(of).fold(0.0, f64::max);
    let sequences: Vec<String> = report.sequences.iter().map(|(name, frames)| format!("{name} {frames}")).collect();
    let truth: Vec<TruthReport> = report.registered.iter().filter_map(|frame| frame.truth).collect();
    let truth = truth_line(&truth).unwrap_or_default();
    let texture = report.texture_size.map_or("no texture".into(), |size| format!("textures of {size} x {size}"));
    format!(
        "{}: {} of {} frames on the mesh of frame {}, {} vertices, {} triangles, {texture} ({})\nworst frame: {:.2} % of the \
         scan uncovered, {:.1} mm off it\n{truth}seconds: comparing {:.1}, registering {:.1}",
        report.manifest.display(),
        report.registered.len(),
        report.frames,
        report.template,
        report.vertices,
        report.triangles,
        sequences.join(", "),
        100.0 * worst(|frame| frame.uncovered),
        1000.0 * worst(|frame| frame.rms_backward),
        report.seconds[0],
        report.seconds[1]
    )
}

/// How far frames are from the truth, without the template's own, which is the nearest.
fn truth_line(frames: &[TruthReport]) -> Option<String> {
    let own = frames.iter().map(|frame| frame.mean).fold(f64::INFINITY, f64::min);
    let others: Vec<&TruthReport> = frames.iter().filter(|frame| frame.mean > own).collect();
    let mean = |of: fn(&TruthReport) -> f64| 1000.0 * others.iter().map(|f| of(f)).sum::<f64>() / others.len() as f64;
    let worst = |of: fn(&TruthReport) -> f64| 1000.0 * others.iter().map(|f| of(f)).fold(0.0, f64::max);
    (!others.is_empty()).then(|| {
        format!(
            "off the truth: {:.1} mm on average, {:.1} in the worst frame; 95th percentile {:.1}, {:.1} in the worst; farthest {:.0}\n",
            mean(|f| f.mean),
            worst(|f| f.mean),
            mean(|f| f.p95),
            worst(|f| f.p95),
            worst(|f| f.worst)
        )
    })
}
