//! Edits of recorded poses: a point of the surface is grabbed and dragged, and what becomes of it spreads over the frames
//! around.
//!
//! ```text
//! Rig -> Reach (inverse kinematics) -> skin -> Deformer (one solve, handles and pins held)
//!                                                 |
//! EditDocument (JSON) -> Editor: grab, drag, release -> EditedPoses (a PoseSource) -> synthesis
//! ```
//!
//! Edits are a document beside the request and never new frames: [`EditedPoses`] stands between the recording and whoever
//! reads poses, so that transitions that pass an edited frame begin or end in it. No input or output, no threads, no GPU: the
//! page runs the same.
//!
//! This work is based on: Tejera, Casas and Hilton, "Animation control of surface motion capture" (2013), sections III-B and
//! III-C. What differs: a whole body is moved by a rig first (the paper's iterations need a good start), and non-linear
//! propagation scales rotation vectors, whose sum has no order where edits overlap.

pub mod apply;
mod carry;
pub mod deform;
mod dense;
mod descent;
pub mod document;
mod drawn;
pub mod edited;
pub mod error;
pub mod floor;
pub mod grab;
mod grounded;
mod learned;
pub mod propagate;
mod pull;
pub mod reach;
pub mod rig;
pub mod rigid;
pub mod rotation;
pub mod settle;
pub mod skin;
pub mod soles;
pub mod space;
mod stand;
pub mod stored;
mod whole;

pub use self::apply::{Edits, Recording};
pub use self::deform::Deformer;
pub use self::document::{Edit, EditDocument, Handle, Method, Pins, Propagation, Scope};
pub use self::edited::EditedPoses;
pub use self::error::{EditError, PreparedError};
pub use self::grab::{Dragged, Editor, Grab, Grip, Released};
pub use self::rig::{Bone, Rig};
pub use self::rigid::Rigid;
pub use self::settle::Settling;
pub use self::skin::{INFLUENCES, Influences, Skin};
pub use self::space::{Space, StoredMode, StoredSpace};
pub use self::stored::StoredRig;
