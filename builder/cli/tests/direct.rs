//! `builder direct`: what it writes loads back through our own importer, and is the same each time.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use job::Job;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use actor::blend::transition_placement;
use actor::capture::{Capture, Poses};
use actor::contacts::Contacts;
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround};
use actor::surface::{Corner, Image, ImageFormat, Material, Part, Surface};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use actor::walk::Walk;
use bundle::{BundleInput, BundleReader, encode};
use capture_io::import::{ImportOptions, Imported, import};
use glam::Vec3;
use kernels::align::{Placement, centre_of_mass};
use kernels::topology::Topology;
use serde_json::{Value, json};
use synthesis::Synthesiser;

const FPS: f32 = 25.0;

/// An octahedron that walks with a bend, and one that walks straight on; with a seam, two parts and a texture.
fn capture() -> Capture {
    let triangles: Vec<[u32; 3]> =
        vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];
    let mut poses = Poses::new(6);
    for frame in 0..60 {
        let (turn, time) = if frame < 30 { (0.03 * frame as f32, frame) } else { (0.0, frame - 30) };
        let walked = Vec3::new(0.02 * turn * time as f32, 0.0, 0.05 * time as f32);
        let swing = 0.1 * (0.4 * frame as f32).sin();
        let body = [
            Vec3::new(0.4, 1.0, 0.0),
            Vec3::new(0.0, 1.0 + swing, 0.3),
            Vec3::new(-0.4, 1.0, 0.0),
            Vec3::new(0.0, 1.0, -0.2),
            Vec3::new(swing, 1.8, 0.0),
            Vec3::new(0.0, 0.0, swing),
        ];
        let pose = body.map(|point| glam::Quat::from_rotation_y(turn) * point + walked);
        poses.push(&pose);
    }
    let mut corners: Vec<Corner> = (0..6)
        .map(|vertex| Corner { vertex, uv: [vertex as f32 / 8.0, 0.25 + vertex as f32 / 16.0], colour: [255; 4] })
        .collect();
    corners.push(Corner { uv: [0.9, 0.9], ..corners[0] });
    let mut drawn = triangles.clone();
    drawn[7][0] = 6;
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_fn(4, 4, |x, y| image::Rgb([60 * x as u8, 60 * y as u8, 128]))
        .write_to(&mut png, image::ImageFormat::Png)
        .unwrap();
    let image = Image { format: ImageFormat::Png, width: 4, height: 4, bytes: png.into_inner() };
    let material = |name: &str, image| Material {
        name: name.into(),
        base_colour: [0.5, 0.7, 0.9, 1.0],
        image,
        double_sided: false,
    };
    let surface = Surface {
        corners,
        triangles: drawn,
        parts: vec![
            Part { material: 0, first_triangle: 0, triangle_count: 5 },
            Part { material: 1, first_triangle: 5, triangle_count: 3 },
        ],
        materials: vec![material("cloth", Some(0)), material("skin", None)],
        images: vec![image],
    };
    let topology = Topology::new(6, triangles, vec![1.0; 6]).unwrap();
    let sequence = |name: &str, first_frame| Sequence {
        name: name.into(),
        labels: vec![name.into()],
        first_frame,
        frame_count: 30,
        cyclic: false,
    };
    let timeline = Timeline::new(FPS, vec![sequence("bend", 0), sequence("straight", 30)]).unwrap();
    Capture { name: "octahedron".into(), topology, surface, timeline, poses, vertex_of_file_vertex: vec![] }
}

fn write_bundle(path: &Path) -> Capture {
    let mut capture = capture();
    let mut transitions = Vec::new();
    for (from, to) in [(15, 8), (18, 48), (20, 50), (45, 12), (50, 42), (52, 18)] {
        let warp = TemporalWarp::new(vec![Move::Both, Move::Source, Move::Both, Move::Destination, Move::Both]);
        let mut memory = PoseMemory::default();
        let weights = capture.topology.weights().to_vec();
        let mut ground = PosesOnGround::new(&mut capture.poses, &weights, &mut memory);
        let placement =
            transition_placement(&capture.timeline, &mut ground, (from, to), &warp, &Contacts::default()).unwrap();
        transitions.push(Transition { from, to, deformation: 0.2, warp, placement, turn: 0.0 });
    }
    let graph = EssentialGraph::new(0.01, transitions, &capture.timeline).unwrap();
    let generator = "test".into();
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 0.0002,
        poisson_order: None,
        generator,
    };
    fs::write(path, encode(&input).unwrap().0).unwrap();
    capture
}

fn direct(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_builder")).arg("direct").args(arguments).output().unwrap()
}

fn run(arguments: &[&str]) -> Value {
    let output = direct(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap_or(Value::Null)
}

/// The frames of a reported walk, made here.
fn made(bundle: &Path, report: &Value) -> Vec<Vec<Vec3>> {
    let mut reader = BundleReader::from_bytes(&fs::read(bundle).unwrap()).unwrap();
    let (graph, timeline) = (reader.graph().unwrap().clone(), reader.timeline().unwrap().clone());
    let walk: Walk = serde_json::from_value(report["answer"]["walk"].clone()).unwrap();
    let start = report["answer"]["start_frame"].as_u64().unwrap() as u32;
    let placement: [f32; 3] = serde_json::from_value(report["answer"]["start_placement"].clone()).unwrap();
    assert_eq!(Some(walk.check(&graph, &timeline, start).unwrap()), walk.end(&graph).or(Some(start)));
    let mut synthesiser = Synthesiser::new(reader.topology().unwrap(), reader.order()).unwrap();
    let placement = Placement { heading: placement[0], translation: glam::Vec2::new(placement[1], placement[2]) };
    synthesiser.begin_walk(&graph, &timeline, (start, placement), &walk).unwrap();
    let mut frames = Vec::new();
    let mut pose = vec![Vec3::ZERO; 6];
    while synthesiser.next_frame(&graph, &timeline, &mut reader, &mut pose).unwrap().is_some() {
        frames.push(pose.clone());
    }
    frames
}

fn load(input: &str, fps: f32) -> Imported {
    let options = ImportOptions { fps: Some(fps), ..ImportOptions::default() };
    import(&[input.to_owned()], &options, &Job::silent()).unwrap()
}

/// Every triangle's corners in space and on the texture are those of the frames that were made.
fn same_frames(imported: &Imported, frames: &[Vec<Vec3>], surface: &Surface) {
    let capture = &imported.capture;
    assert_eq!(capture.poses.len(), frames.len());
    assert_eq!(capture.surface.triangles.len(), surface.triangles.len());
    for (frame, wanted) in frames.iter().enumerate() {
        let pose = capture.poses.frame(frame as u32);
        for (read, written) in capture.surface.triangles.iter().zip(&surface.triangles) {
            for (&a, &b) in read.iter().zip(written) {
                let (a, b) = (&capture.surface.corners[a as usize], &surface.corners[b as usize]);
                let gap = pose[a.vertex as usize].distance(wanted[b.vertex as usize]);
                assert!(gap < 1e-5, "frame {frame}: {gap} m apart");
                assert!((a.uv[0] - b.uv[0]).abs() < 1e-4 && (a.uv[1] - b.uv[1]).abs() < 1e-4);
            }
        }
    }
}

#[test]
fn what_is_written_loads_back() {
    let folder = tempfile::tempdir().unwrap();
    let bundle = folder.path().join("a.reprise");
    write_bundle(&bundle);
    let surface = BundleReader::from_bytes(&fs::read(&bundle).unwrap()).unwrap().surface().unwrap().clone();
    let path = folder.path().join("path.json");
    fs::write(&path, json!({"points": [[0, 0], [0, 2], [0.5, 4]], "shape": "spline"}).to_string()).unwrap();
    let text = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let arguments = |output: &str| {
        ["a.reprise", "--path", "path.json", "--effort", "3000", "--json", "-q", "-o", output].map(|word| match word {
            "a.reprise" | "path.json" => text(word),
            other => other.to_owned(),
        })
    };
    let run = |output: String| run(&arguments(&output).iter().map(String::as_str).collect::<Vec<_>>());

    let report = run(text("walk.glb"));
    let frames = made(&bundle, &report);
    assert_eq!(report["frames"], frames.len());
    assert!(report["answer"]["walk"]["legs"].as_array().unwrap().len() > 1);
    let imported = load(&text("walk.glb"), FPS);
    same_frames(&imported, &frames, &surface);
    assert_eq!(imported.capture.surface.images[0].bytes, surface_image(&bundle));
    assert_eq!(imported.capture.surface.materials[1].base_colour, [0.5, 0.7, 0.9, 1.0]);
    let first = fs::read(text("walk.glb")).unwrap();
    let again = run(text("walk.glb"));
    assert!(first == fs::read(text("walk.glb")).unwrap(), "another file the second time");
    assert_eq!(again["answer"], report["answer"]);

    for kind in ["obj", "ply"] {
        run(text(&format!("{kind}s/%04d.{kind}")));
        let imported = load(&text(&format!("{kind}s")), FPS);
        same_frames(&imported, &frames, &surface);
        assert_eq!(imported.capture.surface.images[0].bytes, surface_image(&bundle));
    }

    // What was planned is what is walked: the plan's samples against the frames' centres of mass.
    let weights = [1.0 / 6.0; 6];
    let mut walked = 0.0;
    for pair in frames.windows(2) {
        let step = centre_of_mass(&pair[1], &weights) - centre_of_mass(&pair[0], &weights);
        walked += f64::from(step.x.hypot(step.z));
    }
    let planned = report["answer"]["parts"][0]["goal"]["path"]["travelled"].as_f64().unwrap();
    assert!((walked - planned).abs() < 0.02 * planned, "{walked} m walked, {planned} m planned");
    let last = frames.last().unwrap();
    let end = report["answer"]["parts"][0]["goal"]["path"]["track"].as_array().unwrap().last().unwrap().clone();
    let end: [f32; 4] = serde_json::from_value(end).unwrap();
    let gap = centre_of_mass(last, &weights).distance(Vec3::new(end[1], end[2], end[3]));
    assert!(gap < 0.01, "the plan ends {gap} m from where the walk ends");
}

fn surface_image(bundle: &Path) -> Vec<u8> {
    BundleReader::from_bytes(&fs::read(bundle).unwrap()).unwrap().image(0).unwrap().bytes.clone()
}

#[test]
fn pictures_show_the_actor() {
    let folder = tempfile::tempdir().unwrap();
    let bundle = folder.path().join("a.reprise");
    write_bundle(&bundle);
    let pattern = folder.path().join("turn/%03d.png");
    let bundle = bundle.to_str().unwrap();
    let pattern = pattern.to_str().unwrap();
    run(&[bundle, "--to", "straight:0.8", "--start", "bend:0", "--every", "4", "--size", "80x60", "-q", "-o", pattern]);
    let pictures = fs::read_dir(folder.path().join("turn")).unwrap().count();
    assert!(pictures > 3);
    let picture = image::open(folder.path().join("turn/001.png")).unwrap().to_rgb8();
    assert_eq!((picture.width(), picture.height()), (80, 60));
    // Something colourful stands in the middle of a grey ground.
    let colourful = |p: &image::Rgb<u8>| p.0.iter().max().unwrap() - p.0.iter().min().unwrap() > 20;
    let share = picture.pixels().filter(|p| colourful(p)).count() as f32 / (80.0 * 60.0);
    assert!((0.05..0.6).contains(&share), "{share} of the picture");
    assert!(!colourful(picture.get_pixel(2, 2)) && !colourful(picture.get_pixel(77, 57)));
}

#[test]
fn every_tool_works_from_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let bundle = folder.path().join("a.reprise");
    write_bundle(&bundle);
    let keys = folder.path().join("keys.toml");
    fs::write(
        &keys,
        "[[poses]]\npose = 5\ntime = 0\n[[poses]]\npose = { sequence = \"straight\", frame = 15 }\ntime = 2.0\n",
    )
    .unwrap();
    let (bundle, keys, out) = (bundle.to_str().unwrap(), keys.to_str().unwrap(), folder.path().join("o.glb"));
    let out = out.to_str().unwrap();
    let report = run(&[bundle, "--keys", keys, "--json", "-q", "-o", out]);
    let rows = &report["answer"]["parts"][0]["goal"]["keys"]["rows"];
    assert_eq!(rows[1]["wanted"], 50);
    assert!(rows[1]["reached"].as_u64().unwrap().abs_diff(50) <= 3, "{rows}");
    let wander = |seed: &str| run(&[bundle, "--wander", "20s", "--seed", seed, "--json", "-q", "-o", out]);
    // So few transitions leave little to chance: most seeds lead the same way.
    let (one, two) = (wander("1"), wander("9"));
    assert!(one["answer"]["seconds"].as_f64().unwrap() >= 20.0);
    assert_ne!(one["answer"]["walk"], two["answer"]["walk"]);
    assert_eq!(one["answer"]["walk"], wander("1")["answer"]["walk"]);

    // The table of key poses, as a file of its own.
    let times = folder.path().join("times.csv");
    run(&[bundle, "--keys", keys, "--times", times.to_str().unwrap(), "-q", "-o", out]);
    let table = fs::read_to_string(&times).unwrap();
    assert!(table.starts_with("frame,shown,wanted_frames,reached_frames") && table.lines().count() == 3, "{table}");
    let times = folder.path().join("times.json");
    run(&[bundle, "--keys", keys, "--times", times.to_str().unwrap(), "-q", "-o", out]);
    let table: Value = serde_json::from_str(&fs::read_to_string(&times).unwrap()).unwrap();
    assert_eq!(table[1]["reached_frames"], rows[1]["reached"]);

    let place = run(&[bundle, "--place", "-0.2,1.0,0.3", "--effort", "3000", "--json", "-q", "-o", out]);
    assert!(place["answer"]["parts"][0]["goal"]["place"]["turn"].is_number());
    assert!((place["request"]["target"]["place"]["x"].as_f64().unwrap() + 0.2).abs() < 1e-6);
    let held = run(&[bundle, "--behaviour", "straight:3s", "--json", "-q", "-o", out]);
    assert_eq!(held["answer"]["parts"][0]["goal"]["behaviour"]["reached"], true);
    assert!(held["answer"]["parts"][0]["goal"]["behaviour"]["held"].as_u64().unwrap() > 0);

    // What the page saves holds the actor's place too, and the walk begins there.
    let saved = folder.path().join("saved.json");
    let start = json!({"frame": 12, "placement": [0.5, 1.0, -2.0]});
    fs::write(&saved, json!({"request": held["request"], "start": start}).to_string()).unwrap();
    let walk = run(&[bundle, "--request", saved.to_str().unwrap(), "--json", "-q", "-o", out]);
    assert_eq!(walk["answer"]["start_frame"], 12);
    assert_eq!(walk["answer"]["start_placement"], start["placement"]);

    // The request that a report holds gives the same walk.
    let request = folder.path().join("request.json");
    fs::write(&request, one["request"].to_string()).unwrap();
    let again = run(&[bundle, "--request", request.to_str().unwrap(), "--json", "-q", "-o", out]);
    assert_eq!(again["answer"]["walk"], one["answer"]["walk"]);
}

#[test]
fn what_cannot_be_done_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let bundle = folder.path().join("a.reprise");
    write_bundle(&bundle);
    let bundle = bundle.to_str().unwrap();
    let refuse = |arguments: &[&str], code: i32, words: &str| {
        let output = direct(&[&[bundle], arguments].concat());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{error}");
        assert!(error.contains(words), "{error}");
    };
    let out = folder.path().join("o.glb");
    let out = out.to_str().unwrap();
    refuse(&["-o", out], 2, "say what to do");
    refuse(&["--wander", "5s", "-o", "walk.mp4"], 2, "says no format");
    refuse(&["--wander", "5s", "-o", "walk.png"], 2, "say where its number goes");
    refuse(&["--wander", "never", "-o", out], 2, "no duration");
    refuse(&["--to", "fly:1", "-o", out], 1, "there are: bend, straight");
    refuse(&["--behaviour", "fly", "-o", out], 1, "there are: bend, straight");
    refuse(&["--place", "here", "-o", out], 2, "no place");
    refuse(&["--place", "1,1e9", "-o", out], 1, "must be a number from");
    refuse(&["--wander", "1s", "--times", "t.csv", "-o", out], 2, "none were asked for");
    let saved = folder.path().join("saved.json");
    let saved = saved.to_str().unwrap();
    fs::write(saved, r#"{"request": {"version": 1, "target": {"pose": 3}}, "start": {"frame": 1}}"#).unwrap();
    refuse(&["--request", saved, "-o", out], 1, "the start: missing field");
    fs::write(
        saved,
        r#"{"request": {"version": 1, "target": {"pose": 3}}, "start": {"frame": 9999, "placement": [0, 0, 0]}}"#,
    )
    .unwrap();
    refuse(&["--request", saved, "-o", out], 1, "no frame 9999");
    fs::write(saved, "[1, 2]").unwrap();
    refuse(&["--request", saved, "-o", out], 1, "not a request");
    refuse(&["--to", "bend:99", "-o", out], 1, "no frame");
    let path = folder.path().join("path.json");
    fs::write(&path, "{\"points\": [[1, 1], [1, 1]]}").unwrap();
    refuse(&["--path", path.to_str().unwrap(), "-o", out], 1, "no length");
    fs::write(&path, "{\"points\": [[0, 0], [0, 1]], \"vertices\": [77]}").unwrap();
    refuse(&["--path", path.to_str().unwrap(), "-o", out], 1, "no vertex 77");
    fs::write(&path, "{\"points\": [[0, 0], [0, 1]], \"vertices\": [4]}").unwrap();
    assert!(direct(&[bundle, "--path", path.to_str().unwrap(), "--effort", "500", "-q", "-o", out]).status.success());
    assert!(!Path::new("walk.mp4").exists());
}
