//! Families: two or more cycles of one kind - a walk and a run, jumps of two heights, turns of two curvatures - and all that lies
//! between them.
//!
//! ```text
//! recorded (frames, feet) -> cycle, jump -> member (cut, closed) -> pair (one phase) -> root, hold (feet) -> sample -> family
//! ```
//!
//! This work is based on: Tejera, Casas and Hilton (2013), section IV, equation 14, and on the works that it summarises. A cycle
//! is cut where a foot lands, members are aligned in time by their landings, blended with Poisson interpolation, and the
//! parameter is measured on the result and inverted. What the paper leaves open is how the body gets on (`root`) and where the feet
//! are (`hold`). Knows no file.

mod align;
mod cycle;
mod error;
mod family;
mod find;
mod hold;
mod jump;
mod member;
mod pair;
mod parameter;
mod phase;
mod recorded;
mod root;
mod sample;
mod times;
mod twist;

pub use error::FamilyError;
pub use family::{Family, Part, Wanted};
pub use find::{Found, MEETS, Proposal, UNLIKE, found, proposals};
pub use member::{Event, Member};
pub use parameter::Parameter;
pub use recorded::{Recorded, Track};
pub use sample::{Measured, Sample};
pub use twist::Twist;
