//! Puts the feet of a blended frame where they stand.
//!
//! Not in the papers. The whole foot goes where it is wanted, and what is around it follows by as much as it is said to follow
//! ([`actor::feet`]): a field that was found once, so that nothing is solved here. Work and memory are those
//! of the vertices of the legs, and a pass over all that leans ([`crate::lean`]).

use actor::blend::Blend;
use actor::feet::{Feet, FootVertex};
use glam::Vec3;
use kernels::align::Placement;

use crate::lean::{lean, share};
use crate::steps::FootStep;

/// A foot that goes far is lifted by this much of its own size: by 5 cm or so.
const LIFT: f32 = 0.57;
/// One that goes as far as this much of its own size is lifted by half of that.
const HALF: f32 = 0.14;
/// One that bears the body goes so many times as far for that.
const BEARS: f32 = 10.0;

/// Where the sides of a blend are.
pub(crate) struct Sides<'a> {
    /// Both poses, placed for the blend.
    pub placed: &'a [Vec<Vec3>; 2],
    /// From there to where each side is played alone: the source from where it left, the destination to where it arrives.
    pub alone: [Placement; 2],
}

/// From where the sides of a node are placed to where each of them is alone; `last` takes the destination, its first frame
/// standing as it was recorded, to where it stands after the transition.
pub(crate) fn alone(blend: &Blend, last: &Placement) -> [Placement; 2] {
    let destination = last.after(&blend.alone[1]);
    [blend.alone[0].after(&blend.placements[0].inverse()), destination.after(&blend.placements[1].inverse())]
}

/// Moves the feet of `pose`, a blend of `sides` at `node`, to where their steps have them, and the body so that its centre of
/// mass by `weights`, which have a sum of 1, stays above where it was.
pub(crate) fn keep(
    feet: &Feet,
    steps: &[Option<FootStep>],
    node: usize,
    sides: &Sides,
    weights: &[f32],
    pose: &mut [Vec3],
) {
    let blended: Vec<Option<Moved>> = (0..feet.count())
        .map(|foot| Some(Moved::of(feet.vertices(foot), steps.get(foot).copied()??, node, sides, pose)))
        .collect();
    // All feet are looked at before the first is moved: where two meet, their order must not count.
    let mut carried = Vec3::ZERO;
    for (foot, moved) in blended.into_iter().enumerate() {
        if let Some(moved) = moved {
            carried += moved.apply(feet.vertices(foot), weights, pose);
        }
    }
    lean(feet, carried, weights, pose);
}

/// How a foot moves.
struct Moved {
    /// The whole foot.
    by: Vec3,
    /// Its vertices besides.
    besides: Vec<Vec3>,
}

impl Moved {
    fn of(vertices: &[FootVertex], step: FootStep, node: usize, sides: &Sides, pose: &[Vec3]) -> Self {
        let weight = step.weight(node);
        let at = |side: usize, vertex: &FootVertex| {
            let points = &sides.placed[side];
            sides.alone[side].apply(points[vertex.vertex as usize])
        };
        let here = |vertex: &FootVertex| pose[vertex.vertex as usize];
        let middle = mean(vertices, here);
        let [source, destination] = [0, 1].map(|side| mean(vertices, |vertex| at(side, vertex)));
        // Halfway both sides may have turned far from each other: there the blend's own shape counts.
        let (before, after) = ((1.0 - weight) * (1.0 - weight), weight * weight);
        let besides = |vertex: &FootVertex| {
            let own = here(vertex) - middle;
            let apart = (at(0, vertex) - source - own) * before + (at(1, vertex) - destination - own) * after;
            apart * share(vertex.sole)
        };
        let besides: Vec<Vec3> = vertices.iter().map(besides).collect();
        let mut by = source.lerp(destination, weight) - middle;
        let lowest = |of: &dyn Fn(usize, &FootVertex) -> f32| {
            let soles = vertices.iter().enumerate().filter(|(_, vertex)| vertex.sole > 0);
            soles.map(|(index, vertex)| of(index, vertex)).fold(f32::INFINITY, f32::min)
        };
        let [low, high] = [0, 1].map(|side| lowest(&|_, vertex| at(side, vertex).y));
        let is = lowest(&|index, vertex| here(vertex).y + by.y + besides[index].y);
        // No lower than both sides are.
        let between = low + (high - low) * weight;
        by.y += (between - is).max(0.0);
        // What is in the air on one side is on its way already.
        let clear = between - low.min(high);
        let goes = |vertex: &FootVertex| (at(1, vertex) - at(0, vertex)).with_y(0.0).length_squared();
        let way = mean(vertices, |vertex| Vec3::splat(goes(vertex))).x.sqrt();
        by.y += (lift(step, node, way, size(vertices, middle, here)) - clear).max(0.0);
        Self { by, besides }
    }

    /// Moves it. Returns how far that carries the centre of mass.
    fn apply(&self, vertices: &[FootVertex], weights: &[f32], pose: &mut [Vec3]) -> Vec3 {
        let mut carried = Vec3::ZERO;
        for (vertex, &besides) in vertices.iter().zip(&self.besides) {
            let (index, by) = (vertex.vertex as usize, self.by * share(vertex.leg) + besides);
            pose[index] += by;
            carried += by * weights[index];
        }
        carried
    }
}

/// How far a foot is lifted that stands while it is moved by `way` metres.
fn lift(step: FootStep, node: usize, way: f32, size: f32) -> f32 {
    let progress = step.progress(node);
    let arc = 4.0 * progress * (1.0 - progress);
    // A foot that hardly goes anywhere is hardly lifted, least of all the one that bears the body: that would be a hop.
    let half = HALF * size * (1.0 + (BEARS - 1.0) * step.alone);
    let [way, half] = [way, half].map(|way| way * way.sqrt());
    arc * arc.sqrt() * step.lifted() * LIFT * size * way / (way + half).max(f32::MIN_POSITIVE)
}

/// The mean of a foot's vertices.
fn mean(vertices: &[FootVertex], of: impl Fn(&FootVertex) -> Vec3) -> Vec3 {
    let (mut sum, mut weight) = (Vec3::ZERO, 0.0);
    for vertex in vertices.iter().filter(|vertex| vertex.sole > 0) {
        sum += of(vertex) * f32::from(vertex.sole);
        weight += f32::from(vertex.sole);
    }
    sum / weight
}

/// The root mean square distance of a foot's vertices from their mean.
fn size(vertices: &[FootVertex], middle: Vec3, of: impl Fn(&FootVertex) -> Vec3) -> f32 {
    mean(vertices, |vertex| Vec3::splat((of(vertex) - middle).length_squared())).x.sqrt()
}
