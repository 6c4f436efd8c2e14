//! Appearance from textures: what comes out, whatever goes in.

#![allow(clippy::unwrap_used, missing_docs, reason = "tests may fail loudly")]

mod common;

use std::path::{Path, PathBuf};

use actor::surface::{Corner, Image, ImageFormat, Material, Part, Surface};
use appearance::align::{AlignOptions, align};
use appearance::basis::Basis;
use appearance::completion::complete;
use appearance::fit::Fitting;
use appearance::naive::naive;
use appearance::stored::stored_quality;
use appearance::textures::{Texture, TextureFiles, TextureSource};
use appearance::{AppearanceError, AppearanceOptions, AppearanceSummary, Charts, build};
use bundle::AppearanceQuality;
use common::{FRAMES, aligned, capture, charts, texture};
use job::Job;
use learn::pca::components;
use learn::store::Store;
use texture::TextureModel;

#[test]
fn fitted_textures_show_the_recorded_ones_better() {
    let textures = capture();
    let aligned = aligned(&textures);
    let of = |steps: usize| {
        let fitting = Fitting { training: &aligned.complete, textures: 6, warps: 3, steps };
        let basis = Basis::fitted(&textures[..], &aligned, &fitting, &Job::silent()).unwrap();
        basis.quality(&textures[..], &aligned, &aligned.complete, 6, 3).unwrap()
    };
    let ((before, error_before), (after, error_after)) = (of(0), of(5));
    println!("similarity {before} then {after}, error {error_before} then {error_after}");
    assert!(error_after < 0.6 * error_before && after > before, "{before} {after} {error_before} {error_after}");
}

#[test]
fn gaps_are_completed_from_other_frames() {
    let textures = capture();
    let whole: Vec<Texture> = (0..FRAMES).map(texture).collect();
    let aligned = aligned(&textures);
    assert_eq!(aligned.complete.len(), FRAMES - 2);
    assert!(aligned.unseen(9).len() >= 25 * 20);
    let basis = Basis::new(&textures[..], &aligned, &aligned.complete, (6, 3), &Job::silent()).unwrap();
    let (ssim, error) = basis.quality(&whole[..], &aligned, &[3, 9], 6, 3).unwrap();
    println!("what was not seen: similarity {ssim}, error {error}");
    assert!(ssim > 0.8, "{ssim}");
}

/// Completed coefficients minimise the error over what was seen, with a little pull to zero: solved here with the whole
/// design matrix by conjugate gradients on the normal equations.
#[test]
fn completion_is_least_squares_over_what_was_seen() {
    let (rows, texels) = (9, 400);
    let noise = |a: usize, b: usize| {
        let hash = (a as u32 * 7919 + b as u32).wrapping_mul(0x9E37_79B9).rotate_left(15).wrapping_mul(0x85EB_CA6B);
        (hash >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    let store = Store::new(rows, 3 * texels, 2.0).unwrap();
    for row in 0..rows {
        store.write(row, &(0..3 * texels).map(|k| noise(row, k)).collect::<Vec<_>>()).unwrap();
    }
    let unseen: Vec<u32> = (0..texels as u32).filter(|k| k % 7 < 3).collect();
    let mut found = components(&store, &[0, 1, 2, 4, 5, 6, 7, 8], 5).unwrap();
    complete(&mut found, &store, 3, &unseen, 3).unwrap();
    let row = store.row(3).unwrap();
    let seen: Vec<usize> = (0..3 * texels).filter(|&k| unseen.binary_search(&(k as u32 / 3)).is_err()).collect();
    let apply = |c: &[f64]| -> Vec<f64> {
        let sums: Vec<f64> =
            seen.iter().map(|&k| c.iter().zip(&found.modes).map(|(c, m)| c * f64::from(m[k])).sum()).collect();
        let back = |m: &Vec<f32>| seen.iter().zip(&sums).map(|(&k, s)| f64::from(m[k]) * s).sum::<f64>();
        found.modes.iter().zip(c).map(|(m, c)| back(m) + 1e-3 * c).collect()
    };
    let right: Vec<f64> = found
        .modes
        .iter()
        .map(|m| seen.iter().map(|&k| f64::from(m[k]) * f64::from(row[k] - found.mean[k])).sum())
        .collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut plain, mut rest, mut way) = (vec![0.0; 5], right.clone(), right);
    for _ in 0..20 {
        let image = apply(&way);
        let length = dot(&rest, &rest);
        if length < 1e-24 {
            break;
        }
        let step = length / dot(&way, &image);
        plain.iter_mut().zip(&way).for_each(|(x, d)| *x += step * d);
        rest.iter_mut().zip(&image).for_each(|(r, i)| *r -= step * i);
        let turn = dot(&rest, &rest) / length;
        way.iter_mut().zip(&rest).for_each(|(d, r)| *d = r + turn * *d);
    }
    for (got, wanted) in found.coefficients[3 * 5..4 * 5].iter().zip(&plain) {
        assert!((f64::from(*got) - wanted).abs() < 1e-4 * (1.0 + wanted.abs()), "{got} {wanted}");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let textures = capture();
    let options = AppearanceOptions { components: 9, ..AppearanceOptions::default() };
    let made = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build(&textures[..], &charts(), &options, &Job::silent()).unwrap())
    });
    assert!(made[0] == made[1] && made[0] == made[2]);
    assert_eq!(made[0].1.completed_frames, [3, 9]);
    assert_eq!(made[0].0.textures.len(), 6);
    assert!(!made[0].0.warps.is_empty());
}

/// The appearance that reaches a similarity, with as many components as given or any number.
fn reaching(ssim: f64, components: Option<usize>) -> (TextureModel, AppearanceSummary) {
    let options = AppearanceOptions {
        ssim: Some(ssim),
        components: components.unwrap_or(12),
        any_components: components.is_none(),
        ..AppearanceOptions::default()
    };
    build(&capture()[..], &charts(), &options, &Job::silent()).unwrap()
}

#[test]
fn a_similarity_after_storing_is_reached_in_few_bytes() {
    let textures = capture();
    // The sample is all complete frames here.
    let frames: Vec<usize> = (0..FRAMES).filter(|frame| ![3, 9].contains(frame)).collect();
    let found = [0.9, 0.95, 0.97].map(|wanted| {
        let (model, summary) = reaching(wanted, Some(9));
        println!("{wanted}: {} and {}, {:?} {:?}", summary.textures, summary.warps, summary.quality, summary.stored);
        // In steps as coarse as these similarity jumps a little.
        assert!((wanted..=wanted + 0.001).contains(&summary.stored.ssim), "{wanted}: {summary:?}");
        assert_eq!((summary.textures + summary.warps, summary.quality.most_bytes), (9, None));
        // What is told is what the bundle will hold.
        let stored = stored_quality(&textures[..], &charts(), &model, summary.quality, &frames).unwrap();
        assert_eq!(stored, summary.stored);
        summary
    });
    let bytes = found.each_ref().map(|summary| summary.stored.bytes_per_frame);
    assert!(bytes[0] < bytes[1] && bytes[1] < bytes[2], "{bytes:?}");

    // The plain way: two thirds textures, in finer and finer steps.
    let options = AppearanceOptions { components: 9, ..AppearanceOptions::default() };
    let (model, usual) = build(&textures[..], &charts(), &options, &Job::silent()).unwrap();
    assert_eq!((usual.textures, usual.warps), (6, 3));
    let plain = (0..400).map(|k| 0.25 * 0.98_f32.powi(k)).find_map(|texture_step| {
        let quality = AppearanceQuality { texture_step, ..found[1].quality };
        let stored = stored_quality(&textures[..], &charts(), &model, quality, &frames).unwrap();
        (stored.ssim >= 0.95).then_some(stored)
    });
    let plain = plain.unwrap();
    println!("plain: {plain:?}");
    // Similarities are reached within a tolerance, which is worth up to three hundredths of the bytes.
    assert!(bytes[1] < 1.03 * plain.bytes_per_frame, "{plain:?} {bytes:?}");
}

#[test]
fn a_similarity_out_of_reach_gives_the_most_similar() {
    let (few, many) = (reaching(0.9999, Some(3)).1, reaching(0.9999, None).1);
    println!("{few:?}\n{many:?}");
    assert_eq!(few.textures + few.warps, 3);
    assert!(many.textures + many.warps > 12 && few.stored.ssim < many.stored.ssim && many.stored.ssim < 0.9999);
}

#[test]
fn threads_do_not_change_what_reaches_a_similarity() {
    let made = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| reaching(0.9, Some(6)))
    });
    assert!(made[0] == made[1]);
}

#[test]
fn storing_is_measured_and_keeps_to_its_bytes() {
    let textures = capture();
    let options = AppearanceOptions { components: 9, ..AppearanceOptions::default() };
    let (model, summary) = build(&textures[..], &charts(), &options, &Job::silent()).unwrap();
    println!("before {} {}, stored {:?}", summary.ssim, summary.mean_square_error, summary.stored);
    assert!(summary.stored.ssim <= summary.ssim + 0.01 && summary.stored.least_ssim <= summary.stored.ssim);
    assert!(summary.stored.bytes_per_frame <= 8192.0 && summary.ssim - summary.stored.ssim < 0.05);
    let frames = [0, 5, 11];
    let with = |texture_step| {
        let quality = AppearanceQuality { texture_step, ..summary.quality };
        stored_quality(&textures[..], &charts(), &model, quality, &frames).unwrap()
    };
    let (coarse, fine) = (with(0.05), with(0.005));
    assert!(coarse.ssim < fine.ssim && coarse.bytes_per_frame < fine.bytes_per_frame, "{coarse:?} {fine:?}");
    assert!(coarse.psnr < fine.psnr && coarse.frames == 3);
}

#[test]
fn naive_components_of_all_frames_rebuild_all_frames() {
    let textures = capture();
    let model = naive(&textures[..], &charts(), FRAMES).unwrap();
    assert_eq!((model.textures.len(), model.warps.len(), model.frame_count()), (FRAMES - 3, 0, FRAMES));
    // Twelve complete frames have eleven components, which leave nothing of them.
    let wanted = appearance::align::colours(&textures[5], &charts());
    let mut found = model.mean_texture.clone();
    for (mode, factor) in model.textures.iter().zip(&model.texture_coefficients[5 * (FRAMES - 3)..]) {
        found.iter_mut().zip(mode).for_each(|(sum, value)| *sum += factor * value);
    }
    let most = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0_f32, f32::max);
    assert!(most < 2e-3, "{most}");
}

/// A folder that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("reprise-appearance-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn files(paths: &[&Path]) -> TextureFiles {
    TextureFiles::new(paths.iter().map(|path| path.to_path_buf()).collect(), Vec::new()).unwrap()
}

#[test]
fn images_of_all_kinds_are_read() {
    let folder = Folder::new("kinds");
    let (grey, deep, alpha, mask) =
        (folder.at("grey.png"), folder.at("deep.png"), folder.at("alpha.png"), folder.at("mask.png"));
    image::GrayImage::from_fn(4, 3, |x, y| image::Luma([(10 * x + y) as u8])).save(&grey).unwrap();
    image::ImageBuffer::<image::Rgb<u16>, _>::from_fn(4, 3, |x, _| image::Rgb([257 * x as u16, 0, 65535]))
        .save(&deep)
        .unwrap();
    image::RgbaImage::from_fn(4, 3, |x, y| image::Rgba([9, x as u8, y as u8, if x == 2 { 0 } else { 255 }]))
        .save(&alpha)
        .unwrap();
    image::GrayImage::from_fn(4, 3, |_, y| image::Luma([if y == 1 { 255 } else { 0 }])).save(&mask).unwrap();
    let read = |path: &Path| files(&[path]).read(0).unwrap();
    assert_eq!(read(&grey).colours[5], [11; 3]);
    assert_eq!(read(&deep).colours[3], [3, 0, 255]);
    let seen = |texture: &Texture| (0..12).filter(|&texel| texture.seen(texel)).count();
    assert_eq!((seen(&read(&grey)), seen(&read(&alpha))), (12, 9));
    let masked = TextureFiles::new(vec![grey.clone()], vec![Some(mask)]).unwrap().read(0).unwrap();
    assert_eq!(seen(&masked), 8);
    assert!(!masked.seen(4) && masked.seen(0));
}

#[test]
fn textures_of_another_size_and_broken_ones_are_named() {
    let folder = Folder::new("sizes");
    let (first, other, broken) = (folder.at("a.png"), folder.at("b.png"), folder.at("c.png"));
    image::RgbImage::new(8, 8).save(&first).unwrap();
    image::RgbImage::new(8, 4).save(&other).unwrap();
    std::fs::write(&broken, b"no image").unwrap();
    let files = files(&[&first, &other, &broken, &folder.at("gone.png")]);
    assert!(matches!(files.read(1), Err(AppearanceError::Size { frame: 1, found: (8, 4), expected: (8, 8), .. })));
    for (frame, name) in [(1, "b.png"), (2, "c.png"), (3, "gone.png")] {
        let message = files.read(frame).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains(&format!("frame {frame}")), "{message}");
    }
    assert!(matches!(TextureFiles::new(Vec::new(), Vec::new()), Err(AppearanceError::NoFrames)));
}

#[test]
fn a_capture_without_a_complete_frame_is_refused() {
    let mut textures = capture();
    let hidden = textures[3].hidden.clone();
    textures.iter_mut().for_each(|texture| texture.hidden = hidden.clone());
    let error = align(&textures[..], &charts(), &AlignOptions::default(), &Job::silent()).unwrap_err();
    assert!(matches!(error, AppearanceError::NoCompleteFrames { frames: FRAMES }), "{error}");
}

/// Two triangles with these texture coordinates, apart from each other.
fn surface(uvs: [[[f32; 2]; 3]; 2]) -> Surface {
    let corner = |(vertex, &uv): (usize, &[f32; 2])| Corner { vertex: vertex as u32, uv, colour: [255; 4] };
    Surface {
        corners: uvs.as_flattened().iter().enumerate().map(corner).collect(),
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        parts: vec![Part { material: 0, first_triangle: 0, triangle_count: 2 }],
        materials: vec![Material { name: String::new(), base_colour: [1.0; 4], image: Some(0), double_sided: false }],
        images: vec![Image { format: ImageFormat::Png, width: 1, height: 1, bytes: Vec::new() }],
    }
}

#[test]
fn odd_atlases_are_told_or_refused() {
    let (one, two) = ([[0.1, 0.1], [0.4, 0.1], [0.1, 0.4]], [[0.6, 0.6], [0.9, 0.6], [0.6, 0.9]]);
    let (apart, findings) = Charts::new(&surface([one, two]), 64, 64).unwrap();
    assert_eq!((findings.shared_texels, findings.wrapped_triangles), (0, 0));
    assert_eq!(apart.labels.iter().max(), Some(&2));
    let (overlapping, findings) = Charts::new(&surface([one, one]), 64, 64).unwrap();
    assert!(findings.shared_texels > 0, "{findings:?}");
    assert_eq!(overlapping.labels.iter().max(), Some(&1));
    let away = two.map(|[u, v]| [u + 1.0, v - 2.0]);
    let (repeated, findings) = Charts::new(&surface([one, away]), 64, 64).unwrap();
    assert_eq!((findings.wrapped_triangles, &repeated), (1, &apart));
    for bad in [f32::NAN, 1e9] {
        let uvs = [one, [two[0], [bad, 0.0], two[2]]];
        let error = Charts::new(&surface(uvs), 64, 64).unwrap_err();
        assert!(matches!(error, AppearanceError::Coordinate { triangle: 1 }), "{error}");
    }
    let mut plain = surface([one, two]);
    plain.materials[0].image = None;
    assert!(matches!(Charts::new(&plain, 64, 64), Err(AppearanceError::NoTexels)));
}
