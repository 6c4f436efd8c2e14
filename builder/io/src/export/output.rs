//! What is written, and under which names.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::ExportError;
use job::files;

/// Where a walk is written; the name says the format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// One animated GLB.
    Glb(PathBuf),
    /// A numbered OBJ a frame, with materials and textures beside them; of each frame, where they change.
    Obj(FramePattern),
    /// A numbered PLY a frame, with the textures beside them.
    Ply(FramePattern),
    /// A numbered picture a frame, from a camera that turns about the actor.
    Png(FramePattern),
}

/// Names of numbered frames: a folder, and what comes before and after the number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    /// The folder.
    pub folder: PathBuf,
    /// Before the number.
    pub before: String,
    /// Least digits of the number.
    pub digits: usize,
    /// After the number.
    pub after: String,
}

impl Output {
    /// Reads what was typed: `walk.glb`, or a pattern such as `frames/%05d.ply`.
    ///
    /// # Errors
    /// A name that says no format.
    pub fn parse(text: &str) -> Result<Self, ExportError> {
        let wrong = || ExportError::Format(text.into());
        let path = Path::new(text);
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("").to_ascii_lowercase();
        if extension == "glb" {
            return Ok(Self::Glb(path.to_owned()));
        }
        if !matches!(extension.as_str(), "obj" | "ply" | "png") {
            return Err(wrong());
        }
        let pattern = FramePattern::parse(path).ok_or_else(|| ExportError::NoNumber(text.into()))?;
        match extension.as_str() {
            "obj" => Ok(Self::Obj(pattern)),
            "ply" => Ok(Self::Ply(pattern)),
            "png" => Ok(Self::Png(pattern)),
            _ => Err(wrong()),
        }
    }
}

impl FramePattern {
    /// A name with one `%d` or `%05d` in its last part.
    fn parse(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let (before, rest) = name.split_once('%')?;
        let (digits, after) = rest.split_once('d')?;
        let plain = digits.is_empty() || digits.starts_with('0') && digits.len() <= 2;
        if !plain || !digits.bytes().all(|digit| digit.is_ascii_digit()) || after.contains('%') {
            return None;
        }
        Some(Self {
            folder: path.parent().map(Path::to_owned).unwrap_or_default(),
            before: before.into(),
            digits: digits.parse().unwrap_or(1),
            after: after.into(),
        })
    }

    /// The file of a frame.
    #[must_use]
    pub fn file(&self, frame: u32) -> PathBuf {
        self.folder.join(format!("{}{frame:0digits$}{}", self.before, self.after, digits = self.digits))
    }

    /// The file of a frame with another ending than its own, which may begin with more of the name: `_texture.png`.
    pub(super) fn companion(&self, frame: u32, ending: &str) -> String {
        let rest = self.after.rsplit_once('.').map_or("", |(rest, _)| rest);
        format!("{}{frame:0digits$}{rest}{ending}", self.before, digits = self.digits)
    }

    /// The name of a file that belongs to all frames.
    pub(super) fn beside(&self, name: &str) -> String {
        let joint = if self.before.ends_with(char::is_alphanumeric) { "_" } else { "" };
        format!("{}{joint}{name}", self.before)
    }

    /// Makes the folder.
    pub(super) fn make_folder(&self) -> Result<(), ExportError> {
        if self.folder.as_os_str().is_empty() {
            return Ok(());
        }
        fs::create_dir_all(&self.folder).map_err(ExportError::write(&self.folder))
    }
}

/// Writes `bytes` to `file`, all of them or none.
pub(super) fn write_whole(file: &Path, bytes: &[u8]) -> Result<(), ExportError> {
    files::write_whole(file, bytes).map_err(ExportError::write(file))
}
