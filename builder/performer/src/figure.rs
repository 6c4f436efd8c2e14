//! The figure, ready to perform: surface, skin, skirt and texture, made once.

use glam::Vec3;
use rayon::prelude::*;

use super::body::{Body, edge_scale};
use super::build::{self, Build, Kind};
use super::cloth::Skirt;
use super::skinning::weights;
use super::{charts, paint};
use geometry::atlas::{Atlas, SurfacePoint};
use geometry::mesh::Mesh;
use geometry::polygonise::polygonise;
use geometry::remesh::{Target, remesh};
use rig::Influences;

/// The performer's figure in the bind pose, with all that moves and colours it.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The implicit body and its bind pose.
    pub body: Body,
    /// The surface in the bind pose, as it is modelled: on the woman's bones.
    pub mesh: Mesh,
    /// The figure's bones.
    pub build: Build,
    /// Positions of the surface in the bind pose of these bones.
    pub rest: Vec<Vec3>,
    /// Skin weights of the vertices.
    pub influences: Vec<Influences>,
    /// The skirt.
    pub skirt: Skirt,
    /// The texture atlas.
    pub atlas: Atlas,
    /// The point of the bind pose under each texel of the atlas, on the exact surface, not on the triangle.
    pub texel_points: Vec<Vec3>,
    /// Baked light of the vertices, about 0.4 to 1.
    pub shading: Vec<f32>,
}

impl Figure {
    /// The woman's figure of `vertices` vertices with a texture of `texture_size` texels a side.
    #[must_use]
    pub fn new(vertices: usize, texture_size: usize) -> Self {
        Self::of(Kind::Woman, vertices, texture_size)
    }

    /// The figure `kind` of `vertices` vertices with a texture of `texture_size` texels a side.
    #[must_use]
    pub fn of(kind: Kind, vertices: usize, texture_size: usize) -> Self {
        let body = Body::dressed(kind.dress());
        // The grid must find the cloth's thickness, and be finer than the triangles.
        let cell = 0.0075_f32.min(0.45 * (2.9 / vertices as f32).sqrt()).max(0.003);
        let (low, high) = (Vec3::new(-0.85, -0.02, -0.45), Vec3::new(0.85, 1.87, 0.45));
        let fine = polygonise(low, high, cell, |p| body.distance(p));
        let target = Target { vertices, project: &|p| body.project(p), scale: &|p| edge_scale(&body, p) };
        let mesh = remesh(&fine, &target);
        let influences = weights(&body, &mesh);
        let skirt = Skirt::new(&body, &mesh, &influences);
        let atlas = Atlas::new(&mesh, texture_size, charts::garments(&body, &mesh), |triangles| {
            charts::density(&body, &mesh, triangles)
        });
        let shading = paint::shading(&body, &mesh);
        let texel_points = atlas
            .texels
            .par_iter()
            .map(|(_, point)| {
                let flat = on_triangle(&mesh, point.triangle, point.weights);
                let round = body.project(flat);
                // Across a crease the exact surface may be far; then the triangle is what is seen.
                if round.distance(flat) < 0.01 { round } else { flat }
            })
            .collect();
        let build = Build::new(kind);
        let rest = build.shaped(&mesh.positions, &influences);
        Self { body, mesh, build, rest, influences, skirt, atlas, texel_points, shading }
    }

    /// The texture: row by row from the top, sRGB.
    #[must_use]
    pub fn texture(&self) -> Vec<[u8; 3]> {
        let colours: Vec<Vec3> = self
            .atlas
            .texels
            .par_iter()
            .zip(&self.texel_points)
            .map(|(&(_, point), &rest)| paint::colour(&self.body, rest) * self.light(point.triangle, point.weights))
            .collect();
        let mut image = vec![[128; 3]; self.atlas.size * self.atlas.size];
        for (&(index, _), colour) in self.atlas.texels.iter().zip(&colours) {
            image[index as usize] = bytes(*colour);
        }
        self.atlas.dilate(&mut image);
        image
    }

    /// The point of the bind pose at barycentric `weights` of `triangle`.
    #[must_use]
    pub fn rest_point(&self, triangle: u32, weights: Vec3) -> Vec3 {
        on_triangle(&self.mesh, triangle, weights)
    }

    /// Baked light at barycentric `weights` of `triangle`.
    #[must_use]
    pub fn light(&self, triangle: u32, weights: Vec3) -> f32 {
        let [a, b, c] = self.mesh.triangles[triangle as usize].map(|v| self.shading[v as usize]);
        a * weights.x + b * weights.y + c * weights.z
    }

    /// What `values` of the vertices come to at a point of the surface.
    pub(super) fn at(&self, values: &[Vec3], point: SurfacePoint) -> Vec3 {
        let [a, b, c] = self.mesh.triangles[point.triangle as usize].map(|v| values[v as usize]);
        a * point.weights.x + b * point.weights.y + c * point.weights.z
    }

    /// Skinned positions in the pose of `skin`, before the skirt has its say.
    #[must_use]
    pub fn skinned(&self, skin: &rig::Skin) -> Vec<Vec3> {
        build::skinned(&self.rest, &self.influences, skin)
    }
}

fn on_triangle(mesh: &Mesh, triangle: u32, weights: Vec3) -> Vec3 {
    let [a, b, c] = mesh.triangles[triangle as usize].map(|v| mesh.positions[v as usize]);
    a * weights.x + b * weights.y + c * weights.z
}

/// A colour of 0 to 1 as bytes.
#[must_use]
pub fn bytes(colour: Vec3) -> [u8; 3] {
    (colour.clamp(Vec3::ZERO, Vec3::ONE) * 255.0).round().to_array().map(|c| c as u8)
}
