//! The faces of the files, as an export needs them: which file vertex each corner is, which triangles are one polygon, in
//! which order they stand, and which corners share a normal.

use actor::files::{FaceRun, FileFaces};
use actor::surface::Surface;
use glam::Vec3;

use super::mesh::{FileMesh, FileTriangle};

/// Normals about a vertex that differ by less are one: they were rounded.
const SAME_NORMAL: f32 = 1e-3;
/// No vertex has more normals that mean something.
const MOST_NORMALS: usize = 64;

/// The faces of `mesh`, of which `triangles` are drawn, in the order of `surface`; `None` where they are the drawn triangles
/// in their order, over the files' vertices.
pub(super) fn faces(
    mesh: &FileMesh,
    triangles: &[FileTriangle],
    surface: &Surface,
    vertex_of_file_vertex: &[u32],
) -> Option<FileFaces> {
    let file_vertex = |corner: usize| mesh.faces.vertices.get(corner).copied().unwrap_or(0);
    let joined = (0..triangles.len()).map(|k| k > 0 && triangles[k - 1].face == triangles[k].face).collect();
    let faces = FileFaces {
        corners: triangles.iter().map(|triangle| triangle.corners.map(file_vertex)).collect(),
        joined,
        runs: runs(mesh, triangles, surface),
        normals: normals(mesh, triangles, vertex_of_file_vertex),
    };
    let vertices = vertex_of_file_vertex.iter().max().map_or(0, |&vertex| vertex as usize + 1);
    let plain = FileFaces::of_surface(surface, vertex_of_file_vertex, vertices);
    (faces != plain).then_some(faces)
}

/// The files' order of the faces that are drawn.
fn runs(mesh: &FileMesh, triangles: &[FileTriangle], surface: &Surface) -> Vec<FaceRun> {
    let mut part_of_face = vec![None; mesh.faces.sizes.len()];
    for (part, own) in (0..).zip(&surface.parts) {
        let first = own.first_triangle as usize;
        for triangle in triangles.get(first..first + own.triangle_count as usize).unwrap_or_default() {
            part_of_face[triangle.face as usize] = Some(part);
        }
    }
    let mut runs: Vec<FaceRun> = Vec::new();
    for part in part_of_face.into_iter().flatten() {
        match runs.last_mut() {
            Some(run) if run.part == part => run.faces += 1,
            _ => runs.push(FaceRun { part, faces: 1 }),
        }
    }
    runs
}

/// Which corners share a normal, numbered about each welded vertex; empty where the files have none.
fn normals(mesh: &FileMesh, triangles: &[FileTriangle], vertex_of_file_vertex: &[u32]) -> Vec<[u32; 3]> {
    if mesh.normals.is_empty() {
        return Vec::new();
    }
    let mut about: Vec<Vec<Vec3>> = vec![Vec::new(); vertex_of_file_vertex.len()];
    let mut number = |corner: usize| -> u32 {
        let normal = mesh.normals.get(corner).map_or(Vec3::ZERO, |&normal| Vec3::from(normal).normalize_or_zero());
        let file_vertex = mesh.faces.vertices.get(corner).map_or(0, |&vertex| vertex as usize);
        let vertex = vertex_of_file_vertex.get(file_vertex).copied().unwrap_or(0);
        let known = &mut about[vertex as usize];
        let same = known.iter().position(|other| other.distance(normal) < SAME_NORMAL);
        if same.is_none() && known.len() < MOST_NORMALS {
            known.push(normal);
        }
        same.unwrap_or(known.len() - 1) as u32
    };
    triangles.iter().map(|triangle| triangle.corners.map(&mut number)).collect()
}
