//! Flow between two pictures on one surface: where what is seen at a vertex in the one picture is found in the other (optical flow on the
//! mesh, Prada et al. 2016, section 6.3), so that both can be moved onto each other while they are mixed.
//!
//! Colours are looked at at vertices. Coarse to fine, by how much they are made smooth along the surface, this minimises
//!
//! ```text
//! sum_i w_i |to(p_i + f_i) - from(p_i)|^2 + a sum_ij |f_i - f_j|^2
//! ```
//!
//! over tangential ways f, linearised where each vertex is found so far, by Gauss-Seidel steps.

use actor::carry::{Carried, Surface};
use glam::{Mat3, Vec3};

use crate::carried::foot_in;

/// How often colours are made smooth, on each level.
const SMOOTH: [usize; 4] = [96, 24, 6, 1];
/// How often a level is linearised anew.
const WARPS: usize = 4;
/// Steps of the solver for each.
const STEPS: usize = 10;
/// Weight of smoothness, in mean squares of the colours' gradients.
const STIFFNESS: f32 = 0.3;
/// Difference of colours beyond which one counts for little.
const WIDTH: f32 = 0.2;
/// The longest way, in parts of the body's largest extent.
const MOST: f32 = 0.06;
/// Edges along which a vertex may have been followed from one look to the next.
const WALK: usize = 64;
/// A flow is one where pictures differ by less than this part of what they did.
const LEAST_GAIN: f32 = 0.8;

/// What a vertex is surrounded by.
struct Net<'a> {
    places: &'a [Vec3],
    normals: Vec<Vec3>,
    triangles: &'a [[u32; 3]],
    /// Where the neighbours, and the triangles, of each vertex begin.
    starts: Vec<u32>,
    /// For each corner of a vertex's triangles the triangle, and its next vertex.
    around: Vec<(u32, u32)>,
}

impl<'a> Net<'a> {
    fn new(triangles: &'a [[u32; 3]], places: &'a [Vec3]) -> Self {
        let normals = Surface::new(triangles, places).normals().iter().map(|n| n.normalize_or_zero()).collect();
        let sound = |triangle: &&[u32; 3]| triangle.iter().all(|&v| (v as usize) < places.len());
        let mut starts = vec![0_u32; places.len() + 1];
        triangles.iter().filter(sound).flatten().for_each(|&v| starts[v as usize + 1] += 1);
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        let mut next = starts.clone();
        let mut around = vec![(0, 0); starts[places.len()] as usize];
        for (number, triangle) in triangles.iter().enumerate().filter(|(_, triangle)| sound(triangle)) {
            for k in 0..3 {
                let slot = &mut next[triangle[k] as usize];
                around[*slot as usize] = (number as u32, triangle[(k + 1) % 3]);
                *slot += 1;
            }
        }
        Self { places, normals, triangles, starts, around }
    }

    fn around(&self, vertex: usize) -> &[(u32, u32)] {
        &self.around[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    fn neighbours(&self, vertex: usize) -> impl Iterator<Item = usize> + '_ {
        self.around(vertex).iter().map(|&(_, next)| next as usize)
    }

    /// `values` made smooth along the surface, `times` times.
    fn smooth(&self, values: &[Vec3], times: usize) -> Vec<Vec3> {
        let mut values = values.to_vec();
        for _ in 0..times {
            let mean = |v: usize| {
                let count = self.around(v).len().max(1) as f32;
                0.5 * values[v] + self.neighbours(v).map(|n| values[n]).sum::<Vec3>() * (0.5 / count)
            };
            values = (0..values.len()).map(mean).collect();
        }
        values
    }

    /// How each channel of `values` changes along the surface, as columns, per metre.
    fn gradients(&self, values: &[Vec3]) -> Vec<Mat3> {
        let of = |v: usize| {
            let (mut squares, mut products) = (Mat3::ZERO, Mat3::ZERO);
            let normal = self.normals[v];
            for n in self.neighbours(v) {
                let way = self.places[n] - self.places[v];
                let way = way - normal * way.dot(normal);
                squares += outer(way, way);
                products += outer(way, values[n] - values[v]);
            }
            let size = squares.x_axis.x + squares.y_axis.y + squares.z_axis.z;
            let inverse = inverse(&(squares + outer(normal, normal) * size.max(1e-12)));
            if inverse.is_finite() { inverse * products } else { Mat3::ZERO }
        };
        (0..values.len()).map(of).collect()
    }

    /// The vertex nearest to `place`, from `vertex` along edges that lead nearer.
    fn walk(&self, mut vertex: usize, place: Vec3) -> usize {
        for _ in 0..WALK {
            let far = |v: usize| self.places[v].distance_squared(place);
            let before = vertex;
            for near in self.neighbours(before) {
                if far(near) < far(vertex) {
                    vertex = near;
                }
            }
            if vertex == before {
                break;
            }
        }
        vertex
    }

    /// The point of the surface nearest to `place`, in the triangles around `vertex`.
    fn point(&self, vertex: usize, place: Vec3) -> Carried {
        let mut best = (f32::INFINITY, Carried::default());
        for &(triangle, _) in self.around(vertex) {
            let [a, b, c] = self.triangles[triangle as usize].map(|v| self.places[v as usize]);
            let foot = foot_in(place, [a, b, c]);
            let far = (a * (1.0 - foot[0] - foot[1]) + b * foot[0] + c * foot[1]).distance_squared(place);
            if far < best.0 {
                best = (far, Carried { triangle, foot, offset: [0.0; 3] });
            }
        }
        best.1
    }
}

/// The inverse; not finite where there is none.
#[inline(never)]
fn inverse(matrix: &Mat3) -> Mat3 {
    matrix.inverse()
}

/// a b^T.
#[inline(never)]
fn outer(a: Vec3, b: Vec3) -> Mat3 {
    Mat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The colours of the vertices of a surface of `triangles`, `count` of them, from those of points that it carries; where there is no
/// point, that of the vertices around it.
#[must_use]
pub fn colours_of(triangles: &[[u32; 3]], count: usize, points: &[Carried], colours: &[Vec3]) -> Vec<Vec3> {
    let (mut sums, mut weights) = (vec![Vec3::ZERO; count], vec![0.0_f32; count]);
    for (point, &colour) in points.iter().zip(colours) {
        let Some(corners) = triangles.get(point.triangle as usize) else { continue };
        let [v, w] = point.foot;
        for (&vertex, share) in corners.iter().zip([1.0 - v - w, v, w]) {
            if let (Some(sum), Some(weight)) = (sums.get_mut(vertex as usize), weights.get_mut(vertex as usize)) {
                *sum += colour * share * share;
                *weight += share * share;
            }
        }
    }
    // What is without points is small; it grows inwards.
    let sound = |triangle: &[u32; 3]| triangle.iter().all(|&v| (v as usize) < count);
    for _ in 0..WALK {
        let mut given = Vec::new();
        for triangle in triangles.iter().filter(|triangle| sound(triangle)) {
            for k in 0..6 {
                let [to, from] = [triangle[k % 3], triangle[(k + 1 + k / 3) % 3]].map(|v| v as usize);
                if weights[to] == 0.0 && weights[from] > 0.0 {
                    given.push((to, sums[from] / weights[from]));
                }
            }
        }
        if given.is_empty() {
            break;
        }
        for (to, colour) in given {
            sums[to] += colour;
            weights[to] += 1.0;
        }
    }
    sums.iter().zip(&weights).map(|(&sum, &weight)| if weight > 0.0 { sum / weight } else { sum }).collect()
}

/// Where on the surface of `triangles` at `places` each vertex, as it is seen by its colour in `from`, is in the picture `to`; empty where
/// no flow makes the pictures more alike.
#[must_use]
pub fn flow(triangles: &[[u32; 3]], places: &[Vec3], from: &[Vec3], to: &[Vec3]) -> Vec<Carried> {
    let count = places.len();
    if from.len() != count || to.len() != count {
        return Vec::new();
    }
    let net = Net::new(triangles, places);
    let low = places.iter().fold(Vec3::INFINITY, |low, &p| low.min(p));
    let most = MOST * places.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p - low)).max_element().max(0.0);
    let mut ways = vec![Vec3::ZERO; count];
    let mut found: Vec<usize> = (0..count).collect();
    for times in SMOOTH {
        let (from, to) = (net.smooth(from, times), net.smooth(to, times));
        let gradients = net.gradients(&to);
        for _ in 0..WARPS {
            solve(&net, (&from, &to, &gradients), &mut ways, &found, most);
            for (k, found) in found.iter_mut().enumerate() {
                *found = net.walk(*found, places[k] + ways[k]);
            }
        }
    }
    let points: Vec<Carried> = (0..count).map(|k| net.point(found[k], places[k] + ways[k])).collect();
    let seen = |point: &Carried| {
        let corners = triangles.get(point.triangle as usize)?.map(|v| to.get(v as usize).copied().unwrap_or_default());
        let [v, w] = point.foot;
        Some(corners[0] * (1.0 - v - w) + corners[1] * v + corners[2] * w)
    };
    let (mut before, mut after) = (0.0, 0.0);
    for (k, point) in points.iter().enumerate() {
        before += from[k].distance(to[k]);
        after += from[k].distance(seen(point).unwrap_or_default());
    }
    if after < LEAST_GAIN * before { points } else { Vec::new() }
}

/// Makes `ways` better, which lead to the vertices `found`.
fn solve(
    net: &Net<'_>,
    (from, to, gradients): (&[Vec3], &[Vec3], &[Mat3]),
    ways: &mut [Vec3],
    found: &[usize],
    most: f32,
) {
    let square = |g: &Mat3| g.x_axis.length_squared() + g.y_axis.length_squared() + g.z_axis.length_squared();
    let stiffness = STIFFNESS * gradients.iter().map(square).sum::<f32>() / gradients.len().max(1) as f32;
    if stiffness <= 0.0 || !stiffness.is_finite() {
        return;
    }
    let equation = |v: usize| {
        let (at, gradient, normal) = (found[v], gradients[found[v]], net.normals[v]);
        // What is seen at the vertex that was found, and on the way on from there.
        let off = to[at] - from[v] - gradient.transpose() * (net.places[at] - net.places[v]);
        let seen = off + gradient.transpose() * ways[v];
        let weight = WIDTH * WIDTH / (WIDTH * WIDTH + seen.length_squared());
        let count = net.around(v).len() as f32;
        let own = gradient * gradient.transpose() * weight;
        let held = Mat3::from_diagonal(Vec3::splat(stiffness * (count + 0.01)));
        let inverse = inverse(&(own + held + outer(normal, normal) * (100.0 * stiffness * count.max(1.0))));
        (inverse, gradient * off * -weight)
    };
    let equations: Vec<(Mat3, Vec3)> = (0..ways.len()).map(equation).collect();
    for _ in 0..STEPS {
        for v in 0..ways.len() {
            let around: Vec3 = net.neighbours(v).map(|n| ways[n]).sum();
            let (inverse, right) = equations[v];
            let way = inverse * (right + around * stiffness);
            ways[v] = if way.is_finite() { way.clamp_length_max(most) } else { Vec3::ZERO };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tube about the vertical, 1.6 m high, and colours on it: dots, turned by `turn` radians.
    fn tube() -> (Vec<[u32; 3]>, Vec<Vec3>) {
        let (around, high) = (80_u32, 60_u32);
        let place = |k: u32, y: u32| {
            let angle = std::f32::consts::TAU * (k as f32 + 0.5 * (y % 2) as f32) / around as f32;
            Vec3::new(0.25 * angle.sin(), 1.6 * y as f32 / high as f32, 0.25 * angle.cos())
        };
        let places = (0..=high).flat_map(|y| (0..around).map(move |k| place(k, y))).collect();
        let mut triangles = Vec::new();
        for y in 0..high {
            for k in 0..around {
                let (a, b) = (y * around + k, y * around + (k + 1) % around);
                triangles.extend([[a, b, a + around], [b, b + around, a + around]]);
            }
        }
        (triangles, places)
    }

    fn dots(places: &[Vec3], turn: f32) -> Vec<Vec3> {
        let dot = |p: &Vec3| {
            let angle = p.x.atan2(p.z) - turn;
            let wave = (10.0 * angle).sin() * (14.0 * p.y).sin();
            Vec3::new(0.5 + 0.4 * wave, 0.4, 0.5 - 0.2 * wave)
        };
        places.iter().map(dot).collect()
    }

    #[test]
    fn what_was_turned_is_found() {
        let (triangles, places) = tube();
        let turn = 0.1;
        let found = flow(&triangles, &places, &dots(&places, 0.0), &dots(&places, turn));
        assert_eq!(found.len(), places.len());
        let surface = Surface::new(&triangles, &places);
        let off = |(p, found): (&Vec3, &Carried)| {
            let there = glam::Quat::from_rotation_y(turn) * *p;
            surface.place(found).unwrap().distance(there)
        };
        let inside = places.iter().zip(&found).filter(|(p, _)| (0.2..1.4).contains(&p.y));
        let off: Vec<f32> = inside.map(off).collect();
        let mean = off.iter().sum::<f32>() / off.len() as f32;
        // It was turned by 25 mm.
        assert!(mean < 0.004, "{mean}");
    }

    #[test]
    fn what_is_not_alike_has_no_flow() {
        let (triangles, places) = tube();
        let noise = |k: usize| {
            let hash = (k as u32 ^ 0x51ED).wrapping_mul(0x9E37_79B9).rotate_left(11).wrapping_mul(0x85EB_CA6B);
            Vec3::splat((hash >> 8) as f32 / (1 << 24) as f32)
        };
        let [from, to] = [0, 100_000].map(|first| (0..places.len()).map(|k| noise(first + k)).collect::<Vec<_>>());
        assert!(flow(&triangles, &places, &from, &to).is_empty());
        assert!(flow(&triangles, &places, &from, &from).is_empty(), "nothing to gain");
        assert!(flow(&triangles, &places, &from, &[]).is_empty());
        assert!(flow(&[[0, 1, 9]], &[Vec3::ZERO; 2], &[Vec3::X; 2], &[Vec3::Y; 2]).is_empty());
    }

    #[test]
    fn colours_come_from_points_and_from_around() {
        let (triangles, places) = tube();
        let (colours, surface) = (dots(&places, 0.0), Surface::new(&triangles, &places));
        let points: Vec<Carried> = (0..triangles.len() as u32)
            .filter(|triangle| triangle % 160 > 3)
            .map(|triangle| Carried { triangle, foot: [1.0 / 3.0; 2], offset: [0.0; 3] })
            .collect();
        let at: Vec<Vec3> = points.iter().map(|point| surface.place(point).unwrap()).collect();
        let found = colours_of(&triangles, places.len(), &points, &dots(&at, 0.0));
        let off = found.iter().zip(&colours).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(off < 0.3, "{off}");
        assert_eq!(colours_of(&[[0, 1, 9]], 2, &[Carried::default()], &[Vec3::X]).len(), 2);
    }
}
