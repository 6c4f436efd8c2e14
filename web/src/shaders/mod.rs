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
/// One level of a mipmap.
pub const MIPMAP: &str = include_str!("mipmap.wgsl");
/// Restores a layer's blocks from the waves of its modes.
pub const APPEARANCE_BASIS: &str = include_str!("appearance_basis.wgsl");
/// What a texture moved directly lacks of its moved gradients.
pub const APPEARANCE_RESIDUAL: &str = concat!(
    include_str!("appearance_move.wgsl"),
    include_str!("appearance_complex.wgsl"),
    include_str!("appearance_residual.wgsl")
);
/// A multigrid cycle, down and up.
pub const APPEARANCE_CYCLE: &str =
    concat!(include_str!("appearance_complex.wgsl"), include_str!("appearance_cycle.wgsl"));
/// The finished texture of a frame.
pub const APPEARANCE_TEXTURE: &str = concat!(
    include_str!("appearance_move.wgsl"),
    include_str!("appearance_complex.wgsl"),
    include_str!("appearance_texture.wgsl")
);
