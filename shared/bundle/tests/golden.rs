//! Old bundles stay readable, and the writer's bytes change only on purpose.
//!
//! `golden/v1.0.reprise` was written by version 1.0, and so on; the ones with `appearance` have that too. Never replace one: a
//! change of the format adds a file.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

mod captures;

use actor::alternatives::{Alternatives, Stretch};
use actor::capture::{Capture, Poses};
use actor::contacts::{Contacts, Held};
use actor::families::{Family, FamilyMember};
use actor::feet::Feet;
use actor::files::{FaceRun, FileFaces, FilePlace, Files};
use actor::graph::TURN_STEP;
use actor::motion::Motion;
use actor::pose_source::PoseSource;
use actor::surface::{Corner, Image, ImageFormat, Material, Part, Surface};
use actor::timeline::Timeline;
use bundle::{
    AppearanceInput, AppearanceQuality, BundleInput, BundleReader, Extras, FoundParts, ModeDecoder, ScannedCorner,
    ScannedFrames, ScannedGroup, code_group, encode_with_extras, encode_with_files, encode_with_rig, ordered, validate,
};
use captures::{contacts, feet, graph, rig, ties, timeline};
use editing::{StoredMode, StoredSpace};
use glam::{DVec3, Vec3};
use kernels::topology::Topology;
use texture::TextureModel;

const GOLDEN: &[u8] = include_bytes!("golden/v1.1.reprise");
/// What earlier versions wrote.
const GOLDEN_1_0: &[u8] = include_bytes!("golden/v1.0.reprise");
const GOLDEN_WITH_CONTACTS: &[u8] = include_bytes!("golden/v1.2.reprise");
const GOLDEN_WITH_EARLIER_APPEARANCE: &[u8] = include_bytes!("golden/v1.1-appearance.reprise");
const GOLDEN_WITH_APPEARANCE: &[u8] = include_bytes!("golden/v1.3-appearance.reprise");
const GOLDEN_WITH_FILES: &[u8] = include_bytes!("golden/v1.4-files.reprise");
const GOLDEN_WITH_TIES: &[u8] = include_bytes!("golden/v1.6-ties.reprise");
const GOLDEN_WITH_RIG: &[u8] = include_bytes!("golden/v1.7-rig.reprise");
const GOLDEN_WITH_ALTERNATIVES: &[u8] = include_bytes!("golden/v1.8-alternatives.reprise");
const GOLDEN_WITH_LATER_ALTERNATIVES: &[u8] = include_bytes!("golden/v1.14-alternatives.reprise");
const GOLDEN_WITH_PARTS: &[u8] = include_bytes!("golden/v1.10-parts.reprise");
const GOLDEN_WITH_TURNS: &[u8] = include_bytes!("golden/v1.12-turns.reprise");
const GOLDEN_WITH_FOUND_PARTS: &[u8] = include_bytes!("golden/v1.14-found-parts.reprise");
const GOLDEN_WITH_FAMILIES: &[u8] = include_bytes!("golden/v1.11-families.reprise");
const GOLDEN_WITH_LEARNED_SPACE: &[u8] = include_bytes!("golden/v1.13-learned.reprise");
const GOLDEN_WITH_SCANNED: &[u8] = include_bytes!("golden/v1.15-scanned.reprise");
const GOLDEN_WITH_STEERING_CONTACTS: &[u8] = include_bytes!("golden/v1.9-contacts.reprise");
const GOLDEN_WITH_FEET: &[u8] = include_bytes!("golden/v1.5-feet.reprise");

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

/// Two charts side by side, and modes of whole numbers.
fn looks() -> TextureModel {
    let active: Vec<bool> = (0..40 * 18).map(|at| at % 40 != 19).collect();
    let count = active.iter().filter(|&&active| active).count();
    let values = |channels: usize, factor: usize| -> Vec<f32> {
        (0..count * channels).map(|at| ((at / 7 * factor) % 16) as f32 / 16.0).collect()
    };
    let modes = |channels: usize, count: usize| -> Vec<Vec<f32>> {
        (0..count).map(|mode| values(channels, 3 + 2 * mode).iter().map(|value| value - 0.5).collect()).collect()
    };
    let coefficients = |count: usize| (0..14 * count).map(|at| ((at * 5) % 8) as f32 / 64.0 - 0.0625).collect();
    TextureModel {
        width: 40,
        height: 18,
        active,
        mean_texture: values(3, 5),
        textures: modes(3, 3),
        mean_warp: values(2, 11),
        warps: modes(2, 2),
        texture_coefficients: coefficients(3),
        warp_coefficients: coefficients(2),
    }
}

/// The pyramid's files: two of its triangles were a polygon, the first vertex was there twice, and one edge was sharp.
fn files() -> Files {
    let faces = FileFaces {
        corners: vec![[4, 3, 0], [3, 2, 0], [2, 1, 0], [1, 5, 0]],
        joined: vec![false, true, false, false],
        runs: vec![FaceRun { part: 0, faces: 3 }],
        normals: vec![[0, 0, 0], [0, 0, 0], [1, 0, 1], [0, 1, 1]],
    };
    let place = FilePlace { offset: DVec3::new(432_188.0, 13.0, -583_922.0), unit: 0.01, z_up: true };
    Files { faces: Some(faces), place }
}

/// As they were until 1.8.
fn earlier_contacts(timeline: &Timeline) -> Contacts {
    contacts(timeline).held(Held::Alike)
}

fn check_writer(appearance: Option<&AppearanceInput>, contacts: Contacts, golden: &[u8]) {
    check_writer_of(appearance, contacts, &Files::default(), golden);
}

fn check_writer_of(appearance: Option<&AppearanceInput>, contacts: Contacts, files: &Files, golden: &[u8]) {
    let capture = pyramid();
    let standing = contacts.parts() > 0;
    let graph = graph_without_transcendentals(&capture).with_contacts(contacts);
    let order = [4, 2, 0, 1, 3];
    let generator = "reprise 0.1.0".into();
    let poisson_order = Some(&order[..]);
    let input =
        BundleInput { capture: &capture, graph: &graph, first_frame: 10, max_error: 0.001, poisson_order, generator };
    let (bytes, _) = encode_with_files(&input, appearance.map_or(&[], std::slice::from_ref), files).unwrap();
    if bytes != golden {
        let name = format!("written-{}-{standing}-{}", appearance.is_some(), files.faces.is_some());
        let path = format!("{}/{name}.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside the old file"
        );
    }
}

#[test]
fn the_writer_has_not_changed() {
    check_writer(None, Contacts::default(), GOLDEN);
}

#[test]
fn the_writer_of_contacts_has_not_changed() {
    check_writer(None, earlier_contacts(&pyramid().timeline), GOLDEN_WITH_CONTACTS);
}

#[test]
fn version_1_2_can_be_read() {
    check_golden(GOLDEN_WITH_CONTACTS, earlier_contacts(&pyramid().timeline));
}

#[test]
fn version_1_9_can_be_written_and_read() {
    let steering = contacts(&pyramid().timeline);
    check_writer(None, steering.clone(), GOLDEN_WITH_STEERING_CONTACTS);
    check_golden(GOLDEN_WITH_STEERING_CONTACTS, steering);
}

#[test]
fn the_writer_of_appearance_has_not_changed() {
    let model = looks();
    let appearance = AppearanceInput { model: &model, material: 0, quality: AppearanceQuality::default() };
    check_writer(Some(&appearance), Contacts::default(), GOLDEN_WITH_APPEARANCE);
}

#[test]
fn the_writer_of_files_has_not_changed() {
    check_writer_of(None, Contacts::default(), &files(), GOLDEN_WITH_FILES);
}

#[test]
fn version_1_4_can_be_read() {
    check_golden(GOLDEN_WITH_FILES, Contacts::default());
    let reader = BundleReader::from_bytes(GOLDEN_WITH_FILES).unwrap();
    assert_eq!(Files { faces: reader.file_faces().unwrap(), place: reader.file_place() }, files());
}

#[test]
fn version_1_5_can_be_written_and_read() {
    let capture = pyramid();
    let feet = feet(5, &capture.timeline);
    let graph =
        graph_without_transcendentals(&capture).with_contacts(earlier_contacts(&capture.timeline)).with_feet(feet);
    let (order, generator) = ([4, 2, 0, 1, 3], "reprise 0.1.0".into());
    let poisson_order = Some(&order[..]);
    let input =
        BundleInput { capture: &capture, graph: &graph, first_frame: 10, max_error: 0.001, poisson_order, generator };
    let (bytes, _) = encode_with_files(&input, &[], &Files::default()).unwrap();
    if bytes != GOLDEN_WITH_FEET {
        let path = format!("{}/written-feet.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, reader.graph()), (5, Some(&graph)));
    // A mesh without feet is written as before.
    let plain = graph.clone().with_feet(Feet::default());
    let (bytes, _) = encode_with_files(&BundleInput { graph: &plain, ..input }, &[], &Files::default()).unwrap();
    assert_eq!(bytes, GOLDEN_WITH_CONTACTS);
}

/// Frames 3 and 4 of the pyramid as they might have been scanned, and frame 9 in colours.
fn scanned() -> Vec<ScannedGroup> {
    let capture = pyramid();
    let corner = |vertex: u32| ScannedCorner { vertex, uv: [(vertex % 2) as f32, (vertex / 4) as f32] };
    let pose = |frame: u32| capture.poses.frame(frame).iter().map(|&p| p + Vec3::Y / 64.0).collect();
    let image = |byte: u8| Image { format: ImageFormat::Jpeg, width: 2, height: 1, bytes: vec![255, 216, byte] };
    let both = ScannedGroup {
        first_frame: 3,
        corners: (0..5).map(corner).collect(),
        triangles: capture.surface.triangles.clone(),
        poses: vec![pose(3), pose(4)],
        colours: Vec::new(),
        images: vec![image(7), image(9)],
        worn: vec![0, 1],
    };
    let colours = (0..5).map(|vertex| [50 * vertex, 3, 255]).collect();
    let alone =
        ScannedGroup { first_frame: 9, poses: vec![pose(9)], colours, images: vec![], worn: vec![], ..both.clone() };
    vec![both, alone]
}

#[test]
fn version_1_15_can_be_written_and_read() {
    let capture = pyramid();
    let graph = graph_without_transcendentals(&capture);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[4, 2, 0, 1, 3]),
        generator: "reprise 0.1.0".into(),
    };
    let step = 1.0 / 1024.0;
    let mut frames = ScannedFrames::default();
    scanned().iter().for_each(|group| frames.push(code_group(group, step).unwrap()));
    let mut extras = Extras::default();
    extras.scanned = Some(&frames);
    let (bytes, _) = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap();
    if bytes != GOLDEN_WITH_SCANNED {
        let path = format!("{}/written-scanned.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!(reader.header().unwrap().minor, 15);
    for (ordinal, group) in (0..).zip(scanned()) {
        let read = reader.scanned().unwrap().read(ordinal, reader.scanned_group(ordinal).unwrap()).unwrap();
        let expected = ordered(&group);
        // All of it is whole numbers of steps; without images there are no texture coordinates.
        assert_eq!((read.triangles, read.poses, read.colours), (expected.triangles, expected.poses, expected.colours));
        assert_eq!(read.worn, expected.worn);
        assert!(group.images.is_empty() || read.corners == expected.corners);
    }
}

/// Two pyramids beside each other.
fn pyramids() -> Capture {
    let one = pyramid();
    let mut poses = Poses::new(10);
    for frame in 0..14 {
        let pose = one.poses.frame(frame);
        let other = pose.iter().map(|&point| point + Vec3::new(0.5, 0.25 * (frame % 3) as f32, 0.0));
        poses.push(&pose.iter().copied().chain(other).collect::<Vec<Vec3>>());
    }
    let both = |triangles: &[[u32; 3]]| -> Vec<[u32; 3]> {
        [0, 5].iter().flat_map(|first| triangles.iter().map(move |t| t.map(|vertex| vertex + first))).collect()
    };
    let triangles = both(one.topology.triangles());
    let mut surface = one.surface;
    surface.corners = (0..10).map(|vertex| Corner { vertex, ..surface.corners[vertex as usize % 5] }).collect();
    surface.parts[0].triangle_count = 8;
    surface.triangles.clone_from(&triangles);
    let topology = Topology::new(10, triangles, vec![1.0; 10]).unwrap();
    Capture { name: "pyramids".into(), topology, surface, poses, vertex_of_file_vertex: Vec::new(), ..one }
}

#[test]
fn version_1_6_can_be_written_and_read() {
    let capture = pyramids();
    let graph = graph_without_transcendentals(&capture).with_ties(ties(&capture.topology));
    assert_eq!(graph.ties().all().len(), 1);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[9, 8, 7, 6, 5, 4, 3, 2, 1, 0]),
        generator: "reprise 0.1.0".into(),
    };
    let (bytes, _) = encode_with_files(&input, &[], &Files::default()).unwrap();
    if bytes != GOLDEN_WITH_TIES {
        let path = format!("{}/written-ties.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, reader.graph()), (6, Some(&graph)));
}

#[test]
fn version_1_7_can_be_written_and_read() {
    let capture = pyramid();
    let graph = graph_without_transcendentals(&capture);
    let rig = rig(5, 3);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[4, 2, 0, 1, 3]),
        generator: "reprise 0.1.0".into(),
    };
    let (bytes, _) = encode_with_rig(&input, &[], &Files::default(), Some(&rig)).unwrap();
    if bytes != GOLDEN_WITH_RIG {
        let path = format!("{}/written-rig.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, reader.rig()), (7, Ok(Some(rig))));
}

#[test]
fn alternatives_of_version_1_14_can_be_written_and_those_of_1_8_read() {
    let capture = pyramid();
    let graph = graph_without_transcendentals(&capture);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[4, 2, 0, 1, 3]),
        generator: "reprise 0.1.0".into(),
    };
    let modes = vec![(0..5).map(|k| [127 - 3 * k, k, -20 * k]).collect(), vec![[0, 5, -5]; 5]];
    let rows = |turn: i16| (0..6).map(|at| turn * (at - 3) * 50).collect::<Vec<i16>>();
    let stretch = Stretch { first: 2, last: 6, headings: vec![30, -40, 900], coefficients: vec![rows(1), rows(-1)] };
    let all = Alternatives::new(modes, vec![stretch], 5, &capture.timeline).unwrap();
    let mut extras = Extras::default();
    extras.alternatives = Some(&all);
    let (bytes, _) = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap();
    if bytes != GOLDEN_WITH_LATER_ALTERNATIVES {
        let path = format!("{}/written-alternatives.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let mut reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, reader.read_alternatives()), (14, Ok(Some(all.clone()))));
    let mut earlier = BundleReader::from_bytes(GOLDEN_WITH_ALTERNATIVES).unwrap();
    assert_eq!((earlier.header().unwrap().minor, earlier.read_alternatives()), (8, Ok(Some(all))));
    assert_eq!(validate(GOLDEN_WITH_ALTERNATIVES), []);
    assert_eq!(reader.read_alternatives(), Ok(None), "they are taken");
}

#[test]
fn version_1_10_can_be_written_and_read() {
    let capture = pyramid();
    let graph = graph_without_transcendentals(&capture);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[4, 2, 0, 1, 3]),
        generator: "reprise 0.1.0".into(),
    };
    let parts = [0, 0, 9, 255, 9];
    let mut extras = Extras::default();
    extras.body_parts = Some(&parts);
    let (bytes, _) = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap();
    if bytes != GOLDEN_WITH_PARTS {
        let path = format!("{}/written-parts.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, reader.body_parts()), (10, Ok(Some(parts.to_vec()))));
    extras.body_parts = Some(&parts[1..]);
    let refused = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap_err();
    assert!(refused.to_string().contains("another mesh"), "{refused}");
}

#[test]
fn version_1_14_can_be_written_and_read() {
    let capture = pyramid();
    let graph = graph_without_transcendentals(&capture);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[4, 2, 0, 1, 3]),
        generator: "reprise 0.1.0".into(),
    };
    let mut parts = FoundParts { names: vec!["torso".into(), "left arm".into()], of_vertex: vec![0, 0, 0, 0, 1] };
    let mut extras = Extras::default();
    extras.found_parts = Some(&parts);
    let (bytes, _) = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap();
    if bytes != GOLDEN_WITH_FOUND_PARTS {
        let path = format!("{}/written-found-parts.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, reader.found_parts()), (14, Ok(Some(parts.clone()))));
    assert_eq!(reader.body_parts(), Ok(None), "nobody painted them");
    parts.of_vertex.pop();
    let mut extras = Extras::default();
    extras.found_parts = Some(&parts);
    let refused = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap_err();
    assert!(refused.to_string().contains("another mesh"), "{refused}");
}

#[test]
fn version_1_11_can_be_written_and_read() {
    let mut capture = pyramid();
    let graph = graph_without_transcendentals(&capture);
    let last = capture.timeline.sequences().last().unwrap();
    let member = |frames, value| FamilyMember { sequence: last.name.clone(), frames, value };
    let (first, end) = (last.first_frame, last.end_frame() - 1);
    let families = vec![Family {
        name: "gait \"1\"".into(),
        parameter: "speed".into(),
        unit: "m/s".into(),
        members: vec![member([first, end], 1.571_3), member([first, first], 0.93)],
    }];
    capture.timeline = capture.timeline.clone().with_families(families.clone()).unwrap();
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[4, 2, 0, 1, 3]),
        generator: "reprise 0.1.0".into(),
    };
    let (bytes, _) = bundle::encode(&input).unwrap();
    if bytes != GOLDEN_WITH_FAMILIES {
        let path = format!("{}/written-families.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    let timeline = reader.timeline_with_families().unwrap().unwrap();
    assert_eq!((reader.header().unwrap().minor, timeline.families()), (11, &families[..]));
    assert_eq!(reader.timeline().unwrap().families(), [], "they are read where they are asked for");
}

#[test]
fn version_1_12_can_be_written_and_read() {
    let capture = pyramid();
    let turns = |index: usize| ((index * 7919) % 1201) as f32 - 600.0;
    let graph = graph_without_transcendentals(&capture);
    let turns: Vec<f32> = (0..graph.transitions().len()).map(|index| turns(index) * TURN_STEP).collect();
    let graph = graph.with_turns(&turns);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[4, 2, 0, 1, 3]),
        generator: "reprise 0.1.0".into(),
    };
    let (bytes, _) = bundle::encode(&input).unwrap();
    if bytes != GOLDEN_WITH_TURNS {
        let path = format!("{}/written-turns.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    let read: Vec<f32> = reader.graph().unwrap().transitions().iter().map(|transition| transition.turn).collect();
    assert_eq!((reader.header().unwrap().minor, read), (12, turns));
}

#[test]
fn version_1_13_can_be_written_and_read() {
    let capture = pyramid();
    let graph = graph_without_transcendentals(&capture);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 10,
        max_error: 0.001,
        poisson_order: Some(&[4, 2, 0, 1, 3]),
        generator: "reprise 0.1.0".into(),
    };
    let mode = |variance, shares: [i16; 3]| StoredMode { variance, step: 0.0625, shares: shares.to_vec() };
    let modes = vec![mode(0.5, [2047, -2047, 3]), mode(0.125, [0, 40, -9])];
    let space = StoredSpace { frames: vec![11, 0, 13, 4], modes };
    let mut extras = Extras::default();
    extras.learned = Some(&space);
    let (bytes, _) = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap();
    if bytes != GOLDEN_WITH_LEARNED_SPACE {
        let path = format!("{}/written-learned.reprise", env!("CARGO_TARGET_TMPDIR"));
        std::fs::write(&path, &bytes).unwrap();
        panic!(
            "the writer makes other bytes than before; if that is meant, raise the version and keep {path} beside it"
        );
    }
    assert_eq!(validate(&bytes), []);
    let reader = BundleReader::from_bytes(&bytes).unwrap();
    assert_eq!((reader.header().unwrap().minor, reader.learned()), (13, Ok(Some(space.clone()))));
    let beyond = StoredSpace { frames: vec![11, 0, 14, 4], ..space.clone() };
    extras.learned = Some(&beyond);
    let refused = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap_err();
    assert!(refused.to_string().contains("another capture"), "{refused}");
}

#[test]
fn version_1_1_can_be_read() {
    assert_eq!(
        looks_checksum(GOLDEN_WITH_EARLIER_APPEARANCE),
        EARLIER_MODES_CHECKSUM,
        "decoded modes are not the same"
    );
}

#[test]
fn version_1_3_can_be_read() {
    assert_eq!(looks_checksum(GOLDEN_WITH_APPEARANCE), MODES_CHECKSUM, "decoded modes are not the same");
}

/// Of all decoded modes, coefficients and scales, bit for bit.
fn looks_checksum(golden: &[u8]) -> u32 {
    let reader = BundleReader::from_bytes(golden).unwrap();
    assert_eq!(validate(golden), []);
    let appearance = reader.appearance().unwrap();
    assert_eq!((appearance.size, appearance.material), ([40, 18], 0));
    let active: Vec<bool> = appearance.mask.full().flags.iter().map(|flags| flags & 1 == 1).collect();
    assert_eq!(active, looks().active);
    let (mut hasher, mut decoder) = (crc32fast::Hasher::new(), ModeDecoder::default());
    for ordinal in 0..appearance.section_count() {
        let (layer, _) = appearance.place(ordinal).unwrap();
        let bytes = reader.mode_bytes(ordinal).unwrap();
        let mode = decoder.advance(bytes, appearance, layer, usize::MAX).unwrap().unwrap();
        hasher.update(bytemuck::cast_slice(&mode.offsets));
        hasher.update(bytemuck::cast_slice(&mode.entries));
    }
    for layer in &appearance.layers {
        hasher.update(bytemuck::cast_slice(&layer.coefficients));
    }
    // Versions before 1.3 have the same steps everywhere.
    for layer in appearance.layers.iter().filter(|layer| layer.scales.iter().any(|&scale| scale != 1.0)) {
        hasher.update(bytemuck::cast_slice(&layer.scales));
    }
    hasher.finalize()
}

/// CRC-32 of all decoded modes, coefficients and scales.
const EARLIER_MODES_CHECKSUM: u32 = 1_235_211_428;
const MODES_CHECKSUM: u32 = 3_815_803_761;

/// The common graph with costs and placements that are whole numbers over powers of two.
fn graph_without_transcendentals(capture: &Capture) -> actor::graph::EssentialGraph {
    let mut transitions = graph(&capture.timeline).transitions().to_vec();
    for transition in &mut transitions {
        let (from, to) = (transition.from as f32, transition.to as f32);
        transition.deformation = (from + 2.0 * to + 1.0) / 16.0;
        transition.placement.heading = (from - to) / 8.0;
        transition.placement.translation = glam::Vec2::new(from, -to) / 4.0;
    }
    actor::graph::EssentialGraph::new(0.015625, transitions, &capture.timeline).unwrap()
}

#[test]
fn all_versions_can_be_read() {
    for golden in [GOLDEN_1_0, GOLDEN] {
        check_golden(golden, Contacts::default());
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

fn check_golden(golden: &[u8], contacts: Contacts) {
    let capture = pyramid();
    let mut reader = BundleReader::from_bytes(golden).unwrap();
    assert_eq!(validate(golden), []);
    assert_eq!(reader.meta().unwrap().generator, "reprise 0.1.0");
    assert_eq!(reader.timeline(), Some(&capture.timeline));
    assert_eq!(reader.surface(), Some(&capture.surface));
    assert_eq!(reader.topology().unwrap().triangles(), capture.topology.triangles());
    assert_eq!(reader.graph(), Some(&graph_without_transcendentals(&capture).with_contacts(contacts)));
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
