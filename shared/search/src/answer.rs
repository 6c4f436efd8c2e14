//! What came out: a walk, how well it does what was asked, and sentences where it does not.

use serde::Serialize;

use super::anytime::Progress;
use super::path::PathReport;
use super::place::PlaceReport;
use actor::walk::Walk;

/// A walk with what it reaches.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// Version of the format: 1.
    pub version: u32,
    /// The frame that the walk begins with.
    pub start_frame: u32,
    /// Where it stands: heading in radians about +Y, then metres along X and Z (`world_from_recorded`).
    pub start_placement: [f32; 3],
    /// The walk.
    pub walk: Walk,
    /// Steps from frame to frame.
    pub steps: u32,
    /// The same in seconds.
    pub seconds: f64,
    /// The frame that it ends with.
    pub end_frame: u32,
    /// Where it stands then, as `start_placement`.
    pub end_placement: [f32; 3],
    /// What became of each target, in order.
    pub parts: Vec<Part>,
    /// Whether there may be a better walk.
    pub progress: Progress,
    /// States that were expanded.
    pub expanded: u64,
}

impl Answer {
    /// All sentences of its parts.
    pub fn notes(&self) -> impl Iterator<Item = &str> {
        self.parts.iter().flat_map(|part| part.notes.iter().map(String::as_str))
    }
}

/// What became of a target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Steps of the walk before it.
    pub first_step: u32,
    /// Steps that it takes.
    pub steps: u32,
    /// How well it does what was asked.
    pub goal: Goal,
    /// Sentences where it does not.
    pub notes: Vec<String>,
}

/// How well a part does what was asked.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    /// A pose was gone to.
    Pose {
        /// Its frame.
        frame: u32,
        /// The frame that is shown in its place: the same, or the nearest that the actor can get to.
        shown: u32,
        /// Whether the walk arrives there.
        reached: bool,
    },
    /// A behaviour was gone to.
    Behaviour {
        /// Its name.
        name: String,
        /// Whether the walk arrives there.
        reached: bool,
        /// Steps that are held.
        held: u32,
    },
    /// A place was gone to.
    Place(PlaceReport),
    /// A path was followed.
    Path(PathReport),
    /// Key poses were taken: the table of thesis figure 3.18.
    Keys {
        /// A row for each key pose, by time.
        rows: Vec<KeyRow>,
        /// Mean of the rows' errors in frames; rows that are not reached do not count.
        mean_error: f64,
    },
    /// It wanders.
    Wander {
        /// The objective of Prada and others (2016), section 7.1: for equal probabilities, after the proxy, and as it
        /// is used.
        objectives: [f64; 3],
        /// Frames that are visited.
        frames: u32,
    },
}

/// A key pose wanted and reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct KeyRow {
    /// Its frame.
    pub frame: u32,
    /// The frame that is shown in its place: the same, or the nearest that the actor can get to.
    pub shown: u32,
    /// Steps after which it is wanted.
    pub wanted: u32,
    /// Steps after which it is reached; `None` where it is not.
    pub reached: Option<u32>,
}
