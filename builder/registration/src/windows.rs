//! One template through both windows of a candidate (Prada 2016, section 5, TrackTemplate): in steps of one frame, from its own
//! outwards, with one step from the one window to the other, which are alike there.

use glam::Vec3;
use job::Job;

use super::checks::{Fault, Fit};
use super::detail::DetailError;
use super::far::Manner;
use super::register::{Found, RegisterOptions, Source, Survey, template};
use super::registrar::Registrar;

/// How far one template came.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrackedWindows {
    /// The frame that is the template.
    pub template: usize,
    /// Frames that it was brought onto, in the order in which they were, and how it lies on each.
    pub tracked: Vec<(usize, Fit)>,
    /// Frames that it does not fit; those beyond them were not tried.
    pub failed: Vec<(usize, Fault, Fit)>,
    /// Frames that were not tried.
    pub untried: usize,
}

impl TrackedWindows {
    /// Whether the template lies on all frames of both windows.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.failed.is_empty() && self.untried == 0
    }
}

/// Tracks the frame `from` of `survey` through `reach` frames to both sides of itself and of `to`; both are numbers among the frames of
/// the survey. `None` where `from` has no surface.
///
/// # Errors
/// What `source` says, or being told to stop.
pub fn track_windows<S: Source>(
    (source, survey): (&S, &Survey),
    [from, to]: [usize; 2],
    reach: usize,
    options: &RegisterOptions,
    job: &Job,
) -> Result<Option<TrackedWindows>, S::Error>
where
    S::Error: From<DetailError>,
{
    let Some(template) = template(source, survey.frames[from])? else { return Ok(None) };
    let nothing = |_: Found<S::Extra>| Ok(());
    let registrar = Registrar::new((source, survey), &template, options, job, &nothing)?;
    let own = template.surface.mesh.positions.clone();
    let tracker = Tracker { registrar: &registrar, survey, options, scale: template.scale };
    let (here, there) = rayon::join(
        || tracker.outwards(from, own.clone(), reach),
        || -> Result<TrackedWindows, S::Error> {
            let mut found = TrackedWindows::default();
            match tracker.step(from, own.clone(), to, &mut found)? {
                Some(pose) => found.add(tracker.outwards(to, pose, reach)?),
                None => found.untried = 2 * reach,
            }
            Ok(found)
        },
    );
    let mut found = TrackedWindows { template: survey.frames[from], ..here? };
    found.add(there?);
    Ok(Some(found))
}

impl TrackedWindows {
    fn add(&mut self, other: Self) {
        self.tracked.extend(other.tracked);
        self.failed.extend(other.failed);
        self.untried += other.untried;
    }
}

struct Tracker<'a, S: Source> {
    registrar: &'a Registrar<'a, S>,
    survey: &'a Survey,
    options: &'a RegisterOptions,
    scale: f32,
}

impl<S: Source> Tracker<'_, S>
where
    S::Error: From<DetailError>,
{
    /// From `centre`, where the template has `pose`, to both sides.
    fn outwards(&self, centre: usize, pose: Vec<Vec3>, reach: usize) -> Result<TrackedWindows, S::Error> {
        let side = |back: bool| -> Result<TrackedWindows, S::Error> {
            let (mut found, mut at, mut pose) = (TrackedWindows::default(), centre, pose.clone());
            for done in 0..reach {
                let next =
                    if back { at.checked_sub(1) } else { Some(at + 1).filter(|&k| k < self.survey.frames.len()) };
                let stepped = next.map(|next| self.step(at, pose, next, &mut found)).transpose()?.flatten();
                let (Some(next), Some(stepped)) = (next, stepped) else {
                    found.untried = reach - done - found.failed.len();
                    break;
                };
                (at, pose) = (next, stepped);
            }
            Ok(found)
        };
        let (forth, back) = rayon::join(|| side(false), || side(true));
        let mut found = forth?;
        found.add(back?);
        Ok(found)
    }

    /// The template's pose on frame `next`, from `pose` on frame `at`; `None` where it does not fit.
    fn step(
        &self,
        at: usize,
        pose: Vec<Vec3>,
        next: usize,
        found: &mut TrackedWindows,
    ) -> Result<Option<Vec<Vec3>>, S::Error> {
        self.registrar.job.begin("tracking windows")?;
        let frame = self.survey.frames[next];
        let nothing = (frame, Fault::Uncovered, Fit { uncovered: 1.0, ..Fit::default() });
        let Some(target) = self.registrar.target(next)? else {
            found.failed.push(nothing);
            return Ok(None);
        };
        let start = self.registrar.start_of((at, &pose), next, 0.0, &target);
        let tried = self.registrar.tried(at, (&start, &start), &target, Manner::Near);
        match tried.fit.fault(&self.options.limits, self.scale) {
            Some(fault) => found.failed.push((frame, fault, tried.fit)),
            None => {
                found.tracked.push((frame, tried.fit));
                return Ok(Some(tried.pose));
            }
        }
        Ok(None)
    }
}
