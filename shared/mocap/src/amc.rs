//! AMC: how the skeleton of an ASF file moves, frame by frame. The format has no rate.

use driving::clip::{MOST_FRAMES, MOST_POSITIONS};
use driving::{Clip, ClipError, Stance};
use glam::{DQuat, DVec3};

use crate::asf::Asf;
use crate::bvh::about;
use crate::error::{MocapError, clip_error};
use crate::skeleton::stance;
use crate::words::{lines, number, syntax, text};

/// Frames a second where nothing is said: those of the database that the format comes from.
pub const RATE: f32 = 120.0;

/// A frame that is being read.
struct Frame {
    line: usize,
    places: Vec<DVec3>,
    turns: Vec<DQuat>,
    seen: Vec<bool>,
}

/// Reads the motion of `asf` at `rate` frames a second; lengths are the skeleton's.
pub fn read(source: &str, bytes: &[u8], asf: &Asf, rate: f32) -> Result<Clip, MocapError> {
    let text = text(bytes);
    let mut degrees = asf.degrees;
    let mut frames: Vec<Stance> = Vec::new();
    let mut open: Option<Frame> = None;
    for (line, text) in lines(&text) {
        let mut words = text.split_whitespace();
        let first = words.next().unwrap_or_default();
        if let Some(keyword) = first.strip_prefix(':') {
            match keyword.to_ascii_uppercase().as_str() {
                "DEGREES" => degrees = true,
                "RADIANS" => degrees = false,
                _ => {}
            }
            continue;
        }
        let numbers: Vec<&str> = words.collect();
        if numbers.is_empty() {
            first.parse::<u64>().map_err(|_| syntax(source, line, format!("{first:?} is no number of a frame")))?;
            finish(source, asf, open.take(), &mut frames)?;
            open = Some(Frame {
                line,
                places: asf.offsets.clone(),
                turns: vec![DQuat::IDENTITY; asf.joints.len()],
                seen: vec![false; asf.joints.len()],
            });
            continue;
        }
        let Some(frame) = &mut open else {
            return Err(syntax(source, line, "a frame's number is missing before this"));
        };
        let shown: String = first.chars().take(40).collect();
        let joint = asf.by_name.get(first);
        let joint = *joint.ok_or_else(|| syntax(source, line, format!("the skeleton has no bone {shown:?}")))?;
        let wanted = if joint == 0 { asf.root.len() } else { asf.dofs[joint].len() };
        if numbers.len() != wanted {
            let reason = format!("{} numbers for the {wanted} of bone {shown:?}", numbers.len());
            return Err(syntax(source, line, reason));
        }
        if std::mem::replace(&mut frame.seen[joint], true) {
            return Err(syntax(source, line, format!("bone {shown:?} comes twice in a frame")));
        }
        let numbers = numbers.iter().map(|word| number(source, line, word)).collect::<Result<Vec<_>, _>>()?;
        pose(asf, joint, &numbers, degrees, frame);
    }
    finish(source, asf, open, &mut frames)?;
    let rest = stance(&asf.joints, &asf.offsets, &vec![DQuat::IDENTITY; asf.joints.len()]);
    Clip::new(asf.joints.clone(), rate, frames, Some(rest)).map_err(clip_error(source))
}

/// Puts the numbers of one bone into the frame.
fn pose(asf: &Asf, joint: usize, numbers: &[f64], degrees: bool, frame: &mut Frame) {
    let angle = |number: f64| if degrees { number.to_radians() } else { number };
    if joint > 0 {
        let turn = asf.dofs[joint]
            .iter()
            .zip(numbers)
            .fold(DQuat::IDENTITY, |turn, (&axis, &number)| about(axis, angle(number)) * turn);
        frame.turns[joint] = asf.axes[joint] * turn * asf.axes[joint].conjugate();
        return;
    }
    let (origin, axes) = asf.origin;
    let (mut place, mut turn) = (DVec3::ZERO, DQuat::IDENTITY);
    for (&what, &number) in asf.root.iter().zip(numbers) {
        if what < 3 {
            place[what] = number;
        } else {
            turn = about(what - 3, angle(number)) * turn;
        }
    }
    frame.places[0] = origin + place;
    frame.turns[0] = axes * turn * axes.conjugate();
}

/// Ends a frame, which must have said something of every bone that turns.
fn finish(source: &str, asf: &Asf, open: Option<Frame>, frames: &mut Vec<Stance>) -> Result<(), MocapError> {
    let Some(frame) = open else { return Ok(()) };
    let lacks = |&joint: &usize| !frame.seen[joint] && (joint == 0 || !asf.dofs[joint].is_empty());
    if let Some(joint) = (0..asf.joints.len()).find(lacks) {
        let reason = format!("the frame that begins here says nothing of bone {:?}", asf.joints[joint].name);
        return Err(syntax(source, frame.line, reason));
    }
    if frames.len() >= MOST_FRAMES || (frames.len() + 1) * asf.joints.len() > MOST_POSITIONS {
        let too_many = ClipError::TooMany { what: "frames", count: frames.len() + 1, most: frames.len() };
        return Err(clip_error(source)(too_many));
    }
    frames.push(stance(&asf.joints, &frame.places, &frame.turns));
    Ok(())
}
