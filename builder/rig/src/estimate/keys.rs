//! Key frames: the few poses that a rig is estimated from.

use actor::capture::Poses;
use glam::{Quat, Vec3};
use kernels::align::{align_heading, centre_of_mass};

/// Poses that are as different as the capture has them, about their centres of mass and facing the same way.
pub struct Keys {
    /// The poses, frame after frame; the first one is the rest pose.
    pub poses: Vec<Vec<Vec3>>,
    /// Their frames.
    pub frames: Vec<u32>,
}

/// Vertices that frames are compared by.
const SAMPLES: usize = 240;

impl Keys {
    /// Up to `count` key frames of `poses`: the rest pose, which is the nearest to the mean, and then those that the ones
    /// before explain least, by pivoted Gram-Schmidt. `weights` are the topology's. Frames that differ by less than `least`
    /// metres from what those before them span are left out.
    #[must_use]
    pub fn choose(poses: &Poses, weights: &[f32], count: usize, least: f32) -> Self {
        let n = poses.vertex_count();
        let step = n.div_ceil(SAMPLES).max(1);
        let sampled: Vec<usize> = (0..n).step_by(step).collect();
        let mut rows: Vec<Vec<f64>> = (0..poses.len() as u32)
            .map(|frame| {
                let pose = aligned(poses.frame(0), poses.frame(frame), weights);
                sampled.iter().flat_map(|&vertex| pose[vertex].to_array()).map(f64::from).collect()
            })
            .collect();
        let columns = 3 * sampled.len();
        let mean: Vec<f64> =
            (0..columns).map(|k| rows.iter().map(|row| row[k]).sum::<f64>() / rows.len() as f64).collect();
        rows.iter_mut().for_each(|row| row.iter_mut().zip(&mean).for_each(|(x, mean)| *x -= mean));
        let square = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>();
        let pick = |rows: &[Vec<f64>], better: fn(f64, f64) -> bool| {
            (0..rows.len()).fold(0, |best, k| if better(square(&rows[k]), square(&rows[best])) { k } else { best })
        };
        let mut frames = vec![pick(&rows, |a, b| a < b) as u32];
        let enough = f64::from(least * least) * sampled.len() as f64;
        while frames.len() < count {
            let next = pick(&rows, |a, b| a > b);
            let size = square(&rows[next]);
            if size <= enough {
                break;
            }
            frames.push(next as u32);
            let axis: Vec<f64> = rows[next].iter().map(|x| x / size.sqrt()).collect();
            for row in &mut rows {
                let along: f64 = row.iter().zip(&axis).map(|(x, a)| x * a).sum();
                row.iter_mut().zip(&axis).for_each(|(x, a)| *x -= along * a);
            }
        }
        let rest = poses.frame(frames[0]);
        let poses = frames.iter().map(|&frame| aligned(rest, poses.frame(frame), weights)).collect();
        Self { poses, frames }
    }
}

/// `pose` turned about the vertical to lie best on `fixed`, about its centre of mass over the ground.
fn aligned(fixed: &[Vec3], pose: &[Vec3], weights: &[f32]) -> Vec<Vec3> {
    let turn = Quat::from_rotation_y(align_heading(fixed, pose, weights));
    let (centre, ground) = (centre_of_mass(pose, weights), centre_of_mass(fixed, weights));
    let to = Vec3::new(ground.x, centre.y, ground.z);
    pose.iter().map(|&point| turn * (point - centre) + to).collect()
}
