//! Inflating compressed buffer views.

use std::collections::HashMap;

use super::document::Document;
use super::views::{Compressed, extension, read};
use crate::import::error::ImportError;
use crate::import::meshopt::decode;

/// Bytes of all inflated views of a file.
const MAX_BYTES: usize = 1 << 31;

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
