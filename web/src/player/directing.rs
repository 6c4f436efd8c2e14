//! What is known for searches so far.

use std::rc::Rc;

use actor::motion::{Motion, MotionMeter};
use glam::Vec3;
use searcher::scene::Telling;

/// It is made anew for another actor.
#[derive(Default)]
pub(super) struct Directing {
    pub meter: Option<Box<MotionMeter>>,
    pub motion: Option<Rc<Motion>>,
    /// What searches need to know, as far as it is written.
    pub telling: Option<Box<Telling>>,
    /// The vertices whose middle is measured, and where it is in the frames so far.
    pub group: Vec<u32>,
    pub middles: Vec<Vec3>,
}
