//! `builder performer`.

use job::Progress;
use performer::{Artefacts, Kind, PerformerError, PerformerOptions, ScannedOptions, write_performer, write_scanned};

use super::args::{Artefact, FigureKind, PerformerArguments};
use super::failure::Failure;
use super::terminal::Terminal;

/// Writes the built-in performer's capture.
pub fn run(arguments: &PerformerArguments, terminal: &Terminal) -> Result<(), Failure> {
    let out = &arguments.output;
    let occupied = out.read_dir().is_ok_and(|mut entries| entries.next().is_some());
    if occupied {
        let error = anyhow::anyhow!("{} is not empty; name a new folder, or empty it first", out.display());
        return Err(Failure::Input(error));
    }
    let progress = |step: performer::Progress| {
        let _ =
            terminal.progress(Progress { what: "performer", done: step.frames_done as u64, total: step.frames as u64 });
    };
    let written = if arguments.scanned {
        let scanned = ScannedOptions { group: arguments.group as usize, noise: arguments.noise / 1000.0 };
        write_scanned(&options(arguments), &scanned, out, &progress)
    } else {
        write_performer(&options(arguments), out, &progress)
    };
    let summary = written.map_err(|error| match error {
        PerformerError::Option { .. } => Failure::Usage(error.to_string()),
        _ => Failure::Input(error.into()),
    })?;
    let sequences: Vec<String> = summary.sequences.iter().map(|(name, frames)| format!("{name} {frames}")).collect();
    terminal.log(&format!(
        "{}: {} frames of {}{} vertices and {} triangles ({})",
        summary.manifest.display(),
        summary.frames,
        if arguments.scanned { "their own meshes, scanned from " } else { "" },
        summary.vertices,
        summary.triangles,
        sequences.join(", ")
    ));
    Ok(())
}

fn options(arguments: &PerformerArguments) -> PerformerOptions {
    let default = PerformerOptions::default();
    let has = |artefact| arguments.artefacts.iter().any(|&asked| asked == artefact || asked == Artefact::All);
    let size = |asked: Option<u32>, default: usize| asked.map_or(default, |number| number as usize);
    PerformerOptions {
        frames: size(arguments.frames, default.frames),
        vertices: size(arguments.vertices, default.vertices),
        texture_size: size(arguments.texture_size, default.texture_size),
        artefacts: Artefacts {
            noise: has(Artefact::Noise),
            drift: has(Artefact::Drift),
            light: has(Artefact::Light),
            holes: has(Artefact::Holes),
        },
        seed: arguments.seed,
        fps: arguments.rate.unwrap_or(default.fps),
        figure: match arguments.figure {
            FigureKind::Woman => Kind::Woman,
            FigureKind::Man => Kind::Man,
            FigureKind::Child => Kind::Child,
        },
    }
}
