//! Waving with the right hand, leaning a little to the other side.

use super::keyed::{Keyed, standing};
use crate::skeleton::{BodyState, Channel};
use geometry::sdf::smoothstep;
use kernels::random::noise1;

pub(super) fn motion(seed: u64) -> impl Fn(f32) -> (BodyState, [bool; 2]) {
    let keys: &[super::keyed::Keys] = &[
        (Channel::SpreadR, &[(0.0, 0.0), (0.5, 112.0), (1.8, 110.0), (2.25, 0.0)]),
        (Channel::FlexR, &[(0.0, 0.0), (0.4, 16.0), (1.8, 14.0), (2.2, 0.0)]),
        (Channel::TwistR, &[(0.0, 0.0), (0.5, -96.0), (1.8, -96.0), (2.25, 0.0)]),
        (Channel::ElbowR, &[(0.0, 0.0), (0.35, 78.0), (0.6, 46.0), (1.7, 48.0), (2.25, 0.0)]),
        (Channel::Left, &[(0.0, 0.0), (0.6, 0.04), (1.7, 0.035), (2.3, 0.0)]),
        (Channel::PelvisRoll, &[(0.0, 0.0), (0.6, 4.0), (1.7, 3.5), (2.3, 0.0)]),
        (Channel::TrunkRoll, &[(0.0, 0.0), (0.55, -8.0), (1.7, -7.0), (2.3, 0.0)]),
        (Channel::HeadRoll, &[(0.1, 0.0), (0.6, -9.0), (1.7, -8.0), (2.2, 0.0)]),
        (Channel::HeadPitch, &[(0.1, 0.0), (0.6, -4.0), (1.7, -4.0), (2.2, 0.0)]),
        (Channel::FlexL, &[(0.1, 0.0), (0.7, -7.0), (1.7, -5.0), (2.2, 0.0)]),
    ];
    let keyed = Keyed::new(keys, standing(), seed);
    move |t| {
        let (mut state, planted) = keyed.at(t);
        let amount = smoothstep(0.4, 0.6, t) * smoothstep(1.95, 1.7, t);
        let beat = ((t - 0.5) * 13.5 + 0.5 * noise1(seed, t)).sin();
        state.controls[Channel::ElbowR] += 27.0 * amount * beat;
        state.controls[Channel::SpreadR] += 6.0 * amount * beat;
        state.controls[Channel::HandR] += 18.0 * amount * ((t - 0.56) * 13.5).sin();
        state.controls[Channel::TrunkYaw] += 1.5 * amount * beat;
        (state, planted)
    }
}
