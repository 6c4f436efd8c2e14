//! What a rig is made of: rigid transforms, inverse kinematics, weights that spread over a surface, and skinning with them.
//!
//! Knows no particular skeleton: joints are indices, and which of them owns a vertex is the caller's to say.

pub mod ik;
pub mod weights;

pub use editing::{INFLUENCES, Influences, Rigid, Skin};

pub use self::ik::{TwoBones, two_bones};
pub use self::weights::{diffuse, spread};
