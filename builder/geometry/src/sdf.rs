//! Signed distances of simple solids, and ways to join them. Negative inside.
//!
//! This work follows Inigo Quilez, "Distance functions" (2008); some distances are bounds rather than exact, which the
//! polygoniser and the projection tolerate.

use glam::{Vec2, Vec3};

/// A capsule from `a` to `b` whose radius goes linearly from `ra` to `rb`.
#[must_use]
pub fn cone(p: Vec3, a: Vec3, b: Vec3, ra: f32, rb: f32) -> f32 {
    let axis = b - a;
    let t = ((p - a).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
    (p - a - axis * t).length() - (ra + (rb - ra) * t)
}

/// An ellipsoid about `centre` with half axes `radii` along the coordinate axes.
#[must_use]
pub fn ellipsoid(p: Vec3, centre: Vec3, radii: Vec3) -> f32 {
    let q = p - centre;
    let k0 = (q / radii).length();
    let k1 = (q / (radii * radii)).length();
    if k1 < 1e-6 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
}

/// The union, with a fillet of about `k` metres where the solids meet.
#[must_use]
pub fn blend(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k * 0.25
}

/// The intersection, with edges rounded over about `k` metres.
#[must_use]
pub fn clip(a: f32, b: f32, k: f32) -> f32 {
    -blend(-a, -b, k)
}

/// A two-dimensional box of half size `half`, with corners rounded by `radius`, about the origin of `q`.
#[must_use]
pub fn rounded_box2(q: Vec2, half: Vec2, radius: f32) -> f32 {
    let outside = q.abs() - half + Vec2::splat(radius);
    outside.max(Vec2::ZERO).length() + outside.max_element().min(0.0) - radius
}

/// Hermite interpolation from 0 at `from` to 1 at `to`, clamped.
#[must_use]
pub fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
