//! Which triangles belong together in the texture: front and back of each garment, so that seams run along the sides, where a
//! tailor would put them.

use super::body::Body;
use super::build::Dress;
use super::skirt;
use geometry::charts::{centre_and_normal, cut};
use geometry::mesh::Mesh;
use glam::Vec3;

/// Groups of the surface and the relative texel density of each.
const DENSITIES: [f32; 12] = [1.75, 0.7, 1.0, 0.95, 0.95, 0.85, 0.85, 1.0, 1.0, 0.95, 0.42, 1.0];

/// Cuts `mesh`, the figure in the bind pose, into charts that are discs.
#[must_use]
pub fn garments(body: &Body, mesh: &Mesh) -> Vec<Vec<u32>> {
    cut(mesh, first_labels(body, mesh))
}

fn group(body: &Body, p: Vec3) -> usize {
    let f = body.fields(p);
    let side = usize::from(p.x < 0.0);
    let across = skirt::across(p);
    let has_inside = body.dress() == Dress::Skirt;
    let candidates = [
        (f.head.min(f.hair), 0),
        (f.tail, 1),
        (f.shirt, 2),
        (f.arms[side], 3 + side),
        (f.legs[side], 5 + side),
        (f.shoes[side], 7 + side),
        (f.skirt, if across > -0.003 || p.y > 0.98 || !has_inside { 9 } else { 10 }),
    ];
    candidates.iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |c| c.1)
}

fn first_labels(body: &Body, mesh: &Mesh) -> Vec<usize> {
    (0..mesh.triangles.len() as u32)
        .map(|t| {
            let (p, n) = centre_and_normal(mesh, t);
            let group = group(body, p);
            let second = match group {
                1 | 7 | 8 => n.x < 0.0,
                9 | 10 => p.z < 0.0,
                0 => n.z + 0.25 * (p.z + 0.02) / 0.1 < 0.0,
                _ => n.z < 0.0,
            };
            group * 2 + usize::from(second)
        })
        .collect()
}

/// Texels per metre, relative to other charts: those of the group that most of the triangles belong to.
#[must_use]
pub fn density(body: &Body, mesh: &Mesh, triangles: &[u32]) -> f32 {
    let mut votes = [0_usize; 12];
    for &triangle in triangles {
        let (p, n) = centre_and_normal(mesh, triangle);
        let group = group(body, p);
        // The back of the head is hair only.
        votes[if group == 0 && n.z < -0.3 { 11 } else { group }] += 1;
    }
    (0..12).rev().max_by_key(|&k| votes[k]).map_or(1.0, |k| DENSITIES[k])
}
