//! A sample of a family: the frames of one blend in the world, and what can be measured of them.

use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::align::{Placement, centre_of_mass};
use kernels::cholesky::CholeskyError;
use kernels::poisson::PoissonInterpolator;

use crate::cycle;
use crate::hold::{hold, slide, stands};
use crate::pair::{Blend, Pair};
use crate::parameter::Parameter;
use crate::recorded::Recorded;
use crate::root::route;
use crate::twist::Twist;

/// The frames of a blend in the world.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Weight of the second of the two members that it lies between, from 0 to 1.
    pub lambda: f32,
    /// The first of them, in the order of the family.
    pub member: usize,
    /// Sequences of both.
    pub sequences: [usize; 2],
    /// Whether its end meets its beginning.
    pub cyclic: bool,
    /// Its frames, in metres.
    pub poses: Vec<Vec<Vec3>>,
    /// From where its first frame is to where it is the next time, of one that repeats.
    pub end: Placement,
    /// Height of the ground that it stands on, in metres.
    pub floor: f32,
    /// For each frame the recorded frames that it is blended of.
    pub from: Vec<[u32; 2]>,
    /// For each foot and frame whether it stands.
    pub stands: Vec<Vec<bool>>,
    /// What was measured of it.
    pub measured: Measured,
}

/// What can be measured of a sample, or of a piece of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Its duration in seconds.
    pub seconds: f32,
    /// Metres a second along its way.
    pub speed: f32,
    /// Turn in radians per metre of its way; 0 where it goes nowhere.
    pub turn: f32,
    /// How far the centre of mass rises above where it is while standing, in metres.
    pub height: f32,
    /// From where the feet leave to where they land, in metres.
    pub length: f32,
    /// How far what touches the ground slides from frame to frame while its foot stands, in metres.
    pub slide: Option<f32>,
    /// Height above the ground of the lowest point of a sole in any frame, in metres.
    pub lowest: f32,
}

impl Measured {
    /// The parameter of a family.
    #[must_use]
    pub fn value(&self, parameter: Parameter) -> f32 {
        match parameter {
            Parameter::Speed => self.speed,
            Parameter::Turn => self.turn,
            Parameter::Height => self.height,
            Parameter::Length => self.length,
        }
    }
}

impl Sample {
    /// For each frame the recorded frame that it is nearer to.
    pub fn worn(&self) -> impl Iterator<Item = u32> {
        let side = usize::from(self.lambda >= 0.5);
        self.from.iter().map(move |frames| frames[side])
    }
}

/// Makes the sample at `lambda` between two members.
pub(crate) fn sample(
    recorded: &Recorded,
    pair: &Pair,
    lambda: f32,
    poisson: &mut PoissonInterpolator,
) -> Result<Sample, CholeskyError> {
    let cyclic = pair.members[0].cyclic;
    let mut blend = pair.blend(lambda, poisson)?;
    let stands = stands(recorded, pair, &blend);
    let route = route(recorded, &blend, &stands, cyclic);
    hold(recorded, pair, &mut blend, &route, &stands);
    let mix = |of: [f32; 2]| of[0] + (of[1] - of[0]) * lambda;
    let floor = mix(pair.members.map(|member| member.floor));
    let end = route.placements[route.placements.len() - 1];
    let from = blend.seen[..blend.poses.len()].iter().map(|seen| {
        [0, 1].map(|side| {
            let member = pair.members[side];
            member.frames[member.index(seen.at[side].round() as i64)]
        })
    });
    let from = from.collect();
    let Blend { mut poses, flight, .. } = blend;
    poses.iter_mut().zip(&route.placements).for_each(|(pose, placement)| placement.apply_all(pose));
    let mut measured = measured(recorded, &poses, &stands, cyclic.then_some(end));
    measured.length = flight.map_or(0.0, |flight| length(recorded, &poses, flight));
    measured.height -= mix(pair.members.map(|member| member.standing));
    poses.iter_mut().flatten().for_each(|point| point.y += floor);
    let sequences = pair.members.map(|member| member.sequence);
    Ok(Sample { lambda, member: 0, sequences, cyclic, poses, end, floor, from, stands, measured })
}

/// What can be measured of frames that stand on a ground at 0, of which the height is that of the centre of mass above it.
fn measured(recorded: &Recorded, poses: &[Vec<Vec3>], stands: &[Vec<bool>], end: Option<Placement>) -> Measured {
    let fps = recorded.timeline.fps();
    let (first, last) = (recorded.centre(&poses[0]), recorded.centre(&poses[poses.len() - 1]));
    let twist = end.map_or(Twist { turn: 0.0, step: last - first }, |end| {
        let begin = Placement { heading: 0.0, translation: first };
        Twist::to(&begin.inverse().after(&end.after(&begin)))
    });
    let steps = if end.is_some() { poses.len() } else { poses.len() - 1 };
    let (seconds, way) = (steps as f32 / fps, cycle::way(&twist));
    let height = |pose: &Vec<Vec3>| centre_of_mass(pose, recorded.topology.weights()).y;
    let lowest = |pose: &Vec<Vec3>| {
        (0..recorded.feet.count()).map(|foot| recorded.lowest(foot, pose)).fold(f32::INFINITY, f32::min)
    };
    Measured {
        seconds,
        speed: way / seconds,
        turn: if way > 0.1 * recorded.body() { twist.turn / way } else { 0.0 },
        height: poses.iter().map(height).fold(f32::NEG_INFINITY, f32::max),
        length: 0.0,
        slide: slide(recorded, poses, stands),
        lowest: poses.iter().map(lowest).fold(f32::INFINITY, f32::min),
    }
}

/// How far the feet are from where they were when they left, once they land, along the ground in metres; `flight` in frames.
fn length(recorded: &Recorded, poses: &[Vec<Vec3>], flight: [f32; 2]) -> f32 {
    let middle = |k: usize| {
        let soles = (0..recorded.feet.count()).flat_map(|foot| recorded.sole(foot));
        let (sum, count) = soles.fold((Vec2::ZERO, 0.0), |(sum, n), v| (sum + poses[k][v].xz(), n + 1.0));
        sum / f32::max(count, 1.0)
    };
    // Whole frames would make it jump by what the feet roll in a frame.
    let [off, land] = flight.map(|at| {
        let (k, last) = (at.floor() as usize, poses.len() - 1);
        middle(k.min(last)).lerp(middle((k + 1).min(last)), at - at.floor())
    });
    off.distance(land)
}
