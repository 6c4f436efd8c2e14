//! An actor of a bundle driven by a clip, natively: as the builder does it, and with its ends edited as the page does it.

use actor::capture::Poses;
use actor::pose_source::PoseSource;
use anyhow::{Result, bail};
use bundle::BundleReader;
use drive::{Driven, Mapping, MappingFile, body, retarget};
use driver::session::Session;
use editor::scene::{Known, words};
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

/// The frames of `clip` with its ends edited as the page edits them where the actor of `bundle` leaves from frame `from`; nothing where it
/// has no rig.
///
/// # Errors
/// As [`drive()`].
pub fn aimed(bundle: &[u8], clip: &str, from: u32) -> Result<Vec<Vec<Vec3>>> {
    let mut reader = BundleReader::from_bytes(bundle)?;
    let (Some(topology), Some(timeline)) = (reader.topology().cloned(), reader.timeline().cloned()) else {
        bail!("the bundle is not complete");
    };
    let Some(rig) = reader.rig_bytes().map(<[u8]>::to_vec) else { return Ok(Vec::new()) };
    let feet = reader.graph().map(|graph| graph.feet().clone()).unwrap_or_default();
    let order = reader.order().map(<[u32]>::to_vec);
    let mut read = |frame: u32| -> Result<Vec<Vec3>> {
        let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
        reader.read(frame, &mut pose)?;
        Ok(pose)
    };
    let Some(known) = Known::from_words(&words(&timeline, &topology, &feet, order.as_deref())) else {
        bail!("the actor cannot be handed over");
    };
    let mut session = Session::new(known, &rig)?;
    while let Some(&frame) = session.needs().first() {
        session.give(read(frame)?)?;
    }
    let began = session.begin(&[("clip.bvh", clip.as_bytes())])?;
    let windows = session.prepare(from, &read(from)?)?;
    let mut recorded = [Vec::new(), Vec::new()];
    for (poses, window) in recorded.iter_mut().zip(windows) {
        for step in 0..window.count {
            poses.extend(read(timeline.offset(window.first, step.into()).unwrap_or(window.first))?);
        }
    }
    session.aim(&recorded)?;
    Ok((0..began.count).map(|frame| session.make(frame)).collect::<Result<_, _>>()?)
}
