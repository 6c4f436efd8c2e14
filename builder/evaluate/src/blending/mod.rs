//! Section 4: blending (TVCG figures 11 and 12), foot skate and seams.

mod foot_skate;
mod seam_tables;
mod turning;
mod walks;

use kernels::cholesky::elimination_order;

use super::EvaluateError;
use super::document::SectionReport;
use super::performance::Recordings;
use super::seams::{self, Ease, Own};
use super::subject::{Subject, progress_of};
use foot_skate::{Skate, skate, skate_table};
use job::Job;
use kernels::random::mix;
use pipeline::transitions::LengthChoice;
use seam_tables::{SeamReport, seam_tables};
use walks::{SKATE_TRANSITIONS, walks};

/// Makes the section.
pub(super) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let recordings = Recordings::of(&subject.capture, &subject.measured.headings, &subject.centres, &subject.contacts);
    let order = elimination_order(&subject.capture.topology);
    let mut section = SectionReport::default();
    turning::trajectories(subject, &mut section);
    let own = Own::of(&recordings);
    let limit = own.percentile(0.99);
    let mut reports = Vec::new();
    let mut skates = Vec::new();
    for choice in [LengthChoice::Total, LengthChoice::Mean] {
        let graph = subject.graph(choice, job)?;
        let of_graph = draw(graph.transitions().len(), subject.options.seam_transitions, subject.options.seed);
        let walks = walks(subject, &graph, job)?;
        for (population, chosen) in [("graph", &of_graph), ("walks", &walks.transitions)] {
            for ease in [Ease::Smooth, Ease::Linear] {
                let progress = progress_of(job, "seams");
                let seams = seams::measure(recordings, &order, graph.transitions(), chosen, ease, &progress)?;
                reports.push(SeamReport { choice, population, ease, seams });
            }
        }
        let few: Vec<usize> = draw(walks.transitions.len(), SKATE_TRANSITIONS, subject.options.seed)
            .into_iter()
            .map(|place| walks.transitions[place])
            .collect();
        let free = Recordings { contacts: &actor::contacts::Contacts::default(), ..recordings };
        let slides = Skate {
            held: skate(subject, recordings, &order, &graph, &few, job)?,
            free: skate(subject, free, &order, &graph, &few, job)?,
        };
        skates.push((choice, walks, slides));
    }
    skate_table(subject, &recordings, &skates, &mut section);
    seam_tables(subject, &reports, &own, limit, &mut section);
    Ok(section)
}

/// Up to `most` of 0..count, in order.
pub(crate) fn draw(count: usize, most: usize, seed: u64) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let mut keyed: Vec<(u64, usize)> = (0..count).map(|index| (mix(seed, index as u64), index)).collect();
    keyed.sort_unstable();
    let mut chosen: Vec<usize> = keyed.into_iter().take(most).map(|(_, index)| index).collect();
    chosen.sort_unstable();
    chosen
}
