//! Triangles stretched as in poses that were recorded: what a map makes of a pose that it never saw is too long, too thin or puffed up.
//!
//! Thesis section 5.6.1 corrects parts by their nearest examples. Here only stretches are taken from them: how triangles are turned stays as
//! the map says.

use glam::{DMat3, Mat3};
use rayon::prelude::*;

use crate::error::TransferError;
use crate::rebuild::Rebuilder;
use crate::space::{Space, numbers};
use crate::subject::Subject;

/// Recorded poses that are kept at most.
const KEPT: usize = 60;
/// So many nearest ones are mixed.
const NEAREST: usize = 3;

/// A part whose triangles are stretched otherwise than in recorded poses by less than the first (root mean square) stays as the map says; by
/// more than the second it is stretched as in these.
const ODD: [f64; 2] = [0.15, 0.35];

/// Recorded poses, as numbers and as stretches of triangles.
pub struct Examples {
    /// For each pose the numbers of all parts.
    numbers: Vec<Vec<Vec<f64>>>,
    /// For each pose how each triangle is stretched.
    stretches: Vec<Vec<Option<Mat3>>>,
    /// For each triangle the part that it belongs to most.
    parts: Vec<usize>,
}

impl Examples {
    /// Of some of the frames of `target` that were learned from. `weights` are those of its parts, none where it is one.
    pub fn of(target: &Subject, frames: &[u32], spaces: &[Space], rebuilder: &Rebuilder, weights: &[&[f32]]) -> Self {
        let mut chosen: Vec<u32> = frames.to_vec();
        chosen.sort_unstable();
        chosen.dedup();
        let count = chosen.len().min(KEPT);
        let chosen: Vec<u32> = (0..count).map(|k| chosen[k * chosen.len() / count]).collect();
        let triangles = 0..rebuilder.triangle_count();
        let stretches = |&frame: &u32| {
            let pose = target.own(frame);
            triangles.clone().map(|triangle| Some(rebuilder.stretch(triangle, &pose)?.as_mat3())).collect()
        };
        let part = |triangle: usize| {
            let share = |part: usize| -> f32 {
                rebuilder.corners(triangle).iter().map(|&vertex| weights[part][vertex as usize]).sum()
            };
            (0..weights.len()).rev().max_by(|&a, &b| share(a).total_cmp(&share(b))).unwrap_or(0)
        };
        Self {
            numbers: chosen.par_iter().map(|&frame| numbers(target, spaces, frame)).collect(),
            stretches: chosen.par_iter().map(stretches).collect(),
            parts: triangles.clone().into_par_iter().map(part).collect(),
        }
    }

    /// The surface with its triangles stretched as in the poses that are nearest to `predicted`, part by part.
    pub fn correct(
        &self,
        rebuilder: &Rebuilder,
        surface: &[glam::Vec3],
        predicted: &[Vec<f64>],
    ) -> Result<Vec<glam::Vec3>, TransferError> {
        let nearest: Vec<Vec<(usize, f32)>> =
            predicted.iter().enumerate().map(|(part, own)| self.nearest(part, own)).collect();
        // Of each triangle: as it is, and as in recorded poses.
        let both = |(triangle, part): (usize, &usize)| -> Option<[DMat3; 2]> {
            let mut sum = Mat3::ZERO;
            for &(pose, share) in &nearest[*part] {
                sum += self.stretches[pose][triangle]? * share;
            }
            Some([rebuilder.stretch(triangle, surface)?, sum.as_dmat3()])
        };
        let both: Vec<Option<[DMat3; 2]>> = self.parts.iter().enumerate().map(both).collect();
        let mut odd = vec![(0.0, 0.0); nearest.len()];
        for (part, [own, recorded]) in self.parts.iter().zip(&both).filter_map(|(part, both)| Some((part, (*both)?))) {
            let off = own - recorded;
            odd[*part].0 += off.to_cols_array().iter().map(|entry| entry * entry).sum::<f64>();
            odd[*part].1 += 1.0;
        }
        let shares: Vec<f64> = odd
            .iter()
            .map(|(sum, count)| (((sum / f64::max(*count, 1.0)).sqrt() - ODD[0]) / (ODD[1] - ODD[0])).clamp(0.0, 1.0))
            .collect();
        let stretch = |triangle: usize| -> Option<DMat3> {
            let [own, recorded] = both[triangle]?;
            let share = shares[self.parts[triangle]];
            (share > 0.0).then(|| own * (1.0 - share) + recorded * share)
        };
        rebuilder.stretched(surface, stretch).map_err(|error| TransferError::Surface(error.to_string()))
    }

    /// The poses nearest to a part, and their shares: the nearer the more.
    fn nearest(&self, part: usize, own: &[f64]) -> Vec<(usize, f32)> {
        let far = |pose: usize| -> f64 {
            self.numbers[pose][part].iter().zip(own).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
        };
        let mut all: Vec<(f64, usize)> = (0..self.numbers.len()).map(|pose| (far(pose), pose)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all.truncate(NEAREST);
        let total: f64 = all.iter().map(|(far, _)| 1.0 / (far + 1e-6)).sum();
        all.into_iter().map(|(far, pose)| (pose, (1.0 / (far + 1e-6) / total) as f32)).collect()
    }
}
