//! Finds the [`Feet`] of a capture: which parts that stand are one foot, when each of them stands, and how far the surface
//! around follows it.
//!
//! Distances are those of shortest ways along the edges of a few poses; components that touch are joined by ties, so that a
//! shoe of its own has a leg. What is within an ankle's distance of the sole goes with it as a whole; the rest follows less and less
//! up to the hip. Bodies differ in size, so all of this is relative to the body's height.

use actor::capture::Poses;
use actor::feet::{Feet, FootVertex, MOST_FEET};
use actor::timeline::Timeline;
use geometry::geodesic::SurfaceGraph;
use glam::Vec3;
use kernels::topology::Topology;
use rayon::prelude::*;

use crate::contacts::{Floor, Standing, fall};

/// Parts nearer than this along the surface are one foot: 22 cm of 1.8 m.
const ONE_FOOT: f32 = 0.12;
/// Up to here all is put down with the sole, from there on less, and nothing above: 4 and 14 cm of 1.8 m.
const SOLE: [f32; 2] = [0.02, 0.08];
/// Up to here all goes with the foot, from there on less, and nothing above: 14 and 75 cm of 1.8 m.
const LEG: [f32; 2] = [0.08, 0.42];
/// Components nearer than this are tied together: 5 cm of 1.8 m.
const TIED: f32 = 0.03;
/// Poses that distances are taken from, spread over the capture.
const POSES: u32 = 5;
/// A foot stands where this share of its vertices rests, of those that rest in its firmest frames.
const STANDS: f32 = 0.15;

/// The feet of a capture, those that stand most first.
#[must_use]
pub fn feet(topology: &Topology, timeline: &Timeline, poses: &Poses) -> Feet {
    let Standing { floor, parts } = Standing::of(topology, timeline, poses);
    let surface = edges(topology, poses, TIED * floor.body);
    let far = LEG[1] * floor.body;
    let mut soles: Vec<(Vec<u32>, Vec<f32>)> = Vec::new();
    for part in parts {
        let from = surface.distances(&part, far);
        let near = |(sole, _): &&mut (Vec<u32>, Vec<f32>)| {
            sole.iter().any(|&vertex| from[vertex as usize] < ONE_FOOT * floor.body)
        };
        if let Some((sole, distances)) = soles.iter_mut().find(near) {
            sole.extend(part);
            distances.iter_mut().zip(from).for_each(|(own, other)| *own = own.min(other));
        } else if soles.len() < MOST_FEET {
            soles.push((part, from));
        }
    }
    let stands: Vec<Vec<bool>> = soles.par_iter().map(|(sole, _)| stands(sole, timeline, poses, &floor)).collect();
    let frames = 0..timeline.frame_count() as usize;
    let stands = frames.flat_map(|frame| stands.iter().map(move |foot| foot[frame])).collect();
    let distances: Vec<Vec<f32>> = soles.into_iter().map(|(_, distances)| distances).collect();
    Feet::new(shares(&distances, floor.body), stands, topology.vertex_count(), timeline).unwrap_or_default()
}

/// How far each vertex follows each foot, by its distance from the sole.
fn shares(distances: &[Vec<f32>], body: f32) -> Vec<Vec<FootVertex>> {
    let share = |distance: f32, [from, to]: [f32; 2]| fall(distance / body, from, to);
    let sum = |vertex: usize| distances.iter().map(|foot| share(foot[vertex], LEG)).sum::<f32>().max(1.0);
    let rounded = |share: f32| (share * 255.0).round() as u8;
    let foot = |foot: &Vec<f32>| {
        let vertices = (0_u32..).zip(foot).map(|(vertex, &distance)| FootVertex {
            vertex,
            leg: rounded(share(distance, LEG) / sum(vertex as usize)),
            sole: rounded(share(distance, SOLE) / sum(vertex as usize)),
        });
        vertices.filter(|vertex| vertex.leg > 0).collect()
    };
    distances.iter().map(foot).collect()
}

/// Whether a foot stands, frame by frame: enough of it rests before or after the frame.
fn stands(sole: &[u32], timeline: &Timeline, poses: &Poses, floor: &Floor) -> Vec<bool> {
    let mut all = Vec::with_capacity(timeline.frame_count() as usize);
    let mut resting: Vec<Vec<usize>> = Vec::new();
    for (index, sequence) in timeline.sequences().iter().enumerate() {
        let count = |frame: u32| {
            let (before, after) = (poses.frame(frame), poses.frame(frame + 1));
            sole.iter().filter(|&&v| floor.rests(index, before[v as usize], after[v as usize])).count()
        };
        resting.push((sequence.first_frame..sequence.end_frame().saturating_sub(1)).map(count).collect());
    }
    let mut counts: Vec<usize> = resting.iter().flatten().copied().filter(|&count| count > 0).collect();
    counts.sort_unstable();
    let most = counts.get(counts.len() * 9 / 10).copied().unwrap_or(0);
    let enough = ((STANDS * most as f32).ceil() as usize).max(1);
    for (sequence, resting) in timeline.sequences().iter().zip(&resting) {
        let rests = |interval: Option<usize>| interval.and_then(|at| resting.get(at)).is_some_and(|&n| n >= enough);
        let frames = 0..sequence.frame_count as usize;
        all.extend(frames.map(|frame| rests(Some(frame)) || rests(frame.checked_sub(1))));
    }
    all
}

/// The edges of a surface with their lengths in the poses in which they are longest, ties between its components included.
fn edges(topology: &Topology, poses: &Poses, tied: f32) -> SurfaceGraph {
    let count = (poses.len() as u32).clamp(1, POSES);
    let chosen: Vec<&[Vec3]> = (0..count)
        .map(|index| poses.frame(index * (poses.len() as u32 - 1) / count.max(2).saturating_sub(1)))
        .collect();
    let far = |a: u32, b: u32| {
        let apart = |pose: &&[Vec3]| pose[a as usize].distance(pose[b as usize]);
        chosen.iter().map(apart).fold(0.0, f32::max)
    };
    let ties = ties(topology, &far, tied);
    SurfaceGraph::new(topology.vertex_count(), topology.triangles(), &ties, far)
}

/// For each vertex the nearest one of another component, where that is near in all poses.
fn ties(topology: &Topology, far: &(impl Fn(u32, u32) -> f32 + Sync), tied: f32) -> Vec<[u32; 2]> {
    if topology.component_count() < 2 {
        return Vec::new();
    }
    let component = topology.component_of_vertex();
    let count = topology.vertex_count() as u32;
    let nearest = |vertex: u32| {
        let others = (0..count).filter(|&other| component[other as usize] != component[vertex as usize]);
        let nearest = others.map(|other| (far(vertex, other), other)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        (nearest.0 < tied).then_some([vertex.min(nearest.1), vertex.max(nearest.1)])
    };
    let mut ties: Vec<[u32; 2]> = (0..count).into_par_iter().filter_map(nearest).collect();
    ties.sort_unstable();
    ties.dedup();
    ties
}
