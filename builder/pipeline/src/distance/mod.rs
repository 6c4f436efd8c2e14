//! Pose distances between all pairs of frames.
//!
//! Boukhayma and Boyer, TVCG, equation 2; thesis section 2.3. n^2 / 2 pairs of frames times M triangles: triangles are
//! taken block by block (so memory does not grow with M beyond the poses themselves), pairs tile by tile (so both
//! sides of a tile stay in cache) and in parallel, and each pair of triangles costs a few dozen vectorised operations.

mod alignment;
mod deformation;
mod euclidean;
mod headings;
mod matrix;
mod tiles;
mod triangles;

use std::ops::Range;

use actor::capture::Poses;
use glam::{DVec3, Vec3};
use job::work::Key;
use job::{Job, Stopped};
use kernels::topology::Topology;
use rayon::prelude::*;
use thiserror::Error;

pub use self::headings::HeadingMatrix;
pub use self::matrix::DistanceMatrix;
use self::tiles::Tile;
use kernels::simd::{Kernel, Level};

/// The default weight of stretch against rotation, w of TVCG equation 2.
pub const DEFAULT_STRETCH_WEIGHT: f32 = 0.01;

/// What a pose distance measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DistanceKind {
    /// Mean over the triangles of the rotation angle plus w times the norm of the logarithm of the stretch, in radians
    /// (TVCG equation 2; thesis equation 2.14).
    #[default]
    Deformation,
    /// The same with the Frobenius norm of the stretch minus the identity (thesis equation 2.13); for comparison.
    DeformationFrobenius,
    /// Weighted sum of squared distances between vertices after alignment, in square metres (thesis equation 2.2, but
    /// with heights, too); for comparison.
    Euclidean,
}

/// How pose distances are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceOptions {
    /// What is measured.
    pub kind: DistanceKind,
    /// w: how much the stretch of a triangle counts against its rotation, in radians.
    pub stretch_weight: f32,
    /// Whether triangles count by their area (mean over the frames' shares) instead of equally.
    pub area_weighted: bool,
}

impl Default for DistanceOptions {
    fn default() -> Self {
        Self { kind: DistanceKind::default(), stretch_weight: DEFAULT_STRETCH_WEIGHT, area_weighted: false }
    }
}

/// Why there are no pose distances.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DistanceError {
    /// The poses are of another mesh.
    #[error("the poses have {poses} vertices, but the mesh has {mesh}")]
    VertexCount {
        /// Vertices of each pose.
        poses: usize,
        /// Vertices of the mesh.
        mesh: usize,
    },
    /// Every triangle is degenerate in some frame.
    #[error("no triangle has an area in every frame; in frame {frame} the last of them collapses")]
    Degenerate {
        /// The first frame after which no triangle is left.
        frame: u32,
    },
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// What was measured cannot be kept in the work folder.
    #[error("cannot write to the work folder: {0}")]
    Work(#[from] std::io::Error),
}

/// Pose distances between all pairs of frames of `poses`, after planar alignment of each pair.
///
/// Triangles that are degenerate in any frame are left out. The result does not depend on the number of threads or on the
/// processor. What is measured goes into the job's work folder band by band.
///
/// # Errors
/// Poses of another mesh, or no triangle left; being stopped; a work folder that cannot be written.
pub fn pose_distances(
    topology: &Topology,
    poses: &Poses,
    options: &DistanceOptions,
    job: &Job,
) -> Result<DistanceMatrix, DistanceError> {
    Ok(measure(topology, poses, options, job)?.distances)
}

/// What is known of all pairs of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Their pose distances.
    pub distances: DistanceMatrix,
    /// How they were aligned.
    pub headings: HeadingMatrix,
}

/// As [`pose_distances`], with the alignment of each pair, which later stages need too.
///
/// # Errors
/// As [`pose_distances`].
pub fn measure(
    topology: &Topology,
    poses: &Poses,
    options: &DistanceOptions,
    job: &Job,
) -> Result<Measured, DistanceError> {
    measure_at(Level::best(), topology, poses, options, job)
}

fn measure_at(
    level: Level,
    topology: &Topology,
    poses: &Poses,
    options: &DistanceOptions,
    job: &Job,
) -> Result<Measured, DistanceError> {
    if poses.vertex_count() != topology.vertex_count() {
        return Err(DistanceError::VertexCount { poses: poses.vertex_count(), mesh: topology.vertex_count() });
    }
    let key = job.work().map(|_| key(topology, poses, options));
    let poses: Vec<&[Vec3]> = poses.iter().collect();
    let measure = match options.kind {
        DistanceKind::Euclidean => Measure::residuals(topology, &poses),
        DistanceKind::Deformation | DistanceKind::DeformationFrobenius => {
            Measure::deformations(topology, &poses, options)?
        }
    };
    let mut distances = DistanceMatrix::zeros(poses.len());
    let mut headings = HeadingMatrix::zeros(poses.len());
    let total = (poses.len() * poses.len().saturating_sub(1) / 2).max(1) as f64;
    let mut done = 0;
    for (number, rows) in tiles::bands(poses.len(), measure.terms()).into_iter().enumerate() {
        let key = key.as_ref().map(|key| key.part("band", number as u64));
        let pairs = tiles::pairs(poses.len(), rows.clone());
        let told = |share: f64| job.share("pose distances", (done as f64 + share * pairs as f64) / total);
        told(0.0)?;
        let band = match job.work().zip(key) {
            None => measure.band(level, rows.clone(), &told)?,
            Some((work, key)) => match work.get(&key).and_then(|bytes| band_from(&bytes, pairs)) {
                Some(band) => band,
                None => {
                    let band = measure.band(level, rows.clone(), &told)?;
                    work.put(&key, bytemuck::cast_slice(&band))?;
                    band
                }
            },
        };
        let mut band = band.into_iter();
        for i in rows {
            for (j, [distance, heading]) in (i + 1..poses.len()).zip(&mut band) {
                distances.set(i, j, distance);
                headings.set(i, j, heading);
            }
        }
        done += pairs;
    }
    Ok(Measured { distances, headings })
}

/// Changes whenever other numbers come out of the same input.
const VERSION: u32 = 1;

fn key(topology: &Topology, poses: &Poses, options: &DistanceOptions) -> Key {
    let mut key = Key::new("distances", VERSION).told(options).told(&poses.len());
    key = key.of(bytemuck::cast_slice(topology.triangles())).of(bytemuck::cast_slice(topology.weights()));
    poses.iter().fold(key, |key, pose| key.of(bytemuck::cast_slice(pose)))
}

/// Distance and heading of the pairs of a band as they were kept, unless their number is another.
fn band_from(bytes: &[u8], pairs: usize) -> Option<Vec<[f32; 2]>> {
    let band: Vec<[f32; 2]> = bytes
        .chunks_exact(8)
        .map(|pair| [0, 4].map(|at| f32::from_le_bytes([pair[at], pair[at + 1], pair[at + 2], pair[at + 3]])))
        .collect();
    (band.len() == pairs && bytes.len() == 8 * pairs).then_some(band)
}

/// What is summed over the mesh for each pair of frames.
struct Measure<'a> {
    poses: &'a [&'a [Vec3]],
    vertex_weights: &'a [f32],
    /// Centre of mass of each frame.
    centres: Vec<DVec3>,
    terms: Terms,
}

enum Terms {
    /// Over triangles, with their weights.
    Deformations { triangles: Vec<[u32; 3]>, weights: Vec<f32>, stretch_weight: f32, log: bool },
    /// Over vertices.
    Residuals,
}

impl<'a> Measure<'a> {
    fn deformations(
        topology: &'a Topology,
        poses: &'a [&'a [Vec3]],
        options: &DistanceOptions,
    ) -> Result<Self, DistanceError> {
        let (triangles, weights) = match poses.first() {
            None => (Vec::new(), Vec::new()),
            Some(first) => {
                let (triangles, weights) = usable_triangles(topology, poses, options.area_weighted)?;
                let turned = triangles.into_iter().map(|corners| triangles::turned_to_shortest_edge(corners, first));
                (turned.collect(), weights)
            }
        };
        let log = options.kind == DistanceKind::Deformation;
        let terms = Terms::Deformations { triangles, weights, stretch_weight: options.stretch_weight, log };
        Ok(Self::of(topology, poses, terms))
    }

    fn residuals(topology: &'a Topology, poses: &'a [&'a [Vec3]]) -> Self {
        Self::of(topology, poses, Terms::Residuals)
    }

    fn of(topology: &'a Topology, poses: &'a [&'a [Vec3]], terms: Terms) -> Self {
        let vertex_weights = topology.weights();
        Self { poses, vertex_weights, centres: alignment::centres(poses, vertex_weights), terms }
    }

    /// Terms of a pair's sum.
    fn terms(&self) -> usize {
        match &self.terms {
            Terms::Deformations { triangles, .. } => triangles.len(),
            Terms::Residuals => self.vertex_weights.len(),
        }
    }

    /// Distance and heading of the pairs (i, j), i < j, with i in `rows`, in order.
    fn band(
        &self,
        level: Level,
        rows: Range<usize>,
        told: &dyn Fn(f64) -> Result<(), Stopped>,
    ) -> Result<Vec<[f32; 2]>, Stopped> {
        let mut tiles = tiles::tiles(self.poses.len(), rows.clone());
        alignment::align_all(level, self.poses, (self.vertex_weights, &self.centres), &mut tiles);
        let divisor = match &self.terms {
            Terms::Deformations { log: true, .. } => self.sum_deformation::<true>(level, &mut tiles, told)?,
            Terms::Deformations { log: false, .. } => self.sum_deformation::<false>(level, &mut tiles, told)?,
            Terms::Residuals => {
                self.sum_residual(level, &mut tiles, told)?;
                1.0
            }
        };
        let mut band = vec![[0.0; 2]; tiles::pairs(self.poses.len(), rows.clone())];
        let before = |i: usize| tiles::pairs(self.poses.len(), rows.start..i);
        for tile in &tiles {
            for i in tile.rows() {
                for j in tile.columns(i) {
                    let slot = tile.slot(i, j);
                    let [half_cos, half_sin] = tile.alignment[slot];
                    let heading = (2.0 * half_sin.atan2(half_cos)) as f32;
                    band[before(i) + j - i - 1] = [(tile.sum[slot] / divisor) as f32, heading];
                }
            }
        }
        Ok(band)
    }

    /// Leaves each pair's weighted sum over the triangles in the tiles; returns the sum of the triangles' weights.
    fn sum_deformation<const LOG: bool>(
        &self,
        level: Level,
        tiles: &mut [Tile],
        told: &dyn Fn(f64) -> Result<(), Stopped>,
    ) -> Result<f64, Stopped> {
        let Terms::Deformations { triangles, weights, stretch_weight, .. } = &self.terms else { return Ok(1.0) };
        if triangles.is_empty() {
            return Ok(1.0);
        }
        let block_count = triangles.len().div_ceil(triangles::BLOCK);
        let chunks = triangles.chunks(triangles::BLOCK).zip(weights.chunks(triangles::BLOCK));
        for (index, (chunk, chunk_weights)) in chunks.enumerate() {
            let mut block_weights = [0.0; triangles::BLOCK];
            block_weights[..chunk.len()].copy_from_slice(chunk_weights);
            let blocks: Vec<_> = self.poses.par_iter().map(|pose| triangles::TriangleBlock::new(chunk, pose)).collect();
            tiles::for_each(tiles, |tile| {
                let stretch_weight = *stretch_weight;
                level.run(SumDeformation::<LOG> { blocks: &blocks, weights: &block_weights, stretch_weight, tile });
            });
            told((index + 1) as f64 / block_count as f64)?;
        }
        Ok(weights.iter().map(|&weight| f64::from(weight)).sum())
    }

    /// Leaves each pair's Euclidean residual in the tiles.
    fn sum_residual(
        &self,
        level: Level,
        tiles: &mut [Tile],
        told: &dyn Fn(f64) -> Result<(), Stopped>,
    ) -> Result<(), Stopped> {
        let weights = self.vertex_weights;
        for start in (0..weights.len()).step_by(alignment::BLOCK) {
            let blocks: Vec<_> = self
                .poses
                .par_iter()
                .zip(&self.centres)
                .map(|(pose, &centre)| alignment::VertexBlock::new(pose, weights, centre, start))
                .collect();
            tiles::for_each(tiles, |tile| level.run(SumResidual { blocks: &blocks, tile }));
            told(start as f64 / weights.len() as f64)?;
        }
        Ok(())
    }
}

struct SumDeformation<'a, const LOG: bool> {
    blocks: &'a [triangles::TriangleBlock],
    weights: &'a [f32; triangles::BLOCK],
    stretch_weight: f32,
    tile: &'a mut Tile,
}

impl<const LOG: bool> Kernel for SumDeformation<'_, LOG> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { blocks, weights, stretch_weight, tile } = self;
        for i in tile.rows() {
            for j in tile.columns(i) {
                let slot = tile.slot(i, j);
                let [cos, sin] = tile.alignment[slot];
                let pair = deformation::Pair { cos: cos as f32, sin: sin as f32, stretch_weight };
                tile.sum[slot] += deformation::deformation::<LOG>(&blocks[i], &blocks[j], weights, pair);
            }
        }
    }
}

/// Whether poses can be measured against each other.
///
/// # Errors
/// As [`pose_distances`].
pub fn comparable(topology: &Topology, poses: &Poses) -> Result<(), DistanceError> {
    if poses.vertex_count() != topology.vertex_count() {
        return Err(DistanceError::VertexCount { poses: poses.vertex_count(), mesh: topology.vertex_count() });
    }
    let poses: Vec<&[Vec3]> = poses.iter().collect();
    usable_triangles(topology, &poses, false).map(|_| ())
}

/// The triangles that are degenerate in no frame, and their weights: 1 each, or their mean share of the frames' area
/// times their number.
fn usable_triangles(
    topology: &Topology,
    poses: &[&[Vec3]],
    area_weighted: bool,
) -> Result<(Vec<[u32; 3]>, Vec<f32>), DistanceError> {
    let triangles = topology.triangles();
    let mut usable = vec![true; triangles.len()];
    let mut shares = vec![0.0; triangles.len()];
    for (frame, pose) in poses.iter().enumerate() {
        let areas = triangles::areas(triangles, pose);
        let mean = areas.iter().sum::<f64>() / areas.len() as f64;
        for (m, area) in areas.into_iter().enumerate() {
            // Written so that an area that is not a number counts as degenerate, and zero in a pose of no area too.
            usable[m] &= area > 0.0 && area >= triangles::DEGENERATE * mean;
            shares[m] += area / mean / poses.len() as f64;
        }
        if !usable.contains(&true) {
            return Err(DistanceError::Degenerate { frame: frame as u32 });
        }
    }
    let kept = || (0..triangles.len()).filter(|&m| usable[m]);
    let weights = kept().map(|m| if area_weighted { shares[m] as f32 } else { 1.0 }).collect();
    Ok((kept().map(|m| triangles[m]).collect(), weights))
}

struct SumResidual<'a> {
    blocks: &'a [alignment::VertexBlock],
    tile: &'a mut Tile,
}

impl Kernel for SumResidual<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { blocks, tile } = self;
        for i in tile.rows() {
            for j in tile.columns(i) {
                let slot = tile.slot(i, j);
                let [cos, sin] = tile.alignment[slot];
                tile.sum[slot] += euclidean::residual(&blocks[i], &blocks[j], cos as f32, sin as f32);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wavy strip of triangles.
    fn strip(frames: u32) -> (Topology, Poses) {
        let triangles: Vec<_> = (0..298).map(|v| [v, v + 1 + v % 2, v + 2 - v % 2]).collect();
        let mut poses = Poses::new(300);
        for frame in 0..frames {
            let phase = frame as f32 * 0.37;
            let point = |v: u32| {
                let along = v as f32 * 0.05;
                Vec3::new(along.sin() + 0.1 * phase.cos(), along * 0.3, (v % 2) as f32 * 0.2 + (along * phase).sin())
            };
            poses.push(&(0..300).map(point).collect::<Vec<_>>());
        }
        (Topology::new(300, triangles, vec![1.0; 300]).unwrap(), poses)
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let (topology, poses) = strip(40);
        for kind in [DistanceKind::Deformation, DistanceKind::DeformationFrobenius, DistanceKind::Euclidean] {
            let options = DistanceOptions { kind, ..Default::default() };
            let run = |level| measure_at(level, &topology, &poses, &options, &Job::silent()).unwrap();
            let mut results = Level::available().into_iter().map(run);
            let first = results.next().unwrap();
            assert!(first.distances.row(0).iter().any(|&d| d > 0.01));
            assert!(results.all(|other| other == first));
        }
    }
}
