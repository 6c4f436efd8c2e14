//! Writes prepared texture pairs with their true flow and ours, for `builder/appearance/benches/opencv_dis.py` to
//! compare with OpenCV.
//!
//! A measuring tool: it stops at the first thing that is amiss.

#![allow(clippy::unwrap_used)]

use job::Job;
use std::path::{Path, PathBuf};
use std::time::Instant;

use appearance::charts::Charts;
use appearance::flow::{FlowGrid, FlowOptions};
use appearance::prepare::prepare;
use appearance::textures::{TextureFiles, TextureSource};
use glam::Vec3;
use performer::figure::Figure;
use performer::perform::takes;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(out)) = (arguments.next(), arguments.next()) else {
        return Err("usage: flow_pair CAPTURE OUT [A B ...]".into());
    };
    let out = PathBuf::from(out);
    std::fs::create_dir_all(&out)?;
    let truth = Truth::new(Path::new(&folder));
    let imported =
        capture_io::import::import(&[folder], &capture_io::import::ImportOptions::default(), &Job::silent())?;
    let files = TextureFiles::new(imported.frame_textures.ok_or("no textures")?, Vec::new())?;
    let (width, height) = files.size();
    let (charts, findings) = Charts::new(&imported.capture.surface, width, height)?;
    let labels = charts.labels.iter().max();
    eprintln!("{} active texels, {labels:?} charts, {findings:?}", charts.texels().len());
    let frames: Vec<usize> = arguments.map(|a| a.parse()).collect::<Result<_, _>>()?;
    let start = Instant::now();
    let grid = FlowGrid::new(&charts, FlowOptions::default());
    eprintln!("grid {:?}", start.elapsed());
    for pair in frames.chunks_exact(2) {
        let textures = [files.read(pair[0])?, files.read(pair[1])?];
        let start = Instant::now();
        let values = [prepare(&textures[0], &charts.labels), prepare(&textures[1], &charts.labels)];
        eprintln!("prepare two {:?}", start.elapsed());
        for (k, values) in values.iter().enumerate() {
            save(&out.join(format!("pair_{}_{}_{k}.png", pair[0], pair[1])), values, width, height)?;
        }
        let truth = truth.flow(pair[0], pair[1]);
        let numbers: Vec<u8> = truth.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        std::fs::write(out.join(format!("pair_{}_{}.truth", pair[0], pair[1])), numbers)?;
        for _ in 0..3 {
            let start = Instant::now();
            let prepared = [grid.prepare(&values[0], None), grid.prepare(&values[1], None)];
            let flow = grid.flow(&prepared[0], &prepared[1]);
            eprintln!("flow {:?}", start.elapsed());
            let mut errors: Vec<f32> = (0..truth.len())
                .filter(|&k| truth[k][0].is_finite())
                .map(|k| (truth[k][0] - flow.x[k]).hypot(truth[k][1] - flow.y[k]))
                .collect();
            errors.sort_by(f32::total_cmp);
            let mean = errors.iter().sum::<f32>() / errors.len() as f32;
            eprintln!(
                "end-point error {mean:.4}, median {:.4}, 90 % {:.4}",
                errors[errors.len() / 2],
                errors[errors.len() * 9 / 10]
            );
            let numbers: Vec<u8> =
                flow.x.iter().zip(&flow.y).flat_map(|(x, y)| [*x, *y]).flat_map(f32::to_le_bytes).collect();
            std::fs::write(out.join(format!("pair_{}_{}.flow", pair[0], pair[1])), numbers)?;
        }
    }
    let active: Vec<u8> = charts.active().iter().map(|&a| u8::from(a) * 255).collect();
    image::save_buffer(out.join("active.png"), &active, width, height, image::ExtendedColorType::L8)?;
    Ok(())
}

/// Where the performer's drift has really moved each texel.
struct Truth {
    size: usize,
    /// Rest position of each texel's point, and the same with its drift, frame by frame.
    rest: Vec<Vec3>,
    drifts: Vec<Vec<Vec3>>,
    figure: Figure,
}

impl Truth {
    fn new(folder: &Path) -> Self {
        let first = image::image_dimensions(folder.join("walk/texture_00000.png")).unwrap().0 as usize;
        let figure = Figure::new(5000, first);
        let mut drifts = Vec::new();
        for take in takes(208, 50.0, 1) {
            let bytes = std::fs::read(folder.join(format!("truth/{}/drift.f32", take.name))).unwrap();
            let values: Vec<f32> = bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
            for frame in values.chunks_exact(3 * figure.mesh.positions.len()) {
                drifts.push(frame.chunks_exact(3).map(|v| Vec3::from_slice(v)).collect());
            }
        }
        let mut rest = vec![Vec3::NAN; first * first];
        for (&(index, _), &point) in figure.atlas.texels.iter().zip(&figure.texel_points) {
            rest[index as usize] = point;
        }
        Self { size: first, rest, drifts, figure }
    }

    fn seen(&self, frame: usize) -> Vec<Vec3> {
        let mut seen = self.rest.clone();
        for &(index, point) in &self.figure.atlas.texels {
            let [a, b, c] = self.figure.mesh.triangles[point.triangle as usize].map(|v| self.drifts[frame][v as usize]);
            seen[index as usize] += a * point.weights.x + b * point.weights.y + c * point.weights.z;
        }
        seen
    }

    /// w with seen_a(x) = seen_b(x + w); NaN where the point has left the chart.
    fn flow(&self, a: usize, b: usize) -> Vec<[f32; 2]> {
        let (seen_a, seen_b) = (self.seen(a), self.seen(b));
        let size = self.size;
        let at = |x: f32, y: f32| -> Option<Vec3> {
            let (ix, iy) = (x.floor(), y.floor());
            if ix < 0.0 || iy < 0.0 || ix >= (size - 1) as f32 || iy >= (size - 1) as f32 {
                return None;
            }
            let k = iy as usize * size + ix as usize;
            let (fx, fy) = (x - ix, y - iy);
            let v = seen_b[k].lerp(seen_b[k + 1], fx).lerp(seen_b[k + size].lerp(seen_b[k + size + 1], fx), fy);
            (v.is_finite()
                && seen_b[k].distance(seen_b[k + size + 1]) < 0.02
                && seen_b[k + 1].distance(seen_b[k + size]) < 0.02)
                .then_some(v)
        };
        (0..size * size)
            .map(|k| {
                let want = seen_a[k];
                let (mut x, mut y) = ((k % size) as f32, (k / size) as f32);
                if !want.is_finite() {
                    return [f32::NAN; 2];
                }
                for _ in 0..20 {
                    let (Some(v), Some(vx), Some(vy)) =
                        (at(x, y), at(x + 0.5, y).or(at(x - 0.5, y)), at(x, y + 0.5).or(at(x, y - 0.5)))
                    else {
                        return [f32::NAN; 2];
                    };
                    let (sx, sy) = (
                        if at(x + 0.5, y).is_some() { 0.5 } else { -0.5 },
                        if at(x, y + 0.5).is_some() { 0.5 } else { -0.5 },
                    );
                    let (jx, jy, r) = ((vx - v) / sx, (vy - v) / sy, want - v);
                    let (p, q, s) = (jx.dot(jx), jx.dot(jy), jy.dot(jy));
                    let (bx, by) = (jx.dot(r), jy.dot(r));
                    let det = p * s - q * q;
                    let (dx, dy) = ((s * bx - q * by) / det, (p * by - q * bx) / det);
                    x += dx.clamp(-3.0, 3.0);
                    y += dy.clamp(-3.0, 3.0);
                    if dx.hypot(dy) < 1e-3 {
                        break;
                    }
                }
                // A point that has no place in this chart leaves a rest.
                let left = at(x, y).map_or(1.0, |v| v.distance(want));
                if left < 0.001 { [x - (k % size) as f32, y - (k / size) as f32] } else { [f32::NAN; 2] }
            })
            .collect()
    }
}

fn save(path: &Path, values: &[f32], width: u32, height: u32) -> Result<(), image::ImageError> {
    let bytes: Vec<u8> = values.iter().map(|v| (v * 255.0).round() as u8).collect();
    image::save_buffer(path, &bytes, width, height, image::ExtendedColorType::L8)
}
