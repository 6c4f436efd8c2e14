//! Channels: what one sampler does to one property of a node, at any time.

use glam::{Quat, Vec4};

/// What a channel changes of its node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Property {
    Translation,
    Rotation,
    Scale,
    /// Weights of the morph targets.
    Weights,
    /// Whether the node is shown.
    Visible,
}

/// What a channel has between its keyframes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    Linear,
    Step,
    CubicSpline,
    /// The keyframe that is nearest in time. No file says so: it stands in for what exporters make of a switch.
    Nearest,
}

/// A property of a node over time.
pub(super) struct Channel {
    pub node: usize,
    pub property: Property,
    pub interpolation: Interpolation,
    /// Times of the keyframes in seconds, ascending; not empty.
    pub times: Vec<f32>,
    /// `width` numbers a keyframe; three times as many where `cubic` (in-tangent, value, out-tangent).
    pub values: Vec<f32>,
    pub width: usize,
    /// Whether the values have tangents beside them.
    pub cubic: bool,
}

impl Channel {
    /// The value at `time`; before the first and after the last keyframe it holds still.
    ///
    /// A step is taken up to `slack` seconds early: keyframes at frames' times are rounded to 32 bits, and a frame shall
    /// show its own keyframe, not the one before.
    pub fn sample(&self, time: f64, slack: f64) -> Vec<f32> {
        let last = self.times.len() - 1;
        if self.interpolation == Interpolation::Step || self.interpolation == Interpolation::Nearest {
            return self.value(self.key(time, slack)).to_vec();
        }
        let next = self.times.partition_point(|&t| f64::from(t) <= time);
        if next == 0 || next > last {
            return self.value(next.min(last)).to_vec();
        }
        let (from, to) = (next - 1, next);
        let (start, end) = (f64::from(self.times[from]), f64::from(self.times[to]));
        let s = ((time - start) / (end - start)) as f32;
        if self.cubic {
            let tangents = (self.point(3 * from + 2), self.point(3 * to));
            return hermite(self.value(from), tangents.0, self.value(to), tangents.1, s, (end - start) as f32);
        }
        if self.property == Property::Rotation {
            return unit(vec4(self.value(from))).slerp(unit(vec4(self.value(to))), s).to_array().to_vec();
        }
        self.value(from).iter().zip(self.value(to)).map(|(a, b)| a + (b - a) * s).collect()
    }

    /// The value at keyframe `key`.
    pub fn value(&self, key: usize) -> &[f32] {
        if self.cubic { self.point(3 * key + 1) } else { self.point(key) }
    }

    /// The keyframe that a step or the nearest one shows.
    fn key(&self, time: f64, slack: f64) -> usize {
        let next = self.times.partition_point(|&t| f64::from(t) <= time + slack);
        let (before, after) = (next.saturating_sub(1), next.min(self.times.len() - 1));
        let away = |key: usize| (f64::from(self.times[key]) - time).abs();
        if self.interpolation == Interpolation::Nearest && away(after) < away(before) { after } else { before }
    }

    fn point(&self, k: usize) -> &[f32] {
        &self.values[k * self.width..(k + 1) * self.width]
    }
}

/// The cubic spline of the glTF specification, appendix C.5: `s` from 0 to 1, tangents per second.
fn hermite(p0: &[f32], m0: &[f32], p1: &[f32], m1: &[f32], s: f32, length: f32) -> Vec<f32> {
    let (s2, s3) = (s * s, s * s * s);
    let (a, b, c, d) =
        (2.0 * s3 - 3.0 * s2 + 1.0, length * (s3 - 2.0 * s2 + s), -2.0 * s3 + 3.0 * s2, length * (s3 - s2));
    (0..p0.len()).map(|k| a * p0[k] + b * m0[k] + c * p1[k] + d * m1[k]).collect()
}

fn vec4(v: &[f32]) -> Vec4 {
    match *v {
        [x, y, z, w] => Vec4::new(x, y, z, w),
        _ => Vec4::W,
    }
}

/// The rotation that `v` points to; none where it points nowhere.
pub(super) fn unit(v: Vec4) -> Quat {
    Quat::from_vec4(v.try_normalize().unwrap_or(Vec4::W))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(interpolation: Interpolation, property: Property, values: Vec<f32>, width: usize) -> Channel {
        let cubic = interpolation == Interpolation::CubicSpline;
        Channel { node: 0, property, interpolation, times: vec![1.0, 2.0, 4.0], values, width, cubic }
    }

    #[test]
    fn steps_hold_and_lines_run() {
        let of = |interpolation| channel(interpolation, Property::Weights, vec![1.0, 2.0, 3.0], 1);
        let [step, line, nearest] = [Interpolation::Step, Interpolation::Linear, Interpolation::Nearest].map(of);
        for (time, stepped, linear, near) in [
            (0.0, 1.0, 1.0, 1.0),
            (1.6, 1.0, 1.6, 2.0),
            (2.0, 2.0, 2.0, 2.0),
            (3.5, 2.0, 2.75, 3.0),
            (9.0, 3.0, 3.0, 3.0),
        ] {
            assert_eq!(step.sample(time, 0.0), [stepped]);
            assert_eq!(line.sample(time, 0.0), [linear]);
            assert_eq!(nearest.sample(time, 0.0), [near]);
        }
        assert_eq!([step.sample(1.98, 0.03), step.sample(1.98, 0.01)].concat(), [2.0, 1.0]);
    }

    #[test]
    fn rotations_take_the_short_way_at_even_speed() {
        let a = Quat::from_rotation_y(0.2);
        let b = -Quat::from_rotation_y(1.0);
        let values = [a, b, b].iter().flat_map(|q| q.to_array()).collect();
        let found = channel(Interpolation::Linear, Property::Rotation, values, 4).sample(1.25, 0.0);
        let expected = Quat::from_rotation_y(0.4);
        assert!(vec4(&found).dot(Vec4::from(expected)).abs() > 1.0 - 1e-6);
    }

    #[test]
    fn cubic_splines_reproduce_a_cubic() {
        let (f, slope) = (|t: f32| t * t * t - 2.0 * t, |t: f32| 3.0 * t * t - 2.0);
        let values = [1.0, 2.0, 4.0].iter().flat_map(|&t| [slope(t), f(t), slope(t)]).collect();
        let cubic = channel(Interpolation::CubicSpline, Property::Weights, values, 1);
        for k in 0..=30 {
            let time = 1.0 + 0.1 * k as f32;
            assert!((cubic.sample(time.into(), 0.0)[0] - f(time)).abs() < 1e-4, "{time}");
        }
    }
}
