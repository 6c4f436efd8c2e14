//! Cotangents of a pose's triangles.

use glam::Vec3;

use crate::gradients::{TriangleBatches, frame};
use crate::lanes::Lanes;

/// Narrowest triangle that is weighted as it is, height over longest edge. Single precision cannot hold the weights of
/// narrower ones (their three cotangents cancel); they are weighted as if they were this wide.
const NARROWEST: f32 = 1e-3;

/// Triangles below this fraction of the mean area have no weight.
const DEGENERATE: f64 = 1e-12;

/// Sets `half_cotangents` to half the cotangent at the three corners of each triangle, by batch.
pub(super) fn set_half_cotangents(triangles: &TriangleBatches, pose: &[Vec3], half_cotangents: &mut Vec<[Lanes; 3]>) {
    half_cotangents.clear();
    let mut areas = Vec::with_capacity(triangles.batches().len());
    let mut sum = 0.0;
    let half = Lanes::splat(0.5);
    for batch in triangles.batches() {
        let frame = frame(batch, pose);
        let (a, b) = (frame.a, frame.b);
        let area = a * frame.c * half;
        sum += area.numbers().iter().map(|&area| f64::from(area)).sum::<f64>();
        areas.push(area);
        let longest = a.max((b * b + frame.c * frame.c).sqrt());
        let longest = longest.max(((a - b) * (a - b) + frame.c * frame.c).sqrt());
        let a = a.max(longest * Lanes::splat(NARROWEST));
        let c = frame.c.max(longest * Lanes::splat(NARROWEST) * longest / a);
        let half_inverse = half / c;
        let first = b * half_inverse;
        let second = (a - b) * half_inverse;
        let third = (c * c - b * (a - b)) * half_inverse / a;
        half_cotangents.push([first, second, third]);
    }
    let least = Lanes::splat((DEGENERATE * sum / triangles.triangle_count() as f64) as f32);
    for (cotangents, &area) in half_cotangents.iter_mut().zip(&areas) {
        for cotangent in cotangents {
            // Not `area < least`: what is not a number has no weight either, and nor has the filling.
            *cotangent = area.greater(least, *cotangent, Lanes::default());
        }
    }
}
