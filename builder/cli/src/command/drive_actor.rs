//! Who is driven, or moves as another does: a bundle, or a capture.

use std::path::Path;

use actor::capture::Poses;
use actor::timeline::Timeline;
use anyhow::{Context, anyhow};
use bundle::BundleReader;
use capture_io::export::Actor;
use capture_io::import::{ImportError, Imported, import};
use editing::Rig;
use glam::Vec3;
use job::Job;
use kernels::topology::Topology;
use reprise::drive::bundle_of;
use reprise::rigged::found_rig;

use super::args::ImportArguments;
use super::failure::Failure;
use super::inspect::is_bundle;
use super::pack::import_options;
use super::rigged;
use super::terminal::Terminal;

/// What the actor comes from.
pub enum Origin {
    /// A bundle.
    Bundle(Box<BundleReader>),
    /// A capture.
    Capture(Box<Imported>),
}

/// An actor as it was read.
pub struct ReadActor {
    /// What it comes from.
    pub origin: Origin,
    /// Its mesh.
    pub topology: Topology,
    /// An order of elimination, where it is known.
    pub order: Option<Vec<u32>>,
    /// What was recorded.
    pub poses: Poses,
    /// Its sequences.
    pub timeline: Timeline,
    /// The number of each vertex's part of the body, where parts were painted.
    pub parts: Option<Vec<u8>>,
}

/// Reads an actor: a bundle, or a capture as `import` says.
pub fn read(path: &str, import_arguments: &ImportArguments, terminal: &Terminal) -> Result<ReadActor, Failure> {
    if is_bundle(Path::new(path)) {
        let bytes = std::fs::read(path).with_context(|| format!("cannot read {path}")).map_err(Failure::Input)?;
        let mut reader = BundleReader::from_bytes(&bytes).with_context(|| path.to_owned()).map_err(Failure::Input)?;
        let (Some(timeline), Some(topology)) = (reader.timeline().cloned(), reader.topology().cloned()) else {
            return Err(Failure::Input(anyhow!("{path} ends before its mesh is described")));
        };
        let poses = rigged::poses(&mut reader, &timeline, topology.vertex_count())?;
        let order = reader.order().map(<[u32]>::to_vec);
        let parts = reader.body_parts().with_context(|| path.to_owned()).map_err(Failure::Input)?;
        return Ok(ReadActor { origin: Origin::Bundle(Box::new(reader)), topology, order, poses, timeline, parts });
    }
    let progress = |step| terminal.progress(step);
    let inputs = [path.to_owned()];
    let imported = import(&inputs, &import_options(import_arguments), &Job::new(&progress));
    let imported = imported.map_err(|error| match error {
        ImportError::Stopped(_) => Failure::StoppedReading,
        error => Failure::Input(error.into()),
    })?;
    imported.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    let capture = &imported.capture;
    let (topology, poses, timeline) = (capture.topology.clone(), capture.poses.clone(), capture.timeline.clone());
    let parts = imported.parts.clone();
    Ok(ReadActor { origin: Origin::Capture(Box::new(imported)), topology, order: None, poses, timeline, parts })
}

/// The rig of an actor: that of the file, the bundle's own, or estimated.
pub fn rig(actor: &mut ReadActor, file: Option<&Path>) -> Result<Rig, Failure> {
    let stored = match &mut actor.origin {
        Origin::Bundle(reader) if file.is_none() => rigged::of_bundle(reader)?,
        _ => None,
    };
    if let Some((_, rig)) = stored {
        return Ok(rig);
    }
    let file = rigged::read_file(file)?;
    let skeleton = match &actor.origin {
        Origin::Bundle(_) => None,
        Origin::Capture(imported) => imported.skeleton.as_ref(),
    };
    let found = found_rig((&actor.topology, &actor.poses), skeleton, &file, None);
    found.map(|found| found.rig).map_err(|error| Failure::Input(error.into()))
}

impl ReadActor {
    /// What exports need: of a capture by way of a bundle of the frames `driven`, of a bundle as it is, all frames wearing
    /// what the recorded frame `worn` wears.
    pub fn exported(&self, name: &str, driven: &[Vec<Vec3>], worn: u32) -> Result<Actor, Failure> {
        let made;
        let reader = match &self.origin {
            Origin::Bundle(reader) => reader.as_ref(),
            Origin::Capture(imported) => {
                let bytes = bundle_of(&imported.capture, &imported.files, name, driven);
                let bytes = bytes.map_err(|error| Failure::Internal(error.into()))?;
                made = BundleReader::from_bytes(&bytes).map_err(|error| Failure::Internal(error.into()))?;
                &made
            }
        };
        let mut actor = Actor::of(reader).map_err(|error| Failure::Input(error.into()))?;
        actor.wear(worn);
        Ok(actor)
    }
}
