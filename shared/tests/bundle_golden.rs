//! Old bundles stay readable, and the writer's bytes change only on purpose.
//!
//! `golden/v1.0.reprise` was written by version 1.0, and so on. Never replace one: a change of the format adds a file.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

mod captures;

use captures::{graph, timeline};
use glam::Vec3;
use shared::bundle::{BundleInput, BundleReader, encode, validate};
use shared::capture::{Capture, Poses};
use shared::pose_source::PoseSource;
use shared::search::Motion;
use shared::surface::{Corner, Image, ImageFormat, Material, Part, Surface};
use shared::topology::Topology;

const GOLDEN: &[u8] = include_bytes!("golden/v1.1.reprise");
/// What earlier versions wrote.
const GOLDEN_1_0: &[u8] = include_bytes!("golden/v1.0.reprise");

/// A pyramid that slides, leans and swings, made of whole numbers so that it is the same on every machine.
fn pyramid() -> Capture {
    let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let mut poses = Poses::new(5);
    for frame in 0..14_i16 {
        let corner = |x: i16, y: i16, z: i16| {
            let lean = (frame % 5 - 2) * y;
            Vec3::new(f32::from(x + 3 * frame + lean), f32::from(y), f32::from(z - frame * frame)) / 128.0
        };
        poses.push(&[corner(0, 0, 0), corner(50, 0, 0), corner(50, 0, 50), corner(0, 0, 50), corner(25, 90, 25)]);
    }
    let corner = |vertex: u32| Corner { vertex, uv: [(vertex % 2) as f32, (vertex / 4) as f32], colour: [255; 4] };
    let image = Image { format: ImageFormat::WebP, width: 1, height: 1, bytes: vec![82, 73, 70, 70] };
    let material =
        Material { name: "stone".into(), base_colour: [0.5, 0.25, 0.125, 1.0], image: Some(0), double_sided: false };
    let surface = Surface {
        corners: (0..5).map(corner).collect(),
        triangles: triangles.clone(),
        parts: vec![Part { material: 0, first_triangle: 0, triangle_count: 4 }],
        materials: vec![material],
        images: vec![image],
    };
    let topology = Topology::new(5, triangles, vec![1.0, 1.0, 1.0, 1.0, 4.0]).unwrap();
    let vertex_of_file_vertex = vec![4, 3, 2, 1, 0, 0];
    Capture { name: "pyramid".into(), topology, surface, timeline: timeline(&[9, 5]), poses, vertex_of_file_vertex }
}

#[test]
fn the_writer_has_not_changed() {
    let capture = pyramid();
    let graph = graph_without_transcendentals(&capture);
    let order = [4, 2, 0, 1, 3];
    let generator = "reprise 0.1.0".into();
    let poisson_order = Some(&order[..]);
    let input =
        BundleInput { capture: &capture, graph: &graph, first_frame: 10, max_error: 0.001, poisson_order, generator };
    let (bytes, _) = encode(&input).unwrap();
    if bytes != GOLDEN {
        let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/written.reprise");
        std::fs::write(path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside the old file"
        );
    }
}

/// The common graph with costs and placements that are whole numbers over powers of two.
fn graph_without_transcendentals(capture: &Capture) -> shared::graph::EssentialGraph {
    let mut transitions = graph(&capture.timeline).transitions().to_vec();
    for transition in &mut transitions {
        let (from, to) = (transition.from as f32, transition.to as f32);
        transition.deformation = (from + 2.0 * to + 1.0) / 16.0;
        transition.placement.heading = (from - to) / 8.0;
        transition.placement.translation = glam::Vec2::new(from, -to) / 4.0;
    }
    shared::graph::EssentialGraph::new(0.015625, transitions, &capture.timeline).unwrap()
}

#[test]
fn all_versions_can_be_read() {
    for golden in [GOLDEN_1_0, GOLDEN] {
        check_golden(golden);
    }
    assert_eq!(BundleReader::from_bytes(GOLDEN_1_0).unwrap().motion(), None);
    let capture = pyramid();
    let stored = BundleReader::from_bytes(GOLDEN).unwrap().motion().unwrap().clone();
    let measured = Motion::measure(&capture.timeline, capture.topology.weights(), &mut capture.poses.clone()).unwrap();
    for (a, b) in stored.centres.iter().zip(&measured.centres) {
        assert!(a.distance(*b) < 1e-4);
    }
    assert!(stored.fits(&capture.timeline));
}

fn check_golden(golden: &[u8]) {
    let capture = pyramid();
    let mut reader = BundleReader::from_bytes(golden).unwrap();
    assert_eq!(validate(golden), []);
    assert_eq!(reader.meta().unwrap().generator, "reprise 0.1.0");
    assert_eq!(reader.timeline(), Some(&capture.timeline));
    assert_eq!(reader.surface(), Some(&capture.surface));
    assert_eq!(reader.topology().unwrap().triangles(), capture.topology.triangles());
    assert_eq!(reader.graph(), Some(&graph_without_transcendentals(&capture)));
    assert_eq!(reader.order(), Some(&[4, 2, 0, 1, 3][..]));
    assert_eq!(reader.file_vertices(), Some(&[4, 3, 2, 1, 0, 0][..]));
    let mut pose = [Vec3::ZERO; 5];
    let mut hasher = crc32fast::Hasher::new();
    for frame in 0..14 {
        reader.read(frame, &mut pose).unwrap();
        for (read, written) in pose.iter().zip(capture.poses.frame(frame)) {
            assert!(read.distance(*written) <= 0.001);
        }
        hasher.update(bytemuck::cast_slice(&pose));
    }
    assert_eq!(hasher.finalize(), POSITIONS_CHECKSUM, "decoded positions are not the same bit for bit");
}

/// CRC-32 of all decoded positions.
const POSITIONS_CHECKSUM: u32 = 1_799_306_145;
