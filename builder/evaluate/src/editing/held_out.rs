//! Held-out reconstruction: some patches of a pose are put where another frame has them, and the rest of it is found by each method;
//! the other frame is of a sequence that nothing was learned from.

use actor::capture::{Capture, Poses};
use editing::{Deformer, Editor, Grip, Method, Rig, Scope, Space};
use glam::Vec3;
use job::Job;
use kernels::topology::Topology;
use rig::{RigOptions, SpaceOptions, estimate, learn_space};

use super::basis::{Basis, aligned, apart};
use super::shape::{stretch, tall};
use super::strip::{CLAY, EDITED, RECORDED, Shown, strip};
use super::surface::Surface;
use crate::EvaluateError;
use crate::document::{Cell, Picture, Table};

/// Modes of the whole body, and of each of its parts (the paper's option).
const MODES: usize = 48;
const PART_MODES: usize = 16;
/// Iterations of rotations.
const ITERATIONS: usize = 20;
/// The prior's weight in square metres of the methods that are here alone: chosen on the built-in performer of seed 1.
const LAMBDA: f64 = 1e-3;
/// Those that are held against the product's own.
const LAMBDAS: [f64; 4] = [3e-5, 1e-4, 3e-4, 1e-3];
/// Above so many vertices what is here alone takes minutes a frame, and is left out.
const SLOW: usize = 6000;
/// Frames that are learned from, and tasks, at most; and tasks of one sequence.
const LEARNED: usize = 160;
const TASKS: usize = 12;
const EACH: usize = 4;
/// Patches, and how far they reach, as a share of the body's height.
const PATCHES: usize = 6;
const PATCH: f32 = 0.03;
/// Tasks of the picture.
const SHOWN: usize = 3;

/// The methods, in the order of their rows.
pub const METHODS: [&str; 9] = [
    "no edit",
    "Laplacian (eq. 4)",
    "as rigid as possible",
    "learned (eq. 7)",
    "learned, rotations",
    "learned by part, rotations",
    "learned, the product\u{2019}s",
    "learned by part, the product\u{2019}s",
    "rig",
];

/// The place of that which all others are held against.
pub const RIGID: usize = 2;
/// The place of the product's learned method.
pub const PRODUCT: usize = 6;

/// What one method came to: errors in millimetres and stretch in percent, over all tasks.
#[derive(Default)]
struct Found {
    off: Vec<f64>,
    stretch: Vec<f64>,
}

/// What was found, method by method: root of the mean square over tasks, in millimetres.
pub struct HeldOut {
    pub tables: Vec<Table>,
    /// By [`METHODS`].
    pub off: Vec<f64>,
    pub tasks: usize,
    /// Some of the tasks, where there are any.
    pub picture: Option<Picture>,
}

/// A frame that is wanted, of a sequence that is held out.
struct Task {
    sequence: usize,
    frame: u32,
    /// The frame that is edited.
    reference: u32,
}

/// Makes the tables.
pub fn held_out(capture: &Capture, job: &Job) -> Result<HeldOut, EvaluateError> {
    let tasks = tasks(capture);
    let mut found: Vec<Found> = METHODS.iter().map(|_| Found::default()).collect();
    let mut priors = [const { Vec::new() }; LAMBDAS.len()];
    let (mut rows, mut shown) = (Vec::new(), Vec::new());
    let mut deformer = Deformer::new(&capture.topology, None)?;
    for (k, task) in tasks.iter().enumerate() {
        job.tell("held-out edits", k as u64, tasks.len() as u64)?;
        let name = &capture.timeline.sequences()[task.sequence].name;
        let (one, poses) = Scene::new(capture, &mut deformer, task).run(&mut deformer, &mut priors)?;
        if k.is_multiple_of(tasks.len().div_ceil(SHOWN).max(1)) {
            shown.push(poses);
        }
        let mut row: Vec<Cell> = vec![name.as_str().into(), Cell::Count(task.frame.into())];
        for (all, measured) in found.iter_mut().zip(&one) {
            row.push(measured.map_or(Cell::Empty, |(off, _)| Cell::Number(off, 1)));
            if let Some((off, stretch)) = *measured {
                all.off.push(off);
                all.stretch.push(stretch);
            }
        }
        rows.push(row);
    }
    let off: Vec<f64> = found.iter().map(|one| root_mean_square(&one.off)).collect();
    let mut table = Table::new(
        "editing_held_out",
        format!(
            "Held-out reconstruction, {} frames: root mean square over free vertices, mm, and mean stretch of edges; {MODES} modes, \
             {PART_MODES} a part, prior {LAMBDA} m^2, {ITERATIONS} iterations",
            tasks.len()
        ),
        &["method", "off mm", "of no edit", "stretch %", "frames"],
    );
    for ((method, one), off_all) in METHODS.iter().zip(&found).zip(&off) {
        if one.off.is_empty() {
            continue;
        }
        table.rows.push(vec![
            (*method).into(),
            Cell::Number(*off_all, 1),
            Cell::Number(off_all / off[0], 2),
            Cell::Number(one.stretch.iter().sum::<f64>() / one.stretch.len().max(1) as f64, 2),
            Cell::Count(one.off.len() as u64),
        ]);
    }
    let columns: Vec<&str> = ["sequence held out", "frame"].into_iter().chain(METHODS).collect();
    let mut each = Table::new("editing_held_out_frames", "The same, frame by frame, mm", &columns);
    each.rows = rows;
    let halves = ["prior m^2", "off mm: every other frame from the first", "from the second"];
    let mut prior =
        Table::new("editing_prior", "The product\u{2019}s learned method, by the weight of its prior", &halves);
    let half = |off: &[f64], from: usize| -> Vec<f64> { off.iter().skip(from).step_by(2).copied().collect() };
    let both = |off: &[f64]| [0, 1].map(|from| Cell::Number(root_mean_square(&half(off, from)), 1));
    for (lambda, off) in LAMBDAS.iter().zip(&priors) {
        prior.rows.push(std::iter::once(format!("{lambda}").into()).chain(both(off)).collect());
    }
    prior.rows.push(std::iter::once("as rigid as possible".into()).chain(both(&found[RIGID].off)).collect());
    let picture = if shown.is_empty() { None } else { Some(picture(capture, &shown)?) };
    Ok(HeldOut { tables: vec![table, each, prior], off, tasks: tasks.len(), picture })
}

/// Figure 2: some tasks, method beside method.
fn picture(capture: &Capture, shown: &[Vec<Vec<Vec3>>]) -> Result<Picture, EvaluateError> {
    let colours = [RECORDED, CLAY, CLAY, EDITED, EDITED, RECORDED];
    let row =
        |poses: &Vec<Vec<Vec3>>| poses.iter().zip(colours).map(|(pose, colour)| Shown::plain(pose, colour)).collect();
    let rows: Vec<Vec<Shown>> = shown.iter().map(row).collect();
    let caption = "Fig. 2: held-out reconstruction; the frame that is edited (blue), its patches put where the wanted frame has them: Laplacian, as \
                   rigid as possible, learned (the product\u{2019}s), rig; and the wanted frame (blue)";
    let floor = shown.iter().flatten().flatten().map(|point| point.y).fold(f32::INFINITY, f32::min);
    strip(capture.topology.triangles(), capture.topology.weights(), &rows, (0.4, floor), caption.into())
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Of every sequence the frames that are farthest from what is edited and from each other; edited is the first frame of the first other
/// sequence.
fn tasks(capture: &Capture) -> Vec<Task> {
    let sequences = capture.timeline.sequences();
    if sequences.len() < 2 {
        return Vec::new();
    }
    let weights = capture.topology.weights();
    let all: Vec<u32> = (0..capture.topology.vertex_count() as u32).collect();
    let each = (TASKS / sequences.len()).clamp(1, EACH);
    let mut tasks = Vec::new();
    for (number, sequence) in sequences.iter().enumerate().take(TASKS) {
        let reference = sequences[usize::from(number == 0)].first_frame;
        let base = capture.poses.frame(reference);
        let step = (sequence.frame_count / 40).max(1);
        let frames: Vec<u32> = (sequence.first_frame..sequence.end_frame()).step_by(step as usize).collect();
        let poses: Vec<Vec<Vec3>> =
            frames.iter().map(|&frame| aligned(base, capture.poses.frame(frame), weights)).collect();
        let mut far: Vec<f64> = poses.iter().map(|pose| apart(base, pose, &all)).collect();
        for _ in 0..each {
            let best = (0..far.len()).fold(0, |best, k| if far[k] > far[best] { k } else { best });
            tasks.push(Task { sequence: number, frame: frames[best], reference });
            far.iter_mut().zip(&poses).for_each(|(far, pose)| *far = far.min(apart(&poses[best], pose, &all)));
        }
    }
    tasks
}

/// What the methods came to in one task, and the poses that are shown of it.
type Ran = (Vec<Option<(f64, f64)>>, Vec<Vec<Vec3>>);

/// A task with what its methods need.
struct Scene<'a> {
    capture: &'a Capture,
    reference: Vec<Vec3>,
    wanted: Vec<Vec3>,
    /// Frames of other sequences.
    others: Vec<u32>,
    /// Poses that are learned from, on the reference.
    learned: Vec<Vec<Vec3>>,
    rig: Option<Rig>,
    /// The vertices of each patch, its centre first.
    patches: Vec<Vec<u32>>,
    /// By vertex the patch that is nearest.
    part: Vec<usize>,
    /// Vertices that are neither held nor of a piece that nothing holds.
    free: Vec<u32>,
}

impl<'a> Scene<'a> {
    fn new(capture: &'a Capture, deformer: &mut Deformer, task: &Task) -> Self {
        let weights = capture.topology.weights();
        let frame = |frame: u32| capture.poses.frame(frame);
        let reference = frame(task.reference).to_vec();
        let left_out = &capture.timeline.sequences()[task.sequence];
        let others: Vec<u32> = (0..capture.timeline.frame_count()).filter(|&f| !left_out.contains(f)).collect();
        let step = others.len().div_ceil(LEARNED).max(1);
        let learned = others.iter().step_by(step).map(|&f| aligned(&reference, frame(f), weights)).collect();
        let mut poses = Poses::new(reference.len());
        others.iter().for_each(|&f| poses.push(frame(f)));
        let rig = estimate(&capture.topology, &poses, &RigOptions::default()).ok().map(|found| found.rig);
        let centres = centres(capture, deformer, &reference, rig.as_ref());
        let far: Vec<Vec<f32>> =
            centres.iter().map(|&centre| deformer.distances(&reference, &[centre], f32::INFINITY)).collect();
        let reach = PATCH * tall(&reference);
        let count = reference.len();
        let patches: Vec<Vec<u32>> = far
            .iter()
            .zip(&centres)
            .map(|(far, &centre)| {
                let around = (0..count as u32).filter(|&v| v != centre && far[v as usize] < reach);
                std::iter::once(centre).chain(around).collect()
            })
            .collect();
        let nearest = |v: usize| (0..far.len()).fold(0, |best, k| if far[k][v] < far[best][v] { k } else { best });
        let part: Vec<usize> = (0..count).map(nearest).collect();
        let mut is_free: Vec<bool> = (0..count).map(|v| far[part[v]][v].is_finite()).collect();
        patches.iter().flatten().for_each(|&v| is_free[v as usize] = false);
        let free = (0..count as u32).filter(|&v| is_free[v as usize]).collect();
        let wanted = aligned(&reference, frame(task.frame), weights);
        Self { capture, reference, wanted, others, learned, rig, patches, part, free }
    }

    /// By method how far the free vertices are off, in millimetres, and the stretch of edges, in percent; and the poses of the picture.
    fn run(&self, deformer: &mut Deformer, priors: &mut [Vec<f64>; LAMBDAS.len()]) -> Result<Ran, EvaluateError> {
        let mut held: Vec<u32> = self.patches.iter().flatten().copied().collect();
        held.sort_unstable();
        held.dedup();
        let mut surface = Surface::new(deformer, &self.reference, &held, &self.wanted)?;
        let mut found = vec![Some(self.reference.clone()), Some(surface.rigid(0)?), Some(surface.rigid(ITERATIONS)?)];
        found.extend(self.by_large_systems(&mut surface)?);
        let measure = |pose: &Option<Vec<Vec3>>| pose.as_ref().map(|pose| self.measure(pose));
        let mut measured: Vec<Option<(f64, f64)>> = found.iter().map(measure).collect();
        let space = self.space();
        for (lambda, prior) in LAMBDAS.iter().zip(priors) {
            prior.extend(
                self.by_product(space.as_ref(), Method::Learned, Some(*lambda)).map(|pose| self.measure(&pose).0),
            );
        }
        let of = |method| self.by_product(space.as_ref(), method, None);
        let last = [of(Method::Learned), of(Method::Parts).filter(|_| self.rig.is_some()), self.by_rig()];
        measured.extend(last.iter().map(measure));
        let or_edited = |pose: Option<Vec<Vec3>>| pose.unwrap_or_else(|| self.reference.clone());
        let [product, _, rig] = last.map(or_edited);
        let [laplacian, rigid] = [1, RIGID].map(|k| or_edited(found[k].take()));
        Ok((measured, vec![self.reference.clone(), laplacian, rigid, product, rig, self.wanted.clone()]))
    }

    /// The learned methods that are here alone; nothing where they would take too long.
    fn by_large_systems(&self, surface: &mut Surface) -> Result<[Option<Vec<Vec3>>; 3], EvaluateError> {
        if self.reference.len() > SLOW {
            return Ok([const { None }; 3]);
        }
        let whole = Basis::of(&self.learned, &vec![true; self.reference.len()], MODES);
        let parts = (0..self.patches.len()).fold(Basis { modes: Vec::new(), variances: Vec::new() }, |all, part| {
            let inside: Vec<bool> = self.part.iter().map(|&of| of == part).collect();
            all.with(Basis::of(&self.learned, &inside, PART_MODES))
        });
        Ok([
            Some(surface.learned(&whole, LAMBDA, 0)?),
            Some(surface.learned(&whole, LAMBDA, ITERATIONS)?),
            Some(surface.learned(&parts, LAMBDA, ITERATIONS)?),
        ])
    }

    fn measure(&self, pose: &[Vec3]) -> (f64, f64) {
        let off = 1e3 * apart(pose, &self.wanted, &self.free);
        (off, 100.0 * stretch(&self.capture.topology, &self.reference, pose))
    }

    /// The space of the other sequences, as a bundle stores it.
    fn space(&self) -> Option<Space> {
        let topology = &self.capture.topology;
        let learned = learn_space(topology, &self.capture.poses, &self.others, &SpaceOptions::default())?;
        let of = |&frame: &u32| self.capture.poses.frame(frame).to_vec();
        let poses: Vec<Vec<Vec3>> = learned.space.frames.iter().map(of).collect();
        learned.space.space(&poses, topology.weights()).ok()
    }

    /// As an edit of method `learned` or `parts` has it.
    fn by_product(&self, space: Option<&Space>, method: Method, prior: Option<f64>) -> Option<Vec<Vec3>> {
        let mut editor = Editor::new(&self.capture.topology, None, self.rig.clone()).ok()?;
        editor.learn(space?.clone()).ok()?;
        prior.iter().for_each(|&prior| editor.set_prior(prior));
        let mut handles: Vec<u32> = self.patches.iter().flatten().copied().collect();
        handles.sort_unstable();
        handles.dedup();
        let to: Vec<Vec3> = handles.iter().map(|&v| self.wanted[v as usize]).collect();
        let grip = Grip { handles, pins: Vec::new(), eased: Vec::new(), scope: Scope::Body, method };
        let grab = editor.grab(&self.reference, &grip).ok()?;
        let (grab, _) = editor.settle(grab, &to).ok()?;
        Some(editor.release(grab).pose)
    }

    /// The patches' centres alone are dragged: the rig turns what is around them.
    fn by_rig(&self) -> Option<Vec<Vec3>> {
        let mut editor = Editor::new(&self.capture.topology, None, Some(self.rig.clone()?)).ok()?;
        let handles: Vec<u32> = self.patches.iter().map(|patch| patch[0]).collect();
        let to: Vec<Vec3> = handles.iter().map(|&v| self.wanted[v as usize]).collect();
        let grip = Grip { handles, pins: Vec::new(), eased: Vec::new(), scope: Scope::Body, method: Method::Rig };
        let grab = editor.grab(&self.reference, &grip).ok()?;
        let (grab, _) = editor.settle(grab, &to).ok()?;
        Some(editor.release(grab).pose)
    }
}

/// The middles of the patches: of a human's rig hands, feet, head and belly, else the ends of the surface and its middle.
fn centres(capture: &Capture, deformer: &Deformer, reference: &[Vec3], rig: Option<&Rig>) -> Vec<u32> {
    if let Some(found) = rig.and_then(|rig| of_human(rig, reference)) {
        return found;
    }
    let mut chosen = vec![middle(&capture.topology, reference)];
    while chosen.len() < PATCHES {
        let far = deformer.distances(reference, &chosen, f32::INFINITY);
        let farthest = (0..reference.len()).filter(|&v| far[v].is_finite());
        let Some(next) = farthest.reduce(|best, v| if far[v] > far[best] { v } else { best }) else { break };
        if far[next] <= 0.0 {
            break;
        }
        chosen.push(next as u32);
    }
    chosen
}

/// The vertex of the largest piece that is nearest to its middle.
fn middle(topology: &Topology, pose: &[Vec3]) -> u32 {
    let of = topology.component_of_vertex();
    let mut sizes = vec![0_u32; topology.component_count()];
    of.iter().for_each(|&piece| sizes[piece as usize] += 1);
    let largest = (0..sizes.len()).fold(0, |best, k| if sizes[k] > sizes[best] { k } else { best });
    let own = || (0..pose.len()).filter(|&v| of[v] as usize == largest);
    let centre = own().map(|v| pose[v]).sum::<Vec3>() / sizes[largest].max(1) as f32;
    let nearer = |best: usize, v: usize| if pose[v].distance(centre) < pose[best].distance(centre) { v } else { best };
    own().reduce(nearer).unwrap_or(0) as u32
}

fn of_human(rig: &Rig, reference: &[Vec3]) -> Option<Vec<u32>> {
    let motions = rig.fit(reference);
    let joints = rig.joints(&motions);
    let of = |name: &str, score: &dyn Fn(Vec3, Vec3) -> f32| -> Option<u32> {
        let bone = rig.bones().iter().position(|bone| bone.name == name)?;
        let own = (0..reference.len() as u32).filter(|&v| rig.bone_of(v) == bone);
        own.reduce(|best, v| {
            let at = |v: u32| score(reference[v as usize], joints[bone]);
            if at(v) > at(best) { v } else { best }
        })
    };
    let far = |point: Vec3, joint: Vec3| point.distance(joint);
    let high = |point: Vec3, _: Vec3| point.y;
    let belly = of(&rig.bones()[0].name, &|point, joint| -point.distance(joint));
    let ends = ["forearm_l", "forearm_r", "foot_l", "foot_r"].map(|name| of(name, &far));
    let all: Option<Vec<u32>> = [belly, of("head", &high)].into_iter().chain(ends).collect();
    all.filter(|all| all.len() == PATCHES)
}
