//! Ducking: a quick deep crouch with the arms over the head, a look up, and back.

use super::keyed::{Keyed, standing};
use crate::skeleton::{BodyState, Channel};

pub(super) fn motion(seed: u64) -> impl Fn(f32) -> (BodyState, [bool; 2]) {
    let keys: &[super::keyed::Keys] = &[
        (Channel::Up, &[(0.15, 0.0), (0.32, 0.008), (0.72, -0.43), (0.86, -0.41), (1.25, -0.4), (1.9, 0.0)]),
        (Channel::Forward, &[(0.2, 0.0), (0.7, -0.1), (1.25, -0.1), (1.9, 0.0)]),
        (Channel::PelvisPitch, &[(0.2, 0.0), (0.7, 26.0), (1.25, 22.0), (1.9, 0.0)]),
        (Channel::TrunkPitch, &[(0.2, -2.0), (0.7, 40.0), (0.85, 36.0), (1.25, 32.0), (1.95, 0.0)]),
        (Channel::HeadPitch, &[(0.25, -3.0), (0.7, 18.0), (0.95, 14.0), (1.3, -34.0), (1.9, 0.0)]),
        (Channel::HeadYaw, &[(0.9, 0.0), (1.25, 24.0), (1.6, -10.0), (2.0, 0.0)]),
        (Channel::KneeL, &[(0.3, 0.0), (0.7, 18.0), (1.25, 16.0), (1.9, 0.0)]),
        (Channel::KneeR, &[(0.3, 0.0), (0.7, 18.0), (1.25, 16.0), (1.9, 0.0)]),
        (Channel::FlexL, &[(0.15, 0.0), (0.6, 118.0), (1.1, 112.0), (1.4, 44.0), (1.95, 0.0)]),
        (Channel::FlexR, &[(0.18, 0.0), (0.64, 124.0), (1.12, 116.0), (1.45, 44.0), (1.98, 0.0)]),
        (Channel::SpreadL, &[(0.2, 0.0), (0.6, 20.0), (1.1, 18.0), (1.9, 0.0)]),
        (Channel::SpreadR, &[(0.2, 0.0), (0.6, 20.0), (1.1, 18.0), (1.9, 0.0)]),
        (Channel::TwistL, &[(0.2, 0.0), (0.6, 34.0), (1.1, 30.0), (1.9, 0.0)]),
        (Channel::TwistR, &[(0.2, 0.0), (0.6, 34.0), (1.1, 30.0), (1.9, 0.0)]),
        (Channel::ElbowL, &[(0.15, 0.0), (0.6, 100.0), (1.1, 96.0), (1.5, 40.0), (1.95, 0.0)]),
        (Channel::ElbowR, &[(0.18, 0.0), (0.64, 104.0), (1.12, 98.0), (1.5, 40.0), (1.98, 0.0)]),
    ];
    let keyed = Keyed::new(keys, standing(), seed);
    move |t| keyed.at(t)
}
