//! The signed distance to a posed surface on a lattice, near the surface: what a studio's reconstruction sees of a body, with parts
//! that nearly touch grown together.

use geometry::closest::closest_of_triangle;
use glam::{IVec3, Vec3};

/// Distances to a surface at the points of a lattice; beyond `band` they are that, with their sign.
pub(super) struct Lattice {
    pub low: Vec3,
    pub high: Vec3,
    cell: f32,
    size: IVec3,
    values: Vec<f32>,
    band: f32,
}

impl Lattice {
    /// For a closed surface, which may pass through itself: inside is what it winds around.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]], cell: f32, band: f32) -> Self {
        let wide = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = positions.iter().fold(wide, |(low, high), &p| (low.min(p), high.max(p)));
        let (low, high) = (low - band - 2.0 * cell, high + band + 2.0 * cell);
        let size = ((high - low) / cell).ceil().as_ivec3() + IVec3::ONE;
        let count = size.as_uvec3().element_product() as usize;
        let mut lattice = Self { low, high, cell, size, values: vec![band; count], band };
        let mut crossings = vec![0_i32; count];
        for triangle in triangles {
            let corners = triangle.map(|v| positions[v as usize]);
            lattice.measure(corners);
            lattice.cross(corners, &mut crossings);
        }
        for column in 0..(size.x * size.y) as usize {
            let mut winding = 0;
            for z in 0..size.z as usize {
                let at = z * (size.x * size.y) as usize + column;
                winding += crossings[at];
                if winding > 0 {
                    lattice.values[at] = -lattice.values[at];
                }
            }
        }
        lattice
    }

    fn index(&self, at: IVec3) -> Option<usize> {
        let inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(self.size).all();
        inside.then(|| ((at.z * self.size.y + at.y) * self.size.x + at.x) as usize)
    }

    /// Keeps the distances to a triangle where they are the least.
    fn measure(&mut self, corners: [Vec3; 3]) {
        let [a, b, c] = corners;
        let first = ((a.min(b).min(c) - self.band - self.low) / self.cell).ceil().as_ivec3().max(IVec3::ZERO);
        let last = ((a.max(b).max(c) + self.band - self.low) / self.cell).floor().as_ivec3().min(self.size - 1);
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let at = IVec3::new(x, y, z);
                    let place = self.low + at.as_vec3() * self.cell;
                    let weights = closest_of_triangle(place, corners);
                    let distance = (a * weights.x + b * weights.y + c * weights.z).distance(place);
                    if let Some(index) = self.index(at) {
                        self.values[index] = self.values[index].min(distance);
                    }
                }
            }
        }
    }

    /// Counts where lines along z enter and leave through a triangle: at the first point above.
    fn cross(&self, corners: [Vec3; 3], crossings: &mut [i32]) {
        let [a, b, c] = corners.map(|p| ((p - self.low) / self.cell).as_dvec3());
        let doubled = (b - a).truncate().perp_dot((c - a).truncate());
        if doubled == 0.0 {
            return;
        }
        let (least, most) = (a.min(b).min(c), a.max(b).max(c));
        for y in least.y.ceil() as i32..=most.y.floor() as i32 {
            for x in least.x.ceil() as i32..=most.x.floor() as i32 {
                let p = glam::DVec2::new(f64::from(x), f64::from(y));
                let of =
                    |q: glam::DVec3, r: glam::DVec3| (r.truncate() - q.truncate()).perp_dot(p - q.truncate()) / doubled;
                let weights = [of(b, c), of(c, a), of(a, b)];
                if weights.iter().all(|weight| *weight >= 0.0) {
                    let z = a.z * weights[0] + b.z * weights[1] + c.z * weights[2];
                    if let Some(index) = self.index(IVec3::new(x, y, z.ceil() as i32)) {
                        // Upwards through a side that faces down is inwards.
                        crossings[index] += if doubled < 0.0 { 1 } else { -1 };
                    }
                }
            }
        }
    }

    /// The value at a point of the lattice.
    pub fn at_point(&self, place: Vec3) -> f32 {
        let at = ((place - self.low) / self.cell).round().as_ivec3();
        self.index(at).map_or(self.band, |index| self.values[index])
    }

    /// The value anywhere, between the points around.
    pub fn at(&self, place: Vec3) -> f32 {
        let scaled = (place - self.low) / self.cell;
        let (corner, part) = (scaled.floor().as_ivec3(), scaled - scaled.floor());
        let value = |x: i32, y: i32, z: i32| {
            self.index(corner + IVec3::new(x, y, z)).map_or(self.band, |index| self.values[index])
        };
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let row = |y: i32, z: i32| mix(value(0, y, z), value(1, y, z), part.x);
        let sheet = |z: i32| mix(row(0, z), row(1, z), part.y);
        mix(sheet(0), sheet(1), part.z)
    }

    /// The nearest point where the value is `level`, by a few Newton steps.
    pub fn project(&self, mut place: Vec3, level: f32) -> Vec3 {
        let step = 0.5 * self.cell;
        for _ in 0..4 {
            let off = self.at(place) - level;
            if off.abs() < 1e-4 {
                break;
            }
            let along = |axis: Vec3| self.at(place + axis * step) - self.at(place - axis * step);
            let gradient = Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)) / (2.0 * step);
            place -= gradient.normalize_or_zero() * off.clamp(-self.cell, self.cell);
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use geometry::polygonise::polygonise;

    use super::*;

    #[test]
    fn distances_are_those_of_two_balls_that_overlap() {
        let ball = |centre: Vec3, radius: f32| {
            polygonise(Vec3::splat(-1.0), Vec3::splat(1.0), 0.03, |p| p.distance(centre) - radius)
        };
        let centres = [Vec3::new(-0.1, 0.013, 0.0), Vec3::new(0.17, 0.1, 0.05)];
        let (mut one, other) = (ball(centres[0], 0.3), ball(centres[1], 0.25));
        let first = one.positions.len() as u32;
        one.positions.extend(other.positions);
        one.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
        let lattice = Lattice::new(&one.positions, &one.triangles, 0.023, 0.05);
        for k in 0..4000_u64 {
            let random = |n: u64| kernels::random::signed(3, 3 * k + n);
            let place = 0.5 * Vec3::new(random(0), random(1), random(2));
            let of = |k: usize, radius: f32| place.distance(centres[k]) - radius;
            let (a, b) = (of(0, 0.3), of(1, 0.25));
            // Where both are seen, the surface of one that lies inside of the other counts, too.
            if a.min(b).abs() < 0.02 && a.max(b) > 0.05 {
                assert!((lattice.at(place) - a.min(b)).abs() < 0.006, "{place} {} {}", lattice.at(place), a.min(b));
            } else if a.min(b).abs() > 0.03 {
                assert_eq!(lattice.at(place) < 0.0, a.min(b) < 0.0, "{place}");
            }
        }
    }
}
