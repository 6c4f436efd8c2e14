//! A small scan, every frame polygonised anew, through registration: whole, stopped, with faults, and packed by itself.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use geometry::mesh::Mesh;
use geometry::polygonise::polygonise;
use geometry::sdf::{blend, cone, ellipsoid};
use glam::Vec3;
use reprise::pack::{AppearanceChoice, PackOptions, pack};
use reprise::scans::{RegisterError, RegisterReport, ScanOptions, register};
use reprise::{Job, Progress, WorkFolder};

/// A body with two arms, of which one is raised by `angle`.
fn body(angle: f32, cell: f32, size: f32) -> Mesh {
    let distance = |p: Vec3| {
        let p = p / size;
        let trunk = ellipsoid(p, Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.28, 0.8, 0.2));
        let shoulder = Vec3::new(0.2, 1.3, 0.0);
        let hand = shoulder + 0.6 * Vec3::new(angle.cos(), angle.sin(), 0.0);
        let raised = cone(p, shoulder, hand, 0.1, 0.07);
        let other = cone(p, Vec3::new(-0.2, 1.3, 0.0), Vec3::new(-0.55, 0.75, 0.2), 0.1, 0.07);
        size * blend(blend(trunk, raised, 0.05), other, 0.05)
    };
    polygonise(Vec3::new(-1.0, 0.0, -0.5) * size, Vec3::new(1.0, 2.2, 0.5) * size, cell * size, distance)
}

fn write(path: &Path, mesh: &Mesh, unit: f32) {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar \
         red\nproperty uchar green\nproperty uchar blue\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    );
    for p in &mesh.positions {
        // Height on the body says the colour, wherever the arm is.
        let [r, g, b] = [p.y * 110.0, 200.0 - p.y * 60.0, 90.0].map(|c| c.clamp(0.0, 255.0) as u8);
        let p = *p * unit;
        text.push_str(&format!("{} {} {} {r} {g} {b}\n", p.x, p.y, p.z));
    }
    for [a, b, c] in &mesh.triangles {
        text.push_str(&format!("3 {a} {b} {c}\n"));
    }
    fs::write(path, text).unwrap();
}

/// A scan of `count` frames in `folder`; no two have the same mesh.
fn scan(folder: &Path, count: usize, unit: f32) -> Vec<String> {
    fs::create_dir_all(folder).unwrap();
    for k in 0..count {
        let mesh = body(-0.3 + 0.12 * k as f32, 0.052 + 0.001 * k as f32, 1.0);
        write(&folder.join(format!("frame_{k:03}.ply")), &mesh, unit);
    }
    vec![folder.to_string_lossy().into_owned()]
}

fn whole(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(at) = open.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
                files.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    files
}

/// Something else, of about as much surface.
fn ring(lean: f32, cell: f32) -> Mesh {
    polygonise(Vec3::new(-0.7, 0.1, -0.7), Vec3::new(0.7, 0.9, 0.7), cell, |p| {
        let ring = Vec3::new((p.x * p.x + p.z * p.z).sqrt() - 0.42, p.y - 0.5 - lean * p.x, 0.0).length() - 0.13;
        ring.min(p.distance(Vec3::new(0.0, 0.5, 0.0)) - 0.1)
    })
}

/// A take of a body, and one of something that is none.
fn two_takes(folder: &Path) -> Vec<String> {
    for (take, count) in [("body", 3), ("ring", 2)] {
        fs::create_dir_all(folder.join(take)).unwrap();
        for k in 0..count {
            let (turn, cell) = (0.1 * k as f32, 0.07 + 0.001 * k as f32);
            let mesh = if take == "body" { body(turn - 0.3, cell, 1.0) } else { ring(turn, 0.8 * cell) };
            write(&folder.join(format!("{take}/frame_{k:03}.ply")), &mesh, 1.0);
        }
    }
    ["body", "ring"].map(|take| folder.join(take).to_string_lossy().into_owned()).to_vec()
}

fn registered(inputs: &[String], out: &Path) -> RegisterReport {
    register(inputs, &ScanOptions::default(), out, &Job::silent()).unwrap()
}

#[test]
fn a_scan_becomes_a_capture_with_the_same_bytes_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = scan(&folder.path().join("scan"), 8, 1.0);
    let on = |threads: usize, out: &str| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| registered(&inputs, &folder.path().join(out)))
    };
    let report = on(1, "one");
    assert_eq!((report.registered.len(), report.lost.len(), report.sequences.len()), (8, 0, 1));
    assert!(report.registered.iter().all(|frame| frame.uncovered < 0.015 && frame.rms_backward < 0.006));
    on(3, "three");
    let (one, three) = (whole(&folder.path().join("one")), whole(&folder.path().join("three")));
    assert_eq!(one.keys().collect::<Vec<_>>(), three.keys().collect::<Vec<_>>());
    assert!(one == three, "bytes differ with the number of threads");
    let again = register(&inputs, &ScanOptions::default(), &folder.path().join("one"), &Job::silent());
    assert!(again.unwrap_err().to_string().contains("not empty"));
}

#[test]
fn a_scan_that_is_stopped_leaves_nothing_and_goes_on_in_its_work_folder() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = scan(&folder.path().join("scan"), 6, 1.0);
    let work = WorkFolder::open(&folder.path().join("work")).unwrap();
    let out = folder.path().join("made/capture");
    let report = |progress: Progress| {
        let late = progress.what == "registering" && progress.done >= 4;
        if late { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let job = Job::new(&report).with_work(Some(&work));
    let stopped = register(&inputs, &ScanOptions::default(), &out, &job).unwrap_err();
    assert!(stopped.is_stopped(), "{stopped}");
    assert_eq!(fs::read_dir(folder.path().join("made")).unwrap().count(), 0);
    let kept = work.entries().unwrap().len();
    assert!(kept >= 2, "{kept} poses are kept");
    let job = Job::silent().with_work(Some(&work));
    register(&inputs, &ScanOptions::default(), &out, &job).unwrap();
    registered(&inputs, &folder.path().join("without"));
    assert!(whole(&out) == whole(&folder.path().join("without")), "resumed work gives other bytes");
}

#[test]
fn what_is_no_frame_of_the_body_is_named_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = scan(&folder.path().join("scan"), 8, 1.0);
    let frame = |k: usize| folder.path().join(format!("scan/frame_{k:03}.ply"));
    // Twice the size, and inside out.
    write(&frame(3), &body(0.1, 0.05, 2.0), 1.0);
    let mut mesh = body(0.42, 0.0545, 1.0);
    mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    write(&frame(6), &mesh, 1.0);
    let report = registered(&inputs, &folder.path().join("capture"));
    assert_eq!(report.lost.iter().map(|lost| lost.frame).collect::<Vec<_>>(), [3]);
    assert!(report.lost[0].reason.contains("times that of most frames"), "{:?}", report.lost);
    assert_eq!(report.sequences.iter().map(|s| s.1).collect::<Vec<_>>(), [3, 4]);
    let codes: Vec<&str> = report.warnings.iter().map(|warning| warning.code).collect();
    assert!(codes.contains(&"W_SCAN_LOST") && codes.contains(&"W_SCAN_INSIDE_OUT"), "{codes:?}");
    // Where every other frame is another body, most are lost.
    (0..8).filter(|k| k % 2 == 0).for_each(|k| write(&frame(k), &body(0.1, 0.05, 1.0 + 3.0 * k as f32), 1.0));
    let out = folder.path().join("refused");
    let refused = register(&inputs, &ScanOptions::default(), &out, &Job::silent()).unwrap_err();
    assert!(matches!(refused, RegisterError::MostLost { .. }), "{refused}");
    assert!(!out.exists());
}

#[test]
fn triangles_that_are_no_part_of_the_template_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = scan(&folder.path().join("scan"), 2, 1.0);
    let whole = registered(&inputs, &folder.path().join("whole"));
    assert!(whole.warnings.iter().all(|warning| warning.code != "W_SCAN_MANIFOLD"), "{:?}", whole.warnings);
    // Two fins on every frame, each at an edge of the body.
    for k in 0..2 {
        let mut mesh = body(-0.3 + 0.12 * k as f32, 0.052 + 0.001 * k as f32, 1.0);
        for t in [40, 90] {
            let [a, b, _] = mesh.triangles[t];
            let tip = mesh.positions[a as usize] + Vec3::new(0.01, 0.02, 0.01);
            mesh.positions.push(tip);
            mesh.triangles.push([a, b, mesh.positions.len() as u32 - 1]);
        }
        write(&folder.path().join(format!("scan/frame_{k:03}.ply")), &mesh, 1.0);
    }
    let report = registered(&inputs, &folder.path().join("torn"));
    let told = report.warnings.iter().find(|warning| warning.code == "W_SCAN_MANIFOLD").unwrap().to_string();
    let root = format!("frame_{:03}.ply", report.template);
    assert!(told.contains(&root) && told.contains("2 of its triangles") && told.contains("--template-frame"), "{told}");
}

#[test]
fn what_fits_another_mesh_only_becomes_a_capture_of_its_own_beside() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = two_takes(&folder.path().join("scan"));
    let out = |name: &str| folder.path().join(name).join("capture");
    // Stopped when the second take is brought onto a mesh of its own: the bar begins again there.
    let begun = std::sync::atomic::AtomicUsize::new(0);
    let report = |progress: Progress| {
        let again = progress.what == "registering" && progress.done == 0;
        let before = begun.fetch_add(usize::from(again), std::sync::atomic::Ordering::Relaxed);
        if again && progress.total == 2 && before > 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let work = WorkFolder::open(&folder.path().join("work")).unwrap();
    let on = |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let options = ScanOptions::default();
    let stopped =
        on(2).install(|| register(&inputs, &options, &out("resumed"), &Job::new(&report).with_work(Some(&work))));
    assert!(stopped.unwrap_err().is_stopped());
    assert_eq!(fs::read_dir(folder.path().join("resumed")).unwrap().count(), 0, "something was left behind");
    let resumed =
        on(2).install(|| register(&inputs, &options, &out("resumed"), &Job::silent().with_work(Some(&work))).unwrap());
    let report = on(1).install(|| registered(&inputs, &out("one")));
    for report in [&resumed, &report] {
        assert_eq!(report.lost.iter().map(|lost| lost.frame).collect::<Vec<_>>(), [3, 4]);
        let [other] = &report.others[..] else { panic!("{:?}", report.others) };
        assert_eq!(other.registered.iter().map(|frame| frame.frame).collect::<Vec<_>>(), [3, 4]);
        assert_eq!(other.sequences, [("ring".to_owned(), 2)]);
        let told = report.warnings.iter().find(|warning| warning.code == "W_SCAN_OTHER").unwrap().to_string();
        assert!(told.contains("capture-2") && told.contains("frame 0 of sequence \"ring\""), "{told}");
    }
    let [one, resumed] = ["one", "resumed"].map(|name| whole(&folder.path().join(name)));
    assert!(one.keys().any(|file| file.starts_with("capture-2/")), "{:?}", one.keys());
    assert!(one == resumed, "bytes differ with the number of threads, or when it was stopped");
    // It is a capture as any other.
    let own = capture_io::import::import(
        &[out("one").with_file_name("capture-2").to_string_lossy().into_owned()],
        &capture_io::import::ImportOptions::default(),
        &Job::silent(),
    );
    assert_eq!(own.unwrap().capture.timeline.frame_count(), 2);
    // Where a folder has the name already, it stays as it is, and the next name is taken.
    let kept = Job::silent().with_work(Some(&work));
    fs::remove_dir_all(out("resumed")).unwrap();
    let third = register(&inputs, &options, &out("resumed"), &kept).unwrap();
    let manifest = third.others[0].manifest.clone().unwrap();
    assert!(manifest.parent().unwrap().ends_with("capture-3"), "{manifest:?}");
    assert!(whole(&out("resumed").with_file_name("capture-2")) == whole(manifest.parent().unwrap()));
}

#[test]
fn frames_of_a_keyframe_group_follow_its_first() {
    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("scan");
    fs::create_dir_all(&scan).unwrap();
    // Two meshes, each of which moves on for four frames: it leans, and the arm with it.
    let lean = |p: Vec3, by: f32| glam::Quat::from_rotation_x(by * p.y) * p;
    for k in 0..8 {
        let mut mesh = body(-0.3 + 0.12 * (k / 4 * 4) as f32, 0.052 + 0.001 * (k / 4) as f32, 1.0);
        mesh.positions.iter_mut().for_each(|p| *p = lean(*p, 0.04 * (k % 4) as f32));
        write(&scan.join(format!("frame_{k:03}.ply")), &mesh, 1.0);
    }
    let inputs = [scan.to_string_lossy().into_owned()];
    let report = registered(&inputs, &folder.path().join("capture"));
    assert_eq!((report.meshes, report.registered.len()), (2, 8));
    // One is the template's own, one is tracked, and the others follow, as close as the one that they follow.
    let followed: Vec<_> = report.registered.iter().filter(|frame| frame.followed).collect();
    assert_eq!(followed.len(), 6, "{:?}", report.registered);
    for frame in followed {
        let first = report.registered.iter().find(|other| Some(other.frame) == frame.parent).unwrap();
        assert_eq!(frame.frame / 4, first.frame / 4);
        assert!(frame.rms_backward < first.rms_backward + 5e-4 && frame.uncovered <= first.uncovered + 0.002);
    }
}

#[test]
fn millimetres_are_found_and_a_scan_is_packed_by_itself() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = scan(&folder.path().join("scan"), 8, 1000.0);
    let mut options = PackOptions::default();
    options.appearance = AppearanceChoice::Static;
    let (bytes, report) = pack(&inputs, &options, &Job::silent()).unwrap();
    assert!(!bytes.is_empty());
    assert_eq!(report.capture.frames, 8);
    let codes: Vec<&str> = report.warnings.iter().map(|warning| warning.code).collect();
    assert!(codes.contains(&"W_SCAN_REGISTERED") && codes.contains(&"W_UNIT_ASSUMED"), "{codes:?}");
}
