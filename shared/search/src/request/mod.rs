//! What can be asked for, as plain types and as JSON. Requests come from links and files: nothing in them is trusted.

mod check;
mod error;
mod find;
mod grammar;
mod json;
pub mod limits;

pub use actor::json::Json;
pub use error::RequestError;

use std::collections::BTreeMap;

use glam::Vec3;
use serde::Serialize;

use super::curve::Shape;

/// The version of requests and answers that this library writes.
pub const VERSION: u32 = 1;

/// What the actor shall do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Request {
    /// Version of the format: 1.
    pub version: u32,
    /// Seed of what is random.
    pub seed: u64,
    /// The weight of a frame's duration in the cheapest walks (alpha, thesis section 3.3.2), where it is not to be the actor's
    /// own: whoever searches tells the graph ([`EssentialGraph::set_alpha`](actor::graph::EssentialGraph::set_alpha)).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quickness: Option<f64>,
    /// What to do.
    pub target: Target,
}

/// Something to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// Go to a recorded pose, by the cheapest walk.
    Pose(FrameRef),
    /// Go to a behaviour, and hold it for a while.
    Behaviour(BehaviourRequest),
    /// Go to a place on the ground.
    Place(PlaceRequest),
    /// Follow a path.
    Path(PathRequest),
    /// Take key poses at given times.
    Keys(KeysRequest),
    /// Wander about.
    Wander(WanderRequest),
    /// One after another. A queue holds no queue.
    Queue(Vec<Target>),
}

/// A recorded frame: by its number over the whole capture, or within a sequence.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum FrameRef {
    /// Number over the whole capture.
    Number(u32),
    /// Within a sequence, by frame or by time in seconds; its first frame where neither is given.
    Within(WithinSequence),
}

/// A frame of a sequence.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WithinSequence {
    /// Name of the sequence.
    pub sequence: String,
    /// Frame within it, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<u32>,
    /// Seconds from its beginning.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
}

/// Go to a behaviour.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BehaviourRequest {
    /// A label of the capture, or the name of a sequence.
    pub name: String,
    /// Seconds for which to hold it, in a loop where it has one.
    pub hold: f64,
}

/// Go to a place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceRequest {
    /// Metres along X.
    pub x: f32,
    /// Metres along Z.
    pub z: f32,
    /// Which way to face there, in radians about +Y from +Z; any way where not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading: Option<f32>,
    /// The pose to end in there; any where not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose: Option<FrameRef>,
    /// Weight of the graph's cost against seconds.
    pub realism: f64,
    /// How far the walk is bent so that it ends there, from 0 (not at all) to 1.
    pub exactness: f64,
}

/// Follow a path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathRequest {
    /// Points in metres: all as [x, z] on the ground, or all as [x, y, z] in space.
    pub points: Vec<Vec<f32>>,
    /// How they are joined.
    pub shape: Shape,
    /// Stretches that demand behaviours.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<Stretch>,
    /// Whether the actor may begin with any pose, standing on the first point; else it begins where it is and first goes
    /// there in a straight line.
    pub free_start: bool,
    /// Vertices whose mean follows the path, instead of the centre of mass.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub vertices: Vec<u32>,
    /// Weight of the graph's cost against metre-seconds of deviation.
    pub realism: f64,
    /// How far the walk is bent onto the path, from 0 (not at all) to 1.
    pub exactness: f64,
}

/// A stretch of a path.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Stretch {
    /// Where it begins, counted in points of the path: 1.5 is half way between the second and the third.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// The behaviour that it demands.
    pub behaviour: String,
}

/// Take key poses.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct KeysRequest {
    /// The key poses, in any order.
    pub poses: Vec<Key>,
}

/// A pose at a time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    /// The pose.
    pub pose: FrameRef,
    /// When, in seconds from now.
    pub time: f64,
}

/// Wander about.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WanderRequest {
    /// For how long, in seconds.
    pub seconds: f64,
    /// How much more (above 1) or less (below) often than others behaviours are to be seen.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub weights: BTreeMap<String, f64>,
}

/// The default weight of the graph's cost against seconds.
pub const DEFAULT_REALISM: f64 = 0.05;
/// The default weight of the graph's cost against metre-seconds of deviation from a path: a good transition is worth being 6 cm
/// off for a second.
pub const PATH_REALISM: f64 = 0.02;

/// How far walks are bent onto their paths and places, where nothing else is said: as far as may be.
pub const DEFAULT_EXACTNESS: f64 = 1.0;

impl Default for PlaceRequest {
    fn default() -> Self {
        Self { x: 0.0, z: 0.0, heading: None, pose: None, realism: DEFAULT_REALISM, exactness: DEFAULT_EXACTNESS }
    }
}

impl Default for PathRequest {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            shape: Shape::default(),
            stretches: Vec::new(),
            free_start: false,
            vertices: Vec::new(),
            realism: PATH_REALISM,
            exactness: DEFAULT_EXACTNESS,
        }
    }
}

impl Request {
    /// A request of this version.
    #[must_use]
    pub fn new(target: Target) -> Self {
        Self { version: VERSION, seed: 0, quickness: None, target }
    }
}

impl PathRequest {
    /// Whether its points are on the ground.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.points.first().is_some_and(|point| point.len() == 2)
    }

    /// Its points in space; those on the ground at height 0.
    #[must_use]
    pub fn points(&self) -> Vec<Vec3> {
        let point = |point: &Vec<f32>| match *point.as_slice() {
            [x, z] => Vec3::new(x, 0.0, z),
            [x, y, z] => Vec3::new(x, y, z),
            _ => Vec3::ZERO,
        };
        self.points.iter().map(point).collect()
    }
}
