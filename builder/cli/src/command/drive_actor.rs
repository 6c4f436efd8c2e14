//! Who is driven: a bundle, or a capture.

use std::path::Path;

use actor::capture::Poses;
use anyhow::{Context, anyhow};
use bundle::BundleReader;
use capture_io::export::Actor;
use capture_io::import::{ImportError, Imported, import};
use editing::Rig;
use glam::Vec3;
use job::Job;
use kernels::topology::Topology;
use reprise::drive::bundle_of;

use super::args::DriveArguments;
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

/// An actor with all that driving it needs.
pub struct DrivenActor {
    /// What it comes from.
    pub origin: Origin,
    /// Its mesh.
    pub topology: Topology,
    /// An order of elimination, where it is known.
    pub order: Option<Vec<u32>>,
    /// What was recorded.
    pub poses: Poses,
    /// Frames a second.
    pub fps: f32,
    /// Its rig.
    pub rig: Rig,
}

/// Reads the actor and its rig.
pub fn read(arguments: &DriveArguments, terminal: &Terminal) -> Result<DrivenActor, Failure> {
    let file = rigged::read_file(arguments.rig.as_deref())?;
    let estimated = |topology: &Topology, poses: &Poses| {
        let corrected = rigged::corrected(topology, poses, &file, None);
        corrected.map(|(_, rig)| rig).map_err(|error| Failure::Input(error.into()))
    };
    if is_bundle(Path::new(&arguments.actor)) {
        let path = &arguments.actor;
        let bytes = std::fs::read(path).with_context(|| format!("cannot read {path}")).map_err(Failure::Input)?;
        let mut reader = BundleReader::from_bytes(&bytes).with_context(|| path.clone()).map_err(Failure::Input)?;
        let (Some(timeline), Some(topology)) = (reader.timeline().cloned(), reader.topology().cloned()) else {
            return Err(Failure::Input(anyhow!("{path} ends before its mesh is described")));
        };
        let poses = rigged::poses(&mut reader, &timeline, topology.vertex_count())?;
        let stored = if arguments.rig.is_none() { rigged::of_bundle(&mut reader)? } else { None };
        let rig = stored.map_or_else(|| estimated(&topology, &poses), |(_, rig)| Ok(rig))?;
        let order = reader.order().map(<[u32]>::to_vec);
        let fps = timeline.fps();
        return Ok(DrivenActor { origin: Origin::Bundle(Box::new(reader)), topology, order, poses, fps, rig });
    }
    let progress = |step| terminal.progress(step);
    let inputs = [arguments.actor.clone()];
    let imported = import(&inputs, &import_options(&arguments.import), &Job::new(&progress));
    let imported = imported.map_err(|error| match error {
        ImportError::Stopped(_) => Failure::StoppedReading,
        error => Failure::Input(error.into()),
    })?;
    imported.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    let (topology, poses) = (imported.capture.topology.clone(), imported.capture.poses.clone());
    let rig = estimated(&topology, &poses)?;
    let fps = imported.capture.timeline.fps();
    Ok(DrivenActor { origin: Origin::Capture(Box::new(imported)), topology, order: None, poses, fps, rig })
}

impl DrivenActor {
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
