//! The driven sequence edited towards the recorded frame that it is blended with, over a window (paper V-C and III-C).

use std::ops::Range;

use actor::capture::Capture;
use actor::feet::Feet;
use actor::pose_source::PoseSource;
use editing::PreparedError;
use editing::soles::sole;
use editing::{Edit, EditDocument, EditedPoses, Editor, Handle, Method, Pins, Propagation, Rig, Scope};
use glam::Vec3;
use pipeline::feet::feet;

use super::error::HybridError;
use super::places::laid;
use super::seam::Way;
use super::tried::{EditedBy, Tried};

/// Handles of each bone at most: enough to say where it is.
const HANDLES: usize = 5;
/// A handle belongs to its bone by this share at least, so that nothing around it has to follow.
const WHOLLY: f32 = 0.98;
/// The shortest window in seconds, how much longer it is for each metre by which poses are apart, and the longest.
const SHORTEST: f32 = 0.5;
const LONGER: f32 = 4.0;
const LONGEST: f32 = 1.6;

/// How much of a frame's edit goes to the two frames before it, itself, and the two after it.
const SPREAD: [f32; 5] = [0.0625, 0.25, 0.375, 0.25, 0.0625];

/// An edit of the last sequence, and the frames that it reaches, over the whole capture.
struct Towards {
    document: EditDocument,
    frames: Range<u32>,
}

/// The driven frame in the middle of `way` as the recorded one that it is blended with, by the rig.
pub(super) fn by_surface(both: &Capture, rig: &Rig, way: &Way, inwards: bool) -> Result<Tried, HybridError> {
    let standing = feet(&both.topology, &both.timeline, &both.poses);
    let Towards { document, frames } = towards(both, (rig, &standing), way, inwards);
    let poses = edited(both, (rig, &standing), document, frames.clone())?;
    Ok(Tried { first: frames.start, poses, by: EditedBy::Surface, aim: None })
}

/// The edit that takes the driven frame in the middle of `way` to the recorded one. Legs that stand there stay as they are, but for
/// what the body above asks of them.
fn towards(both: &Capture, (rig, feet): (&Rig, &Feet), way: &Way, inwards: bool) -> Towards {
    let [source, destination] = way.middle();
    let (recorded, key) = if inwards { (source, destination) } else { (destination, source) };
    let own = both.timeline.sequences().last();
    let (name, all) = own.map_or((String::new(), 0..0), |own| (own.name.clone(), own.first_frame..own.end_frame()));
    let pose = both.poses.frame(key);
    let wanted = laid(pose, both.poses.frame(recorded), both.topology.weights());
    let standing = (0..feet.count()).filter(|&foot| feet.stands(key, foot));
    let limbs: Vec<u32> = standing
        .flat_map(|foot| sole(feet, foot))
        .map(|v| rig.bones()[rig.bone_of(v)].limb)
        .filter(|&limb| limb > 0)
        .collect();
    let handles =
        handles(rig, pose, &limbs).into_iter().map(|vertex| Handle { vertex, to: wanted[vertex as usize] }).collect();
    let seconds = (SHORTEST + LONGER * way.apart_mm / 1000.0).min(LONGEST);
    let frames = i64::from((seconds * both.timeline.fps()).ceil() as u32);
    let frame = key - all.start;
    let at = i64::from(frame);
    let window = [at - frames, at + frames];
    let reached = (key + 1).saturating_sub(frames as u32).max(all.start)..(key + frames as u32).min(all.end);
    let edit = Edit {
        sequence: name,
        frame,
        window: Some(window),
        handles,
        pins: Pins::Contacts,
        scope: Scope::Body,
        method: Method::Rig,
        propagate: Propagation::Nonlinear,
        on: true,
    };
    Towards { document: EditDocument { version: editing::document::VERSION, edits: vec![edit] }, frames: reached }
}

/// Some vertices of each bone but those of some limbs, as far from each other as they are.
fn handles(rig: &Rig, pose: &[Vec3], but: &[u32]) -> Vec<u32> {
    let mut all = Vec::new();
    for bone in (0..rig.bones().len()).filter(|&bone| !but.contains(&rig.bones()[bone].limb)) {
        let is_own = |&v: &u32| {
            let own = &rig.influences()[v as usize];
            let mut parts = own.joints.iter().zip(&own.weights);
            usize::from(rig.core()[v as usize]) == bone
                && parts.any(|(&joint, &weight)| usize::from(joint) == bone && weight >= WHOLLY)
        };
        let own: Vec<u32> = (0..pose.len() as u32).filter(is_own).collect();
        let Some(&first) = own.first() else { continue };
        let mut chosen = vec![first];
        let mut far: Vec<f32> = own.iter().map(|&v| pose[v as usize].distance(pose[first as usize])).collect();
        while chosen.len() < HANDLES.min(own.len()) {
            let next = (0..own.len()).fold(0, |best, k| if far[k] > far[best] { k } else { best });
            if far[next] <= 0.0 {
                break;
            }
            chosen.push(own[next]);
            let at = pose[own[next] as usize];
            far.iter_mut().zip(&own).for_each(|(far, &v)| *far = far.min(pose[v as usize].distance(at)));
        }
        all.extend(chosen);
    }
    all
}

/// These frames of `both` with the edits of `document`.
fn edited(
    both: &Capture,
    (rig, feet): (&Rig, &Feet),
    document: EditDocument,
    frames: Range<u32>,
) -> Result<Vec<Vec<Vec3>>, PreparedError> {
    let editor = Editor::new(&both.topology, None, Some(rig.clone()))?;
    let mut source = both.poses.clone();
    let mut edited = EditedPoses::new(&mut source, (&both.timeline, feet), both.topology.weights(), editor, document)?;
    edited.prepare()?;
    let mut poses = Vec::new();
    for frame in frames.clone() {
        let mut pose = vec![Vec3::ZERO; both.topology.vertex_count()];
        edited.read(frame, &mut pose)?;
        poses.push(pose);
    }
    drop(edited);
    Ok(smoothed(both, frames.start, &poses))
}

/// The frames from `first` on with what was edited spread over those around: each is solved for alone, and two solutions that are as good
/// may lie a centimetre apart. What stays in all of them stays; nothing comes to lie lower than anything of the sequence did.
fn smoothed(both: &Capture, first: u32, poses: &[Vec<Vec3>]) -> Vec<Vec<Vec3>> {
    let own = both.timeline.sequences().last().map_or(0..0, |own| own.first_frame..own.end_frame());
    let points = own.clone().flat_map(|frame| both.poses.frame(frame));
    let floor = points.map(|point| point.y).fold(f32::INFINITY, f32::min);
    let moved = |frame: i64, vertex: usize| {
        // Beyond the sequence's ends it goes on as there; frames that the edit does not reach are not moved.
        let frame = frame.clamp(own.start.into(), i64::from(own.end) - 1) as u32;
        let edited = frame.checked_sub(first).and_then(|at| poses.get(at as usize));
        edited.map_or(Vec3::ZERO, |edited| edited[vertex] - both.poses.frame(frame)[vertex])
    };
    let around = |frame: i64, vertex: usize| -> Vec3 {
        (-2..).zip(SPREAD).map(|(off, share)| moved(frame + off, vertex) * share).sum()
    };
    (first..)
        .take(poses.len())
        .map(|frame| {
            let recorded = both.poses.frame(frame).iter().enumerate();
            let above = |point: Vec3| point.with_y(point.y.max(floor));
            recorded.map(|(vertex, &point)| above(point + around(frame.into(), vertex))).collect()
        })
        .collect()
}
