//! `builder family`: what lies between the cycles of a capture.

use std::path::Path;

use anyhow::anyhow;
use capture_io::export::{ExportOptions, Output};
use capture_io::import::{FamilyParameter, FamilySamples, Imported, ManifestFamily};
use family::{Found, Sample};
use job::Job;
use reprise::families::{FamilySummary, Ground, MadeFamily, make, proposed};
use serde::Serialize;
use toml::{Table, Value};

use super::args::{FamilyArguments, FamilyKind};
use super::drive_actor::{Origin, ReadActor, read};
use super::drive_capture::{NewSequence, is_ply, manifest};
use super::drive_frames::write_frames;
use super::failure::Failure;
use super::output::{print_json, write_whole};
use super::terminal::Terminal;
use super::transfer::{texture, with_texture};

/// What `--json` prints of a sequence's cycles and jumps.
#[derive(Serialize)]
struct FoundSummary {
    sequence: String,
    frames: (u32, u32),
    does: &'static str,
    speed: f32,
    turn: f32,
    height: f32,
    length: f32,
    apart_mm: f32,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Told {
    found: Vec<FoundSummary>,
    proposed: Vec<ManifestFamily>,
    families: Vec<FamilySummary>,
}

/// Finds what cycles and says which families there could be, or makes the samples of families and writes them.
pub fn run(arguments: &FamilyArguments, terminal: &Terminal) -> Result<(), Failure> {
    if let Some(folder) = &arguments.output
        && folder.read_dir().is_ok_and(|mut entries| entries.next().is_some())
    {
        let error = anyhow!("{} is not empty; name a new folder, or empty it first", folder.display());
        return Err(Failure::Input(error));
    }
    let actor = read(&arguments.capture, &arguments.import, terminal)?;
    let Origin::Capture(imported) = &actor.origin else {
        let error =
            anyhow!("{} is a bundle: families are made of the capture that it was packed from", arguments.capture);
        return Err(Failure::Input(error));
    };
    let ground = Ground::of(&imported.capture);
    let recorded = ground.recorded(&imported.capture);
    let found = family::found(&recorded);
    let proposed = proposed(&recorded, &found);
    let told_found: Vec<FoundSummary> = found.iter().map(|one| summary(imported, one)).collect();
    let wanted = wanted(arguments, imported, &proposed)?;
    let Some(folder) = &arguments.output else {
        terminal.log(&table(&told_found, recorded.feet.count()));
        let told = Told { found: told_found, proposed: wanted, families: Vec::new() };
        return if arguments.json { print_json(&told) } else { print_text(&told.proposed) };
    };
    if wanted.is_empty() {
        terminal.log(&table(&told_found, recorded.feet.count()));
        let error = anyhow!(
            "no two sequences of {} do the same at another speed, turn, height or length: nothing can be made between them",
            arguments.capture
        );
        return Err(Failure::Input(error));
    }
    let report = |step| terminal.progress(step);
    let (made, warnings) = make(&imported.capture, &wanted, &Job::new(&report)).map_err(|error| match error.cause {
        family::FamilyError::Stopped(_) => Failure::StoppedReading,
        _ => Failure::Input(error.into()),
    })?;
    warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    write((arguments, folder), &actor, &made, terminal)?;
    let families: Vec<FamilySummary> = made.into_iter().map(|family| family.summary).collect();
    let text = serde_json::to_string_pretty(&families).map_err(|error| Failure::Internal(error.into()))?;
    write_whole(&folder.join("families.json"), text.as_bytes()).map_err(Failure::Input)?;
    families.iter().for_each(|family| terminal.log(&told(family)));
    if arguments.json {
        print_json(&Told { found: told_found, proposed: wanted, families })?;
    }
    Ok(())
}

/// The family that is typed, or those of the manifest, or those that are proposed.
fn wanted(
    arguments: &FamilyArguments,
    imported: &Imported,
    proposed: &[ManifestFamily],
) -> Result<Vec<ManifestFamily>, Failure> {
    let samples = arguments.samples.map(|count| FamilySamples::Count(count.into()));
    let samples = match arguments.at.is_empty() {
        true => samples,
        false => Some(FamilySamples::At(arguments.at.clone())),
    };
    if arguments.sequences.is_empty() {
        let all = if imported.families.is_empty() { proposed } else { &imported.families };
        let of_kind = |family: &&ManifestFamily| arguments.by.is_none_or(|kind| parameter(kind) == family.parameter);
        let with = |family: &ManifestFamily| {
            let samples = samples.clone().or_else(|| family.samples.clone());
            ManifestFamily { samples, ..family.clone() }
        };
        return Ok(all.iter().filter(of_kind).map(with).collect());
    }
    let known: Vec<&str> = imported.capture.timeline.sequences().iter().map(|one| one.name.as_str()).collect();
    if let Some(name) = arguments.sequences.iter().find(|name| !known.contains(&name.as_str())) {
        let error = anyhow!("there is no sequence {name:?}; there are: {}", known.join(", "));
        return Err(Failure::Input(error));
    }
    let kind = arguments.by.unwrap_or(FamilyKind::Speed);
    Ok(vec![ManifestFamily {
        name: arguments.family.clone().unwrap_or_else(|| arguments.sequences.join("-")),
        parameter: parameter(kind),
        sequences: arguments.sequences.clone(),
        samples,
        frames: None,
        values: None,
    }])
}

fn parameter(kind: FamilyKind) -> FamilyParameter {
    match kind {
        FamilyKind::Speed => FamilyParameter::Speed,
        FamilyKind::Turn => FamilyParameter::Turn,
        FamilyKind::Height => FamilyParameter::Height,
        FamilyKind::Length => FamilyParameter::Length,
    }
}

fn summary(imported: &Imported, found: &Found) -> FoundSummary {
    FoundSummary {
        sequence: imported.capture.timeline.sequences()[found.sequence].name.clone(),
        frames: found.frames,
        does: match found {
            Found { jumps: true, .. } => "jumps",
            Found { meets: true, .. } => "steps",
            _ => "steps, does not repeat well",
        },
        speed: found.speed,
        turn: found.turn,
        height: found.height,
        length: found.length,
        apart_mm: found.apart * 1e3,
    }
}

fn table(found: &[FoundSummary], feet: usize) -> String {
    if feet == 0 {
        return "nothing in this capture comes to rest on the ground: no cycle can be cut at contacts".into();
    }
    if found.is_empty() {
        return format!("{feet} feet stand, and no sequence steps or jumps: there is nothing to make a family of");
    }
    let mut lines = vec![format!(
        "{:<16} {:>11} {:>8} {:>9} {:>9} {:>9} {:>9}  does",
        "sequence", "frames", "m/s", "turn 1/m", "height m", "length m", "apart mm"
    )];
    for one in found {
        let frames = format!("{}-{}", one.frames.0, one.frames.1);
        lines.push(format!(
            "{:<16} {frames:>11} {:>8.2} {:>9.2} {:>9.2} {:>9.2} {:>9.0}  {}",
            one.sequence, one.speed, one.turn, one.height, one.length, one.apart_mm, one.does
        ));
    }
    lines.join("\n")
}

/// Text to paste into a manifest.
fn print_text(proposed: &[ManifestFamily]) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Families<'a> {
        family: &'a [ManifestFamily],
    }
    if proposed.is_empty() {
        return Ok(());
    }
    let text = toml::to_string(&Families { family: proposed }).map_err(|error| Failure::Internal(error.into()))?;
    super::output::print_text(text.trim_end())
}

/// Writes the frames of all samples, and the manifest last.
fn write(
    (arguments, folder): (&FamilyArguments, &Path),
    actor: &ReadActor,
    made: &[MadeFamily],
    terminal: &Terminal,
) -> Result<(), Failure> {
    // As the recorded frames are, so that texture coordinates have one layout.
    let ending = if is_ply(Path::new(&arguments.capture)) { "ply" } else { "obj" };
    let all: Vec<(&str, &[String], &Sample)> = made
        .iter()
        .flat_map(|family| family.summary.samples.iter().zip(&family.samples))
        .map(|(told, (labels, sample))| (told.sequence.as_str(), labels.as_slice(), sample))
        .collect();
    let folder_of = |k: usize| format!("sample_{k:03}");
    let mut new = Vec::new();
    for (k, &(name, labels, sample)) in all.iter().enumerate() {
        let worn = sample.worn().next().unwrap_or(0);
        let exported = actor.exported(name, &sample.poses[..1], worn)?;
        let pattern = folder.join(folder_of(k)).join(format!("%05d.{ending}"));
        let output = Output::parse(&pattern.to_string_lossy()).map_err(|error| Failure::Internal(error.into()))?;
        write_frames(actor, &exported, (name, &sample.poses), &output, &ExportOptions::default(), terminal)?;
        new.push(NewSequence {
            name,
            input: format!("{}/%05d.{ending}:0:{}", folder_of(k), sample.poses.len() - 1),
            texture: texture(actor, worn),
            labels,
            cyclic: sample.cyclic,
        });
    }
    let text = manifest(folder, (&arguments.capture, &arguments.import), actor.timeline.fps(), &new)
        .and_then(|text| with_texture(text, actor, folder, &folder_of(0)))
        .and_then(|text| {
            // What they ask for is there now.
            let mut table: Table = text.parse()?;
            table.insert("family".into(), Value::Array(made.iter().map(|family| there(&family.summary)).collect()));
            Ok(toml::to_string(&table)?)
        })
        .map_err(Failure::Input)?;
    let mut origin = String::from("# Samples of families (families.json):\n");
    for one in made.iter().flat_map(|family| &family.summary.samples) {
        let [from, to] = &one.between;
        origin.push_str(&format!("# {}: {from} and {to}, weight {:.3}\n", one.sequence, one.weight));
    }
    write_whole(&folder.join("capture.toml"), format!("{origin}\n{text}").as_bytes()).map_err(Failure::Input)
}

/// A family whose samples are there, as manifests have it.
fn there(family: &FamilySummary) -> Value {
    let mut table = Table::new();
    table.insert("name".into(), family.name.clone().into());
    table.insert("parameter".into(), family.parameter.into());
    let samples = family.samples.iter().map(|one| (&one.sequence, Value::Array(Vec::new()), one.value));
    let frames = |(first, last): (u32, u32)| Value::Array(vec![first.into(), last.into()]);
    let recorded = family.members.iter().map(|one| (&one.sequence, frames(one.frames), one.value));
    let all: Vec<_> = samples.chain(recorded).collect();
    table.insert("sequences".into(), all.iter().map(|one| one.0.clone().into()).collect::<Vec<Value>>().into());
    table.insert("frames".into(), all.iter().map(|one| one.1.clone()).collect::<Vec<Value>>().into());
    table.insert("values".into(), all.iter().map(|one| f64::from(one.2).into()).collect::<Vec<Value>>().into());
    table.into()
}

/// What came of a family, for people.
pub fn told(family: &FamilySummary) -> String {
    let members: Vec<String> = family
        .members
        .iter()
        .map(|one| format!("{} {}-{} {:.2}", one.sequence, one.frames.0, one.frames.1, one.value))
        .collect();
    let mut lines = vec![format!("{} by {} ({}): {}", family.name, family.parameter, family.unit, members.join(", "))];
    for one in &family.samples {
        let [from, to] = &one.between;
        let slide = one.slide_mm.map_or("no contact".into(), |slide| format!("slide {slide:.2} mm per 1/50 s"));
        lines.push(format!(
            "  {}: asked {:.2}, {} frames, {from} and {to} at {:.2}, {slide}, soles from {:.1} mm",
            one.sequence, one.asked, one.frames, one.weight, one.lowest_mm
        ));
    }
    lines.join("\n")
}
