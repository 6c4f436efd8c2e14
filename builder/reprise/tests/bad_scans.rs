//! Faults that studios' scans have, made from a real one: each is mended, named or refused, and none passes silently.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::{Path, PathBuf};

use fixtures::{Scanned, scanned};
use geometry::polygonise::polygonise;
use glam::{Vec3, Vec3Swizzles};
use kernels::random::signed;
use reprise::Job;
use reprise::scans::{RegisterError, RegisterReport, ScanOptions, register};

/// A frame that is about to be spoilt.
#[derive(Clone)]
struct Frame {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    colours: Vec<Vec3>,
}

impl Frame {
    fn of(frame: usize) -> Self {
        let Scanned { positions, triangles, colours, .. } = scanned("crane", frame);
        Self { positions, triangles, colours }
    }

    fn add(&mut self, positions: &[Vec3], triangles: &[[u32; 3]]) {
        let first = self.positions.len() as u32;
        self.positions.extend(positions);
        self.colours.extend(positions.iter().map(|_| Vec3::splat(0.5)));
        self.triangles.extend(triangles.iter().map(|t| t.map(|v| v + first)));
    }

    /// A ball of some hundred triangles in the air.
    fn add_debris(&mut self, seed: u64) {
        let ball = polygonise(Vec3::splat(-0.06), Vec3::splat(0.06), 0.02, |p| p.length() - 0.035);
        for k in 0..3 {
            let at = |n: u64| signed(seed, 10 * k + n);
            let place = self.positions[0] + Vec3::new(0.8 * at(0), 0.3 * at(1), 0.8 * at(2)) + Vec3::X * 0.7;
            let places: Vec<Vec3> = ball.positions.iter().map(|p| *p + place).collect();
            self.add(&places, &ball.triangles);
        }
    }

    fn write(&self, path: &Path) {
        let mut file = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\nproperty list uchar int \
             vertex_indices\nend_header\n",
            self.positions.len(),
            self.triangles.len()
        )
        .into_bytes();
        for (p, c) in self.positions.iter().zip(&self.colours) {
            file.extend(p.to_array().into_iter().flat_map(f32::to_le_bytes));
            file.extend(c.to_array().map(|c| (c * 255.0) as u8));
        }
        for triangle in &self.triangles {
            file.push(3);
            file.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
        }
        fs::write(path, file).unwrap();
    }
}

/// What becomes of the first `frames` frames of crane when `spoil` was at each.
fn registered(frames: usize, spoil: impl Fn(usize, &mut Frame)) -> Result<RegisterReport, RegisterError> {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("scan");
    fs::create_dir_all(&scan).unwrap();
    for k in 0..frames {
        let mut frame = Frame::of(k);
        spoil(k, &mut frame);
        frame.write(&scan.join(format!("frame_{k:03}.ply")));
    }
    let out = folder.path().join("capture");
    let mut options = ScanOptions::default();
    options.texture_size = Some(128);
    let report = register(&[scan.to_string_lossy().into_owned()], &options, &out, &Job::silent());
    assert_eq!(out.exists(), report.is_ok());
    report
}

fn codes(report: &RegisterReport) -> Vec<&str> {
    report.warnings.iter().map(|warning| warning.code).collect()
}

fn lost(report: &RegisterReport) -> Vec<usize> {
    report.lost.iter().map(|lost| lost.frame).collect()
}

/// The warning `code` names the file of frame `frame`, and what was done or can be done: `remedy`.
fn assert_told(report: &RegisterReport, code: &str, frame: usize, remedy: &str) {
    let told = report.warnings.iter().find(|warning| warning.code == code).map(ToString::to_string).unwrap_or_default();
    assert!(told.contains(&format!("frame_{frame:03}.ply")) && told.contains(remedy), "{code}: {:?}", report.warnings);
}

/// A second person beside the first one.
fn add_twin(frame: &mut Frame) {
    let (positions, triangles) = (frame.positions.clone(), frame.triangles.clone());
    frame.add(&positions.iter().map(|p| *p + Vec3::X * 1.2).collect::<Vec<_>>(), &triangles);
}

/// Frame `frame` alone is lost; it is named with `why` and with what to do.
fn assert_lost(report: &RegisterReport, frame: usize, why: &str, remedy: &str) {
    assert_eq!(lost(report), [frame], "{:?}", report.lost);
    let one = &report.lost[0];
    assert!(one.place.contains(&format!("frame_{frame:03}.ply")), "{one:?}");
    assert!(one.reason.contains(why) && one.reason.contains(remedy), "{one:?}");
    assert_told(report, "W_SCAN_LOST", frame, remedy);
}

#[test]
#[ignore = "reads ../shared/data"]
fn an_empty_frame_cuts_its_sequence() {
    for (frames, at, parts) in [(3, 0, vec![2]), (5, 2, vec![2, 2])] {
        let report = registered(frames, |k, frame| {
            if k == at {
                frame.triangles.clear();
            }
        })
        .unwrap();
        assert_lost(&report, at, "no surface", "export it again");
        assert_eq!(report.sequences.iter().map(|s| s.1).collect::<Vec<_>>(), parts);
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn one_frame_of_another_scale_is_lost() {
    let report = registered(5, |k, frame| {
        if k == 3 {
            frame.positions.iter_mut().for_each(|p| *p *= 1000.0);
        }
    })
    .unwrap();
    assert_lost(&report, 3, "times that of most frames", "in the unit of the others");
    assert_told(&report, "W_SCAN_ALONE", 4, "mend those");
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_second_person_in_one_frame_is_lost() {
    let report = registered(3, |k, frame| {
        if k == 2 {
            add_twin(frame);
        }
    })
    .unwrap();
    assert_lost(&report, 2, "template", "more than one body, leave it out");
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_frame_of_noise_is_lost() {
    let report = registered(5, |k, frame| {
        if k == 2 {
            for (v, p) in frame.positions.iter_mut().enumerate() {
                let at = |n: u64| signed(9, 3 * v as u64 + n);
                *p += 0.05 * Vec3::new(at(0), at(1), at(2));
            }
        }
    })
    .unwrap();
    assert_lost(&report, 2, "or noise", "leave it out");
}

/// One capture with all of it: nothing is lost.
#[test]
#[ignore = "reads ../shared/data"]
fn millimetres_inside_out_doubled_and_debris_are_mended_and_told() {
    let report = registered(4, |k, frame| {
        // Every triangle has vertices of its own, and every fifth is there twice.
        let (positions, colours) = (frame.positions.clone(), frame.colours.clone());
        let corners: Vec<u32> = frame.triangles.as_flattened().to_vec();
        frame.positions = corners.iter().map(|&v| positions[v as usize]).collect();
        frame.colours = corners.iter().map(|&v| colours[v as usize]).collect();
        frame.triangles = (0..frame.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let twice: Vec<[u32; 3]> = frame.triangles.iter().step_by(5).copied().collect();
        frame.triangles.extend(twice);
        match k {
            1 => frame.triangles.iter_mut().for_each(|t| t.swap(0, 1)),
            2 => frame.add_debris(k as u64),
            _ => {}
        }
        frame.positions.iter_mut().for_each(|p| *p *= 1000.0);
    })
    .unwrap();
    assert!(lost(&report).is_empty(), "{:?}", report.lost);
    assert_told(&report, "W_UNIT_ASSUMED", 0, "--unit");
    assert_told(&report, "W_SCAN_INSIDE_OUT", 1, "they were turned");
    assert_told(&report, "W_SCAN_DEBRIS", 2, "must touch it");
    let twice = Frame::of(0).triangles.len().div_ceil(5);
    assert_told(&report, "W_SCAN_MENDED", 0, &format!("{twice} lie on others"));
    assert_told(&report, "W_SCAN_MENDED", 0, "so it is with 3 more frames");
    // Six vertices of a soup are one again.
    let clean = Frame::of(report.template);
    let most = (clean.positions.len(), clean.triangles.len());
    let found = (report.vertices, report.triangles);
    assert!(found <= most && 100 * report.vertices > 99 * most.0, "{found:?} {most:?}");
    assert!(report.registered.iter().all(|frame| frame.rms_backward < 0.004 && frame.beyond < 0.02));
}

#[test]
#[ignore = "reads ../shared/data"]
fn floating_debris_in_every_frame_is_no_part_of_the_body() {
    let report = registered(3, |k, frame| frame.add_debris(k as u64)).unwrap();
    assert!(lost(&report).is_empty(), "{:?}", report.lost);
    assert!(report.registered.iter().all(|frame| frame.beyond < 0.02), "{:?}", report.registered);
    assert_told(&report, "W_SCAN_DEBRIS", 0, "must touch it");
    assert!(report.vertices <= Frame::of(report.template).positions.len());
}

#[test]
#[ignore = "reads ../shared/data"]
fn two_people_all_the_time_are_one_actor_and_told() {
    let report = registered(3, |_, frame| add_twin(frame)).unwrap();
    assert!(lost(&report).is_empty(), "{:?}", report.lost);
    assert_told(&report, "W_SCAN_PARTS", report.template, "take the other out");
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_web_that_closes_and_opens_loses_nothing() {
    // Of these frames of crane the second one has a handle that those around it have not.
    let report = registered(3, |k, frame| *frame = Frame::of(10 + k)).unwrap();
    assert!(lost(&report).is_empty(), "{:?}", report.lost);
    assert_ne!(report.template, 1, "the template has no web");
    assert!(report.registered.iter().all(|frame| frame.uncovered < 0.015), "{:?}", report.registered);
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_hole_of_a_tenth_is_told() {
    let report = registered(4, |k, frame| {
        if k == 1 {
            // All that is lower than a tenth of the triangles.
            let height = |t: &[u32; 3]| t.map(|v| frame.positions[v as usize].xy().y).iter().sum::<f32>();
            let mut heights: Vec<f32> = frame.triangles.iter().map(height).collect();
            heights.sort_by(f32::total_cmp);
            let limit = heights[heights.len() / 10];
            let (positions, triangles) = (frame.positions.clone(), frame.triangles.clone());
            let height = |t: &[u32; 3]| t.map(|v| positions[v as usize].y).iter().sum::<f32>();
            frame.triangles = triangles.into_iter().filter(|t| height(t) > limit).collect();
        }
    })
    .unwrap();
    let told = report.warnings.iter().find(|warning| matches!(warning.code, "W_SCAN_DOUBTFUL" | "W_SCAN_LOST"));
    let told = told.map(ToString::to_string).unwrap_or_default();
    assert!(told.contains("frame_001.ply") && told.contains("leave it out"), "{told:?}, {:?}", report.registered);
}

#[test]
#[ignore = "reads ../shared/data"]
fn what_cannot_be_one_topology_is_refused() {
    let error = registered(3, |k, frame| {
        if k > 0 {
            // Something else, as large, every time.
            let size = 0.3 + 0.02 * k as f32;
            let ball = polygonise(Vec3::splat(-0.6), Vec3::splat(0.6), 0.04, |p| p.length() - size);
            (frame.positions, frame.triangles) = (Vec::new(), Vec::new());
            frame.colours.clear();
            frame.add(&ball.positions, &ball.triangles);
            let other = polygonise(Vec3::splat(-0.6), Vec3::splat(0.6), 0.04, |p| {
                (p / Vec3::new(0.2, 0.5, 0.1 * k as f32)).length() - 1.0
            });
            frame.add(&other.positions.iter().map(|p| *p + Vec3::Y * k as f32).collect::<Vec<_>>(), &other.triangles);
        }
    })
    .unwrap_err();
    assert_eq!(error.code(), "E_SCANS_LOST", "{error}");
    let message = error.to_string();
    assert!(
        message.contains(".ply") && message.contains("frame_0") && message.contains("--template-frame"),
        "{message}"
    );
}

/// The first frames as OBJ files whose material wears the texture `image`.
fn write_objects(scan: &Path, material: Option<&str>) -> PathBuf {
    fs::create_dir_all(scan).unwrap();
    for k in 0..3 {
        let frame = Frame::of(k);
        let mut text = material.map_or(String::new(), |name| format!("mtllib {name}\nusemtl skin\n"));
        for p in &frame.positions {
            text.push_str(&format!("v {} {} {}\nvt {} {}\n", p.x, p.y, p.z, 0.5 + 0.2 * p.x, 0.4 * p.y));
        }
        for t in &frame.triangles {
            let [a, b, c] = t.map(|v| v + 1);
            text.push_str(&format!("f {a}/{a} {b}/{b} {c}/{c}\n"));
        }
        fs::write(scan.join(format!("frame_{k:03}.obj")), text).unwrap();
    }
    scan.to_owned()
}

#[test]
#[ignore = "reads ../shared/data"]
fn textures_are_found_beside_or_missed() {
    let folder = tempfile::tempdir().unwrap();
    let scan = write_objects(&folder.path().join("scan"), None);
    let mut options = ScanOptions::default();
    options.texture_size = Some(128);
    let inputs = [scan.to_string_lossy().into_owned()];
    let run = |out: &str| register(&inputs, &options, &folder.path().join(out), &Job::silent());
    // Nothing has a colour: it is said, for colours are what stops the template from sliding.
    let report = run("bare").unwrap();
    assert!(report.texture_size.is_none(), "{:?}", report.texture_size);
    let told = report.warnings.iter().find(|warning| warning.code == "W_SCAN_COLOURLESS").unwrap().to_string();
    assert!(told.contains("the frames have neither") && told.contains("--texture"), "{told}");
    // Numbered like the frames, without being named.
    for k in 0..3 {
        let picture = image::RgbImage::from_fn(64, 64, |x, y| image::Rgb([4 * x as u8, 4 * y as u8, 60 * k]));
        picture.save(scan.join(format!("frame_{k:03}.png"))).unwrap();
    }
    let report = run("textured").unwrap();
    assert_eq!((report.texture_size, report.lost.len()), (Some(128), 0));
    assert!(!codes(&report).contains(&"W_SCAN_COLOURLESS"));
    // Named, and not there.
    let other = write_objects(&folder.path().join("other"), Some("skin.mtl"));
    fs::write(other.join("skin.mtl"), "newmtl skin\nmap_Kd gone.png\n").unwrap();
    let out = folder.path().join("missed");
    let error = register(&[other.to_string_lossy().into_owned()], &options, &out, &Job::silent()).unwrap_err();
    assert_eq!((error.code(), out.exists()), ("E_TEXTURE_MISSING", false));
    let message = error.to_string();
    assert!(["frame_000.obj", "gone.png", "--texture"].iter().all(|part| message.contains(part)), "{message}");
}
