//! The surface of the actor over its bones: skinned, then solved once with the soles that stand held where they stand.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use editing::{Deformer, Rigid, Skin};
use glam::{Quat, Vec3};
use kernels::cholesky::{CholeskyError, elimination_order};
use kernels::topology::Topology;
use rayon::prelude::*;
use thiserror::Error;

use crate::body::Body;
use crate::foot::Foot;
use crate::plant::{Flat, Planted, PlantedFrame, Standing};

/// How firmly vertices are kept where skinning puts them, beside the weights of edges.
const ANCHOR: f32 = 0.05;
/// Frames that are made by one thread after another.
const BATCH: usize = 32;
/// What comes nearer to the floor than this is laid onto it, in metres.
const LAID: f32 = 0.03;

/// The surface cannot be solved for.
#[derive(Clone, Debug, Error)]
#[error("the actor's surface cannot be solved for: {0}")]
pub struct SurfaceError(#[from] CholeskyError);

/// A surface over a body.
pub struct Surface<'a> {
    body: &'a Body<'a>,
    topology: &'a Topology,
    order: Option<&'a [u32]>,
    /// Of each foot the share of its toes' bend that each of its vertices takes part in; vertices without any are left out.
    toes: [Vec<(u32, f32)>; 2],
    /// Vertices that belong to feet and shins: what is planted.
    is_low: Vec<bool>,
}

/// Which patches of the soles stand: heel and ball of the left foot, and of the right one.
type Held = [bool; 4];

fn held(feet: &[Standing; 2]) -> Held {
    let [left, right] = feet.map(|foot| [foot.flat.is_some() && foot.heel, foot.flat.is_some() && foot.ball]);
    [left[0], left[1], right[0], right[1]]
}

impl<'a> Surface<'a> {
    /// The surface `topology` over `body`; `order` is its order of elimination, where known.
    #[must_use]
    pub fn new(body: &'a Body<'a>, topology: &'a Topology, order: Option<&'a [u32]>) -> Self {
        let toes = body.legs.each_ref().map(|leg| toes(body, &leg.foot));
        let is_low = is_foot(body);
        Self { body, topology, order, toes, is_low }
    }

    /// Vertex positions of all frames in metres. The number of threads changes nothing.
    ///
    /// # Errors
    /// A surface that cannot be solved for.
    pub fn deform(&self, planted: &Planted) -> Result<Vec<Vec<Vec3>>, SurfaceError> {
        let found;
        let order = match self.order {
            Some(order) => Some(order),
            None => {
                found = elimination_order(self.topology);
                Some(found.as_slice())
            }
        };
        let batches: Vec<_> = planted
            .frames
            .par_chunks(BATCH)
            .map(|frames| {
                let mut solver = Solver { deformer: Deformer::new(self.topology, order)?, held: BTreeMap::new() };
                frames.iter().map(|frame| self.frame(frame, &mut solver)).collect::<Result<Vec<_>, SurfaceError>>()
            })
            .collect::<Result<_, _>>()?;
        Ok(batches.into_iter().flatten().collect())
    }

    fn frame(&self, frame: &PlantedFrame, solver: &mut Solver) -> Result<Vec<Vec3>, SurfaceError> {
        let motions = self.body.motions(&frame.pose);
        let vertices = self.skinned(frame, &motions);
        let base = self.body.rig.rest();
        let turns: Vec<Quat> = vertices.iter().map(|motion| motion.rotation).collect();
        let told: Vec<Vec3> = vertices.iter().zip(base).map(|(motion, &point)| motion.apply(point) - point).collect();
        let standing = held(&frame.feet);
        let patches = self.patches(standing);
        let wanted: Vec<Vec3> =
            patches.iter().map(|&(side, v)| self.sole(frame.feet[side].flat, v) - base[v as usize]).collect();
        let pins: Vec<u32> = patches.iter().map(|(_, v)| *v).collect();
        let factor = match solver.held.entry(standing) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => entry.insert(solver.deformer.hold(base, &pins, ANCHOR)?),
        };
        let moved = solver.deformer.solve(factor, base, &turns, &told, &wanted)?;
        let mut pose: Vec<Vec3> = base.iter().zip(moved).map(|(point, moved)| *point + moved).collect();
        self.lift(&mut pose);
        Ok(pose)
    }

    /// Lifts what would lie below the floor onto it: cloth as if it were laid down, feet as they are.
    fn lift(&self, pose: &mut [Vec3]) {
        for (point, &is_low) in pose.iter_mut().zip(&self.is_low) {
            let height = point.y - self.body.floor;
            if is_low {
                point.y = point.y.max(self.body.floor);
            } else if height < LAID {
                point.y = self.body.floor + LAID * ((height - LAID) / LAID).exp();
            }
        }
    }

    /// How each vertex moves by skinning, from the rest pose.
    fn skinned(&self, frame: &PlantedFrame, motions: &[Rigid]) -> Vec<Rigid> {
        let rig = self.body.rig;
        let still = vec![Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO }; motions.len()];
        let skin = Skin::new(&still, motions);
        let mut vertices: Vec<Rigid> = rig.influences().iter().map(|own| skin.motion(own)).collect();
        for (side, leg) in self.body.legs.iter().enumerate() {
            let bend = frame.feet[side].bend;
            if bend > 0.0 {
                for &(vertex, share) in &self.toes[side] {
                    let lifted = leg.foot.lifted(bend * share);
                    vertices[vertex as usize] = vertices[vertex as usize].after(&lifted);
                }
            }
        }
        vertices
    }

    /// The soles' vertices that are held, with their foot.
    fn patches(&self, held: Held) -> Vec<(usize, u32)> {
        let mut patches = Vec::new();
        for (side, leg) in self.body.legs.iter().enumerate() {
            let foot = &leg.foot;
            let [heel, ball] = [held[2 * side], held[2 * side + 1]];
            let mut add = |patch: &[u32]| patches.extend(patch.iter().map(|&v| (side, v)));
            if heel {
                add(&foot.heel_patch);
            }
            if heel && ball {
                add(&foot.arch);
            }
            if ball {
                add(&foot.fore_patch);
            }
        }
        patches
    }

    /// Where a vertex of a sole that stands is.
    fn sole(&self, flat: Option<Flat>, vertex: u32) -> Vec3 {
        let point = self.body.rig.rest()[vertex as usize];
        flat.map_or(point, |flat| flat.rotation * point + flat.translation)
    }
}

struct Solver {
    deformer: Deformer,
    held: BTreeMap<Held, editing::deform::Held>,
}

/// Whether each vertex belongs to a foot or a shin.
fn is_foot(body: &Body) -> Vec<bool> {
    let bones: Vec<usize> = body.legs.iter().flat_map(|leg| [leg.foot.bone, leg.bones.bones[1]]).collect();
    (0..body.rig.rest().len() as u32).map(|v| bones.contains(&body.rig.bone_of(v))).collect()
}

/// Vertices of a foot in front of its ball, with their share of its toes' bend.
fn toes(body: &Body, foot: &Foot) -> Vec<(u32, f32)> {
    let rig = body.rig;
    let share = |v: usize| {
        let own = &rig.influences()[v];
        let of_foot = own.joints.iter().zip(&own.weights).filter(|(joint, _)| **joint as usize == foot.bone);
        of_foot.map(|(_, weight)| weight).sum::<f32>() * foot.toe_share(rig.rest()[v])
    };
    (0..rig.rest().len()).map(|v| (v as u32, share(v))).filter(|(_, share)| *share > 1e-3).collect()
}
