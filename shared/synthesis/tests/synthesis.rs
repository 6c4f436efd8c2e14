//! Walks: continuity, identities, and changes of mind.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests fail as tests do")]

use actor::blend::{arrival, transition_placement};
use actor::capture::Poses;
use actor::contacts::Contacts;
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround, recorded_step};
use actor::pose_source::{PoseError, PoseSource};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, Walk, WalkError};
use fixtures::captured;
use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::align::{Placement, centre_of_mass};
use kernels::topology::Topology;
use search::cheapest_walk;
use synthesis::{FrameInfo, FrameKind, Synthesiser};

fn sequence(name: &str, first_frame: u32, frame_count: u32, cyclic: bool) -> Sequence {
    Sequence { name: name.into(), labels: vec![], first_frame, frame_count, cyclic }
}

/// A transition with its placement, as the builder would make it.
fn transition(
    timeline: &Timeline,
    topology: &Topology,
    poses: &mut Poses,
    (from, to): (u32, u32),
    moves: Vec<Move>,
) -> Transition {
    let warp = TemporalWarp::new(moves);
    let mut memory = PoseMemory::default();
    let mut ground = PosesOnGround::new(poses, topology.weights(), &mut memory);
    let placement = transition_placement(timeline, &mut ground, (from, to), &warp, &Contacts::default()).unwrap();
    Transition { from, to, deformation: 0.1, warp, placement, turn: 0.0 }
}

struct Played {
    infos: Vec<FrameInfo>,
    frames: Vec<Vec<Vec3>>,
}

impl Played {
    /// Largest distance of a vertex between each frame and the next.
    fn steps(&self) -> Vec<f32> {
        let step = |pair: &[Vec<Vec3>]| pair[0].iter().zip(&pair[1]).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        self.frames.windows(2).map(step).collect()
    }
}

fn play(
    synthesiser: &mut Synthesiser,
    graph: &EssentialGraph,
    timeline: &Timeline,
    poses: &mut Poses,
    most: usize,
) -> Played {
    let mut played = Played { infos: vec![], frames: vec![] };
    let mut out = vec![Vec3::ZERO; poses.vertex_count()];
    while let Some(info) = synthesiser.next_frame(graph, timeline, poses, &mut out).unwrap() {
        played.infos.push(info);
        played.frames.push(out.clone());
        if played.infos.len() >= most {
            break;
        }
    }
    played
}

/// Every node of a warp of both sides in step, with a frame repeated now and then.
fn uneven(count: usize) -> Vec<Move> {
    (0..count)
        .map(|step| match step % 5 {
            2 => Move::Source,
            4 => Move::Destination,
            _ => Move::Both,
        })
        .collect()
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_captured_walk_with_two_transitions_does_not_pop() {
    let frames: Vec<usize> = (0..70).collect();
    let (topology, crane) = captured("crane", &frames);
    let (_, jumping) = captured("jumping", &frames);
    let mut poses = Poses::new(topology.vertex_count());
    crane.iter().chain(&jumping).for_each(|pose| poses.push(pose));
    let timeline =
        Timeline::new(25.0, vec![sequence("crane", 0, 70, false), sequence("jumping", 70, 70, false)]).unwrap();
    let edges = vec![
        transition(&timeline, &topology, &mut poses, (10, 100), uneven(20)),
        transition(&timeline, &topology, &mut poses, (105, 50), uneven(15)),
    ];
    let graph = EssentialGraph::new(0.01, edges, &timeline).unwrap();
    let legs = vec![
        Leg::Recorded { first: 5, last: 10, steps: 5 },
        Leg::Synthetic(0),
        Leg::Recorded { first: 100, last: 105, steps: 5 },
        Leg::Synthetic(1),
        Leg::Recorded { first: 50, last: 60, steps: 10 },
    ];
    let walk = Walk { legs, ..Walk::default() };

    let start = Placement { heading: 2.0, translation: Vec2::new(3.0, -1.0) };
    let mut synthesiser = Synthesiser::new(&topology, None).unwrap();
    synthesiser.begin_walk(&graph, &timeline, (5, start), &walk).unwrap();
    let pieces = 1 + (0..10).take_while(|_| synthesiser.prepare(&graph, &timeline, &mut poses).unwrap()).count();
    assert!((2..=4).contains(&pieces), "{pieces} pieces: a factorisation each, and what is tried before");
    let played = play(&mut synthesiser, &graph, &timeline, &mut poses, usize::MAX);
    assert_eq!(played.infos.len(), 1 + 5 + 20 + 5 + 15 + 10);

    // Recorded frames come out as read, then placed.
    for (info, frame) in played.infos.iter().zip(&played.frames) {
        if let FrameKind::Recorded { frame: number } = info.kind {
            let mut expected = poses.frame(number).to_vec();
            info.placement.apply_all(&mut expected);
            assert_eq!(frame, &expected);
        }
    }

    // No step at a seam is larger than its neighbours' largest, give or take a tenth.
    let steps = played.steps();
    let synthetic = |index: usize| matches!(played.infos[index].kind, FrameKind::Synthetic { .. });
    let mut seams = 0;
    for index in 3..steps.len() - 3 {
        if synthetic(index) != synthetic(index + 1) {
            seams += 1;
            let around = [index - 3, index - 2, index - 1, index + 1, index + 2, index + 3];
            let neighbours = around.into_iter().map(|k| steps[k]).fold(0.0, f32::max);
            println!("seam at {index}: {} against {neighbours}", steps[index]);
            assert!(steps[index] < 1.1 * neighbours, "{} against {neighbours}", steps[index]);
        }
    }
    assert_eq!(seams, 4);

    // Centres of mass move on without a jump, headings accumulate, and the preview knows where it ends.
    let weights = topology.weights();
    let centres: Vec<Vec2> = played.frames.iter().map(|frame| centre_of_mass(frame, weights).xz()).collect();
    let longest = centres.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f32::max);
    let recorded = (0..140).filter(|&k| k != 69).filter_map(|k| timeline.next(k).map(|next| (k, next)));
    let centre = |k: u32| centre_of_mass(poses.frame(k), weights).xz();
    let fastest = recorded.map(|(a, b)| centre(a).distance(centre(b))).fold(0.0, f32::max);
    assert!(longest <= fastest * 1.01, "{longest} against {fastest}");
    let mut memory = PoseMemory::default();
    let mut ground = PosesOnGround::new(&mut poses, weights, &mut memory);
    let end = arrival(&graph, &timeline, &mut ground, start, &walk.legs).unwrap();
    let last = played.infos.last().unwrap().placement;
    assert!(end.translation.distance(last.translation) < 1e-4, "{end:?} against {last:?}");
    assert!((end.heading - last.heading).sin().abs() < 1e-5);
    let solves: usize = played.infos.iter().map(|info| info.effort.solves.iter().sum::<usize>()).sum();
    let factorisations: usize = played.infos.iter().map(|info| info.effort.factorisations).sum();
    println!("{solves} solves, {factorisations} factorisations in 33 frames");
}

/// A small closed body: an octahedron with a beak, turned by `heading` and moved to `at`.
fn body(heading: f32, at: Vec3) -> Vec<Vec3> {
    let corners = [
        Vec3::new(0.6, 0.0, 0.0),
        Vec3::new(-0.6, 0.0, 0.0),
        Vec3::new(0.0, 0.9, 0.1),
        Vec3::new(0.0, -0.9, 0.0),
        Vec3::new(0.0, 0.0, 0.5),
        Vec3::new(0.0, 0.0, -0.3),
    ];
    corners.map(|corner| glam::Quat::from_rotation_y(heading) * corner + at).to_vec()
}

fn body_topology() -> Topology {
    let triangles = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Topology::new(6, triangles, vec![1.0; 6]).unwrap()
}

/// Two cyclic sequences of a rigid body: one walks straight on, the other around a circle.
fn rigid_capture() -> (Topology, Timeline, Poses) {
    let topology = body_topology();
    let mut poses = Poses::new(6);
    (0..20).for_each(|k| poses.push(&body(0.0, Vec3::new(0.0, 1.0, 0.05 * k as f32))));
    (0..20).for_each(|k| {
        let angle = 0.05 * k as f32;
        // Facing along the tangent.
        poses.push(&body(angle, Vec3::new(-angle.cos(), 1.5, angle.sin())));
    });
    let timeline = Timeline::new(50.0, vec![sequence("straight", 0, 20, true), sequence("circle", 20, 20, true)]);
    (topology, timeline.unwrap(), poses)
}

#[test]
fn wraps_go_on_as_the_body_goes() {
    let (topology, timeline, mut poses) = rigid_capture();
    let mut memory = PoseMemory::default();
    let mut ground = PosesOnGround::new(&mut poses, topology.weights(), &mut memory);
    let (to, straight) = recorded_step(&timeline, &mut ground, 19).unwrap().unwrap();
    assert_eq!(to, 0);
    assert!(straight.heading.abs() < 1e-5);
    assert!(straight.translation.distance(Vec2::new(0.0, 1.0)) < 1e-5, "{straight:?}");
    let (_, circle) = recorded_step(&timeline, &mut ground, 39).unwrap().unwrap();
    // Once around goes on around the same circle.
    assert!((circle.heading - 1.0).abs() < 1e-5, "{circle:?}");
    assert!(circle.translation.length() < 2e-3, "{circle:?}");
    assert_eq!(recorded_step(&timeline, &mut ground, 3).unwrap(), Some((4, Placement::IDENTITY)));

    let graph = EssentialGraph::new(0.01, vec![], &timeline).unwrap();
    let walk = Walk { legs: vec![Leg::Recorded { first: 30, last: 30, steps: 60 }], ..Walk::default() };
    let mut synthesiser = Synthesiser::new(&topology, None).unwrap();
    synthesiser.begin_walk(&graph, &timeline, (30, Placement::IDENTITY), &walk).unwrap();
    let steps = play(&mut synthesiser, &graph, &timeline, &mut poses, usize::MAX).steps();
    assert_eq!(steps.len(), 60);
    let (least, most) = steps.iter().fold((f32::MAX, 0.0_f32), |(a, b), &step| (a.min(step), b.max(step)));
    assert!(most < 1.01 * least, "{least} to {most}");
}

#[test]
fn rigid_bodies_blend_rigidly_and_headings_accumulate() {
    let (topology, timeline, mut poses) = rigid_capture();
    // Both segments wrap.
    let edge = transition(&timeline, &topology, &mut poses, (12, 27), uneven(14));
    let graph = EssentialGraph::new(0.01, vec![edge], &timeline).unwrap();
    let walk =
        Walk { legs: vec![Leg::Synthetic(0), Leg::Recorded { first: 27, last: 35, steps: 8 }], ..Walk::default() };
    let start = Placement { heading: -0.7, translation: Vec2::new(0.3, 8.0) };
    let mut synthesiser = Synthesiser::new(&topology, None).unwrap();
    synthesiser.begin_walk(&graph, &timeline, (12, start), &walk).unwrap();
    let played = play(&mut synthesiser, &graph, &timeline, &mut poses, usize::MAX);
    assert_eq!(played.infos.len(), 1 + 14 + 8);
    let shape = |pose: &[Vec3]| -> Vec<f32> { (0..6).map(|k| pose[k].distance(pose[(k + 1) % 6])).collect() };
    let rigid = shape(poses.frame(0));
    // The circle turns by 0.05 radians a frame; half way between frames a straight line loses 1 - cos 0.025 of 1.2 m.
    let chord = 1.2 * (1.0 - 0.025_f32.cos()) + 1e-5;
    for (info, frame) in played.infos.iter().zip(&played.frames) {
        for (found, expected) in shape(frame).iter().zip(&rigid) {
            assert!((found - expected).abs() < chord, "{info:?}: {found} against {expected}");
        }
    }
    // Heights are blended: the circle lies half a metre higher.
    let heights: Vec<f32> = played.frames.iter().map(|frame| centre_of_mass(frame, topology.weights()).y).collect();
    assert!(heights.windows(2).all(|pair| pair[1] > pair[0] - 1e-5), "{heights:?}");
    assert!((heights[0] - heights[22] + 0.5).abs() < 1e-4);
    // It walks forward all the time, and turns as fast as the circle in the end.
    let centre = |k: usize| centre_of_mass(&played.frames[k], topology.weights()).xz();
    for k in 0..22 {
        let step = centre(k).distance(centre(k + 1));
        assert!(step < 0.06, "step {k} is {step}");
    }
    let facing = |k: usize| (played.frames[k][4] - played.frames[k][5]).xz();
    for k in 14..22 {
        assert!((facing(k).angle_to(facing(k + 1)) + 0.05).abs() < 1e-3);
    }
    let end = arrival_of(&graph, &timeline, &topology, &mut poses, start, &walk);
    assert!(end.translation.distance(played.infos[22].placement.translation) < 1e-4);
}

#[test]
fn a_body_that_walks_evenly_does_not_stutter_in_an_uneven_warp() {
    let (topology, timeline, mut poses) = rigid_capture();
    let edge = transition(&timeline, &topology, &mut poses, (1, 19), uneven(20));
    let pauses = edge.warp.moves().iter().filter(|step| **step != Move::Both).count();
    assert_eq!(pauses, 8);
    let graph = EssentialGraph::new(0.01, vec![edge], &timeline).unwrap();
    let walk =
        Walk { legs: vec![Leg::Synthetic(0), Leg::Recorded { first: 19, last: 3, steps: 4 }], ..Walk::default() };
    let mut synthesiser = Synthesiser::new(&topology, None).unwrap();
    synthesiser.begin_walk(&graph, &timeline, (1, Placement::IDENTITY), &walk).unwrap();
    let steps = play(&mut synthesiser, &graph, &timeline, &mut poses, usize::MAX).steps();
    // A side is paused for a fifth of the frames: evenly, every step would be 0.8 of a recorded one. On repeated frames
    // single steps of 0 and 0.05 m follow each other.
    for pair in steps.windows(2) {
        assert!((pair[1] - pair[0]).abs() < 0.2 * 0.05, "{steps:?}");
    }
    assert!(steps.iter().all(|step| (0.5 * 0.05..1.01 * 0.05).contains(step)), "{steps:?}");
}

fn arrival_of(
    graph: &EssentialGraph,
    timeline: &Timeline,
    topology: &Topology,
    poses: &mut Poses,
    start: Placement,
    walk: &Walk,
) -> Placement {
    let mut memory = PoseMemory::default();
    arrival(graph, timeline, &mut PosesOnGround::new(poses, topology.weights(), &mut memory), start, &walk.legs)
        .unwrap()
}

#[test]
fn a_change_of_mind_finishes_the_transition_and_does_not_pop() {
    let (topology, timeline, mut poses) = rigid_capture();
    let edges = vec![
        transition(&timeline, &topology, &mut poses, (5, 30), uneven(10)),
        transition(&timeline, &topology, &mut poses, (30, 15), uneven(10)),
    ];
    let graph = EssentialGraph::new(0.01, edges, &timeline).unwrap();
    let walk = cheapest_walk(&graph, &timeline, 2, 36).unwrap();
    let mut synthesiser = Synthesiser::new(&topology, None).unwrap();
    assert_eq!(synthesiser.departure(&graph), None);
    synthesiser.begin_walk(&graph, &timeline, (2, Placement::IDENTITY), &walk).unwrap();
    let mut played = play(&mut synthesiser, &graph, &timeline, &mut poses, 7);
    assert_eq!(synthesiser.departure(&graph), Some(30));
    let there = synthesiser.departure_placement(&graph, &timeline, &mut poses).unwrap().unwrap();
    let back = cheapest_walk(&graph, &timeline, 30, 18).unwrap();
    synthesiser.retarget(&graph, &timeline, &back.legs).unwrap();
    let rest = play(&mut synthesiser, &graph, &timeline, &mut poses, usize::MAX);
    let at_end = rest.infos.iter().find(|info| info.kind == FrameKind::Recorded { frame: 30 }).unwrap();
    assert_eq!((at_end.placement, at_end.leg), (there, None));
    assert_eq!(rest.infos.last().unwrap().kind, FrameKind::Recorded { frame: 18 });
    assert_eq!(rest.infos.last().unwrap().leg, Some(1));
    played.frames.extend(rest.frames);
    assert!(played.steps().iter().all(|&step| step < 0.13), "{:?}", played.steps());

    // Out of recorded frames it leaves at once.
    synthesiser.begin_walk(&graph, &timeline, (2, Placement::IDENTITY), &walk).unwrap();
    play(&mut synthesiser, &graph, &timeline, &mut poses, 2);
    assert_eq!(synthesiser.departure(&graph), Some(3));
    let stay = Walk { legs: vec![Leg::Recorded { first: 3, last: 4, steps: 1 }], ..Walk::default() };
    synthesiser.retarget(&graph, &timeline, &stay.legs).unwrap();
    assert_eq!(play(&mut synthesiser, &graph, &timeline, &mut poses, usize::MAX).infos.len(), 1);
}

/// Fails once at every frame, as a bundle that is still arriving.
struct Arriving<'a>(&'a mut Poses, Vec<u32>);

impl PoseSource for Arriving<'_> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        if self.1.contains(&frame) {
            return self.0.read(frame, pose);
        }
        self.1.push(frame);
        Err(PoseError::NotLoaded(frame))
    }
}

#[test]
fn a_frame_that_has_not_arrived_can_be_asked_for_again() {
    let (topology, timeline, mut poses) = rigid_capture();
    let edge = transition(&timeline, &topology, &mut poses, (5, 30), uneven(10));
    let graph = EssentialGraph::new(0.01, vec![edge], &timeline).unwrap();
    let walk = cheapest_walk(&graph, &timeline, 2, 36).unwrap();
    let mut synthesiser = Synthesiser::new(&topology, None).unwrap();
    synthesiser.begin_walk(&graph, &timeline, (2, Placement::IDENTITY), &walk).unwrap();
    let expected = play(&mut synthesiser, &graph, &timeline, &mut poses, usize::MAX);
    synthesiser = Synthesiser::new(&topology, None).unwrap();
    synthesiser.begin_walk(&graph, &timeline, (2, Placement::IDENTITY), &walk).unwrap();
    let mut arriving = Arriving(&mut poses, vec![]);
    let mut out = vec![Vec3::ZERO; 6];
    let mut frames = vec![];
    for _ in 0..1000 {
        match synthesiser.next_frame(&graph, &timeline, &mut arriving, &mut out) {
            Ok(Some(_)) => frames.push(out.clone()),
            Ok(None) => break,
            Err(error) => assert!(matches!(error, PoseError::NotLoaded(_))),
        }
    }
    assert_eq!(frames, expected.frames);
}

#[test]
fn a_walk_that_does_not_fit_is_refused() {
    let (topology, timeline, mut poses) = rigid_capture();
    let graph = EssentialGraph::new(0.01, vec![], &timeline).unwrap();
    let mut synthesiser = Synthesiser::new(&topology, None).unwrap();
    let stay = Walk { legs: vec![Leg::Recorded { first: 2, last: 5, steps: 3 }], ..Walk::default() };
    synthesiser.begin_walk(&graph, &timeline, (2, Placement::IDENTITY), &stay).unwrap();
    let unfit = [
        (vec![Leg::Synthetic(0)], WalkError::NoSuchLeg(0)),
        (vec![Leg::Recorded { first: 9, last: 10, steps: 1 }], WalkError::Gap(0)),
        (
            vec![Leg::Recorded { first: 2, last: 3, steps: 1 }, Leg::Back { first: 4, last: 2, steps: 2 }],
            WalkError::Gap(1),
        ),
        (vec![Leg::Back { first: 2, last: 39, steps: 3 }], WalkError::NoSuchLeg(0)),
    ];
    for (legs, error) in unfit {
        let walk = Walk { legs, ..Walk::default() };
        assert_eq!(synthesiser.begin_walk(&graph, &timeline, (2, Placement::IDENTITY), &walk), Err(error));
        assert_eq!(synthesiser.retarget(&graph, &timeline, &walk.legs), Err(error));
    }
    // What was under way goes on.
    assert_eq!(play(&mut synthesiser, &graph, &timeline, &mut poses, usize::MAX).infos.len(), 4);
}
