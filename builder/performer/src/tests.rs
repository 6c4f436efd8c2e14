//! The performer as a whole: its surface, its feet, and what is written.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use glam::Vec3;
use rayon::prelude::*;

use super::figure::Figure;
use super::skeleton::joint;
use super::{Artefacts, PerformerError, PerformerOptions, between, perform, write_performer};
use geometry::atlas;

const FPS: f32 = 50.0;

static FIGURE: LazyLock<Figure> = LazyLock::new(|| Figure::new(2500, 512));

/// Every behaviour at its usual length.
static PERFORMED: LazyLock<Vec<(perform::Take, Vec<perform::PerformedFrame>)>> = LazyLock::new(|| {
    let takes = perform::takes(1250, FPS, 5);
    takes.into_par_iter().map(|take| (take.clone(), perform::perform(&FIGURE, &take, FPS))).collect()
});

#[test]
fn the_surface_is_one_closed_sheet_with_the_vertices_asked_for() {
    for vertices in [1500, 5000] {
        let figure = Figure::new(vertices, 256);
        let mesh = &figure.mesh;
        mesh.check_closed().unwrap();
        assert_eq!(mesh.euler_characteristic(), 2);
        assert_eq!(mesh.largest_component().positions.len(), mesh.positions.len());
        assert!((mesh.positions.len() as f32 / vertices as f32 - 1.0).abs() < 0.05);
        assert!(mesh.volume() > 0.05, "triangles face outwards");
        let off = mesh.positions.iter().map(|&p| figure.body.distance(p).abs()).fold(0.0, f32::max);
        assert!(off < 0.003, "a vertex lies {off} m off the implicit surface");
    }
}

#[test]
fn weights_are_shares_of_few_joints() {
    for influences in &FIGURE.influences {
        assert!((influences.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        assert!(influences.weights.iter().all(|w| (0.0..=1.0).contains(w)));
    }
}

#[test]
fn charts_lie_apart_in_the_texture() {
    let usual = Figure::new(5000, 512);
    check_atlas(&FIGURE);
    check_atlas(&usual);
    assert!(usual.atlas.chart_count() <= 40, "{} charts", usual.atlas.chart_count());
    let filled = usual.atlas.texels.len() as f32 / (512.0 * 512.0);
    assert!(filled > 0.35, "only {filled} of the texture is used");
}

fn check_atlas(figure: &Figure) {
    let atlas = &figure.atlas;
    for (index, [a, b, c]) in atlas.uvs.iter().enumerate() {
        let (chart, flat) = (atlas.chart_of_triangle[index], (*b - *a).perp_dot(*c - *a));
        let inside = [a, b, c].iter().all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0);
        assert!(inside && flat > 0.0, "triangle {index} of chart {chart} lies at {a}, {b}, {c}");
    }
    assert_eq!(atlas::overlaps(&atlas.uvs, 2048), 0, "texels that lie in two triangles");
    // Texels of different charts keep their distance.
    let size = atlas.size;
    let mut chart = vec![u32::MAX; size * size];
    for &(index, point) in &atlas.texels {
        chart[index as usize] = atlas.chart_of_triangle[point.triangle as usize];
    }
    for &(index, point) in &atlas.texels {
        let own = atlas.chart_of_triangle[point.triangle as usize];
        let (x, y) = (index as usize % size, index as usize / size);
        for step in 1..=atlas::PADDING {
            for (x, y) in [(x + step, y), (x, y + step)] {
                let other = if x < size && y < size { chart[y * size + x] } else { own };
                assert!(other == own || other == u32::MAX, "charts {own} and {other} are {step} texels apart");
            }
        }
    }
}

#[test]
fn planted_feet_stay_where_they_are() {
    for (take, frames) in PERFORMED.iter() {
        let mut standing = 0;
        for pair in frames.windows(2) {
            for side in 0..2 {
                if !(pair[0].planted[side] && pair[1].planted[side]) {
                    continue;
                }
                for (vertex, influences) in FIGURE.influences.iter().enumerate() {
                    let first = joint::LEG[side] as u8 + 2;
                    let (before, after) = (pair[0].positions[vertex], pair[1].positions[vertex]);
                    if [first, first + 1].contains(&influences.joints[0]) && before.y < 0.004 && after.y < 0.004 {
                        let slid = ((after - before) * Vec3::new(1.0, 0.0, 1.0)).length();
                        let pitch = pair[1].state.feet[side].pitch.to_degrees();
                        let place = FIGURE.body.to_joint(FIGURE.mesh.positions[vertex], joint::LEG[side] + 2);
                        assert!(
                            slid < 0.002,
                            "in {} a sole slides by {slid} m at {place} of the foot, pitched by {pitch} degrees",
                            take.name
                        );
                        standing += 1;
                    }
                }
            }
        }
        assert!(standing > frames.len(), "{}: feet stand on the ground", take.name);
        let lowest = frames.iter().flat_map(|f| &f.positions).map(|p| p.y).fold(f32::INFINITY, f32::min);
        assert!(lowest > -0.025, "in {} the figure sinks {lowest} m into the ground", take.name);
    }
}

#[test]
fn the_skirt_stays_off_the_legs_and_in_one_piece() {
    let shares = FIGURE.skirt.shares(FIGURE.mesh.positions.len());
    for (take, frames) in PERFORMED.iter() {
        for frame in frames {
            for (vertex, &p) in frame.positions.iter().enumerate() {
                assert!(p.is_finite());
                let free = shares[vertex] > 0.99 && FIGURE.mesh.positions[vertex].y < 0.8;
                for first in joint::LEG {
                    let (hip, knee) = (frame.joints[first].translation, frame.joints[first + 1].translation);
                    let inside = geometry::sdf::cone(p, hip, knee, 0.075, 0.05);
                    assert!(!free || inside > 0.0, "in {} the skirt is {inside} m inside a leg", take.name);
                }
            }
        }
    }
}

#[test]
fn takes_share_the_frames_and_repeat_with_their_number() {
    for (frames, sequences) in [(1200, 10), (2633, 20), (300, 10), (7, 7)] {
        let takes = perform::takes(frames, FPS, 1);
        assert_eq!(takes.iter().map(|take| take.frames).sum::<usize>(), frames);
        assert!(takes.len() <= sequences, "{frames} frames make {} takes", takes.len());
        let mut next = 0;
        for take in &takes {
            assert_eq!(take.first_frame, next);
            next += take.frames;
        }
    }
    let takes = perform::takes(2633, FPS, 1);
    assert!(takes.iter().all(|take| (75..=400).contains(&take.frames)), "sequences last 1.5 to 8 s");
}

#[test]
fn no_two_takes_are_the_same() {
    let takes = perform::takes(2500, FPS, 9);
    let walks: Vec<_> = takes.iter().filter(|take| take.behaviour == 1).collect();
    let [first, second] = [0, 1].map(|k| perform::perform(&FIGURE, walks[k], FPS));
    let apart = first[100].positions.iter().zip(&second[100].positions).map(|(a, b)| a.distance(*b));
    assert!(apart.fold(0.0, f32::max) > 0.01);
}

#[test]
fn the_same_options_write_the_same_bytes_with_one_thread_and_two() {
    let options = PerformerOptions {
        frames: 30,
        vertices: 1500,
        texture_size: 128,
        artefacts: Artefacts::ALL,
        ..PerformerOptions::default()
    };
    let written = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| capture(&options))
    };
    let (one, two) = (written(1), written(2));
    assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
    assert!(one.iter().all(|(name, bytes)| two[name] == *bytes));
    assert_eq!(one.keys().filter(|name| name.ends_with(".ply")).count(), 30);
    assert_eq!(one.keys().filter(|name| name.contains("texture_")).count(), 30);
}

#[test]
fn the_truth_explains_the_artefacts() {
    let clean = PerformerOptions { frames: 24, vertices: 1500, texture_size: 128, ..PerformerOptions::default() };
    let noisy = PerformerOptions { artefacts: "noise".parse().unwrap(), ..clean };
    let (clean, noisy) = (capture(&clean), capture(&noisy));
    let heights = floats(&noisy["truth/walk/noise.f32"]);
    let (before, after) = (positions(&clean["walk/frame_00001.ply"]), positions(&noisy["walk/frame_00001.ply"]));
    let frame = &heights[before.len()..2 * before.len()];
    let mut largest = 0.0_f32;
    for ((a, b), height) in before.iter().zip(&after).zip(frame) {
        assert!((a.distance(*b) - height.abs()).abs() < 1e-5);
        largest = largest.max(height.abs());
    }
    assert!((0.0004..0.0025).contains(&largest), "noise reaches {largest} m");

    let drifted = PerformerOptions {
        frames: 24,
        vertices: 1500,
        texture_size: 128,
        artefacts: "drift,holes".parse().unwrap(),
        ..PerformerOptions::default()
    };
    let drifted = capture(&drifted);
    let ways = floats(&drifted["truth/walk/drift.f32"]);
    let far = ways.chunks_exact(3).map(|way| Vec3::from_slice(way).length()).fold(0.0, f32::max);
    assert!((0.003..=0.0105).contains(&far), "drift reaches {far} m");
    let after = positions(&drifted["walk/frame_00001.ply"]);
    assert!(before.iter().zip(&after).any(|(a, b)| a.distance(*b) > 0.002));
}

#[test]
fn hidden_texels_are_black() {
    let take = &perform::takes(1250, FPS, 1)[0];
    let frames = perform::perform(&FIGURE, take, FPS);
    let hole = (0..take.frames).find_map(|k| Some((k, super::artefacts::Hole::new(&FIGURE, take, k)?)));
    let (index, hole) = hole.unwrap();
    let (image, mask) = super::artefacts::frame_texture(&FIGURE, &frames[index], None, None, Some(&hole));
    let mask = mask.unwrap();
    let hidden = mask.iter().filter(|&&m| m == 255).count();
    assert!(hidden > 50 && mask.iter().zip(&image).all(|(&m, &texel)| m == 0 || texel == [0; 3]));
}

#[test]
fn a_capture_is_made_again_from_its_truth() {
    let asked = PerformerOptions {
        frames: 40,
        vertices: 1500,
        texture_size: 128,
        artefacts: Artefacts::ALL,
        seed: 3,
        ..PerformerOptions::default()
    };
    let folder = tempfile::tempdir().unwrap();
    write_performer(&asked, folder.path(), &|_| {}).unwrap();
    let options = between::options(&folder.path().join("truth")).unwrap();
    assert_eq!(options, asked);
    let takes = perform::takes(options.frames, options.fps, options.seed);
    let frames: Vec<usize> = (0..40).collect();
    let between = between::Between::new(&options, &frames);
    let captured = |frame: usize| {
        let take = takes.iter().rfind(|take| take.first_frame <= frame).unwrap();
        let (name, index) = (&take.name, frame - take.first_frame);
        let image = image::open(folder.path().join(format!("{name}/texture_{index:05}.png"))).unwrap().into_rgb8();
        image.pixels().map(|texel| texel.0).collect::<Vec<_>>()
    };
    for frame in [0, 7, 21, 39] {
        assert_eq!(between.recorded(frame), Some(captured(frame)), "frame {frame}");
    }
    assert!(between.texture([0, 40], 0.5).is_none() && between.slides([40, 0]).is_none());
    // Without gaps both ends are what was captured, and half way colours may not be the mean.
    let whole: Vec<usize> =
        frames.into_iter().filter(|&frame| between.texture([frame; 2], 0.3) == between.recorded(frame)).collect();
    let [a, b] = [whole[0], whole[whole.len() - 1]];
    assert!(b > a + 10);
    let (first, last) = (captured(a), captured(b));
    assert_eq!(between.texture([a, b], 0.0).unwrap(), first);
    let apart = |x: &[[u8; 3]], y: &[[u8; 3]]| -> u64 {
        x.iter().flatten().zip(y.iter().flatten()).map(|(x, y)| u64::from(x.abs_diff(*y))).sum()
    };
    // Rounding alone.
    assert!(apart(&between.texture([a, b], 1.0).unwrap(), &last) < 50);
    let half = between.texture([a, b], 0.5).unwrap();
    assert!(apart(&half, &between.texture([b, a], 0.5).unwrap()) < 50);
    let mean: Vec<[u8; 3]> =
        first.iter().zip(&last).map(|(a, b)| [0, 1, 2].map(|c| u8::midpoint(a[c], b[c]))).collect();
    assert!(apart(&half, &mean) > 5000 && apart(&half, &first) > 5000);

    let slides = between.slides([a, b]).unwrap();
    let known: Vec<f32> = slides.into_iter().filter(|slide| !slide.is_nan()).collect();
    let mean = known.iter().sum::<f32>() / known.len() as f32;
    // 1 cm is about half a texel here; two ways of at most that much.
    assert!(known.len() > 1500 && (0.05..2.0).contains(&mean), "{} {mean}", known.len());
    assert!(between.slides([a, a]).unwrap().iter().all(|slide| slide.is_nan() || *slide == 0.0));
}

#[test]
fn a_truth_that_is_none_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let told = |text: Option<&str>| {
        if let Some(text) = text {
            std::fs::write(folder.path().join("capture.json"), text).unwrap();
        }
        between::options(folder.path()).unwrap_err()
    };
    assert!(told(None).contains("cannot be read"));
    assert!(told(Some("{")).contains("not a truth file"));
    let begin = r#"{"seed": 1, "artefacts": [["drift", true]]"#;
    assert!(told(Some(&format!("{begin}}}"))).contains("earlier version"));
    let asked = |size: &str| {
        format!(r#"{begin}, "asked": {{"frames": 9, "vertices": 1500, "texture_size": {size}, "fps": 50}}}}"#)
    };
    assert!(told(Some(&asked("1000000"))).contains("--texture-size"));
    assert!(told(Some(&asked("-1"))).contains("not a truth file"));
}

#[test]
fn refuses_what_it_cannot_make() {
    let options = PerformerOptions { vertices: 10, ..PerformerOptions::default() };
    let error = write_performer(&options, Path::new("/nowhere"), &|_| {}).unwrap_err();
    assert!(matches!(error, PerformerError::Option { option: "--vertices", .. }), "{error}");
}

/// All files of a capture, by name.
fn capture(options: &PerformerOptions) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let summary = write_performer(options, folder.path(), &|_| {}).unwrap();
    assert_eq!(summary.frames, options.frames);
    let mut files = BTreeMap::new();
    let mut open = vec![folder.path().to_owned()];
    while let Some(path) = open.pop() {
        for entry in std::fs::read_dir(path).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path.strip_prefix(folder.path()).unwrap().to_string_lossy().replace('\\', "/");
                files.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    files
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// Vertex positions of a frame as written.
fn positions(file: &[u8]) -> Vec<Vec3> {
    let end = b"end_header\n";
    let start = file.windows(end.len()).position(|window| window == end).unwrap() + end.len();
    let header = std::str::from_utf8(&file[..start]).unwrap();
    let count: usize = header.lines().find_map(|line| line.strip_prefix("element vertex ")).unwrap().parse().unwrap();
    floats(&file[start..start + count * 12]).chunks_exact(3).map(Vec3::from_slice).collect()
}
