//! Writes prepared texture pairs with their true flow and ours, for `benches/opencv_dis.py` to compare with OpenCV.

use std::path::{Path, PathBuf};
use std::time::Instant;

use builder::appearance::charts::Charts;
use builder::appearance::flow::{FlowGrid, FlowOptions};
use builder::appearance::prepare::prepare;
use builder::appearance::textures::{TextureFiles, TextureSource};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(out)) = (arguments.next(), arguments.next()) else {
        return Err("usage: flow_pair CAPTURE OUT [A B ...]".into());
    };
    let out = PathBuf::from(out);
    std::fs::create_dir_all(&out)?;
    let imported = builder::import::import(&[folder], &builder::import::ImportOptions::default(), &|_| ())?;
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
        for _ in 0..3 {
            let start = Instant::now();
            let prepared = [grid.prepare(&values[0], None), grid.prepare(&values[1], None)];
            let flow = grid.flow(&prepared[0], &prepared[1]);
            eprintln!("flow {:?}", start.elapsed());
            let numbers: Vec<u8> = flow.x.iter().zip(&flow.y).flat_map(|(x, y)| [*x, *y]).flat_map(f32::to_le_bytes).collect();
            std::fs::write(out.join(format!("pair_{}_{}.flow", pair[0], pair[1])), numbers)?;
        }
    }
    let active: Vec<u8> = charts.active().iter().map(|&a| u8::from(a) * 255).collect();
    image::save_buffer(out.join("active.png"), &active, width, height, image::ExtendedColorType::L8)?;
    Ok(())
}

fn save(path: &Path, values: &[f32], width: u32, height: u32) -> Result<(), image::ImageError> {
    let bytes: Vec<u8> = values.iter().map(|v| (v * 255.0).round() as u8).collect();
    image::save_buffer(path, &bytes, width, height, image::ExtendedColorType::L8)
}
