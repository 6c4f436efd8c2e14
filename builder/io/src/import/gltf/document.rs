//! A glTF file opened: its JSON, and the bytes of its buffers.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use gltf::json::{self, Index, Root, Value, buffer};

use super::animation_json::AnimationJson;
use super::container::{data_uri, percent_decoded, split};
use super::views;
use crate::import::error::ImportError;
use crate::import::images::read_file;

/// The JSON and the buffers of a glTF file.
///
/// The `gltf` crate reads the JSON; its own accessor reader and validation are left aside, for they refuse quantised
/// meshes and may panic on indices out of range. So every index is looked up with a check here. Animations are taken
/// out beforehand: the crate refuses channels without a node, which the format allows.
pub(super) struct Document {
    path: PathBuf,
    root: Root,
    animations: Vec<AnimationJson>,
    /// The bytes of each buffer; none where a compressed file leaves its uncompressed twin out.
    buffers: Vec<Option<Vec<u8>>>,
    /// Buffer views that were compressed.
    inflated: HashMap<usize, Vec<u8>>,
}

impl Document {
    /// The same with the bytes of its compressed buffer views, by their index.
    pub fn with_inflated(self, inflated: HashMap<usize, Vec<u8>>) -> Self {
        Self { inflated, ..self }
    }

    /// Opens a `.glb` or `.gltf` file and the buffers beside it; compressed views are yet to be inflated.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let wrong = |reason: String| ImportError::Gltf { path: path.to_owned(), reason };
        let no_json = |e: json::Error| wrong(format!("not glTF JSON: {e}"));
        let (text, blob) = split(read_file(path)?, path)?;
        let mut json: Value = json::deserialize::from_slice(&text).map_err(no_json)?;
        drop(text);
        let animations = json.as_object_mut().and_then(|object| object.remove("animations"));
        let animations = animations.map_or(Ok(Vec::new()), json::deserialize::from_value).map_err(no_json)?;
        let root: Root = json::deserialize::from_value(json).map_err(no_json)?;
        if !root.asset.version.starts_with("2.") {
            return Err(wrong(format!("glTF version {}, only 2 is read", root.asset.version)));
        }
        let (buffers, inflated) = (Vec::new(), HashMap::new());
        let mut document = Self { path: path.to_owned(), root, animations, buffers, inflated };
        document.buffers = document.load_buffers(blob)?;
        Ok(document)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The JSON, without its animations.
    pub fn root(&self) -> &Root {
        &self.root
    }

    /// The animations.
    pub fn animations(&self) -> &[AnimationJson] {
        &self.animations
    }

    /// Whether the file cannot be read without `extension`.
    pub fn requires(&self, extension: &str) -> bool {
        self.root.extensions_required.iter().any(|required| required == extension)
    }

    /// An error about this file.
    pub fn wrong(&self, reason: impl Into<String>) -> ImportError {
        ImportError::Gltf { path: self.path.clone(), reason: reason.into() }
    }

    /// The object that `index` names; `user` says who asks.
    pub fn get<T>(&self, index: Index<T>, what: &str, user: &str) -> Result<&T, ImportError>
    where
        Root: json::root::Get<T>,
    {
        self.root.get(index).ok_or_else(|| self.wrong(format!("{user} names {what} {index}, which does not exist")))
    }

    /// The bytes of a buffer view, inflated where it is compressed.
    pub fn view(&self, index: Index<buffer::View>, user: &str) -> Result<&[u8], ImportError> {
        if let Some(bytes) = self.inflated.get(&index.value()) {
            return Ok(bytes);
        }
        let view = self.get(index, "buffer view", user)?;
        let user = format!("buffer view {index}");
        self.slice(view.buffer.value(), view.byte_offset.unwrap_or_default().0, view.byte_length.0, &user)
    }

    /// Bytes of a buffer.
    pub fn slice(&self, buffer: usize, offset: u64, length: u64, user: &str) -> Result<&[u8], ImportError> {
        let buffer_bytes = self.buffers.get(buffer);
        let buffer_bytes =
            buffer_bytes.ok_or_else(|| self.wrong(format!("{user} names a buffer that is not there")))?;
        let Some(bytes) = buffer_bytes else {
            return Err(self.wrong(format!("buffer {buffer}, which {user} names, has no bytes in this file")));
        };
        let start = usize::try_from(offset).ok();
        let range = start.zip(usize::try_from(length).ok()).and_then(|(start, n)| Some(start..start.checked_add(n)?));
        range.and_then(|range| bytes.get(range)).ok_or_else(|| ImportError::Truncated {
            path: self.path.clone(),
            reason: format!("{user} reaches beyond its buffer of {} bytes", bytes.len()),
        })
    }

    /// Bytes in all buffers and inflated views.
    pub fn buffer_bytes(&self) -> usize {
        self.buffers.iter().flatten().chain(self.inflated.values()).map(Vec::len).sum()
    }

    /// The bytes that a URI stands for: a data URI, or a file beside this one.
    pub fn fetch(&self, uri: &str, user: &str) -> Result<Vec<u8>, ImportError> {
        if let Some(data) = strip_scheme(uri, "data:") {
            return data_uri(data).map_err(|reason| self.wrong(format!("{user}: {reason}")));
        }
        if uri.contains("://") {
            return Err(self.wrong(format!("{user} lies on the network ({uri}): save it beside the file")));
        }
        read_file(&self.beside(uri))
    }

    /// The file that a relative URI names; this file where the URI holds its data itself.
    pub fn beside(&self, uri: &str) -> PathBuf {
        if strip_scheme(uri, "data:").is_some() {
            return self.path.clone();
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        // A file may truly be named "a%20b": the name as it stands is tried where the decoded one does not exist.
        let decoded = folder.join(percent_decoded(uri));
        let literal = folder.join(uri);
        if !decoded.exists() && literal.exists() { literal } else { decoded }
    }

    fn load_buffers(&self, mut blob: Option<Vec<u8>>) -> Result<Vec<Option<Vec<u8>>>, ImportError> {
        let twins = views::uncompressed_twins(&self.root);
        let mut buffers = Vec::new();
        for (index, buffer) in self.root.buffers.iter().enumerate() {
            let user = format!("buffer {index}");
            let bytes = match &buffer.uri {
                _ if twins.contains(&index) => None,
                Some(uri) => Some(self.fetch(uri, &user)?),
                None => blob.take(),
            };
            let length = bytes.as_ref().map(|bytes| bytes.len() as u64);
            if let Some(length) = length.filter(|&length| length < buffer.byte_length.0) {
                let reason = format!("{user} has {length} of {} bytes", buffer.byte_length.0);
                return Err(ImportError::Truncated { path: self.path.clone(), reason });
            }
            buffers.push(bytes);
        }
        Ok(buffers)
    }
}

/// What follows the scheme of a URI, whose letters may be large or small.
fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let (start, rest) = uri.split_at_checked(scheme.len())?;
    start.eq_ignore_ascii_case(scheme).then_some(rest)
}
