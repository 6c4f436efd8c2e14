//! Pose distances between all pairs of frames.
//!
//! Boukhayma and Boyer, TVCG, equation 2; thesis section 2.3. n^2 / 2 pairs of frames times M triangles: triangles are
//! taken block by block (so memory does not grow with M beyond the poses themselves), pairs tile by tile (so both
//! sides of a tile stay in cache) and in parallel, and each pair of triangles costs a few dozen vectorised operations.

mod alignment;
mod deformation;
mod euclidean;
mod headings;
mod lanes;
mod matrix;
mod tiles;
mod triangles;

use actor::capture::Poses;
use glam::Vec3;
use kernels::topology::Topology;
use rayon::prelude::*;
use thiserror::Error;

pub use self::headings::HeadingMatrix;
pub use self::matrix::DistanceMatrix;
use self::tiles::Tile;
use kernels::simd::{Kernel, Level};

/// The default weight of stretch against rotation, w of the equation.
pub const DEFAULT_STRETCH_WEIGHT: f32 = 0.01;

/// What a pose distance measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DistanceKind {
    /// Mean over the triangles of the rotation angle plus w times the norm of the logarithm of the stretch, in radians
    /// (TVCG equation 2).
    #[default]
    Deformation,
    /// The same with the Frobenius norm of the stretch minus the identity (thesis equation 2.13); for comparison.
    DeformationFrobenius,
    /// Weighted sum of squared distances between vertices after alignment, in square metres (thesis equation 2.2); for
    /// comparison.
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
#[derive(Clone, Debug, PartialEq, Eq, Error)]
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
}

/// Pose distances between all pairs of frames of `poses`, after planar alignment of each pair.
///
/// Triangles that are degenerate in any frame are left out. `progress` is told the share that is done, in [0, 1]. The
/// result does not depend on the number of threads or on the processor.
///
/// # Errors
/// Poses of another mesh, or no triangle left.
pub fn pose_distances(
    topology: &Topology,
    poses: &Poses,
    options: &DistanceOptions,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<DistanceMatrix, DistanceError> {
    Ok(measure(topology, poses, options, progress)?.distances)
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
/// Poses of another mesh, or no triangle left.
pub fn measure(
    topology: &Topology,
    poses: &Poses,
    options: &DistanceOptions,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Measured, DistanceError> {
    measure_at(Level::best(), topology, poses, options, progress)
}

/// The share of the progress that alignment gets.
const ALIGNMENT_SHARE: f64 = 0.05;

fn measure_at(
    level: Level,
    topology: &Topology,
    poses: &Poses,
    options: &DistanceOptions,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Measured, DistanceError> {
    if poses.vertex_count() != topology.vertex_count() {
        return Err(DistanceError::VertexCount { poses: poses.vertex_count(), mesh: topology.vertex_count() });
    }
    let poses: Vec<&[Vec3]> = poses.iter().collect();
    let mut tiles = tiles::tiles(poses.len());
    alignment::align_all(level, &poses, topology.weights(), &mut tiles);
    progress(ALIGNMENT_SHARE);
    let divisor = match options.kind {
        DistanceKind::Deformation => sum_deformation::<true>(level, topology, &poses, options, &mut tiles, progress)?,
        DistanceKind::DeformationFrobenius => {
            sum_deformation::<false>(level, topology, &poses, options, &mut tiles, progress)?
        }
        DistanceKind::Euclidean => {
            sum_residual(level, topology, &poses, &mut tiles, progress);
            1.0
        }
    };
    let mut distances = DistanceMatrix::zeros(poses.len());
    let mut headings = HeadingMatrix::zeros(poses.len());
    for tile in &tiles {
        for i in tile.rows() {
            for j in tile.columns(i) {
                let slot = tile.slot(i, j);
                let [half_cos, half_sin] = tile.alignment[slot];
                distances.set(i, j, (tile.sum[slot] / divisor) as f32);
                headings.set(i, j, (2.0 * half_sin.atan2(half_cos)) as f32);
            }
        }
    }
    Ok(Measured { distances, headings })
}

/// Leaves each pair's weighted sum over the triangles in the tiles; returns the sum of the triangles' weights.
fn sum_deformation<const LOG: bool>(
    level: Level,
    topology: &Topology,
    poses: &[&[Vec3]],
    options: &DistanceOptions,
    tiles: &mut [Tile],
    progress: &(dyn Fn(f64) + Sync),
) -> Result<f64, DistanceError> {
    let Some(&first_pose) = poses.first() else { return Ok(1.0) };
    let (triangles, weights) = usable_triangles(topology, poses, options.area_weighted)?;
    let triangles: Vec<_> =
        triangles.into_iter().map(|corners| triangles::turned_to_shortest_edge(corners, first_pose)).collect();
    let block_count = triangles.len().div_ceil(triangles::BLOCK);
    let chunks = triangles.chunks(triangles::BLOCK).zip(weights.chunks(triangles::BLOCK));
    for (index, (chunk, chunk_weights)) in chunks.enumerate() {
        let mut block_weights = [0.0; triangles::BLOCK];
        block_weights[..chunk.len()].copy_from_slice(chunk_weights);
        let blocks: Vec<_> = poses.par_iter().map(|pose| triangles::TriangleBlock::new(chunk, pose)).collect();
        tiles::for_each(tiles, |tile| {
            let stretch_weight = options.stretch_weight;
            level.run(SumDeformation::<LOG> { blocks: &blocks, weights: &block_weights, stretch_weight, tile });
        });
        progress(ALIGNMENT_SHARE + (1.0 - ALIGNMENT_SHARE) * (index + 1) as f64 / block_count as f64);
    }
    Ok(weights.iter().map(|&weight| f64::from(weight)).sum())
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

/// Leaves each pair's Euclidean residual in the tiles.
fn sum_residual(
    level: Level,
    topology: &Topology,
    poses: &[&[Vec3]],
    tiles: &mut [Tile],
    progress: &(dyn Fn(f64) + Sync),
) {
    let weights = topology.weights();
    let centres = alignment::centres(poses, weights);
    for start in (0..weights.len()).step_by(alignment::BLOCK) {
        let blocks: Vec<_> = poses
            .par_iter()
            .zip(&centres)
            .map(|(pose, &centre)| alignment::VertexBlock::new(pose, weights, centre, start))
            .collect();
        tiles::for_each(tiles, |tile| level.run(SumResidual { blocks: &blocks, tile }));
        progress(ALIGNMENT_SHARE + (1.0 - ALIGNMENT_SHARE) * start as f64 / weights.len() as f64);
    }
    progress(1.0);
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
            let run = |level| measure_at(level, &topology, &poses, &options, &|_| ()).unwrap();
            let mut results = Level::available().into_iter().map(run);
            let first = results.next().unwrap();
            assert!(first.distances.row(0).iter().any(|&d| d > 0.01));
            assert!(results.all(|other| other == first));
        }
    }
}
