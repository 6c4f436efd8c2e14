//! A glTF file opened: its JSON, and the bytes of its buffers.

use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::binary::Glb;
use gltf::json::{self, Index, Root};

use crate::import::error::ImportError;
use crate::import::images::read_file;

/// Extensions that may be required: those that change nothing here, or that are read.
const READ: [&str; 4] = ["KHR_mesh_quantization", "KHR_texture_transform", "EXT_texture_webp", "KHR_lights_punctual"];
/// Extensions that compress geometry.
const COMPRESSIONS: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The JSON and the buffers of a glTF file.
///
/// The `gltf` crate reads JSON and container; its own accessor reader and validation are left aside, for they refuse
/// quantised meshes and may panic on indices out of range. So every index is looked up with a check here.
pub(super) struct Document {
    path: PathBuf,
    root: Root,
    buffers: Vec<Vec<u8>>,
}

impl Document {
    /// Opens a `.glb` or `.gltf` file and the buffers beside it.
    pub fn open(path: &Path) -> Result<Self, ImportError> {
        let wrong = |reason: String| ImportError::Gltf { path: path.to_owned(), reason };
        let bytes = read_file(path)?;
        let (json, blob) = if bytes.starts_with(b"glTF") { split_glb(&bytes, path)? } else { (bytes, None) };
        let root: Root = json::deserialize::from_slice(&json).map_err(|e| wrong(format!("not glTF JSON: {e}")))?;
        drop(json);
        if !root.asset.version.starts_with("2.") {
            return Err(wrong(format!("glTF version {}, only 2 is read", root.asset.version)));
        }
        check_extensions(&root, path)?;
        let mut document = Self { path: path.to_owned(), root, buffers: Vec::new() };
        document.buffers = document.load_buffers(blob)?;
        Ok(document)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The JSON.
    pub fn root(&self) -> &Root {
        &self.root
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

    /// The bytes of a buffer view.
    pub fn view(&self, index: Index<json::buffer::View>, user: &str) -> Result<&[u8], ImportError> {
        let view = self.get(index, "buffer view", user)?;
        let buffer = self.buffers.get(view.buffer.value());
        let buffer =
            buffer.ok_or_else(|| self.wrong(format!("buffer view {index} names a buffer that is not there")))?;
        let start = usize::try_from(view.byte_offset.unwrap_or_default().0).ok();
        let length = usize::try_from(view.byte_length.0).ok();
        let range = start.zip(length).and_then(|(start, length)| Some(start..start.checked_add(length)?));
        range.and_then(|range| buffer.get(range)).ok_or_else(|| ImportError::Truncated {
            path: self.path.clone(),
            reason: format!("buffer view {index} reaches beyond its buffer of {} bytes", buffer.len()),
        })
    }

    /// Bytes in all buffers.
    pub fn buffer_bytes(&self) -> usize {
        self.buffers.iter().map(Vec::len).sum()
    }

    /// The bytes that a URI stands for: a data URI, or a file beside this one.
    pub fn fetch(&self, uri: &str, user: &str) -> Result<Vec<u8>, ImportError> {
        if let Some(data) = uri.strip_prefix("data:") {
            let text = data.split_once(";base64,").map(|(_, text)| text);
            let text = text.ok_or_else(|| self.wrong(format!("{user}: the data URI is not base64")))?;
            return STANDARD
                .decode(text.trim())
                .map_err(|e| self.wrong(format!("{user}: the data URI is damaged: {e}")));
        }
        if uri.contains("://") {
            return Err(self.wrong(format!("{user} lies on the network ({uri}): save it beside the file")));
        }
        read_file(&self.beside(uri))
    }

    /// The file that a relative URI names.
    pub fn beside(&self, uri: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(percent_decoded(uri))
    }

    /// A buffer without bytes: where the file uses compression, it stands in for what a decoder would write.
    fn missing_buffer(&self, user: &str) -> ImportError {
        match compression(&self.root.extensions_used) {
            Some(extension) => ImportError::Compressed { path: self.path.clone(), extension: extension.clone() },
            None => self.wrong(format!("{user} has no bytes in this file")),
        }
    }

    fn load_buffers(&self, mut blob: Option<Vec<u8>>) -> Result<Vec<Vec<u8>>, ImportError> {
        let buffers = self.root.buffers.iter().enumerate();
        buffers
            .map(|(index, buffer)| {
                let user = format!("buffer {index}");
                let bytes = match &buffer.uri {
                    Some(uri) => self.fetch(uri, &user)?,
                    None => blob.take().ok_or_else(|| self.missing_buffer(&user))?,
                };
                if (bytes.len() as u64) < buffer.byte_length.0 {
                    let reason = format!("{user} has {} of {} bytes", bytes.len(), buffer.byte_length.0);
                    return Err(ImportError::Truncated { path: self.path.clone(), reason });
                }
                Ok(bytes)
            })
            .collect()
    }
}

/// The extension by which a file says that it is compressed, if it does.
fn compression(extensions: &[String]) -> Option<&String> {
    extensions.iter().find(|extension| COMPRESSIONS.contains(&extension.as_str()))
}

fn split_glb(bytes: &[u8], path: &Path) -> Result<(Vec<u8>, Option<Vec<u8>>), ImportError> {
    let truncated = |reason: String| ImportError::Truncated { path: path.to_owned(), reason };
    let length = bytes.get(8..12).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    // The crate subtracts the header from the length without a check.
    match length {
        Some(length) if (12..=bytes.len() as u64).contains(&u64::from(length)) => {}
        Some(length) => return Err(truncated(format!("{} of {length} bytes", bytes.len()))),
        None => return Err(truncated("the GLB header is not complete".into())),
    }
    let glb = Glb::from_slice(bytes)
        .map_err(|e| ImportError::Gltf { path: path.to_owned(), reason: format!("not a GLB container: {e}") })?;
    Ok((glb.json.into_owned(), glb.bin.map(std::borrow::Cow::into_owned)))
}

fn check_extensions(root: &Root, path: &Path) -> Result<(), ImportError> {
    if let Some(extension) = compression(&root.extensions_required) {
        return Err(ImportError::Compressed { path: path.to_owned(), extension: extension.clone() });
    }
    for extension in &root.extensions_required {
        let path = path.to_owned();
        if !READ.contains(&extension.as_str()) && !extension.starts_with("KHR_materials_") {
            return Err(ImportError::Extension { path, extension: extension.clone() });
        }
    }
    Ok(())
}

fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let code = tail.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) if first == b'%' => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::percent_decoded;

    #[test]
    fn decodes_percent_signs() {
        assert_eq!(percent_decoded("a%20b%C3%A4.bin"), "a bä.bin");
        assert_eq!(percent_decoded("100%"), "100%");
        assert_eq!(percent_decoded("%zz%4"), "%zz%4");
    }
}
