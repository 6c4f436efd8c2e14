//! What some triangles are: a disc, a cylinder, or something else.

use std::collections::{BTreeMap, BTreeSet};

/// The shape of a piece of a surface, as far as its topology goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Euler's characteristic: vertices less edges plus triangles.
    pub characteristic: i64,
    /// Loops of its border.
    pub loops: usize,
    /// Connected pieces.
    pub pieces: usize,
}

impl Shape {
    /// One piece with one border and nothing else.
    pub const DISC: Self = Self { characteristic: 1, loops: 1, pieces: 1 };
    /// One piece with two borders.
    pub const CYLINDER: Self = Self { characteristic: 0, loops: 2, pieces: 1 };
}

/// The shape of these triangles.
#[must_use]
pub fn shape_of(triangles: &[[u32; 3]]) -> Shape {
    let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *edges.entry([from.min(to), from.max(to)]).or_default() += 1;
        }
    }
    let vertices: BTreeSet<u32> = triangles.iter().flatten().copied().collect();
    let border: Vec<[u32; 2]> = edges.iter().filter(|(_, count)| **count == 1).map(|(edge, _)| *edge).collect();
    let all: Vec<[u32; 2]> = edges.keys().copied().collect();
    Shape {
        characteristic: vertices.len() as i64 - all.len() as i64 + triangles.len() as i64,
        loops: pieces(&border),
        pieces: pieces(&all),
    }
}

/// Connected pieces of a graph.
fn pieces(edges: &[[u32; 2]]) -> usize {
    let mut parent: BTreeMap<u32, u32> = edges.iter().flatten().map(|&vertex| (vertex, vertex)).collect();
    fn root(parent: &BTreeMap<u32, u32>, mut vertex: u32) -> u32 {
        while parent[&vertex] != vertex {
            vertex = parent[&vertex];
        }
        vertex
    }
    let mut count = parent.len();
    for &[a, b] in edges {
        let (a, b) = (root(&parent, a), root(&parent, b));
        if a != b {
            // The lower number stays; ways to it are short enough on limbs.
            parent.insert(a.max(b), a.min(b));
            count -= 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_and_cylinders_are_told_apart() {
        assert_eq!(shape_of(&[[0, 1, 2], [0, 2, 3]]), Shape::DISC);
        let ring: Vec<[u32; 3]> =
            (0..5).flat_map(|k| [[k, (k + 1) % 5, k + 5], [(k + 1) % 5, (k + 1) % 5 + 5, k + 5]]).collect();
        assert_eq!(shape_of(&ring), Shape::CYLINDER);
        let tetrahedron = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        assert_eq!(shape_of(&tetrahedron), Shape { characteristic: 2, loops: 0, pieces: 1 });
        assert_eq!(shape_of(&[]), Shape { characteristic: 0, loops: 0, pieces: 0 });
    }
}
