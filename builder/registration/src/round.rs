//! The part of a template that is round, as a skirt: it looks the same wherever it is turned, and where a pattern repeats on it, so do its
//! colours. A frame that is far from all that are known may be found with it turned by some of the pattern's periods, and then nothing but
//! the twist of what it hangs on tells. So it is turned as a whole, about its own axis, along the surface that was found.

use glam::{Quat, Vec3};
use rayon::prelude::*;

use super::surface::{Closest, Surface, SurfacePoint};
use super::template::Template;

/// Turns that are tried of a pose that was found, radians: a pattern's period may be any, and tracking goes on from beside it.
pub const TRIED: [f32; 6] = [0.2, -0.2, 0.4, -0.4, 0.6, -0.6];
/// Turns, radians, by which the template is held against itself.
const TURNS: [f32; 10] = [0.4, -0.4, 0.8, -0.8, 1.2, -1.2, 1.6, -1.6, 2.4, -2.4];
/// What lies farther off when it is turned is not round, in parts of how far it is from the axis, which is looked for anew each time: folds
/// are less, a trunk's flat sides more.
const FARTHEST: [f32; 4] = [0.4, 0.35, 0.35, 0.35];
/// Normals that agree less (cosine) belong to something else.
const LEAST_COSINE: f32 = 0.5;
/// Of the turns the worst in so many do not count: something else may lie there.
const SPARED: usize = 4;
/// What is rounder than this belongs to the part.
const LEAST: f32 = 0.25;
/// A part that is less of the surface is not worth turning.
const LEAST_AREA: f32 = 0.05;
/// How often shares are made smooth, so that the border gives way.
const SMOOTH: usize = 10;
/// An axis that leans more (cosine) is none.
const LEAST_UPRIGHT: f32 = 0.7;
/// Metres on a person that a unit of difference between normals counts.
const NORMAL: f32 = 0.06;

/// A line, more or less upright.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// A point of it.
    pub point: Vec3,
    /// Along it, of unit length.
    pub along: Vec3,
}

impl Axis {
    /// `place` and `normal`, turned about it by so many radians.
    fn turn(self, turn: f32, (place, normal): (Vec3, Vec3)) -> (Vec3, Vec3) {
        let turn = Quat::from_axis_angle(self.along, turn);
        (turn * (place - self.point) + self.point, turn * normal)
    }

    /// How far `place` is from it.
    #[must_use]
    pub fn distance(self, place: Vec3) -> f32 {
        (place - self.point).cross(self.along).length()
    }
}

/// A round part of a template.
#[derive(Clone, Debug)]
pub struct Round {
    /// How much of a turn each vertex takes part in, from 0 to 1.
    pub shares: Vec<f32>,
    /// What it is round about.
    pub axis: Axis,
    closest: Closest,
}

impl Round {
    /// The largest round part of `template`, of which `neighbours` are the vertices around each; `None` where none is worth turning.
    #[must_use]
    pub fn new(template: &Template, neighbours: &[Vec<u32>]) -> Option<Self> {
        let surface = &template.surface;
        let closest = Closest::new(surface, NORMAL * template.scale);
        let mut axis = Axis { point: surface.centroid(), along: Vec3::Y };
        let mut part = Vec::new();
        for farthest in FARTHEST {
            part = largest(surface, neighbours, &roundness(surface, &closest, axis, farthest), axis);
            axis = middle(surface, &part)?;
        }
        let area: f32 = part.iter().map(|&v| surface.areas[v as usize]).sum();
        if area < LEAST_AREA * surface.area() {
            return None;
        }
        let mut shares = vec![0.0; neighbours.len()];
        part.iter().for_each(|&v| shares[v as usize] = 1.0);
        for _ in 0..SMOOTH {
            let mean = |(v, around): (usize, &Vec<u32>)| {
                let sum: f32 = around.iter().map(|&n| shares[n as usize]).sum();
                0.5 * shares[v] + 0.5 * sum / around.len().max(1) as f32
            };
            shares = neighbours.iter().enumerate().map(mean).collect();
        }
        Some(Self { shares, axis, closest })
    }

    /// `posed`, a pose of `surface`, the template's, with the part turned by `turn` radians: each vertex goes to where the pose has the point of the
    /// template that it comes to lie on.
    #[must_use]
    pub fn turned(&self, surface: &Surface, posed: &Surface, turn: f32) -> Vec<Vec3> {
        let place = |v: usize| {
            let own = posed.mesh.positions[v];
            let found = if self.shares[v] > 0.0 { self.under(surface, v, turn * self.shares[v]) } else { None };
            found.map_or(own, |found| posed.interpolated(&posed.mesh.positions, found.triangle, found.weights))
        };
        (0..self.shares.len()).into_par_iter().map(place).collect()
    }

    /// The point of `surface`, the template's, that vertex `v` comes to lie on when it is turned by `turn` radians.
    #[must_use]
    pub fn under(&self, surface: &Surface, v: usize, turn: f32) -> Option<SurfacePoint> {
        let (place, normal) = self.axis.turn(turn, (surface.mesh.positions[v], surface.normals[v]));
        self.closest.find(surface, place, normal)
    }

    /// Where `place` lies about the axis as seen from above, from +Z to +X, from 0 to a whole turn in radians.
    #[must_use]
    pub fn bearing(&self, place: Vec3) -> f32 {
        let off = place - self.axis.point;
        off.x.atan2(off.z).rem_euclid(std::f32::consts::TAU)
    }
}

/// How round the surface is about `axis` at each vertex, from 0 to 1: 0 is `farthest` off.
fn roundness(surface: &Surface, closest: &Closest, axis: Axis, farthest: f32) -> Vec<f32> {
    let of = |v: usize| {
        let farthest = farthest * axis.distance(surface.mesh.positions[v]).max(1e-9);
        let share = |turn: f32| {
            let (place, normal) = axis.turn(turn, (surface.mesh.positions[v], surface.normals[v]));
            let found = closest.find(surface, place, normal).filter(|found| found.normal.dot(normal) > LEAST_COSINE);
            found.map_or(0.0, |found| (1.0 - (found.position.distance(place) / farthest).powi(2)).max(0.0))
        };
        let mut shares = TURNS.map(share);
        shares.sort_by(f32::total_cmp);
        shares[TURNS.len() / SPARED]
    };
    (0..surface.mesh.positions.len()).into_par_iter().map(of).collect()
}

/// The vertices of the connected part of what is round that would go farthest, all together, if it were turned.
fn largest(surface: &Surface, neighbours: &[Vec<u32>], roundness: &[f32], axis: Axis) -> Vec<u32> {
    let mut seen: Vec<bool> = roundness.iter().map(|&round| round < LEAST).collect();
    let mut best = (0.0, Vec::new());
    for start in 0..seen.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let (mut part, mut reach, mut next) = (vec![start as u32], 0.0, 0);
        while let Some(&vertex) = part.get(next) {
            reach += surface.areas[vertex as usize] * axis.distance(surface.mesh.positions[vertex as usize]);
            for &near in &neighbours[vertex as usize] {
                if !std::mem::replace(&mut seen[near as usize], true) {
                    part.push(near);
                }
            }
            next += 1;
        }
        if reach > best.0 {
            best = (reach, part);
        }
    }
    best.1
}

/// The line through the middles of some vertices at all heights, by their areas; `None` where there is none.
fn middle(surface: &Surface, part: &[u32]) -> Option<Axis> {
    let weighed = || part.iter().map(|&v| (surface.mesh.positions[v as usize], surface.areas[v as usize]));
    let area: f32 = weighed().map(|(_, area)| area).sum();
    let point = weighed().map(|(p, area)| p * area).sum::<Vec3>() / area;
    let along: Vec3 = weighed().map(|(p, area)| (p - point) * ((p.y - point.y) * area)).sum();
    let axis = Axis { point, along: along.normalize_or(Vec3::Y) };
    (area > 0.0 && axis.along.y > LEAST_UPRIGHT).then_some(axis)
}

#[cfg(test)]
mod tests {
    use geometry::polygonise::polygonise;

    use super::*;

    /// A skirt about a vertical beside the middle, and a flat trunk with an arm on it.
    fn body() -> Template {
        let distance = |p: Vec3| {
            let q = p - Vec3::new(0.1, 0.0, 0.05);
            let skirt = (q / Vec3::new(0.4, 0.45, 0.4)).length() * 0.4 - 0.4;
            let trunk = (q - Vec3::Y * q.y.clamp(0.3, 1.0)).abs() - Vec3::new(0.2, 0.02, 0.06);
            let trunk = trunk.max(Vec3::ZERO).length() + trunk.max_element().min(0.0) - 0.03;
            let arm = Vec3::new(q.x - q.x.clamp(0.0, 0.8), q.y - 0.9, q.z).length() - 0.06;
            skirt.min(trunk).min(arm)
        };
        let mesh = polygonise(Vec3::new(-0.9, -0.7, -0.9), Vec3::new(1.2, 1.3, 0.95), 0.04, distance);
        Template::new(Surface::new(mesh, None)).unwrap()
    }

    #[test]
    fn the_skirt_is_turned_and_nothing_else() {
        let template = body();
        let round = Round::new(&template, &template.surface.mesh.neighbours()).unwrap();
        assert!(round.axis.distance(Vec3::new(0.1, 0.0, 0.05)) < 0.03, "{:?}", round.axis);
        // In a pose that leans and has moved it turns along.
        let lean = |p: Vec3| Quat::from_rotation_x(0.4) * p + Vec3::new(2.0, 0.0, 1.0);
        let pose: Vec<Vec3> = template.surface.mesh.positions.iter().map(|&p| lean(p)).collect();
        let turned = round.turned(&template.surface, &template.surface.posed(pose.clone()), 0.3);
        let axis = Vec3::new(0.1, 0.0, 0.05);
        let (mut skirt, mut rest) = (Vec::new(), Vec::new());
        for (k, &p) in template.surface.mesh.positions.iter().enumerate() {
            let there = lean(Quat::from_rotation_y(0.3) * (p - axis) + axis);
            if (-0.3..0.1).contains(&p.y) {
                skirt.push(turned[k].distance(there));
            }
            if p.y > 0.75 {
                rest.push(turned[k].distance(pose[k]));
            }
        }
        let mean = |off: &[f32]| off.iter().sum::<f32>() / off.len() as f32;
        assert!(mean(&skirt) < 0.015 && mean(&rest) < 1e-3, "{} and {}", mean(&skirt), mean(&rest));
    }

    #[test]
    fn a_body_without_a_round_part_has_none() {
        let distance = |p: Vec3| {
            let q = p.abs() - Vec3::new(0.5, 0.8, 0.05);
            q.max(Vec3::ZERO).length() + q.max_element().min(0.0) - 0.03
        };
        let mesh = polygonise(Vec3::splat(-1.1), Vec3::splat(1.15), 0.05, distance);
        let template = Template::new(Surface::new(mesh, None)).unwrap();
        assert!(Round::new(&template, &template.surface.mesh.neighbours()).is_none());
    }
}
