//! The shaders, each with what it shares put before it. A native test validates them all.

/// The actor's colour pass.
pub const ACTOR: &str = concat!(include_str!("frame.wgsl"), include_str!("pose.wgsl"), include_str!("actor.wgsl"));
/// Ghost poses: depth first, then their colour.
pub const GHOST: &str = concat!(include_str!("frame.wgsl"), include_str!("pose.wgsl"), include_str!("ghost.wgsl"));
/// What covers the ground, from above.
pub const OCCLUSION: &str =
    concat!(include_str!("frame.wgsl"), include_str!("pose.wgsl"), include_str!("occlusion.wgsl"));
/// Separable blur of the occlusion.
pub const BLUR: &str = include_str!("blur.wgsl");
/// The ground, its grid and the shadow on it.
pub const GROUND: &str = concat!(include_str!("frame.wgsl"), include_str!("ground.wgsl"));
/// The path walked so far.
pub const TRAIL: &str = concat!(include_str!("frame.wgsl"), include_str!("trail.wgsl"));
/// What tools draw on the ground.
pub const MARKS: &str = concat!(include_str!("frame.wgsl"), include_str!("marks.wgsl"));
/// One level of a mipmap.
pub const MIPMAP: &str = include_str!("mipmap.wgsl");
