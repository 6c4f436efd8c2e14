//! Poisson interpolation written down plainly, in double precision: 3x3 polar decompositions by singular values, matrix
//! powers, each side's own gradients, and a full factorisation of each side's system.

use faer::Mat;
use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use glam::{DMat3, DQuat, DVec3, Vec3};
use kernels::topology::Topology;

pub struct Exact<'a> {
    topology: &'a Topology,
}

pub struct Solution {
    pub blended: Vec<DVec3>,
    pub sides_differ: f64,
}

impl<'a> Exact<'a> {
    pub fn new(topology: &'a Topology) -> Self {
        Self { topology }
    }

    pub fn interpolate(&self, source: &[Vec3], destination: &[Vec3], lambda: f64) -> Solution {
        let [i, j] = [source, destination].map(|pose| pose.iter().map(|v| v.as_dvec3()).collect::<Vec<_>>());
        let mut from_i = self.side(&i, &j, lambda);
        let mut from_j = self.side(&j, &i, 1.0 - lambda);
        let [ci, cj] = [&i, &j].map(|pose| self.centres(pose));
        let centres: Vec<DVec3> = ci.iter().zip(&cj).map(|(i, j)| i.lerp(*j, lambda)).collect();
        self.place(&mut from_i, &centres);
        self.place(&mut from_j, &centres);
        let sides_differ = from_i.iter().zip(&from_j).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        Solution { blended: from_i.iter().zip(&from_j).map(|(a, b)| a.lerp(*b, lambda)).collect(), sides_differ }
    }

    /// Deforms `pose` by `lambda` of the way towards `other`.
    fn side(&self, pose: &[DVec3], other: &[DVec3], lambda: f64) -> Vec<DVec3> {
        let mut entries = Vec::new();
        let mut right = Mat::<f64>::zeros(pose.len(), 3);
        let anchors = self.anchors();
        let areas: Vec<f64> = self.topology.triangles().iter().map(|t| area(t, pose)).collect();
        let least = 1e-12 * areas.iter().sum::<f64>() / areas.len() as f64;
        for (triangle, &area) in self.topology.triangles().iter().zip(&areas) {
            if area <= least {
                continue;
            }
            let moved = gradient(triangle.map(|v| pose[v as usize]), triangle.map(|v| other[v as usize]), lambda);
            for corner in 0..3 {
                let [o, k, l] = [0, 1, 2].map(|step| triangle[(corner + step) % 3] as usize);
                let (a, b) = (pose[k] - pose[o], pose[l] - pose[o]);
                let weight = 0.5 * a.dot(b) / a.cross(b).length();
                entries.extend([(k, k, weight), (l, l, weight), (k, l, -weight), (l, k, -weight)]);
                let wanted = moved * (pose[k] - pose[l]) * weight;
                for axis in 0..3 {
                    right[(k, axis)] += wanted[axis];
                    right[(l, axis)] -= wanted[axis];
                }
            }
        }
        let mut triplets: Vec<Triplet<usize, usize, f64>> = entries
            .into_iter()
            .filter(|&(k, l, _)| !anchors[k] && !anchors[l])
            .map(|(k, l, weight)| Triplet::new(k, l, weight))
            .collect();
        for (anchor, _) in anchors.iter().enumerate().filter(|(_, is)| **is) {
            triplets.push(Triplet::new(anchor, anchor, 1.0));
            for axis in 0..3 {
                right[(anchor, axis)] = 0.0;
            }
        }
        let matrix = SparseColMat::try_new_from_triplets(pose.len(), pose.len(), &triplets).unwrap();
        let symbolic = SymbolicLlt::try_new(matrix.symbolic(), faer::Side::Lower).unwrap();
        let factor = Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), faer::Side::Lower).unwrap();
        factor.solve_in_place(right.as_mut());
        (0..pose.len()).map(|k| DVec3::new(right[(k, 0)], right[(k, 1)], right[(k, 2)])).collect()
    }

    /// The first vertex of each component.
    fn anchors(&self) -> Vec<bool> {
        let mut seen = vec![false; self.topology.component_count()];
        let first = |&component: &u32| !std::mem::replace(&mut seen[component as usize], true);
        self.topology.component_of_vertex().iter().map(first).collect()
    }

    /// Centre of mass of each component.
    fn centres(&self, pose: &[DVec3]) -> Vec<DVec3> {
        let mut sums = vec![(DVec3::ZERO, 0.0); self.topology.component_count()];
        for ((point, &component), &weight) in
            pose.iter().zip(self.topology.component_of_vertex()).zip(self.topology.weights())
        {
            sums[component as usize].0 += *point * f64::from(weight);
            sums[component as usize].1 += f64::from(weight);
        }
        sums.into_iter().map(|(sum, weight)| sum / weight).collect()
    }

    fn place(&self, pose: &mut [DVec3], centres: &[DVec3]) {
        let own = self.centres(pose);
        for (point, &component) in pose.iter_mut().zip(self.topology.component_of_vertex()) {
            *point += centres[component as usize] - own[component as usize];
        }
    }
}

fn area(triangle: &[u32; 3], pose: &[DVec3]) -> f64 {
    let [a, b, c] = triangle.map(|v| pose[v as usize]);
    (b - a).cross(c - a).length() / 2.0
}

/// `T~(lambda)` of a triangle, by the singular values of its 3x3 deformation gradient.
pub fn gradient(from: [DVec3; 3], to: [DVec3; 3], lambda: f64) -> DMat3 {
    let (rotation, u, stretches) = polar(from, to);
    let power = DMat3::from_diagonal(stretches.map(|s| s.powf(lambda)));
    let (axis, angle) = DQuat::from_mat3(&rotation).to_axis_angle();
    let angle = if angle > std::f64::consts::PI { angle - std::f64::consts::TAU } else { angle };
    DMat3::from_axis_angle(axis, lambda * angle) * u * power * u.transpose()
}

/// Rotation of a triangle, and its stretch as principal directions and values.
pub fn polar(from: [DVec3; 3], to: [DVec3; 3]) -> (DMat3, DMat3, DVec3) {
    let basis = |[a, b, c]: [DVec3; 3]| {
        let (e, f) = (b - a, c - a);
        DMat3::from_cols(e, f, e.cross(f).normalize())
    };
    let t = basis(to) * basis(from).inverse();
    let matrix = Mat::from_fn(3, 3, |row, column| t.col(column)[row]);
    let svd = matrix.svd().unwrap();
    let columns = |m: faer::MatRef<'_, f64>| {
        DMat3::from_cols_array_2d(&[0, 1, 2].map(|column| [0, 1, 2].map(|row| m[(row, column)])))
    };
    let (left, right) = (columns(svd.U()), columns(svd.V()));
    let s = svd.S().column_vector();
    (left * right.transpose(), right, DVec3::new(s[0], s[1], s[2]))
}

/// Enclosed volume in cubic metres.
pub fn volume(topology: &Topology, pose: &[DVec3]) -> f64 {
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| pose[v as usize]);
        a.dot(b.cross(c)) / 6.0
    };
    topology.triangles().iter().map(of).sum()
}
