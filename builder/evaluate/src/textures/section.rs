//! Section 8: Eigen appearance maps against PCA of textures as they are (thesis figures 4.9 to 4.12, TVCG figure 22).

use std::ops::Range;
use std::path::{Path, PathBuf};

use actor::blend::Blend;

use super::curves::{Curves, Subject as Textured, curves};
use super::ghosting::Crossings;
use super::performed::{self, Performed};
use super::quality::Quality;
use super::seams::Moment;
use super::views::Views;
use crate::blending::draw;
use crate::document::{Agreement, Cell, SectionReport, Table, Verdict};
use crate::performance::Recordings;
use crate::plot::{Plot, Series, SeriesStyle};
use crate::statistics::percentile;
use crate::subject::Subject;
use crate::{EvaluateError, missing};
use appearance::align::AlignOptions;
use appearance::textures::{TextureFiles, TextureSource};
use appearance::{AppearanceError, Charts};
use capture_io::export::ExportError;
use job::Job;
use pipeline::transitions::LengthChoice;

/// Transitions whose seams are looked at.
const SEAM_TRANSITIONS: usize = 150;

/// Makes the section.
pub(crate) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let Some(paths) = subject.textures.clone() else {
        return Ok(missing(
            "The capture has no texture for every frame. The built-in performer has them with its artefacts: \
             builder performer --artefacts all -o capture, then builder evaluate capture --sections appearance.",
        ));
    };
    let files = TextureFiles::new(paths, subject.masks.clone())?;
    let (width, height) = files.size();
    let (charts, _) = Charts::new(&subject.capture.surface, width, height)?;
    let range = |first: u32, count: u32| first as usize..(first + count) as usize;
    let sequences: Vec<Range<usize>> =
        subject.timeline().sequences().iter().map(|s| range(s.first_frame, s.frame_count)).collect();
    let poses: Vec<Vec<glam::Vec3>> = subject.capture.poses.iter().map(<[glam::Vec3]>::to_vec).collect();
    let views = Views::new(&subject.capture.surface, &poses, &charts);
    let blends = drawn(subject, job)?;
    let seams = seams(&blends);
    let pairs = performed::pairs(&blends, subject.timeline());
    let first = files.paths.first().map_or(Path::new(""), PathBuf::as_path);
    job.begin("truth of transitions")?;
    let truth = Performed::again(first, &files, &charts, subject.timeline(), &pairs);
    let crossings = truth.as_ref().ok().map(|truth| Crossings { pairs: &pairs, truth });
    let textured = Textured { source: &files, charts: &charts, sequences: &sequences, seams: &seams, crossings, views };
    match curves(&textured, &AlignOptions::default(), job) {
        Ok(curves) => {
            let mut section = write(&curves, (width, height));
            match (&curves.against_truth, &truth) {
                (Some(found), _) => performed::write(found, &charts, &mut section)
                    .map_err(|cause| ExportError::Texture { image: 0, cause })?,
                (None, Err(why)) => section.text.push(format!(
                    "Transitions between sequences are not compared with the truth, which is missing: {why}."
                )),
                (None, Ok(_)) => {}
            }
            Ok(section)
        }
        Err(EvaluateError::Appearance(
            error @ (AppearanceError::NoCompleteFrames { .. } | AppearanceError::NoTexels),
        )) => Ok(missing(&format!("No appearance can be built: {error}."))),
        Err(error) => Err(error),
    }
}

/// Transitions drawn from the essential graph, node by node.
fn drawn(subject: &Subject, job: &Job) -> Result<Vec<Vec<Blend>>, EvaluateError> {
    let graph = subject.graph(LengthChoice::Total, job)?;
    let recordings = Recordings::of(&subject.capture, &subject.measured.headings, &subject.centres, &subject.contacts);
    let drawn = draw(graph.transitions().len(), SEAM_TRANSITIONS, subject.options.seed);
    let blends = drawn.into_iter().map(|index| Ok(recordings.blends(&graph.transitions()[index])?));
    blends.collect()
}

/// The textures on both sides of the seams of transitions.
fn seams(transitions: &[Vec<Blend>]) -> Vec<[Moment; 2]> {
    let mut seams = Vec::new();
    for blends in transitions {
        // A transition without a node of its own has no synthetic frame.
        let [first, second, .., before_last, last] = blends.as_slice() else { continue };
        let moment =
            |blend: &Blend| Moment { frames: [0, 1].map(|side| blend.nearest(side) as usize), lambda: blend.lambda };
        seams.push([Moment::recorded(first.frames[0] as usize), moment(second)]);
        seams.push([moment(before_last), Moment::recorded(last.frames[1] as usize)]);
    }
    seams
}

fn cells(quality: Quality) -> [Cell; 2] {
    [Cell::Number(quality.ssim, 4), Cell::Number(quality.mse * 1e4, 3)]
}

fn write(curves: &Curves, (width, height): (u32, u32)) -> SectionReport {
    let mut reconstruction = Table::new(
        "appearance_components",
        "Textures of frames rebuilt from a number of components (ours: two Eigen textures for each Eigen warp), against the \
         recorded ones: structural similarity and mean square error (times 10,000, colours 0 to 1) over active texels, \
         and over the actor\u{2019}s pixels in pictures of 512 x 512.",
        &[
            "components",
            "ours, SSIM",
            "ours, MSE",
            "ours stored, SSIM",
            "ours stored, MSE",
            "bytes a frame",
            "ours moved directly, SSIM",
            "ours moved directly, MSE",
            "naive, SSIM",
            "naive, MSE",
            "ours seen, SSIM",
            "ours seen, MSE",
            "naive seen, SSIM",
            "naive seen, MSE",
        ],
    );
    for row in &curves.reconstruction {
        let mut line = vec![Cell::Count(row.components as u64)];
        line.extend([row.ours, row.stored].into_iter().flat_map(cells));
        line.push(Cell::Count(row.stored_bytes.round() as u64));
        line.extend([row.direct, row.naive, row.ours_seen, row.naive_seen].into_iter().flat_map(cells));
        reconstruction.rows.push(line);
    }
    let mut generalisation = Table::new(
        "appearance_generalisation",
        "Frames that were not learnt from, rebuilt from at most 50 components of those that were.",
        &[
            "share learnt, percent",
            "frames learnt",
            "components",
            "ours, SSIM",
            "ours, MSE",
            "naive, SSIM",
            "naive, MSE",
        ],
    );
    for row in &curves.generalisation {
        let counts = [row.percent, row.training, row.components].map(|count| Cell::Count(count as u64));
        let values = [row.ours, row.naive].into_iter().flat_map(cells);
        generalisation.rows.push(counts.into_iter().chain(values).collect());
    }
    let mut interpolation = Table::new(
        "appearance_interpolation",
        "Half way between two frames drawn at random: coefficients interpolated with a number of components, against the \
         same with 50.",
        &["components", "SSIM", "MSE"],
    );
    for row in &curves.interpolation {
        let count = Cell::Count(row.components as u64);
        interpolation.rows.push(std::iter::once(count).chain(cells(row.quality)).collect());
    }
    let mut ghosting = Table::new(
        "appearance_ghosting",
        "The recorded frame in the middle of two others of its sequence, made from those two: by our coefficients, and by \
         a linear cross-fade. Sharpness is the mean gradient over that of the recorded frame; below 1 is blur.",
        &[
            "frames apart",
            "pairs",
            "ours, SSIM",
            "ours, MSE",
            "cross-fade, SSIM",
            "cross-fade, MSE",
            "ours, sharpness",
            "cross-fade, sharpness",
        ],
    );
    for row in &curves.ghosting {
        let counts = [row.distance, row.pairs].map(|count| Cell::Count(count as u64));
        let values = [row.ours, row.blend].into_iter().flat_map(cells);
        let sharpness = row.sharpness.map(|value| Cell::Number(value, 3));
        ghosting.rows.push(counts.into_iter().chain(values).chain(sharpness).collect());
    }
    SectionReport {
        text: vec![format!(
            "Textures of {width} x {height} texels. Frames with gaps are left out of all models and of what is measured. \
             Colours are sRGB-encoded. Naive is principal components of the textures as captured."
        )],
        agreements: agreements(curves),
        plots: plots(curves),
        tables: vec![reconstruction, generalisation, interpolation, ghosting, seam_table(curves)],
        ..SectionReport::default()
    }
}

/// The 99th percentile of the capture's own changes.
fn limit(curves: &Curves) -> f64 {
    percentile(&curves.own_changes, 0.99).unwrap_or(0.0)
}

fn above(curves: &Curves) -> usize {
    curves.seam_changes.iter().filter(|&&change| change > limit(curves)).count()
}

fn seam_table(curves: &Curves) -> Table {
    let mut table = Table::new(
        "appearance_seams",
        format!(
            "Change of the texture from frame to frame, root mean square over active texels, in units of an 8-bit colour: of \
             recorded frames, and where recorded and synthetic frames of up to {SEAM_TRANSITIONS} transitions drawn from the \
             graph meet. 50 components."
        ),
        &["frames", "changes", "median", "95th percentile", "99th percentile", "most", "above the recorded 99th"],
    );
    for (name, changes, above) in
        [("recorded", &curves.own_changes, None), ("seams", &curves.seam_changes, Some(above(curves)))]
    {
        let mut row = vec![name.into(), Cell::Count(changes.len() as u64)];
        row.extend(
            [0.5, 0.95, 0.99, 1.0]
                .map(|share| percentile(changes, share).map_or(Cell::Empty, |change| Cell::Number(255.0 * change, 2))),
        );
        row.push(above.map_or(Cell::Empty, |above| Cell::Count(above as u64)));
        table.rows.push(row);
    }
    table
}

fn agreements(curves: &Curves) -> Vec<Agreement> {
    let mut found = Vec::new();
    if !curves.seam_changes.is_empty() {
        let (above, count) = (above(curves), curves.seam_changes.len());
        found.push(Agreement {
            papers: "Our own mark: no seam changes the texture more than the capture itself does, 99 times in 100."
                .into(),
            found: format!("{above} of {count} seams above the recorded 99th percentile"),
            verdict: Verdict::of(above * 100 <= count, above == 0),
            why: String::new(),
        });
    }
    let up_to_50: Vec<_> = curves.reconstruction.iter().filter(|row| row.components <= 50).collect();
    let above = up_to_50.iter().filter(|row| row.ours.ssim > row.naive.ssim).count();
    if let Some(at_50) = up_to_50.last() {
        found.push(Agreement {
            papers: "With aligned textures fewer components reach the same quality than without (figures 4.9, 4.10)."
                .into(),
            found: format!(
                "Above naive PCA at {above} of {} counts; at {} components SSIM {:.4} against {:.4}.",
                up_to_50.len(),
                at_50.components,
                at_50.ours.ssim,
                at_50.naive.ssim
            ),
            verdict: Verdict::of(above > 0, above == up_to_50.len()),
            why: if above == up_to_50.len() {
                String::new()
            } else {
                "Where the textures slide slowly and the sequences are short, a few components a sequence hold them as \
                 they are, and nothing is interpolated twice."
                    .into()
            },
        });
    }
    let half = curves.generalisation.iter().find(|row| row.percent == 50);
    if let (Some(half), Some(most)) = (half, curves.generalisation.last()) {
        found.push(Agreement {
            papers: "Aligned textures generalise better to frames not learnt from (figure 4.11).".into(),
            found: format!(
                "Half learnt: SSIM {:.4} against {:.4} naive; naive with {} %: {:.4}.",
                half.ours.ssim, half.naive.ssim, most.percent, most.naive.ssim
            ),
            verdict: Verdict::of(half.ours.ssim > half.naive.ssim, half.ours.ssim >= most.naive.ssim),
            why: String::new(),
        });
    }
    if let Some(far) = curves.ghosting.last().filter(|far| far.pairs > 0) {
        found.push(Agreement {
            papers: "Interpolated coefficients do not ghost, blended textures do (TVCG figure 21).".into(),
            found: format!(
                "{} frames apart: SSIM {:.4} against {:.4}, sharpness {:.3} against {:.3}.",
                far.distance, far.ours.ssim, far.blend.ssim, far.sharpness[0], far.sharpness[1]
            ),
            verdict: Verdict::of(far.sharpness[0] > far.sharpness[1], far.ours.ssim > far.blend.ssim),
            why: String::new(),
        });
    }
    found
}

fn plots(curves: &Curves) -> Vec<Plot> {
    let line = |name: &str, colour, points: Vec<(f64, f64)>| Series::new(name, SeriesStyle::DottedLine, colour, points);
    let rebuilt = |value: fn(&super::curves::Reconstruction) -> f64| -> Vec<(f64, f64)> {
        curves.reconstruction.iter().map(|row| (row.components as f64, value(row))).collect()
    };
    let learnt = |value: fn(&super::curves::Generalisation) -> f64| -> Vec<(f64, f64)> {
        curves.generalisation.iter().map(|row| (row.percent as f64, value(row))).collect()
    };
    let apart = |value: fn(&super::curves::Ghosting) -> f64| -> Vec<(f64, f64)> {
        curves.ghosting.iter().map(|row| (row.distance as f64, value(row))).collect()
    };
    let plot = |caption: &str, x: &str, y: &str, series| Plot {
        caption: caption.into(),
        x: x.into(),
        y: y.into(),
        series,
        ..Plot::default()
    };
    vec![
        plot(
            "Textures rebuilt (thesis figure 4.9)",
            "components",
            "SSIM",
            vec![
                line("ours", 0, rebuilt(|row| row.ours.ssim)),
                line("naive", 1, rebuilt(|row| row.naive.ssim)),
                line("ours, stored", 2, rebuilt(|row| row.stored.ssim)),
            ],
        ),
        plot(
            "Textures rebuilt (thesis figure 4.10)",
            "components",
            "MSE times 10,000",
            vec![
                line("ours", 0, rebuilt(|row| row.ours.mse * 1e4)),
                line("naive", 1, rebuilt(|row| row.naive.mse * 1e4)),
            ],
        ),
        plot(
            "Pictures of the actor (thesis figure 4.9)",
            "components",
            "SSIM",
            vec![
                line("ours", 0, rebuilt(|row| row.ours_seen.ssim)),
                line("naive", 1, rebuilt(|row| row.naive_seen.ssim)),
            ],
        ),
        plot(
            "Frames not learnt from (thesis figure 4.11)",
            "frames learnt from, percent",
            "SSIM",
            vec![line("ours", 0, learnt(|row| row.ours.ssim)), line("naive", 1, learnt(|row| row.naive.ssim))],
        ),
        plot(
            "Interpolation (TVCG figure 22)",
            "components",
            "SSIM to that with 50",
            vec![line(
                "ours",
                0,
                curves.interpolation.iter().map(|row| (row.components as f64, row.quality.ssim)).collect(),
            )],
        ),
        plot(
            "In the middle of two recorded frames (TVCG figure 21)",
            "frames apart",
            "SSIM",
            vec![line("ours", 0, apart(|row| row.ours.ssim)), line("cross-fade", 1, apart(|row| row.blend.ssim))],
        ),
        plot(
            "In the middle of two recorded frames",
            "frames apart",
            "sharpness",
            vec![line("ours", 0, apart(|row| row.sharpness[0])), line("cross-fade", 1, apart(|row| row.sharpness[1]))],
        ),
    ]
}
