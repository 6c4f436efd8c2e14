//! Moving the template onto a frame: iteratively closest points in both directions, weighed by distance and normals, under a
//! deformation graph that is as stiff as the motion from the parent's pose allows.
//!
//! Per level the energy is
//!
//! ```text
//! sum_i (A_i / A)  u_i (n_y . (x_i - y_i))^2          from the template to the closest points y_i of the frame
//! + sum_j (A_j / A') u_j (n_j . (x_i(j) - y_j))^2      from the frame's vertices y_j to the closest points of the template
//! + sum_i (A_i / A) c v_i |colour(y_i) - colour_i|^2   where there are colours, on the fine level
//! + a / |E| sum_kl |R_k (g_l - g_k) + g_k + t_k - g_l - t_l|^2
//! ```
//!
//! Everything is held against the *parent's* pose: against the template's own, the first, stiff stage would straighten the
//! limbs again before there are correspondences.

use glam::Vec3;
use rayon::prelude::*;

use super::energy::{Pull, deform};
use super::graph::Motion;
use super::surface::{Closest, Surface, SurfacePoint, gradients};
use super::template::{Level, Template};

/// Metres that a unit of difference between normals counts, on the coarse and on the fine level.
const NORMALS: [f32; 2] = [0.15, 0.06];
/// Of the points one in so many is looked at.
const STRIDES: [usize; 2] = [4, 1];
/// Distance beyond which a pair counts for little, in the first stage and in the last.
const WIDTHS: [[f32; 2]; 2] = [[0.4, 0.05], [0.05, 0.01]];
/// Weight of stiffness, in the first stage and in the last.
const STIFFNESSES: [[f64; 2]; 2] = [[2.0, 0.1], [0.1, 0.03]];
const STAGES: usize = 3;
const STEPS: usize = 6;
/// The first stage, of both levels, where a pose is near the target's already.
const REFINED: usize = STAGES + 1;
/// A stage ends where the energy or the pose changes by less.
const LEAST_CHANGE: f64 = 0.01;
const LEAST_STEP: f32 = 2e-4;
/// Normals that agree less (cosine) belong to different sides.
const LEAST_COSINE: f32 = 0.3;
/// Vertices of the frame that are farther than this from the template pull at it as points, too, with this share.
const FAR: f32 = 0.03;
const FAR_SHARE: f32 = 0.1;
/// Weight of colours, square metres, and the difference beyond which one counts for little.
const COLOUR: f32 = 1e-3;
const COLOUR_WIDTH: f32 = 0.15;

/// A frame as it is tracked to.
#[derive(Debug)]
pub struct Target {
    /// Its surface.
    pub surface: Surface,
    closest: [Closest; 2],
    gradients: Option<Vec<[Vec3; 3]>>,
}

impl Target {
    /// Gets `surface` ready; `scale` as [`Template::scale`].
    #[must_use]
    pub fn new(surface: Surface, scale: f32) -> Self {
        let closest = NORMALS.map(|normal| Closest::new(&surface, normal * scale));
        let gradients = gradients(&surface);
        Self { surface, closest, gradients }
    }

    /// The point of the frame's surface closest to `place` with its `normal`, by the finer measure.
    #[must_use]
    pub fn closest(&self, place: Vec3, normal: Vec3) -> Option<SurfacePoint> {
        self.closest[1].find(&self.surface, place, normal)
    }
}

/// How much colours count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackOptions {
    /// Weight of colours relative to the usual one; 0 without.
    pub colour: f32,
}

impl Default for TrackOptions {
    fn default() -> Self {
        Self { colour: 1.0 }
    }
}

/// The template's pose on `target`, tracked from `start`, its pose on the frame before (turned and moved to where this one
/// is).
#[must_use]
pub fn track(template: &Template, start: &[Vec3], target: &Target, options: &TrackOptions) -> Vec<Vec3> {
    stages(template, (start, start.to_vec()), target, options, 0)
}

/// The same, from a pose that is near the target's already: the coarse level, which would slide back what lies right by its shape
/// alone, is left out. The template is held against `start` all the same.
#[must_use]
pub fn refine(
    template: &Template,
    (start, near): (&[Vec3], &[Vec3]),
    target: &Target,
    options: &TrackOptions,
) -> Vec<Vec3> {
    stages(template, (start, near.to_vec()), target, options, REFINED)
}

/// The stages of both levels from `first` on.
fn stages(
    template: &Template,
    (start, mut pose): (&[Vec3], Vec<Vec3>),
    target: &Target,
    options: &TrackOptions,
    first: usize,
) -> Vec<Vec3> {
    let mut moving = template.surface.posed(pose.clone());
    for (index, level) in template.levels.iter().enumerate().skip(first / STAGES) {
        let mut motions =
            if index == 0 { vec![Motion::NONE; level.graph.nodes.len()] } else { level.graph.fit(start, &pose) };
        let tracker = Tracker { template, level, start, target, index, colour: options.colour };
        for stage in first.saturating_sub(STAGES * index)..STAGES {
            tracker.stage(stage, &mut motions, &mut moving);
        }
        pose.clone_from(&moving.mesh.positions);
    }
    pose
}

struct Tracker<'a> {
    template: &'a Template,
    level: &'a Level,
    start: &'a [Vec3],
    target: &'a Target,
    index: usize,
    colour: f32,
}

impl Tracker<'_> {
    fn stage(&self, stage: usize, motions: &mut Vec<Motion>, moving: &mut Surface) {
        let share = stage as f64 / (STAGES - 1) as f64;
        let between = |[first, last]: [f64; 2]| first * (last / first).powf(share);
        let [first, last] = WIDTHS[self.index].map(f64::from);
        let width = between([first, last]) as f32 * self.template.scale;
        // Energies are squares of lengths in the data and in stiffness alike: it needs no scale.
        let stiffness = between(STIFFNESSES[self.index]);
        let mut before = f64::INFINITY;
        moving.pose(&deform(&self.level.graph, self.start, motions));
        for _ in 0..STEPS {
            let pulls = self.pulls(moving, width);
            let kept = motions.clone();
            let Some(energy) = self.level.system.step(&self.level.graph, self.start, &pulls, stiffness, motions) else {
                *motions = kept;
                break;
            };
            let pose = deform(&self.level.graph, self.start, motions);
            let squares = pose.iter().zip(&moving.mesh.positions).map(|(a, b)| f64::from(a.distance_squared(*b)));
            let step = (squares.sum::<f64>() / pose.len().max(1) as f64).sqrt() as f32;
            moving.pose(&pose);
            if step < LEAST_STEP * self.template.scale || (before - energy).abs() < LEAST_CHANGE * energy {
                break;
            }
            before = energy;
        }
    }

    /// What pulls at every vertex of the template in its present pose.
    fn pulls(&self, moving: &Surface, width: f32) -> Vec<Pull> {
        let (stride, target) = (STRIDES[self.index], &self.target.surface);
        let weigh = |distance: f32, cosine: f32| {
            let near = width * width / (width * width + distance * distance);
            if cosine < LEAST_COSINE { 0.0 } else { near * near * cosine }
        };
        let to_target = &self.target.closest[self.index];
        let vertices = (0..moving.mesh.positions.len()).into_par_iter().step_by(stride);
        let forward: Vec<Option<(usize, SurfacePoint)>> = vertices
            .map(|i| {
                let found = to_target.find(target, moving.mesh.positions[i], moving.normals[i]);
                found.map(|found| (i, found))
            })
            .collect();
        let mut pulls = vec![Pull::NONE; moving.mesh.positions.len()];
        let share = stride as f32 / moving.area().max(1e-12);
        for (i, y) in forward.into_iter().flatten() {
            let x = moving.mesh.positions[i];
            let weight = weigh(x.distance(y.position), moving.normals[i].dot(y.normal));
            if weight > 0.0 {
                let area = moving.areas[i] * share;
                pulls[i].add(area * weight, y.normal, y.normal.dot(x - y.position));
                if self.index == 1 {
                    self.add_colours(&mut pulls[i], area, i, x, &y);
                }
            }
        }
        let to_template = Closest::new(moving, NORMALS[self.index] * self.template.scale);
        let vertices = (0..target.mesh.positions.len()).into_par_iter().step_by(stride);
        let backward: Vec<Option<(usize, SurfacePoint)>> = vertices
            .map(|j| to_template.find(moving, target.mesh.positions[j], target.normals[j]).map(|found| (j, found)))
            .collect();
        let share = stride as f32 / target.area().max(1e-12);
        for (j, x) in backward.into_iter().flatten() {
            let (y, normal) = (target.mesh.positions[j], target.normals[j]);
            let (off, distance) = (x.position - y, x.position.distance(y));
            let weight = weigh(distance, normal.dot(x.normal)) * target.areas[j] * share;
            if weight > 0.0 {
                let pull = &mut pulls[x.vertex as usize];
                pull.add(weight, normal, normal.dot(off));
                if distance > FAR * self.template.scale {
                    pull.add_point(FAR_SHARE * weight, off);
                }
            }
        }
        pulls
    }

    fn add_colours(&self, pull: &mut Pull, area: f32, vertex: usize, x: Vec3, y: &SurfacePoint) {
        let (Some(own), Some(colours), Some(gradients)) =
            (&self.template.surface.colours, &self.target.surface.colours, &self.target.gradients)
        else {
            return;
        };
        let surface = &self.target.surface;
        let corners = surface.mesh.triangles[y.triangle as usize];
        let found = surface.interpolated(colours, y.triangle, y.weights);
        let scale = self.template.scale * self.template.scale;
        for channel in 0..3 {
            let of = |corner: usize| gradients[corners[corner] as usize][channel];
            let gradient = of(0) * y.weights.x + of(1) * y.weights.y + of(2) * y.weights.z;
            let residual = found[channel] - own[vertex][channel] + gradient.dot(x - y.position);
            let square = COLOUR_WIDTH * COLOUR_WIDTH;
            let near = square / (square + residual * residual);
            pull.add(self.colour * COLOUR * scale * area * near * near, gradient, residual);
        }
    }
}
