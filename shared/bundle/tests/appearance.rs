//! Models of textures through a bundle and back, whole, forged and piece by piece.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

mod captures;
mod forge;
mod looks;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use bundle::{
    AppearanceInput, AppearanceQuality, AppearanceReport, BundleError, BundleInput, BundleReader, EncodeError,
    ModeDecoder, SectionKind, Textures, encode_with_appearance, encode_with_looks, store_appearance, validate,
};
use captures::{cloth, graph};
use forge::{Section, assembled, raw_sections};
use proptest::prelude::*;
use texture::TextureModel;
use texture::basis::Mode;

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

/// As in `bundle_hostile.rs`.
const LARGEST_BLOCK: usize = 32 << 20;

const FRAMES: [u32; 2] = [5, 3];

fn write(model: &TextureModel, quality: AppearanceQuality) -> Result<(Vec<u8>, AppearanceReport), EncodeError> {
    let capture = cloth(4, 3, &FRAMES);
    let graph = graph(&capture.timeline);
    let generator = "reprise test".into();
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 6,
        max_error: 0.001,
        poisson_order: None,
        generator,
    };
    let appearance = AppearanceInput { model, material: 1, quality };
    let (bytes, report) = encode_with_appearance(&input, Some(&appearance))?;
    Ok((bytes, report.appearance.unwrap()))
}

fn small() -> TextureModel {
    looks::model([50, 37], [3, 2], 8)
}

/// All modes of the bundle, read `most` blocks at a time.
fn modes(reader: &BundleReader, most: usize) -> Result<[Vec<Mode>; 2], &'static str> {
    let appearance = reader.appearance().unwrap();
    let (mut modes, mut decoder) = ([Vec::new(), Vec::new()], ModeDecoder::default());
    for ordinal in 0..appearance.section_count() {
        let (layer, index) = appearance.place(ordinal).unwrap();
        assert_eq!(modes[layer].len(), index);
        let bytes = reader.mode_bytes(ordinal).unwrap();
        let mode = loop {
            if let Some(mode) = decoder.advance(bytes, appearance, layer, most)? {
                break mode;
            }
        };
        modes[layer].push(mode);
    }
    Ok(modes)
}

/// Root mean square difference between the stored and the plain textures and warps over all frames.
fn errors(model: &TextureModel, bytes: &[u8]) -> [f64; 2] {
    let reader = BundleReader::from_bytes(bytes).unwrap();
    let appearance = reader.appearance().unwrap();
    let modes = modes(&reader, usize::MAX).unwrap();
    let (mut sums, mut counts) = ([0.0; 2], [0_usize; 2]);
    for frame in 0..model.frame_count() {
        let plain = looks::plain(model, frame);
        for layer in 0..2 {
            let own = &appearance.layers[layer];
            let weights = own.weights(frame as u32, frame as u32, 0.0);
            let field = own.rebuild(&appearance.mask, &modes[layer], &weights, 16);
            let texels = (0..model.active.len()).filter(|&at| model.active[at]);
            let cell = (1 << own.level) as f32;
            for (at, values) in texels.zip(plain[layer].chunks_exact(own.channels)) {
                let [x, y] = [at % model.width as usize, at / model.width as usize];
                let [x, y] = [x, y].map(|at| (at as f32 + 0.5) / cell - 0.5);
                let stored = field.sample(x, y).unwrap();
                sums[layer] += values.iter().zip(stored).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
                counts[layer] += values.len();
            }
        }
    }
    [0, 1].map(|layer| (sums[layer] / counts[layer] as f64).sqrt())
}

#[test]
fn textures_and_warps_come_back_as_closely_as_reported() {
    let model = looks::model([200, 120], [6, 3], 8);
    let mut before = [0, 0];
    for (index, step) in [0.004, 0.016].into_iter().enumerate() {
        let quality = AppearanceQuality { texture_step: step, warp_level: 1, ..Default::default() };
        let (bytes, report) = write(&model, quality).unwrap();
        assert_eq!(validate(&bytes).iter().filter(|finding| finding.code.contains("damaged")).count(), 0);
        let [texture, warp] = errors(&model, &bytes);
        // The report leaves out the rounding of coefficients, and takes modes to be uncorrelated.
        assert!(texture < 1.3 * report.texture_error + 1e-4, "{texture} {report:?}");
        assert!(texture < f64::from(step) && warp < 0.15, "{texture} {warp}");
        before[index] = report.bytes;
    }
    assert!(before[1] < before[0]);
}

#[test]
fn every_byte_is_accounted_for() {
    let (bytes, report) = write(&small(), AppearanceQuality::default()).unwrap();
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!(reader.header().unwrap().minor, 9);
    let ours: Vec<_> = reader.sections().into_iter().filter(|section| section.name.starts_with("appearance")).collect();
    assert_eq!(ours.len(), 1 + 2 + 3 + 2);
    assert_eq!(ours.iter().map(|section| section.stored).sum::<u64>(), report.bytes);
    assert!((report.bytes_per_frame - report.bytes as f64 / 8.0).abs() < 1e-9);
    // The mean texture comes with the first pose, what refines it after everything else.
    let names: Vec<_> = reader.sections().iter().map(|section| section.name).collect();
    let first = names.iter().position(|name| *name == "geometry").unwrap();
    assert_eq!(names[first + 1..first + 3], ["appearance", "appearance-mode"]);
    assert!(names[names.len() - 6..].iter().all(|name| *name == "appearance-mode"));
    assert_eq!(reader.appearance().unwrap().material, 1);
    assert_eq!(reader.appearance().unwrap().mask.full().flags.len(), 50 * 37);
    let active: Vec<bool> = reader.appearance().unwrap().mask.full().flags.iter().map(|flags| flags & 1 == 1).collect();
    assert_eq!(active, small().active);
}

#[test]
fn bytes_can_be_capped() {
    let model = looks::model([160, 100], [5, 3], 8);
    let (_, free) = write(&model, AppearanceQuality::default()).unwrap();
    let most_bytes = Some(free.bytes / 2);
    let (_, capped) = write(&model, AppearanceQuality { most_bytes, ..Default::default() }).unwrap();
    assert!(capped.bytes <= free.bytes / 2 && capped.texture_step > free.texture_step);
}

#[test]
fn reading_in_pieces_gives_the_same() {
    let (bytes, _) = write(&small(), AppearanceQuality::default()).unwrap();
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    let whole = modes(&reader, usize::MAX).unwrap();
    for most in [1, 2, 5] {
        assert_eq!(modes(&reader, most).unwrap(), whole);
    }
}

#[test]
fn readers_that_do_not_know_appearance_skip_it() {
    let (bytes, _) = write(&small(), AppearanceQuality::default()).unwrap();
    let header = bundle::Header::parse(&bytes).unwrap().unwrap();
    for (index, section) in header.sections.iter().enumerate() {
        let flags = bytes[48 + 40 * index + 2];
        assert_eq!(flags, u8::from(section.number >= 32), "section {}", section.number);
    }
}

#[test]
fn models_that_do_not_fit_are_refused() {
    let refused = |change: &dyn Fn(&mut TextureModel)| {
        let mut model = small();
        change(&mut model);
        write(&model, AppearanceQuality::default()).unwrap_err()
    };
    refused(&|model| model.width += 1);
    refused(&|model| model.mean_texture.truncate(7));
    refused(&|model| model.textures[1].push(0.0));
    refused(&|model| model.warp_coefficients.truncate(7));
    refused(&|model| model.warps[0][3] = f32::NAN);
    refused(&|model| model.active[50 * 18 + 13] ^= true);
    refused(&|model| model.textures = vec![vec![0.0; model.mean_texture.len()]; 300]);
    for quality in [
        AppearanceQuality { texture_step: 0.0, ..Default::default() },
        AppearanceQuality { warp_step: f32::NAN, ..Default::default() },
        AppearanceQuality { warp_level: 9, ..Default::default() },
    ] {
        assert!(write(&small(), quality).is_err());
    }
}

#[test]
fn models_without_modes_or_texels_are_stored_too() {
    for (counts, size) in [([0, 0], [50, 37]), ([2, 0], [50, 37]), ([1, 1], [3, 1])] {
        let model = looks::model(size, counts, 8);
        let (bytes, _) = write(&model, AppearanceQuality::default()).unwrap();
        let reader = BundleReader::from_bytes(&bytes).unwrap();
        let read = modes(&reader, usize::MAX).unwrap();
        assert_eq!([read[0].len(), read[1].len()], counts.map(|count| count + 1));
    }
}

/// Everything that a player would ask.
fn use_all(bytes: &[u8]) -> Result<(), BundleError> {
    let reader = BundleReader::from_bytes(bytes)?;
    let Some(appearance) = reader.appearance() else { return Ok(()) };
    if let Ok(modes) = modes(&reader, 7) {
        for (layer, modes) in appearance.layers.iter().zip(&modes) {
            let weights = layer.weights(1, 7, 0.3);
            let _ = layer.rebuild(&appearance.mask, modes, &weights, 8);
        }
    }
    Ok(())
}

fn sections() -> &'static Vec<Section> {
    static BUNDLE: OnceLock<Vec<Section>> = OnceLock::new();
    BUNDLE.get_or_init(|| {
        let mut sections = raw_sections(&write(&small(), AppearanceQuality::default()).unwrap().0);
        for section in &mut sections {
            section.may_be_skipped = section.number >= 32;
        }
        sections
    })
}

#[test]
fn every_truncation_and_every_flipped_bit_is_refused() {
    let (bytes, _) = write(&small(), AppearanceQuality::default()).unwrap();
    let header = bundle::Header::parse(&bytes).unwrap().unwrap();
    let ours = header.sections.iter().filter(|section| section.number >= 32);
    for section in ours {
        for position in section.offset..section.offset + section.stored {
            let position = position as usize;
            let cut = BundleReader::from_bytes(&bytes[..position]).unwrap_err();
            assert!(matches!(cut, BundleError::Truncated { .. }));
            let mut changed = bytes.clone();
            changed[position] ^= 1 << (position % 8);
            assert!(matches!(use_all(&changed), Err(BundleError::Damaged { .. })), "byte {position}");
        }
    }
}

#[test]
fn cut_sections_with_fitting_checksums_are_noticed() {
    for index in (0..sections().len()).filter(|&index| sections()[index].number >= 32) {
        for length in 0..sections()[index].raw.len() {
            let mut cut = sections().clone();
            cut[index].raw.truncate(length);
            let bytes = assembled(&cut);
            let noticed = use_all(&bytes).is_err() || validate(&bytes).iter().any(|f| f.code == "damaged-mode");
            assert!(noticed, "section {index} of {length} bytes");
        }
    }
}

#[test]
fn modes_must_all_be_there_after_what_they_need() {
    assert!(use_all(&assembled(sections())).is_ok());
    let head = sections().iter().position(|section| section.number == SectionKind::Appearance.number()).unwrap();
    let mut without_head = sections().clone();
    without_head.remove(head);
    assert!(use_all(&assembled(&without_head)).is_err());
    let mut without_mode = sections().clone();
    without_mode.pop();
    assert!(use_all(&assembled(&without_mode)).is_err());
    let mut late = sections().clone();
    late.swap(head, head + 1);
    assert!(use_all(&assembled(&late)).is_err());
    let mut none = sections().clone();
    none.retain(|section| section.number < 32);
    assert!(use_all(&assembled(&none)).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn forged_appearance_never_panics(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        tail in prop::collection::vec(any::<u8>(), 0..40),
    ) {
        let mut forged = sections().clone();
        let ours: Vec<usize> = (0..forged.len()).filter(|&index| forged[index].number >= 32).collect();
        // The head, of which there is one, more often than its share.
        let index = ours[which.index(ours.len() * 2).saturating_sub(ours.len())];
        let raw = &mut forged[index].raw;
        for (at, value) in changes {
            let at = at.index(raw.len());
            raw[at] = value;
        }
        raw.extend(tail);
        let bytes = assembled(&forged);
        let _ = use_all(&bytes);
        let _ = validate(&bytes);
        prop_assert!(LARGEST.load(Ordering::Relaxed) < LARGEST_BLOCK);
    }
}

/// Models to compare with lie beside the others, and say so in the version; what is forged in them is refused as well.
#[test]
fn naive_models_come_back_beside_the_others() {
    let capture = cloth(4, 3, &FRAMES);
    let graph = graph(&capture.timeline);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 6,
        max_error: 0.001,
        poisson_order: None,
        generator: "reprise test".into(),
    };
    let (ours, naive) = (small(), looks::model([50, 37], [5, 0], 8));
    let looks =
        [&ours, &naive].map(|model| AppearanceInput { model, material: 1, quality: AppearanceQuality::default() });
    let (bytes, _) = encode_with_looks(&input, &looks).unwrap();
    let (alone, _) = encode_with_appearance(&input, Some(&looks[0])).unwrap();
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, validate(&bytes)), (9, validate(&alone)));
    let counts = |textures| reader.appearance_of(textures).unwrap().layers.clone().map(|layer| layer.mode_count());
    assert_eq!((counts(Textures::Aligned), counts(Textures::Naive)), ([3, 2], [5, 0]));
    let before = BundleReader::from_bytes(&alone).unwrap();
    assert!(before.appearance_of(Textures::Naive).is_none() && before.mode_bytes_of(Textures::Naive, 0).is_none());
    for ordinal in 0..7 {
        assert_eq!(reader.mode_bytes(ordinal), before.mode_bytes(ordinal));
        assert!(reader.mode_bytes_of(Textures::Naive, ordinal).is_some());
    }
    // A mode too few, a mode before what it needs, a damaged mode.
    let sections = raw_sections(&bytes);
    let index = |kind: SectionKind| sections.iter().position(|section| section.number == kind.number()).unwrap();
    let fewer: Vec<Section> = sections[..sections.len() - 1].to_vec();
    assert!(matches!(BundleReader::from_bytes(&assembled(&fewer)), Err(BundleError::Inconsistent { .. })));
    let mut early = sections.clone();
    early.swap(index(SectionKind::Naive), index(SectionKind::NaiveMode));
    assert!(BundleReader::from_bytes(&assembled(&early)).is_err());
    let mut cut = sections.clone();
    let damaged = &mut cut[index(SectionKind::NaiveMode)].raw;
    damaged.truncate(damaged.len() / 2);
    let findings = validate(&assembled(&cut));
    assert!(findings.iter().any(|f| f.code == "damaged-mode" && f.message.contains("naive-mode 0")), "{findings:?}");
}

/// What is stored and read again for measuring is what a bundle holds.
#[test]
fn storing_is_measured_on_what_a_bundle_holds() {
    let model = small();
    let (bytes, report) = write(&model, AppearanceQuality::default()).unwrap();
    let input = AppearanceInput { model: &model, material: 1, quality: AppearanceQuality::default() };
    let stored = store_appearance(&input, 8, 2).unwrap();
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!(stored.report, report);
    assert_eq!(stored.modes, modes(&reader, usize::MAX).unwrap());
    assert_eq!(stored.layers, reader.appearance().unwrap().layers);
    let texture = stored.texture(3, 1);
    assert!(texture.len() == 3 * model.active_count() && texture.iter().all(|value| value.is_finite()));
}
