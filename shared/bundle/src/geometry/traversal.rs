//! The order in which vertices are coded, and which vertices each is predicted from. Both sides derive it from the
//! connectivity alone.

use std::collections::VecDeque;

use kernels::topology::Topology;

/// Neighbours of a vertex beyond this many are not looked at, so that a fan of a million triangles costs no more than
/// its vertices.
const MOST_NEIGHBOURS: usize = 24;

/// An order of the vertices, and the parents of each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Traversal {
    /// The vertex at each place.
    pub vertex_of_place: Vec<u32>,
    /// Number of parents of each place, at most `most_parents`.
    pub parent_count: Vec<u8>,
    /// `most_parents` parents of each place, as **slots**: one more than their places. Slot 0 is no vertex.
    pub parent_slots: Vec<u32>,
    /// Row length of `parent_slots`.
    pub most_parents: usize,
}

impl Traversal {
    /// The traversal of `topology` with `most_parents` parents a vertex.
    ///
    /// `links` name, for each component but the first, a vertex of an earlier component to begin from.
    ///
    /// # Errors
    /// The reason, where `links` do not fit the topology.
    pub fn new(topology: &Topology, links: &[u32], most_parents: usize) -> Result<Self, &'static str> {
        check_links(topology, links)?;
        let neighbours = Neighbours::new(topology, links);
        let mut walk = Walk::new(topology.vertex_count(), most_parents);
        for vertex in 0..topology.vertex_count() as u32 {
            // Components are numbered by first vertex, so this meets them in order and links lead backwards.
            if walk.slot_of_vertex[vertex as usize] == 0 {
                walk.visit_component(&neighbours, vertex);
            }
        }
        Ok(walk.traversal)
    }
}

fn check_links(topology: &Topology, links: &[u32]) -> Result<(), &'static str> {
    if links.len() + 1 != topology.component_count() {
        return Err("has another number of links than there are components");
    }
    for (index, &link) in links.iter().enumerate() {
        let component = topology.component_of_vertex().get(link as usize);
        if component.is_none_or(|&component| component as usize > index) {
            return Err("has a link that does not lead to an earlier component");
        }
    }
    Ok(())
}

/// Neighbours of each vertex: along edges, and from the first vertex of a component to its link.
struct Neighbours {
    start: Vec<u32>,
    list: Vec<u32>,
}

impl Neighbours {
    fn new(topology: &Topology, links: &[u32]) -> Self {
        let count = topology.vertex_count();
        let mut start = vec![0_u32; count + 1];
        for_each_pair(topology, links, |vertex, _| start[vertex as usize + 1] += 1);
        for vertex in 0..count {
            start[vertex + 1] += start[vertex];
        }
        let mut next = start.clone();
        let mut list = vec![0; start[count] as usize];
        for_each_pair(topology, links, |vertex, neighbour| {
            list[next[vertex as usize] as usize] = neighbour;
            next[vertex as usize] += 1;
        });
        Self { start, list }.without_repetitions()
    }

    /// Keeps the first mention of each neighbour.
    fn without_repetitions(mut self) -> Self {
        let count = self.start.len() - 1;
        let mut mentioned_by = vec![u32::MAX; count];
        let (mut begin, mut kept) = (0, 0);
        for vertex in 0..count {
            let end = self.start[vertex + 1] as usize;
            for index in begin..end {
                let neighbour = self.list[index];
                if std::mem::replace(&mut mentioned_by[neighbour as usize], vertex as u32) != vertex as u32 {
                    self.list[kept] = neighbour;
                    kept += 1;
                }
            }
            begin = end;
            self.start[vertex + 1] = kept as u32;
        }
        self.list.truncate(kept);
        self
    }

    fn of(&self, vertex: u32) -> &[u32] {
        let all = &self.list[self.start[vertex as usize] as usize..self.start[vertex as usize + 1] as usize];
        &all[..all.len().min(MOST_NEIGHBOURS)]
    }
}

/// Calls `act` with both directions of each edge, triangle by triangle, then of each link.
fn for_each_pair(topology: &Topology, links: &[u32], mut act: impl FnMut(u32, u32)) {
    for &[a, b, c] in topology.triangles() {
        for (from, to) in [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)] {
            act(from, to);
        }
    }
    let mut next = 0;
    for (vertex, &component) in topology.component_of_vertex().iter().enumerate() {
        if component == next {
            if component > 0 {
                act(vertex as u32, links[component as usize - 1]);
            }
            next += 1;
        }
    }
}

/// Brings the `count` largest of `list` to its front, the largest first.
fn largest_first<T: Copy + Ord>(list: &mut [T], count: usize) {
    for place in 0..count.min(list.len()) {
        for other in place + 1..list.len() {
            if list[other] > list[place] {
                list.swap(place, other);
            }
        }
    }
}

struct Walk {
    traversal: Traversal,
    /// One more than the place of each vertex; 0 before its visit.
    slot_of_vertex: Vec<u32>,
    /// Visited neighbours of each vertex.
    known: Vec<u8>,
    /// Vertices that may be next, by the number of their visited neighbours when they were queued.
    queues: Vec<VecDeque<u32>>,
    /// Reused by [`Walk::add_parents`]: the number of ways that lead to a slot, and the slot.
    candidates: Vec<(u32, u32)>,
}

impl Walk {
    fn new(count: usize, most_parents: usize) -> Self {
        let traversal = Traversal {
            vertex_of_place: Vec::with_capacity(count),
            parent_count: Vec::with_capacity(count),
            parent_slots: Vec::with_capacity(count * most_parents),
            most_parents,
        };
        Self {
            traversal,
            slot_of_vertex: vec![0; count],
            known: vec![0; count],
            queues: vec![VecDeque::new(); MOST_NEIGHBOURS + 1],
            candidates: Vec::new(),
        }
    }

    fn visit_component(&mut self, neighbours: &Neighbours, first: u32) {
        let mut next = Some(first);
        while let Some(vertex) = next {
            self.add_parents(neighbours, vertex);
            self.traversal.vertex_of_place.push(vertex);
            self.slot_of_vertex[vertex as usize] = self.traversal.vertex_of_place.len() as u32;
            for &neighbour in neighbours.of(vertex) {
                if self.slot_of_vertex[neighbour as usize] == 0 {
                    let known = (self.known[neighbour as usize] + 1).min(MOST_NEIGHBOURS as u8);
                    self.known[neighbour as usize] = known;
                    self.queues[usize::from(known)].push_back(neighbour);
                }
            }
            next = self.best_known();
        }
    }

    /// The vertex with the most visited neighbours; of those, the one that has waited longest.
    fn best_known(&mut self) -> Option<u32> {
        for known in (1..self.queues.len()).rev() {
            while let Some(vertex) = self.queues[known].pop_front() {
                let current = usize::from(self.known[vertex as usize]) == known;
                if current && self.slot_of_vertex[vertex as usize] == 0 {
                    return Some(vertex);
                }
            }
        }
        None
    }

    /// Visited neighbours, latest first; then visited neighbours of those, the most often met first.
    fn add_parents(&mut self, neighbours: &Neighbours, vertex: u32) {
        let most = self.traversal.most_parents;
        let row = self.traversal.parent_slots.len();
        let slots = neighbours.of(vertex).iter().map(|&neighbour| self.slot_of_vertex[neighbour as usize]);
        self.traversal.parent_slots.extend(slots.filter(|&slot| slot > 0));
        largest_first(&mut self.traversal.parent_slots[row..], most);
        self.traversal.parent_slots.truncate(row + most);
        self.add_ring(neighbours, vertex, row);
        // Just after a link there is little to see: look one ring further.
        if self.traversal.parent_slots.len() - row < most.min(4) {
            self.add_ring(neighbours, vertex, row);
        }
        let count = self.traversal.parent_slots.len() - row;
        self.traversal.parent_count.push(count as u8);
        self.traversal.parent_slots.resize(row + most, 0);
    }

    fn add_ring(&mut self, neighbours: &Neighbours, vertex: u32, row: usize) {
        let most = self.traversal.most_parents;
        self.candidates.clear();
        for &parent in &self.traversal.parent_slots[row..] {
            let parent = self.traversal.vertex_of_place[parent as usize - 1];
            for &other in neighbours.of(parent) {
                let slot = self.slot_of_vertex[other as usize];
                if other == vertex || slot == 0 || self.traversal.parent_slots[row..].contains(&slot) {
                    continue;
                }
                match self.candidates.iter_mut().find(|(_, known)| *known == slot) {
                    Some((ways, _)) => *ways += 1,
                    None => self.candidates.push((1, slot)),
                }
            }
        }
        let free = most - (self.traversal.parent_slots.len() - row);
        largest_first(&mut self.candidates, free);
        let chosen = self.candidates.iter().take(free).map(|&(_, slot)| slot);
        self.traversal.parent_slots.extend(chosen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(width: u32, height: u32) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        for y in 0..height - 1 {
            for x in 0..width - 1 {
                let a = y * width + x;
                triangles.extend([[a, a + 1, a + width], [a + 1, a + width + 1, a + width]]);
            }
        }
        triangles
    }

    #[test]
    fn parents_come_before_their_children() {
        let mut triangles = grid(9, 7);
        triangles.extend(grid(5, 5).iter().map(|t| t.map(|v| v + 63)));
        let topology = Topology::new(63 + 25 + 1, triangles, vec![1.0; 89]).unwrap();
        let traversal = Traversal::new(&topology, &[62, 87], 8).unwrap();
        let mut sorted = traversal.vertex_of_place.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..89));
        for place in 1..89 {
            let row = &traversal.parent_slots[place * 8..place * 8 + 8];
            let count = usize::from(traversal.parent_count[place]);
            assert!(count > 0, "place {place} has no parent");
            assert!(row[..count].iter().all(|&slot| slot > 0 && slot as usize <= place));
            assert!(row[count..].iter().all(|&slot| slot == 0));
        }
        assert!(traversal.parent_count.iter().filter(|&&count| count >= 4).count() > 80);
    }

    #[test]
    fn links_must_lead_backwards() {
        let topology = Topology::new(6, vec![[0, 1, 2], [3, 4, 5]], vec![1.0; 6]).unwrap();
        assert!(Traversal::new(&topology, &[2], 4).is_ok());
        assert!(Traversal::new(&topology, &[], 4).is_err());
        assert!(Traversal::new(&topology, &[3], 4).is_err());
        assert!(Traversal::new(&topology, &[6], 4).is_err());
    }

    #[test]
    fn a_large_fan_is_quick() {
        let count = 200_000;
        let triangles = (1..count - 1).map(|i| [0, i, i + 1]).collect();
        let topology = Topology::new(count, triangles, vec![1.0; count as usize]).unwrap();
        assert_eq!(Traversal::new(&topology, &[], 8).unwrap().vertex_of_place.len(), count as usize);
    }
}
