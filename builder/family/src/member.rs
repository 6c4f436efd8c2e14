//! A member of a family: a cycle or a jump cut out of its sequence, seen from a frame that moves along steadily.

use glam::Vec3;
use kernels::align::{Placement, align_heading, centre_of_mass};
use kernels::cholesky::CholeskyError;
use kernels::poisson::{KeyedPose, PoissonInterpolator};

use crate::cycle::{Cycle, FLICKER, heading};
use crate::jump::Jump;
use crate::recorded::{Recorded, Track};
use crate::twist::Twist;

/// The end of a cycle goes over into its beginning within so many seconds, and within this share of it at most.
const SEAM: f32 = 0.16;
const SEAM_SHARE: f32 = 0.25;
/// A way shorter than this says nothing about a direction, in body heights.
const NO_WAY: f32 = 0.1;

/// A foot lands or lifts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// The foot; all jumps have 0.
    pub foot: usize,
    /// Whether it lands.
    pub lands: bool,
    /// When, in frames from the beginning.
    pub at: f32,
}

/// What is cut out of a sequence.
#[derive(Clone, Debug)]
pub struct Member {
    /// Index of the sequence.
    pub sequence: usize,
    /// Whether it repeats.
    pub cyclic: bool,
    /// The recorded frame of each of its frames.
    pub frames: Vec<u32>,
    /// Its frames in metres, seen from the frame that moves along, the ground at 0. One that repeats has closed ends.
    pub poses: Vec<Vec<Vec3>>,
    /// Steps from its first frame to where it begins again, or to its last frame.
    pub steps: usize,
    /// Where it leads to.
    pub twist: Twist,
    /// When feet land and lift, in order.
    pub events: Vec<Event>,
    /// For each foot and frame whether it stands.
    pub stands: Vec<Vec<bool>>,
    /// For each foot and frame how high its sole's lowest point is, in metres.
    pub lowest: Vec<Vec<f32>>,
    /// Height of the ground in its recording, in metres.
    pub floor: f32,
    /// Height of the centre of mass above the ground while something stands, in metres: the median.
    pub standing: f32,
    /// Frames in which the end goes over into the beginning; 0 where the recording has none to spare.
    pub seam: usize,
}

/// What a member is cut from.
pub(crate) struct Cut<'a> {
    pub recorded: &'a Recorded<'a>,
    pub track: &'a Track,
    pub sequence: usize,
}

impl Cut<'_> {
    /// The member that a cycle is.
    pub fn cycle(&self, cycle: &Cycle, poisson: &mut PoissonInterpolator) -> Result<Member, CholeskyError> {
        let recorded = self.recorded;
        let turned = heading(&cycle.twist, NO_WAY * recorded.body()).unwrap_or(0.0);
        let twist = cycle.twist.turned(-turned);
        let steps = cycle.frames();
        let local = self.seen(cycle.from, turned, &twist, steps);
        let places: Vec<usize> = (cycle.from..cycle.to).collect();
        let mut poses: Vec<Vec<Vec3>> = (0..steps as i64).map(&local).collect();
        let most = recorded.frames(SEAM).min((SEAM_SHARE * steps as f32) as usize);
        let (before, after) = (cycle.from, self.track.len() - cycle.to);
        let seam = before.max(after).min(most);
        for k in 0..seam {
            let share = (k + 1) as f32 / (seam + 1) as f32;
            let share = share * share * (3.0 - 2.0 * share);
            // Either the end goes over into what led to the beginning, or the beginning comes out of what followed the end.
            let (at, other, share) = if before >= seam {
                let at = steps - seam + k;
                (at, local(at as i64 - steps as i64), share)
            } else {
                (k, local((k + steps) as i64), 1.0 - share)
            };
            let pose = poses[at].clone();
            let sides =
                [KeyedPose { frame: at as u32, pose: &pose }, KeyedPose { frame: (1 << 16) + k as u32, pose: &other }];
            poisson.interpolate(sides[0], sides[1], share, &mut poses[at])?;
        }
        poisson.forget_poses();
        Ok(self.member((places, poses, steps, true), twist, self.events(cycle), seam))
    }

    /// The member that a jump is, with so many frames before and after the flight.
    pub fn jump(&self, jump: &Jump, (before, after): (usize, usize)) -> Member {
        let recorded = self.recorded;
        let (from, to) = (jump.off - before, jump.land + after);
        let steps = to - from;
        let [first, last] = [from, to].map(|at| self.track.pose(recorded, at));
        let turn = align_heading(&last, &first, recorded.topology.weights());
        let origin = Placement { heading: 0.0, translation: recorded.centre(&first) };
        let end = Placement::turning(turn, origin.translation, recorded.centre(&last));
        let twist = Twist::to(&origin.inverse().after(&end.after(&origin)));
        let turned = heading(&twist, NO_WAY * recorded.body()).unwrap_or(0.0);
        let twist = twist.turned(-turned);
        let local = self.seen(from, turned, &twist, steps);
        let poses = (0..=steps as i64).map(local).collect();
        let event = |lands: bool, at: usize| Event { foot: 0, lands, at: (at - from) as f32 };
        let events = vec![event(false, jump.off), event(true, jump.land)];
        self.member(((from..=to).collect(), poses, steps, false), twist, events, 0)
    }

    /// Poses seen from the frame that moves along, by steps from the place `from`.
    fn seen<'a>(&'a self, from: usize, turned: f32, twist: &Twist, steps: usize) -> impl Fn(i64) -> Vec<Vec3> + 'a {
        let begin =
            Placement { heading: turned, translation: self.recorded.centre(&self.track.pose(self.recorded, from)) };
        let (twist, floor) = (*twist, self.floor());
        move |step: i64| {
            let along = twist.times(step as f32 / steps as f32).placement();
            let back = begin.after(&along).inverse();
            let mut pose = self.track.pose(self.recorded, (from as i64 + step) as usize);
            back.apply_all(&mut pose);
            pose.iter_mut().for_each(|point| point.y -= floor);
            pose
        }
    }

    fn floor(&self) -> f32 {
        self.recorded.floors.get(self.sequence).copied().unwrap_or(0.0)
    }

    /// When feet land and lift in a cycle.
    fn events(&self, cycle: &Cycle) -> Vec<Event> {
        let recorded = self.recorded;
        let mut events = Vec::new();
        for foot in 0..recorded.feet.count() {
            for (first, last) in self.track.stances(recorded.feet, foot, recorded.frames(FLICKER)) {
                let mut add = |place: usize, lands: bool| {
                    if (cycle.from..cycle.to).contains(&place) {
                        events.push(Event { foot, lands, at: (place - cycle.from) as f32 });
                    }
                };
                // The foot by which it is cut lands at its ends, and nowhere else.
                if foot != cycle.foot || first == cycle.from {
                    add(first, true);
                }
                if last + 1 < self.track.len() {
                    add(last, false);
                }
            }
        }
        events.sort_by(|a, b| a.at.total_cmp(&b.at).then(b.lands.cmp(&a.lands)).then(a.foot.cmp(&b.foot)));
        events
    }

    fn member(
        &self,
        (places, poses, steps, cyclic): (Vec<usize>, Vec<Vec<Vec3>>, usize, bool),
        twist: Twist,
        events: Vec<Event>,
        seam: usize,
    ) -> Member {
        let recorded = self.recorded;
        let feet = 0..recorded.feet.count();
        let stands: Vec<Vec<bool>> = feet
            .clone()
            .map(|foot| {
                let stances = self.track.stances(recorded.feet, foot, recorded.frames(FLICKER));
                let within = |place: &usize| stances.iter().any(|(first, last)| (first..=last).contains(&place));
                places.iter().map(within).collect()
            })
            .collect();
        let lowest = feet.map(|foot| poses.iter().map(|pose| recorded.lowest(foot, pose)).collect()).collect();
        let mut standing: Vec<f32> = (0..poses.len())
            .filter(|&k| stands.iter().any(|foot| foot[k]))
            .map(|k| centre_of_mass(&poses[k], recorded.topology.weights()).y)
            .collect();
        standing.sort_unstable_by(f32::total_cmp);
        let frames = places.iter().map(|&place| self.track.frame(place)).collect();
        let standing = standing.get(standing.len() / 2).copied().unwrap_or(0.0);
        Member {
            sequence: self.sequence,
            cyclic,
            frames,
            poses,
            steps,
            twist,
            events,
            stands,
            lowest,
            floor: self.floor(),
            standing,
            seam,
        }
    }
}

impl Member {
    /// Turns it about where it begins.
    pub fn turn(&mut self, by: f32) {
        let placement = Placement { heading: by, translation: glam::Vec2::ZERO };
        self.poses.iter_mut().for_each(|pose| placement.apply_all(pose));
        self.twist = self.twist.turned(by);
    }

    /// The frame at a place, which wraps around where it repeats and is held at the ends where it does not.
    #[must_use]
    pub fn index(&self, at: i64) -> usize {
        let count = self.poses.len() as i64;
        (if self.cyclic { at.rem_euclid(count) } else { at.clamp(0, count - 1) }) as usize
    }

    /// Writes the pose between frames at `at` into `out`: cubic in time, through the frames.
    pub fn pose_at(&self, at: f32, out: &mut [Vec3]) {
        let (k, u) = (at.floor() as i64, at - at.floor());
        let [a, b, c, d] = [-1, 0, 1, 2].map(|beside| &self.poses[self.index(k + beside)]);
        let weights = catmull_rom(u);
        for (vertex, out) in out.iter_mut().enumerate() {
            *out = a[vertex] * weights[0] + b[vertex] * weights[1] + c[vertex] * weights[2] + d[vertex] * weights[3];
        }
    }

    /// One of its numbers between frames.
    #[must_use]
    pub fn number_at(&self, numbers: &[f32], at: f32) -> f32 {
        let (k, u) = (at.floor() as i64, at - at.floor());
        let [b, c] = [0, 1].map(|beside| numbers[self.index(k + beside)]);
        b + (c - b) * u
    }

    /// Whether a foot stands at a time, in frames.
    #[must_use]
    pub fn stands_at(&self, foot: usize, at: f32) -> bool {
        self.stands[foot][self.index(at.round() as i64)]
    }
}

/// Weights of four frames in a row, `u` of the way from the second to the third.
fn catmull_rom(u: f32) -> [f32; 4] {
    let (u2, u3) = (u * u, u * u * u);
    [(-u3 + 2.0 * u2 - u) / 2.0, (3.0 * u3 - 5.0 * u2 + 2.0) / 2.0, (-3.0 * u3 + 4.0 * u2 + u) / 2.0, (u3 - u2) / 2.0]
}
