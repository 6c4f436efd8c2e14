//! Which transitions wandering chooses from: few, good, and spread over the capture.
//!
//! Prada and others (2016, section 4) take pairs of frames that are alike and not too near pairs that are taken already; their
//! graph has 72 transitions on 2,283 frames. What they leave to chance is added first here: for every sequence the best way into
//! its beginning and the best way out of its end, so that all of the main component stays connected and every sequence can be
//! shown from one end to the other.

use super::super::meter;
use super::super::ways::Ways;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;

/// Share of a sequence's frames at either end that need not be shown, where better transitions arrive after them or leave
/// before them.
const SLACK: f64 = 0.02;
/// Seconds within which both ends of two transitions must not lie (20 frames of 30 a second in the paper).
const APART: f64 = 0.66;
/// Seconds of recorded frames for each transition of the graph.
const SECONDS_A_TRANSITION: f64 = 1.0;
/// Transitions looked at that count as an expanded state.
const LOOKED_AT: usize = 64;

/// The frames of a sequence that are in the main component.
#[derive(Clone, Copy, Debug)]
struct Span {
    first: u32,
    last: u32,
    /// How many frames at either end need not be shown.
    slack: u32,
}

/// Chooses transitions, some at a time.
#[derive(Clone, Debug)]
pub(super) struct Sparse {
    spans: Vec<Option<Span>>,
    /// All transitions of the main component, the best first.
    order: Vec<u32>,
    /// Those that arrive at the beginning of a sequence, and those that leave at the end of one.
    joins: [Vec<u32>; 2],
    /// Sequences that are joined so far, by ways in and by ways out.
    joined: [Vec<bool>; 2],
    /// The sequence with the most frames, from where all are joined.
    root: usize,
    /// Transitions of the order that have been looked at.
    next: usize,
    chosen: Vec<u32>,
}

impl Sparse {
    /// Nothing is chosen yet; `order` are transitions between frames of the main component, the best first.
    pub(super) fn new(graph: &EssentialGraph, timeline: &Timeline, ways: &Ways, order: Vec<u32>) -> Self {
        let spans: Vec<Option<Span>> = timeline
            .sequences()
            .iter()
            .map(|sequence| {
                let is_main = |frame: &u32| ways.main[*frame as usize];
                let first = (sequence.first_frame..sequence.end_frame()).find(is_main)?;
                let last = (sequence.first_frame..sequence.end_frame()).rev().find(is_main)?;
                let frames = last + 1 - first;
                // Around a cyclic sequence every frame leads to every other.
                let slack = if sequence.cyclic { frames } else { (SLACK * f64::from(frames)) as u32 };
                Some(Span { first, last, slack })
            })
            .collect();
        let length = |span: &Option<Span>| span.map_or(0, |span| span.last + 1 - span.first);
        let root = (0..spans.len()).rev().max_by_key(|&sequence| length(&spans[sequence])).unwrap_or(0);
        let mut sparse = Self {
            joins: [Vec::new(), Vec::new()],
            joined: [vec![false; spans.len()], vec![false; spans.len()]],
            spans,
            order,
            root,
            next: 0,
            chosen: Vec::new(),
        };
        for &index in &sparse.order {
            let Some([source, destination]) = sparse.ends(graph, ways, index) else { continue };
            let transition = &graph.transitions()[index as usize];
            // What leaves at once could not be taken after every way in, nor what arrives too late before every way out.
            let leaves = transition.from >= source.first + source.slack.min(source.last - source.first);
            let arrives =
                transition.to + destination.slack.min(destination.last - destination.first) <= destination.last;
            if leaves && transition.to <= destination.first + destination.slack {
                sparse.joins[0].push(index);
            }
            if arrives && transition.from + source.slack >= source.last {
                sparse.joins[1].push(index);
            }
        }
        meter::count(sparse.order.len());
        sparse
    }

    fn ends(&self, graph: &EssentialGraph, ways: &Ways, index: u32) -> Option<[Span; 2]> {
        let transition = graph.transitions().get(index as usize)?;
        Some([self.spans[ways.sequence(transition.from)]?, self.spans[ways.sequence(transition.to)]?])
    }

    /// Looks at some more transitions; how many expanded states that counts as, or `None` once all are chosen.
    pub(super) fn advance(&mut self, graph: &EssentialGraph, ways: &Ways) -> Option<usize> {
        let looked_at = match (0..2).find(|&way| self.joined[way].iter().any(|&joined| !joined)) {
            Some(way) => self.join(graph, ways, way),
            None => self.fill(graph, ways)?,
        };
        meter::count(looked_at);
        Some(looked_at.div_ceil(LOOKED_AT))
    }

    /// The transitions chosen.
    pub(super) fn chosen(self) -> Vec<u32> {
        self.chosen
    }

    /// Joins one more sequence by the best way into it from those joined before (0), or out of it to one of them (1): Prim's
    /// algorithm on sequences. The first is the root, which needs both itself.
    fn join(&mut self, graph: &EssentialGraph, ways: &Ways, way: usize) -> usize {
        let joined = &self.joined[way];
        let is_first = !joined[self.root];
        let found = self.joins[way].iter().position(|&index| {
            let transition = &graph.transitions()[index as usize];
            let mut ends = [ways.sequence(transition.from), ways.sequence(transition.to)];
            if way == 1 {
                ends.reverse();
            }
            if is_first { ends[1] == self.root } else { joined[ends[0]] && !joined[ends[1]] }
        });
        let joined = &mut self.joined[way];
        let Some(place) = found else {
            // The rest is out of reach, or the root has no way in that is as early as that.
            if is_first {
                joined[self.root] = true;
            } else {
                joined.fill(true);
            }
            return self.joins[way].len();
        };
        let index = self.joins[way][place];
        let transition = &graph.transitions()[index as usize];
        let new = if way == 0 { transition.to } else { transition.from };
        joined[ways.sequence(new)] = true;
        if !self.chosen.contains(&index) {
            self.chosen.push(index);
        }
        place + 1
    }

    /// Looks at the best transitions that are left, and takes those that are far enough from all others.
    fn fill(&mut self, graph: &EssentialGraph, ways: &Ways) -> Option<usize> {
        let frames: u32 = self.spans.iter().flatten().map(|span| span.last + 1 - span.first).sum();
        let enough = (f64::from(frames) / (SECONDS_A_TRANSITION * ways.fps)) as usize;
        let apart = (APART * ways.fps) as u32;
        if self.next == self.order.len() || self.chosen.len() >= enough {
            return None;
        }
        let end = (self.next + LOOKED_AT).min(self.order.len());
        for place in self.next..end {
            let index = self.order[place];
            let transition = &graph.transitions()[index as usize];
            let is_near = |&other: &u32| {
                let other = &graph.transitions()[other as usize];
                transition.from.abs_diff(other.from) < apart && transition.to.abs_diff(other.to) < apart
            };
            if self.chosen.len() < enough && !self.chosen.iter().any(is_near) {
                self.chosen.push(index);
            }
        }
        let looked_at = (end - self.next) * self.chosen.len().max(1);
        self.next = end;
        Some(looked_at)
    }
}
