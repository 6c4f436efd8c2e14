//! Requests as the browser reads them: its own JSON parser is there anyway, and ours would weigh 30 KB.
//!
//! Nothing is trusted: what is missing, of another kind or unknown is refused with a sentence that names it. Counts and
//! ranges are checked by the request itself.

use std::collections::BTreeMap;

use js_sys::{Array, JSON, Object, Reflect};
use search::{
    BehaviourRequest, DEFAULT_REALISM, FrameRef, Key, KeysRequest, PATH_REALISM, PathRequest, PlaceRequest, Request,
    Shape, Stretch, Target, WanderRequest, WithinSequence,
};
use wasm_bindgen::{JsCast, JsValue};

use super::error::{Kind, error};
use crate::player::direct::DirectError;

/// The request that `text` holds as JSON.
///
/// # Errors
/// What is wrong with it.
pub fn parse(text: &str) -> Result<Request, JsValue> {
    let value = JSON::parse(text).map_err(|_| wrong("it is no JSON"))?;
    let fields = Fields::new(&value, "the request", &["version", "seed", "target"])?;
    let request = Request {
        version: whole(fields.need("version")?, "the version")?,
        seed: fields.number_or("seed", 0.0)? as u64,
        target: target(&fields.need("target")?)?,
    };
    request.check_numbers().map_err(DirectError::from)?;
    Ok(request)
}

fn wrong(why: &str) -> JsValue {
    error(Kind::BadArgument, &["this is not a request: ", why].concat())
}

fn is_no(what: &str, kind: &str) -> JsValue {
    wrong(&[what, " is no ", kind].concat())
}

/// An object's fields.
struct Fields<'a> {
    object: &'a JsValue,
    what: &'a str,
}

impl<'a> Fields<'a> {
    fn new(object: &'a JsValue, what: &'a str, known: &[&str]) -> Result<Self, JsValue> {
        if !object.is_object() || Array::is_array(object) {
            return Err(is_no(what, "object"));
        }
        for key in Object::keys(object.unchecked_ref::<Object>()).iter() {
            let key = String::from(js_sys::JsString::from(key));
            if !known.contains(&key.as_str()) {
                return Err(wrong(&[what, " has a field that nobody knows: ", &key].concat()));
            }
        }
        Ok(Self { object, what })
    }

    fn maybe(&self, name: &str) -> Option<JsValue> {
        let value = Reflect::get(self.object, &name.into()).ok()?;
        (!value.is_undefined() && !value.is_null()).then_some(value)
    }

    fn need(&self, name: &str) -> Result<JsValue, JsValue> {
        self.maybe(name).ok_or_else(|| wrong(&[self.what, " has no ", name].concat()))
    }

    fn number(&self, name: &str) -> Result<f64, JsValue> {
        number(&self.need(name)?, name)
    }

    fn number_or(&self, name: &str, usual: f64) -> Result<f64, JsValue> {
        self.maybe(name).map_or(Ok(usual), |value| number(&value, name))
    }

    fn text(&self, name: &str) -> Result<String, JsValue> {
        self.need(name)?.as_string().ok_or_else(|| is_no(name, "text"))
    }

    fn list(&self, name: &str) -> Result<Vec<JsValue>, JsValue> {
        self.maybe(name).map_or(Ok(Vec::new()), |value| list(&value, name))
    }
}

fn number(value: &JsValue, what: &str) -> Result<f64, JsValue> {
    value.as_f64().ok_or_else(|| is_no(what, "number"))
}

fn whole(value: JsValue, what: &str) -> Result<u32, JsValue> {
    let number = number(&value, what)?;
    let fits = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    if fits { Ok(number as u32) } else { Err(is_no(what, "whole number")) }
}

fn list(value: &JsValue, what: &str) -> Result<Vec<JsValue>, JsValue> {
    if Array::is_array(value) { Ok(value.unchecked_ref::<Array>().to_vec()) } else { Err(is_no(what, "list")) }
}

fn target(value: &JsValue) -> Result<Target, JsValue> {
    let kinds = ["pose", "behaviour", "place", "path", "keys", "wander", "queue"];
    let fields = Fields::new(value, "the target", &kinds)?;
    let mut given = kinds.iter().filter_map(|kind| Some((*kind, fields.maybe(kind)?)));
    let (Some((kind, value)), None) = (given.next(), given.next()) else {
        return Err(wrong("a target is one of pose, behaviour, place, path, keys, wander and queue"));
    };
    Ok(match kind {
        "pose" => Target::Pose(frame(&value)?),
        "behaviour" => {
            let fields = Fields::new(&value, kind, &["name", "hold"])?;
            Target::Behaviour(BehaviourRequest { name: fields.text("name")?, hold: fields.number_or("hold", 0.0)? })
        }
        "place" => Target::Place(place(&value)?),
        "path" => Target::Path(path(&value)?),
        "keys" => {
            let fields = Fields::new(&value, kind, &["poses"])?;
            let poses = fields.list("poses")?.iter().map(key).collect::<Result<_, _>>()?;
            Target::Keys(KeysRequest { poses })
        }
        "wander" => Target::Wander(wander(&value)?),
        _ => Target::Queue(list(&value, kind)?.iter().map(target).collect::<Result<_, _>>()?),
    })
}

fn frame(value: &JsValue) -> Result<FrameRef, JsValue> {
    if value.as_f64().is_some() {
        return Ok(FrameRef::Number(whole(value.clone(), "a pose")?));
    }
    let fields = Fields::new(value, "a pose", &["sequence", "frame", "time"])?;
    Ok(FrameRef::Within(WithinSequence {
        sequence: fields.text("sequence")?,
        frame: fields.maybe("frame").map(|frame| whole(frame, "a pose's frame")).transpose()?,
        time: fields.maybe("time").map(|time| number(&time, "a pose's time")).transpose()?,
    }))
}

fn place(value: &JsValue) -> Result<PlaceRequest, JsValue> {
    let fields = Fields::new(value, "the place", &["x", "z", "heading", "realism"])?;
    Ok(PlaceRequest {
        x: fields.number("x")? as f32,
        z: fields.number("z")? as f32,
        heading: fields.maybe("heading").map(|heading| number(&heading, "heading")).transpose()?.map(|h| h as f32),
        realism: fields.number_or("realism", DEFAULT_REALISM)?,
    })
}

fn path(value: &JsValue) -> Result<PathRequest, JsValue> {
    let known = ["points", "shape", "stretches", "free_start", "vertices", "realism"];
    let fields = Fields::new(value, "the path", &known)?;
    let point = |point: &JsValue| -> Result<Vec<f32>, JsValue> {
        list(point, "a point")?.iter().map(|part| Ok(number(part, "a point's coordinate")? as f32)).collect()
    };
    let shape = match fields.maybe("shape").map(|shape| shape.as_string()) {
        None => Shape::default(),
        Some(Some(shape)) if shape == "spline" => Shape::Spline,
        Some(Some(shape)) if shape == "polyline" => Shape::Polyline,
        Some(_) => return Err(wrong("a path's shape is spline or polyline")),
    };
    Ok(PathRequest {
        points: fields.list("points")?.iter().map(point).collect::<Result<_, _>>()?,
        shape,
        stretches: fields.list("stretches")?.iter().map(stretch).collect::<Result<_, _>>()?,
        free_start: fields.maybe("free_start").is_some_and(|free| free.is_truthy()),
        vertices: fields.list("vertices")?.into_iter().map(|one| whole(one, "a vertex")).collect::<Result<_, _>>()?,
        realism: fields.number_or("realism", PATH_REALISM)?,
    })
}

fn stretch(value: &JsValue) -> Result<Stretch, JsValue> {
    let fields = Fields::new(value, "a stretch", &["from", "to", "behaviour"])?;
    Ok(Stretch { from: fields.number("from")?, to: fields.number("to")?, behaviour: fields.text("behaviour")? })
}

fn key(value: &JsValue) -> Result<Key, JsValue> {
    let fields = Fields::new(value, "a key pose", &["pose", "time"])?;
    Ok(Key { pose: frame(&fields.need("pose")?)?, time: fields.number("time")? })
}

fn wander(value: &JsValue) -> Result<WanderRequest, JsValue> {
    let fields = Fields::new(value, "wandering", &["seconds", "weights"])?;
    let mut weights = BTreeMap::new();
    if let Some(given) = fields.maybe("weights") {
        if !given.is_object() || Array::is_array(&given) {
            return Err(is_no("weights", "object"));
        }
        for entry in Object::entries(given.unchecked_ref::<Object>()).iter() {
            let entry: Array = entry.unchecked_into();
            let name = entry.get(0).as_string().unwrap_or_default();
            weights.insert(name, number(&entry.get(1), "a weight")?);
        }
    }
    Ok(WanderRequest { seconds: fields.number("seconds")?, weights })
}
