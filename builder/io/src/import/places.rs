//! Where a capture stands: coordinates of a map become coordinates about the actor.
//!
//! 32-bit numbers hold seven digits: 500 km from the origin that is 3 cm. So what stands far away is moved to the origin
//! while its coordinates still have 64 bits, by whole metres, and the offset is kept.

use std::path::Path;

use glam::DVec3;

use super::warning::Warning;

/// A capture is moved where it stands farther from the origin than this, in metres...
const FAR: f64 = 100.0;
/// ...and than so many times its own size: what is that large is in other units.
const FAR_SIZES: f64 = 20.0;

/// What to take off all positions, where the first pose is far from the origin: whole metres along each axis.
pub(super) fn offset_of(pose: impl Iterator<Item = DVec3> + Clone) -> Option<DVec3> {
    let low = pose.clone().reduce(DVec3::min)?;
    let high = pose.reduce(DVec3::max)?;
    let centre = (low + high) / 2.0;
    if !(low.is_finite() && high.is_finite() && centre.abs().max_element() > FAR.max(FAR_SIZES * low.distance(high))) {
        return None;
    }
    // What stands on the ground of a map stands on the ground.
    let offset = DVec3::new(centre.x.round(), low.y.round(), centre.z.round());
    (offset != DVec3::ZERO).then_some(offset)
}

/// The sentence about an offset.
pub(super) fn recentred(offset: DVec3, path: &Path) -> Warning {
    let DVec3 { x, y, z } = offset;
    Warning::new(
        "W_RECENTRED",
        format!(
            "{}: stands {:.1} km from the origin, as on a map: {x}, {y}, {z} metres (+Y up) are taken off all coordinates",
            path.display(),
            offset.length() / 1000.0
        ),
    )
}

/// Coordinates that are rounded by more than this share of the body's size look rough.
const COARSE: f64 = 5e-4;

/// A sentence about 32-bit coordinates so far from the origin that their last digits are missing; `pose` in metres.
pub(super) fn coarse(pose: impl Iterator<Item = DVec3> + Clone, path: &Path) -> Option<Warning> {
    let low = pose.clone().reduce(DVec3::min)?;
    let high = pose.reduce(DVec3::max)?;
    // Half of the last of 24 bits.
    let rounding = low.abs().max(high.abs()).max_element() / f64::from(1 << 24);
    (rounding > COARSE * low.distance(high)).then(|| {
        Warning::new(
            "W_COORDINATES_COARSE",
            format!(
                "{}: this far from the origin, 32-bit coordinates are rounded by up to {:.1} mm, which shows: write the \
                 file with coordinates about the actor, or with 64 bits",
                path.display(),
                rounding * 1000.0
            ),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(at: DVec3, size: f64) -> [DVec3; 2] {
        [at, at + DVec3::new(0.3, 1.0, 0.3) * size]
    }

    #[test]
    fn only_what_stands_far_away_is_moved() {
        let offset = |at: DVec3, size: f64| offset_of(body(at, size).into_iter());
        assert_eq!(offset(DVec3::new(432_187.25, 12.5, 583_921.75), 1.7), Some(DVec3::new(432_188.0, 13.0, 583_922.0)));
        assert_eq!(offset(DVec3::new(0.0, 0.2, -3000.0), 1.7), Some(DVec3::new(0.0, 0.0, -3000.0)));
        // A stage of 90 m, and an actor in millimetres.
        assert_eq!(offset(DVec3::new(90.0, 0.0, 0.0), 1.7), None);
        assert_eq!(offset(DVec3::new(3000.0, 0.0, 1000.0), 1700.0), None);
        assert_eq!(offset(DVec3::new(f64::NAN, 0.0, 1e9), 1.7), None);
        assert_eq!(offset_of(std::iter::empty()), None);
    }

    #[test]
    fn rounding_is_told_where_it_shows() {
        let told = |at: f64| coarse(body(DVec3::splat(at), 1.7).into_iter(), Path::new("f.ply"));
        assert_eq!(told(1000.0), None);
        assert!(told(200_000.0).is_some_and(|warning| warning.contains("11.9 mm")));
    }
}
