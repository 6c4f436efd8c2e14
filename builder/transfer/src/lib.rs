//! One actor moves as another does, learned from a few pairs of poses that mean the same.
//!
//! ```text
//! subject (own frame, parts) -> spaces (numbers a part) -> densify (keys to pairs, by DTW)
//!     -> upright, carried (the pose by the bones of both) -> model (Gaussian processes of what is left over, displacement)
//!     -> rebuild (parts into one surface) -> stand (soles)
//! ```
//!
//! Thesis chapter 5, with what it takes to work (docs/transfer.md). Knows no file.

mod agreement;
mod bones;
mod carried;
mod correct;
mod densify;
mod displace;
mod dtw;
mod error;
mod frame_map;
mod front;
mod inputs;
mod limbs;
mod map;
mod model;
mod pair;
mod rebuild;
mod space;
mod stand;
mod subject;
mod upright;

pub use crate::densify::{Dense, Doubt, densify};
pub use crate::error::TransferError;
pub use crate::frame_map::{Costs, FrameMap};
pub use crate::model::Model;
pub use crate::pair::{Key, Pair, TransferOptions};
pub use crate::rebuild::Rebuilder;
pub use crate::subject::Subject;
pub use learn::kernel::Kernel;
