//! A mesh that changes within a capture: where, and how often.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::error::ImportError;
use super::frames::read_frame;
use super::gltf::GltfFile;
use super::mesh::FaceList;
use super::plan::PlannedSequence;

/// Frames named in a message.
const NAMED: usize = 6;

/// `error`, where it is about a frame with another mesh, with what the other frames of `sequence` are like: `paths` are
/// read once more for it. Other errors stay as they are.
pub(super) fn explained(mut error: ImportError, sequence: &PlannedSequence, paths: &[PathBuf]) -> ImportError {
    if let ImportError::VertexCount { frame, more, .. } | ImportError::FaceList { frame, more, .. } = &mut error {
        *more = if *frame == 0 {
            format!("; sequence \"{}\" has another mesh than the first sequence", sequence.name)
        } else {
            told(&sequence.name, paths)
        };
    }
    error
}

fn told(name: &str, paths: &[PathBuf]) -> String {
    let meshes: Vec<Option<u64>> = paths.par_iter().map(|path| mesh_of(path)).collect();
    let changes: Vec<usize> = (1..meshes.len()).filter(|&k| meshes[k] != meshes[k - 1]).collect();
    let frames = meshes.len();
    let like_first = meshes.iter().filter(|mesh| **mesh == meshes[0]).count();
    if 2 * changes.len() >= frames {
        return format!("; almost every one of the {frames} frames of sequence \"{name}\" has a mesh of its own");
    }
    let named: Vec<String> = changes.iter().take(NAMED).map(usize::to_string).collect();
    let rest = if changes.len() > NAMED { format!(" and {} more", changes.len() - NAMED) } else { String::new() };
    format!(
        "; in sequence \"{name}\" the mesh changes at frame {}{rest}, and {like_first} of {frames} frames have that of the \
         first",
        named.join(", ")
    )
}

/// A number for the mesh of a file; `None` where it cannot be read.
fn mesh_of(path: &Path) -> Option<u64> {
    let number = |vertices: usize, faces: &FaceList| {
        let mut hasher = DefaultHasher::new();
        (vertices, &faces.sizes, &faces.vertices).hash(&mut hasher);
        hasher.finish()
    };
    if let Ok(frame) = read_frame(path) {
        return Some(number(frame.positions.len(), &frame.faces));
    }
    let file = GltfFile::open(path).ok()?;
    Some(number(file.mesh().vertex_count, &file.mesh().faces))
}
