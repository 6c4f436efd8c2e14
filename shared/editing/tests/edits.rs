//! Edits of a small recorded body: a tube of three bones that stands on its lowest ring, bends, and turns about the vertical.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use actor::capture::Poses;
use actor::feet::{Feet, FootVertex};
use actor::pose_source::PoseSource;
use actor::timeline::{Sequence, Timeline};
use editing::{
    Bone, EditDocument, EditError, EditedPoses, Editor, Grip, Influences, Method, Rig, Scope, Space, StoredMode,
    StoredSpace,
};
use glam::{Mat3, Quat, Vec3};
use kernels::topology::Topology;

const RINGS: u32 = 19;
const AROUND: u32 = 10;
const FRAMES: u32 = 30;
const COUNT: usize = (RINGS * AROUND) as usize;
/// The highest vertex of the tube, about.
const TOP: u32 = COUNT as u32 - 5;
const KEY: u32 = 15;

fn rest() -> Vec<Vec3> {
    let point = |v: u32| {
        let angle = (v % AROUND) as f32 / AROUND as f32 * std::f32::consts::TAU;
        Vec3::new(0.12 * angle.cos(), (v / AROUND) as f32 * 0.09, 0.1 * angle.sin())
    };
    (0..COUNT as u32).map(point).collect()
}

fn topology() -> Topology {
    let at = |ring: u32, k: u32| ring * AROUND + k % AROUND;
    let quads = (0..RINGS - 1).flat_map(|ring| (0..AROUND).map(move |k| (ring, k)));
    let triangles = quads.flat_map(|(ring, k)| {
        let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k), at(ring + 1, k + 1)];
        [[a, c, b], [b, c, d]]
    });
    Topology::new(COUNT as u32, triangles.collect(), vec![1.0; COUNT]).unwrap()
}

/// How the three bones share a vertex of the rest pose.
fn influences(point: Vec3) -> Influences {
    let step = |at: f32| ((point.y - at) / 0.2 + 0.5).clamp(0.0, 1.0);
    let (first, second) = (step(0.54), step(1.08));
    Influences { joints: [0, 1, 2, 0], weights: [1.0 - first, first - second, second, 0.0] }
}

fn rig() -> Rig {
    let bone = |name: &str, parent, y: f32| Bone {
        name: name.into(),
        parent,
        joint: Vec3::new(0.0, y, 0.0),
        limb: u32::from(y > 0.0),
        range: [Vec3::splat(-1.0), Vec3::splat(1.0)],
        spread: Mat3::from_diagonal(Vec3::splat(0.2)),
        gap: 0.0,
    };
    let bones = vec![bone("low", 0, 0.0), bone("middle", 0, 0.54), bone("high", 1, 1.08)];
    let influences: Vec<Influences> = rest().into_iter().map(influences).collect();
    let core = influences.iter().map(|own| (0..3).find(|&k| own.weights[k] == 1.0).map_or(u8::MAX, |k| k as u8));
    let core = core.collect();
    Rig::new(bones, influences, core, rest()).unwrap()
}

/// The tube bends forwards, now more, now less, so that it has a front, and turns by `turn` radians a frame.
fn poses(turn: f32) -> Poses {
    bending(turn, |frame| 0.5 + 0.3 * (frame * 0.3).sin())
}

/// The same where it bends by `bend` radians at each joint.
fn bending(turn: f32, bend: impl Fn(f32) -> f32) -> Poses {
    let mut poses = Poses::new(COUNT);
    for frame in 0..FRAMES {
        let bend = bend(frame as f32);
        let heading = Quat::from_rotation_y(turn * frame as f32);
        let bent = |share: f32, joint: f32, p: Vec3| {
            let joint = Vec3::Y * joint;
            joint + Quat::from_rotation_x(bend * share) * (p - joint)
        };
        let pose: Vec<Vec3> = rest()
            .into_iter()
            .map(|p| {
                let own = influences(p);
                heading * bent(own.weights[1] + own.weights[2], 0.54, bent(own.weights[2], 1.08, p))
                    + Vec3::new(2.0, 0.0, 1.0)
            })
            .collect();
        poses.push(&pose);
    }
    poses
}

fn timeline() -> Timeline {
    let sequence = Sequence { name: "bend".into(), labels: vec![], first_frame: 0, frame_count: FRAMES, cyclic: false };
    Timeline::new(25.0, vec![sequence]).unwrap()
}

/// The two ways in which three of its frames differ, so common that they cost nearly nothing.
fn space(poses: &Poses) -> Space {
    let mode = |variance, shares: [i16; 2]| StoredMode { variance, step: 0.001, shares: shares.to_vec() };
    let stored = StoredSpace { frames: vec![0, 8, 14], modes: vec![mode(900.0, [500, 0]), mode(400.0, [300, -400])] };
    let of: Vec<Vec<Vec3>> = stored.frames.iter().map(|&frame| poses.frame(frame).to_vec()).collect();
    stored.space(&of, topology().weights()).unwrap()
}

/// The lowest ring stands in every frame.
fn feet() -> Feet {
    let vertices = (0..AROUND).map(|vertex| FootVertex { vertex, leg: 255, sole: 255 });
    Feet::new(vec![vertices.collect()], vec![true; FRAMES as usize], COUNT, &timeline()).unwrap()
}

fn document(edits: &[String]) -> EditDocument {
    EditDocument::from_json(&format!(r#"{{"version":1,"edits":[{}]}}"#, edits.join(","))).unwrap()
}

/// An edit of the key frame that moves `vertex` by `by`, with further fields.
fn edit(poses: &Poses, vertex: u32, by: Vec3, more: &str) -> String {
    let to = poses.frame(KEY)[vertex as usize] + by;
    let [x, y, z] = to.to_array();
    format!(
        r#"{{"sequence":"bend","frame":{KEY},"window":[5,25],"handles":[{{"vertex":{vertex},"to":[{x},{y},{z}]}}]{more}}}"#
    )
}

/// All frames with these edits, and the notes.
fn edited(poses: &Poses, document: EditDocument, rig: Option<Rig>) -> (Vec<Vec<Vec3>>, Vec<String>) {
    edited_on(poses, &feet(), document, rig)
}

/// The same on feet of their own.
fn edited_on(poses: &Poses, feet: &Feet, document: EditDocument, rig: Option<Rig>) -> (Vec<Vec<Vec3>>, Vec<String>) {
    let (timeline, topology) = (timeline(), topology());
    let mut editor = Editor::new(&topology, None, rig).unwrap();
    editor.learn(space(poses)).unwrap();
    let mut source = poses.clone();
    let mut edited = EditedPoses::new(&mut source, (&timeline, feet), topology.weights(), editor, document).unwrap();
    let notes = edited.prepare().unwrap().to_vec();
    let mut pose = vec![Vec3::ZERO; COUNT];
    let frames = (0..FRAMES).map(|frame| {
        edited.read(frame, &mut pose).unwrap();
        pose.clone()
    });
    (frames.collect(), notes)
}

const BY: Vec3 = Vec3::new(0.15, -0.1, 0.2);

#[test]
fn a_handle_that_stays_gives_all_frames_back_to_the_bit() {
    let poses = poses(0.05);
    for more in [
        "",
        r#","method":"learned""#,
        r#","method":"arap""#,
        r#","scope":{"radius":0.4}"#,
        r#","propagate":"constraint""#,
    ] {
        let (frames, notes) = edited(&poses, document(&[edit(&poses, TOP, Vec3::ZERO, more)]), Some(rig()));
        assert!(notes.is_empty());
        assert_eq!(frames[KEY as usize], poses.frame(KEY), "{more}");
        for (frame, pose) in frames.iter().zip(poses.iter()) {
            let off = frame.iter().zip(pose).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            assert!(off == 0.0, "{more}: {off}");
        }
    }
}

#[test]
fn handles_are_met_pins_stay_and_the_window_ends() {
    let poses = poses(0.05);
    let methods = [
        "",
        r#","method":"arap""#,
        r#","method":"laplace""#,
        r#","method":"learned""#,
        r#","method":"learned","scope":{"radius":0.9}"#,
        r#","scope":"limb""#,
        r#","scope":{"radius":0.5}"#,
    ];
    for method in methods {
        for propagate in ["nonlinear", "linear", "constraint"] {
            let more = format!(r#"{method},"propagate":"{propagate}""#);
            let (frames, notes) = edited(&poses, document(&[edit(&poses, TOP, BY, &more)]), Some(rig()));
            assert!(notes.is_empty(), "{more}: {notes:?}");
            let wanted = poses.frame(KEY)[TOP as usize] + BY;
            assert!(frames[KEY as usize][TOP as usize].distance(wanted) < 1e-3, "{more}");
            for (index, (frame, pose)) in frames.iter().zip(poses.iter()).enumerate() {
                assert!(frame.iter().all(|point| point.is_finite()));
                for pin in 0..AROUND as usize {
                    assert!(frame[pin].distance(pose[pin]) < 1e-3, "{more}, frame {index}");
                }
                let is_inside = (6..25).contains(&index);
                assert_eq!(frame != pose, is_inside, "{more}, frame {index}");
            }
            // From frame to frame the handle goes on evenly.
            for pair in 5..25 {
                let off = |frame: usize| frames[frame][TOP as usize] - poses.frame(frame as u32)[TOP as usize];
                assert!(
                    off(pair).distance(off(pair + 1)) < 0.08,
                    "{more}, frame {pair}: {} {}",
                    off(pair),
                    off(pair + 1)
                );
            }
        }
    }
}

/// The tube hops: it is in the air in frames 11 to 19, highest in the key frame, and stands in all others.
fn hop(height: f32) -> (Poses, Feet) {
    let (still, mut poses) = (poses(0.05), Poses::new(COUNT));
    let up = |frame: u32| height * (1.0 - ((frame as f32 - KEY as f32) / 5.0).powi(2)).max(0.0);
    for (frame, pose) in (0..).zip(still.iter()) {
        poses.push(&pose.iter().map(|&point| point + Vec3::Y * up(frame)).collect::<Vec<_>>());
    }
    let vertices = (0..AROUND).map(|vertex| FootVertex { vertex, leg: 255, sole: 255 });
    let stands = (0..FRAMES).map(|frame| up(frame) == 0.0).collect();
    (poses, Feet::new(vec![vertices.collect()], stands, COUNT, &timeline()).unwrap())
}

#[test]
fn nothing_goes_below_the_ground_where_no_foot_stands() {
    let down = Vec3::new(0.1, -0.5, 0.2);
    let low = |pose: &[Vec3]| pose.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    for height in [0.005, 0.2] {
        let (poses, feet) = hop(height);
        for method in ["rig", "learned", "parts", "arap", "laplace"] {
            for more in ["", r#","propagate":"linear""#, r#","propagate":"constraint""#, r#","pins":"none""#] {
                let more = format!(r#","method":"{method}"{more}"#);
                let asked = document(&[edit(&poses, TOP, down, &more)]);
                let (frames, _) = edited_on(&poses, &feet, asked, Some(rig()));
                for (frame, (pose, recorded)) in frames.iter().zip(poses.iter()).enumerate() {
                    let (is, was) = (low(pose), low(recorded).min(0.0));
                    assert!(is > was - 1e-5, "{more}, {height} m up, frame {frame}: {is} below {was}");
                }
                let at = frames[KEY as usize][TOP as usize];
                let to = poses.frame(KEY)[TOP as usize] + down;
                assert!(at.distance(to) < 1e-3, "{more}: {at} is not {to}");
                let zero = document(&[edit(&poses, TOP, Vec3::ZERO, &more)]);
                assert!(edited_on(&poses, &feet, zero, Some(rig())).0.iter().zip(poses.iter()).all(|(a, b)| a == b));
            }
        }
        // What is dragged below the ground stops there, and a note says so.
        let asked = document(&[edit(&poses, 2, Vec3::Y * -0.6, "")]);
        let (frames, notes) = edited_on(&poses, &feet, asked, Some(rig()));
        assert!(frames[KEY as usize][2].y.abs() < 1e-4, "{}", frames[KEY as usize][2]);
        assert!(notes.iter().any(|note| note.contains("the ground")), "{notes:?}");
    }
}

#[test]
fn a_foot_on_the_ground_stays_though_none_was_found_to_stand() {
    // Half a centimetre up, in the air as far as its feet say: a hand that is raised does not take it along.
    let (poses, feet) = hop(0.005);
    let (frames, _) = edited_on(&poses, &feet, document(&[edit(&poses, TOP, Vec3::Y * 0.1, "")]), Some(rig()));
    for (frame, pose) in frames.iter().zip(poses.iter()) {
        (0..AROUND as usize).for_each(|pin| assert!(frame[pin].distance(pose[pin]) < 1e-3));
    }
}

#[test]
fn bones_keep_the_tube_as_long_as_it_is() {
    let poses = poses(0.0);
    let (frames, _) = edited(&poses, document(&[edit(&poses, TOP, Vec3::new(0.4, -0.3, 0.3), "")]), Some(rig()));
    let length = |pose: &[Vec3]| {
        let ring = |ring: u32| (0..AROUND).map(|k| pose[(ring * AROUND + k) as usize]).sum::<Vec3>() / AROUND as f32;
        (0..RINGS - 1).map(|k| ring(k).distance(ring(k + 1))).sum::<f32>()
    };
    for (frame, pose) in frames.iter().zip(poses.iter()) {
        assert!((length(frame) / length(pose) - 1.0).abs() < 0.03, "{} {}", length(frame), length(pose));
    }
}

#[test]
fn what_swings_fast_is_not_drawn_out_beside_the_edited_frame() {
    let poses = bending(0.0, |frame| 0.3 + 0.25 * (frame - KEY as f32));
    let made = edited(&poses, document(&[edit(&poses, TOP, Vec3::new(0.3, -0.3, 0.4), "")]), Some(rig())).0;
    let wanted = poses.frame(KEY)[TOP as usize] + Vec3::new(0.3, -0.3, 0.4);
    assert!(made[KEY as usize][TOP as usize].distance(wanted) < 1e-3);
    // The key is bent otherwise than its neighbours: its displacement is not theirs.
    for frame in [KEY - 1, KEY + 1] {
        let length = longest(poses.frame(frame), &made[frame as usize]);
        assert!(length < 1.2, "{length} in frame {frame}");
    }
}

#[test]
fn edits_turn_with_the_actor() {
    let (straight, turning) = (poses(0.0), poses(0.1));
    for (propagate, method) in
        [("nonlinear", "rig"), ("linear", "rig"), ("constraint", "rig"), ("nonlinear", "learned")]
    {
        let more = format!(r#","propagate":"{propagate}","method":"{method}""#);
        let heading = Quat::from_rotation_y(0.1 * KEY as f32);
        let (a, _) = edited(&straight, document(&[edit(&straight, TOP, BY, &more)]), Some(rig()));
        let (b, _) = edited(&turning, document(&[edit(&turning, TOP, heading * BY, &more)]), Some(rig()));
        let stands = Vec3::new(2.0, 0.0, 1.0);
        for (frame, (a, b)) in a.iter().zip(&b).enumerate() {
            let turn = Quat::from_rotation_y(0.1 * frame as f32);
            let off = a.iter().zip(b).map(|(a, b)| (turn * (a - stands) + stands).distance(*b)).fold(0.0, f32::max);
            assert!(off < 5e-3, "{propagate}, frame {frame}: {off}");
        }
    }
}

#[test]
fn several_edits_add_up_whatever_their_order() {
    let poses = poses(0.05);
    let middle = 8 * AROUND + 2;
    let one = edit(&poses, TOP, Vec3::new(0.15, 0.0, 0.1), "");
    let other = edit(&poses, middle, Vec3::new(0.0, 0.0, -0.08), r#","scope":{"radius":0.3}"#);
    let third = edit(&poses, TOP - 2 * AROUND, Vec3::new(0.1, 0.0, 0.1), "");
    let (a, _) = edited(&poses, document(&[one.clone(), third.clone()]), Some(rig()));
    let (b, _) = edited(&poses, document(&[third, one.clone()]), Some(rig()));
    for (a, b) in a.iter().zip(&b) {
        assert!(a.iter().zip(b).all(|(a, b)| a.distance(*b) < 1e-3));
    }
    let wanted = poses.frame(KEY)[TOP as usize] + Vec3::new(0.15, 0.0, 0.1);
    assert!(a[KEY as usize][TOP as usize].distance(wanted) < 1e-3);
    let off = other.replace("\"frame\"", "\"on\":false,\"frame\"");
    let (alone, _) = edited(&poses, document(std::slice::from_ref(&one)), Some(rig()));
    let (with_off, _) = edited(&poses, document(&[one, off]), Some(rig()));
    assert_eq!(alone, with_off);
}

#[test]
fn what_cannot_be_reached_is_approached_and_said() {
    let poses = poses(0.0);
    for (more, rig) in [("", Some(rig())), ("", None), (r#","scope":{"radius":0.3}"#, Some(rig()))] {
        let (frames, notes) = edited(&poses, document(&[edit(&poses, TOP, Vec3::new(30.0, 5.0, 0.0), more)]), rig);
        assert!(notes.iter().any(|note| note.contains("does not reach")), "{more}: {notes:?}");
        let moved = frames[KEY as usize][TOP as usize] - poses.frame(KEY)[TOP as usize];
        assert!(moved.is_finite() && moved.x > 0.1 && moved.length() < 2.5, "{moved}");
    }
    let (_, notes) = edited(&poses, document(&[edit(&poses, TOP, BY, "")]), None);
    assert!(notes[0].contains("no rig"), "{notes:?}");
}

#[test]
fn a_body_that_goes_by_its_space_bends_as_it_was_seen_to() {
    // A frame that is no part of the space is put where a handle of another one is.
    let poses = poses(0.05);
    let (key, other) = (poses.frame(KEY), poses.frame(10));
    // The other frame as the edited one stands: turned with it.
    let turn = Quat::from_rotation_y(0.05 * (KEY as f32 - 10.0));
    let stands = Vec3::new(2.0, 0.0, 1.0);
    let wanted: Vec<Vec3> = other.iter().map(|&p| turn * (p - stands) + stands).collect();
    let by = wanted[TOP as usize] - key[TOP as usize];
    let off = |more: &str| {
        let (frames, notes) = edited(&poses, document(&[edit(&poses, TOP, by, more)]), None);
        assert!(notes.is_empty(), "{notes:?}");
        let all = frames[KEY as usize].iter().zip(&wanted).map(|(a, b)| a.distance_squared(*b)).sum::<f32>();
        (all / COUNT as f32).sqrt()
    };
    let (learned, rigid) = (off(r#","method":"learned""#), off(r#","method":"arap""#));
    assert!(by.length() > 0.1 && learned < 0.5 * rigid, "{learned} {rigid}");
}

#[test]
fn without_a_space_a_note_says_so() {
    let (poses, timeline, feet, topology) = (poses(0.0), timeline(), feet(), topology());
    let editor = Editor::new(&topology, None, Some(rig())).unwrap();
    let mut source = poses.clone();
    let asked = document(&[edit(&poses, TOP, BY, r#","method":"learned""#)]);
    let mut edited = EditedPoses::new(&mut source, (&timeline, &feet), topology.weights(), editor, asked).unwrap();
    assert!(edited.prepare().unwrap()[0].contains("no learned space"));
    let mut other = Editor::new(&Topology::new(3, vec![[0, 1, 2]], vec![1.0; 3]).unwrap(), None, None).unwrap();
    assert!(matches!(other.learn(space(&poses)), Err(EditError::Space(_))));
}

#[test]
fn a_learned_drag_meets_its_handle_at_once_and_goes_back_to_nothing() {
    let poses = poses(0.0);
    let mut editor = Editor::new(&topology(), None, None).unwrap();
    editor.learn(space(&poses)).unwrap();
    let grip = Grip {
        handles: vec![TOP],
        pins: (0..AROUND).collect(),
        eased: Vec::new(),
        scope: Scope::Body,
        method: Method::Learned,
    };
    let mut grab = editor.grab(poses.frame(KEY), &grip).unwrap();
    let from = poses.frame(KEY)[TOP as usize];
    for step in 1..=10 {
        let dragged = editor.drag(&mut grab, &[from + BY * (step as f32 / 10.0)]).unwrap();
        assert!(dragged.pose[TOP as usize].distance(from + BY * (step as f32 / 10.0)) < 1e-5);
        (0..AROUND as usize).for_each(|pin| assert_eq!(dragged.pose[pin], poses.frame(KEY)[pin]));
    }
    assert_eq!(editor.drag(&mut grab, &[from]).unwrap().pose, poses.frame(KEY));
    let (again, _) = editor.settle(grab, &[from + BY]).unwrap();
    let fresh = editor.grab(poses.frame(KEY), &grip).unwrap();
    let (fresh, _) = editor.settle(fresh, &[from + BY]).unwrap();
    assert_eq!(editor.release(fresh).pose, editor.release(again).pose);
}

#[test]
fn what_does_not_exist_is_named() {
    let (poses, timeline, feet, topology) = (poses(0.0), timeline(), feet(), topology());
    let refused = |edit: String| {
        let editor = Editor::new(&topology, None, Some(rig())).unwrap();
        let mut source = poses.clone();
        let found = EditedPoses::new(&mut source, (&timeline, &feet), topology.weights(), editor, document(&[edit]));
        found.err().unwrap()
    };
    let good = edit(&poses, TOP, BY, "");
    assert!(matches!(refused(good.replace("bend", "jump")), EditError::Sequence { edit: 0, .. }));
    assert!(matches!(refused(good.replace("\"vertex\":185", "\"vertex\":190")), EditError::Vertex { vertex: 190, .. }));
    assert!(matches!(refused(edit(&poses, TOP, BY, r#","pins":[1,9999]"#)), EditError::Vertex { vertex: 9999, .. }));
    let small = Topology::new(3, vec![[0, 1, 2]], vec![1.0; 3]).unwrap();
    assert!(matches!(Editor::new(&small, None, Some(rig())), Err(EditError::Rig(_))));
}

#[test]
fn a_drag_goes_on_from_the_last_and_back_to_nothing() {
    let poses = poses(0.0);
    let mut editor = Editor::new(&topology(), None, Some(rig())).unwrap();
    let grip = Grip {
        handles: vec![TOP],
        pins: (0..AROUND).collect(),
        eased: Vec::new(),
        scope: Scope::Body,
        method: Method::Rig,
    };
    let mut grab = editor.grab(poses.frame(KEY), &grip).unwrap();
    let from = poses.frame(KEY)[TOP as usize];
    for step in 1..=10 {
        let to = from + BY * (step as f32 / 10.0);
        let dragged = editor.drag(&mut grab, &[to]).unwrap();
        assert!(dragged.pose[TOP as usize].distance(to) < 1e-3);
    }
    let dragged = editor.drag(&mut grab, &[from]).unwrap();
    assert_eq!(dragged.pose, poses.frame(KEY));
    assert!(editor.drag(&mut grab, &[]).is_err());
    assert!(editor.drag(&mut grab, &[Vec3::NAN]).is_err());
}

/// The longest edge of `after` beside `before`.
fn longest(before: &[Vec3], after: &[Vec3]) -> f32 {
    let topology = topology();
    let edges = topology.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let longer = edges.map(|[a, b]| {
        let length = |pose: &[Vec3]| pose[a as usize].distance(pose[b as usize]);
        length(after) / length(before)
    });
    longer.fold(0.0, f32::max)
}

#[test]
fn a_foot_that_is_grabbed_is_not_torn_off_its_sole() {
    let poses = poses(0.02);
    for method in ["rig", "arap"] {
        let wanted = edit(&poses, 0, Vec3::new(0.2, 0.15, 0.0), &format!(r#","method":"{method}""#));
        let (made, notes) = edited(&poses, document(&[wanted]), Some(rig()));
        assert!(notes.is_empty(), "{notes:?}");
        let mut before = Vec3::ZERO;
        for (frame, made) in made.iter().enumerate() {
            let recorded = poses.frame(frame as u32);
            assert!(longest(recorded, made) < 1.5, "{method} {frame}: {}", longest(recorded, made));
            // Nothing jumps where the frames around have it stand.
            let moved = made[0] - recorded[0];
            assert!(moved.distance(before) < 0.06, "{method} {frame}: {before} {moved}");
            before = moved;
        }
    }
}

#[test]
fn a_surface_whose_handle_is_out_of_reach_stays_whole() {
    let poses = poses(0.0);
    let recorded = poses.frame(KEY);
    for (method, most) in [("rig", 1.5), ("learned", 1.5), ("arap", 1.9)] {
        let by = Vec3::new(0.3, 1.5, 0.0);
        let (made, notes) =
            edited(&poses, document(&[edit(&poses, TOP, by, &format!(r#","method":"{method}""#))]), Some(rig()));
        let made = &made[KEY as usize];
        assert!(longest(recorded, made) < most, "{method}: {}", longest(recorded, made));
        assert!(notes.iter().any(|note| note.contains("short of where it is to go")), "{notes:?}");
    }
}
