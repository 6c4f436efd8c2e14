//! The grammar of requests: what is missing, of another kind or unknown is refused with a sentence that names it. Counts
//! and ranges are checked afterwards ([`check`](super::check)).

use std::collections::BTreeMap;

use actor::json::{Fields, Json, each, number, whole, whole_number, wrong};

use super::check::check_version;
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
    let fields = fields.only(&["version", "seed", "quickness", "target"])?;
    let seed = fields.maybe("seed").map_or(Ok(0.0), |seed| whole_number(seed, "the seed"))?;
    let quickness = fields.maybe("quickness").map(|quickness| number(quickness, "quickness")).transpose()?;
    // What is beyond 2^53 is refused when the numbers are checked.
    Ok(Request { version, seed: seed as u64, quickness, target: target(fields.need("target")?)? })
}

fn target(value: &Json) -> Read<Target> {
    let kinds = ["pose", "behaviour", "place", "path", "keys", "wander", "queue"];
    let fields = Fields::new(value, "the target")?.only(&kinds)?;
    let mut given = kinds.iter().filter_map(|kind| Some((*kind, fields.maybe(kind)?)));
    let (Some((kind, value)), None) = (given.next(), given.next()) else {
        return Err(wrong(&["a target is one of pose, behaviour, place, path, keys, wander and queue"]).into());
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
    let fields = Fields::new(value, "the place")?.only(&["x", "z", "heading", "pose", "realism", "exactness"])?;
    Ok(PlaceRequest {
        x: fields.number("x")? as f32,
        z: fields.number("z")? as f32,
        heading: fields.maybe("heading").map(|heading| number(heading, "heading")).transpose()?.map(|h| h as f32),
        pose: fields.maybe("pose").map(frame).transpose()?,
        realism: fields.number_or("realism", DEFAULT_REALISM)?,
        exactness: fields.number_or("exactness", DEFAULT_EXACTNESS)?,
    })
}

/// A path.
pub(super) fn path(value: &Json) -> Read<PathRequest> {
    let known = ["points", "shape", "stretches", "free_start", "vertices", "realism", "exactness"];
    let fields = Fields::new(value, "the path")?.only(&known)?;
    let coordinate = |part: &Json| -> Read<f32> { Ok(number(part, "a point's coordinate")? as f32) };
    let shape = match fields.maybe("shape") {
        None => Shape::default(),
        Some(Json::Text(shape)) if shape == "spline" => Shape::Spline,
        Some(Json::Text(shape)) if shape == "polyline" => Shape::Polyline,
        Some(_) => return Err(wrong(&["a path's shape is spline or polyline"]).into()),
    };
    let free_start = match fields.maybe("free_start") {
        None => false,
        Some(Json::Bool(free)) => *free,
        Some(_) => return Err(wrong(&["free_start is true or false"]).into()),
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
