//! Cheapest walks between frames drawn at random.

use actor::graph::EssentialGraph;
use actor::walk::Walk;
use job::Job;
use kernels::random::mix;
use pipeline::transitions::LengthChoice;
use rayon::prelude::*;
use search::cheapest_walk;

use crate::EvaluateError;
use crate::document::{Cell, Table};
use crate::statistics::Moments;
use crate::subject::Subject;

/// Cheapest walks between frames drawn at random.
const WALKS: u64 = 300;

/// Transitions on them whose frames are all made, for foot skate.
pub(super) const SKATE_TRANSITIONS: usize = 200;

/// Cheapest walks between frames drawn at random, as users ask for them.
pub(super) struct Walks {
    /// The transitions on them, as often as they are used.
    pub transitions: Vec<usize>,
    /// Cost, deformation, duration in frames, transitions.
    pub moments: [Moments; 4],
}

pub(super) fn walks(subject: &Subject, graph: &EssentialGraph, job: &Job) -> Result<Walks, EvaluateError> {
    let (n, seed) = (u64::from(subject.timeline().frame_count()), subject.options.seed);
    let frame = |index: u64| (mix(seed, index) % n) as u32;
    job.begin("walks")?;
    let found: Vec<Option<Walk>> = (0..WALKS)
        .into_par_iter()
        .map(|index| cheapest_walk(graph, subject.timeline(), frame(2 * index), frame(2 * index + 1)))
        .collect();
    let mut walks = Walks { transitions: Vec::new(), moments: [Moments::default(); 4] };
    for walk in found.iter().flatten() {
        let values = [walk.cost, walk.deformation, f64::from(walk.duration), walk.transition_count() as f64];
        values.into_iter().zip(&mut walks.moments).for_each(|(value, moments)| moments.add(value));
        walks.transitions.extend(walk.legs.iter().filter_map(|leg| leg.transition().map(|index| index as usize)));
    }
    walks.transitions.sort_unstable();
    Ok(walks)
}

pub(super) fn walks_table<'a>(walks: impl Iterator<Item = (LengthChoice, &'a Walks)>, fps: f64) -> Table {
    let mut table = Table::new(
        "walks",
        format!("{WALKS} cheapest walks between frames drawn at random, those that exist."),
        &["lengths by", "walks", "cost", "deformation", "duration, s", "deviation, s", "transitions"],
    );
    for (choice, walks) in walks {
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
