//! `builder transfer`: an actor moves as another one does, learned from a file of key poses.

use actor::capture::Poses;
use actor::feet::Feet;
use actor::motion::Motion;
use actor::timeline::{Sequence, Timeline};
use capture_io::import::Warning;
use glam::Vec3;
use job::Job;
use kernels::topology::Topology;
use parts::Parts;
use serde::{Deserialize, Serialize};
use thiserror::Error;
use transfer::{Dense, Key, Model, Subject};
pub use transfer::{Kernel, TransferError, TransferOptions};

use crate::frame_maps::{MappedFrames, named_maps};

/// Where pairs agree less than this, source and target share little.
const LEAST_AGREEMENT: f64 = 0.3;

/// Who does it, or whom it is done like.
#[derive(Clone, Copy, Debug)]
pub struct TransferActor<'a> {
    /// Its mesh.
    pub topology: &'a Topology,
    /// Its sequences.
    pub timeline: &'a Timeline,
    /// What was recorded.
    pub poses: &'a Poses,
    /// The number of each vertex's part of the body, where parts were painted.
    pub parts: Option<&'a [u8]>,
}

/// A file of key poses: `keys.toml` (docs/transfer.md).
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyFile {
    /// Pairs of poses that mean the same.
    #[serde(default, rename = "pair")]
    pub pairs: Vec<KeyPair>,
}

/// Two poses that mean the same.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyPair {
    /// Sequence of the source.
    pub from: String,
    /// Frame in it, from 0.
    pub from_frame: u32,
    /// Sequence of the target.
    pub to: String,
    /// Frame in it, from 0.
    pub to_frame: u32,
    /// A name of the stretch that it belongs to: frames are matched between keys of one stretch, not from one to the next.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stretch: Option<String>,
}

/// Why nothing was transferred.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TransferFailure {
    /// A pair of the file names a sequence that is not there.
    #[error("pair {pair} of the keys: the {which} has no sequence {name:?}; it has: {known}")]
    Sequence {
        /// The pair, counted from 1.
        pair: usize,
        /// Source or target.
        which: &'static str,
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A pair of the file names a frame that is not there.
    #[error("pair {pair} of the keys: sequence {name:?} of the {which} has no frame {frame}, but 0 to {last}")]
    Frame {
        /// The pair, counted from 1.
        pair: usize,
        /// Source or target.
        which: &'static str,
        /// The sequence.
        name: String,
        /// The frame.
        frame: u32,
        /// The sequence's last frame.
        last: u32,
    },
    /// A sequence that is to be transferred is not there.
    #[error("the source has no sequence or label {name:?}; it has: {known}")]
    Wanted {
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// Nothing can be learned, or shown.
    #[error(transparent)]
    Transfer(#[from] TransferError),
}

impl TransferFailure {
    /// Whether it was asked to stop.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        matches!(self, Self::Transfer(TransferError::Stopped(_)))
    }
}

/// A sequence of the source, as the target does it.
#[derive(Clone, Debug)]
pub struct TransferredSequence {
    /// The sequence of the source.
    pub sequence: Sequence,
    /// The target's poses, at its own frame rate, in metres.
    pub poses: Vec<Vec<Vec3>>,
    /// The recorded frame of the target that is most like it, for its looks.
    pub worn: u32,
    /// How far soles slide from frame to frame while they stand, in metres, on average; none without feet.
    pub slide: Option<f32>,
    /// Whether keys name it: others are moved by what was learned elsewhere.
    pub has_keys: bool,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Transferred {
    /// The sequences.
    pub sequences: Vec<TransferredSequence>,
    /// Figures.
    pub summary: TransferSummary,
    /// Which frames were found to belong together, stretch by stretch.
    pub maps: Vec<MappedFrames>,
    /// What is not as one might think.
    pub warnings: Vec<Warning>,
}

/// Figures of a transfer.
#[derive(Clone, Debug, Serialize)]
pub struct TransferSummary {
    /// Keys.
    pub keys: usize,
    /// Pairs of frames that were found between them.
    pub pairs: usize,
    /// Pairs that were learned from.
    pub learned: usize,
    /// Parts of the body that were learned apart.
    pub parts: usize,
    /// Whether bones of both carry the pose, and maps learn what they leave over.
    pub bones: bool,
    /// What a metre of the source's way is for the target.
    pub ratio: f64,
    /// How much of the target's poses some pairs foretell of others: 1 for all, 0 where the mean pose would do as well; none of too
    /// few pairs.
    pub agreement: Option<f64>,
    /// Keys that look wrong.
    pub doubts: Vec<DoubtedKey>,
}

/// A key that looks wrong.
#[derive(Clone, Debug, Serialize)]
pub struct DoubtedKey {
    /// The key.
    pub key: KeyPair,
    /// The frame of the source's sequence that looks right.
    pub better_from_frame: f64,
    /// How far off the key is, in frames of the target.
    pub off: f64,
}

/// Transfers the sequences of `source` that `wanted` names, or all, onto `target`.
///
/// # Errors
/// Keys that name what is not there or contradict each other, or too few; being asked to stop.
pub fn transfer(
    source: &TransferActor,
    target: &TransferActor,
    (keys, wanted): (&KeyFile, &[String]),
    options: &TransferOptions,
    job: &Job,
) -> Result<Transferred, TransferFailure> {
    let resolved = resolve(keys, source.timeline, target.timeline)?;
    let chosen = chosen(source.timeline, wanted)?;
    job.begin("parts of the bodies").map_err(TransferError::from)?;
    let feet = [feet_of(source), feet_of(target)];
    let (source, target) = (subject(source, &feet[0]), subject(target, &feet[1]));
    let Dense { pairs, doubts, agreement, maps } = transfer::densify(&source, &target, &resolved, options, job)?;
    let model = Model::learn(&source, &target, &pairs, options, job)?;
    let doubts: Vec<DoubtedKey> = doubts
        .iter()
        .map(|doubt| DoubtedKey {
            key: named(&doubt.key, &source, &target),
            better_from_frame: doubt.better - f64::from(first_of(source.timeline, doubt.key.source)),
            off: doubt.off,
        })
        .collect();
    let mut warnings: Vec<Warning> = doubts.iter().map(doubted).collect();
    warnings.extend(agreement.and_then(unlike));
    warnings.extend(limits(&source, &target, &model, options));
    let mut sequences = Vec::new();
    for sequence in chosen {
        let times = model.times(sequence);
        let poses = model.frames(&times, job)?;
        let slide = model.slide(&times, &poses);
        let has_keys = resolved.iter().any(|key| sequence.contains(key.source));
        let worn = worn(&pairs, sequence);
        sequences.push(TransferredSequence { sequence: sequence.clone(), poses, worn, slide, has_keys });
    }
    let summary = TransferSummary {
        keys: resolved.len(),
        pairs: pairs.len(),
        learned: model.learned,
        parts: model.parts(),
        bones: model.has_bones(),
        ratio: model.ratio(),
        agreement,
        doubts,
    };
    let stretch = |number: u32| keys.pairs.get(number.checked_sub(1)? as usize)?.stretch.clone();
    let maps = named_maps(&maps, source.timeline, target.timeline, stretch);
    Ok(Transferred { sequences, summary, maps, warnings })
}

fn feet_of(actor: &TransferActor) -> Feet {
    pipeline::feet::feet(actor.topology, actor.timeline, actor.poses)
}

fn subject<'a>(actor: &TransferActor<'a>, feet: &'a Feet) -> Subject<'a> {
    let parts = match actor.parts {
        Some(painted) => Parts::of_painted(actor.topology, actor.poses, painted),
        None => Parts::find(actor.topology, actor.poses),
    };
    let mut source = actor.poses.clone();
    // Poses in memory can all be read.
    let motion = Motion::measure(actor.timeline, actor.topology.weights(), &mut source);
    let motion = motion.unwrap_or_else(|_| Motion {
        centres: vec![Vec3::ZERO; actor.poses.len()],
        facings: vec![0.0; actor.poses.len()],
        wraps: Vec::new(),
    });
    Subject::new((actor.topology, actor.timeline, actor.poses), &motion, feet, parts)
}

/// The keys by frames of the captures.
fn resolve(keys: &KeyFile, source: &Timeline, target: &Timeline) -> Result<Vec<Key>, TransferFailure> {
    let frame = |index: usize, which: &'static str, timeline: &Timeline, name: &str, frame: u32| {
        let found = timeline.sequences().iter().find(|sequence| sequence.name == name);
        let Some(sequence) = found else {
            return Err(TransferFailure::Sequence {
                pair: index + 1,
                which,
                name: name.into(),
                known: known(timeline),
            });
        };
        if frame >= sequence.frame_count {
            let last = sequence.frame_count - 1;
            return Err(TransferFailure::Frame { pair: index + 1, which, name: name.into(), frame, last });
        }
        Ok(sequence.first_frame + frame)
    };
    // The first pair that names a stretch gives it its number; 0 has no name.
    let stretch = |pair: &KeyPair| {
        let first =
            pair.stretch.as_ref().and_then(|_| keys.pairs.iter().position(|other| other.stretch == pair.stretch));
        first.map_or(0, |first| first as u32 + 1)
    };
    let key = |(index, pair): (usize, &KeyPair)| {
        Ok(Key {
            source: frame(index, "source", source, &pair.from, pair.from_frame)?,
            target: frame(index, "target", target, &pair.to, pair.to_frame)?,
            stretch: stretch(pair),
        })
    };
    keys.pairs.iter().enumerate().map(key).collect()
}

fn known(timeline: &Timeline) -> String {
    let names: Vec<&str> = timeline.sequences().iter().map(|sequence| sequence.name.as_str()).collect();
    names.join(", ")
}

/// The sequences of these names or labels; all where none is given.
fn chosen<'a>(timeline: &'a Timeline, wanted: &[String]) -> Result<Vec<&'a Sequence>, TransferFailure> {
    let shows = |sequence: &Sequence, name: &String| sequence.name == *name || sequence.labels.contains(name);
    let missing = |name: &&String| !timeline.sequences().iter().any(|sequence| shows(sequence, name));
    if let Some(name) = wanted.iter().find(missing) {
        return Err(TransferFailure::Wanted { name: name.clone(), known: known(timeline) });
    }
    let is_wanted = |sequence: &&Sequence| wanted.is_empty() || wanted.iter().any(|name| shows(sequence, name));
    Ok(timeline.sequences().iter().filter(is_wanted).collect())
}

fn first_of(timeline: &Timeline, frame: u32) -> u32 {
    timeline.sequence_of(frame).map_or(0, |sequence| sequence.first_frame)
}

fn named(key: &Key, source: &Subject, target: &Subject) -> KeyPair {
    let name = |timeline: &Timeline, frame: u32| {
        timeline.sequence_of(frame).map_or((String::new(), 0), |s| (s.name.clone(), frame - s.first_frame))
    };
    let ((from, from_frame), (to, to_frame)) = (name(source.timeline, key.source), name(target.timeline, key.target));
    KeyPair { from, from_frame, to, to_frame, stretch: None }
}

fn doubted(doubt: &DoubtedKey) -> Warning {
    let KeyPair { from, from_frame, to, to_frame, .. } = &doubt.key;
    let message = format!(
        "the key {from} {from_frame} -> {to} {to_frame} looks wrong by {:.1} frames: {to} {to_frame} is more like {from} {:.0}; it was \
         not trusted",
        doubt.off, doubt.better_from_frame
    );
    Warning::new("W_TRANSFER_KEY", message)
}

/// That what pairs say does not hold for each other.
fn unlike(agreement: f64) -> Option<Warning> {
    let message = format!(
        "source and target seem to share little between the keys: what is learned from most of the matched frames foretells {:.0} % of the \
         rest; name only stretches in which both do the same",
        100.0 * agreement.max(0.0)
    );
    (agreement < LEAST_AGREEMENT).then(|| Warning::new("W_TRANSFER_SHARE", message))
}

/// What could not be done as for most bodies.
fn limits(source: &Subject, target: &Subject, model: &Model, options: &TransferOptions) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let [from, to] = [source, target].map(|subject| subject.parts.limbs.len());
    if model.parts() == 1 && !options.whole {
        let message = format!(
            "the source has {from} limbs and the target {to}: the body is learned as a whole, and what was not seen is made less well"
        );
        warnings.push(Warning::new("W_TRANSFER_WHOLE", message));
    }
    if options.hold && !model.holds() {
        let [from, to] = [source, target].map(|subject| subject.feet.count());
        let message =
            format!("{from} feet stand in the source and {to} in the target: no sole is held, and feet may slide");
        warnings.push(Warning::new("W_TRANSFER_FEET", message));
    }
    warnings
}

/// The target's frame whose looks a sequence wears: that of the pair in its middle, or of the first pair.
fn worn(pairs: &[transfer::Pair], sequence: &Sequence) -> u32 {
    let own: Vec<u32> =
        pairs.iter().filter(|pair| sequence.contains(pair.source as u32)).map(|pair| pair.target).collect();
    own.get(own.len() / 2).copied().unwrap_or_else(|| pairs.first().map_or(0, |pair| pair.target))
}
