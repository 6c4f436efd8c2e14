//! `builder transfer`: an actor moves as another one does.

use std::path::Path;

use anyhow::{Context, anyhow};
use capture_io::export::{ExportOptions, Output};
use capture_io::import::Warning;
use job::Job;
use reprise::frame_maps::MappedFrames;
use reprise::transfer::{
    Kernel, KeyFile, TransferActor, TransferOptions, TransferSummary, Transferred, TransferredSequence, transfer,
};
use serde::Serialize;
use toml::Table;

use super::args::{KernelKind, TransferArguments};
use super::drive_actor::{Origin, ReadActor, read};
use super::drive_capture::{NewSequence, is_ply, manifest};
use super::drive_frames::write_frames;
use super::failure::Failure;
use super::output::{print_json, write_whole};
use super::terminal::Terminal;
use super::transfer_alone;

/// What is kept beside the capture, and what `--json` prints, but for the maps.
#[derive(Serialize)]
struct Provenance {
    /// Whose motion it is.
    source: String,
    /// Who moves so.
    target: String,
    /// The keys.
    keys: KeyFile,
    /// What was learned.
    learned: TransferSummary,
    /// The new sequences.
    sequences: Vec<NewSequenceSummary>,
    /// What is not as one might think.
    warnings: Vec<Warning>,
    /// Which frames were found to belong together; last, for it is long.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    maps: Vec<MappedFrames>,
}

#[derive(Serialize)]
struct NewSequenceSummary {
    /// Its name.
    name: String,
    /// The sequence of the source.
    from: String,
    /// Its frames.
    frames: usize,
    /// Whether keys name it.
    has_keys: bool,
    /// How far soles slide from frame to frame while they stand, in millimetres.
    slide_mm: Option<f32>,
}

/// Reads, learns, writes, and says what came out.
pub fn run(arguments: &TransferArguments, terminal: &Terminal) -> Result<(), Failure> {
    let folder = &arguments.output;
    if folder.read_dir().is_ok_and(|mut entries| entries.next().is_some()) {
        let error = anyhow!("{} is not empty; name a new folder, or empty it first", folder.display());
        return Err(Failure::Input(error));
    }
    let path = &arguments.keys;
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()));
    let keys: Result<KeyFile, _> =
        text.and_then(|text| toml::from_str(&text).with_context(|| path.display().to_string()));
    let keys = keys.map_err(Failure::Input)?;
    let source = read(&arguments.from, &arguments.import, terminal)?;
    let target = read(&arguments.to, &arguments.import, terminal)?;
    let report = |step| terminal.progress(step);
    let done = transfer(
        &actor(&source),
        &actor(&target),
        (&keys, &arguments.sequences),
        &options(arguments),
        &Job::new(&report),
    )
    .map_err(|error| if error.is_stopped() { Failure::StoppedReading } else { Failure::Input(error.into()) })?;
    done.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    let names = names(&done.sequences, &target, arguments.alone);
    write(arguments, &target, &done, &names, terminal)?;
    let mut provenance = provenance(arguments, keys, &done, &names);
    let text = serde_json::to_string_pretty(&provenance).map_err(|error| Failure::Internal(error.into()))?;
    write_whole(&folder.join("transfer.json"), text.as_bytes()).map_err(Failure::Input)?;
    terminal.log(&told(&provenance));
    if arguments.json {
        provenance.maps.clear();
        print_json(&provenance)?;
    }
    Ok(())
}

fn actor(read: &ReadActor) -> TransferActor<'_> {
    TransferActor {
        topology: &read.topology,
        timeline: &read.timeline,
        poses: &read.poses,
        parts: read.parts.as_deref(),
    }
}

fn options(arguments: &TransferArguments) -> TransferOptions {
    let mut options = TransferOptions::default();
    options.kernel = match arguments.kernel {
        KernelKind::Nn => Kernel::NeuralNetwork,
        KernelKind::Se => Kernel::SquaredExponential,
        KernelKind::Linear => Kernel::Linear,
        KernelKind::Affine => Kernel::Affine,
    };
    options.whole = arguments.whole;
    options.pairs = arguments.pairs.into();
    options.hold = !arguments.no_hold;
    options.correct = !arguments.no_correct;
    options.bones = !arguments.no_bones;
    options
}

/// Names of the new sequences: the source's, where the target's own are not called so.
fn names(sequences: &[TransferredSequence], target: &ReadActor, alone: bool) -> Vec<String> {
    let stays = !alone && matches!(target.origin, Origin::Capture(_));
    let mut taken: Vec<String> = match stays {
        true => target.timeline.sequences().iter().map(|sequence| sequence.name.clone()).collect(),
        false => Vec::new(),
    };
    let mut names = Vec::new();
    for one in sequences {
        let mut name = one.sequence.name.clone();
        while taken.contains(&name) {
            name.push_str("_transferred");
        }
        taken.push(name.clone());
        names.push(name);
    }
    names
}

/// Writes the frames of all sequences, and the manifest last.
fn write(
    arguments: &TransferArguments,
    target: &ReadActor,
    done: &Transferred,
    names: &[String],
    terminal: &Terminal,
) -> Result<(), Failure> {
    let folder = &arguments.output;
    // As the recorded frames are, so that texture coordinates have one layout.
    let ending = if is_ply(Path::new(&arguments.to)) { "ply" } else { "obj" };
    let first = &done.sequences[0];
    let exported = target.exported(&names[0], &first.poses[..1], first.worn)?;
    for (one, name) in done.sequences.iter().zip(names) {
        let pattern = folder.join(name).join(format!("%05d.{ending}"));
        let output = Output::parse(&pattern.to_string_lossy()).map_err(|error| Failure::Internal(error.into()))?;
        write_frames(target, &exported, (name, &one.poses), &output, &ExportOptions::default(), terminal)?;
    }
    let new: Vec<NewSequence> = done
        .sequences
        .iter()
        .zip(names)
        .map(|(one, name)| NewSequence {
            name,
            input: format!("{name}/%05d.{ending}:0:{}", one.poses.len() - 1),
            texture: texture(target, one.worn),
            labels: &one.sequence.labels,
            cyclic: false,
        })
        .collect();
    let fps = target.timeline.fps();
    let stays = !arguments.alone && matches!(target.origin, Origin::Capture(_));
    let text = match stays {
        true => manifest(folder, (&arguments.to, &arguments.import), fps, &new),
        false => transfer_alone::manifest(folder, (target, &exported), fps, &new),
    };
    let text = text.and_then(|text| with_texture(text, target, folder, &names[0])).map_err(Failure::Input)?;
    let text = format!("{}{text}", origin(arguments, done, names));
    write_whole(&folder.join("capture.toml"), text.as_bytes()).map_err(Failure::Input)
}

/// The texture of a recorded frame, where frames have their own.
pub(super) fn texture(target: &ReadActor, worn: u32) -> Option<std::path::PathBuf> {
    let Origin::Capture(imported) = &target.origin else { return None };
    imported.frame_textures.as_ref()?.get(worn as usize).cloned()
}

/// The same manifest with the texture that all frames of a target wear whose textures do not change: each folder of frames names a
/// copy of its own, and these would be taken for textures that do.
pub(super) fn with_texture(text: String, target: &ReadActor, folder: &Path, name: &str) -> anyhow::Result<String> {
    let changes = matches!(&target.origin, Origin::Capture(imported) if imported.frame_textures.is_some());
    let entries = folder.join(name).read_dir().into_iter().flatten().flatten();
    let images: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|file| file.starts_with("texture_"))
        .collect();
    let mut table: Table = text.parse()?;
    if let [image] = images.as_slice()
        && !changes
        && !table.contains_key("texture")
    {
        table.insert("texture".into(), format!("{name}/{image}").into());
    }
    Ok(toml::to_string(&table)?)
}

/// Where the new sequences come from, as a comment.
fn origin(arguments: &TransferArguments, done: &Transferred, names: &[String]) -> String {
    let mut text = format!("# Moves as {} does (transfer.json):\n", arguments.from.replace('\n', " "));
    for (one, name) in done.sequences.iter().zip(names) {
        text.push_str(&format!("# {name}: from {}\n", one.sequence.name));
    }
    text + "\n"
}

fn provenance(arguments: &TransferArguments, keys: KeyFile, done: &Transferred, names: &[String]) -> Provenance {
    let summary = |(one, name): (&TransferredSequence, &String)| NewSequenceSummary {
        name: name.clone(),
        from: one.sequence.name.clone(),
        frames: one.poses.len(),
        has_keys: one.has_keys,
        slide_mm: one.slide.map(|slide| 1000.0 * slide),
    };
    Provenance {
        source: arguments.from.clone(),
        target: arguments.to.clone(),
        keys,
        learned: done.summary.clone(),
        sequences: done.sequences.iter().zip(names).map(summary).collect(),
        warnings: done.warnings.clone(),
        maps: done.maps.clone(),
    }
}

fn told(provenance: &Provenance) -> String {
    let TransferSummary { keys, pairs, learned, parts, ratio, agreement, bones, .. } = &provenance.learned;
    let carried = if *bones { ", beside what bones carry" } else { "" };
    let agreement = agreement.map_or(String::new(), |agreement| format!("; pairs agree by {:.0} %", 100.0 * agreement));
    let mut lines = vec![format!(
        "{keys} keys, {pairs} pairs of frames found between them, {learned} learned from in {parts} parts{carried}; a metre becomes {ratio:.3} m{agreement}"
    )];
    for one in &provenance.sequences {
        let slide = one.slide_mm.map_or("no feet held".into(), |slide| format!("soles slide {slide:.2} mm a frame"));
        let keys = if one.has_keys { "" } else { ", without keys" };
        lines.push(format!("{}: {} frames from {}{keys}, {slide}", one.name, one.frames, one.from));
    }
    lines.join("\n")
}
