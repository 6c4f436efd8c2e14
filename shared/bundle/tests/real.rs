//! A real capture through the bundle and back.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

mod captures;

use actor::graph::EssentialGraph;
use actor::pose_source::PoseSource;
use bundle::{BundleInput, BundleReader, encode, validate};
use glam::Vec3;

#[test]
#[ignore = "reads ../shared/data"]
fn a_real_capture_stays_within_its_bound_and_is_small() {
    let capture = captures::crane_and_jumping();
    let graph = EssentialGraph::new(0.01, Vec::new(), &capture.timeline).unwrap();
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 100,
        max_error: 0.0005,
        poisson_order: None,
        generator: "test".into(),
    };
    let start = std::time::Instant::now();
    let (bytes, report) = encode(&input).unwrap();
    println!("{report:#?}\nencoded in {:?}", start.elapsed());
    assert!(report.max_error <= 0.0005);
    assert!(report.bytes_per_frame < 6000.0, "{} bytes a frame", report.bytes_per_frame);

    let mut reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!(reader.topology().unwrap().triangles(), capture.topology.triangles());
    assert_eq!(reader.surface(), Some(&capture.surface));
    let mut pose = vec![Vec3::ZERO; capture.poses.vertex_count()];
    let start = std::time::Instant::now();
    let mut largest = 0.0_f64;
    let mut sum = 0.0_f64;
    let frames = capture.poses.len() as u32;
    // Out of order, so that references are fetched and forgotten.
    for frame in (0..frames).map(|index| index * 7 % frames) {
        reader.read(frame, &mut pose).unwrap();
        for (decoded, captured) in pose.iter().zip(capture.poses.frame(frame)) {
            let distance = decoded.as_dvec3().distance(captured.as_dvec3());
            largest = largest.max(distance);
            sum += distance * distance;
        }
    }
    println!("read in {:?}", start.elapsed());
    assert!(largest <= 0.0005, "{largest}");
    assert!((largest - report.max_error).abs() < 1e-12);
    let rms = (sum / (f64::from(frames) * pose.len() as f64)).sqrt();
    assert!((rms - report.rms_error).abs() < 1e-9);
    let codes: Vec<_> = validate(&bytes).iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["no-transitions", "no-order"]);
}
