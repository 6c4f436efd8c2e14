//! Whether a template that is tracked from a wrong heading is found back, or is at least a fault: frames are tracked from the
//! frame before, once as it is and then turned.

use capture_io::import::scans;
use glam::{Quat, Vec3};
use job::Job;
use registration::checks::{Fault, fit};
use registration::register::{Source, cleaned, template};
use registration::track::{Target, track};
use serde::Serialize;

use super::scans::{Frames, RegisterError, ScanOptions};

/// Wrong headings, radians.
const TURNS: [f32; 3] = [1.6, 3.1, -2.2];
/// Metres on average by which what was found back may be off what was tracked from the right heading.
const BACK: f64 = 0.003;

/// What became of a frame that was tracked from a wrong heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeadingTrial {
    /// The frame, counted over all sequences; it is tracked from the one before.
    pub frame: usize,
    /// How far the start was turned, radians.
    pub turn: f32,
    /// How far off the result is from the one of the right heading, metres on average.
    pub off: f64,
    /// Share of the frame that the result leaves uncovered.
    pub uncovered: f64,
    /// Whether a limit tells that it is wrong.
    pub fault: bool,
}

impl HeadingTrial {
    /// Whether it was found back.
    #[must_use]
    pub fn is_back(&self) -> bool {
        self.off < BACK
    }
}

/// Tries wrong headings on `count` frames of the scan that `inputs` name, as far apart as they can be.
///
/// # Errors
/// Scans that cannot be read.
pub fn wrong_headings(
    inputs: &[String],
    options: &ScanOptions,
    count: usize,
    job: &Job,
) -> Result<Vec<HeadingTrial>, RegisterError> {
    let scans = scans(inputs, &options.import)?;
    let source = Frames(&scans);
    let able: Vec<usize> =
        (1..source.count()).filter(|&frame| source.sequence(frame) == source.sequence(frame - 1)).collect();
    let chosen = able.iter().step_by(able.len().div_ceil(count.max(1)).max(1));
    let mut trials = Vec::new();
    for (done, &frame) in chosen.enumerate() {
        job.tell("trying wrong headings", done as u64, count as u64)?;
        trials.extend(trials_of(&source, frame, options)?);
    }
    Ok(trials)
}

/// The trials of one frame; none where it or the one before has no surface.
fn trials_of(source: &Frames, frame: usize, options: &ScanOptions) -> Result<Vec<HeadingTrial>, RegisterError> {
    let Some(template) = template(source, frame - 1)? else { return Ok(Vec::new()) };
    let (mut scan, _) = source.read(frame)?;
    let Some((cleaned, _)) = cleaned(&mut scan) else { return Ok(Vec::new()) };
    let target = Target::new(cleaned.surface, template.scale);
    let (from, to) = (template.surface.centroid(), target.surface.centroid());
    let tracked = |turn: f32| -> (Vec<Vec3>, Option<Fault>, f64) {
        let turned = |p: &Vec3| Quat::from_rotation_y(turn) * (*p - from) + to;
        let start: Vec<Vec3> = template.surface.mesh.positions.iter().map(turned).collect();
        let pose = track(&template, &start, &target, &options.register.track);
        let found = fit(&template, &template.surface.posed(pose.clone()), &start, &target.surface);
        (pose, found.fault(&options.register.limits, template.scale), found.uncovered)
    };
    let (right, ..) = tracked(0.0);
    let trial = |turn: f32| {
        let (pose, fault, uncovered) = tracked(turn);
        let sum: f64 = pose.iter().zip(&right).map(|(a, b)| f64::from(a.distance(*b))).sum();
        HeadingTrial { frame, turn, off: sum / pose.len().max(1) as f64, uncovered, fault: fault.is_some() }
    };
    Ok(TURNS.map(trial).to_vec())
}
