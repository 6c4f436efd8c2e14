//! The player on a small capture in memory.

use glam::{Vec2, Vec3};
use shared::align::Placement;
use shared::capture::{Capture, Poses};
use shared::graph::{EssentialGraph, Transition};
use shared::surface::{Corner, Material, Part, Surface};
use shared::timeline::{Sequence, Timeline};
use shared::topology::Topology;
use shared::warp::{Move, Warp};

use super::events::Event;
use super::{Player, PlayerError};

/// A timeline of 25 frames per second with sequences of these lengths, cyclic or not.
pub fn timeline(sequences: &[(u32, bool)]) -> Timeline {
    let mut first_frame = 0;
    let mut list = Vec::new();
    for &(frame_count, cyclic) in sequences {
        list.push(Sequence { name: format!("s{first_frame}"), labels: vec![], first_frame, frame_count, cyclic });
        first_frame += frame_count;
    }
    Timeline::new(25.0, list).unwrap()
}

/// A transition of three frames, where both segments lie in their sequences.
pub fn jump(timeline: &Timeline, from: u32, to: u32) -> Option<Transition> {
    timeline.offset(from, 2)?;
    timeline.offset(to, -2)?;
    let warp = Warp::new(vec![Move::Both; 2]);
    Some(Transition { from, to, deformation: 0.125, warp, placement: Placement::IDENTITY })
}

const CORNERS: [Vec3; 4] =
    [Vec3::new(0.3, 0.0, 0.0), Vec3::new(-0.2, 0.0, 0.3), Vec3::new(-0.2, 0.0, -0.3), Vec3::new(0.0, 1.8, 0.0)];

/// A tetrahedron that walks 1 cm a frame in the direction of +X.
fn player(sequences: &[(u32, bool)], edges: &[(u32, u32)]) -> Player {
    let timeline = timeline(sequences);
    let triangles = vec![[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
    let mut poses = Poses::new(4);
    for frame in 0..timeline.frame_count() {
        poses.push(&CORNERS.map(|p| p + Vec3::X * 0.01 * frame as f32));
    }
    let corner = |vertex| Corner { vertex, uv: [0.0; 2], colour: [255; 4] };
    let material = Material { name: String::new(), base_colour: [1.0; 4], image: None, double_sided: false };
    let surface = Surface {
        corners: (0..4).map(corner).collect(),
        triangles: triangles.clone(),
        parts: vec![Part { material: 0, first_triangle: 0, triangle_count: 4 }],
        materials: vec![material],
        images: vec![],
    };
    let transitions = edges.iter().map(|&(from, to)| jump(&timeline, from, to).unwrap()).collect();
    let graph = EssentialGraph::new(0.01, transitions, &timeline).unwrap();
    let capture = Capture {
        name: "tetrahedron".into(),
        topology: Topology::new(4, triangles, vec![1.0; 4]).unwrap(),
        surface,
        timeline,
        poses,
        vertex_of_file_vertex: vec![0, 1, 2, 3],
    };
    Player::of_capture(capture, graph)
}

/// Ticks until the actor stands; all events on the way.
fn run(player: &mut Player) -> Vec<Event> {
    let mut events = Vec::new();
    for _ in 0..5000 {
        player.tick(1.0 / 60.0);
        events.extend(player.take_events());
        if !player.playing() {
            return events;
        }
    }
    panic!("the actor never stands still");
}

fn frame(player: &Player) -> f64 {
    player.state().unwrap().frame
}

#[test]
fn stands_at_the_first_pose_and_nothing_changes() {
    let mut player = player(&[(10, false)], &[]);
    assert!(player.tick(0.0), "the first picture");
    for _ in 0..10 {
        assert!(!player.tick(0.1));
    }
    let state = player.state().unwrap();
    assert_eq!((state.frame, state.mode, state.target), (0.0, "paused", None));
    assert_eq!(player.picture().unwrap().pose(), CORNERS);
}

#[test]
fn plays_at_the_rate_of_the_capture_between_the_frames() {
    let mut player = player(&[(30, false)], &[]);
    player.set_loop(false);
    player.play();
    player.tick(0.1);
    assert!((frame(&player) - 2.5).abs() < 1e-9);
    let pose = player.picture().unwrap().pose();
    assert!(pose[3].distance(CORNERS[3] + Vec3::X * 0.025) < 1e-6);
    player.pause();
    assert!(!player.tick(0.1));
    player.set_speed(2.0);
    player.play();
    player.tick(0.1);
    assert!((frame(&player) - 7.5).abs() < 1e-9);
}

#[test]
fn arrives_exactly_and_says_so() {
    let mut player = player(&[(30, false)], &[]);
    let plan = player.go_to(17).unwrap();
    assert_eq!((plan.frames, plan.transitions), (17, 0));
    assert_eq!(run(&mut player), [Event::Arrive { frame: 17 }]);
    let picture = player.picture().unwrap();
    assert_eq!((frame(&player), picture.weight), (17.0, 0.0));
    assert_eq!(player.go_to(17).unwrap().frames, 0);
    assert_eq!(player.take_events(), [Event::Arrive { frame: 17 }]);
    assert!(!player.playing());
}

#[test]
fn stops_at_the_end_of_a_sequence_without_loop() {
    let mut player = player(&[(10, false), (10, false)], &[(2, 15)]);
    player.set_loop(false);
    player.play();
    assert_eq!(run(&mut player), [Event::End { frame: 9 }]);
    assert_eq!(frame(&player), 9.0);
}

#[test]
fn never_gets_stuck_with_loop() {
    let mut player = player(&[(10, false)], &[]);
    player.play();
    let mut ends = 0;
    for _ in 0..200 {
        player.tick(0.02);
        ends += player.take_events().iter().filter(|event| matches!(event, Event::End { .. })).count();
    }
    assert!(player.playing() && ends == 0);
}

#[test]
fn walks_back_out_of_a_dead_end() {
    let mut player = player(&[(10, false), (10, false)], &[(5, 15)]);
    player.seek(9.0).unwrap();
    let plan = player.plan(16).unwrap();
    assert_eq!((plan.legs.len(), plan.frames), (3, 4 + 3 + 1));
    assert_eq!(player.plan(3).unwrap().legs.len(), 1);
    player.seek(12.0).unwrap();
    assert_eq!(player.plan(3), Err(PlayerError::Unreachable { from: 12, to: 3 }));
    assert_eq!(player.plan(20), Err(PlayerError::NoFrame(20)));
}

#[test]
fn seeking_stays_where_the_actor_stands() {
    let mut player = player(&[(10, false), (10, false)], &[]);
    player.seek(3.0).unwrap();
    let here = player.ground().unwrap();
    for target in [7.3, 2.9, 18.5, 4.0, 19.0, 0.25] {
        player.seek(target).unwrap();
        assert!((frame(&player) - target).abs() < 1e-9);
        assert!(player.ground().unwrap().distance(here) < 1e-6);
    }
    player.seek(1e9).unwrap();
    assert_eq!(frame(&player), 19.0);
    player.seek(f64::NAN).unwrap();
    assert_eq!(frame(&player), 0.0);
}

#[test]
fn changing_its_mind_does_not_jump() {
    let mut player = player(&[(40, false)], &[]);
    player.go_to(30).unwrap();
    player.tick(0.1);
    let before = player.picture().unwrap().pose();
    let plan = player.go_to(20).unwrap();
    assert_eq!(plan.frames, 17);
    assert_eq!(player.picture().unwrap().pose(), before);
    assert_eq!(run(&mut player), [Event::Arrive { frame: 20 }]);
}

#[test]
fn cancelling_stands_still_between_frames() {
    let mut player = player(&[(40, false)], &[]);
    player.go_to(30).unwrap();
    player.tick(0.1);
    player.cancel();
    assert!(!player.tick(0.1));
    assert!((frame(&player) - 2.5).abs() < 1e-9);
    assert_eq!(player.state().unwrap().target, None);
}

#[test]
fn leaves_a_trail() {
    let mut player = player(&[(40, false)], &[]);
    player.go_to(30).unwrap();
    run(&mut player);
    let trail: Vec<_> = player.trail().collect();
    assert_eq!(trail.len(), 31);
    assert!(trail[30].ground.distance(trail[0].ground + Vec2::X * 0.3) < 1e-5);
}
