//! Which sections a bundle must have, and which must come before which so that each can be read when it arrives.

use super::error::BundleError;
use super::header::{Header, Kind};
use super::meta::Meta;

/// Checks the kinds of sections and their order.
pub(super) fn check_order(header: &Header) -> Result<(), BundleError> {
    let mut seen: Vec<(Kind, u32)> = Vec::new();
    for section in &header.sections {
        let Some(kind) = section.kind else { continue };
        if !kind.is_repeated() && section.ordinal != 0 {
            return Err(BundleError::header("numbers a section of which there is only one"));
        }
        let has = |kind: Kind| seen.iter().any(|&(seen, _)| seen == kind);
        if !needs(kind).iter().all(|&needed| has(needed)) {
            return Err(BundleError::header("has a section before another one that it needs"));
        }
        seen.push((kind, section.ordinal));
    }
    seen.sort_unstable();
    if seen.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err(BundleError::header("has the same section twice"));
    }
    for kind in [Kind::Meta, Kind::Surface, Kind::Model, Kind::Graph] {
        if seen.binary_search(&(kind, 0)).is_err() {
            return Err(BundleError::header(format!("has no section {}", kind.name())));
        }
    }
    Ok(())
}

/// Checks that there are as many chunks and images as `meta` declares.
pub(super) fn check_counts(header: &Header, meta: &Meta) -> Result<(), BundleError> {
    for (kind, count) in [(Kind::Geometry, meta.chunks.len()), (Kind::Image, meta.image_count as usize)] {
        let sections = header.sections.iter().filter(|section| section.kind == Some(kind));
        let (mut found, mut in_range) = (0, true);
        for section in sections {
            found += 1;
            in_range &= (section.ordinal as usize) < count;
        }
        // No ordinal occurs twice, so this many in range are all of them.
        if found != count || !in_range {
            let reason = format!("declares another number of {} sections than there are", kind.name());
            return Err(BundleError::section(Kind::Meta, reason));
        }
    }
    Ok(())
}

/// What must have arrived before a section of `kind` can be read.
fn needs(kind: Kind) -> &'static [Kind] {
    match kind {
        Kind::Meta => &[],
        Kind::Surface | Kind::Graph => &[Kind::Meta],
        Kind::Model | Kind::Image | Kind::Order | Kind::FileVertices => &[Kind::Meta, Kind::Surface],
        Kind::Geometry => &[Kind::Meta, Kind::Surface, Kind::Model],
    }
}
