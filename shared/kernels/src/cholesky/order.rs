//! In which order to eliminate vertices, so that few entries fill in.
//!
//! This work is based on: George and Liu, "The evolution of the minimum degree ordering algorithm" (1989): the vertex
//! with the fewest neighbours goes first, and leaves them joined to each other. What it joins is not written out but kept
//! as one *element*, a list of vertices; elements that touch the vertex are absorbed by it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{CholeskyError, SymmetricPattern};

/// No column.
const NONE: u32 = u32::MAX;

/// The rows of a pattern in the order in which they are eliminated, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EliminationOrder {
    rows: Vec<u32>,
}

impl EliminationOrder {
    /// A fill-reducing order, by minimum degree; ties go to the smaller number, and each subtree of the elimination tree is
    /// in one piece. The same for the same pattern everywhere.
    #[must_use]
    pub fn minimum_degree(pattern: &SymmetricPattern) -> Self {
        let order = Elimination::new(pattern).run();
        Self { rows: postorder(pattern, &order) }
    }

    /// The rows as they are numbered: for patterns that are in a good order already, such as narrow bands.
    #[must_use]
    pub fn natural(row_count: usize) -> Self {
        Self { rows: (0..row_count as u32).collect() }
    }

    /// An order found before.
    ///
    /// # Errors
    /// [`CholeskyError::Order`] where `rows` do not name each of `row_count` rows once.
    pub fn new(row_count: usize, rows: Vec<u32>) -> Result<Self, CholeskyError> {
        let mut seen = vec![false; row_count];
        for &row in &rows {
            match seen.get_mut(row as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => return Err(CholeskyError::Order(row_count)),
            }
        }
        if rows.len() == row_count { Ok(Self { rows }) } else { Err(CholeskyError::Order(row_count)) }
    }

    /// The rows, those that are eliminated first in front.
    #[must_use]
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Where each row is in the order.
    #[must_use]
    pub fn positions(&self) -> Vec<u32> {
        positions(&self.rows)
    }
}

/// Where each of the rows of an order is in it.
#[inline(never)]
fn positions(rows: &[u32]) -> Vec<u32> {
    let mut positions = vec![0; rows.len()];
    for (at, &row) in (0..).zip(rows) {
        positions[row as usize] = at;
    }
    positions
}

/// The graph of what is not eliminated yet.
struct Elimination {
    /// Neighbours of each vertex that no element joins to it.
    neighbours: Vec<Vec<u32>>,
    /// Elements that touch each vertex, by the vertex whose elimination made them.
    elements: Vec<Vec<u32>>,
    /// Vertices of each element; empty once it is absorbed.
    members: Vec<Vec<u32>>,
    degree: Vec<usize>,
    eliminated: Vec<bool>,
    queue: BinaryHeap<Reverse<(usize, u32)>>,
    seen: Vec<u32>,
    stamp: u32,
}

impl Elimination {
    fn new(pattern: &SymmetricPattern) -> Self {
        let n = pattern.row_count();
        let neighbours: Vec<Vec<u32>> = (0..n).map(|row| pattern.row(row).0.to_vec()).collect();
        let degree: Vec<usize> = neighbours.iter().map(Vec::len).collect();
        let queue = (0..).zip(&degree).map(|(vertex, &degree)| Reverse((degree, vertex))).collect();
        let (elements, members) = (vec![Vec::new(); n], vec![Vec::new(); n]);
        Self { neighbours, elements, members, degree, eliminated: vec![false; n], queue, seen: vec![0; n], stamp: 0 }
    }

    fn run(mut self) -> Vec<u32> {
        let n = self.degree.len();
        let mut order = Vec::with_capacity(n);
        while let Some(Reverse((degree, vertex))) = self.queue.pop() {
            if self.eliminated[vertex as usize] || self.degree[vertex as usize] != degree {
                continue;
            }
            order.push(vertex);
            let joined = self.eliminate(vertex);
            if joined.len() == n - order.len() {
                // All that is left is joined to all: any order fills in as much.
                order.extend(joined);
                break;
            }
        }
        order
    }

    /// Eliminates `vertex` and returns whom it joins.
    fn eliminate(&mut self, vertex: u32) -> Vec<u32> {
        self.eliminated[vertex as usize] = true;
        let joined = self.reached(vertex);
        for element in std::mem::take(&mut self.elements[vertex as usize]) {
            self.members[element as usize] = Vec::new();
        }
        self.neighbours[vertex as usize] = Vec::new();
        // `seen` still marks the joined: they need no edges to each other.
        let stamp = self.stamp;
        for &other in &joined {
            let other = other as usize;
            let (seen, members) = (&self.seen, &self.members);
            self.neighbours[other].retain(|&third| third != vertex && seen[third as usize] != stamp);
            self.elements[other].retain(|&element| !members[element as usize].is_empty());
            self.elements[other].push(vertex);
        }
        self.members[vertex as usize].clone_from(&joined);
        for &other in &joined {
            let degree = self.reached(other).len();
            self.degree[other as usize] = degree;
            self.queue.push(Reverse((degree, other)));
        }
        joined
    }

    /// Who is joined to `vertex`, by an edge or an element; `seen` marks them.
    fn reached(&mut self, vertex: u32) -> Vec<u32> {
        self.stamp += 1;
        let (stamp, seen) = (self.stamp, &mut self.seen);
        seen[vertex as usize] = stamp;
        let elements = self.elements[vertex as usize].iter().map(|&element| &self.members[element as usize]);
        let lists = elements.chain([&self.neighbours[vertex as usize]]);
        let mut reached = Vec::new();
        for &other in lists.flatten() {
            if seen[other as usize] != stamp && !self.eliminated[other as usize] {
                seen[other as usize] = stamp;
                reached.push(other);
            }
        }
        reached
    }
}

/// `order` with each subtree of its elimination tree in one piece, which fills in as much.
fn postorder(pattern: &SymmetricPattern, order: &[u32]) -> Vec<u32> {
    let n = order.len();
    let place = positions(order);
    // Liu's algorithm: a column's parent is the first row below that it reaches; ways up are cut short.
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for row in 0..n as u32 {
        for &neighbour in pattern.row(order[row as usize] as usize).0 {
            let mut column = place[neighbour as usize];
            while column < row {
                let above = std::mem::replace(&mut ancestor[column as usize], row);
                if above == NONE {
                    parent[column as usize] = row;
                    break;
                }
                column = above;
            }
        }
    }
    // Parents come after their children: backwards, each takes the end of what is left of its parent's piece.
    let mut size = vec![1_u32; n];
    for column in 0..n {
        if parent[column] != NONE {
            size[parent[column] as usize] += size[column];
        }
    }
    let mut free_end = vec![0_u32; n];
    let mut end = n as u32;
    let mut ordered = vec![0; n];
    for column in (0..n).rev() {
        let piece_end = match parent[column] {
            NONE => &mut end,
            parent => &mut free_end[parent as usize],
        };
        let own = *piece_end - 1;
        *piece_end -= size[column];
        ordered[own as usize] = order[column];
        free_end[column] = own;
    }
    ordered
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries below the diagonal when a graph is eliminated in `order`, written out edge by edge.
    fn fill(pattern: &SymmetricPattern, order: &[u32]) -> usize {
        let mut graph: Vec<std::collections::BTreeSet<u32>> =
            (0..pattern.row_count()).map(|row| pattern.row(row).0.iter().copied().collect()).collect();
        let mut entries = 0;
        for &vertex in order {
            let joined = std::mem::take(&mut graph[vertex as usize]);
            entries += joined.len();
            for &a in &joined {
                graph[a as usize].remove(&vertex);
                graph[a as usize].extend(joined.iter().filter(|&&b| b != a));
            }
        }
        entries
    }

    fn minimum_degree(pattern: &SymmetricPattern) -> Vec<u32> {
        EliminationOrder::minimum_degree(pattern).rows
    }

    fn grid(width: u32, height: u32) -> SymmetricPattern {
        let at = |x: u32, y: u32| y * width + x;
        let mut edges = Vec::new();
        for y in 0..height {
            for x in 0..width {
                for (dx, dy) in [(1, 0), (0, 1), (1, 1)] {
                    if x + dx < width && y + dy < height {
                        edges.push([at(x, y), at(x + dx, y + dy)]);
                    }
                }
            }
        }
        SymmetricPattern::from_edges((width * height) as usize, &edges).unwrap()
    }

    #[test]
    fn every_vertex_comes_once() {
        let apart = |rows| SymmetricPattern::from_edges(rows, &[]).unwrap();
        for pattern in [apart(0), apart(3), grid(1, 1), grid(7, 5), grid(20, 20)] {
            let mut order = minimum_degree(&pattern);
            order.sort_unstable();
            assert!(order.into_iter().eq(0..pattern.row_count() as u32));
        }
    }

    #[test]
    fn little_fills_in() {
        let grid = grid(24, 24);
        let natural: Vec<u32> = (0..24 * 24).collect();
        let order = minimum_degree(&grid);
        assert!(fill(&grid, &order) * 3 < fill(&grid, &natural) * 2, "{} entries", fill(&grid, &order));
    }

    #[test]
    fn subtrees_in_one_piece_fill_in_as_much() {
        let grid = grid(13, 9);
        let order = Elimination::new(&grid).run();
        assert_eq!(fill(&grid, &postorder(&grid, &order)), fill(&grid, &order));
    }

    #[test]
    fn a_tree_does_not_fill_in() {
        let edges: Vec<[u32; 2]> = (1..31).map(|child| [child, (child - 1) / 2]).collect();
        let tree = SymmetricPattern::from_edges(31, &edges).unwrap();
        assert_eq!(fill(&tree, &minimum_degree(&tree)), 30);
    }
}
