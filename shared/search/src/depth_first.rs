//! The papers' search, exhaustive: depth-first branch-and-bound (thesis section 3.5; Kovar and others 2002). The oracle
//! that the tool's search is measured against; its time grows exponentially.

use super::search_graph::SearchGraph;
use super::task::{Found, State, Task};

/// What an exhaustive search has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Exhausted {
    /// The best walk; `None` where there is none.
    pub found: Option<Found>,
    /// Whether all walks were searched or pruned by the bound, so that there is no better one.
    pub complete: bool,
    /// States that were expanded.
    pub expanded: u64,
}

/// Searches all walks, up to `most` expanded states.
#[must_use]
pub fn depth_first(task: &impl Task, search_graph: &SearchGraph, most: u64) -> Exhausted {
    let mut search =
        Search { task, search_graph, most, result: Exhausted { found: None, complete: true, expanded: 0 } };
    for start in task.starts(search_graph) {
        search.consider(&start, &start, &[]);
        search.expand(start);
    }
    search.result
}

struct Search<'a, T> {
    task: &'a T,
    search_graph: &'a SearchGraph,
    most: u64,
    result: Exhausted,
}

/// States that can follow one, the worst first, and which is being expanded.
type Siblings = Vec<(f64, u32, State)>;

impl<T: Task> Search<'_, T> {
    /// Depth first from `start`, with a stack of its own: walks may be long.
    fn expand(&mut self, start: State) {
        let mut taken: Vec<u32> = Vec::new();
        let mut stack = vec![self.successors(&start)];
        while let Some(siblings) = stack.last_mut() {
            let Some((bound, edge, state)) = siblings.pop() else {
                stack.pop();
                taken.pop();
                continue;
            };
            if self.is_hopeless(bound) {
                continue;
            }
            if self.result.expanded >= self.most {
                self.result.complete = false;
                return;
            }
            taken.push(edge);
            self.consider(&start, &state, &taken);
            if self.task.halts(self.search_graph, &state) {
                taken.pop();
            } else {
                stack.push(self.successors(&state));
            }
        }
    }

    fn successors(&mut self, state: &State) -> Siblings {
        self.result.expanded += 1;
        let follow = |edge: u32| {
            let next = self.task.follow(self.search_graph, state, edge)?;
            Some((next.cost + self.task.remaining(self.search_graph, &next), edge, next))
        };
        let mut siblings: Siblings = self.search_graph.from(state.frame).filter_map(follow).collect();
        siblings.sort_by(|a, b| b.0.total_cmp(&a.0));
        siblings
    }

    fn is_hopeless(&self, bound: f64) -> bool {
        self.result.found.as_ref().is_some_and(|best| bound >= best.cost)
    }

    fn consider(&mut self, start: &State, end: &State, taken: &[u32]) {
        let Some(ending) = self.task.ending(self.search_graph, end) else { return };
        let cost = end.cost + ending;
        if !self.is_hopeless(cost) {
            self.result.found = Some(Found { cost, start: *start, edges: taken.to_vec(), end: *end });
        }
    }
}
