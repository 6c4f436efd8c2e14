//! What a glTF file is wrapped in: GLB chunks, data URIs, percent signs.

use std::path::Path;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use crate::import::error::ImportError;

/// Base64 with or without `=` at its end: some exporters leave it out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The JSON text of a `.glb` or `.gltf` file, and the binary chunk of a GLB.
pub(super) fn split(bytes: Vec<u8>, path: &Path) -> Result<(Vec<u8>, Option<Vec<u8>>), ImportError> {
    if bytes.starts_with(b"glTF") {
        let (json, blob) = chunks(&bytes, path)?;
        return Ok((text(json).to_vec(), blob.map(<[u8]>::to_vec)));
    }
    Ok((text(&bytes).to_vec(), None))
}

/// JSON without a byte order mark before it and without what pads it: spaces by the rules, zeros from some exporters.
fn text(json: &[u8]) -> &[u8] {
    let mut json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    while let [rest @ .., 0 | b' ' | b'\n' | b'\r' | b'\t'] = json {
        json = rest;
    }
    json
}

/// The JSON chunk and the binary chunk of a GLB; chunks of other kinds are passed over, as the format asks.
fn chunks<'a>(bytes: &'a [u8], path: &Path) -> Result<(&'a [u8], Option<&'a [u8]>), ImportError> {
    let truncated = |reason: String| ImportError::Truncated { path: path.to_owned(), reason };
    let wrong = |reason: String| ImportError::Gltf { path: path.to_owned(), reason };
    let word = |at: usize| bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes);
    let Some((version, length)) = word(4).zip(word(8)) else {
        return Err(truncated("the GLB header is not complete".into()));
    };
    if version != 2 {
        return Err(wrong(format!("GLB version {version}, only 2 is read")));
    }
    if u64::from(length) > bytes.len() as u64 {
        return Err(truncated(format!("{} of {length} bytes", bytes.len())));
    }
    let (mut json, mut blob) = (None, None);
    let mut at = 12;
    // A file may end behind its last chunk, or have up to three bytes of padding there.
    while let Some((size, kind)) = word(at).zip(word(at + 4)) {
        let size = size as usize;
        let chunk = (at + 8).checked_add(size).and_then(|end| bytes.get(at + 8..end));
        let chunk = chunk.ok_or_else(|| truncated(format!("a GLB chunk of {size} bytes reaches beyond the file")))?;
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if blob.is_none() => blob = Some(chunk),
            _ => {}
        }
        at += 8 + size.next_multiple_of(4);
    }
    Ok((json.ok_or_else(|| wrong("the GLB container has no JSON chunk".into()))?, blob))
}

/// The bytes of what follows `data:` in a URI; an error is a sentence without a place.
pub(super) fn data_uri(data: &str) -> Result<Vec<u8>, String> {
    let Some((kind, text)) = data.split_once(',') else { return Err("the data URI has no data".into()) };
    if !kind.ends_with(";base64") {
        return Err("the data URI is not base64".into());
    }
    // Long texts are wrapped by some writers; others use the alphabet of URLs.
    let letter = |byte: u8| match byte {
        b'-' => b'+',
        b'_' => b'/',
        _ => byte,
    };
    let compact: Vec<u8> = text.bytes().filter(|b| !b.is_ascii_whitespace()).map(letter).collect();
    BASE64.decode(compact).map_err(|e| format!("the data URI is damaged: {e}"))
}

/// A relative URI as the name of a file.
pub(super) fn percent_decoded(uri: &str) -> String {
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
    use super::*;

    #[test]
    fn decodes_percent_signs() {
        assert_eq!(percent_decoded("a%20b%C3%A4.bin"), "a bä.bin");
        assert_eq!(percent_decoded("100%"), "100%");
        assert_eq!(percent_decoded("%zz%4"), "%zz%4");
    }

    #[test]
    fn base64_comes_padded_or_not_and_wrapped() {
        for data in
            ["application/octet-stream;base64,AQL/+w==", "a/b;base64,AQL/+w", ";base64,AQ\r\n L/\n+w", ";base64,AQL_-w"]
        {
            assert_eq!(data_uri(data).unwrap(), [1, 2, 255, 251], "{data}");
        }
        assert!(data_uri("text/plain,abc").is_err() && data_uri("a;base64,###").is_err() && data_uri("a").is_err());
    }
}
