//! A count of edges that searches have looked at: what tests hold slices to, as they must not look at clocks.

use std::cell::Cell;

thread_local! {
    static EDGES: Cell<u64> = const { Cell::new(0) };
}

/// Counts edges.
pub(super) fn count(edges: usize) {
    EDGES.with(|sum| sum.set(sum.get().wrapping_add(edges as u64)));
}

/// How many edges of graphs and chains the searches of this thread have looked at so far. An edge takes about a twentieth of
/// a microsecond.
#[must_use]
pub fn edges_looked_at() -> u64 {
    EDGES.with(Cell::get)
}
