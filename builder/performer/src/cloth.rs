//! The skirt: a grid of points moved by position-based dynamics, and the vertices of the surface that ride on it.
//!
//! This work is based on: M. Müller et al., "Position based dynamics", 2007, with one iteration in each of many small
//! steps (M. Macklin et al., "Small steps in physics simulation", 2019). A petticoat is assumed below the cloth: weak
//! springs pull it towards its modelled flare, so it swings, lags and settles instead of hanging like a towel.

use std::f32::consts::TAU;

use glam::{Mat3, Quat, Vec3};

use super::body::Body;
use super::build::Dress;
use super::skeleton::{JOINT_COUNT, NEUTRAL, joint};
use super::skirt;
use geometry::mesh::Mesh;
use geometry::sdf::smoothstep;
use rig::Rigid;
use rig::{Influences, Skin, diffuse};

const COLUMNS: usize = 60;
const ROWS: usize = 13;
const COUNT: usize = COLUMNS * ROWS;
/// Rows at the top that move with the skin.
const PINNED: usize = 2;
/// Steps a frame at 50 frames per second.
const STEPS: usize = 10;
/// How far the middle of the cloth keeps from the skin of a leg.
const CLEARANCE: f32 = 0.019;

/// A distance to keep between two points.
#[derive(Clone, Copy, Debug)]
struct Link {
    a: u32,
    b: u32,
    length: f32,
    /// Part of the error that a step removes.
    stiffness: f32,
}

/// A vertex of the surface on the grid.
#[derive(Clone, Copy, Debug)]
struct Rider {
    vertex: u32,
    /// Column and row, with fractions.
    place: (f32, f32),
    /// Offset from the grid's surface in its frame (along the row, down the column, outwards).
    offset: Vec3,
    /// 1 where the grid alone moves the vertex, 0 where the skin does.
    weight: f32,
}

/// What the skirts of all frames have in common.
#[derive(Clone, Debug)]
pub struct Skirt {
    rest: Vec<Vec3>,
    links: Vec<Link>,
    pins: Vec<Influences>,
    riders: Vec<Rider>,
}

/// State of the moving skirt; carry it from frame to frame.
#[derive(Clone, Debug)]
pub struct MovingSkirt {
    points: Vec<Vec3>,
    previous: Vec<Vec3>,
    /// Where the petticoat pulled in the step before.
    wanted: Vec<Vec3>,
    world: [Rigid; JOINT_COUNT],
}

fn index(column: usize, row: usize) -> usize {
    row * COLUMNS + column % COLUMNS
}

impl Skirt {
    /// The skirt of `mesh`, which is the figure in the bind pose with skin weights `influences`.
    #[must_use]
    pub fn new(body: &Body, mesh: &Mesh, influences: &[Influences]) -> Self {
        let mut rest = Vec::with_capacity(COUNT);
        for row in 0..ROWS {
            let y = skirt::TOP + (skirt::HEM - skirt::TOP) * row as f32 / (ROWS - 1) as f32;
            rest.extend((0..COLUMNS).map(|column| skirt::point(column as f32 / COLUMNS as f32 * TAU, y)));
        }
        let links = links(&rest);
        let pins = rest[..PINNED * COLUMNS]
            .iter()
            .map(|point| {
                let distance = |v: usize| mesh.positions[v].distance_squared(*point);
                let nearest = (0..mesh.positions.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
                nearest.map(|v| influences[v]).unwrap_or_default()
            })
            .collect();
        let worn = body.dress() == Dress::Skirt;
        let riders = if worn { riders(body, mesh, &rest) } else { Vec::new() };
        Self { rest, links, pins, riders }
    }

    /// Share of each vertex of the surface that the cloth moves, 0 to 1.
    #[must_use]
    pub fn shares(&self, vertex_count: usize) -> Vec<f32> {
        let mut shares = vec![0.0; vertex_count];
        for rider in &self.riders {
            shares[rider.vertex as usize] = rider.weight;
        }
        shares
    }

    /// The skirt at rest on the body `world`.
    #[must_use]
    pub fn start(&self, world: &[Rigid; JOINT_COUNT]) -> MovingSkirt {
        let points = self.wanted(world);
        MovingSkirt { previous: points.clone(), wanted: points.clone(), points, world: *world }
    }

    /// Moves the skirt on by `seconds` to the body `world`.
    pub fn advance(&self, body: &Body, moving: &mut MovingSkirt, world: &[Rigid; JOINT_COUNT], seconds: f32) {
        if self.riders.is_empty() {
            return;
        }
        let steps = ((seconds * 50.0 * STEPS as f32).round() as usize).max(1);
        let dt = seconds / steps as f32;
        let from = moving.world;
        for step in 1..=steps {
            let share = step as f32 / steps as f32;
            let now = std::array::from_fn(|k| Rigid {
                rotation: from[k].rotation.slerp(world[k].rotation, share),
                translation: from[k].translation.lerp(world[k].translation, share),
            });
            self.step(body, moving, &now, dt);
        }
        moving.world = *world;
    }

    /// Moves the skirt's vertices of `positions`, which holds the skinned surface, to the cloth.
    pub fn apply(&self, moving: &MovingSkirt, positions: &mut [Vec3]) {
        for rider in &self.riders {
            let (at, frame) = sample(&moving.points, rider.place);
            let position = &mut positions[rider.vertex as usize];
            *position = position.lerp(at + frame * rider.offset, rider.weight);
        }
    }

    /// Where the petticoat pulls the cloth: its modelled shape on the pelvis, more upright towards the hem.
    fn wanted(&self, world: &[Rigid; JOINT_COUNT]) -> Vec<Vec3> {
        let pelvis = world[joint::PELVIS];
        let forward = pelvis.rotation * Vec3::Z;
        let upright = Quat::from_rotation_y(forward.x.atan2(forward.z));
        let hanging = upright.slerp(pelvis.rotation, 0.45);
        let centre = NEUTRAL[joint::PELVIS];
        let of_row = |row: usize| {
            let down = row as f32 / (ROWS - 1) as f32;
            Mat3::from_quat(pelvis.rotation.slerp(hanging, smoothstep(0.1, 0.6, down)))
        };
        let rotations: [Mat3; ROWS] = std::array::from_fn(of_row);
        let rest = self.rest.iter().enumerate();
        rest.map(|(k, &point)| pelvis.translation + rotations[k / COLUMNS] * (point - centre)).collect()
    }

    fn step(&self, body: &Body, moving: &mut MovingSkirt, world: &[Rigid; JOINT_COUNT], dt: f32) {
        let wanted = self.wanted(world);
        let skin = Skin::new(body.bind_inverse(), world);
        let pinned = PINNED * COLUMNS;
        let before = moving.points.clone();
        for k in pinned..COUNT {
            let row = (k / COLUMNS) as f32 / (ROWS - 1) as f32;
            let velocity = (moving.points[k] - moving.previous[k]) / dt;
            let pull = 60.0 + 900.0 * (1.0 - smoothstep(0.05, 0.5, row));
            // The petticoat carries most of the cloth's weight, and slows it against itself; the air slows the hem.
            let carried = velocity - (wanted[k] - moving.wanted[k]) / dt;
            let drag = carried * (3.4 + 22.0 * (1.0 - row).powi(2)) + velocity * 1.1 * row;
            let acceleration = (wanted[k] - moving.points[k]) * pull + Vec3::NEG_Y * 1.6 - drag;
            moving.points[k] += (velocity + acceleration * dt) * dt;
        }
        for k in 0..pinned {
            moving.points[k] = skin.motion(&self.pins[k]).apply(self.rest[k]);
        }
        for link in &self.links {
            let (a, b) = (link.a as usize, link.b as usize);
            let (wa, wb) = (if a < pinned { 0.0 } else { 1.0 }, if b < pinned { 0.0 } else { 1.0 });
            let apart = moving.points[b] - moving.points[a];
            let length = apart.length().max(1e-6);
            let move_by = apart * (link.stiffness * (length - link.length) / (length * f32::max(wa + wb, 1.0)));
            moving.points[a] += move_by * wa;
            moving.points[b] -= move_by * wb;
        }
        collide(&mut moving.points[pinned..], &before[pinned..], world);
        moving.previous = before;
        moving.wanted = wanted;
    }
}

/// Pushes points out of the legs, with a little friction.
fn collide(points: &mut [Vec3], before: &[Vec3], world: &[Rigid; JOINT_COUNT]) {
    for first in joint::LEG {
        let (hip, knee, ankle) = (world[first].translation, world[first + 1].translation, world[first + 2].translation);
        let capsules =
            [(hip, knee, 0.08 + CLEARANCE, 0.058 + CLEARANCE), (knee, ankle, 0.058 + CLEARANCE, 0.05 + CLEARANCE)];
        for (start, end, r0, r1) in capsules {
            let axis = end - start;
            let squared = axis.length_squared();
            for (point, old) in points.iter_mut().zip(before) {
                let t = ((*point - start).dot(axis) / squared).clamp(0.0, 1.0);
                let away = *point - start - axis * t;
                let (distance, radius) = (away.length(), r0 + (r1 - r0) * t);
                if distance < radius {
                    *point += away * ((radius - distance) / distance.max(1e-4));
                    *point = point.lerp(*old, 0.04);
                }
            }
        }
    }
}

fn links(rest: &[Vec3]) -> Vec<Link> {
    let mut links = Vec::new();
    let mut link = |a: usize, b: usize, stiffness: f32| {
        links.push(Link { a: a as u32, b: b as u32, length: rest[a].distance(rest[b]), stiffness });
    };
    for row in 1..ROWS {
        for column in 0..COLUMNS {
            let here = index(column, row);
            link(index(column, row - 1), here, 0.9);
            link(here, index(column + 1, row), 0.8);
            link(index(column, row - 1), index(column + 1, row), 0.12);
            link(index(column + 1, row - 1), here, 0.12);
            link(here, index(column + 2, row), 0.02);
            if row >= 2 {
                link(index(column, row - 2), here, 0.03);
            }
        }
    }
    links
}

/// Catmull-Rom weights of four neighbouring knots at fraction `t` between the middle two, and their derivatives.
fn spline(t: f32) -> ([f32; 4], [f32; 4]) {
    let (t2, t3) = (t * t, t * t * t);
    let values = [
        0.5 * (-t3 + 2.0 * t2 - t),
        0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
        0.5 * (-3.0 * t3 + 4.0 * t2 + t),
        0.5 * (t3 - t2),
    ];
    let slopes = [
        0.5 * (-3.0 * t2 + 4.0 * t - 1.0),
        0.5 * (9.0 * t2 - 10.0 * t),
        0.5 * (-9.0 * t2 + 8.0 * t + 1.0),
        0.5 * (3.0 * t2 - 2.0 * t),
    ];
    (values, slopes)
}

/// Position and frame (along the row, down the column, outwards) of the grid's smooth surface.
fn sample(points: &[Vec3], place: (f32, f32)) -> (Vec3, Mat3) {
    let column = place.0.floor();
    let row = place.1.floor().clamp(0.0, (ROWS - 2) as f32);
    let (across, across_slope) = spline(place.0 - column);
    let (down, down_slope) = spline(place.1 - row);
    let (mut at, mut along, mut downwards) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    for j in 0..4 {
        let wanted = row as i64 + j as i64 - 1;
        // Rows beyond the ends continue in a straight line.
        let knot = |column: usize| {
            let get = |row: i64| points[index(column, row as usize)];
            let last = ROWS as i64 - 1;
            match wanted {
                w if w < 0 => get(0) * 2.0 - get(1),
                w if w > last => get(last) * 2.0 - get(last - 1),
                w => get(w),
            }
        };
        for i in 0..4 {
            let point = knot((column as i64 + i as i64 - 1).rem_euclid(COLUMNS as i64) as usize);
            at += point * (across[i] * down[j]);
            along += point * (across_slope[i] * down[j]);
            downwards += point * (across[i] * down_slope[j]);
        }
    }
    let outwards = along.cross(downwards).normalize_or(Vec3::X) * -1.0;
    let along = along.normalize_or(Vec3::Z);
    (at, Mat3::from_cols(along, along.cross(outwards), outwards))
}

fn riders(body: &Body, mesh: &Mesh, rest: &[Vec3]) -> Vec<Rider> {
    let shares: Vec<f32> = mesh.positions.iter().map(|&p| share(body, p)).collect();
    let softened = diffuse(mesh, &mesh.neighbours(), &shares, 0.012);
    let mut riders = Vec::new();
    for (vertex, &p) in mesh.positions.iter().enumerate() {
        // Soft where the cloth meets the leg, exact elsewhere.
        let weight = if shares[vertex] > 0.98 { 1.0 } else { 0.5 * (shares[vertex] + softened[vertex]) };
        if weight < 0.02 {
            continue;
        }
        let (angle, y) = skirt::coordinates(p);
        let place = (angle / TAU * COLUMNS as f32, (skirt::TOP - y) / (skirt::TOP - skirt::HEM) * (ROWS - 1) as f32);
        let (at, frame) = sample(rest, place);
        riders.push(Rider {
            vertex: vertex as u32,
            place,
            offset: frame.transpose() * (p - at),
            weight: weight.min(1.0),
        });
    }
    riders
}

/// How much of a vertex at `p` of the bind pose the cloth moves.
fn share(body: &Body, p: Vec3) -> f32 {
    let across = skirt::across(p);
    let fields = body.fields(p);
    let leg = fields.legs[0].min(fields.legs[1]);
    let below_band = smoothstep(skirt::TOP - 0.015, skirt::TOP - 0.075, p.y);
    if p.y < skirt::HEM - 0.03 || fields.skirt > 0.02 {
        return 0.0;
    }
    if across > -0.002 || skirt::cloth(p, across).abs() < 0.003 {
        return below_band;
    }
    // The ceiling between the legs and the cloth goes with whichever is nearer.
    let from_leg = leg.max(0.0);
    smoothstep(0.1, 0.75, from_leg / (from_leg - across).max(1e-4)) * below_band
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_at_rest_keeps_its_skirt() {
        let body = Body::default();
        let mesh = Mesh { positions: vec![Vec3::Y, Vec3::X, Vec3::Z], triangles: vec![[0, 1, 2]] };
        let skirt = Skirt::new(&body, &mesh, &[Influences { joints: [0; 4], weights: [1.0, 0.0, 0.0, 0.0] }; 3]);
        let world = *body.bind();
        let mut moving = skirt.start(&world);
        for _ in 0..100 {
            skirt.advance(&body, &mut moving, &world, 0.02);
        }
        for (now, rest) in moving.points.iter().zip(&skirt.rest) {
            assert!(now.distance(*rest) < 0.06, "the cloth settled {} m away", now.distance(*rest));
        }
    }
}
