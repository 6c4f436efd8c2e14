//! The program as its users run it.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Command, Output};

use libtest_mimic::{Completion, Failed};
use serde_json::Value;

use crate::actor;

/// Passes that rebuild a texture, in order; what is a work of its own between passes comes where it is done.
const DIRECT: [&str; 4] =
    ["reprise.basis.colours", "reprise.basis.warps", "reprise.texture.pass", "reprise.mipmap.pass"];
const POISSON: [&str; 5] = [
    "reprise.basis.colours",
    "reprise.basis.warps",
    "reprise.cycle.pass",
    "reprise.texture.pass",
    "reprise.mipmap.pass",
];
const PICTURE: [&str; 3] = ["reprise.occlusion.pass", "reprise.blur.pass", "reprise.picture.pass"];
/// Timed only where a device can time what is no pass.
const CLEAR: &str = "reprise.basis.clear";

/// The program, which cargo builds along with a package's tests.
fn program() -> Command {
    let tests = std::env::current_exe().unwrap();
    let name = format!("gpu_times{}", std::env::consts::EXE_SUFFIX);
    let path: PathBuf = tests.ancestors().nth(2).unwrap().join("examples").join(name);
    assert!(path.is_file(), "{} is missing: cargo build -p reprise-web --example gpu_times", path.display());
    Command::new(path)
}

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

pub fn takes_times_of_every_pass() -> Result<Completion, Failed> {
    let folder = tempfile::tempdir()?;
    let bundle = folder.path().join("actor.reprise");
    std::fs::write(&bundle, actor::bundle())?;
    let run = |more: &[&str]| {
        let mut command = program();
        command.arg(&bundle).args(["--frames", "3", "--size", "64x48", "--seconds", "1"]).args(more).output()
    };
    let output = run(&["--json"])?;
    if output.status.code() == Some(2) {
        return Ok(Completion::ignored_with(text(&output)));
    }
    assert!(output.status.success(), "{}", text(&output));
    let found: Value = serde_json::from_slice(&output.stdout)?;
    let timestamps = found["timestamp_queries"].as_bool().unwrap();
    let mut passes: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for row in found["rows"].as_array().unwrap() {
        let [median, most] = ["median_ms", "p95_ms"].map(|key| row[key].as_f64().unwrap());
        assert!(median.is_finite() && median >= 0.0 && most >= median, "{row}");
        assert_eq!(row["frames"], 3, "{row}");
        match row["clock"].as_str().unwrap() {
            "gpu" => {
                passes.entry(row["setting"].as_str().unwrap_or("")).or_default().push(row["pass"].as_str().unwrap())
            }
            _ => assert!(median > 0.0, "{row}"),
        }
    }
    if timestamps {
        for (setting, wanted) in [("half", &DIRECT[..]), ("direct", &DIRECT), ("poisson", &POISSON), ("", &PICTURE)] {
            let mut own = passes.remove(setting).unwrap_or_default();
            assert_eq!(own.pop(), Some("all of these"), "{setting:?}");
            own.retain(|pass| *pass != CLEAR);
            assert_eq!(own, wanted, "{setting:?}");
        }
    }
    assert!(passes.is_empty(), "{passes:?}");

    let output = run(&[])?;
    let table = text(&output);
    assert!(output.status.success() && table.contains(found["adapter"]["name"].as_str().unwrap()), "{table}");
    assert_eq!(table.contains("has no timestamp queries"), !timestamps, "{table}");

    let output = run(&["--adapter", "no such adapter"])?;
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output).contains(found["adapter"]["name"].as_str().unwrap()), "{}", text(&output));
    Ok(Completion::Completed)
}

pub fn says_what_to_install() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let bundle = folder.path().join("actor.reprise");
    std::fs::write(&bundle, actor::bundle())?;
    // A backend that the program is built without has no adapters.
    let output = program().arg(&bundle).env("WGPU_BACKEND", "gl").output()?;
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("apt-get install libvulkan1 mesa-vulkan-drivers"), "{}", text(&output));
    Ok(())
}

pub fn tells_what_cannot_be_used() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let [whole, cut, other] = ["whole", "cut", "other"].map(|name| folder.path().join(name));
    let bytes = actor::bundle();
    std::fs::write(&cut, &bytes[..bytes.len() / 2])?;
    std::fs::write(&other, "a letter")?;
    for (words, said) in [
        (vec![whole.as_os_str()], "cannot read"),
        (vec![cut.as_os_str()], "is not whole"),
        (vec![other.as_os_str()], "is not a bundle that can be shown"),
        (vec!["--frames".as_ref(), "0".as_ref()], "from 1 to 1000000"),
        (vec![], "name a bundle"),
    ] {
        let output = program().args(&words).output()?;
        assert_eq!(output.status.code(), Some(1), "{words:?}: {}", text(&output));
        assert!(text(&output).contains(said), "{words:?}: {}", text(&output));
    }
    Ok(())
}
