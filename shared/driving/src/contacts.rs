//! When a foot of the source stands: where heel or ball is slow and low.

/// Slower than this stands, in metres a second of the actor.
const SPEED: f32 = 0.35;
/// Lower than this over where it usually stands, in metres: ball and ankle.
const BALL_HEIGHT: f32 = 0.06;
const ANKLE_HEIGHT: f32 = 0.035;
/// Contacts and gaps shorter than this are none, in seconds.
const SHORTEST: f32 = 0.07;
/// Where a joint usually stands: at this share of its heights.
const STANDING: f32 = 0.08;

use glam::Vec3;

use crate::smooth::quantile;

/// Whether heel and ball of a foot stand, frame by frame.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contacts {
    /// Of the heel.
    pub heel: Vec<bool>,
    /// Of the ball.
    pub ball: Vec<bool>,
}

impl Contacts {
    /// Contacts of a foot whose ankle and ball go these ways, in metres of the actor, at `fps` frames a second.
    #[must_use]
    pub fn find(ankle: &[Vec3], ball: &[Vec3], fps: f32) -> Self {
        let least = (SHORTEST * fps).round() as usize;
        let settled = |way: &[Vec3], above: f32| {
            let floor = quantile(way.iter().map(|place| place.y).collect(), STANDING);
            let mut stands: Vec<bool> =
                (0..way.len()).map(|frame| way[frame].y < floor + above && speed(way, frame, fps) < SPEED).collect();
            without_short(&mut stands, false, least);
            without_short(&mut stands, true, least);
            stands
        };
        Self { heel: settled(ankle, ANKLE_HEIGHT), ball: settled(ball, BALL_HEIGHT) }
    }

    /// Whether the foot stands in `frame`, with whatever of it.
    #[must_use]
    pub fn stands(&self, frame: usize) -> bool {
        self.heel[frame] || self.ball[frame]
    }
}

/// Speed in metres a second, from the frames around.
fn speed(way: &[Vec3], frame: usize, fps: f32) -> f32 {
    let (from, to) = (frame.saturating_sub(1), (frame + 1).min(way.len() - 1));
    way[to].distance(way[from]) * fps / (to - from).max(1) as f32
}

/// Turns runs of `value` that are shorter than `least` into the other; those at the ends stay.
fn without_short(stands: &mut [bool], value: bool, least: usize) {
    let mut from = 0;
    while from < stands.len() {
        let to = (from..stands.len()).find(|&frame| stands[frame] != stands[from]).unwrap_or(stands.len());
        if stands[from] == value && to - from < least && from > 0 && to < stands.len() {
            stands[from..to].fill(!value);
        }
        from = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_low_and_slow_stands() {
        // A step: 10 frames on the ground, 10 in the air, 10 on the ground.
        let way: Vec<Vec3> = (0..30)
            .map(|frame| {
                let u = ((frame - 10).clamp(0, 10) as f32) / 10.0;
                Vec3::new(u, 0.02 + 0.3 * u * (1.0 - u), 0.0)
            })
            .collect();
        let contacts = Contacts::find(&way, &way, 30.0);
        assert!(contacts.ball[5] && !contacts.ball[15] && contacts.ball[25]);
        assert!(contacts.stands(5) && !contacts.stands(15));
    }

    #[test]
    fn short_gaps_close() {
        let mut stands = [true, true, false, true, true, false, false, false, true];
        without_short(&mut stands, false, 2);
        assert_eq!(stands, [true, true, true, true, true, false, false, false, true]);
    }
}
