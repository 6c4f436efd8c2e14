//! Where the round part of a template flares, as a skirt does from the waist to its hem: there it may be turned by another angle on each
//! side, while what is narrow above goes with the body.

use super::round::Round;
use super::surface::Surface;

/// Height of a ring, metres on a person.
const RING: f32 = 0.04;
/// A ring that is this many times as wide as the widest is at the border: half of it goes with the body; and how soon it gives way.
const BORDER: f32 = 0.575;
const SOON: f32 = 4.0;

/// How much each vertex of `surface`, the template's, belongs to where `round` flares, from 0 to 1, and without steps; `scale` as
/// [`super::template::Template::scale`].
#[must_use]
pub fn flare(round: &Round, surface: &Surface, scale: f32) -> Vec<f32> {
    let height = |v: usize| (surface.mesh.positions[v] - round.axis.point).dot(round.axis.along) / (RING * scale);
    let heights: Vec<f32> = (0..surface.mesh.positions.len()).map(height).collect();
    let low = heights.iter().copied().fold(f32::INFINITY, f32::min).floor();
    let count = heights.iter().map(|&height| (height - low) as usize + 2).max().unwrap_or(0);
    let mut rings: Vec<Vec<(f32, f32)>> = vec![Vec::new(); count];
    for (v, &place) in surface.mesh.positions.iter().enumerate().filter(|(v, _)| round.shares[*v] > 0.5) {
        rings[(heights[v] - low) as usize].push((round.axis.distance(place), surface.areas[v]));
    }
    let widths: Vec<(f32, f32)> = rings.into_iter().map(width).collect();
    // The widest by what would go farthest if it were turned: a crumb far out is no ring.
    let widest = (0..count).max_by(|&a, &b| (widths[a].0 * widths[a].1).total_cmp(&(widths[b].0 * widths[b].1)));
    let Some(widest) = widest.filter(|&ring| widths[ring].0 > 0.0) else { return vec![0.0; heights.len()] };
    let part = |ring: usize| ((widths[ring].0 / widths[widest].0 - BORDER) * SOON + 0.5).clamp(0.0, 1.0);
    let mut parts = vec![0.0; count];
    for ring in (widest..count).take_while(|&ring| part(ring) > 0.0) {
        parts[ring] = part(ring);
    }
    for ring in (0..widest).rev().take_while(|&ring| part(ring) > 0.0) {
        parts[ring] = part(ring);
    }
    let between = |v: usize| {
        let at = (heights[v] - low - 0.5).max(0.0);
        let ring = at as usize;
        parts[ring] + (parts[(ring + 1).min(count - 1)] - parts[ring]) * at.fract()
    };
    (0..heights.len()).map(|v| round.shares[v] * between(v)).collect()
}

/// How far most of a ring is from the axis, the median by area, and its area.
fn width(mut ring: Vec<(f32, f32)>) -> (f32, f32) {
    ring.sort_by(|a, b| a.0.total_cmp(&b.0));
    let area: f32 = ring.iter().map(|part| part.1).sum();
    let mut sum = 0.0;
    let is_half = |part: &&(f32, f32)| {
        sum += part.1;
        sum >= 0.5 * area
    };
    (ring.iter().find(is_half).map_or(0.0, |part| part.0), area)
}

#[cfg(test)]
mod tests {
    use geometry::polygonise::polygonise;
    use glam::Vec3;

    use super::*;
    use crate::template::Template;

    #[test]
    fn the_skirt_flares_and_the_trunk_does_not() {
        // A cone about the vertical, as wide at its hem as it is high, under a trunk that is round, too.
        let distance = |p: Vec3| {
            let across = p.x.hypot(p.z);
            let cone = (across - (0.1 + 0.5 * (0.4 - p.y))) * 0.9;
            let skirt = cone.max(-0.1 - p.y).max(p.y - 0.4);
            let trunk = (across - 0.1).max(0.3 - p.y).max(p.y - 1.0);
            skirt.min(trunk)
        };
        let mesh = polygonise(Vec3::new(-0.6, -0.3, -0.6), Vec3::new(0.62, 1.2, 0.61), 0.03, distance);
        let template = Template::new(Surface::new(mesh, None)).unwrap();
        let round = Round::new(&template, &template.surface.mesh.neighbours()).unwrap();
        let parts = flare(&round, &template.surface, template.scale);
        let mean = |only: &dyn Fn(Vec3) -> bool| {
            let of = template.surface.mesh.positions.iter().zip(&parts).filter(|(p, _)| only(**p));
            let of: Vec<f32> = of.map(|(_, part)| *part).collect();
            of.iter().sum::<f32>() / of.len() as f32
        };
        let side = |p: Vec3| p.x.hypot(p.z) > 0.15;
        let (hem, middle, trunk) =
            (mean(&|p| p.y < 0.1 && side(p)), mean(&|p| (0.2..0.3).contains(&p.y)), mean(&|p| p.y > 0.45));
        assert!(hem > 0.9 && middle < 0.9 && trunk < 0.05, "{hem}, {middle} and {trunk}");
    }
}
