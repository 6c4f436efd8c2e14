//! `builder pack`.

use std::path::Path;

use anyhow::{Context, anyhow};
use appearance::AppearanceOptions;
use capture_io::import::{Cyclic, ImportOptions};
use job::Job;
use job::files::write_for_good_by;
use pipeline::distance::{DistanceKind, DistanceOptions};
use pipeline::transitions::{LengthChoice, TransitionOptions};
#[cfg(feature = "complete")]
use reprise::pack::ScanMode;
use reprise::pack::{AppearanceChoice, PackOptions, PackReport, PartsSummary, pack_streamed};
#[cfg(feature = "complete")]
use reprise::vary::Variations;

#[cfg(feature = "complete")]
use super::args::Mode;
use super::args::{AppearanceKind, ImportArguments, PackArguments, TransitionLength, UpAxis, WorkFolderArgument};
use super::failure::Failure;
use super::output::print_json;
use super::rigged;
use super::terminal::Terminal;
use super::work;

/// Reads, computes, writes, and says what came out.
pub fn run(arguments: &PackArguments, terminal: &Terminal) -> Result<(), Failure> {
    let options = options(arguments)?;
    pack_into(&arguments.output, (&arguments.inputs, &options), &arguments.work, arguments.json, terminal)?;
    Ok(())
}

/// Packs `inputs` into the file `output`, and says what came out.
pub fn pack_into(
    output: &Path,
    (inputs, options): (&[String], &PackOptions),
    folder: &WorkFolderArgument,
    json: bool,
    terminal: &Terminal,
) -> Result<PackReport, Failure> {
    if output.file_name().is_none() {
        return Err(Failure::Input(anyhow!("{} is no name for a file", output.display())));
    }
    let (report, work) = (|progress| terminal.progress(progress), work::open(folder)?);
    let job = Job::new(&report).with_work(work.as_ref());
    let (mut packed, report) = pack_streamed(inputs, options, &job).map_err(|error| match error {
        error if error.is_stopped() => Failure::Stopped { work: folder.work.clone() },
        error if error.is_ours() => Failure::Internal(error.into()),
        error => Failure::Input(error.into()),
    })?;
    let written = write_for_good_by(output, |file| packed.write(file));
    written.with_context(|| format!("cannot write {}", output.display())).map_err(Failure::Input)?;
    for warning in &report.warnings {
        terminal.log(&format!("warning: {warning}"));
    }
    terminal.log(&summary(&report));
    if json {
        print_json(&report)?;
    }
    Ok(report)
}

/// What was typed about the input.
pub fn import_options(arguments: &ImportArguments) -> ImportOptions {
    ImportOptions {
        name: arguments.name.clone(),
        fps: arguments.fps,
        up: arguments.up.map(|axis| match axis {
            UpAxis::Y => capture_io::import::UpAxis::Y,
            UpAxis::Z => capture_io::import::UpAxis::Z,
        }),
        unit: arguments.unit,
        cyclic: match arguments.cyclic.as_slice() {
            [word] if word == "auto" => Cyclic::Auto,
            [word] if word == "none" => Cyclic::None,
            names => Cyclic::Names(names.to_vec()),
        },
        texture: arguments.texture.clone(),
        weights: arguments.weights.clone(),
        weld: arguments.weld,
    }
}

fn options(arguments: &PackArguments) -> Result<PackOptions, Failure> {
    if !(0.0..=1000.0).contains(&arguments.alpha) {
        return Err(Failure::Usage("--alpha must be between 0 and 1000".into()));
    }
    if !(arguments.stretch_weight >= 0.0 && arguments.stretch_weight.is_finite()) {
        return Err(Failure::Usage("--stretch-weight must not be negative".into()));
    }
    if arguments.max_error.is_some_and(|error| !(error > 0.0 && error.is_finite())) {
        return Err(Failure::Usage("--max-error must be a length in metres above zero".into()));
    }
    if arguments.appearance_ssim.is_some_and(|ssim| !(ssim > 0.0 && ssim < 1.0)) {
        return Err(Failure::Usage("--appearance-ssim must be between 0 and 1".into()));
    }
    let mut options = PackOptions::default();
    options.import = import_options(&arguments.import);
    options.distance = DistanceOptions {
        kind: DistanceKind::Deformation,
        stretch_weight: arguments.stretch_weight,
        area_weighted: arguments.area_weighted,
    };
    options.graph.transition = TransitionOptions {
        shortest_seconds: arguments.shortest,
        longest_seconds: arguments.longest,
        slope: arguments.slope.0,
        choice: match arguments.transition_length {
            TransitionLength::Total => LengthChoice::Total,
            TransitionLength::Mean => LengthChoice::Mean,
            TransitionLength::Haste => LengthChoice::Haste,
        },
    };
    options.graph.alpha = arguments.alpha;
    options.graph.hold_contacts = !arguments.no_contacts;
    options.parts = !arguments.no_parts;
    options.max_error = arguments.max_error;
    options.appearance = match arguments.appearance {
        AppearanceKind::Static => AppearanceChoice::Static,
        AppearanceKind::Eigen => AppearanceChoice::Eigen(appearance_options(arguments)),
    };
    #[cfg(feature = "complete")]
    {
        options.mode = match arguments.mode {
            Mode::Global => ScanMode::Global,
            Mode::Windows => ScanMode::Windows,
        };
        options.others = Some(arguments.output.with_extension(""));
        options.variations = (!arguments.no_variations).then(Variations::usual);
    }
    if let Some(file) = &arguments.rig {
        options.rig = Some(rigged::read_file(Some(file.as_path()).filter(|file| file.as_os_str() != "-"))?);
    }
    Ok(options)
}

fn parts_line(parts: &PartsSummary, seconds: f64) -> String {
    let how = if parts.painted { "painted" } else { "found" };
    match parts.names.len() {
        0 | 1 => format!("parts of the body: none {how}, it is shown and learned as a whole"),
        _ => format!("parts of the body: {}, {how}; in {seconds:.1} s", parts.names.join(", ")),
    }
}

fn appearance_options(arguments: &PackArguments) -> AppearanceOptions {
    let (usual, wanted) = (AppearanceOptions::default(), arguments.appearance_components);
    AppearanceOptions {
        components: wanted.map_or(usual.components, usize::from),
        any_components: wanted.is_none(),
        ssim: arguments.appearance_ssim,
        compare: arguments.appearance_compare,
        ..usual
    }
}

fn summary(report: &PackReport) -> String {
    let (capture, graph, seconds, bundle) = (&report.capture, &report.graph, &report.seconds, &report.bundle);
    let mut lines = vec![
        format!(
            "{}: {} frames in {} sequences at {} fps, {} vertices, {} triangles",
            report.name, capture.frames, capture.sequences, capture.fps, capture.vertices, capture.triangles
        ),
        format!(
            "essential graph: {} transitions, density {:.4}, alpha {:.4} a frame ({:.3} a second), {} of {} frames \
             in the largest strongly connected component, {} dead ends",
            graph.transitions,
            graph.density,
            graph.alpha,
            graph.alpha_per_second,
            graph.largest_component,
            capture.frames,
            graph.dead_ends
        ),
        format!(
            "bundle: {:.2} MB, {:.1} KB a frame of positions, error {:.3} mm RMS and {:.3} mm at most",
            bundle.bytes as f64 / 1e6,
            bundle.bytes_per_frame / 1e3,
            bundle.rms_error * 1e3,
            bundle.max_error * 1e3
        ),
        format!(
            "seconds: import {:.1}, distances {:.1}, transitions and graph {:.1}, bundle {:.1}",
            seconds.import, seconds.distances, seconds.graph, seconds.bundle
        ),
    ];
    if let Some(appearance) = &report.appearance {
        lines.push(format!(
            "appearance: {} Eigen textures, {} Eigen warps, SSIM {:.4}, PSNR {:.1} dB; stored in {:.0} bytes a frame: SSIM \
             {:.4}, at least {:.4}, PSNR {:.1} dB; in {:.1} s",
            appearance.textures,
            appearance.warps,
            appearance.ssim,
            texture::quality::psnr(appearance.mean_square_error),
            appearance.stored.bytes_per_frame,
            appearance.stored.ssim,
            appearance.stored.least_ssim,
            appearance.stored.psnr,
            seconds.appearance
        ));
    }
    #[cfg(feature = "complete")]
    if let Some(scanned) = &report.scanned {
        lines.push(format!(
            "scanned frames: {} in {} groups, {:.1} KB a frame, of which images {:.1} KB; in {:.1} s",
            scanned.frames,
            scanned.groups,
            scanned.bytes_per_frame / 1e3,
            scanned.images_per_frame / 1e3,
            seconds.scanned
        ));
    }
    #[cfg(feature = "complete")]
    if let Some(stored) = report.alternatives {
        lines.push(format!(
            "variations: {} alternatives of {} stretches in {} modes, {:.2} mm off on average and {:.1} mm at most, {:.0} KB; in \
             {:.1} s",
            stored.alternatives,
            stored.stretches,
            stored.modes,
            stored.error * 1e3,
            stored.most * 1e3,
            stored.bytes as f64 / 1e3,
            seconds.variations
        ));
    }
    for family in &report.families {
        let values: Vec<String> = family.samples.iter().map(|sample| format!("{:.2}", sample.value)).collect();
        lines.push(format!("family {}: {} {} {}", family.name, family.parameter, values.join(", "), family.unit));
    }
    lines.extend(report.parts.as_ref().map(|parts| parts_line(parts, seconds.parts)));
    if let Some(learned) = &report.learned {
        let (modes, frames, misfit, moves) = (learned.modes, learned.frames, learned.misfit_mm, learned.moves_mm);
        let stored =
            report.bundle.sections.iter().find(|size| size.name == "learned-space").map_or(0, |size| size.stored);
        lines.push(format!(
            "learned space: {modes} modes of {frames} frames miss {misfit:.1} of {moves:.1} mm RMS; {:.1} KB",
            stored as f64 / 1000.0
        ));
    }
    if let Some(rig) = &report.rig {
        let kind = if rig.human { ", a human's" } else { "" };
        let (bones, misfit) = (rig.bones, rig.misfit_mm);
        lines.push(format!("rig: {bones} bones{kind}, skinning misses {misfit:.1} mm RMS; in {:.1} s", seconds.rig));
    }
    if let Some(bytes) = report.peak_memory_bytes {
        lines.push(format!("peak memory: {:.0} MB", bytes as f64 / 1e6));
    }
    lines.join("\n")
}
