//! What the surface looks like: a colour for every point of the figure in the bind pose.
//!
//! Colours depend on the place in space, not on the texture, so seams cannot be seen and a slid point keeps its colour.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::body::{Body, HEAD_SCALE, TOP_OF_TRUNKS};
use super::build::Dress;
use super::skeleton::joint;
use super::skirt;
use geometry::mesh::Mesh;
use geometry::sdf::smoothstep;
use kernels::random::{noise1, noise4};

const SKIN: Vec3 = Vec3::new(0.93, 0.735, 0.615);
const HAIR: Vec3 = Vec3::new(0.235, 0.125, 0.09);
const CREAM: Vec3 = Vec3::new(0.955, 0.93, 0.87);
const NAVY: Vec3 = Vec3::new(0.13, 0.19, 0.34);
const CORAL: Vec3 = Vec3::new(0.875, 0.345, 0.285);
const WHITE: Vec3 = Vec3::new(0.965, 0.955, 0.94);
const TEAL: Vec3 = Vec3::new(0.11, 0.5, 0.5);
const LINING: Vec3 = Vec3::new(0.66, 0.235, 0.21);
const DARK: Vec3 = Vec3::new(0.115, 0.075, 0.07);

/// Half of the width over which painted edges are smoothed, in metres: about a texel.
const EDGE: f32 = 0.0011;

/// The painted colour in sRGB, 0 to 1, of the point `p` of the surface in the bind pose, without any light.
#[must_use]
pub fn colour(body: &Body, p: Vec3) -> Vec3 {
    let f = body.fields(p);
    let side = usize::from(p.x < 0.0);
    let parts = [
        (f.head, 0),
        (f.hair, 1),
        (f.tail, 2),
        (f.shirt, 3),
        (f.arms[side], 4),
        (f.legs[side], 5),
        (f.shoes[side], 6),
        (f.skirt, 7),
    ];
    match parts.iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |part| part.1) {
        0 => head(body.to_joint(p, joint::HEAD) / HEAD_SCALE),
        1 => hair(body.to_joint(p, joint::HEAD) / HEAD_SCALE),
        2 => tail(body, p),
        3 => shirt(body, p, side),
        4 => arm(body, p, side),
        5 => leg(body, p, side),
        6 => shoe(body.to_joint(p, joint::LEG[side] + 2)),
        _ if body.dress() != Dress::Skirt => trousers(body, p),
        _ => skirt_colour(p),
    }
}

/// How light each vertex is in the soft light of a studio: occlusion, and light that comes more from above.
#[must_use]
pub fn shading(body: &Body, mesh: &Mesh) -> Vec<f32> {
    use rayon::prelude::*;
    let normals = mesh.normals();
    mesh.positions
        .par_iter()
        .zip(&normals)
        .map(|(&p, &normal)| {
            // The distance should grow as fast as one goes away from the surface; where it does not, something is near.
            let mut occlusion = 0.0;
            for (step, share) in [(0.02, 0.34), (0.045, 0.28), (0.09, 0.22), (0.16, 0.16)] {
                occlusion += share * (1.0 - body.distance(p + normal * step) / step).clamp(0.0, 1.0);
            }
            let sky = 0.5 + 0.5 * normal.y;
            (1.0 - 0.62 * occlusion) * (0.8 + 0.2 * sky) + 0.03 * normal.z.max(0.0)
        })
        .collect()
}

fn mix(a: Vec3, b: Vec3, share: f32) -> Vec3 {
    a + (b - a) * share.clamp(0.0, 1.0)
}

/// 1 inside of a region given by its signed distance, smoothed at the edge.
fn within(distance: f32) -> f32 {
    smoothstep(EDGE, -EDGE, distance)
}

/// 1 on stripes of `width` that come every `period` along `x`.
fn stripes(x: f32, period: f32, width: f32) -> f32 {
    let from_middle = (x / period - (x / period).round()).abs() * period;
    within(from_middle - 0.5 * width)
}

fn ellipse(q: Vec2, centre: Vec2, radii: Vec2) -> f32 {
    let d = (q - centre) / radii;
    (d.length() - 1.0) * radii.min_element()
}

/// Distance to the curve y = height + bend * (x / half)^2 for |x| < half, minus half of its width, which tapers.
fn stroke(q: Vec2, half: f32, bend: f32, width: f32) -> f32 {
    let x = (q.x / half).clamp(-1.0, 1.0);
    let outside = (q.x.abs() - half).max(0.0);
    let taper = 1.0 - 0.75 * x * x;
    Vec2::new(outside, q.y - bend * x * x).length() - 0.5 * width * taper
}

fn skin(p: Vec3) -> Vec3 {
    SKIN * (1.0 + 0.012 * noise4(11, p * 45.0, 0.0))
}

/// Size of the painted eyes, against those of an adult.
const EYE: f32 = 1.18;

/// The face, in the frame of the head joint at natural size.
fn head(p: Vec3) -> Vec3 {
    let mut colour = skin(p);
    if p.z < 0.02 {
        return colour;
    }
    let q = Vec2::new(p.x, p.y);
    let near = Vec2::new(p.x.abs(), p.y);
    let side = p.x.signum();
    // Blush on cheeks and nose.
    let blush = (-((near - Vec2::new(0.05, 0.073)) / Vec2::new(0.021, 0.015)).length_squared()).exp();
    let tip = (-((q - Vec2::new(0.0, 0.08)) / Vec2::new(0.013, 0.01)).length_squared()).exp();
    colour = mix(colour, Vec3::new(0.93, 0.5, 0.43), 0.36 * blush + 0.2 * tip);
    // Eyes: white, iris, pupil, lid line and a light.
    let eye = (near - Vec2::new(0.0395, 0.1085)) / EYE;
    let white = ellipse(eye, Vec2::ZERO, Vec2::new(0.0172, 0.0158));
    let socket = ellipse(eye, Vec2::new(0.0, 0.002), Vec2::new(0.024, 0.021));
    colour = mix(colour, Vec3::new(0.8, 0.56, 0.46), 0.4 * smoothstep(0.006, -0.004, socket));
    colour = mix(colour, WHITE, within(white));
    let iris = Vec2::new(eye.x + 0.0006 * side, eye.y);
    let inside = within(white);
    colour = mix(colour, Vec3::new(0.2, 0.33, 0.3), inside * within(iris.length() - 0.0108));
    colour =
        mix(colour, Vec3::new(0.33, 0.5, 0.43), inside * within((iris - Vec2::new(0.0, -0.003)).length() - 0.0068));
    colour = mix(colour, DARK, inside * within(iris.length() - 0.0058));
    let spark = (Vec2::new(p.x, p.y) - Vec2::new(side * 0.0395 + 0.0045, 0.1142)) / EYE;
    colour = mix(colour, Vec3::ONE, within(spark.length() - 0.0029));
    colour = mix(colour, Vec3::new(0.6, 0.5, 0.48), inside * 0.5 * smoothstep(0.006, 0.015, eye.y));
    let lash = (white.abs() - 0.0014).max(-eye.y + 0.001 - 0.12 * eye.x);
    let wing = stroke(eye - Vec2::new(0.0165, 0.0055), 0.0055, 0.003, 0.003);
    colour = mix(colour, DARK, within(lash.min(wing)));
    // Brows.
    let brow = eye - Vec2::new(0.002, 0.0265);
    let brow = stroke(Vec2::new(brow.x, brow.y + 0.1 * brow.x), 0.019, -0.0062, 0.0055);
    colour = mix(colour, HAIR, 0.92 * within(brow));
    // Nostrils and mouth.
    let nostril = ellipse(near, Vec2::new(0.0058, 0.0715), Vec2::new(0.0024, 0.0014));
    colour = mix(colour, Vec3::new(0.66, 0.4, 0.33), 0.7 * within(nostril));
    let mouth = q - Vec2::new(0.0, 0.0445);
    let upper = stroke(mouth - Vec2::new(0.0, 0.0026), 0.021, 0.006, 0.0056);
    let lower = stroke(mouth + Vec2::new(0.0, 0.0026), 0.0175, 0.0072, 0.0074);
    colour = mix(colour, Vec3::new(0.8, 0.37, 0.35), 0.9 * within(upper.min(lower)));
    let line = stroke(mouth, 0.0232, 0.0068, 0.0023);
    colour = mix(colour, Vec3::new(0.45, 0.16, 0.15), within(line));
    colour
}

/// Strands, darker towards the parting.
fn hair(p: Vec3) -> Vec3 {
    // Combed back to the tie.
    let tie = Vec3::new(0.0, 0.18, -0.118);
    let axis = (Vec3::new(0.01, 0.07, 0.1) - tie).normalize_or(Vec3::Z);
    let from_tie = p - tie;
    let angle = from_tie.x.atan2(from_tie.dot(axis.cross(Vec3::NEG_X)));
    let strand = noise1(21, angle * 24.0) * 0.5 + noise1(22, angle * 71.0) * 0.5;
    let gloss = (-((p.y - 0.19 - 0.02 * noise1(23, angle * 9.0)) / 0.018).powi(2)).exp() * smoothstep(-0.09, 0.0, p.z);
    HAIR * (1.0 + 0.2 * strand) + Vec3::new(0.2, 0.12, 0.08) * gloss * (0.55 + 0.3 * strand)
}

fn tail(body: &Body, p: Vec3) -> Vec3 {
    let root = body.bind()[joint::TAIL].translation;
    if p.distance(root) < 0.043 {
        return TEAL * (0.94 + 0.1 * (p.y * 900.0).sin());
    }
    let local = p - root;
    let strand = noise1(24, local.x * 190.0 + 3.0 * local.y) * 0.6 + noise1(25, (local.z + local.y) * 150.0) * 0.4;
    let gloss = (-((p.y - root.y + 0.07) / 0.03).powi(2)).exp() * 0.5;
    HAIR * (1.0 + 0.22 * strand) + Vec3::new(0.2, 0.12, 0.08) * gloss * (0.5 + 0.5 * strand)
}

fn shirt(body: &Body, p: Vec3, side: usize) -> Vec3 {
    let shoulder = body.bind()[joint::ARM[side] + 1].translation;
    let elbow = body.bind()[joint::ARM[side] + 2].translation;
    let along = (p - shoulder).dot((elbow - shoulder).normalize_or(Vec3::NEG_Y));
    let weave = 1.0 + 0.02 * noise4(31, p * 300.0, 0.0);
    // The sleeve begins at a seam around the shoulder.
    let seam = p.x.abs() - 0.158 - 0.3 * (1.38 - p.y);
    let sleeve = seam > 0.0;
    let band = if sleeve { stripes(along - 0.012, 0.036, 0.015) } else { stripes(p.y - 1.06, 0.036, 0.015) };
    let mut colour = mix(CREAM, NAVY, band);
    if !sleeve && p.y > 1.372 {
        // The yoke is plain.
        colour = mix(colour, CREAM, smoothstep(1.372, 1.376, p.y));
    }
    colour = mix(colour, CREAM * 0.84, 0.8 * within(seam.abs() - 0.0011));
    let cuff = along - 0.6 * shoulder.distance(elbow);
    if sleeve {
        colour = mix(colour, NAVY, within(-(cuff + 0.013)));
    }
    let collar = (p.y - 1.452) * 0.93 + (p.z + 0.01) * 0.36;
    let from_neck = Vec2::new(p.x, 0.9 * (p.z + 0.02)).length();
    colour = mix(colour, NAVY, within((-(collar + 0.012)).max(from_neck - 0.085)));
    colour * weave
}

fn arm(body: &Body, p: Vec3, side: usize) -> Vec3 {
    let q = body.to_joint(p, joint::ARM[side] + 3);
    let colour = skin(p);
    // Warmer fingertips, and lines between the fingers.
    let inward = if side == 0 { q.x } else { -q.x };
    let warm = smoothstep(-0.12, -0.17, q.y);
    let colour = mix(colour, Vec3::new(0.93, 0.6, 0.5), 0.3 * warm);
    let gap = [0.0175, -0.0005, -0.018].iter().map(|z| (q.z - z).abs() - 0.0011).fold(f32::INFINITY, f32::min);
    let lines =
        smoothstep(-0.086, -0.094, q.y) * smoothstep(0.036, 0.03, q.z) * (1.0 - smoothstep(0.02, 0.03, inward.abs()));
    let colour = mix(colour, Vec3::new(0.72, 0.47, 0.38), 0.62 * lines * within(gap));
    // A thin bracelet on the left wrist.
    if side == 0 { mix(colour, TEAL, within((q.y - 0.012).abs() - 0.0055)) } else { colour }
}

fn leg(body: &Body, p: Vec3, side: usize) -> Vec3 {
    let knee = body.bind()[joint::LEG[side] + 1].translation;
    let ankle = body.bind()[joint::LEG[side] + 2].translation;
    let up = (p - ankle).dot((knee - ankle).normalize_or(Vec3::Y));
    let top = 0.2 * knee.distance(ankle) + 0.002;
    let mut colour = skin(p);
    let thigh = knee.distance(body.bind()[joint::LEG[side]].translation);
    let covered = match body.dress() {
        Dress::Skirt => false,
        Dress::Trousers => up > 0.06 * knee.distance(ankle) - 0.008,
        Dress::Shorts => up > knee.distance(ankle) + 0.1 * thigh - 0.008,
    };
    if covered {
        return trousers(body, p);
    }
    if p.y > 0.74 {
        // Short leggings under the skirt.
        colour = mix(colour, NAVY * 0.9, smoothstep(0.741, 0.743, p.y));
    }
    let warm = (-((p - knee - Vec3::new(0.0, 0.0, 0.05)) / 0.035).length_squared()).exp();
    colour = mix(colour, Vec3::new(0.93, 0.58, 0.48), 0.25 * warm);
    let sock = mix(CREAM, TEAL, stripes(up - top + 0.02, 0.05, 0.009) * smoothstep(top - 0.05, top - 0.045, up));
    let knit = 1.0 + 0.03 * (up * 1100.0).sin();
    mix(colour, sock * knit, within(up - top))
}

/// A canvas shoe in the frame of its joint.
fn shoe(q: Vec3) -> Vec3 {
    let mut colour = CORAL * 0.97 * (1.0 + 0.02 * noise4(41, q * 300.0, 0.0));
    let toe = ((q.z - 0.146).powi(2) + (q.x * 0.9).powi(2)).sqrt() - 0.047;
    colour = mix(colour, WHITE * 0.98, within(toe));
    // Tongue and laces.
    let tongue = (q.x.abs() - 0.02).max(0.055 - q.z).max(q.z - 0.1).max(-0.032 - q.y);
    if q.y > -0.05 {
        let lace = stripes(q.z - 0.062, 0.0175, 0.0075);
        let over = within((q.x.abs() - 0.025).max(0.03 - q.z).max(q.z - 0.098));
        colour = mix(colour, CREAM * 0.9, within(tongue) * 0.6);
        colour = mix(colour, WHITE, over * lace);
    }
    // The rim around the ankle.
    colour = mix(colour, WHITE, within(-0.004 - q.y));
    let sole = within(q.y + 0.056);
    colour = mix(colour, WHITE * 0.97, sole);
    colour = mix(colour, NAVY, within((q.y + 0.0625).abs() - 0.0022));
    mix(colour, Vec3::new(0.64, 0.6, 0.54), within(q.y + 0.0815))
}

fn trousers(body: &Body, p: Vec3) -> Vec3 {
    let weave = 1.0 + 0.025 * noise4(52, p * 280.0, 0.0);
    let cloth = if body.dress() == Dress::Shorts { TEAL } else { NAVY * 0.9 + Vec3::splat(0.05) };
    let belt = within((p.y - TOP_OF_TRUNKS + 0.02).abs() - 0.014);
    let seam = within((p.z + 0.004).abs() - 0.0016) * smoothstep(0.1, 0.12, p.x.abs());
    mix(mix(cloth, cloth * 0.72, seam), DARK * 1.6, belt) * weave
}

fn skirt_colour(p: Vec3) -> Vec3 {
    let across = skirt::across(p);
    let weave = 1.0 + 0.02 * noise4(51, p * 260.0, 0.0);
    if across < -0.0035 && p.y < 0.97 {
        return LINING * weave;
    }
    let (angle, y) = skirt::coordinates(p);
    if y > skirt::TOP - 0.037 {
        return mix(NAVY, TEAL, within((y - skirt::TOP + 0.02).abs() - 0.003)) * weave;
    }
    // Dots in staggered rows that keep their number around, and grow with the flare.
    let rows = (skirt::TOP - y - 0.055) / 0.047;
    let row = rows.round();
    let count = 26.0;
    let turn = angle / TAU * count + 0.5 * (row.rem_euclid(2.0));
    let width = skirt::radius(angle, y) * TAU / count;
    let dot = Vec2::new((turn - turn.round()) * width, (rows - row) * 0.047);
    let size = 0.0058 + 0.006 * smoothstep(0.0, 8.0, row);
    let mut colour = CORAL;
    if (-0.5..8.4).contains(&rows) {
        colour = mix(colour, CREAM, within(dot.length() - size));
    }
    let from_hem = y - skirt::HEM;
    colour = mix(colour, CREAM, within((from_hem - 0.03).abs() - 0.005));
    colour = mix(colour, NAVY, within(from_hem - 0.016));
    colour * weave
}
