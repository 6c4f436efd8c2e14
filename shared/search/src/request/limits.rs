//! Limits of a request. What exceeds them is refused with a sentence.

/// Bytes of JSON.
pub const MAX_BYTES: usize = 1 << 20;
/// Points of a path.
pub const MAX_POINTS: usize = 4096;
/// Stretches of a path.
pub const MAX_STRETCHES: usize = 256;
/// Vertices of a group.
pub const MAX_VERTICES: usize = 1 << 16;
/// Key poses.
pub const MAX_KEYS: usize = 256;
/// Targets of a queue.
pub const MAX_QUEUE: usize = 256;
/// Weights of behaviours.
pub const MAX_WEIGHTS: usize = 256;
/// The largest seed: 2^53 - 1, the largest whole number that every reader of JSON keeps as it is.
pub const MAX_SEED: u64 = (1 << 53) - 1;
/// Seconds of anything.
pub const MAX_SECONDS: f64 = 3600.0;
/// Metres from the origin, and of a path's length.
pub const MAX_METRES: f64 = 2000.0;
/// The largest weight of anything.
pub const MAX_WEIGHT: f64 = 1000.0;
/// The least and the largest weight of a frame's duration.
pub const LEAST_QUICKNESS: f64 = 1e-6;
/// See [`LEAST_QUICKNESS`].
pub const MOST_QUICKNESS: f64 = 1000.0;
