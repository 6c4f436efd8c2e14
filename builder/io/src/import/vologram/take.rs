//! A vologram that is found: its frames, and what of it is read.

use std::path::{Path, PathBuf};

use super::super::error::ImportError;
use super::super::folder::list;
use super::super::images::is_image;
use super::super::layers::TextureLayer;
use super::super::paths::{ending, folder_of};
use super::super::warning::Warning;
use super::file::FrameFile;
use super::header::{self, Header, Pictures};
use super::{FRAME, header_beside, name, sequences_beside, wrong};

/// A vologram as its header describes it.
pub(in super::super) struct Vologram {
    pub name: String,
    /// A name for each frame, see [`super::frame_at`].
    pub frames: Vec<PathBuf>,
    pub fps: Option<f32>,
    /// The texture of each frame; empty where the file holds none that is read.
    pub layers: Vec<TextureLayer>,
    pub warnings: Vec<Warning>,
}

impl Vologram {
    /// Reads the header that `path` is or that lies beside it, and finds the frames.
    pub fn read(path: &Path) -> Result<Self, ImportError> {
        let header_path = if header::read(path).is_ok() { path.to_owned() } else { header_beside(path)? };
        let header = header::read(&header_path).map_err(|reason| wrong(&header_path, reason))?;
        let alone = FrameFile::open(&header_path, &header)?.holds_frames();
        let files = if alone { vec![header_path.clone()] } else { sequences_beside(&header_path)? };
        let mut frames = Vec::new();
        for file in &files {
            let count = FrameFile::open(file, &header)?.count()?;
            frames.extend((0..count).map(|number| file.join(format!("{FRAME}{number:05}"))));
        }
        if frames.len() != header.frame_count as usize {
            return Err(wrong(
                &header_path,
                format!(
                    "says that there are {} frames, and there are {}: fetch it again",
                    header.frame_count,
                    frames.len()
                ),
            ));
        }
        Ok(Self {
            name: name(&header_path),
            fps: header.fps,
            layers: layers(&frames, &header),
            warnings: left_out(&header_path, &header),
            frames,
        })
    }
}

#[cfg(feature = "gltf")]
fn layers(frames: &[PathBuf], header: &Header) -> Vec<TextureLayer> {
    if header.pictures != Pictures::Basis {
        return Vec::new();
    }
    frames.iter().map(|path| TextureLayer { path: path.clone(), layer: 0, lowest_first: false }).collect()
}

#[cfg(not(feature = "gltf"))]
fn layers(_: &[PathBuf], _: &Header) -> Vec<TextureLayer> {
    Vec::new()
}

/// What of a vologram is not read.
fn left_out(path: &Path, header: &Header) -> Vec<Warning> {
    let shown = path.display();
    let mut warnings = Vec::new();
    if header.sound {
        warnings.push(Warning::new("W_VOLS_LEFT_OUT", format!("{shown}: its sound is left out")));
    }
    if header.placed {
        let message = format!("{shown}: how its header moves, turns and scales the body is left out");
        warnings.push(Warning::new("W_VOLS_LEFT_OUT", message));
    }
    match header.pictures {
        Pictures::Other(what) => warnings.push(Warning::new(
            "W_VOLS_LEFT_OUT",
            format!(
                "{shown}: its textures are {what}, which is not read: write them as images, one a frame, beside it"
            ),
        )),
        Pictures::Basis if cfg!(not(feature = "gltf")) => warnings.push(Warning::new(
            "W_VOLS_LEFT_OUT",
            format!("{shown}: its textures are left out, for this program was compiled without glTF"),
        )),
        Pictures::Basis => {}
        Pictures::None => warnings.extend(video_beside(path)),
    }
    warnings
}

/// The video with the textures, which has to be unpacked first, unless that was done.
fn video_beside(path: &Path) -> Option<Warning> {
    let entries = list(folder_of(path)).ok()?;
    let video = entries.iter().find(|entry| matches!(ending(entry).as_str(), "mp4" | "webm" | "mov"))?;
    let unpacked = entries.iter().any(|entry| is_image(entry));
    (!unpacked).then(|| {
        Warning::new(
            "W_VOLS_VIDEO",
            format!(
                "{}: its textures are a video, which is not read, so that there are no colours: ffmpeg -i {} -start_number 0 \
                 {} writes them as images beside it",
                path.display(),
                video.display(),
                folder_of(path).join("texture_%05d.png").display()
            ),
        )
    })
}
