//! Which sections a bundle must have, and which must come before which so that each can be read when it arrives.

use super::error::BundleError;
use super::header::Header;
use super::kind::SectionKind;
use super::meta::Meta;

/// Checks the kinds of sections, their numbers and their order.
pub(super) fn check_order(header: &Header) -> Result<(), BundleError> {
    // Linear in the number of sections: a forged header may have many.
    let mut seen = SectionKind::ALL.map(|kind| (kind, vec![false; count(header, kind)]));
    for (kind, which) in &seen {
        let needed =
            matches!(*kind, SectionKind::Meta | SectionKind::Surface | SectionKind::Model | SectionKind::Graph);
        if which.is_empty() && needed || which.len() > 1 && !kind.is_repeated() {
            let reason = format!("has {} sections {}", which.len(), kind.name());
            return Err(BundleError::header(reason));
        }
    }
    for section in &header.sections {
        if seen.iter().any(|(seen, which)| *seen == SectionKind::ScannedGroup && which.contains(&true))
            && section.kind != Some(SectionKind::ScannedGroup)
        {
            // Pages fetch these by themselves, and the rest as one.
            return Err(BundleError::header("has something behind its groups of scanned frames"));
        }
        let Some(kind) = section.kind else { continue };
        let has = |kind: &SectionKind| seen.iter().any(|(seen, which)| seen == kind && which.contains(&true));
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
    for (kind, declared) in
        [(SectionKind::Geometry, meta.chunks.len()), (SectionKind::Image, meta.image_count as usize)]
    {
        if count(header, kind) != declared {
            let reason = format!("declares another number of {} sections than there are", kind.name());
            return Err(BundleError::section(SectionKind::Meta, reason));
        }
    }
    Ok(())
}

/// Sections of `kind`.
pub(super) fn count(header: &Header, kind: SectionKind) -> usize {
    header.sections.iter().filter(|section| section.kind == Some(kind)).count()
}

/// What must have arrived before a section of `kind` can be read.
fn needs(kind: SectionKind) -> &'static [SectionKind] {
    match kind {
        SectionKind::Meta => &[],
        SectionKind::Surface
        | SectionKind::Graph
        | SectionKind::Motion
        | SectionKind::Contacts
        | SectionKind::EarlierContacts
        | SectionKind::Feet
        | SectionKind::Families
        | SectionKind::Turns
        | SectionKind::LearnedSpace
        | SectionKind::Scanned
        | SectionKind::FilePlace => &[SectionKind::Meta],
        SectionKind::Model
        | SectionKind::Image
        | SectionKind::Order
        | SectionKind::Ties
        | SectionKind::Rig
        | SectionKind::EarlierAlternatives
        | SectionKind::Alternatives
        | SectionKind::BodyParts
        | SectionKind::FoundParts
        | SectionKind::FileVertices
        | SectionKind::FileFaces => &[SectionKind::Meta, SectionKind::Surface],
        SectionKind::EarlierAppearance | SectionKind::EarlierNaive | SectionKind::Appearance | SectionKind::Naive => {
            &[SectionKind::Meta, SectionKind::Surface]
        }
        SectionKind::Geometry => &[SectionKind::Meta, SectionKind::Surface, SectionKind::Model],
        SectionKind::EarlierMode => &[SectionKind::EarlierAppearance],
        SectionKind::EarlierNaiveMode => &[SectionKind::EarlierNaive],
        SectionKind::AppearanceMode => &[SectionKind::Appearance],
        SectionKind::NaiveMode => &[SectionKind::Naive],
        SectionKind::ScannedGroup => &[SectionKind::Meta, SectionKind::Scanned],
    }
}
