//! All frames of a scan, tracked along the tree: frames whose parents are tracked go side by side; what fails is tried again
//! from others, and what fails then is lost, with the reason.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicU64;

use job::Job;

use super::colouring::Colourings;
use super::detail::DetailError;
use super::registrar::{Registrar, State};
pub use super::survey::{Lost, RegisterOptions, Source, Survey, cleaned, survey, template, windowed};
use super::template::Template;
pub use super::tracked::{Emit, Found, Registered, Tracked};
use super::tree::Tree;
use super::ways::{Known, Way, Ways};

/// Tracks `template` through all frames of `survey` along `tree`. `emit` is given every frame that is tracked, from many threads
/// at once, a parent always before its children.
///
/// # Errors
/// What `source` or `emit` say, or being told to stop.
pub fn register<S: Source>(
    source: &S,
    survey: &Survey,
    tree: &Tree,
    template: &Template,
    options: &RegisterOptions,
    job: &Job,
    emit: Emit<'_, S>,
) -> Result<Registered, S::Error>
where
    S::Error: From<DetailError>,
{
    let count = survey.frames.len();
    let registrar = Registrar::new((source, survey), template, options, job, emit)?;
    let ways = Ways::new(survey, (tree.root, &tree.parents), |frame| source.sequence(frame));
    let mut state: Vec<State> = (0..count).map(|_| State::default()).collect();
    let mut colourings = Colourings::new(template);
    let mut known = vec![Known::default(); count];
    let done = AtomicU64::new(0);
    job.tell("registering", 0, count as u64)?;
    let mut open = vec![(tree.root, Way::Root)];
    while !open.is_empty() {
        registrar.work(&open, (&mut state, &mut colourings), &known, &done)?;
        for (k, way) in &open {
            known[*k].tracked = state[*k].pose.is_some();
            known[*k].strain = state[*k].tracked.as_ref().map_or(0.0, |tracked| tracked.fit.strain);
            known[*k].tried.extend(way.parents());
            known[*k].far += usize::from(matches!(way, Way::Far(_)));
        }
        open = ways.next(&known);
    }
    let mut lost = survey.lost.clone();
    let (mut tracked, mut poses) = (Vec::new(), BTreeMap::new());
    for (k, state) in state.into_iter().enumerate() {
        poses.extend(state.pose.map(|pose| (survey.frames[k], pose)));
        match (state.tracked, state.failed) {
            (Some(found), _) => tracked.push(found),
            (None, Some((fault, fit))) => lost.push((survey.frames[k], Lost::Untracked(fault, fit))),
            (None, None) => lost.push((survey.frames[k], Lost::Empty)),
        }
    }
    lost.sort_by_key(|&(frame, _)| frame);
    Ok(Registered { tracked, lost, poses, recoloured: colourings.changed() })
}
