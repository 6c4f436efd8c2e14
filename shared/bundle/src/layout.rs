//! Which sections a bundle must have, and which must come before which so that each can be read when it arrives.

use super::error::BundleError;
use super::header::Header;
use super::kind::Kind;
use super::meta::Meta;

/// Checks the kinds of sections, their numbers and their order.
pub(super) fn check_order(header: &Header) -> Result<(), BundleError> {
    // Linear in the number of sections: a forged header may have many.
    let mut seen = Kind::ALL.map(|kind| (kind, vec![false; count(header, kind)]));
    for (kind, which) in &seen {
        let needed = matches!(*kind, Kind::Meta | Kind::Surface | Kind::Model | Kind::Graph);
        if which.is_empty() && needed || which.len() > 1 && !kind.is_repeated() {
            let reason = format!("has {} sections {}", which.len(), kind.name());
            return Err(BundleError::header(reason));
        }
    }
    for section in &header.sections {
        let Some(kind) = section.kind else { continue };
        let has = |kind: &Kind| seen.iter().any(|(seen, which)| seen == kind && which.contains(&true));
        if !needs(kind).iter().all(has) {
            return Err(BundleError::header("has a section before another one that it needs"));
        }
        let which = seen.iter_mut().find(|(seen, _)| *seen == kind);
        match which.and_then(|(_, which)| which.get_mut(section.ordinal as usize)) {
            Some(arrived) if !*arrived => *arrived = true,
            _ => return Err(BundleError::header("does not number its sections of a kind from 0 up")),
        }
    }
    Ok(())
}

/// Checks that there are as many chunks and images as `meta` declares.
pub(super) fn check_counts(header: &Header, meta: &Meta) -> Result<(), BundleError> {
    for (kind, declared) in [(Kind::Geometry, meta.chunks.len()), (Kind::Image, meta.image_count as usize)] {
        if count(header, kind) != declared {
            let reason = format!("declares another number of {} sections than there are", kind.name());
            return Err(BundleError::section(Kind::Meta, reason));
        }
    }
    Ok(())
}

/// Sections of `kind`.
pub(super) fn count(header: &Header, kind: Kind) -> usize {
    header.sections.iter().filter(|section| section.kind == Some(kind)).count()
}

/// What must have arrived before a section of `kind` can be read.
fn needs(kind: Kind) -> &'static [Kind] {
    match kind {
        Kind::Meta => &[],
        Kind::Surface | Kind::Graph | Kind::Motion | Kind::Contacts | Kind::FilePlace => &[Kind::Meta],
        Kind::Model | Kind::Image | Kind::Order | Kind::FileVertices | Kind::FileFaces => &[Kind::Meta, Kind::Surface],
        Kind::EarlierAppearance | Kind::EarlierNaive | Kind::Appearance | Kind::Naive => &[Kind::Meta, Kind::Surface],
        Kind::Geometry => &[Kind::Meta, Kind::Surface, Kind::Model],
        Kind::EarlierMode => &[Kind::EarlierAppearance],
        Kind::EarlierNaiveMode => &[Kind::EarlierNaive],
        Kind::AppearanceMode => &[Kind::Appearance],
        Kind::NaiveMode => &[Kind::Naive],
    }
}
