//! What is measured of edited surfaces: edges, volume, folds, limbs.

use editing::Rig;
use glam::Vec3;
use kernels::topology::Topology;

/// Bones between whose joints limbs are measured.
const LIMBS: [(&str, &str); 6] = [
    ("thigh_l", "shin_l"),
    ("thigh_r", "shin_r"),
    ("shin_l", "foot_l"),
    ("shin_r", "foot_r"),
    ("upper_arm_l", "forearm_l"),
    ("upper_arm_r", "forearm_r"),
];

/// Mean of |l' / l - 1| over the edges of the mesh.
pub fn stretch(topology: &Topology, before: &[Vec3], after: &[Vec3]) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u32);
    for triangle in topology.triangles() {
        for k in 0..3 {
            let [a, b] = [triangle[k] as usize, triangle[(k + 1) % 3] as usize];
            let length = before[a].distance(before[b]);
            if length > 1e-6 {
                sum += f64::from((after[a].distance(after[b]) / length - 1.0).abs());
                count += 1;
            }
        }
    }
    sum / f64::from(count.max(1))
}

/// The volume within a surface, in cubic metres.
pub fn volume(topology: &Topology, pose: &[Vec3]) -> f64 {
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| pose[v as usize].as_dvec3());
        a.dot(b.cross(c)) / 6.0
    };
    topology.triangles().iter().map(of).sum()
}

/// The share of edges whose two triangles are folded onto each other: by more than a right angle.
pub fn folded(topology: &Topology, pose: &[Vec3]) -> f64 {
    let normal = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| pose[v as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let normals: Vec<Vec3> = topology.triangles().iter().map(normal).collect();
    let mut sides: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * normals.len());
    for (number, &[a, b, c]) in topology.triangles().iter().enumerate() {
        sides.extend([[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], number)));
    }
    sides.sort_unstable();
    let (mut folded, mut count) = (0_u32, 0_u32);
    for pair in sides.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        count += 1;
        folded += u32::from(normals[pair[0].1].dot(normals[pair[1].1]) < 0.0);
    }
    f64::from(folded) / f64::from(count.max(1))
}

/// How tall a pose stands, in metres.
pub fn tall(pose: &[Vec3]) -> f32 {
    let heights = || pose.iter().map(|point| point.y);
    heights().fold(f32::NEG_INFINITY, f32::max) - heights().fold(f32::INFINITY, f32::min)
}

/// The limbs of a human rig, by the bones that begin and end them.
pub struct Limbs<'a> {
    rig: &'a Rig,
    bones: Vec<[usize; 2]>,
}

impl<'a> Limbs<'a> {
    /// Those of `rig`; none where it is no human's.
    pub fn of(rig: &'a Rig) -> Self {
        let bone = |name: &str| rig.bones().iter().position(|bone| bone.name == name);
        let bones = LIMBS.iter().filter_map(|&(upper, lower)| Some([bone(upper)?, bone(lower)?])).collect();
        Self { rig, bones }
    }

    /// The largest share by which a limb has become longer or shorter, from joint to joint, each where its bone's vertices have it;
    /// `None` where there is none.
    pub fn change(&self, before: &[Vec3], after: &[Vec3]) -> Option<f64> {
        let [before, after] = [before, after].map(|pose| self.rig.joints(&self.rig.fit(pose)));
        let length = |joints: &[Vec3], [upper, lower]: [usize; 2]| f64::from(joints[upper].distance(joints[lower]));
        let changes = self.bones.iter().map(|&limb| (length(&after, limb) / length(&before, limb) - 1.0).abs());
        changes.reduce(f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folds_are_counted_and_volumes_have_their_sign() {
        let pose = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::new(1.0, 0.0, 1.0), Vec3::Y];
        let flat = Topology::new(5, vec![[0, 2, 1], [1, 2, 3], [0, 1, 4]], vec![1.0; 5]).unwrap();
        assert_eq!(folded(&flat, &pose), 0.0);
        let mut closed = pose;
        closed[3] = Vec3::new(0.1, 0.05, 0.1);
        assert_eq!(folded(&flat, &closed), 0.5, "one of two inner edges");
        let tetrahedron = Topology::new(5, vec![[0, 1, 2], [0, 4, 1], [1, 4, 2], [2, 4, 0]], vec![1.0; 5]).unwrap();
        assert!((volume(&tetrahedron, &pose) - 1.0 / 6.0).abs() < 1e-6);
        assert!((stretch(&tetrahedron, &pose, &pose.map(|p| p * 1.5)) - 0.5).abs() < 1e-6);
    }
}
