//! Connected components of a graph, by union and find.

/// Sets of things that are joined step by step.
#[derive(Clone, Debug)]
pub struct UnionFind(Vec<u32>);

impl UnionFind {
    /// `count` things, each in a set of its own.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The smallest thing of the set of `thing`.
    ///
    /// # Panics
    /// Where there is no such thing.
    pub fn root(&mut self, mut thing: u32) -> u32 {
        while self.0[thing as usize] != thing {
            let grandparent = self.0[self.0[thing as usize] as usize];
            self.0[thing as usize] = grandparent;
            thing = grandparent;
        }
        thing
    }

    /// Makes one set of those of `a` and `b`.
    ///
    /// # Panics
    /// Where one of them does not exist.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller root wins, so that sets are numbered by their first thing.
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// The set of each thing, numbered by their first thing, and the number of sets.
    #[must_use]
    pub fn numbered(mut self) -> (Vec<u32>, usize) {
        let mut number = vec![u32::MAX; self.0.len()];
        let mut sets = 0;
        let set_of_thing = (0..self.0.len() as u32)
            .map(|thing| {
                let slot = &mut number[self.root(thing) as usize];
                if *slot == u32::MAX {
                    *slot = sets;
                    sets += 1;
                }
                *slot
            })
            .collect();
        (set_of_thing, sets as usize)
    }
}

/// The component of each of `count` vertices, numbered by their first vertex, and the number of components. Edges name
/// vertices below `count`.
#[must_use]
pub fn connected_components(count: usize, edges: impl IntoIterator<Item = [u32; 2]>) -> (Vec<u32>, usize) {
    let mut sets = UnionFind::new(count);
    for [a, b] in edges {
        sets.join(a, b);
    }
    sets.numbered()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_numbered_by_first_vertex() {
        let (of_vertex, count) = connected_components(8, [[4, 5], [4, 6], [0, 2], [0, 3], [6, 5], [6, 7]]);
        assert_eq!((of_vertex.as_slice(), count), (&[0, 1, 0, 0, 2, 2, 2, 2][..], 3));
        assert_eq!(connected_components(0, []), (Vec::new(), 0));
    }
}
