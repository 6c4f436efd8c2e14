//! What a rig is made of: rigid transforms, inverse kinematics, weights that spread over a surface, and skinning with them.
//!
//! Knows no particular skeleton: joints are indices, and which of them owns a vertex is the caller's to say.

pub mod ik;
pub mod rigid;
pub mod skin;
pub mod weights;

pub use self::ik::{TwoBones, two_bones};
pub use self::rigid::Rigid;
pub use self::skin::{INFLUENCES, Influences, Skin};
pub use self::weights::{diffuse, spread};
