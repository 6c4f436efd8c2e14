//! Slide of feet that stand: what has to stay, apart from toes of a swinging foot that just brush the ground.

use actor::capture::Capture;
use actor::feet::Feet;
use actor::graph::{EssentialGraph, Transition};
use actor::timeline::Timeline;
use actor::walk::{Leg, steps_of};
use glam::{Vec3, Vec3Swizzles};
use synthesis::steps::foot_steps;

use super::series::Look;
use crate::blended;

/// The way along the ground, summed up over vertices, and how many these are.
pub type Slid = (f64, u32);

/// How far the soles of some feet slide from one frame to the next: those of their vertices that touch the ground in both.
pub fn slid(feet: &Feet, stands: &[bool], look: &Look, [before, after]: [&[Vec3]; 2]) -> Slid {
    let (mut sum, mut count) = (0.0, 0);
    for (foot, _) in stands.iter().enumerate().filter(|(_, stands)| **stands) {
        for vertex in feet.vertices(foot).iter().filter(|vertex| vertex.sole > 0) {
            let (b, a) = (before[vertex.vertex as usize], after[vertex.vertex as usize]);
            if look.touches(b) && look.touches(a) {
                sum += f64::from(b.xz().distance(a.xz()));
                count += 1;
            }
        }
    }
    (sum, count)
}

/// The mean of all, in metres a frame; not a number where nothing stands.
pub fn mean(slid: impl Iterator<Item = Slid>) -> f64 {
    let (sum, count) = slid.fold((0.0, 0), |all, one| (all.0 + one.0, all.1 + u64::from(one.1)));
    sum / count as f64
}

/// How far feet slide that stand, from each recorded frame to the one recorded after it.
pub fn recorded(capture: &Capture, feet: &Feet, look: &Look) -> Vec<Slid> {
    let (poses, timeline) = (&capture.poses, &capture.timeline);
    let step = |frame: u32| {
        let next = timeline.next(frame).filter(|next| *next == frame + 1)?;
        let stands = in_both(feet, frame, next);
        Some(slid(feet, &stands, look, [poses.frame(frame), poses.frame(next)]))
    };
    (0..timeline.frame_count()).map(|frame| step(frame).unwrap_or_default()).collect()
}

/// The mean of what the sides of transitions slide as recorded, each transition counting as much as it slid itself, in metres a frame; `recorded` as
/// [`recorded`] has it.
pub fn there<'a>(recorded: &[Slid], timeline: &Timeline, slid: impl Iterator<Item = (&'a Transition, Slid)>) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for (transition, (_, count)) in slid {
        let of = blended::sides(timeline, transition).into_iter().flatten();
        let own = mean(of.filter_map(|frame| recorded.get(frame as usize)).copied());
        if own.is_finite() {
            sum += own * f64::from(count);
            weight += f64::from(count);
        }
    }
    sum / weight
}

/// For each step of a leg, which feet stand in it.
pub fn standing(graph: &EssentialGraph, timeline: &Timeline, leg: &Leg) -> Vec<Vec<bool>> {
    let feet = graph.feet();
    let walked = |first: u32, steps: u32, way: i64| -> Vec<Vec<bool>> {
        let frame = |step: u32| timeline.offset(first, way * i64::from(step));
        let stands = |step| Some(in_both(feet, frame(step)?, frame(step + 1)?));
        (0..steps).map(|step| stands(step).unwrap_or_default()).collect()
    };
    match *leg {
        Leg::Recorded { first, steps, .. } => walked(first, steps, 1),
        Leg::Back { first, steps, .. } => walked(first, steps, -1),
        Leg::Synthetic(index) => {
            graph.transitions().get(index as usize).map_or_else(Vec::new, |to| within(feet, timeline, to))
        }
    }
}

fn in_both(feet: &Feet, frame: u32, next: u32) -> Vec<bool> {
    (0..feet.count()).map(|foot| feet.stands(frame, foot) && feet.stands(next, foot)).collect()
}

/// A foot stands in a step of a transition where it does on the side that it follows, before its own step the source and after it
/// the destination.
fn within(feet: &Feet, timeline: &Timeline, transition: &Transition) -> Vec<Vec<bool>> {
    let steps = foot_steps(feet, timeline, transition);
    let first = timeline.offset(transition.to, 1 - transition.warp.lengths().1 as i64);
    let frames = |(n, m): (usize, usize)| {
        [timeline.offset(transition.from, n as i64), first.and_then(|first| timeline.offset(first, m as i64))]
    };
    let nodes: Vec<[Option<u32>; 2]> = transition.warp.nodes().map(frames).collect();
    let stands = |foot: usize, at: usize| {
        let side = steps.get(foot).copied().flatten().map(|step| usize::from(step.weight(at) >= 0.5));
        let on = |node: usize| side.and_then(|side| nodes[node][side]).is_some_and(|frame| feet.stands(frame, foot));
        on(at) && on(at + 1)
    };
    (0..steps_of(transition) as usize)
        .map(|at| (0..feet.count()).map(|foot| at + 1 < nodes.len() && stands(foot, at)).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use actor::capture::Poses;
    use actor::feet::FootVertex;
    use actor::timeline::Sequence;

    use super::*;

    #[test]
    fn only_soles_of_feet_that_stand_count() {
        let sole = |vertex: u32, sole: u8| FootVertex { vertex, leg: 255, sole };
        let (name, labels) = ("stands".to_string(), Vec::new());
        let sequence = Sequence { name, labels, first_frame: 0, frame_count: 2, cyclic: false };
        let timeline = Timeline::new(30.0, vec![sequence]).unwrap();
        let feet = vec![vec![sole(0, 255), sole(1, 0)], vec![sole(2, 255)]];
        let feet = Feet::new(feet, vec![true, false, true, false], 4, &timeline).unwrap();
        let before = [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::Y];
        let after = [Vec3::X * 0.01, Vec3::X, Vec3::X, Vec3::Y];
        let mut poses = Poses::new(4);
        poses.push(&before);
        let look = Look::of(&poses, &[0.25; 4]);
        let stands = in_both(&feet, 0, 1);
        assert_eq!(stands, [true, false]);
        let (sum, count) = slid(&feet, &stands, &look, [&before, &after]);
        assert!((sum - 0.01).abs() < 1e-6 && count == 1, "{sum} {count}");
        assert!((mean([(0.01, 1), (0.0, 3)].into_iter()) - 0.0025).abs() < 1e-9);
    }
}
