//! `cargo xtask bench`: the figures of the demo, the page, the full-size capture and the kernels, each beside its mark
//! (docs/performance.md).

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result};
use serde_json::Value;

use crate::command::{cargo, run, target};
use crate::figures::{Figures, Mark};
use crate::{browser, demo, size, web};

/// Frames of the papers' largest capture.
const FULL_SIZE: &str = "2633";

/// Criterion's benchmarks: package and name.
const BENCHES: [(&str, &str); 7] = [
    ("reprise-kernels", "poisson"),
    ("reprise-bundle", "bundle"),
    ("reprise-search", "search"),
    ("reprise-pipeline", "distance"),
    ("reprise-pipeline", "transitions"),
    ("reprise-pipeline", "essential"),
    ("reprise-appearance", "appearance"),
];

/// Measures everything and prints one table at the end.
pub fn bench() -> Result<()> {
    let mut figures = Figures::default();
    let dist = web::build()?;
    let size::Weight { at_once, later, .. } = size::weigh(&dist)?;
    let mark = Mark::AtMost(size::MARK as f64 / 1e3, Some(200.0));
    figures.add("page: wasm + JavaScript, gzip", at_once as f64 / 1e3, "KB", mark);
    figures.add("page: the same with the tools", (at_once + later) as f64 / 1e3, "KB", Mark::None);
    let dist = web::build_to_measure()?;
    run("the builder", cargo().args(["build", "-p", "reprise-builder", "--release"]))?;
    demo(&dist, &mut figures)?;
    page(&dist, &mut figures)?;
    full_size(&mut figures)?;
    kernels(&mut figures)?;
    figures.print();
    Ok(())
}

/// The demo's capture, packed as `cargo xtask demo` packs it.
fn demo(dist: &Path, figures: &mut Figures) -> Result<()> {
    let bundle = dist.join("demo.reprise");
    let (written, packed, report) = pack("demo", &[], &bundle)?;
    figures.add("demo: capture written and packed", written + packed, "s", Mark::AtMost(60.0, None));
    let bundle = &report["bundle"];
    let frames = number(&report["capture"]["frames"]);
    figures.add("demo: bundle", number(&bundle["bytes"]) / 1e6, "MB", Mark::AtMost(20.0, Some(12.0)));
    let each = number(&bundle["bytes"]) / frames / 1e3;
    figures.add("demo: bundle, a frame", each, "KB", Mark::AtMost(16.0, Some(10.0)));
    figures.add("demo: positions, a frame", number(&bundle["bytes_per_frame"]) / 1e3, "KB", Mark::None);
    figures.add("demo: error of positions, RMS", number(&bundle["rms_error"]) * 1e3, "mm", Mark::None);
    figures.add("demo: error of positions, largest", number(&bundle["max_error"]) * 1e3, "mm", Mark::AtMost(0.5, None));
    Ok(())
}

/// The capture of the papers' largest size.
fn full_size(figures: &mut Figures) -> Result<()> {
    let (_, _, report) = pack("full size", &["--frames", FULL_SIZE], &target().join("bench/full.reprise"))?;
    let seconds = &report["seconds"];
    for (stage, most) in [("distances", 90.0), ("transitions", 90.0), ("graph", 10.0)] {
        figures.add(&format!("2,633 frames: {stage}"), number(&seconds[stage]), "s", Mark::AtMost(most, None));
    }
    let memory = number(&report["peak_memory_bytes"]) / 1e6;
    figures.add("2,633 frames: peak memory", memory, "MB", Mark::AtMost(2000.0, None));
    Ok(())
}

/// Writes a performer's capture and packs it: the seconds of both, and the report.
fn pack(what: &str, size: &[&str], bundle: &Path) -> Result<(f64, f64, Value)> {
    let folder = target().join("bench");
    let capture = folder.join(what.replace(' ', "-"));
    if capture.exists() {
        fs::remove_dir_all(&capture).with_context(|| format!("cannot clear {}", capture.display()))?;
    }
    fs::create_dir_all(&folder).with_context(|| format!("cannot create {}", folder.display()))?;
    let start = Instant::now();
    let mut performer = demo::builder("release");
    run(&format!("{what}: the performer's capture"), performer.arg("performer").arg("-o").arg(&capture).args(size))?;
    let written = start.elapsed().as_secs_f64();
    let report = folder.join("report.json");
    let file = fs::File::create(&report).with_context(|| format!("cannot write {}", report.display()))?;
    let mut command = demo::builder("release");
    command.arg("pack").arg(&capture).arg("-o").arg(bundle).arg("--json").stdout(file);
    let start = Instant::now();
    run(&format!("{what}: the bundle"), &mut command)?;
    Ok((written, start.elapsed().as_secs_f64(), read_json(&report)?))
}

/// What the page's own benchmark finds.
fn page(dist: &Path, figures: &mut Figures) -> Result<()> {
    let found = target().join("bench/page.json");
    run("the page", browser::node("bench.mjs", dist)?.env("REPRISE_FIGURES", &found))?;
    let found = read_json(&found)?;
    let mut add = |name: &str, what: &str, unit, mark| figures.add(what, number(&found[name]), unit, mark);
    add("synthetic_frame", "page: frame of a transition", "ms", Mark::AtMost(4.0, Some(3.0)));
    add("synthetic_frame_first", "page: first frame of a transition", "ms", Mark::None);
    add("synthetic_frame_worst", "page: frame of a transition, slowest", "ms", Mark::None);
    add("plan", "page: cheapest walk", "ms", Mark::AtMost(5.0, Some(1.0)));
    add("recorded_frame", "page: any recorded frame", "ms", Mark::AtMost(1.0, None));
    add("click_to_plan", "page: click to plan", "ms", Mark::AtMost(5.0, Some(1.0)));
    add("click_to_changed", "page: click to first changed frame", "ms", Mark::AtMost(50.0, None));
    add("click_to_changed_worst", "page: the same, slowest of 24", "ms", Mark::AtMost(50.0, None));
    add("search_prepared", "page: getting ready to search", "ms", Mark::None);
    add("search_first", "page: first walk along a path, slowest of five", "ms", Mark::AtMost(100.0, None));
    add("search_slice", "page: longest slice of a search", "ms", Mark::AtMost(50.0, None));
    add("search_turn_own", "page: longest turn while searching, the thread's own time", "ms", Mark::AtMost(50.0, None));
    add("search_turn_clock", "page: longest turn while searching, by the clock, drawn in software", "ms", Mark::None);
    for path in ["line", "circle", "slalom", "right angles", "figure eight"] {
        let name = path.replace(' ', "_");
        add(&format!("path_{name}_mean"), &format!("page: off the {path} after 2 s, mean"), "cm", Mark::None);
        add(&format!("path_{name}_most"), &format!("page: off the {path} after 2 s, most"), "cm", Mark::None);
    }
    add("bytes_to_first_picture", "page: bundle before the first picture", "MB", Mark::AtMost(2.0, None));
    add("device_loss", "page: device lost to the same pose", "ms", Mark::AtMost(1000.0, None));
    Ok(())
}

/// Criterion's benchmarks of the kernels.
fn kernels(figures: &mut Figures) -> Result<()> {
    for (package, bench) in BENCHES {
        run(&format!("benchmark {bench}"), cargo().args(["bench", "-q", "-p", package, "--bench", bench]))?;
    }
    let mut folders = Vec::new();
    find_results(&target().join("criterion"), &mut folders)?;
    folders.sort();
    for folder in folders {
        let about = read_json(&folder.join("benchmark.json"))?;
        let nanoseconds = number(&read_json(&folder.join("estimates.json"))?["median"]["point_estimate"]);
        let id = about["full_id"].as_str().unwrap_or_default();
        let (value, unit, mark) = kernel(id, nanoseconds, number(&about["throughput"]["Elements"]));
        figures.add(id, value, unit, mark);
    }
    Ok(())
}

/// A benchmark's figure in the unit of its mark.
fn kernel(id: &str, nanoseconds: f64, elements: f64) -> (f64, &'static str, Mark) {
    let ten_thousand = id.starts_with("poisson/1");
    match id.rsplit('/').next().unwrap_or_default() {
        "transition of 40 in-betweens" => (40e9 / nanoseconds, "a second", Mark::None),
        // The mark is one for two cores.
        "two transitions of 40 in-betweens on two threads" => {
            let mark = if ten_thousand { Mark::AtLeast(500.0) } else { Mark::None };
            (80e9 / nanoseconds, "a second", mark)
        }
        "factorise" if ten_thousand => (nanoseconds / 1e6, "ms", Mark::AtMost(10.0, None)),
        "solve" if ten_thousand => (nanoseconds / 1e6, "ms", Mark::AtMost(0.7, None)),
        _ if id.starts_with("transitions/") => (elements / nanoseconds * 1e3, "Mcell/s", Mark::AtLeast(200.0)),
        _ if id.starts_with("pose distances/") => (nanoseconds / elements, "ns", Mark::None),
        _ if id.starts_with("essential graph/1000") => (nanoseconds / 1e6, "ms", Mark::AtMost(200.0, None)),
        "50 components of 300 textures of 512 x 512" => (nanoseconds / 1e9, "s", Mark::AtMost(8.0, Some(4.0))),
        "flow of two textures of 1024 x 1024" => (nanoseconds / 1e6, "ms", Mark::AtMost(60.0, None)),
        _ => (nanoseconds / 1e6, "ms", Mark::None),
    }
}

/// Folders of criterion's newest results.
fn find_results(folder: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        if path.ends_with("new") && path.join("benchmark.json").is_file() {
            found.push(path);
        } else if path.is_dir() {
            find_results(&path, found)?;
        }
    }
    Ok(())
}

fn read_json(path: &Path) -> Result<Value> {
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    serde_json::from_str(&text).with_context(|| format!("{} is no JSON", path.display()))
}

/// A number; what is missing counts as no number, which no mark is met by.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}
