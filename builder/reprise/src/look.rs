//! What registering would say of a scan, as far as it can be known before a frame is tracked: for `builder inspect` and
//! `builder validate`.

use capture_io::import::{ImportError, Warning, scans};
use job::Job;
use registration::register::survey;
use serde::Serialize;

use crate::scans::{Frames, LostReport, RegisterError, ScanOptions, check_lost, lost_reports, told_of_frames, tree};

/// A scan before it is registered.
#[derive(Clone, Debug, Serialize)]
pub struct ScanLook {
    /// Name of the subject.
    pub name: String,
    /// Frames per second.
    pub fps: f32,
    /// Frames of the scan.
    pub frames: usize,
    /// Meshes: frames of one mesh are registered once.
    pub meshes: usize,
    /// Names of the sequences, with their numbers of frames.
    pub sequences: Vec<(String, usize)>,
    /// The frame whose mesh would be the template, counted over all sequences.
    pub template: usize,
    /// Area of that frame's surface, square metres.
    pub area: f32,
    /// The frames that cannot be part of the capture.
    pub lost: Vec<LostReport>,
    /// What the user should know about the input.
    pub warnings: Vec<Warning>,
}

/// Whether `error` says that frames have meshes of their own, so that the input can be a scan.
#[must_use]
pub fn is_scan(error: &ImportError) -> bool {
    matches!(error, ImportError::VertexCount { .. } | ImportError::FaceList { .. })
}

/// Looks at all frames of the scan that `inputs` name.
///
/// # Errors
/// What [`register`](crate::scans::register) would say before it tracks a frame.
pub fn look(inputs: &[String], options: &ScanOptions, job: &Job) -> Result<ScanLook, RegisterError> {
    let mut scans = scans(inputs, &options.import)?;
    let mut warnings = std::mem::take(&mut scans.warnings);
    let survey = survey(&Frames(&scans), &options.register, job)?;
    let tree = tree(&scans, &survey, options)?;
    let root = survey.frames[tree.root];
    check_lost(&scans, &survey.lost, 0, root)?;
    let meshes = survey.groups.iter().max().map_or(0, |last| last + 1);
    warnings.insert(0, registered_first(meshes, scans.frame_count(), root));
    warnings.extend(told_of_frames(&scans, &survey, root, &survey.lost));
    Ok(ScanLook {
        name: scans.name.clone(),
        fps: scans.fps,
        frames: scans.frame_count(),
        meshes,
        sequences: scans.sequences.iter().map(|s| (s.name.clone(), s.files.len())).collect(),
        template: root,
        area: survey.candidates[tree.root].area,
        lost: lost_reports(&scans, &survey.lost),
        warnings,
    })
}

fn registered_first(meshes: usize, frames: usize, root: usize) -> Warning {
    Warning::new(
        "W_SCAN_REGISTERED",
        format!(
            "frames have meshes of their own ({meshes} in {frames} frames): builder pack brings them onto that of frame {root} \
             first; builder register does it alone, and tells more"
        ),
    )
}
