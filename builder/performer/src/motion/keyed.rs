//! Motions written as keys: curves over single channels, on top of standing at ease.

use glam::Vec3;

use crate::curve::Curve;
use crate::feet::FootTrack;
use crate::skeleton::{BodyState, Channel, Controls};
use kernels::random::{mix, noise1};

/// Keys of one channel: times in seconds, and what is added to standing at ease.
pub type Keys<'a> = (Channel, &'a [(f32, f32)]);

/// A motion on the spot from keys and foot tracks.
pub struct Keyed {
    curves: Vec<(Channel, Curve)>,
    feet: [FootTrack; 2],
    seed: u64,
}

impl Keyed {
    /// A motion from `keys` and `feet`; `seed` varies how much and how fast it is done.
    #[must_use]
    pub fn new(keys: &[Keys], feet: [FootTrack; 2], seed: u64) -> Self {
        let curves = keys
            .iter()
            .enumerate()
            .map(|(k, (channel, keys))| {
                // Feet and height must agree with each other; the rest is done a little differently in each take.
                let exact = matches!(channel, Channel::Up | Channel::Forward | Channel::Left);
                let amount = if exact { 1.0 } else { 1.0 + 0.07 * noise1(mix(seed, k as u64), 0.5) };
                let keys: Vec<(f32, f32)> = keys.iter().map(|&(t, v)| (t, v * amount)).collect();
                (*channel, Curve::new(&keys))
            })
            .collect();
        Self { curves, feet, seed }
    }

    /// The body at time `t`, and which feet are down.
    #[must_use]
    pub fn at(&self, t: f32) -> (BodyState, [bool; 2]) {
        let mut controls = Controls::default();
        for (channel, curve) in &self.curves {
            controls[*channel] += curve.at(t);
        }
        live(&mut controls, t, self.seed);
        let (left, right) = (self.feet[0].at(t), self.feet[1].at(t));
        let state = BodyState { root: Vec3::ZERO, heading: 0.0, controls, feet: [left.0, right.0] };
        (state, [left.1, right.1])
    }
}

/// Where the feet stand at ease.
#[must_use]
pub fn stand(side: usize) -> Vec3 {
    Vec3::new(if side == 0 { 0.1 } else { -0.1 }, 0.0, -0.012)
}

/// Both feet at ease.
#[must_use]
pub fn standing() -> [FootTrack; 2] {
    [FootTrack::standing(stand(0), 0.12), FootTrack::standing(stand(1), -0.12)]
}

/// Breath, sway and a wandering look.
pub fn live(controls: &mut Controls, t: f32, seed: u64) {
    let noise = |stream: u64, rate: f32| noise1(mix(seed, 100 + stream), t * rate);
    let breath = (t * 1.7 + noise(0, 0.3)).sin();
    controls[Channel::TrunkPitch] += 0.9 * breath + 0.8 * noise(1, 0.6);
    controls[Channel::ShrugL] += 0.8 * breath;
    controls[Channel::ShrugR] += 0.8 * breath;
    controls[Channel::Left] += 0.007 * noise(2, 0.5);
    controls[Channel::Forward] += 0.006 * noise(3, 0.6);
    controls[Channel::PelvisYaw] += 1.5 * noise(4, 0.5);
    controls[Channel::HeadYaw] += 6.0 * noise(5, 0.55);
    controls[Channel::HeadPitch] += 2.5 * noise(6, 0.6);
    controls[Channel::HeadRoll] += 2.0 * noise(7, 0.4);
    for (k, channel) in [Channel::FlexL, Channel::FlexR, Channel::ElbowL, Channel::ElbowR].into_iter().enumerate() {
        controls[channel] += 2.2 * noise(8 + k as u64, 0.6);
    }
}
