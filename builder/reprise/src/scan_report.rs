//! What `builder register` says of a scan and of its frames.

use std::path::PathBuf;

use capture_io::import::Warning;
use registration::register::Tracked;
use serde::Serialize;

use super::scan_truth::TruthReport;

/// What became of a scan; what `--json` prints.
#[derive(Clone, Debug, Serialize)]
pub struct RegisterReport {
    /// The manifest that `pack` reads.
    pub manifest: PathBuf,
    /// Name of the subject.
    pub name: String,
    /// Frames of the scan.
    pub frames: usize,
    /// The frame whose mesh is the template, counted over all sequences.
    pub template: usize,
    /// Vertices of the template.
    pub vertices: usize,
    /// Triangles of the template.
    pub triangles: usize,
    /// Meshes of the frames that hold a body: frames of one mesh follow one of them.
    pub meshes: usize,
    /// Width and height of the textures; none where the scan has no colours.
    pub texture_size: Option<usize>,
    /// Names of the sequences that were written, with their numbers of frames.
    pub sequences: Vec<(String, usize)>,
    /// The frames that were registered.
    pub registered: Vec<FrameReport>,
    /// The frames that are not part of the capture.
    pub lost: Vec<LostReport>,
    /// Those of them that have a mesh of their own.
    pub others: Vec<OtherReport>,
    /// The scan's frame that each frame of the capture is, in the capture's order.
    #[serde(skip)]
    pub written: Vec<usize>,
    /// How unlike frames are, row by row, square metres on a person; of the frames `compared`.
    #[serde(skip)]
    pub dissimilarity: Vec<f32>,
    /// Frames that hold a body.
    #[serde(skip)]
    pub compared: Vec<usize>,
    /// What the user should know about the input.
    pub warnings: Vec<Warning>,
    /// Wall-clock seconds: comparing frames, and registering them.
    pub seconds: [f64; 2],
}

/// Frames that could not be brought onto the capture's mesh, but onto one of their own.
#[derive(Clone, Debug, Serialize)]
pub struct OtherReport {
    /// The manifest of the capture that they became; none where they were not written.
    pub manifest: Option<PathBuf>,
    /// The frame whose mesh is their template, counted over all sequences.
    pub template: usize,
    /// Vertices of the template.
    pub vertices: usize,
    /// Triangles of the template.
    pub triangles: usize,
    /// Names of the sequences, with their numbers of frames.
    pub sequences: Vec<(String, usize)>,
    /// The frames.
    pub registered: Vec<FrameReport>,
}

/// A frame that was registered. Frames are counted over all sequences; lengths are metres.
#[derive(Clone, Debug, Serialize)]
pub struct FrameReport {
    /// The frame.
    pub frame: usize,
    /// The frame that it was tracked from; none for the template's own.
    pub parent: Option<usize>,
    /// Share of the scan that is farther than a centimetre from the template.
    pub uncovered: f64,
    /// Root of the mean square distance from the scan to the template.
    pub rms_backward: f64,
    /// Share of the template that is farther than a centimetre from the scan.
    pub beyond: f64,
    /// Root of the mean square distance from the template to the scan.
    pub rms_forward: f64,
    /// The largest distance of either.
    pub hausdorff: f64,
    /// How much longer an edge is than in the parent's pose: the 99th percentile.
    pub stretch: f64,
    /// How much longer or shorter edges are than the template's own: the mean of the logarithms, without signs.
    pub strain: f64,
    /// How much the colours of the template differ from those under it, 0 to 1.
    pub colour: f64,
    /// From how many frames it was tried.
    pub tries: usize,
    /// Whether it has its parent's mesh and follows it, instead of being tracked.
    pub followed: bool,
    /// The frame of another template, by which it was brought onto this one; none where it was tracked by itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub through: Option<usize>,
    /// How far it is from the truth, where that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthReport>,
}

/// A frame that was lost.
#[derive(Clone, Debug, Serialize)]
pub struct LostReport {
    /// The frame, counted over all sequences.
    pub frame: usize,
    /// The same as its user counts.
    pub place: String,
    /// Why.
    pub reason: String,
}

impl FrameReport {
    /// Of a frame that was tracked, and how far it is from the truth.
    #[must_use]
    pub fn new(tracked: &Tracked, truth: Option<TruthReport>) -> Self {
        let fit = &tracked.fit;
        Self {
            frame: tracked.frame,
            parent: tracked.parent,
            uncovered: fit.uncovered,
            rms_backward: fit.rms_backward,
            beyond: fit.beyond,
            rms_forward: fit.rms_forward,
            hausdorff: fit.hausdorff,
            stretch: fit.stretch,
            strain: fit.strain,
            colour: fit.colour,
            tries: tracked.tries,
            followed: tracked.followed,
            through: tracked.through,
            truth,
        }
    }
}
