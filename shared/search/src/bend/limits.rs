//! By how much walks may be bent.

/// A step of the body is taken to last so many seconds.
pub const STEP: f32 = 0.5;
/// Radians by which a step may be turned: 10 degrees.
pub const MOST_TURN: f32 = 0.1745;
/// Metres by which a step may be moved.
pub const MOST_STRIDE: f32 = 0.1;
/// From this speed on, in metres a second, a step may be changed by as much as may be; less at lower speeds.
pub const WALKS: f32 = 0.5;
