//! Whether a frame was tracked: how well the template covers it.

use rayon::prelude::*;

use super::surface::{Closest, Surface};
use super::template::Template;

/// Metres that a surface may lie off before it counts as not covered.
const COVERED: f32 = 0.01;

/// Metres off that count as much as all of the frame not being covered.
const UNCOVERED: f64 = 0.2;
/// Metres off that count as much as all edges being e times too long, and as colours that differ by all that they can: these tell a
/// surface that only slid, or a leg that is taken for the other. Chosen on pairs of frames of the performer.
const STRAIN: f64 = 0.1;
const COLOUR: f64 = 0.25;

/// How the template lies on a frame. Measured by area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    /// Share of the frame's surface that is farther than a centimetre from the template.
    pub uncovered: f64,
    /// Root of the mean square distance from the frame to the template, metres.
    pub rms_backward: f64,
    /// Share of the template that is farther than a centimetre from the frame: webs of the frame, for the most part.
    pub beyond: f64,
    /// Root of the mean square distance from the template to the frame, metres.
    pub rms_forward: f64,
    /// The largest distance of either.
    pub hausdorff: f64,
    /// How much longer an edge of the template is than in the parent's pose: the 99th percentile.
    pub stretch: f64,
    /// How much the colours of the template differ from those under it, 0 to 1; 0 where there are none.
    pub colour: f64,
    /// How much longer or shorter edges are than the template's own: the mean of the logarithms, without signs.
    pub strain: f64,
}

/// What is wrong with a frame that was tracked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// More of the frame is not covered than can be explained.
    Uncovered,
    /// The template does not fit the frame closely.
    Loose,
    /// The template fits, but is stretched and squeezed: parts of it lie where others belong.
    Strained,
}

/// Limits beyond which a frame counts as lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Of [`Fit::uncovered`].
    pub uncovered: f64,
    /// Of [`Fit::rms_backward`], metres on a person.
    pub rms_backward: f64,
    /// Of [`Fit::strain`], of frames that are far from all that were known; noise strains edges, too.
    pub strain: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { uncovered: 0.02, rms_backward: 0.006, strain: 0.13 }
    }
}

impl Fit {
    /// How bad it is, to compare results on one frame: the distance from the frame, and as much for each percent that is not
    /// covered as a viewer would mind.
    #[must_use]
    pub fn badness(&self, scale: f32) -> f64 {
        self.rms_backward / f64::from(scale) + UNCOVERED * self.uncovered + STRAIN * self.strain + COLOUR * self.colour
    }

    /// What is wrong with a frame that was far from all that were known, if anything: there, parts may be taken for others.
    #[must_use]
    pub fn far_fault(&self, limits: &Limits, scale: f32) -> Option<Fault> {
        let strained = (self.strain > limits.strain).then_some(Fault::Strained);
        self.fault(limits, scale).or(strained)
    }

    /// What is wrong, if anything. No limit finds a surface that only slid.
    #[must_use]
    pub fn fault(&self, limits: &Limits, scale: f32) -> Option<Fault> {
        if self.uncovered > limits.uncovered {
            Some(Fault::Uncovered)
        } else if self.rms_backward > limits.rms_backward * f64::from(scale) {
            Some(Fault::Loose)
        } else {
            None
        }
    }
}

/// How `posed`, the template in the pose that was found, lies on `target`; `start` is the pose that it was tracked from.
#[must_use]
pub fn fit(template: &Template, posed: &Surface, start: &[glam::Vec3], target: &Surface) -> Fit {
    let limit = COVERED * template.scale;
    let (beyond, rms_forward, most_forward) = off(posed, target, limit);
    let (uncovered, rms_backward, most_backward) = off(target, posed, limit);
    let mesh = &posed.mesh;
    let mut stretches: Vec<f32> = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| {
            let length = |pose: &[glam::Vec3]| pose[a as usize].distance(pose[b as usize]);
            length(&mesh.positions) / length(start).max(1e-9)
        })
        .collect();
    let index = stretches.len() * 99 / 100;
    let stretch = match stretches.get(index) {
        Some(_) => f64::from(*stretches.select_nth_unstable_by(index, f32::total_cmp).1),
        None => 1.0,
    };
    Fit {
        uncovered,
        rms_backward,
        beyond,
        rms_forward,
        hausdorff: most_forward.max(most_backward),
        stretch,
        colour: colour(posed, target, limit),
        strain: strain(template, &mesh.positions),
    }
}

/// The mean difference of the colours of `from` and of what lies under it on `to`, no farther off than `limit`.
fn colour(from: &Surface, to: &Surface, limit: f32) -> f64 {
    let (Some(own), Some(others)) = (&from.colours, &to.colours) else { return 0.0 };
    let closest = Closest::new(to, 0.0);
    let of = |k: usize| -> Option<f32> {
        let found = closest.find(to, from.mesh.positions[k], from.normals[k])?;
        let near = found.position.distance(from.mesh.positions[k]) < limit;
        near.then(|| to.interpolated(others, found.triangle, found.weights).distance(own[k]))
    };
    let differences: Vec<Option<f32>> = (0..own.len()).into_par_iter().map(of).collect();
    let (mut sum, mut area) = (0.0, 0.0);
    for (difference, &own) in differences.iter().zip(&from.areas) {
        if let Some(difference) = difference {
            sum += f64::from(*difference) * f64::from(own);
            area += f64::from(own);
        }
    }
    sum / f64::max(area, 1e-12)
}

/// The mean of how much longer or shorter edges are than the template's own, by their logarithms.
fn strain(template: &Template, pose: &[glam::Vec3]) -> f64 {
    let mesh = &template.surface.mesh;
    let of = |&[a, b, c]: &[u32; 3]| {
        let edge = |[a, b]: [u32; 2]| {
            let length = |pose: &[glam::Vec3]| pose[a as usize].distance(pose[b as usize]).max(1e-9);
            f64::from(length(pose) / length(&mesh.positions)).ln().abs()
        };
        edge([a, b]) + edge([b, c]) + edge([c, a])
    };
    mesh.triangles.iter().map(of).sum::<f64>() / (3 * mesh.triangles.len()).max(1) as f64
}

/// The share of `from` that is farther than `limit` from `to`, the root of the mean square distance, and the largest.
fn off(from: &Surface, to: &Surface, limit: f32) -> (f64, f64, f64) {
    let closest = Closest::new(to, 0.0);
    let distances: Vec<f32> = (0..from.mesh.positions.len())
        .into_par_iter()
        .map(|k| {
            let place = from.mesh.positions[k];
            closest.find(to, place, from.normals[k]).map_or(f32::INFINITY, |found| found.position.distance(place))
        })
        .collect();
    let (mut far, mut squares, mut area, mut most) = (0.0, 0.0, 0.0, 0.0_f64);
    for (&distance, &own) in distances.iter().zip(&from.areas) {
        let (distance, own) = (f64::from(distance), f64::from(own));
        if own > 0.0 {
            area += own;
            squares += own * distance * distance;
            far += if distance > f64::from(limit) { own } else { 0.0 };
            most = most.max(distance);
        }
    }
    (far / f64::max(area, 1e-12), (squares / f64::max(area, 1e-12)).sqrt(), most)
}
