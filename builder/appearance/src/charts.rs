//! Which texels of the texture the surface uses, and to which chart of the atlas each belongs.
//!
//! A texel is active where bilinear filtering anywhere in a triangle can touch it: the triangles' own texels and a border
//! of one. Nothing in this crate looks across the border of a chart: the texel beside it shows another part of the
//! body.

use actor::surface::Surface;
use geometry::raster::touch;
use glam::Vec2;
use kernels::components::UnionFind;

use super::AppearanceError;

/// A triangle may lie at most this many times the texture's size away from it: beyond, a coordinate is a fault.
const MAX_TILES: f32 = 64.0;
/// Texels that two charts may share by rounding before they count as overlapping.
const INSIDE: f32 = 0.05;

/// The charts of an atlas over a grid of texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Charts {
    /// Width in texels.
    pub width: usize,
    /// Height in texels.
    pub height: usize,
    /// Chart of each texel, row-major, from 1; 0 where the texel is not active.
    pub labels: Vec<u32>,
}

/// What the atlas is like, beside its charts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AtlasFindings {
    /// Texels that triangles of different charts share: mirrored or overlapping parts.
    pub shared_texels: usize,
    /// Triangles that lie outside of the texture and are repeated into it.
    pub wrapped_triangles: usize,
}

impl Charts {
    /// Rasterises the triangles of `surface` that wear a texture over `width` by `height` texels. Charts that overlap
    /// become one; coordinates outside 0 to 1 repeat, as the player draws them.
    ///
    /// # Errors
    /// A texture coordinate that is no number or absurdly far away, or a surface without any textured triangle.
    pub fn new(surface: &Surface, width: u32, height: u32) -> Result<(Self, AtlasFindings), AppearanceError> {
        let (width, height) = (width as usize, height as usize);
        let mut charts = connected(surface);
        let mut raster = Raster { width, height, owner: vec![0; width * height] };
        let mut findings = AtlasFindings::default();
        for pass in [Pass::Inside, Pass::Border] {
            for part in &surface.parts {
                let textured = surface.materials.get(part.material as usize).is_some_and(|m| m.image.is_some());
                let triangles = part.first_triangle..part.first_triangle + part.triangle_count;
                for triangle in triangles.filter(|_| textured) {
                    let Some(&corners) = surface.triangles.get(triangle as usize) else { continue };
                    let uvs = corners.map(|c| surface.corners[c as usize].uv);
                    if uvs.as_flattened().iter().any(|x| !x.is_finite() || x.abs() > MAX_TILES) {
                        return Err(AppearanceError::Coordinate { triangle });
                    }
                    let outside = uvs.as_flattened().iter().any(|x| !(-1e-4..=1.0001).contains(x));
                    findings.wrapped_triangles += usize::from(outside && pass == Pass::Inside);
                    let size = Vec2::new(width as f32, height as f32);
                    // Texel centres at whole numbers.
                    let places = uvs.map(|uv| Vec2::from(uv) * size - 0.5);
                    findings.shared_texels += raster.draw(places, pass, corners[0], &mut charts);
                }
            }
        }
        if raster.owner.iter().all(|&owner| owner == 0) {
            return Err(AppearanceError::NoTexels);
        }
        Ok((Self { width, height, labels: raster.labels(&mut charts) }, findings))
    }

    /// One chart that is the whole texture.
    #[must_use]
    pub fn whole(width: usize, height: usize) -> Self {
        Self { width, height, labels: vec![1; width * height] }
    }

    /// Active texels, row-major.
    #[must_use]
    pub fn texels(&self) -> Vec<u32> {
        (0..self.labels.len() as u32).filter(|&texel| self.labels[texel as usize] != 0).collect()
    }

    /// The mask of [`texture::TextureModel`].
    #[must_use]
    pub fn active(&self) -> Vec<bool> {
        self.labels.iter().map(|&label| label != 0).collect()
    }

    /// The charts at half the resolution: a texel is active where one of its four is, and belongs to the chart with most.
    #[must_use]
    pub fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut labels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let mut four = [0; 4];
                for (slot, (dx, dy)) in four.iter_mut().zip([(0, 0), (1, 0), (0, 1), (1, 1)]) {
                    let (x, y) = (2 * x + dx, 2 * y + dy);
                    *slot = if x < self.width && y < self.height { self.labels[y * self.width + x] } else { 0 };
                }
                let votes = |label: u32| four.iter().filter(|&&other| other == label).count();
                let best =
                    four.iter().filter(|&&label| label != 0).max_by_key(|&&label| (votes(label), u32::MAX - label));
                labels.push(best.copied().unwrap_or(0));
            }
        }
        Self { width, height, labels }
    }

    /// Half the resolution, over and over, until neither side is longer than `longest`.
    #[must_use]
    pub fn at_most(&self, longest: usize) -> Self {
        let mut charts = self.clone();
        while charts.width.max(charts.height) > longest {
            charts = charts.halved();
        }
        charts
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Pass {
    /// Texels whose centre lies in a triangle.
    Inside,
    /// Texels that filtering near a triangle's edge touches.
    Border,
}

/// Corners that triangles connect: charts before overlaps are known.
fn connected(surface: &Surface) -> UnionFind {
    let mut forest = UnionFind::new(surface.corners.len());
    for &[a, b, c] in &surface.triangles {
        forest.join(a, b);
        forest.join(a, c);
    }
    forest
}

struct Raster {
    width: usize,
    height: usize,
    /// A corner of the triangle that owns each texel, plus one; 0 for none.
    owner: Vec<u32>,
}

impl Raster {
    /// Draws a triangle of the chart of `corner`; how many texels of other charts it covers.
    fn draw(&mut self, places: [Vec2; 3], pass: Pass, corner: u32, charts: &mut UnionFind) -> usize {
        let reach = if pass == Pass::Inside { 0.0 } else { 1.0 };
        let mut shared = 0;
        touch(places, reach, |x, y, depth| {
            let index =
                y.rem_euclid(self.height as i64) as usize * self.width + x.rem_euclid(self.width as i64) as usize;
            let owner = self.owner[index];
            if owner == 0 {
                self.owner[index] = corner + 1;
            } else if pass == Pass::Inside && depth > INSIDE && charts.root(owner - 1) != charts.root(corner) {
                charts.join(owner - 1, corner);
                shared += 1;
            }
        });
        shared
    }

    /// Numbers the charts in the order of their first texels.
    fn labels(&self, charts: &mut UnionFind) -> Vec<u32> {
        let mut number = std::collections::HashMap::new();
        let mut labels = Vec::with_capacity(self.owner.len());
        for &owner in &self.owner {
            labels.push(if owner == 0 {
                0
            } else {
                let next = number.len() as u32 + 1;
                *number.entry(charts.root(owner - 1)).or_insert(next)
            });
        }
        labels
    }
}
