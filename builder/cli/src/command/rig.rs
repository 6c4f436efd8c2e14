//! `builder rig`.

use std::path::Path;

use actor::capture::Poses;
use anyhow::{Context, anyhow};
use bundle::BundleReader;
use capture_io::export::rig_picture;
use capture_io::import::{FileSkeleton, ImportError, import};
use editing::Rig;
use glam::{Vec2, Vec3Swizzles};
use job::Job;
use kernels::topology::Topology;
use reprise::rigged::{FoundRig, found_rig};
use rig::{Estimate, RigFile};
use serde::Serialize;

use super::args::RigArguments;
use super::failure::Failure;
use super::inspect::is_bundle;
use super::output::{print_json, print_text, write_whole};
use super::pack::import_options;
use super::rigged;
use super::terminal::Terminal;

/// What `--json` prints.
#[derive(Serialize)]
struct RigReport {
    /// The frame of the rest pose.
    rest_frame: u32,
    /// What was found; nothing of a rig that a bundle has.
    #[serde(flatten)]
    found: Option<FoundReport>,
    /// The bones, as corrected.
    bones: Vec<BoneReport>,
}

#[derive(Serialize)]
struct FoundReport {
    /// Whether it was taken for a human's.
    human: bool,
    /// Whether it is the skeleton that the capture's file brings.
    given: bool,
    /// Rigid parts that were found.
    parts: usize,
    /// Key frames, the rest pose first.
    keys: Vec<u32>,
    /// What skinning with all parts misses, in millimetres: root of the mean square, 95th percentile.
    parts_misfit_mm: [f32; 2],
    /// The same with the bones as they were found.
    misfit_mm: [f32; 2],
}

#[derive(Serialize)]
struct BoneReport {
    name: String,
    parent: Option<String>,
    /// In metres, in the rest pose.
    joint: [f32; 3],
    gap_mm: f32,
    /// Vertices that it moves most.
    vertices: usize,
}

/// Estimates a rig, or takes that of a bundle, and writes what is asked for.
pub fn run(arguments: &RigArguments, terminal: &Terminal) -> Result<(), Failure> {
    if let Some(mut reader) = bundle(arguments)?
        && arguments.rig.is_none()
        && arguments.parts.is_none()
        && arguments.toml.is_none()
        && let Some((rest_frame, rig)) = rigged::of_bundle(&mut reader)?
    {
        if let Some(topology) = reader.topology() {
            draw(arguments, &rig, topology)?;
        }
        return print(arguments, &report(rest_frame, None, &rig));
    }
    let file = rigged::read_file(arguments.rig.as_deref())?;
    let (topology, poses, skeleton) = read(arguments, terminal)?;
    let parts = arguments.parts.map(usize::from);
    let found = found_rig((&topology, &poses), skeleton.as_ref(), &file, parts);
    let FoundRig { estimate: found, rig, warning } = found.map_err(|error| Failure::Input(error.into()))?;
    warning.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    draw(arguments, &rig, &topology)?;
    if let Some(path) = &arguments.toml {
        let text = toml::to_string(&RigFile::of(&found)).map_err(|error| Failure::Internal(error.into()))?;
        write_whole(path, text.as_bytes()).map_err(Failure::Input)?;
    }
    let rest_frame = found.keys.first().copied().unwrap_or_default();
    print(arguments, &report(rest_frame, Some(&found), &rig))
}

/// Writes the picture, where one is asked for.
fn draw(arguments: &RigArguments, rig: &Rig, topology: &Topology) -> Result<(), Failure> {
    let Some(path) = &arguments.output else { return Ok(()) };
    let picture =
        rig_picture(rig, topology.triangles(), facing(rig)).map_err(|error| Failure::Internal(error.into()))?;
    write_whole(path, &picture).map_err(Failure::Input)
}

fn print(arguments: &RigArguments, report: &RigReport) -> Result<(), Failure> {
    if arguments.json { print_json(report) } else { print_text(&text(report)) }
}

/// The bundle that was named; `None` where files were.
fn bundle(arguments: &RigArguments) -> Result<Option<BundleReader>, Failure> {
    let [path] = arguments.inputs.as_slice() else { return Ok(None) };
    if !is_bundle(Path::new(path)) {
        return Ok(None);
    }
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {path}")).map_err(Failure::Input)?;
    BundleReader::from_bytes(&bytes).with_context(|| path.clone()).map(Some).map_err(Failure::Input)
}

/// The mesh and all poses of a bundle or of an input, and the skeleton that an input brings.
fn read(arguments: &RigArguments, terminal: &Terminal) -> Result<(Topology, Poses, Option<FileSkeleton>), Failure> {
    if let Some(mut reader) = bundle(arguments)? {
        let (Some(timeline), Some(topology)) = (reader.timeline().cloned(), reader.topology().cloned()) else {
            return Err(Failure::Input(anyhow!("the bundle ends before its mesh is described")));
        };
        let poses = rigged::poses(&mut reader, &timeline, topology.vertex_count())?;
        return Ok((topology, poses, None));
    }
    let progress = |step| terminal.progress(step);
    let imported = import(&arguments.inputs, &import_options(&arguments.import), &Job::new(&progress));
    let imported = imported.map_err(|error| match error {
        ImportError::Stopped(_) => Failure::StoppedReading,
        error => Failure::Input(error.into()),
    })?;
    imported.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    Ok((imported.capture.topology, imported.capture.poses, imported.skeleton))
}

/// The way the body faces in the rest pose: forwards of what is left and right where that is known, +Z where it is not.
fn facing(rig: &Rig) -> Vec2 {
    let joint = |name: &str| rig.bones().iter().find(|bone| bone.name == name).map(|bone| bone.joint.xz());
    let across = [("thigh_l", "thigh_r"), ("upper_arm_l", "upper_arm_r")]
        .into_iter()
        .filter_map(|(left, right)| Some(joint(left)? - joint(right)?))
        .sum::<Vec2>();
    if across == Vec2::ZERO { Vec2::Y } else { Vec2::new(-across.y, across.x) }
}

fn report(rest_frame: u32, found: Option<&Estimate>, rig: &Rig) -> RigReport {
    let mut vertices = vec![0; rig.bones().len()];
    (0..rig.rest().len() as u32).for_each(|vertex| vertices[rig.bone_of(vertex)] += 1);
    let bones = rig.bones().iter().enumerate().map(|(index, bone)| BoneReport {
        name: bone.name.clone(),
        parent: (index > 0).then(|| rig.bones()[bone.parent].name.clone()),
        joint: bone.joint.to_array(),
        gap_mm: 1000.0 * bone.gap,
        vertices: vertices[index],
    });
    let found = found.map(|found| FoundReport {
        human: found.is_human,
        given: found.is_given,
        parts: found.parts,
        keys: found.keys.clone(),
        parts_misfit_mm: found.parts_misfit.map(|off| 1000.0 * off),
        misfit_mm: found.misfit.map(|off| 1000.0 * off),
    });
    RigReport { rest_frame, found, bones: bones.collect() }
}

fn text(report: &RigReport) -> String {
    let frame = report.rest_frame;
    let mut lines = match &report.found {
        None => vec![format!("the rig of the bundle: {} bones; rest pose: frame {frame}", report.bones.len())],
        Some(found) => {
            let kind = if found.human { "a human" } else { "no human that is known: all parts are bones" };
            let (parts, keys) = (found.parts, found.keys.len());
            if found.given {
                let kind = if found.human { "a human" } else { "no human that is known" };
                let off = found.misfit_mm[0];
                vec![
                    format!(
                        "{parts} bones of the file's skeleton, looked at in {keys} key frames; rest pose: frame {frame}; {kind}"
                    ),
                    format!("skinning misses {off:.1} mm (root of the mean square)"),
                ]
            } else {
                vec![
                    format!("{parts} rigid parts from {keys} key frames; rest pose: frame {frame}; {kind}"),
                    format!(
                        "skinning misses {:.1} mm with all parts, {:.1} mm with the bones (root of the mean square)",
                        found.parts_misfit_mm[0], found.misfit_mm[0]
                    ),
                ]
            }
        }
    };
    lines.push(format!("{:14} {:14} {:>24} {:>8} {:>9}", "bone", "hangs on", "joint (m)", "gap (mm)", "vertices"));
    for bone in &report.bones {
        let [x, y, z] = bone.joint;
        let parent = bone.parent.as_deref().unwrap_or("-");
        let joint = format!("{x:.3} {y:.3} {z:.3}");
        lines.push(format!("{:14} {parent:14} {joint:>24} {:8.1} {:9}", bone.name, bone.gap_mm, bone.vertices));
    }
    lines.join("\n")
}
