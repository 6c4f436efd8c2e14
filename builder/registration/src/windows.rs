//! One template through both windows of a candidate (Prada 2016, section 5, TrackTemplate): in steps of one frame, from its own
//! outwards. Between the windows, which are alike there, is one step, too; only where that does not fit is it looked for from afar.

use glam::Vec3;
use job::Job;

use super::checks::{Fault, Fit};
use super::detail::DetailError;
use super::far::Manner;
use super::register::{Found, RegisterOptions, Source, Survey, template};
use super::registrar::{Registrar, State};

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
            match tracker.across(from, own.clone(), to, &mut found)? {
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

    /// From the one window to the other: in one step, or, where that does not fit, by transport.
    fn across(
        &self,
        from: usize,
        own: Vec<Vec3>,
        to: usize,
        found: &mut TrackedWindows,
    ) -> Result<Option<Vec<Vec3>>, S::Error> {
        let mut near = TrackedWindows::default();
        if let Some(pose) = self.step(from, own.clone(), to, &mut near)? {
            found.add(near);
            return Ok(Some(pose));
        }
        let Some(target) = self.registrar.target(to)? else { return Ok(None) };
        let mut state: Vec<State> = self.survey.frames.iter().map(|_| State::default()).collect();
        state[from].pose = Some(own);
        let Some(tried) = self.registrar.found_far(to, &[from], &state, &target) else { return Ok(None) };
        let frame = self.survey.frames[to];
        match tried.fit.far_fault(&self.options.limits, self.scale) {
            Some(fault) => found.failed.push((frame, fault, tried.fit)),
            None => {
                found.tracked.push((frame, tried.fit));
                return Ok(Some(tried.pose));
            }
        }
        Ok(None)
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

#[cfg(test)]
mod tests {
    use geometry::mesh::Mesh;
    use geometry::polygonise::polygonise;
    use geometry::sdf::{blend, cone, ellipsoid};
    use job::Stopped;

    use super::*;
    use crate::register::survey;
    use crate::scan::Scan;

    /// Two takes of nine frames in which an arm is raised; in the second one the last frame is something else.
    struct Takes;

    #[derive(Debug)]
    struct Failed;

    impl From<Stopped> for Failed {
        fn from(_: Stopped) -> Self {
            Self
        }
    }

    impl From<DetailError> for Failed {
        fn from(_: DetailError) -> Self {
            Self
        }
    }

    fn body(angle: f32, cell: f32) -> Mesh {
        let distance = |p: Vec3| {
            let shoulder = Vec3::new(0.2, 1.3, 0.0);
            let hand = shoulder + 0.6 * Vec3::new(angle.cos(), angle.sin(), 0.0);
            let trunk = ellipsoid(p, Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.28, 0.8, 0.2));
            blend(trunk, cone(p, shoulder, hand, 0.1, 0.07), 0.05)
        };
        polygonise(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(1.0, 2.2, 0.5), cell, distance)
    }

    impl Source for Takes {
        type Extra = ();
        type Error = Failed;

        fn count(&self) -> usize {
            18
        }

        fn sequence(&self, frame: usize) -> usize {
            frame / 9
        }

        fn read(&self, frame: usize) -> Result<(Scan, ()), Failed> {
            let mesh = if frame == 17 {
                polygonise(Vec3::splat(-0.7), Vec3::splat(0.7), 0.05, |p| p.length() - 0.45)
            } else {
                body(-0.3 + 0.1 * (frame % 9) as f32, 0.065 + 0.0003 * frame as f32)
            };
            Ok((Scan { positions: mesh.positions, triangles: mesh.triangles, ..Scan::default() }, ()))
        }
    }

    #[test]
    fn a_template_goes_through_both_windows_as_far_as_it_fits() {
        let (options, job) = (RegisterOptions::default(), Job::silent());
        let survey = survey(&Takes, &options, &job).unwrap();
        assert_eq!(survey.frames.len(), 18);
        let track = |reach: usize| track_windows((&Takes, &survey), [4, 13], reach, &options, &job).unwrap().unwrap();
        let found = track(3);
        let mut frames: Vec<usize> = found.tracked.iter().map(|(frame, _)| *frame).collect();
        frames.sort_unstable();
        assert!(found.is_whole() && found.template == 4, "{found:?}");
        // All but the template's own.
        assert_eq!(frames, [1, 2, 3, 5, 6, 7, 10, 11, 12, 13, 14, 15, 16]);
        // The last frame of a wider window is something else, and is no success.
        let found = track(4);
        assert!(!found.is_whole());
        assert_eq!(found.failed.iter().map(|failed| failed.0).collect::<Vec<_>>(), [17]);
        assert_eq!((found.tracked.len(), found.untried), (16, 0));
    }
}
