//! What the tests that cross crates share.

pub mod dressed;
mod driven;
pub mod hostile;
pub mod scanned;

use anyhow::{Context, Result, bail};
use bundle::BundleReader;
use glam::Vec3;
use kernels::align::Placement;
use search::cheapest_walk;
use synthesis::Synthesiser;

pub use self::driven::{aimed, drive};

/// Every frame of the cheapest walk between two frames of a bundle, synthesised natively, from where `from` was recorded.
///
/// # Errors
/// A bundle that cannot be read, or no walk.
pub fn synthesise(bundle: &[u8], from: u32, to: u32) -> Result<Vec<Vec<Vec3>>> {
    let mut reader = BundleReader::from_bytes(bundle)?;
    let (Some(topology), Some(timeline), Some(graph)) =
        (reader.topology().cloned(), reader.timeline().cloned(), reader.graph().cloned())
    else {
        bail!("the bundle is not complete");
    };
    let walk = cheapest_walk(&graph, &timeline, from, to).context("there is no walk")?;
    let order = reader.order().map(<[u32]>::to_vec);
    let mut synthesiser = Synthesiser::new(&topology, order.as_deref())?;
    synthesiser.begin_walk(&graph, &timeline, (from, Placement::IDENTITY), &walk)?;
    let mut frames = Vec::new();
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    while synthesiser.next_frame(&graph, &timeline, &mut reader, &mut pose)?.is_some() {
        frames.push(pose.clone());
    }
    Ok(frames)
}
