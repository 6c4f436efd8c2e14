//! `builder evaluate` and `builder report`, end to end, on a small performer.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use performer::{Artefacts, PerformerOptions, ScannedOptions, write_performer, write_scanned};
use serde_json::Value;

/// Tables of times, which differ from run to run.
const TIMED: [&str; 3] = ["algorithms.csv", "stages.csv", "exponents.csv"];

fn builder(arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

fn tables(folder: &Path) -> BTreeMap<String, String> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let tables = files.filter(|path| path.extension().is_some_and(|extension| extension == "csv"));
    tables
        .map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), fs::read_to_string(&path).unwrap()))
        .collect()
}

#[test]
fn evaluates_a_small_performer_twice_alike() {
    let scratch = tempfile::tempdir().unwrap();
    let capture = scratch.path().join("capture");
    let options = PerformerOptions { frames: 200, vertices: 1500, texture_size: 128, fps: 25.0, ..Default::default() };
    write_performer(&options, &capture, &|_| ()).unwrap();
    let path = |name: &str| scratch.path().join(name).to_str().unwrap().to_owned();
    let input = path("capture");
    let all = "poses,transitions,graphs,blending,interpolation,walks,scaling";
    builder(&["evaluate", &input, "-o", &path("first"), "--sections", all, "--threads", "2"]);
    let timeless = "poses,transitions,graphs,blending,interpolation,walks";
    builder(&["evaluate", &input, "-o", &path("second"), "--sections", timeless, "--threads", "1"]);

    let (first, second) = (tables(&scratch.path().join("first")), tables(&scratch.path().join("second")));
    for (name, table) in &second {
        assert!(table.lines().count() > 1, "{name} is empty");
        let columns = table.lines().map(columns).collect::<Vec<_>>();
        assert!(columns.windows(2).all(|pair| pair[0] == pair[1]), "{name} is ragged");
        if !TIMED.contains(&name.as_str()) {
            assert_eq!(first.get(name), Some(table), "{name}");
        }
    }
    assert!(TIMED.iter().all(|name| first.contains_key(*name)));

    let report: Value = serde_json::from_str(&fs::read_to_string(path("first/report.json")).unwrap()).unwrap();
    let table = |name: &str| -> Vec<Value> {
        let sections = report["sections"].as_array().unwrap().iter();
        let mut tables = sections.flat_map(|section| section["tables"].as_array().unwrap());
        tables.find(|table| table["name"] == name).unwrap()["rows"].as_array().unwrap().clone()
    };
    // Identities that hold on any capture.
    assert!(table("certificate").iter().all(|row| row["pairs that differ"] == 0 && row["pairs compared"] == 200 * 199));
    assert!(table("algorithms").iter().all(|row| row["same edges"] == "yes"));
    for row in table("graphs") {
        assert!(row["essential graph"].as_f64() <= row["motion graph"].as_f64());
    }
    let cost = |scheme: &str, slope: u64| {
        let rows = table("transitions");
        let row = rows.iter().find(|row| row["scheme"] == scheme && row["slope"] == slope).unwrap();
        row["normalised cost"].as_f64().unwrap()
    };
    assert!(cost("warped, lengths by the mean", 3) <= cost("warped, 0.6 s", 3));
    assert!(cost("warped, lengths by the mean", 3) <= cost("warped, lengths by the sum", 3));
    assert!(table("transitions").iter().all(|row| row["acceleration, m/s\u{b2}"].as_f64().unwrap() > 0.0));
    let poses = table("pose_distances");
    let pearson = |row: usize| poses[row]["Pearson"].as_f64().unwrap();
    assert!(pearson(0) > 0.5 && (pearson(0) - pearson(1)).abs() < 0.02);
    let interpolation = table("interpolation");
    let edges = |row: usize| interpolation[row]["edges, mean"].as_f64().unwrap();
    assert!(edges(1) < edges(0), "Poisson in-betweens keep edges better than linear ones");

    let page = fs::read_to_string(path("first/index.html")).unwrap();
    assert!(page.ends_with("</html>\n") && page.matches("<svg").count() >= 10);
    // Nothing from elsewhere.
    assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("<script"));
    assert!(page.contains("prefers-color-scheme: dark") && !page.contains("NaN"));
    let left: Vec<_> = fs::read_dir(scratch.path().join("first")).unwrap().map(|f| f.unwrap().file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().contains("partial")), "{left:?}");

    let bundle = path("actor.reprise");
    builder(&["pack", &input, "-o", &bundle]);
    builder(&["report", &bundle]);
    let page = fs::read_to_string(path("actor.html")).unwrap();
    assert!(page.contains("What to capture next") && page.contains("data:image/png;base64,"));
}

#[test]
fn transitions_of_the_performer_are_compared_with_its_truth() {
    let scratch = tempfile::tempdir().unwrap();
    let path = |name: &str| scratch.path().join(name).to_str().unwrap().to_owned();
    let input = path("capture");
    let options = PerformerOptions {
        frames: 100,
        vertices: 1500,
        texture_size: 128,
        fps: 25.0,
        // Small gaps would not be found at this size.
        artefacts: Artefacts { holes: false, ..Artefacts::ALL },
        ..Default::default()
    };
    write_performer(&options, Path::new(&input), &|_| ()).unwrap();
    builder(&["evaluate", &input, "-o", &path("out"), "--sections", "appearance"]);
    let table = tables(&scratch.path().join("out"))["appearance_ghosting_truth.csv"].clone();
    let page = fs::read_to_string(path("out/index.html")).unwrap();
    println!("{table}");
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines.len() >= 4 && lines.iter().all(|line| columns(line) == columns(lines[0])));
    for line in &lines[1..] {
        let numbers = line.split(',').filter(|cell| !cell.contains("to") && !cell.contains("or") && *cell != "all");
        assert!(numbers.map(|cell| cell.parse::<f64>().unwrap()).all(f64::is_finite), "{line}");
    }
    let report: Value = serde_json::from_str(&fs::read_to_string(path("out/report.json")).unwrap()).unwrap();
    let tables = report["sections"][0]["tables"].as_array().unwrap();
    let rows = &tables.iter().find(|table| table["name"] == "appearance_ghosting_truth").unwrap()["rows"];
    // At 0 a cross-fade of captured textures is the captured texture, and that is the truth.
    let first = |column: &str| rows[0][column].as_f64().unwrap();
    assert!(first("cross-fade of captured, SSIM") > 0.9999 && first("cross-fade of captured, MSE") < 1e-6);
    assert!(first("ours, SSIM") > 0.8 && first("ours, SSIM") < 1.0);
    assert!(page.contains("Cross-fade of ours, as stored, half way") && page.matches("data:image/png").count() == 4);
    assert!(!page.contains("not compared with the truth"));
}

/// Columns of a line of CSV.
fn columns(line: &str) -> usize {
    let mut quoted = false;
    let commas = line.chars().filter(|&c| {
        quoted ^= c == '"';
        c == ',' && !quoted
    });
    commas.count() + 1
}

#[test]
fn refuses_what_is_no_bundle_and_no_capture() {
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("no.reprise");
    fs::write(&file, "no").unwrap();
    let code = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_builder")).args(arguments).output().unwrap();
        output.status.code().unwrap()
    };
    let out = scratch.path().join("out");
    assert_eq!(code(&["report", file.to_str().unwrap()]), 1);
    assert_eq!(code(&["evaluate", file.to_str().unwrap(), "-o", out.to_str().unwrap()]), 1);
    assert_eq!(code(&["evaluate", "-o", out.to_str().unwrap(), "--sections", "nonsense"]), 2);
    assert!(!out.join("index.html").exists());
}

#[test]
fn evaluates_a_scan_against_its_truth() {
    let scratch = tempfile::tempdir().unwrap();
    let path = |name: &str| scratch.path().join(name).to_str().unwrap().to_owned();
    let options = PerformerOptions { frames: 40, vertices: 4000, texture_size: 128, ..Default::default() };
    write_scanned(&options, &ScannedOptions::default(), &scratch.path().join("scan"), &|_| ()).unwrap();
    // The first take alone, whose frames are near each other.
    for manifest in ["scan/capture.toml", "scan/truth/capture.toml"].map(path) {
        let text = fs::read_to_string(&manifest).unwrap();
        let parts: Vec<&str> = text.split("\n[[sequence]]").take(2).collect();
        fs::write(&manifest, parts.join("\n[[sequence]]")).unwrap();
    }
    builder(&["evaluate", &path("scan"), "-o", &path("report"), "--sections", "scans"]);
    let tables = tables(&scratch.path().join("report"));
    let rows = |name: &str| -> Vec<Vec<String>> {
        let lines = tables[name].lines().skip(1);
        lines.map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let number = |text: &str| text.parse::<f64>().unwrap();
    // Every frame is registered or lost, and every frame that is registered has its distance from the truth.
    let (frames, lost) = (rows("scan_frames.csv"), rows("scan_lost.csv"));
    assert_eq!(frames.len() + lost.len(), 4);
    assert!(frames.iter().all(|row| (0.0..500.0).contains(&number(&row[2]))), "{frames:?}");
    // The template's own frame is where it is in truth, but for noise and detail.
    let own: Vec<f64> = frames.iter().filter(|row| row[1].is_empty()).map(|row| number(&row[2])).collect();
    assert!(own.len() == 1 && own[0] < 3.0, "{own:?}");
    // A frame's own texture is more like the scan than another frame's.
    let views = rows("scan_views.csv");
    assert!(!views.is_empty());
    let mean = |column: usize| views.iter().map(|row| number(&row[column])).sum::<f64>() / views.len() as f64;
    assert!(mean(1) > 20.0 && mean(1) > mean(4) && mean(2) > mean(5), "{views:?}");
    assert!(!rows("scan_headings.csv").is_empty());
    // It takes a scan, and what other sections take is none.
    let output = Command::new(env!("CARGO_BIN_EXE_builder"))
        .args(["evaluate", &path("scan"), "-o", &path("other"), "--sections", "scans,poses"])
        .output()
        .unwrap();
    assert!(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains("stands alone"));
}
