//! Frames that were tracked before anyone was there to write them.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

use job::Job;
use rayon::prelude::*;

use super::cut::Group;
use super::detail::{Detail, DetailError};
use super::register::{Emit, Found, RegisterOptions, Source, Tracked, cleaned};
use super::scan::Cleaned;
use super::track::Target;

/// Gives the frames of `group` that `wanted` wants to `emit`, with detail, parents before their children.
///
/// # Errors
/// What `source` or `emit` say, or being told to stop.
pub fn write<S: Source>(
    source: &S,
    group: &Group,
    wanted: impl Fn(usize) -> bool,
    options: &RegisterOptions,
    job: &Job,
    emit: Emit<'_, S>,
) -> Result<(), S::Error>
where
    S::Error: From<DetailError>,
{
    let detail = Detail::new(&group.template.surface, group.template.scale)?;
    let total = group.registered.tracked.iter().filter(|tracked| wanted(tracked.frame)).count() as u64;
    let done = AtomicU64::new(0);
    let one = |tracked: &&Tracked| -> Result<(), S::Error> {
        job.tell("writing frames", done.fetch_add(1, Ordering::Relaxed), total)?;
        let (mut scan, extra) = source.read(tracked.frame)?;
        let (Some((cleaned, _)), Some(pose)) = (cleaned(&mut scan), group.registered.poses.get(&tracked.frame)) else {
            return Ok(());
        };
        let Cleaned { surface, uvs, .. } = cleaned;
        let target = Target::new(surface, group.template.scale);
        let pose = if options.detail > 0.0 && tracked.frame != group.root {
            detail.add(&group.template.surface, pose, &target, options.detail)?
        } else {
            pose.clone()
        };
        emit(Found { template: &group.template, tracked, pose: &pose, target: &target, uvs: &uvs, extra })
    };
    for level in levels(&group.registered.tracked) {
        let level: Vec<&Tracked> = level.into_iter().filter(|tracked| wanted(tracked.frame)).collect();
        let done: Vec<Result<(), S::Error>> = level.par_iter().map(one).collect();
        done.into_iter().collect::<Result<(), _>>()?;
    }
    Ok(())
}

/// Frames by how many others they hang on.
fn levels(tracked: &[Tracked]) -> Vec<Vec<&Tracked>> {
    let parents: BTreeMap<usize, Option<usize>> = tracked.iter().map(|t| (t.frame, t.parent)).collect();
    let depth = |tracked: &Tracked| {
        let next = |frame: &usize| parents.get(frame).copied().flatten();
        std::iter::successors(tracked.parent, next).take(parents.len()).count()
    };
    let mut levels: BTreeMap<usize, Vec<&Tracked>> = BTreeMap::new();
    for tracked in tracked {
        levels.entry(depth(tracked)).or_default().push(tracked);
    }
    levels.into_values().collect()
}
