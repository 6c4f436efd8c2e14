//! Rigs of captures and bundles, corrected as a file says.

use std::path::Path;

use actor::capture::Poses;
use actor::pose_source::PoseSource;
use actor::timeline::Timeline;
use anyhow::Context;
use bundle::BundleReader;
use editing::{EditDocument, Editor, Rig, Space};
use glam::Vec3;
use kernels::topology::Topology;
use reprise::rigged::found_rig;
use rig::{RigError, RigFile};

use super::failure::Failure;
use super::terminal::Terminal;

/// All poses of a bundle.
pub fn poses(reader: &mut BundleReader, timeline: &Timeline, vertex_count: usize) -> Result<Poses, Failure> {
    let mut poses = Poses::new(vertex_count);
    let mut pose = vec![Vec3::ZERO; vertex_count];
    for frame in 0..timeline.frame_count() {
        reader.read(frame, &mut pose).map_err(|error| Failure::Input(error.into()))?;
        poses.push(&pose);
    }
    Ok(poses)
}

/// What a rig file says; nothing where there is none.
pub fn read_file(file: Option<&Path>) -> Result<RigFile, Failure> {
    let Some(file) = file else { return Ok(RigFile::default()) };
    let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()));
    let is_json = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    let parse = |text: String| -> anyhow::Result<RigFile> {
        if is_json { Ok(serde_json::from_str(&text)?) } else { Ok(toml::from_str(&text)?) }
    };
    let read = text.and_then(|text| parse(text).with_context(|| file.display().to_string()));
    read.map_err(Failure::Input)
}

/// The rig that a bundle has, and the frame of its rest pose.
pub fn of_bundle(reader: &mut BundleReader) -> Result<Option<(u32, Rig)>, Failure> {
    let damaged =
        |error: anyhow::Error| Failure::Input(error.context("the bundle's rig cannot be used: pack it again"));
    let Some(stored) = reader.rig().map_err(|error| damaged(error.into()))? else { return Ok(None) };
    let frame = stored.rest_frame;
    let mut rest = vec![Vec3::ZERO; reader.topology().map_or(0, Topology::vertex_count)];
    reader.read(frame, &mut rest).map_err(|error| damaged(error.into()))?;
    let rig = stored.rig(rest).map_err(|error| damaged(error.into()))?;
    Ok(Some((frame, rig)))
}

/// The ways in which a bundle's actor was seen to move, where it says.
fn space_of_bundle(reader: &mut BundleReader, topology: &Topology) -> Result<Option<Space>, Failure> {
    let damaged = |error: anyhow::Error| {
        Failure::Input(error.context("the bundle's learned space cannot be used: pack it again"))
    };
    let Some(stored) = reader.learned().map_err(|error| damaged(error.into()))? else { return Ok(None) };
    let mut poses = vec![vec![Vec3::ZERO; topology.vertex_count()]; stored.frames.len()];
    for (&frame, pose) in stored.frames.iter().zip(&mut poses) {
        reader.read(frame, pose).map_err(|error| damaged(error.into()))?;
    }
    stored.space(&poses, topology.weights()).map(Some).map_err(|error| damaged(error.into()))
}

/// What makes the edits of `document`: as [`bare_editor`], with the bundle's learned space where one of them goes by it.
pub fn editor(
    reader: &mut BundleReader,
    (topology, order): (&Topology, Option<&[u32]>),
    timeline: &Timeline,
    (document, file): (&EditDocument, Option<&Path>),
    terminal: &Terminal,
) -> Result<Editor, Failure> {
    let mut editor = bare_editor(reader, (topology, order), timeline, file, terminal)?;
    if document.wants_space()
        && let Some(space) = space_of_bundle(reader, topology)?
    {
        editor.learn(space).map_err(|error| Failure::Input(error.into()))?;
    }
    Ok(editor)
}

/// What edits poses of a bundle: with the rig that it has, with one that is estimated and corrected by a file, or without one where nothing moves against anything else.
fn bare_editor(
    reader: &mut BundleReader,
    (topology, order): (&Topology, Option<&[u32]>),
    timeline: &Timeline,
    file: Option<&Path>,
    terminal: &Terminal,
) -> Result<Editor, Failure> {
    if file.is_none()
        && let Some((_, rig)) = of_bundle(reader)?
    {
        return Editor::new(topology, order, Some(rig)).map_err(|error| Failure::Input(error.into()));
    }
    let rig_file = read_file(file)?;
    let poses = poses(reader, timeline, topology.vertex_count())?;
    let rig = match found_rig((topology, &poses), None, &rig_file, None) {
        Ok(found) => Some(found.rig),
        Err(error @ RigError::Rigid { .. }) if file.is_none() => {
            terminal.log(&format!("note: {error}"));
            None
        }
        Err(error) => return Err(Failure::Input(error.into())),
    };
    Editor::new(topology, order, rig).map_err(|error| Failure::Input(error.into()))
}
