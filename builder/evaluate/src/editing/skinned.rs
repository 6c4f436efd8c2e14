//! What the paper holds driven sequences against (Fig. 10): linear blend skinning, and differential coordinates that follow the bones.

use driving::Body;
use driving::plant::PlantedFrame;
use editing::deform::Held;
use editing::{Deformer, Rigid};
use glam::Vec3;
use kernels::cholesky::CholeskyError;
use kernels::topology::Topology;

use super::shape::tall;

/// Vertices that follow the bones, at most; they belong to their bone by this share at least, and are so far from any joint, in metres.
const HELD: usize = 160;
const WHOLLY: f32 = 0.8;
const FROM_JOINTS: f32 = 0.07;
/// How firmly what nothing holds stays where the pelvis has it.
const ANCHOR: f32 = 1e-5;
/// How far from the hips their region reaches, as a share of the body's height.
const HIPS: f32 = 0.11;

/// The mean of the bones' motions of each point (linear subspace deformation; second row of Fig. 10).
pub fn skinned(body: &Body, frame: &PlantedFrame) -> Vec<Vec3> {
    let motions = body.motions(&frame.pose);
    let rig = &body.rig;
    let moved = |(own, &point): (&editing::Influences, &Vec3)| {
        let parts = own.joints.iter().zip(&own.weights);
        parts.map(|(&joint, &weight)| motions[joint as usize].apply(point) * weight).sum::<Vec3>()
    };
    let weight = |own: &editing::Influences| own.weights.iter().sum::<f32>().max(1e-6);
    rig.influences().iter().zip(rig.rest()).map(|pair| moved(pair) / weight(pair.0)).collect()
}

/// Differential coordinates of the rest pose, turned with the pelvis; some vertices are where skinning has them (third row of Fig. 10).
pub struct Laplacian {
    deformer: Deformer,
    held: Held,
}

impl Laplacian {
    /// Of a body's surface.
    pub fn new(body: &Body, topology: &Topology) -> Result<Self, CholeskyError> {
        let mut deformer = Deformer::new(topology, None)?;
        let rest = body.rig.rest();
        let held = deformer.hold(rest, &chosen(body), ANCHOR)?;
        Ok(Self { deformer, held })
    }

    /// A frame.
    pub fn frame(&mut self, body: &Body, frame: &PlantedFrame) -> Result<Vec<Vec3>, CholeskyError> {
        let rest = body.rig.rest();
        let pelvis: Rigid = body.motions(&frame.pose)[0];
        let skinned = skinned(body, frame);
        let wanted: Vec<Vec3> = self.held.vertices().iter().map(|&v| skinned[v as usize] - rest[v as usize]).collect();
        let told: Vec<Vec3> = rest.iter().map(|&point| pelvis.apply(point) - point).collect();
        let turns = vec![pelvis.rotation; rest.len()];
        let moved = self.deformer.solve(&self.held, rest, &turns, &told, &wanted)?;
        Ok(rest.iter().zip(moved).map(|(point, moved)| *point + moved).collect())
    }
}

/// Vertices that belong to one bone and are far from joints, as far from each other as they are.
fn chosen(body: &Body) -> Vec<u32> {
    let (rig, rest) = (&body.rig, body.rig.rest());
    let is_firm = |&v: &u32| {
        let most = rig.influences()[v as usize].weights.iter().copied().fold(0.0, f32::max);
        let point = rest[v as usize];
        most >= WHOLLY && rig.bones().iter().skip(1).all(|bone| bone.joint.distance(point) >= FROM_JOINTS)
    };
    let firm: Vec<u32> = (0..rest.len() as u32).filter(is_firm).collect();
    let Some(&first) = firm.first() else { return vec![0] };
    let mut chosen = vec![first];
    let mut far: Vec<f32> = firm.iter().map(|&v| rest[v as usize].distance(rest[first as usize])).collect();
    while chosen.len() < HELD.min(firm.len()) {
        let next = (0..firm.len()).fold(0, |best, k| if far[k] > far[best] { k } else { best });
        if far[next] <= 0.0 {
            break;
        }
        chosen.push(firm[next]);
        let at = rest[firm[next] as usize];
        far.iter_mut().zip(&firm).for_each(|(far, &v)| *far = far.min(rest[v as usize].distance(at)));
    }
    chosen.sort_unstable();
    chosen
}

/// The surface around the hips.
pub struct Hips {
    triangles: Vec<[u32; 3]>,
    vertices: Vec<u32>,
}

impl Hips {
    /// Of a body: what moves with pelvis or thighs, near the joints of the hips.
    pub fn new(body: &Body, topology: &Topology) -> Self {
        let (rig, rest) = (&body.rig, body.rig.rest());
        let bones = [0, body.legs[0].bones.bones[0], body.legs[1].bones.bones[0]];
        let joints = body.legs.each_ref().map(|leg| leg.bones.joints[0]);
        let reach = HIPS * tall(rest);
        let is_near = |v: u32| {
            let point = rest[v as usize];
            bones.contains(&rig.bone_of(v)) && joints.iter().any(|joint| joint.distance(point) < reach)
        };
        let vertices = (0..rest.len() as u32).filter(|&v| is_near(v)).collect();
        let triangles = topology.triangles().iter().copied().filter(|all| all.iter().all(|&v| is_near(v))).collect();
        Self { triangles, vertices }
    }

    /// The volume between that surface and its middle, in cubic metres.
    pub fn volume(&self, pose: &[Vec3]) -> f64 {
        let middle = self.vertices.iter().map(|&v| pose[v as usize]).sum::<Vec3>() / self.vertices.len().max(1) as f32;
        let of = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| (pose[v as usize] - middle).as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        self.triangles.iter().map(of).sum()
    }
}
