//! The performer as a volumetric studio would deliver it: every frame, or every few of them, polygonised anew, with its own atlas
//! and texture, noise, and webs where parts nearly touch; and beside it the truth.
//!
//! The folder `truth` is the ordinary capture of the same performance. `truth/scan/TAKE/frame_%05d.bin` says where each vertex of a
//! scan lies on it: little-endian, `u32` triangle, three `f32` barycentric coordinates, `f32` metres off.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use geometry::atlas::Atlas;
use geometry::charts;
use geometry::closest::closest_of_triangle;
use geometry::kd::KdTree;
use geometry::mesh::{Mesh, vertex_normals};
use geometry::polygonise::polygonise;
use geometry::remesh::{Target, remesh};
use glam::{Quat, Vec3};
use image::{ExtendedColorType, ImageEncoder, codecs::png};
use job::files::write_whole;
use kernels::random::{mix, signed};
use rayon::prelude::*;

use super::figure::{Figure, bytes};
use super::lattice::Lattice;
use super::motion::BEHAVIOURS;
use super::perform::{PerformedFrame, Take, perform, takes};
use super::{PerformerError, PerformerOptions, Progress, Summary, check, paint, write_performer};

/// Metres between points of the lattice: the skirt is thinner, but grown by twice [`GROWN`] it is not.
const CELL: f32 = 0.012;
/// Metres by which the body is grown before it is polygonised, and shrunk again after: what is nearer than twice that is fused.
const GROWN: f32 = 0.006;
/// Metres that a unit of difference between normals counts where the nearest point is looked for: cloth has two sides.
const NORMAL: f32 = 0.05;

/// How the performance is scanned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScannedOptions {
    /// Frames that share a mesh; 1 where every frame has its own.
    pub group: usize,
    /// Standard deviation of the noise along normals, metres.
    pub noise: f32,
}

impl Default for ScannedOptions {
    fn default() -> Self {
        Self { group: 1, noise: 0.001 }
    }
}

/// A mesh over the figure: a point of the figure's surface for each vertex.
struct ScanMesh {
    triangles: Vec<[u32; 3]>,
    points: Vec<Point>,
    atlas: Atlas,
}

#[derive(Clone, Copy)]
struct Point {
    triangle: u32,
    weights: Vec3,
    off: f32,
}

/// Performs with `options`, and writes the scan into the folder `out` with its truth beside it. Artefacts are of the truth's own
/// textures alone.
///
/// # Errors
/// Options out of range, or a file that cannot be written.
pub fn write_scanned(
    options: &PerformerOptions,
    scanned: &ScannedOptions,
    out: &Path,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Summary, PerformerError> {
    check(options)?;
    let noise = f64::from(scanned.noise) * 1000.0;
    for (option, value, low, high) in [("--noise", noise, 0.0, 20.0), ("--group", scanned.group as f64, 1.0, 10_000.0)]
    {
        if !(low..=high).contains(&value) {
            return Err(PerformerError::Option { option, value, low, high });
        }
    }
    let truth = write_performer(options, &out.join("truth"), &|_| {})?;
    let figure = Figure::of(options.figure, options.vertices, options.texture_size);
    let done = AtomicUsize::new(0);
    let all = takes(options.frames, options.fps, options.seed);
    for take in &all {
        for folder in [out.join(&take.name), out.join("truth/scan").join(&take.name)] {
            fs::create_dir_all(&folder).map_err(|source| PerformerError::Write { path: folder.clone(), source })?;
        }
        let frames = perform(&figure, take, options.fps);
        let writer = Writer { figure: &figure, take, options, noise: scanned.noise, out };
        frames.par_chunks(scanned.group).enumerate().try_for_each(|(group, frames)| {
            let first = group * scanned.group;
            let mesh = writer.mesh(first, &frames[0]);
            for (k, frame) in frames.iter().enumerate() {
                writer.frame(first + k, frame, &mesh)?;
                let frames_done = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress(Progress { frames_done, frames: options.frames });
            }
            Ok(())
        })?;
    }
    let path = out.join("capture.toml");
    write_whole(&path, manifest(&all, options.fps).as_bytes())
        .map_err(|source| PerformerError::Write { path: path.clone(), source })?;
    Ok(Summary { manifest: path, ..truth })
}

fn manifest(all: &[Take], fps: f32) -> String {
    let mut text = format!("name = \"Performer\"\nfps = {fps}\nup = \"y\"\nunit = 1.0\n");
    for take in all {
        let (name, last, label) = (&take.name, take.frames - 1, BEHAVIOURS[take.behaviour].0);
        text.push_str(&format!(
            "\n[[sequence]]\nname = \"{name}\"\ninput = \"{name}/frame_%05d.ply:0:{last}\"\nlabels = [\"{label}\"]\ncyclic = \
             false\ntexture = \"{name}/texture_%05d.png:0:{last}\"\n"
        ));
    }
    text
}

struct Writer<'a> {
    figure: &'a Figure,
    take: &'a Take,
    options: &'a PerformerOptions,
    noise: f32,
    out: &'a Path,
}

impl Writer<'_> {
    /// The mesh of a group, from its first frame, number `index` of the take.
    fn mesh(&self, index: usize, frame: &PerformedFrame) -> ScanMesh {
        let seed = mix(self.take.seed, 7_000 + index as u64);
        let random = |n: u64| signed(seed, n);
        // Every lattice lies otherwise.
        let turn = Quat::from_euler(glam::EulerRot::YXZ, 3.0 * random(0), 0.3 * random(1), 0.3 * random(2));
        let turned: Vec<Vec3> = frame.positions.iter().map(|p| turn * *p).collect();
        let lattice = Lattice::new(&turned, &self.figure.mesh.triangles, CELL, GROWN + 2.0 * CELL);
        let grown = polygonise(lattice.low, lattice.high, CELL, |p| lattice.at_point(p) - GROWN);
        let vertices = (self.options.vertices as f32 * (1.0 + 0.25 * random(3))) as usize;
        let target = Target { vertices, project: &|p| lattice.project(p, GROWN), scale: &|_| 1.0 };
        let mut mesh = remesh(&grown, &target);
        let normals = mesh.normals();
        let back = turn.inverse();
        mesh.positions.iter_mut().zip(&normals).for_each(|(p, n)| *p = back * (*p - *n * GROWN));
        let points = points(self.figure, &frame.positions, &mesh);
        let side = |triangle: u32| {
            let (_, normal) = charts::centre_and_normal(&mesh, triangle);
            let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
            2 * axis + usize::from(normal[axis] < 0.0)
        };
        let labels = (0..mesh.triangles.len() as u32).map(side).collect();
        let atlas = Atlas::new(&mesh, self.options.texture_size, charts::cut(&mesh, labels), |_| 1.0);
        ScanMesh { triangles: mesh.triangles, points, atlas }
    }

    fn frame(&self, index: usize, frame: &PerformedFrame, mesh: &ScanMesh) -> Result<(), PerformerError> {
        let figure = self.figure;
        let normals = vertex_normals(&frame.positions, &figure.mesh.triangles);
        let seed = mix(self.take.seed, 9_000_000 + index as u64);
        let (mut places, mut truth) = (Vec::with_capacity(mesh.points.len()), Vec::new());
        for (k, point) in mesh.points.iter().enumerate() {
            let surface = geometry::atlas::SurfacePoint { triangle: point.triangle, weights: point.weights };
            let normal = figure.at(&normals, surface).normalize_or(Vec3::Y);
            // The sum of four has nearly a normal distribution, of variance 4/3.
            let noise: f32 = (0..4).map(|n| signed(seed, 4 * k as u64 + n)).sum::<f32>() * 0.866 * self.noise;
            places.push(figure.at(&frame.positions, surface) + normal * (point.off + noise));
            truth.extend(point.triangle.to_le_bytes());
            truth.extend(point.weights.to_array().into_iter().chain([point.off + noise]).flat_map(f32::to_le_bytes));
        }
        let write = |path: &Path, bytes: &[u8]| {
            fs::write(path, bytes).map_err(|source| PerformerError::Write { path: path.to_owned(), source })
        };
        let name = &self.take.name;
        write(&self.out.join(format!("truth/scan/{name}/frame_{index:05}.bin")), &truth)?;
        write(&self.out.join(format!("{name}/frame_{index:05}.ply")), &ply(&places, mesh))?;
        let path = self.out.join(format!("{name}/texture_{index:05}.png"));
        let mut file = Vec::new();
        let size = mesh.atlas.size as u32;
        png::PngEncoder::new_with_quality(&mut file, png::CompressionType::Fast, png::FilterType::Adaptive)
            .write_image(self.texture(mesh).as_flattened(), size, size, ExtendedColorType::Rgb8)
            .map_err(|source| PerformerError::Image { path: path.clone(), source })?;
        write(&path, &file)
    }

    /// What is painted on the figure, under each texel.
    fn texture(&self, mesh: &ScanMesh) -> Vec<[u8; 3]> {
        let figure = self.figure;
        let rest: Vec<Vec3> = mesh.points.iter().map(|p| figure.rest_point(p.triangle, p.weights)).collect();
        let light: Vec<f32> = mesh.points.iter().map(|p| figure.light(p.triangle, p.weights)).collect();
        let colour = |point: &geometry::atlas::SurfacePoint| {
            let [a, b, c] = mesh.triangles[point.triangle as usize].map(|v| v as usize);
            let w = point.weights;
            let place = rest[a] * w.x + rest[b] * w.y + rest[c] * w.z;
            paint::colour(&figure.body, place) * (light[a] * w.x + light[b] * w.y + light[c] * w.z)
        };
        let mut image = vec![[128; 3]; mesh.atlas.size * mesh.atlas.size];
        let colours: Vec<[u8; 3]> = mesh.atlas.texels.par_iter().map(|(_, point)| bytes(colour(point))).collect();
        mesh.atlas.texels.iter().zip(colours).for_each(|((k, _), colour)| image[*k as usize] = colour);
        mesh.atlas.dilate(&mut image);
        image
    }
}

/// The point of the figure in `pose` that each vertex of `mesh` lies on.
fn points(figure: &Figure, pose: &[Vec3], mesh: &Mesh) -> Vec<Point> {
    let triangles = &figure.mesh.triangles;
    let (normals, around) = (vertex_normals(pose, triangles), figure.mesh.triangles_of_vertices());
    let joined = |p: Vec3, n: Vec3| {
        let n = n * NORMAL;
        [p.x, p.y, p.z, n.x, n.y, n.z]
    };
    let tree = KdTree::new(&pose.iter().zip(&normals).map(|(p, n)| joined(*p, *n)).collect::<Vec<_>>());
    let find = |(&place, &normal): (&Vec3, &Vec3)| -> Point {
        let vertex = tree.nearest(joined(place, normal), f32::INFINITY).map_or(0, |found| found.0);
        let mut best = (f32::INFINITY, Point { triangle: 0, weights: Vec3::X, off: 0.0 });
        for &triangle in &around[vertex as usize] {
            let corners = triangles[triangle as usize];
            let [a, b, c] = corners.map(|v| pose[v as usize]);
            let weights = closest_of_triangle(place, [a, b, c]);
            let point = a * weights.x + b * weights.y + c * weights.z;
            if point.distance(place) < best.0 {
                let [x, y, z] = corners.map(|v| normals[v as usize]);
                let normal = (x * weights.x + y * weights.y + z * weights.z).normalize_or(Vec3::Y);
                best = (point.distance(place), Point { triangle, weights, off: (place - point).dot(normal) });
            }
        }
        best.1
    };
    let own = mesh.normals();
    mesh.positions.iter().zip(&own).collect::<Vec<_>>().into_par_iter().map(find).collect()
}

fn ply(places: &[Vec3], mesh: &ScanMesh) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement \
         face {}\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n",
        places.len(),
        mesh.triangles.len()
    )
    .into_bytes();
    file.extend(places.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
    for (triangle, uvs) in mesh.triangles.iter().zip(&mesh.atlas.uvs) {
        file.push(3);
        file.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
        file.push(6);
        // PLY counts v upwards.
        file.extend(uvs.iter().flat_map(|uv| [uv.x, 1.0 - uv.y]).flat_map(f32::to_le_bytes));
    }
    file
}
