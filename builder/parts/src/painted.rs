//! Parts that were painted: a number for each vertex. Where two meet, they overlap in a band.

use geometry::geodesic::SurfaceGraph;
use kernels::topology::Topology;

use crate::band::{Limb, half_band, smooth_step};
use crate::measured::Measured;
use crate::shape::Shape;

/// Parts as they were painted.
pub struct Painted {
    /// All but the first part.
    pub limbs: Vec<Limb>,
    /// How far each vertex is the first part's.
    pub torso: Vec<f32>,
    /// The numbers, that of the first part first.
    pub numbers: Vec<u8>,
}

/// The parts of these numbers; `None` where there is not one for each vertex.
pub fn painted(graph: &SurfaceGraph, topology: &Topology, body: &Measured, of_vertex: &[u8]) -> Option<Painted> {
    let mut numbers = of_vertex.to_vec();
    numbers.sort_unstable();
    numbers.dedup();
    if of_vertex.len() != topology.vertex_count() || numbers.is_empty() {
        return None;
    }
    let half = half_band(body);
    let depths: Vec<Vec<f32>> = numbers.iter().map(|&number| depths(graph, of_vertex, number, body.edge)).collect();
    let mut weights: Vec<Vec<f32>> =
        depths.iter().map(|depths| depths.iter().map(|&depth| smooth_step(depth, half)).collect()).collect();
    for vertex in 0..of_vertex.len() {
        // Of two parts weights add up to 1 already; not so where three meet.
        let sum: f32 = weights.iter().map(|own| own[vertex]).sum();
        weights.iter_mut().for_each(|own| own[vertex] /= sum.max(f32::MIN_POSITIVE));
    }
    let mut weights = weights.into_iter();
    let torso = weights.next()?;
    let limb = |(weights, depths): (Vec<f32>, &Vec<f32>)| {
        let tip = (0..depths.len()).rev().max_by(|&a, &b| depths[a].total_cmp(&depths[b])).unwrap_or(0);
        let depth = if depths[tip].is_finite() { depths[tip] } else { 0.0 };
        let mut limb = Limb { tip: tip as u32, hinge: depth, half_band: half, weights, is_disc: false };
        limb.is_disc = limb.shapes(topology.triangles()) == [Shape::DISC, Shape::CYLINDER];
        limb
    };
    let limbs = weights.zip(&depths[1..]).map(limb).collect();
    Some(Painted { limbs, torso, numbers })
}

/// How far each vertex is within the part `number`, along the surface, in metres; negative outside. Vertices that no border can be
/// reached from are infinitely far within or without.
fn depths(graph: &SurfaceGraph, of_vertex: &[u8], number: u8, edge: f32) -> Vec<f32> {
    let all = |inside: bool| -> Vec<u32> {
        (0..of_vertex.len() as u32).filter(|&v| (of_vertex[v as usize] == number) == inside).collect()
    };
    let [to_part, to_rest] = [true, false].map(|inside| graph.distances(&all(inside), f32::INFINITY));
    // The border lies in the middle of the edges that cross it.
    let depth = |v: usize| if of_vertex[v] == number { to_rest[v] - edge / 2.0 } else { edge / 2.0 - to_part[v] };
    (0..of_vertex.len()).map(depth).collect()
}
