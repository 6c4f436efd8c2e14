//! A closed triangle mesh, and what can be asked of one.

use std::collections::HashMap;

use glam::Vec3;

/// Positions in metres and triangles, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Triangles around each vertex, ascending.
    #[must_use]
    pub fn triangles_of_vertices(&self) -> Vec<Vec<u32>> {
        let mut around = vec![Vec::new(); self.positions.len()];
        for (index, triangle) in self.triangles.iter().enumerate() {
            for &vertex in triangle {
                around[vertex as usize].push(index as u32);
            }
        }
        around
    }

    /// Neighbours of each vertex, ascending.
    #[must_use]
    pub fn neighbours(&self) -> Vec<Vec<u32>> {
        let mut neighbours = vec![Vec::new(); self.positions.len()];
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                neighbours[from as usize].push(to);
                neighbours[to as usize].push(from);
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        neighbours
    }

    /// Unit normals of the vertices, weighted by area.
    #[must_use]
    pub fn normals(&self) -> Vec<Vec3> {
        vertex_normals(&self.positions, &self.triangles)
    }

    /// The triangle on the other side of each edge (a, b), keyed as its own triangle runs along it.
    #[must_use]
    pub fn half_edges(&self) -> HashMap<(u32, u32), u32> {
        let mut map = HashMap::with_capacity(self.triangles.len() * 3);
        for (index, &[a, b, c]) in self.triangles.iter().enumerate() {
            for edge in [(a, b), (b, c), (c, a)] {
                map.insert(edge, index as u32);
            }
        }
        map
    }

    /// Vertices minus edges plus triangles, of a closed mesh: 2 for a sphere.
    #[must_use]
    pub fn euler_characteristic(&self) -> i64 {
        self.positions.len() as i64 - self.triangles.len() as i64 / 2
    }

    /// Whether every edge has exactly two triangles, of opposite directions, and every vertex one fan of triangles.
    ///
    /// # Errors
    /// A sentence that names the first element that breaks this.
    pub fn check_closed(&self) -> Result<(), String> {
        let edges = self.half_edges();
        if edges.len() != self.triangles.len() * 3 {
            return Err("an edge is used twice in the same direction".into());
        }
        if let Some((a, b)) = edges.keys().find(|&&(a, b)| !edges.contains_key(&(b, a))) {
            return Err(format!("the edge from vertex {a} to vertex {b} has one triangle only"));
        }
        for (vertex, around) in self.triangles_of_vertices().iter().enumerate() {
            let Some(&first) = around.first() else { return Err(format!("vertex {vertex} has no triangle")) };
            let mut triangle = first;
            let mut steps = 0;
            loop {
                let corners = self.triangles[triangle as usize];
                let corner = corners.iter().position(|&v| v as usize == vertex).unwrap_or(0);
                let next = corners[(corner + 2) % 3];
                triangle = edges[&(vertex as u32, next)];
                steps += 1;
                if triangle == first || steps > around.len() {
                    break;
                }
            }
            if steps != around.len() {
                return Err(format!("the triangles around vertex {vertex} are not one fan"));
            }
        }
        Ok(())
    }

    /// Enclosed volume in cubic metres, positive where triangles face outwards.
    #[must_use]
    pub fn volume(&self) -> f32 {
        let sum: f64 = self
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| self.positions[v as usize].as_dvec3());
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        sum as f32
    }

    /// Surface area in square metres.
    #[must_use]
    pub fn area(&self) -> f32 {
        let sum: f64 = self
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| self.positions[v as usize].as_dvec3());
                (b - a).cross(c - a).length() * 0.5
            })
            .sum();
        sum as f32
    }

    /// The connected part with the most triangles, with its vertices in order of first use.
    #[must_use]
    pub fn largest_component(&self) -> Self {
        let neighbours = self.neighbours();
        let mut part = vec![usize::MAX; self.positions.len()];
        let mut sizes = Vec::new();
        for start in 0..self.positions.len() {
            if part[start] != usize::MAX {
                continue;
            }
            let mut stack = vec![start];
            part[start] = sizes.len();
            let mut size = 0;
            while let Some(vertex) = stack.pop() {
                size += 1;
                for &next in &neighbours[vertex] {
                    if part[next as usize] == usize::MAX {
                        part[next as usize] = sizes.len();
                        stack.push(next as usize);
                    }
                }
            }
            sizes.push(size);
        }
        // The first of the largest, so that ties are decided by order.
        let largest = (0..sizes.len()).rev().max_by_key(|&index| sizes[index]).unwrap_or(0);
        let kept = self.triangles.iter().filter(|t| part[t[0] as usize] == largest).copied().collect();
        Self { positions: self.positions.clone(), triangles: kept }.compact()
    }

    /// The same mesh without unused vertices, numbered by first use.
    #[must_use]
    pub fn compact(&self) -> Self {
        let mut number = vec![u32::MAX; self.positions.len()];
        let mut positions = Vec::new();
        let triangles = self
            .triangles
            .iter()
            .map(|t| {
                t.map(|vertex| {
                    let slot = &mut number[vertex as usize];
                    if *slot == u32::MAX {
                        *slot = positions.len() as u32;
                        positions.push(self.positions[vertex as usize]);
                    }
                    *slot
                })
            })
            .collect();
        Self { positions, triangles }
    }
}

/// Unit normals of vertices at `positions`, weighted by the area of their triangles.
#[must_use]
pub fn vertex_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a);
        for &vertex in triangle {
            normals[vertex as usize] += normal;
        }
    }
    for normal in &mut normals {
        *normal = normal.normalize_or(Vec3::Y);
    }
    normals
}
