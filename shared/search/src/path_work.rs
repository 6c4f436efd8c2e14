//! A path that is worked on: walks are looked for, and the best is bent onto it.
//!
//! A search reckons with a bend step by step ([`super::steer`]); only the whole walk, bent, shows what comes of it. Now and then that
//! is no good where another walk, which seemed to cost a little more, lies on the path. So where the best walk strays, the best
//! walks of earlier passes are bent as well, and who strays least is taken.

use super::anytime::Anytime;
use super::bend::{Bend, Bending};
use super::notes::LEFT;
use super::path::{PathReport, PathTask};
use super::search_graph::SearchGraph;
use super::task::Found;

/// Another walk is taken where it strays less than this share of what the best one does.
const MUCH_LESS: f64 = 0.5;

/// A path that is to be followed: its search, and how the best walk so far is bent onto it.
#[derive(Clone, Debug)]
pub(super) struct PathWork {
    pub task: PathTask,
    pub search: Anytime,
    pub notes: Vec<String>,
    /// The cost of the search's best walk that this began with, and how far it is.
    polish: Option<(f64, Polish)>,
}

/// A walk and how it is bent.
#[derive(Clone, Debug)]
pub(super) struct Bent {
    pub found: Found,
    pub bend: Bend,
    pub report: PathReport,
}

impl Bent {
    /// Whether it strays so far that somebody is told.
    fn strays(&self) -> bool {
        !self.bend.0.is_empty() && self.report.max_aside > LEFT
    }

    /// Whether it keeps to the path much better than `other` and does nothing else worse.
    fn is_better(&self, other: &Self) -> bool {
        let (mine, its) = (&self.report, &other.report);
        mine.max_aside < MUCH_LESS * its.max_aside
            && mine.mean_aside <= its.mean_aside
            && mine.demands_kept >= its.demands_kept
            && (mine.travelled + LEFT > mine.length || mine.travelled >= its.travelled)
    }
}

/// How far the bending of walks is.
#[derive(Clone, Debug)]
enum Polish {
    Bending(Box<Trial>),
    Done(Box<Bent>),
}

/// A walk that is being bent.
#[derive(Clone, Debug)]
struct Trial {
    found: Found,
    bending: Option<Bending>,
    /// The best before it.
    best: Option<Bent>,
    /// What is tried after it, in this order, where all before stray.
    rest: Vec<Found>,
}

impl PathWork {
    pub fn new(task: PathTask, search: Anytime, notes: Vec<String>) -> Self {
        Self { task, search, notes, polish: None }
    }

    /// Bends the best walk so far, and others where it strays, until `is_over` says that it is enough for now; whether that is
    /// done.
    pub fn polish(&mut self, search_graph: &SearchGraph, is_free: bool, is_over: &mut dyn FnMut() -> bool) -> bool {
        let Some(best) = self.search.best() else { return true };
        // Each better walk costs less.
        let begun = self.polish.take().filter(|(cost, _)| *cost == best.cost).map(|(_, polish)| polish);
        let cost = best.cost;
        let Some(mut polish) = begun.or_else(|| self.begin(search_graph, is_free)) else { return true };
        while let Polish::Bending(trial) = polish {
            polish = self.advance(search_graph, is_free, trial);
            if is_over() {
                break;
            }
        }
        let is_done = matches!(polish, Polish::Done(_));
        self.polish = Some((cost, polish));
        is_done
    }

    /// The walk to take and how it is bent; `None` where none was found.
    pub fn bent(&self, search_graph: &SearchGraph, is_free: bool) -> Option<Bent> {
        if let Some((cost, Polish::Done(bent))) = &self.polish
            && self.search.best().is_some_and(|best| best.cost == *cost)
        {
            return Some(Bent::clone(bent));
        }
        let mut polish = self.begin(search_graph, is_free)?;
        loop {
            match polish {
                Polish::Done(bent) => return Some(*bent),
                Polish::Bending(trial) => polish = self.advance(search_graph, is_free, trial),
            }
        }
    }

    fn begin(&self, search_graph: &SearchGraph, is_free: bool) -> Option<Polish> {
        let found = self.search.best()?.clone();
        let bending = self.task.bending(search_graph, &found, is_free);
        let rest = self.search.earlier().cloned().collect();
        Some(Polish::Bending(Box::new(Trial { found, bending, best: None, rest })))
    }

    /// One pass of the walk that is being bent, or what follows from its last.
    fn advance(&self, search_graph: &SearchGraph, is_free: bool, mut trial: Box<Trial>) -> Polish {
        if trial.bending.as_mut().is_some_and(|bending| !bending.advance(&self.task.curve)) {
            return Polish::Bending(trial);
        }
        let Trial { found, bending, best, mut rest } = *trial;
        let (bend, report) = self.task.bent(search_graph, &found, bending);
        let bent = Bent { found, bend, report };
        let best = match best {
            Some(best) if !bent.is_better(&best) => best,
            _ => bent,
        };
        if !best.strays() || rest.is_empty() {
            return Polish::Done(Box::new(best));
        }
        let found = rest.remove(0);
        let bending = self.task.bending(search_graph, &found, is_free);
        Polish::Bending(Box::new(Trial { found, bending, best: Some(best), rest }))
    }
}
