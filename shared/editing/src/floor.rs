//! The ground: no edit takes anything below it, or below where the frame as it was recorded is lowest.
//!
//! Feet that stand are held where they are. Where none stands, a head that is pulled down would take both feet through the
//! ground: so what would go below it is stopped there, and the body bends over that. Bones are stopped by targets that push
//! upwards alone; a surface without bones by holding its lowest vertices; and what then is still too low is lifted.

use actor::feet::Feet;
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use glam::{Quat, Vec3};
use kernels::cholesky::CholeskyError;

use crate::carry::{Carried, size, skin};
use crate::deform::Deformer;
use crate::reach::{Bend, Reach, Target};
use crate::rig::{NO_BONE, Rig};
use crate::soles::{firm, sole};

/// What is less far below the ground is no matter of the bones, in metres; it is laid onto the ground as it is.
const SHALLOW: f32 = 1e-3;
/// Times that the bones are bent on over what has come below the ground, or the surface is held there.
pub(crate) const ROUNDS: usize = 4;
/// Weight of what pushes upwards in the inverse kinematics, and of staying over the same place meanwhile: else a leg that is pushed up
/// slides to whatever side is nearer, to another one in the next frame.
const FIRM: f32 = 200.0;
const ROUGH: f32 = 0.05;
/// How many such targets there are at most.
const MOST: usize = 64;
/// Vertices so near to the lowest one are held together with it, as a share of the body's size.
const LAYER: f32 = 0.006;

/// The frames that tell how high the ground is under `frame`: itself where a foot stands in it, else the nearest ones before and
/// after it in which one does; of another sequence where none ever stands in this one.
#[must_use]
pub fn telling(timeline: &Timeline, feet: &Feet, frame: u32) -> Vec<u32> {
    let stands = |frame: u32| (0..feet.count()).any(|foot| feet.stands(frame, foot));
    if stands(frame) || feet.count() == 0 {
        return vec![frame];
    }
    let count = timeline.sequence_of(frame).map_or(0, |sequence| i64::from(sequence.frame_count));
    let nearest = |way: i64| (1..count).map_while(|k| timeline.offset(frame, way * k)).find(|&other| stands(other));
    let mut found: Vec<u32> = [nearest(-1), nearest(1)].into_iter().flatten().collect();
    if found.is_empty() {
        let others = (0..timeline.frame_count()).filter(|&other| stands(other));
        found.extend(others.min_by_key(|other| other.abs_diff(frame)));
    }
    found.dedup();
    if found.is_empty() { vec![frame] } else { found }
}

/// How high the ground is under `frame`, which is `pose` as it was recorded: where the soles that stand are lowest; where none ever
/// stands, where the body is.
pub(crate) fn ground(
    (timeline, feet): (&Timeline, &Feet),
    source: &mut dyn PoseSource,
    frame: u32,
    pose: &[Vec3],
) -> Result<f32, PoseError> {
    let mut height = f32::INFINITY;
    let mut other = pose.to_vec();
    for telling in telling(timeline, feet, frame) {
        if telling != frame {
            source.read(telling, &mut other)?;
        }
        let standing = (0..feet.count()).filter(|&foot| feet.stands(telling, foot));
        let soles = standing.flat_map(|foot| sole(feet, foot)).map(|vertex| other[vertex as usize].y);
        height = soles.fold(height, f32::min);
    }
    Ok(if height.is_finite() { height } else { lowest(pose) })
}

/// The feet on which `frame` stands as it was recorded, for edits that say nothing of pins; `count` is the number of vertices.
///
/// # Errors
/// A frame that cannot be read.
pub fn standing_in(
    known: (&Timeline, &Feet),
    source: &mut dyn PoseSource,
    frame: u32,
    count: usize,
) -> Result<Vec<bool>, PoseError> {
    let mut pose = vec![Vec3::ZERO; count];
    source.read(frame, &mut pose)?;
    let ground = ground(known, source, frame, &pose)?;
    Ok(firm(known.0, known.1, frame, &pose, ground).iter().map(|firm| *firm > 0.5).collect())
}

/// How low a pose is.
pub(crate) fn lowest(pose: &[Vec3]) -> f32 {
    pose.iter().map(|point| point.y).fold(f32::INFINITY, f32::min)
}

/// How the vertices of `pose` turn and move by `bend`, which is bent on as long as parts of bones come below `floor`, in metres.
pub(crate) fn above(
    (rig, pose, carried): (&Rig, &[Vec3], &[Carried]),
    floor: f32,
    (reach, targets, centre, bend): (&mut Reach, &mut Vec<Target>, &Bend, &mut Bend),
    steps: usize,
) -> (Vec<Quat>, Vec<Vec3>) {
    let mut skinned = skin(rig, pose, &reach.motions(bend), carried);
    for _ in 0..ROUNDS {
        if !block(rig, pose, &skinned.1, floor, reach, targets) {
            break;
        }
        reach.solve(targets, centre, bend, steps);
        skinned = skin(rig, pose, &reach.motions(bend), carried);
    }
    skinned
}

/// Further targets that push up what is below the ground, of each bone the deepest vertex and the outermost ones; whether there are
/// any. Cloth and hair push nothing.
fn block(rig: &Rig, pose: &[Vec3], told: &[Vec3], floor: f32, reach: &mut Reach, targets: &mut Vec<Target>) -> bool {
    let mut by_bone: Vec<Vec<u32>> = vec![Vec::new(); rig.bones().len()];
    let moved = |vertex: u32| pose[vertex as usize] + told[vertex as usize];
    for vertex in 0..pose.len() as u32 {
        if moved(vertex).y < floor - SHALLOW && rig.core()[vertex as usize] != NO_BONE {
            by_bone[rig.bone_of(vertex)].push(vertex);
        }
    }
    let before = targets.len();
    for (bone, under) in by_bone.iter().enumerate().filter(|(_, under)| !under.is_empty()) {
        for axis in [Vec3::NEG_Y, Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
            let along = |vertex: u32| moved(vertex).dot(axis);
            let outermost = under.iter().copied().reduce(|best, v| if along(v) > along(best) { v } else { best });
            let Some(vertex) = outermost else { continue };
            let point = pose[vertex as usize];
            let is_known = |target: &Target| target.is_floor && target.parts[0].2 == point;
            if !targets.iter().any(is_known) && targets.iter().filter(|target| target.is_floor).count() < MOST {
                targets.push(Target {
                    parts: vec![(bone, 1.0, point)],
                    to: moved(vertex).with_y(floor),
                    weight: Vec3::new(ROUGH, FIRM, ROUGH),
                    is_floor: true,
                });
            }
        }
        // A leg on the ground bends, as one that stands does.
        reach.rouse(rig, rig.bones()[bone].limb);
    }
    targets.len() > before
}

/// Lifts what of the pose `moved` is below `floor`, deepest parts first and what is around with them; `fixed` stays. Whether anything was.
pub(crate) fn lift(
    deformer: &mut Deformer,
    moved: &mut [Vec3],
    fixed: &[u32],
    anchor: f32,
    floor: f32,
) -> Result<bool, CholeskyError> {
    if lowest(moved) >= floor {
        return Ok(false);
    }
    let mut held: Vec<u32> = fixed.iter().copied().filter(|&vertex| moved[vertex as usize].y >= floor).collect();
    held.sort_unstable();
    held.dedup();
    for _ in 0..ROUNDS {
        let layer = layer(moved, floor, &held);
        if layer.is_empty() {
            break;
        }
        let up = layer.iter().map(|&vertex| Vec3::Y * (floor - moved[vertex as usize].y));
        let wanted: Vec<Vec3> = held.iter().map(|_| Vec3::ZERO).chain(up).collect();
        held.extend(layer);
        let system = deformer.hold(moved, &held, anchor)?;
        let (turns, told) = (vec![Quat::IDENTITY; moved.len()], vec![Vec3::ZERO; moved.len()]);
        let lifted = deformer.solve(&system, moved, &turns, &told, &wanted)?;
        moved.iter_mut().zip(lifted).for_each(|(point, lifted)| *point += lifted);
    }
    moved.iter_mut().for_each(|point| point.y = point.y.max(floor));
    Ok(true)
}

/// The vertices that are about as far below `floor` as the deepest; none where that is nearly at it. `held` are not asked.
pub(crate) fn layer(moved: &[Vec3], floor: f32, held: &[u32]) -> Vec<u32> {
    let mut is_held = vec![false; moved.len()];
    held.iter().for_each(|&vertex| is_held[vertex as usize] = true);
    let free = || (0..moved.len() as u32).filter(|&vertex| !is_held[vertex as usize]);
    let low = free().map(|vertex| moved[vertex as usize].y).fold(f32::INFINITY, f32::min);
    if low >= floor - SHALLOW {
        return Vec::new();
    }
    let most = (low + LAYER * size(moved)).min(floor);
    free().filter(|&vertex| moved[vertex as usize].y < most).collect()
}

#[cfg(test)]
mod tests {
    use glam::Mat3;

    use super::*;
    use crate::reach::Role;
    use crate::rig::Bone;
    use crate::rigid::Rigid;
    use crate::skin::Influences;

    /// A pelvis, a thigh and a shin with its sole at height 0.
    fn leg() -> Rig {
        let joints = [Vec3::Y, Vec3::Y, Vec3::new(0.02, 0.5, 0.0)];
        let bones = joints.iter().enumerate().map(|(index, &joint)| Bone {
            name: format!("b{index}"),
            parent: index.saturating_sub(1),
            joint,
            limb: u32::from(index > 0),
            range: [Vec3::splat(-2.0), Vec3::splat(2.0)],
            spread: Mat3::from_diagonal(Vec3::splat(0.1)),
            gap: 0.0,
        });
        let sole = [[-0.05, -0.05], [-0.05, 0.05], [0.1, -0.05], [0.1, 0.05]].map(|[x, z]| Vec3::new(x, 0.0, z));
        let rest: Vec<Vec3> = [Vec3::Y * 1.2, Vec3::Y * 0.8].into_iter().chain(sole).collect();
        let core = vec![0, 1, 2, 2, 2, 2];
        let influences = core.iter().map(|&bone| Influences { joints: [bone; 4], weights: [1.0, 0.0, 0.0, 0.0] });
        Rig::new(bones.collect(), influences.collect(), core.clone(), rest).unwrap()
    }

    #[test]
    fn a_leg_that_is_pushed_up_folds_and_does_not_slide_to_a_side() {
        let rig = leg();
        let still = Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO };
        let mut reach = Reach::new(&rig, &[still; 3], vec![false, true, true], |_| Role::Idle, vec![false; 3]);
        let (centre, mut bend, mut targets) = (Bend::none(3), Bend::none(3), Vec::new());
        let (_, told) = above((&rig, rig.rest(), &[]), 0.1, (&mut reach, &mut targets, &centre, &mut bend), 40);
        for (point, told) in rig.rest().iter().zip(&told).skip(2) {
            assert!((point + told).y > 0.09, "{told}");
        }
        // The leg is as long as before: to slide takes its sole 0.5 m to a side.
        let middle = told[2..].iter().sum::<Vec3>() / 4.0;
        assert!(middle.with_y(0.0).length() < 0.2, "{middle}");
    }
}
