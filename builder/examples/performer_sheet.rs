//! Draws the built-in performer into contact sheets: `performer_sheet OUT_FOLDER [FRAMES]`.
//!
//! One PNG per sequence with poses from the front and from three quarters, one of the bind pose with its edges, and the
//! texture. A plain software rasteriser, so that it runs anywhere.

use std::path::PathBuf;

use builder::performer::figure::Figure;
use builder::performer::{PerformerOptions, perform};
use glam::{Quat, Vec2, Vec3};
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
        let mut depths = vec![f32::NEG_INFINITY; width * height];
        for (index, triangle) in figure.mesh.triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|v| seen(positions[v as usize]));
            let [pa, pb, pc] = triangle.map(|v| turn * positions[v as usize]);
            let normal = (pb - pa).cross(pc - pa).normalize_or_zero();
            let area = (b - a).truncate().perp_dot((c - a).truncate());
            if area.abs() < 1e-9 {
                continue;
            }
            let low = a.min(b).min(c).max(Vec3::ZERO);
            let high = a.max(b).max(c);
            for y in low.y as usize..(high.y.ceil().max(0.0) as usize).min(height) {
                for x in low.x as usize..(high.x.ceil().max(0.0) as usize).min(width) {
                    let p = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                    let w = Vec3::new(
                        (c - b).truncate().perp_dot(p - b.truncate()),
                        (a - c).truncate().perp_dot(p - c.truncate()),
                        (b - a).truncate().perp_dot(p - a.truncate()),
                    ) / area;
                    let depth = w.x * a.z + w.y * b.z + w.z * c.z;
                    if w.min_element() < 0.0 || depth <= depths[y * width + x] {
                        continue;
                    }
                    depths[y * width + x] = depth;
                    let [ua, ub, uc] = figure.atlas.uvs[index];
                    let uv = (ua * w.x + ub * w.y + uc * w.z) * figure.atlas.size as f32;
                    let texel = texture[(uv.y as usize).min(figure.atlas.size - 1) * figure.atlas.size
                        + (uv.x as usize).min(figure.atlas.size - 1)];
                    let light = 0.35 + 0.65 * normal.dot(Vec3::new(0.4, 0.6, 0.7).normalize()).max(0.0);
                    let edge = if w.min_element() * area.abs().sqrt() < 0.35 { 0.8 } else { 1.0 };
                    let colour =
                        if view.clay { [210.0, 200.0, 190.0].map(|c: f32| (c * light * edge) as u8) } else { texel };
                    // The inside of the surface must never be seen.
                    let colour = if area > 0.0 { [255, 0, 255] } else { colour };
                    self.image.put_pixel((column * width + x) as u32, (row * height + y) as u32, image::Rgb(colour));
                }
            }
        }
    }
}
