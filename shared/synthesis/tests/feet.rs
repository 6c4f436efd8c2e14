//! Feet in transitions: steps against all possible ones, poses against where the sides, played alone, have the feet.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use actor::blend::transition_placement;
use actor::capture::Poses;
use actor::contacts::Contacts;
use actor::feet::{Feet, FootVertex};
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround, recorded_step};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, Walk};
use fixtures::Random;
use glam::{Quat, Vec3, Vec3Swizzles};
use kernels::align::{Placement, centre_of_mass};
use kernels::topology::Topology;
use synthesis::Synthesiser;
use synthesis::steps::{FootStep, foot_steps, steps_of_standing};

const FPS: f32 = 25.0;

fn firm(node: impl Fn(usize) -> bool, nodes: usize) -> Vec<f32> {
    (0..nodes).map(|index| f32::from(u8::from(node(index)))).collect()
}

fn only_step(source: Vec<f32>, destination: Vec<f32>) -> FootStep {
    steps_of_standing(&[[source, destination]], FPS)[0].unwrap()
}

#[test]
fn a_foot_goes_while_it_is_in_the_air() {
    // It lifts after node 4 on one side and lands at node 15 on the other.
    let step = only_step(firm(|node| node <= 4, 21), firm(|node| node >= 15, 21));
    assert_eq!((step.weight(4), step.weight(15)), (0.0, 1.0));
    assert!(step.stands.iter().sum::<f32>() < 0.05, "{step:?}");
    // It goes for as long as it can.
    assert!(step.width == 10 && (4..=5).contains(&step.begin), "{step:?}");
}

#[test]
fn a_foot_that_stands_on_both_sides_makes_a_step_in_the_middle() {
    let step = only_step(firm(|_| true, 41), firm(|_| true, 41));
    let middle = step.begin as f32 + step.width as f32 / 2.0;
    assert!(step.stands.iter().all(|side| (side - 0.5).abs() < 1e-5) && step.lifted() == 1.0);
    // It is lifted before it goes, and is there before it is put down.
    let raised = (step.width as f32 * 0.3) as usize;
    assert_eq!((step.weight(step.begin + raised), step.weight(step.begin + step.width - raised)), (0.0, 1.0));
    assert!((middle - 20.0).abs() <= 1.0 && (5..=15).contains(&step.width), "{step:?}");
}

#[test]
fn two_feet_do_not_go_at_once_where_there_is_time() {
    let foot = || [firm(|_| true, 41), firm(|_| true, 41)];
    let steps = steps_of_standing(&[foot(), foot()], FPS);
    let [one, other] = [0, 1].map(|foot| steps[foot].unwrap());
    let together = (0..40).filter(|&node| {
        let goes = |step: &FootStep| step.weight(node + 1) - step.weight(node) > 0.02;
        goes(&one) && goes(&other)
    });
    assert!(together.count() <= 4, "{one:?} {other:?}");
}

#[test]
fn two_feet_go_one_after_the_other_in_little_time_too() {
    // Each of them alone would rather take all of the time.
    let foot = || [firm(|_| true, 15), firm(|_| true, 15)];
    for step in steps_of_standing(&[foot(), foot()], 50.0).into_iter().flatten() {
        assert!(step.alone < 0.01 && step.width == 10, "{step:?}");
    }
}

#[test]
fn a_foot_knows_whether_another_one_bears() {
    let (stands, hangs) = (|| firm(|_| true, 21), || firm(|_| false, 21));
    let beside = |other: [Vec<f32>; 2]| steps_of_standing(&[[stands(), stands()], other], FPS)[0].unwrap().alone;
    assert!((beside([hangs(), hangs()]) - 1.0).abs() < 1e-5);
    assert_eq!(only_step(stands(), stands()).alone, 1.0);
    // The other one comes down in good time, and the first one waits for it.
    assert!(beside([firm(|node| node >= 8, 21), firm(|node| node >= 8, 21)]) < 0.7);
}

#[test]
fn steps_begin_on_one_side_and_end_on_the_other_whatever_stands() {
    for seed in 0..500 {
        let mut random = Random::new(seed);
        let nodes = 1 + random.below(60);
        let feet = 1 + random.below(4);
        let standing: Vec<[Vec<f32>; 2]> = (0..feet)
            .map(|_| [0, 1].map(|_| (0..nodes).map(|_| (random.unit() * 2.0 - 0.7).clamp(0.0, 1.0)).collect()))
            .collect();
        for step in steps_of_standing(&standing, random.range(5.0, 120.0)).into_iter().flatten() {
            if nodes > 1 {
                assert_eq!((step.weight(0), step.weight(nodes - 1)), (0.0, 1.0), "{step:?} of {nodes}");
            }
            assert!((0..nodes - 1).all(|node| step.weight(node) <= step.weight(node + 1)));
            assert!(step.stands.iter().all(|side| (0.0..=0.501).contains(side)), "{step:?}");
        }
    }
    assert_eq!(steps_of_standing(&[[vec![0.0; 9], vec![0.0; 9]]], FPS), [None]);
}

const AROUND: u32 = 7;
const RINGS: u32 = 9;

/// A tube that turns, bends and walks, in a plain and a cyclic sequence; it stands on its lowest ring.
fn tube() -> (Topology, Timeline, Poses) {
    let mut triangles = Vec::new();
    for ring in 0..RINGS - 1 {
        for side in 0..AROUND {
            let [a, b] = [side, (side + 1) % AROUND].map(|side| ring * AROUND + side);
            triangles.extend([[a, b, a + AROUND], [b, b + AROUND, a + AROUND]]);
        }
    }
    let count = (AROUND * RINGS) as usize;
    let topology = Topology::new(AROUND * RINGS, triangles, vec![1.0; count]).unwrap();
    let mut poses = Poses::new(count);
    for frame in 0..60_u32 {
        let (time, second) = (frame as f32, frame >= 30);
        let heading = Quat::from_rotation_y(if second { 0.6 + 0.02 * time } else { -0.03 * time });
        let pose: Vec<Vec3> = (0..RINGS * AROUND)
            .map(|vertex| {
                let (height, angle) = (0.2 * (vertex / AROUND) as f32, (vertex % AROUND) as f32 * 0.9);
                let lean = height * (0.2 * time + if second { 1.0 } else { 0.0 }).sin();
                heading * Vec3::new(0.3 * angle.cos() + lean, height, 0.3 * angle.sin()) + 0.03 * time * Vec3::Z
            })
            .collect();
        poses.push(&pose);
    }
    let sequence = |name: &str, first_frame: u32, cyclic: bool| Sequence {
        name: name.into(),
        labels: vec![],
        first_frame,
        frame_count: 30,
        cyclic,
    };
    let timeline = Timeline::new(FPS, vec![sequence("plain", 0, false), sequence("cyclic", 30, true)]).unwrap();
    (topology, timeline, poses)
}

fn all_frames(
    (topology, timeline, poses): &mut (Topology, Timeline, Poses),
    graph: &EssentialGraph,
    start: Placement,
) -> Vec<Vec<Vec3>> {
    let mut synthesiser = Synthesiser::new(topology, None).unwrap();
    let from = graph.transitions()[0].from;
    let walk = Walk::of_legs(vec![Leg::Synthetic(0)], graph).unwrap();
    synthesiser.begin_walk(graph, timeline, (from, start), &walk).unwrap();
    let (mut frames, mut pose) = (Vec::new(), vec![Vec3::ZERO; topology.vertex_count()]);
    while synthesiser.next_frame(graph, timeline, poses, &mut pose).unwrap().is_some() {
        frames.push(pose.clone());
    }
    frames
}

/// The placement of each frame of the destination's segment: backwards from where the last one stands.
fn placements_before(actor: &mut (Topology, Timeline, Poses), to: u32, length: u32, end: Placement) -> Vec<Placement> {
    let (topology, timeline, poses) = actor;
    let mut memory = PoseMemory::default();
    let mut ground = PosesOnGround::new(poses, topology.weights(), &mut memory);
    let mut placements = vec![end];
    for back in 1..length {
        let frame = timeline.offset(to, -i64::from(back)).unwrap();
        let (_, step) = recorded_step(timeline, &mut ground, frame).unwrap().unwrap();
        // p(frame + 1) = p(frame) step, solved for p(frame) by its two unknowns.
        let after = placements[back as usize - 1];
        let heading = after.heading - step.heading;
        let moved = kernels::align::rotate(heading, step.translation);
        placements.push(Placement { heading, translation: after.translation - moved });
    }
    placements.reverse();
    placements
}

#[test]
fn what_stands_is_where_its_side_played_alone_has_it() {
    let mut actor = tube();
    let moves = vec![Move::Both; 24];
    // The last one goes through the wrap of the cyclic sequence.
    for (from, to) in [(4, 50), (33, 27), (2, 36)] {
        let warp = TemporalWarp::new(moves.clone());
        let (topology, timeline, poses) = &mut actor;
        let mut memory = PoseMemory::default();
        let mut ground = PosesOnGround::new(poses, topology.weights(), &mut memory);
        let none = Contacts::default();
        let placement = transition_placement(timeline, &mut ground, (from, to), &warp, &none).unwrap();
        let transition = Transition { from, to, deformation: 0.1, warp, placement, turn: 0.0 };
        let plain = EssentialGraph::new(0.01, vec![transition.clone()], timeline).unwrap();
        let share = |vertex: u32| match vertex / AROUND {
            0 => Some((255, 255)),
            1 => Some((255, 100)),
            2 => Some((128, 0)),
            _ => None,
        };
        let foot = (0..AROUND * RINGS).filter_map(|vertex| {
            let (leg, sole) = share(vertex)?;
            Some(FootVertex { vertex, leg, sole })
        });
        let count = topology.vertex_count();
        let feet = Feet::new(vec![foot.collect()], vec![true; 60], count, timeline).unwrap();
        let step = foot_steps(&feet, timeline, &transition)[0].unwrap();
        assert!(step.begin > 1 && step.begin + step.width < 23, "{step:?}");
        let start = Placement { heading: 0.7, translation: glam::Vec2::new(2.0, -1.0) };
        let before = all_frames(&mut actor, &plain, start);
        let kept = all_frames(&mut actor, &plain.clone().with_feet(feet), start);
        let ends = placements_before(&mut actor, to, 25, start.after(&placement));
        let (topology, timeline, poses) = &mut actor;
        let (mut stood, mut moved) = (0, 0.0_f32);
        for node in 1..24 {
            for vertex in 0..AROUND {
                let point = kept[node][vertex as usize];
                let alone = |frame: u32, placement: &Placement| placement.apply(poses.frame(frame)[vertex as usize]);
                let source = alone(from + node as u32, &start);
                let destination = alone(timeline.offset(to, node as i64 - 24).unwrap(), &ends[node]);
                // No poses between frames: the warp has no pause.
                if step.progress(node) == 0.0 {
                    assert!(point.distance(source) < 2e-5, "{from} to {to}, node {node}: {point} {source}");
                    stood += 1;
                } else if step.progress(node) == 1.0 {
                    assert!(point.distance(destination) < 2e-5, "{from} to {to}, node {node}: {point} {destination}");
                    stood += 1;
                }
                assert!(point.y > -1e-4, "below the ground");
                moved = moved.max(point.distance(before[node][vertex as usize]));
            }
            // What does not follow the foot leans against it along the ground, as one.
            let leans = |vertex: usize| kept[node][vertex] - before[node][vertex];
            for vertex in (3 * AROUND) as usize..count {
                assert!(leans(vertex).distance(leans(count - 1)) < 1e-6 && leans(vertex).y == 0.0);
            }
            let centre = |poses: &[Vec<Vec3>]| centre_of_mass(&poses[node], topology.weights()).xz();
            assert!(centre(&kept).distance(centre(&before)) < 1e-5, "the centre of mass stays on its way");
        }
        assert!(stood >= 20 && moved > 0.01, "{stood} {moved}");
        // Recorded frames are what they are.
        assert_eq!((&kept[0], &kept[24]), (&before[0], &before[24]));
    }
}
