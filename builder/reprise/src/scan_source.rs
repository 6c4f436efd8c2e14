//! A scan as registration reads it, and why that fails.

use std::path::PathBuf;

use capture_io::export::ExportError;
use capture_io::import::{ImportError, ImportOptions, ScannedFrame, ScannedTexture, Scans};
use glam::Vec3;
use job::Stopped;
use registration::detail::DetailError;
use registration::projection::Texture;
use registration::register::{Lost, RegisterOptions, Source};
use registration::scan::Scan;
use thiserror::Error;

use super::scan_truth::TruthError;

/// How a scan becomes a capture.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct ScanOptions {
    /// How the input is read.
    pub import: ImportOptions,
    /// How it is registered.
    pub register: RegisterOptions,
    /// Width and height of the textures; as dense as the scan's own where not given.
    pub texture_size: Option<usize>,
    /// A folder with the truth, where it is known: the capture that the scan was made from.
    pub truth: Option<PathBuf>,
    /// What becomes of frames that need a template of their own.
    pub others: OtherCaptures,
}

/// Where frames go that cannot be brought onto the one mesh, but onto a mesh of their own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum OtherCaptures {
    /// Into captures beside the one that is written, named like it with -2, -3 and so on.
    #[default]
    Beside,
    /// The same, named like this path.
    At(PathBuf),
    /// Nowhere: they are only told.
    Nowhere,
}

/// Why there is no capture.
#[derive(Debug, Error)]
pub enum RegisterError {
    /// A scan cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The capture cannot be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The template's equations cannot be set up.
    #[error("the template cannot be deformed: {0}. Choose another frame with --template-frame")]
    Detail(#[from] DetailError),
    /// No frame holds a body.
    #[error("none of the {0} frames holds a surface of more than crumbs: are they meshes of one subject?")]
    Nothing(usize),
    /// The frame that is to be the template is none.
    #[error("frame {wanted} cannot be the template: {reason}; the scan has frames 0 to {last}")]
    Template {
        /// The frame.
        wanted: usize,
        /// Why not.
        reason: String,
        /// The last frame.
        last: usize,
    },
    /// Most frames were lost.
    #[error(
        "{lost} of {frames} frames could not be brought onto the mesh of frame {root}; the first of them is {place}: {why}. \
         Choose another template with --template-frame, or leave out what shows something else"
    )]
    MostLost {
        /// Frames that were lost.
        lost: usize,
        /// All frames.
        frames: usize,
        /// The template's frame.
        root: usize,
        /// The first one that was lost.
        place: String,
        /// Why.
        why: Lost,
    },
    /// The truth is none of this scan.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// It was asked to stop: nothing was written.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl RegisterError {
    /// Whether it was stopped, in whatever stage.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        matches!(self, Self::Stopped(_) | Self::Import(ImportError::Stopped(_)) | Self::Export(ExportError::Stopped(_)))
    }

    /// A name for the kind of error that never changes.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Import(error) => error.code(),
            Self::Export(_) => "E_IO",
            Self::Detail(_) | Self::Template { .. } => "E_TEMPLATE",
            Self::Nothing(_) => "E_NO_TRIANGLES",
            Self::Truth(TruthError::Import(error)) => error.code(),
            Self::Truth(TruthError::Other { .. }) => "E_TRUTH",
            Self::MostLost { .. } => "E_SCANS_LOST",
            Self::Stopped(_) => "E_STOPPED",
        }
    }
}

/// Scans as registration reads them.
pub(crate) struct Frames<'a>(pub &'a Scans);

impl Source for Frames<'_> {
    type Extra = Option<ScannedTexture>;
    type Error = RegisterError;

    fn count(&self) -> usize {
        self.0.frame_count()
    }

    fn sequence(&self, frame: usize) -> usize {
        self.0.place_of(frame).map_or(0, |(sequence, _)| sequence)
    }

    fn read(&self, frame: usize) -> Result<(Scan, Self::Extra), RegisterError> {
        let (mut scan, texture) = self.plain(frame)?;
        // Colours stop the template from sliding: those of the texture, where there is one, else those of vertices.
        if let (Some(texture), false) = (&texture, scan.uvs.is_empty()) {
            scan.colours = decoded(texture)?.of_vertices(scan.positions.len(), &scan.triangles, &scan.uvs);
        }
        Ok((scan, texture))
    }

    fn shape(&self, frame: usize) -> Result<Scan, RegisterError> {
        self.plain(frame).map(|(scan, _)| scan)
    }
}

impl Frames<'_> {
    /// A frame with the colours that its file gives vertices.
    pub(crate) fn plain(&self, frame: usize) -> Result<(Scan, Option<ScannedTexture>), RegisterError> {
        let read = match self.0.read(frame) {
            // A frame without a surface is lost, and not the whole scan.
            Err(ImportError::NoTriangles { .. } | ImportError::Collapsed { .. }) => ScannedFrame::default(),
            read => read?,
        };
        let colour = |c: &[u8; 4]| Vec3::new(f32::from(c[0]), f32::from(c[1]), f32::from(c[2])) / 255.0;
        let colours = read.colours.iter().map(colour).collect();
        let scan = Scan { positions: read.positions, triangles: read.triangles, uvs: read.uvs, colours };
        Ok((scan, read.texture))
    }
}

pub(crate) fn decoded(texture: &ScannedTexture) -> Result<Texture, RegisterError> {
    let (width, height, texels) = texture.decoded()?;
    Ok(Texture { width, height, texels })
}

/// A frame of the scan, as its user counts.
pub(crate) fn place(scans: &Scans, frame: usize) -> String {
    match scans.place_of(frame).and_then(|(sequence, number)| {
        let sequence = &scans.sequences[sequence];
        sequence.files.get(number).map(|file| (sequence, number, file))
    }) {
        Some((sequence, number, file)) => {
            format!("frame {number} of sequence \"{}\" ({})", sequence.name, file.display())
        }
        None => format!("frame {frame}"),
    }
}

/// The first frame of a sequence, counted over all.
pub(crate) fn first_of(scans: &Scans, sequence: usize) -> usize {
    scans.sequences[..sequence].iter().map(|s| s.files.len()).sum()
}
