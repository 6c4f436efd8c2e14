//! Standing: the weight goes from one leg to the other, the head looks about, a hand comes up and falls again.

use super::keyed::{Keyed, standing};
use crate::skeleton::{BodyState, Channel};

pub(super) fn motion(seed: u64) -> impl Fn(f32) -> (BodyState, [bool; 2]) {
    let keys: &[super::keyed::Keys] = &[
        (Channel::Left, &[(-1.0, -0.035), (0.3, -0.04), (1.3, 0.045), (2.2, 0.04), (3.4, -0.03)]),
        (Channel::PelvisRoll, &[(-1.0, -3.5), (0.3, -4.0), (1.3, 4.5), (2.2, 4.0), (3.4, -3.0)]),
        (Channel::TrunkRoll, &[(-1.0, 4.0), (0.4, 4.0), (1.4, -4.5), (2.2, -4.0), (3.4, 3.0)]),
        (Channel::Up, &[(-1.0, -0.008), (0.3, -0.008), (0.8, -0.018), (1.3, -0.008), (3.4, -0.008)]),
        (Channel::HeadYaw, &[(-1.0, 6.0), (0.2, 8.0), (0.9, 22.0), (1.5, 18.0), (2.2, -14.0), (3.2, -6.0)]),
        (Channel::HeadPitch, &[(0.2, 0.0), (0.9, 3.0), (1.6, -4.0), (2.4, 0.0)]),
        (Channel::FlexL, &[(0.5, 0.0), (1.2, 24.0), (1.7, 22.0), (2.4, 0.0)]),
        (Channel::ElbowL, &[(0.4, 0.0), (1.2, 66.0), (1.7, 60.0), (2.4, 0.0)]),
        (Channel::TwistL, &[(0.4, 0.0), (1.2, 30.0), (1.7, 26.0), (2.4, 0.0)]),
        (Channel::KneeR, &[(0.3, 0.0), (1.3, 8.0), (2.2, 6.0), (3.2, 0.0)]),
    ];
    let keyed = Keyed::new(keys, standing(), seed);
    move |t| keyed.at(t)
}
