//! The command line: exit codes, what is on stdout, and that no output is half-written.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn builder(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).output().unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A few frames of a tetrahedron that turns.
fn write_frames(folder: &Path, count: usize) {
    fs::create_dir_all(folder).unwrap();
    for frame in 0..count {
        let (sin, cos) = (0.1 * frame as f32).sin_cos();
        let text = format!(
            "v 0 0 0\nv {cos} 0 {sin}\nv 0 1 0\nv {} 0.5 {}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
            -sin + 0.2 * (0.3 * frame as f32).sin(),
            cos
        );
        fs::write(folder.join(format!("frame_{frame:03}.obj")), text).unwrap();
    }
}

#[test]
fn slope_limits_that_no_kernel_has_are_refused() {
    for slope in ["0", "6", "many"] {
        let refused = builder(&["pack", "nowhere", "-o", "nothing.reprise", "--slope", slope]);
        assert_eq!(code(&refused), 2, "{}", stderr(&refused));
        assert!(stderr(&refused).contains("from 1 to 5, or none"), "{}", stderr(&refused));
    }
    // These are refused for the missing input only.
    for slope in ["1", "5", "none"] {
        let refused = builder(&["pack", "nowhere", "-o", "nothing.reprise", "--slope", slope]);
        assert_eq!(code(&refused), 1, "{}", stderr(&refused));
    }
}

#[test]
fn packs_inspects_and_validates() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("turn");
    write_frames(&frames, 60);
    let bundle = folder.path().join("turn.reprise");
    let (frames, bundle) = (frames.to_str().unwrap(), bundle.to_str().unwrap());

    let packed = builder(&["pack", frames, "-o", bundle, "--fps", "30", "--json", "--threads", "1"]);
    assert_eq!(code(&packed), 0, "{}", stderr(&packed));
    let report: Value = serde_json::from_slice(&packed.stdout).unwrap();
    assert_eq!(report["capture"]["frames"], 60);
    for stage in ["import", "distances", "graph", "appearance", "bundle"] {
        assert!(report["seconds"][stage].is_number(), "{stage}");
    }
    assert_eq!(report["bundle"]["bytes"], fs::metadata(bundle).unwrap().len());

    let inspected = builder(&["inspect", bundle, "--json"]);
    let found: Value = serde_json::from_slice(&inspected.stdout).unwrap();
    assert_eq!((found["kind"].as_str(), found["capture"]["vertices"].as_u64()), (Some("bundle"), Some(4)));
    let input: Value = serde_json::from_slice(&builder(&["inspect", frames, "--json"]).stdout).unwrap();
    assert_eq!((input["kind"].as_str(), input["capture"]["frames"].as_u64()), (Some("input"), Some(60)));

    assert_eq!(code(&builder(&["validate", bundle])), 0);
    let mut damaged = fs::read(bundle).unwrap();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(bundle, damaged).unwrap();
    let validated = builder(&["validate", bundle, "--json"]);
    assert_eq!(code(&validated), 1);
    let findings: Value = serde_json::from_slice(&validated.stdout).unwrap();
    assert_eq!(findings[0]["code"], "damaged");
}

#[test]
fn a_similarity_that_textures_do_not_reach_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (capture, bundle) = (path("capture"), path("actor.reprise"));
    let small = ["--frames", "20", "--vertices", "1500", "--texture-size", "128", "--artefacts", "drift,light"];
    let performed = builder(&[&["performer", "-o", &capture], &small[..]].concat());
    assert_eq!(code(&performed), 0, "{}", stderr(&performed));
    let pack = |ssim: &str| -> Value {
        let wanted = ["--appearance-ssim", ssim, "--appearance-components", "4"];
        let packed = builder(&[&["pack", &capture, "-o", &bundle, "--json"], &wanted[..]].concat());
        assert_eq!(code(&packed), 0, "{}", stderr(&packed));
        serde_json::from_slice(&packed.stdout).unwrap()
    };
    let warning = |report: &Value| -> Option<String> {
        let warnings = report["warnings"].as_array().unwrap();
        let warning = warnings.iter().find(|warning| warning["code"] == "W_APPEARANCE_SSIM")?;
        Some(warning["message"].as_str().unwrap().to_owned())
    };
    let (reached, missed) = (pack("0.8"), pack("0.9999"));
    let figure = |report: &Value, name: &str| report["appearance"]["stored"][name].as_f64().unwrap();
    assert!(figure(&reached, "ssim") >= 0.8 && figure(&missed, "ssim") < 0.9999);
    assert!(figure(&reached, "ssim") < figure(&missed, "ssim"));
    assert_eq!(warning(&reached), None);
    let message = warning(&missed).unwrap();
    let bytes = format!("{:.0} bytes a frame", figure(&missed, "bytes_per_frame"));
    assert!(message.contains("0.9999") && message.contains(&bytes) && message.contains("more components"), "{message}");
    // The bundle holds what was measured.
    let in_bundle = &reached["bundle"]["appearance"]["bytes_per_frame"];
    assert_eq!(in_bundle, &reached["appearance"]["stored"]["bytes_per_frame"], "{}", reached["bundle"]);
}

#[test]
fn bad_input_is_exit_code_1_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("turn");
    write_frames(&frames, 20);
    fs::write(frames.join("frame_007.obj"), "v 0 0 0\nv 1 0 nan\nv 0 1 0\nv 0 0 1\nf 1 3 2\n").unwrap();
    let bundle = folder.path().join("turn.reprise");
    let packed = builder(&["pack", frames.to_str().unwrap(), "-o", bundle.to_str().unwrap()]);
    assert_eq!(code(&packed), 1);
    assert!(stderr(&packed).contains("frame_007.obj"), "{}", stderr(&packed));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "something was left behind");
    assert_eq!(code(&builder(&["pack", "no-such-folder", "-o", bundle.to_str().unwrap()])), 1);
    assert_eq!(code(&builder(&["validate", "no-such-file"])), 1);
}

#[test]
fn inputs_are_validated_with_codes() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("turn");
    write_frames(&frames, 20);
    let path = frames.to_str().unwrap();
    let codes = |path: &str| {
        let validated = builder(&["validate", path, "--json"]);
        let findings: Value = serde_json::from_slice(&validated.stdout).unwrap();
        let codes = findings.as_array().unwrap().iter().map(|f| f["code"].as_str().unwrap().to_owned());
        (code(&validated), codes.collect::<Vec<_>>())
    };
    assert_eq!(codes(path), (0, vec!["W_FPS_ASSUMED".to_owned()]));
    fs::remove_file(frames.join("frame_011.obj")).unwrap();
    assert_eq!(codes(path), (0, vec!["W_FRAMES_MISSING".to_owned(), "W_FPS_ASSUMED".to_owned()]));
    fs::write(frames.join("frame_011.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    // Packing would take it for a scan.
    let said = ["W_SCAN_REGISTERED", "W_FPS_ASSUMED", "W_SCAN_LOST"].map(str::to_owned);
    assert_eq!(codes(path), (0, said.to_vec()));
    let bad = folder.path().join("damaged.reprise");
    fs::write(&bad, b"anything else").unwrap();
    assert_eq!(codes(bad.to_str().unwrap()), (1, vec!["not-reprise".to_owned()]));
}

#[test]
fn bad_usage_is_exit_code_2() {
    assert_eq!(code(&builder(&[])), 2);
    assert_eq!(code(&builder(&["pack"])), 2);
    assert_eq!(code(&builder(&["pack", "x", "-o", "y", "--alpha", "-1"])), 2);
    assert_eq!(code(&builder(&["pack", "x", "-o", "y", "--threads", "0"])), 2);
    assert_eq!(code(&builder(&["--version"])), 0);
}

/// Frames of a square that bends, with texture coordinates, and a texture beside each.
fn write_textured(folder: &Path, count: usize) {
    fs::create_dir_all(folder).unwrap();
    for frame in 0..count {
        let bend = 0.3 * (0.4 * frame as f32).sin() + 0.02 * frame as f32;
        let text = format!(
            "v 0 0 0\nv 1 0 {bend}\nv 1 1 0\nv 0 1 {}\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n",
            0.5 * bend
        );
        fs::write(folder.join(format!("f_{frame:03}.obj")), text).unwrap();
        let pixel = |x: u32, y: u32| image::Rgb([(40 * (x / 4) + 5 * y) as u8, (9 * x) as u8, (3 * frame + 90) as u8]);
        let picture = image::RgbImage::from_fn(32, 32, pixel);
        picture.save(folder.join(format!("f_{frame:03}.png"))).unwrap();
    }
}

/// The codes of a command's findings: what `validate` lists, or the warnings of what `pack` and `inspect` print.
fn codes_of(output: &Output) -> Vec<String> {
    let found: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", stderr(output)));
    let list = if found.is_array() { &found } else { &found["warnings"] };
    let codes = list.as_array().unwrap().iter().map(|finding| finding["code"].as_str().unwrap().to_owned());
    // What only the long stages find out.
    codes.filter(|code| code != "W_UNREACHABLE" && code != "W_APPEARANCE_SSIM").collect()
}

#[test]
fn validate_and_inspect_say_what_pack_says() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("sheet");
    write_textured(&frames, 24);
    // One texture with a hole, and one that is lost.
    let hole =
        image::RgbaImage::from_fn(32, 32, |x, y| image::Rgba([200, 90, 40, if x < 8 && y < 8 { 0 } else { 255 }]));
    hole.save(frames.join("f_004.png")).unwrap();
    fs::remove_file(frames.join("f_009.png")).unwrap();
    let (path, bundle) = (frames.to_str().unwrap(), folder.path().join("sheet.reprise"));
    let bundle = bundle.to_str().unwrap();
    let pack = || builder(&["pack", path, "-o", bundle, "--json"]);
    let validate = || builder(&["validate", path, "--json"]);
    let inspect = || builder(&["inspect", path, "--json"]);

    let packed = pack();
    assert_eq!(code(&packed), 0, "{}", stderr(&packed));
    let expected = ["W_FPS_ASSUMED", "W_TEXTURE_LOST", "W_TEXTURE_HOLES"];
    assert_eq!(codes_of(&packed), expected);
    assert_eq!((code(&validate()), codes_of(&validate())), (0, expected.map(str::to_owned).to_vec()));
    assert_eq!((code(&inspect()), codes_of(&inspect())), (0, expected.map(str::to_owned).to_vec()));

    // A texture whose header is sound and whose rest is cut off: all three refuse it, and name it.
    fs::remove_file(bundle).unwrap();
    let whole = fs::read(frames.join("f_015.png")).unwrap();
    fs::write(frames.join("f_015.png"), &whole[..whole.len() / 2]).unwrap();
    for output in [pack(), validate(), inspect()] {
        assert_eq!(code(&output), 1);
        let said = stderr(&output) + &String::from_utf8_lossy(&output.stdout);
        assert!(said.contains("f_015.png"), "{said}");
    }
    assert!(codes_of(&validate()).contains(&"E_APPEARANCE".to_owned()));
    assert!(!Path::new(bundle).exists());
}

#[test]
fn what_cannot_be_packed_is_refused_by_validate_and_inspect() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let square = |name: &str, size: f32, away: f32| {
        let text = format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {away}\nf 1 2 3\nf 1 3 2\n");
        fs::create_dir_all(path.join(name)).unwrap();
        text
    };
    // A vertex that flies off, and a surface without area in the third frame.
    for frame in 0..12 {
        let far = square("far", 1.0, if frame == 5 { 90_000.0 } else { 1.0 });
        fs::write(path.join(format!("far/f_{frame:02}.obj")), far).unwrap();
        let flat = square("flat", if frame == 2 { 0.0 } else { 1.0 }, 1.0);
        fs::write(path.join(format!("flat/f_{frame:02}.obj")), flat).unwrap();
    }
    for (name, said) in [("far", "frame 5 of sequence \"far\": vertex 3"), ("flat", "f_02.obj, frame 2")] {
        let input = path.join(name);
        let input = input.to_str().unwrap();
        let bundle = path.join("x.reprise");
        let all = [
            builder(&["pack", input, "-o", bundle.to_str().unwrap()]),
            builder(&["validate", input]),
            builder(&["inspect", input]),
        ];
        for output in all {
            let told = stderr(&output) + &String::from_utf8_lossy(&output.stdout);
            assert!(code(&output) == 1 && told.contains(said), "{told}");
        }
        assert!(!bundle.exists());
    }
}

#[test]
fn sequences_without_a_way_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = ["turn", "short"].map(|name| folder.path().join(name));
    write_frames(&inputs[0], 40);
    write_frames(&inputs[1], 4);
    let bundle = folder.path().join("x.reprise");
    let [turn, short] = inputs.each_ref().map(|path| path.to_str().unwrap());
    let packed = builder(&["pack", turn, short, "-o", bundle.to_str().unwrap(), "--fps", "30", "--json"]);
    assert_eq!(code(&packed), 0, "{}", stderr(&packed));
    let report: Value = serde_json::from_slice(&packed.stdout).unwrap();
    let message = |code: &str| {
        let warnings = report["warnings"].as_array().unwrap();
        let warning = warnings.iter().find(|warning| warning["code"] == code).unwrap_or_else(|| panic!("{warnings:?}"));
        warning["message"].as_str().unwrap().to_owned()
    };
    assert!(message("W_SEQUENCE_SHORT").contains("1 of 2 sequences"), "{}", message("W_SEQUENCE_SHORT"));
    let unreachable = message("W_UNREACHABLE");
    assert!(unreachable.contains("nothing leads from turn, short to any other sequence"), "{unreachable}");
    assert!(stderr(&packed).contains(&unreachable), "{}", stderr(&packed));
}

#[test]
fn loops_are_found_or_named_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("swing");
    fs::create_dir_all(&frames).unwrap();
    for frame in 0..24 {
        let (sin, cos) = (std::f32::consts::TAU * frame as f32 / 24.0).sin_cos();
        let text = format!(
            "v 0 0 0\nv 1 0 0\nv {} {} 0.3\nv 0.2 0.1 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
            0.3 * sin,
            1.0 + 0.3 * cos
        );
        fs::write(frames.join(format!("f_{frame:02}.obj")), text).unwrap();
    }
    let path = frames.to_str().unwrap();
    let cyclic = |arguments: &[&str]| -> bool {
        let inspected = builder(&[&["inspect", path, "--json"], arguments].concat());
        let found: Value = serde_json::from_slice(&inspected.stdout).unwrap();
        found["sequences"][0]["cyclic"].as_bool().unwrap()
    };
    assert!(cyclic(&[]) && cyclic(&["--cyclic", "auto"]) && cyclic(&["--cyclic", "swing"]));
    assert!(!cyclic(&["--cyclic", "none"]));
    let unknown = builder(&["inspect", path, "--cyclic", "walk"]);
    assert!(code(&unknown) == 1 && stderr(&unknown).contains("swing"), "{}", stderr(&unknown));
}

#[test]
fn a_pack_has_variations_where_nothing_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("turn");
    write_frames(&frames, 60);
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let pack = |output: &str, more: &[&str]| -> Value {
        let packed = builder(
            &[&["pack", frames.to_str().unwrap(), "-o", &path(output), "--fps", "25", "--json"], more].concat(),
        );
        assert_eq!(code(&packed), 0, "{}", stderr(&packed));
        serde_json::from_slice(&packed.stdout).unwrap()
    };
    let usual = pack("one.reprise", &["--threads", "1"]);
    assert!(usual["alternatives"]["alternatives"].as_u64() >= Some(8), "{usual}");
    assert!(usual["seconds"]["variations"].is_number());
    pack("two.reprise", &["--threads", "2"]);
    assert_eq!(fs::read(path("one.reprise")).unwrap(), fs::read(path("two.reprise")).unwrap());
    // As `vary` makes them.
    let varied = builder(&["vary", frames.to_str().unwrap(), "-o", &path("varied.reprise"), "--fps", "25"]);
    assert_eq!(code(&varied), 0, "{}", stderr(&varied));
    assert_eq!(fs::read(path("one.reprise")).unwrap(), fs::read(path("varied.reprise")).unwrap());
    let plain = pack("plain.reprise", &["--no-variations"]);
    assert!(plain["alternatives"].is_null() && plain["variations"].is_null(), "{plain}");
    assert_eq!(plain["graph"], usual["graph"], "the graph stays as it is");

    // What cannot be varied is packed without a word.
    let short = folder.path().join("short");
    write_frames(&short, 2);
    let packed = builder(&["pack", short.to_str().unwrap(), "-o", &path("short.reprise"), "--fps", "25", "--json"]);
    assert_eq!(code(&packed), 0, "{}", stderr(&packed));
    assert!(!stderr(&packed).contains("VARIATION"), "{}", stderr(&packed));
}

#[test]
fn variations_are_packed_beside_what_they_vary() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("turn");
    write_frames(&frames, 60);
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let vary = |output: &str, more: &[&str]| {
        let output = path(output);
        let usual = ["vary", frames.to_str().unwrap(), "-o", &output, "--fps", "25", "--count", "2", "--json"];
        builder(&[&usual[..], more].concat())
    };
    let varied = vary("one.reprise", &["--threads", "1"]);
    assert_eq!(code(&varied), 0, "{}", stderr(&varied));
    let report: Value = serde_json::from_slice(&varied.stdout).unwrap();
    assert_eq!((report["capture"]["frames"].as_u64(), report["capture"]["sequences"].as_u64()), (Some(60), Some(1)));
    let stored = &report["alternatives"];
    assert!(stored["stretches"].as_u64() > Some(0) && stored["alternatives"].as_u64() > Some(1), "{stored}");
    assert!(stored["error"].as_f64().unwrap() < 1e-3 && stored["bytes"].as_u64() > Some(0), "{stored}");
    let told = &report["variations"][0];
    assert_eq!((told["name"].as_str(), told["variations"].as_u64()), (Some("turn"), Some(2)));
    assert!(told["distance"].as_f64().unwrap() > 1e-4 && told["acceleration"].as_f64().unwrap() < 1.2, "{told}");
    assert_eq!(code(&vary("two.reprise", &["--threads", "2"])), 0);
    assert_eq!(fs::read(path("one.reprise")).unwrap(), fs::read(path("two.reprise")).unwrap());
    assert_eq!(code(&vary("other.reprise", &["--seed", "2"])), 0);
    assert_ne!(fs::read(path("one.reprise")).unwrap(), fs::read(path("other.reprise")).unwrap());

    let apart = vary("apart.reprise", &["--as-sequences"]);
    let report: Value = serde_json::from_slice(&apart.stdout).unwrap();
    assert_eq!((report["capture"]["frames"].as_u64(), report["capture"]["sequences"].as_u64()), (Some(180), Some(3)));
    assert!(report["alternatives"].is_null() && report["variations"][0]["variations"].as_u64() == Some(2));

    // Films show them, too.
    let film = |variety: &str| {
        let output = path(&format!("film{variety}.glb"));
        let one = path("one.reprise");
        let done = builder(&["direct", &one, "--to", "50", "--variety", variety, "-o", &output]);
        assert_eq!(code(&done), 0, "{}", stderr(&done));
        fs::read(output).unwrap()
    };
    assert_ne!(film("0"), film("1"));

    let unknown = vary("none.reprise", &["--sequences", "walk"]);
    assert_eq!(code(&unknown), 1);
    assert!(stderr(&unknown).contains("there is no sequence \"walk\"; there are: turn"), "{}", stderr(&unknown));
    assert_eq!(code(&vary("none.reprise", &["--amount", "0"])), 2);
    assert!(!Path::new(&path("none.reprise")).exists());
}
