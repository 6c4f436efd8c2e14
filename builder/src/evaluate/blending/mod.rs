//! Section 4: blending (TVCG figures 11 and 12), foot skate and seams.

mod foot_skate;
mod seam_tables;
mod turning;

use rayon::prelude::*;
use shared::cholesky::elimination_order;
use shared::graph::EssentialGraph;
use shared::search::{Leg, Walk, cheapest_walk};

use super::EvaluateError;
use super::document::{Cell, SectionReport, Table};
use super::seams::{self, Ease, Own};
use super::stage::Recordings;
use super::statistics::Moments;
use super::subject::{Subject, told};
use crate::performer::random::mix;
use crate::progress::{Progress, Report};
use crate::transitions::LengthChoice;
use foot_skate::{Skate, skate, skate_table};
use seam_tables::{SeamReport, seam_tables};

/// Cheapest walks between frames drawn at random.
const WALKS: u64 = 300;
/// Transitions on them whose frames are all made, for foot skate.
const SKATE_TRANSITIONS: usize = 200;

/// Makes the section.
pub(super) fn section(subject: &Subject, report: Report) -> Result<SectionReport, EvaluateError> {
    let recordings = Recordings::of(&subject.capture, &subject.measured.headings, &subject.centres, &subject.contacts);
    let order = elimination_order(&subject.capture.topology);
    let mut section = SectionReport::default();
    turning::trajectories(subject, &mut section);
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

fn walks_table(skates: &[(LengthChoice, Walks, Skate)], fps: f64) -> Table {
    let mut table = Table::new(
        "walks",
        format!("{WALKS} cheapest walks between frames drawn at random, those that exist."),
        &["lengths by", "walks", "cost", "deformation", "duration, s", "deviation, s", "transitions"],
    );
    for (choice, walks, _) in skates {
        let [cost, deformation, duration, transitions] = walks.moments;
        table.rows.push(vec![
            choice.word().into(),
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
