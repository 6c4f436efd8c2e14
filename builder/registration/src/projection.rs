//! What a frame's surface looks like, brought into the template's atlas: for every texel the frame's surface is looked up where
//! the template lies on it.

use geometry::atlas::Atlas;
use geometry::charts;
use geometry::raster::cover;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::surface::{Surface, SurfacePoint};
use super::track::Target;

/// A texel farther from the frame's surface is a hole, metres on a person; so is one that faces another way.
const FARTHEST: f32 = 0.01;
const LEAST_COSINE: f32 = 0.5;
/// Texels of a frame's own texture that are spread from its charts outwards, so that none is blended with what lies between.
const SPREAD: usize = 4;

/// A picture in sRGB, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Width in texels.
    pub width: usize,
    /// Height in texels.
    pub height: usize,
    /// Its texels.
    pub texels: Vec<[u8; 3]>,
}

/// The template's atlas.
#[derive(Debug)]
pub struct Projection {
    /// Charts and texels.
    pub atlas: Atlas,
    scale: f32,
}

/// A frame's colours in the template's atlas.
#[derive(Clone, Debug)]
pub struct Projected {
    /// Colours of all texels; those of holes and between charts are black.
    pub texels: Vec<[u8; 3]>,
    /// Texels in charts of which the frame says nothing, ascending.
    pub holes: Vec<u32>,
}

impl Projection {
    /// An atlas of `size` by `size` texels for `template`, as dense everywhere; `scale` as
    /// [`Template::scale`](super::template::Template::scale).
    #[must_use]
    pub fn new(template: &Surface, scale: f32, size: usize) -> Self {
        let mesh = &template.mesh;
        // Sides of the body: what faces the same way lies flat best.
        let side = |triangle: u32| {
            let (_, normal) = charts::centre_and_normal(mesh, triangle);
            let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
            2 * axis + usize::from(normal[axis] < 0.0)
        };
        let labels = (0..mesh.triangles.len() as u32).map(side).collect();
        Self { atlas: Atlas::new(mesh, size, charts::cut(mesh, labels), |_| 1.0), scale }
    }

    /// The colours of `target`, on which `posed`, the template, lies: from its `texture`, by the texture coordinates `uvs` of its
    /// triangles' corners, or from its vertices.
    #[must_use]
    pub fn project(&self, posed: &Surface, target: &Target, uvs: &[[Vec2; 3]], texture: Option<&Texture>) -> Projected {
        let spread = texture.filter(|_| !uvs.is_empty()).map(|texture| texture.spread(uvs));
        let colour = |point: &SurfacePoint| -> Option<Vec3> {
            if let (Some(texture), Some(corners)) = (&spread, uvs.get(point.triangle as usize)) {
                let [a, b, c] = *corners;
                return Some(texture.at(a * point.weights.x + b * point.weights.y + c * point.weights.z));
            }
            let colours = target.surface.colours.as_ref()?;
            Some(target.surface.interpolated(colours, point.triangle, point.weights) * 255.0)
        };
        let mesh = &posed.mesh;
        let find = |(_, texel): &(u32, geometry::atlas::SurfacePoint)| -> Option<[u8; 3]> {
            let [a, b, c] = mesh.triangles[texel.triangle as usize].map(|v| mesh.positions[v as usize]);
            let place = a * texel.weights.x + b * texel.weights.y + c * texel.weights.z;
            let normal = posed.interpolated(&posed.normals, texel.triangle, texel.weights).normalize_or_zero();
            let found = target.closest(place, normal)?;
            let near = found.position.distance(place) < FARTHEST * self.scale;
            if near && found.normal.dot(normal) > LEAST_COSINE { colour(&found).map(bytes) } else { None }
        };
        let found: Vec<Option<[u8; 3]>> = self.atlas.texels.par_iter().map(find).collect();
        let mut projected = Projected { texels: vec![[0; 3]; self.atlas.size * self.atlas.size], holes: Vec::new() };
        for ((index, _), colour) in self.atlas.texels.iter().zip(found) {
            match colour {
                Some(colour) => projected.texels[*index as usize] = colour,
                None => projected.holes.push(*index),
            }
        }
        projected
    }

    /// Fills the holes of `projected`: from `other`, a texture in the same atlas without any, or from around them; then spreads
    /// the charts' borders.
    pub fn complete(&self, projected: &mut Projected, other: Option<&[[u8; 3]]>) {
        match other {
            Some(other) => {
                projected.holes.iter().for_each(|&k| projected.texels[k as usize] = other[k as usize]);
            }
            None => self.fill(projected),
        }
        self.atlas.dilate(&mut projected.texels);
    }

    /// Fills holes from their border inwards, each texel with the mean of what is known around it.
    fn fill(&self, projected: &mut Projected) {
        let size = self.atlas.size;
        let mut known = vec![false; size * size];
        self.atlas.texels.iter().for_each(|(k, _)| known[*k as usize] = true);
        projected.holes.iter().for_each(|&k| known[k as usize] = false);
        let mut open = projected.holes.clone();
        while !open.is_empty() {
            let mut filled = Vec::new();
            for &k in &open {
                let (x, y) = (k as usize % size, k as usize / size);
                let near = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
                let near = near.iter().filter(|&&(x, y)| x < size && y < size && known[y * size + x]);
                let (mut sum, mut count) = (Vec3::ZERO, 0.0);
                for &(x, y) in near {
                    sum += Vec3::from(projected.texels[y * size + x].map(f32::from));
                    count += 1.0;
                }
                if count > 0.0 {
                    filled.push((k, bytes(sum / count)));
                }
            }
            if filled.is_empty() {
                // A chart of which nothing is known: the mean of all that is.
                let all = || self.atlas.texels.iter().filter(|(k, _)| known[*k as usize]);
                let sum: Vec3 = all().map(|(k, _)| Vec3::from(projected.texels[*k as usize].map(f32::from))).sum();
                let mean = bytes(sum / all().count().max(1) as f32);
                open.drain(..).for_each(|k| projected.texels[k as usize] = mean);
            }
            for &(k, colour) in &filled {
                projected.texels[k as usize] = colour;
                known[k as usize] = true;
            }
            open.retain(|&k| !known[k as usize]);
        }
    }
}

fn bytes(colour: Vec3) -> [u8; 3] {
    colour.to_array().map(|c| c.clamp(0.0, 255.0).round() as u8)
}

impl Texture {
    /// The colours, 0 to 1, of the `count` vertices of `triangles`, whose corners have the texture coordinates `uvs`: means of what lies
    /// around each, for one texel tells little.
    #[must_use]
    pub fn of_vertices(&self, count: usize, triangles: &[[u32; 3]], uvs: &[[Vec2; 3]]) -> Vec<Vec3> {
        let mut sums = vec![(Vec3::ZERO, 0.0); count];
        for (triangle, corners) in triangles.iter().zip(uvs) {
            let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
            for (&vertex, corner) in triangle.iter().zip(corners) {
                for share in [0.2, 0.5, 0.8] {
                    let (sum, samples) = &mut sums[vertex as usize];
                    *sum += self.at(corner.lerp(centre, share)) / 255.0;
                    *samples += 1.0;
                }
            }
        }
        sums.into_iter().map(|(sum, samples)| sum / f32::max(samples, 1.0)).collect()
    }

    /// The texture with the borders of its charts, which `uvs` say, spread outwards.
    fn spread(&self, uvs: &[[Vec2; 3]]) -> Self {
        let size = Vec2::new(self.width as f32, self.height as f32);
        let mut known = vec![false; self.texels.len()];
        for corners in uvs {
            cover(corners.map(|uv| uv * size), (self.width, self.height), 0.0, |k, _| known[k] = true);
        }
        let mut texels = self.texels.clone();
        let mut front: Vec<usize> = (0..known.len()).filter(|&k| known[k]).collect();
        for _ in 0..SPREAD {
            let mut next = Vec::new();
            for &k in &front {
                let (x, y) = (k % self.width, k / self.width);
                for (x, y) in [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)] {
                    if x < self.width && y < self.height && !known[y * self.width + x] {
                        known[y * self.width + x] = true;
                        texels[y * self.width + x] = texels[k];
                        next.push(y * self.width + x);
                    }
                }
            }
            front = next;
        }
        Self { texels, ..*self }
    }

    /// The colour at a place of the unit square, v downwards, between texels; 0 to 255.
    #[must_use]
    pub fn at(&self, uv: Vec2) -> Vec3 {
        let place = (uv * Vec2::new(self.width as f32, self.height as f32) - 0.5)
            .clamp(Vec2::ZERO, Vec2::new(self.width as f32 - 1.0, self.height as f32 - 1.0));
        let (low, part) = (place.floor(), place.fract());
        let of = |x: usize, y: usize| {
            let (x, y) = ((low.x as usize + x).min(self.width - 1), (low.y as usize + y).min(self.height - 1));
            Vec3::from(self.texels[y * self.width + x].map(f32::from))
        };
        of(0, 0).lerp(of(1, 0), part.x).lerp(of(0, 1).lerp(of(1, 1), part.x), part.y)
    }
}

#[cfg(test)]
mod tests {
    use geometry::mesh::Mesh;
    use geometry::polygonise::polygonise;

    use super::*;

    fn ball(cell: f32) -> Mesh {
        polygonise(Vec3::splat(-0.7), Vec3::splat(0.7), cell, |p| p.length() - 0.5)
    }

    fn pattern(p: Vec3) -> Vec3 {
        Vec3::splat(0.5) + 0.4 * Vec3::new((7.0 * p.x).sin(), (5.0 * p.y).cos(), (6.0 * p.z).sin())
    }

    #[test]
    fn colours_of_vertices_come_over_and_holes_are_known() {
        let mesh = ball(0.05);
        let template = Surface::new(mesh.clone(), None);
        let scanned = ball(0.031);
        // A lid is missing from the scan.
        let triangles = scanned.triangles.iter().filter(|t| t.iter().any(|&v| scanned.positions[v as usize].y < 0.4));
        let scanned = Mesh { triangles: triangles.copied().collect(), ..scanned }.compact();
        let colours = scanned.positions.iter().map(|p| pattern(*p)).collect();
        let target = Target::new(Surface::new(scanned, Some(colours)), 1.0);
        let projection = Projection::new(&template, 1.0, 256);
        let mut projected = projection.project(&template, &target, &[], None);
        let place = |texel: &geometry::atlas::SurfacePoint| {
            let [a, b, c] = mesh.triangles[texel.triangle as usize].map(|v| mesh.positions[v as usize]);
            a * texel.weights.x + b * texel.weights.y + c * texel.weights.z
        };
        let (mut worst, mut missed) = (0.0_f32, 0);
        for (k, texel) in &projection.atlas.texels {
            let p = place(texel);
            let hole = projected.holes.binary_search(k).is_ok();
            if p.y < 0.38 && hole {
                // Beside a sliver the triangles around the nearest vertex are not always the nearest ones.
                missed += 1;
            } else if p.y < 0.38 {
                let found = Vec3::from(projected.texels[*k as usize].map(f32::from)) / 255.0;
                worst = worst.max((found - pattern(p)).abs().max_element());
            } else if p.y > 0.46 {
                assert!(hole, "{p}");
            }
        }
        assert!(worst < 0.04 && 500 * missed < projection.atlas.texels.len(), "{worst}, {missed}");
        projection.complete(&mut projected, None);
        for (k, _) in &projection.atlas.texels {
            assert_ne!(projected.texels[*k as usize], [0; 3]);
        }
    }

    #[test]
    fn vertices_have_the_colours_around_them() {
        let triangles = [[0, 1, 2], [2, 1, 3]];
        let places = [Vec2::new(0.1, 0.1), Vec2::new(0.1, 0.9), Vec2::new(0.9, 0.1), Vec2::new(0.9, 0.9)];
        let uvs = triangles.map(|t| t.map(|v: u32| places[v as usize]));
        let texels = (0..64 * 64).map(|k| if k % 64 < 32 { [255, 0, 0] } else { [0, 0, 255] }).collect();
        let texture = Texture { width: 64, height: 64, texels };
        let colours = texture.of_vertices(5, &triangles, &uvs);
        // Left is red, right is blue; nothing lies around the last.
        assert!(colours[0].x > 0.99 && colours[3].z > 0.99 && colours[1].x > 0.6 && colours[2].z > 0.6, "{colours:?}");
        assert_eq!(colours[4], Vec3::ZERO);
    }

    #[test]
    fn textures_come_over_without_what_lies_between_charts() {
        // A sheet whose texture fills a quarter of its picture; the rest is red.
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::new(1.0, 0.0, 1.0)],
            triangles: vec![[0, 1, 2], [2, 1, 3]],
        };
        let uv = |v: u32| Vec2::new(mesh.positions[v as usize].x, mesh.positions[v as usize].z) * 0.5;
        let uvs: Vec<[Vec2; 3]> = mesh.triangles.iter().map(|t| t.map(uv)).collect();
        let ramp = |x: usize, y: usize| if x < 32 && y < 32 { [0, 4 * x as u8, 4 * y as u8] } else { [255, 0, 0] };
        let texels = (0..64 * 64).map(|k| ramp(k % 64, k / 64)).collect();
        let texture = Texture { width: 64, height: 64, texels };
        let surface = Surface::new(mesh.clone(), None);
        let target = Target::new(surface.clone(), 1.0);
        let projection = Projection::new(&surface, 1.0, 128);
        let projected = projection.project(&surface, &target, &uvs, Some(&texture));
        assert!(projected.holes.is_empty());
        for (k, texel) in &projection.atlas.texels {
            let [a, b, c] = mesh.triangles[texel.triangle as usize].map(|v| mesh.positions[v as usize]);
            let p = a * texel.weights.x + b * texel.weights.y + c * texel.weights.z;
            let [red, green, blue] = projected.texels[*k as usize].map(f32::from);
            assert_eq!(red, 0.0, "{p}");
            let wanted = |x: f32| 4.0 * (32.0 * x - 0.5).clamp(0.0, 31.0);
            assert!((green - wanted(p.x)).abs() < 1.6 && (blue - wanted(p.z)).abs() < 1.6, "{p} {green} {blue}");
        }
    }
}
