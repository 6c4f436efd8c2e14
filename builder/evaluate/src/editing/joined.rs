//! Driven sequences joined to the recording, their ends edited towards it: before and after (sections V-B and V-C, figures 11 and 17).

use actor::capture::Capture;
use drive::Driven;
use driving::Body;
use glam::Vec3;
use job::Job;
use reprise::hybrid::{DrivenFrames, EditedBy, EndReport, HybridError, join};

use super::basis::aligned;
use super::strip::{RECORDED, Shown, strip};
use crate::EvaluateError;
use crate::document::{Cell, Picture, Table};

/// Distances of this and more are all red, in metres.
const RED: f32 = 0.25;
/// Frames of the strip to the driven side, and how many lie between two.
const FRAMES: usize = 6;
const EVERY: usize = 5;

/// The empty table.
pub fn table() -> Table {
    let columns = [
        "clip",
        "end",
        "recorded",
        "edited by",
        "frames changed",
        "apart mm before",
        "after",
        "cost before",
        "after",
        "acceleration before",
        "after",
    ];
    let caption = "The best transition between the recording and each driven sequence, as driven and with the ends edited: mean distance of \
                   vertices of the frames that are blended in its middle, cost, and the largest mean acceleration of the surface on it, \
                   m/s^2";
    Table::new("editing_joins", caption, &columns)
}

/// Joins a driven sequence: rows of the table, and a picture of the way in.
pub fn joined(
    capture: &Capture,
    body: &Body,
    (name, driven): (&str, &Driven),
    job: &Job,
) -> Result<(Vec<Vec<Cell>>, Vec<Picture>), EvaluateError> {
    let mesh = (&capture.topology, None);
    let remade = |aims: &[_]| driven.towards(aims, body, mesh).ok().map(|(_, poses)| poses);
    let frames = DrivenFrames { name, body, poses: &driven.poses, free: &driven.free, remade: &remade };
    let made = join(capture, frames, job).map_err(|error| match error {
        HybridError::Stopped(stopped) => EvaluateError::Stopped(stopped),
        error => EvaluateError::Edit(error.to_string()),
    })?;
    let rows = made.ends.iter().map(|end| row(name, end)).collect();
    let entry = made.ends.iter().find(|end| end.inwards && end.after.is_some());
    let picture = entry.map(|end| picture(capture, name, (&driven.poses, &made.poses), end)).transpose()?;
    Ok((rows, picture.into_iter().collect()))
}

fn row(name: &str, end: &EndReport) -> Vec<Cell> {
    let (before, after) = (&end.before, end.after.as_ref());
    let by = match end.by {
        Some(EditedBy::Bones) => "bones",
        Some(EditedBy::Surface) => "surface",
        None => "nothing",
    };
    let number = |value: f64, digits| Cell::Number(value, digits);
    let or_none = |value: Option<f64>, digits| value.map_or(Cell::Empty, |value| Cell::Number(value, digits));
    vec![
        name.into(),
        if end.inwards { "in" } else { "out" }.into(),
        format!("{} {}", end.sequence, before.frames[0]).into(),
        by.into(),
        Cell::Count(end.changed.into()),
        number(before.apart_mm.into(), 0),
        or_none(after.map(|way| way.apart_mm.into()), 0),
        number(before.cost, 2),
        or_none(after.map(|way| way.cost), 2),
        number(before.acceleration[0].into(), 1),
        or_none(after.map(|way| way.acceleration[0].into()), 1),
    ]
}

/// Figure 11: the recorded frame that is blended in the middle, then the driven ones from their beginning, as driven and edited, red where they
/// are far from it.
fn picture(
    capture: &Capture,
    name: &str,
    (driven, edited): (&[Vec<Vec3>], &[Vec<Vec3>]),
    end: &EndReport,
) -> Result<Picture, EvaluateError> {
    let weights = capture.topology.weights();
    let first =
        capture.timeline.sequences().iter().find(|one| one.name == end.sequence).map_or(0, |one| one.first_frame);
    let way = end.after.as_ref().unwrap_or(&end.before);
    // The way begins in the recorded frame; what is blended in its middle lies half of it later.
    let at = first + way.frames[0] + u32::from(way.duration) / 2;
    let recorded = capture.poses.frame(at.min(capture.timeline.frame_count() - 1));
    let middle = (way.frames[1] as usize).saturating_sub(usize::from(way.duration) / 2);
    let row = |poses: &[Vec<Vec3>]| {
        let mut row = vec![Shown::plain(recorded, RECORDED)];
        for step in 0..FRAMES {
            let pose = &poses[(middle + EVERY * step).min(poses.len() - 1)];
            row.push(Shown::heat(&aligned(recorded, pose, weights), recorded, RED));
        }
        row
    };
    let caption = format!(
        "Figs. 11 and 17: the way into {name} from {}. Blue: the recorded frame in the middle of the transition; then the driven frame that it is \
         blended with and every {EVERY}th after it, laid onto the recorded one and red where {RED} m away from it: as driven, and edited",
        end.sequence
    );
    let floor = recorded.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    strip(capture.topology.triangles(), weights, &[row(driven), row(edited)], (0.6, floor), caption)
}
