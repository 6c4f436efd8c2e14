//! What can be checked of a request without a capture: its version, its counts, its numbers.

use super::{FrameRef, PathRequest, Request, RequestError, Target, VERSION, WithinSequence, limits};

impl Request {
    /// Checks counts and numbers.
    ///
    /// # Errors
    /// See [`RequestError`].
    pub fn check_numbers(&self) -> Result<(), RequestError> {
        check_version(self.version)?;
        range("the seed", self.seed as f64, 0.0, limits::MAX_SEED as f64)?;
        if let Some(quickness) = self.quickness {
            range("quickness", quickness, limits::LEAST_QUICKNESS, limits::MOST_QUICKNESS)?;
        }
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
                range("exactness", request.exactness, 0.0, 1.0)?;
                request.pose.as_ref().map_or(Ok(()), FrameRef::check)?;
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
        range("exactness", self.exactness, 0.0, 1.0)?;
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
}

impl FrameRef {
    fn check(&self) -> Result<(), RequestError> {
        match self {
            Self::Within(WithinSequence { time: Some(time), .. }) => seconds("time", *time),
            _ => Ok(()),
        }
    }
}

pub(super) fn check_version(version: u32) -> Result<(), RequestError> {
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
