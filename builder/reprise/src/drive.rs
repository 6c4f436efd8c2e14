//! Frames that were driven by a skeleton, as a bundle without transitions: what exports write as they write any actor.

use actor::capture::{Capture, Poses};
use actor::files::Files;
use actor::graph::{DEFAULT_ALPHA, EssentialGraph};
use actor::timeline::{Sequence, Timeline};
use bundle::{BundleInput, default_max_error};
use glam::Vec3;
use kernels::cholesky::elimination_order;

use crate::options::{FIRST_FRAME, PackError};

/// Positions of such a bundle are off by this share of what a packed one's may be: it is written out and thrown away.
const FINER: f32 = 0.1;

/// A bundle of `poses` over the mesh and the looks of `capture`, as one sequence called `name`. It leads from nowhere to
/// nowhere: it is there to be exported.
///
/// # Errors
/// No pose, or poses of another mesh.
pub fn bundle_of(capture: &Capture, files: &Files, name: &str, poses: &[Vec<Vec3>]) -> Result<Vec<u8>, PackError> {
    let wrong = |error: &dyn std::fmt::Display| PackError::Option(error.to_string());
    let sequence = Sequence {
        name: name.to_owned(),
        labels: Vec::new(),
        first_frame: 0,
        frame_count: poses.len() as u32,
        cyclic: false,
    };
    let timeline = Timeline::new(capture.timeline.fps(), vec![sequence]).map_err(|error| wrong(&error))?;
    let positions = poses.iter().flatten().copied().collect();
    let poses = Poses::from_positions(capture.topology.vertex_count(), positions);
    let graph = EssentialGraph::new(DEFAULT_ALPHA, Vec::new(), &timeline).map_err(|error| wrong(&error))?;
    let driven = Capture::new(&*capture.name, capture.topology.clone(), capture.surface.clone(), timeline, poses)
        .and_then(|driven| driven.with_file_vertices(capture.vertex_of_file_vertex.clone()))
        .map_err(|error| wrong(&error))?;
    let order = elimination_order(&driven.topology);
    let input = BundleInput {
        capture: &driven,
        graph: &graph,
        first_frame: FIRST_FRAME,
        max_error: FINER * default_max_error(&driven, FIRST_FRAME),
        poisson_order: Some(&order),
        generator: format!("Reprise builder {}", env!("CARGO_PKG_VERSION")),
    };
    Ok(bundle::encode_with_rig(&input, &[], files, None)?.0)
}
