//! Bones that are found in how a surface moves, where they are in a shape of it, and the surface that they carry.

use actor::capture::Poses;
use editing::{Rig, Rigid, Skin};
use glam::{Quat, Vec3};
use kernels::topology::Topology;
use rig::RigOptions;

/// Frames that bones are found in at most.
const FRAMES: usize = 600;
/// Rigid parts that a surface is split into, until a human is found.
const PARTS: [usize; 3] = [26, 22, 32];

/// The bones of a human's body.
#[derive(Clone, Debug)]
pub struct Bones {
    /// They, over the mesh.
    pub rig: Rig,
}

/// A surface that bones carry.
pub struct Pose {
    /// The places of all vertices.
    pub shape: Vec<Vec3>,
    /// How the surface is turned at each.
    pub turns: Vec<Quat>,
}

impl Pose {
    /// The places of some vertices with what is beside the bones there.
    pub fn with(&self, vertices: &[u32], rest: &[Vec3]) -> Vec<Vec3> {
        let place = |(&vertex, &rest): (&u32, &Vec3)| {
            let vertex = vertex as usize;
            self.shape[vertex] + self.turns[vertex] * rest
        };
        vertices.iter().zip(rest).map(place).collect()
    }
}

impl Bones {
    /// Those of a mesh that was recorded in these poses; `None` where nothing like a human's skeleton is found.
    pub fn find(topology: &Topology, recorded: &Poses) -> Option<Self> {
        let count = recorded.len();
        let mut poses = Poses::new(recorded.vertex_count());
        let chosen = (0..count).step_by(count.div_ceil(FRAMES).max(1));
        chosen.for_each(|frame| poses.push(recorded.frame(frame as u32)));
        PARTS.into_iter().find_map(|parts| {
            let mut options = RigOptions::default();
            options.parts = parts;
            let found = rig::estimate(topology, &poses, &options).ok()?;
            found.is_human.then_some(Self { rig: found.rig })
        })
    }

    /// Where they are in a shape: motions from the rest pose.
    pub fn at(&self, shape: &[Vec3]) -> Vec<Rigid> {
        self.rig.fit(shape)
    }

    /// For each bone the one of `other` with the same name; where there is none, that of what it hangs on.
    pub fn like(&self, other: &Self) -> Vec<usize> {
        let mut like: Vec<usize> = Vec::new();
        for bone in self.rig.bones() {
            let named = other.rig.bones().iter().position(|own| own.name == bone.name);
            like.push(named.or_else(|| like.get(bone.parent).copied()).unwrap_or(0));
        }
        like
    }

    /// The middle of the hips in a pose.
    pub fn hips(&self, pose: &[Vec3]) -> Vec3 {
        self.at(pose)[0].apply(self.rig.bones()[0].joint)
    }

    /// The bone that a bone hangs on.
    pub fn parent(&self, bone: usize) -> usize {
        self.rig.bones()[bone].parent
    }

    /// How far a bone's joint is from where its parent has it; where the first bone's joint is.
    pub fn slip(&self, motions: &[Rigid], bone: usize) -> Vec3 {
        let joint = self.rig.bones()[bone].joint;
        let there = motions[bone].apply(joint);
        if bone == 0 { there } else { there - motions[self.parent(bone)].apply(joint) }
    }

    /// The surface that bones carry.
    pub fn carry(&self, motions: &[Rigid]) -> Pose {
        let still = Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO };
        let skin = Skin::new(&vec![still; motions.len()], motions);
        let rest = self.rig.rest().iter().zip(self.rig.influences());
        let (shape, turns) = rest
            .map(|(&point, influences)| {
                let motion = skin.motion(influences);
                (motion.apply(point), motion.rotation)
            })
            .unzip();
        Pose { shape, turns }
    }
}

/// The mean of rotations.
pub fn mean(turns: impl Iterator<Item = Quat>) -> Quat {
    let mut sum = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    for turn in turns {
        sum += if turn.dot(sum) < 0.0 { -turn } else { turn };
    }
    if sum.length() > 1e-3 { sum.normalize() } else { Quat::IDENTITY }
}
