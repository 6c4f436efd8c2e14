//! Skin weights by diffusion over the surface.
//!
//! They spread from the bone that owns a vertex by implicit heat flow on the mesh, so they are smooth over joints and never
//! jump from one limb to another through the air.

use geometry::mesh::Mesh;
use rayon::prelude::*;

use editing::{INFLUENCES, Influences};

/// Skin weights of every vertex of `mesh`: `owners` says which joint each vertex begins with, `lengths` for each joint over
/// which length its weights spread, in the unit of the positions. There must be as many joints as [`INFLUENCES`] or more.
#[must_use]
pub fn spread(mesh: &Mesh, owners: &[usize], lengths: &[f32]) -> Vec<Influences> {
    let neighbours = mesh.neighbours();
    let columns: Vec<Vec<f32>> = lengths
        .par_iter()
        .enumerate()
        .map(|(joint, &length)| {
            let start: Vec<f32> = owners.iter().map(|&owner| if owner == joint { 1.0 } else { 0.0 }).collect();
            if start.iter().all(|&w| w == 0.0) { start } else { diffuse(mesh, &neighbours, &start, length) }
        })
        .collect();
    (0..mesh.positions.len()).map(|vertex| strongest(&columns, vertex)).collect()
}

/// Heat flow of `values`, one for each vertex, over the mesh by implicit Euler steps, each solved by Jacobi sweeps: they
/// spread over about `length`, in the unit of the positions.
#[must_use]
pub fn diffuse(mesh: &Mesh, neighbours: &[Vec<u32>], values: &[f32], length: f32) -> Vec<f32> {
    let mut now = values.to_vec();
    let steps = 3;
    for _ in 0..steps {
        let before = now.clone();
        for _ in 0..14 {
            now = (0..now.len())
                .map(|vertex| {
                    let (mut sum, mut weight) = (before[vertex], 1.0);
                    for &other in &neighbours[vertex] {
                        let distance = mesh.positions[vertex].distance(mesh.positions[other as usize]).max(1e-4);
                        // A sum over about six neighbours of (f_j - f_i) / d^2 is 1.5 times the Laplacian.
                        let pull = length * length / (distance * distance * 1.5 * steps as f32) * 2.0;
                        sum += pull * now[other as usize];
                        weight += pull;
                    }
                    sum / weight
                })
                .collect();
        }
    }
    now
}

fn strongest(columns: &[Vec<f32>], vertex: usize) -> Influences {
    let mut order: Vec<usize> = (0..columns.len()).collect();
    order.sort_by(|&a, &b| columns[b][vertex].total_cmp(&columns[a][vertex]).then(a.cmp(&b)));
    let sum: f32 = order[..INFLUENCES].iter().map(|&j| columns[j][vertex]).sum();
    Influences {
        joints: std::array::from_fn(|k| order[k] as u8),
        weights: std::array::from_fn(|k| columns[order[k]][vertex] / sum),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// A strip of `count` squares, a metre each, along x.
    fn strip(count: u32) -> Mesh {
        let positions =
            (0..=count).flat_map(|x| [Vec3::new(x as f32, 0.0, 0.0), Vec3::new(x as f32, 1.0, 0.0)]).collect();
        let triangles = (0..count).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 1], [2 * k + 1, 2 * k + 2, 2 * k + 3]]);
        Mesh { positions, triangles: triangles.collect() }
    }

    #[test]
    fn weights_sum_to_one_and_fall_with_the_distance() {
        let mesh = strip(20);
        let owners: Vec<usize> = (0..42).map(|vertex| usize::from(vertex >= 21)).collect();
        let influences = spread(&mesh, &owners, &[1.5, 1.5, 1.0, 1.0]);
        let share = |vertex: usize, joint: u8| -> f32 {
            let Influences { joints, weights } = influences[vertex];
            joints.iter().zip(weights).filter(|(owner, _)| **owner == joint).map(|(_, weight)| weight).sum()
        };
        for (vertex, own) in influences.iter().enumerate() {
            assert!((own.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "vertex {vertex}");
            assert_eq!(share(vertex, 2) + share(vertex, 3), 0.0);
        }
        for vertex in (2..42).step_by(2) {
            assert!(share(vertex, 0) <= share(vertex - 2, 0) + 1e-6, "vertex {vertex}");
        }
        assert!(share(0, 0) > 0.99 && share(41, 1) > 0.99 && share(20, 1) > 0.05 && share(20, 0) > 0.05);
    }
}
