//! What several tests share: captured poses and comparisons.
#![allow(dead_code, reason = "each test binary uses its part")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

pub mod exact;
pub mod ground;
pub mod meshes;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, OnceLock};

use glam::{DVec3, Vec3, Vec3Swizzles};
use shared::align::{Placement, align_heading, centre_of_mass};
use shared::topology::{Topology, barycentric_areas};

/// Topology and the poses of the asked frames (counted from 0) of a captured sequence; `None`, with a sentence, where the
/// captures are not at hand.
pub fn captured(name: &str, frames: &[usize]) -> Option<(Topology, Vec<Vec<Vec3>>)> {
    let folder = unpacked(name)?;
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut triangles = Vec::new();
    let poses = frames
        .iter()
        .map(|&frame| {
            let (pose, faces) = read_obj(&files[frame]);
            triangles = faces;
            pose
        })
        .collect::<Vec<_>>();
    let weights = barycentric_areas(&triangles, &poses[0]);
    Some((Topology::new(poses[0].len() as u32, triangles, weights).unwrap(), poses))
}

/// The folder that a capture was unpacked into, once per test binary.
fn unpacked(name: &str) -> Option<PathBuf> {
    static ROOT: OnceLock<tempfile::TempDir> = OnceLock::new();
    static UNPACKING: Mutex<()> = Mutex::new(());
    let archive = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../shared/data/captured/{name}.tar.xz"));
    if !archive.exists() {
        assert!(std::env::var_os("CI").is_none(), "{} is required where CI is set", archive.display());
        println!("skipped: {} is not here", archive.display());
        return None;
    }
    let root = ROOT.get_or_init(|| tempfile::tempdir().unwrap()).path();
    let folder = root.join(name);
    let _one_at_a_time = UNPACKING.lock().unwrap();
    if !folder.exists() {
        let status = Command::new("tar").arg("-xJf").arg(&archive).arg("-C").arg(root).status().unwrap();
        assert!(status.success(), "tar could not unpack {}", archive.display());
    }
    Some(folder)
}

fn read_obj(path: &Path) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let text = std::fs::read_to_string(path).unwrap();
    let (mut pose, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let [x, y, z] = [0; 3].map(|_: i32| words.next().unwrap().parse().unwrap());
                pose.push(Vec3::new(x, y, z));
            }
            Some("f") => {
                let corner = |word: &str| word.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                triangles.push([0; 3].map(|_: i32| corner(words.next().unwrap())));
            }
            _ => {}
        }
    }
    (pose, triangles)
}

/// `moving`, turned and moved to lie best on `fixed`.
pub fn aligned(topology: &Topology, fixed: &[Vec3], moving: &[Vec3]) -> Vec<Vec3> {
    let heading = align_heading(fixed, moving, topology.weights());
    let [from, to] = [moving, fixed].map(|pose| centre_of_mass(pose, topology.weights()));
    let mut out = moving.to_vec();
    Placement::turning(heading, from.xz(), to.xz()).apply_all(&mut out);
    out
}

/// Largest distance between corresponding vertices.
pub fn largest_difference(a: &[Vec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.as_dvec3().distance(*b)).fold(0.0, f64::max)
}
