//! How long work says how far it is, and is told to stop: plain values, so that a terminal, a log or a window can show them.

use std::ops::ControlFlow;

use thiserror::Error;

use crate::work::WorkFolder;

/// How far a stage is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage, for example `pose distances`.
    pub what: &'static str,
    /// Units of work done so far.
    pub done: u64,
    /// Units of work in all; 0 where that is not known.
    pub total: u64,
}

/// Who is told; called from many threads at once. [`ControlFlow::Break`] asks the work to stop.
pub type Report<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// The work was asked to stop and did: nothing is half-written, and what the work folder holds is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("stopped before it was done")]
pub struct Stopped;

/// A piece of long work: whom it tells how far it is, and where its results last.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    report: Report<'a>,
    work: Option<&'a WorkFolder>,
}

impl std::fmt::Debug for Job<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.debug_struct("Job").field("work", &self.work).finish_non_exhaustive()
    }
}

impl<'a> Job<'a> {
    /// Work that tells `report`; nothing of it lasts but what it returns.
    #[must_use]
    pub fn new(report: Report<'a>) -> Self {
        Self { report, work: None }
    }

    /// Work that tells nobody.
    #[must_use]
    pub fn silent() -> Self {
        Self::new(&|_| ControlFlow::Continue(()))
    }

    /// The same work, whose results are kept in `work` and taken from there.
    #[must_use]
    pub fn with_work(self, work: Option<&'a WorkFolder>) -> Self {
        Self { work, ..self }
    }

    /// Where results last, if anywhere.
    #[must_use]
    pub fn work(&self) -> Option<&'a WorkFolder> {
        self.work
    }

    /// Says how far a stage is.
    ///
    /// # Errors
    /// Where the answer is to stop.
    pub fn tell(&self, what: &'static str, done: u64, total: u64) -> Result<(), Stopped> {
        match (self.report)(Progress { what, done, total }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Stopped),
        }
    }

    /// Says that a stage begins whose length is not known.
    ///
    /// # Errors
    /// As [`Self::tell`].
    pub fn begin(&self, what: &'static str) -> Result<(), Stopped> {
        self.tell(what, 0, 0)
    }

    /// Says which share of a stage is done, from 0 to 1.
    ///
    /// # Errors
    /// As [`Self::tell`].
    pub fn share(&self, what: &'static str, share: f64) -> Result<(), Stopped> {
        self.tell(what, (share * 1000.0) as u64, 1000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_to_stop_is_an_error() {
        let report =
            |progress: Progress| if progress.done < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        let job = Job::new(&report);
        assert_eq!((0..10).map(|done| job.tell("stage", done, 10)).filter(Result::is_ok).count(), 3);
        assert!(Job::silent().share("stage", 1.0).is_ok());
    }
}
