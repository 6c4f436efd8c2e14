//! Measures the appearance of a capture and prints the curves as JSON.
//!
//!     cargo run --release -p reprise-builder --example appearance_curves -- CAPTURE > curves.json

use std::time::Instant;

use builder::appearance::align::AlignOptions;
use builder::appearance::curves::curves;
use builder::appearance::textures::{TextureFiles, TextureSource};
use builder::appearance::{AppearanceOptions, Charts, build};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: appearance_curves CAPTURE")?;
    let imported = builder::import::import(&[folder], &builder::import::ImportOptions::default(), &|_| ())?;
    let files = TextureFiles::new(imported.frame_textures.ok_or("the frames have no textures")?, Vec::new())?;
    let (width, height) = files.size();
    let (charts, findings) = Charts::new(&imported.capture.surface, width, height)?;
    eprintln!("{width} x {height}, {} active texels, {findings:?}", charts.texels().len());
    let start = Instant::now();
    if std::env::args().nth(2).as_deref() == Some("build") {
        let (_, summary) = build(&files, &charts, &AppearanceOptions::default(), &builder::progress::silent)?;
        eprintln!("build {:?}: {}", start.elapsed(), serde_json::to_string(&summary)?);
        eprintln!("peak {:?} MB", builder::memory::peak_bytes().map(|bytes| bytes / 1_000_000));
        return Ok(());
    }
    let sequences: Vec<_> = imported
        .capture
        .timeline
        .sequences()
        .iter()
        .map(|s| s.first_frame as usize..(s.first_frame + s.frame_count) as usize)
        .collect();
    let curves = curves(&files, &charts, &sequences, &AlignOptions::default(), &builder::progress::silent)?;
    eprintln!("curves {:?}", start.elapsed());
    let mut out = std::io::stdout().lock();
    serde_json::to_writer_pretty(&mut out, &curves)?;
    Ok(())
}
