//! Playing a walk: its frames, one after another, as the player on the page makes them.

use actor::graph::EssentialGraph;
use actor::pose_source::PoseSource;
use actor::timeline::Timeline;
use actor::walk::Walk;
use bundle::BundleReader;
use glam::Vec3;
use kernels::align::{Placement, centre_of_mass};
use kernels::topology::Topology;
use synthesis::{FrameKind, Synthesiser};

use super::error::ExportError;
use job::Job;

/// A walk that is being played.
pub struct Played<'a> {
    graph: &'a EssentialGraph,
    timeline: &'a Timeline,
    source: &'a mut dyn PoseSource,
    weights: Vec<f32>,
    synthesiser: Synthesiser,
    pose: Vec<Vec3>,
    /// Centre of mass of each frame so far, in metres.
    pub centres: Vec<Vec3>,
    /// Frames of the walk.
    pub frames: u32,
}

/// Begins to play `walk` from frame `start`, which stands at `placement`.
///
/// # Errors
/// A bundle that is not whole, a mesh that cannot be interpolated, or a walk that does not belong to the graph.
pub fn play<'a>(
    reader: &'a mut BundleReader,
    graph: &'a EssentialGraph,
    timeline: &'a Timeline,
    (start, placement): (u32, Placement),
    walk: &Walk,
) -> Result<Played<'a>, ExportError> {
    let topology = reader.topology().ok_or(ExportError::NotWhole)?.clone();
    let order = reader.order().map(<[u32]>::to_vec);
    play_from(reader, (&topology, order.as_deref()), graph, timeline, (start, placement), walk)
}

/// As [`play`], with poses from `source`: a bundle's, with edits. `order` is the bundle's order of elimination.
///
/// # Errors
/// As there.
pub fn play_from<'a>(
    source: &'a mut dyn PoseSource,
    (topology, order): (&Topology, Option<&[u32]>),
    graph: &'a EssentialGraph,
    timeline: &'a Timeline,
    (start, placement): (u32, Placement),
    walk: &Walk,
) -> Result<Played<'a>, ExportError> {
    let weights = topology.weights().to_vec();
    let mut synthesiser = Synthesiser::new(topology, order)?;
    synthesiser.begin_walk(graph, timeline, (start, placement), walk)?;
    let pose = vec![Vec3::ZERO; weights.len()];
    let frames = walk.steps(graph) + 1;
    Ok(Played { graph, timeline, source, weights, synthesiser, pose, centres: Vec::new(), frames })
}

/// A frame that is written.
#[derive(Clone, Copy)]
pub(super) struct Shown<'a> {
    /// Its number among those that are written.
    pub number: u32,
    /// Where it comes from.
    pub kind: FrameKind,
    /// Positions of the welded vertices, in metres.
    pub pose: &'a [Vec3],
}

impl Played<'_> {
    /// The next frame's vertex positions in metres; `None` once the walk has arrived.
    ///
    /// # Errors
    /// A frame that cannot be read or made.
    pub fn next_pose(&mut self) -> Result<Option<&[Vec3]>, ExportError> {
        Ok(self.next()?.map(|(_, pose)| pose))
    }

    /// The next frame: where it comes from, and its pose.
    fn next(&mut self) -> Result<Option<(FrameKind, &[Vec3])>, ExportError> {
        let made = self.synthesiser.next_frame(self.graph, self.timeline, self.source, &mut self.pose);
        let made = made.map_err(|cause| ExportError::Frame { step: self.centres.len() as u32, cause })?;
        let Some(made) = made else { return Ok(None) };
        self.centres.push(centre_of_mass(&self.pose, &self.weights));
        Ok(Some((made.kind, &self.pose)))
    }

    /// Calls `write` with every `every`-th frame. Reports each as one of `what`, and returns how many there were.
    pub(super) fn each(
        &mut self,
        every: u32,
        (what, job): (&'static str, &Job),
        mut write: impl FnMut(Shown) -> Result<(), ExportError>,
    ) -> Result<u32, ExportError> {
        let total = u64::from(self.written(every));
        let (mut step, mut written) = (0_u32, 0);
        while let Some((kind, pose)) = self.next()? {
            if step.is_multiple_of(every.max(1)) {
                job.tell(what, u64::from(written), total)?;
                write(Shown { number: written, kind, pose })?;
                written += 1;
            }
            step += 1;
        }
        Ok(written)
    }

    /// Frames that are written when every `every`-th is.
    pub(super) fn written(&self, every: u32) -> u32 {
        self.frames.div_ceil(every.max(1))
    }
}
