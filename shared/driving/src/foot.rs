//! A foot of the actor: which vertices it stands on, and how it turns over its ball.

use editing::{Rig, Rigid};
use glam::{Quat, Vec3};

use crate::frames::{level, upright};
use crate::smooth::{ease, quantile};

/// Vertices so near to the lowest one of a standing foot are its sole, in shares of the foot's length: some 6 mm.
const SOLE: f32 = 0.025;
/// Shares of the length, from the heel, that are: where the heel turns over, where its patch ends, where the foot bends, and
/// where the patch of ball and toes begins.
const HEEL: f32 = 0.1;
const HEEL_END: f32 = 0.4;
const BALL: f32 = 0.7;
const TOES: f32 = 0.62;
/// Share of the length over which the toes' bend begins.
const BEND: f32 = 0.14;

/// A foot.
#[derive(Clone, Debug, PartialEq)]
pub struct Foot {
    /// Its bone.
    pub bone: usize,
    /// Axes in the rest pose: left, up, forwards where it stands.
    pub axes: Quat,
    /// Under the heel, in the rest pose.
    pub heel: Vec3,
    /// Under the ball, in the rest pose: the toes bend there.
    pub ball: Vec3,
    /// Length in metres.
    pub length: f32,
    /// Vertices of the heel's sole.
    pub heel_patch: Vec<u32>,
    /// Vertices of the sole under ball and toes.
    pub fore_patch: Vec<u32>,
    /// Other vertices of the sole.
    pub arch: Vec<u32>,
}

impl Foot {
    /// The foot `bone` of `rig`, whose ankle is at `ankle` in the rest pose and which `up` is up for where it stands.
    /// `None` where it has no vertices.
    #[must_use]
    pub fn new(rig: &Rig, bone: usize, ankle: Vec3, up: Vec3) -> Option<Self> {
        let rest = rig.rest();
        let own: Vec<u32> = (0..rest.len() as u32).filter(|&v| rig.bone_of(v) == bone).collect();
        let at = |v: u32| rest[v as usize];
        let lowest = quantile(own.iter().map(|&v| up.dot(at(v))).collect(), 0.0);
        // The sole is longer than wide: forwards is the way it is longest.
        let near: Vec<u32> = own.iter().copied().filter(|&v| up.dot(at(v)) < lowest + 0.03).collect();
        let middle = near.iter().map(|&v| at(v)).sum::<Vec3>() / near.len().max(1) as f32;
        let to_middle = upright(up, up.any_orthonormal_vector()).conjugate();
        let flat = |v: Vec3| level(to_middle * v);
        let (mut xx, mut xz, mut zz) = (0.0, 0.0, 0.0);
        for &v in &near {
            let off = flat(at(v) - middle);
            (xx, xz, zz) = (xx + off.x * off.x, xz + off.x * off.z, zz + off.z * off.z);
        }
        let angle = 0.5 * kernels::scalar::atan2(2.0 * xz, xx - zz);
        let (sin, cos) = kernels::scalar::sin_cos(angle);
        let along = to_middle.conjugate() * Vec3::new(cos, 0.0, sin);
        let ahead = if along.dot(middle - ankle) < 0.0 { -along } else { along };
        let axes = upright(up, up.cross(ahead));
        let place = |v: u32| axes.conjugate() * at(v);
        let from = near.iter().map(|&v| place(v).z).reduce(f32::min)?;
        let to = near.iter().map(|&v| place(v).z).reduce(f32::max)?;
        let length = (to - from).max(1e-3);
        let (mut heel_patch, mut fore_patch, mut arch) = (Vec::new(), Vec::new(), Vec::new());
        for &v in near.iter().filter(|&&v| place(v).y < lowest + SOLE * length) {
            let share = (place(v).z - from) / length;
            let patch = if share < HEEL_END {
                &mut heel_patch
            } else if share > TOES {
                &mut fore_patch
            } else {
                &mut arch
            };
            patch.push(v);
        }
        let side = place_middle(&near, &place);
        let under = |share: f32| axes * Vec3::new(side, lowest, from + share * length);
        Some(Self { bone, axes, heel: under(HEEL), ball: under(BALL), length, heel_patch, fore_patch, arch })
    }

    /// All vertices of the sole.
    pub fn sole(&self) -> impl Iterator<Item = u32> + '_ {
        self.heel_patch.iter().chain(&self.arch).chain(&self.fore_patch).copied()
    }

    /// How much of the toes' bend a point of the rest pose takes part in, from 0 to 1.
    #[must_use]
    pub fn toe_share(&self, point: Vec3) -> f32 {
        let ahead = (self.axes.conjugate() * (point - self.ball)).z;
        ease(0.5 + ahead / (BEND * self.length))
    }

    /// The rigid motion of the toes against the foot that lifts them by `angle` radians, in the rest pose.
    #[must_use]
    pub fn lifted(&self, angle: f32) -> Rigid {
        let axis = self.axes * Vec3::X;
        let rotation = editing::rotation::turn_by(axis * -angle);
        Rigid { rotation, translation: self.ball - rotation * self.ball }
    }
}

/// How far to the left the middle of the vertices is.
fn place_middle(vertices: &[u32], place: &dyn Fn(u32) -> Vec3) -> f32 {
    vertices.iter().map(|&v| place(v).x).sum::<f32>() / vertices.len().max(1) as f32
}
