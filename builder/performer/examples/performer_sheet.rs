//! Draws the built-in performer into contact sheets: `performer_sheet OUT_FOLDER [FRAMES]`.
//!
//! One PNG per sequence with poses from the front and from three quarters, one of the bind pose with its edges, and the
//! texture. A plain software rasteriser, so that it runs anywhere.

use std::path::PathBuf;

use geometry::raster::Canvas;
use glam::{Quat, Vec3, Vec3Swizzles};
use performer::figure::Figure;
use performer::{PerformerOptions, perform};
use rayon::prelude::*;

const CELL: (usize, usize) = (300, 400);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let out = PathBuf::from(arguments.next().unwrap_or_else(|| "performer_sheets".into()));
    let frames: usize = arguments.next().map_or(Ok(1200), |text| text.parse())?;
    let only = arguments.next();
    std::fs::create_dir_all(&out)?;
    let options = PerformerOptions { frames, ..PerformerOptions::default() };
    let figure = Figure::new(options.vertices, options.texture_size);
    let texture = figure.texture();
    let size = figure.atlas.size as u32;
    image::save_buffer(out.join("texture.png"), texture.as_flattened(), size, size, image::ColorType::Rgb8)?;
    let rest = &figure.mesh.positions;
    let mut sheet = Sheet::new(4, 1, (600, 820));
    for (column, yaw) in [0.0, 0.7, 1.57, 2.7].into_iter().enumerate() {
        sheet.draw(
            &figure,
            &texture,
            rest,
            column,
            0,
            &View { yaw, centre: Vec3::Y * 0.92, height: 1.95, clay: column == 1 },
        );
    }
    sheet.save(&out.join("bind.png"))?;
    let mut sheet = Sheet::new(3, 1, (600, 600));
    for (column, yaw) in [0.0, 0.6, 1.57].into_iter().enumerate() {
        sheet.draw(&figure, &texture, rest, column, 0, &View { yaw, centre: Vec3::Y * 1.62, height: 0.5, clay: false });
    }
    sheet.save(&out.join("face.png"))?;
    let takes = perform::takes(frames, options.fps, options.seed);
    takes.par_iter().filter(|take| only.as_ref().is_none_or(|only| &take.name == only)).try_for_each(|take| {
        let performed = perform::perform(&figure, take, options.fps);
        let columns = 8;
        let mut sheet = Sheet::new(columns, 3, CELL);
        for cell in 0..columns * 2 {
            let frame = cell * (performed.len() - 1) / (columns * 2 - 1);
            let positions = &performed[frame].positions;
            let root = performed[frame].joints[0].translation;
            let centre = Vec3::new(root.x, 0.92, root.z);
            let heading = performed[frame].state.heading;
            let (row, column) = (cell / columns, cell % columns);
            let side = take.name.starts_with("walk") || take.name.starts_with("run") || take.name.starts_with("jump");
            let yaw = if side { -1.35 - heading } else { 0.5 - heading };
            sheet.draw(&figure, &texture, positions, column, row, &View { yaw, centre, height: 2.1, clay: false });
            if row == 0 {
                sheet.draw(
                    &figure,
                    &texture,
                    positions,
                    column,
                    2,
                    &View { yaw: -heading + 0.15, centre, height: 2.1, clay: false },
                );
            }
        }
        sheet.save(&out.join(format!("{}.png", take.name)))
    })?;
    Ok(())
}

/// Where the camera stands: turned about the vertical, looking at `centre`, showing `height` metres.
struct View {
    yaw: f32,
    centre: Vec3,
    height: f32,
    /// Shows triangles instead of the texture.
    clay: bool,
}

struct Sheet {
    image: image::RgbImage,
    cell: (usize, usize),
}

impl Sheet {
    fn new(columns: usize, rows: usize, cell: (usize, usize)) -> Self {
        let size = ((columns * cell.0) as u32, (rows * cell.1) as u32);
        Self { image: image::RgbImage::from_pixel(size.0, size.1, image::Rgb([226, 228, 230])), cell }
    }

    fn save(&self, path: &std::path::Path) -> Result<(), image::ImageError> {
        self.image.save(path)
    }

    fn draw(
        &mut self,
        figure: &Figure,
        texture: &[[u8; 3]],
        positions: &[Vec3],
        column: usize,
        row: usize,
        view: &View,
    ) {
        let (width, height) = self.cell;
        let scale = height as f32 / view.height;
        let turn = Quat::from_rotation_y(view.yaw);
        let seen = |p: Vec3| {
            let q = turn * (p - view.centre);
            Vec3::new(width as f32 * 0.5 + q.x * scale, height as f32 * 0.5 - q.y * scale, q.z)
        };
        let mut canvas = Canvas::new((width, height), |_, _| Vec3::ZERO);
        for (index, triangle) in figure.mesh.triangles.iter().enumerate() {
            let places = triangle.map(|v| seen(positions[v as usize]));
            let [pa, pb, pc] = triangle.map(|v| turn * positions[v as usize]);
            let normal = (pb - pa).cross(pc - pa).normalize_or_zero();
            let light = 0.35 + 0.65 * normal.dot(Vec3::new(0.4, 0.6, 0.7).normalize()).max(0.0);
            let [a, b, c] = places.map(Vec3::xy);
            let area = (b - a).perp_dot(c - a);
            let [ua, ub, uc] = figure.atlas.uvs[index];
            canvas.fill([a, b, c], places.map(|place| place.z), |w, _| {
                // The inside of the surface must never be seen.
                if area > 0.0 {
                    return Vec3::new(255.0, 0.0, 255.0);
                }
                if view.clay {
                    let edge = if w.min_element() * area.abs().sqrt() < 0.35 { 0.8 } else { 1.0 };
                    return Vec3::new(210.0, 200.0, 190.0) * light * edge;
                }
                let uv = (ua * w.x + ub * w.y + uc * w.z) * figure.atlas.size as f32;
                let [x, y] = [uv.x, uv.y].map(|texel| (texel as usize).min(figure.atlas.size - 1));
                Vec3::from(texture[y * figure.atlas.size + x].map(f32::from))
            });
        }
        let (left, top) = ((column * width) as u32, (row * height) as u32);
        for (x, y) in (0..height as u32).flat_map(|y| (0..width as u32).map(move |x| (x, y))) {
            for (colour, _) in canvas.pixel(x, y, 1).filter(|(_, covered)| *covered) {
                self.image.put_pixel(left + x, top + y, image::Rgb(colour.to_array().map(|value| value as u8)));
            }
        }
    }
}
