//! `builder vary`: the whole pipeline, on a capture with variations of its sequences beside them.

use std::collections::HashSet;

use actor::capture::{Capture, Poses};
use actor::timeline::{Sequence, Timeline};
use capture_io::import::{Imported, Warning};
use glam::Vec3;
use job::Job;
use motion::vary::Varied;
pub use motion::vary::VaryOptions;
use serde::Serialize;

use crate::options::PackError;

/// Which sequences get variations, and which.
#[derive(Clone, Debug, Default)]
pub struct Variations {
    /// Names or labels of the sequences; all where there is none.
    pub sequences: Vec<String>,
    /// How they are varied.
    pub options: VaryOptions,
}

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

/// Adds variations to the sequences of a capture. They have the looks of the frames that they vary.
pub(crate) fn add_variations(
    imported: &mut Imported,
    wanted: &Variations,
    job: &Job,
) -> Result<Vec<VariedSequence>, PackError> {
    let chosen = chosen(&imported.capture.timeline, &wanted.sequences)?;
    let capture = &imported.capture;
    let (timeline, weights) = (&capture.timeline, capture.topology.weights());
    let feet = pipeline::feet::feet(&capture.topology, timeline, &capture.poses);
    let mut sequences = timeline.sequences().to_vec();
    let mut positions: Vec<Vec3> = capture.poses.iter().flatten().copied().collect();
    let mut source_of_frame: Vec<u32> = (0..timeline.frame_count()).collect();
    let mut names: HashSet<String> = sequences.iter().map(|sequence| sequence.name.clone()).collect();
    let mut told = Vec::new();
    for index in chosen {
        let original = timeline.sequences()[index].clone();
        let frames = original.first_frame..original.end_frame();
        let varied =
            motion::vary::vary(&capture.poses, weights, (frames.clone(), timeline.fps()), &wanted.options, job)?;
        // What shows the behaviour "walk" is the recorded walk and its variations.
        if original.labels.is_empty() {
            sequences[index].labels.push(original.name.clone());
        }
        let mut measures = Measures::default();
        for number in 0..wanted.options.count {
            let poses = varied.poses(number, &capture.poses, &feet);
            measures.add(capture, frames.start, &poses);
            let mut name = format!("{}~{}", original.name, number + 1);
            while !names.insert(name.clone()) {
                name.push('~');
            }
            let first_frame = source_of_frame.len() as u32;
            sequences.push(Sequence { name, first_frame, ..sequences[index].clone() });
            source_of_frame.extend(frames.clone());
            poses.into_iter().for_each(|pose| positions.extend(pose));
        }
        told.push(summary(original.name, &varied, &measures, &wanted.options));
        if varied.rejected > 0 {
            imported.warnings.push(rejected(told.last()));
        }
    }
    let poses = Poses::from_positions(capture.topology.vertex_count(), positions);
    let timeline = Timeline::new(timeline.fps(), sequences).map_err(|error| PackError::Option(error.to_string()))?;
    if let Some(textures) = &mut imported.frame_textures {
        *textures = source_of_frame.iter().map(|&frame| textures[frame as usize].clone()).collect();
    }
    if !imported.frame_masks.is_empty() {
        let masks = &imported.frame_masks;
        imported.frame_masks = source_of_frame.iter().map(|&frame| masks[frame as usize].clone()).collect();
    }
    imported.capture.timeline = timeline;
    imported.capture.poses = poses;
    Ok(told)
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
    fn add(&mut self, capture: &Capture, first: u32, poses: &[Vec<Vec3>]) {
        let recorded = |k: usize| capture.poses.frame(first + k as u32);
        let mean = |of: &dyn Fn(usize) -> f32, count: usize| {
            (0..count).map(|k| f64::from(of(k))).sum::<f64>() / count.max(1) as f64
        };
        let (vertices, triangles) = (capture.topology.vertex_count(), capture.topology.triangles());
        for (k, pose) in poses.iter().enumerate() {
            self.frames += 1.0;
            self.distance += mean(&|v| pose[v].distance(recorded(k)[v]), vertices);
            let change = |t: usize| {
                let [a, b, _] = triangles[t].map(|v| v as usize);
                let was = recorded(k)[a].distance(recorded(k)[b]).max(1e-6);
                (pose[a].distance(pose[b]) / was - 1.0).abs()
            };
            self.edges += mean(&change, triangles.len());
            if k > 0 && k + 1 < poses.len() {
                let bend = |before: Vec3, here: Vec3, after: Vec3| (before + after - 2.0 * here).length();
                self.acceleration[0] += mean(&|v| bend(poses[k - 1][v], pose[v], poses[k + 1][v]), vertices);
                self.acceleration[1] +=
                    mean(&|v| bend(recorded(k - 1)[v], recorded(k)[v], recorded(k + 1)[v]), vertices);
            }
        }
    }
}
