//! In which order to eliminate vertices, so that few entries fill in.
//!
//! This work is based on: George and Liu, "The evolution of the minimum degree ordering algorithm" (1989): the vertex
//! with the fewest neighbours goes first, and leaves them joined to each other. What it joins is not written out but kept
//! as one *element*, a list of vertices; elements that touch the vertex are absorbed by it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// No column.
const NONE: u32 = u32::MAX;

/// Vertices in an order of minimum degree, each subtree of the elimination tree in one piece. `neighbours` lists each
/// vertex' neighbours, both ways; ties go to the smaller number.
pub(super) fn minimum_degree(neighbours: Vec<Vec<u32>>) -> Vec<u32> {
    let order = Elimination::new(neighbours.clone()).run();
    postorder(&neighbours, &order)
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
    fn new(neighbours: Vec<Vec<u32>>) -> Self {
        let n = neighbours.len();
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
fn postorder(neighbours: &[Vec<u32>], order: &[u32]) -> Vec<u32> {
    let n = order.len();
    let mut place = vec![0; n];
    for (at, &vertex) in (0_u32..).zip(order) {
        place[vertex as usize] = at;
    }
    // Liu's algorithm: a column's parent is the first row below that it reaches; ways up are cut short.
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for row in 0..n as u32 {
        for &neighbour in &neighbours[order[row as usize] as usize] {
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
    fn fill(neighbours: &[Vec<u32>], order: &[u32]) -> usize {
        let mut graph: Vec<std::collections::BTreeSet<u32>> =
            neighbours.iter().map(|list| list.iter().copied().collect()).collect();
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

    fn grid(width: u32, height: u32) -> Vec<Vec<u32>> {
        let at = |x: u32, y: u32| y * width + x;
        let mut neighbours = vec![Vec::new(); (width * height) as usize];
        for y in 0..height {
            for x in 0..width {
                for (dx, dy) in [(1, 0), (0, 1), (1, 1)] {
                    if x + dx < width && y + dy < height {
                        neighbours[at(x, y) as usize].push(at(x + dx, y + dy));
                        neighbours[at(x + dx, y + dy) as usize].push(at(x, y));
                    }
                }
            }
        }
        neighbours
    }

    #[test]
    fn every_vertex_comes_once() {
        for neighbours in [Vec::new(), vec![Vec::new(); 3], grid(1, 1), grid(7, 5), grid(20, 20)] {
            let mut order = minimum_degree(neighbours.clone());
            order.sort_unstable();
            assert!(order.into_iter().eq(0..neighbours.len() as u32));
        }
    }

    #[test]
    fn little_fills_in() {
        let grid = grid(24, 24);
        let natural: Vec<u32> = (0..24 * 24).collect();
        let order = minimum_degree(grid.clone());
        assert!(fill(&grid, &order) * 3 < fill(&grid, &natural) * 2, "{} entries", fill(&grid, &order));
    }

    #[test]
    fn subtrees_in_one_piece_fill_in_as_much() {
        let grid = grid(13, 9);
        let order = Elimination::new(grid.clone()).run();
        assert_eq!(fill(&grid, &postorder(&grid, &order)), fill(&grid, &order));
    }

    #[test]
    fn a_tree_does_not_fill_in() {
        let mut neighbours = vec![Vec::new(); 31];
        for child in 1..31_u32 {
            neighbours[child as usize].push((child - 1) / 2);
            neighbours[(child as usize - 1) / 2].push(child);
        }
        assert_eq!(fill(&neighbours, &minimum_degree(neighbours.clone())), 30);
    }
}
