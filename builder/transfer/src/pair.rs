//! Poses that mean the same, and how it is learned from them.

use learn::kernel::Kernel;

/// Two poses that mean the same, by frames of the whole captures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    /// Frame of the source.
    pub source: u32,
    /// Frame of the target.
    pub target: u32,
    /// Which stretch it belongs to: frames are matched between keys of one stretch alone.
    pub stretch: u32,
}

/// Two poses that mean the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Time in the source, in frames of the whole capture.
    pub source: f64,
    /// Frame of the target, of the whole capture.
    pub target: u32,
}

impl Pair {
    /// The pair that a key is.
    #[must_use]
    pub fn of_key(key: &Key) -> Self {
        Self { source: f64::from(key.source), target: key.target }
    }
}

/// How it is learned.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TransferOptions {
    /// What maps numbers of the source to those of the target.
    pub kernel: Kernel,
    /// Take the body for one part.
    pub whole: bool,
    /// Pairs that are learned from, at most; where there are more, some spread over all.
    pub pairs: usize,
    /// Hold soles where the source's stand.
    pub hold: bool,
    /// Stretch triangles as in the target's recorded poses.
    pub correct: bool,
    /// Let the bones of both carry the pose, where both have a human's: maps learn what they leave over.
    pub bones: bool,
}

impl Default for TransferOptions {
    fn default() -> Self {
        Self { kernel: Kernel::NeuralNetwork, whole: false, pairs: 350, hold: true, correct: true, bones: true }
    }
}
