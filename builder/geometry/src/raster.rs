//! A plain rasteriser in software: which samples of a grid a triangle covers, and which triangle is nearest in each.
//!
//! Places are in samples from the top left, so that the centre of the first sample is (0.5, 0.5). One rule for edges: a
//! sample is covered where its centre lies in the triangle or on its edge, whichever way round the corners go. Where two
//! triangles cover a sample the nearer one is kept, and of two equally near ones the first that was drawn.

use glam::{Vec2, Vec3};

/// Triangles with less than this area (twice over, in samples) cover nothing.
const LEAST_AREA: f32 = 1e-9;

/// Calls `visit` with the index (row by row) and the barycentric coordinates of every sample that the triangle covers in a
/// grid of `size` (width, height). `slack` widens the triangle: coordinates down to `-slack` count as inside. With less than
/// 0 what lies on the edges is left out.
pub fn cover([a, b, c]: [Vec2; 3], size: (usize, usize), slack: f32, mut visit: impl FnMut(usize, Vec3)) {
    let area = (b - a).perp_dot(c - a);
    if area.abs() < LEAST_AREA || !area.is_finite() {
        return;
    }
    let low = a.min(b).min(c).max(Vec2::ZERO);
    let high = a.max(b).max(c).ceil().max(Vec2::ZERO);
    for y in low.y as usize..(high.y as usize).min(size.1) {
        for x in low.x as usize..(high.x as usize).min(size.0) {
            let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let weights = Vec3::new((c - b).perp_dot(p - b), (a - c).perp_dot(p - c), (b - a).perp_dot(p - a)) / area;
            if weights.min_element() >= -slack {
                visit(y * size.0 + x, weights);
            }
        }
    }
}

/// Calls `visit` with the column and row of every sample within reach of the triangle, in the grid or not, and with how far
/// inside of the nearest edge its centre lies, in samples: less than 0 where it lies outside. Within reach is a sample whose
/// square, widened to `reach` samples on each side of its centre, is not wholly beyond an edge.
///
/// Other than for [`cover`], the centre of the first sample is (0, 0).
pub fn touch(places: [Vec2; 3], reach: f32, mut visit: impl FnMut(i64, i64, f32)) {
    let [a, mut b, mut c] = places;
    let area = (b - a).perp_dot(c - a);
    if area.abs() < LEAST_AREA || !area.is_finite() {
        return;
    }
    if area < 0.0 {
        (b, c) = (c, b);
    }
    let low = (a.min(b).min(c) - reach).ceil();
    let high = (a.max(b).max(c) + reach).floor();
    for y in low.y as i64..=high.y as i64 {
        for x in low.x as i64..=high.x as i64 {
            let p = Vec2::new(x as f32, y as f32);
            let mut depth = f32::INFINITY;
            let mut touches = true;
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let edge = to - from;
                let side = edge.perp_dot(p - from);
                depth = depth.min(side / edge.length().max(1e-12));
                touches &= side + reach * (edge.x.abs() + edge.y.abs()) >= 0.0;
            }
            if touches {
                visit(x, y, depth);
            }
        }
    }
}

/// A picture that is being drawn: a colour for each sample, and how near what it shows is.
pub struct Canvas {
    size: (usize, usize),
    nearness: Vec<f32>,
    colours: Vec<Vec3>,
}

impl Canvas {
    /// Samples of `background`, which is told their column and row, and is behind everything.
    #[must_use]
    pub fn new(size: (usize, usize), background: impl Fn(usize, usize) -> Vec3) -> Self {
        let samples = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
        let colours: Vec<Vec3> = samples.map(|(x, y)| background(x, y)).collect();
        Self { size, nearness: vec![f32::NEG_INFINITY; colours.len()], colours }
    }

    /// Draws a triangle where it is nearer than what is there. `nearness` of its corners grows towards the camera and is
    /// linear in the picture; `colour` is told a sample's barycentric coordinates and its nearness.
    pub fn fill(&mut self, corners: [Vec2; 3], nearness: [f32; 3], colour: impl Fn(Vec3, f32) -> Vec3) {
        cover(corners, self.size, 0.0, |sample, weights| {
            let near = weights.dot(nearness.into());
            if near > self.nearness[sample] {
                self.nearness[sample] = near;
                self.colours[sample] = colour(weights, near);
            }
        });
    }

    /// The samples of a pixel that is `side` samples wide and high, row by row: each one's colour, and whether a triangle
    /// covers it. The pixel must lie inside.
    pub fn pixel(&self, x: u32, y: u32, side: usize) -> impl Iterator<Item = (Vec3, bool)> {
        let first = (y as usize * self.size.0 + x as usize) * side;
        let samples = (0..side * side).map(move |k| first + k / side * self.size.0 + k % side);
        samples.map(|sample| (self.colours[sample], self.nearness[sample] > f32::NEG_INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (usize, usize) = (16, 12);

    fn covered(corners: [Vec2; 3], slack: f32) -> Vec<usize> {
        let mut covered = Vec::new();
        cover(corners, SIZE, slack, |sample, weights| {
            let place = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
            let centre = Vec2::new((sample % SIZE.0) as f32, (sample / SIZE.0) as f32) + 0.5;
            assert!(
                place.distance(centre) < 1e-3 && (weights.element_sum() - 1.0).abs() < 1e-5,
                "{place} for {centre}"
            );
            covered.push(sample);
        });
        covered
    }

    #[test]
    fn samples_on_an_edge_belong_to_both_sides_or_with_less_slack_to_none() {
        // The diagonal of a square of 8 by 8 goes through the centres of 8 samples.
        let [a, b, c, d] = [(2.0, 2.0), (10.0, 2.0), (10.0, 10.0), (2.0, 10.0)].map(Vec2::from);
        assert_eq!(covered([a, b, c], 0.0).len() + covered([a, c, d], 0.0).len(), 64 + 8);
        assert_eq!(covered([a, b, c], -1e-4).len() + covered([a, c, d], -1e-4).len(), 64 - 8);
        // Either way round, and only inside the grid.
        assert_eq!(covered([a, b, c], 0.0), covered([c, b, a], 0.0));
        assert_eq!(covered([Vec2::splat(-50.0), Vec2::new(90.0, -50.0), Vec2::new(-50.0, 90.0)], 0.0).len(), 16 * 12);
    }

    #[test]
    fn what_has_no_area_or_no_place_covers_nothing() {
        for bad in [f32::NAN, f32::INFINITY, 5.0] {
            assert_eq!(covered([Vec2::splat(5.0), Vec2::splat(bad), Vec2::new(5.0, 9.0)], 0.0), [0_usize; 0]);
        }
    }

    #[test]
    fn what_is_touched_is_what_is_covered_and_a_border() {
        let corners = [Vec2::new(2.3, 1.7), Vec2::new(9.1, 3.2), Vec2::new(4.4, 8.8)];
        for [a, b, c] in [corners, [corners[2], corners[1], corners[0]]] {
            let touched = |reach: f32| {
                let mut touched = std::collections::BTreeSet::new();
                touch([a, b, c].map(|p| p - 0.5), reach, |x, y, depth| {
                    assert_eq!(depth >= 0.0, covered([a, b, c], 0.0).contains(&(y as usize * SIZE.0 + x as usize)));
                    touched.insert((x, y));
                });
                touched
            };
            let inside = touched(0.0);
            assert_eq!(inside.len(), covered([a, b, c], 0.0).len());
            let around = touched(1.0);
            // All eight neighbours of what is inside.
            let grown =
                inside.iter().flat_map(|&(x, y)| (-1..=1).flat_map(move |u| (-1..=1).map(move |v| (x + u, y + v))));
            assert!(grown.clone().all(|place| around.contains(&place)));
            assert!(around.len() < 3 * inside.len());
        }
    }

    #[test]
    fn the_nearer_triangle_is_kept_in_any_order() {
        let whole = [Vec2::ZERO, Vec2::new(40.0, 0.0), Vec2::new(0.0, 40.0)];
        // The second one leans through the first: it is nearer on the left of column 8.
        let triangles = [([4.0; 3], Vec3::X), ([8.0, -12.0, 8.0], Vec3::Y)];
        for order in [[0, 1], [1, 0]] {
            let mut canvas = Canvas::new(SIZE, |_, _| Vec3::ZERO);
            for (nearness, colour) in order.map(|index| triangles[index]) {
                canvas.fill(whole, nearness, |_, _| colour);
            }
            for (x, wanted) in [(0, Vec3::Y), (3, Vec3::Y), (4, Vec3::X), (7, Vec3::X)] {
                assert!(canvas.pixel(x, 2, 2).all(|sample| sample == (wanted, true)), "column {x}");
            }
        }
        let mut canvas = Canvas::new(SIZE, |x, y| Vec3::splat((y * 100 + x) as f32));
        let samples: Vec<(Vec3, bool)> = canvas.pixel(3, 2, 2).collect();
        assert_eq!(samples, [406.0, 407.0, 506.0, 507.0].map(|value| (Vec3::splat(value), false)));
        for (_, colour) in triangles {
            canvas.fill(whole, [1.0; 3], |_, _| colour);
        }
        assert_eq!(canvas.pixel(3, 2, 2).next(), Some((Vec3::X, true)));
    }
}
