//! Writes the built-in performer's capture: `performer_capture OUT_FOLDER [FRAMES] [ARTEFACTS]`, and says how long it took.

use performer::{PerformerOptions, write_performer};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let out = arguments.next().ok_or("where to?")?;
    let mut options = PerformerOptions::default();
    if let Some(frames) = arguments.next() {
        options.frames = frames.parse()?;
    }
    if let Some(artefacts) = arguments.next() {
        options.artefacts = artefacts.parse()?;
    }
    let start = std::time::Instant::now();
    let summary = write_performer(&options, out.as_ref(), &|_| {})?;
    eprintln!("{summary:?} in {:?}", start.elapsed());
    Ok(())
}
