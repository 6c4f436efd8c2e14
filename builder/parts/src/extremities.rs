//! Where a body ends: hills of the distance from its middle, along the surface.

use actor::capture::Poses;
use geometry::geodesic::SurfaceGraph;
use kernels::topology::Topology;

use crate::measured::{MEASURED, Measured, spread};

/// A hill that stands out by less than this is none, relative to the body's size: 16 cm of 1.8 m.
const STANDS_OUT: f32 = 0.09;
/// Extremities at most: what has more is no body.
const MOST: usize = 12;
/// Places from which the middle is found.
const PLACES: usize = 40;
/// The core is what is nearer to the middle than this share of the way to the nearest pass.
const CORE: f32 = 0.8;
/// Its radius is at least this much of the body's size: 18 cm of 1.8 m.
const LEAST_CORE: f32 = 0.1;

/// An extremity that is a limb's.
pub struct Extremity {
    /// The vertex at its end.
    pub tip: u32,
    /// Distance of each vertex from it, in metres.
    pub distances: Vec<f32>,
    /// How far its tip is from the middle.
    pub reach: f32,
    /// How far the nearest pass to another hill is: about where the limb begins.
    pub pass: f32,
    /// Half of the way to the nearest tip of another limb: one that went on from here would be another limb's, too.
    pub stop: f32,
}

/// All extremities of a body.
pub struct Extremities {
    pub limbs: Vec<Extremity>,
    /// The end of the head.
    pub head: Option<u32>,
    /// Vertices about the middle.
    pub core: Vec<u32>,
}

/// The extremities, farthest first; `None` where there are no limbs.
pub fn extremities(graph: &SurfaceGraph, topology: &Topology, poses: &Poses, body: &Measured) -> Option<Extremities> {
    let middle = middle(graph, topology, &body.areas)?;
    let heights = graph.distances(&[middle], f32::INFINITY);
    let peaks: Vec<_> =
        graph.peaks(&heights).into_iter().filter(|peak| peak.persistence > STANDS_OUT * body.size).take(MOST).collect();
    // One hill is a body with a tail end: nothing turns about anything.
    if peaks.len() < 2 {
        return None;
    }
    let tips: Vec<u32> = peaks.iter().map(|peak| peak.top).collect();
    let passes: Vec<u32> = peaks.iter().filter_map(|peak| peak.pass).collect();
    let head = highest(&tips, poses).filter(|_| tips.len() > 2);
    // A limb may come near the head, which is the torso's.
    let others: Vec<u32> = tips.iter().copied().filter(|tip| Some(*tip) != head).collect();
    let limb = |&tip: &u32| {
        let distances = graph.distances(&[tip], f32::INFINITY);
        let nearest = |vertices: &[u32]| {
            vertices.iter().filter(|&&v| v != tip).map(|&v| distances[v as usize]).fold(f32::INFINITY, f32::min)
        };
        let (pass, stop) = (nearest(&passes), 0.5 * nearest(&others));
        Extremity { tip, reach: heights[tip as usize], pass, stop, distances }
    };
    let limbs = tips.iter().filter(|tip| Some(**tip) != head).map(limb).collect();
    let nearest = passes.iter().map(|&pass| heights[pass as usize]).fold(f32::INFINITY, f32::min);
    let radius = (CORE * nearest).max(LEAST_CORE * body.size);
    let core = (0..heights.len() as u32).filter(|&v| heights[v as usize] < radius).collect();
    Some(Extremities { limbs, head, core })
}

/// The vertex of the largest component from which the others are nearest on average, by their areas.
fn middle(graph: &SurfaceGraph, topology: &Topology, areas: &[f32]) -> Option<u32> {
    let component = topology.component_of_vertex();
    let mut sizes = vec![0.0; topology.component_count()];
    component.iter().zip(areas).for_each(|(&component, area)| sizes[component as usize] += area);
    let largest = (0..sizes.len()).max_by(|&a, &b| f32::total_cmp(&sizes[a], &sizes[b]).then(b.cmp(&a)))?;
    let own = |vertex: &u32| component[*vertex as usize] as usize == largest;
    let vertices: Vec<u32> = (0..areas.len() as u32).filter(own).collect();
    // Places far from each other, each standing for what is nearest to it.
    let mut nearest = vec![f32::INFINITY; areas.len()];
    let mut owner = vec![0; areas.len()];
    let mut ways: Vec<Vec<f32>> = Vec::new();
    let mut next = *vertices.first()?;
    for place in 0..PLACES.min(vertices.len()) {
        let distances = graph.distances(&[next], f32::INFINITY);
        for &vertex in &vertices {
            let v = vertex as usize;
            if distances[v] < nearest[v] {
                (nearest[v], owner[v]) = (distances[v], place);
            }
        }
        ways.push(distances);
        next = *vertices.iter().max_by(|&&a, &&b| nearest[a as usize].total_cmp(&nearest[b as usize]))?;
    }
    let mut shares = vec![0.0; ways.len()];
    vertices.iter().for_each(|&vertex| shares[owner[vertex as usize]] += areas[vertex as usize]);
    let far = |vertex: u32| ways.iter().zip(&shares).map(|(way, share)| way[vertex as usize] * share).sum::<f32>();
    vertices.into_iter().map(|vertex| (far(vertex), vertex)).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, v)| v)
}

/// The tip that is highest on average.
fn highest(tips: &[u32], poses: &Poses) -> Option<u32> {
    let frames = spread(poses.len(), 10 * MEASURED);
    let height = |tip: u32| frames.iter().map(|&frame| poses.frame(frame)[tip as usize].y).sum::<f32>();
    tips.iter().copied().max_by(|&a, &b| height(a).total_cmp(&height(b)))
}
