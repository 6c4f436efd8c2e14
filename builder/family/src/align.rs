//! What two members do at the same time: their landings, and the liftings that come between the same landings in both.

use crate::member::{Event, Member};

/// A lifting nearer than this to another event is left out, in frames.
const APART: f32 = 1.5;
/// Between two events no member runs more than so many times as fast as the other, against the whole.
const RATIO: f32 = 2.5;

/// Times at which both do the same, in frames of both, from their beginnings to their ends. `Err` says why they do not match.
pub fn align(one: &Member, other: &Member) -> Result<Vec<(f32, f32)>, String> {
    let landings =
        |member: &Member| -> Vec<Event> { member.events.iter().copied().filter(|event| event.lands).collect() };
    let (ones, others) = (landings(one), landings(other));
    let feet = |events: &[Event]| events.iter().map(|event| event.foot).collect::<Vec<_>>();
    if one.cyclic != other.cyclic {
        return Err("one jumps and the other steps".into());
    }
    if feet(&ones) != feet(&others) {
        return Err(format!("feet land in another order: {} and {}", told(&ones), told(&others)));
    }
    let end = (one.steps as f32, other.steps as f32);
    let mut points = vec![(0.0, 0.0)];
    points.extend(ones.iter().zip(&others).map(|(a, b)| (a.at, b.at)).filter(|&(a, b)| a > 0.0 && b > 0.0));
    points.push(end);
    let rises = points.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 < pair[1].1);
    if !rises {
        return Err("two feet land at once in one of them, and one after the other in the other".into());
    }
    let mut all = points.clone();
    for pair in points.windows(2) {
        let within = |event: &&Event, from: f32, to: f32| !event.lands && from < event.at && event.at < to;
        let mut left = other.events.iter().filter(|event| within(event, pair[0].1, pair[1].1));
        for lift in one.events.iter().filter(|event| within(event, pair[0].0, pair[1].0)) {
            if let Some(same) = left.by_ref().find(|event| event.foot == lift.foot) {
                all.push((lift.at, same.at));
            }
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(spaced(&all, &points))
}

fn told(landings: &[Event]) -> String {
    let feet: Vec<String> = landings.iter().map(|event| (event.foot + 1).to_string()).collect();
    if feet.is_empty() { "none".into() } else { feet.join(", ") }
}

/// Of `points` in order those that keep their distance; those that `stay` do in any case.
fn spaced(points: &[(f32, f32)], stay: &[(f32, f32)]) -> Vec<(f32, f32)> {
    let mut kept: Vec<(f32, f32)> = Vec::new();
    let (first, last) = (points[0], points[points.len() - 1]);
    let whole = (last.1 - first.1) / (last.0 - first.0);
    let fits = |a: (f32, f32), b: (f32, f32)| {
        let (x, y) = (b.0 - a.0, b.1 - a.1);
        x > APART && y > APART && (1.0 / RATIO..RATIO).contains(&(y / x / whole))
    };
    for (k, &point) in points.iter().enumerate() {
        let next = points[k + 1..].iter().find(|point| stay.contains(point));
        let before = kept.last().is_none_or(|&before| fits(before, point));
        if stay.contains(&point) || before && next.is_none_or(|&next| fits(point, next)) {
            kept.push(point);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::twist::Twist;

    fn member(events: &[(usize, bool, f32)], steps: usize, cyclic: bool) -> Member {
        let event = |&(foot, lands, at): &(usize, bool, f32)| Event { foot, lands, at };
        Member {
            sequence: 0,
            cyclic,
            frames: vec![],
            poses: vec![],
            steps,
            twist: Twist::default(),
            events: events.iter().map(event).collect(),
            stands: vec![],
            lowest: vec![],
            floor: 0.0,
            standing: 0.0,
            seam: 0,
        }
    }

    #[test]
    fn landings_meet_and_liftings_between_the_same_landings() {
        let walk = member(&[(0, true, 0.0), (1, false, 6.0), (1, true, 27.0), (0, false, 33.0)], 54, true);
        let slow = member(&[(0, true, 0.0), (1, false, 8.0), (1, true, 33.0), (0, false, 41.0)], 66, true);
        let run = member(&[(0, true, 0.0), (0, false, 13.0), (1, true, 18.0), (1, false, 31.0)], 36, true);
        let steps = align(&walk, &slow).unwrap();
        assert_eq!(steps, [(0.0, 0.0), (6.0, 8.0), (27.0, 33.0), (33.0, 41.0), (54.0, 66.0)]);
        // In a run the other foot lifts between the landings: these are not the same.
        assert_eq!(align(&walk, &run).unwrap(), [(0.0, 0.0), (27.0, 18.0), (54.0, 36.0)]);
    }

    #[test]
    fn what_does_something_else_is_refused() {
        let walk = member(&[(0, true, 0.0), (1, true, 27.0)], 54, true);
        let hop = member(&[(0, true, 0.0)], 20, true);
        let jump = member(&[(0, false, 30.0), (0, true, 54.0)], 90, false);
        assert_eq!(align(&walk, &hop).unwrap_err(), "feet land in another order: 1, 2 and 1");
        assert_eq!(align(&walk, &jump).unwrap_err(), "one jumps and the other steps");
    }
}
