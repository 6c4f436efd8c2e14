//! Buffer views that are compressed: `EXT_meshopt_compression` and `KHR_meshopt_compression`.

use std::collections::HashSet;

use gltf::json::{Root, Value, buffer};

use crate::import::meshopt::{Filter, Layout, Mode};

/// The two names of the extension, which differ only in what a stream may hold.
const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// What the extension says of a view.
pub(super) struct Compressed {
    pub buffer: usize,
    pub offset: u64,
    pub length: u64,
    pub layout: Layout,
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

pub(super) fn extension(view: &buffer::View) -> Option<&Value> {
    let extensions = &view.extensions.as_ref()?.others;
    NAMES.iter().find_map(|&name| extensions.get(name))
}

pub(super) fn read(extension: &Value) -> Result<Compressed, String> {
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
