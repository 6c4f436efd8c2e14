//! The surface of the actor over its bones: skinned, then solved once with the soles that stand held where they stand.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use editing::{Deformer, Rigid, Skin};
use glam::{Quat, Vec3};
use kernels::cholesky::CholeskyError;
use kernels::scalar::exp;
use kernels::topology::Topology;
use thiserror::Error;

use crate::body::Body;
use crate::foot::Foot;
use crate::plant::{Flat, PlantedFrame, Standing};

/// Within so many metres the surface is smoothed by its turned edges; what is larger stays where skinning has it, which keeps the volume
/// of what bends. Edges alone lose it: their turns fit together nowhere that a joint folds. Chosen by squats (`docs/results`).
const SMOOTHED: f32 = 0.04;
/// What comes nearer to the floor than this is laid onto it, in metres.
const LAID: f32 = 0.03;

/// The surface cannot be solved for.
#[derive(Clone, Debug, Error)]
#[error("the actor's surface cannot be solved for: {0}")]
pub struct SurfaceError(#[from] CholeskyError);

/// A surface over a body.
pub struct Surface {
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

impl Surface {
    /// The surface over `body`.
    #[must_use]
    pub fn new(body: &Body) -> Self {
        Self { toes: body.legs.each_ref().map(|leg| toes(body, &leg.foot)), is_low: is_foot(body) }
    }

    /// Vertex positions of a frame of `body`, in metres. Which frames `solver` has solved before changes nothing.
    ///
    /// # Errors
    /// A surface that cannot be solved for.
    pub fn frame(&self, body: &Body, frame: &PlantedFrame, solver: &mut Solver) -> Result<Vec<Vec3>, SurfaceError> {
        let motions = body.motions(&frame.pose);
        let vertices = self.skinned(body, frame, &motions);
        let base = body.rig.rest();
        let turns: Vec<Quat> = vertices.iter().map(|motion| motion.rotation).collect();
        let told: Vec<Vec3> = vertices.iter().zip(base).map(|(motion, &point)| motion.apply(point) - point).collect();
        let standing = held(&frame.feet);
        let patches = patches(body, standing);
        let wanted: Vec<Vec3> =
            patches.iter().map(|&(side, v)| sole(frame.feet[side].flat, base[v as usize]) - base[v as usize]).collect();
        let pins: Vec<u32> = patches.iter().map(|(_, v)| *v).collect();
        let factor = match solver.held.entry(standing) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                let anchor = anchor(solver.deformer.edges(), base);
                entry.insert(solver.deformer.hold(base, &pins, anchor)?)
            }
        };
        let moved = solver.deformer.solve(factor, base, &turns, &told, &wanted)?;
        let mut pose: Vec<Vec3> = base.iter().zip(moved).map(|(point, moved)| *point + moved).collect();
        self.lift(body.floor, &mut pose);
        Ok(pose)
    }

    /// Lifts what would lie below the floor onto it: cloth as if it were laid down, feet as they are.
    fn lift(&self, floor: f32, pose: &mut [Vec3]) {
        for (point, &is_low) in pose.iter_mut().zip(&self.is_low) {
            let height = point.y - floor;
            if is_low {
                point.y = point.y.max(floor);
            } else if height < LAID {
                point.y = floor + LAID * exp(((height - LAID) / LAID).max(-80.0));
            }
        }
    }

    /// How each vertex moves by skinning, from the rest pose.
    fn skinned(&self, body: &Body, frame: &PlantedFrame, motions: &[Rigid]) -> Vec<Rigid> {
        let rig = &body.rig;
        let still = vec![Rigid { rotation: Quat::IDENTITY, translation: Vec3::ZERO }; motions.len()];
        let skin = Skin::new(&still, motions);
        let mut vertices: Vec<Rigid> = rig.influences().iter().map(|own| skin.motion(own)).collect();
        for (side, leg) in body.legs.iter().enumerate() {
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
}

/// How firmly vertices are kept where skinning puts them, beside the weights of edges, which do not know how long these are: so firmly
/// that a mesh is smoothed within [`SMOOTHED`] however fine it is.
fn anchor(edges: &[[u32; 2]], pose: &[Vec3]) -> f32 {
    let squares = edges.iter().map(|edge| {
        let [a, b] = edge.map(|v| pose[v as usize]);
        a.distance_squared(b)
    });
    let mean = squares.sum::<f32>() / edges.len().max(1) as f32;
    (mean / (SMOOTHED * SMOOTHED)).clamp(0.01, 10.0)
}

/// The soles' vertices that are held, with their foot.
fn patches(body: &Body, held: Held) -> Vec<(usize, u32)> {
    let mut patches = Vec::new();
    for (side, leg) in body.legs.iter().enumerate() {
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

/// Where a point of a sole that stands is.
fn sole(flat: Option<Flat>, point: Vec3) -> Vec3 {
    flat.map_or(point, |flat| flat.rotation * point + flat.translation)
}

/// Solves for surfaces over one mesh; keeps what it has found for soles that stand alike.
pub struct Solver {
    deformer: Deformer,
    held: BTreeMap<Held, editing::deform::Held>,
}

impl Solver {
    /// For the mesh `topology`; `order` is its order of elimination, where known.
    ///
    /// # Errors
    /// A mesh too large to factorise.
    pub fn new(topology: &Topology, order: Option<&[u32]>) -> Result<Self, SurfaceError> {
        Ok(Self { deformer: Deformer::new(topology, order)?, held: BTreeMap::new() })
    }
}

/// Whether each vertex belongs to a foot or a shin.
fn is_foot(body: &Body) -> Vec<bool> {
    let bones: Vec<usize> = body.legs.iter().flat_map(|leg| [leg.foot.bone, leg.bones.bones[1]]).collect();
    (0..body.rig.rest().len() as u32).map(|v| bones.contains(&body.rig.bone_of(v))).collect()
}

/// Vertices of a foot in front of its ball, with their share of its toes' bend.
fn toes(body: &Body, foot: &Foot) -> Vec<(u32, f32)> {
    let rig = &body.rig;
    let share = |v: usize| {
        let own = &rig.influences()[v];
        let of_foot = own.joints.iter().zip(&own.weights).filter(|(joint, _)| **joint as usize == foot.bone);
        of_foot.map(|(_, weight)| weight).sum::<f32>() * foot.toe_share(rig.rest()[v])
    };
    (0..rig.rest().len()).map(|v| (v as u32, share(v))).filter(|(_, share)| *share > 1e-3).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finer_meshes_are_held_less_firmly_a_vertex() {
        let line = |count: u32| {
            let pose: Vec<Vec3> = (0..count).map(|k| Vec3::X * (k as f32 / (count - 1) as f32)).collect();
            let edges: Vec<[u32; 2]> = (1..count).map(|k| [k - 1, k]).collect();
            anchor(&edges, &pose)
        };
        let (coarse, fine) = (line(26), line(51));
        assert!((coarse - 1.0).abs() < 1e-3, "edges as long as what is smoothed: {coarse}");
        assert!((coarse / fine - 4.0).abs() < 1e-3, "four times as many vertices share it: {fine}");
        assert!(anchor(&[], &[]) > 0.0);
    }
}
