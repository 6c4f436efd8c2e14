//! Volograms (`.vols`): a header, then frames of which only some, the keyframes, say how their vertices are joined.
//!
//! Everything may lie in one file, or the header in one (`header.vols`) and the frames in another (`sequence_0.vols`). Versions
//! 1.0 to 1.3 of the format are read. A frame is named as if its file were a folder: `take.vols/frame_00012`, so that frames
//! are files to everything behind this.

mod file;
mod frame;
mod header;
pub(super) mod take;

use std::path::{Path, PathBuf};

use self::file::FrameFile;
use self::header::Header;
use super::error::ImportError;
use super::folder::list;
use super::mesh::MeshFile;
use super::paths::{ending, folder_of, name_of_folder, stem};

/// What the names of frames begin with.
const FRAME: &str = "frame_";
/// Names of headers that say nothing about the motion.
const DULL_NAMES: [&str; 5] = ["header", "hdr", "sequence", "sequence_0", "vologram"];

/// What a file's ending says that it may be (part of) a vologram.
pub(super) fn may_be(path: &Path) -> bool {
    matches!(ending(path).as_str(), "vols" | "vol")
}

/// Whether `path` is a file that begins like a header, with frames behind it or without.
pub(super) fn is_header(path: &Path) -> bool {
    may_be(path) && path.is_file() && header::read(path).is_ok()
}

/// The file and the number of the frame that `path` names; `None` where it names a file.
pub(super) fn frame_at(path: &Path) -> Option<(&Path, usize)> {
    let file = path.parent().filter(|file| may_be(file))?;
    let number = path.file_name()?.to_str()?.strip_prefix(FRAME)?.parse().ok()?;
    Some((file, number))
}

/// The folder that a frame lies in, whether it is a file or part of one.
pub(super) fn folder_of_frame(path: &Path) -> &Path {
    folder_of(frame_at(path).map_or(path, |(file, _)| file))
}

/// Reads the mesh of a frame.
pub(super) fn read_frame(file: &Path, number: usize) -> Result<MeshFile, ImportError> {
    let header = header_of(file)?;
    let (frame, key) = FrameFile::open(file, &header)?.frame(number)?;
    frame::parse(&frame, &key, &header).map_err(|reason| wrong(file, format!("frame {number}: {reason}")))
}

/// The texture that a frame holds, as a file of its own would.
#[cfg(feature = "gltf")]
pub(super) fn texture_bytes(file: &Path, number: usize) -> Result<Vec<u8>, ImportError> {
    let header = header_of(file)?;
    let (frame, _) = FrameFile::open(file, &header)?.frame(number)?;
    let texture = frame::arrays(&frame, &header).and_then(|arrays| {
        arrays.texture.filter(|bytes| !bytes.is_empty()).map(<[u8]>::to_vec).ok_or_else(|| "it has no texture".into())
    });
    texture.map_err(|reason: String| wrong(file, format!("frame {number}: {reason}")))
}

/// The header of the frames in `file`: its own, or that of the file beside it.
fn header_of(file: &Path) -> Result<Header, ImportError> {
    if let Ok(header) = header::read(file) {
        return Ok(header);
    }
    let path = header_beside(file)?;
    header::read(&path).map_err(|reason| wrong(&path, reason))
}

/// The header that belongs to the frames in `file`: named like it, or the only one of its folder.
fn header_beside(file: &Path) -> Result<PathBuf, ImportError> {
    let reason = header::read(file).err().unwrap_or_default();
    let headers: Vec<PathBuf> =
        list(folder_of(file))?.into_iter().filter(|path| path != file && is_header(path)).collect();
    let alike = headers.iter().find(|path| key(path) == key(file));
    match (alike, headers.as_slice()) {
        (Some(header), _) | (None, [header]) => Ok(header.clone()),
        (None, []) => Err(wrong(file, format!("{reason}, and no header (header.vols) lies beside it"))),
        (None, _) => {
            Err(wrong(file, format!("{reason}, and several headers lie beside it: name the one that belongs to it")))
        }
    }
}

/// The files of frames that belong to a header without any: those that are named like it, or all of its folder.
fn sequences_beside(header: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let files: Vec<PathBuf> = list(folder_of(header))?
        .into_iter()
        .filter(|path| may_be(path) && path.is_file() && header::read(path).is_err())
        .collect();
    let alike: Vec<PathBuf> = files.iter().filter(|path| key(path) == key(header)).cloned().collect();
    let mut files = if alike.is_empty() { files } else { alike };
    files.sort_by(|a, b| super::numbered::natural(&a.to_string_lossy(), &b.to_string_lossy()));
    if files.is_empty() {
        return Err(wrong(header, "holds no frames, and no file of frames (sequence_0.vols) lies beside it".into()));
    }
    Ok(files)
}

/// What the names of a header and of its frames share: `cone` of `cone_hdr.vol` and `cone_seq.vol`.
fn key(path: &Path) -> String {
    let name = stem(path).to_ascii_lowercase();
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_' || c == '-');
    let cut = ["header", "hdr", "sequence", "seq"].iter().find_map(|word| name.strip_suffix(word));
    cut.unwrap_or(name).trim_end_matches(['_', '-']).to_owned()
}

/// What a vologram is called: the name of the file `header`, or of its folder where that says more.
pub(super) fn name(header: &Path) -> String {
    let name = stem(header);
    if DULL_NAMES.contains(&name.to_ascii_lowercase().as_str()) {
        let folder = name_of_folder(folder_of(header));
        return if folder.is_empty() { name } else { folder };
    }
    let lower = name.to_ascii_lowercase();
    let cut = ["header", "hdr"].iter().find_map(|word| lower.strip_suffix(word));
    let start = cut.and_then(|start| name.get(..start.trim_end_matches(['_', '-']).len()));
    start.filter(|start| !start.is_empty()).unwrap_or(&name).to_owned()
}

fn wrong(path: &Path, reason: String) -> ImportError {
    ImportError::Binary { path: path.to_owned(), reason }
}
