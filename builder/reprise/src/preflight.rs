//! What packing would refuse or warn of, as far as it can be known before anything long is computed. `builder validate` and
//! `builder inspect` say it of an input, and `builder pack` says it first.

use actor::capture::Capture;
use actor::timeline::Timeline;
use appearance::gaps::Gaps;
use appearance::textures::{TextureFiles, TextureSource};
use appearance::{AppearanceError, Charts};
use bundle::geometry::quantise::Grid;
use bundle::{default_max_error, limits};
use capture_io::import::{Imported, Warning};
use job::Job;
use pipeline::{contacts, distance};

use crate::options::{AppearanceChoice, FIRST_FRAME, PackError, PackOptions};

/// What was found.
#[derive(Debug, Default)]
pub struct Preflight {
    /// Sentences for the user.
    pub warnings: Vec<Warning>,
    /// Why the capture cannot be packed.
    pub refusal: Option<PackError>,
}

/// Everything that packing `imported` would say of it, but for what its stages find out; all textures are read.
#[must_use]
pub fn preflight(imported: &Imported, options: &PackOptions, job: &Job) -> Preflight {
    let mut found = before_stages(imported, options);
    if found.refusal.is_none() {
        found.refusal = read_textures(imported, options, job, &mut found.warnings).err();
    }
    found
}

/// As [`preflight`], but textures are left for the stage that reads them anyway.
#[must_use]
pub(crate) fn before_stages(imported: &Imported, options: &PackOptions) -> Preflight {
    let mut warnings = Vec::new();
    let capture = &imported.capture;
    let checked = check_sizes(capture)
        .and_then(|()| check_places(capture, options))
        .and_then(|()| check_poses(capture))
        .and_then(|()| short_sequences(capture, options, &mut warnings))
        .and_then(|()| check_atlas(imported, options, &mut warnings));
    if checked.is_ok() && options.graph.hold_contacts {
        warnings.extend(uneven_floor(capture));
    }
    Preflight { warnings, refusal: checked.err() }
}

/// Sequences that float or sink by centimetres.
fn uneven_floor(capture: &Capture) -> Option<Warning> {
    let sequences = capture.timeline.sequences();
    let heights = contacts::uneven_floor(&capture.timeline, &capture.poses)?;
    let ends = [f32::min, f32::max].map(|of| heights.iter().copied().reduce(of).unwrap_or(0.0));
    let at = ends.map(|height| heights.iter().position(|&other| other == height).unwrap_or(0));
    let [low, high] = at.map(|index| sequences.get(index).map_or("", |sequence| sequence.name.as_str()));
    let message = format!(
        "the ground of sequence \"{high}\" is {:.1} cm above that of \"{low}\": each sequence stands on its own, and the \
         actor rises or sinks in transitions between them. Move the frames in the program that wrote them",
        (ends[1] - ends[0]) * 100.0
    );
    Some(Warning::new("W_FLOOR", message))
}

/// More of something than a bundle holds.
fn check_sizes(capture: &Capture) -> Result<(), PackError> {
    let surface = &capture.surface;
    let sizes = [
        ("vertices", capture.topology.vertex_count(), limits::MAX_VERTICES),
        ("corners", surface.corners.len(), limits::MAX_CORNERS),
        ("triangles", surface.triangles.len(), limits::MAX_TRIANGLES),
        ("images", surface.images.len(), limits::MAX_IMAGES),
        ("materials", surface.materials.len(), limits::MAX_MATERIALS),
        ("vertices in its files", capture.vertex_of_file_vertex.len(), limits::MAX_CORNERS),
    ];
    match sizes.iter().find(|(_, count, limit)| *count > *limit as usize) {
        Some((what, count, limit)) => {
            Err(PackError::Option(format!("the capture has {count} {what}, but a bundle holds at most {limit}")))
        }
        None => Ok(()),
    }
}

/// A frame of the capture, as its user counts.
fn place(timeline: &Timeline, frame: u32) -> String {
    match timeline.sequence_of(frame) {
        Some(sequence) => format!("frame {} of sequence \"{}\"", frame - sequence.first_frame, sequence.name),
        None => format!("frame {frame}"),
    }
}

/// Vertices so far out that the bundle cannot hold them as exactly as it is to.
fn check_places(capture: &Capture, options: &PackOptions) -> Result<(), PackError> {
    let farthest = |pose: &[glam::Vec3]| pose.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
    let reach: Vec<f32> = capture.poses.iter().map(farthest).collect();
    let largest = reach.iter().copied().fold(0.0, f32::max);
    let max_error = options.max_error.unwrap_or_else(|| default_max_error(capture, FIRST_FRAME));
    if Grid::new(max_error, largest).is_some() {
        return Ok(());
    }
    let frame = reach.iter().position(|&reach| reach == largest).unwrap_or(0) as u32;
    let pose = capture.poses.frame(frame);
    let vertex = pose.iter().position(|p| p.abs().max_element() == largest).unwrap_or(0);
    Err(PackError::Option(format!(
        "{}: vertex {vertex} lies {largest:.1} m from the origin, too far to be stored within {:.2} mm: repair the frame, \
         leave it out, or allow a larger --max-error",
        place(&capture.timeline, frame),
        max_error * 1000.0
    )))
}

/// Poses that cannot be compared.
fn check_poses(capture: &Capture) -> Result<(), PackError> {
    distance::comparable(&capture.topology, &capture.poses).map_err(|error| match error {
        distance::DistanceError::Degenerate { frame } => PackError::Option(format!(
            "no triangle has an area in every frame; in {} the last of them collapses: leave out the frames in which the \
             surface, or a part of it, has no extent",
            place(&capture.timeline, frame)
        )),
        error => PackError::Option(error.to_string()),
    })
}

/// Sequences named in a message.
const NAMED: usize = 8;

/// Sequences too short for a transition: nothing can leave or enter them.
fn short_sequences(capture: &Capture, options: &PackOptions, warnings: &mut Vec<Warning>) -> Result<(), PackError> {
    let lengths =
        options.graph.transition.lengths(&capture.timeline).map_err(|error| PackError::Option(error.to_string()))?;
    let sequences = capture.timeline.sequences();
    let short: Vec<&str> = sequences
        .iter()
        .filter(|sequence| (sequence.frame_count as usize) < lengths.shortest)
        .map(|sequence| sequence.name.as_str())
        .collect();
    if !short.is_empty() {
        let more = if short.len() > NAMED { format!(" and {} more", short.len() - NAMED) } else { String::new() };
        warnings.push(Warning::new(
            "W_SEQUENCE_SHORT",
            format!(
                "{} of {} sequences have fewer than {} frames, the shortest part of a transition ({} s), so that nothing \
                 leads to them or on from them: {}{more}",
                short.len(),
                sequences.len(),
                lengths.shortest,
                options.graph.transition.shortest_seconds,
                short[..short.len().min(NAMED)].join(", ")
            ),
        ));
    }
    Ok(())
}

/// What is unusual about the atlas of textures that change.
fn check_atlas(imported: &Imported, options: &PackOptions, warnings: &mut Vec<Warning>) -> Result<(), PackError> {
    let Some(paths) = &imported.frame_textures else { return Ok(()) };
    if options.appearance == AppearanceChoice::Static {
        warnings.push(Warning::new(
            "W_TEXTURES_STATIC",
            format!("{} frames have textures of their own, of which the first one's is used for all", paths.len()),
        ));
        return Ok(());
    }
    let files = TextureFiles::new(paths.clone(), imported.frame_masks.clone())?;
    let (width, height) = files.size();
    let largest = limits::MAX_TEXTURE_SIDE;
    if width.max(height) > largest {
        return Err(PackError::Option(format!(
            "textures of {width} x {height} pixels are too large for an appearance that changes: at most {largest} along a \
             side; make them smaller, or say --appearance static"
        )));
    }
    let (_, findings) = Charts::new(&imported.capture.surface, width, height)?;
    if findings.shared_texels > 0 {
        warnings.push(Warning::new(
            "W_ATLAS_OVERLAP",
            format!(
                "charts of the atlas overlap in {} texels: parts of the body that share texels look alike",
                findings.shared_texels
            ),
        ));
    }
    if findings.wrapped_triangles > 0 {
        warnings.push(Warning::new(
            "W_ATLAS_REPEAT",
            format!(
                "{} triangles have texture coordinates outside of 0 to 1: the texture repeats",
                findings.wrapped_triangles
            ),
        ));
    }
    Ok(())
}

/// Textures that cannot be read, and those with holes.
fn read_textures(
    imported: &Imported,
    options: &PackOptions,
    job: &Job,
    warnings: &mut Vec<Warning>,
) -> Result<(), PackError> {
    let (Some(paths), AppearanceChoice::Eigen(_)) = (&imported.frame_textures, &options.appearance) else {
        return Ok(());
    };
    job.begin("reading textures")?;
    let files = TextureFiles::new(paths.clone(), imported.frame_masks.clone())?;
    let (width, height) = files.size();
    let (charts, _) = Charts::new(&imported.capture.surface, width, height)?;
    let complete = Gaps::find(&files, &charts)?.complete().len();
    if complete == 0 {
        return Err(AppearanceError::NoCompleteFrames { frames: paths.len() }.into());
    }
    warnings.extend(holes(paths.len() - complete));
    Ok(())
}

/// The sentence about frames with texels that no camera saw.
pub(crate) fn holes(frames: usize) -> Option<Warning> {
    (frames > 0).then(|| {
        Warning::new(
            "W_TEXTURE_HOLES",
            format!(
                "{frames} frames have texels that no camera saw: they are left out of the model and completed from it"
            ),
        )
    })
}
