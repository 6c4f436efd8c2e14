//! How a long stage says how far it is: plain values, so that a terminal, a log or a window can show them.

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

/// Who is told; called from many threads at once.
pub type Report<'a> = &'a (dyn Fn(Progress) + Sync);

/// Tells nobody.
pub fn silent(_: Progress) {}
