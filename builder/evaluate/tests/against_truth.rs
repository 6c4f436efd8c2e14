//! Transitions of textures against the truth, which is known of textures made in code.
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs, reason = "tests may fail loudly")]

#[path = "../../appearance/tests/common/mod.rs"]
mod common;

use appearance::basis::Basis;
use appearance::textures::Texture;
use common::{SIZE, aligned, between, capture, charts, slide};
use evaluate::textures::ghosting::{CLASSES, Crossings, Scene, Truth, against_truth};
use job::Job;
use texture::quality::Similarity;

/// The truth about the textures above.
struct Known;

impl Truth for Known {
    fn between(&self, frames: [usize; 2], lambda: f32) -> Option<Texture> {
        Some(between(frames[0], frames[1], lambda))
    }

    fn slides(&self, frames: [usize; 2]) -> Option<Vec<f32>> {
        let way = slide(frames[1]) - slide(frames[0]);
        let slide = |k: usize| {
            let (x, y) = ((k % SIZE) as f32, (k / SIZE) as f32);
            // A row of which nothing is known.
            if k / SIZE == 10 { f32::NAN } else { (way * (0.03 * y).cos()).hypot(way * (0.04 * x).sin()) }
        };
        Some((0..SIZE * SIZE).map(slide).collect())
    }
}

#[test]
fn coefficients_come_closer_to_the_truth_than_a_cross_fade() {
    let textures = capture();
    let aligned = aligned(&textures);
    let basis = Basis::new(&textures[..], &aligned, &aligned.complete, (6, 3), &Job::silent()).unwrap();
    let similarity = Similarity::new(SIZE as u32, &charts().active());
    let scene = Scene { source: &textures[..], aligned: &aligned, basis: &basis, similarity: &similarity };
    // Frames 3 and 9 have gaps.
    let pairs = [[3, 11], [4, 10], [4, 11], [2, 9], [0, 1]];
    let measure = || against_truth(&scene, &Crossings { pairs: &pairs, truth: &Known }).unwrap();
    let found = measure();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    // Not the whole: slides that are not known are NaN.
    assert!(one.install(measure).rows == found.rows);
    assert_eq!(found.pairs, 3);
    for row in &found.rows {
        println!("{} {:?} {:?}", row.lambda, row.slides, row.ways.map(|way| way.quality.ssim));
        assert!(row.ways.iter().all(|way| way.quality.ssim.is_finite() && way.sharpness.is_finite()));
    }
    let row = |lambda: f32, slides| found.rows.iter().find(|row| row.lambda == lambda && row.slides == slides).unwrap();
    let [ours, stored, captured, faded] = row(0.0, None).ways;
    assert!((captured.quality.ssim - 1.0).abs() < 1e-5 && captured.quality.mse < 1e-9, "{captured:?}");
    assert!((captured.sharpness - 1.0).abs() < 1e-6);
    assert_eq!(stored, faded, "nothing is blended at 0");
    let (ssim, _) = basis.quality(&textures[..], &aligned, &[0, 4, 4], 6, 3).unwrap();
    assert!((ours.quality.ssim - ssim).abs() < 1e-4, "{ours:?} {ssim}");
    let far = row(0.5, Some(CLASSES[3]));
    let [ours, stored, captured, faded] = far.ways;
    assert!(far.slide > 2.0 && far.share > 0.3);
    assert!(ours.quality.ssim > captured.quality.ssim + 0.05 && ours.quality.mse < 0.5 * captured.quality.mse);
    assert!(stored.quality.ssim > faded.quality.ssim + 0.05 && stored.sharpness > faded.sharpness + 0.05);
    // Texels of which no slide is known are in no class.
    let shares: f64 =
        found.rows.iter().filter(|row| row.lambda == 0.5 && row.slides.is_some()).map(|row| row.share).sum();
    assert!((shares - 87.0 / 88.0).abs() < 1e-9, "{shares}");
    let worst = found.worst.unwrap();
    assert_eq!((worst.frames, worst.truth.len(), worst.ways[3].len()), ([4, 10], 42 * 88 * 2 * 3, 42 * 88 * 2 * 3));
}
