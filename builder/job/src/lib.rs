//! What long work needs, whatever it works on: saying how far it is, stopping when asked, results that last, and files that
//! are whole or not there at all.

pub mod files;
pub mod memory;
mod progress;
pub mod rows;
pub mod work;

pub use progress::{Job, Progress, Report, Stopped};
