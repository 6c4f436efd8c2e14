//! Deformation gradients of triangles between two poses, and the edges they want at any point in between.
//!
//! This work is based on: Boukhayma, thesis (2017), section 2.4.3; Xu, Zhang, Wang and Bao, "Poisson shape
//! interpolation" (2005). Per triangle `T = R S`, and `T~(lambda) = exp(lambda log R) exp(lambda log S)` (thesis
//! equation 2.46; TVCG equation 5).
//!
//! In the triangle's own orthonormal frame (first edge, in-plane normal to it, normal) `T` maps plane to plane and normal
//! to normal, so the polar decomposition is that of the 2x2 matrix of the in-plane edges.
//!
//! Both sides of the thesis want the same edges: with `T' = T^-1 = R' S'` from the destination, `R' = R^T`,
//! `S' = R S^-1 R^T`, hence `T'~(1 - lambda) T e = T~(lambda) e`. So they are computed once; the sides differ in the
//! weights of their Laplacians alone.

mod batches;

pub use batches::{Batch, TriangleBatches};

use glam::Vec3;

use crate::lanes::{LANES, Lanes, Lanes3};

/// Narrowest triangle, height over first edge, whose gradient is taken; below it single precision no longer tells the
/// normal, and the wanted edges are blended linearly.
const NARROWEST: f32 = 1e-4;

/// Rotation, stretch and reference of every triangle between two poses: all that `edges` needs.
#[derive(Clone, Debug, Default)]
pub struct PairGradients {
    batches: Vec<PairBatch>,
    narrow: Vec<NarrowBatch>,
}

/// [`PairGradients`] of eight triangles.
#[derive(Clone, Copy, Debug, Default)]
struct PairBatch {
    /// Unit axis of R, and half its angle, between 0 and pi/2.
    axis: Lanes3,
    half_angle: Lanes,
    /// Logarithms of the in-plane principal stretches, the larger first.
    log_stretch: [Lanes; 2],
    /// The direction of the larger one: (cos 2a, sin 2a) with a the angle from the first edge.
    direction: [Lanes; 2],
    /// The source triangle: its in-plane axes, and its edges (a, 0) and (b, c) along them.
    u: Lanes3,
    v: Lanes3,
    a: Lanes,
    b: Lanes,
    c: Lanes,
    /// Which of [`PairGradients::narrow`] overrules some of the eight; [`ALL_WIDE`] for most.
    narrow: u32,
}

const ALL_WIDE: u32 = u32::MAX;

/// Eight triangles some of which are too narrow: those where `wide` is 0 blend their edges linearly.
#[derive(Clone, Copy, Debug)]
struct NarrowBatch {
    wide: Lanes,
    source: [Lanes3; 2],
    destination: [Lanes3; 2],
}

impl PairGradients {
    /// Decomposes the deformation of each triangle from `source` to `destination`, in metres.
    pub fn set(&mut self, triangles: &TriangleBatches, source: &[Vec3], destination: &[Vec3]) {
        self.batches.clear();
        self.narrow.clear();
        for batch in triangles.batches() {
            let i = frame(batch, source);
            let j = frame(batch, destination);
            let mut pair = decompose(&i, &j);
            let wide = i.wide * j.wide;
            if wide != Lanes::splat(1.0) {
                pair.narrow = self.narrow.len() as u32;
                self.narrow.push(NarrowBatch { wide, source: i.edges, destination: j.edges });
            }
            self.batches.push(pair);
        }
    }

    /// The edges from the first corner to the second and to the third that `T~(lambda)` wants, for the eight triangles
    /// of batch `batch`.
    #[inline(always)]
    pub(crate) fn edges(&self, batch: usize, lambda: f32) -> [Lanes3; 2] {
        let pair = &self.batches[batch];
        let lambda = Lanes::splat(lambda);
        let wanted = in_between(pair, lambda);
        if pair.narrow == ALL_WIDE { wanted } else { self.narrow[pair.narrow as usize].overrule(wanted, lambda) }
    }

    /// What `edges` gives, of one triangle.
    #[must_use]
    pub fn triangle_edges(&self, triangle: usize, lambda: f32) -> [Vec3; 2] {
        let lane = triangle % LANES;
        self.edges(triangle / LANES, lambda).map(|edges| edges.lane(lane))
    }

    /// Angle of R in radians, between 0 and pi; 0 for a triangle too narrow to tell.
    #[must_use]
    pub fn rotation_angle(&self, triangle: usize) -> f32 {
        let (batch, lane) = (&self.batches[triangle / LANES], triangle % LANES);
        let wide = batch.narrow == ALL_WIDE || self.narrow[batch.narrow as usize].wide.lane(lane) > 0.0;
        if wide { 2.0 * batch.half_angle.lane(lane) } else { 0.0 }
    }
}

impl NarrowBatch {
    #[cold]
    fn overrule(&self, wanted: [Lanes3; 2], lambda: Lanes) -> [Lanes3; 2] {
        let one = Lanes::splat(1.0);
        let mut edges = wanted;
        for edge in 0..2 {
            let blended = self.source[edge] + (self.destination[edge] - self.source[edge]).scale(lambda);
            edges[edge].x = self.wide.at_least(one, wanted[edge].x, blended.x);
            edges[edge].y = self.wide.at_least(one, wanted[edge].y, blended.y);
            edges[edge].z = self.wide.at_least(one, wanted[edge].z, blended.z);
        }
        edges
    }
}

/// Edges, in-plane axes and normal of eight triangles of a pose.
pub(crate) struct TriangleFrames {
    pub a: Lanes,
    pub b: Lanes,
    pub c: Lanes,
    u: Lanes3,
    v: Lanes3,
    /// 1 where the triangle is wide enough to have a normal, 0 elsewhere.
    wide: Lanes,
    edges: [Lanes3; 2],
}

#[inline(always)]
pub(crate) fn frame(batch: &Batch, pose: &[Vec3]) -> TriangleFrames {
    let edges = batch.edges(pose);
    let [first, second] = edges;
    let tiny = Lanes::splat(1e-30);
    let a = first.dot(first).sqrt().max(tiny);
    let u = first.scale(a.recip());
    let b = second.dot(u);
    let rest = second - u.scale(b);
    let c = rest.dot(rest).sqrt().max(tiny);
    let v = rest.scale(c.recip());
    let longest = a.max(b.abs());
    let one = Lanes::splat(1.0);
    let wide = c.at_least(longest * Lanes::splat(NARROWEST), one, Lanes::default());
    let wide = a.at_least((c + b.abs()) * Lanes::splat(NARROWEST), wide, Lanes::default());
    TriangleFrames { a, b, c, u, v, wide, edges }
}

#[inline(always)]
fn decompose(i: &TriangleFrames, j: &TriangleFrames) -> PairBatch {
    let tiny = Lanes::splat(1e-30);

    // A = P_j P_i^-1 with P = [[a, b], [0, c]], and its polar decomposition A = rot(phi) S.
    let a11 = j.a / i.a;
    let a22 = j.c / i.c;
    let a12 = (j.b - a11 * i.b) / i.c;
    let norm = ((a11 + a22) * (a11 + a22) + a12 * a12).sqrt().max(tiny).recip();
    let (cos, sin) = ((a11 + a22) * norm, -(a12 * norm));
    let s11 = cos * a11;
    let s12 = cos * a12 + sin * a22;
    let s22 = cos * a22 - sin * a12;
    let half = Lanes::splat(0.5);
    let mean = (s11 + s22) * half;
    let difference = (s11 - s22) * half;
    let radius = (difference * difference + s12 * s12).sqrt();
    let large = mean + radius;
    // The product of both is det A; taking the difference would cancel.
    let small = a11 * a22 / large.max(tiny);
    let inverse_radius = radius.max(tiny).recip();

    // R takes the source's frame to the destination's, turned by phi about its normal.
    let ju = j.u.scale(cos) + j.v.scale(sin);
    let jv = j.v.scale(cos) - j.u.scale(sin);
    let (axis, half_angle) = rotation([i.u, i.v, i.u.cross(i.v)], [ju, jv, ju.cross(jv)]);

    PairBatch {
        axis,
        half_angle,
        log_stretch: [large.max(tiny).ln(), small.max(tiny).ln()],
        direction: [difference * inverse_radius, s12 * inverse_radius],
        u: i.u,
        v: i.v,
        a: i.a,
        b: i.b,
        c: i.c,
        narrow: ALL_WIDE,
    }
}

/// Unit axis and half the angle of the rotation between two right-handed orthonormal frames; the angle is at most pi.
#[inline(always)]
fn rotation(from: [Lanes3; 3], to: [Lanes3; 3]) -> (Lanes3, Lanes) {
    // R = to from^T, the frames' axes being the columns.
    let product = |row: [Lanes; 3], column: [Lanes; 3]| row[0] * column[0] + row[1] * column[1] + row[2] * column[2];
    let [(tx, ty, tz), (fx, fy, fz)] = [to, from].map(|[a, b, c]| ([a.x, b.x, c.x], [a.y, b.y, c.y], [a.z, b.z, c.z]));
    let (r00, r11, r22) = (product(tx, fx), product(ty, fy), product(tz, fz));
    let (r01, r10) = (product(tx, fy), product(ty, fx));
    let (r02, r20) = (product(tx, fz), product(tz, fx));
    let (r12, r21) = (product(ty, fz), product(tz, fy));
    let one = Lanes::splat(1.0);
    // Four times the squares of the quaternion's parts; the largest gives the best conditioned row of 4 q q^T.
    let squares = [one + r00 + r11 + r22, one + r00 - r11 - r22, one - r00 + r11 - r22, one - r00 - r11 + r22];
    let (sx, sy, sz) = (r21 - r12, r02 - r20, r10 - r01);
    let (dx, dy, dz) = (r21 + r12, r02 + r20, r10 + r01);
    let rows = [[squares[0], sx, sy, sz], [sx, squares[1], dz, dy], [sy, dz, squares[2], dx], [sz, dy, dx, squares[3]]];
    let mut best = squares[0];
    let mut row = rows[0];
    for candidate in 1..4 {
        for part in 0..4 {
            row[part] = best.at_least(squares[candidate], row[part], rows[candidate][part]);
        }
        best = best.max(squares[candidate]);
    }
    // Of the two quaternions of a rotation, the one with w >= 0 has the angle of at most pi.
    let sign = row[0].at_least(Lanes::default(), one, -one);
    let vector = Lanes3 { x: row[1] * sign, y: row[2] * sign, z: row[3] * sign };
    let length = vector.dot(vector).sqrt();
    let axis = vector.scale(length.max(Lanes::splat(1e-30)).recip());
    (axis, length.quarter_atan2(row[0].abs().max(Lanes::splat(1e-30))))
}

#[inline(always)]
fn in_between(pair: &PairBatch, lambda: Lanes) -> [Lanes3; 2] {
    // exp(lambda log S) on the in-plane edges.
    let half = Lanes::splat(0.5);
    let large = (lambda * pair.log_stretch[0]).exp();
    let small = (lambda * pair.log_stretch[1]).exp();
    let mean = (large + small) * half;
    let radius = (large - small) * half;
    let s11 = mean + radius * pair.direction[0];
    let s12 = radius * pair.direction[1];
    let s22 = mean - radius * pair.direction[0];
    let first = pair.u.scale(pair.a * s11) + pair.v.scale(pair.a * s12);
    let second = pair.u.scale(pair.b * s11 + pair.c * s12) + pair.v.scale(pair.b * s12 + pair.c * s22);

    // exp(lambda log R).
    let (sin, cos) = (lambda * pair.half_angle).quarter_sin_cos();
    let q = pair.axis.scale(sin);
    let rotate = |e: Lanes3| {
        let t = q.cross(e);
        let t = t + t;
        e + t.scale(cos) + q.cross(t)
    };
    [rotate(first), rotate(second)]
}
