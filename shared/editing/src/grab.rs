//! Grabbing a pose and dragging it: what a page does with every move of a pointer, and what a document of edits asks for.
//!
//! A grab prepares all that does not change while one drags: where the bones are, which bone a handle takes hold of, and the
//! factor of the surface under its handles and pins. A drag is inverse kinematics from where the last one ended, skinning of
//! the *frame's own* vertices by how the bones turned (folds and hair survive), and one solve.

use glam::{Quat, Vec3};
use kernels::align::centre_of_mass;
use kernels::topology::Topology;

use crate::deform::{Deformer, Held};
use crate::document::{Method, Scope};
use crate::error::EditError;
use crate::reach::{Bend, Reach, Role, Target};
use crate::rig::{NO_BONE, Rig};
use crate::rigid::Rigid;
use crate::rotation::between;
use crate::skin::{Influences, Skin};

/// How firmly vertices follow the skin beside the weights of edges.
pub(crate) const FOLLOW: f32 = 0.02;
/// The same where there is no skin: only against parts that nothing holds.
const REST: f32 = 1e-4;
/// Weight of handles and pins in the inverse kinematics, and of the centre of mass over the ground.
pub(crate) const HANDLE: f32 = 4.0;
pub(crate) const PIN: f32 = 20.0;
const BALANCE: f32 = 0.1;
/// Steps of a drag, and of a grab's first one.
const STEPS: usize = 6;
const FIRST_STEPS: usize = 40;
/// How far a handle takes hold of its bone over the surface, as a share of the body's size.
const HOLD: f32 = 0.14;
/// Further than this share of its size the surface is not stretched beyond what the bones reach.
const STRETCH: f32 = 0.03;
/// The bones are not pulled further than so many sizes.
const PULL: f32 = 1.2;
/// Further than this share no handle goes without a rig; of a region, than so many radii.
const FARTHEST: f32 = 0.5;
const FARTHEST_RADII: f32 = 1.5;
/// Local and global steps of as-rigid-as-possible surfaces: a drag, and until it comes to rest.
const ITERATIONS: usize = 4;
const MOST_ITERATIONS: usize = 80;
const STILL: f32 = 1e-4;

/// What is grabbed, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// Vertices that will be dragged.
    pub handles: Vec<u32>,
    /// Vertices that stay; handles are none.
    pub pins: Vec<u32>,
    /// What may move.
    pub scope: Scope,
    /// How it moves; [`Method::Rig`] where there is no rig is [`Method::Arap`].
    pub method: Method,
}

/// A vertex that takes hold of a bone: what is around it follows the bone, too, by these shares.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Carried {
    pub vertex: u32,
    pub bone: usize,
    pub around: Vec<(u32, f32)>,
}

/// A pose that is being dragged.
pub struct Grab {
    pose: Vec<Vec3>,
    grip: Grip,
    size: f32,
    held: Held,
    by: By,
    /// Displacement of each handle: what was wanted, or the nearest sensible one.
    wanted: Vec<Vec3>,
    displacements: Vec<Vec3>,
    is_first: bool,
}

/// What moves the surface.
enum By {
    Bones { reach: Box<Reach>, bend: Bend, carried: Vec<Carried>, targets: Vec<Target>, skinned: Vec<Vec3> },
    Surface { turns: Vec<Quat>, outside: Vec<u32> },
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
    pub(crate) outside: Vec<u32>,
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
    weights: Vec<f32>,
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
        Ok(Self { deformer: Deformer::new(topology, order)?, rig, weights: topology.weights().to_vec() })
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
        let mut grip = grip.clone();
        let count = self.weights.len();
        if let Some(&vertex) = grip.handles.iter().chain(&grip.pins).find(|&&vertex| vertex as usize >= count) {
            return Err(EditError::Vertex { edit: 0, vertex, count });
        }
        if grip.handles.is_empty() {
            return Err(EditError::Edit { edit: 0, reason: "it has no handle: say which vertex goes where" });
        }
        let mut is_pin = vec![false; count];
        grip.pins.iter().for_each(|&pin| is_pin[pin as usize] = true);
        grip.handles.iter().for_each(|&handle| is_pin[handle as usize] = false);
        grip.pins = (0..count as u32).filter(|&vertex| is_pin[vertex as usize]).collect();
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
        let staying: Vec<u32> = grip.pins.iter().map(|&pin| rig.bones()[rig.bone_of(pin)].limb).collect();
        let reach = Reach::new(rig, &motions, free.clone(), |limb| Role::of(limb, &limbs, &staying), steady);
        let mut targets: Vec<Target> = carried.iter().map(|one| handle_target(one, pose)).collect();
        targets.extend(pin_targets(rig, pose, &grip.pins, 1.0));
        if free[0] && !grip.pins.is_empty() {
            targets.extend(self.balance_target(rig, pose));
        }
        let fixed: Vec<u32> = grip.handles.iter().chain(&grip.pins).copied().collect();
        let bend = Bend::none(rig.bones().len());
        let held = self.deformer.hold(pose, &fixed, FOLLOW)?;
        let by = By::Bones { reach: Box::new(reach), bend, carried, targets, skinned: Vec::new() };
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
        let by = By::Surface { turns: vec![Quat::IDENTITY; pose.len()], outside };
        Ok(Grab::new(pose, grip, size(pose), held, by))
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
        (whole > 0.0).then(|| Target { parts, to: centre_of_mass(pose, &self.weights) / whole, weight })
    }

    /// Drags the handles to `to`, in metres, one place for each handle.
    ///
    /// # Errors
    /// Places that are not finite, or of another number.
    pub fn drag(&mut self, grab: &mut Grab, to: &[Vec3]) -> Result<Dragged, EditError> {
        self.pull(grab, to, false)
    }

    /// As [`Self::drag`], until nothing moves any more: for documents, and for idle moments of a page.
    ///
    /// # Errors
    /// As there.
    pub fn settle(&mut self, grab: &mut Grab, to: &[Vec3]) -> Result<Dragged, EditError> {
        self.pull(grab, to, true)
    }

    fn pull(&mut self, grab: &mut Grab, to: &[Vec3], until_still: bool) -> Result<Dragged, EditError> {
        if to.len() != grab.grip.handles.len() || !to.iter().all(|to| to.is_finite()) {
            return Err(EditError::Edit { edit: 0, reason: "each handle needs one place, of three finite numbers" });
        }
        let at = |handle: u32| grab.pose[handle as usize];
        grab.wanted = grab.grip.handles.iter().zip(to).map(|(&handle, &to)| to - at(handle)).collect();
        if grab.grip.handles.iter().zip(to).all(|(&handle, &to)| to == at(handle)) {
            grab.still();
            return Ok(Dragged { pose: grab.pose.clone(), notes: Vec::new() });
        }
        let mut notes = Vec::new();
        match grab.by {
            By::Bones { .. } => self.pull_bones(grab, to, until_still, &mut notes)?,
            By::Surface { .. } => self.pull_surface(grab, until_still, &mut notes)?,
        }
        grab.is_first = false;
        Ok(Dragged { pose: grab.moved(), notes })
    }

    fn pull_bones(
        &mut self,
        grab: &mut Grab,
        to: &[Vec3],
        until_still: bool,
        notes: &mut Vec<String>,
    ) -> Result<(), EditError> {
        let (By::Bones { reach, bend, carried, targets, skinned }, Some(rig)) = (&mut grab.by, &self.rig) else {
            return Ok(());
        };
        for ((target, &to), &handle) in targets.iter_mut().zip(to).zip(&grab.grip.handles) {
            let from = grab.pose[handle as usize];
            // What is far away must not pull the feet from where they stand.
            target.to = from + (to - from).clamp_length_max(PULL * grab.size);
        }
        let (steps, none) =
            (if grab.is_first || until_still { FIRST_STEPS } else { STEPS }, Bend::none(rig.bones().len()));
        reach.solve(targets, &none, bend, steps);
        let mut motions = reach.motions(bend);
        let most = STRETCH * grab.size;
        let mut is_short = false;
        for target in targets.iter_mut().take(carried.len()) {
            let place = Reach::place(target, &motions);
            let off = target.to - place;
            if off.length() > most {
                (target.to, is_short) = (place + off.normalize_or_zero() * most, true);
            }
        }
        if is_short {
            reach.solve(targets, &none, bend, steps);
            motions = reach.motions(bend);
        }
        for (index, (target, &to)) in targets.iter().zip(to).enumerate() {
            let handle = grab.grip.handles[index];
            let short = target.to.distance(to);
            if short > 1e-6 {
                grab.wanted[index] = target.to - grab.pose[handle as usize];
                notes.push(far(handle, short));
            }
        }
        let (turns, told) = skin(rig, &grab.pose, &motions, carried);
        let still = grab.grip.pins.iter().map(|_| Vec3::ZERO);
        let wanted: Vec<Vec3> = grab.wanted.iter().copied().chain(still).collect();
        grab.displacements = self.deformer.solve(&grab.held, &grab.pose, &turns, &told, &wanted)?;
        *skinned = told;
        Ok(())
    }

    fn pull_surface(&mut self, grab: &mut Grab, until_still: bool, notes: &mut Vec<String>) -> Result<(), EditError> {
        let most = match grab.grip.scope {
            Scope::Region { radius } => FARTHEST_RADII * radius,
            _ => FARTHEST * grab.size,
        };
        for (wanted, &handle) in grab.wanted.iter_mut().zip(&grab.grip.handles) {
            let length = wanted.length();
            if length > most {
                *wanted *= most / length;
                notes.push(far(handle, length - most));
            }
        }
        let By::Surface { turns, .. } = &mut grab.by else { return Ok(()) };
        let told = vec![Vec3::ZERO; grab.pose.len()];
        let fixed = grab.held.vertices().len();
        let mut wanted = grab.wanted.clone();
        wanted.resize(fixed, Vec3::ZERO);
        let iterations = match grab.grip.method {
            Method::Laplace => 1,
            _ if until_still => MOST_ITERATIONS,
            _ => ITERATIONS,
        };
        for iteration in 0..iterations {
            let next = self.deformer.solve(&grab.held, &grab.pose, turns, &told, &wanted)?;
            let moved = next.iter().zip(&grab.displacements).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            grab.displacements = next;
            if grab.grip.method == Method::Laplace || iteration + 1 == iterations || moved < STILL {
                break;
            }
            *turns = self.deformer.turns(&grab.held, &grab.pose, &grab.displacements);
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
            outside: Vec::new(),
        };
        match &grab.by {
            By::Bones { reach, bend, carried, skinned, .. } => {
                let skin_of = |one: &Carried| skinned.get(one.vertex as usize).copied().unwrap_or_default();
                let beyond = carried.iter().zip(&released.wanted).map(|(one, &wanted)| wanted - skin_of(one)).collect();
                let (free, bend, carried) = (reach.free().to_vec(), bend.clone(), carried.clone());
                released.bones = Some(ReleasedBones { free, bend, carried, beyond });
            }
            By::Surface { turns, outside } => {
                released.turns = turns.iter().map(|&turn| crate::reach::logarithm(turn)).collect();
                released.outside.clone_from(outside);
            }
        }
        released
    }
}

impl Grab {
    fn new(pose: &[Vec3], grip: Grip, size: f32, held: Held, by: By) -> Self {
        let (wanted, displacements) = (vec![Vec3::ZERO; grip.handles.len()], vec![Vec3::ZERO; pose.len()]);
        Self { pose: pose.to_vec(), grip, size, held, by, wanted, displacements, is_first: true }
    }

    /// What was grabbed.
    #[must_use]
    pub fn grip(&self) -> &Grip {
        &self.grip
    }

    /// Back to the pose that was grabbed.
    fn still(&mut self) {
        self.displacements.fill(Vec3::ZERO);
        self.is_first = true;
        match &mut self.by {
            By::Bones { bend, skinned, .. } => {
                *bend = Bend::none(bend.turns.len());
                skinned.clear();
            }
            By::Surface { turns, .. } => turns.fill(Quat::IDENTITY),
        }
    }

    fn moved(&self) -> Vec<Vec3> {
        self.pose.iter().zip(&self.displacements).map(|(&point, &displacement)| point + displacement).collect()
    }
}

fn far(vertex: u32, short: f32) -> String {
    // Whole numbers: to write others would weigh 6 KB on the page.
    let centimetres = (100.0 * short).round() as u32;
    let (metres, rest) = (centimetres / 100, centimetres % 100);
    format!("vertex {vertex} stops {metres}.{rest:02} m short of where it is to go: the body does not reach further")
}

/// How large a pose is: the longest side of its box.
fn size(pose: &[Vec3]) -> f32 {
    let low = pose.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = pose.iter().copied().reduce(Vec3::max).unwrap_or_default();
    (high - low).max_element()
}

/// The bone that a handle takes hold of, and how far what is around follows. That of its own piece; cloth and hair, which
/// belong to none, are grabbed for the nearest of the bones that move them: a skirt for the thigh under it.
fn carry(rig: &Rig, deformer: &Deformer, (pose, motions): (&[Vec3], &[Rigid]), vertex: u32, radius: f32) -> Carried {
    let Influences { joints, weights } = &rig.influences()[vertex as usize];
    let (from, to) = (rig.joints(motions), rig.ends(motions));
    let point = pose[vertex as usize];
    let distance = |k: usize| {
        let bone = joints[k] as usize;
        let along = to[bone] - from[bone];
        let share = ((point - from[bone]).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        point.distance(from[bone] + along * share)
    };
    let is_loose = rig.core()[vertex as usize] == NO_BONE;
    let is_better = |k: usize, best: usize| match is_loose {
        true => weights[k] > 0.0 && (weights[best] <= 0.0 || distance(k) < distance(best)),
        false => weights[k] > weights[best],
    };
    let best = (1..joints.len()).fold(0, |best, k| if is_better(k, best) { k } else { best });
    let bone = joints[best] as usize;
    let share = weights[best];
    let distances = deformer.distances(pose, &[vertex], radius);
    let around = distances.iter().enumerate().filter(|(_, distance)| distance.is_finite()).map(|(other, distance)| {
        let u = (distance / radius).clamp(0.0, 1.0);
        (other as u32, (1.0 - share) * (1.0 - u * u * (3.0 - 2.0 * u)))
    });
    Carried { vertex, bone, around: around.collect() }
}

/// Which bones may turn.
fn free(rig: &Rig, scope: Scope, limbs: &[u32]) -> Vec<bool> {
    let bones = rig.bones().iter().enumerate();
    bones.map(|(index, bone)| scope == Scope::Body || (index > 0 && limbs.contains(&bone.limb))).collect()
}

pub(crate) fn handle_target(carried: &Carried, pose: &[Vec3]) -> Target {
    let point = pose[carried.vertex as usize];
    Target { parts: vec![(carried.bone, 1.0, point)], to: point, weight: Vec3::splat(HANDLE) }
}

/// Targets that hold the vertices `pins` where they are: of each bone the outermost along each axis.
pub(crate) fn pin_targets(rig: &Rig, pose: &[Vec3], pins: &[u32], share: f32) -> Vec<Target> {
    let mut by_bone: Vec<Vec<u32>> = vec![Vec::new(); rig.bones().len()];
    pins.iter().for_each(|&pin| by_bone[rig.bone_of(pin)].push(pin));
    let mut targets = Vec::new();
    for (bone, pins) in by_bone.iter().enumerate() {
        let mut chosen: Vec<u32> = Vec::new();
        for axis in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z, Vec3::Y, Vec3::NEG_Y] {
            let along = |pin: u32| pose[pin as usize].dot(axis);
            let outermost = pins.iter().copied().reduce(|best, pin| if along(pin) > along(best) { pin } else { best });
            chosen.extend(outermost.filter(|pin| !chosen.contains(pin)));
        }
        targets.extend(chosen.into_iter().map(|pin| {
            let point = pose[pin as usize];
            Target { parts: vec![(bone, 1.0, point)], to: point, weight: Vec3::splat(PIN * share * share) }
        }));
    }
    targets
}

/// How each vertex of `pose` is turned and displaced where its bones do `motions`.
pub(crate) fn skin(rig: &Rig, pose: &[Vec3], motions: &[Rigid], carried: &[Carried]) -> (Vec<Quat>, Vec<Vec3>) {
    let origin = vec![Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO }; motions.len()];
    let skin = Skin::new(&origin, motions);
    let is_still: Vec<bool> = motions.iter().map(|motion| *motion == origin[0]).collect();
    let (mut turns, mut told) = (Vec::with_capacity(pose.len()), Vec::with_capacity(pose.len()));
    for (influences, &point) in rig.influences().iter().zip(pose) {
        let moves = |k: usize| influences.weights[k] > 0.0 && !is_still[influences.joints[k] as usize];
        // What no bone moves is not moved by rounding, either.
        let motion = if (0..influences.joints.len()).any(moves) { skin.motion(influences) } else { origin[0] };
        turns.push(motion.rotation);
        told.push(motion.apply(point) - point);
    }
    for one in carried.iter().filter(|one| !is_still[one.bone]) {
        let motion = &motions[one.bone];
        for &(vertex, share) in &one.around {
            let vertex = vertex as usize;
            turns[vertex] = between(turns[vertex], motion.rotation, share);
            told[vertex] = told[vertex].lerp(motion.apply(pose[vertex]) - pose[vertex], share);
        }
    }
    (turns, told)
}
