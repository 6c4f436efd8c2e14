//! Steps: stretches of time in which a foot stands in one place.

use std::ops::Range;

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::contacts::Contacts;

/// A foot that goes farther than this from where it stands slides, and stands anew: in metres and radians.
const FARTHEST: f32 = 0.06;
const MOST_TURN: f32 = 0.35;
/// Between two places of a sliding foot, in seconds.
const SLIDE: f32 = 0.12;
/// Steps shorter than this are none, in seconds.
const SHORTEST: f32 = 0.06;

/// Where a foot is over the ground in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Print {
    /// The middle of its sole (X, Z), in metres.
    pub place: Vec2,
    /// The way it points, of length 1 (X, Z).
    pub ahead: Vec2,
}

/// A foot that stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Its frames.
    pub frames: Range<usize>,
    /// Where it stands.
    pub print: Print,
}

/// The steps of a foot that would be over the ground at `prints`, frame by frame.
#[must_use]
pub fn steps(contacts: &Contacts, prints: &[Print], fps: f32) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut from = 0;
    while from < prints.len() {
        if !contacts.stands(from) {
            from += 1;
            continue;
        }
        let to = (from..prints.len()).find(|&frame| !contacts.stands(frame)).unwrap_or(prints.len());
        split(from..to, contacts, prints, fps, &mut steps);
        from = to;
    }
    let least = (SHORTEST * fps).ceil() as usize;
    steps.retain(|step| step.frames.len() >= least);
    steps
}

/// One stretch of contact: one step, or several where the foot slides meanwhile.
fn split(frames: Range<usize>, contacts: &Contacts, prints: &[Print], fps: f32, steps: &mut Vec<Step>) {
    let half = (0.5 * SLIDE * fps).ceil() as usize;
    let mut begin = frames.start;
    let mut frame = begin;
    while frame < frames.end {
        let print = mean(begin..frame + 1, contacts, prints);
        let strays = |other: &Print| {
            other.place.distance(print.place) > FARTHEST
                || other.ahead.dot(print.ahead) < kernels::scalar::sin_cos(MOST_TURN).1
        };
        if strays(&prints[frame]) || strays(&prints[begin]) {
            let end = frame.saturating_sub(half).max(begin);
            if end > begin {
                steps.push(Step { frames: begin..end, print: mean(begin..end, contacts, prints) });
            }
            begin = (end + 2 * half).max(frame);
            frame = begin;
        } else {
            frame += 1;
        }
    }
    if begin < frames.end {
        steps.push(Step { frames: begin..frames.end, print: mean(begin..frames.end, contacts, prints) });
    }
}

/// The mean print of the frames in which the foot lies flat, or of all where it never does.
fn mean(frames: Range<usize>, contacts: &Contacts, prints: &[Print]) -> Print {
    let flat: Vec<usize> = frames.clone().filter(|&frame| contacts.heel[frame] && contacts.ball[frame]).collect();
    let taken = if flat.is_empty() { frames.collect() } else { flat };
    let count = taken.len().max(1) as f32;
    let place = taken.iter().map(|&frame| prints[frame].place).sum::<Vec2>() / count;
    let ahead = taken.iter().map(|&frame| prints[frame].ahead).sum::<Vec2>().normalize_or(Vec2::Y);
    Print { place, ahead }
}

impl Print {
    /// The print of a foot whose middle is at `middle` and which points `ahead`.
    #[must_use]
    pub fn of(middle: Vec3, ahead: Vec3) -> Self {
        Self { place: middle.xz(), ahead: ahead.xz().normalize_or(Vec2::Y) }
    }
}
