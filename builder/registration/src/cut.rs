//! Frames that a template cannot be brought onto get a template of their own: one of them, chosen as the first one was.

use job::Job;

use super::detail::DetailError;
use super::register::{Found, Lost, RegisterOptions, Registered, Source, Survey, register, template};
use super::template::Template;

/// A template and the frames that it was brought onto.
#[derive(Debug)]
pub struct Group {
    /// The template.
    pub template: Template,
    /// The frame that it is.
    pub root: usize,
    /// What became of frames.
    pub registered: Registered,
}

impl Group {
    /// Whether the template lies on `frame`.
    #[must_use]
    pub fn holds(&self, frame: usize) -> bool {
        self.registered.poses.contains_key(&frame)
    }

    /// The frames that it lies on, in order.
    #[must_use]
    pub fn frames(&self) -> Vec<usize> {
        self.registered.poses.keys().copied().collect()
    }

    /// Frames that hold a body, but that the template could not be brought onto.
    #[must_use]
    pub fn untracked(&self) -> Vec<usize> {
        let lost = self.registered.lost.iter().filter(|(_, why)| matches!(why, Lost::Untracked(..)));
        lost.map(|&(frame, _)| frame).collect()
    }

    /// Leaves out the frames that `keep` does not want; what was tracked from these has no parent then.
    pub fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let found = &mut self.registered;
        found.poses.retain(|&frame, _| keep(frame));
        found.tracked.retain(|tracked| keep(tracked.frame));
        for tracked in &mut found.tracked {
            tracked.parent = tracked.parent.filter(|&parent| keep(parent));
        }
    }
}

/// Whether two of `frames`, which are in order, follow each other in a sequence: fewer make no motion.
pub fn make_motion<S: Source>(source: &S, frames: &[usize]) -> bool {
    frames.windows(2).any(|pair| pair[0] + 1 == pair[1] && source.sequence(pair[0]) == source.sequence(pair[1]))
}

/// Brings `frames` of `survey` onto one of them, without detail; `None` where they make no motion.
///
/// # Errors
/// What `source` says, or being told to stop.
pub fn cut<S: Source>(
    source: &S,
    survey: &Survey,
    frames: &[usize],
    options: &RegisterOptions,
    job: &Job,
) -> Result<Option<Group>, S::Error>
where
    S::Error: From<DetailError>,
{
    let which: Vec<usize> = (0..survey.frames.len()).filter(|&k| frames.contains(&survey.frames[k])).collect();
    if !make_motion(source, frames) || which.is_empty() {
        return Ok(None);
    }
    let own = survey.only(&which);
    let tree = own.tree(None);
    let root = own.frames[tree.root];
    let Some(template) = template(source, root)? else { return Ok(None) };
    let options = RegisterOptions { detail: 0.0, ..options.clone() };
    let registered = register(source, &own, &tree, &template, &options, job, &|_: Found<S::Extra>| Ok(()))?;
    Ok(Some(Group { template, root, registered }))
}
