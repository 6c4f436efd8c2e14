//! Frames in memory, written as any walk's are written.

use actor::capture::Poses;
use actor::graph::{DEFAULT_ALPHA, EssentialGraph};
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, Walk};
use capture_io::export::{Actor, ExportOptions, Output, Written, export, play_from};
use glam::Vec3;
use job::{Job, Progress};
use kernels::align::Placement;

use super::drive_actor::ReadActor;
use super::failure::Failure;
use super::terminal::Terminal;

/// Writes `poses` of `actor`, which looks as `exported` does, as one sequence called `name`.
pub fn write_frames(
    actor: &ReadActor,
    exported: &Actor,
    (name, poses): (&str, &[Vec<Vec3>]),
    output: &Output,
    options: &ExportOptions,
    terminal: &Terminal,
) -> Result<Written, Failure> {
    let internal = |error: anyhow::Error| Failure::Internal(error);
    let count = poses.len() as u32;
    let sequence =
        Sequence { name: name.into(), labels: Vec::new(), first_frame: 0, frame_count: count, cyclic: false };
    let timeline = Timeline::new(actor.timeline.fps(), vec![sequence]).map_err(|error| internal(error.into()))?;
    let graph = EssentialGraph::new(DEFAULT_ALPHA, Vec::new(), &timeline).map_err(|error| internal(error.into()))?;
    let legs = vec![Leg::Recorded { first: 0, last: count - 1, steps: count - 1 }];
    let walk = Walk::of_legs(legs, &graph).map_err(|error| internal(error.into()))?;
    let positions: Vec<Vec3> = poses.iter().flatten().copied().collect();
    let mut poses = Poses::from_positions(actor.topology.vertex_count(), positions);
    let mesh = (&actor.topology, actor.order.as_deref());
    let begin = (0, Placement::IDENTITY);
    let input = |error: Box<dyn std::error::Error + Send + Sync>| Failure::Input(anyhow::Error::from_boxed(error));
    let mut played =
        play_from(&mut poses, mesh, &graph, &timeline, begin, &walk).map_err(|error| input(error.into()))?;
    let report = |step: Progress| terminal.progress(step);
    let written =
        export(exported, &mut played, output, options, &Job::new(&report)).map_err(|error| input(error.into()))?;
    written.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    Ok(written)
}
