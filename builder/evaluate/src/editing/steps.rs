//! A step that goes elsewhere: its foot goes there while it swings, stands there, and comes back in its next swing.
//!
//! One edit alone cannot do that: it is whole in a single frame, and the foot would slide all through its stance. So the stance has an
//! edit every few frames, each of which fades until the next one is whole: what they do between them adds up to the same.

use actor::feet::Feet;
use actor::timeline::Sequence;
use editing::soles::sole;
use glam::Vec3;

/// Frames between two edits of a stance, at most.
const EVERY: u32 = 6;

/// When a foot goes somewhere else, in frames of its sequence.
pub struct Step {
    /// The last frame before it is lifted, the first and the last in which it stands elsewhere, and the first after it has come back.
    pub lift: u32,
    pub land: u32,
    pub leave: u32,
    pub back: u32,
}

impl Step {
    /// The step whose swing `frame` is in, of the foot `foot`; `None` where it does not end in a stance.
    pub fn around(feet: &Feet, sequence: &Sequence, foot: usize, frame: u32) -> Option<Self> {
        let last = sequence.frame_count - 1;
        let stands = |frame: &u32| feet.stands(sequence.first_frame + frame, foot);
        let lift = (0..=frame).rev().find(stands).unwrap_or(0);
        let land = (frame.max(lift + 1)..=last).find(stands)?;
        let leave = (land..=last).take_while(stands).last()?;
        let back = (leave + 1..=last).find(stands).unwrap_or(last);
        (leave < back).then_some(Self { lift, land, leave, back })
    }

    /// The frames that are edited, and the window of each.
    pub fn keys(&self) -> Vec<(u32, [u32; 2])> {
        let length = self.leave - self.land;
        let count = length.div_ceil(EVERY).max(1).min(length.max(1));
        let at = |k: u32| self.land + length * k / count;
        let key = |k: u32| {
            let first = if k == 0 { self.lift } else { at(k - 1) };
            let last = if k == count { self.back } else { at(k + 1) };
            (at(k), [first, last])
        };
        if length == 0 { vec![(self.land, [self.lift, self.back])] } else { (0..=count).map(key).collect() }
    }
}

/// How far `foot` is on its way from one stance to the next, from 0 to 1; 0 where it stands.
pub fn swung(feet: &Feet, sequence: &Sequence, foot: usize, frame: u32) -> f32 {
    let stands = |frame: &u32| feet.stands(sequence.first_frame + frame, foot);
    let before = (0..=frame).rev().find(stands);
    let after = (frame..sequence.frame_count).find(stands);
    match (before, after) {
        (Some(before), Some(after)) if after > before => (frame - before) as f32 / (after - before) as f32,
        _ => 0.0,
    }
}

/// The vertices of a sole that are farthest ahead and farthest behind in `pose`.
pub fn ends(feet: &Feet, foot: usize, pose: &[Vec3], ahead: Vec3) -> Vec<u32> {
    let along = |vertex: u32| pose[vertex as usize].dot(ahead);
    let toe = sole(feet, foot).reduce(|best, v| if along(v) > along(best) { v } else { best });
    let heel = sole(feet, foot).reduce(|best, v| if along(v) < along(best) { v } else { best });
    let mut ends: Vec<u32> = [toe, heel].into_iter().flatten().collect();
    ends.dedup();
    ends
}

#[cfg(test)]
mod tests {
    use actor::feet::FootVertex;
    use actor::timeline::Timeline;

    use super::*;

    #[test]
    fn a_step_reaches_from_its_swing_through_its_stance_into_the_next_swing() {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 40, cyclic: false };
        let timeline = Timeline::new(20.0, vec![sequence.clone()]).unwrap();
        let stands: Vec<bool> = (0..40).map(|frame| frame < 5 || (10..25).contains(&frame) || frame >= 30).collect();
        let vertices = vec![vec![FootVertex { vertex: 0, leg: 255, sole: 255 }]];
        let feet = Feet::new(vertices, stands, 1, &timeline).unwrap();
        let step = Step::around(&feet, &sequence, 0, 7).unwrap();
        assert_eq!([step.lift, step.land, step.leave, step.back], [4, 10, 24, 30]);
        let keys = step.keys();
        assert_eq!((keys[0], keys[keys.len() - 1]), ((10, [4, 14]), (24, [19, 30])));
        // Each fades until the next one is whole, so that they add up to the same all through the stance.
        for pair in keys.windows(2) {
            assert_eq!((pair[0].1[1], pair[1].1[0]), (pair[1].0, pair[0].0));
            assert!(pair[1].0 - pair[0].0 <= EVERY);
        }
        assert_eq!((swung(&feet, &sequence, 0, 12), swung(&feet, &sequence, 0, 7)), (0.0, 0.5));
        assert!(Step::around(&feet, &sequence, 0, 35).is_none(), "no swing follows");
    }
}
