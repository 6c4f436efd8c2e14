//! What is known for searches, and the search under way.

use std::rc::Rc;

use actor::motion::{Motion, MotionMeter};
use glam::Vec3;
use search::{Direction, RequestError, SearchGraph, SearchGraphBuilder, limits};

/// It is made anew for another actor, and in part for other vertices that are followed.
#[derive(Default)]
pub(super) struct Directing {
    pub motion: Option<Rc<Motion>>,
    /// The vertices that are, or shall be, followed; empty for the centre of mass.
    pub group: Vec<u32>,
    pub preparing: Option<Preparing>,
    pub search_graph: Option<Rc<SearchGraph>>,
    pub direction: Option<Direction>,
}

/// How far the preparations are.
pub(super) enum Preparing {
    Measuring(Box<MotionMeter>),
    /// The group's middle in the frames so far.
    Grouping(Vec<Vec3>),
    Surveying(Box<SearchGraphBuilder>),
}

impl Directing {
    /// From now on these vertices are followed: what was known of others is dropped.
    pub fn follow(&mut self, vertices: &[u32], vertex_count: usize) -> Result<(), RequestError> {
        if self.group == vertices {
            return Ok(());
        }
        if vertices.len() > limits::MAX_VERTICES {
            let (what, limit) = ("vertices", limits::MAX_VERTICES);
            return Err(RequestError::TooMany { what, count: vertices.len(), limit });
        }
        if let Some(&vertex) = vertices.iter().find(|&&vertex| vertex as usize >= vertex_count) {
            return Err(RequestError::UnknownVertex(vertex));
        }
        self.group = vertices.to_vec();
        self.preparing.take_if(|state| !matches!(state, Preparing::Measuring(_)));
        (self.search_graph, self.direction) = (None, None);
        Ok(())
    }
}
