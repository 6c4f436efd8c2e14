//! The built-in performer.

pub mod body;
pub mod ik;
pub mod mesh;
pub mod polygonise;
pub mod random;
pub mod remesh;
pub mod sdf;
pub mod skeleton;
pub mod skirt;

/// The rest mesh
#[must_use]
pub fn rest_mesh(vertices: usize) -> mesh::Mesh {
    let body = body::Body::default();
    let fine = polygonise::polygonise(glam::Vec3::new(-0.85, -0.02, -0.45), glam::Vec3::new(0.85, 1.85, 0.45), 0.008, |p| body.distance(p));
    remesh::remesh(
        &fine,
        &remesh::Target { vertices, project: &|p| body.project(p), scale: &|p| body::edge_scale(&body, p) },
    )
}
