//! Two actors whose frames stand upright about their hips, turned alike where they mean the same.
//!
//! A body's own frame follows what moves least: of one body it may be the hips, of another the chest, which turn against each other by ten
//! degrees. Bones turn alike in the world, so frames do not turn with bodies, but for their heading: that of the source's, and for
//! the target the one by which its bones are turned most like the source's.

use glam::{Mat3, Quat, Vec3};
use rayon::prelude::*;

use crate::bones::mean;
use crate::pair::Pair;
use crate::subject::{Root, Subject};

/// Rounds of finding how bones differ at rest, and how frames are turned.
const ROUNDS: usize = 4;

/// Source and target with such frames; `None` where either has no human's bones.
pub fn upright<'a>(source: &Subject<'a>, target: &Subject<'a>, pairs: &[Pair]) -> Option<[Subject<'a>; 2]> {
    let like = target.bones()?.like(source.bones()?);
    let source = about_hips(source)?;
    let mut target = about_hips(target)?;
    let mut turns: Vec<[Vec<Quat>; 2]> = pairs
        .par_iter()
        .map(|pair| {
            let [own, other] = [source.own_at(pair.source), target.own(pair.target)];
            let own = source.bones()?.at(&own);
            let other = target.bones()?.at(&other);
            let like = like.iter().map(|&bone| own[bone].rotation).collect();
            Some([like, other.iter().map(|motion| motion.rotation).collect()])
        })
        .collect::<Option<_>>()?;
    for _ in 0..ROUNDS {
        let at_rest: Vec<Quat> = (0..like.len())
            .map(|bone| mean(turns.iter().map(|[own, other]| own[bone].inverse() * other[bone])))
            .collect();
        for (pair, [own, other]) in pairs.iter().zip(&mut turns) {
            let turned = own
                .iter()
                .zip(&at_rest)
                .zip(other.iter())
                .map(|((own, rest), other)| *other * (*own * *rest).inverse());
            let by = about_vertical(turned);
            let back = Quat::from_rotation_y(-by);
            other.iter_mut().for_each(|turn| *turn = back * *turn);
            target.roots[pair.target as usize].heading += by;
        }
    }
    Some([source, target])
}

/// A subject whose frames are upright about its hips.
fn about_hips<'a>(subject: &Subject<'a>) -> Option<Subject<'a>> {
    let bones = subject.bones()?;
    let roots = subject.roots.par_iter().enumerate().map(|(frame, root)| Root {
        heading: root.heading,
        tilt: Vec3::ZERO,
        centre: bones.hips(subject.poses.frame(frame as u32)),
    });
    Some(subject.with_roots(roots.collect()))
}

/// The turn about +Y that is most like some rotations.
fn about_vertical(turns: impl Iterator<Item = Quat>) -> f32 {
    let sum = turns.map(Mat3::from_quat).fold(Mat3::ZERO, |sum, turn| sum + turn);
    (sum.z_axis.x - sum.x_axis.z).atan2(sum.x_axis.x + sum.z_axis.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_about_the_vertical_are_found() {
        let lean = |x: f32| Quat::from_rotation_y(0.7) * Quat::from_rotation_x(x);
        assert!((about_vertical([0.2, -0.2, 0.1, -0.1].into_iter().map(lean)) - 0.7).abs() < 1e-3);
    }
}
