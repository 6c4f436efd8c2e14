//! Soles of the target stand where the source's stand.

use actor::feet::SHARE_STEP;
use glam::{Quat, Vec3};
use motion::hold::{Ends, mean, stand_still};

use crate::subject::Subject;

/// Which foot is which, and where the target's soles are when they stand.
pub struct Stance {
    /// Foot of the source for each of the target.
    source: Vec<usize>,
    /// Height of each sole's mean above the origin when it stands, in metres.
    heights: Vec<f32>,
}

impl Stance {
    /// Of two actors with as many feet; `None` where they have others.
    pub fn of(source: &Subject, target: &Subject) -> Option<Self> {
        let count = target.feet.count();
        if count == 0 || source.feet.count() != count {
            return None;
        }
        let (from, to) = (places(source)?, places(target)?);
        // The nearest one that is still free, the nearest pair first.
        let mut pairs: Vec<(f32, usize, usize)> = (0..count)
            .flat_map(|a| (0..count).map(move |b| (a, b)))
            .map(|(a, b)| (to[a].distance(from[b]), a, b))
            .collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut chosen = vec![usize::MAX; count];
        for (_, a, b) in pairs {
            if chosen[a] == usize::MAX && !chosen.contains(&b) {
                chosen[a] = b;
            }
        }
        let heights = (0..count).map(|foot| height(target, foot)).collect::<Option<Vec<f32>>>()?;
        Some(Self { source: chosen, heights })
    }

    /// Holds the soles of `poses`, of which each is the target as the source is at one of `times`.
    pub fn hold(&self, target: &Subject, source: &Subject, times: &[f64], poses: &mut [Vec<Vec3>]) {
        for (foot, (&other, &height)) in self.source.iter().zip(&self.heights).enumerate() {
            let sole = target.feet.vertices(foot);
            let stands: Vec<bool> = times.iter().map(|time| source.feet.stands(time.round() as u32, other)).collect();
            let carried: Vec<Vec3> = poses.iter().map(|pose| mean(sole, pose) - Vec3::Y * height).collect();
            let moves = stand_still(&carried, &stands, target.timeline.fps(), Ends::Free);
            for (pose, by) in poses.iter_mut().zip(moves) {
                for vertex in sole {
                    pose[vertex.vertex as usize] += by * (f32::from(vertex.leg) * SHARE_STEP);
                }
            }
        }
    }
}

impl Stance {
    /// How far soles move from frame to frame along the ground while the source's stand, in metres, on average; 0 where nothing
    /// stands.
    pub fn slide(&self, target: &Subject, source: &Subject, times: &[f64], poses: &[Vec<Vec3>]) -> f32 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (foot, &other) in self.source.iter().enumerate() {
            let stands = |k: usize| source.feet.stands(times[k].round() as u32, other);
            let at = |k: usize| mean(target.feet.vertices(foot), &poses[k]).with_y(0.0);
            for k in (1..poses.len()).filter(|&k| stands(k - 1) && stands(k)) {
                sum += at(k).distance(at(k - 1));
                count += 1.0;
            }
        }
        sum / f32::max(count, 1.0)
    }
}

/// Where each foot is on average, as the body faces, in body sizes.
fn places(subject: &Subject) -> Option<Vec<Vec3>> {
    let count = subject.poses.len();
    let frames: Vec<u32> = (0..count.min(60)).map(|k| (k * count / count.min(60)) as u32).collect();
    let place = |foot: usize| {
        let at = |&frame: &u32| {
            let root = subject.roots[frame as usize];
            Quat::from_rotation_y(-root.heading)
                * (mean(subject.feet.vertices(foot), subject.poses.frame(frame)) - root.centre)
        };
        frames.iter().map(at).sum::<Vec3>() / (frames.len() as f32 * subject.size)
    };
    (!frames.is_empty()).then(|| (0..subject.feet.count()).map(place).collect())
}

/// The middle height of a sole while it stands.
fn height(subject: &Subject, foot: usize) -> Option<f32> {
    let stands = (0..subject.poses.len() as u32).filter(|&frame| subject.feet.stands(frame, foot));
    let mut heights: Vec<f32> =
        stands.map(|frame| mean(subject.feet.vertices(foot), subject.poses.frame(frame)).y).collect();
    heights.sort_unstable_by(f32::total_cmp);
    heights.get(heights.len() / 2).copied()
}
