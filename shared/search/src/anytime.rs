//! The tool's search: an answer at once, a better one with time, the best one where time suffices.
//!
//! States are kept by layers (how far they have come) and each layer is expanded in the order of cost so far plus the
//! task's guess of what is to come, which learns from the best walk so far ([`Outlook`]). The first pass expands a few states
//! a layer, no more of one crowd than its share, of states that
//! are alike only one, and takes transitions from every eighth frame only, of those that resemble each other the cheapest;
//! it answers quickly. Each later pass is wider, every other one finer. A pass that left nothing out but what the admissible
//! bound prunes is branch-and-bound: its answer is proven to be the best. Work is cut into slices by counting expanded
//! states, so that the result depends on nothing but the input.

use super::meter;
use super::pool::Pool;
use super::queue::Queue;
use super::search_graph::SearchGraph;
use super::task::{Found, Outlook, State, Task};

/// States expanded in a layer of the first pass.
const FIRST_WIDTH: usize = 96;
/// States expanded in a layer of the last pass: bounds memory.
const LAST_WIDTH: usize = 96 << 9;
/// Passes in which states that are alike are left out, and the last in which transitions of some frames are.
const COARSE_PASSES: u32 = 8;
/// States that wait in a layer: sorting twice as many has to fit in a slice.
const MOST_OPEN: usize = 24_000;
/// States that wait and turn out not to be worth expanding: as much work as expanding one.
const PASSED_OVER: u32 = 16;
/// Cells that are remembered in a pass.
const CELLS: usize = 1 << 17;

/// Best walks of earlier passes that are kept.
const KEPT: usize = 4;

/// States that a patient search expands without finding a better walk before it ends, and as a multiple of those it took to
/// find the best.
const PATIENCE: u64 = 100_000;
const PATIENCE_SHARE: u64 = 2;

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Progress {
    /// There may be a better answer.
    Running,
    /// The widest pass is through, or for long nothing better was found: there may be a better answer, but this search will not
    /// find it.
    Ended,
    /// There is no better answer.
    Proven,
}

/// A search that can be asked for its best walk at any time.
#[derive(Clone, Debug)]
pub struct Anytime {
    pass: u32,
    layers: Vec<Queue>,
    layer: usize,
    expanded_in_layer: usize,
    expanded_by_crowd: Vec<usize>,
    /// States that wait, by the number that their layer's queue holds, and numbers that are free again.
    open: Pool<Open>,
    free: Vec<u32>,
    /// The least order of each cell, as far as it is remembered: a cell has one place, and the last one stays.
    cells: Vec<(u64, f64)>,
    outlook: Outlook,
    trail: Pool<Trail>,
    starts: Vec<State>,
    left_out: bool,
    best: Option<Found>,
    /// The best walks of earlier passes, the last one first.
    earlier: Vec<Found>,
    progress: Progress,
    expanded: u64,
    /// States expanded when the best walk was found, and whether the search ends when that is long ago.
    found_at: u64,
    has_patience: bool,
    serial: u32,
}

/// A state that waits to be expanded.
#[derive(Clone, Copy, Debug)]
struct Open {
    /// Cost so far and lower bound of what is to come.
    bound: f64,
    /// Cost so far and what is likely to come.
    order: f64,
    /// What it is alike with; 0 where it is not compared.
    cell: u64,
    state: State,
    /// Index in the trail of the state before, and the edge from it; for a start, [`NONE`] and its number.
    before: u32,
    edge: u32,
}

/// What comes next in a layer.
enum Next {
    /// A state that is worth expanding.
    Open(Open),
    /// One that is not.
    PassedOver,
    /// Nothing.
    LayerDone,
}

/// How an expanded state was reached.
#[derive(Clone, Copy, Debug)]
struct Trail {
    before: u32,
    edge: u32,
}

const NONE: u32 = u32::MAX;

impl Anytime {
    /// A search that has not begun.
    #[must_use]
    pub fn new(task: &impl Task, search_graph: &SearchGraph) -> Self {
        let mut search = Self {
            pass: 0,
            layers: Vec::new(),
            layer: 0,
            expanded_in_layer: 0,
            expanded_by_crowd: Vec::new(),
            open: Pool::new(),
            free: Vec::new(),
            cells: vec![(0, 0.0); CELLS],
            outlook: Outlook::default(),
            trail: Pool::new(),
            starts: task.starts(search_graph),
            left_out: false,
            best: None,
            earlier: Vec::new(),
            progress: Progress::Running,
            expanded: 0,
            found_at: 0,
            has_patience: false,
            serial: 0,
        };
        search.begin_pass(task, search_graph);
        search
    }

    /// The same, which ends when for long it has found nothing better.
    #[must_use]
    pub fn with_patience(mut self) -> Self {
        self.has_patience = true;
        self
    }

    /// Expands up to `budget` states, or passes over many more: 1 to 2 microseconds each in early passes, up to 20 in the
    /// last. `task` and `search_graph` are those that it was made with.
    pub fn advance(&mut self, task: &impl Task, search_graph: &SearchGraph, budget: u32) -> Progress {
        let mut left = budget.saturating_mul(PASSED_OVER);
        while self.progress == Progress::Running && left > 0 {
            let cost = match self.next_open(task, search_graph) {
                Next::Open(open) => {
                    self.expand(task, search_graph, &open);
                    let patience = PATIENCE.max(PATIENCE_SHARE * self.found_at);
                    if self.has_patience && self.best.is_some() && self.expanded > self.found_at + patience {
                        self.end(Progress::Ended);
                    }
                    PASSED_OVER
                }
                Next::PassedOver => 1,
                Next::LayerDone if self.layer + 1 < self.layers.len() => {
                    self.layers[self.layer] = Queue::default();
                    self.layer += 1;
                    self.begin_layer();
                    1
                }
                Next::LayerDone => {
                    self.end_pass(task, search_graph);
                    PASSED_OVER
                }
            };
            left = left.saturating_sub(cost);
        }
        self.progress
    }

    /// The best walk so far.
    #[must_use]
    pub fn best(&self) -> Option<&Found> {
        self.best.as_ref()
    }

    /// The best walks of earlier passes, which cost more than [`Self::best`]: each is a walk of its own, found another way.
    pub fn earlier(&self) -> impl Iterator<Item = &Found> {
        let best = self.best.as_ref().map_or(f64::INFINITY, |best| best.cost);
        self.earlier.iter().filter(move |found| found.cost > best)
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
        FIRST_WIDTH << self.pass
    }

    /// How fine a pass is: two passes of the same fineness err in different ways.
    fn level(&self) -> u32 {
        self.pass / 2
    }

    fn begin_pass(&mut self, task: &impl Task, search_graph: &SearchGraph) {
        self.layers.clear();
        self.open.clear();
        self.free.clear();
        self.cells.fill((0, 0.0));
        (self.layer, self.serial, self.left_out) = (0, 0, false);
        self.begin_layer();
        self.trail.clear();
        self.outlook = Outlook::new(task, search_graph, self.best.as_ref(), self.pass);
        for index in 0..self.starts.len() {
            let start = self.starts[index];
            self.reach(task, search_graph, start, NONE, index as u32);
        }
    }

    fn begin_layer(&mut self) {
        self.expanded_in_layer = 0;
        self.expanded_by_crowd.fill(0);
    }

    fn end(&mut self, progress: Progress) {
        self.progress = progress;
        self.layers = Vec::new();
        self.trail = Pool::new();
        self.open = Pool::new();
    }

    fn end_pass(&mut self, task: &impl Task, search_graph: &SearchGraph) {
        if !self.left_out {
            self.end(Progress::Proven);
        } else if self.width() >= LAST_WIDTH {
            self.end(Progress::Ended);
        } else {
            self.pass += 1;
            self.keep();
            self.begin_pass(task, search_graph);
        }
    }

    /// Keeps the best walk of a pass that found a better one.
    fn keep(&mut self) {
        let Some(best) = &self.best else { return };
        if self.earlier.first().is_none_or(|kept| kept.cost != best.cost) {
            self.earlier.insert(0, best.clone());
            self.earlier.truncate(KEPT);
        }
    }

    /// Takes the next state of this layer.
    fn next_open(&mut self, task: &impl Task, search_graph: &SearchGraph) -> Next {
        // All starts get their chance.
        let width = self.width() + if self.layer == 0 { self.starts.len() } else { 0 };
        let Some((_, number)) = self.layers.get_mut(self.layer).and_then(Queue::pop) else { return Next::LayerDone };
        let open = self.open.get(number as u32);
        self.free.push(number as u32);
        if self.is_hopeless(open.bound) {
            return Next::PassedOver;
        }
        if self.expanded_in_layer >= width {
            self.left_out = true;
            return Next::LayerDone;
        }
        if open.before == NONE || self.admit(task, search_graph, &open, width) {
            self.expanded_in_layer += 1;
            return Next::Open(open);
        }
        self.left_out = true;
        Next::PassedOver
    }

    /// Whether a state has its place among those of its layer.
    fn admit(&mut self, task: &impl Task, search_graph: &SearchGraph, open: &Open, width: usize) -> bool {
        if self.pass >= COARSE_PASSES {
            return true;
        }
        let (crowd, parts) = task.crowd(search_graph, &open.state);
        if crowd >= self.expanded_by_crowd.len() {
            self.expanded_by_crowd.resize(crowd + 1, 0);
        }
        let expanded = &mut self.expanded_by_crowd[crowd];
        let (cell, order) = self.cells[open.cell as usize % CELLS];
        if *expanded >= width / parts.max(1) || open.cell != 0 && cell == open.cell && order < open.order {
            return false;
        }
        *expanded += 1;
        true
    }

    fn expand(&mut self, task: &impl Task, search_graph: &SearchGraph, open: &Open) {
        self.expanded += 1;
        let here = self.trail.push(Trail { before: open.before, edge: open.edge });
        let level = self.level();
        meter::count(search_graph.from(open.state.frame).len());
        let stride = 8_u32 >> level.min(3);
        let recorded_only = !open.state.frame.is_multiple_of(stride);
        for edge in search_graph.from(open.state.frame) {
            let taken = search_graph.edge(edge);
            if taken.transition.is_some() && (recorded_only || taken.rank > level) {
                self.left_out = true;
                continue;
            }
            if let Some(next) = task.follow(search_graph, &open.state, edge) {
                self.reach(task, search_graph, next, here, edge);
            }
        }
    }

    fn reach(&mut self, task: &impl Task, search_graph: &SearchGraph, state: State, before: u32, edge: u32) {
        let remaining = task.remaining(search_graph, &state);
        let bound = state.cost + remaining;
        if self.is_hopeless(bound) {
            return;
        }
        if let Some(ending) = task.ending(search_graph, &state) {
            let cost = state.cost + ending;
            if !self.is_hopeless(cost) {
                self.best = Some(self.trace(cost, state, before, edge));
                self.found_at = self.expanded;
            }
        }
        if task.halts(search_graph, &state) {
            return;
        }
        let order = state.cost + remaining.max(task.guess(search_graph, &state, &self.outlook));
        let layer = task.layer(&state).max(self.layer);
        let mut cell = 0;
        // A state that goes on from one of this layer by a recorded step is not compared with it.
        let is_fresh = layer > self.layer || before == NONE || search_graph.edge(edge).transition.is_some();
        if is_fresh && self.pass < COARSE_PASSES {
            cell = task.cell(search_graph, &state, self.level()) ^ (layer as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let known = &mut self.cells[cell as usize % CELLS];
            if known.0 == cell && known.1 <= order {
                self.left_out = true;
                return;
            }
            *known = (cell, order);
        }
        self.push(layer, Open { bound, order, cell, state, before, edge });
    }

    /// A layer with many times more states than will be expanded loses its worst, to bound memory.
    fn push(&mut self, layer: usize, open: Open) {
        let number = match self.free.pop() {
            Some(number) => {
                self.open.set(number, open);
                number
            }
            None => self.open.push(open),
        };
        let most = (4 * self.width() + 2048).min(MOST_OPEN);
        if layer >= self.layers.len() {
            self.layers.resize_with(layer + 1, Queue::default);
        }
        let queue = &mut self.layers[layer];
        queue.push(open.order, u64::from(self.serial) << 32 | u64::from(number));
        self.serial = self.serial.wrapping_add(1);
        if queue.len() > 2 * most {
            self.free.extend(queue.cut(most).into_iter().map(|number| number as u32));
            self.left_out = true;
        }
    }

    fn is_hopeless(&self, bound: f64) -> bool {
        self.best.as_ref().is_some_and(|best| bound >= best.cost)
    }

    fn trace(&self, cost: f64, end: State, before: u32, edge: u32) -> Found {
        let (mut edges, mut before, mut edge) = (Vec::new(), before, edge);
        while before != NONE {
            edges.push(edge);
            Trail { before, edge } = self.trail.get(before);
        }
        edges.reverse();
        Found { cost, start: self.starts[edge as usize], edges, end }
    }
}
