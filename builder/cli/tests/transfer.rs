//! `builder transfer`: the man walks as the woman does.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use reprise::transfer::{KeyFile, KeyPair};
use serde_json::Value;

fn builder(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).current_dir(folder).output().unwrap()
}

fn done(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn refused(output: &Output, words: &str) {
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains(words), "{told}");
}

fn keys(folder: &Path, pairs: &[(&str, u32, &str, u32)]) {
    let pair = |(from, from_frame, to, to_frame): &(&str, u32, &str, u32)| {
        format!("[[pair]]\nfrom = {from:?}\nfrom_frame = {from_frame}\nto = {to:?}\nto_frame = {to_frame}\n")
    };
    fs::write(folder.join("keys.toml"), pairs.iter().map(pair).collect::<String>()).unwrap();
}

#[test]
fn what_the_page_of_key_poses_writes_is_read() {
    // The page's own tests check that it writes exactly this.
    let text = include_str!("../../../tests/browser/fixtures/keys.toml");
    let keys: KeyFile = toml::from_str(text).unwrap();
    let pair = |from: &str, from_frame: u32, to: &str, to_frame: u32, stretch: Option<&str>| KeyPair {
        from: from.into(),
        from_frame,
        to: to.into(),
        to_frame,
        stretch: stretch.map(Into::into),
    };
    let expected = [
        pair("walk", 3, "walk", 5, None),
        pair("walk", 40, "walk", 44, None),
        pair("walk", 77, "walk", 90, None),
        pair("turn \"left\"", 0, "Drehung \\ links", u32::MAX, Some("über\tden Zaun")),
        pair("it's", 12, "", 0, Some("'one'")),
    ];
    assert_eq!(keys.pairs, expected);
}

#[test]
fn a_capture_of_the_target_with_the_sources_sequences_comes_out() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let performer = ["performer", "--vertices", "1500", "--texture-size", "128", "-q"];
    done(&builder(folder, &[&performer[..], &["-o", "woman", "--frames", "170", "--rate", "14"]].concat()));
    let man = ["-o", "man", "--frames", "120", "--rate", "10", "--figure", "man"];
    done(&builder(folder, &[&performer[..], &man].concat()));
    let transfer = ["transfer", "--from", "woman", "--to", "man", "--keys", "keys.toml", "-q"];
    let run = |more: &[&str]| builder(folder, &[&transfer[..], more].concat());

    keys(folder, &[("stroll", 0, "walk", 0)]);
    refused(&run(&["-o", "out"]), "pair 1 of the keys: the source has no sequence \"stroll\"");
    keys(folder, &[("walk", 0, "walk", 90)]);
    refused(&run(&["-o", "out"]), "no frame 90");
    keys(folder, &[("walk", 0, "walk", 0)]);
    refused(&run(&["-o", "out"]), "too few");
    fs::write(folder.join("keys.toml"), "[[pair]]\nfrm = 3\n").unwrap();
    refused(&run(&["-o", "out"]), "frm");

    keys(
        folder,
        &[
            ("walk", 0, "walk", 0),
            ("walk", 10, "walk", 7),
            ("walk", 20, "walk", 14),
            ("jump", 0, "jump", 0),
            ("jump", 13, "jump", 9),
        ],
    );
    let told = done(&run(&["-o", "out", "--sequences", "walk,kick", "--json"]));
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(told["learned"]["keys"], 5);
    assert!(told.get("maps").is_none(), "maps are for the file alone");
    maps(folder);
    assert_eq!(told["learned"]["parts"], 5);
    let names: Vec<&str> =
        told["sequences"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["walk_transferred", "kick_transferred"]);
    assert_eq!((&told["sequences"][0]["has_keys"], &told["sequences"][1]["has_keys"]), (&true.into(), &false.into()));
    assert!(told["sequences"][0]["slide_mm"].as_f64().unwrap() < 1.0);
    let manifest = fs::read_to_string(folder.join("out/capture.toml")).unwrap();
    assert!(manifest.contains("# walk_transferred: from walk") && manifest.contains("../man/"), "{manifest}");
    let seen: Value = serde_json::from_str(&done(&builder(folder, &["inspect", "out", "--json"]))).unwrap();
    assert_eq!(seen["sequences"].as_array().unwrap().len(), 12, "ten of the man and two new ones");

    done(&run(&["-o", "alone", "--sequences", "walk", "--alone"]));
    let seen: Value = serde_json::from_str(&done(&builder(folder, &["inspect", "alone", "--json"]))).unwrap();
    assert_eq!(seen["sequences"].as_array().unwrap().len(), 1);
    refused(&run(&["-o", "alone"]), "is not empty");
}

/// What a bundle or a capture says of itself.
fn inspected(folder: &Path, input: &str) -> Value {
    serde_json::from_str(&done(&builder(folder, &["inspect", input, "--json"]))).unwrap()
}

#[test]
fn a_capture_of_new_sequences_alone_keeps_what_is_true_of_the_target() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let performer =
        ["performer", "--vertices", "1500", "--texture-size", "128", "--frames", "120", "--rate", "10", "-q", "-o"];
    done(&builder(folder, &[&performer[..], &["man", "--figure", "man"]].concat()));
    let first = fs::read_dir(folder.join("man/walk")).unwrap().map(|entry| entry.unwrap().path()).min().unwrap();
    let text = String::from_utf8_lossy(&fs::read(first).unwrap()).into_owned();
    let count: usize = match text.lines().find_map(|line| line.strip_prefix("element vertex ")) {
        Some(count) => count.parse().unwrap(),
        None => text.lines().filter(|line| line.starts_with("v ")).count(),
    };
    // Half a metre a unit, another name, two parts, and weights that are no areas.
    let manifest = fs::read_to_string(folder.join("man/capture.toml")).unwrap();
    let edited = manifest.replacen("\"Performer\"", "\"Paul\"", 1).replacen("unit = 1.0", "unit = 0.5", 1);
    assert!(edited.contains("Paul") && edited.contains("unit = 0.5"), "{edited}");
    let more = "parts = \"parts.txt\"\nweights = \"weights.txt\"\n";
    fs::write(folder.join("man/capture.toml"), format!("{more}{edited}")).unwrap();
    let numbers = |of: &dyn Fn(usize) -> String| (0..count).map(|v| of(v) + "\n").collect::<String>();
    fs::write(folder.join("man/parts.txt"), numbers(&|v| if v < count / 3 { "3" } else { "5" }.into())).unwrap();
    fs::write(folder.join("man/weights.txt"), numbers(&|v| format!("{}", 1 + v % 7))).unwrap();
    done(&builder(folder, &["pack", "man", "-o", "man.reprise", "-q"]));
    keys(folder, &[("walk", 0, "walk", 0), ("walk", 4, "walk", 4), ("walk", 9, "walk", 9)]);
    for (target, out) in [("man", "of-capture"), ("man.reprise", "of-bundle")] {
        let transfer = [
            "transfer",
            "--from",
            "man.reprise",
            "--to",
            target,
            "--keys",
            "keys.toml",
            "--sequences",
            "walk",
            "--alone",
        ];
        done(&builder(folder, &[&transfer[..], &["-q", "-o", out]].concat()));
        let packed = format!("{out}.reprise");
        done(&builder(folder, &["pack", out, "-o", &packed, "-q"]));
        let [was, is] = ["man.reprise", &packed].map(|bundle| inspected(folder, bundle));
        assert_eq!((&is["name"], &is["files"]), (&was["name"], &was["files"]), "{out}");
        assert_eq!(was["files"]["metres_per_unit"], 0.5);
        let [before, after] = ["man.reprise", &packed].map(|bundle| {
            let reader = bundle::BundleReader::from_bytes(&fs::read(folder.join(bundle)).unwrap()).unwrap();
            (
                reader.body_parts().unwrap().unwrap(),
                reader.topology().unwrap().weights().to_vec(),
                reader.meta().unwrap().bounds(),
            )
        });
        assert_eq!(before.0, after.0, "{out}: parts");
        let off = before.1.iter().zip(&after.1).map(|(a, b)| (a / before.1[0] - b / after.1[0]).abs());
        assert!(off.fold(0.0, f32::max) < 0.01, "{out}: weights");
        let height = |(low, high): (glam::Vec3, glam::Vec3)| high.y - low.y;
        assert!(
            height(after.2) > 0.7 * height(before.2) && height(after.2) < 1.1 * height(before.2),
            "{out}: {:?}",
            after.2
        );
    }
}

/// The page of key poses draws these.
fn maps(folder: &Path) {
    let told: Value = serde_json::from_str(&fs::read_to_string(folder.join("out/transfer.json")).unwrap()).unwrap();
    let maps = told["maps"].as_array().unwrap();
    let named: Vec<(&str, &str)> =
        maps.iter().map(|map| (map["from"].as_str().unwrap(), map["to"].as_str().unwrap())).collect();
    let mut sorted = named.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, [("jump", "jump"), ("walk", "walk")]);
    let walk = &maps[named.iter().position(|names| names.0 == "walk").unwrap()];
    let frame = |name: &str| walk[name].as_u64().unwrap();
    assert_eq!(["from_first", "from_last", "to_first", "to_last"].map(frame), [0, 20, 0, 14]);
    let path: Vec<f64> = walk["path"].as_array().unwrap().iter().map(|frame| frame.as_f64().unwrap()).collect();
    assert_eq!((path.len(), path[0], path[14]), (15, 0.0, 20.0));
    assert!(path.windows(2).all(|frames| frames[1] >= frames[0]), "time goes on: {path:?}");
    let (rows, columns) = (walk["costs"]["rows"].as_u64().unwrap(), walk["costs"]["columns"].as_u64().unwrap());
    assert_eq!((rows, columns), (15, 15), "20 frames at 14 a second are 14 at 10");
    // Four letters for three bytes.
    assert_eq!(walk["costs"]["values"].as_str().unwrap().len(), (rows * columns).div_ceil(3) as usize * 4);
}
