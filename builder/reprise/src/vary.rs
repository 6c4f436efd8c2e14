//! Variations of a capture's sequences on the way to its bundle: as alternatives of what was recorded, as `builder pack` makes them by itself, or as
//! sequences beside it (`builder vary`).

use std::collections::{BTreeMap, HashSet};
use std::ops::Range;

use actor::alternatives::Alternatives;
use actor::capture::{Capture, Poses};
use actor::feet::Feet;
use actor::motion::Motion;
use actor::timeline::{Sequence, Timeline};
use capture_io::import::{Imported, Warning};
use glam::Vec3;
use job::Job;
use motion::seen::{Seen, Variation};
use motion::vary::Varied;
pub use motion::vary::VaryOptions;
use serde::Serialize;

use crate::families::FamilySummary;
use crate::options::PackError;
pub use crate::options::Variations;
use crate::varied_families;

/// What came of one sequence.
#[derive(Clone, Debug, Serialize)]
pub struct VariedSequence {
    /// Its name.
    pub name: String,
    /// Variations.
    pub variations: usize,
    /// Stretches of all of them.
    pub stretches: usize,
    /// Of these the ones that keep the recording: what was drawn went too far.
    pub rejected: usize,
    /// The share of slides of the chains that were accepted.
    pub accepted: f64,
    /// Mean distance of a vertex from where it was recorded, in metres.
    pub distance: f64,
    /// Mean distance between the shapes of two variations in the body's own frame, in metres.
    pub diversity: f64,
    /// Mean acceleration of a vertex over that of the recording.
    pub acceleration: f64,
    /// Mean change of an edge's length, as a part of it.
    pub edges: f64,
}

/// What came of storing variations as alternatives.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AlternativesSummary {
    /// Stretches that have alternatives.
    pub stretches: usize,
    /// Alternatives of all stretches.
    pub alternatives: usize,
    /// Modes over the surface.
    pub modes: usize,
    /// Mean distance of a vertex from where the variation has it, in metres.
    pub error: f64,
    /// The largest one.
    pub most: f64,
    /// Bytes of the section.
    pub bytes: usize,
}

/// The variations of a capture's sequences, as they were learned.
pub(crate) struct Learned {
    chosen: Vec<usize>,
    varied: Vec<Varied>,
    feet: Feet,
    pub told: Vec<VariedSequence>,
}

/// What was learned, and what for.
pub(crate) struct Made<'a> {
    wanted: &'a Variations,
    pub learned: Learned,
}

/// Learns the variations that are wanted, and adds those that become sequences; `None` where none are wanted, or those that are usual
/// cannot be had.
pub(crate) fn made<'a>(
    imported: &mut Imported,
    families: &[FamilySummary],
    wanted: Option<&'a Variations>,
    job: &Job,
) -> Result<Option<Made<'a>>, PackError> {
    let Some(wanted) = wanted else { return Ok(None) };
    let samples = varied_families::samples(families);
    let learned = learn(&imported.capture, wanted, &samples, &mut imported.warnings, job);
    let Some(learned) = if_usual(learned, wanted, &mut imported.warnings)? else { return Ok(None) };
    if wanted.as_sequences {
        let varied = add_sequences(imported, &learned, wanted.options.count)?;
        varied_families::add(imported, families, &varied, job)?;
    }
    Ok(Some(Made { wanted, learned }))
}

/// Variations as they are stored, where they are no sequences.
pub(crate) fn stored(
    made: Option<&Made>,
    capture: &Capture,
    warnings: &mut Vec<Warning>,
    job: &Job,
) -> Result<Option<(Alternatives, AlternativesSummary)>, PackError> {
    let Some(Made { wanted, learned }) = made.filter(|made| !made.wanted.as_sequences) else { return Ok(None) };
    if_usual(alternatives(capture, learned, wanted.options.count, job), wanted, warnings)
}

/// What came of it; nothing but a warning where it failed and nobody asked for it.
fn if_usual<T>(
    found: Result<T, PackError>,
    wanted: &Variations,
    warnings: &mut Vec<Warning>,
) -> Result<Option<T>, PackError> {
    match found {
        Err(error) if wanted.usual && !error.is_stopped() => {
            let message = format!("nothing is varied, for {error}");
            warnings.push(Warning::new("W_VARIATIONS", message));
            Ok(None)
        }
        found => found.map(Some),
    }
}

/// Learns how sequences of a capture move, and draws variations.
///
/// Sequences named in `besides` get theirs otherwise, where sequences are made of variations.
fn learn(
    capture: &Capture,
    wanted: &Variations,
    besides: &HashSet<String>,
    warnings: &mut Vec<Warning>,
    job: &Job,
) -> Result<Learned, PackError> {
    let timeline = &capture.timeline;
    let mut chosen = chosen(timeline, &wanted.sequences)?;
    if wanted.as_sequences {
        chosen.retain(|&index| !besides.contains(&timeline.sequences()[index].name));
    }
    let feet = pipeline::feet::feet(&capture.topology, timeline, &capture.poses);
    let (mut varied, mut told) = (Vec::new(), Vec::new());
    for &index in &chosen {
        let original = &timeline.sequences()[index];
        let frames = (original.first_frame..original.end_frame(), timeline.fps());
        let one = motion::vary::vary(&capture.poses, &capture.topology, frames, &wanted.options, job)?;
        let mut measures = Measures::default();
        let seen = Seen::new(&one, &capture.poses, &feet, None);
        (0..wanted.options.count).for_each(|number| measures.add(capture, one.frames(), &seen.variation(number)));
        told.push(summary(original.name.clone(), &one, &measures, &wanted.options));
        // Who did not ask for variations has no amount to change.
        if one.rejected > 0 && !wanted.usual {
            warnings.push(rejected(told.last()));
        }
        varied.push(one);
    }
    Ok(Learned { chosen, varied, feet, told })
}

/// The variations as alternatives of recorded stretches.
fn alternatives(
    capture: &Capture,
    learned: &Learned,
    count: usize,
    job: &Job,
) -> Result<(Alternatives, AlternativesSummary), PackError> {
    let mut source = capture.poses.clone();
    let motion = Motion::measure(&capture.timeline, capture.topology.weights(), &mut source)
        .map_err(|error| PackError::Option(error.to_string()))?;
    let (all, stored) =
        motion::alternatives::alternatives(capture, &learned.feet, &motion.facings, &learned.varied, count, job)?;
    let summary = AlternativesSummary {
        stretches: all.stretches().len(),
        alternatives: all.stretches().iter().map(|stretch| stretch.coefficients.len()).sum(),
        modes: all.modes().len(),
        error: stored.error,
        most: stored.most,
        bytes: 0,
    };
    Ok((all, summary))
}

/// Adds variations to a capture as sequences, which have the looks of the frames that they vary; for each sequence that is varied
/// the names of its variations.
fn add_sequences(
    imported: &mut Imported,
    learned: &Learned,
    count: usize,
) -> Result<BTreeMap<String, Vec<String>>, PackError> {
    let capture = &imported.capture;
    let timeline = &capture.timeline;
    let mut sequences = timeline.sequences().to_vec();
    let mut positions: Vec<Vec3> = capture.poses.iter().flatten().copied().collect();
    let mut source_of_frame: Vec<u32> = (0..timeline.frame_count()).collect();
    let mut added: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut names: HashSet<String> = sequences.iter().map(|sequence| sequence.name.clone()).collect();
    for (&index, varied) in learned.chosen.iter().zip(&learned.varied) {
        let original = &timeline.sequences()[index];
        // What shows the behaviour "walk" is the recorded walk and its variations.
        if original.labels.is_empty() {
            sequences[index].labels.push(original.name.clone());
        }
        for number in 0..count {
            let mut name = format!("{}~{}", original.name, number + 1);
            while !names.insert(name.clone()) {
                name.push('~');
            }
            added.entry(original.name.clone()).or_default().push(name.clone());
            let first_frame = source_of_frame.len() as u32;
            sequences.push(Sequence { name, first_frame, ..sequences[index].clone() });
            source_of_frame.extend(varied.frames());
            varied.poses(number, &capture.poses, &learned.feet).into_iter().for_each(|pose| positions.extend(pose));
        }
    }
    let poses = Poses::from_positions(capture.topology.vertex_count(), positions);
    let timeline = Timeline::new(timeline.fps(), sequences)
        .and_then(|more| more.with_families(timeline.families().to_vec()))
        .map_err(|error| PackError::Option(error.to_string()))?;
    if let Some(textures) = &mut imported.frame_textures {
        *textures = source_of_frame.iter().map(|&frame| textures[frame as usize].clone()).collect();
    }
    if !imported.frame_masks.is_empty() {
        let masks = &imported.frame_masks;
        imported.frame_masks = source_of_frame.iter().map(|&frame| masks[frame as usize].clone()).collect();
    }
    imported.capture.timeline = timeline;
    imported.capture.poses = poses;
    Ok(added)
}

/// The sequences of these names or labels.
fn chosen(timeline: &Timeline, wanted: &[String]) -> Result<Vec<usize>, PackError> {
    let sequences = timeline.sequences();
    if wanted.is_empty() {
        return Ok((0..sequences.len()).collect());
    }
    let mut chosen = Vec::new();
    for name in wanted {
        let before = chosen.len();
        let shows = |sequence: &Sequence| sequence.name == *name || sequence.labels.contains(name);
        chosen.extend(sequences.iter().enumerate().filter(|(_, sequence)| shows(sequence)).map(|(index, _)| index));
        if chosen.len() == before {
            let known: Vec<&str> = sequences.iter().map(|sequence| sequence.name.as_str()).collect();
            return Err(PackError::Option(format!("there is no sequence {name:?}; there are: {}", known.join(", "))));
        }
    }
    chosen.sort_unstable();
    chosen.dedup();
    Ok(chosen)
}

fn rejected(told: Option<&VariedSequence>) -> Warning {
    let (name, rejected, stretches) = told.map_or(("", 0, 0), |told| (&told.name, told.rejected, told.stretches));
    let message = format!(
        "\"{name}\": {rejected} of {stretches} stretches keep the recorded motion, for what was drawn went too far from it; a \
         smaller --amount keeps nearer"
    );
    Warning::new("W_VARIATION_REJECTED", message)
}

fn summary(name: String, varied: &Varied, measures: &Measures, options: &VaryOptions) -> VariedSequence {
    VariedSequence {
        name,
        variations: options.count,
        stretches: varied.stretches,
        rejected: varied.rejected,
        accepted: varied.accepted,
        distance: measures.distance / measures.frames.max(1.0),
        diversity: varied.diversity(),
        acceleration: measures.acceleration[0] / measures.acceleration[1].max(f64::MIN_POSITIVE),
        edges: measures.edges / measures.frames.max(1.0),
    }
}

/// One frame of so many is looked at, with those beside it.
const MEASURED: usize = 16;

/// Sums over frames of variations.
#[derive(Default)]
struct Measures {
    frames: f64,
    distance: f64,
    /// Of the variations, of the recording.
    acceleration: [f64; 2],
    edges: f64,
}

impl Measures {
    fn add(&mut self, capture: &Capture, frames: Range<u32>, variation: &Variation) {
        let mean = |of: &dyn Fn(usize) -> f32, count: usize| {
            (0..count).map(|k| f64::from(of(k))).sum::<f64>() / count.max(1) as f64
        };
        let (vertices, triangles) = (capture.topology.vertex_count(), capture.topology.triangles());
        // From within its first and last frame, which have none beside them.
        let inner = frames.start + 1..frames.end.saturating_sub(1);
        let offset = (inner.len() / 2) % MEASURED;
        for frame in inner.skip(offset).step_by(MEASURED) {
            let recorded = [frame - 1, frame, frame + 1].map(|frame| capture.poses.frame(frame));
            let own = [frame - 1, frame, frame + 1].map(|frame| variation.pose(frame));
            self.frames += 1.0;
            self.distance += mean(&|v| own[1][v].distance(recorded[1][v]), vertices);
            let change = |t: usize| {
                let [a, b, _] = triangles[t].map(|v| v as usize);
                let was = recorded[1][a].distance(recorded[1][b]).max(1e-6);
                (own[1][a].distance(own[1][b]) / was - 1.0).abs()
            };
            self.edges += mean(&change, triangles.len());
            let bend = |before: Vec3, here: Vec3, after: Vec3| (before + after - 2.0 * here).length();
            self.acceleration[0] += mean(&|v| bend(own[0][v], own[1][v], own[2][v]), vertices);
            self.acceleration[1] += mean(&|v| bend(recorded[0][v], recorded[1][v], recorded[2][v]), vertices);
        }
    }
}
