//! Edits on a page are those of a film, to the bit; what comes from outside is refused with a sentence.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use actor::capture::{Capture, Poses};
use actor::feet::{Feet, FootVertex};
use actor::files::Files;
use actor::graph::EssentialGraph;
use actor::pose_source::PoseSource;
use actor::surface::{Corner, Material, Part, Surface};
use actor::timeline::{Sequence, Timeline};
use bundle::{BundleInput, BundleReader, Extras, encode_with_extras};
use editing::{Bone, EditDocument, EditedPoses, Editor, Influences, Rig, StoredMode, StoredRig, StoredSpace};
use editor::scene::{Known, words};
use editor::session::{Session, SessionError};
use glam::{Mat3, Quat, Vec3};
use kernels::topology::Topology;

const RINGS: u32 = 15;
const AROUND: u32 = 8;
const COUNT: u32 = RINGS * AROUND;
const FRAMES: u32 = 24;
const REST: u32 = 2;
const TOP: u32 = COUNT - 3;

fn rest(vertex: u32) -> Vec3 {
    let angle = (vertex % AROUND) as f32 * 0.785;
    Vec3::new(0.12 * angle.cos(), (vertex / AROUND) as f32 * 0.1, 0.1 * angle.sin())
}

/// A tube that bends in the middle and turns.
fn capture() -> Capture {
    let at = |ring: u32, k: u32| ring * AROUND + k % AROUND;
    let quads = (0..RINGS - 1).flat_map(|ring| (0..AROUND).map(move |k| (ring, k)));
    let triangles: Vec<[u32; 3]> = quads
        .flat_map(|(ring, k)| {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1)];
            [[a, c, b], [b, c, d]]
        })
        .collect();
    let mut poses = Poses::new(COUNT as usize);
    for frame in 0..FRAMES {
        let (bend, turn) = (0.3 + 0.2 * (0.4 * frame as f32).sin(), Quat::from_rotation_y(0.03 * frame as f32));
        let point = |vertex| {
            let p = rest(vertex);
            let share = ((p.y - 0.7) / 0.2 + 0.5).clamp(0.0, 1.0);
            let joint = Vec3::Y * 0.7;
            turn * (joint + Quat::from_rotation_x(bend * share) * (p - joint))
        };
        poses.push(&(0..COUNT).map(point).collect::<Vec<Vec3>>());
    }
    let sequence = Sequence { name: "bend".into(), labels: vec![], first_frame: 0, frame_count: FRAMES, cyclic: false };
    let material = Material { name: "m".into(), base_colour: [1.0; 4], image: None, double_sided: false };
    let surface = Surface {
        corners: (0..COUNT).map(|vertex| Corner { vertex, uv: [0.0; 2], colour: [255; 4] }).collect(),
        triangles: triangles.clone(),
        parts: vec![Part { material: 0, first_triangle: 0, triangle_count: triangles.len() as u32 }],
        materials: vec![material],
        images: vec![],
    };
    Capture {
        name: "tube".into(),
        topology: Topology::new(COUNT, triangles, vec![1.0; COUNT as usize]).unwrap(),
        surface,
        timeline: Timeline::new(25.0, vec![sequence]).unwrap(),
        poses,
        vertex_of_file_vertex: vec![],
    }
}

fn stored_rig(capture: &Capture) -> StoredRig {
    let bone = |name: &str, y: f32, limb| Bone {
        name: name.into(),
        parent: 0,
        joint: Vec3::Y * y,
        limb,
        range: [Vec3::splat(-1.0), Vec3::splat(1.0)],
        spread: Mat3::from_diagonal(Vec3::splat(0.2)),
        gap: 0.0,
    };
    let share = |vertex: u32| ((rest(vertex).y - 0.7) / 0.2 + 0.5).clamp(0.0, 1.0);
    let influences = (0..COUNT)
        .map(|vertex| Influences { joints: [0, 1, 0, 0], weights: [1.0 - share(vertex), share(vertex), 0.0, 0.0] });
    let core = (0..COUNT).map(|vertex| match share(vertex) {
        0.0 => 0,
        1.0 => 1,
        _ => u8::MAX,
    });
    let pose = capture.poses.frame(REST).to_vec();
    let bones = vec![bone("low", 0.0, 0), bone("high", 0.7, 1)];
    StoredRig::of(&Rig::new(bones, influences.collect(), core.collect(), pose).unwrap(), REST)
}

/// Two ways in which three of its frames differ.
fn stored_space() -> StoredSpace {
    let mode = |variance, shares: [i16; 2]| StoredMode { variance, step: 0.001, shares: shares.to_vec() };
    StoredSpace { frames: vec![2, 10, 17], modes: vec![mode(0.5, [500, 0]), mode(0.1, [300, -400])] }
}

/// A bundle of the tube, which stands on its lowest ring, with a rig or without.
fn bundle(with_rig: bool) -> BundleReader {
    let capture = capture();
    let vertices = (0..AROUND).map(|vertex| FootVertex { vertex, leg: 255, sole: 255 }).collect();
    let feet = Feet::new(vec![vertices], vec![true; FRAMES as usize], COUNT as usize, &capture.timeline).unwrap();
    let graph = EssentialGraph::new(0.01, vec![], &capture.timeline).unwrap().with_feet(feet);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 1e-4,
        poisson_order: None,
        generator: "test".into(),
    };
    let rig = with_rig.then(|| stored_rig(&capture));
    let (mut extras, space) = (Extras::default(), stored_space());
    (extras.rig, extras.learned) = (rig.as_ref(), with_rig.then_some(&space));
    let (bytes, _) = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap();
    BundleReader::from_bytes(&bytes).unwrap()
}

fn pose(reader: &mut BundleReader, frame: u32) -> Vec<Vec3> {
    let mut pose = vec![Vec3::ZERO; COUNT as usize];
    reader.read(frame, &mut pose).unwrap();
    pose
}

fn give(session: &mut Session, reader: &mut BundleReader) {
    for frame in session.needs() {
        let pose = pose(reader, frame);
        session.give(frame, pose).unwrap();
    }
    assert!(session.needs().is_empty());
}

fn session(reader: &mut BundleReader) -> Session {
    let (timeline, topology) = (reader.timeline().unwrap(), reader.topology().unwrap());
    let words = words(timeline, topology, reader.graph().unwrap().feet(), reader.order());
    let known = Known::from_words(&words).unwrap();
    assert_eq!((&known.timeline, &known.feet), (timeline, reader.graph().unwrap().feet()));
    assert_eq!(known.topology.triangles(), topology.triangles());
    for length in [0, 1, 5, words.len() / 2, words.len() - 1] {
        assert!(Known::from_words(&words[..length]).is_none());
    }
    let mut session =
        Session::new(known, reader.rig_bytes().unwrap_or_default(), reader.learned_bytes().unwrap_or_default())
            .unwrap();
    give(&mut session, reader);
    session
}

fn edit(frame: u32, from: Vec3, by: Vec3, more: &str) -> String {
    let [x, y, z] = (from + by).to_array();
    format!(r#"{{"sequence":"bend","frame":{frame},"handles":[{{"vertex":{TOP},"to":[{x},{y},{z}]}}]{more}}}"#)
}

fn parsed(text: &str) -> EditDocument {
    EditDocument::from_json(text).unwrap()
}

fn document(edits: &[String]) -> String {
    format!(r#"{{"version":1,"edits":[{}]}}"#, edits.join(","))
}

#[test]
fn frames_are_those_of_a_film_to_the_bit() {
    for with_rig in [true, false] {
        let mut reader = bundle(with_rig);
        let mut session = session(&mut reader);
        assert_eq!(session.has_rig(), with_rig);
        let (at, later) = (pose(&mut reader, 10)[TOP as usize], pose(&mut reader, 14)[TOP as usize]);
        let edits = [
            edit(10, at, Vec3::new(0.1, -0.05, 0.15), ""),
            edit(14, later, Vec3::new(-0.05, 0.0, 0.1), r#","propagate":"constraint","scope":"limb""#),
            edit(12, at, Vec3::new(0.05, 0.0, 0.0), r#","method":"arap","pins":"none","on":false"#),
            edit(12, at, Vec3::new(0.06, 0.0, -0.02), r#","method":"learned""#),
        ];
        let text = document(&edits);
        session.replace(parsed(&text)).unwrap();
        give(&mut session, &mut reader);
        let mut reached: Vec<u32> = (0..4).flat_map(|edit| session.reached(edit)).collect();
        reached.sort_unstable();
        reached.dedup();
        assert_eq!(reached, (4..21).collect::<Vec<u32>>());

        let mut film = bundle(with_rig);
        let (timeline, topology) = (film.timeline().unwrap().clone(), film.topology().unwrap().clone());
        let feet = film.graph().unwrap().feet().clone();
        let stored = film.rig().unwrap();
        let rig = stored.map(|stored| stored.rig(pose(&mut film, REST)).unwrap());
        let mut editor = Editor::new(&topology, None, rig).unwrap();
        if let Some(stored) = film.learned().unwrap() {
            let of: Vec<Vec<Vec3>> = stored.frames.iter().map(|&frame| pose(&mut film, frame)).collect();
            editor.learn(stored.space(&of, topology.weights()).unwrap()).unwrap();
        }
        let document = EditDocument::from_json(&text).unwrap();
        let mut edited = EditedPoses::new(&mut film, (&timeline, &feet), topology.weights(), editor, document).unwrap();
        // On a page edits come to rest a step at a time; one that is off, or none, is at rest.
        let mut steps = [0; 5];
        for (edit, steps) in steps.iter_mut().enumerate() {
            while !session.settle(edit).unwrap() {
                *steps += 1;
            }
        }
        assert_eq!([steps[2], steps[4]], [0, 0]);
        assert!(steps[3] > 10 && (steps[0] == 1) == with_rig, "{steps:?}");
        // Those nearest to the actor come first on a page.
        for &frame in reached.iter().rev() {
            let mut ours = pose(&mut reader, frame);
            session.make(frame, &mut ours).unwrap();
            let mut theirs = vec![Vec3::ZERO; COUNT as usize];
            edited.read(frame, &mut theirs).unwrap();
            assert_eq!(ours, theirs, "frame {frame}");
            assert_ne!(ours, pose(&mut reader, frame), "frame {frame}");
        }
        let notes = session.notes();
        assert_eq!(
            (notes.iter().any(|note| note.contains("no learned space")), session.has_space()),
            (!with_rig, with_rig)
        );
        assert_eq!(notes, edited.prepare().unwrap());
    }
}

#[test]
fn a_drag_that_comes_back_gives_the_frame_back_to_the_bit() {
    let mut reader = bundle(true);
    let mut session = session(&mut reader);
    let from = pose(&mut reader, 10)[TOP as usize];
    assert_eq!(session.drag(&[from]), Err(SessionError::Nothing));
    session.replace(parsed(&document(&[edit(10, from, Vec3::ZERO, "")]))).unwrap();
    give(&mut session, &mut reader);
    session.grab(0).unwrap();
    let recorded = pose(&mut reader, 10);
    assert_eq!(session.drag(&[from]).unwrap(), recorded);
    for step in 1..8 {
        let to = from + Vec3::new(0.02, -0.01, 0.02) * step as f32;
        let dragged = session.drag(&[to]).unwrap();
        assert!(dragged[TOP as usize].distance(to) < 1e-3);
        for pin in 0..AROUND as usize {
            assert!(dragged[pin].distance(recorded[pin]) < 1e-3);
        }
    }
    assert_eq!(session.drag(&[from]).unwrap(), recorded);
    assert!(session.drag(&[Vec3::NAN]).is_err() && session.drag(&[]).is_err());
    assert!(session.grab(1).is_err());
    // What is let go is made anew from the document.
    session.replace(parsed(&document(&[edit(10, from, Vec3::ZERO, "")]))).unwrap();
    let mut made = recorded.clone();
    session.make(10, &mut made).unwrap();
    assert_eq!(made, recorded);
    assert_eq!(session.bones(&recorded).len(), 4);
    assert_eq!((session.stands(10), session.sole(0).len(), session.sole(9).len()), (vec![true], AROUND as usize, 0));
}

#[test]
fn what_makes_no_sense_is_refused_and_the_document_before_stays() {
    let mut reader = bundle(true);
    let mut session = session(&mut reader);
    let from = pose(&mut reader, 10)[TOP as usize];
    let good = document(&[edit(10, from, Vec3::X * 0.1, "")]);
    session.replace(parsed(&good)).unwrap();
    give(&mut session, &mut reader);
    let before = session.reached(0);
    for (text, says) in [
        (good.replace("bend", "jump"), "there are: bend"),
        (good.replace(&format!(r#""vertex":{TOP}"#), r#""vertex":9999"#), "no vertex 9999"),
        (good.replace(r#""frame":10"#, r#""frame":99"#), "no frame 99"),
    ] {
        assert!(session.replace(parsed(&text)).unwrap_err().to_string().contains(says), "{says}");
        assert_eq!(session.reached(0), before);
    }
    assert_eq!(session.give(3, vec![Vec3::NAN; COUNT as usize]), Err(SessionError::Misfit));
    assert_eq!(session.make(999, &mut vec![Vec3::ZERO; COUNT as usize]), Err(SessionError::Misfit));
    assert_eq!(session.make(3, &mut [Vec3::ZERO]), Err(SessionError::Misfit));
    assert!(session.reached(7).is_empty());
    // A rig that is none leaves the surface alone to be moved.
    let words = words(reader.timeline().unwrap(), reader.topology().unwrap(), &Feet::default(), None);
    let session = Session::new(Known::from_words(&words).unwrap(), b"no rig", &[]).unwrap();
    assert!(!session.has_rig() && session.rig_trouble().is_some() && session.needs().is_empty());
}
