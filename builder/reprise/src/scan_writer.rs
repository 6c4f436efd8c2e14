//! Frames of a scan, on the template, as they are written.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use capture_io::export::{CaptureWriter, WrittenCapture, WrittenSequence};
use capture_io::import::{ScannedTexture, Scans};
use glam::Vec2;
use registration::projection::Projection;
use registration::register::{Found, Registered};
use registration::template::Template;

use super::scan_report::FrameReport;
use super::scan_source::{RegisterError, ScanOptions, decoded};
use super::scan_truth::{Truth, TruthReport};

/// Width of the template's texture: a power of two from and to.
const SIZES: (usize, usize) = (256, 4096);
/// Share of an atlas that charts cover, roughly.
const COVERED: f32 = 0.5;
/// Holes of a smaller share of the texels are as good as seen, once they are filled: webs and folds make some in every frame.
const SMALL_HOLES: f64 = 0.02;
/// A model of textures needs so many that were seen in full; with fewer, what was filled in stands for what was seen.
const LEAST_SEEN: usize = 2;
/// Texels for each vertex of a scan whose colours are those of its vertices.
const TEXELS_OF_VERTEX: f32 = 6.0;

/// Writes frames as they are tracked.
pub(crate) struct Writer<'a> {
    scans: &'a Scans,
    files: CaptureWriter,
    projection: Option<Projection>,
    /// Frames whose textures were seen in full, and frames with masks.
    seen: [AtomicUsize; 2],
    truth: Option<Truth>,
}

impl<'a> Writer<'a> {
    /// For the folder `out`, and the template, which is frame `root`.
    pub fn new(
        scans: &'a Scans,
        template: &Template,
        root: usize,
        out: &Path,
        options: &ScanOptions,
    ) -> Result<Self, RegisterError> {
        let read = scans.read(root)?;
        let wanted = match &read.texture {
            Some(texture) if !read.uvs.is_empty() => {
                let (width, height, _) = texture.decoded()?;
                let area: f32 = read.uvs.iter().map(|[a, b, c]| (*b - *a).perp_dot(*c - *a).abs() * 0.5).sum();
                Some(area * width as f32 * height as f32)
            }
            _ if !read.colours.is_empty() => Some(read.positions.len() as f32 * TEXELS_OF_VERTEX),
            _ => None,
        };
        let mesh = &template.surface.mesh;
        let projection = wanted.map(|texels| {
            let size = (texels / COVERED).sqrt() as usize;
            let size = options.texture_size.unwrap_or(size.next_power_of_two().clamp(SIZES.0, SIZES.1));
            Projection::new(&template.surface, template.scale, size)
        });
        let plain = vec![[Vec2::ZERO; 3]; mesh.triangles.len()];
        let uvs = projection.as_ref().map_or(&plain, |projection| &projection.atlas.uvs);
        let files = CaptureWriter::new(out, &mesh.triangles, uvs, scans.sequences.len())?;
        let truth =
            options.truth.as_deref().map(|folder| Truth::read(folder, scans, (template, root, &read.positions)));
        Ok(Self { scans, files, projection, seen: Default::default(), truth: truth.transpose()? })
    }

    fn truth_of(&self, frame: usize) -> Option<TruthReport> {
        self.truth.as_ref().and_then(|truth| truth.of(frame))
    }

    /// Whether frames have no colours.
    pub fn is_colourless(&self) -> bool {
        self.projection.is_none()
    }

    /// Width and height of the textures.
    pub fn texture_size(&self) -> Option<usize> {
        self.projection.as_ref().map(|projection| projection.atlas.size)
    }

    /// What is told of the frames that were registered, all of which were written.
    pub fn frames(&self, registered: &Registered) -> Vec<FrameReport> {
        registered.tracked.iter().map(|tracked| FrameReport::new(tracked, self.truth_of(tracked.frame))).collect()
    }

    /// Gives the folder its name; the manifest's path.
    pub fn finish(self, sequences: Vec<WrittenSequence>) -> Result<PathBuf, RegisterError> {
        let [whole, masked] = self.seen.each_ref().map(|count| count.load(Ordering::Relaxed));
        let (textures, masks) = (self.projection.is_some(), masked > 0 && whole >= LEAST_SEEN);
        let capture = WrittenCapture { name: self.scans.name.clone(), fps: self.scans.fps, textures, masks, sequences };
        Ok(self.files.finish(&capture)?)
    }

    /// Writes a frame.
    pub fn take(&self, found: Found<Option<ScannedTexture>>) -> Result<(), RegisterError> {
        let Some((sequence, number)) = self.scans.place_of(found.tracked.frame) else { return Ok(()) };
        self.files.frame(sequence, number, found.pose)?;
        if let Some(truth) = &self.truth {
            truth.take(found.tracked.frame, found.pose)?;
        }
        let Some(projection) = &self.projection else { return Ok(()) };
        let texture = found.extra.as_ref().map(decoded).transpose()?;
        let posed = found.template.surface.posed(found.pose.to_vec());
        let mut projected = projection.project(&posed, found.target, found.uvs, texture.as_ref());
        let parent = found.tracked.parent.and_then(|parent| self.scans.place_of(parent));
        let other = match parent {
            Some((sequence, number)) => Some(self.files.written_texture(sequence, number)?),
            None => None,
        };
        projection.complete(&mut projected, other.as_deref());
        let large = projected.holes.len() as f64 > SMALL_HOLES * projection.atlas.texels.len() as f64;
        self.seen[usize::from(large)].fetch_add(1, Ordering::Relaxed);
        let unseen = if large { projected.holes.as_slice() } else { &[] };
        self.files.texture(sequence, number, projection.atlas.size, &projected.texels, unseen)?;
        Ok(())
    }
}
