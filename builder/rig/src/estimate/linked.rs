//! Neighbours over a surface in one piece: pieces that lie apart are linked where they are nearest.

use glam::Vec3;
use kernels::topology::Topology;

/// Neighbours of each vertex along edges; each connected component but the largest is linked once to those linked before it,
/// where they are nearest in `rest`.
#[must_use]
pub fn neighbours(topology: &Topology, rest: &[Vec3]) -> Vec<Vec<u32>> {
    let n = topology.vertex_count();
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); n];
    for &[a, b, c] in topology.triangles() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            around[from as usize].push(to);
            around[to as usize].push(from);
        }
    }
    for around in &mut around {
        around.sort_unstable();
        around.dedup();
    }
    let mut members = vec![Vec::new(); topology.component_count()];
    topology.component_of_vertex().iter().enumerate().for_each(|(v, &component)| members[component as usize].push(v));
    let mut apart: Vec<bool> = vec![true; members.len()];
    let Some(first) =
        (0..members.len()).max_by_key(|&component| (members[component].len(), std::cmp::Reverse(component)))
    else {
        return around;
    };
    // Nearest linked vertex of each vertex that is still apart (Prim).
    let mut nearest = vec![(f32::INFINITY, 0_usize); n];
    let mut next = Some((first, None));
    while let Some((component, link)) = next {
        apart[component] = false;
        if let Some((v, u)) = link {
            let (v, u): (usize, usize) = (v, u);
            around[v].push(u as u32);
            around[u].push(v as u32);
        }
        next = None;
        let mut least = f32::INFINITY;
        for other in (0..members.len()).filter(|&other| apart[other]) {
            for &v in &members[other] {
                for &u in &members[component] {
                    let distance = rest[v].distance_squared(rest[u]);
                    if distance < nearest[v].0 {
                        nearest[v] = (distance, u);
                    }
                }
                if nearest[v].0 < least {
                    least = nearest[v].0;
                    next = Some((other, Some((v, nearest[v].1))));
                }
            }
        }
    }
    around
}
