//! How far a registered frame is from the truth, where that is known: what a scan was made from, as `builder performer --scanned`
//! writes it, and for every vertex of a scan the point of it.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::io::Error;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use capture_io::import::{ImportError, ImportOptions, Scans, scans};
use glam::Vec3;
use registration::template::Template;
use serde::Serialize;
use thiserror::Error;

/// Metres off the figure from which a vertex of the scan is none of its surface: webs, for the most part.
const WEB: f32 = 0.005;
/// Bytes of a vertex.
const RECORD: usize = 20;

/// Why a frame cannot be held against the truth.
#[derive(Debug, Error)]
pub enum TruthError {
    /// What the scan was made from cannot be read.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// It is not this scan's.
    #[error("{}: this is not the truth of the scan: {what}", .path.display())]
    Other {
        /// Where.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// Distances of the template's vertices to where they are in truth, metres; what lay in webs of the template's frame is left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TruthReport {
    /// Their mean.
    pub mean: f64,
    /// Their 95th percentile.
    pub p95: f64,
    /// The largest.
    pub worst: f64,
}

/// A point of the figure: a triangle, barycentric coordinates, and how far off it the scan's vertex is.
#[derive(Clone, Copy, Debug)]
struct Point {
    triangle: u32,
    weights: Vec3,
    off: f32,
}

/// The truth of a scan, for a template.
#[derive(Debug)]
pub(crate) struct Truth {
    figure: Scans,
    /// For each vertex of the template.
    points: Vec<Point>,
    found: Mutex<BTreeMap<usize, TruthReport>>,
}

impl Truth {
    /// The truth in `folder`, a capture with a folder `scan/SEQUENCE/frame_%05d.bin` in it, of the scan `of`; `root` is the frame
    /// of the template, `raw` the places of its vertices in the file.
    pub fn read(
        folder: &Path,
        of: &Scans,
        (template, root, raw): (&Template, usize, &[Vec3]),
    ) -> Result<Self, TruthError> {
        let figure = scans(&[folder.to_string_lossy().into_owned()], &ImportOptions::default())?;
        let lengths = |scans: &Scans| scans.sequences.iter().map(|s| s.files.len()).collect::<Vec<_>>();
        let wrong = |path: &Path, what: String| TruthError::Other { path: path.to_owned(), what };
        if lengths(&figure) != lengths(of) {
            let what = format!("it has sequences of {:?} frames, the scan of {:?}", lengths(&figure), lengths(of));
            return Err(wrong(folder, what));
        }
        let (path, points) = points_of(folder, of, root).map_err(|(path, error)| wrong(&path, error.to_string()))?;
        if points.len() != raw.len() {
            let what = format!("it has {} vertices, the scan's frame has {}", points.len(), raw.len());
            return Err(wrong(&path, what));
        }
        let count = figure.read(root)?.triangles.len();
        if let Some(point) = points.iter().find(|point| point.triangle as usize >= count) {
            return Err(wrong(&path, format!("it names triangle {} of {count}", point.triangle)));
        }
        // Cleaning renumbers vertices: they are where they were.
        let bits = |p: &Vec3| p.to_array().map(f32::to_bits);
        let numbers: HashMap<[u32; 3], usize> = raw.iter().enumerate().rev().map(|(k, p)| (bits(p), k)).collect();
        let point = |p: &Vec3| numbers.get(&bits(p)).map(|&k| points[k]);
        let points = template.surface.mesh.positions.iter().map(point).collect::<Option<_>>();
        let points = points.ok_or_else(|| wrong(folder, "vertices of the template are none of its frame".into()))?;
        Ok(Self { figure, points, found: Mutex::default() })
    }

    /// Measures the template's `pose` on a frame.
    pub fn take(&self, frame: usize, pose: &[Vec3]) -> Result<(), TruthError> {
        let figure = self.figure.read(frame)?;
        let place = |point: &Point| -> Option<Vec3> {
            let [a, b, c] = figure.triangles.get(point.triangle as usize)?.map(|v| figure.positions[v as usize]);
            Some(a * point.weights.x + b * point.weights.y + c * point.weights.z)
        };
        let on_figure = self.points.iter().zip(pose).filter(|(point, _)| point.off.abs() < WEB);
        let mut off: Vec<f32> = on_figure.filter_map(|(point, p)| Some(place(point)?.distance(*p))).collect();
        off.sort_by(f32::total_cmp);
        let Some(&worst) = off.last() else { return Ok(()) };
        let mean = off.iter().map(|&d| f64::from(d)).sum::<f64>() / off.len() as f64;
        let report = TruthReport { mean, p95: f64::from(off[off.len() * 95 / 100]), worst: f64::from(worst) };
        self.found.lock().unwrap_or_else(PoisonError::into_inner).insert(frame, report);
        Ok(())
    }

    /// What was found of a frame.
    pub fn of(&self, frame: usize) -> Option<TruthReport> {
        self.found.lock().unwrap_or_else(PoisonError::into_inner).get(&frame).copied()
    }
}

/// The points of a frame's vertices, and the file that they are from.
fn points_of(folder: &Path, of: &Scans, frame: usize) -> Result<(PathBuf, Vec<Point>), (PathBuf, Error)> {
    let (sequence, number) = of.place_of(frame).unwrap_or_default();
    let path = folder.join("scan").join(&of.sequences[sequence].name).join(format!("frame_{number:05}.bin"));
    let bytes = fs::read(&path).map_err(|error| (path.clone(), error))?;
    let float = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let point = |b: &[u8]| Point {
        triangle: u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        weights: Vec3::new(float(&b[4..]), float(&b[8..]), float(&b[12..])),
        off: float(&b[16..]),
    };
    Ok((path, bytes.chunks_exact(RECORD).map(point).collect()))
}
