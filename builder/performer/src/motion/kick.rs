//! A high front kick with the right leg, after shifting the weight to the left.

use super::keyed::{Keyed, stand};
use crate::curve::Curve;
use crate::feet::{FootTrack, Swing};
use crate::skeleton::{BodyState, Channel};

pub(super) fn motion(seed: u64) -> impl Fn(f32) -> (BodyState, [bool; 2]) {
    let swing = Swing {
        height: Curve::new(&[
            (0.0, 0.0),
            (0.16, 0.1),
            (0.33, 0.5),
            (0.48, 1.02),
            (0.62, 0.66),
            (0.82, 0.12),
            (1.0, 0.0),
        ]),
        forward: Curve::new(&[
            (0.0, 0.0),
            (0.13, -0.17),
            (0.31, 0.3),
            (0.48, 0.8),
            (0.6, 0.5),
            (0.8, 0.04),
            (1.0, 0.0),
        ]),
        left: Curve::new(&[(0.0, 0.0), (0.45, 0.05), (1.0, 0.0)]),
        pitch: Curve::new(&[
            (0.0, 32.0),
            (0.16, 62.0),
            (0.34, 10.0),
            (0.48, -52.0),
            (0.62, -8.0),
            (0.85, 22.0),
            (1.0, 8.0),
        ]),
        ballistic: false,
    };
    let right = FootTrack::standing(stand(1), -0.12)
        .rolling(&[(100.0 + 0.3, 0.0), (100.0 + 0.46, 32.0)])
        .step(0.46, 1.62, stand(1), -0.12, swing)
        .rolling(&[(0.0, 8.0), (0.12, 0.0)]);
    let feet = [FootTrack::standing(stand(0), 0.3), right];
    let keys: &[super::keyed::Keys] = &[
        (Channel::Left, &[(0.0, 0.0), (0.42, 0.085), (1.5, 0.085), (1.95, 0.0)]),
        (Channel::Forward, &[(0.0, 0.0), (0.45, 0.03), (0.98, -0.045), (1.4, 0.015), (1.9, 0.0)]),
        (Channel::Up, &[(0.0, 0.0), (0.4, -0.03), (0.95, 0.0), (1.4, -0.025), (1.9, 0.0)]),
        (Channel::PelvisPitch, &[(0.2, 0.0), (0.6, 7.0), (1.0, -20.0), (1.45, 4.0), (1.9, 0.0)]),
        (Channel::PelvisYaw, &[(0.2, 0.0), (0.55, -14.0), (1.0, 20.0), (1.6, 0.0)]),
        (Channel::PelvisRoll, &[(0.1, 0.0), (0.5, 4.0), (1.0, -5.0), (1.6, 0.0)]),
        (Channel::TrunkPitch, &[(0.2, 0.0), (0.6, 5.0), (1.0, -3.0), (1.4, 9.0), (1.9, 0.0)]),
        (Channel::TrunkYaw, &[(0.2, 0.0), (0.55, 18.0), (1.0, -24.0), (1.6, 0.0)]),
        (Channel::HeadPitch, &[(0.4, 0.0), (1.0, 14.0), (1.6, 0.0)]),
        (Channel::FlexL, &[(0.1, 0.0), (0.55, -22.0), (1.0, 52.0), (1.5, 8.0), (1.9, 0.0)]),
        (Channel::SpreadL, &[(0.1, 0.0), (0.6, 22.0), (1.0, 42.0), (1.5, 18.0), (1.95, 0.0)]),
        (Channel::ElbowL, &[(0.1, 0.0), (0.5, 34.0), (1.0, 58.0), (1.9, 0.0)]),
        (Channel::FlexR, &[(0.1, 0.0), (0.55, 26.0), (1.02, -36.0), (1.5, 4.0), (1.9, 0.0)]),
        (Channel::SpreadR, &[(0.1, 0.0), (0.55, 18.0), (1.0, 48.0), (1.5, 16.0), (1.95, 0.0)]),
        (Channel::ElbowR, &[(0.1, 0.0), (0.55, 52.0), (1.0, 22.0), (1.9, 0.0)]),
    ];
    let keyed = Keyed::new(keys, feet, seed);
    move |t| keyed.at(t)
}
