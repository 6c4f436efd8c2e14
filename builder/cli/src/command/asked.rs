//! What `builder direct` is asked for, by whichever option.

use std::path::Path;

use anyhow::{Context, anyhow};
use kernels::align::Placement;
use search::{KeysRequest, PathRequest, Request, Start, Target, WanderRequest};
use serde::Deserialize;
use serde_json::Value;

use super::args::DirectArguments;
use super::failure::Failure;

/// A request, and where the actor was when it was made, where that is known.
pub struct Asked {
    pub request: Request,
    pub start: Option<Start>,
}

/// Where the actor was, as the page saves it.
#[derive(Deserialize)]
struct SavedStart {
    frame: u32,
    placement: [f32; 3],
}

/// What was asked for.
pub fn asked(arguments: &DirectArguments) -> Result<Asked, Failure> {
    let mut targets = Vec::new();
    if let Some(path) = &arguments.request {
        let mut asked = saved(path)?;
        asked.request.seed = arguments.seed.unwrap_or(asked.request.seed);
        asked.request.quickness = arguments.quickness.or(asked.request.quickness);
        bend(&mut asked.request.target, arguments.exactness);
        asked.request.check_numbers().map_err(|error| Failure::Input(error.into()))?;
        return Ok(asked);
    }
    if let Some(path) = &arguments.path {
        let path_request = PathRequest::of_json(&json(path, &read(path)?)?.into());
        targets.push(Target::Path(path_request.map_err(|error| wrong(path, &error))?));
    }
    if let Some(path) = &arguments.keys {
        let value: Value = toml::from_str(&read(path)?).map_err(|error| wrong(path, &error))?;
        targets.push(Target::Keys(KeysRequest::of_json(&value.into()).map_err(|error| wrong(path, &error))?));
    }
    targets.extend(arguments.place.clone().map(Target::Place));
    targets.extend(arguments.behaviour.clone().map(Target::Behaviour));
    if let Some(seconds) = arguments.wander {
        targets.push(Target::Wander(WanderRequest { seconds, ..WanderRequest::default() }));
    }
    targets.extend(arguments.to.iter().map(|to| Target::Pose(to.0.clone())));
    let target = match (targets.len(), targets.pop()) {
        (1, Some(target)) => target,
        (_, Some(last)) => Target::Queue(targets.into_iter().chain([last]).collect()),
        (_, None) => {
            let options = "--path, --keys, --place, --behaviour, --wander, --to or --request";
            return Err(Failure::Usage(format!("say what to do: {options}")));
        }
    };
    let mut target = target;
    bend(&mut target, arguments.exactness);
    let (seed, quickness) = (arguments.seed.unwrap_or(0), arguments.quickness);
    let request = Request { seed, quickness, ..Request::new(target) };
    request.check_numbers().map_err(|error| Failure::Input(error.into()))?;
    Ok(Asked { request, start: None })
}

/// Bends walks to paths and places as far as was said.
fn bend(target: &mut Target, exactness: Option<f64>) {
    let Some(wanted) = exactness else { return };
    match target {
        Target::Path(path) => path.exactness = wanted,
        Target::Place(place) => place.exactness = wanted,
        Target::Queue(targets) => targets.iter_mut().for_each(|target| bend(target, exactness)),
        _ => {}
    }
}

/// A request from a file: by itself, or as `request` beside `start`, as links and files of the page hold it, or as `request`
/// of what `--json` prints.
fn saved(path: &Path) -> Result<Asked, Failure> {
    let text = read(path)?;
    let plain = |text: &str| Request::from_json(text).map_err(|error| wrong(path, &error));
    let Value::Object(mut fields) = json(path, &text)? else {
        return Ok(Asked { request: plain(&text)?, start: None });
    };
    let Some(request) = fields.remove("request") else {
        return Ok(Asked { request: plain(&text)?, start: None });
    };
    let start = match fields.remove("start").filter(|start| !start.is_null()) {
        Some(start) => {
            let saved: SavedStart =
                serde_json::from_value(start).map_err(|error| wrong(path, &format!("the start: {error}")))?;
            let [heading, x, z] = saved.placement;
            if !saved.placement.iter().all(|number| number.is_finite() && number.abs() < 1e5) {
                return Err(wrong(path, &"the start's placement must be a heading and metres along X and Z"));
            }
            Some(Start { frame: saved.frame, placement: Placement { heading, translation: glam::Vec2::new(x, z) } })
        }
        None => None,
    };
    Ok(Asked { request: plain(&request.to_string())?, start })
}

/// What a file of JSON holds. Where it holds none, the error says where it ends to be JSON.
fn json(path: &Path, text: &str) -> Result<Value, Failure> {
    serde_json::from_str(text).map_err(|error| {
        let refused = Request::from_json(text).err().map_or_else(String::new, |refused| refused.to_string());
        wrong(path, &format!("{refused}: {error}"))
    })
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display())).map_err(Failure::Input)
}

fn wrong(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::Input(anyhow!("{}: {error}", path.display()))
}
