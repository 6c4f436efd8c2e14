//! BVH: a hierarchy of joints with channels, then the channels' numbers frame by frame.
//!
//! Channels are multiplied in the order in which the file lists them: `Zrotation Yrotation Xrotation` is Rz Ry Rx. A position
//! channel stands in the place of the joint's offset along its axis.

use std::collections::HashSet;

use driving::clip::{MOST_FRAMES, MOST_JOINTS, MOST_POSITIONS};
use driving::{Clip, ClipError, ClipJoint};
use glam::{DQuat, DVec3};

use crate::error::{MocapError, clip_error};
use crate::skeleton::stance;
use crate::words::{Words, number, syntax, text};

/// What a channel moves: 0 to 2 is the position along an axis, 3 to 5 the rotation about one.
type Channel = usize;

const CHANNELS: [&str; 6] = ["Xposition", "Yposition", "Zposition", "Xrotation", "Yrotation", "Zrotation"];

#[derive(Default)]
struct Hierarchy {
    joints: Vec<ClipJoint>,
    offsets: Vec<DVec3>,
    /// Joint and channel, in the file's order.
    channels: Vec<(usize, Channel)>,
}

/// Reads a BVH file; lengths are the file's.
pub fn read(source: &str, bytes: &[u8]) -> Result<Clip, MocapError> {
    let text = text(bytes);
    let mut words = Words::new(source, &text);
    let hierarchy = hierarchy(source, &mut words)?;
    words.expect("MOTION")?;
    words.expect("Frames:")?;
    let line = words.line();
    let frames = words.number("the number of frames")?;
    words.expect("Frame")?;
    words.expect("Time:")?;
    let time = words.number("the time of a frame")?;
    if frames < 1.0 || frames.fract() != 0.0 {
        return Err(syntax(source, line, format!("{frames} frames are none")));
    }
    if !(time > 1e-6 && time < 1e6) {
        return Err(syntax(source, line + 1, format!("a frame of {time} seconds has no rate")));
    }
    let numbers = numbers(source, &hierarchy, frames, &words)?;
    let Hierarchy { joints, offsets, channels } = hierarchy;
    let rest = stance(&joints, &offsets, &vec![DQuat::IDENTITY; joints.len()]);
    let pose = |numbers: &[f64]| {
        let (mut places, mut turns) = (offsets.clone(), vec![DQuat::IDENTITY; joints.len()]);
        for (&(joint, channel), &number) in channels.iter().zip(numbers) {
            if channel < 3 {
                places[joint][channel] = number;
            } else {
                turns[joint] *= about(channel - 3, number.to_radians());
            }
        }
        stance(&joints, &places, &turns)
    };
    let frames = numbers.chunks_exact(channels.len().max(1)).map(pose).collect();
    Clip::new(joints, (1.0 / time) as f32, frames, Some(rest)).map_err(clip_error(source))
}

/// The rotation about an axis, by its number.
pub fn about(axis: usize, angle: f64) -> DQuat {
    match axis {
        0 => DQuat::from_rotation_x(angle),
        1 => DQuat::from_rotation_y(angle),
        _ => DQuat::from_rotation_z(angle),
    }
}

fn hierarchy(source: &str, words: &mut Words) -> Result<Hierarchy, MocapError> {
    words.expect("HIERARCHY")?;
    words.expect("ROOT")?;
    let mut found = Hierarchy::default();
    let mut names = HashSet::new();
    // The joints within whose braces the file is.
    let mut open: Vec<usize> = Vec::new();
    let mut keyword = "ROOT";
    loop {
        match keyword.to_ascii_uppercase().as_str() {
            "ROOT" | "JOINT" | "END" => {
                let name = words.word("a joint's name")?;
                let parent = open.last().copied();
                let is_end = keyword.eq_ignore_ascii_case("END");
                let name = match parent {
                    Some(parent) if is_end => format!("{} end", found.joints[parent].name),
                    _ => name.to_owned(),
                };
                if !is_end && !names.insert(name.clone()) {
                    return Err(words.wrong(format!("two joints are called {name:?}")));
                }
                if found.joints.len() == MOST_JOINTS {
                    return Err(words.wrong(format!("there are more than {MOST_JOINTS} joints")));
                }
                words.expect("{")?;
                words.expect("OFFSET")?;
                open.push(found.joints.len());
                found.joints.push(ClipJoint { name, parent });
                found.offsets.push(words.vector("an offset")?);
            }
            "CHANNELS" => channels(source, words, &mut found, open.last().copied())?,
            "}" => {
                open.pop();
                if open.is_empty() {
                    return Ok(found);
                }
            }
            _ => {
                let shown: String = keyword.chars().take(40).collect();
                return Err(words.wrong(format!("{shown:?} is nothing that a joint has")));
            }
        }
        keyword = words.word("the hierarchy")?;
    }
}

fn channels(source: &str, words: &mut Words, found: &mut Hierarchy, joint: Option<usize>) -> Result<(), MocapError> {
    let line = words.line();
    let count = words.number("the number of channels")?;
    if !(0.0..=6.0).contains(&count) || count.fract() != 0.0 {
        return Err(syntax(source, line, format!("a joint has up to 6 channels, not {count}")));
    }
    for _ in 0..count as usize {
        let line = words.line();
        let word = words.word("a channel")?;
        let Some(channel) = CHANNELS.iter().position(|name| name.eq_ignore_ascii_case(word)) else {
            let shown: String = word.chars().take(40).collect();
            return Err(syntax(source, line, format!("{shown:?} is no channel; {count} were announced")));
        };
        found.channels.push((joint.unwrap_or(0), channel));
    }
    Ok(())
}

/// The numbers of all frames, once there are as many as announced.
fn numbers(source: &str, hierarchy: &Hierarchy, frames: f64, words: &Words) -> Result<Vec<f64>, MocapError> {
    let (width, rest) = (hierarchy.channels.len(), words.rest());
    let too_many =
        |what, count: f64, most| clip_error(source)(ClipError::TooMany { what, count: count.min(1e15) as usize, most });
    if frames > MOST_FRAMES as f64 {
        return Err(too_many("frames", frames, MOST_FRAMES));
    }
    let joints = hierarchy.joints.len();
    if frames * joints as f64 > MOST_POSITIONS as f64 {
        return Err(too_many("positions", frames * joints as f64, MOST_POSITIONS));
    }
    if width == 0 {
        return Err(clip_error(source)(ClipError::Empty("channel")));
    }
    let wanted = frames as usize * width;
    if rest.len() != wanted {
        // Frames are lines, as a rule: the first that is not as long as it should be is the one to name.
        let mut lines: Vec<(usize, usize)> = Vec::new();
        for &(line, _) in rest {
            match lines.last_mut() {
                Some((last, count)) if *last == line => *count += 1,
                _ => lines.push((line, 1)),
            }
        }
        if let Some((line, count)) = lines.iter().find(|(_, count)| *count != width) {
            return Err(syntax(source, *line, format!("{count} numbers for {width} channels")));
        }
        if rest.len() < wanted {
            let what = format!("frame {} of the {frames} that are announced", rest.len() / width + 1);
            return Err(MocapError::Truncated { file: source.into(), what });
        }
        let line = rest.get(wanted).map_or(0, |(line, _)| *line);
        return Err(syntax(source, line, format!("there are more than the {frames} frames that are announced")));
    }
    rest.iter().map(|&(line, word)| number(source, line, word)).collect()
}
