//! The files that a capture came from: what an export needs beside the welded mesh so that what goes out is what came in.

use glam::{DVec3, Vec3};

use crate::surface::Surface;

/// What is known of the files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files {
    /// Their faces; `None` where they follow from the drawn mesh: see [`FileFaces::of_surface`].
    pub faces: Option<FileFaces>,
    /// Where and in which units they are.
    pub place: FilePlace,
}

/// The place, the unit and the axes of the files' coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilePlace {
    /// What was taken off all positions, in metres, +Y up.
    pub offset: DVec3,
    /// Metres per unit of the files.
    pub unit: f64,
    /// Whether +Z points up in the files, +Y away from the viewer; otherwise +Y points up.
    pub z_up: bool,
}

impl Default for FilePlace {
    fn default() -> Self {
        Self { offset: DVec3::ZERO, unit: 1.0, z_up: false }
    }
}

impl FilePlace {
    /// Whether the files' coordinates are those of the capture.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// A position of the capture in the files' coordinates.
    #[must_use]
    pub fn position(&self, position: Vec3) -> DVec3 {
        self.turned(position.as_dvec3() + self.offset) / self.unit
    }

    /// A direction of the capture along the files' axes.
    #[must_use]
    pub fn direction(&self, direction: Vec3) -> DVec3 {
        self.turned(direction.as_dvec3())
    }

    fn turned(&self, v: DVec3) -> DVec3 {
        if self.z_up { DVec3::new(v.x, -v.z, v.y) } else { v }
    }
}

/// Consecutive faces of the files in one part of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceRun {
    /// Index of the part in [`Surface::parts`].
    pub part: u32,
    /// Number of faces.
    pub faces: u32,
}

/// The faces of the files, told by the triangles of the surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileFaces {
    /// File vertex of each corner of each triangle.
    pub corners: Vec<[u32; 3]>,
    /// Whether each triangle is a piece of the same polygon as the triangle before it.
    pub joined: Vec<bool>,
    /// The files' order of faces. Within a part they keep their order.
    pub runs: Vec<FaceRun>,
    /// Which corners about a welded vertex share a normal: numbered from 0 about each vertex, in the order of the triangles.
    /// Empty where the files have no normals.
    pub normals: Vec<[u32; 3]>,
}

impl FileFaces {
    /// The faces where nothing else is known: triangles in their own order, each over the first of the file vertices that
    /// were welded into its vertices. `file_vertices` has the welded vertex of each file vertex.
    #[must_use]
    pub fn of_surface(surface: &Surface, file_vertices: &[u32], vertex_count: usize) -> Self {
        let mut first = vec![None; vertex_count];
        for (file_vertex, &vertex) in (0..).zip(file_vertices) {
            if let Some(first) = first.get_mut(vertex as usize) {
                first.get_or_insert(file_vertex);
            }
        }
        let of_corner = |corner: u32| {
            let vertex = surface.corners.get(corner as usize).map_or(0, |corner| corner.vertex);
            first.get(vertex as usize).copied().flatten().unwrap_or(0)
        };
        Self {
            corners: surface.triangles.iter().map(|triangle| triangle.map(of_corner)).collect(),
            joined: vec![false; surface.triangles.len()],
            runs: runs_of_parts(surface),
            normals: Vec::new(),
        }
    }

    /// What of them does not follow the surface and the welded vertex of each file vertex, if anything.
    ///
    /// # Errors
    /// The first contradiction.
    pub fn check(&self, surface: &Surface, file_vertices: &[u32]) -> Result<(), &'static str> {
        let count = surface.triangles.len();
        if self.corners.len() != count || self.joined.len() != count {
            return Err("have another number of triangles");
        }
        if !self.normals.is_empty() && self.normals.len() != count {
            return Err("have another number of normals");
        }
        for (drawn, own) in surface.triangles.iter().zip(&self.corners) {
            for (&corner, &file_vertex) in drawn.iter().zip(own) {
                let vertex = surface.corners.get(corner as usize).map(|corner| corner.vertex);
                if vertex.is_none() || file_vertices.get(file_vertex as usize).copied() != vertex {
                    return Err("have a corner that was welded into another vertex");
                }
            }
        }
        let mut left = Vec::with_capacity(surface.parts.len());
        for part in &surface.parts {
            let (first, end) = (part.first_triangle as usize, (part.first_triangle + part.triangle_count) as usize);
            let joined = self.joined.get(first..end).ok_or("leave triangles out")?;
            if joined.first() == Some(&true) {
                return Err("have a polygon in two parts");
            }
            left.push(joined.iter().filter(|&&joined| !joined).count() as u64);
        }
        for run in &self.runs {
            let left = left.get_mut(run.part as usize).ok_or("name a part that does not exist")?;
            *left = left.checked_sub(run.faces.into()).ok_or("name more faces of a part than it has")?;
        }
        if left.iter().any(|&left| left > 0) { Err("leave faces out") } else { Ok(()) }
    }
}

/// All faces of each part, part after part, where each triangle is a face.
fn runs_of_parts(surface: &Surface) -> Vec<FaceRun> {
    (0..).zip(&surface.parts).map(|(part, own)| FaceRun { part, faces: own.triangle_count }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::topology::Topology;

    #[test]
    fn places_turn_and_scale_back() {
        let place = FilePlace { offset: DVec3::new(1000.0, 20.0, -3.0), unit: 0.001, z_up: true };
        // A file's (x, y, z) became (x, z, -y) in metres, and the offset was taken off.
        let file = DVec3::new(1_000_500.0, 2_750.0, 20_250.0);
        let metres = DVec3::new(file.x, file.z, -file.y) * place.unit - place.offset;
        assert!(place.position(metres.as_vec3()).distance(file) < 1e-2);
        assert_eq!(place.direction(Vec3::Y), DVec3::Z);
        assert!(!place.is_plain() && FilePlace::default().is_plain());
        assert_eq!(FilePlace::default().position(Vec3::ONE), DVec3::ONE);
    }

    #[test]
    fn faces_that_do_not_follow_the_surface_are_named() {
        let topology = Topology::new(4, vec![[0, 1, 2], [0, 2, 3]], vec![1.0; 4]).unwrap();
        let surface = Surface::plain(&topology);
        // The files have vertex 2 twice.
        let file_vertices = [3, 2, 1, 0, 2];
        let mut faces = FileFaces::of_surface(&surface, &file_vertices, 4);
        assert_eq!(faces.corners, [[3, 2, 1], [3, 1, 0]]);
        assert_eq!(faces.check(&surface, &file_vertices), Ok(()));
        faces.corners[1][1] = 4;
        faces.joined[1] = true;
        assert_eq!(faces.check(&surface, &file_vertices), Err("name more faces of a part than it has"));
        faces.runs[0].faces = 1;
        assert_eq!(faces.check(&surface, &file_vertices), Ok(()));
        faces.corners[1][1] = 2;
        assert!(faces.check(&surface, &file_vertices).unwrap_err().contains("another vertex"));
        faces.corners[1][1] = 5;
        assert!(faces.check(&surface, &file_vertices).unwrap_err().contains("another vertex"));
        faces.corners[1][1] = 4;
        faces.joined[0] = true;
        assert!(faces.check(&surface, &file_vertices).unwrap_err().contains("two parts"));
    }
}
