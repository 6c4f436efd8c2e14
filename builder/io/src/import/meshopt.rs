//! Meshopt compression: byte streams of glTF buffer views, as the extensions `EXT_meshopt_compression` and
//! `KHR_meshopt_compression` define them. Written from their texts, whose appendices A and B are cited here.
//!
//! A stream says nothing about its own length or shape: [`Layout`] comes from the JSON beside it.

mod attributes;
mod filters;
mod indices;

use thiserror::Error;

/// What a stream holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Elements of any kind, coded byte by byte against their predecessors (appendix A, mode 0).
    Attributes,
    /// Indices of a list of triangles (mode 1).
    Triangles,
    /// Any other indices (mode 2).
    Indices,
}

/// What is done with attributes after they are decoded (appendix B).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filter {
    /// Nothing.
    None,
    /// Unit vectors on an octahedron.
    Octahedral,
    /// Unit quaternions without their largest component.
    Quaternion,
    /// Floats as mantissa and exponent.
    Exponential,
    /// Colours as luma and chroma (`KHR_meshopt_compression` only).
    Colour,
}

/// The shape of a decoded stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Number of elements.
    pub count: usize,
    /// Bytes of an element.
    pub stride: usize,
    /// What the elements are.
    pub mode: Mode,
    /// The filter over attributes.
    pub filter: Filter,
}

/// Why a stream cannot be decoded.
#[derive(Debug, Error, PartialEq, Eq)]
pub(super) enum MeshoptError {
    /// The JSON describes no possible stream.
    #[error("{0}")]
    Layout(&'static str),
    /// The first byte is not the mode's.
    #[error("the stream begins with byte {0:#04x}, which is no meshopt stream of this mode")]
    Header(u8),
    /// The stream ends before its elements do.
    #[error("the compressed stream is too short for its {0} elements")]
    Short(usize),
    /// Bytes are left over behind the last element.
    #[error("{0} bytes of the compressed stream are left over")]
    LeftOver(usize),
    /// A code that the format does not allow.
    #[error("{0}")]
    Code(&'static str),
}

/// Decodes `stream` to `layout.count * layout.stride` bytes.
///
/// No more memory is reserved than 1,024 times the stream's own size, which is as far as the coding reaches.
///
/// # Errors
/// A layout that the format forbids, and a stream that does not hold exactly that layout.
pub(super) fn decode(stream: &[u8], layout: Layout) -> Result<Vec<u8>, MeshoptError> {
    check(layout)?;
    let mut bytes = match layout.mode {
        Mode::Attributes => attributes::decode(stream, layout.count, layout.stride)?,
        Mode::Triangles => indices::narrow(&indices::triangles(stream, layout.count)?, layout.stride),
        Mode::Indices => indices::narrow(&indices::sequence(stream, layout.count)?, layout.stride),
    };
    filters::apply(&mut bytes, layout.filter, layout.stride);
    Ok(bytes)
}

/// The rules of the section "JSON schema updates".
fn check(layout: Layout) -> Result<(), MeshoptError> {
    let Layout { count, stride, mode, filter } = layout;
    let stride_fits = match mode {
        Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
        Mode::Triangles | Mode::Indices => stride == 2 || stride == 4,
    };
    let filter_fits = match filter {
        Filter::None => true,
        _ if mode != Mode::Attributes => false,
        Filter::Octahedral | Filter::Colour => stride == 4 || stride == 8,
        Filter::Quaternion => stride == 8,
        Filter::Exponential => true,
    };
    if !stride_fits {
        return Err(MeshoptError::Layout("byteStride does not fit the mode"));
    }
    if !filter_fits {
        return Err(MeshoptError::Layout("the filter does not fit the mode or byteStride"));
    }
    if mode == Mode::Triangles && !count.is_multiple_of(3) {
        return Err(MeshoptError::Layout("the count is no whole number of triangles"));
    }
    Ok(())
}
