//! Connected components of a graph, by union and find.

/// The component of each of `count` vertices, numbered by their first vertex, and the number of components. Edges name
/// vertices below `count`.
#[must_use]
pub fn connected_components(count: usize, edges: impl IntoIterator<Item = [u32; 2]>) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..count as u32).collect();
    for [a, b] in edges {
        let (x, y) = (root(&mut parent, a), root(&mut parent, b));
        // The smaller root wins, so that components are numbered by their first vertex.
        parent[x.max(y) as usize] = x.min(y);
    }
    let mut number = vec![u32::MAX; count];
    let mut components = 0;
    let component_of_vertex = (0..count as u32)
        .map(|vertex| {
            let slot = &mut number[root(&mut parent, vertex) as usize];
            if *slot == u32::MAX {
                *slot = components;
                components += 1;
            }
            *slot
        })
        .collect();
    (component_of_vertex, components as usize)
}

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        let grandparent = parent[parent[vertex as usize] as usize];
        parent[vertex as usize] = grandparent;
        vertex = grandparent;
    }
    vertex
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
