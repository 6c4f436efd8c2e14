//! Values as they are typed.

use search::{BehaviourRequest, FrameRef, PlaceRequest, WithinSequence};

/// Reads a place as it is typed: `2,1.5` or `2,1.5,0.8`.
pub fn parse_place(text: &str) -> Result<PlaceRequest, String> {
    let wrong = || format!("{text:?} is no place, such as 2,1.5 or 2,1.5,0.8 or 2,1.5@kick:0.5");
    let (text, pose) = match text.split_once('@') {
        Some((place, pose)) => (place, Some(parse_pose(pose)?.0)),
        None => (text, None),
    };
    let numbers: Vec<f32> =
        text.split(',').map(|part| part.trim().parse().map_err(|_| wrong())).collect::<Result<_, _>>()?;
    match *numbers.as_slice() {
        [x, z] => Ok(PlaceRequest { x, z, pose, ..PlaceRequest::default() }),
        [x, z, heading] => Ok(PlaceRequest { x, z, heading: Some(heading), pose, ..PlaceRequest::default() }),
        _ => Err(wrong()),
    }
}

/// Reads a behaviour as it is typed: `walk`, or `walk:5s` to hold it.
pub fn parse_behaviour(text: &str) -> Result<BehaviourRequest, String> {
    let (name, hold) = match text.rsplit_once(':') {
        Some((name, seconds)) => (name, parse_seconds(seconds)?),
        None => (text, 0.0),
    };
    Ok(BehaviourRequest { name: name.into(), hold })
}

/// A pose as it is typed: a frame's number, or `NAME:SECONDS`.
#[derive(Clone, Debug)]
pub struct TypedPose(pub FrameRef);

/// Reads a pose as it is typed.
pub fn parse_pose(text: &str) -> Result<TypedPose, String> {
    if let Ok(number) = text.parse() {
        return Ok(TypedPose(FrameRef::Number(number)));
    }
    let (name, time) = text.rsplit_once(':').unwrap_or((text, "0"));
    let time: f64 = time.parse().map_err(|_| format!("{time:?} is no time in seconds"))?;
    let within = WithinSequence { sequence: name.into(), frame: None, time: Some(time) };
    Ok(TypedPose(FrameRef::Within(within)))
}

/// Reads a duration as it is typed: `60`, `60s` or `2min`.
pub fn parse_seconds(text: &str) -> Result<f64, String> {
    let (number, unit) = match text {
        text if text.ends_with("min") => (&text[..text.len() - 3], 60.0),
        text if text.ends_with('s') => (&text[..text.len() - 1], 1.0),
        text => (text, 1.0),
    };
    let seconds: f64 = number.trim().parse().map_err(|_| format!("{text:?} is no duration, such as 60s"))?;
    if seconds.is_finite() && seconds >= 0.0 { Ok(seconds * unit) } else { Err("a duration is not negative".into()) }
}

/// Reads a size in pixels as it is typed: `720x720`.
pub fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let wrong = || format!("{text:?} is no size, such as 720x720, of 16 to 4096 pixels");
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let side = |side: &str| side.parse().ok().filter(|side| (16..=4096).contains(side)).ok_or_else(wrong);
    Ok((side(width)?, side(height)?))
}
