//! The bits of orders, factors and in-betweens: bundles and walks hang on them.
//!
//! Additions, products, quotients and square roots alone, rounded as IEEE 754 says: the same on every machine. Whoever
//! changes a checksum here changes every walk, and the elimination orders in bundles.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use glam::Vec3;
use kernels::cholesky::elimination_order;
use kernels::poisson::{KeyedPose, PoissonInterpolator};
use kernels::topology::Topology;

/// A checksum of numbers (FNV-1a).
struct Checksum(u64);

impl Checksum {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn take(&mut self, number: u32) {
        for byte in number.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
}

/// A square tube of 17 rings of 12 vertices with a lid at either end, a loose sheet, and a vertex of no triangle.
fn mesh() -> Topology {
    let (rings, around) = (17, 12);
    let mut triangles = Vec::new();
    for ring in 0..rings - 1 {
        for step in 0..around {
            let [a, b] = [step, (step + 1) % around].map(|step| ring * around + step);
            triangles.extend([[a, b, a + around], [b, b + around, a + around]]);
        }
    }
    let (bottom, top) = (rings * around, rings * around + 1);
    for step in 0..around {
        let next = (step + 1) % around;
        triangles.extend([[bottom, next, step], [top, (rings - 1) * around + step, (rings - 1) * around + next]]);
    }
    let sheet = top + 1;
    for cell in 0..9 {
        let a = sheet + 4 * (cell / 3) + cell % 3;
        triangles.extend([[a, a + 1, a + 4], [a + 1, a + 5, a + 4]]);
    }
    Topology::new(sheet + 17, triangles, vec![1.0; sheet as usize + 17]).unwrap()
}

/// A pose: the tube leans by `lean` and is stretched; all in quotients of small numbers.
fn pose(lean: f32, stretch: f32) -> Vec<Vec3> {
    const CORNERS: [[f32; 2]; 12] = [
        [2.0, 0.0],
        [2.0, 1.0],
        [2.0, 2.0],
        [0.5, 2.5],
        [-1.0, 2.0],
        [-2.0, 2.0],
        [-2.5, 0.5],
        [-2.0, -1.0],
        [-2.0, -2.0],
        [0.0, -2.5],
        [1.0, -2.0],
        [2.0, -2.0],
    ];
    let at = |x: f32, height: f32, z: f32| {
        let aside = lean * height * height / 40.0;
        let turn = lean * height / 30.0;
        Vec3::new(x - turn * z + aside, stretch * height, z + turn * x) / 8.0
    };
    let mut points = Vec::new();
    for ring in 0..17_u8 {
        let height = f32::from(ring) * (1.0 + f32::from(ring % 3) / 16.0);
        points.extend(CORNERS.map(|[x, z]| at(x + f32::from(ring % 4) / 8.0, height, z)));
    }
    points.extend([at(0.0, -1.0, 0.0), at(0.0, 18.0, 0.0)]);
    for k in 0..17_u8 {
        let (x, z) = (f32::from(k % 4), f32::from(k / 4));
        points.push(at(4.0 + x, x * z * lean / 5.0 + 3.0, z));
    }
    points
}

#[test]
fn the_bits_are_those_of_every_version_before() {
    let topology = mesh();
    let mut order = Checksum::new();
    elimination_order(&topology).into_iter().for_each(|vertex| order.take(vertex));
    assert_eq!(order.0, 0xa4cb_87ca_a59d_6eea);

    let mut interpolator = PoissonInterpolator::new(&topology, None).unwrap();
    let mut all = Checksum::new();
    let mut out = vec![Vec3::ZERO; topology.vertex_count()];
    for step in 0..24_u8 {
        let time = f32::from(step);
        let (source, destination) = (pose(time / 8.0, 1.0), pose(3.0 - time / 16.0, 1.0 + time / 64.0));
        let source = KeyedPose { frame: step.into(), pose: &source };
        let destination = KeyedPose { frame: 100 + u32::from(step), pose: &destination };
        let lambda = (time + 1.0) / 25.0;
        let effort = interpolator.interpolate(source, destination, lambda, &mut out).unwrap();
        out.iter().flat_map(|point| point.to_array()).for_each(|x| all.take(x.to_bits()));
        let [first, second] = effort.solves;
        [first, second, effort.factorisations, effort.regularised].iter().for_each(|&count| all.take(count as u32));
        all.take(effort.error.to_bits());
    }
    // As it has been since in-betweens are solved to a tenth of a millimetre; to a hundredth it was 0xd393_dbc7_2c39_f960.
    assert_eq!(all.0, 0x78ec_adc5_0b18_e25f);
}
