//! `builder rig`.

use std::path::Path;

use actor::capture::Poses;
use anyhow::{Context, anyhow};
use bundle::BundleReader;
use capture_io::export::rig_picture;
use capture_io::import::{ImportError, import};
use editing::Rig;
use glam::{Vec2, Vec3Swizzles};
use job::Job;
use kernels::topology::Topology;
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
    /// Whether it was taken for a human's.
    human: bool,
    /// Rigid parts that were found.
    parts: usize,
    /// Key frames, the rest pose first.
    keys: Vec<u32>,
    /// What skinning with all parts misses, in millimetres: root of the mean square, 95th percentile.
    parts_misfit_mm: [f32; 2],
    /// The same with the bones as they were found.
    misfit_mm: [f32; 2],
    /// The bones, as corrected.
    bones: Vec<BoneReport>,
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

/// Estimates a rig and writes what is asked for.
pub fn run(arguments: &RigArguments, terminal: &Terminal) -> Result<(), Failure> {
    let file = rigged::read_file(arguments.rig.as_deref())?;
    let (topology, poses) = read(arguments, terminal)?;
    let parts = arguments.parts.map(usize::from);
    let (found, rig) =
        rigged::corrected(&topology, &poses, &file, parts).map_err(|error| Failure::Input(error.into()))?;
    if let Some(path) = &arguments.output {
        let picture =
            rig_picture(&rig, topology.triangles(), facing(&rig)).map_err(|error| Failure::Internal(error.into()))?;
        write_whole(path, &picture).map_err(Failure::Input)?;
    }
    if let Some(path) = &arguments.toml {
        let text = toml::to_string(&RigFile::of(&found)).map_err(|error| Failure::Internal(error.into()))?;
        write_whole(path, text.as_bytes()).map_err(Failure::Input)?;
    }
    let report = report(&found, &rig);
    if arguments.json { print_json(&report) } else { print_text(&text(&report)) }
}

/// The mesh and all poses of a bundle or of an input.
fn read(arguments: &RigArguments, terminal: &Terminal) -> Result<(Topology, Poses), Failure> {
    if let [path] = arguments.inputs.as_slice()
        && is_bundle(Path::new(path))
    {
        let bytes = std::fs::read(path).with_context(|| format!("cannot read {path}")).map_err(Failure::Input)?;
        let mut reader = BundleReader::from_bytes(&bytes).with_context(|| path.clone()).map_err(Failure::Input)?;
        let (Some(timeline), Some(topology)) = (reader.timeline().cloned(), reader.topology().cloned()) else {
            return Err(Failure::Input(anyhow!("{path} ends before its mesh is described")));
        };
        let poses = rigged::poses(&mut reader, &timeline, topology.vertex_count())?;
        return Ok((topology, poses));
    }
    let progress = |step| terminal.progress(step);
    let imported = import(&arguments.inputs, &import_options(&arguments.import), &Job::new(&progress));
    let imported = imported.map_err(|error| match error {
        ImportError::Stopped(_) => Failure::StoppedReading,
        error => Failure::Input(error.into()),
    })?;
    imported.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    Ok((imported.capture.topology, imported.capture.poses))
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

fn report(found: &Estimate, rig: &Rig) -> RigReport {
    let mut vertices = vec![0; rig.bones().len()];
    (0..rig.rest().len() as u32).for_each(|vertex| vertices[rig.bone_of(vertex)] += 1);
    let bones = rig.bones().iter().enumerate().map(|(index, bone)| BoneReport {
        name: bone.name.clone(),
        parent: (index > 0).then(|| rig.bones()[bone.parent].name.clone()),
        joint: bone.joint.to_array(),
        gap_mm: 1000.0 * bone.gap,
        vertices: vertices[index],
    });
    RigReport {
        human: found.is_human,
        parts: found.parts,
        keys: found.keys.clone(),
        parts_misfit_mm: found.parts_misfit.map(|off| 1000.0 * off),
        misfit_mm: found.misfit.map(|off| 1000.0 * off),
        bones: bones.collect(),
    }
}

fn text(report: &RigReport) -> String {
    let kind = if report.human { "a human" } else { "no human that is known: all parts are bones" };
    let mut lines = vec![
        format!(
            "{} rigid parts from {} key frames; rest pose: frame {}; {kind}",
            report.parts,
            report.keys.len(),
            report.keys.first().copied().unwrap_or_default()
        ),
        format!(
            "skinning misses {:.1} mm with all parts, {:.1} mm with the bones (root of the mean square)",
            report.parts_misfit_mm[0], report.misfit_mm[0]
        ),
        format!("{:14} {:14} {:>24} {:>8} {:>9}", "bone", "hangs on", "joint (m)", "gap (mm)", "vertices"),
    ];
    for bone in &report.bones {
        let [x, y, z] = bone.joint;
        let parent = bone.parent.as_deref().unwrap_or("-");
        let joint = format!("{x:.3} {y:.3} {z:.3}");
        lines.push(format!("{:14} {parent:14} {joint:>24} {:8.1} {:9}", bone.name, bone.gap_mm, bone.vertices));
    }
    lines.join("\n")
}
