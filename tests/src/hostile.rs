//! Bytes that nobody vouches for, given to whatever reads them as a newcomer's file or a stranger's link would be.
//!
//! The fuzz targets in `fuzz/` call these with what they make up; `tests/tests/findings.rs` with the seeds, and with whatever
//! they ever stumbled over. Each returns whether the bytes were accepted; a panic is a fault.

use job::Job;
use std::path::Path;

use actor::pose_source::PoseSource;
use bundle::{BundleReader, validate};
use capture_io::import::{ImportOptions, import};
use glam::Vec3;
use search::Request;

/// Frames of a made-up bundle that are read.
const FRAMES: u32 = 40;

/// A bundle: opened, validated, and played. Its checksums are mended first, or nothing else would ever be looked at.
#[must_use]
pub fn bundle(bytes: &[u8]) -> bool {
    let bytes = &checksummed(bytes);
    let _ = validate(bytes);
    let Ok(mut reader) = BundleReader::from_bytes(bytes) else { return false };
    let count = reader.topology().map_or(0, |topology| topology.vertex_count());
    let mut pose = vec![Vec3::ZERO; count];
    for frame in 0..reader.timeline().map_or(0, |timeline| timeline.frame_count()).min(FRAMES) {
        let _ = reader.read(frame, &mut pose);
    }
    true
}

/// The bytes of a bundle with the length and the checksums that they should have (docs/bundle-format.md).
fn checksummed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let length = bytes.len() as u64;
    let Some(header) = bytes.get(..48) else { return bytes };
    let number = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let (end, sections) = (number(12) as usize, number(16) as usize);
    for entry in (0..sections.min(4096)).map(|k| 48 + 40 * k) {
        let Some(place) = bytes.get(entry + 8..entry + 24) else { break };
        let [offset, stored] = [0, 8].map(|at| place[at..at + 8].iter().rev().fold(0, |n, &b| n << 8 | usize::from(b)));
        let Some(content) = bytes.get(offset..offset.saturating_add(stored)) else { continue };
        let checksum = crc32fast::hash(content).to_le_bytes();
        if let Some(slot) = bytes.get_mut(entry + 32..entry + 36) {
            slot.copy_from_slice(&checksum);
        }
    }
    bytes[20..28].copy_from_slice(&length.to_le_bytes());
    bytes[28..32].fill(0);
    let checksum = crc32fast::hash(bytes.get(..end).unwrap_or_default()).to_le_bytes();
    bytes[28..32].copy_from_slice(&checksum);
    bytes
}

/// A glTF file in one piece.
#[must_use]
pub fn glb(bytes: &[u8]) -> bool {
    alone("capture.glb", bytes)
}

/// A glTF file as text.
#[must_use]
pub fn gltf(bytes: &[u8]) -> bool {
    alone("capture.gltf", bytes)
}

/// An OBJ file, and its material library behind the first NUL.
#[must_use]
pub fn obj(bytes: &[u8]) -> bool {
    let at = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    let (mesh, library) = bytes.split_at(at);
    read(&[("frame_0.obj", mesh), ("looks.mtl", library.get(1..).unwrap_or_default())])
}

/// A PLY file.
#[must_use]
pub fn ply(bytes: &[u8]) -> bool {
    alone("frame_0.ply", bytes)
}

/// A manifest beside two frames.
#[must_use]
pub fn manifest(bytes: &[u8]) -> bool {
    let frame = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    read(&[("capture.toml", bytes), ("a/frame_0.obj", frame), ("a/frame_1.obj", frame)])
}

/// What is asked of the actor, as JSON.
#[must_use]
pub fn request(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let Ok(request) = Request::from_json(text) else { return false };
    // What was understood is understood again.
    assert_eq!(Request::from_json(&request.to_json()).as_ref(), Ok(&request));
    true
}

fn alone(name: &str, bytes: &[u8]) -> bool {
    read(&[(name, bytes)])
}

/// Imports a folder of these files.
fn read(files: &[(&str, &[u8])]) -> bool {
    let Ok(folder) = tempfile::tempdir() else { return false };
    for (name, bytes) in files {
        let path = folder.path().join(name);
        let made = path.parent().is_none_or(|parent: &Path| std::fs::create_dir_all(parent).is_ok());
        if !made || std::fs::write(path, bytes).is_err() {
            return false;
        }
    }
    import(&[folder.path().display().to_string()], &ImportOptions::default(), &Job::silent()).is_ok()
}
