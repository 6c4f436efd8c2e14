//! What became of a request: paths as they were really walked, and the table of key poses.

use std::path::Path;

use glam::Vec3;
use search::{Answer, Curve, Goal, Shape};
use serde::Serialize;
use serde_json::{Value, json};

use super::failure::Failure;
use super::output::write_whole;

/// A path as it was walked: centres of mass of the frames that were made against the point of equal arc length.
#[derive(Serialize)]
pub struct Walked {
    /// Index of the part.
    pub part: usize,
    /// Mean distance in metres.
    pub mean: f64,
    /// Largest distance in metres.
    pub max: f64,
    /// Mean distance in metres to the nearest point of the path.
    pub mean_aside: f64,
    /// The largest such distance.
    pub max_aside: f64,
}

/// Deviations of the centres of mass that were really walked from each path.
pub fn walked(answer: &Answer, centres: &[Vec3], is_centre: bool) -> Vec<Walked> {
    let mut walked = Vec::new();
    for (part, planned) in answer.parts.iter().enumerate() {
        let Goal::Path(report) = &planned.goal else { continue };
        let first = planned.first_step as usize;
        let Some(frames) = centres.get(first..=first + planned.steps as usize) else { continue };
        if !is_centre {
            continue;
        }
        let points: Vec<Vec3> = report.curve.iter().map(|&point| point.into()).collect();
        let curve = Curve::new(&points, Shape::Polyline, report.flat, None);
        let mut sums = Walked { part, mean: 0.0, max: 0.0, mean_aside: 0.0, max_aside: 0.0 };
        let mut travelled = 0.0;
        for pair in frames.windows(2) {
            let step = pair[1] - pair[0];
            travelled += f64::from(if report.flat { step.x.hypot(step.z) } else { step.length() });
            let (off, aside) = (curve.distance(pair[1], travelled), curve.nearest(pair[1], travelled));
            (sums.mean, sums.max) = (sums.mean + off, sums.max.max(off));
            (sums.mean_aside, sums.max_aside) = (sums.mean_aside + aside, sums.max_aside.max(aside));
        }
        let count = (frames.len() - 1).max(1) as f64;
        (sums.mean, sums.mean_aside) = (sums.mean / count, sums.mean_aside / count);
        walked.push(sums);
    }
    walked
}

/// Writes the table of key poses, wanted and reached (thesis figure 3.18), as CSV or JSON by the file's ending.
pub fn write_times(answer: &Answer, fps: f64, path: &Path) -> Result<(), Failure> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let tables = answer.parts.iter().filter_map(|part| match &part.goal {
        Goal::Keys { rows, .. } => Some((part.first_step, rows)),
        _ => None,
    });
    let mut lines =
        vec!["frame,shown,wanted_frames,reached_frames,error_frames,wanted_seconds,reached_seconds".to_owned()];
    let mut values: Vec<Value> = Vec::new();
    for (_, row) in tables.flat_map(|(first, rows)| rows.iter().map(move |row| (first, row))) {
        let error = row.reached.map(|reached| i64::from(reached) - i64::from(row.wanted));
        let seconds = |frames: u32| f64::from(frames) / fps;
        values.push(json!({
            "frame": row.frame, "shown": row.shown, "wanted_frames": row.wanted, "reached_frames": row.reached,
            "error_frames": error, "wanted_seconds": seconds(row.wanted), "reached_seconds": row.reached.map(seconds),
        }));
        let cell = |number: Option<String>| number.unwrap_or_default();
        lines.push(format!(
            "{},{},{},{},{},{:.4},{}",
            row.frame,
            row.shown,
            row.wanted,
            cell(row.reached.map(|reached| reached.to_string())),
            cell(error.map(|error| error.to_string())),
            seconds(row.wanted),
            cell(row.reached.map(|reached| format!("{:.4}", seconds(reached)))),
        ));
    }
    if values.is_empty() {
        return Err(Failure::Usage("--times writes the table of key poses, but none were asked for".into()));
    }
    let text = match ending {
        "csv" => lines.join("\n") + "\n",
        "json" => Value::from(values).to_string() + "\n",
        _ => return Err(Failure::Usage(format!("--times writes .csv or .json, not {:?}", path.display().to_string()))),
    };
    write_whole(path, text.as_bytes()).map_err(Failure::Input)
}
