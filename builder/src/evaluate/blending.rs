//! Section 4: blending (TVCG figures 11 and 12), foot skate and seams.

use rayon::prelude::*;
use shared::cholesky::elimination_order;
use shared::graph::EssentialGraph;
use shared::search::{Leg, Walk, cheapest_walk};
use shared::timeline::Sequence;

use super::EvaluateError;
use super::contacts::Contacts;
use super::document::{Agreement, Cell, SectionReport, Table, Verdict};
use super::plot::{Kind, Plot, Series, histogram};
use super::seams::{self, Change, Ease, Own, SeamSummary, Seams};
use super::stage::{Recordings, Stage};
use super::statistics::{Moments, percentile};
use super::subject::{Subject, told};
use super::trajectories::{Pairing, Trajectory, aligned, length, linear, sides};
use crate::performer::random::mix;
use crate::progress::{Progress, Report};
use crate::transitions::LengthChoice;

/// Cheapest walks between frames drawn at random.
const WALKS: u64 = 300;
/// Transitions on them whose frames are all made, for foot skate.
const SKATE_TRANSITIONS: usize = 200;

/// Makes the section.
pub(super) fn section(subject: &Subject, report: Report) -> Result<SectionReport, EvaluateError> {
    let recordings = Recordings::of(&subject.capture, &subject.measured.headings, &subject.centres, &subject.contacts);
    let order = elimination_order(&subject.capture.topology);
    let mut section = SectionReport::default();
    trajectories(subject, &mut section);
    let own = Own::of(&recordings);
    let limit = own.percentile(0.99);
    let mut reports = Vec::new();
    let mut skates = Vec::new();
    for choice in [LengthChoice::Total, LengthChoice::Mean] {
        let graph = subject.graph(choice, report)?;
        let of_graph = draw(graph.transitions().len(), subject.options.seam_transitions, subject.options.seed);
        let walks = walks(subject, &graph, report);
        for (population, chosen) in [("graph", &of_graph), ("walks", &walks.transitions)] {
            for ease in [Ease::Smooth, Ease::Linear] {
                let told = told(report, "seams");
                let seams = seams::measure(recordings, &order, graph.transitions(), chosen, ease, &told)?;
                reports.push(SeamReport { choice, population, ease, seams });
            }
        }
        let few: Vec<usize> = draw(walks.transitions.len(), SKATE_TRANSITIONS, subject.options.seed)
            .into_iter()
            .map(|place| walks.transitions[place])
            .collect();
        let free = Recordings { contacts: &shared::contacts::Contacts::default(), ..recordings };
        let slides = Skate {
            held: skate(subject, recordings, &order, &graph, &few, report)?,
            free: skate(subject, free, &order, &graph, &few, report)?,
        };
        skates.push((choice, walks, slides));
    }
    skate_table(subject, &recordings, &skates, &mut section);
    seam_tables(subject, &reports, &own, limit, &mut section);
    Ok(section)
}

/// The seams of some transitions of one graph.
struct SeamReport {
    choice: LengthChoice,
    /// Where the transitions were drawn from: the graph, or cheapest walks.
    population: &'static str,
    ease: Ease,
    seams: Vec<Seams>,
}

/// Cheapest walks between frames drawn at random, as users ask for them.
struct Walks {
    /// The transitions on them, as often as they are used.
    transitions: Vec<usize>,
    /// Cost, deformation, duration in frames, transitions.
    moments: [Moments; 4],
}

fn walks(subject: &Subject, graph: &EssentialGraph, report: Report) -> Walks {
    let (n, seed) = (u64::from(subject.timeline().frame_count()), subject.options.seed);
    let frame = |index: u64| (mix(seed, index) % n) as u32;
    report(Progress { what: "walks", done: 0, total: 0 });
    let found: Vec<Option<Walk>> = (0..WALKS)
        .into_par_iter()
        .map(|index| cheapest_walk(graph, subject.timeline(), frame(2 * index), frame(2 * index + 1)))
        .collect();
    let mut walks = Walks { transitions: Vec::new(), moments: [Moments::default(); 4] };
    for walk in found.iter().flatten() {
        let values = [walk.cost, walk.deformation, f64::from(walk.duration), walk.transition_count() as f64];
        values.into_iter().zip(&mut walks.moments).for_each(|(value, moments)| moments.add(value));
        walks.transitions.extend(walk.legs.iter().filter_map(|leg| match leg {
            Leg::Synthetic(index) => Some(*index as usize),
            Leg::Recorded { .. } => None,
        }));
    }
    walks.transitions.sort_unstable();
    walks
}

/// Up to `most` of 0..count, in order.
pub(super) fn draw(count: usize, most: usize, seed: u64) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let mut keyed: Vec<(u64, usize)> = (0..count).map(|index| (mix(seed, index as u64), index)).collect();
    keyed.sort_unstable();
    let mut chosen: Vec<usize> = keyed.into_iter().take(most).map(|(_, index)| index).collect();
    chosen.sort_unstable();
    chosen
}

/// Blends two sequences that turn apart.
fn trajectories(subject: &Subject, section: &mut SectionReport) {
    let Some((names, pairing)) = turning_apart(subject) else {
        section.text.push("No two sequences are long enough to be blended as in TVCG figure 11.".into());
        return;
    };
    let (headings, centres) = (&subject.measured.headings, subject.centres.as_slice());
    let recorded = sides(pairing, headings, centres);
    let whole = (length(&recorded[0]) + length(&recorded[1])) / 2.0;
    let mut table = Table::new(
        "trajectories",
        format!(
            "Length of the centre of mass\u{2019}s trajectory when {} and {} are blended, against the mean of both, over \
             {} frames.",
            names[0], names[1], pairing.length
        ),
        &[
            "weight",
            "without alignment, m",
            "with recurring alignment, m",
            "mean of both, m",
            "kept without",
            "kept with",
        ],
    );
    let half = |_: f32| 0.5;
    let rising = |t: f32| t;
    let weights: [(&str, &dyn Fn(f32) -> f32); 2] = [("0.5 throughout", &half), ("from 0 to 1", &rising)];
    let mut kept = Vec::new();
    for (name, weight) in weights {
        let without = linear(pairing, headings, centres, weight);
        let with = aligned(pairing, headings, centres, weight);
        let (a, b) = (length(&without), length(&with));
        kept.push((a / whole, b / whole));
        table.rows.push(vec![
            name.into(),
            Cell::Number(a, 3),
            Cell::Number(b, 3),
            Cell::Number(whole, 3),
            Cell::Text(format!("{:.0} %", 100.0 * a / whole)),
            Cell::Text(format!("{:.0} %", 100.0 * b / whole)),
        ]);
        let line = |name: &str, kind, colour, trajectory: &Trajectory| {
            Series::new(name, kind, colour, trajectory.iter().map(|p| (f64::from(p.x), f64::from(p.y))).collect())
        };
        section.plots.push(Plot {
            caption: format!("Centre of mass, weight {name} (TVCG figures 11 and 12)."),
            x: "x, m".into(),
            y: "z, m".into(),
            series: vec![
                line(&names[0], Kind::Dashes, 5, &recorded[0]),
                line(&names[1], Kind::Dashes, 4, &recorded[1]),
                line("without alignment", Kind::Line, 1, &without),
                line("recurring alignment", Kind::Line, 0, &with),
            ],
            equal: true,
            ..Plot::default()
        });
    }
    section.tables.push(table);
    let (without, with) = kept[0];
    section.agreements.push(Agreement {
        papers: "Recurring alignment keeps the trajectory from collapsing".into(),
        found: format!("{:.0} % of the way is kept with it, {:.0} % without", 100.0 * with, 100.0 * without),
        verdict: Verdict::of(with > without, with > 0.9 && with < 1.15),
        why: String::new(),
    });
}

/// The two sequences whose bodies turn furthest apart, by their names and labels where those say left and right.
fn turning_apart(subject: &Subject) -> Option<([String; 2], Pairing)> {
    let sequences = subject.timeline().sequences();
    let says = |sequence: &Sequence, side: &str| {
        sequence.name.contains(side) || sequence.labels.iter().any(|label| label.contains(side))
    };
    let pairing = |a: &Sequence, b: &Sequence| Pairing {
        first: [a.first_frame, b.first_frame],
        length: a.frame_count.min(b.frame_count),
    };
    let named = |a: &Sequence, b: &Sequence| ([a.name.clone(), b.name.clone()], pairing(a, b));
    let left = sequences.iter().find(|sequence| says(sequence, "left"));
    let right = sequences.iter().find(|sequence| says(sequence, "right"));
    if let (Some(left), Some(right)) = (left, right) {
        return Some(named(left, right));
    }
    let headings = &subject.measured.headings;
    let apart = |a: &Sequence, b: &Sequence| {
        let length = a.frame_count.min(b.frame_count) - 1;
        let turn = |s: &Sequence| headings.get(s.first_frame as usize, (s.first_frame + length) as usize);
        (turn(a) - turn(b)).abs()
    };
    let pairs = sequences.iter().enumerate().flat_map(|(i, a)| sequences[i + 1..].iter().map(move |b| (a, b)));
    let long = pairs.filter(|(a, b)| a.frame_count.min(b.frame_count) >= 12);
    long.max_by(|x, y| apart(x.0, x.1).total_cmp(&apart(y.0, y.1))).map(|(a, b)| named(a, b))
}

/// Slides in metres per frame: of all that touches the ground, and of feet that are known to stand.
#[derive(Default)]
struct Slides {
    touching: Vec<f64>,
    standing: Vec<f64>,
}

/// The same transitions with what stands kept still, and as in the papers.
struct Skate {
    held: Slides,
    free: Slides,
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

fn skate(
    subject: &Subject,
    recordings: Recordings,
    order: &[u32],
    graph: &EssentialGraph,
    chosen: &[usize],
    report: Report,
) -> Result<Slides, EvaluateError> {
    let contacts = Contacts::of(&recordings, subject.truth.as_ref());
    let told = told(report, "foot skate");
    let done = std::sync::atomic::AtomicUsize::new(0);
    let parts: Vec<Slides> = chosen
        .par_chunks(4)
        .map(|chunk| {
            let mut stage = Stage::new(recordings, order)?;
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
            let before = done.fetch_add(chunk.len(), std::sync::atomic::Ordering::Relaxed);
            told((before + chunk.len()) as f64 / chosen.len() as f64);
            Ok(slides)
        })
        .collect::<Result<_, EvaluateError>>()?;
    Ok(Slides {
        touching: parts.iter().flat_map(|part| part.touching.iter().copied()).collect(),
        standing: parts.iter().flat_map(|part| part.standing.iter().copied()).collect(),
    })
}

fn skate_table(
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
        let lengths = if *choice == LengthChoice::Total { "lengths by the sum" } else { "lengths by the mean" };
        for (slides, way) in [(held, "contacts held"), (free, "as in the papers")] {
            let name = format!("synthetic, {way}, {lengths}");
            add(&name, "touching", &slides.touching);
            sliding.push(add(&name, "standing", &slides.standing));
        }
    }
    section.tables.push(table);
    section.tables.push(walks_table(skates, fps));
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

fn walks_table(skates: &[(LengthChoice, Walks, Skate)], fps: f64) -> Table {
    let mut table = Table::new(
        "walks",
        format!("{WALKS} cheapest walks between frames drawn at random, those that exist."),
        &["lengths by", "walks", "cost", "deformation", "duration, s", "deviation, s", "transitions"],
    );
    for (choice, walks, _) in skates {
        let [cost, deformation, duration, transitions] = walks.moments;
        table.rows.push(vec![
            lengths_by(*choice).into(),
            Cell::Count(cost.count),
            Cell::Number(cost.mean, 3),
            Cell::Number(deformation.mean, 3),
            Cell::Number(duration.mean / fps, 2),
            Cell::Number(duration.deviation() / fps, 2),
            Cell::Number(transitions.mean, 2),
        ]);
    }
    table
}

fn lengths_by(choice: LengthChoice) -> &'static str {
    if choice == LengthChoice::Total { "sum" } else { "mean" }
}

fn seam_tables(subject: &Subject, reports: &[SeamReport], own: &Own, limit: Change, section: &mut SectionReport) {
    let mut table = Table::new(
        "seams",
        format!(
            "Seams of up to {most} transitions of each graph drawn at random, and of the transitions on \
             cheapest walks between frames drawn at random, against the capture\u{2019}s own change from \
             frame to frame, whose 99th percentile is {:.2} mm (geometry) and {:.2} mm a frame (velocity); root mean \
             squares over the vertices.",
            limit.geometry * 1e3,
            limit.velocity * 1e3,
            most = subject.options.seam_transitions
        ),
        &[
            "lengths by",
            "drawn from",
            "weight",
            "seams",
            "geometry above",
            "velocity above",
            "geometry: median, mm",
            "99th",
            "most",
            "velocity: median, mm a frame",
            "99th ",
            "most ",
        ],
    );
    let share = |above: u64, count: u64| format!("{:.1} %", 100.0 * above as f64 / count.max(1) as f64);
    let mut summaries = Vec::new();
    for SeamReport { choice, population, ease, seams } in reports {
        let s = SeamSummary::of(seams, limit);
        summaries.push(s);
        table.rows.push(vec![
            lengths_by(*choice).into(),
            (*population).into(),
            if *ease == Ease::Linear { "linear" } else { "smooth" }.into(),
            Cell::Count(s.count),
            Cell::Text(share(s.above[0], s.count)),
            Cell::Text(share(s.above[1], s.count)),
            Cell::Number(s.median.geometry * 1e3, 2),
            Cell::Number(s.high.geometry * 1e3, 2),
            Cell::Number(s.greatest.geometry * 1e3, 2),
            Cell::Number(s.median.velocity * 1e3, 2),
            Cell::Number(s.high.velocity * 1e3, 2),
            Cell::Number(s.greatest.velocity * 1e3, 2),
        ]);
    }
    section.tables.push(table);
    let walked = |ease: Ease| {
        let mut reports = reports.iter().zip(&summaries);
        reports.find(|(report, _)| report.population == "walks" && report.ease == ease).map(|(_, summary)| summary)
    };
    let (Some(first), papers) = (walked(Ease::Smooth), walked(Ease::Linear)) else { return };
    section.agreements.push(Agreement {
        papers: "Our own mark: no seam above the capture\u{2019}s 99th percentile in geometry and velocity".into(),
        found: format!(
            "{} of {} seams on walks above in geometry, {} in velocity, with our weight and lengths by the sum; the papers\u{2019}: {} and {}",
            first.above[0],
            first.count,
            first.above[1],
            papers.map_or(0, |papers| papers.above[0]),
            papers.map_or(0, |papers| papers.above[1])
        ),
        verdict: Verdict::of(first.above[0] == 0, first.above == [0, 0]),
        why: "Between shapes far apart a blend has to move faster than the capture does, whatever its weight.".into(),
    });
    section.text.push(
        "Our weight begins and ends at rest (3 t\u{b2} minus 2 t\u{b3}); the papers\u{2019} grows evenly, so that at the \
         first synthetic frame the surface takes on the velocity (destination minus source) over L at once. The rows \
         named linear show the papers\u{2019}, along our paths on the ground."
            .into(),
    );
    let velocities = |seams: &[Seams]| -> Vec<f64> {
        let changes = seams.iter().flat_map(|seams| [seams.start, seams.end]).flatten();
        changes.map(|change| change.velocity * 1e3).collect()
    };
    let bins = |values: &[f64]| histogram(values, 40);
    let outline = |name: &str, colour, values: &[f64]| Series::new(name, Kind::Line, colour, bins(values));
    let recorded: Vec<f64> = own.velocity.iter().map(|velocity| velocity * 1e3).collect();
    section.plots.push(Plot {
        caption: "Change of velocity at seams and at recorded frames; the line marks the recorded 99th percentile."
            .into(),
        x: "change of velocity, mm a frame (RMS)".into(),
        y: "share".into(),
        series: [
            vec![outline("recorded frames", 5, &recorded)],
            reports
                .iter()
                .filter(|report| report.choice == LengthChoice::Total && report.population == "walks")
                .map(|SeamReport { ease, seams, .. }| {
                    let (name, colour) =
                        if *ease == Ease::Linear { ("seams, linear", 1) } else { ("seams, smooth", 0) };
                    outline(name, colour, &velocities(seams))
                })
                .collect(),
        ]
        .concat(),
        marks: vec![(limit.velocity * 1e3, "99 %".into(), 2)],
        from_zero: true,
        ..Plot::default()
    });
}
