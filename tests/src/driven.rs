//! An actor of a bundle driven by a clip, natively.

use actor::capture::Poses;
use actor::pose_source::PoseSource;
use anyhow::{Result, bail};
use bundle::BundleReader;
use drive::{Driven, Mapping, MappingFile, body, retarget};
use glam::Vec3;

/// What the actor of `bundle` does where `clip`, the text of a BVH file, moves it; `None` where it has no rig.
///
/// # Errors
/// A bundle that cannot be read, a rig or a clip that is no human's.
pub fn drive(bundle: &[u8], clip: &str) -> Result<Option<Driven>> {
    let mut reader = BundleReader::from_bytes(bundle)?;
    let Some(stored) = reader.rig()? else { return Ok(None) };
    let (Some(topology), Some(timeline)) = (reader.topology().cloned(), reader.timeline().cloned()) else {
        bail!("the bundle is not complete");
    };
    let mut poses = Poses::new(topology.vertex_count());
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    for frame in 0..timeline.frame_count() {
        reader.read(frame, &mut pose)?;
        poses.push(&pose);
    }
    let rest = poses.frame(stored.rest_frame).to_vec();
    let rig = stored.rig(rest)?;
    let (clip, _) = mocap::read(&[("clip.bvh", clip.as_bytes())], &mocap::Options::default())?;
    let mapping = Mapping::of(&clip, &MappingFile::default())?;
    let order = reader.order().map(<[u32]>::to_vec);
    let body = body(&rig, &poses)?;
    let mesh = (&topology, order.as_deref());
    Ok(Some(retarget((&clip, &mapping), &body, mesh, (&poses, timeline.fps()))?))
}
