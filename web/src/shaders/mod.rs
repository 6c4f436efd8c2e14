//! The shaders, each with what it shares put before it, as `build.rs` leaves them. A native test validates them all.

macro_rules! shader {
    ($name:literal) => {
        include_str!(concat!(env!("OUT_DIR"), "/", $name))
    };
}

/// The actor's colour pass.
pub const ACTOR: &str = concat!(shader!("frame.wgsl"), shader!("pose.wgsl"), shader!("actor.wgsl"));
/// Ghost poses: depth first, then their colour.
pub const GHOST: &str = concat!(shader!("frame.wgsl"), shader!("pose.wgsl"), shader!("ghost.wgsl"));
/// What covers the ground, from above.
pub const OCCLUSION: &str = concat!(shader!("frame.wgsl"), shader!("pose.wgsl"), shader!("occlusion.wgsl"));
/// Separable blur of the occlusion.
pub const BLUR: &str = shader!("blur.wgsl");
/// The ground, its grid and the shadow on it.
pub const GROUND: &str = concat!(shader!("frame.wgsl"), shader!("ground.wgsl"));
/// The path walked so far.
pub const TRAIL: &str = concat!(shader!("frame.wgsl"), shader!("trail.wgsl"));
/// What tools draw on the ground.
pub const MARKS: &str = concat!(shader!("frame.wgsl"), shader!("marks.wgsl"));
/// One level of a mipmap.
pub const MIPMAP: &str = shader!("mipmap.wgsl");
/// Restores a layer's blocks from the waves of its modes.
pub const APPEARANCE_BASIS: &str = shader!("appearance_basis.wgsl");
/// What a texture moved directly lacks of its moved gradients.
pub const APPEARANCE_RESIDUAL: &str =
    concat!(shader!("appearance_move.wgsl"), shader!("appearance_complex.wgsl"), shader!("appearance_residual.wgsl"));
/// A multigrid cycle, down and up.
pub const APPEARANCE_CYCLE: &str = concat!(shader!("appearance_complex.wgsl"), shader!("appearance_cycle.wgsl"));
/// The finished texture of a frame.
pub const APPEARANCE_TEXTURE: &str =
    concat!(shader!("appearance_move.wgsl"), shader!("appearance_complex.wgsl"), shader!("appearance_texture.wgsl"));
