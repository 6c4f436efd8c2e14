//! What goes into a bundle comes out of it.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

mod captures;

use actor::capture::{Capture, Poses};
use actor::files::Files;
use actor::graph::EssentialGraph;
use actor::pose_source::{PoseError, PoseSource};
use bundle::{
    BundleError, BundleInput, BundleReader, EncodeError, default_max_error, encode, encode_with_rig, validate,
};
use captures::{cloth, graph, rig, ties};
use editing::StoredRig;
use glam::Vec3;
use proptest::prelude::*;

fn input<'a>(capture: &'a Capture, graph: &'a EssentialGraph) -> BundleInput<'a> {
    BundleInput {
        capture,
        graph,
        first_frame: 0,
        max_error: default_max_error(capture, 0),
        poisson_order: None,
        generator: "reprise test".into(),
    }
}

/// Every part of `reader` against what was written; textures, weights and placements up to their stated rounding.
fn check(reader: &mut BundleReader, input: &BundleInput) {
    let capture = input.capture;
    assert!(reader.is_complete());
    let meta = reader.meta().unwrap();
    assert_eq!((meta.name.as_str(), meta.generator.as_str()), (capture.name.as_str(), input.generator.as_str()));
    assert_eq!(meta.first_frame, input.first_frame);
    assert_eq!(reader.timeline(), Some(&capture.timeline));
    let topology = reader.topology().unwrap();
    assert_eq!(topology.triangles(), capture.topology.triangles());
    let heaviest = capture.topology.weights().iter().copied().fold(0.0, f32::max);
    for (read, written) in topology.weights().iter().zip(capture.topology.weights()) {
        assert!((read - written).abs() <= heaviest * 2e-5);
    }
    check_surface(reader, capture);
    check_graph(reader.graph().unwrap(), input.graph);
    assert_eq!(reader.order(), input.poisson_order);
    let map = Some(&capture.vertex_of_file_vertex[..]).filter(|map| !map.is_empty());
    assert_eq!(reader.file_vertices(), map);
    check_poses(reader, input);
}

fn check_surface(reader: &BundleReader, capture: &Capture) {
    let (read, written) = (reader.surface().unwrap(), &capture.surface);
    assert_eq!(
        (&read.triangles, &read.parts, &read.materials),
        (&written.triangles, &written.parts, &written.materials)
    );
    assert_eq!(read.images, written.images);
    for (index, image) in written.images.iter().enumerate() {
        assert_eq!(reader.image(index), Some(image));
    }
    let extent = |axis: usize| {
        let uvs = || written.corners.iter().map(|corner| corner.uv[axis]);
        uvs().fold(f32::MIN, f32::max) - uvs().fold(f32::MAX, f32::min)
    };
    for (read, written) in read.corners.iter().zip(&written.corners) {
        assert_eq!((read.vertex, read.colour), (written.vertex, written.colour));
        for axis in 0..2 {
            assert!((read.uv[axis] - written.uv[axis]).abs() <= extent(axis) / 131_000.0);
        }
    }
}

fn check_graph(read: &EssentialGraph, written: &EssentialGraph) {
    assert_eq!(read.alpha(), written.alpha());
    assert_eq!((read.contacts(), read.feet()), (written.contacts(), written.feet()));
    assert_eq!(read.ties(), written.ties());
    assert_eq!(read.transitions().len(), written.transitions().len());
    for (read, written) in read.transitions().iter().zip(written.transitions()) {
        assert_eq!((read.from, read.to, &read.warp), (written.from, written.to, &written.warp));
        assert_eq!(read.deformation.to_bits(), written.deformation.to_bits());
        let turn = (read.placement.heading - written.placement.heading).rem_euclid(std::f32::consts::TAU);
        assert!(turn.min(std::f32::consts::TAU - turn) < 1e-5);
        assert!(read.placement.translation.distance(written.placement.translation) < 3e-5);
    }
}

fn check_poses(reader: &mut BundleReader, input: &BundleInput) {
    let capture = input.capture;
    let mut pose = vec![Vec3::ZERO; capture.poses.vertex_count()];
    let frames = capture.poses.len() as u32;
    for frame in (0..frames).rev().chain(0..frames) {
        reader.read(frame, &mut pose).unwrap();
        for (read, written) in pose.iter().zip(capture.poses.frame(frame)) {
            let distance = read.as_dvec3().distance(written.as_dvec3());
            assert!(distance <= f64::from(input.max_error), "frame {frame}: {distance}");
        }
        if frame == input.first_frame {
            assert_eq!(reader.first_pose(), Some(&pose[..]));
        }
    }
    assert_eq!(reader.read(frames, &mut pose), Err(PoseError::OutOfRange(frames)));
}

#[test]
fn a_capture_comes_back() {
    let capture = cloth(12, 9, &[40, 1, 9, 70]);
    let graph = graph(&capture.timeline).with_ties(ties(&capture.topology));
    let order: Vec<u32> = (0..117).map(|i| i * 50 % 117).collect();
    let mut input = BundleInput { first_frame: 47, poisson_order: Some(&order), ..input(&capture, &graph) };
    for max_error in [input.max_error, 1e-5, 0.05] {
        input.max_error = max_error;
        let (bytes, report) = encode(&input).unwrap();
        assert_eq!(report.bytes, bytes.len() as u64);
        assert_eq!(report.sections.iter().map(|size| size.stored).sum::<u64>(), report.bytes);
        assert!(report.max_error <= f64::from(max_error) && report.rms_error <= report.max_error);
        check(&mut BundleReader::from_bytes(&bytes).unwrap(), &input);
        assert_eq!(validate(&bytes), []);
        assert_eq!(encode(&input).unwrap().0, bytes, "the same input gives the same bytes");
    }
}

#[test]
fn a_rig_comes_back_and_one_of_another_mesh_is_refused() {
    let capture = cloth(12, 9, &[40, 5]);
    let graph = graph(&capture.timeline);
    let order: Vec<u32> = (0..117).collect();
    let input = BundleInput { poisson_order: Some(&order), ..input(&capture, &graph) };
    let stored = rig(117, 41);
    let with = |stored: &StoredRig| encode_with_rig(&input, &[], &Files::default(), Some(stored));
    let (bytes, _) = with(&stored).unwrap();
    assert_eq!(BundleReader::from_bytes(&bytes).unwrap().rig(), Ok(Some(stored.clone())));
    assert_eq!(validate(&bytes), []);
    let refused = |stored: &StoredRig| with(stored).unwrap_err().to_string();
    assert!(refused(&rig(116, 41)).contains("another mesh"));
    assert!(refused(&rig(117, 45)).contains("frame that does not exist"));
    let mut wrong = stored.clone();
    wrong.influences[7] = vec![(9, 255)];
    assert!(refused(&wrong).contains("bone that does not exist"));
    // Bones that do not fit together are found once the rest pose is there.
    let mut twice = stored;
    twice.bones[2].name = "left".into();
    let findings = validate(&with(&twice).unwrap().0);
    assert!(findings.len() == 1 && findings[0].message.contains("two bones"), "{findings:?}");
}

#[test]
fn a_bundle_may_arrive_in_any_pieces() {
    let capture = cloth(12, 9, &[40, 5]);
    let graph = graph(&capture.timeline);
    let input = BundleInput { first_frame: 41, ..input(&capture, &graph) };
    let (bytes, report) = encode(&input).unwrap();
    for size in [1, 7, 1000, bytes.len()] {
        let mut reader = BundleReader::new();
        let mut pose = vec![Vec3::ZERO; capture.poses.vertex_count()];
        for piece in bytes.chunks(size) {
            assert_eq!(reader.finish().is_ok(), reader.is_complete());
            reader.push(piece).unwrap();
            let enough = reader.bytes_received() >= report.bytes_to_first_pose;
            assert_eq!(reader.first_pose().is_some(), enough);
            for frame in [0, 41] {
                let loaded = reader.frame_loaded(frame);
                assert_eq!(reader.read(frame, &mut pose).is_ok(), loaded);
                assert!(loaded || reader.read(frame, &mut pose) == Err(PoseError::NotLoaded(frame)));
            }
        }
        assert_eq!(reader.bytes_total(), Some(bytes.len() as u64));
        check(&mut reader, &input);
        assert!(matches!(reader.push(b"x"), Err(BundleError::Inconsistent { kind: None, .. })));
    }
}

#[test]
fn walking_away_and_turning_cost_nothing() {
    let still = cloth(20, 15, &[33]);
    let mut moving = still.clone();
    moving.poses = Poses::new(still.poses.vertex_count());
    for (frame, pose) in still.poses.iter().enumerate() {
        let step = Vec3::new(0.07, 0.01, -0.11) * frame as f32;
        moving.poses.push(&pose.iter().map(|&position| position + step).collect::<Vec<_>>());
    }
    let graph = EssentialGraph::new(0.01, Vec::new(), &still.timeline).unwrap();
    let bytes = |capture| encode(&input(capture, &graph)).unwrap().1.bytes_per_frame;
    let (still, moving) = (bytes(&still), bytes(&moving));
    assert!(moving < 1.1 * still + 10.0, "{moving} against {still} bytes a frame");
}

#[test]
fn refuses_what_cannot_be_written() {
    let capture = cloth(4, 3, &[5, 3]);
    let graph = graph(&capture.timeline);
    let refused = |input: BundleInput| encode(&input).unwrap_err();
    let missing = refused(BundleInput { first_frame: 8, ..input(&capture, &graph) });
    assert_eq!(missing, EncodeError::FirstFrame { first_frame: 8, frame_count: 8 });
    for max_error in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let error = refused(BundleInput { max_error, ..input(&capture, &graph) });
        assert!(matches!(error, EncodeError::MaxError(_)));
    }
    let too_exact = refused(BundleInput { max_error: 1e-9, ..input(&capture, &graph) });
    assert!(matches!(too_exact, EncodeError::Position { .. }));
    let twice = [0; 21];
    let error = refused(BundleInput { poisson_order: Some(&twice), ..input(&capture, &graph) });
    assert!(matches!(error, EncodeError::Inconsistent(_)));
    let mut broken = capture.clone();
    let mut pose = broken.poses.frame(6).to_vec();
    pose[4].z = f32::NAN;
    broken.poses = Poses::new(pose.len());
    for frame in 0..8 {
        broken.poses.push(if frame == 6 { &pose } else { capture.poses.frame(frame) });
    }
    assert_eq!(refused(input(&broken, &graph)), EncodeError::Position { frame: 6, vertex: 4 });
    let mut unlike = capture.clone();
    unlike.surface.triangles[0].rotate_left(1);
    assert!(matches!(refused(input(&unlike, &graph)), EncodeError::Inconsistent(_)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Vertices that jump about without any sense: nothing can be predicted, the bound must hold all the same.
    #[test]
    fn noise_stays_within_its_bound(
        positions in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f32), 21 * 8..=21 * 8),
        max_error in prop_oneof![Just(1e-4_f32), 1e-4..0.5_f32],
        first_frame in 0..8_u32,
    ) {
        let mut capture = cloth(4, 3, &[5, 3]);
        capture.poses = Poses::new(21);
        for pose in positions.chunks_exact(21) {
            capture.poses.push(&pose.iter().copied().map(Vec3::from).collect::<Vec<_>>());
        }
        let graph = graph(&capture.timeline);
        let input = BundleInput { max_error, first_frame, ..input(&capture, &graph) };
        let (bytes, _) = encode(&input).unwrap();
        check(&mut BundleReader::from_bytes(&bytes).unwrap(), &input);
    }
}
