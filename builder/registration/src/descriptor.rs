//! What a frame looks like, whichever way it faces: the surface and the distances to it on a grid in cylinder coordinates about
//! the body, with frequencies of the angle instead of angles (Prada 2016, section 4 and A.1).
//!
//! The indicator of cell (a, m, n) holds the share of the surface's area that lies in it. That includes the factor m of A.1,
//! which stands for the size of a cell.

use std::f32::consts::TAU;

use geometry::kd::KdTree;
use glam::{Vec2, Vec3};

use super::surface::Surface;

/// Samples of the surface.
const SAMPLES: usize = 20_000;
/// Radius and half the height of the grid, metres on a person.
const EXTENT: f32 = 1.25;

/// How frames are described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DescriptorOptions {
    /// N: the grid has 2 N angles, N / 2 radii and N heights. 64 in the paper.
    pub resolution: usize,
    /// Frequencies of the angle that are kept; all N + 1 in the paper.
    pub frequencies: usize,
    /// Distances beyond count as this, metres on a person; infinite in the paper.
    pub farthest: f32,
}

impl Default for DescriptorOptions {
    fn default() -> Self {
        Self { resolution: 32, frequencies: 16, farthest: 0.15 }
    }
}

impl DescriptorOptions {
    /// As printed in A.1.
    #[must_use]
    pub fn printed() -> Self {
        Self { resolution: 64, frequencies: 65, farthest: f32::INFINITY }
    }

    /// Cells of one angle.
    fn cells(&self) -> usize {
        self.resolution / 2 * self.resolution
    }
}

/// A complex number.
pub(crate) type Complex = Vec2;

/// The descriptor of a frame: frequency by frequency, the cells of one angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Descriptor {
    /// Of the indicator of the surface.
    pub(crate) surface: Vec<Complex>,
    /// Of the squared distances to it.
    pub(crate) distances: Vec<Complex>,
    pub(crate) options: DescriptorOptions,
}

/// The grid before frequencies are taken: cell by cell, the angles of each.
pub(crate) struct Grid {
    pub surface: Vec<f32>,
    pub distances: Vec<f32>,
}

impl Descriptor {
    /// Describes `surface`; `scale` as [`scale_of`](super::template::scale_of) of the body, the same for all frames.
    #[must_use]
    pub fn new(surface: &Surface, scale: f32, options: &DescriptorOptions) -> Self {
        let grid = Grid::new(surface, scale, options);
        Self {
            surface: frequencies(&grid.surface, options),
            distances: frequencies(&grid.distances, options),
            options: *options,
        }
    }
}

impl Grid {
    pub fn new(surface: &Surface, scale: f32, options: &DescriptorOptions) -> Self {
        let n = options.resolution;
        let (angles, radii, heights) = (2 * n, n / 2, n);
        let size = EXTENT * scale;
        let centre = surface.centroid();
        let points: Vec<Vec3> = samples(surface).iter().map(|p| *p - centre).collect();
        let mut indicator = vec![0.0; angles * options.cells()];
        let share = 1.0 / points.len().max(1) as f32;
        for p in &points {
            let angle = (p.x.atan2(p.z) / TAU * angles as f32).rem_euclid(angles as f32);
            let radius = (p.x.hypot(p.z) / size * radii as f32) as usize;
            let height = (p.y / size * 0.5 + 0.5) * heights as f32;
            // What sticks out counts where it left.
            let (radius, height) = (radius.min(radii - 1), height.clamp(0.0, heights as f32 - 1.0) as usize);
            indicator[(radius * heights + height) * angles + (angle as usize).min(angles - 1)] += share;
        }
        let tree = KdTree::new(&points.iter().map(Vec3::to_array).collect::<Vec<_>>());
        let farthest = (options.farthest * scale).powi(2);
        let mut distances = Vec::with_capacity(indicator.len());
        for radius in 0..radii {
            for height in 0..heights {
                for angle in 0..angles {
                    let turn = (angle as f32 + 0.5) / angles as f32 * TAU;
                    let out = (radius as f32 + 0.5) / radii as f32 * size;
                    let up = ((height as f32 + 0.5) / heights as f32 * 2.0 - 1.0) * size;
                    let place = [out * turn.sin(), up, out * turn.cos()];
                    let squared = tree.nearest(place, farthest).map_or(farthest, |(_, squared)| squared);
                    distances.push(squared / (scale * scale));
                }
            }
        }
        Self { surface: indicator, distances }
    }
}

/// Points spread evenly over a surface: as many a triangle as its area asks for, what is left over handed to the next one.
fn samples(surface: &Surface) -> Vec<Vec3> {
    let mesh = &surface.mesh;
    let spacing = f64::from(surface.area()) / SAMPLES as f64;
    let (mut points, mut owed) = (Vec::with_capacity(SAMPLES + 1), 0.5);
    let mut number = 0.0_f64;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        owed += f64::from((b - a).cross(c - a).length()) * 0.5 / spacing.max(1e-12);
        while owed >= 1.0 && points.len() < 2 * SAMPLES {
            owed -= 1.0;
            number += 1.0;
            // Additive sequence of the plastic number (Roberts 2018), folded into the triangle.
            let (u, v) = ((number * 0.754_877_666_246_692_7).fract(), (number * 0.569_840_290_998_053_2).fract());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            points.push(a + (b - a) * u as f32 + (c - a) * v as f32);
        }
    }
    points
}

/// The lowest frequencies of the angles of each cell: X_f = sum_a x_a exp(-2 pi i f a / 2N), frequency by frequency.
fn frequencies(grid: &[f32], options: &DescriptorOptions) -> Vec<Complex> {
    let (angles, cells) = (2 * options.resolution, options.cells());
    let waves: Vec<Complex> = (0..angles).map(|a| Vec2::from_angle(-TAU * a as f32 / angles as f32)).collect();
    let mut out = vec![Complex::ZERO; options.frequencies * cells];
    for (cell, values) in grid.chunks_exact(angles).enumerate() {
        for frequency in 0..options.frequencies {
            let mut sum = Complex::ZERO;
            for (angle, &value) in values.iter().enumerate() {
                sum += waves[frequency * angle % angles] * value;
            }
            out[frequency * cells + cell] = sum;
        }
    }
    out
}
