//! The whole pipeline: files to a bundle, a bundle to a walk.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use actor::pose_source::PoseSource;
use bundle::{BundleReader, Severity, validate};
use std::path::Path;

use fixtures::unpacked;
use glam::Vec3;
use job::Job;
use performer::{PerformerOptions, write_performer};
use reprise::pack::{AppearanceChoice, PackOptions, PackReport, pack};

fn options(fps: Option<f32>) -> PackOptions {
    let mut options = PackOptions::default();
    options.import.fps = fps;
    options.appearance = AppearanceChoice::Static;
    options
}

fn pack_with_threads(threads: usize, inputs: &[String], options: &PackOptions) -> (Vec<u8>, PackReport) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| pack(inputs, options, &Job::silent())).unwrap()
}

/// The performer, small enough to be packed twice in a test.
fn small_performer(folder: &Path) -> Vec<String> {
    let small = PerformerOptions { frames: 400, vertices: 1_500, texture_size: 128, ..PerformerOptions::default() };
    write_performer(&small, folder, &|_| ()).unwrap();
    vec![folder.to_str().unwrap().into()]
}

#[test]
fn the_performer_becomes_an_actor() {
    let folder = tempfile::tempdir().unwrap();
    let inputs = small_performer(folder.path());
    let (bytes, report) = pack_with_threads(1, &inputs, &options(None));
    let (again, _) = pack_with_threads(2, &inputs, &options(None));
    assert!(bytes == again, "the bundle depends on the number of threads");
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert!(report.graph.largest_component > 100, "{:?}", report.graph);
    assert!(validate(&bytes).iter().all(|finding| finding.severity < Severity::Error));

    let reader = BundleReader::from_bytes(&bytes).unwrap();
    let sequences = reader.timeline().unwrap().sequences();
    let middle = |name: &str| {
        let sequence = sequences.iter().find(|sequence| sequence.name == name).unwrap();
        sequence.first_frame + sequence.frame_count / 2
    };
    let (from, to) = (middle("walk"), middle("wave"));
    let frames = tests::synthesise(&bytes, from, to).unwrap();
    check_walk(&bytes, &frames, from, to);
}

#[test]
#[ignore = "reads ../shared/data"]
fn the_real_capture_becomes_an_actor() {
    let folder = |name| unpacked(name)[0].parent().unwrap().to_str().unwrap().to_owned();
    let inputs = ["crane", "jumping"].map(folder);
    let (bytes, report) = pack(&inputs, &options(Some(25.0)), &Job::silent()).unwrap();
    assert_eq!((report.capture.frames, report.capture.vertices, report.capture.triangles), (325, 10_002, 20_000));
    assert!(validate(&bytes).iter().all(|finding| finding.severity < Severity::Error));
    assert!(report.bundle.max_error < 0.000_6, "{:?}", report.bundle);
    let frames = tests::synthesise(&bytes, 60, 175 + 90).unwrap();
    check_walk(&bytes, &frames, 60, 175 + 90);
}

/// A walk begins and ends with the recorded poses, and no vertex jumps on the way.
fn check_walk(bundle: &[u8], frames: &[Vec<Vec3>], from: u32, to: u32) {
    let mut reader = BundleReader::from_bytes(bundle).unwrap();
    let mut recorded = frames[0].clone();
    reader.read(from, &mut recorded).unwrap();
    assert_eq!(frames[0], recorded);
    reader.read(to, &mut recorded).unwrap();
    let last = frames.last().unwrap();
    let weights = reader.topology().unwrap().weights().to_vec();
    let heading = kernels::align::align_heading(last, &recorded, &weights);
    let centre = |pose: &[Vec3]| kernels::align::centre_of_mass(pose, &weights);
    let (there, here) = (centre(last), centre(&recorded));
    let ground = |v: Vec3| glam::Vec2::new(v.x, v.z);
    let placement = kernels::align::Placement::turning(heading, ground(here), ground(there));
    for (end, recorded) in last.iter().zip(&recorded) {
        assert!(end.distance(placement.apply(*recorded)) < 1e-4, "the walk does not end in the pose");
    }
    let steps =
        frames.windows(2).map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max));
    let fps = reader.timeline().unwrap().fps();
    let fastest = steps.fold(0.0, f32::max) * fps;
    // A running foot or a kicking one reaches about 15 m/s.
    assert!(fastest < 20.0, "a vertex moves at {fastest} m/s");
}
