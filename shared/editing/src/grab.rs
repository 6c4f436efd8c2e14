//! Grabbing a pose and dragging it: what a page does with every move of a pointer, and what a document of edits asks for.
//!
//! A grab prepares all that does not change while one drags: where the bones are, which bone a handle takes hold of, and the
//! factor of the surface under its handles and pins. A drag is inverse kinematics from where the last one ended, skinning of
//! the *frame's own* vertices by how the bones turned (folds and hair survive), and one solve.

use glam::{Quat, Vec3};
use kernels::align::centre_of_mass;
use kernels::topology::Topology;

use crate::carry::{Carried, carry, free, handle_target, pin_targets, size};
use crate::deform::{Deformer, Held};
use crate::document::{Method, Scope};
use crate::drawn::Drawn;
use crate::error::EditError;
use crate::learned::{Learned, PRIOR};
use crate::reach::{Bend, Reach, Role, Target};
use crate::rig::Rig;
use crate::space::{Space, by_part};

/// How firmly vertices follow the skin beside the weights of edges.
pub(crate) const FOLLOW: f32 = 0.02;
/// The same where there is no skin: only against parts that nothing holds.
pub(crate) const REST: f32 = 1e-4;
/// Weight of the centre of mass over the ground in the inverse kinematics.
const BALANCE: f32 = 0.1;
/// Steps of a drag, and of a grab's first one.
const STEPS: usize = 6;
pub(crate) const FIRST_STEPS: usize = 40;
/// How far a handle takes hold of its bone over the surface, as a share of the body's size.
pub(crate) const HOLD: f32 = 0.14;
/// Further than this share no handle goes without a rig; of a region, than so many radii.
const FARTHEST: f32 = 0.5;
const FARTHEST_RADII: f32 = 1.5;
/// Local and global steps of as-rigid-as-possible surfaces in a drag.
const ITERATIONS: usize = 4;
const STILL: f32 = 1e-4;
/// What ends closer to where it is wanted than this, in metres, is there.
pub(crate) const SHORT: f32 = 1e-6;

/// What is grabbed, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// Vertices that will be dragged.
    pub handles: Vec<u32>,
    /// Vertices that stay; handles are none.
    pub pins: Vec<u32>,
    /// Vertices that bones take along in part, and how firmly they stay, from 0 to 1: feet about to stand.
    pub eased: Vec<(u32, f32)>,
    /// What may move.
    pub scope: Scope,
    /// How it moves; [`Method::Rig`] where there is no rig and [`Method::Learned`] where there is no space are
    /// [`Method::Arap`]; [`Method::Parts`] without a rig is [`Method::Learned`].
    pub method: Method,
}

impl Grip {
    /// All vertices of which something is said.
    fn mentioned(&self) -> impl Iterator<Item = u32> {
        self.handles.iter().chain(&self.pins).copied().chain(self.eased.iter().map(|(vertex, _)| *vertex))
    }
}

/// A pose that is being dragged.
pub struct Grab {
    pub(crate) pose: Vec<Vec3>,
    pub(crate) grip: Grip,
    pub(crate) size: f32,
    pub(crate) held: Held,
    pub(crate) by: By,
    /// Displacement of each handle: what was wanted, or the nearest sensible one; of a surface without bones, before it was looked whether that
    /// is drawn out, and what is known of that.
    pub(crate) wanted: Vec<Vec3>,
    pub(crate) asked: Vec<Vec3>,
    pub(crate) drawn: Drawn,
    /// What was spread over what is near the handles, by vertex; nothing where nothing was.
    pub(crate) drawn_out: Vec<Vec3>,
    pub(crate) displacements: Vec<Vec3>,
    pub(crate) is_first: bool,
    /// Height of the ground, and below what nothing goes, in metres.
    pub(crate) ground: f32,
    pub(crate) floor: f32,
    /// How far vertices go that are held at the ground, the last of those that are held, and how often some were found.
    pub(crate) stopped: Vec<Vec3>,
    pub(crate) rounds: usize,
}

/// What moves the surface.
pub(crate) enum By {
    Bones(Box<Bones>),
    Surface { turns: Vec<Quat>, outside: Vec<u32> },
    Modes { learned: Box<Learned>, outside: Vec<u32> },
}

/// Bones that are bent.
pub(crate) struct Bones {
    pub reach: Reach,
    /// As far as what is held firmly goes, and with what is held in part.
    pub bend: Bend,
    pub eased: Bend,
    pub carried: Vec<Carried>,
    pub targets: Vec<Target>,
    pub skinned: Vec<Vec3>,
}

/// What came of a drag.
#[derive(Clone, Debug, PartialEq)]
pub struct Dragged {
    /// The pose.
    pub pose: Vec<Vec3>,
    /// What is not as it was wanted, in sentences.
    pub notes: Vec<String>,
}

/// An edit that is done: what its propagation needs.
#[derive(Clone, Debug)]
pub struct Released {
    /// What was grabbed.
    pub grip: Grip,
    /// The edited pose.
    pub pose: Vec<Vec3>,
    /// Displacements of all vertices in the edited frame.
    pub displacements: Vec<Vec3>,
    /// Displacements of the handles.
    pub wanted: Vec<Vec3>,
    pub(crate) bones: Option<ReleasedBones>,
    /// Rotation vectors of vertices where there is no rig; vertices that do not move.
    pub(crate) turns: Vec<Vec3>,
    /// What modes moved the vertices by before they turned; nothing where there were none.
    pub(crate) rest: Vec<Vec3>,
    /// What was spread over what is near the handles; nothing where nothing was.
    pub(crate) drawn: Vec<Vec3>,
    pub(crate) outside: Vec<u32>,
    /// Height of the ground, in metres.
    pub(crate) ground: f32,
}

/// What the bones did.
#[derive(Clone, Debug)]
pub(crate) struct ReleasedBones {
    pub bend: Bend,
    pub free: Vec<bool>,
    pub carried: Vec<Carried>,
    /// What each handle was displaced beyond its skin.
    pub beyond: Vec<Vec3>,
}

/// Edits poses of one mesh.
pub struct Editor {
    pub(crate) deformer: Deformer,
    pub(crate) rig: Option<Rig>,
    pub(crate) space: Option<Space>,
    weights: Vec<f32>,
    /// The prior's weight beside the modes of the space.
    pub(crate) prior: f64,
}

impl Editor {
    /// For poses of `topology`, with a rig or without; `order` as in [`Deformer::new`].
    ///
    /// # Errors
    /// A rig of another mesh, or a mesh too large to factorise.
    pub fn new(topology: &Topology, order: Option<&[u32]>, rig: Option<Rig>) -> Result<Self, EditError> {
        let n = topology.vertex_count();
        if let Some(rig) = rig.as_ref().filter(|rig| rig.rest().len() != n) {
            let found = rig.rest().len();
            return Err(EditError::Rig(format!("it moves {found} vertices, but the mesh has {n}")));
        }
        let weights = topology.weights().to_vec();
        Ok(Self { deformer: Deformer::new(topology, order)?, rig, space: None, weights, prior: PRIOR })
    }

    /// From now on edits may go by the modes of `space`.
    ///
    /// # Errors
    /// A space of another mesh; nothing is changed then.
    pub fn learn(&mut self, space: Space) -> Result<(), EditError> {
        if space.modes().iter().any(|mode| mode.len() != self.weights.len()) {
            return Err(EditError::Space("its modes are those of another mesh".into()));
        }
        self.space = Some(space);
        Ok(())
    }

    /// Weighs the prior of modes otherwise, in square metres: for whoever measures what it does.
    pub fn set_prior(&mut self, prior: f64) {
        self.prior = if prior.is_finite() && prior > 0.0 { prior } else { PRIOR };
    }

    /// Whether edits may go by modes.
    #[must_use]
    pub fn has_space(&self) -> bool {
        self.space.is_some()
    }

    /// The rig.
    #[must_use]
    pub fn rig(&self) -> Option<&Rig> {
        self.rig.as_ref()
    }

    /// Grabs `pose`.
    ///
    /// # Errors
    /// No handle, one twice, or a vertex that does not exist; edits are numbered from 0, and this is the first.
    pub fn grab(&mut self, pose: &[Vec3], grip: &Grip) -> Result<Grab, EditError> {
        let mut grab = self.hold(pose, grip)?;
        if let By::Modes { learned, .. } = &mut grab.by {
            learned.prepare(&mut self.deformer, &grab.held, pose)?;
        }
        Ok(grab)
    }

    /// As [`Self::grab`], for what comes to rest without a drag: what only drags need is left out.
    pub(crate) fn hold(&mut self, pose: &[Vec3], grip: &Grip) -> Result<Grab, EditError> {
        let mut grip = grip.clone();
        let count = self.weights.len();
        if let Some(vertex) = grip.mentioned().find(|&vertex| vertex as usize >= count) {
            return Err(EditError::Vertex { edit: 0, vertex, count });
        }
        if grip.handles.is_empty() {
            return Err(EditError::Edit { edit: 0, reason: "it has no handle: say which vertex goes where" });
        }
        let mut is_pin = vec![false; count];
        grip.pins.iter().for_each(|&pin| is_pin[pin as usize] = true);
        grip.handles.iter().for_each(|&handle| is_pin[handle as usize] = false);
        grip.pins = (0..count as u32).filter(|&vertex| is_pin[vertex as usize]).collect();
        grip.eased.retain(|(vertex, _)| !is_pin[*vertex as usize] && !grip.handles.contains(vertex));
        let with_bones = grip.method == Method::Rig && !matches!(grip.scope, Scope::Region { .. });
        if with_bones && self.rig.is_some() { self.grab_bones(pose, grip) } else { self.grab_surface(pose, grip) }
    }

    fn grab_bones(&mut self, pose: &[Vec3], grip: Grip) -> Result<Grab, EditError> {
        let Some(rig) = &self.rig else { return self.grab_surface(pose, grip) };
        let size = size(pose);
        let motions = rig.fit(pose);
        let carried: Vec<Carried> = grip
            .handles
            .iter()
            .map(|&vertex| carry(rig, &self.deformer, (pose, &motions), vertex, HOLD * size))
            .collect();
        let limbs: Vec<u32> = carried.iter().map(|one| rig.bones()[one.bone].limb).collect();
        let free = free(rig, grip.scope, &limbs);
        let mut steady = vec![false; rig.bones().len()];
        for one in carried.iter().filter(|one| one.bone > 0 && rig.bones()[one.bone].limb == 0) {
            steady[one.bone] = true;
        }
        let eased = grip.eased.iter().map(|(vertex, _)| vertex);
        let staying = grip.pins.iter().chain(eased.clone()).map(|&pin| rig.bones()[rig.bone_of(pin)].limb);
        let staying: Vec<u32> = staying.collect();
        let reach = Reach::new(rig, &motions, free.clone(), |limb| Role::of(limb, &limbs, &staying), steady);
        let mut targets: Vec<Target> = carried.iter().map(|one| handle_target(one, pose)).collect();
        targets.extend(pin_targets(rig, pose, &grip.pins));
        if free[0] && !grip.pins.is_empty() {
            targets.extend(self.balance_target(rig, pose));
        }
        let fixed: Vec<u32> = grip.handles.iter().chain(&grip.pins).chain(eased).copied().collect();
        let bend = Bend::none(rig.bones().len());
        let held = self.deformer.hold(pose, &fixed, FOLLOW)?;
        let eased = bend.clone();
        let by = By::Bones(Box::new(Bones { reach, bend, eased, carried, targets, skinned: Vec::new() }));
        Ok(Grab::new(pose, grip, size, held, by))
    }

    fn grab_surface(&mut self, pose: &[Vec3], mut grip: Grip) -> Result<Grab, EditError> {
        if grip.method == Method::Rig {
            grip.method = Method::Arap;
        }
        let mut outside = Vec::new();
        if let Scope::Region { radius } = grip.scope {
            let distances = self.deformer.distances(pose, &grip.handles, radius);
            outside.extend((0..pose.len() as u32).filter(|&vertex| distances[vertex as usize].is_infinite()));
            grip.pins.retain(|pin| outside.binary_search(pin).is_err());
        }
        let fixed: Vec<u32> = grip.handles.iter().chain(&grip.pins).chain(&outside).copied().collect();
        let held = self.deformer.hold(pose, &fixed, REST)?;
        let by = match self.space.as_ref().filter(|_| grip.method.is_learned()) {
            Some(space) => {
                let learned = Box::new(self.by_modes(space, pose, &grip, &held));
                By::Modes { learned, outside }
            }
            None => By::Surface { turns: vec![Quat::IDENTITY; pose.len()], outside },
        };
        Ok(Grab::new(pose, grip, size(pose), held, by))
    }

    /// A pose that moves by the modes of `space`.
    pub(crate) fn by_modes(&self, space: &Space, pose: &[Vec3], grip: &Grip, held: &Held) -> Learned {
        let mut modes = (space.facing(pose, &self.weights), space.variances().to_vec());
        if let Some(rig) = self.rig.as_ref().filter(|_| grip.method == Method::Parts) {
            let parts = rig.bones().iter().map(|bone| bone.limb + 1).max().unwrap_or(0);
            modes = by_part(&modes, parts, |vertex, part| {
                rig.influences()[vertex].sum(|bone| rig.bones()[bone].limb == part)
            });
        }
        Learned::new(held, pose.len(), modes, self.prior)
    }

    /// The centre of mass rather stays over the ground where it is.
    fn balance_target(&self, rig: &Rig, pose: &[Vec3]) -> Option<Target> {
        let mut sums = vec![(0.0_f32, Vec3::ZERO); rig.bones().len()];
        for ((influences, &point), &mass) in rig.influences().iter().zip(pose).zip(&self.weights) {
            for (&bone, &weight) in influences.joints.iter().zip(&influences.weights) {
                sums[bone as usize].0 += weight * mass;
                sums[bone as usize].1 += point * (weight * mass);
            }
        }
        let whole: f32 = sums.iter().map(|(mass, _)| mass).sum();
        let parts = sums.into_iter().enumerate().filter(|(_, (mass, _))| *mass > 0.0);
        let parts = parts.map(|(bone, (mass, sum))| (bone, mass / whole, sum / mass)).collect();
        let weight = Vec3::new(BALANCE, 0.0, BALANCE);
        (whole > 0.0).then(|| Target {
            parts,
            to: centre_of_mass(pose, &self.weights) / whole,
            weight,
            is_floor: false,
        })
    }

    /// Drags the handles to `to`, in metres, one place for each handle.
    ///
    /// # Errors
    /// Places that are not finite, or of another number.
    pub fn drag(&mut self, grab: &mut Grab, to: &[Vec3]) -> Result<Dragged, EditError> {
        let mut notes = Vec::new();
        let to = &grab.allowed(to, &mut notes);
        if self.aim(grab, to)? {
            let anchor = grab.held.anchor();
            match &grab.by {
                By::Bones(_) => self.pull_bones(grab, to, STEPS, &mut notes)?,
                _ => {
                    self.pull_surface(grab)?;
                    while self.draw_in(grab) {
                        self.pull_surface(grab)?;
                    }
                    self.soften(grab)?;
                    grab.shortfalls(to, &mut notes);
                }
            }
            self.lift(grab, anchor)?;
            grab.is_first = false;
        }
        Ok(Dragged { pose: grab.moved(), notes })
    }

    /// A drag of what has no bones.
    fn pull_surface(&mut self, grab: &mut Grab) -> Result<(), EditError> {
        if matches!(grab.by, By::Modes { .. }) {
            return self.pull_modes(grab);
        }
        let mut left = ITERATIONS;
        while left > 0 && !self.relax(grab, left == 1)? {
            left -= 1;
        }
        Ok(())
    }

    /// Where the handles are wanted, or the nearest sensible place; whether anything moves.
    pub(crate) fn aim(&mut self, grab: &mut Grab, to: &[Vec3]) -> Result<bool, EditError> {
        if to.len() != grab.grip.handles.len() || !to.iter().all(|to| to.is_finite()) {
            return Err(EditError::Edit { edit: 0, reason: "each handle needs one place, of three finite numbers" });
        }
        let at = |handle: u32| grab.pose[handle as usize];
        grab.wanted = grab.grip.handles.iter().zip(to).map(|(&handle, &to)| to - at(handle)).collect();
        if grab.grip.handles.iter().zip(to).all(|(&handle, &to)| to == at(handle)) {
            self.still(grab)?;
            return Ok(false);
        }
        let mut is_far = false;
        if !matches!(grab.by, By::Bones(_)) {
            let most = match grab.grip.scope {
                Scope::Region { radius } => FARTHEST_RADII * radius,
                _ => FARTHEST * grab.size,
            };
            is_far = grab.wanted.iter().any(|wanted| wanted.length() > most);
            grab.wanted.iter_mut().for_each(|wanted| *wanted = wanted.clamp_length_max(most));
        }
        (grab.asked, grab.drawn) = (grab.wanted.clone(), Drawn::default());
        grab.drawn.is_far = is_far;
        if let By::Modes { learned, .. } = &mut grab.by {
            learned.set_prior(self.prior);
        }
        Ok(true)
    }

    /// A step of a surface without bones and modes: all vertices for the turns as they are, then, unless it is the last, the turns. Whether
    /// nothing moves any more.
    pub(crate) fn relax(&mut self, grab: &mut Grab, is_last: bool) -> Result<bool, EditError> {
        let wanted = grab.held_wanted();
        let By::Surface { turns, .. } = &mut grab.by else { return Ok(true) };
        let told = vec![Vec3::ZERO; grab.pose.len()];
        let next = self.deformer.solve(&grab.held, &grab.pose, turns, &told, &wanted)?;
        let moved = next.iter().zip(&grab.displacements).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        grab.displacements = next;
        let is_still = grab.grip.method == Method::Laplace || moved < STILL;
        if !is_still && !is_last {
            *turns = self.deformer.turns(&grab.held, &grab.pose, &grab.displacements);
        }
        Ok(is_still || is_last)
    }

    /// One iteration with modes.
    fn pull_modes(&mut self, grab: &mut Grab) -> Result<(), EditError> {
        let wanted = grab.held_wanted();
        let By::Modes { learned, .. } = &mut grab.by else { return Ok(()) };
        grab.displacements = learned.pull(&mut self.deformer, &grab.held, &grab.pose, &wanted)?;
        Ok(())
    }

    /// Back to the pose that was grabbed.
    fn still(&mut self, grab: &mut Grab) -> Result<(), EditError> {
        grab.displacements.fill(Vec3::ZERO);
        grab.drawn_out.clear();
        grab.is_first = true;
        match &mut grab.by {
            By::Bones(bones) => {
                bones.bend = Bend::none(bones.bend.turns.len());
                bones.eased = bones.bend.clone();
                bones.targets.retain(|target| !target.is_floor);
                bones.skinned.clear();
            }
            By::Surface { turns, .. } => turns.fill(Quat::IDENTITY),
            By::Modes { learned, .. } => learned.still(&mut self.deformer, &grab.held, &grab.pose)?,
        }
        Ok(())
    }

    /// Lets go: what was dragged, to be spread over other frames.
    #[must_use]
    pub fn release(&self, grab: Grab) -> Released {
        self.released(&grab)
    }

    /// What would be let go now.
    #[must_use]
    pub fn released(&self, grab: &Grab) -> Released {
        let mut released = Released {
            grip: grab.grip.clone(),
            pose: grab.moved(),
            displacements: grab.displacements.clone(),
            wanted: grab.wanted.clone(),
            bones: None,
            turns: Vec::new(),
            rest: Vec::new(),
            drawn: grab.drawn_out.clone(),
            outside: Vec::new(),
            ground: grab.ground,
        };
        let vectors = |turns: &[Quat]| turns.iter().map(|&turn| crate::reach::logarithm(turn)).collect();
        match &grab.by {
            By::Bones(bones) => {
                let Bones { reach, eased, carried, skinned, .. } = bones.as_ref();
                let skin_of = |one: &Carried| skinned.get(one.vertex as usize).copied().unwrap_or_default();
                let beyond = carried.iter().zip(&released.wanted).map(|(one, &wanted)| wanted - skin_of(one)).collect();
                let (free, bend, carried) = (reach.free().to_vec(), eased.clone(), carried.clone());
                released.bones = Some(ReleasedBones { free, bend, carried, beyond });
            }
            By::Surface { turns, outside } => {
                released.turns = vectors(turns);
                released.outside.clone_from(outside);
            }
            By::Modes { learned, outside } => {
                (released.turns, released.rest) = (vectors(learned.turns()), learned.rest().to_vec());
                released.outside.clone_from(outside);
            }
        }
        released
    }
}

impl Grab {
    fn new(pose: &[Vec3], grip: Grip, size: f32, held: Held, by: By) -> Self {
        let (wanted, displacements) = (vec![Vec3::ZERO; grip.handles.len()], vec![Vec3::ZERO; pose.len()]);
        let (ground, floor) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
        let (pose, is_first, stopped) = (pose.to_vec(), true, Vec::new());
        let (asked, drawn, rounds) = (Vec::new(), Drawn::default(), 0);
        Self {
            pose,
            grip,
            size,
            held,
            by,
            wanted,
            asked,
            drawn,
            drawn_out: Vec::new(),
            displacements,
            is_first,
            ground,
            floor,
            stopped,
            rounds,
        }
    }

    /// What was grabbed.
    #[must_use]
    pub fn grip(&self) -> &Grip {
        &self.grip
    }

    /// Notes how far handles stop short of `to`.
    pub(crate) fn shortfalls(&self, to: &[Vec3], notes: &mut Vec<String>) {
        for ((&handle, &to), &wanted) in self.grip.handles.iter().zip(to).zip(&self.wanted) {
            let short = (to - self.pose[handle as usize]).distance(wanted);
            if short > SHORT {
                notes.push(far(handle, short));
            }
        }
    }

    /// Displacements of all that is held: what is no handle stays, or goes to the ground.
    pub(crate) fn held_wanted(&self) -> Vec<Vec3> {
        let mut wanted = self.wanted.clone();
        wanted.resize(self.held.vertices().len() - self.stopped.len(), Vec3::ZERO);
        wanted.extend(&self.stopped);
        wanted
    }

    pub(crate) fn moved(&self) -> Vec<Vec3> {
        self.pose.iter().zip(&self.displacements).map(|(&point, &displacement)| point + displacement).collect()
    }
}

pub(crate) fn far(vertex: u32, short: f32) -> String {
    // Whole numbers: to write others would weigh 6 KB on the page.
    let centimetres = (100.0 * short).round() as u32;
    let (metres, rest) = (centimetres / 100, centimetres % 100);
    format!("vertex {vertex} stops {metres}.{rest:02} m short of where it is to go: the body does not reach further")
}
