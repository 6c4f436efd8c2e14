//! Buffer views that are compressed: `EXT_meshopt_compression` and `KHR_meshopt_compression`.

use std::collections::{HashMap, HashSet};

use gltf::json::{Root, Value, buffer};

use super::document::Document;
use crate::import::error::ImportError;
use crate::import::meshopt::{Filter, Layout, Mode, decode};

/// The two names of the extension, which differ only in what a stream may hold.
const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
/// Bytes of all inflated views of a file.
const MAX_BYTES: usize = 1 << 31;

/// What the extension says of a view.
struct Compressed {
    buffer: usize,
    offset: u64,
    length: u64,
    layout: Layout,
}

/// Buffers that only say how large the uncompressed data would be, or hold it a second time; they are not read.
pub(super) fn uncompressed_twins(root: &Root) -> HashSet<usize> {
    let mut compressed = HashSet::new();
    let mut plain = HashSet::new();
    for view in &root.buffer_views {
        match extension(view) {
            Some(extension) => {
                compressed.insert(view.buffer.value());
                plain.extend(extension.get("buffer").and_then(Value::as_u64).map(|buffer| buffer as usize));
            }
            None => drop(plain.insert(view.buffer.value())),
        }
    }
    compressed.difference(&plain).copied().collect()
}

/// The bytes of all compressed views, by the view's index.
pub(super) fn inflate_all(document: &Document) -> Result<HashMap<usize, Vec<u8>>, ImportError> {
    let mut inflated = HashMap::new();
    let mut total = 0_usize;
    for (index, view) in document.root().buffer_views.iter().enumerate() {
        let Some(extension) = extension(view) else { continue };
        let user = format!("buffer view {index}");
        let wrong = |reason: String| document.wrong(format!("{user}: {reason}"));
        let Compressed { buffer, offset, length, layout } = read(extension).map_err(wrong)?;
        let stream = document.slice(buffer, offset, length, &format!("compressed {user}"))?;
        total = total.saturating_add(layout.count.saturating_mul(layout.stride));
        if total > MAX_BYTES {
            let reason = format!("the compressed buffer views hold more than {MAX_BYTES} bytes");
            return Err(ImportError::TooLarge { path: document.path().to_owned(), reason });
        }
        let bytes = decode(stream, layout).map_err(|error| wrong(error.to_string()))?;
        if view.byte_stride.is_some_and(|stride| stride.0 != layout.stride) || view.byte_length.0 > bytes.len() as u64 {
            return Err(wrong("its shape is not that of its compressed stream".into()));
        }
        inflated.insert(index, bytes);
    }
    Ok(inflated)
}

fn extension(view: &buffer::View) -> Option<&Value> {
    let extensions = &view.extensions.as_ref()?.others;
    NAMES.iter().find_map(|&name| extensions.get(name))
}

fn read(extension: &Value) -> Result<Compressed, String> {
    let number = |key: &str| extension.get(key).and_then(Value::as_u64);
    let needed = |key: &str| number(key).ok_or_else(|| format!("its compression has no {key}"));
    let word = |key: &str| extension.get(key).and_then(Value::as_str);
    let mode = match word("mode") {
        Some("ATTRIBUTES") => Mode::Attributes,
        Some("TRIANGLES") => Mode::Triangles,
        Some("INDICES") => Mode::Indices,
        other => return Err(format!("the compression mode {} is not read", other.unwrap_or("(none)"))),
    };
    let filter = match word("filter") {
        None | Some("NONE") => Filter::None,
        Some("OCTAHEDRAL") => Filter::Octahedral,
        Some("QUATERNION") => Filter::Quaternion,
        Some("EXPONENTIAL") => Filter::Exponential,
        Some("COLOR") => Filter::Colour,
        Some(other) => return Err(format!("the compression filter {other} is not read")),
    };
    let size = |value: u64| usize::try_from(value).unwrap_or(usize::MAX);
    Ok(Compressed {
        buffer: size(needed("buffer")?),
        offset: number("byteOffset").unwrap_or(0),
        length: needed("byteLength")?,
        layout: Layout { count: size(needed("count")?), stride: size(needed("byteStride")?), mode, filter },
    })
}
