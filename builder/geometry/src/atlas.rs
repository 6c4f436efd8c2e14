//! The texture atlas: charts flattened and packed, and which point of the surface lies under each texel.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::charts;
use super::flatten::flatten;
use super::mesh::Mesh;
use super::raster::cover;

/// Texels kept free around every chart.
pub const PADDING: usize = 5;
/// A triangle may not lose more than all but this share of its area when it is flattened.
const LEAST_AREA: f32 = 0.04;
/// A texel on the edge of two triangles belongs to the first of them, even where rounding puts it beside both.
const NEAR: f32 = 1e-4;
/// What lies on an edge counts as covered by neither triangle where charts are asked whether they lie over themselves.
const INSIDE: f32 = -1e-4;
const NONE: u32 = u32::MAX;

/// A point of the surface: a triangle and barycentric coordinates in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The triangle.
    pub triangle: u32,
    /// Barycentric coordinates of its corners.
    pub weights: Vec3,
}

/// Texture coordinates of every corner, and the texels.
#[derive(Clone, Debug)]
pub struct Atlas {
    /// Width and height of the texture.
    pub size: usize,
    /// For each triangle the texture coordinates of its corners in [0, 1], v downwards.
    pub uvs: Vec<[Vec2; 3]>,
    /// Chart of each triangle.
    pub chart_of_triangle: Vec<u32>,
    /// The texels inside charts: their index (row by row, from the top) and the point of the surface under each.
    pub texels: Vec<(u32, SurfacePoint)>,
}

/// A chart before it is flattened.
struct Chart {
    triangles: Vec<u32>,
    density: f32,
}

struct Flat {
    triangles: Vec<u32>,
    /// Corner places in metres times density, from (0, 0) upwards.
    corners: Vec<[Vec2; 3]>,
    extent: Vec2,
    /// Smallest ratio of a triangle's area in the plane to its area in space; negative where it is turned over.
    squash: f32,
}

impl Atlas {
    /// Flattens and packs `mesh`, cut into `charts` that are discs ([`charts::cut`]), for a texture of `size` by `size` texels.
    /// `density` says of a chart how many texels it should have per unit of length, relative to other charts. A chart that
    /// would lie over itself is divided.
    #[must_use]
    pub fn new(mesh: &Mesh, size: usize, charts: Vec<Vec<u32>>, density: impl Fn(&[u32]) -> f32) -> Self {
        let mut flats = lay_out_all(mesh, charts, &density);
        flats.sort_by(|a, b| b.extent.y.total_cmp(&a.extent.y));
        let (scale, places) = pack(&flats, size);
        let mut uvs = vec![[Vec2::ZERO; 3]; mesh.triangles.len()];
        let mut chart_of_triangle = vec![0; mesh.triangles.len()];
        for (index, (flat, place)) in flats.iter().zip(&places).enumerate() {
            for (&triangle, corners) in flat.triangles.iter().zip(&flat.corners) {
                uvs[triangle as usize] = corners.map(|corner| (*place + corner * scale) / size as f32);
                chart_of_triangle[triangle as usize] = index as u32;
            }
        }
        let texels = texels(&uvs, size);
        Self { size, uvs, chart_of_triangle, texels }
    }

    /// Number of charts.
    #[must_use]
    pub fn chart_count(&self) -> usize {
        self.chart_of_triangle.iter().max().map_or(0, |&chart| chart as usize + 1)
    }

    /// Spreads the colours of `image` from the charts into the free texels around them, [`PADDING`] texels and more.
    pub fn dilate(&self, image: &mut [[u8; 3]]) {
        let size = self.size;
        let mut filled = vec![false; size * size];
        for &(index, _) in &self.texels {
            filled[index as usize] = true;
        }
        let mut front: Vec<u32> = self.texels.iter().map(|texel| texel.0).collect();
        for _ in 0..PADDING + 11 {
            let mut next = Vec::new();
            for &index in &front {
                let (x, y) = (index as usize % size, index as usize / size);
                let near = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
                for (x, y) in near {
                    if x < size && y < size && !filled[y * size + x] {
                        filled[y * size + x] = true;
                        image[y * size + x] = image[index as usize];
                        next.push((y * size + x) as u32);
                    }
                }
            }
            front = next;
        }
    }
}

/// Flattens all charts; one that would lie over itself is divided.
fn lay_out_all(mesh: &Mesh, charts: Vec<Vec<u32>>, density: &dyn Fn(&[u32]) -> f32) -> Vec<Flat> {
    let dense = |triangles: Vec<u32>| Chart { density: density(&triangles), triangles };
    let mut open: Vec<Chart> = charts.into_iter().map(dense).collect();
    let mut flats = Vec::new();
    while !open.is_empty() {
        let laid: Vec<Flat> = open.par_iter().map(|chart| lay_out(mesh, chart)).collect();
        let mut divided = Vec::new();
        for (chart, flat) in open.iter().zip(laid) {
            if chart.triangles.len() > 2 && overlaps_itself(&flat) {
                divided.extend(charts::divide(mesh, &chart.triangles).into_iter().map(dense));
            } else {
                flats.push(flat);
            }
        }
        open = divided;
    }
    flats
}

/// Whether a triangle is turned over or squashed, or a point lies in two triangles, as far as a raster over the chart tells.
fn overlaps_itself(flat: &Flat) -> bool {
    let size = 768;
    let scale = 1.0 / flat.extent.max_element().max(1e-9);
    let mut used = vec![false; size * size];
    let mut twice = flat.squash < LEAST_AREA;
    for corners in &flat.corners {
        cover(corners.map(|corner| corner * scale * size as f32), (size, size), INSIDE, |index, _| {
            twice |= used[index];
            used[index] = true;
        });
    }
    twice
}

fn lay_out(mesh: &Mesh, chart: &Chart) -> Flat {
    let (triangles, count) = charts::weld_corners(mesh, &chart.triangles);
    let spatial: Vec<[Vec3; 3]> =
        chart.triangles.iter().map(|&t| mesh.triangles[t as usize].map(|v| mesh.positions[v as usize])).collect();
    let places = flatten(&triangles, &spatial, count);
    let bounds = |turn: Vec2| {
        let turned = places.iter().map(|p| turn.rotate(*p));
        let (low, high) = turned.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        (low, high - low)
    };
    // The turn with the smallest box, lying on its longer side.
    let mut best = (f32::INFINITY, Vec2::X);
    for step in 0..36 {
        let turn = Vec2::from_angle(step as f32 * 5.0_f32.to_radians());
        let (_, extent) = bounds(turn);
        if extent.x * extent.y < best.0 * 0.999 && extent.x <= extent.y {
            best = (extent.x * extent.y, turn);
        }
    }
    let (low, extent) = bounds(best.1);
    let corners =
        triangles.iter().map(|t| t.map(|v| (best.1.rotate(places[v as usize]) - low) * chart.density)).collect();
    let squash = triangles.iter().zip(&spatial).map(|(t, corners)| {
        let [a, b, c] = t.map(|v| places[v as usize]);
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        (b - a).perp_dot(c - a) / area.max(1e-12)
    });
    let squash = squash.fold(f32::INFINITY, f32::min);
    Flat { triangles: chart.triangles.clone(), corners, extent: extent * chart.density, squash }
}

/// Texels per unit, and the place of each chart, tallest first, on shelves.
fn pack(flats: &[Flat], size: usize) -> (f32, Vec<Vec2>) {
    let (mut low, mut high) = (0.0, size as f32 * 4.0);
    let mut best = (size as f32 * 1e-3, vec![Vec2::splat(PADDING as f32); flats.len()]);
    for _ in 0..30 {
        let scale = 0.5 * (low + high);
        match shelves(flats, scale, size as f32) {
            Some(places) => {
                best = (scale, places);
                low = scale;
            }
            None => high = scale,
        }
    }
    best
}

fn shelves(flats: &[Flat], scale: f32, size: f32) -> Option<Vec<Vec2>> {
    let padding = PADDING as f32;
    // Where the next chart of each shelf would stand, and the shelf's height.
    let mut shelves: Vec<(Vec2, f32)> = Vec::new();
    let mut top = 0.0;
    let mut places = Vec::with_capacity(flats.len());
    for flat in flats {
        let needed = (flat.extent * scale + Vec2::splat(2.0 * padding)).ceil();
        let fitting = shelves.iter().position(|(at, height)| at.x + needed.x <= size && needed.y <= *height);
        let place = match fitting {
            Some(index) => {
                let at = shelves[index].0;
                shelves[index].0.x += needed.x;
                at
            }
            None => {
                if top + needed.y > size || needed.x > size {
                    return None;
                }
                let at = Vec2::new(0.0, top);
                shelves.push((Vec2::new(needed.x, top), needed.y));
                top += needed.y;
                at
            }
        };
        places.push(place + Vec2::splat(padding));
    }
    Some(places)
}

/// Rasterises all charts: a texel belongs to the triangle that holds its centre.
fn texels(uvs: &[[Vec2; 3]], size: usize) -> Vec<(u32, SurfacePoint)> {
    let mut owner = vec![(NONE, Vec3::ZERO); size * size];
    for (triangle, corners) in uvs.iter().enumerate() {
        cover(corners.map(|corner| corner * size as f32), (size, size), NEAR, |index, weights| {
            if owner[index].0 == NONE {
                owner[index] = (triangle as u32, weights.max(Vec3::ZERO));
            }
        });
    }
    owner
        .iter()
        .enumerate()
        .filter(|(_, (triangle, _))| *triangle != NONE)
        .map(|(index, &(triangle, weights))| (index as u32, SurfacePoint { triangle, weights }))
        .collect()
}

/// Texels of a texture of `size` by `size` that lie within two triangles or more.
#[must_use]
pub fn overlaps(uvs: &[[Vec2; 3]], size: usize) -> usize {
    let mut used = vec![0_u8; size * size];
    for corners in uvs {
        cover(corners.map(|corner| corner * size as f32), (size, size), INSIDE, |index, _| {
            used[index] = used[index].saturating_add(1);
        });
    }
    used.iter().filter(|&&count| count > 1).count()
}
