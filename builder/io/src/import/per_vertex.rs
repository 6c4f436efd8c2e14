//! Text files with one number per vertex of the mesh files: weights, and parts of the body.

use std::path::Path;

use super::error::ImportError;
use super::images::read_file;
use super::text::{Continues, for_each_line, number, without_comment};

/// A weight for each of the file vertices `kept`: not negative.
pub(super) fn weights(path: &Path, file_vertices: usize, kept: &[u32]) -> Result<Vec<f32>, ImportError> {
    let wrong = |reason: String| ImportError::Weights { path: path.to_owned(), reason };
    let mut weights = Vec::new();
    read(path, |line, number| {
        let weight = number as f32;
        if !(weight >= 0.0 && weight.is_finite()) {
            return Err(wrong(format!("line {line}: a weight of {weight}")));
        }
        weights.push(weight);
        Ok(())
    })?;
    if weights.len() != file_vertices {
        return Err(wrong(format!("{} weights for {file_vertices} vertices", weights.len())));
    }
    Ok(kept.iter().map(|&v| weights[v as usize]).collect())
}

/// The part's number of each of the file vertices `kept`: 0 to 255.
pub(super) fn parts(path: &Path, file_vertices: usize, kept: &[u32]) -> Result<Vec<u8>, ImportError> {
    let wrong = |reason: String| ImportError::Parts { path: path.to_owned(), reason };
    let mut parts = Vec::new();
    read(path, |line, number| {
        if !(number.fract() == 0.0 && (0.0..=255.0).contains(&number)) {
            return Err(wrong(format!("line {line}: a part of the number {number}")));
        }
        parts.push(number as u8);
        Ok(())
    })?;
    if parts.len() != file_vertices {
        return Err(wrong(format!("{} numbers for {file_vertices} vertices", parts.len())));
    }
    Ok(kept.iter().map(|&v| parts[v as usize]).collect())
}

/// Tells all numbers of a text file, with the lines that they are on. What follows a # is a comment.
fn read(path: &Path, mut tell: impl FnMut(usize, f64) -> Result<(), ImportError>) -> Result<(), ImportError> {
    for_each_line(
        &read_file(path)?,
        |_| Continues::Always,
        |line, text| {
            let mut words = without_comment(text).split_ascii_whitespace();
            words.try_for_each(|word| tell(line, number(path, line, word)?))
        },
    )
}
