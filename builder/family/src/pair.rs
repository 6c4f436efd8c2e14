//! Two members and everything between them: their frames at the same phase, blended, before the feet are looked at.

use glam::Vec3;
use kernels::cholesky::CholeskyError;
use kernels::poisson::{KeyedPose, PoissonInterpolator};

use crate::align::align;
use crate::member::Member;
use crate::times::TimeMap;
use crate::twist::Twist;

/// Keys of the frames of the second member: far from those of the first.
const OTHER: u32 = 1 << 20;

/// Two members that do the same.
pub(crate) struct Pair<'a> {
    pub members: [&'a Member; 2],
    /// Times at which both do the same, in frames of both.
    points: Vec<(f32, f32)>,
}

/// What is seen of a blend at one frame.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    /// Where the frame of the blend is in both, in frames.
    pub at: [f32; 2],
    /// How far the frame that moves along has moved.
    pub along: Twist,
}

/// The frames of a blend, seen from the frame that moves along, the ground at 0.
pub(crate) struct Blend {
    /// Weight of the second member.
    pub lambda: f32,
    /// Frames, and one more step than there are frames where it repeats.
    pub seen: Vec<Seen>,
    /// When the flight of a jump begins and ends, in frames.
    pub flight: Option<[f32; 2]>,
    pub poses: Vec<Vec<Vec3>>,
}

impl<'a> Pair<'a> {
    /// Two members at the same phase. `Err` says why they do not match.
    pub fn new(members: [&'a Member; 2]) -> Result<Self, String> {
        let points = align(members[0], members[1])?;
        Ok(Self { members, points })
    }

    /// Times of the events in a blend in frames, the last one its duration. Flights last as long as a fall takes whose height
    /// is blended, steps as long as is between.
    fn times(&self, lambda: f32) -> Vec<f32> {
        let mix = |a: f32, b: f32| a + (b - a) * lambda;
        let mut times = vec![0.0];
        for (k, pair) in self.points.windows(2).enumerate() {
            let [a, b] = [pair[1].0 - pair[0].0, pair[1].1 - pair[0].1];
            let flies = !self.members[0].cyclic && k == 1;
            times.push(times[k] + if flies { mix(a * a, b * b).sqrt() } else { mix(a, b) });
        }
        times
    }

    /// The frames of a blend.
    pub fn blend(&self, lambda: f32, poisson: &mut PoissonInterpolator) -> Result<Blend, CholeskyError> {
        let cyclic = self.members[0].cyclic;
        let times = self.times(lambda);
        let duration = times[times.len() - 1];
        let steps = duration.round().max(2.0) as usize;
        let maps = [0, 1].map(|side| {
            let value = |point: &(f32, f32)| if side == 0 { point.0 } else { point.1 };
            let points: Vec<(f32, f32)> = times.iter().copied().zip(self.points.iter().map(value)).collect();
            TimeMap::new(&points, cyclic)
        });
        let twists = self.members.map(|member| member.twist);
        let shares = [1.0 - lambda, lambda];
        let seen: Vec<Seen> = (0..=steps)
            .map(|k| {
                let at = [0, 1].map(|side| maps[side].value(k as f32 * duration / steps as f32));
                let along = |side: usize| twists[side].times(shares[side] * at[side] / self.members[side].steps as f32);
                Seen { at, along: along(0).plus(&along(1)) }
            })
            .collect();
        let frames = if cyclic { steps } else { steps + 1 };
        let count = self.members[0].poses[0].len();
        let (mut poses, mut placed) = (Vec::with_capacity(frames), [vec![Vec3::ZERO; count], vec![Vec3::ZERO; count]]);
        poisson.forget_poses();
        for seen in &seen[..frames] {
            let mut keys = [0, OTHER];
            for side in [0, 1] {
                let member = self.members[side];
                let frame = member.index(seen.at[side].floor() as i64);
                keys[side] += frame as u32;
                // Weights are those of a recorded frame, whatever is between it and the next.
                poisson.weigh(KeyedPose { frame: keys[side], pose: &member.poses[frame] });
                member.pose_at(seen.at[side], &mut placed[side]);
            }
            let mut pose = vec![Vec3::ZERO; count];
            let sides = [0, 1].map(|side| KeyedPose { frame: keys[side], pose: &placed[side] });
            poisson.interpolate(sides[0], sides[1], lambda, &mut pose)?;
            poses.push(pose);
        }
        let flight = (!cyclic).then(|| [1, 2].map(|k| times[k.min(times.len() - 1)] * steps as f32 / duration));
        Ok(Blend { lambda, seen, flight, poses })
    }
}
