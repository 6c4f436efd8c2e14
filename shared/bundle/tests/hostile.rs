//! Damaged, cut off and forged bundles: a typed error or the same content, never a panic, a loop or a flood of memory.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

mod captures;
mod forge;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use actor::files::Files;
use actor::graph::TURN_STEP;
use actor::pose_source::PoseSource;
use bundle::{BundleError, BundleInput, BundleReader, SectionKind, Severity, VERSION_MAJOR, encode_with_rig, validate};
use captures::{cloth, feet, graph, rig, ties};
use forge::{Section, assembled, meta_of, raw_sections};
use glam::Vec3;
use proptest::prelude::*;

/// Remembers the largest single block that was asked for.
struct Watched;

static LARGEST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.fetch_max(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static WATCHED: Watched = Watched;

/// Nothing that these few kilobytes say may ask for a larger block.
const LARGEST_BLOCK: usize = 32 << 20;

fn small_bundle() -> Vec<u8> {
    let capture = cloth(4, 3, &[5, 3]);
    let feet = feet(capture.topology.vertex_count(), &capture.timeline);
    let graph = graph(&capture.timeline).with_feet(feet).with_ties(ties(&capture.topology));
    let turns: Vec<f32> = (0..graph.transitions().len()).map(|index| (index % 100) as f32 * TURN_STEP).collect();
    let graph = graph.with_turns(&turns);
    let order: Vec<u32> = (0..21).rev().collect();
    let generator = "reprise test".into();
    let poisson_order = Some(&order[..]);
    let input =
        BundleInput { capture: &capture, graph: &graph, first_frame: 6, max_error: 0.001, poisson_order, generator };
    encode_with_rig(&input, &[], &Files::default(), Some(&rig(21, 2))).unwrap().0
}

/// Everything that a player would ask of `bytes`: no call may panic.
fn use_all(bytes: &[u8]) -> Result<Vec<Vec3>, BundleError> {
    let mut reader = BundleReader::from_bytes(bytes)?;
    let count = reader.topology().map_or(0, |topology| topology.vertex_count());
    let mut pose = vec![Vec3::ZERO; count];
    let mut all = Vec::new();
    for frame in 0..reader.timeline().map_or(0, |timeline| timeline.frame_count()).min(300) {
        if reader.read(frame, &mut pose).is_ok() {
            all.extend_from_slice(&pose);
        }
    }
    Ok(all)
}

#[test]
fn every_truncation_is_said_so() {
    let bytes = small_bundle();
    for length in 0..bytes.len() {
        let error = BundleReader::from_bytes(&bytes[..length]).unwrap_err();
        assert!(
            matches!(error, BundleError::Truncated { received, .. } if received == length as u64),
            "{length}: {error}"
        );
    }
}

#[test]
fn every_changed_byte_is_noticed_or_harmless() {
    let mut bytes = small_bundle();
    let intact = use_all(&bytes).unwrap();
    for position in 0..bytes.len() {
        let original = bytes[position];
        // All values where it is cheap (the header), all single bits everywhere.
        let values: Vec<u8> =
            if position < 100 { (0..=255).collect() } else { (0..8).map(|bit| original ^ 1 << bit).collect() };
        for value in values.into_iter().filter(|&value| value != original) {
            bytes[position] = value;
            match use_all(&bytes) {
                Ok(read) => assert_eq!(read, intact, "byte {position} as {value}"),
                Err(error) => assert_eq!(matches!(error, BundleError::NotOurs), position < 8, "{position}: {error}"),
            }
        }
        bytes[position] = original;
    }
}

#[test]
fn errors_are_told_apart() {
    let bytes = small_bundle();
    let error_of = |position: usize, value: u8| {
        let mut changed = bytes.clone();
        changed[position] = value;
        BundleReader::from_bytes(&changed).unwrap_err()
    };
    assert_eq!(error_of(0, b'P'), BundleError::NotOurs);
    assert_eq!(error_of(8, 2), BundleError::TooNew { major: VERSION_MAJOR + 1 });
    assert!(matches!(error_of(40, 1), BundleError::Damaged { kind: None, .. }));
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    for section in &reader.header().unwrap().sections {
        let middle = (section.offset + section.stored / 2) as usize;
        match error_of(middle, bytes[middle] ^ 0x10) {
            BundleError::Damaged { kind, ordinal, expected, found } => {
                assert_eq!((kind, ordinal, expected), (section.kind, section.ordinal, section.checksum));
                assert_ne!(expected, found);
            }
            other => panic!("{other}"),
        }
    }
    assert_eq!(validate(&bytes[..60])[0].code, "truncated");
    assert_eq!(validate(b"PK\x03\x04 something else")[0].code, "not-reprise");
}

#[test]
fn unknown_sections_are_skipped_only_if_they_may_be() {
    let sections = raw_sections(&small_bundle());
    let unknown = |may_be_skipped| Section { number: 63, may_be_skipped, ordinal: 0, raw: vec![7; 100] };
    for place in 0..=sections.len() {
        let mut with = sections.clone();
        with.insert(place, unknown(true));
        let bytes = assembled(&with);
        assert_eq!(use_all(&bytes), use_all(&small_bundle()));
        let findings = validate(&bytes);
        assert_eq!((findings[0].code, findings[0].severity), ("skipped-section", Severity::Note));
        with[place] = unknown(false);
        assert_eq!(use_all(&assembled(&with)), Err(BundleError::UnknownSection { kind: 63 }));
    }
}

#[test]
fn sections_must_be_there_once_and_in_order() {
    let sections = raw_sections(&small_bundle());
    assert!(use_all(&assembled(&sections)).is_ok());
    for place in 0..sections.len() {
        let optional = [
            SectionKind::Order,
            SectionKind::FileVertices,
            SectionKind::Motion,
            SectionKind::Contacts,
            SectionKind::EarlierContacts,
            SectionKind::Feet,
            SectionKind::Ties,
            SectionKind::Rig,
            SectionKind::BodyParts,
            SectionKind::FoundParts,
            SectionKind::Families,
            SectionKind::Turns,
            SectionKind::LearnedSpace,
        ]
        .map(SectionKind::number)
        .contains(&sections[place].number);
        let mut without = sections.clone();
        without.remove(place);
        assert_eq!(use_all(&assembled(&without)).is_ok(), optional);
        let mut twice = sections.clone();
        twice.push(sections[place].clone());
        assert!(use_all(&assembled(&twice)).is_err());
    }
    let mut late = sections.clone();
    late.swap(0, 1);
    assert!(use_all(&assembled(&late)).is_err());
}

#[test]
fn a_tiny_file_cannot_ask_for_much() {
    let mut sections = raw_sections(&small_bundle());
    let mut meta = meta_of(&sections);
    (meta.vertex_count, meta.corner_count, meta.triangle_count) = (4_000_000, 8_000_000, 8_000_000);
    (meta.transition_count, meta.image_count) = (16_000_000, 1);
    sections[0].raw = postcard::to_stdvec(&meta).unwrap();
    assert!(use_all(&assembled(&sections)).is_err());
    assert!(LARGEST.load(Ordering::Relaxed) < LARGEST_BLOCK);
}

/// A change to the raw bytes of a section whose checksum is made to fit.
#[derive(Clone, Debug)]
enum Forgery {
    Set(usize, u8),
    Insert(usize, u8),
    Remove(usize),
    Truncate(usize),
}

fn forgery() -> impl Strategy<Value = Forgery> {
    let value = || prop_oneof![any::<u8>(), Just(0), Just(255), Just(127), Just(128)];
    prop_oneof![
        6 => (any::<usize>(), value()).prop_map(|(at, value)| Forgery::Set(at, value)),
        1 => (any::<usize>(), value()).prop_map(|(at, value)| Forgery::Insert(at, value)),
        1 => any::<usize>().prop_map(Forgery::Remove),
        1 => any::<usize>().prop_map(Forgery::Truncate),
    ]
}

fn forge(raw: &mut Vec<u8>, forgery: &Forgery) {
    let length = raw.len().max(1);
    match *forgery {
        Forgery::Set(at, value) if !raw.is_empty() => raw[at % length] = value,
        Forgery::Insert(at, value) => raw.insert(at % length, value),
        Forgery::Remove(at) if !raw.is_empty() => drop(raw.remove(at % length)),
        Forgery::Truncate(at) => raw.truncate(at % length),
        Forgery::Set(..) | Forgery::Remove(_) => {}
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6000))]

    #[test]
    fn forged_sections_never_panic(section: prop::sample::Index, forgeries in prop::collection::vec(forgery(), 1..5)) {
        static BUNDLE: std::sync::OnceLock<Vec<Section>> = std::sync::OnceLock::new();
        let mut sections = BUNDLE.get_or_init(|| raw_sections(&small_bundle())).clone();
        let raw = &mut section.get_mut(&mut sections).raw;
        forgeries.iter().for_each(|forgery| forge(raw, forgery));
        let bytes = assembled(&sections);
        let accepted = use_all(&bytes).is_ok();
        let errors = validate(&bytes).iter().filter(|finding| finding.severity == Severity::Error).count();
        prop_assert!(accepted || errors == 1);
        prop_assert!(LARGEST.load(Ordering::Relaxed) < LARGEST_BLOCK);
    }

    #[test]
    fn forged_counts_never_panic(
        which in 0..11_usize,
        value in prop_oneof![any::<u32>(), 0..40_u32, Just(u32::MAX), Just(1 << 22)],
        number in any::<f32>(),
    ) {
        static BUNDLE: std::sync::OnceLock<Vec<Section>> = std::sync::OnceLock::new();
        let mut sections = BUNDLE.get_or_init(|| raw_sections(&small_bundle())).clone();
        let mut meta = meta_of(&sections);
        match which {
            0 => meta.vertex_count = value,
            1 => meta.corner_count = value,
            2 => meta.triangle_count = value,
            3 => meta.image_count = value,
            4 => meta.transition_count = value,
            5 => meta.first_frame = value,
            6 => meta.group = value,
            7 => meta.sequences[0].frame_count = value,
            8 => meta.chunks[0].frame_count = value,
            9 => (meta.step, meta.fps) = (number, number.abs()),
            _ => (meta.lowest[1], meta.max_error) = (number, number),
        }
        sections[0].raw = postcard::to_stdvec(&meta).unwrap();
        let _ = use_all(&assembled(&sections));
        prop_assert!(LARGEST.load(Ordering::Relaxed) < LARGEST_BLOCK);
    }

    #[test]
    fn arbitrary_bytes_never_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..400), magic: bool) {
        if magic && bytes.len() > 12 {
            bytes[..8].copy_from_slice(&bundle::MAGIC);
            bytes[8..12].copy_from_slice(&[1, 0, 0, 0]);
        }
        prop_assert!(use_all(&bytes).is_err());
    }
}
