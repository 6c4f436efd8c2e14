//! Rigs: estimated from how a surface moves, and what they are made of: inverse kinematics in closed form, and weights that
//! spread over a surface.
//!
//! Knows no particular skeleton but a human's, whose joints [`estimate()`] finds; everywhere else joints are indices, and which
//! of them owns a vertex is the caller's to say. What the page needs of rigs, too, is in `editing`.

pub mod corrections;
pub mod estimate;
pub mod given;
mod hung;
pub mod ik;
pub mod space;
pub mod weights;

pub use editing::{INFLUENCES, Influences, Rigid, Skin};

pub use self::corrections::{Correction, RigFile, RigOrigin};
pub use self::estimate::{Estimate, RigError, RigOptions, estimate};
pub use self::given::given;
pub use self::hung::GivenBone;
pub use self::ik::{TwoBones, two_bones};
pub use self::space::{Learned, SpaceOptions, learn_space};
pub use self::weights::{diffuse, spread};
