//! Two members face one way: what one does at each phase lies best on what the other does.

use glam::{Vec2, Vec3};
use kernels::align::{Placement, align_heading};

use crate::align::align;
use crate::member::Member;
use crate::recorded::Recorded;

/// Phases that are looked at.
const PHASES: usize = 12;

/// Turns `other` so that it faces as `one` does, on average over a cycle, and says how far they then are apart: the root of the mean square
/// over vertices and phases in metres, their centres of mass on each other. `Err` says why they do not match.
pub(crate) fn face(recorded: &Recorded, one: &Member, other: &mut Member) -> Result<f32, String> {
    let points = align(one, other)?;
    let count = recorded.topology.vertex_count();
    let mut looked_at = Vec::with_capacity(PHASES);
    let mut sum = Vec2::ZERO;
    for phase in 0..PHASES {
        let at = phase as f32 / PHASES as f32 * one.steps as f32;
        let k = points.partition_point(|point| point.0 <= at).clamp(1, points.len() - 1);
        let (from, to) = (points[k - 1], points[k]);
        let other_at = from.1 + (to.1 - from.1) * (at - from.0) / (to.0 - from.0);
        let (mut here, mut there) = (vec![Vec3::ZERO; count], vec![Vec3::ZERO; count]);
        one.pose_at(at, &mut here);
        other.pose_at(other_at, &mut there);
        sum += Vec2::from_angle(align_heading(&here, &there, recorded.topology.weights()));
        looked_at.push((here, there));
    }
    let turn = sum.to_angle();
    other.turn(turn);
    let apart = |(here, there): &(Vec<Vec3>, Vec<Vec3>)| {
        let placement = Placement::turning(turn, recorded.centre(there), recorded.centre(here));
        let squares = here.iter().zip(there).map(|(here, there)| placement.apply(*there).distance_squared(*here));
        squares.sum::<f32>() / count as f32
    };
    Ok((looked_at.iter().map(apart).sum::<f32>() / PHASES as f32).sqrt())
}
