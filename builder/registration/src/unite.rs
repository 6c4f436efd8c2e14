//! What the template cannot be brought onto: it is brought onto a template of its own, and both are joined, so that there is one
//! mesh all the same; where that cannot be, there are several.

use job::Job;

use super::cut::{Group, cut, make_motion};
use super::detail::DetailError;
use super::join::{Arrived, bridge, carried};
use super::register::{RegisterOptions, Source, Survey};

/// So many templates are tried beside the first.
const MOST: usize = 4;

/// Frames on one template, and those on others.
#[derive(Debug)]
pub struct United {
    /// The template that most frames are on: the first, or one that takes its place because it can be brought onto more frames.
    pub main: Group,
    /// Frames that it could not be brought onto, on templates of their own.
    pub others: Vec<Group>,
}

/// Brings the frames that are lost to `first` onto templates of their own, and joins these with it.
///
/// # Errors
/// What `source` says, or being told to stop.
pub fn unite<S: Source>(
    source: &S,
    survey: &Survey,
    first: Group,
    options: &RegisterOptions,
    job: &Job,
) -> Result<United, S::Error>
where
    S::Error: From<DetailError>,
{
    let (mut main, mut others) = (first, Vec::new());
    let mut tried: Vec<usize> = Vec::new();
    for _ in 0..MOST {
        let waiting: Vec<usize> = main.untracked().into_iter().filter(|frame| !tried.contains(frame)).collect();
        let Some(mut group) = cut(source, survey, &waiting, options, job)? else { break };
        tried.extend(group.frames());
        if !make_motion(source, &group.frames()) {
            continue;
        }
        main = joined((source, survey), main, &mut group, options, job)?;
        group.retain(|frame| !main.holds(frame));
        tried.extend(group.frames());
        if make_motion(source, &group.frames()) {
            others.push(group);
        }
    }
    Ok(United { main, others })
}

/// `main` with the frames of `group` that its template can be carried to; or, where the template of `group` can be brought onto more
/// frames, that one with the frames of both. `group` is the other one then.
fn joined<S: Source>(
    scan: (&S, &Survey),
    mut main: Group,
    group: &mut Group,
    options: &RegisterOptions,
    job: &Job,
) -> Result<Group, S::Error>
where
    S::Error: From<DetailError>,
{
    let Some(bridge) = bridge(scan, &main, group, options, job)? else { return Ok(main) };
    let Some(own) = main.registered.poses.get(&bridge.frame) else { return Ok(main) };
    let there = carried(scan, (&main, own), (group, &bridge.pose), (bridge.frame, &group.frames()), options, job)?;
    // A template that was asked for stays. One of more parts, as of two people, would lie on one of them twice.
    let may = options.template.is_none() && !there.lost.is_empty();
    if may && parts_of(scan.1, group) <= parts_of(scan.1, &main) {
        let frames: Vec<usize> = main.frames().into_iter().filter(|&frame| frame != bridge.frame).collect();
        let back = carried(scan, (group, &bridge.pose), (&main, own), (bridge.frame, &frames), options, job)?;
        if back.lost.len() < there.lost.len() {
            let lost = main.registered.lost.iter().copied().chain(back.lost).collect();
            let mut other = std::mem::replace(group, main);
            other.registered.lost = lost;
            add(&mut other, vec![(bridge.tracked, bridge.pose)]);
            add(&mut other, back.arrived);
            return Ok(other);
        }
    }
    add(&mut main, there.arrived);
    Ok(main)
}

/// Connected parts of a template.
fn parts_of(survey: &Survey, group: &Group) -> usize {
    let number = survey.frames.iter().position(|&frame| frame == group.root);
    number.map_or(usize::MAX, |k| survey.candidates[k].parts)
}

/// Frames that a template was carried to are no longer lost.
fn add(group: &mut Group, arrived: Vec<Arrived>) {
    let found = &mut group.registered;
    for (tracked, pose) in arrived {
        found.poses.insert(tracked.frame, pose);
        found.tracked.push(tracked);
    }
    found.tracked.sort_by_key(|tracked| tracked.frame);
    found.lost.retain(|(frame, _)| !found.poses.contains_key(frame));
    found.lost.sort_by_key(|&(frame, _)| frame);
}
