//! What can be asked for, as plain types and as JSON. Requests come from links and files: nothing in them is trusted.

use std::collections::BTreeMap;

use glam::Vec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::curve::Shape;
use super::ways::Ways;
use crate::timeline::Timeline;

/// The version of requests and answers that this library writes.
pub const VERSION: u32 = 1;

/// Limits of a request. What exceeds them is refused with a sentence.
pub mod limits {
    /// Bytes of JSON.
    pub const MAX_BYTES: usize = 1 << 20;
    /// Points of a path.
    pub const MAX_POINTS: usize = 4096;
    /// Stretches of a path.
    pub const MAX_STRETCHES: usize = 256;
    /// Vertices of a group.
    pub const MAX_VERTICES: usize = 1 << 16;
    /// Key poses.
    pub const MAX_KEYS: usize = 256;
    /// Targets of a queue.
    pub const MAX_QUEUE: usize = 256;
    /// Weights of behaviours.
    pub const MAX_WEIGHTS: usize = 256;
    /// Seconds of anything.
    pub const MAX_SECONDS: f64 = 3600.0;
    /// Metres from the origin, and of a path's length.
    pub const MAX_METRES: f64 = 2000.0;
    /// The largest weight of anything.
    pub const MAX_WEIGHT: f64 = 1000.0;
}

/// What the actor shall do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// Version of the format: 1.
    pub version: u32,
    /// Seed of what is random.
    #[serde(default)]
    pub seed: u64,
    /// What to do.
    pub target: Target,
}

/// Something to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FrameRef {
    /// Number over the whole capture.
    Number(u32),
    /// Within a sequence, by frame or by time in seconds; its first frame where neither is given.
    Within(WithinSequence),
}

/// A frame of a sequence.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WithinSequence {
    /// Name of the sequence.
    pub sequence: String,
    /// Frame within it, from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<u32>,
    /// Seconds from its beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
}

/// Go to a behaviour.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BehaviourRequest {
    /// A label of the capture, or the name of a sequence.
    pub name: String,
    /// Seconds for which to hold it, in a loop where it has one.
    #[serde(default)]
    pub hold: f64,
}

/// Go to a place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceRequest {
    /// Metres along X.
    pub x: f32,
    /// Metres along Z.
    pub z: f32,
    /// Which way to face there, in radians about +Y from +Z; any way where not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading: Option<f32>,
    /// Weight of the graph's cost against seconds.
    #[serde(default = "default_realism")]
    pub realism: f64,
}

/// Follow a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathRequest {
    /// Points in metres: all as [x, z] on the ground, or all as [x, y, z] in space.
    pub points: Vec<Vec<f32>>,
    /// How they are joined.
    #[serde(default)]
    pub shape: Shape,
    /// Stretches that demand behaviours.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stretches: Vec<Stretch>,
    /// Whether the actor may begin with any pose, standing on the first point; else it begins where it is and first goes
    /// there in a straight line.
    #[serde(default)]
    pub free_start: bool,
    /// Vertices whose mean follows the path, instead of the centre of mass.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub vertices: Vec<u32>,
    /// Weight of the graph's cost against metre-seconds of deviation.
    #[serde(default = "path_realism")]
    pub realism: f64,
}

/// A stretch of a path.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stretch {
    /// Where it begins, counted in points of the path: 1.5 is half way between the second and the third.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// The behaviour that it demands.
    pub behaviour: String,
}

/// Take key poses.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeysRequest {
    /// The key poses, in any order.
    pub poses: Vec<Key>,
}

/// A pose at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// The pose.
    pub pose: FrameRef,
    /// When, in seconds from now.
    pub time: f64,
}

/// Wander about.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WanderRequest {
    /// For how long, in seconds.
    pub seconds: f64,
    /// How much more (above 1) or less (below) often than others behaviours are to be seen.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub weights: BTreeMap<String, f64>,
}

/// The default weight of the graph's cost against seconds.
pub const DEFAULT_REALISM: f64 = 0.05;
/// The default weight of the graph's cost against metre-seconds of deviation from a path: a good transition is worth being 6 cm
/// off for a second.
pub const PATH_REALISM: f64 = 0.02;

fn default_realism() -> f64 {
    DEFAULT_REALISM
}

fn path_realism() -> f64 {
    PATH_REALISM
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
        }
    }
}

/// Why a request cannot be worked on.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RequestError {
    /// The text is not a request.
    #[error("this is not a request: {0}")]
    Json(String),
    /// The request was written for another version.
    #[error("the request has version {0}, but this version of Reprise knows {VERSION}: update it")]
    Version(u32),
    /// More of something than is allowed.
    #[error("the request has {count} {what}, but at most {limit} are allowed")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A number is not finite or out of range.
    #[error("{what} must be a number from {least} to {most}")]
    Range {
        /// What the number is.
        what: &'static str,
        /// The least it may be.
        least: f64,
        /// The most it may be.
        most: f64,
    },
    /// There is nothing to do.
    #[error("{0} has nothing in it")]
    Empty(&'static str),
    /// A path's points are neither all on the ground nor all in space.
    #[error("point {0} of the path must have two coordinates (x, z) or three (x, y, z), as all others have")]
    Coordinates(usize),
    /// A path has no length.
    #[error("the path has no length: its points are all in one place; draw it longer, or ask for a place instead")]
    NoLength,
    /// A behaviour that the capture does not have.
    #[error("there is no behaviour {name:?}; there are: {}", known.join(", "))]
    UnknownBehaviour {
        /// The name asked for.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// A frame that the capture does not have.
    #[error("there is no frame {0}")]
    UnknownFrame(String),
    /// A queue within a queue.
    #[error("a queue cannot hold a queue")]
    Nested,
    /// The ways are not those of the group of vertices that is to follow the path.
    #[error(
        "the motion of these vertices has not been measured: all paths of a request must be followed by the same ones"
    )]
    OtherGroup,
    /// A vertex that the capture does not have.
    #[error("there is no vertex {0}")]
    UnknownVertex(u32),
}

impl Request {
    /// A request of this version.
    #[must_use]
    pub fn new(target: Target) -> Self {
        Self { version: VERSION, seed: 0, target }
    }

    /// Reads a request and checks all that can be checked without a capture.
    ///
    /// # Errors
    /// See [`RequestError`].
    pub fn from_json(text: &str) -> Result<Self, RequestError> {
        #[derive(Deserialize)]
        struct Versioned {
            version: u32,
        }
        if text.len() > limits::MAX_BYTES {
            let (what, limit) = ("bytes", limits::MAX_BYTES);
            return Err(RequestError::TooMany { what, count: text.len(), limit });
        }
        // A later version may have other fields: that is to be said first.
        if let Ok(Versioned { version }) = serde_json::from_str(text) {
            check_version(version)?;
        }
        let request: Self = serde_json::from_str(text).map_err(|error| RequestError::Json(error.to_string()))?;
        request.check_numbers()?;
        Ok(request)
    }

    /// The request as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        // All fields are plain: there is nothing that could fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Checks counts and numbers.
    ///
    /// # Errors
    /// See [`RequestError`].
    pub fn check_numbers(&self) -> Result<(), RequestError> {
        check_version(self.version)?;
        match &self.target {
            Target::Queue(targets) => {
                count("targets", targets.len(), limits::MAX_QUEUE)?;
                if targets.is_empty() {
                    return Err(RequestError::Empty("the queue"));
                }
                targets.iter().try_for_each(Target::check_numbers)
            }
            target => target.check_numbers(),
        }
    }
}

impl Target {
    fn check_numbers(&self) -> Result<(), RequestError> {
        match self {
            Self::Pose(frame) => frame.check(),
            Self::Behaviour(request) => seconds("hold", request.hold),
            Self::Place(request) => {
                metres("x", request.x)?;
                metres("z", request.z)?;
                weight("realism", request.realism)?;
                request.heading.map_or(Ok(()), |heading| range("heading", f64::from(heading), -1e3, 1e3))
            }
            Self::Path(request) => request.check(),
            Self::Keys(request) => {
                count("key poses", request.poses.len(), limits::MAX_KEYS)?;
                if request.poses.is_empty() {
                    return Err(RequestError::Empty("the list of key poses"));
                }
                request.poses.iter().try_for_each(|key| seconds("time", key.time).and_then(|()| key.pose.check()))
            }
            Self::Wander(request) => {
                count("weights", request.weights.len(), limits::MAX_WEIGHTS)?;
                seconds("seconds", request.seconds)?;
                request.weights.values().try_for_each(|&value| weight("a weight", value))
            }
            Self::Queue(_) => Err(RequestError::Nested),
        }
    }
}

impl PathRequest {
    fn check(&self) -> Result<(), RequestError> {
        count("points", self.points.len(), limits::MAX_POINTS)?;
        count("stretches", self.stretches.len(), limits::MAX_STRETCHES)?;
        count("vertices", self.vertices.len(), limits::MAX_VERTICES)?;
        weight("realism", self.realism)?;
        let coordinates = self.points.first().map_or(0, Vec::len);
        for (index, point) in self.points.iter().enumerate() {
            if point.len() != coordinates || !matches!(coordinates, 2 | 3) {
                return Err(RequestError::Coordinates(index));
            }
            point.iter().try_for_each(|&coordinate| metres("a point's coordinate", coordinate))?;
        }
        for stretch in &self.stretches {
            range("a stretch's end", stretch.from, 0.0, limits::MAX_POINTS as f64)?;
            range("a stretch's end", stretch.to, 0.0, limits::MAX_POINTS as f64)?;
        }
        let points = self.points();
        let length: f32 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        if self.points.is_empty() {
            Err(RequestError::Empty("the path"))
        } else if length < 0.01 {
            Err(RequestError::NoLength)
        } else {
            range("the path's length in metres", f64::from(length), 0.0, limits::MAX_METRES)
        }
    }

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

impl FrameRef {
    fn check(&self) -> Result<(), RequestError> {
        match self {
            Self::Within(WithinSequence { time: Some(time), .. }) => seconds("time", *time),
            _ => Ok(()),
        }
    }

    /// The frame's number over the whole capture.
    ///
    /// # Errors
    /// A frame or a sequence that does not exist.
    pub fn find(&self, timeline: &Timeline) -> Result<u32, RequestError> {
        match self {
            Self::Number(frame) if *frame < timeline.frame_count() => Ok(*frame),
            Self::Number(frame) => Err(RequestError::UnknownFrame(frame.to_string())),
            Self::Within(within) => {
                let wrong = |what: String| RequestError::UnknownFrame(format!("{what} of {:?}", within.sequence));
                let named = timeline.sequences().iter().find(|sequence| sequence.name == within.sequence);
                let sequence = named.ok_or_else(|| RequestError::UnknownBehaviour {
                    name: within.sequence.clone(),
                    known: timeline.sequences().iter().map(|sequence| sequence.name.clone()).collect(),
                })?;
                let local = match (within.frame, within.time) {
                    (Some(frame), _) => frame,
                    (None, Some(time)) => (time * f64::from(timeline.fps())).round() as u32,
                    (None, None) => 0,
                };
                let exists = local < sequence.frame_count;
                exists.then(|| sequence.first_frame + local).ok_or_else(|| wrong(local.to_string()))
            }
        }
    }
}

/// The number of a behaviour by name.
pub(super) fn behaviour(ways: &Ways, name: &str) -> Result<usize, RequestError> {
    ways.behaviour(name).ok_or_else(|| RequestError::UnknownBehaviour {
        name: name.into(),
        known: ways.behaviours().map(str::to_owned).collect(),
    })
}

fn check_version(version: u32) -> Result<(), RequestError> {
    if version == VERSION { Ok(()) } else { Err(RequestError::Version(version)) }
}

fn count(what: &'static str, count: usize, limit: usize) -> Result<(), RequestError> {
    if count <= limit { Ok(()) } else { Err(RequestError::TooMany { what, count, limit }) }
}

/// NaN is in no range.
fn range(what: &'static str, value: f64, least: f64, most: f64) -> Result<(), RequestError> {
    if (least..=most).contains(&value) { Ok(()) } else { Err(RequestError::Range { what, least, most }) }
}

fn metres(what: &'static str, value: f32) -> Result<(), RequestError> {
    range(what, f64::from(value), -limits::MAX_METRES, limits::MAX_METRES)
}

fn seconds(what: &'static str, value: f64) -> Result<(), RequestError> {
    range(what, value, 0.0, limits::MAX_SECONDS)
}

fn weight(what: &'static str, value: f64) -> Result<(), RequestError> {
    range(what, value, 0.0, limits::MAX_WEIGHT)
}
