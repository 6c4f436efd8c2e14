//! Recorded poses with edits: what stands between a recording and whoever reads it.

use std::collections::VecDeque;

use actor::feet::Feet;
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::Timeline;
use glam::{Quat, Vec3};
use kernels::align::align_heading;

use crate::document::{EditDocument, Method, Pins, Propagation};
use crate::error::EditError;
use crate::grab::{Editor, FOLLOW, Grip, Released, handle_target, pin_targets, skin};
use crate::propagate::{firmness, share, window};
use crate::reach::{Bend, Reach, Role};

/// Steps by which feet are brought back to where they stand, and handles to where they are wanted.
const STEPS: usize = 12;
/// Frames that are kept: whoever reads one reads it again soon.
const KEPT: usize = 32;
/// A vertex is part of a sole from this share on, in [`actor::feet::SHARE_STEP`].
const SOLE: u8 = 128;
/// What is this close to the lowest point stands, relative to the body's height, where no feet are known.
const LOW: f32 = 0.011;

/// Recorded poses with the edits of a document; as bit for bit as they were where no edit reaches.
pub struct EditedPoses<'a, S: PoseSource + ?Sized> {
    source: &'a mut S,
    timeline: &'a Timeline,
    feet: &'a Feet,
    editor: Editor,
    document: EditDocument,
    /// By edit: its frame over the whole capture, how far it reaches, and what it does once that was asked for.
    edits: Vec<(u32, [i64; 2], Option<Keyed>)>,
    weights: Vec<f32>,
    kept: VecDeque<(u32, Vec<Vec3>)>,
    notes: Vec<String>,
}

/// An edit of its own frame.
#[derive(Clone)]
struct Keyed {
    released: Released,
    /// The frame as it was recorded.
    recorded: Vec<Vec3>,
}

/// An edit as it is in a frame.
struct Active {
    edit: usize,
    share: f32,
    /// From the edited frame's axes to this one's.
    turn: Quat,
}

impl<'a, S: PoseSource + ?Sized> EditedPoses<'a, S> {
    /// The poses of `source` with the edits of `document`; `weights` are the topology's, `feet` say what stands.
    ///
    /// # Errors
    /// What the capture does not have, and in which edit.
    pub fn new(
        source: &'a mut S,
        (timeline, feet): (&'a Timeline, &'a Feet),
        weights: &[f32],
        editor: Editor,
        document: EditDocument,
    ) -> Result<Self, EditError> {
        let frames = document.check(timeline, weights.len())?;
        let edits = frames.into_iter().zip(&document.edits);
        let edits = edits.map(|(frame, edit)| (frame, window(edit, timeline), None)).collect();
        let (kept, notes) = (VecDeque::new(), Vec::new());
        let weights = weights.to_vec();
        Ok(Self { source, timeline, feet, editor, document, edits, weights, kept, notes })
    }

    /// Makes all edits of their own frames now; what is not as it was wanted, in sentences.
    ///
    /// # Errors
    /// A frame that cannot be read; edits that cannot be made.
    pub fn prepare(&mut self) -> Result<&[String], PreparedError> {
        for edit in 0..self.edits.len() {
            if self.document.edits[edit].on {
                self.key(edit)?;
            }
        }
        Ok(&self.notes)
    }

    /// Makes edit `edit` of its own frame, once.
    fn key(&mut self, edit: usize) -> Result<(), PreparedError> {
        let (frame, _, None) = &self.edits[edit] else { return Ok(()) };
        let frame = *frame;
        let mut recorded = vec![Vec3::ZERO; self.weights.len()];
        self.source.read(frame, &mut recorded)?;
        let asked = &self.document.edits[edit];
        let pins = match &asked.pins {
            Pins::Contacts if self.feet.count() == 0 => lowest(&recorded),
            Pins::Contacts => (0..self.feet.count())
                .filter(|&foot| self.feet.stands(frame, foot))
                .flat_map(|foot| self.sole(foot))
                .collect(),
            Pins::None => Vec::new(),
            Pins::Vertices(pins) => pins.clone(),
        };
        let handles = asked.handles.iter().map(|handle| handle.vertex).collect();
        let to: Vec<Vec3> = asked.handles.iter().map(|handle| handle.to).collect();
        let grip = Grip { handles, pins, scope: asked.scope, method: asked.method };
        let numbered = |error: EditError| error.of_edit(edit);
        if asked.method == Method::Rig && self.editor.rig.is_none() {
            self.notes
                .push(format!("edit {edit}: this actor has no rig: the surface alone is moved, as rigid as possible"));
        }
        let mut grab = self.editor.grab(&recorded, &grip).map_err(numbered)?;
        let dragged = self.editor.settle(&mut grab, &to).map_err(numbered)?;
        self.notes.extend(dragged.notes.iter().map(|note| format!("edit {edit}: {note}")));
        let released = self.editor.release(grab);
        self.edits[edit].2 = Some(Keyed { released, recorded });
        Ok(())
    }

    /// The vertices of a foot's sole.
    fn sole(&self, foot: usize) -> impl Iterator<Item = u32> + use<'a, S> {
        self.feet.vertices(foot).iter().filter(|vertex| vertex.sole >= SOLE).map(|vertex| vertex.vertex)
    }

    /// The edits that reach `frame`.
    fn active(&mut self, frame: u32, pose: &[Vec3]) -> Result<Vec<Active>, PreparedError> {
        let mut active = Vec::new();
        for edit in 0..self.edits.len() {
            let (key, window, _) = self.edits[edit];
            let share = share(self.timeline, key, window, frame);
            if share <= 0.0 || !self.document.edits[edit].on {
                continue;
            }
            self.key(edit)?;
            let Some(keyed) = &self.edits[edit].2 else { continue };
            let heading = if key == frame { 0.0 } else { align_heading(pose, &keyed.recorded, &self.weights) };
            active.push(Active { edit, share, turn: Quat::from_rotation_y(heading) });
        }
        Ok(active)
    }

    fn edited(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PreparedError> {
        let active = self.active(frame, pose)?;
        if let [one] = active.as_slice()
            && self.edits[one.edit].0 == frame
            && let Some(keyed) = &self.edits[one.edit].2
        {
            pose.copy_from_slice(&keyed.released.pose);
            return Ok(());
        }
        let (linear, others): (Vec<Active>, Vec<Active>) =
            active.into_iter().partition(|one| self.document.edits[one.edit].propagate == Propagation::Linear);
        let (bones, surfaces): (Vec<Active>, Vec<Active>) = others
            .into_iter()
            .partition(|one| self.edits[one.edit].2.as_ref().is_some_and(|keyed| keyed.released.bones.is_some()));
        if !bones.is_empty() {
            self.bend(frame, &bones, pose)?;
        }
        if !surfaces.is_empty() {
            self.reshape(&surfaces, pose)?;
        }
        for one in &linear {
            let Some(keyed) = &self.edits[one.edit].2 else { continue };
            for (point, &displacement) in pose.iter_mut().zip(&keyed.released.displacements) {
                *point += one.turn * (displacement * one.share);
            }
        }
        Ok(())
    }

    /// Edits that bones made: their rotation vectors are added up, feet brought back to where they stand, and the surface
    /// solved for once.
    fn bend(&mut self, frame: u32, active: &[Active], pose: &mut [Vec3]) -> Result<(), PreparedError> {
        let Some(rig) = &self.editor.rig else { return Ok(()) };
        let count = rig.bones().len();
        let mut free = vec![false; count];
        let mut sums = vec![Vec3::ZERO; count];
        let mut centre = Bend::none(count);
        let mut goals = Vec::new();
        let mut handles: Vec<(u32, f32, Vec3, Vec3)> = Vec::new();
        let mut carried = Vec::new();
        let mut limbs = Vec::new();
        for one in active {
            let Some(released) = self.edits[one.edit].2.as_ref().map(|keyed| &keyed.released) else { continue };
            let Some(bones) = &released.bones else { continue };
            free.iter_mut().zip(&bones.free).for_each(|(free, &other)| *free |= other);
            let anew = self.document.edits[one.edit].propagate == Propagation::Constraint;
            if !anew {
                let logarithms = bones.bend.logarithms();
                sums.iter_mut().zip(logarithms).for_each(|(sum, r)| *sum += one.turn * (r * one.share));
                centre.shift += one.turn * (bones.bend.shift * one.share);
            }
            for ((own, &wanted), &beyond) in bones.carried.iter().zip(&released.wanted).zip(&bones.beyond) {
                let [wanted, beyond] = [wanted, beyond].map(|v| one.turn * (v * one.share));
                if anew {
                    let mut target = handle_target(own, pose);
                    target.to += wanted;
                    goals.push(target);
                }
                // At its own frame a handle is where it is wanted, whatever other edits do.
                let exactly = if anew { 1.0 } else { ((one.share - 0.9) * 10.0).clamp(0.0, 1.0) };
                handles.push((own.vertex, exactly, wanted, beyond));
                limbs.push(rig.bones()[own.bone].limb);
            }
            carried.extend(bones.carried.iter().cloned().map(|mut own| {
                own.around.iter_mut().for_each(|(_, share)| *share *= one.share.min(1.0).sqrt());
                own
            }));
        }
        centre.turns = sums.into_iter().map(Quat::from_scaled_axis).collect();
        let pins = self.pins(frame, active);
        let rig = match &self.editor.rig {
            Some(rig) => rig,
            None => return Ok(()),
        };
        let motions = rig.fit(pose);
        let staying: Vec<u32> = pins.iter().map(|(pin, _)| rig.bones()[rig.bone_of(*pin)].limb).collect();
        let reach = Reach::new(rig, &motions, free, |limb| Role::of(limb, &limbs, &staying), vec![false; count]);
        let firm: Vec<u32> = pins.iter().filter(|(_, firm)| *firm >= 1.0).map(|(pin, _)| *pin).collect();
        let mut targets = goals;
        let loose =
            pins.iter().filter(|(_, firm)| *firm > 0.0 && *firm < 1.0).map(|(_, firm)| *firm).fold(0.0, f32::max);
        let fading: Vec<u32> =
            pins.iter().filter(|(_, firm)| *firm == loose && loose > 0.0).map(|(pin, _)| *pin).collect();
        let (firm, fading) = (pin_targets(rig, pose, &firm, 1.0), pin_targets(rig, pose, &fading, loose));
        let begun = reach.motions(&centre);
        let drifts = |target: &crate::reach::Target| Reach::place(target, &begun).distance(target.to) > 1e-5;
        let mut bend = centre.clone();
        if !targets.is_empty() || firm.iter().chain(&fading).any(drifts) {
            targets.extend(firm);
            targets.extend(fading);
            reach.solve(&targets, &centre, &mut bend, STEPS);
        }
        let (turns, told) = skin(rig, pose, &reach.motions(&bend), &carried);
        let mut held: Vec<(u32, Vec3)> = Vec::new();
        for &(vertex, exactly, wanted, beyond) in &handles {
            let by_skin = told[vertex as usize] + beyond;
            held.push((vertex, by_skin.lerp(wanted, exactly)));
        }
        for &(pin, firm) in &pins {
            held.push((pin, told[pin as usize] * (1.0 - firm)));
        }
        // Of a vertex that is held twice the first one counts: handles before pins.
        let mut seen = std::collections::BTreeSet::new();
        held.retain(|(vertex, _)| seen.insert(*vertex));
        let (vertices, wanted): (Vec<u32>, Vec<Vec3>) = held.into_iter().unzip();
        let system = self.editor.deformer.hold(pose, &vertices, FOLLOW).map_err(EditError::from)?;
        let moved = self.editor.deformer.solve(&system, pose, &turns, &told, &wanted).map_err(EditError::from)?;
        pose.iter_mut().zip(moved).for_each(|(point, moved)| *point += moved);
        Ok(())
    }

    /// Vertices that stay in `frame`, and how firmly.
    fn pins(&self, frame: u32, active: &[Active]) -> Vec<(u32, f32)> {
        let mut pins = Vec::new();
        let asked: Vec<&Pins> = active.iter().map(|one| &self.document.edits[one.edit].pins).collect();
        if asked.iter().any(|pins| matches!(pins, Pins::Contacts)) {
            for foot in 0..self.feet.count() {
                let firm = firmness(self.timeline, frame, |frame| self.feet.stands(frame, foot));
                if firm > 0.0 {
                    pins.extend(self.sole(foot).map(|vertex| (vertex, firm)));
                }
            }
        }
        for one in active {
            let vertices: &[u32] = match (&self.document.edits[one.edit].pins, &self.edits[one.edit].2) {
                (Pins::Vertices(vertices), _) => vertices,
                // What was lowest in the edited frame goes as it was recorded.
                (Pins::Contacts, Some(keyed)) if self.feet.count() == 0 => &keyed.released.grip.pins,
                _ => &[],
            };
            pins.extend(vertices.iter().map(|&vertex| (vertex, 1.0)));
        }
        pins.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        pins.dedup_by_key(|pin| pin.0);
        pins
    }

    /// Edits of the surface alone: the vertices' rotation vectors are added up, one solve.
    fn reshape(&mut self, active: &[Active], pose: &mut [Vec3]) -> Result<(), PreparedError> {
        let n = pose.len();
        let (mut sums, mut outside) = (vec![Vec3::ZERO; n], vec![0_usize; n]);
        let mut held: Vec<(u32, Vec3)> = Vec::new();
        let mut pinned = Vec::new();
        for one in active {
            let Some(released) = self.edits[one.edit].2.as_ref().map(|keyed| &keyed.released) else { continue };
            sums.iter_mut().zip(&released.turns).for_each(|(sum, &r)| *sum += one.turn * (r * one.share));
            released.outside.iter().for_each(|&vertex| outside[vertex as usize] += 1);
            let wanted = released.wanted.iter().map(|&wanted| one.turn * (wanted * one.share));
            held.extend(released.grip.handles.iter().copied().zip(wanted));
            pinned.extend(&released.grip.pins);
        }
        held.extend(pinned.into_iter().map(|pin| (pin, Vec3::ZERO)));
        let beyond = (0..n as u32).filter(|&vertex| outside[vertex as usize] == active.len());
        held.extend(beyond.map(|vertex| (vertex, Vec3::ZERO)));
        let mut seen = std::collections::BTreeSet::new();
        held.retain(|(vertex, _)| seen.insert(*vertex));
        let (vertices, wanted): (Vec<u32>, Vec<Vec3>) = held.into_iter().unzip();
        let turns: Vec<Quat> = sums.into_iter().map(Quat::from_scaled_axis).collect();
        let system = self.editor.deformer.hold(pose, &vertices, 1e-4).map_err(EditError::from)?;
        let told = vec![Vec3::ZERO; n];
        let moved = self.editor.deformer.solve(&system, pose, &turns, &told, &wanted).map_err(EditError::from)?;
        pose.iter_mut().zip(moved).for_each(|(point, moved)| *point += moved);
        Ok(())
    }
}

/// The vertices on which a pose stands where no feet are known: those that are about as low as the lowest.
fn lowest(pose: &[Vec3]) -> Vec<u32> {
    let low = pose.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    let high = pose.iter().map(|point| point.y).fold(f32::NEG_INFINITY, f32::max);
    let most = low + LOW * (high - low);
    (0..pose.len() as u32).filter(|&vertex| pose[vertex as usize].y <= most).collect()
}

/// Why an edited frame cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PreparedError {
    /// The recorded frame cannot be read.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The edit cannot be made.
    #[error(transparent)]
    Edit(#[from] EditError),
}

impl<S: PoseSource + ?Sized> PoseSource for EditedPoses<'_, S> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        let reaches =
            |(key, window, _): &(u32, [i64; 2], Option<Keyed>)| share(self.timeline, *key, *window, frame) > 0.0;
        if !self.edits.iter().any(reaches) {
            return self.source.read(frame, pose);
        }
        if let Some((_, kept)) = self.kept.iter().find(|(other, _)| *other == frame) {
            pose.copy_from_slice(kept);
            return Ok(());
        }
        self.source.read(frame, pose)?;
        let mut edited = pose.to_vec();
        self.edited(frame, &mut edited).map_err(|error| match error {
            PreparedError::Pose(error) => error,
            // Edits were checked: what is left is a pose that is not finite.
            PreparedError::Edit(_) => PoseError::Damaged(frame),
        })?;
        pose.copy_from_slice(&edited);
        if self.kept.len() == KEPT {
            self.kept.pop_front();
        }
        self.kept.push_back((frame, edited));
        Ok(())
    }
}
