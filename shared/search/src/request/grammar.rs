//! The grammar of requests: what is missing, of another kind or unknown is refused with a sentence that names it. Counts
//! and ranges are checked afterwards ([`check`](super::check)).

use std::collections::BTreeMap;

use super::check::check_version;
use super::value::Json;
use super::{
    BehaviourRequest, DEFAULT_EXACTNESS, DEFAULT_REALISM, FrameRef, Key, KeysRequest, PATH_REALISM, PathRequest,
    PlaceRequest, Request, RequestError, Stretch, Target, WanderRequest, WithinSequence,
};
use crate::curve::Shape;

type Read<T> = Result<T, RequestError>;

/// A request.
pub(super) fn request(value: &Json) -> Read<Request> {
    let fields = Fields::new(value, "the request")?;
    // A later version may have other fields: that is to be said first.
    let version = whole(fields.need("version")?, "the version")?;
    check_version(version)?;
    let fields = fields.only(&["version", "seed", "target"])?;
    let seed = fields.maybe("seed").map_or(Ok(0.0), |seed| whole_number(seed, "the seed"))?;
    // What is beyond 2^53 is refused when the numbers are checked.
    Ok(Request { version, seed: seed as u64, target: target(fields.need("target")?)? })
}

fn target(value: &Json) -> Read<Target> {
    let kinds = ["pose", "behaviour", "place", "path", "keys", "wander", "queue"];
    let fields = Fields::new(value, "the target")?.only(&kinds)?;
    let mut given = kinds.iter().filter_map(|kind| Some((*kind, fields.maybe(kind)?)));
    let (Some((kind, value)), None) = (given.next(), given.next()) else {
        return Err(wrong(&["a target is one of pose, behaviour, place, path, keys, wander and queue"]));
    };
    Ok(match kind {
        "pose" => Target::Pose(frame(value)?),
        "behaviour" => Target::Behaviour(behaviour(value)?),
        "place" => Target::Place(place(value)?),
        "path" => Target::Path(path(value)?),
        "keys" => Target::Keys(keys(value)?),
        "wander" => Target::Wander(wander(value)?),
        _ => Target::Queue(each(value, "the queue", target)?),
    })
}

fn frame(value: &Json) -> Read<FrameRef> {
    if matches!(value, Json::Number(_)) {
        return Ok(FrameRef::Number(whole(value, "a pose")?));
    }
    let fields = Fields::new(value, "a pose")?.only(&["sequence", "frame", "time"])?;
    Ok(FrameRef::Within(WithinSequence {
        sequence: fields.text("sequence")?,
        frame: fields.maybe("frame").map(|frame| whole(frame, "a pose's frame")).transpose()?,
        time: fields.maybe("time").map(|time| number(time, "a pose's time")).transpose()?,
    }))
}

fn behaviour(value: &Json) -> Read<BehaviourRequest> {
    let fields = Fields::new(value, "the behaviour")?.only(&["name", "hold"])?;
    Ok(BehaviourRequest { name: fields.text("name")?, hold: fields.number_or("hold", 0.0)? })
}

fn place(value: &Json) -> Read<PlaceRequest> {
    let fields = Fields::new(value, "the place")?.only(&["x", "z", "heading", "realism", "exactness"])?;
    Ok(PlaceRequest {
        x: fields.number("x")? as f32,
        z: fields.number("z")? as f32,
        heading: fields.maybe("heading").map(|heading| number(heading, "heading")).transpose()?.map(|h| h as f32),
        realism: fields.number_or("realism", DEFAULT_REALISM)?,
        exactness: fields.number_or("exactness", DEFAULT_EXACTNESS)?,
    })
}

/// A path.
pub(super) fn path(value: &Json) -> Read<PathRequest> {
    let known = ["points", "shape", "stretches", "free_start", "vertices", "realism", "exactness"];
    let fields = Fields::new(value, "the path")?.only(&known)?;
    let coordinate = |part: &Json| Ok(number(part, "a point's coordinate")? as f32);
    let shape = match fields.maybe("shape") {
        None => Shape::default(),
        Some(Json::Text(shape)) if shape == "spline" => Shape::Spline,
        Some(Json::Text(shape)) if shape == "polyline" => Shape::Polyline,
        Some(_) => return Err(wrong(&["a path's shape is spline or polyline"])),
    };
    let free_start = match fields.maybe("free_start") {
        None => false,
        Some(Json::Bool(free)) => *free,
        Some(_) => return Err(wrong(&["free_start is true or false"])),
    };
    Ok(PathRequest {
        points: each(fields.need("points")?, "points", |point| each(point, "a point", coordinate))?,
        shape,
        stretches: fields.list("stretches", stretch)?,
        free_start,
        vertices: fields.list("vertices", |vertex| whole(vertex, "a vertex"))?,
        realism: fields.number_or("realism", PATH_REALISM)?,
        exactness: fields.number_or("exactness", DEFAULT_EXACTNESS)?,
    })
}

fn stretch(value: &Json) -> Read<Stretch> {
    let fields = Fields::new(value, "a stretch")?.only(&["from", "to", "behaviour"])?;
    Ok(Stretch { from: fields.number("from")?, to: fields.number("to")?, behaviour: fields.text("behaviour")? })
}

/// Key poses.
pub(super) fn keys(value: &Json) -> Read<KeysRequest> {
    let fields = Fields::new(value, "the list of key poses")?.only(&["poses"])?;
    Ok(KeysRequest { poses: each(fields.need("poses")?, "poses", key)? })
}

fn key(value: &Json) -> Read<Key> {
    let fields = Fields::new(value, "a key pose")?.only(&["pose", "time"])?;
    Ok(Key { pose: frame(fields.need("pose")?)?, time: fields.number("time")? })
}

fn wander(value: &Json) -> Read<WanderRequest> {
    let fields = Fields::new(value, "wandering")?.only(&["seconds", "weights"])?;
    let mut weights = BTreeMap::new();
    if let Some(given) = fields.maybe("weights") {
        for (name, weight) in Fields::new(given, "weights")?.fields {
            weights.insert(name.clone(), number(weight, "a weight")?);
        }
    }
    Ok(WanderRequest { seconds: fields.number("seconds")?, weights })
}

fn wrong(why: &[&str]) -> RequestError {
    RequestError::Json(why.concat())
}

fn is_no(what: &str, kind: &str) -> RequestError {
    wrong(&[what, " is no ", kind])
}

/// An object's fields.
struct Fields<'a> {
    fields: &'a [(String, Json)],
    what: &'static str,
}

impl<'a> Fields<'a> {
    fn new(value: &'a Json, what: &'static str) -> Read<Self> {
        match value {
            Json::Object(fields) => Ok(Self { fields, what }),
            _ => Err(is_no(what, "object")),
        }
    }

    fn only(self, known: &[&str]) -> Read<Self> {
        let names = self.fields.iter().map(|(name, _)| name);
        match names.filter(|name| !known.contains(&name.as_str())).min() {
            Some(name) => Err(wrong(&[self.what, " has a field that nobody knows: ", name])),
            None => Ok(self),
        }
    }

    fn maybe(&self, name: &str) -> Option<&'a Json> {
        let field = self.fields.iter().find(|(field, _)| field == name);
        field.map(|(_, value)| value).filter(|value| **value != Json::Null)
    }

    fn need(&self, name: &str) -> Read<&'a Json> {
        self.maybe(name).ok_or_else(|| wrong(&[self.what, " has no ", name]))
    }

    fn number(&self, name: &str) -> Read<f64> {
        number(self.need(name)?, name)
    }

    fn number_or(&self, name: &str, usual: f64) -> Read<f64> {
        self.maybe(name).map_or(Ok(usual), |value| number(value, name))
    }

    fn text(&self, name: &str) -> Read<String> {
        match self.need(name)? {
            Json::Text(text) => Ok(text.clone()),
            _ => Err(is_no(name, "text")),
        }
    }

    fn list<T>(&self, name: &str, read: impl Fn(&Json) -> Read<T>) -> Read<Vec<T>> {
        self.maybe(name).map_or(Ok(Vec::new()), |value| each(value, name, read))
    }
}

fn each<T>(value: &Json, what: &str, read: impl Fn(&Json) -> Read<T>) -> Read<Vec<T>> {
    match value {
        Json::List(list) => list.iter().map(read).collect(),
        _ => Err(is_no(what, "list")),
    }
}

fn number(value: &Json, what: &str) -> Read<f64> {
    match value {
        Json::Number(number) => Ok(*number),
        _ => Err(is_no(what, "number")),
    }
}

fn whole_number(value: &Json, what: &str) -> Read<f64> {
    let number = number(value, what)?;
    if number.fract() == 0.0 && number >= 0.0 { Ok(number) } else { Err(is_no(what, "whole number")) }
}

fn whole(value: &Json, what: &str) -> Read<u32> {
    let number = whole_number(value, what)?;
    if number <= f64::from(u32::MAX) { Ok(number as u32) } else { Err(is_no(what, "whole number below 2^32")) }
}
