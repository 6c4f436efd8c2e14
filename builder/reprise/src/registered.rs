//! What `builder pack` does with a scan: it is brought onto one mesh first, as `builder register` does it.

use std::path::PathBuf;

use bundle::ScannedFrames;
use capture_io::import::{ImportError, ImportOptions, Warning, scans};
use glam::{DVec3, Vec3};
use job::Job;

use crate::options::{PackError, PackOptions};
use crate::packed::Spool;
use crate::scans::{OtherCaptures, RegisterError, ScanOptions, register};
use crate::windows::{ScannedSummary, scanned_frames};

/// A scan that was brought onto one mesh, in a folder that vanishes with this.
pub(crate) struct RegisteredScan {
    folder: tempfile::TempDir,
    pub warnings: Vec<Warning>,
    inputs: Vec<String>,
    /// The scan's frame that each frame of the capture is.
    written: Vec<usize>,
}

impl RegisteredScan {
    /// Brings the scan `inputs` onto one mesh; the folder lies in the work folder, where there is one.
    pub fn new(inputs: &[String], options: &PackOptions, job: &Job) -> Result<Self, PackError> {
        let root = job.work().map_or_else(std::env::temp_dir, |work| work.root().to_owned());
        let folder = tempfile::Builder::new().prefix(".registered-").tempdir_in(&root);
        let folder = folder.map_err(|source| ImportError::Io { path: root, source })?;
        let others = options.others.clone().map_or(OtherCaptures::Nowhere, OtherCaptures::At);
        let scan = ScanOptions { import: options.import.clone(), others, ..ScanOptions::default() };
        let mut registered = Self { folder, warnings: Vec::new(), inputs: inputs.to_vec(), written: Vec::new() };
        let report = register(inputs, &scan, &registered.path(), job)?;
        registered.written = report.written;
        registered.warnings.push(Warning::new(
            "W_SCAN_REGISTERED",
            format!(
                "frames have meshes of their own: {} of {} were brought onto that of frame {} first; builder register does it \
                 alone, and tells more",
                report.registered.len(),
                report.frames,
                report.template
            ),
        ));
        registered.warnings.extend(report.warnings);
        Ok(registered)
    }

    /// The capture's folder.
    fn path(&self) -> PathBuf {
        self.folder.path().join("capture")
    }

    /// The same as an input.
    pub fn input(&self) -> String {
        self.path().to_string_lossy().into_owned()
    }

    /// How it is read: what was said of the files is done.
    pub fn options(&self, options: &PackOptions) -> PackOptions {
        let ImportOptions { name, cyclic, weld, .. } = options.import.clone();
        PackOptions { import: ImportOptions { name, cyclic, weld, ..ImportOptions::default() }, ..options.clone() }
    }

    /// The frames as they were scanned, less `offset`, which was taken off the capture; `frames` says how many that has of them. Their bytes
    /// wait on the disk.
    pub fn scanned(
        &self,
        options: &PackOptions,
        frames: usize,
        (offset, step): (DVec3, f32),
        job: &Job,
    ) -> Result<(ScannedFrames, ScannedSummary, Spool), PackError> {
        if frames < self.written.len() {
            return Err(PackError::Option("--mode windows: frames of the scan are missing in the capture".into()));
        }
        let scans = scans(&self.inputs, &options.import).map_err(RegisterError::from)?;
        let offset: Vec3 = offset.as_vec3();
        let folder = self.folder.path();
        let mut spool = Spool::new(folder).map_err(|source| ImportError::Io { path: folder.to_owned(), source })?;
        let take = &mut |bytes: &[u8]| spool.push(bytes);
        let (scanned, summary) = scanned_frames(&scans, &self.written, (offset, step), job, take)?;
        Ok((scanned, summary, spool))
    }
}
