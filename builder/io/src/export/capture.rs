//! A capture as a folder that [`import`](crate::import::import) reads: a binary PLY file and a texture a frame, and a manifest.
//!
//! All is written into a folder beside the one that is asked for, which takes that name when the capture is whole.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{Vec2, Vec3};
use image::ExtendedColorType;

use super::error::ExportError;
use crate::png;

/// A folder under way.
#[derive(Debug)]
pub struct CaptureWriter {
    out: PathBuf,
    beside: tempfile::TempDir,
    /// All that comes after the vertices in a PLY file; the same for all frames.
    faces: Vec<u8>,
    triangles: usize,
}

/// A part of a sequence, as the manifest names it.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenSequence {
    /// Its name.
    pub name: String,
    /// Its labels.
    pub labels: Vec<String>,
    /// Whether its end meets its beginning, where that is known.
    pub cyclic: Option<bool>,
    /// The number under which its frames were written.
    pub number: usize,
    /// Its first frame and its last.
    pub frames: (usize, usize),
}

/// What the manifest says.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenCapture {
    /// Name of the subject.
    pub name: String,
    /// Frames per second.
    pub fps: f32,
    /// Whether frames have textures.
    pub textures: bool,
    /// Whether the masks of what no camera saw are to be heeded.
    pub masks: bool,
    /// The sequences.
    pub sequences: Vec<WrittenSequence>,
}

impl CaptureWriter {
    /// Begins a capture that will be the folder `out`, which must not exist or be empty. `uvs` are of the corners of `triangles`,
    /// v downwards; `sequences` says how many there are.
    ///
    /// # Errors
    /// A folder that is in use, or cannot be made.
    pub fn new(out: &Path, triangles: &[[u32; 3]], uvs: &[[Vec2; 3]], sequences: usize) -> Result<Self, ExportError> {
        if out.read_dir().is_ok_and(|mut entries| entries.next().is_some()) || out.is_file() {
            let cause = std::io::Error::other("it is not empty: name a new folder, or empty it first");
            return Err(ExportError::Write { file: out.to_owned(), cause });
        }
        let parent = out.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        fs::create_dir_all(parent).map_err(ExportError::write(parent))?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".partial-");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o755));
        let beside = builder.tempdir_in(parent).map_err(ExportError::write(parent))?;
        let mut faces = Vec::with_capacity(triangles.len() * 38);
        for (triangle, uvs) in triangles.iter().zip(uvs) {
            faces.push(3);
            faces.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
            faces.push(6);
            // PLY counts v upwards.
            faces.extend(uvs.iter().flat_map(|uv| [uv.x, 1.0 - uv.y]).flat_map(f32::to_le_bytes));
        }
        let writer = Self { out: out.to_owned(), beside, faces, triangles: triangles.len() };
        for sequence in 0..sequences {
            let folder = writer.folder(sequence);
            fs::create_dir_all(&folder).map_err(ExportError::write(&folder))?;
        }
        Ok(writer)
    }

    fn folder(&self, sequence: usize) -> PathBuf {
        self.beside.path().join(format!("{sequence:03}"))
    }

    /// Writes the pose of a frame.
    ///
    /// # Errors
    /// What the file system says.
    pub fn frame(&self, sequence: usize, frame: usize, pose: &[Vec3]) -> Result<(), ExportError> {
        let mut file = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float \
             z\nelement face {}\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n",
            pose.len(),
            self.triangles
        )
        .into_bytes();
        file.extend(pose.iter().flat_map(Vec3::to_array).flat_map(f32::to_le_bytes));
        file.extend(&self.faces);
        let path = self.folder(sequence).join(format!("frame_{frame:05}.ply"));
        fs::write(&path, file).map_err(ExportError::write(&path))
    }

    /// Writes the texture of a frame, `size` by `size` texels, and the mask of those that no camera saw.
    ///
    /// # Errors
    /// What the file system says.
    pub fn texture(
        &self,
        sequence: usize,
        frame: usize,
        size: usize,
        texels: &[[u8; 3]],
        unseen: &[u32],
    ) -> Result<(), ExportError> {
        let path = self.folder(sequence).join(format!("texture_{frame:05}.png"));
        self.png(&path, size, texels.as_flattened(), ExtendedColorType::Rgb8)?;
        let mut mask = vec![0; size * size];
        unseen.iter().for_each(|&k| mask[k as usize] = 255);
        self.png(&self.folder(sequence).join(format!("unseen_{frame:05}.png")), size, &mask, ExtendedColorType::L8)
    }

    /// Reads back the texture of a frame.
    ///
    /// # Errors
    /// A frame that was not written, or cannot be read.
    pub fn written_texture(&self, sequence: usize, frame: usize) -> Result<Vec<[u8; 3]>, ExportError> {
        let file = self.folder(sequence).join(format!("texture_{frame:05}.png"));
        let bytes = fs::read(&file).map_err(ExportError::write(&file))?;
        let image = image::load_from_memory(&bytes).map_err(|cause| ExportError::Picture { file, cause })?;
        Ok(image.to_rgb8().pixels().map(|pixel| pixel.0).collect())
    }

    fn png(&self, path: &Path, size: usize, texels: &[u8], colour: ExtendedColorType) -> Result<(), ExportError> {
        let file = png::encode(texels, [size as u32; 2], colour)
            .map_err(|cause| ExportError::Picture { file: path.to_owned(), cause })?;
        fs::write(path, file).map_err(ExportError::write(path))
    }

    /// Writes another file into the folder.
    ///
    /// # Errors
    /// What the file system says.
    pub fn file(&self, name: &str, bytes: &[u8]) -> Result<(), ExportError> {
        let path = self.beside.path().join(name);
        fs::write(&path, bytes).map_err(ExportError::write(&path))
    }

    /// Writes the manifest and gives the folder its name; the manifest's path.
    ///
    /// # Errors
    /// What the file system says; nothing is at the folder's name then.
    pub fn finish(self, capture: &WrittenCapture) -> Result<PathBuf, ExportError> {
        self.file("capture.toml", manifest(capture).as_bytes())?;
        // An empty folder may be there already.
        if self.out.is_dir() {
            fs::remove_dir(&self.out).map_err(ExportError::write(&self.out))?;
        }
        fs::rename(self.beside.path(), &self.out).map_err(ExportError::write(&self.out))?;
        // It is not there any more under its own name.
        let _ = self.beside.keep();
        Ok(self.out.join("capture.toml"))
    }
}

fn manifest(capture: &WrittenCapture) -> String {
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let mut text = format!("name = {}\nfps = {}\nup = \"y\"\nunit = 1.0\n", quoted(&capture.name), capture.fps);
    for WrittenSequence { name, labels, cyclic, number, frames: (first, last) } in &capture.sequences {
        let labels: Vec<String> = labels.iter().map(|label| quoted(label)).collect();
        let _ = write!(
            text,
            "\n[[sequence]]\nname = {}\ninput = \"{number:03}/frame_%05d.ply:{first}:{last}\"\nlabels = [{}]\n",
            quoted(name),
            labels.join(", ")
        );
        if let Some(cyclic) = cyclic {
            let _ = writeln!(text, "cyclic = {cyclic}");
        }
        if capture.textures {
            let _ = writeln!(text, "texture = \"{number:03}/texture_%05d.png:{first}:{last}\"");
        }
        if capture.textures && capture.masks {
            let _ = writeln!(text, "mask = \"{number:03}/unseen_%05d.png:{first}:{last}\"");
        }
    }
    text
}
