//! A blended body does not hop: it is hardly higher above the ground than the higher of both sides.
//!
//! Not in the papers. Between two poses on different legs both legs may be bent or both feet on their way, so that the whole body
//! is in the air for some frames. It is let down, all of it by as much, and softly: less than [`LEFT`] of its height is left.

use glam::Vec3;

/// What is left of a high hop, as a part of the body's height. Half of that is left of a hop that is as high.
const LEFT: f32 = 0.005;

/// Lets `pose`, a blend of the sides as they are `placed`, down towards the higher of both.
pub(crate) fn let_down(placed: &[Vec<Vec3>; 2], pose: &mut [Vec3]) {
    let [source, destination] = [0, 1].map(|side| heights(&placed[side]));
    let above = heights(pose)[0] - source[0].max(destination[0]);
    if above > 0.0 {
        let left = LEFT * (source[1] - source[0]).min(destination[1] - destination[0]);
        // Grows with the square at first, so that nothing is let down at once.
        let by = above * (above / (above + left).max(f32::MIN_POSITIVE));
        pose.iter_mut().for_each(|point| point.y -= by);
    }
}

/// The lowest and the highest point.
fn heights(pose: &[Vec3]) -> [f32; 2] {
    let low = pose.iter().fold(f32::INFINITY, |low, point| low.min(point.y));
    [low, pose.iter().fold(f32::NEG_INFINITY, |high, point| high.max(point.y))]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body of 2 m, its lowest point at `low`.
    fn body(low: f32) -> Vec<Vec3> {
        [0.0, 0.7, 2.0].map(|y| Vec3::new(0.1 * y, low + y, 0.3)).to_vec()
    }

    #[test]
    fn little_is_left_of_a_hop_and_nothing_else_is_moved() {
        let placed = [body(0.0), body(0.02)];
        for low in [-0.1, 0.0, 0.01, 0.02] {
            let mut pose = body(low);
            let_down(&placed, &mut pose);
            assert_eq!(pose, body(low));
        }
        let mut before = 0.0;
        for step in 1..40 {
            let above = 0.002 * step as f32;
            let mut pose = body(0.02 + above);
            let_down(&placed, &mut pose);
            let left = pose[0].y - 0.02;
            assert!(left > before && left < 0.01 && left <= above, "{left} of {above}");
            assert!(
                pose.iter().zip(body(0.02 + left)).all(|(a, b)| a.abs_diff_eq(b, 1e-6)),
                "not all of it by as much"
            );
            before = left;
        }
    }

    #[test]
    fn nothing_is_no_trouble() {
        for placed in [[vec![], vec![]], [vec![Vec3::ZERO], vec![Vec3::ZERO]]] {
            let mut pose = vec![Vec3::ONE; placed[0].len()];
            let_down(&placed, &mut pose);
            assert!(pose.iter().all(|point| point.is_finite()));
        }
    }
}
