//! The mesh as the files had it: their vertices in their order, their faces with all corners, and which corners share a
//! normal.

use std::collections::HashMap;

use actor::files::FileFaces;
use actor::surface::Surface;
use bundle::BundleReader;
use glam::Vec3;

use super::error::ExportError;

/// A corner of a face, with all that may differ from face to face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct FaceCorner {
    /// The files' vertex.
    pub vertex: u32,
    /// The drawn corner, which has the texture coordinate.
    pub corner: u32,
    /// Which of the mesh's normals it has; 0 where there are none.
    pub normal: u32,
}

/// A face of the files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Face {
    /// Its material.
    pub material: u32,
    /// Its corners, three or more.
    pub corners: Vec<FaceCorner>,
}

/// The files' vertices and faces over the welded mesh.
#[derive(Clone, Debug)]
pub(super) struct FileMesh {
    /// Welded vertex of each vertex.
    pub vertices: Vec<u32>,
    /// sRGB colours of the vertices; empty where all are white.
    pub colours: Vec<[u8; 4]>,
    /// The triangles, in the order of the surface.
    pub triangles: Vec<[FaceCorner; 3]>,
    /// The faces, in the files' order.
    pub faces: Vec<Face>,
    /// Whether any texture coordinate is not zero.
    pub has_uvs: bool,
    /// Number of normals; 0 where the files had none.
    pub normal_count: usize,
}

impl FileMesh {
    /// The mesh of a whole bundle.
    ///
    /// # Errors
    /// A bundle that is not whole, or contradicts itself.
    pub fn of(reader: &BundleReader) -> Result<Self, ExportError> {
        let (Some(surface), Some(topology)) = (reader.surface(), reader.topology()) else {
            return Err(ExportError::NotWhole);
        };
        let vertex_count = topology.vertex_count();
        // Every welded vertex is one of the files at least; where a bundle says otherwise, what is drawn is written.
        let mut known = vec![false; vertex_count];
        reader.file_vertices().into_iter().flatten().for_each(|&vertex| known[vertex as usize] = true);
        let vertices = match reader.file_vertices() {
            Some(vertices) if !known.contains(&false) => vertices.to_vec(),
            _ => (0..vertex_count as u32).collect(),
        };
        let plain = || FileFaces::of_surface(surface, &vertices, vertex_count);
        Ok(Self::new(surface, &reader.file_faces()?.unwrap_or_else(plain), vertices))
    }

    fn new(surface: &Surface, faces: &FileFaces, vertices: Vec<u32>) -> Self {
        let mut normals: HashMap<(u32, u32), u32> = HashMap::new();
        let mut triangles = Vec::with_capacity(surface.triangles.len());
        for (index, (drawn, own)) in surface.triangles.iter().zip(&faces.corners).enumerate() {
            triangles.push([0, 1, 2].map(|k| {
                let welded = surface.corners[drawn[k] as usize].vertex;
                let normal = faces.normals.get(index).map_or(0, |of_triangle| {
                    let next = normals.len() as u32;
                    *normals.entry((welded, of_triangle[k])).or_insert(next)
                });
                FaceCorner { vertex: own[k], corner: drawn[k], normal }
            }));
        }
        let mut mesh = Self {
            colours: colours(surface, &triangles, vertices.len()),
            faces: Vec::new(),
            has_uvs: surface.corners.iter().any(|corner| corner.uv != [0.0; 2]),
            normal_count: normals.len(),
            vertices,
            triangles,
        };
        mesh.faces = mesh.in_order(surface, faces);
        mesh
    }

    /// The faces in the files' order.
    fn in_order(&self, surface: &Surface, faces: &FileFaces) -> Vec<Face> {
        let mut next: Vec<usize> = surface.parts.iter().map(|part| part.first_triangle as usize).collect();
        let mut ordered = Vec::new();
        for run in &faces.runs {
            let part = run.part as usize;
            let (Some(at), Some(own)) = (next.get_mut(part), surface.parts.get(part)) else { continue };
            let end = (own.first_triangle + own.triangle_count) as usize;
            for _ in 0..run.faces {
                let first = *at;
                if first >= end {
                    break;
                }
                *at += 1;
                while *at < end && faces.joined[*at] {
                    *at += 1;
                }
                let pieces = &self.triangles[first..*at];
                let material = own.material;
                match outline(pieces) {
                    Some(corners) => ordered.push(Face { material, corners }),
                    None => ordered.extend(pieces.iter().map(|piece| Face { material, corners: piece.to_vec() })),
                }
            }
        }
        ordered
    }

    /// Normals of a pose over welded vertices, weighted by the areas of the triangles about each; none where the files had
    /// none.
    pub fn normals(&self, pose: &[Vec3]) -> Vec<Vec3> {
        let mut normals = vec![Vec3::ZERO; self.normal_count];
        if normals.is_empty() {
            return normals;
        }
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|corner| pose[self.vertices[corner.vertex as usize] as usize]);
            let area = (b - a).cross(c - a);
            triangle.iter().for_each(|corner| normals[corner.normal as usize] += area);
        }
        normals.iter().map(|normal| normal.normalize_or(Vec3::Y)).collect()
    }
}

/// Colours of the files' vertices; none where all are white.
fn colours(surface: &Surface, triangles: &[[FaceCorner; 3]], vertex_count: usize) -> Vec<[u8; 4]> {
    if surface.corners.iter().all(|corner| corner.colour == [255; 4]) {
        return Vec::new();
    }
    let mut colours = vec![[255; 4]; vertex_count];
    for corner in triangles.iter().flatten() {
        colours[corner.vertex as usize] = surface.corners[corner.corner as usize].colour;
    }
    colours
}

/// The polygon that `pieces` are, from the first corner of the first on; `None` where they are none in one piece.
fn outline(pieces: &[[FaceCorner; 3]]) -> Option<Vec<FaceCorner>> {
    if let [triangle] = pieces {
        return Some(triangle.to_vec());
    }
    let edges = || pieces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let inside: std::collections::HashSet<_> = edges().collect();
    let mut after = HashMap::new();
    for (from, to) in edges().filter(|&(from, to)| !inside.contains(&(to, from))) {
        if after.insert(from, to).is_some() {
            return None;
        }
    }
    let first = pieces.first()?[0];
    let mut corners = vec![first];
    while let Some(&next) = after.get(corners.last()?).filter(|&&next| next != first) {
        if corners.len() > after.len() {
            return None;
        }
        corners.push(next);
    }
    (corners.len() == after.len() && corners.len() == pieces.len() + 2).then_some(corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(vertex: u32) -> FaceCorner {
        FaceCorner { vertex, corner: vertex, normal: 0 }
    }

    fn outlined(pieces: &[[u32; 3]]) -> Option<Vec<u32>> {
        let pieces: Vec<[FaceCorner; 3]> = pieces.iter().map(|piece| piece.map(corner)).collect();
        outline(&pieces).map(|corners| corners.iter().map(|corner| corner.vertex).collect())
    }

    #[test]
    fn polygons_come_back_from_their_triangles() {
        assert_eq!(outlined(&[[4, 5, 6]]), Some(vec![4, 5, 6]));
        assert_eq!(outlined(&[[0, 1, 2], [0, 2, 3], [0, 3, 4]]), Some(vec![0, 1, 2, 3, 4]));
        // Clipped ears.
        assert_eq!(outlined(&[[1, 2, 3], [0, 1, 3], [4, 0, 3]]), Some(vec![1, 2, 3, 4, 0]));
        // Two triangles that only touch, and one that is there twice.
        assert_eq!(outlined(&[[0, 1, 2], [2, 3, 4]]), None);
        assert_eq!(outlined(&[[0, 1, 2], [0, 1, 2]]), None);
    }
}
