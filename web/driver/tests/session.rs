//! A clip of motion capture in the page: the frames are the builder's, bit for bit, and the actor performs them between frames that
//! were recorded.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::sync::LazyLock;

use actor::capture::{Capture, Poses};
use actor::feet::{Feet, FootVertex};
use actor::files::Files;
use actor::graph::EssentialGraph;
use actor::pose_source::PoseSource;
use actor::surface::{Corner, Material, Part, Surface};
use actor::timeline::{Sequence, Timeline};
use bundle::{BundleInput, BundleReader, encode_with_rig};
use drive::{Driven, Mapping, MappingFile, body, retarget};
use driver::error::DriverError;
use driver::perform::Performed;
use driver::session::Session;
use driving::{Aim, End, Masses, strength};
use editing::{Rig, StoredRig};
use editor::scene::{Known, words};
use fixtures::squat;
use glam::{Vec2, Vec3};
use kernels::align::Placement;
use kernels::topology::{Topology, barycentric_areas};
use performer::PerformerOptions;
use performer::figure::Figure;
use performer::perform::{perform, takes};
use rig::{RigOptions, estimate};

const FPS: f32 = 50.0;

/// The built-in performer with the bones that are found in it.
struct Actor {
    timeline: Timeline,
    topology: Topology,
    feet: Feet,
    poses: Poses,
    rig: Rig,
    rig_bytes: Vec<u8>,
}

/// Found once for all tests: that takes longer than they do.
static ACTOR: LazyLock<Actor> = LazyLock::new(actor);

fn actor() -> Actor {
    let options = PerformerOptions { frames: 260, vertices: 2_000, ..PerformerOptions::default() };
    let figure = Figure::new(options.vertices, 64);
    let mut poses = Poses::new(figure.mesh.positions.len());
    let mut sequences: Vec<Sequence> = Vec::new();
    for take in takes(options.frames, FPS, options.seed) {
        let first_frame = poses.len() as u32;
        perform(&figure, &take, FPS).iter().for_each(|frame| poses.push(&frame.positions));
        let frame_count = poses.len() as u32 - first_frame;
        let name = format!("s{first_frame}");
        sequences.push(Sequence { name, labels: vec![], first_frame, frame_count, cyclic: false });
    }
    let triangles = figure.mesh.triangles.clone();
    let areas = barycentric_areas(&triangles, poses.frame(0));
    let topology = Topology::new(poses.vertex_count() as u32, triangles, areas).unwrap();
    let found = estimate(&topology, &poses, &RigOptions::default()).unwrap();
    let timeline = Timeline::new(FPS, sequences).unwrap();
    // Feet as bones say; each stands where it is low.
    let foot = |name: &str| {
        let bone = found.rig.bones().iter().position(|bone| bone.name == name).unwrap();
        let own = (0..topology.vertex_count() as u32).filter(|&vertex| found.rig.bone_of(vertex) == bone);
        own.map(|vertex| FootVertex { vertex, leg: 255, sole: 255 }).collect::<Vec<_>>()
    };
    let vertices = vec![foot("foot_r"), foot("foot_l")];
    let low = |frame: u32, foot: &[FootVertex]| {
        foot.iter().map(|one| poses.frame(frame)[one.vertex as usize].y).fold(f32::INFINITY, f32::min) < 0.02
    };
    let frames = 0..timeline.frame_count();
    let stands = frames.flat_map(|frame| [low(frame, &vertices[0]), low(frame, &vertices[1])]).collect();
    let feet = Feet::new(vertices, stands, topology.vertex_count(), &timeline).unwrap();
    let stored = StoredRig::of(&found.rig, found.keys.first().copied().unwrap());
    Actor::of_bundle(&bundle(timeline, topology, poses, feet, &stored))
}

fn bundle(timeline: Timeline, topology: Topology, poses: Poses, feet: Feet, rig: &StoredRig) -> Vec<u8> {
    let triangles = topology.triangles().to_vec();
    let corner = |vertex| Corner { vertex, uv: [0.0; 2], colour: [255; 4] };
    let surface = Surface {
        corners: (0..topology.vertex_count() as u32).map(corner).collect(),
        parts: vec![Part { material: 0, first_triangle: 0, triangle_count: triangles.len() as u32 }],
        triangles,
        materials: vec![Material { name: "m".into(), base_colour: [1.0; 4], image: None, double_sided: false }],
        images: vec![],
    };
    let graph = EssentialGraph::new(0.01, vec![], &timeline).unwrap().with_feet(feet);
    let capture = Capture { name: "p".into(), topology, surface, timeline, poses, vertex_of_file_vertex: vec![] };
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 1e-4,
        poisson_order: None,
        generator: "test".into(),
    };
    encode_with_rig(&input, &[], &Files::default(), Some(rig)).unwrap().0
}

impl Actor {
    /// What a page has of a bundle.
    fn of_bundle(bytes: &[u8]) -> Self {
        let mut reader = BundleReader::from_bytes(bytes).unwrap();
        let (timeline, topology) = (reader.timeline().unwrap().clone(), reader.topology().unwrap().clone());
        let mut poses = Poses::new(topology.vertex_count());
        let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
        for frame in 0..timeline.frame_count() {
            reader.read(frame, &mut pose).unwrap();
            poses.push(&pose);
        }
        let stored = reader.rig().unwrap().unwrap();
        let rest = poses.frame(stored.rest_frame).to_vec();
        let (rig, rig_bytes) = (stored.rig(rest).unwrap(), reader.rig_bytes().unwrap().to_vec());
        Self { timeline, topology, feet: reader.graph().unwrap().feet().clone(), poses, rig, rig_bytes }
    }

    fn known(&self) -> Known {
        Known::from_words(&words(&self.timeline, &self.topology, &self.feet, None)).unwrap()
    }

    fn session(&self) -> Session {
        let mut session = Session::new(self.known(), &self.rig_bytes).unwrap();
        while let Some(&frame) = session.needs().first() {
            session.give(self.poses.frame(frame).to_vec()).unwrap();
        }
        session
    }

    /// What the builder makes of the clip.
    fn native(&self, clip: &str) -> Driven {
        let (clip, _) = mocap::read(&[("clip.bvh", clip.as_bytes())], &mocap::Options::default()).unwrap();
        let mapping = Mapping::of(&clip, &MappingFile::default()).unwrap();
        let body = body(&self.rig, &self.poses).unwrap();
        retarget((&clip, &mapping), &body, (&self.topology, None), (&self.poses, FPS)).unwrap()
    }

    /// Performs the clip that was begun, from frame `from`; the frame that it ends with, where that stands, and all frames.
    fn perform(&self, session: &mut Session, from: u32, placement: Placement) -> (u32, Placement, Vec<Performed>) {
        let windows = session.prepare(from, self.poses.frame(from)).unwrap();
        let recorded = windows.map(|window| {
            (window.first..window.first + window.count).flat_map(|f| self.poses.frame(f)).copied().collect()
        });
        let (to, home, length) = session.perform(recorded, placement).unwrap();
        let frames: Vec<Performed> = std::iter::from_fn(|| session.next_frame().unwrap()).collect();
        assert_eq!(frames.len(), length as usize);
        (to, home, frames)
    }
}

/// What `Session::aim` asks of the builder's code, and the poses of both windows.
fn aimed(actor: &Actor, session: &mut Session, native: &Driven, from: u32) -> (Vec<Aim>, [Vec<Vec3>; 2]) {
    let windows = session.prepare(from, actor.poses.frame(from)).unwrap();
    let recorded: [Vec<Vec3>; 2] = windows.map(|window| {
        (window.first..window.first + window.count).flat_map(|f| actor.poses.frame(f)).copied().collect()
    });
    let body = body(&actor.rig, &actor.poses).unwrap();
    let motions = driving::plant::bones(&body, &native.planted);
    let mut inwards = false;
    let aims = session.keys().unwrap().map(|[of_recorded, of_clip]| {
        inwards = !inwards;
        let wanted = body.rig.fit(actor.poses.frame(of_recorded));
        Aim::new(&body, [&wanted, &motions[of_clip as usize]], (of_clip as usize, FPS), inwards)
    });
    let mut aims = aims.to_vec();
    let between = aims[1].frame - aims[0].frame;
    aims.iter_mut().for_each(|aim| aim.fades = aim.fades.min(between));
    let masses = Masses::new(&body);
    let nodes = session.blended().unwrap();
    for (end, aim) in aims.iter_mut().enumerate() {
        let frames = recorded[end].chunks_exact(actor.topology.vertex_count());
        let motions: Vec<_> = frames.map(|pose| body.rig.fit(pose)).collect();
        let first = if aim.inwards { 0 } else { native.free.count() };
        let of = End { recorded: &motions, nodes: nodes[end], first };
        aim.strength = strength((&body, &masses), (&native.free, FPS), aim, &of);
    }
    (aims, recorded)
}

#[test]
fn who_squats_keeps_volume() {
    let driven = ACTOR.native(&squat());
    let [least, mean] = driven.measures.volume;
    assert!(least > 0.93 && mean > 0.97, "least {least}, mean {mean}");
}

#[test]
fn a_clips_ends_are_edited_towards_the_recording_as_the_builder_edits_them() {
    let actor = &*ACTOR;
    let mut session = actor.session();
    let clip = squat();
    session.begin(&[("squat.bvh", clip.as_bytes())]).unwrap();
    let native = actor.native(&clip);
    let body = body(&actor.rig, &actor.poses).unwrap();
    for from in [10, 40] {
        let (aims, recorded) = aimed(actor, &mut session, &native, from);
        let apart = session.aim(&recorded).unwrap();
        for ([driven, edited], aim) in apart.iter().zip(&aims) {
            assert!(
                *edited < (1.0 - 0.2 * aim.strength) * driven || aim.strength == 0.0,
                "{apart:?}, {}",
                aim.strength
            );
        }
        assert!(aims.iter().any(|aim| aim.strength > 0.0));
        // To the bit, and nothing but what the edits reach.
        let (planted, poses) = native.towards(&aims, &body, (&actor.topology, None)).unwrap();
        assert!((0..poses.len()).all(|frame| session.make(frame).unwrap() == poses[frame]));
        assert!((0..poses.len()).any(|frame| poses[frame] != native.poses[frame]));
        let faded = aims[0].frame + aims[0].fades..aims[1].frame.saturating_sub(aims[1].fades);
        let far = |frame: &usize| faded.clone().nth(10).is_some_and(|first| *frame >= first && frame + 10 < faded.end);
        assert!(
            (0..poses.len())
                .filter(far)
                .all(|frame| planted.frames[frame].pose.turns[0] == native.planted.frames[frame].pose.turns[0])
        );
        // Soles that stand are as near to the floor as before, and stay where they are.
        let soles = |poses: &[Vec<Vec3>], planted| {
            drive::measure::measure(&body, &actor.topology, &actor.poses, poses, planted)
        };
        let (before, after) = (soles(&native.poses, &native.planted), soles(&poses, &planted));
        assert!(after.sole_off_mm[0] < before.sole_off_mm[0] + 0.5 && after.slide_mm[0] < 0.1, "{after:?}");
        // An edit is good for a frame or two later, and none for one farther away.
        session.prepare(from + 2, actor.poses.frame(from + 2)).unwrap();
        assert!((0..poses.len()).all(|frame| session.make(frame).unwrap() == poses[frame]));
        while session.make_ahead().unwrap() {}
        // As it was driven, it is the builder's as it was driven.
        session.as_driven = true;
        let (_, recorded) = aimed(actor, &mut session, &native, from + 30);
        assert!(session.aim(&recorded).unwrap().is_empty());
        assert!((0..poses.len()).all(|frame| session.make(frame).unwrap() == native.poses[frame]));
        session.as_driven = false;
    }
    assert!(session.aim(&[Vec::new(), Vec::new()]).is_err(), "poses that do not fit");
}

/// The largest mean acceleration of the first `count` frames after the recorded one, in metres per second squared.
fn abrupt(first: &[Vec3], frames: &[Performed], count: usize) -> f32 {
    let shown: Vec<&[Vec3]> =
        std::iter::once(first).chain(frames.iter().take(count).map(|frame| frame.pose.as_slice())).collect();
    let of = |three: &[&[Vec3]]| {
        let bends = (0..first.len()).map(|v| (three[0][v] + three[2][v] - 2.0 * three[1][v]).length());
        FPS * FPS * bends.sum::<f32>() / first.len() as f32
    };
    shown.windows(3).map(of).fold(0.0, f32::max)
}

#[test]
fn an_edit_is_done_as_far_as_it_makes_the_way_no_more_abrupt() {
    let actor = &*ACTOR;
    let mut session = actor.session();
    let clip = squat();
    session.begin(&[("squat.bvh", clip.as_bytes())]).unwrap();
    let native = actor.native(&clip);
    let count = actor.timeline.frame_count();
    let mut found: Vec<(f32, u32)> = Vec::new();
    for from in (0..count).step_by(7) {
        found.push((aimed(actor, &mut session, &native, from).0[0].strength, from));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (least, most) = (found[0], found[found.len() - 1]);
    assert!(least.0 < 1.0 && most.0 == 1.0, "{found:?}");
    let [driven, edited] = [true, false].map(|as_driven| {
        session.as_driven = as_driven;
        let (_, _, frames) = actor.perform(&mut session, least.1, Placement::IDENTITY);
        abrupt(actor.poses.frame(least.1), &frames, 100)
    });
    // Told by bones, and so not to the last of the surface.
    assert!(edited < 1.15 * driven + 1.0, "{driven} m/s^2, edited {edited}, {least:?}");
}

fn largest_step(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn a_clip_is_performed_between_recorded_frames() {
    let actor = &*ACTOR;
    let mut session = actor.session();
    let clip = squat();
    let began = session.begin(&[("squat.bvh", clip.as_bytes())]).unwrap();
    assert_eq!(began.notes.len(), 2, "{:?}", began.notes);

    // The same frames as the builder's, in whatever order.
    let native = actor.native(&clip);
    assert_eq!(began.count, native.poses.len());
    for (frame, pose) in native.poses.iter().enumerate().rev() {
        assert!(session.make(frame).unwrap() == *pose, "frame {frame}");
    }
    assert!(session.make(began.count).is_err());

    for (from, heading) in [(10, 0.0), (actor.timeline.sequences()[0].end_frame() - 2, 1.2)] {
        let placement = Placement { heading, translation: Vec2::new(0.5, -0.25) };
        let (to, home, frames) = actor.perform(&mut session, from, placement);
        // It begins beside where the actor stands and ends where the recorded frame stands, without a jump on the way.
        let mut last: Vec<Vec3> = actor.poses.frame(from).to_vec();
        placement.apply_all(&mut last);
        for (step, frame) in frames.iter().enumerate() {
            let metres = largest_step(&last, &frame.pose);
            assert!(metres * FPS < 7.0, "{} m/s in step {step} of {} from {from}", metres * FPS, frames.len());
            last.clone_from(&frame.pose);
        }
        let mut end: Vec<Vec3> = actor.poses.frame(to).to_vec();
        home.apply_all(&mut end);
        assert!(largest_step(&end, &last) < 1e-5);
        assert!(frames.iter().any(|frame| frame.worn == ([native.nearest; 2], 0.0)), "the clip's looks are missing");
        // What is no blend is shown as it is.
        let shown = frames.iter().filter(|frame| frame.worn.1 == 0.0).count();
        assert!(5 * shown > began.count, "{shown} of {}", began.count);
        // No sole is far below the floor.
        let lowest = frames.iter().flat_map(|frame| &frame.pose).map(|point| point.y).fold(f32::INFINITY, f32::min);
        assert!(lowest > -0.03, "{lowest} m");
        // The same again is the same to the bit, whatever was made ahead.
        session.prepare(from, actor.poses.frame(from)).unwrap();
        while session.make_ahead().unwrap() {}
        assert!(actor.perform(&mut session, from, placement).2 == frames);
    }
}

#[test]
fn what_cannot_be_driven_is_told_in_a_sentence() {
    let actor = &*ACTOR;
    let refused = Session::new(actor.known(), &[]).err().unwrap();
    assert!(matches!(refused, DriverError::NoRig) && refused.to_string().contains("pack --rig"), "{refused}");
    assert!(matches!(Session::new(actor.known(), &[1, 2, 3]), Err(DriverError::Rig(_))));
    let mut session = actor.session();
    let told = |session: &mut Session, name: &str, text: &str| {
        session.begin(&[(name, text.as_bytes())]).unwrap_err().to_string()
    };
    assert!(told(&mut session, "a.bvh", "HIERARCHY").contains("a.bvh: the file ends in the middle of"));
    assert!(told(&mut session, "a.asf", "").contains("a motion (.amc) is missing"));
    let slow = squat().replace("0.0333333", "60");
    assert!(told(&mut session, "a.bvh", &slow).contains("but a page performs up to 600 s"));
    let pole = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Yposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\n\
                Frames: 2\nFrame Time: 0.1\n0\n0\n";
    assert!(told(&mut session, "a.bvh", pole).contains("no two legs"));
    assert!(session.make(0).is_err() && session.prepare(0, &[]).is_err() && session.next_frame().unwrap().is_none());
}
