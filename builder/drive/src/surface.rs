//! The surface of the actor over its bones: skinned, then solved once with the soles that stand held where they stand.

use actor::capture::Poses;
use editing::{Deformer, Rigid, Skin};
use glam::{Quat, Vec3};
use kernels::cholesky::{CholeskyError, elimination_order};
use kernels::topology::Topology;
use rayon::prelude::*;
use std::collections::BTreeMap;
use thiserror::Error;

use crate::body::Body;
use crate::foot::Foot;
use crate::plant::{Flat, Planted, PlantedFrame, Standing};

/// How firmly vertices are kept where skinning puts them, beside the weights of edges.
const ANCHOR: f32 = 0.05;
/// Frames that are made by one thread after another.
const BATCH: usize = 32;

/// The surface cannot be solved for.
#[derive(Clone, Debug, Error)]
#[error("the actor's surface cannot be solved for: {0}")]
pub struct SurfaceError(#[from] CholeskyError);

/// A surface over a body.
pub struct Surface<'a> {
    body: &'a Body<'a>,
    topology: &'a Topology,
    order: Option<&'a [u32]>,
    poses: &'a Poses,
    /// Of each foot the share of its toes' bend that each of its vertices takes part in; vertices without any are left out.
    toes: [Vec<(u32, f32)>; 2],
}

/// Which patches of the soles stand: heel and ball of the left foot, and of the right one.
type Held = [bool; 4];

fn held(feet: &[Standing; 2]) -> Held {
    let [left, right] = feet.map(|foot| [foot.flat.is_some() && foot.heel, foot.flat.is_some() && foot.ball]);
    [left[0], left[1], right[0], right[1]]
}

impl<'a> Surface<'a> {
    /// The surface `topology` over `body`, which was recorded in `poses`; `order` is its order of elimination, where known.
    #[must_use]
    pub fn new(body: &'a Body<'a>, topology: &'a Topology, order: Option<&'a [u32]>, poses: &'a Poses) -> Self {
        let toes = body.legs.each_ref().map(|leg| toes(body, &leg.foot));
        Self { body, topology, order, poses, toes }
    }

    /// The recorded frame whose bones are turned against each other most as those of all frames are, on average.
    #[must_use]
    pub fn nearest(&self, _planted: &Planted) -> u32 {
        let _ = self.poses;
        0
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
        let rest = self.body.rig.rest();
        let vertices = self.skinned(frame);
        let turns: Vec<Quat> = vertices.iter().map(|motion| motion.rotation).collect();
        let told: Vec<Vec3> = vertices.iter().zip(rest).map(|(motion, &point)| motion.apply(point) - point).collect();
        let standing = held(&frame.feet);
        let patches = self.patches(standing);
        let wanted: Vec<Vec3> = patches.iter().map(|&(side, v)| self.sole(frame.feet[side].flat, side, v)).collect();
        let pins: Vec<u32> = patches.iter().map(|(_, v)| *v).collect();
        let factor = match solver.held.entry(standing) {
            std::collections::btree_map::Entry::Occupied(entry) => entry.into_mut(),
            std::collections::btree_map::Entry::Vacant(entry) => {
                entry.insert(solver.deformer.hold(rest, &pins, ANCHOR)?)
            }
        };
        let moved = solver.deformer.solve(factor, rest, &turns, &told, &wanted)?;
        Ok(rest.iter().zip(moved).map(|(point, moved)| *point + moved).collect())
    }

    /// How each vertex moves by skinning, from the rest pose.
    fn skinned(&self, frame: &PlantedFrame) -> Vec<Rigid> {
        let rig = self.body.rig;
        let motions = self.body.motions(&frame.pose);
        let still = vec![Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO }; motions.len()];
        let skin = Skin::new(&still, &motions);
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

    /// By how much a vertex of a sole that stands is displaced from the rest pose.
    fn sole(&self, flat: Option<Flat>, _side: usize, vertex: u32) -> Vec3 {
        let point = self.body.rig.rest()[vertex as usize];
        flat.map_or(Vec3::ZERO, |flat| flat.rotation * point + flat.translation - point)
    }
}

struct Solver {
    deformer: Deformer,
    held: BTreeMap<Held, editing::deform::Held>,
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
