//! Where the feet stand and how they travel from one stand to the next.

use glam::Vec3;

use super::curve::Curve;
use super::skeleton::Foot;

/// A foot rolled further than this, in radians, only leaves its toes or its heel on the ground: it does not stand.
const STANDING: f32 = 0.3;

/// A foot on the ground.
#[derive(Clone, Debug)]
pub struct Plant {
    /// When it lands, in seconds.
    pub from: f32,
    /// When it leaves the ground.
    pub to: f32,
    /// The ground below the ankle when the sole is flat.
    pub place: Vec3,
    /// Heading of the foot in radians.
    pub yaw: f32,
    /// Roll over the sole while it stands: pitch in degrees over seconds since `from`.
    pub roll: Curve,
    /// The way to the next plant.
    pub swing: Swing,
}

/// The way of a foot through the air. All curves run over the share of the swing, 0 to 1.
#[derive(Clone, Debug, Default)]
pub struct Swing {
    /// Height above the line between the plants, metres.
    pub height: Curve,
    /// Pitch in degrees, heel up.
    pub pitch: Curve,
    /// Aside of that line, to the figure's left, metres.
    pub left: Curve,
    /// Ahead of that line, metres.
    pub forward: Curve,
    /// Whether the foot flies with a jump instead of easing from stand to stand.
    pub ballistic: bool,
}

/// One foot over a whole sequence: plants in ascending time.
#[derive(Clone, Debug, Default)]
pub struct FootTrack {
    /// The plants; at least one.
    pub plants: Vec<Plant>,
}

impl FootTrack {
    /// A foot that never moves.
    #[must_use]
    pub fn standing(place: Vec3, yaw: f32) -> Self {
        let plant = Plant { from: -100.0, to: 100.0, place, yaw, roll: Curve::default(), swing: Swing::default() };
        Self { plants: vec![plant] }
    }

    /// Lifts the foot at `lift` and puts it down at `land` at `place`.
    #[must_use]
    pub fn step(mut self, lift: f32, land: f32, place: Vec3, yaw: f32, swing: Swing) -> Self {
        if let Some(last) = self.plants.last_mut() {
            last.to = lift;
            last.swing = swing;
        }
        self.plants.push(Plant { from: land, to: 100.0, place, yaw, roll: Curve::default(), swing: Swing::default() });
        self
    }

    /// Gives the last plant so far a roll over the sole: pitch in degrees over seconds since it landed.
    #[must_use]
    pub fn rolling(mut self, keys: &[(f32, f32)]) -> Self {
        if let Some(last) = self.plants.last_mut() {
            last.roll = Curve::new(keys);
        }
        self
    }

    /// The foot at time `t`, and whether it stands.
    #[must_use]
    pub fn at(&self, t: f32) -> (Foot, bool) {
        let next = self.plants.partition_point(|plant| plant.from <= t).max(1);
        let Some(plant) = self.plants.get(next - 1) else {
            return (Foot { place: Vec3::ZERO, yaw: 0.0, pitch: 0.0, toes_level: 1.0 }, false);
        };
        match self.plants.get(next) {
            Some(target) if t > plant.to => (swinging(plant, target, t), false),
            _ => {
                let pitch = plant.roll.at(t - plant.from).to_radians();
                let foot = Foot { place: plant.place, yaw: plant.yaw, pitch, toes_level: 1.0 };
                (foot, pitch.abs() < STANDING)
            }
        }
    }
}

fn swinging(from: &Plant, to: &Plant, t: f32) -> Foot {
    let u = ((t - from.to) / (to.from - from.to)).clamp(0.0, 1.0);
    let eased = u * u * u * (u * (u * 6.0 - 15.0) + 10.0);
    let way = if from.swing.ballistic { u } else { 0.75 * eased + 0.25 * u * u * (3.0 - 2.0 * u) };
    let yaw = from.yaw + (to.yaw - from.yaw) * way;
    let swing = &from.swing;
    let aside = glam::Quat::from_rotation_y(yaw) * Vec3::new(swing.left.at(u), 0.0, swing.forward.at(u));
    let place = from.place.lerp(to.place, way) + aside + Vec3::Y * swing.height.at(u);
    // The toes hang level near the ground and follow the foot in the air.
    let toes_level = (1.0 - 6.0 * u.min(1.0 - u)).clamp(0.25, 1.0);
    Foot { place, yaw, pitch: swing.pitch.at(u).to_radians(), toes_level }
}
