//! `builder drive`: an actor does what a clip of motion capture shows.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow};
use capture_io::export::{ExportOptions, Output, Written};
use capture_io::import::Warning;
use capture_io::mocap::{MocapOptions, ReadClip, read_clip};
use drive::measure::measure;
use drive::retarget::Driven;
use drive::{Body, Mapping, MappingFile, Measures, Role, retarget};
use job::{Job, Progress};
use reprise::hybrid::{DrivenFrames, EditedBy, EndReport, Hybrid, HybridError, WayReport, join};
use reprise::pack::PackOptions;
use serde::Serialize;

use super::args::{DriveArguments, UpAxis};
use super::drive_actor::{Origin, ReadActor, read, rig};
use super::drive_capture::{NewSequence, manifest};
use super::drive_frames::write_frames;
use super::failure::Failure;
use super::output::{print_json, write_whole};
use super::pack::{import_options, pack_into};
use super::terminal::Terminal;

/// What `--json` prints.
#[derive(Serialize)]
struct DriveReport {
    /// Which joint was taken for which.
    mapping: MappingFile,
    /// Frames that were written.
    frames: u32,
    /// Where.
    output: String,
    /// What was measured on them.
    measures: Measures,
    /// The ways into the new sequence and out of it, where it goes into a capture.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    joins: Vec<EndReport>,
    /// Seconds: of reading clip and actor, and of making all frames.
    seconds: [f64; 2],
    /// What is not as in the clip, or may be mistaken.
    warnings: Vec<Warning>,
}

/// Reads, drives, writes, and says what came out.
pub fn run(arguments: &DriveArguments, terminal: &Terminal) -> Result<(), Failure> {
    let output = Output::parse(&arguments.output).ok();
    check(arguments, output.as_ref())?;
    let began = Instant::now();
    let ReadClip { clip, mut warnings } = read_clip(&arguments.clip, &options(arguments)).map_err(input)?;
    let mapping = Mapping::of(&clip, &mapping_file(arguments)?).map_err(input)?;
    if let Some(path) = &arguments.write_mapping {
        let text = toml::to_string(&mapping.file(&clip)).map_err(|error| Failure::Internal(error.into()))?;
        write_whole(path, text.as_bytes()).map_err(Failure::Input)?;
    }
    warnings.extend(missing(&mapping));
    warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    let mut actor = read(&arguments.actor, &arguments.import, terminal)?;
    let rig = rig(&mut actor, arguments.rig.as_deref())?;
    let body = drive::body(&rig, &actor.poses).map_err(input)?;
    let read_seconds = began.elapsed().as_secs_f64();
    let began = Instant::now();
    let mesh = (&actor.topology, actor.order.as_deref());
    let mut driven = retarget((&clip, &mapping), &body, mesh, (&actor.poses, actor.timeline.fps())).map_err(input)?;
    let seconds = [read_seconds, began.elapsed().as_secs_f64()];
    if !driven.stands {
        let message = format!(
            "{}: no foot ever stands, as in a walk on the spot: nothing is planted, and the feet slide as the clip's do",
            arguments.clip
        );
        let warning = Warning::new("W_MOCAP_NO_CONTACT", message);
        terminal.log(&format!("warning: {warning}"));
        warnings.push(warning);
    }
    let name = sequence_name(arguments);
    let mut joins = Vec::new();
    if output.is_none() && !arguments.as_driven {
        joins = joined(&actor, &body, (&name, &mut driven), terminal)?;
    }
    let written = match &output {
        Some(output) => frames(arguments, arguments.every, &actor, (&name, &driven), output, terminal)?,
        None => capture(arguments, &actor, &name, &driven, terminal)?,
    };
    warnings.extend(written.warnings);
    terminal.log(&summary(&driven.measures, seconds, &arguments.output));
    if arguments.json {
        let (mapping, output) = (mapping.file(&clip), arguments.output.clone());
        let Written { frames, .. } = written;
        print_json(&DriveReport { mapping, frames, output, measures: driven.measures, joins, seconds, warnings })?;
    }
    Ok(())
}

fn input(error: impl std::error::Error + Send + Sync + 'static) -> Failure {
    Failure::Input(error.into())
}

fn check(arguments: &DriveArguments, output: Option<&Output>) -> Result<(), Failure> {
    let usage = |text: &str| Err(Failure::Usage(text.into()));
    let positive = |number: Option<f32>| number.is_none_or(|number| number > 0.0 && number.is_finite());
    if !positive(arguments.rate) || !positive(arguments.clip_unit) {
        return usage("--rate and --clip-unit must be above zero");
    }
    if output.is_some() && arguments.into.is_some() {
        return usage("--into packs a capture: -o must name a new folder for it");
    }
    let is_folder = Path::new(&arguments.output).extension().is_none();
    if output.is_none() && (!is_folder || super::inspect::is_bundle(Path::new(&arguments.actor))) {
        return usage(
            "-o names walk.glb, a pattern such as walk/%05d.obj (.ply, .png), or, where the actor is a capture, a new folder",
        );
    }
    Ok(())
}

fn options(arguments: &DriveArguments) -> MocapOptions {
    MocapOptions {
        rate: arguments.rate,
        unit: arguments.clip_unit,
        up: match arguments.clip_up {
            UpAxis::Y => capture_io::import::UpAxis::Y,
            UpAxis::Z => capture_io::import::UpAxis::Z,
        },
        clip: arguments.take.clone(),
        keep_first: arguments.keep_first,
    }
}

fn mapping_file(arguments: &DriveArguments) -> Result<MappingFile, Failure> {
    let Some(file) = &arguments.mapping else { return Ok(MappingFile::default()) };
    let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()));
    let read = text.and_then(|text| toml::from_str(&text).with_context(|| file.display().to_string()));
    read.map_err(Failure::Input)
}

/// A sentence where the skeleton lacks what a body has.
fn missing(mapping: &Mapping) -> Option<Warning> {
    let names: Vec<&str> = mapping.missing().into_iter().map(Role::name).collect();
    let message = format!(
        "the clip's skeleton has no {}: these parts stay as they are in the actor's rest pose; --mapping names joints",
        names.join(", ")
    );
    (!names.is_empty()).then(|| Warning::new("W_MOCAP_MISSING", message))
}

fn sequence_name(arguments: &DriveArguments) -> String {
    let file = arguments.clip.rsplit_once('+').map_or(arguments.clip.as_str(), |(_, motion)| motion);
    let stem = Path::new(file).file_stem().map_or("clip".into(), |stem| stem.to_string_lossy().into_owned());
    arguments.sequence.clone().unwrap_or(stem)
}

/// Edits the frames' beginning and end towards the recording, and says what that did.
fn joined(
    actor: &ReadActor,
    body: &Body,
    (name, driven): (&str, &mut Driven),
    terminal: &Terminal,
) -> Result<Vec<EndReport>, Failure> {
    let Origin::Capture(imported) = &actor.origin else { return Ok(Vec::new()) };
    let report = |step: Progress| terminal.progress(step);
    let mesh = (&actor.topology, actor.order.as_deref());
    let remade = |aims: &[_]| driven.towards(aims, body, mesh).ok().map(|(_, poses)| poses);
    let frames = DrivenFrames { name, body, poses: &driven.poses, free: &driven.free, remade: &remade };
    let joined = join(&imported.capture, frames, &Job::new(&report));
    let Hybrid { poses, ends, aims } = joined.map_err(|error| match error {
        HybridError::Stopped(_) => Failure::StoppedReading,
        error => input(error),
    })?;
    driven.poses = poses;
    driven.planted = driven.free.planted(body, &aims);
    driven.measures = measure(body, &actor.topology, &actor.poses, &driven.poses, &driven.planted);
    for end in &ends {
        terminal.log(&said(end));
    }
    Ok(ends)
}

fn said(end: &EndReport) -> String {
    let way = |way: &WayReport| {
        format!(
            "cost {:.2} over {} frames, poses {:.0} mm apart in its middle, acceleration {:.1} m/s^2 where the frames have {:.1}",
            way.cost, way.duration, way.apart_mm, way.acceleration[0], way.acceleration[1]
        )
    };
    let (name, sequence) = (if end.inwards { "in from" } else { "out to" }, &end.sequence);
    let before = format!("best way {name} {sequence}, frame {}: {}", end.before.frames[0], way(&end.before));
    match &end.after {
        Some(after) => {
            let by = if end.by == Some(EditedBy::Bones) { "by their bones" } else { "on their surface" };
            format!("{before}\n  with {} frames edited {by}: {}", end.changed, way(after))
        }
        None => format!("{before}; an edit would not make it cheaper"),
    }
}

/// Writes the frames as any walk's are written.
fn frames(
    arguments: &DriveArguments,
    every: u32,
    actor: &ReadActor,
    (name, driven): (&str, &Driven),
    output: &Output,
    terminal: &Terminal,
) -> Result<Written, Failure> {
    let exported = actor.exported(name, &driven.poses, driven.nearest)?;
    let options = ExportOptions {
        every,
        size: arguments.size,
        turn_seconds: arguments.turn.max(0.1) as f32,
        ..ExportOptions::default()
    };
    write_frames(actor, &exported, (name, &driven.poses), output, &options, terminal)
}

/// Writes the frames and a manifest that has them beside the recorded ones; packs it, where that is asked for.
fn capture(
    arguments: &DriveArguments,
    actor: &ReadActor,
    name: &str,
    driven: &Driven,
    terminal: &Terminal,
) -> Result<Written, Failure> {
    let Origin::Capture(imported) = &actor.origin else {
        return Err(Failure::Usage("only a capture can have one more sequence".into()));
    };
    let folder = Path::new(&arguments.output);
    if folder.read_dir().is_ok_and(|mut entries| entries.next().is_some()) {
        let error = anyhow!("{} is not empty; name a new folder, or empty it first", folder.display());
        return Err(Failure::Input(error));
    }
    let last = driven.poses.len() - 1;
    let textures = imported.frame_textures.as_ref();
    let texture = textures.and_then(|textures| textures.get(driven.nearest as usize)).cloned();
    // As the recorded frames are, so that texture coordinates have one layout.
    let ending = if super::drive_capture::is_ply(Path::new(&arguments.actor)) { "ply" } else { "obj" };
    let input = format!("frames/%05d.{ending}:0:{last}");
    let new = NewSequence { name, input, texture, labels: &arguments.labels, cyclic: false };
    let text = manifest(folder, (&arguments.actor, &arguments.import), actor.timeline.fps(), &[new]);
    let text = text.map_err(Failure::Input)?;
    let pattern = folder.join("frames").join(format!("%05d.{ending}"));
    let output = Output::parse(&pattern.to_string_lossy()).map_err(|error| Failure::Internal(error.into()))?;
    let written = frames(arguments, 1, actor, (name, driven), &output, terminal)?;
    write_whole(&folder.join("capture.toml"), text.as_bytes()).map_err(Failure::Input)?;
    if let Some(bundle) = &arguments.into {
        let mut options = PackOptions::default();
        options.import = import_options(&arguments.import);
        options.import.texture = None;
        options.import.weights = None;
        let inputs = [arguments.output.clone()];
        pack_into(bundle, (&inputs, &options), &arguments.work, false, terminal)?;
    }
    Ok(written)
}

fn summary(measures: &Measures, seconds: [f64; 2], output: &str) -> String {
    let Measures { frames, sole_off_mm, slide_mm, below_mm, volume, recorded_volume, .. } = measures;
    format!(
        "{output}: {frames} frames in {:.2} s ({:.1} ms each)\n\
         soles that stand: {:.1} mm from the floor on average and {:.1} at most, slide {:.2} mm a frame on average and {:.2} at \
         most; nothing lies more than {below_mm:.1} mm below the floor\n\
         volume beside that of the recorded frames: {:.3} on average, {:.3} at least (recorded: {:.3} to {:.3})",
        seconds[1],
        1000.0 * seconds[1] / (*frames).max(1) as f64,
        sole_off_mm[0],
        sole_off_mm[1],
        slide_mm[0],
        slide_mm[1],
        volume[1],
        volume[0],
        recorded_volume[0],
        recorded_volume[1]
    )
}
