//! How vertices and edges are numbered.

use crate::cholesky::{CholeskyError, EliminationOrder};
use crate::gradients::TriangleBatches;
use crate::lanes::LANES;
use crate::sort::{key, numbers, sort};
use crate::topology::Topology;

/// `order` with the anchor of each component, its last vertex, moved to the end.
pub(super) fn anchors_last(
    (component_of_vertex, count): (&[u32], usize),
    order: &[u32],
) -> Result<EliminationOrder, CholeskyError> {
    let n = component_of_vertex.len();
    let component = |vertex: u32| component_of_vertex.get(vertex as usize).copied();
    let mut last = vec![u32::MAX; count];
    for &vertex in order {
        if let Some(component) = component(vertex) {
            last[component as usize] = vertex;
        }
    }
    let is_anchor = |vertex: u32| component(vertex).is_some_and(|component| last[component as usize] == vertex);
    let mut rows: Vec<u32> = order.iter().copied().filter(|&vertex| !is_anchor(vertex)).collect();
    rows.extend_from_slice(&last);
    // An anchor that was named twice would now be there once: then the order is too long.
    if order.len() == n { EliminationOrder::new(n, rows) } else { Err(CholeskyError::Order(n)) }
}

/// Refuses ties between vertices that do not exist.
pub(super) fn check_ties(topology: &Topology, ties: &[[u32; 2]]) -> Result<(), CholeskyError> {
    let row_count = topology.vertex_count();
    match ties.iter().flatten().find(|&&vertex| vertex as usize >= row_count) {
        Some(&row) => Err(CholeskyError::NoRow { row, row_count }),
        None => Ok(()),
    }
}

/// Numbers the edges by the positions of their ends, and gives the edge opposite to each corner; behind the last edge where
/// that is none.
pub(super) fn number_edges(
    triangles: &TriangleBatches,
    position_of_vertex: &[u32],
    ties: &[[u32; 2]],
) -> (Vec<[u32; 2]>, Vec<[[u32; LANES]; 3]>) {
    let mut sides = Vec::with_capacity(triangles.triangle_count() * 3 + ties.len());
    for triangle in 0..triangles.triangle_count() {
        let corners = triangles.batches()[triangle / LANES].corners();
        let [a, b, c] = corners.map(|corner| position_of_vertex[corner[triangle % LANES] as usize]);
        for (corner, (k, l)) in [(b, c), (c, a), (a, b)].into_iter().enumerate() {
            sides.push(key([k.min(l), k.max(l), triangle as u32, corner as u32]));
        }
    }
    for tie in ties {
        let [k, l] = tie.map(|vertex| position_of_vertex[vertex as usize]);
        sides.push(key([k.min(l), k.max(l), u32::MAX, 0]));
    }
    sort(&mut sides);
    let mut edges: Vec<[u32; 2]> = Vec::new();
    let mut edge_of_corner = vec![[[u32::MAX; LANES]; 3]; triangles.batches().len()];
    for [k, l, triangle, corner] in sides.into_iter().map(numbers) {
        // A triangle that names a vertex twice has a side from it to itself, which says nothing.
        if k == l {
            continue;
        }
        if edges.last() != Some(&[k, l]) {
            edges.push([k, l]);
        }
        if let Some(edges_of_batch) = edge_of_corner.get_mut(triangle as usize / LANES) {
            edges_of_batch[corner as usize][triangle as usize % LANES] = edges.len() as u32 - 1;
        }
    }
    for edge in edge_of_corner.iter_mut().flatten().flatten() {
        *edge = (*edge).min(edges.len() as u32);
    }
    (edges, edge_of_corner)
}
