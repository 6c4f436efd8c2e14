//! Recorded poses with edits: what stands between a recording and whoever reads it.

use actor::feet::Feet;
use actor::pose_source::PoseSource;
use actor::timeline::Timeline;
use glam::{Quat, Vec3};
use kernels::align::align_heading;

use crate::carry::{handle_target, spread};
use crate::deform::once;
use crate::document::{Edit, EditDocument, Method, Pins, Propagation};
use crate::error::{EditError, PreparedError};
use crate::floor::{above, ground, lift, telling};
use crate::grab::{Editor, FOLLOW, Grab, Grip, REST, Released};
use crate::propagate::{share, window};
use crate::reach::{Bend, Reach, Role};
use crate::rotation::turn_by;
use crate::settle::Settling;
use crate::soles::{firm, is_grabbed, lowest, sole};
use crate::space::Space;
use crate::stand::{STEPS, stand};

/// What recorded frames are read from, and what is known of them.
pub struct Recording<'a> {
    /// The poses as they were recorded.
    pub source: &'a mut dyn PoseSource,
    /// The sequences.
    pub timeline: &'a Timeline,
    /// What stands.
    pub feet: &'a Feet,
}

/// The edits of a document over one capture: each is made of its own frame once, and then spread over the frames around.
///
/// It holds no recording, so that a page can keep it beside frames that arrive one by one.
pub struct Edits {
    editor: Editor,
    document: EditDocument,
    /// By edit: its frame over the whole capture, how far it reaches, and what it does once that was asked for.
    edits: Vec<(u32, [i64; 2], Option<Keyed>)>,
    /// The edit that is being made, and its frame as it was recorded.
    settling: Option<(usize, Settling, Vec<Vec3>)>,
    weights: Vec<f32>,
}

/// An edit of its own frame.
#[derive(Clone)]
struct Keyed {
    released: Released,
    /// The frame as it was recorded.
    recorded: Vec<Vec3>,
    /// What is not as it was wanted, in sentences.
    notes: Vec<String>,
    /// Whether nothing moves any more: a drag that is under way has not settled.
    is_settled: bool,
}

/// From this share on an edit is nearly whole.
const NEARLY: f32 = 0.9;

/// An edit as it is in a frame.
struct Active {
    edit: usize,
    share: f32,
    /// From the edited frame's axes to this one's.
    turn: Quat,
}

impl Edits {
    /// The edits of `document`; `weights` are the topology's.
    ///
    /// # Errors
    /// What the capture does not have, and in which edit.
    pub fn new(
        timeline: &Timeline,
        weights: &[f32],
        editor: Editor,
        document: EditDocument,
    ) -> Result<Self, EditError> {
        let mut edits = Self { editor, document, edits: Vec::new(), settling: None, weights: weights.to_vec() };
        edits.replace(timeline, edits.document.clone())?;
        Ok(edits)
    }

    /// The document.
    #[must_use]
    pub fn document(&self) -> &EditDocument {
        &self.document
    }

    /// What edits poses.
    #[must_use]
    pub fn editor(&self) -> &Editor {
        &self.editor
    }

    /// As [`Editor::learn`]; edits that go by it are made anew.
    ///
    /// # Errors
    /// As there.
    pub fn learn(&mut self, space: Space) -> Result<(), EditError> {
        self.editor.learn(space)?;
        self.settling = None;
        for (edit, (_, _, keyed)) in self.document.edits.iter().zip(&mut self.edits) {
            keyed.take_if(|_| edit.method.is_learned());
        }
        Ok(())
    }

    /// Takes another document in place of this one. What was made of an edit that is in both is kept.
    ///
    /// # Errors
    /// As [`Self::new`]; nothing is changed then.
    pub fn replace(&mut self, timeline: &Timeline, document: EditDocument) -> Result<(), EditError> {
        let frames = document.check(timeline, self.weights.len())?;
        let mut before: Vec<(&Edit, u32, Option<Keyed>)> = Vec::new();
        for (edit, (frame, _, keyed)) in self.document.edits.iter().zip(std::mem::take(&mut self.edits)) {
            before.push((edit, frame, keyed.filter(|keyed| keyed.is_settled)));
        }
        let mut edits = Vec::with_capacity(frames.len());
        for (frame, edit) in frames.into_iter().zip(&document.edits) {
            let same =
                before.iter_mut().find(|(other, at, keyed)| *at == frame && keyed.is_some() && other.does_as(edit));
            let keyed = same.and_then(|(_, _, keyed)| keyed.take());
            edits.push((frame, window(edit, timeline), keyed));
        }
        (self.edits, self.document, self.settling) = (edits, document, None);
        Ok(())
    }

    /// The frame of edit `edit` over the whole capture; `None` where there is no such edit.
    #[must_use]
    pub fn frame(&self, edit: usize) -> Option<u32> {
        self.edits.get(edit).map(|(frame, _, _)| *frame)
    }

    /// Whether any edit that is on reaches `frame`.
    #[must_use]
    pub fn reaches(&self, timeline: &Timeline, frame: u32) -> bool {
        (0..self.edits.len()).any(|edit| self.reaches_by(timeline, edit, frame))
    }

    /// Whether edit `edit` is on and reaches `frame`.
    #[must_use]
    pub fn reaches_by(&self, timeline: &Timeline, edit: usize, frame: u32) -> bool {
        let is_on = self.document.edits.get(edit).is_some_and(|edit| edit.on);
        let reaches = |(key, window, _): &(u32, [i64; 2], Option<Keyed>)| share(timeline, *key, *window, frame) > 0.0;
        is_on && self.edits.get(edit).is_some_and(reaches)
    }

    /// Makes all edits that are on of their own frames now.
    ///
    /// # Errors
    /// A frame that cannot be read; edits that cannot be made.
    pub fn prepare(&mut self, recording: &mut Recording) -> Result<(), PreparedError> {
        for edit in 0..self.edits.len() {
            if self.document.edits[edit].on {
                self.key(recording, edit)?;
            }
        }
        Ok(())
    }

    /// What is not as it was wanted, in sentences, of the edits that were made so far.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let keyed = self.edits.iter().enumerate().filter_map(|(edit, (_, _, keyed))| Some((edit, keyed.as_ref()?)));
        keyed.flat_map(|(edit, keyed)| keyed.notes.iter().map(move |note| format!("edit {edit}: {note}"))).collect()
    }

    /// Takes hold of what edit `edit` grabs in its frame, to be dragged; the frame as it was recorded, beside.
    ///
    /// # Errors
    /// A frame that cannot be read; an edit that cannot be made, or is none.
    pub fn grab(&mut self, recording: &mut Recording, edit: usize) -> Result<(Grab, Vec<Vec3>), PreparedError> {
        let (grip, recorded, ground) = self.grip(recording, edit)?;
        let mut grab = self.editor.grab(&recorded, &grip).map_err(|error| error.of_edit(edit))?;
        grab.stand_on(ground);
        Ok((grab, recorded))
    }

    /// The frames whose recorded poses edit `edit` is made of: its own, and where the ground is told by others, these. None where there
    /// is no such edit.
    #[must_use]
    pub fn needs(&self, (timeline, feet): (&Timeline, &Feet), edit: usize) -> Vec<u32> {
        let Some(frame) = self.frame(edit) else { return Vec::new() };
        let others = telling(timeline, feet, frame).into_iter().filter(|&other| other != frame);
        std::iter::once(frame).chain(others).collect()
    }

    /// What edit `edit` grabs in its frame, the frame as it was recorded, and how high the ground is under it.
    fn grip(&self, recording: &mut Recording, edit: usize) -> Result<(Grip, Vec<Vec3>, f32), PreparedError> {
        let nothing = EditError::Edit { edit, reason: "there is no such edit" };
        let (Some(&(frame, _, _)), Some(asked)) = (self.edits.get(edit), self.document.edits.get(edit)) else {
            return Err(nothing.into());
        };
        let mut recorded = vec![Vec3::ZERO; self.weights.len()];
        recording.source.read(frame, &mut recorded)?;
        let ground = ground((recording.timeline, recording.feet), recording.source, frame, &recorded)?;
        let feet = recording.feet;
        let handles: Vec<u32> = asked.handles.iter().map(|handle| handle.vertex).collect();
        let (mut pins, mut eased) = (Vec::new(), Vec::new());
        match &asked.pins {
            Pins::Contacts if feet.count() == 0 => pins = lowest(&recorded),
            Pins::Contacts => {
                for (foot, firm) in firm(recording.timeline, feet, frame, &recorded, ground).into_iter().enumerate() {
                    match firm {
                        // Who grabs a foot takes it along: a sole that stayed would be torn off its toes.
                        _ if is_grabbed(feet, foot, &handles) => {}
                        1.0 => pins.extend(sole(feet, foot)),
                        firm if firm > 0.0 => eased.extend(sole(feet, foot).map(|vertex| (vertex, firm))),
                        _ => {}
                    }
                }
            }
            Pins::None => {}
            Pins::Vertices(vertices) => pins.clone_from(vertices),
        }
        let grip = Grip { handles, pins, eased, scope: asked.scope, method: asked.method };
        Ok((grip, recorded, ground))
    }

    /// Drags what [`Self::grab`] has taken hold of to `to`, one place for each handle, in metres as the frame was recorded:
    /// until it is let go ([`Self::replace`]), that is what the edit does.
    ///
    /// # Errors
    /// As [`Editor::drag`].
    pub fn drag(
        &mut self,
        edit: usize,
        (grab, recorded): (&mut Grab, &[Vec3]),
        to: &[Vec3],
    ) -> Result<&[String], EditError> {
        let dragged = self.editor.drag(grab, to).map_err(|error| error.of_edit(edit))?;
        let released = self.editor.released(grab);
        let notes = dragged.notes;
        let Some((_, _, keyed)) = self.edits.get_mut(edit) else { return Ok(&[]) };
        let keyed = keyed.insert(Keyed { released, recorded: recorded.to_vec(), notes, is_settled: false });
        Ok(&keyed.notes)
    }

    /// One step of making edit `edit` of its own frame, for whoever has other work between; whether it is made. So is one that is off, or none.
    ///
    /// # Errors
    /// A frame that cannot be read; an edit that cannot be made.
    pub fn settle(&mut self, recording: &mut Recording, edit: usize) -> Result<bool, PreparedError> {
        let (Some(asked), Some((_, _, None))) = (self.document.edits.get(edit), self.edits.get(edit)) else {
            return Ok(true);
        };
        if !asked.on {
            return Ok(true);
        }
        let to: Vec<Vec3> = asked.handles.iter().map(|handle| handle.to).collect();
        let (_, mut settling, recorded) = match self.settling.take().filter(|(of, _, _)| *of == edit) {
            Some(begun) => begun,
            None => {
                let (grip, recorded, ground) = self.grip(recording, edit)?;
                let mut grab = self.editor.hold(&recorded, &grip).map_err(|error| error.of_edit(edit))?;
                grab.stand_on(ground);
                self.settling = Some((edit, Settling::new(grab, &to), recorded));
                return Ok(false);
            }
        };
        if !settling.step(&mut self.editor).map_err(|error| error.of_edit(edit))? {
            self.settling = Some((edit, settling, recorded));
            return Ok(false);
        }
        let mut notes = self.lacks(edit);
        let (grab, settled) = settling.into_parts();
        notes.extend(settled);
        let released = self.editor.release(grab);
        self.edits[edit].2 = Some(Keyed { released, recorded, notes, is_settled: true });
        Ok(true)
    }

    /// What the actor does not have for edit `edit`, in sentences.
    fn lacks(&self, edit: usize) -> Vec<String> {
        let lacks = match self.document.edits[edit].method {
            Method::Rig if self.editor.rig.is_none() => "rig",
            method if method.is_learned() && !self.editor.has_space() => "learned space",
            _ => return Vec::new(),
        };
        vec![format!("this actor has no {lacks}: the surface alone is moved, as rigid as possible")]
    }

    /// Makes edit `edit` of its own frame, once.
    fn key(&mut self, recording: &mut Recording, edit: usize) -> Result<(), PreparedError> {
        while !self.settle(recording, edit)? {}
        Ok(())
    }

    /// The edits that reach `frame`.
    fn active(&mut self, recording: &mut Recording, frame: u32, pose: &[Vec3]) -> Result<Vec<Active>, PreparedError> {
        let mut active = Vec::new();
        for edit in 0..self.edits.len() {
            let (key, window, _) = self.edits[edit];
            let share = share(recording.timeline, key, window, frame);
            if share <= 0.0 || !self.document.edits[edit].on {
                continue;
            }
            self.key(recording, edit)?;
            let Some(keyed) = &self.edits[edit].2 else { continue };
            let heading = if key == frame { 0.0 } else { align_heading(pose, &keyed.recorded, &self.weights) };
            active.push(Active { edit, share, turn: turn_by(Vec3::Y * heading) });
        }
        Ok(active)
    }

    /// Edits `pose`, which is `frame` as it was recorded.
    ///
    /// # Errors
    /// The frame of an edit that cannot be read; edits that cannot be made.
    pub fn apply(&mut self, recording: &mut Recording, frame: u32, pose: &mut [Vec3]) -> Result<(), PreparedError> {
        let active = self.active(recording, frame, pose)?;
        if let [one] = active.as_slice()
            && self.edits[one.edit].0 == frame
            && let Some(keyed) = &self.edits[one.edit].2
        {
            pose.copy_from_slice(&keyed.released.pose);
            return Ok(());
        }
        let floor = self.floor(&active, pose);
        let pins = self.pins(recording, frame, &active, pose);
        let held = self.held(&pins, &active);
        let (linear, others): (Vec<Active>, Vec<Active>) =
            active.into_iter().partition(|one| self.document.edits[one.edit].propagate == Propagation::Linear);
        let (bones, surfaces): (Vec<Active>, Vec<Active>) = others
            .into_iter()
            .partition(|one| self.edits[one.edit].2.as_ref().is_some_and(|keyed| keyed.released.bones.is_some()));
        if !bones.is_empty() {
            self.bend(&pins, &bones, (pose, floor))?;
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
        lift(&mut self.editor.deformer, pose, &held, FOLLOW, floor).map_err(EditError::from)?;
        Ok(())
    }

    /// Below what nothing of `pose` goes, in metres.
    fn floor(&self, active: &[Active], pose: &[Vec3]) -> f32 {
        let grounds = active.iter().filter_map(|one| Some(self.edits[one.edit].2.as_ref()?.released.ground));
        grounds.fold(crate::floor::lowest(pose), f32::min)
    }

    /// The vertices that are where they are to be, whatever is lifted.
    fn held(&self, pins: &[(u32, f32)], active: &[Active]) -> Vec<u32> {
        let mut held: Vec<u32> = pins.iter().filter(|(_, firm)| *firm == 1.0).map(|(pin, _)| *pin).collect();
        for one in active.iter().filter(|one| one.share > NEARLY) {
            held.extend(self.document.edits[one.edit].handles.iter().map(|handle| handle.vertex));
        }
        held
    }

    /// Edits that bones made: their rotation vectors are added up, feet brought back to where they stand, and the surface
    /// solved for once.
    fn bend(
        &mut self,
        pins: &[(u32, f32)],
        active: &[Active],
        (pose, floor): (&mut [Vec3], f32),
    ) -> Result<(), PreparedError> {
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
                let exactly = if anew { 1.0 } else { exactly(one, active) };
                handles.push((own.vertex, exactly, wanted, beyond));
                limbs.push(rig.bones()[own.bone].limb);
            }
            carried.extend(bones.carried.iter().cloned().map(|mut own| {
                own.around.iter_mut().for_each(|(_, share)| *share *= one.share.min(1.0).sqrt());
                own
            }));
        }
        centre.turns = sums.into_iter().map(turn_by).collect();
        let rig = match &self.editor.rig {
            Some(rig) => rig,
            None => return Ok(()),
        };
        let motions = rig.fit(pose);
        let staying: Vec<u32> = pins.iter().map(|(pin, _)| rig.bones()[rig.bone_of(*pin)].limb).collect();
        let reach = Reach::new(rig, &motions, free, |limb| Role::of(limb, &limbs, &staying), vec![false; count]);
        let mut reach = reach.allowing(&centre);
        let mut bend = centre.clone();
        stand(&reach, (&mut goals, false), (&centre, &mut bend), (rig, pose, pins));
        let bent = (&mut reach, &mut goals, &centre, &mut bend);
        let (turns, told) = above((rig, pose, &carried), floor, bent, STEPS);
        let mut held: Vec<(u32, Vec3)> = Vec::new();
        for &(vertex, exactly, wanted, beyond) in &handles {
            let by_skin = told[vertex as usize] + beyond;
            held.push((vertex, by_skin.lerp(wanted, exactly)));
        }
        let beyond: Vec<Vec3> = held.iter().map(|&(vertex, to)| to - told[vertex as usize]).collect();
        let drawn = spread(carried.iter().map(|one| one.near.as_slice()), &beyond, pose.len());
        for &(pin, firm) in pins {
            held.push((pin, told[pin as usize] * (1.0 - firm)));
        }
        // Of a vertex that is held twice the first one counts: handles before pins.
        once(&mut held, self.weights.len());
        let (vertices, wanted): (Vec<u32>, Vec<Vec3>) = held.into_iter().unzip();
        let system = self.editor.deformer.hold(pose, &vertices, FOLLOW).map_err(EditError::from)?;
        let moved = self.editor.deformer.solve_over(&system, pose, (&turns, &told), &drawn, &wanted);
        let moved = moved.map_err(EditError::from)?;
        pose.iter_mut().zip(moved).for_each(|(point, moved)| *point += moved);
        Ok(())
    }

    /// Vertices that stay in `frame`, and how firmly: feet that stand, and where none does those that are on the ground, the ones going
    /// over into the others.
    fn pins(&self, recording: &Recording, frame: u32, active: &[Active], pose: &[Vec3]) -> Vec<(u32, f32)> {
        let (mut pins, feet) = (Vec::new(), recording.feet);
        let ground = active.iter().filter_map(|one| Some(self.edits[one.edit].2.as_ref()?.released.ground));
        let ground = ground.fold(f32::INFINITY, f32::min);
        let asked: Vec<&Pins> = active.iter().map(|one| &self.document.edits[one.edit].pins).collect();
        if asked.iter().any(|pins| matches!(pins, Pins::Contacts)) {
            for (foot, firm) in firm(recording.timeline, feet, frame, pose, ground).into_iter().enumerate() {
                let firm = firm * (1.0 - self.taken(feet, foot, active));
                if firm > 0.0 {
                    pins.extend(sole(recording.feet, foot).map(|vertex| (vertex, firm)));
                }
            }
        }
        for one in active {
            let vertices: &[u32] = match (&self.document.edits[one.edit].pins, &self.edits[one.edit].2) {
                (Pins::Vertices(vertices), _) => vertices,
                // What was lowest in the edited frame goes as it was recorded.
                (Pins::Contacts, Some(keyed)) if recording.feet.count() == 0 => &keyed.released.grip.pins,
                _ => &[],
            };
            pins.extend(vertices.iter().map(|&vertex| (vertex, 1.0)));
        }
        let mut firmest = vec![0.0_f32; self.weights.len()];
        for (vertex, firm) in pins {
            let most = &mut firmest[vertex as usize];
            *most = most.max(firm);
        }
        (0..).zip(firmest).filter(|(_, firm)| *firm > 0.0).collect()
    }

    /// How much of a foot that stands edits take along: the share of those that grab it where it stands. One that is grabbed in the
    /// air stands all the same where it comes down.
    fn taken(&self, feet: &Feet, foot: usize, active: &[Active]) -> f32 {
        let grabs = |one: &&Active| {
            let Edit { handles, pins, .. } = &self.document.edits[one.edit];
            let handles: Vec<u32> = handles.iter().map(|handle| handle.vertex).collect();
            *pins == Pins::Contacts && feet.stands(self.edits[one.edit].0, foot) && is_grabbed(feet, foot, &handles)
        };
        active.iter().filter(grabs).map(|one| one.share).fold(0.0, f32::max)
    }

    /// Edits of the surface alone: the vertices' rotation vectors are added up, one solve.
    fn reshape(&mut self, active: &[Active], pose: &mut [Vec3]) -> Result<(), PreparedError> {
        let n = pose.len();
        let (mut sums, mut outside) = (vec![Vec3::ZERO; n], vec![0_usize; n]);
        let (mut rest, mut drawn) = (vec![Vec3::ZERO; n], vec![Vec3::ZERO; n]);
        let mut held: Vec<(u32, Vec3)> = Vec::new();
        let mut pinned = Vec::new();
        for one in active {
            let Some(released) = self.edits[one.edit].2.as_ref().map(|keyed| &keyed.released) else { continue };
            sums.iter_mut().zip(&released.turns).for_each(|(sum, &r)| *sum += one.turn * (r * one.share));
            rest.iter_mut().zip(&released.rest).for_each(|(sum, &moved)| *sum += one.turn * (moved * one.share));
            drawn.iter_mut().zip(&released.drawn).for_each(|(sum, &moved)| *sum += one.turn * (moved * one.share));
            released.outside.iter().for_each(|&vertex| outside[vertex as usize] += 1);
            let wanted = released.wanted.iter().map(|&wanted| one.turn * (wanted * one.share));
            held.extend(released.grip.handles.iter().copied().zip(wanted));
            pinned.extend(&released.grip.pins);
        }
        held.extend(pinned.into_iter().map(|pin| (pin, Vec3::ZERO)));
        let beyond = (0..n as u32).filter(|&vertex| outside[vertex as usize] == active.len());
        held.extend(beyond.map(|vertex| (vertex, Vec3::ZERO)));
        once(&mut held, self.weights.len());
        let (vertices, wanted): (Vec<u32>, Vec<Vec3>) = held.into_iter().unzip();
        let turns: Vec<Quat> = sums.into_iter().map(turn_by).collect();
        let system = self.editor.deformer.hold(pose, &vertices, REST).map_err(EditError::from)?;
        let told = vec![Vec3::ZERO; n];
        // What modes moved comes before what turned: turned are the edges of a pose that they have moved.
        let by_modes: Vec<Vec3> = pose.iter().zip(&rest).map(|(&point, &moved)| point + moved).collect();
        let left: Vec<Vec3> =
            vertices.iter().zip(wanted).map(|(&vertex, wanted)| wanted - rest[vertex as usize]).collect();
        let moved = self.editor.deformer.solve_over(&system, &by_modes, (&turns, &told), &drawn, &left);
        let moved = moved.map_err(EditError::from)?;
        pose.iter_mut().zip(&by_modes).zip(moved).for_each(|((point, &before), moved)| *point = before + moved);
        Ok(())
    }
}

/// How exactly a handle of `one` is where it is wanted in a frame, from 0 to 1, among the edits that are active there. At its own frame it is, whatever
/// other edits do, and beside it all the more, the more they do. Without others the bones take it along: the same way from another
/// recorded place would draw a swinging arm out.
fn exactly(one: &Active, active: &[Active]) -> f32 {
    let others = active.iter().filter(|other| other.edit != one.edit).map(|other| other.share).fold(0.0, f32::max);
    let near = ((one.share - NEARLY) / (1.0 - NEARLY)).clamp(0.0, 1.0);
    if near == 1.0 { 1.0 } else { near * (others / (1.0 - NEARLY)).min(1.0) }
}
