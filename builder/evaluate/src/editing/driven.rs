//! Sequences that were driven by motion capture beside the recording (Fig. 10): volume, folds, soles.

use actor::capture::Capture;
use capture_io::mocap::{MocapOptions, read_clip};
use drive::{body, retarget};
use driving::{Mapping, MappingFile};
use editing::Rig;
use glam::Vec3;
use job::Job;

use super::shape::{folded, volume};
use crate::EvaluateError;
use crate::document::{Cell, Table};

/// Recorded frames that are measured, at most.
const SAMPLES: usize = 100;

/// The table, and what of the clips could not be driven, in sentences.
pub fn driven(
    capture: &Capture,
    rig: &Rig,
    clips: &[String],
    job: &Job,
) -> Result<(Table, Vec<String>), EvaluateError> {
    let columns = [
        "sequence",
        "frames",
        "volume least",
        "volume mean",
        "folded mean %",
        "folded most %",
        "soles mm",
        "slide mm",
        "standing %",
    ];
    let caption = "Driven sequences beside the recorded frames: volume over the recorded mean, edges whose triangles are folded by more than a \
                   right angle, and soles that stand";
    let mut table = Table::new("editing_driven", caption, &columns);
    let Capture { topology, timeline, poses, .. } = capture;
    let every = poses.len().div_ceil(SAMPLES).max(1);
    let recorded: Vec<Vec<Vec3>> = poses.iter().step_by(every).map(<[Vec3]>::to_vec).collect();
    let whole = recorded.iter().map(|pose| volume(topology, pose)).sum::<f64>() / recorded.len().max(1) as f64;
    let measured = |name: &str, frames: &[Vec<Vec3>], feet: [Cell; 3]| {
        let volumes: Vec<f64> = frames.iter().map(|pose| volume(topology, pose) / whole).collect();
        let folds: Vec<f64> = frames.iter().map(|pose| 100.0 * folded(topology, pose)).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let mut row = vec![
            name.into(),
            Cell::Count(frames.len() as u64),
            Cell::Number(volumes.iter().copied().fold(f64::INFINITY, f64::min), 3),
            Cell::Number(mean(&volumes), 3),
            Cell::Number(mean(&folds), 3),
            Cell::Number(folds.iter().copied().fold(0.0, f64::max), 3),
        ];
        row.extend(feet);
        row
    };
    table.rows.push(measured("recorded", &recorded, [Cell::Empty, Cell::Empty, Cell::Empty]));
    let mut notes = Vec::new();
    let body = match body(rig, poses) {
        Ok(body) => body,
        Err(error) => return Ok((table, vec![error.to_string()])),
    };
    for (k, clip) in clips.iter().enumerate() {
        job.tell("clips", k as u64, clips.len() as u64)?;
        let name = clip.rsplit(['/', '+']).next().unwrap_or(clip);
        let options = MocapOptions::default();
        let read = read_clip(clip, &options).map_err(|error| error.to_string()).and_then(|read| {
            let mapping = Mapping::of(&read.clip, &MappingFile::default()).map_err(|error| error.to_string())?;
            let mesh = (topology, None);
            retarget((&read.clip, &mapping), &body, mesh, (poses, timeline.fps())).map_err(|error| error.to_string())
        });
        match read {
            Ok(made) => {
                let number = |value: f32, decimals| Cell::Number(value.into(), decimals);
                let measures = &made.measures;
                let feet = [
                    number(measures.sole_off_mm[0], 1),
                    number(measures.slide_mm[0], 2),
                    number(100.0 * measures.standing, 0),
                ];
                table.rows.push(measured(name, &made.poses, feet));
            }
            Err(error) => notes.push(format!("{name}: {error}")),
        }
    }
    Ok((table, notes))
}
