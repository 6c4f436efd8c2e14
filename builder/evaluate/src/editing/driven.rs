//! Sequences that were driven by motion capture beside the recording and beside what the paper holds them against (Fig. 10): volume, folds,
//! soles; and how they join the recording.

use actor::capture::Capture;
use capture_io::mocap::{MocapOptions, read_clip};
use drive::retarget::Driven;
use drive::{body, retarget};
use driving::{Body, Mapping, MappingFile};
use editing::Rig;
use glam::Vec3;
use job::Job;
use kernels::topology::Topology;

use super::joined::{self, joined};
use super::shape::{folded, volume};
use super::skinned::{Hips, Laplacian, skinned};
use super::strip::{CLAY, Shown, strip};
use crate::EvaluateError;
use crate::document::{Cell, Picture, Table};

/// Recorded frames that are measured, and driven ones, at most.
const SAMPLES: usize = 100;
/// Frames of a picture; differences of this and more are all red, in metres.
const SHOWN: usize = 6;
const RED: f32 = 0.06;

/// What came of the clips.
pub struct Clips {
    pub tables: Vec<Table>,
    pub pictures: Vec<Picture>,
    /// Of each clip the least volume at the hips: ours, and that of linear blend skinning.
    pub hips: Vec<[f64; 2]>,
    /// What of them could not be driven, in sentences.
    pub notes: Vec<String>,
}

/// What surfaces are held against: their own over the recording.
struct Measure<'a> {
    topology: &'a Topology,
    hips: Hips,
    /// Mean volumes over the recording: of all, and of the hips.
    whole: [f64; 2],
}

impl<'a> Measure<'a> {
    fn new(topology: &'a Topology, hips: Hips, recorded: &[Vec<Vec3>]) -> Self {
        let mean = |of: &dyn Fn(&[Vec3]) -> f64| {
            recorded.iter().map(|pose| of(pose)).sum::<f64>() / recorded.len().max(1) as f64
        };
        let whole = [mean(&|pose| volume(topology, pose)), mean(&|pose| hips.volume(pose))];
        Self { topology, hips, whole }
    }

    /// Of all frames the least volume at the hips, over the recorded mean.
    fn least_hips(&self, frames: &[Vec<Vec3>]) -> f64 {
        frames.iter().map(|pose| self.hips.volume(pose) / self.whole[1]).fold(f64::INFINITY, f64::min)
    }

    fn row(&self, name: String, frames: &[Vec<Vec3>], feet: [Cell; 3]) -> Vec<Cell> {
        let volumes: Vec<f64> = frames.iter().map(|pose| volume(self.topology, pose) / self.whole[0]).collect();
        let hips: Vec<f64> = frames.iter().map(|pose| self.hips.volume(pose) / self.whole[1]).collect();
        let folds: Vec<f64> = frames.iter().map(|pose| 100.0 * folded(self.topology, pose)).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let mut row = vec![
            name.into(),
            Cell::Count(frames.len() as u64),
            Cell::Number(least(&volumes), 3),
            Cell::Number(mean(&volumes), 3),
            Cell::Number(least(&hips), 3),
            Cell::Number(mean(&hips), 3),
            Cell::Number(mean(&folds), 3),
            Cell::Number(folds.iter().copied().fold(0.0, f64::max), 3),
        ];
        row.extend(feet);
        row
    }
}

fn table() -> Table {
    let columns = [
        "sequence",
        "frames",
        "volume least",
        "volume mean",
        "hips least",
        "hips mean",
        "folded mean %",
        "folded most %",
        "soles mm",
        "slide mm",
        "standing %",
    ];
    let caption = "Driven sequences beside the recorded frames, and beside the same bones with linear blend skinning and with differential coordinates \
                   (Fig. 10; every so many frames): volume over the recorded mean, of all and between the surface around the hips and its middle; \
                   edges whose triangles are folded by more than a right angle; and soles that stand";
    Table::new("editing_driven", caption, &columns)
}

/// Drives the actor by the clips.
pub fn driven(capture: &Capture, rig: &Rig, clips: &[String], job: &Job) -> Result<Clips, EvaluateError> {
    let Capture { topology, timeline, poses, .. } = capture;
    let mut made = Clips { tables: Vec::new(), pictures: Vec::new(), hips: Vec::new(), notes: Vec::new() };
    let body = match body(rig, poses) {
        Ok(body) => body,
        Err(error) => {
            made.notes.push(error.to_string());
            return Ok(made);
        }
    };
    let every = poses.len().div_ceil(SAMPLES).max(1);
    let recorded: Vec<Vec<Vec3>> = poses.iter().step_by(every).map(<[Vec3]>::to_vec).collect();
    let measure = Measure::new(topology, Hips::new(&body, topology), &recorded);
    let (mut table, mut joins) = (table(), joined::table());
    table.rows.push(measure.row("recorded".into(), &recorded, [Cell::Empty, Cell::Empty, Cell::Empty]));
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
            Ok(driven) => {
                let Beside { rows, picture, hips } = beside(&measure, &body, (name, &driven), topology)?;
                table.rows.extend(rows);
                made.pictures.push(picture);
                made.hips.push(hips);
                let (rows, pictures) = joined(capture, &body, (name, &driven), job)?;
                joins.rows.extend(rows);
                made.pictures.extend(pictures);
            }
            Err(error) => made.notes.push(format!("{name}: {error}")),
        }
    }
    made.tables = vec![table, joins];
    Ok(made)
}

/// Driven frames beside those of the paper's other ways over the same bones.
struct Beside {
    rows: Vec<Vec<Cell>>,
    picture: Picture,
    hips: [f64; 2],
}

/// The driven frames beside those of the paper's other ways over the same bones: rows, and the frames in which the hips are bent most.
fn beside(
    measure: &Measure,
    body: &Body,
    (name, driven): (&str, &Driven),
    topology: &Topology,
) -> Result<Beside, EvaluateError> {
    let number = |value: f32, decimals| Cell::Number(value.into(), decimals);
    let measures = &driven.measures;
    let feet =
        [number(measures.sole_off_mm[0], 1), number(measures.slide_mm[0], 2), number(100.0 * measures.standing, 0)];
    let mut rows = vec![measure.row(name.into(), &driven.poses, feet)];
    let every = driven.poses.len().div_ceil(SAMPLES).max(1);
    let frames: Vec<usize> = (0..driven.poses.len()).step_by(every).collect();
    let ours: Vec<Vec<Vec3>> = frames.iter().map(|&frame| driven.poses[frame].clone()).collect();
    let linear: Vec<Vec<Vec3>> = frames.iter().map(|&frame| skinned(body, &driven.planted.frames[frame])).collect();
    let mut laplacian = Laplacian::new(body, topology)?;
    let differential: Vec<Vec<Vec3>> =
        frames.iter().map(|&frame| laplacian.frame(body, &driven.planted.frames[frame])).collect::<Result<_, _>>()?;
    for (way, poses) in [("ours", &ours), ("linear blend", &linear), ("Laplacian", &differential)] {
        let none = [Cell::Empty, Cell::Empty, Cell::Empty];
        rows.push(measure.row(format!("{name}, every {every}: {way}"), poses, none));
    }
    // Those in which the hips keep least, spread over the clip.
    let part = frames.len().div_ceil(SHOWN).max(1);
    let hips = |k: usize| measure.hips.volume(&linear[k]);
    let parts = (0..frames.len()).collect::<Vec<_>>();
    let shown: Vec<usize> = parts
        .chunks(part)
        .filter_map(|part| part.iter().copied().min_by(|&a, &b| hips(a).total_cmp(&hips(b))))
        .collect();
    let plain = |poses: &[Vec<Vec3>]| shown.iter().map(|&k| Shown::plain(&poses[k], CLAY)).collect::<Vec<_>>();
    let differs = shown.iter().map(|&k| Shown::heat(&ours[k], &linear[k], RED)).collect();
    let caption = format!(
        "Fig. 10: {name}; rows: linear blend skinning, Laplacian, ours, and ours again, red where it is {RED} m from linear blend skinning"
    );
    let rows_shown = [plain(&linear), plain(&differential), plain(&ours), differs];
    let picture = strip(
        topology.triangles(),
        topology.weights(),
        &rows_shown,
        (std::f32::consts::FRAC_PI_2, body.floor),
        caption,
    )?;
    Ok(Beside { rows, picture, hips: [measure.least_hips(&ours), measure.least_hips(&linear)] })
}
