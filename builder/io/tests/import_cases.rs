//! Inputs built after public bug reports (`../shared/data/cases`): what is right for each, against the control, which is the
//! same body in files without anything unusual.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, end a test by panicking")]

mod import_support;

use job::Job;
use std::path::{Path, PathBuf};
use std::process::Command;

use capture_io::import::{Cyclic, ImportError, ImportOptions, Imported, import};
use fixtures::data;
use glam::DVec3;
use import_support::check;

/// The folder of all cases, unpacked once beside the test's own program.
fn cases() -> PathBuf {
    let program = std::env::current_exe().unwrap();
    let folder = program.ancestors().nth(2).unwrap().join("tmp/cases");
    if !folder.exists() {
        // Unpacked elsewhere and renamed, so that tests which run at the same time never see half of it.
        let beside = folder.with_extension(format!("{}.{:?}", std::process::id(), std::thread::current().id()));
        std::fs::create_dir_all(&beside).unwrap();
        let archive = data().join("cases/cases.tar.xz");
        let status = Command::new("tar").arg("-xJf").arg(&archive).arg("-C").arg(&beside).status().unwrap();
        assert!(status.success(), "tar could not unpack {}", archive.display());
        if std::fs::rename(&beside, &folder).is_err() {
            assert!(folder.exists());
            std::fs::remove_dir_all(&beside).unwrap();
        }
    }
    folder
}

fn options() -> ImportOptions {
    ImportOptions { fps: Some(24.0), cyclic: Cyclic::None, ..ImportOptions::default() }
}

fn try_with(input: &str, options: &ImportOptions) -> Result<Imported, ImportError> {
    import(&[cases().join(input).to_str().unwrap().to_owned()], options, &Job::silent())
}

fn read(input: &str) -> Imported {
    let imported = try_with(input, &options()).unwrap_or_else(|error| panic!("{input}: {error}"));
    check(&imported);
    imported
}

fn refusal(input: &str) -> (&'static str, String) {
    match try_with(input, &options()) {
        Ok(_) => panic!("{input} was read"),
        Err(error) => (error.code(), error.to_string()),
    }
}

fn codes(imported: &Imported) -> Vec<&str> {
    imported.warnings.iter().map(|warning| warning.code).collect()
}

/// The one sequence of 24 frames in which every vertex is within `tolerance` metres of the control's, after `shift`.
fn assert_moves_like_control(imported: &Imported, shift: DVec3, tolerance: f64) {
    let control = read("00-control");
    let sequences = imported.capture.timeline.sequences();
    assert_eq!(sequences.iter().map(|s| s.frame_count).collect::<Vec<_>>(), [24]);
    for frame in 0..24 {
        let (found, expected) = (imported.capture.poses.frame(frame), control.capture.poses.frame(frame));
        for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
            let off = (found.as_dvec3() + shift).distance(expected.as_dvec3());
            assert!(off < tolerance, "frame {frame}, vertex {k}: {off} m");
        }
    }
    assert!(imported.capture.topology.triangles().len() == control.capture.topology.triangles().len());
}

fn is_control(input: &str) -> Imported {
    let imported = read(input);
    assert_moves_like_control(&imported, DVec3::ZERO, 2e-6);
    imported
}

/// The bytes of the texture of the first material.
fn texture(imported: &Imported) -> Option<&[u8]> {
    let image = imported.capture.surface.materials[0].image?;
    Some(&imported.capture.surface.images[image as usize].bytes)
}

fn file(name: &str) -> Vec<u8> {
    std::fs::read(cases().join(name)).unwrap()
}

/// The names of the textures of all frames.
fn worn(imported: &Imported) -> Vec<String> {
    let textures = imported.frame_textures.as_ref().unwrap();
    textures.iter().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_01_comments_that_end_in_a_backslash_swallow_nothing() {
    for variant in ["a-before-v", "b-before-mtllib", "d-before-faces", "e-before-mtllib-two-images"] {
        let name = format!("01-comment-backslash/{variant}");
        let imported = is_control(&name);
        if variant != "d-before-faces" {
            assert_eq!(texture(&imported).unwrap(), file(&format!("{name}/skin.png")), "{variant}");
        }
    }
    let loose = read("01-comment-backslash/c-loose-last-vertex");
    assert_eq!(loose.capture.topology.vertex_count(), 67);
    assert_moves_like_control(&loose, DVec3::ZERO, 2e-6);
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_02_byte_order_marks_are_skipped() {
    for variant in ["a-mtllib-first", "d-bom-in-mtl"] {
        let name = format!("02-bom/{variant}");
        let imported = is_control(&name);
        assert_eq!(texture(&imported).unwrap(), file(&format!("{name}/skin_albedo.png")), "{variant}");
    }
    // These name no library and have no texture coordinates.
    is_control("02-bom/b-vertex-first");
    let loose = is_control("02-bom/c-vertex-first-loose-last");
    assert_eq!(loose.capture.topology.vertex_count(), 67);
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_03_vertex_colours_have_opacity_or_go_to_255() {
    let all = |name: &str| {
        let imported = is_control(name);
        let colours: std::collections::HashSet<_> = imported.capture.surface.corners.iter().map(|c| c.colour).collect();
        (colours.into_iter().collect::<Vec<_>>(), codes(&imported).contains(&"W_COLOUR_RANGE"))
    };
    assert_eq!(all("03-vertex-rgba"), (vec![[255, 0, 0, 128]], false));
    assert_eq!(all("03-vertex-rgba-rgb"), (vec![[255, 0, 0, 255]], false));
    assert_eq!(all("03-vertex-rgba-rgb-brown-255"), (vec![[120, 60, 30, 255]], true));
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_04_comments_stand_behind_data() {
    is_control("04-trailing-comments/v");
    is_control("04-trailing-comments/f");
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_05_every_frame_wears_its_own_texture() {
    let own: Vec<String> = (0..24).map(|k| format!("colour_{k:04}.png")).collect();
    for variant in ["own-mtl", "one-mtl", "usemtl-first"] {
        let imported = is_control(&format!("05-texture-per-frame/{variant}"));
        assert_eq!(worn(&imported), own, "{variant}");
        assert_eq!(imported.warnings, [], "{variant}");
    }
    let mut lost = own.clone();
    lost[15].clone_from(&own[14]);
    for (variant, code) in [("mtl-missing", "W_MATERIAL_MISSING"), ("png-missing", "W_TEXTURE_LOST")] {
        let imported = is_control(&format!("05-texture-per-frame/{variant}"));
        assert_eq!(worn(&imported), lost, "{variant}");
        let told = |code: &str| imported.warnings.iter().any(|w| w.code == code && w.contains("walk_0015.obj"));
        assert!(told(code) && told("W_TEXTURE_LOST"), "{:?}", imported.warnings);
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_06_textures_are_paired_by_number() {
    let imported = read("06-texture-gaps");
    let numbers = (1..=24).filter(|&n| n != 5);
    let expected: Vec<String> = numbers.map(|n| format!("tex_{:04}.png", if n == 20 { 19 } else { n })).collect();
    assert_eq!(worn(&imported), expected);
    for (code, said) in [
        ("W_FRAMES_MISSING", "missing 5 (between 4 and 6)"),
        ("W_TEXTURE_LOST", "walk_0020.obj"),
        ("W_TEXTURES_UNUSED", "tex_0005.png"),
    ] {
        assert!(
            imported.warnings.iter().any(|w| w.code == code && w.contains(said)),
            "{code}: {:?}",
            imported.warnings
        );
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_07_and_08_numbers_may_be_negative_or_in_brackets() {
    for name in ["07-negative-numbers", "08-number-inside-windows"] {
        assert_eq!(is_control(name).warnings, [], "{name}");
    }
    let pattern = read("07-negative-numbers/walk_%04d.obj:-6:17");
    assert_moves_like_control(&pattern, DVec3::ZERO, 2e-6);
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_15_one_glb_a_frame_is_one_sequence() {
    is_control("15-glb-per-frame");
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_16_places_on_a_map_are_moved_to_the_origin() {
    let utm = read("16-utm-obj");
    assert_eq!(utm.offset, DVec3::new(432_187.0, 13.0, 583_922.0));
    assert_moves_like_control(&utm, utm.offset - DVec3::new(432_187.25, 12.5, 583_921.75), 2e-6);
    for far in [1000.0, 10_000.0, 50_000.0, 100_000.0, 200_000.0] {
        let imported = read(&format!("16-far-from-origin/{far}"));
        assert!(codes(&imported).contains(&"W_RECENTRED"), "{:?}", imported.warnings);
        let base = DVec3::new(far, 0.0, far);
        let first = imported.capture.poses.frame(0)[0].as_dvec3() + imported.offset;
        assert!(first.distance(base) < 1.0, "{first}");
        assert_moves_like_control(&imported, imported.offset - first, 2e-6);
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_19_and_20_ply_files_of_all_kinds() {
    for variant in [
        "blank-line-after-header",
        "cr-ascii",
        "cr-binary",
        "crlf-ascii",
        "crlf-binary",
        "lf-ascii",
        "lf-binary",
        "cr-obj",
    ] {
        let imported = is_control(&format!("19-ply-line-ends/{variant}"));
        assert_eq!(imported.warnings, [], "{variant}");
    }
    for variant in ["face-first", "scalar-first", "ushort", "vertex-list"] {
        assert_eq!(is_control(&format!("20-ply-properties/{variant}")).warnings, [], "{variant}");
    }
    assert_eq!(codes(&is_control("20-ply-properties/face-colour")), ["W_FACE_COLOURS"]);
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_22_and_30_folders_and_files_of_any_name() {
    is_control("22-brackets/capture [final]");
    is_control("22-brackets/capture [final]/walk/*.obj");
    is_control("22-brackets/capture [final]/walk");
    for name in ["30-names/Tänzerin 走る é", "30-names-latin1"] {
        let imported = is_control(name);
        assert_eq!(texture(&imported).unwrap(), file(&format!("{name}/Haut größe.png")), "{name}");
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_23_a_texture_on_another_machine_is_found_beside() {
    let imported = is_control("23-absolute-map");
    assert_eq!(texture(&imported).unwrap(), file("23-absolute-map/skin.png"));
    assert_eq!(codes(&imported), ["W_FILE_MOVED"]);
    // The option wins, and then it does not matter what the library names.
    let other = cases().join("26-emissive-only/skin.png").to_str().unwrap().to_owned();
    let imported = try_with("23-absolute-map", &ImportOptions { texture: Some(other), ..options() }).unwrap();
    assert_eq!(texture(&imported).unwrap(), file("26-emissive-only/skin.png"));
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_27_images_beside_frames_are_paired_or_told() {
    let named =
        |prefix: &str, digits: usize| -> Vec<String> { (0..24).map(|k| format!("{prefix}{k:0digits$}.png")).collect() };
    assert_eq!(worn(&is_control("27-images-beside/same-stem")), named("take_", 4));
    assert_eq!(worn(&is_control("27-images-beside/other-padding")), named("take_", 1));
    let guessed = is_control("27-images-beside/other-name");
    assert_eq!((worn(&guessed), codes(&guessed)), (named("take_tex_", 4), vec!["W_TEXTURES_GUESSED"]));
    let lost = is_control("27-images-beside/one-missing");
    let mut expected = named("take_", 4);
    expected[15] = expected[14].clone();
    assert_eq!((worn(&lost), codes(&lost)), (expected, vec!["W_TEXTURE_LOST"]));
}

#[test]
#[ignore = "reads ../shared/data"]
fn case_28_and_29_frames_that_cannot_be_used_are_named() {
    for (variant, code, said) in [
        ("nan", "E_NOT_FINITE", "vertex 30"),
        ("inf", "E_NOT_FINITE", "vertex 30"),
        ("big", "E_NOT_FINITE", "vertex 30"),
        ("neg", "E_SYNTAX", "\"-nan(ind)\" is not a number"),
        ("msvc", "E_SYNTAX", "\"1.#QNAN\" is not a number"),
        ("comma", "E_SYNTAX", "decimals are written with a point"),
    ] {
        let (found, message) = refusal(&format!("28-nan/{variant}"));
        assert!(found == code && message.contains("w_002.obj") && message.contains(said), "{variant}: {message}");
    }
    for (name, frame) in [("appear", "appear.glb, frame 0"), ("vanish", "vanish.glb, frame 23")] {
        let (code, message) = refusal(&format!("29-scale-from-zero/{name}.glb"));
        assert!(code == "E_COLLAPSED" && message.contains(frame), "{message}");
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn loops_of_characters_are_found() {
    let clips = |path: &Path| {
        let options = ImportOptions::default();
        let imported = import(&[path.to_str().unwrap().to_owned()], &options, &Job::silent()).unwrap();
        check(&imported);
        let sequences = imported.capture.timeline.sequences().iter();
        let (loops, others): (Vec<_>, Vec<_>) = sequences.partition(|sequence| sequence.cyclic);
        let names = |of: Vec<&actor::timeline::Sequence>| of.iter().map(|s| s.name.clone()).collect::<Vec<_>>();
        let told = imported.warnings.iter().find(|warning| warning.code == "W_CYCLIC").unwrap().message.clone();
        let (loops, others) = (names(loops), names(others));
        assert!(loops.iter().all(|name| told.contains(name.as_str())), "{told}");
        (loops, others)
    };
    let (loops, others) = clips(&data().join("gltf/kaykit-knight/Knight.glb"));
    for name in ["Idle", "Walking_A", "Walking_B", "Walking_C", "Walking_Backwards", "Running_A", "Jump_Idle"] {
        assert!(loops.iter().any(|found| found == name), "{name} is no loop");
    }
    for name in ["Death_A", "Jump_Start", "Jump_Land", "Lie_Down", "Lie_StandUp", "Sit_Chair_Down", "T-Pose"] {
        assert!(others.iter().any(|found| found == name), "{name} is a loop");
    }
    let (loops, others) = clips(&data().join("gltf/fox/Fox.glb"));
    assert_eq!((loops, others), (vec!["Survey".to_owned(), "Walk".into(), "Run".into()], vec![]));
    // A row of poses that ends where it begins is one, too.
    let (loops, others) = clips(&data().join("gltf/lumberjack/lumberjack.glb"));
    assert_eq!((loops, others), (vec!["Walk".to_owned(), "Poses".into()], vec!["A-pose".to_owned()]));
    let (loops, others) = clips(&data().join("gltf/robot-expressive/RobotExpressive.glb"));
    assert_eq!(others, ["Death", "Sitting", "Standing"]);
    for name in ["Dance", "Idle", "Jump", "Running", "Walking", "Wave"] {
        assert!(loops.iter().any(|found| found == name), "{name} is no loop");
    }
    assert_eq!(clips(&data().join("gltf/cesium-man/CesiumMan.glb")).0, ["CesiumMan"]);
}

/// The pose that closes a loop is left out, so that going round shows no pose twice and skips none: the step over the end is as
/// long as those within.
#[test]
#[ignore = "reads ../shared/data"]
fn going_round_a_loop_is_as_even_as_the_loop() {
    let path = data().join("gltf/fox/Fox.glb").to_str().unwrap().to_owned();
    let with = |cyclic: Cyclic| {
        let options = ImportOptions { cyclic, ..ImportOptions::default() };
        import(std::slice::from_ref(&path), &options, &Job::silent()).unwrap().capture
    };
    let (closed, open) = (with(Cyclic::Auto), with(Cyclic::None));
    for (round, whole) in closed.timeline.sequences().iter().zip(open.timeline.sequences()) {
        assert_eq!((round.cyclic, whole.cyclic, round.frame_count + 1), (true, false, whole.frame_count));
        let step = |from: u32, to: u32| {
            let (a, b) = (closed.poses.frame(from), closed.poses.frame(to));
            (a.iter().zip(b).map(|(a, b)| f64::from(a.distance_squared(*b))).sum::<f64>() / a.len() as f64).sqrt()
        };
        let last = round.end_frame() - 1;
        let longest = (round.first_frame..last).map(|frame| step(frame, frame + 1)).fold(0.0, f64::max);
        let wrap = step(last, round.first_frame);
        assert!(wrap > 0.0 && wrap <= longest, "{}: {wrap} over the end, {longest} within", round.name);
        // What was left out is the first pose, within a thousandth of the 190 units of the fox.
        let (first, repeated) = (open.poses.frame(whole.first_frame), open.poses.frame(whole.end_frame() - 1));
        assert!(first.iter().zip(repeated).all(|(a, b)| a.distance(*b) < 0.2));
    }
}

#[test]
#[ignore = "reads ../shared/data"]
fn takes_of_a_stage_are_no_loops() {
    for name in ["crane", "jumping"] {
        let files = fixtures::unpacked(name);
        let folder = files[0].parent().unwrap().to_str().unwrap().to_owned();
        let imported = import(&[folder], &ImportOptions::default(), &Job::silent()).unwrap();
        assert!(imported.capture.timeline.sequences().iter().all(|sequence| !sequence.cyclic), "{name}");
        assert!(!codes(&imported).contains(&"W_CYCLIC"), "{name}");
    }
}
