//! The figure as an implicit surface in the bind pose: blended cones and ellipsoids, one group for each garment.

use glam::{Vec2, Vec3};

use super::build::Dress;
use super::skeleton::{JOINT_COUNT, bind_pose, joint};
use super::skirt;
use geometry::sdf::{blend, clip, cone, ellipsoid, smoothstep};
use rig::Rigid;

/// Signed distances of the groups at one point, in metres.
#[derive(Clone, Copy, Debug)]
pub struct Fields {
    /// Face, skull, ears and neck.
    pub head: f32,
    /// Hair on the head.
    pub hair: f32,
    /// Ponytail.
    pub tail: f32,
    /// Trunk under the shirt, with the sleeves.
    pub shirt: f32,
    /// Bare arms and hands, left and right.
    pub arms: [f32; 2],
    /// Legs, left and right.
    pub legs: [f32; 2],
    /// Shoes, left and right.
    pub shoes: [f32; 2],
    /// Skirt, with what fills it down to the hips.
    pub skirt: f32,
}

impl Fields {
    /// The whole figure.
    #[must_use]
    pub fn union(&self) -> f32 {
        let head = blend(blend(self.head, self.hair, 0.008), self.tail, 0.014);
        let mut trunk = blend(head, self.shirt, 0.012);
        for side in 0..2 {
            trunk = blend(trunk, self.arms[side], 0.014);
        }
        trunk = blend(trunk, self.skirt, 0.01);
        let leg = |side: usize| {
            let leg = blend(self.legs[side], self.shoes[side], 0.012);
            blend(trunk, leg, 0.03)
        };
        leg(0).min(leg(1))
    }
}

/// The figure in the bind pose.
#[derive(Clone, Debug)]
pub struct Body {
    bind: [Rigid; JOINT_COUNT],
    bind_inverse: [Rigid; JOINT_COUNT],
    dress: Dress,
}

impl Default for Body {
    fn default() -> Self {
        Self::dressed(Dress::Skirt)
    }
}

/// The head is modelled at natural size and drawn a little larger.
pub const HEAD_SCALE: f32 = 1.12;

/// What is not there is this far away, in metres.
const NOWHERE: f32 = 10.0;

/// Height of the upper edge of trousers above the ground, in metres.
pub const TOP_OF_TRUNKS: f32 = 1.03;

/// Above this height the skirt is solid, and there is no cavity around the legs.
const FILLED_ABOVE: f32 = 0.872;

impl Body {
    /// The figure in these clothes.
    #[must_use]
    pub fn dressed(dress: Dress) -> Self {
        let bind = bind_pose();
        Self { bind, bind_inverse: bind.map(|transform| transform.inverse()), dress }
    }

    /// What covers the legs.
    #[must_use]
    pub fn dress(&self) -> Dress {
        self.dress
    }

    /// Joint transforms of the bind pose.
    #[must_use]
    pub fn bind(&self) -> &[Rigid; JOINT_COUNT] {
        &self.bind
    }

    /// Inverse joint transforms of the bind pose.
    #[must_use]
    pub fn bind_inverse(&self) -> &[Rigid; JOINT_COUNT] {
        &self.bind_inverse
    }

    /// Signed distance of the figure, in metres; a bound away from the surface.
    #[must_use]
    pub fn distance(&self, p: Vec3) -> f32 {
        self.fields(p).union()
    }

    /// The direction in which the distance grows fastest, a unit vector.
    #[must_use]
    pub fn normal(&self, p: Vec3) -> Vec3 {
        let step = 5e-4;
        // Four samples at the corners of a tetrahedron.
        let corners = [
            Vec3::new(1.0, -1.0, -1.0),
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(-1.0, 1.0, -1.0),
            Vec3::new(1.0, 1.0, 1.0),
        ];
        corners.iter().map(|&corner| corner * self.distance(p + corner * step)).sum::<Vec3>().normalize_or(Vec3::Y)
    }

    /// The nearest point of the surface, by a few Newton steps; good within a few centimetres of it.
    #[must_use]
    pub fn project(&self, mut p: Vec3) -> Vec3 {
        for _ in 0..4 {
            let distance = self.distance(p);
            if distance.abs() < 2e-5 {
                break;
            }
            p -= self.normal(p) * distance.clamp(-0.02, 0.02);
        }
        p
    }

    /// Signed distances of all groups.
    #[must_use]
    pub fn fields(&self, p: Vec3) -> Fields {
        let head = self.to_joint(p, joint::HEAD);
        Fields {
            head: head_and_neck(head / HEAD_SCALE) * HEAD_SCALE,
            hair: hair(head / HEAD_SCALE) * HEAD_SCALE,
            tail: self.tail(p),
            shirt: self.shirt(p),
            arms: [self.arm(p, 0), self.arm(p, 1)],
            legs: [self.leg(p, 0), self.leg(p, 1)],
            shoes: [self.shoe(p, 0), self.shoe(p, 1)],
            skirt: self.skirt(p),
        }
    }

    /// `p` in the frame of joint `index`, relative to the joint.
    #[must_use]
    pub fn to_joint(&self, p: Vec3, index: usize) -> Vec3 {
        self.bind_inverse[index].apply(p)
    }

    fn at(&self, index: usize) -> Vec3 {
        self.bind[index].translation
    }

    fn tail(&self, p: Vec3) -> f32 {
        if self.dress != Dress::Skirt {
            return NOWHERE;
        }
        let (a, b, c) = (self.at(joint::TAIL), self.at(joint::TAIL + 1), self.at(joint::TAIL + 2));
        let tip = c + Vec3::new(0.0, -0.1, 0.008);
        let root = cone(p, a, b, 0.024, 0.041);
        let middle = cone(p, b, c, 0.041, 0.042);
        let end = cone(p, c, tip, 0.042, 0.013);
        blend(root, blend(middle, end, 0.03), 0.02)
    }

    fn shirt(&self, p: Vec3) -> f32 {
        // The trunk is deeper than it is wide by a constant factor.
        let flat = 0.7;
        let q = Vec3::new(p.x, p.y, (p.z + 0.012) / flat);
        let level = |y: f32| Vec3::new(0.0, y, 0.0);
        let waist = cone(q, level(0.98), level(1.1), 0.15, 0.124);
        let ribs = cone(q, level(1.1), level(1.27), 0.124, 0.148);
        let shoulders = cone(side_of(q), Vec3::new(0.0, 1.392, -0.008), Vec3::new(0.118, 1.366, -0.008), 0.066, 0.06);
        let neck = cone(q, level(1.36), level(1.45), 0.105, 0.062);
        let trunk = blend(blend(blend(waist, ribs, 0.05), shoulders, 0.1), neck, 0.06) * flat;
        let side = Vec3::new(p.x.abs(), p.y, p.z);
        let bust = ellipsoid(side, Vec3::new(0.058, 1.262, 0.062), Vec3::new(0.06, 0.06, 0.05));
        let trunk = blend(trunk, bust, 0.05);
        // The collar: the shirt ends in a plane that drops forwards.
        let collar = (p.y - 1.452) * 0.93 + (p.z + 0.01) * 0.36;
        let trunk = clip(trunk, collar, 0.006);
        blend(trunk, self.sleeve(p, 0).min(self.sleeve(p, 1)), 0.05)
    }

    fn sleeve(&self, p: Vec3, side: usize) -> f32 {
        let (shoulder, elbow) = (self.at(joint::ARM[side] + 1), self.at(joint::ARM[side] + 2));
        let end = shoulder.lerp(elbow, 0.66);
        let along = (elbow - shoulder).normalize_or(Vec3::NEG_Y);
        let tube = cone(p, shoulder - Vec3::Y * 0.008, end, 0.053, 0.06);
        clip(tube, (p - shoulder.lerp(elbow, 0.6)).dot(along), 0.006)
    }

    fn arm(&self, p: Vec3, side: usize) -> f32 {
        let first = joint::ARM[side];
        let (shoulder, elbow, wrist) = (self.at(first + 1), self.at(first + 2), self.at(first + 3));
        let upper = cone(p, shoulder, elbow, 0.047, 0.039);
        let belly = elbow.lerp(wrist, 0.3);
        let lower = blend(cone(p, elbow, belly, 0.037, 0.0385), cone(p, belly, wrist, 0.0385, 0.0255), 0.02);
        let arm = blend(upper, lower, 0.02);
        let mut q = self.to_joint(p, first + 3);
        if side == 1 {
            q.x = -q.x;
        }
        blend(arm, hand(q), 0.022)
    }

    fn leg(&self, p: Vec3, side: usize) -> f32 {
        let first = joint::LEG[side];
        let (hip, knee, ankle) = (self.at(first), self.at(first + 1), self.at(first + 2));
        let thigh = cone(p, hip, knee, 0.086, 0.056);
        let calf_at = knee.lerp(ankle, 0.3) + Vec3::new(0.0, 0.0, -0.012);
        let calf = blend(cone(p, knee, calf_at, 0.051, 0.0535), cone(p, calf_at, ankle, 0.0535, 0.034), 0.03);
        let kneecap = ellipsoid(p, knee + Vec3::new(0.0, 0.0, 0.022), Vec3::new(0.034, 0.042, 0.032));
        let leg = blend(blend(thigh, calf, 0.03), kneecap, 0.03);
        let leg = match self.dress {
            Dress::Skirt => leg,
            Dress::Trousers => return blend(leg, trouser([hip, knee, ankle], p, 0.94), 0.008),
            Dress::Shorts => blend(leg, trouser([hip, knee, ankle], p, 0.0), 0.006),
        };
        // A folded sock.
        let top = ankle.lerp(knee, 0.2);
        let sock = cone(p, ankle, top, 0.041, 0.0455);
        let up = (knee - ankle).normalize_or(Vec3::Y);
        blend(leg, clip(sock, (p - top).dot(up), 0.008), 0.006)
    }

    fn shoe(&self, p: Vec3, side: usize) -> f32 {
        let q = self.to_joint(p, joint::LEG[side] + 2);
        let upper = cone(q, Vec3::new(0.0, -0.045, -0.022), Vec3::new(0.0, -0.047, 0.09), 0.043, 0.044);
        let toe = ellipsoid(q, Vec3::new(0.0, -0.052, 0.128), Vec3::new(0.05, 0.036, 0.062));
        let cuff = cone(q, Vec3::new(0.0, -0.02, -0.006), Vec3::new(0.0, 0.012, -0.002), 0.046, 0.045);
        let cuff = clip(cuff, q.y - 0.006, 0.008);
        let top = blend(blend(upper, toe, 0.03), cuff, 0.03);
        // The sole: the outline of the shoe, a little wider, flat on the ground.
        let outline = |centre: f32, half: f32| ((q.x / half).powi(2) + ((q.z - centre) / 0.075).powi(2)).sqrt();
        let plan = blend((outline(-0.005, 0.047) - 1.0) * 0.045, (outline(0.112, 0.054) - 1.0) * 0.05, 0.04);
        let slab = Vec2::new(plan, (q.y + 0.071).abs() - 0.014);
        let sole = slab.max(Vec2::ZERO).length() + slab.max_element().min(0.0) - 0.004;
        clip(blend(top, sole, 0.006), -0.085 - q.y, 0.008)
    }

    fn skirt(&self, p: Vec3) -> f32 {
        if self.dress != Dress::Skirt {
            return trunks(p);
        }
        let across = skirt::across(p);
        let cloth = skirt::cloth(p, across);
        let filled = clip(clip(across, FILLED_ABOVE - p.y, 0.03), p.y - skirt::TOP, 0.01);
        let band = Vec2::new(across - 0.004, p.y - skirt::TOP + 0.02);
        let band = band.length() - 0.0135;
        blend(blend(cloth, filled, 0.03), band, 0.012)
    }
}

/// The leg of a pair of trousers over the joints of a leg, down to this share of the shin.
fn trouser([hip, knee, ankle]: [Vec3; 3], p: Vec3, down: f32) -> f32 {
    let end = knee.lerp(ankle, down.max(0.05));
    let upper = cone(p, hip, knee, 0.1, 0.074);
    let lower = cone(p, knee, end, 0.074, if down > 0.5 { 0.058 } else { 0.076 });
    let along = (ankle - knee).normalize_or(Vec3::NEG_Y);
    let end = if down > 0.5 { end } else { hip.lerp(knee, 0.9) };
    clip(blend(upper, lower, 0.03), (p - end).dot(along), 0.008)
}

/// Trousers about the hips, with a belt.
fn trunks(p: Vec3) -> f32 {
    let flat = 0.76;
    let q = Vec3::new(p.x, p.y, (p.z + 0.004) / flat);
    let hips = cone(q, Vec3::new(0.0, 0.93, 0.0), Vec3::new(0.0, TOP_OF_TRUNKS, 0.0), 0.158, 0.146) * flat;
    let seat = ellipsoid(side_of(p), Vec3::new(0.07, 0.925, -0.045), Vec3::new(0.085, 0.085, 0.07));
    let trunks = clip(blend(hips, seat, 0.04), p.y - TOP_OF_TRUNKS, 0.01);
    let belt = Vec2::new(hips - 0.003, p.y - TOP_OF_TRUNKS + 0.02).length() - 0.012;
    blend(trunks, belt, 0.01)
}

fn side_of(p: Vec3) -> Vec3 {
    Vec3::new(p.x.abs(), p.y, p.z)
}

/// Face, skull, ears and neck, in the frame of the head joint.
fn head_and_neck(p: Vec3) -> f32 {
    let side = Vec3::new(p.x.abs(), p.y, p.z);
    let skull = ellipsoid(p, Vec3::new(0.0, 0.118, 0.0), Vec3::new(0.094, 0.104, 0.106));
    let jaw = ellipsoid(p, Vec3::new(0.0, 0.05, 0.046), Vec3::new(0.055, 0.06, 0.058));
    let cheek = ellipsoid(side, Vec3::new(0.036, 0.073, 0.06), Vec3::new(0.036, 0.034, 0.036));
    let face = blend(blend(skull, jaw, 0.06), cheek, 0.025);
    let nose = cone(p, Vec3::new(0.0, 0.102, 0.098), Vec3::new(0.0, 0.079, 0.1155), 0.008, 0.0125);
    let face = blend(face, nose, 0.02);
    let socket = ellipsoid(side, Vec3::new(0.039, 0.112, 0.118), Vec3::new(0.024, 0.017, 0.02));
    let face = clip(face, -socket, 0.02);
    let ear = ellipsoid(side, Vec3::new(0.096, 0.092, -0.006), Vec3::new(0.014, 0.03, 0.02));
    let neck = cone(p, Vec3::new(0.0, -0.13, -0.018), Vec3::new(0.0, 0.03, -0.004), 0.049, 0.041);
    blend(blend(face, ear, 0.012), neck, 0.035)
}

/// Hair on the head, in the frame of the head joint: a cap, cut away from the face, with a fringe.
fn hair(p: Vec3) -> f32 {
    let cap = ellipsoid(p, Vec3::new(0.0, 0.126, -0.012), Vec3::new(0.111, 0.11, 0.116));
    let nape = ellipsoid(p, Vec3::new(0.0, 0.06, -0.045), Vec3::new(0.078, 0.075, 0.066));
    let cap = blend(cap, nape, 0.04);
    // Keep what lies behind and above the hairline; it sweeps down towards the ears, with a parting on the left.
    let from_parting = p.x - 0.034;
    let sweep = if from_parting > 0.0 { 0.62 * from_parting } else { -0.42 * from_parting };
    let front = (0.172 - sweep - 1.6 * from_parting.min(0.0).powi(2) - p.y) * 0.8
        + (p.z - 0.01) * smoothstep(0.2, 0.1, p.y) * 0.35;
    let behind = (p.z + 0.022) * 0.8 + (0.05 - p.y) * 0.25;
    clip(cap, front.min(behind), 0.012)
}

/// A hand in the frame of the left wrist: fingers down, palm towards -X, thumb forwards.
fn hand(q: Vec3) -> f32 {
    // Flat from palm to back.
    let flat = 0.56;
    let squash = |p: Vec3| Vec3::new(p.x / flat, p.y, p.z);
    let palm = cone(squash(q), Vec3::new(0.0, -0.03, 0.0), Vec3::new(0.0, -0.078, 0.002), 0.031, 0.038) * flat;
    let bent = |z: f32, length: f32, radius: f32| {
        let root = Vec3::new(0.0, -0.085, z);
        let knuckle = Vec3::new(-0.004, -0.085 - 0.5 * length, z * 1.06);
        let tip = Vec3::new(-0.017, -0.085 - length, z * 1.02);
        cone(q, root, knuckle, radius, radius).min(cone(q, knuckle, tip, radius, radius * 0.84))
    };
    // Two fingers and two fingers: a mitten that still reads as a hand at the resolution of the mesh.
    let fingers = blend(bent(0.026, 0.066, 0.0125), bent(0.009, 0.074, 0.0125), 0.016);
    let others = blend(bent(-0.0095, 0.07, 0.0125), bent(-0.027, 0.056, 0.0118), 0.016);
    let fingers = blend(fingers, others, 0.01);
    let ball = Vec3::new(-0.006, -0.035, 0.022);
    let joint = Vec3::new(-0.014, -0.066, 0.049);
    let tip = Vec3::new(-0.017, -0.097, 0.057);
    let thumb = blend(cone(q, ball, joint, 0.0165, 0.013), cone(q, joint, tip, 0.013, 0.0105), 0.01);
    blend(blend(palm, fingers, 0.014), thumb, 0.014)
}

/// How long edges should be near a point of the surface, as a multiple of the usual length.
#[must_use]
pub fn edge_scale(body: &Body, p: Vec3) -> f32 {
    let head = body.to_joint(p, joint::HEAD);
    let face = smoothstep(0.17, 0.1, (head - Vec3::new(0.0, 0.09, 0.06)).length());
    let mut scale = 1.0 - 0.47 * face;
    for side in 0..2 {
        let hand = body.to_joint(p, joint::ARM[side] + 3);
        scale = scale.min(1.0 - 0.52 * smoothstep(0.13, 0.09, (hand + Vec3::Y * 0.08).length()));
        let foot = body.to_joint(p, joint::LEG[side] + 2);
        scale = scale.min(1.0 - 0.3 * smoothstep(0.2, 0.12, (foot - Vec3::new(0.0, -0.05, 0.04)).length()));
    }
    if body.dress != Dress::Skirt {
        return scale;
    }
    // What the skirt hides may be coarse; its hem may not.
    let across = skirt::across(p);
    let hidden = smoothstep(-0.002, -0.006, across) * smoothstep(0.62, 0.68, p.y) * smoothstep(1.05, 1.0, p.y);
    let hem = smoothstep(0.035, 0.012, (p.y - skirt::HEM).abs()) * smoothstep(0.03, 0.015, across.abs());
    (scale * (1.0 + 0.55 * hidden)).min(1.0 - 0.36 * hem)
}
