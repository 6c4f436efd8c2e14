//! What a stopwatch and the passes agree on.

/// Where a pass writes when it begins and ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot<'a> {
    pub queries: &'a wgpu::QuerySet,
    pub begin: u32,
    pub end: u32,
}
