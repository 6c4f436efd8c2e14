//! The shape of the skirt in the bind pose: a flared surface of revolution with soft folds, in coordinates of its own.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use geometry::sdf;

/// Height of the waistband above the ground, in metres.
pub const TOP: f32 = 1.062;
/// Height of the hem above the ground, in metres.
pub const HEM: f32 = 0.615;
/// Half of the cloth's thickness, in metres.
pub const HALF_THICKNESS: f32 = 0.0085;

const FOLDS: f32 = 10.0;

/// Radius of the middle of the cloth at `angle` about the vertical axis (0 is +X, a quarter turn is +Z) and height `y`.
#[must_use]
pub fn radius(angle: f32, y: f32) -> f32 {
    let down = ((TOP - y) / (TOP - HEM)).clamp(-0.1, 1.1);
    let flare = 0.58 * down + 0.42 * sdf::smoothstep(-0.05, 1.35, down);
    let (wide, deep) = (0.126 + 0.245 * flare, 0.098 + 0.245 * flare);
    let (sine, cosine) = angle.sin_cos();
    let ellipse = 1.0 / ((cosine / wide).powi(2) + (sine / deep).powi(2)).sqrt();
    let depth = 0.021 * sdf::smoothstep(0.12, 1.1, down);
    ellipse + depth * (FOLDS * angle + 0.9 * (2.0 * angle).sin()).cos()
}

/// The point of the middle surface at `angle` and height `y`.
#[must_use]
pub fn point(angle: f32, y: f32) -> Vec3 {
    let (sine, cosine) = angle.sin_cos();
    Vec3::new(cosine, 0.0, sine) * radius(angle, y) + Vec3::Y * y
}

/// Angle in [0, 2 pi) and height of the middle surface beside `p`.
#[must_use]
pub fn coordinates(p: Vec3) -> (f32, f32) {
    (p.z.atan2(p.x).rem_euclid(TAU), p.y)
}

/// Distance across the cloth from its middle surface, positive outside.
#[must_use]
pub fn across(p: Vec3) -> f32 {
    let (angle, y) = coordinates(p);
    let r = radius(angle, y);
    let step = 1e-3;
    let slope_y = (radius(angle, y + step) - r) / step;
    let slope_angle = (radius(angle + step, y) - r) / (step * r);
    (Vec2::new(p.x, p.z).length() - r) / (1.0 + slope_y * slope_y + slope_angle * slope_angle).sqrt()
}

/// Signed distance of the cloth, without what fills it at the top.
#[must_use]
pub fn cloth(p: Vec3, across: f32) -> f32 {
    let middle = 0.5 * (TOP + HEM);
    let half = Vec2::new(HALF_THICKNESS, 0.5 * (TOP - HEM));
    let sheet = sdf::rounded_box2(Vec2::new(across, p.y - middle), half, HALF_THICKNESS * 0.98);
    // The hem is rolled, which also gives it room for a row of triangles below.
    let roll = Vec2::new(across, p.y - HEM - 0.012).length() - 0.0125;
    sdf::blend(sheet, roll, 0.01)
}
