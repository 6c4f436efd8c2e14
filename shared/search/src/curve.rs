//! Curves that the actor is asked to follow: polylines and splines, by arc length.

use glam::{Vec2, Vec3, Vec3Swizzles};

/// Points of a spline's segment before it is measured.
const SPLINE_PIECES: usize = 32;
/// Distance in metres between two stored points of a curve, unless it is too long for that.
const SPACING: f64 = 0.01;
/// Metres before and after a place that its direction is taken from.
const TANGENT: f64 = 0.08;
/// Most stored points.
const MOST_POINTS: usize = 1 << 16;

/// How the points of a curve are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// By straight lines.
    #[default]
    Polyline,
    /// By a centripetal Catmull-Rom spline, which goes through all points and has no loops of its own.
    Spline,
}

/// A curve by arc length.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Points at equal distances along it, the last one at its end.
    points: Vec<Vec3>,
    /// Metres between two of them.
    spacing: f64,
    /// Its length in metres.
    length: f64,
    /// Arc length at each point that it was made from.
    knots: Vec<f64>,
    flat: bool,
}

impl Curve {
    /// The curve through `points`, at least one, finite; a straight line from `approach` to the first one goes before it.
    /// Where `flat`, lengths and distances are taken on the ground.
    #[must_use]
    pub fn new(points: &[Vec3], shape: Shape, flat: bool, approach: Option<Vec3>) -> Self {
        let flatten = |point: &Vec3| if flat { Vec3::new(point.x, 0.0, point.z) } else { *point };
        let points: Vec<Vec3> = points.iter().map(flatten).collect();
        let (mut line, mut knot_at): (_, Vec<usize>) = match shape {
            Shape::Polyline => (points.clone(), (0..points.len()).collect()),
            Shape::Spline => spline(&points),
        };
        if let Some(approach) = approach {
            line.insert(0, flatten(&approach));
            knot_at.iter_mut().for_each(|index| *index += 1);
        }
        let mut lengths = vec![0.0];
        for pair in line.windows(2) {
            let last = lengths.last().copied().unwrap_or(0.0);
            lengths.push(last + pair[0].as_dvec3().distance(pair[1].as_dvec3()));
        }
        let length = lengths.last().copied().unwrap_or(0.0);
        let pieces = ((length / SPACING).ceil() as usize).clamp(1, MOST_POINTS);
        let spacing = length / pieces as f64;
        let mut resampled = Vec::with_capacity(pieces + 1);
        let mut piece = 0;
        for index in 0..=pieces {
            let at = spacing * index as f64;
            while piece + 2 < lengths.len() && lengths[piece + 1] < at {
                piece += 1;
            }
            resampled.push(match line.get(piece + 1) {
                Some(&end) => {
                    let span = lengths[piece + 1] - lengths[piece];
                    let share = if span > 0.0 { ((at - lengths[piece]) / span).clamp(0.0, 1.0) } else { 0.0 };
                    line[piece].lerp(end, share as f32)
                }
                None => line[piece],
            });
        }
        let knots = knot_at.into_iter().map(|index| lengths[index]).collect();
        Self { points: resampled, spacing, length, knots, flat }
    }

    /// Its length in metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Whether it lies on the ground.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.flat
    }

    /// The point at an arc length in metres; its ends beyond them.
    #[must_use]
    pub fn at(&self, length: f64) -> Vec3 {
        if self.spacing <= 0.0 {
            return self.points[0];
        }
        let place = (length / self.spacing).clamp(0.0, (self.points.len() - 1) as f64);
        let index = (place as usize).min(self.points.len() - 2);
        self.points[index].lerp(self.points[index + 1], (place - index as f64) as f32)
    }

    /// Arc length at a parameter that counts the points it was made from: 1.5 is between the second and the third.
    #[must_use]
    pub fn length_at_knot(&self, parameter: f64) -> f64 {
        let place = parameter.clamp(0.0, (self.knots.len() - 1) as f64);
        let index = place as usize;
        match self.knots.get(index + 1) {
            Some(next) => self.knots[index] + (next - self.knots[index]) * (place - index as f64),
            None => self.length,
        }
    }

    /// Distance in metres from `point` to the curve at an arc length.
    #[must_use]
    pub fn distance(&self, point: Vec3, length: f64) -> f64 {
        self.gap(point, self.at(length))
    }

    /// Distance in metres from `point` to the nearest stored point of the curve within two metres of an arc length.
    #[must_use]
    pub fn nearest(&self, point: Vec3, length: f64) -> f64 {
        let index = |length: f64| if self.spacing > 0.0 { (length / self.spacing).max(0.0) as usize } else { 0 };
        let last = self.points.len() - 1;
        let window = index(length - 2.0).min(last)..=index(length + 2.0).min(last);
        self.points[window].iter().map(|&other| self.gap(point, other)).fold(f64::INFINITY, f64::min)
    }

    /// The arc length, between `from` and `to`, of the stored point that is nearest to `place` on the ground.
    #[must_use]
    pub(super) fn nearest_length(&self, place: Vec2, from: f64, to: f64) -> f64 {
        if self.spacing <= 0.0 {
            return 0.0;
        }
        let last = self.points.len() - 1;
        let index = |length: f64| ((length / self.spacing).max(0.0) as usize).min(last);
        let (first, end) = (index(from), index(to));
        let (mut nearest, mut least) = (first, f32::INFINITY);
        for (index, point) in (first..).zip(&self.points[first..=end.max(first)]) {
            let away = point.xz().distance_squared(place);
            if away < least {
                (nearest, least) = (index, away);
            }
        }
        (nearest as f64 * self.spacing).clamp(from, to)
    }

    fn gap(&self, point: Vec3, other: Vec3) -> f64 {
        f64::from(if self.flat { point.xz().distance(other.xz()) } else { point.distance(other) })
    }

    /// Which way it leads at an arc length: a unit vector along (X, Z), taken from some centimetres before and after.
    #[must_use]
    pub fn direction(&self, length: f64) -> Vec2 {
        (self.at(length + TANGENT) - self.at(length - TANGENT)).xz().normalize_or(Vec2::Y)
    }

    /// The direction in which it begins: heading in radians about +Y from +Z, over its first tenth of a metre.
    #[must_use]
    pub fn first_heading(&self) -> f32 {
        let step = (self.at(0.1) - self.at(0.0)).xz();
        if step.length() > 1e-6 { super::ground_pose::angle(step.x, step.y) } else { 0.0 }
    }

    /// Its points about `spacing` metres apart, for drawing.
    #[must_use]
    pub fn polyline(&self, spacing: f64) -> Vec<Vec3> {
        let pieces = ((self.length / spacing.max(0.001)).ceil() as usize).clamp(1, 4096);
        (0..=pieces).map(|index| self.at(self.length * index as f64 / pieces as f64)).collect()
    }
}

/// Points along a centripetal Catmull-Rom spline, and which of them are the points given.
///
/// This work is based on: Barry and Goldman, A recursive evaluation algorithm for a class of Catmull-Rom splines (1988).
fn spline(points: &[Vec3]) -> (Vec<Vec3>, Vec<usize>) {
    let mut kept: Vec<Vec3> = Vec::new();
    let mut place = Vec::new();
    for &point in points {
        if kept.last().is_none_or(|last| last.distance(point) > 1e-6) {
            kept.push(point);
        }
        place.push(kept.len() - 1);
    }
    let count = kept.len();
    if count < 3 {
        return (kept, place);
    }
    // Ends are continued by reflection.
    let at = |index: isize| match index {
        -1 => 2.0 * kept[0] - kept[1],
        _ if index as usize == count => 2.0 * kept[count - 1] - kept[count - 2],
        _ => kept[index as usize],
    };
    let mut line = vec![kept[0]];
    for segment in 0..count as isize - 1 {
        let p = [at(segment - 1), at(segment), at(segment + 1), at(segment + 2)];
        for piece in 1..=SPLINE_PIECES {
            line.push(catmull_rom(p, piece as f32 / SPLINE_PIECES as f32));
        }
    }
    (line, place.into_iter().map(|index| index * SPLINE_PIECES).collect())
}

/// The point at `u`, from 0 to 1, between the middle two of four points.
fn catmull_rom(p: [Vec3; 4], u: f32) -> Vec3 {
    let mut t = [0.0_f32; 4];
    for index in 1..4 {
        t[index] = t[index - 1] + p[index].distance(p[index - 1]).sqrt();
    }
    let at = t[1] + (t[2] - t[1]) * u;
    let mix = |a: Vec3, b: Vec3, from: f32, to: f32| a + (b - a) * ((at - from) / (to - from));
    let a = [mix(p[0], p[1], t[0], t[1]), mix(p[1], p[2], t[1], t[2]), mix(p[2], p[3], t[2], t[3])];
    let b = [mix(a[0], a[1], t[0], t[2]), mix(a[1], a[2], t[1], t[3])];
    mix(b[0], b[1], t[1], t[2])
}
