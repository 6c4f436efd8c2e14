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

#[cfg(test)]
mod tests {
    use super::*;

    /// Streams made by the library that the extension comes from, with what its decoder makes of them; `README.md` beside
    /// the file says how.
    fn samples() -> Vec<(Layout, Vec<u8>, Vec<u8>)> {
        let all = include_bytes!("../../tests/data/meshopt/streams.bin");
        let mut rest = all.as_slice();
        let mut samples = Vec::new();
        while !rest.is_empty() {
            let (head, tail) = rest.split_at(12);
            let word = |at: usize| u32::from_le_bytes(head[at..at + 4].try_into().unwrap()) as usize;
            let (stride, count, length) = (usize::from(u16::from_le_bytes([head[2], head[3]])), word(4), word(8));
            let mode = [Mode::Attributes, Mode::Triangles, Mode::Indices][usize::from(head[0])];
            let filters = [Filter::None, Filter::Octahedral, Filter::Quaternion, Filter::Exponential, Filter::Colour];
            let layout = Layout { count, stride, mode, filter: filters[usize::from(head[1])] };
            let (stream, tail) = tail.split_at(length);
            let (bytes, tail) = tail.split_at(count * stride);
            samples.push((layout, stream.to_vec(), bytes.to_vec()));
            rest = tail;
        }
        samples
    }

    /// Numbers that the text lets differ by one in their last place.
    fn close(layout: Layout, a: &[u8], b: &[u8]) -> bool {
        let differ_by_one = |a: i32, b: i32, whole: i32| [0, 1, whole - 1].contains(&(a - b).rem_euclid(whole));
        match (layout.filter, layout.stride) {
            (Filter::None | Filter::Exponential, _) => a == b,
            (_, 4) => a.iter().zip(b).all(|(&a, &b)| differ_by_one(a.into(), b.into(), 256)),
            _ => a.chunks(2).zip(b.chunks(2)).all(|(a, b)| {
                differ_by_one(u16::from_le_bytes([a[0], a[1]]).into(), u16::from_le_bytes([b[0], b[1]]).into(), 65536)
            }),
        }
    }

    #[test]
    fn decodes_as_the_first_decoder_does() {
        let samples = samples();
        assert_eq!(samples.len(), 25);
        for (k, (layout, stream, bytes)) in samples.iter().enumerate() {
            let found = decode(stream, *layout).unwrap_or_else(|e| panic!("stream {k}, {layout:?}: {e}"));
            assert!(close(*layout, &found, bytes), "stream {k}, {layout:?}");
        }
    }

    #[test]
    fn damage_is_refused_or_decodes_to_as_many_bytes() {
        for (layout, stream, _) in samples() {
            for length in 0..stream.len() {
                // Where the last bytes are padding, what is left may still be whole; as a rule it is not.
                if let Ok(bytes) = decode(&stream[..length], layout) {
                    assert_eq!(bytes.len(), layout.count * layout.stride);
                }
            }
            let mut damaged = stream.clone();
            for at in 0..stream.len() {
                for flip in [1, 0x80, 0xff] {
                    damaged[at] ^= flip;
                    if let Ok(bytes) = decode(&damaged, layout) {
                        assert_eq!(bytes.len(), layout.count * layout.stride);
                    }
                    damaged[at] = stream[at];
                }
            }
            // Counts that no stream of this size could hold cost no memory.
            for count in [usize::MAX / 3, 3 << 40, layout.count.next_multiple_of(3) * 3 + 300] {
                assert!(decode(&stream, Layout { count: count / 3 * 3, ..layout }).is_err(), "{layout:?}");
            }
        }
    }

    #[test]
    fn layouts_follow_the_rules() {
        let layout = |stride, mode, filter| Layout { count: 3, stride, mode, filter };
        for wrong in [
            layout(6, Mode::Attributes, Filter::None),
            layout(260, Mode::Attributes, Filter::None),
            layout(0, Mode::Attributes, Filter::None),
            layout(3, Mode::Triangles, Filter::None),
            layout(4, Mode::Indices, Filter::Exponential),
            layout(12, Mode::Attributes, Filter::Octahedral),
            layout(4, Mode::Attributes, Filter::Quaternion),
            Layout { count: 4, ..layout(4, Mode::Triangles, Filter::None) },
        ] {
            assert!(matches!(decode(&[], wrong), Err(MeshoptError::Layout(_))), "{wrong:?}");
        }
    }
}
