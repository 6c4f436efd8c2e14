//! Families of a capture: what lies between its cycles, made as further sequences (docs/families.md).

use std::collections::HashSet;

use actor::capture::{Capture, Poses};
use actor::families::FamilyMember;
use actor::feet::Feet;
use actor::timeline::{Sequence, Timeline, TimelineError};
use capture_io::import::{DEFAULT_SAMPLES, FamilyParameter, FamilySamples, Imported, ManifestFamily, Warning};
use family::{Family, FamilyError, MEETS, Measured, Parameter, Part, Recorded, Sample, UNLIKE, Wanted};
use glam::Vec3;
use job::Job;
use serde::Serialize;

pub use crate::failure::FamilyFailure;
use crate::options::PackError;

/// What is met less well than this is told, as a part of what was asked.
const MISSED: f32 = 0.03;

/// A member of a family, as it is told.
#[derive(Clone, Debug, Serialize)]
pub struct MemberSummary {
    /// Its sequence.
    pub sequence: String,
    /// First and last frame of what was cut, within the sequence.
    pub frames: (u32, u32),
    /// What the family is asked by, measured.
    pub value: f32,
    /// How far its ends are apart before they are closed, in millimetres; 0 for a jump.
    pub apart_mm: f32,
}

/// A sample of a family, as it is told.
#[derive(Clone, Debug, Serialize)]
pub struct SampleSummary {
    /// Its sequence.
    pub sequence: String,
    /// The value that was asked for.
    pub asked: f32,
    /// What was measured.
    pub value: f32,
    /// The sequences that it lies between.
    pub between: [String; 2],
    /// Weight of the second of them.
    pub weight: f32,
    /// Frames.
    pub frames: usize,
    /// How far what touches the ground slides while it stands, in millimetres per fiftieth of a second.
    pub slide_mm: Option<f32>,
    /// The lowest point of a sole above the ground, in millimetres.
    pub lowest_mm: f32,
    /// For each frame the two recorded frames that it is blended of, counted over the capture.
    pub recipe: Vec<[u32; 2]>,
}

/// A family, as it is told: where its samples come from.
#[derive(Clone, Debug, Serialize)]
pub struct FamilySummary {
    /// Its name.
    pub name: String,
    /// By which number it is asked.
    pub parameter: &'static str,
    /// The unit of that.
    pub unit: &'static str,
    /// Its members, in the order of the parameter.
    pub members: Vec<MemberSummary>,
    /// How far members are from the first one at the same phase, at most: root of the mean square, in millimetres.
    pub unlike_mm: f32,
    /// Weights, counted on from member to member, and the parameter measured there.
    pub table: Vec<(f32, f32)>,
    /// Its samples.
    pub samples: Vec<SampleSummary>,
}

/// A family and the frames of its samples.
#[derive(Debug)]
pub struct MadeFamily {
    /// What is told of it.
    pub summary: FamilySummary,
    /// For each sample its behaviours and its frames.
    pub samples: Vec<(Vec<String>, Sample)>,
}

/// What the builder finds of a capture's feet, for families.
#[derive(Debug)]
pub struct Ground {
    feet: Feet,
    floors: Vec<f32>,
}

impl Ground {
    /// Finds feet and ground.
    #[must_use]
    pub fn of(capture: &Capture) -> Self {
        let feet = pipeline::feet::feet(&capture.topology, &capture.timeline, &capture.poses);
        Self { feet, floors: pipeline::contacts::floors(&capture.timeline, &capture.poses) }
    }

    /// The capture, as families see it.
    #[must_use]
    pub fn recorded<'a>(&'a self, capture: &'a Capture) -> Recorded<'a> {
        let Capture { topology, timeline, poses, .. } = capture;
        Recorded { topology, timeline, poses, feet: &self.feet, floors: &self.floors }
    }
}

/// What the capture's own cycles and jumps could be made, as a manifest would ask for it.
#[must_use]
pub fn proposed(recorded: &Recorded, found: &[family::Found]) -> Vec<ManifestFamily> {
    let name = |sequence: usize| recorded.timeline.sequences()[sequence].name.clone();
    family::proposals(recorded, found)
        .into_iter()
        .map(|proposal| {
            let Wanted { parameter, sequences } = proposal.wanted;
            let named = sequences.iter().any(|(_, frames)| frames.is_some());
            let frames = |(_, frames): &Part| frames.map_or_else(Vec::new, |(from, to)| vec![from, to]);
            ManifestFamily {
                name: proposal.name.into(),
                parameter: match parameter {
                    Parameter::Speed => FamilyParameter::Speed,
                    Parameter::Turn => FamilyParameter::Turn,
                    Parameter::Height => FamilyParameter::Height,
                    Parameter::Length => FamilyParameter::Length,
                },
                sequences: sequences.iter().map(|&(sequence, _)| name(sequence)).collect(),
                samples: None,
                values: None,
                frames: named.then(|| sequences.iter().map(frames).collect()),
            }
        })
        .collect()
}

/// Makes the samples of families.
///
/// # Errors
/// Sequences that are no family, or being asked to stop.
pub fn make(
    capture: &Capture,
    wanted: &[ManifestFamily],
    job: &Job,
) -> Result<(Vec<MadeFamily>, Vec<Warning>), FamilyFailure> {
    let ground = Ground::of(capture);
    let recorded = ground.recorded(capture);
    let mut taken = names(&capture.timeline);
    let mut warnings = Vec::new();
    let made: Result<Vec<MadeFamily>, FamilyFailure> =
        wanted.iter().map(|asked| make_one(&recorded, asked, &mut taken, &mut warnings, job)).collect();
    Ok((made?, warnings))
}

/// The names of all sequences.
pub(crate) fn names(timeline: &Timeline) -> HashSet<String> {
    timeline.sequences().iter().map(|one| one.name.clone()).collect()
}

/// Makes the samples of one family, under names that are not `taken`.
pub(crate) fn make_one(
    recorded: &Recorded,
    asked: &ManifestFamily,
    taken: &mut HashSet<String>,
    warnings: &mut Vec<Warning>,
    job: &Job,
) -> Result<MadeFamily, FamilyFailure> {
    let failure = |cause: FamilyError| FamilyFailure { name: asked.name.clone(), cause };
    let family = Family::new(*recorded, &resolved(recorded, asked), job).map_err(failure)?;
    warnings.extend(doubts(recorded, asked, &family));
    samples(recorded, (asked, &family), taken, warnings, job).map_err(failure)
}

/// A family by the numbers of its sequences; import has seen that they are there.
#[must_use]
pub fn resolved(recorded: &Recorded, asked: &ManifestFamily) -> Wanted {
    let number = |name: &String| recorded.timeline.sequences().iter().position(|one| one.name == *name);
    let sequences = asked.sequences.iter().enumerate();
    Wanted {
        parameter: parameter_of(asked.parameter),
        sequences: sequences.filter_map(|(k, name)| Some((number(name)?, asked.frames_of(k)))).collect(),
    }
}

fn parameter_of(asked: FamilyParameter) -> Parameter {
    match asked {
        FamilyParameter::Speed => Parameter::Speed,
        FamilyParameter::Turn => Parameter::Turn,
        FamilyParameter::Height => Parameter::Height,
        FamilyParameter::Length => Parameter::Length,
    }
}

/// What a family is asked by, as manifests have it.
fn word(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Speed => "speed",
        Parameter::Turn => "turn",
        Parameter::Height => "height",
        Parameter::Length => "length",
    }
}

/// What may be said of a family's members.
fn doubts(recorded: &Recorded, asked: &ManifestFamily, family: &Family) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (member, apart) in family.members().filter(|(member, _)| member.cyclic) {
        let sequence = &recorded.timeline.sequences()[member.sequence].name;
        if apart > MEETS * recorded.body() || member.seam == 0 {
            let why =
                if member.seam == 0 { ", and nothing is recorded before or after it to close it with" } else { "" };
            let message = format!(
                "family \"{}\": the ends of the cycle in \"{sequence}\" are {:.0} mm apart{why}; it may be seen to begin again: \
                 record a steadier one, or say with frames where one is",
                asked.name,
                apart * 1e3
            );
            warnings.push(Warning::new("W_FAMILY_SEAM", message));
        }
    }
    if family.unlike() > UNLIKE * recorded.body() {
        let message = format!(
            "family \"{}\": its members are {:.0} mm from each other at the same phase: they do not do the same, and what lies between \
             may lose volume or do neither; look at it",
            asked.name,
            family.unlike() * 1e3
        );
        warnings.push(Warning::new("W_FAMILY_UNLIKE", message));
    }
    if !family.is_monotone() {
        let message = format!(
            "family \"{}\": the {} does not grow all the way from the first cycle to the last; of several weights that give one \
             value the first is taken",
            asked.name,
            family.parameter()
        );
        warnings.push(Warning::new("W_FAMILY_UNEVEN", message));
    }
    warnings
}

/// Values in two decimals, where that stays within the family.
fn values(asked: &ManifestFamily, family: &Family) -> Vec<f32> {
    let (low, high) = family.range();
    match &asked.samples {
        Some(FamilySamples::At(values)) => values.clone(),
        samples => {
            let count = if let Some(FamilySamples::Count(count)) = samples { *count } else { DEFAULT_SAMPLES };
            let mut values: Vec<f32> =
                if count == 1 { vec![(low + high) / 2.0] } else { family.values(count as usize) };
            let last = values.len() - 1;
            for (k, value) in values.iter_mut().enumerate() {
                if count == 1 || (k > 0 && k < last) {
                    *value = ((*value * 100.0).round() / 100.0).clamp(low, high);
                }
            }
            values
        }
    }
}

fn samples(
    recorded: &Recorded,
    (asked, family): (&ManifestFamily, &Family),
    taken: &mut HashSet<String>,
    warnings: &mut Vec<Warning>,
    job: &Job,
) -> Result<MadeFamily, FamilyError> {
    use rayon::prelude::*;
    let parameter = family.parameter();
    let values = values(asked, family);
    let all: Vec<Result<Sample, FamilyError>> = values
        .par_iter()
        .enumerate()
        .map(|(k, &value)| {
            job.tell("samples", k as u64, values.len() as u64)?;
            family.ask(value)
        })
        .collect();
    let name_of = |sequence: usize| recorded.timeline.sequences()[sequence].name.clone();
    let (mut summaries, mut made) = (Vec::new(), Vec::new());
    for (&value, sample) in values.iter().zip(all) {
        let sample = sample?;
        let found = sample.measured.value(parameter);
        warnings.extend(missed(asked, family, value, found));
        let label = format!("{} {}", asked.name, parameter.told(found));
        let mut name = label.clone();
        while !taken.insert(name.clone()) {
            name.push('~');
        }
        let Measured { slide, lowest, .. } = sample.measured;
        summaries.push(SampleSummary {
            sequence: name,
            asked: value,
            value: found,
            between: sample.sequences.map(name_of),
            weight: sample.lambda,
            frames: sample.poses.len(),
            slide_mm: slide.map(|slide| slide * recorded.timeline.fps() / 50.0 * 1e3),
            lowest_mm: lowest * 1e3,
            recipe: sample.from.clone(),
        });
        made.push((vec![asked.name.clone(), label], sample));
    }
    let first = |sequence: usize| recorded.timeline.sequences()[sequence].first_frame;
    let values: Vec<f32> = family.member_values();
    let members = family.members().zip(values).map(|((member, apart), value)| MemberSummary {
        sequence: name_of(member.sequence),
        frames: {
            let within = |frame: Option<&u32>| frame.map_or(0, |frame| frame - first(member.sequence));
            (within(member.frames.first()), within(member.frames.last()))
        },
        value,
        apart_mm: apart * 1e3,
    });
    let summary = FamilySummary {
        name: asked.name.clone(),
        parameter: word(parameter),
        unit: parameter.unit(),
        members: members.collect(),
        unlike_mm: family.unlike() * 1e3,
        table: family.table().to_vec(),
        samples: summaries,
    };
    Ok(MadeFamily { summary, samples: made })
}

/// That a value was not met.
fn missed(asked: &ManifestFamily, family: &Family, value: f32, found: f32) -> Option<Warning> {
    let parameter = family.parameter();
    let (low, high) = family.range();
    let (told, got) = (parameter.told(value), parameter.told(found));
    let slack = MISSED * value.abs().max(parameter.grain());
    if value < low - slack || value > high + slack {
        let message = format!(
            "family \"{}\" has no {parameter} of {told}, only {} to {}: its nearest sample, {got}, is made",
            asked.name,
            parameter.told(low),
            parameter.told(high)
        );
        return Some(Warning::new("W_FAMILY_RANGE", message));
    }
    ((found - value).abs() > slack).then(|| {
        let message = format!("family \"{}\": asked for {told}, its sample has {got}", asked.name);
        Warning::new("W_FAMILY_MISSED", message)
    })
}

/// Adds the samples of the families that manifests ask for to a capture, as sequences, and tells its timeline what families there
/// are. Samples have the looks of the recorded frames that they are nearer to.
pub(crate) fn add(imported: &mut Imported, job: &Job) -> Result<Vec<FamilySummary>, PackError> {
    if imported.families.is_empty() {
        return Ok(Vec::new());
    }
    let (there, wanted): (Vec<_>, Vec<_>) =
        imported.families.iter().cloned().partition(|family| family.values.is_some());
    let (made, warnings) = make(&imported.capture, &wanted, job)?;
    imported.warnings.extend(warnings);
    append(imported, &made)?;
    let timeline = &imported.capture.timeline;
    let mut families: Vec<_> = made.iter().map(|family| of_made(&family.summary, timeline)).collect();
    families.extend(there.iter().map(|family| of_manifest(family, timeline)));
    imported.capture.timeline = timeline.clone().with_families(families).map_err(wrong)?;
    Ok(made.into_iter().map(|family| family.summary).collect())
}

fn wrong(error: TimelineError) -> PackError {
    PackError::Option(error.to_string())
}

/// Adds samples to a capture as sequences.
pub(crate) fn append(imported: &mut Imported, made: &[MadeFamily]) -> Result<(), PackError> {
    let capture = &imported.capture;
    let mut sequences = capture.timeline.sequences().to_vec();
    let mut positions: Vec<Vec3> = capture.poses.iter().flatten().copied().collect();
    let mut worn: Vec<u32> = (0..capture.timeline.frame_count()).collect();
    for family in made {
        for (told, (labels, sample)) in family.summary.samples.iter().zip(&family.samples) {
            sequences.push(Sequence {
                name: told.sequence.clone(),
                labels: labels.clone(),
                first_frame: worn.len() as u32,
                frame_count: sample.poses.len() as u32,
                cyclic: sample.cyclic,
            });
            sample.poses.iter().for_each(|pose| positions.extend(pose));
            worn.extend(sample.worn());
        }
    }
    let poses = Poses::from_positions(capture.topology.vertex_count(), positions);
    let timeline = Timeline::new(capture.timeline.fps(), sequences).map_err(wrong)?;
    let timeline = timeline.with_families(capture.timeline.families().to_vec()).map_err(wrong)?;
    if let Some(textures) = &mut imported.frame_textures {
        *textures = worn.iter().map(|&frame| textures[frame as usize].clone()).collect();
    }
    if !imported.frame_masks.is_empty() {
        let masks = &imported.frame_masks;
        imported.frame_masks = worn.iter().map(|&frame| masks[frame as usize].clone()).collect();
    }
    imported.capture.timeline = timeline;
    imported.capture.poses = poses;
    Ok(())
}

/// A part of a sequence, given by its frames within it, as a member; of a sequence that is not there no frame is.
fn member(timeline: &Timeline, sequence: &str, frames: Option<(u32, u32)>, value: f32) -> FamilyMember {
    let found = timeline.sequences().iter().find(|one| one.name == sequence);
    let (begin, count) = found.map_or((0, 0), |one| (one.first_frame, one.frame_count));
    let (first, last) = frames.unwrap_or((0, count.saturating_sub(1)));
    FamilyMember { sequence: sequence.into(), frames: [begin + first, begin + last], value }
}

/// A family that was made, as actors have it: its samples, which go on for ever, then what was recorded.
fn of_made(told: &FamilySummary, timeline: &Timeline) -> actor::families::Family {
    let samples = told.samples.iter().map(|one| member(timeline, &one.sequence, None, one.value));
    let recorded = told.members.iter().map(|one| member(timeline, &one.sequence, Some(one.frames), one.value));
    let (name, parameter, unit) = (told.name.clone(), told.parameter.into(), told.unit.into());
    actor::families::Family { name, parameter, unit, members: samples.chain(recorded).collect() }
}

/// A family whose members are all there, as actors have it.
fn of_manifest(family: &ManifestFamily, timeline: &Timeline) -> actor::families::Family {
    let parameter = parameter_of(family.parameter);
    let values = family.values.iter().flatten();
    let members = (0..).zip(&family.sequences).zip(values);
    actor::families::Family {
        name: family.name.clone(),
        parameter: word(parameter).into(),
        unit: parameter.unit().into(),
        members: members
            .map(|((index, sequence), &value)| member(timeline, sequence, family.frames_of(index), value))
            .collect(),
    }
}
