//! Two templates become one: where one of them can be brought onto a frame that the other lies on, each knows where it is on the
//! other, and can be carried to all of its frames.
//!
//! Which of both is brought onto frames of the other matters: a template in which an arm is fused to the body covers no raised
//! arm, but one with a raised arm covers a body that hides it.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use job::Job;
use rayon::prelude::*;

use super::carried::Carried;
use super::checks::{Fault, Fit};
use super::cut::Group;
use super::detail::DetailError;
use super::far::Manner;
use super::register::{Found, Lost, RegisterOptions, Source, Survey, Tracked};
use super::registrar::{Registrar, State, Tried};
use super::ways::{Known, Ways};

/// On so many frames of the other template one is tried.
const BRIDGES: usize = 4;

/// A frame on which both templates lie.
#[derive(Clone, Debug)]
pub(crate) struct Bridge {
    /// The frame, which is one of the first template's.
    pub frame: usize,
    /// The frame of the second template that this was tracked from, and how it fits.
    pub tracked: Tracked,
    /// The pose of the second template on the frame.
    pub pose: Vec<Vec3>,
}

/// A frame that a template was carried to, and the pose.
pub(crate) type Arrived = (Tracked, Vec<Vec3>);

/// What became of frames that a template was carried to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Carriage {
    pub arrived: Vec<Arrived>,
    pub lost: Vec<(usize, Lost)>,
}

/// Brings the template of `group` onto a frame of `main`; `None` where that cannot be done.
pub(crate) fn bridge<S: Source>(
    (source, survey): (&S, &Survey),
    main: &Group,
    group: &Group,
    options: &RegisterOptions,
    job: &Job,
) -> Result<Option<Bridge>, S::Error>
where
    S::Error: From<DetailError>,
{
    let nothing = |_: Found<S::Extra>| Ok(());
    let registrar = Registrar::new((source, survey), &group.template, options, job, &nothing)?;
    let state = states(survey, group);
    let known: Vec<Known> =
        state.iter().map(|state| Known { tracked: state.pose.is_some(), ..Known::default() }).collect();
    let root = survey.frames.iter().position(|&frame| frame == group.root).unwrap_or(0);
    let ways = Ways::new(survey, (root, &[]), |frame| source.sequence(frame));
    for (tried, k) in nearest(survey, main, group, &ways).into_iter().enumerate() {
        job.tell("joining templates", tried as u64, BRIDGES as u64)?;
        let Some(target) = registrar.target(k)? else { continue };
        let parents = ways.nearest(k, &known);
        let tries = parents.len();
        let Some(Tried { parent, pose, fit, .. }) = registrar.found_far(k, &parents, &state, &target) else { continue };
        if fit.far_fault(&options.limits, group.template.scale).is_none() {
            let (frame, parent) = (survey.frames[k], Some(survey.frames[parent]));
            let tracked = Tracked { frame, parent, fit, tries, followed: false, through: Some(main.root) };
            return Ok(Some(Bridge { frame, tracked, pose }));
        }
    }
    Ok(None)
}

/// Frames of `main` that are most alike to frames of `group` and not too much to each other, and its template's own.
fn nearest(survey: &Survey, main: &Group, group: &Group, ways: &Ways) -> Vec<usize> {
    let of =
        |group: &Group| -> Vec<usize> { (0..survey.frames.len()).filter(|&k| group.holds(survey.frames[k])).collect() };
    let (mut able, others) = (of(main), of(group));
    let unlike =
        |k: usize| others.iter().map(|&other| survey.dissimilarity.get(k, other)).fold(f32::INFINITY, f32::min);
    able.sort_by(|&a, &b| unlike(a).total_cmp(&unlike(b)).then(a.cmp(&b)));
    let own = able.iter().copied().find(|&k| survey.frames[k] == main.root);
    let mut found: Vec<usize> = Vec::new();
    for k in able {
        if found.len() + 1 < BRIDGES && !found.iter().any(|&other| ways.near_in_time(k, other)) {
            found.push(k);
        }
    }
    found.extend(own.filter(|own| !found.contains(own)));
    found
}

/// Where the template of `group` lies, frame by frame of `survey`.
fn states(survey: &Survey, group: &Group) -> Vec<State> {
    let of = |frame: &usize| State { pose: group.registered.poses.get(frame).cloned(), ..State::default() };
    survey.frames.iter().map(of).collect()
}

/// Carries the template of `group` to the `frames` of `carrier`. `here` and `there` are the poses of both on the frame `at`.
pub(crate) fn carried<S: Source>(
    (source, survey): (&S, &Survey),
    (group, here): (&Group, &[Vec3]),
    (carrier, there): (&Group, &[Vec3]),
    (at, frames): (usize, &[usize]),
    options: &RegisterOptions,
    job: &Job,
) -> Result<Carriage, S::Error>
where
    S::Error: From<DetailError>,
{
    let nothing = |_: Found<S::Extra>| Ok(());
    let registrar = Registrar::new((source, survey), &group.template, options, job, &nothing)?;
    let number = |frame: usize| survey.frames.iter().position(|&other| other == frame);
    let Some(from) = number(at) else { return Ok(Carriage::default()) };
    let mut state = states(survey, group);
    state[from].pose = Some(here.to_vec());
    let map = Carried::new((&group.template, here), (&carrier.template, there));
    let done = AtomicU64::new(0);
    let one = |&frame: &usize| -> Result<Option<Tried>, S::Error> {
        job.tell("carrying templates", done.fetch_add(1, Ordering::Relaxed), frames.len() as u64)?;
        let Some((k, others)) = number(frame).zip(carrier.registered.poses.get(&frame)) else { return Ok(None) };
        let (Some(near), Some(target)) = (map.pose(others), registrar.target(k)?) else { return Ok(None) };
        let Some(start) = registrar.start(k, from, 0.0, &state, &target) else { return Ok(None) };
        let found = [Manner::Refine, Manner::Coloured].map(|manner| {
            let tried = registrar.tried(from, (&start, &near), &target, manner);
            registrar.again(&tried, &target)
        });
        Ok(registrar.best(found.into(), 1).pop())
    };
    let found: Vec<Result<Option<Tried>, S::Error>> = frames.par_iter().map(one).collect();
    let mut carriage = Carriage::default();
    for (&frame, found) in frames.iter().zip(found) {
        let nothing = (Fault::Uncovered, Fit { uncovered: 1.0, ..Fit::default() });
        let Some(Tried { pose, fit, .. }) = found? else {
            carriage.lost.push((frame, Lost::Untracked(nothing.0, nothing.1)));
            continue;
        };
        match fit.far_fault(&options.limits, group.template.scale) {
            Some(fault) => carriage.lost.push((frame, Lost::Untracked(fault, fit))),
            None => {
                let (parent, through) = (Some(at), Some(carrier.root));
                let tracked = Tracked { frame, parent, fit, tries: 1, followed: false, through };
                carriage.arrived.push((tracked, pose));
            }
        }
    }
    Ok(carriage)
}
