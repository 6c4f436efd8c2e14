//! Section 13: variations (thesis chapter 6, figures 6.4, 6.5 and 6.7): how well few dimensions hold a motion, and what alternatives look
//! like as a bundle has them.

mod lasting;
mod model;
mod stored;
mod wandered;

use std::sync::Arc;

use ::motion::alternatives::alternatives;
use ::motion::vary::{Varied, VaryOptions, vary};
use actor::alternatives::Alternatives;
use actor::capture::Capture;
use actor::feet::Feet;
use actor::files::Files;
use actor::graph::EssentialGraph;
use actor::motion::Motion;
use actor::timeline::Sequence;
use bundle::{BundleInput, Extras, encode_with_extras};
use image::{RgbaImage, imageops};
use job::Job;

use self::lasting::lasting;
use self::model::{held, training};
use self::stored::{Played, played};
use super::EvaluateError;
use super::clay::{self, Camera};
use super::document::{Agreement, Cell, Picture, SectionReport, Table, Verdict};
use super::plot::{Plot, Series, SeriesStyle};
use super::subject::Subject;

/// Dimensions of the models that are compared.
const DIMENSIONS: [usize; 3] = [2, 3, 5];
/// Amounts of variation.
const AMOUNTS: [f64; 3] = [0.06, 0.12, 0.25];
/// The amount that is asked for where nothing is said.
const USUAL: usize = 1;
/// Variations of each sequence.
const COUNT: usize = 8;
/// Sequences that are varied at most: idle and walk first.
const SEQUENCES: usize = 4;
/// Frames that training is timed on.
const TIMED: usize = 168;
/// How long an idle lasts, in seconds, and seeds that it is drawn by.
const LASTS: f64 = 600.0;
const SEEDS: u64 = 4;
/// Our marks: error over that of principal components, acceleration, edges, the seam in steps, and bytes.
const MARKS: [f64; 5] = [1.0 / 3.0, 1.1, 0.02, 1.5, 1.5e6];
/// A step that is at most so many times the recorded one at the same end is like it.
const NEARLY: f64 = 1.05;
/// Frames of the picture, and alternatives.
const SHOWN: [usize; 2] = [9, 3];

/// Makes the section.
pub fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let capture = &subject.capture;
    let chosen = chosen(capture);
    if chosen.is_empty() {
        return Ok(super::missing("No sequence is long enough to be varied."));
    }
    job.begin("learning motion")?;
    let (fits, fit_plot) = fits(capture, &chosen, job)?;
    let timed = training(capture, TIMED);
    let feet = pipeline::feet::feet(&capture.topology, &capture.timeline, &capture.poses);
    let motion = Motion::measure(&capture.timeline, capture.topology.weights(), &mut capture.poses.clone())?;
    let mut all = Vec::new();
    for amount in AMOUNTS {
        all.push(made(capture, &feet, &motion.facings, &chosen, (amount, subject.options.seed), job)?);
    }
    let measures: Vec<Vec<Played>> = all
        .iter()
        .map(|(own, _)| {
            let frames = |sequence: &&Sequence| sequence.first_frame..sequence.end_frame();
            chosen.iter().map(|sequence| played(capture, &feet, own, frames(sequence))).collect()
        })
        .collect();
    let mut section = SectionReport { text: text(), ..SectionReport::default() };
    section.agreements = agreements(&fits, timed, &measures, &all, capture)?;
    section.tables =
        vec![fits, shown(&chosen, &measures), lasts(capture, &chosen, &all[USUAL].0, subject.options.seed)];
    section.tables.push(wandered::table(
        subject,
        &wandered_alternatives(capture, &feet, &motion.facings, subject, job)?,
        job,
    )?);
    section.plots = vec![fit_plot, spread_plot(&measures)];
    section.pictures.extend(picture(capture, &all[USUAL].0)?);
    Ok(section)
}

fn text() -> Vec<String> {
    vec![format!(
        "{COUNT} variations of each sequence, by the recipe of builder vary (docs/learning.md). What is measured is what a bundle \
         stores and a page plays, not what was sampled: recorded frames, and the stored differences added to them."
    )]
}

/// Sequences to vary: idles and walks first, then the longest.
fn chosen(capture: &Capture) -> Vec<&Sequence> {
    let first = |sequence: &Sequence| {
        let is = |name: &str| sequence.name.contains(name) || sequence.labels.iter().any(|label| label == name);
        (!is("idle"), !is("walk"))
    };
    let enough = |sequence: &&Sequence| sequence.frame_count as f32 >= 2.0 * capture.timeline.fps();
    let mut all: Vec<&Sequence> = capture.timeline.sequences().iter().filter(enough).collect();
    all.sort_by_key(|sequence| (first(sequence), std::cmp::Reverse(sequence.frame_count), sequence.first_frame));
    all.truncate(SEQUENCES);
    all
}

/// Figure 6.4.
fn fits(capture: &Capture, chosen: &[&Sequence], job: &Job) -> Result<(Table, Plot), EvaluateError> {
    let caption = "Mean error of a vertex when few numbers stand for a frame (figure 6.4): a Gaussian process dynamical model, and as many \
                   principal components.";
    let columns = ["sequence", "dimensions", "model mm", "components mm", "of these"];
    let mut table = Table::new("variations_fit", caption, &columns);
    let mut sums = [[0.0; 2]; DIMENSIONS.len()];
    for (done, sequence) in chosen.iter().enumerate() {
        job.tell("learning motion", done as u64, chosen.len() as u64)?;
        for (sum, held) in sums.iter_mut().zip(held(capture, sequence, &DIMENSIONS)) {
            let [model, components] = held.millimetres;
            (sum[0], sum[1]) = (sum[0] + model, sum[1] + components);
            table.rows.push(vec![
                sequence.name.as_str().into(),
                Cell::Count(held.dimensions as u64),
                Cell::Number(model, 2),
                Cell::Number(components, 2),
                Cell::Number(model / components.max(1e-9), 2),
            ]);
        }
    }
    let line = |which: usize| {
        let point = |(dimensions, sum): (&usize, &[f64; 2])| (*dimensions as f64, sum[which] / chosen.len() as f64);
        DIMENSIONS.iter().zip(&sums).map(point).collect()
    };
    let plot = Plot {
        caption: "Mean error by dimensions, over these sequences (figure 6.4).".into(),
        x: "dimensions".into(),
        y: "mm".into(),
        series: vec![
            Series::new("model", SeriesStyle::DottedLine, 0, line(0)),
            Series::new("principal components", SeriesStyle::DottedLine, 1, line(1)),
        ],
        from_zero: true,
        ..Plot::default()
    };
    Ok((table, plot))
}

/// The alternatives of some sequences, and the stretches that keep the recording and all.
fn made(
    capture: &Capture,
    feet: &Feet,
    facings: &[f32],
    chosen: &[&Sequence],
    (amount, seed): (f64, u64),
    job: &Job,
) -> Result<(Arc<Alternatives>, [usize; 2]), EvaluateError> {
    let mut options = VaryOptions::default();
    (options.amount, options.count, options.seed) = (amount, COUNT, seed);
    let of = |sequence: &&Sequence| {
        let frames = (sequence.first_frame..sequence.end_frame(), capture.timeline.fps());
        vary(&capture.poses, &capture.topology, frames, &options, job)
    };
    let varied = chosen.iter().map(of).collect::<Result<Vec<Varied>, _>>()?;
    let (all, _) = alternatives(capture, feet, facings, &varied, COUNT, job)?;
    let sum = |of: fn(&Varied) -> usize| varied.iter().map(of).sum();
    Ok((Arc::new(all), [sum(|one| one.rejected), sum(|one| one.stretches)]))
}

/// The alternatives of all sequences, as `builder vary` makes them where nothing is said.
fn wandered_alternatives(
    capture: &Capture,
    feet: &Feet,
    facings: &[f32],
    subject: &Subject,
    job: &Job,
) -> Result<Arc<Alternatives>, EvaluateError> {
    let all: Vec<&Sequence> = capture.timeline.sequences().iter().collect();
    Ok(made(capture, feet, facings, &all, (AMOUNTS[USUAL], subject.options.seed), job)?.0)
}

/// What is played, by sequence and amount.
fn shown(chosen: &[&Sequence], measures: &[Vec<Played>]) -> Table {
    let caption = "Alternatives as they are stored, mixed as players mix them (six mixtures a stretch), added wholly to the recording. Acceleration and steps \
                   at the ends of stretches are beside the recording's.";
    let columns = [
        "sequence",
        "amount",
        "alternatives",
        "apart mm",
        "off mm",
        "acceleration",
        "edges %",
        "pinned ends mm",
        "steps at ends",
        "recorded",
        "slide mm",
        "recorded mm",
    ];
    let mut table = Table::new("variations_played", caption, &columns);
    for (index, sequence) in chosen.iter().enumerate() {
        for (amount, measures) in AMOUNTS.iter().zip(measures) {
            let own = measures[index];
            table.rows.push(vec![
                sequence.name.as_str().into(),
                Cell::Number(*amount, 2),
                Cell::Count(own.count as u64),
                Cell::Number(1e3 * own.apart, 1),
                Cell::Number(1e3 * own.off, 1),
                Cell::Number(own.acceleration, 2),
                Cell::Number(1e2 * own.edges, 2),
                Cell::Number(1e3 * own.ends, 3),
                Cell::Number(own.seam, 2),
                Cell::Number(own.recorded_seam, 2),
                Cell::Number(1e3 * own.slide[0], 2),
                Cell::Number(1e3 * own.slide[1], 2),
            ]);
        }
    }
    table
}

/// How long the first sequences last without repeating themselves.
fn lasts(capture: &Capture, chosen: &[&Sequence], all: &Arc<Alternatives>, seed: u64) -> Table {
    let caption = "Ten minutes of a sequence, gone through again and again with mixtures of its alternatives drawn by a seed: passes, the mean distance \
                   of a vertex between two of them and between the two that are nearest to each other, and the longest passage that had been \
                   shown before within 1 mm.";
    let columns = ["sequence", "seed", "passes", "apart mm", "nearest mm", "longest within 1 mm s"];
    let mut table = Table::new("variations_lasting", caption, &columns);
    for sequence in chosen.iter().take(2) {
        for seed in seed..seed + SEEDS {
            let shown = (*sequence, capture.topology.vertex_count());
            let found = lasting(all, shown, capture.timeline.fps(), LASTS, seed);
            table.rows.push(vec![
                sequence.name.as_str().into(),
                Cell::Count(seed),
                Cell::Count(found.passes as u64),
                Cell::Number(1e3 * found.apart, 1),
                Cell::Number(1e3 * found.nearest, 1),
                Cell::Number(found.longest, 1),
            ]);
        }
    }
    table
}

/// Figure 6.5 as numbers: how far alternatives spread.
fn spread_plot(measures: &[Vec<Played>]) -> Plot {
    let line = |of: fn(&Played) -> f64| {
        let mean = |own: &Vec<Played>| own.iter().map(of).sum::<f64>() / own.len().max(1) as f64;
        AMOUNTS.iter().zip(measures).map(|(amount, own)| (*amount, 1e3 * mean(own))).collect()
    };
    Plot {
        caption: "Mean distance of two alternatives, and of one from the recording, by amount.".into(),
        x: "amount".into(),
        y: "mm".into(),
        series: vec![
            Series::new("from each other", SeriesStyle::DottedLine, 0, line(|own| own.apart)),
            Series::new("from the recording", SeriesStyle::DottedLine, 1, line(|own| own.off)),
        ],
        from_zero: true,
        ..Plot::default()
    }
}

/// Our marks, beside what was found.
fn agreements(
    fits: &Table,
    timed: Option<(usize, f64)>,
    measures: &[Vec<Played>],
    all: &[(Arc<Alternatives>, [usize; 2])],
    capture: &Capture,
) -> Result<Vec<Agreement>, EvaluateError> {
    let worst = |of: fn(&Played) -> f64| measures.iter().flatten().map(of).fold(0.0, f64::max);
    let three = fits.rows.iter().filter(|row| row[1] == Cell::Count(3)).filter_map(|row| match row[4] {
        Cell::Number(ratio, _) => Some(ratio),
        _ => None,
    });
    let ratio = three.fold(0.0, f64::max);
    let mean = |own: &[Played]| own.iter().map(|own| 1e3 * own.apart).sum::<f64>() / own.len().max(1) as f64;
    let apart: Vec<f64> = measures.iter().map(|own| mean(own)).collect();
    let grows = apart.windows(2).all(|pair| pair[1] > pair[0]);
    let bytes = bytes(capture, &all[USUAL].0)?;
    let [rejected, stretches] = all[USUAL].1;
    let one = |papers: &str, found: String, holds: bool, why: &str| Agreement {
        papers: papers.into(),
        found,
        verdict: Verdict::of(holds, holds),
        why: why.into(),
    };
    let (at_end, recorded) = (worst(|own| own.seam), worst(|own| own.recorded_seam));
    let (frames, seconds) = timed.unwrap_or((0, f64::NAN));
    Ok(vec![
        one(
            "A Gaussian process dynamical model of three dimensions errs by at most a third of what three principal components do (figure 6.4)",
            format!("at most {ratio:.2} of it"),
            ratio <= MARKS[0],
            "The worst of the sequences",
        ),
        one("It is learned from 168 frames in 2 s", format!("{frames} frames in {seconds:.2} s"), seconds <= 2.0, "Depends on the machine, and on what else it does"),
        one(
            "Mark: alternatives are accelerated by at most 1.1 of the recording",
            format!("{:.2} at most, of all amounts", worst(|own| own.acceleration)),
            worst(|own| own.acceleration) <= MARKS[1],
            "Where a recording hardly moves, what storing rounds is a large part of its acceleration",
        ),
        one(
            "Mark: edges change by 2 %",
            format!("{:.2} % at most", 1e2 * worst(|own| own.edges)),
            worst(|own| own.edges) <= MARKS[2],
            "A mean over edges and frames, beside the recorded frame",
        ),
        one(
            "Mark: pinned ends are as recorded",
            format!("{:.3} mm at most", 1e3 * worst(|own| own.ends)),
            worst(|own| own.ends) == 0.0,
            "The first and the last frame of a stretch have no differences",
        ),
        Agreement {
            papers: "Mark: the step at an end is at most 1.5 steps of the recording".into(),
            found: format!("{at_end:.2} at most, where the recording has {recorded:.2}"),
            verdict: Verdict::of(at_end <= f64::max(MARKS[3], NEARLY * recorded), at_end <= MARKS[3]),
            why: "In mean steps of the stretch: where the recording itself is faster at an end than on average, so are its alternatives".into(),
        },
        one(
            "Mark: two alternatives are 5 to 20 mm apart, and more by a larger amount",
            apart.iter().map(|apart| format!("{apart:.1}")).collect::<Vec<_>>().join(", ") + " mm",
            grows && apart.iter().all(|apart| (5.0..=20.0).contains(apart)),
            "Means over sequences at the amounts 0.06, 0.12 and 0.25: they grow with the power of 2/3 of these, for bounds are kept at 0.25",
        ),
        one(
            "Mark: alternatives take at most 1.5 MB an actor",
            format!("{:.2} MB; {rejected} of {stretches} stretches keep the recording", bytes as f64 / 1e6),
            bytes as f64 <= MARKS[4],
            "Of the sequences above, eight variations each",
        ),
    ])
}

/// Bytes of alternatives in a bundle.
fn bytes(capture: &Capture, all: &Alternatives) -> Result<u64, EvaluateError> {
    let graph = EssentialGraph::new(actor::graph::DEFAULT_ALPHA, Vec::new(), &capture.timeline)
        .map_err(pipeline::essential::BuildError::from)?;
    let input = BundleInput {
        capture,
        graph: &graph,
        first_frame: 0,
        max_error: bundle::default_max_error(capture, 0),
        poisson_order: None,
        generator: String::new(),
    };
    let mut extras = Extras::default();
    extras.alternatives = Some(all);
    let (_, report) = encode_with_extras(&input, &[], &Files::default(), &extras)?;
    Ok(report.sections.iter().find(|section| section.name == "alternatives").map_or(0, |section| section.stored))
}

/// A stretch as it was recorded, and some of its alternatives below.
fn picture(capture: &Capture, all: &Alternatives) -> Result<Option<Picture>, EvaluateError> {
    let Some(stretch) = all.stretches().iter().max_by_key(|stretch| stretch.last - stretch.first) else {
        return Ok(None);
    };
    let number = all.stretches().iter().position(|one| one == stretch).unwrap_or(0);
    let [columns, rows] = [SHOWN[0], 1 + SHOWN[1].min(stretch.coefficients.len())];
    let view = [110, 170];
    let size = [view[0] * columns as u32, view[1] * rows as u32];
    let mut sheet = RgbaImage::new(size[0], size[1]);
    let clay_colour = vec![glam::Vec3::new(0.62, 0.60, 0.57); capture.topology.vertex_count()];
    for row in 0..rows {
        for column in 0..columns {
            let frame = stretch.first + (column as u32 * (stretch.last - stretch.first)) / (columns as u32 - 1);
            let recorded = capture.poses.frame(frame);
            let mut pose = recorded.to_vec();
            if let Some(alternative) = row.checked_sub(1) {
                all.add((number, alternative), frame, 1.0, &mut pose);
            }
            let camera = Camera::framing(recorded, view, 0.6);
            let drawn = clay::draw(&pose, capture.topology.triangles(), &clay_colour, &camera);
            imageops::replace(&mut sheet, &drawn, i64::from(view[0]) * column as i64, i64::from(view[1]) * row as i64);
        }
    }
    let caption =
        format!("Frames {} to {} as recorded, and {} alternatives below.", stretch.first, stretch.last, rows - 1);
    Ok(Some(Picture { png: clay::png(&sheet).map_err(EvaluateError::Picture)?, size, caption }))
}
