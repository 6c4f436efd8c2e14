//! Walks as the page reads them: legs, and where they lead on the ground.

use actor::graph::EssentialGraph;
use actor::walk::{Leg, Walk, steps_of};
use glam::{Vec2, Vec3};
use kernels::align::Placement;
use search::{Answer, GroundPose, SearchGraph};
use serde::Serialize;

/// A leg as the page reads it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum LegReport {
    /// Recorded frames; backwards where `last` is before `first` in a sequence that is not cyclic.
    Recorded {
        /// First frame.
        first: u32,
        /// Last frame.
        last: u32,
        /// Steps between them.
        steps: u32,
        /// Whether it is walked backwards.
        back: bool,
    },
    /// A synthesised transition.
    Synthetic {
        /// Frame left.
        from: u32,
        /// Frame reached.
        to: u32,
        /// Steps that it takes.
        frames: u32,
        /// Its surface deformation cost.
        deformation: f32,
        /// Its index in the graph.
        edge: u32,
    },
}

/// `legs` as the page reads them.
#[must_use]
pub fn report_legs(legs: &[Leg], graph: &EssentialGraph) -> Vec<LegReport> {
    let report = |leg: &Leg| match *leg {
        Leg::Back { first, last, steps } => Some(LegReport::Recorded { first, last, steps, back: true }),
        Leg::Recorded { first, last, steps } => Some(LegReport::Recorded { first, last, steps, back: false }),
        Leg::Synthetic(edge) => graph.transitions().get(edge as usize).map(|transition| LegReport::Synthetic {
            from: transition.from,
            to: transition.to,
            frames: steps_of(transition),
            deformation: transition.deformation,
            edge,
        }),
    };
    legs.iter().filter_map(report).collect()
}

/// An answer as the page reads it.
#[derive(Clone, Debug, Serialize)]
pub struct AnswerReport {
    /// What the search says.
    #[serde(flatten)]
    pub answer: Answer,
    /// The walk's legs as in plans.
    pub legs: Vec<LegReport>,
    /// Where the walk leads on the ground, leg by leg.
    pub track: Vec<TrackPiece>,
}

/// A leg of a walk on the ground.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackPiece {
    /// Whether it is synthesised.
    pub synthetic: bool,
    /// The followed point (X, Z), metres.
    pub points: Vec<[f32; 2]>,
}

/// Where `walk` leads on the ground from `start`, standing at `placement`.
pub(crate) fn track(search_graph: &SearchGraph, start: u32, placement: Placement, walk: &Walk) -> Vec<TrackPiece> {
    let (mut frame, mut ground_pose) = (start, GroundPose::from(&placement));
    let ground = |ground_pose: &GroundPose, point| {
        let place = ground_pose.apply(point);
        [place.x, place.z]
    };
    let mut pieces = Vec::with_capacity(walk.legs.len());
    // Points come after so many steps, and are put where the bend has them then.
    let mut taken = 0;
    let bent = |step: u32, [x, z]: [f32; 2]| {
        let Some(&[heading, shift_x, shift_z]) = walk.bend.get(step as usize).or(walk.bend.last()) else {
            return [x, z];
        };
        let put = Placement { heading, translation: Vec2::new(shift_x, shift_z) };
        let Vec3 { x, z, .. } = put.apply(Vec3::new(x, 0.0, z));
        [x, z]
    };
    for leg in &walk.legs {
        let transition = leg.transition();
        let here = search_graph.points.get(frame as usize).copied().unwrap_or_default();
        let mut piece =
            TrackPiece { synthetic: transition.is_some(), points: vec![bent(taken, ground(&ground_pose, here))] };
        if let Leg::Back { first, last, .. } = *leg {
            let frames = search_graph.points.get(last as usize..first as usize).unwrap_or_default();
            for &point in frames.iter().rev() {
                taken += 1;
                piece.points.push(bent(taken, ground(&ground_pose, point)));
            }
            frame = last;
        }
        let steps = match *leg {
            Leg::Recorded { steps, .. } => steps,
            Leg::Synthetic(_) => 1,
            Leg::Back { .. } => 0,
        };
        for _ in 0..steps {
            let Some(index) = search_graph.from(frame).find(|&index| search_graph.edge(index).transition == transition)
            else {
                break;
            };
            for sample in search_graph.samples(index) {
                taken += sample.steps;
                piece.points.push(bent(taken, ground(&ground_pose, sample.point)));
            }
            let edge = search_graph.edge(index);
            (frame, ground_pose) = (edge.to, ground_pose.after(&edge.ground_pose));
        }
        pieces.push(piece);
    }
    pieces
}
