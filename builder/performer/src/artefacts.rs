//! What makes a capture differ from what happened, each with its ground truth.

use std::str::FromStr;

use glam::Vec3;
use rayon::prelude::*;

use super::figure::{Figure, bytes};
use super::paint;
use super::perform::{PerformedFrame, Take};
use geometry::atlas::SurfacePoint;
use geometry::mesh::vertex_normals;
use kernels::random::{mix, noise1, noise4, signed, vector_noise};

/// Height of the reconstruction noise, in metres.
pub const NOISE: f32 = 0.001;
/// Longest way that the texture slides along the surface, in metres.
pub const DRIFT: f32 = 0.01;

/// Which artefacts a capture has. None by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Artefacts {
    /// Reconstruction noise: about 1 mm across the surface, correlated over centimetres and frames.
    pub noise: bool,
    /// Tracking drift: vertices slide up to 1 cm along the surface, smoothly in space and time.
    pub drift: bool,
    /// A key light and a camera fixed in the room, and an exposure that wanders.
    pub light: bool,
    /// Some frames have a patch that no camera saw: black in the texture.
    pub holes: bool,
}

impl Artefacts {
    /// Everything on.
    pub const ALL: Self = Self { noise: true, drift: true, light: true, holes: true };

    /// Whether every frame needs a texture of its own.
    #[must_use]
    pub fn change_texture(&self) -> bool {
        self.drift || self.light || self.holes
    }
}

impl FromStr for Artefacts {
    type Err = String;

    /// `none`, `all`, or names from noise, drift, light and holes with commas between.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut artefacts = Self::default();
        for word in text.split(',').map(str::trim).filter(|word| !word.is_empty()) {
            match word {
                "none" => artefacts = Self::default(),
                "all" => artefacts = Self::ALL,
                "noise" => artefacts.noise = true,
                "drift" => artefacts.drift = true,
                "light" => artefacts.light = true,
                "holes" => artefacts.holes = true,
                _ => {
                    return Err(format!(
                        "there is no artefact {word:?}; choose from noise, drift, light, holes, all, none"
                    ));
                }
            }
        }
        Ok(artefacts)
    }
}

/// Where each vertex has slid to: a point of the surface, and the way there in the bind pose.
#[derive(Clone, Debug)]
pub struct Drift {
    /// Triangle and barycentric coordinates of each vertex's place.
    pub places: Vec<(u32, Vec3)>,
    /// From the vertex to its place, in the bind pose, in metres.
    pub ways: Vec<Vec3>,
}

/// The drift of a frame, numbered over the whole capture; sequences are tracked one by one.
#[must_use]
pub fn drift(figure: &Figure, around: &[Vec<u32>], normals: &[Vec3], take: &Take, frame: usize, fps: f32) -> Drift {
    let time = frame as f32 / fps;
    let seed = mix(take.seed, 500);
    let places: Vec<(u32, Vec3)> = (0..figure.mesh.positions.len())
        .map(|vertex| {
            let (p, normal) = (figure.mesh.positions[vertex], normals[vertex]);
            let field = vector_noise(seed, p * 4.0, time * 0.8) * DRIFT;
            let way = (field - normal * field.dot(normal)).clamp_length_max(DRIFT);
            slide(figure, &around[vertex], p + way)
        })
        .collect();
    let ways = places
        .iter()
        .zip(&figure.mesh.positions)
        .map(|(&(triangle, weights), &p)| figure.rest_point(triangle, weights) - p)
        .collect();
    Drift { places, ways }
}

/// The point of the triangles `around` a vertex that is nearest to `wanted`.
fn slide(figure: &Figure, around: &[u32], wanted: Vec3) -> (u32, Vec3) {
    let mut best = (f32::INFINITY, (0, Vec3::X));
    for &triangle in around {
        let [a, b, c] = figure.mesh.triangles[triangle as usize].map(|v| figure.mesh.positions[v as usize]);
        let normal = (b - a).cross(c - a);
        let area = normal.length_squared().max(1e-20);
        let raw = Vec3::new(
            (c - b).cross(wanted - b).dot(normal) / area,
            (a - c).cross(wanted - c).dot(normal) / area,
            (b - a).cross(wanted - a).dot(normal) / area,
        );
        let inside = raw.max(Vec3::ZERO);
        let weights = inside / inside.element_sum().max(1e-9);
        let distance = (a * weights.x + b * weights.y + c * weights.z).distance(wanted);
        if distance < best.0 {
            best = (distance, (triangle, weights));
        }
    }
    best.1
}

/// Moves `positions` to where they have drifted on the same surface.
pub fn apply_drift(figure: &Figure, drift: &Drift, positions: &mut [Vec3]) {
    let before = positions.to_vec();
    for (position, &(triangle, weights)) in positions.iter_mut().zip(&drift.places) {
        let [a, b, c] = figure.mesh.triangles[triangle as usize].map(|v| before[v as usize]);
        *position = a * weights.x + b * weights.y + c * weights.z;
    }
}

/// How far the reconstruction is off along the normal at each vertex of a frame, in metres.
#[must_use]
pub fn noise(figure: &Figure, take: &Take, frame: usize, fps: f32) -> Vec<f32> {
    let seed = mix(take.seed, 501);
    let time = frame as f32 / fps;
    figure.mesh.positions.iter().map(|&p| 1.6 * NOISE * noise4(seed, p * 28.0, time * 7.0)).collect()
}

/// Moves `positions` by `heights` along their normals.
pub fn apply_noise(figure: &Figure, heights: &[f32], positions: &mut [Vec3]) {
    let normals = vertex_normals(positions, &figure.mesh.triangles);
    for ((position, normal), height) in positions.iter_mut().zip(&normals).zip(heights) {
        *position += *normal * *height;
    }
}

/// The light of a frame.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Light {
    /// Unit vector towards the key light, fixed in the room.
    pub key: Vec3,
    /// Unit vector towards the camera, fixed in the room.
    pub camera: Vec3,
    /// What the cameras multiply all colours with.
    pub exposure: f32,
}

impl Light {
    /// The light of a frame of a take.
    #[must_use]
    pub fn new(take: &Take, frame: usize, fps: f32) -> Self {
        let time = frame as f32 / fps;
        Self {
            key: Vec3::new(0.55, 0.62, 0.56).normalize_or(Vec3::Y),
            camera: Vec3::new(-0.3, 0.1, 0.95).normalize_or(Vec3::Z),
            exposure: 1.0 + 0.06 * noise1(mix(take.seed, 502), time * 0.7),
        }
    }

    /// What the colour of a surface facing `normal` is multiplied with, and what is added to it.
    #[must_use]
    pub fn shade(&self, normal: Vec3) -> (f32, f32) {
        let half = (self.key + self.camera).normalize_or(Vec3::Y);
        let gain = 0.8 + 0.32 * normal.dot(self.key).max(0.0);
        (gain * self.exposure, 0.09 * normal.dot(half).max(0.0).powi(18) * self.exposure)
    }
}

/// A patch that was not seen: a ball around a point of the surface in the bind pose.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Hole {
    /// Its middle in the bind pose, in metres.
    pub centre: Vec3,
    /// Its radius in metres.
    pub radius: f32,
}

impl Hole {
    /// The hole of a frame of a take, if it has one: runs of 12 frames, one run in five.
    #[must_use]
    pub fn new(figure: &Figure, take: &Take, frame: usize) -> Option<Self> {
        let seed = mix(take.seed, 503);
        let run = (frame / 12) as u64;
        if signed(seed, run * 3) > -0.6 {
            return None;
        }
        let vertex = mix(seed, run * 3 + 1) as usize % figure.mesh.positions.len();
        let radius = 0.06 + 0.03 * signed(seed, run * 3 + 2);
        Some(Self { centre: figure.mesh.positions[vertex], radius })
    }
}

/// The shade where there is no light: colours as they are painted.
pub(super) const UNLIT: (f32, f32) = (1.0, 0.0);

/// The colour of a texel at `point` of the surface that shows the point `rest` of the body in a shade of [`Light::shade`].
pub(super) fn shown(figure: &Figure, point: SurfacePoint, rest: Vec3, (gain, added): (f32, f32)) -> Vec3 {
    let painted = paint::colour(&figure.body, rest) * figure.light(point.triangle, point.weights);
    painted * gain + Vec3::splat(added)
}

/// The texture of one frame, and which texels are hidden (255) where there is a hole.
#[must_use]
pub fn frame_texture(
    figure: &Figure,
    frame: &PerformedFrame,
    drift: Option<&Drift>,
    light: Option<&Light>,
    hole: Option<&Hole>,
) -> (Vec<[u8; 3]>, Option<Vec<u8>>) {
    let normals = vertex_normals(&frame.positions, &figure.mesh.triangles);
    let texels: Vec<([u8; 3], bool)> = figure
        .atlas
        .texels
        .par_iter()
        .zip(&figure.texel_points)
        .map(|(&(_, point), &rest)| {
            // The point of the body that is seen where the tracker believes this texel to be.
            let mut rest = rest;
            if let Some(drift) = drift {
                rest += figure.at(&drift.ways, point);
            }
            if hole.is_some_and(|hole| rest.distance(hole.centre) < hole.radius) {
                return ([0; 3], true);
            }
            let shade = light.map_or(UNLIT, |light| light.shade(figure.at(&normals, point).normalize_or(Vec3::Y)));
            let colour = shown(figure, point, rest, shade);
            (bytes(colour), false)
        })
        .collect();
    let size = figure.atlas.size;
    let mut image = vec![[128; 3]; size * size];
    let mut mask = hole.map(|_| vec![0; size * size]);
    for (&(index, _), &(colour, hidden)) in figure.atlas.texels.iter().zip(&texels) {
        image[index as usize] = colour;
        if let (Some(mask), true) = (&mut mask, hidden) {
            mask[index as usize] = 255;
        }
    }
    figure.atlas.dilate(&mut image);
    (image, mask)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read() {
        assert_eq!("noise, drift".parse(), Ok(Artefacts { noise: true, drift: true, ..Artefacts::default() }));
        assert_eq!("all".parse(), Ok(Artefacts::ALL));
        assert!("nose".parse::<Artefacts>().unwrap_err().contains("nose"));
    }
}
