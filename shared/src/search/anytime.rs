//! The tool's search: an answer at once, a better one with time, the best one where time suffices.
//!
//! States are kept by layers (how far they have come) and each layer is expanded in the order of cost so far plus the
//! admissible bound and a guess. The first pass expands a few states a layer, no more of one sequence than its share (or what is cheap
//! now would crowd out what can still turn), of states that are alike only one, and takes transitions from every eighth
//! frame only; it answers quickly. Each later pass is wider and finer. A pass that left nothing out but what the bound
//! prunes is branch-and-bound: its answer is proven to be the best. Work is cut into slices by counting expanded states, so
//! that the result depends on nothing but the input.

use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashSet};

use super::task::{Found, State, Task};
use super::ways::Ways;

/// States expanded in a layer of the first pass.
const FIRST_WIDTH: usize = 96;
/// A later pass is wider than the one before by this power of two.
const WIDER: u32 = 1;
/// States expanded in a layer of the last pass: bounds memory.
const LAST_WIDTH: usize = 96 << 9;
/// A sequence gets this part of a layer's width.
const SHARE: usize = 4;
/// Passes in which states that are alike are left out, and the last in which transitions of some frames are.
const COARSE_PASSES: u32 = 5;

/// How much each pass trusts the task's guess: passes that err in different ways find what the others miss.
const GUESS_TRUST: [f64; 4] = [1.0, 3.0, 0.5, 2.0];

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Progress {
    /// There may be a better answer.
    Running,
    /// The widest pass is through: there may be a better answer, but this search will not find it.
    Ended,
    /// There is no better answer.
    Proven,
}

/// A search that can be asked for its best walk at any time.
#[derive(Clone, Debug)]
pub struct Anytime {
    pass: u32,
    layers: Vec<BinaryHeap<Open>>,
    layer: usize,
    expanded_in_layer: usize,
    cells: HashSet<u64>,
    expanded_by_sequence: Vec<usize>,
    trail: Vec<Trail>,
    starts: Vec<State>,
    left_out: bool,
    best: Option<Found>,
    progress: Progress,
    expanded: u64,
    serial: u32,
}

/// A state that waits to be expanded.
#[derive(Clone, Copy, Debug)]
struct Open {
    /// Cost so far and lower bound of what is to come.
    bound: f64,
    /// The same with a guess: the order of expansion.
    order: f64,
    serial: u32,
    state: State,
    /// Index in the trail of the state before, and the way from it; for a start, [`NONE`] and its number.
    before: u32,
    way: u32,
    /// Whether it has just come to its layer, or to its frame by a transition.
    is_fresh: bool,
}

/// How an expanded state was reached.
#[derive(Clone, Copy, Debug)]
struct Trail {
    before: u32,
    way: u32,
}

const NONE: u32 = u32::MAX;

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    /// The least order is the greatest, then the earliest.
    fn cmp(&self, other: &Self) -> Ordering {
        other.order.total_cmp(&self.order).then(other.serial.cmp(&self.serial))
    }
}

impl Anytime {
    /// A search that has not begun.
    #[must_use]
    pub fn new(task: &impl Task, ways: &Ways) -> Self {
        let mut search = Self {
            pass: 0,
            layers: Vec::new(),
            layer: 0,
            expanded_in_layer: 0,
            cells: HashSet::new(),
            expanded_by_sequence: Vec::new(),
            trail: Vec::new(),
            starts: task.starts(ways),
            left_out: false,
            best: None,
            progress: Progress::Running,
            expanded: 0,
            serial: 0,
        };
        search.begin_pass(task, ways);
        search
    }

    /// Expands up to `budget` states: about 5 microseconds each. `task` and `ways` are those that it was made with.
    pub fn advance(&mut self, task: &impl Task, ways: &Ways, budget: u32) -> Progress {
        let mut left = budget;
        while self.progress == Progress::Running && left > 0 {
            match self.next_open(task, ways) {
                Some(open) => {
                    self.expand(task, ways, &open);
                    left -= 1;
                }
                None if self.layer + 1 < self.layers.len() => {
                    self.layers[self.layer] = BinaryHeap::new();
                    self.layer += 1;
                    self.begin_layer();
                }
                None => self.end_pass(task, ways),
            }
        }
        self.progress
    }

    /// The best walk so far.
    #[must_use]
    pub fn best(&self) -> Option<&Found> {
        self.best.as_ref()
    }

    /// How far the search is.
    #[must_use]
    pub fn progress(&self) -> Progress {
        self.progress
    }

    /// States expanded so far.
    #[must_use]
    pub fn expanded(&self) -> u64 {
        self.expanded
    }

    fn width(&self) -> usize {
        FIRST_WIDTH << (WIDER * self.pass)
    }

    fn begin_pass(&mut self, task: &impl Task, ways: &Ways) {
        self.layers.clear();
        (self.layer, self.serial, self.left_out) = (0, 0, false);
        self.begin_layer();
        self.trail.clear();
        for index in 0..self.starts.len() {
            let start = self.starts[index];
            self.reach(task, ways, start, NONE, index as u32);
        }
    }

    fn begin_layer(&mut self) {
        self.expanded_in_layer = 0;
        self.expanded_by_sequence.fill(0);
        self.cells.clear();
    }

    fn end_pass(&mut self, task: &impl Task, ways: &Ways) {
        if !self.left_out {
            self.progress = Progress::Proven;
        } else if self.width() >= LAST_WIDTH {
            self.progress = Progress::Ended;
        } else {
            self.pass += 1;
            self.begin_pass(task, ways);
            return;
        }
        self.layers = Vec::new();
        self.trail = Vec::new();
    }

    /// The next state of this layer that is worth expanding.
    fn next_open(&mut self, task: &impl Task, ways: &Ways) -> Option<Open> {
        // All starts get their chance.
        let width = self.width() + if self.layer == 0 { self.starts.len() } else { 0 };
        loop {
            let open = self.layers.get_mut(self.layer)?.pop()?;
            if self.is_hopeless(open.bound) {
                continue;
            }
            if self.expanded_in_layer >= width {
                self.left_out = true;
                return None;
            }
            if open.before == NONE || self.admit(task, ways, &open, width) {
                self.expanded_in_layer += 1;
                return Some(open);
            }
            self.left_out = true;
        }
    }

    /// Whether a state has its place among those of its layer.
    fn admit(&mut self, task: &impl Task, ways: &Ways, open: &Open, width: usize) -> bool {
        if self.pass >= COARSE_PASSES {
            return true;
        }
        let sequence = ways.sequence(open.state.frame);
        if sequence >= self.expanded_by_sequence.len() {
            self.expanded_by_sequence.resize(sequence + 1, 0);
        }
        let expanded = &mut self.expanded_by_sequence[sequence];
        // A state that goes on from one of this layer by a recorded step is not compared with it.
        if *expanded >= width / SHARE || open.is_fresh && !self.cells.insert(task.cell(ways, &open.state, self.pass)) {
            return false;
        }
        *expanded += 1;
        true
    }

    fn expand(&mut self, task: &impl Task, ways: &Ways, open: &Open) {
        self.expanded += 1;
        let here = self.trail.len() as u32;
        self.trail.push(Trail { before: open.before, way: open.way });
        let stride = 8_u32 >> self.pass.min(3);
        let recorded_only = !open.state.frame.is_multiple_of(stride);
        for way in ways.from(open.state.frame) {
            if recorded_only && ways.way(way).transition.is_some() {
                self.left_out = true;
                break;
            }
            if let Some(next) = task.follow(ways, &open.state, way) {
                self.reach(task, ways, next, here, way);
            }
        }
        self.trim();
    }

    fn reach(&mut self, task: &impl Task, ways: &Ways, state: State, before: u32, way: u32) {
        let bound = state.cost + task.remaining(ways, &state);
        if self.is_hopeless(bound) {
            return;
        }
        if let Some(ending) = task.ending(ways, &state) {
            let cost = state.cost + ending;
            if !self.is_hopeless(cost) {
                self.best = Some(self.trace(cost, state, before, way));
            }
        }
        if task.halts(ways, &state) {
            return;
        }
        let trust = GUESS_TRUST[self.pass as usize % GUESS_TRUST.len()];
        let order = bound + trust * task.guess(ways, &state);
        let layer = task.layer(&state).max(self.layer);
        let is_fresh = layer > self.layer || before == NONE || ways.way(way).transition.is_some();
        if layer >= self.layers.len() {
            self.layers.resize_with(layer + 1, BinaryHeap::new);
        }
        self.layers[layer].push(Open { bound, order, serial: self.serial, state, before, way, is_fresh });
        self.serial = self.serial.wrapping_add(1);
    }

    fn is_hopeless(&self, bound: f64) -> bool {
        self.best.as_ref().is_some_and(|best| bound >= best.cost)
    }

    /// Bounds memory: a layer with many times more states than will be expanded loses its worst.
    fn trim(&mut self) {
        let most = 16 * self.width() + 4096;
        for heap in self.layers.iter_mut().skip(self.layer) {
            if heap.len() > 2 * most {
                let mut open = std::mem::take(heap).into_vec();
                open.select_nth_unstable_by(most, |a, b| b.cmp(a));
                open.truncate(most);
                *heap = open.into();
                self.left_out = true;
            }
        }
    }

    fn trace(&self, cost: f64, end: State, before: u32, way: u32) -> Found {
        let (mut ways, mut before, mut way) = (Vec::new(), before, way);
        while before != NONE {
            ways.push(way);
            Trail { before, way } = self.trail[before as usize];
        }
        ways.reverse();
        Found { cost, start: self.starts[way as usize], ways, end }
    }
}
