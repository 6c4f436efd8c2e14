//! Frames made ahead of time, with little work at once, for routes that change: the same as those of a film, bit for bit.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use actor::blend::transition_placement;
use actor::capture::Poses;
use actor::contacts::Contacts;
use actor::feet::{Feet, FootVertex};
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, Walk};
use fixtures::Random;
use glam::{Quat, Vec3};
use kernels::align::Placement;
use kernels::topology::Topology;
use search::plan_walk;
use synthesis::{FrameInfo, Made, Synthesiser};

struct Scene {
    topology: Topology,
    timeline: Timeline,
    graph: EssentialGraph,
    poses: Poses,
}

const AROUND: u32 = 7;
const RINGS: u32 = 9;

/// A tube that walks, bends and swells, in three sequences of which one is cyclic, and transitions between any of them.
fn scene(seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let mut triangles = Vec::new();
    for ring in 0..RINGS - 1 {
        for side in 0..AROUND {
            let [a, b] = [side, (side + 1) % AROUND].map(|side| ring * AROUND + side);
            triangles.extend([[a, b, a + AROUND], [b, b + AROUND, a + AROUND]]);
        }
    }
    let vertex_count = AROUND * RINGS;
    let topology = Topology::new(vertex_count, triangles, vec![1.0; vertex_count as usize]).unwrap();
    let lengths = [(26, false), (20, true), (18, false)];
    let (mut sequences, mut poses, mut first_frame) = (Vec::new(), Poses::new(vertex_count as usize), 0);
    for (index, (frame_count, cyclic)) in lengths.into_iter().enumerate() {
        let (turn, bend, speed) = (random.range(-0.05, 0.05), random.range(0.1, 0.9), random.range(0.01, 0.05));
        for step in 0..frame_count {
            let time = step as f32;
            let heading = Quat::from_rotation_y(turn * time + index as f32);
            let pose: Vec<Vec3> = (0..RINGS * AROUND)
                .map(|vertex| {
                    let (height, angle) = (0.2 * (vertex / AROUND) as f32, (vertex % AROUND) as f32 * 0.9);
                    let width = 0.3 + 0.1 * (0.5 * time + 2.0 * height).sin();
                    let lean = bend * height * (0.3 * time + index as f32).sin();
                    heading * Vec3::new(width * angle.cos() + lean, height, width * angle.sin())
                        + speed * time * Vec3::Z
                })
                .collect();
            poses.push(&pose);
        }
        sequences.push(Sequence { name: format!("s{index}"), labels: vec![], first_frame, frame_count, cyclic });
        first_frame += frame_count;
    }
    let timeline = Timeline::new(25.0, sequences).unwrap();
    let mut edges: Vec<(u32, u32)> = (0..14)
        .map(|_| (random.below(first_frame as usize) as u32, random.below(first_frame as usize) as u32))
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut transitions = Vec::new();
    for (from, to) in edges {
        let length = 2 + random.below(6) as i64;
        if from == to || timeline.offset(from, length).is_none() || timeline.offset(to, -length).is_none() {
            continue;
        }
        let warp = TemporalWarp::new(vec![Move::Both; length as usize]);
        let mut memory = PoseMemory::default();
        let mut ground = PosesOnGround::new(&mut poses, topology.weights(), &mut memory);
        let placement = transition_placement(&timeline, &mut ground, (from, to), &warp, &Contacts::default()).unwrap();
        transitions.push(Transition { from, to, deformation: random.range(0.05, 0.3), warp, placement, turn: 0.0 });
    }
    let stands = (0..2 * first_frame).map(|_| random.below(3) > 0).collect();
    let feet = Feet::new(feet(), stands, vertex_count as usize, &timeline).unwrap();
    let graph = EssentialGraph::new(0.01, transitions, &timeline).unwrap().with_feet(feet);
    Scene { topology, timeline, graph, poses }
}

/// Both ends of the tube.
fn feet() -> Vec<Vec<FootVertex>> {
    let ring = |ring: u32, leg: u8, sole: u8| {
        (ring * AROUND..(ring + 1) * AROUND).map(move |vertex| FootVertex { vertex, leg, sole })
    };
    vec![ring(0, 255, 255).chain(ring(1, 200, 90)).collect(), ring(7, 120, 0).chain(ring(8, 255, 200)).collect()]
}

/// A change of the route, after so many frames.
struct Change {
    after: usize,
    legs: Vec<Leg>,
}

type Frames = Vec<(FrameInfo, Vec<Vec3>)>;

/// As the page goes: a little at once, changing its mind, looking at where it might go; and the changes of its mind.
fn wandered(scene: &mut Scene, start: (u32, Placement), random: &mut Random) -> (Frames, Vec<Change>, usize) {
    let Scene { topology, timeline, graph, poses } = scene;
    let mut synthesiser = Synthesiser::unprepared(topology);
    synthesiser.begin_walk(graph, timeline, start, &Walk::default()).unwrap();
    synthesiser.warm(topology, None).unwrap();
    let (mut frames, mut changes, mut unfinished) = (Frames::new(), Vec::new(), 0);
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    let some = |random: &mut Random| random.below(timeline.frame_count() as usize) as u32;
    for _ in 0..600 {
        let from = synthesiser.departure(graph).unwrap();
        if random.below(8) == 0
            && let Some(walk) = plan_walk(graph, timeline, from, &[some(random)])
        {
            synthesiser.retarget(graph, timeline, &walk.legs).unwrap();
            changes.push(Change { after: frames.len(), legs: walk.legs });
        }
        if random.below(3) == 0
            && let Some(walk) = plan_walk(graph, timeline, from, &[some(random)])
        {
            for _ in 0..random.below(4) {
                synthesiser.prepare_for(graph, timeline, poses, &walk.legs).unwrap();
            }
        }
        if random.below(4) == 0 {
            synthesiser.prepare(graph, timeline, poses).unwrap();
        }
        let mut factorisations = random.below(2) as u32;
        match synthesiser.next_frame_within(&mut factorisations, graph, timeline, poses, &mut pose).unwrap() {
            Made::Frame(info) => frames.push((info, pose.clone())),
            Made::Unfinished => unfinished += 1,
            Made::Arrived => {}
        }
    }
    (frames, changes, unfinished)
}

/// As a film is made: nothing ahead, everything at once.
fn filmed(scene: &mut Scene, start: (u32, Placement), changes: &[Change], count: usize) -> Frames {
    let Scene { topology, timeline, graph, poses } = scene;
    let mut synthesiser = Synthesiser::new(topology, None).unwrap();
    synthesiser.begin_walk(graph, timeline, start, &Walk::default()).unwrap();
    let (mut frames, mut changes) = (Frames::new(), changes.iter().peekable());
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    while frames.len() < count {
        while let Some(change) = changes.next_if(|change| change.after == frames.len()) {
            synthesiser.retarget(graph, timeline, &change.legs).unwrap();
        }
        let info = synthesiser.next_frame(graph, timeline, poses, &mut pose).unwrap().unwrap();
        frames.push((info, pose.clone()));
    }
    frames
}

#[test]
fn frames_are_those_of_a_film_whatever_was_made_ahead() {
    let (mut nodes, mut waits, mut turns, mut back) = (0, 0, 0, 0);
    for seed in 0..40 {
        let mut scene = scene(seed);
        let mut random = Random::new(seed + 1000);
        let placement = Placement { heading: random.range(-3.0, 3.0), translation: glam::Vec2::new(1.0, -2.0) };
        let start = (random.below(60) as u32, placement);
        let (page, changes, unfinished) = wandered(&mut scene, start, &mut random);
        let film = filmed(&mut scene, start, &changes, page.len());
        for (step, ((page, pose), (film, wanted))) in page.iter().zip(&film).enumerate() {
            let told = |info: &FrameInfo| (info.kind, info.placement, info.leg);
            assert_eq!(told(page), told(film), "seed {seed}, frame {step}");
            let same =
                pose.iter().zip(wanted).all(|(a, b)| a.to_array().map(f32::to_bits) == b.to_array().map(f32::to_bits));
            assert!(same, "seed {seed}, frame {step}: {page:?} is not as filmed: {film:?}");
        }
        nodes += page.iter().filter(|(info, _)| info.kind.is_synthetic()).count();
        let inside = |change: &&Change| change.after > 0 && page[change.after - 1].0.kind.is_synthetic();
        turns += changes.iter().filter(inside).count();
        back += changes.iter().flat_map(|change| &change.legs).filter(|leg| matches!(leg, Leg::Back { .. })).count();
        waits += unfinished;
    }
    // The test is about something.
    assert!(
        nodes > 1000 && waits > 100 && turns > 20 && back > 20,
        "{nodes} nodes, {waits} waits, {turns} turns, {back}"
    );
}
