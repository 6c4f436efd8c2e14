//! How scanned frames are brought to where they are shown.

use actor::carry::{Carried, Surface};
use glam::Vec3;
use kernels::align::Placement;

/// What a changed mesh carries to less than this from where it stands as it was scanned, metres, stands there: the mesh was left alone.
const LEFT_ALONE: f32 = 1e-5;

/// How a scanned frame is brought to where it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Brought {
    /// It stands as it was scanned: the number of its pose and the world from the scan.
    Placed(u64, Placement),
    /// The mesh of the nearer frame carries it, which was edited or varied; where that was left alone it stands as it was scanned, by this.
    Changed(Placement),
    /// The mesh carries it through a transition.
    Blended,
}

/// `pose` where `placement` puts it.
#[must_use]
pub fn placed(pose: &[Vec3], placement: Placement) -> Vec<Vec3> {
    let mut world = pose.to_vec();
    placement.apply_all(&mut world);
    world
}

/// Where `surface`, a mesh that was changed, carries what would stand at `world` if it had not been: to the bit there, where it was left alone.
#[must_use]
pub fn changed(surface: &Surface<'_>, carried: &[Carried], world: Vec<Vec3>) -> Vec<Vec3> {
    let place = |(stood, one): (Vec3, &Carried)| match surface.place(one) {
        Some(place) if place.distance(stood) > LEFT_ALONE => place,
        _ => stood,
    };
    world.into_iter().zip(carried).map(place).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    /// A strip of ten squares along X, of which `bent` metres of height are put on the vertex at its end.
    fn strip(bent: f32) -> (Vec<[u32; 3]>, Vec<Vec3>) {
        let mut pose: Vec<Vec3> = (0..22).map(|k| Vec3::new((k / 2) as f32 * 0.1, 0.0, (k % 2) as f32 * 0.1)).collect();
        pose[21].y += bent;
        let squares = (0..10).flat_map(|k| [[2 * k, 2 * k + 1, 2 * k + 2], [2 * k + 1, 2 * k + 3, 2 * k + 2]]);
        (squares.collect(), pose)
    }

    #[test]
    fn what_an_edit_leaves_alone_stands_as_scanned_to_the_bit_and_the_rest_goes_along() {
        let (triangles, pose) = strip(0.0);
        let surface = Surface::new(&triangles, &pose);
        // Over the middle of each triangle a little height.
        let middle = |t: &[u32; 3]| t.map(|v| pose[v as usize]).iter().sum::<Vec3>() / 3.0 + Vec3::Y * 0.003;
        let scanned: Vec<Vec3> = triangles.iter().map(middle).collect();
        let carry = |(k, p): (usize, &Vec3)| surface.carry(*p, k as u32, [1.0 / 3.0; 2]).unwrap();
        let carried: Vec<Carried> = scanned.iter().enumerate().map(carry).collect();
        let placement = Placement { heading: 0.7, translation: Vec2::new(2.0, -3.0) };
        let world = placed(&scanned, placement);
        let shown = |bent: f32| {
            let pose = placed(&strip(bent).1, placement);
            changed(&Surface::new(&triangles, &pose), &carried, world.clone())
        };
        assert_eq!(shown(0.0), world);
        let bent = shown(0.05);
        // What the last vertex, and the normals around it, do not reach.
        assert_eq!(bent[..16], world[..16]);
        let lifted = bent[19].y - world[19].y;
        assert!((0.01..0.03).contains(&lifted), "{lifted}");
    }
}
