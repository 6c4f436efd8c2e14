//! Foot skate: how far what stands on the ground slides in recorded and in synthetic frames.

use std::sync::atomic::{AtomicUsize, Ordering};

use actor::graph::EssentialGraph;
use rayon::prelude::*;

use super::walks::{SKATE_TRANSITIONS, Walks, walks_table};
use crate::EvaluateError;
use crate::contacts::Contacts;
use crate::document::{Cell, SectionReport, Table};
use crate::performance::{Performance, Recordings};
use crate::statistics::{Moments, percentile};
use crate::subject::{Subject, progress_of};
use job::Job;
use pipeline::transitions::LengthChoice;

/// Slides in metres per frame: of all that touches the ground, and of feet that are known to stand.
#[derive(Default)]
pub(super) struct Slides {
    touching: Vec<f64>,
    standing: Vec<f64>,
}

/// The same transitions with what stands kept still, and as in the papers.
pub(super) struct Skate {
    pub(super) held: Slides,
    pub(super) free: Slides,
}

fn recorded_slides(subject: &Subject, recordings: &Recordings, contacts: &Contacts) -> Slides {
    let mut slides = Slides::default();
    for sequence in subject.timeline().sequences() {
        for frame in sequence.first_frame..sequence.end_frame() - 1 {
            let (before, after) = (recordings.poses.frame(frame), recordings.poses.frame(frame + 1));
            slides.touching.extend(contacts.slide(before, after).map(|slide| slide.0));
            for side in standing(subject, &[frame, frame + 1]) {
                slides.standing.extend(contacts.slide_of_sole(side, before, after).map(|slide| slide.0));
            }
        }
    }
    slides
}

/// The feet that the truth says stand in all of some frames.
fn standing(subject: &Subject, frames: &[u32]) -> Vec<usize> {
    let Some(truth) = &subject.truth else { return Vec::new() };
    let stands = |side: usize| frames.iter().all(|&f| truth.frames.get(f as usize).is_some_and(|f| f.planted[side]));
    (0..2).filter(|&side| stands(side)).collect()
}

/// The slides of all frames of the `chosen` transitions.
pub(super) fn skate(
    subject: &Subject,
    recordings: Recordings,
    order: &[u32],
    graph: &EssentialGraph,
    chosen: &[usize],
    job: &Job,
) -> Result<Slides, EvaluateError> {
    let contacts = Contacts::of(&recordings, subject.truth.as_ref());
    let progress = progress_of(job, "foot skate");
    let done = AtomicUsize::new(0);
    let parts: Vec<Slides> = chosen
        .par_chunks(4)
        .map(|chunk| {
            let mut stage = Performance::new(recordings, order)?;
            let mut slides = Slides::default();
            for &index in chunk {
                let blends = recordings.blends(&graph.transitions()[index])?;
                let mut before = stage.pose(&blends[0], 0.0)?;
                for pair in blends.windows(2) {
                    let after = stage.pose(&pair[1], pair[1].lambda)?;
                    slides.touching.extend(contacts.slide(&before, &after).map(|slide| slide.0));
                    for side in standing(subject, &[pair[0].frames, pair[1].frames].concat()) {
                        slides.standing.extend(contacts.slide_of_sole(side, &before, &after).map(|slide| slide.0));
                    }
                    before = after;
                }
            }
            let before = done.fetch_add(chunk.len(), Ordering::Relaxed);
            progress((before + chunk.len()) as f64 / chosen.len() as f64)?;
            Ok(slides)
        })
        .collect::<Result<_, EvaluateError>>()?;
    Ok(Slides {
        touching: parts.iter().flat_map(|part| part.touching.iter().copied()).collect(),
        standing: parts.iter().flat_map(|part| part.standing.iter().copied()).collect(),
    })
}

/// The tables of slides and of the walks that they were measured on.
pub(super) fn skate_table(
    subject: &Subject,
    recordings: &Recordings,
    skates: &[(LengthChoice, Walks, Skate)],
    section: &mut SectionReport,
) {
    let contacts = Contacts::of(recordings, subject.truth.as_ref());
    let recorded = recorded_slides(subject, recordings, &contacts);
    let mut table = Table::new(
        "foot_skate",
        format!(
            "Slide of ground contacts from frame to frame. Touching: vertices within 2 cm of the ground in both frames. \
             Standing: those of the sole of a foot that the truth says stands, on both sides of the blend and in both \
             frames. Synthetic: all frames of {SKATE_TRANSITIONS} transitions on cheapest walks between frames \
             drawn at random."
        ),
        &["frames", "contacts", "pairs of frames", "mean slide, mm", "95th percentile, mm", "mean, cm/s"],
    );
    let fps = f64::from(subject.timeline().fps());
    let mut add = |name: &str, contacts: &str, values: &[f64]| {
        let moments = Moments::of(values.iter().copied());
        let absent = values.is_empty();
        table.rows.push(vec![
            name.into(),
            contacts.into(),
            Cell::Count(moments.count),
            if absent { Cell::Empty } else { Cell::Number(moments.mean * 1e3, 2) },
            percentile(values, 0.95).map_or(Cell::Empty, |high| Cell::Number(high * 1e3, 2)),
            if absent { Cell::Empty } else { Cell::Number(moments.mean * fps * 100.0, 1) },
        ]);
        moments.mean
    };
    add("recorded", "touching", &recorded.touching);
    let still = add("recorded", "standing", &recorded.standing);
    let mut sliding = Vec::new();
    for (choice, _, Skate { held, free }) in skates {
        let lengths = format!("lengths by the {}", choice.word());
        for (slides, way) in [(held, "contacts held"), (free, "as in the papers")] {
            let name = format!("synthetic, {way}, {lengths}");
            add(&name, "touching", &slides.touching);
            sliding.push(add(&name, "standing", &slides.standing));
        }
    }
    section.tables.push(table);
    section.tables.push(walks_table(skates.iter().map(|(choice, walks, _)| (*choice, walks)), fps));
    if let (Some(_), [held, free, ..]) = (&subject.truth, sliding.as_slice()) {
        section.text.push(format!(
            "A foot that stands slides {:.2} mm a frame in synthetic frames, {:.2} mm where the blend follows the centre \
             of mass alone as in the papers, and {:.2} mm in recorded frames. What is left is feet that stand further apart \
             on one side than on the other: no step of the body can keep both still.",
            held * 1e3,
            free * 1e3,
            still * 1e3
        ));
    }
}
