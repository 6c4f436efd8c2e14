//! How long passes take, by the GPU's own clock.
//!
//! For programs outside of a browser alone: the page's build has none of it. A `Gpu` that is `timed_by` a
//! stopwatch has every pass write its beginning and its end.

use std::sync::{Mutex, MutexGuard, PoisonError, mpsc};

use thiserror::Error;
use wgpu::{BufferUsages, Features, QUERY_SIZE};

use super::slot::Slot;

/// Passes that can be timed between two looks at the stopwatch; a picture with its texture has some twenty.
const MOST: u32 = 256;

/// Why there are no times.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TimingError {
    /// The device is gone, or does not hand its times out.
    #[error("the device does not hand its times out: {0}")]
    Unreadable(String),
    /// Passes beyond those that there is room for.
    #[error("there is room for the times of {MOST} passes; look at the stopwatch more often")]
    Full,
}

/// How long a pass took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lap {
    /// The pass's label.
    pub name: &'static str,
    /// From its beginning to its end.
    pub nanoseconds: f64,
}

/// Queries of the GPU's clock, two for each pass.
#[derive(Debug)]
pub struct Stopwatch {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    mapped: wgpu::Buffer,
    /// Nanoseconds of a tick.
    period: f64,
    /// Whether work between passes can be timed, too.
    between_passes: bool,
    /// Passes since the last look.
    names: Mutex<Vec<&'static str>>,
}

impl Stopwatch {
    /// What a device should be asked for, as far as its adapter has it.
    pub const FEATURES: Features = Features::TIMESTAMP_QUERY.union(Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);

    /// `None` where `device` was opened without timestamp queries.
    #[must_use]
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        if !device.features().contains(Features::TIMESTAMP_QUERY) {
            return None;
        }
        let buffer = |label, usage| {
            let size = u64::from(2 * MOST * QUERY_SIZE);
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
        };
        let mapped = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        Some(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("reprise.timing.queries"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MOST,
            }),
            resolved: buffer(Some("reprise.timing.resolved"), BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            mapped: buffer(Some("reprise.timing.mapped"), mapped),
            period: f64::from(queue.get_timestamp_period()),
            between_passes: device.features().contains(Features::TIMESTAMP_QUERY_INSIDE_ENCODERS),
            names: Mutex::default(),
        })
    }

    /// A slot for the pass `name`; `None` where there is no room, which [`Self::laps`] tells.
    pub(super) fn slot(&self, name: &'static str) -> Option<Slot<'_>> {
        let mut names = self.names();
        names.push(name);
        let begin = 2 * (names.len() as u32 - 1);
        (begin < 2 * MOST).then_some(Slot { queries: &self.queries, begin, end: begin + 1 })
    }

    /// As [`Self::slot`], for what is not a pass; `None` where the device cannot time that.
    pub(super) fn slot_between(&self, name: &'static str) -> Option<Slot<'_>> {
        if self.between_passes { self.slot(name) } else { None }
    }

    /// The passes that were submitted since the last look, in the order in which they were begun; waits for their end.
    ///
    /// None at all where the device set its clock back meanwhile, as some do when they change their speed.
    ///
    /// # Errors
    /// The device is gone, or there were too many passes.
    pub fn laps(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<Lap>, TimingError> {
        let names = std::mem::take(&mut *self.names());
        let count = names.len() as u32;
        if count > MOST {
            return Err(TimingError::Full);
        }
        if count == 0 {
            return Ok(Vec::new());
        }
        let bytes = u64::from(2 * count * QUERY_SIZE);
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("reprise.timing.commands") });
        encoder.resolve_query_set(&self.queries, 0..2 * count, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.mapped, 0, bytes);
        queue.submit([encoder.finish()]);
        let (told, outcome) = mpsc::channel();
        // Nobody listens any more only where this function has failed already.
        self.mapped.map_async(wgpu::MapMode::Read, ..bytes, move |outcome| drop(told.send(outcome)));
        let unreadable = |error: &dyn std::fmt::Display| TimingError::Unreadable(error.to_string());
        device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| unreadable(&error))?;
        outcome.recv().map_err(|error| unreadable(&error))?.map_err(|error| unreadable(&error))?;
        let ticks: Vec<u64> = {
            let range = self.mapped.get_mapped_range(..bytes).map_err(|error| unreadable(&error))?;
            bytemuck::pod_collect_to_vec(&range[..])
        };
        self.mapped.unmap();
        let lap = |(name, ticks): (&&'static str, &[u64])| {
            let ticks = ticks[1].checked_sub(ticks[0])?;
            Some(Lap { name, nanoseconds: ticks as f64 * self.period })
        };
        let laps: Option<Vec<Lap>> = names.iter().zip(ticks.chunks_exact(2)).map(lap).collect();
        Ok(laps.unwrap_or_default())
    }

    fn names(&self) -> MutexGuard<'_, Vec<&'static str>> {
        // A list of names is whole whatever happened to whoever held it.
        self.names.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
