//! The player on a small capture in memory.

use actor::alternatives::{Alternatives, Stretch};
use actor::blend::transition_placement;
use actor::capture::{Capture, Poses};
use actor::contacts::Contacts;
use actor::files::Files;
use actor::graph::{EssentialGraph, Transition};
use actor::ground::{PoseMemory, PosesOnGround};
use actor::surface::{Corner, Material, Part, Surface};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use bundle::{
    AppearanceInput, AppearanceQuality, BundleInput, Extras, Textures, encode, encode_with_appearance,
    encode_with_extras,
};
use glam::{Quat, Vec3};
use kernels::align::Placement;
use kernels::topology::Topology;
use search::{Goal, PathRequest, Progress, Request, RequestError, Start, Target};
use searcher::scene::Known;
use searcher::searcher::{Origin, SearchError, Searcher};
use synthesis::FrameKind;
use texture::TextureModel;

use super::events::Event;
use super::loading::{Loading, Phase};
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
    let warp = TemporalWarp::new(vec![Move::Both; 2]);
    Some(Transition { from, to, deformation: 0.125, warp, placement: Placement::IDENTITY, turn: 0.0 })
}

const CORNERS: [Vec3; 4] =
    [Vec3::new(0.3, 0.0, 0.0), Vec3::new(-0.2, 0.0, 0.3), Vec3::new(-0.2, 0.0, -0.3), Vec3::new(0.0, 1.8, 0.0)];

/// A tetrahedron that walks 1 cm a frame, turning a little; in every sequence from the same place, leaning more.
pub fn capture(sequences: &[(u32, bool)], edges: &[(u32, u32)]) -> (Capture, EssentialGraph) {
    let timeline = timeline(sequences);
    let triangles = vec![[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
    let mut poses = Poses::new(4);
    for (index, sequence) in timeline.sequences().iter().enumerate() {
        let lean = Quat::from_rotation_z(0.2 * index as f32);
        for step in 0..sequence.frame_count {
            let turn = Quat::from_rotation_y(0.01 * step as f32);
            poses.push(&CORNERS.map(|p| turn * (lean * p) + Vec3::X * 0.01 * step as f32));
        }
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
    let mut capture = Capture {
        name: "tetrahedron".into(),
        topology: Topology::new(4, triangles, vec![1.0; 4]).unwrap(),
        surface,
        timeline,
        poses,
        vertex_of_file_vertex: vec![0, 1, 2, 3],
    };
    let mut transitions: Vec<_> = edges.iter().map(|&(from, to)| jump(&capture.timeline, from, to).unwrap()).collect();
    for transition in &mut transitions {
        let mut memory = PoseMemory::default();
        let mut ground = PosesOnGround::new(&mut capture.poses, capture.topology.weights(), &mut memory);
        let ends = (transition.from, transition.to);
        transition.placement =
            transition_placement(&capture.timeline, &mut ground, ends, &transition.warp, &Contacts::default()).unwrap();
    }
    let graph = EssentialGraph::new(0.01, transitions, &capture.timeline).unwrap();
    (capture, graph)
}

fn player(sequences: &[(u32, bool)], edges: &[(u32, u32)]) -> Player {
    let (capture, graph) = capture(sequences, edges);
    Player::of_capture(capture, graph)
}

/// The largest distance that a vertex goes from one pose to another.
fn largest_step(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
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
    let [two, three] = [2, 3].map(|frame| player.recorded_pose(frame).unwrap());
    let pose = player.picture().unwrap().pose();
    assert!(pose[3].distance((two[3] + three[3]) / 2.0) < 1e-6);
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
    assert_eq!((plan.legs.len(), plan.frames), (3, 4 + 2 + 1));
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
fn quickness_weighs_time_and_is_taken_back() {
    let (capture, graph) = capture(&[(40, false), (40, false)], &[(3, 45), (10, 70), (60, 20)]);
    let own = graph.alpha();
    let mut player = Player::of_capture(capture, graph);
    let smooth = player.plan(75).unwrap();
    player.set_quickness(0.2).unwrap();
    let quick = player.plan(75).unwrap();
    assert!(quick.cost > smooth.cost);
    assert_eq!(player.info().map(|info| serde_json::to_value(&info).unwrap()["alpha"].as_f64()), Some(Some(own)));
    let planned = player.plans();
    // What makes no sense changes nothing, and planned is planned.
    player.set_quickness(f64::INFINITY).unwrap();
    assert_eq!((player.plan(75).unwrap(), player.plans()), (quick, planned));
    player.set_quickness(0.0).unwrap();
    assert_eq!(player.plan(75).unwrap(), smooth);
}

/// A player of a bundle with one stretch of five frames, of which three alternatives move one corner up by 5, 10 and 15 mm.
fn varied_player() -> Player {
    let (capture, graph) = capture(&[(20, true), (20, false)], &[(15, 30), (35, 10)]);
    let modes = vec![vec![[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 127, 0]]];
    let rows = |most: i16| vec![most / 2, most, most, most / 2];
    let stretch =
        Stretch { first: 4, last: 9, headings: vec![0; 4], coefficients: vec![rows(50), rows(100), rows(150)] };
    let all = Alternatives::new(modes, vec![stretch], 4, &capture.timeline).unwrap();
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 1e-4,
        poisson_order: None,
        generator: "test".into(),
    };
    let mut extras = Extras::default();
    extras.alternatives = Some(&all);
    let (bytes, _) = encode_with_extras(&input, &[], &Files::default(), &extras).unwrap();
    let mut player = Player::new(Loading::default(), || 0.0);
    player.push(&bytes).unwrap();
    player
}

/// How far up the last corner is from where it was recorded, and which alternative is said to be shown, for so many frames.
fn shown_heights(player: &mut Player, frames: u32) -> Vec<(u32, i32, Option<usize>)> {
    let mut shown = Vec::new();
    for _ in 0..frames {
        player.tick(0.04);
        let picture = player.picture().unwrap();
        let frame = picture.before.kind.frame();
        let height = picture.before.pose[3].y;
        let number = player.state().unwrap().alternative;
        let recorded = player.recorded_pose(frame).unwrap()[3].y;
        shown.push((frame, ((height - recorded) * 1e3).round() as i32, number));
    }
    shown
}

#[test]
fn recorded_stretches_vary() {
    let mut player = varied_player();
    player.set_loop(true);
    player.play();
    let shown = shown_heights(&mut player, 600);
    let peaks: Vec<i32> = shown.iter().filter(|(frame, ..)| *frame == 7).map(|(_, height, _)| *height).collect();
    // Mixed of two of 5, 10 and 15 mm, on either side.
    assert!(peaks.len() > 6 && peaks.iter().all(|height| height.abs() <= 19), "{peaks:?}");
    let mut unlike = peaks.clone();
    unlike.sort_unstable();
    unlike.dedup();
    assert!(2 * unlike.len() > peaks.len() && unlike[0] < 0 && unlike.last() > Some(&0), "{peaks:?}");
    assert!(
        shown.iter().all(|(frame, height, _)| (5..9).contains(frame) || *height == 0),
        "outside it is the recording"
    );
    // Another player shows the same of the same walk.
    let mut again = varied_player();
    again.set_loop(true);
    again.play();
    assert_eq!(shown_heights(&mut again, 600), shown);
}

#[test]
fn variety_is_taken_back_by_its_amount_by_seeking_and_by_edits() {
    let mut player = varied_player();
    player.set_loop(true);
    player.set_variety(0.0);
    player.play();
    assert!(shown_heights(&mut player, 60).iter().all(|(_, height, number)| *height == 0 && number.is_none()));
    player.set_variety(1.0);
    while !(player.alternative().is_some() && player.picture().unwrap().before.kind.frame() == 6) {
        player.tick(0.04);
    }
    player.seek(7.0).unwrap();
    assert_eq!(player.alternative(), None);
    let recorded = player.recorded_pose(7).unwrap();
    assert_eq!(player.picture().unwrap().before.pose[3].y, recorded[3].y);
    player.set_edited(15, Some(recorded)).unwrap();
    player.play();
    let shown = shown_heights(&mut player, 100);
    assert!(shown.iter().all(|(frame, height, _)| *frame == 15 || *height == 0), "edits are of the recording");
    // What makes no number is none.
    player.set_variety(f64::NAN);
}

#[test]
fn what_is_looked_at_and_clicked_is_planned_once() {
    let mut player = player(&[(12, false), (12, false), (8, false)], &[(4, 18)]);
    assert_eq!(player.plans(), 0);
    let seen = player.plan(21).unwrap();
    let foreseen = player.arrival(21).unwrap();
    let ghost = player.ghost(21).unwrap();
    assert_eq!(player.go_to(21).unwrap(), seen);
    assert_eq!(player.plans(), 1);
    run(&mut player);
    assert!(largest_step(&ghost, &player.picture().unwrap().pose()) < 1e-5);
    // From elsewhere it is another plan, and so is what cannot be reached: once.
    for _ in 0..3 {
        assert_eq!(player.plan(26), Err(PlayerError::Unreachable { from: 21, to: 26 }));
        player.arrival(26).unwrap_err();
        player.arrival(19).unwrap();
    }
    assert_eq!(player.plans(), 3);
    // Where it stands has no part in it but for where it arrives.
    player.stand(0, glam::Vec2::new(5.0, 0.0), 0.0).unwrap();
    let moved = player.arrival(21).unwrap();
    assert_eq!(player.plans(), 3);
    assert!(moved.translation.distance(foreseen.translation) > 1.0);
    player.stand(0, glam::Vec2::new(5.0, 0.0), 1.0).unwrap();
    assert!((player.arrival(21).unwrap().heading - moved.heading - 1.0).abs() < 1e-4);
}

#[test]
fn the_nearest_frame_of_a_behaviour_is_the_cheapest_of_all() {
    let edges = [(4, 18), (6, 27), (20, 6), (30, 15)];
    for start in [0.0, 4.0, 5.0, 14.0, 20.0, 25.0] {
        let mut player = player(&[(12, false), (12, false), (10, false)], &edges);
        player.seek(start).unwrap();
        for (name, frames) in [("s0", 0..12), ("s12", 12..24), ("s24", 24..34)] {
            let before = player.plans();
            let nearest = player.nearest(name);
            assert_eq!(player.plans(), before + 1);
            let costs: Vec<_> = frames.map(|to| player.plan(to).map_or(f64::INFINITY, |plan| plan.cost)).collect();
            let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
            let nearest = nearest.unwrap();
            let before = player.plans();
            assert_eq!(player.go_to(nearest).unwrap().cost, least, "{name} from {start}");
            assert_eq!(player.plans(), before);
            player.seek(start).unwrap();
        }
        let unknown = player.nearest("flying").unwrap_err();
        assert_eq!(unknown.to_string(), r#"there is no behaviour "flying"; there are: s0, s12, s24"#);
    }
}

#[test]
fn leaves_a_trail() {
    let mut player = player(&[(40, false)], &[]);
    player.go_to(30).unwrap();
    run(&mut player);
    let trail: Vec<_> = player.trail().collect();
    assert_eq!(trail.len(), 31);
    assert!(trail.windows(2).all(|pair| pair[0].time < pair[1].time && !pair[1].starts));
}

#[test]
fn a_walk_through_a_transition_arrives_where_it_was_foreseen() {
    let mut player = player(&[(12, false), (12, false)], &[(4, 18)]);
    let foreseen = player.arrival(21).unwrap();
    let plan = player.go_to(21).unwrap();
    assert_eq!((plan.transitions, plan.frames), (1, 4 + 2 + 3));
    let mut events = Vec::new();
    let mut before = player.picture().unwrap().pose();
    while player.playing() {
        player.tick(0.01);
        events.extend(player.take_events());
        let now = player.picture().unwrap().pose();
        assert!(largest_step(&before, &now) < 0.06, "a pop");
        before = now;
    }
    let passed = [
        Event::TransitionStart { from: 4, to: 18 },
        Event::TransitionEnd { from: 4, to: 18 },
        Event::Arrive { frame: 21 },
    ];
    assert_eq!(events, passed);
    let mut target = player.recorded_pose(21).unwrap();
    foreseen.apply_all(&mut target);
    assert!(largest_step(&target, &before) < 1e-5);
    assert!(player.trail().any(|point| point.synthetic));
}

#[test]
fn a_transition_under_way_is_finished_when_the_mind_changes() {
    let mut player = player(&[(12, false), (12, false)], &[(4, 18)]);
    player.seek(4.0).unwrap();
    player.go_to(22).unwrap();
    player.tick(0.02);
    assert!(player.state().unwrap().transition.is_none(), "one factorisation a tick");
    player.tick(0.02);
    assert!(player.state().unwrap().transition.is_some());
    assert_eq!(player.state().unwrap().mode, "synthetic");
    let foreseen = player.arrival(19).unwrap();
    let plan = player.go_to(19).unwrap();
    assert_eq!(plan.frames, 1);
    assert_eq!(player.state().unwrap().walk.unwrap().len(), 2);
    assert_eq!(run(&mut player).last(), Some(&Event::Arrive { frame: 19 }));
    let mut target = player.recorded_pose(19).unwrap();
    foreseen.apply_all(&mut target);
    assert!(largest_step(&target, &player.picture().unwrap().pose()) < 1e-5);

    player.seek(4.0).unwrap();
    player.go_to(22).unwrap();
    player.tick(0.02);
    player.cancel();
    assert_eq!(player.state().unwrap().target, None);
    assert_eq!(run(&mut player).last(), Some(&Event::TransitionEnd { from: 4, to: 18 }));
    assert_eq!(frame(&player), 18.0);
}

#[test]
fn playing_on_goes_round_through_the_graph() {
    let mut player = player(&[(12, false), (12, false)], &[(4, 18), (8, 3), (20, 6)]);
    player.play();
    let mut transitions = 0;
    for _ in 0..600 {
        player.tick(0.02);
        for event in player.take_events() {
            assert!(matches!(event, Event::TransitionStart { .. } | Event::TransitionEnd { .. }), "{event:?}");
            transitions += 1;
        }
    }
    assert!(player.playing() && transitions > 10);
}

#[test]
fn a_cyclic_sequence_walks_on_across_its_wrap() {
    let mut player = player(&[(10, true)], &[]);
    player.play();
    let start = player.ground().unwrap();
    let mut before = start;
    for _ in 0..200 {
        player.tick(0.02);
        let now = player.ground().unwrap();
        assert!(before.distance(now) < 0.02);
        before = now;
    }
    assert!(player.take_events().is_empty());
    assert!(player.state().unwrap().frame < 10.0);
}

#[test]
fn a_bundle_plays_as_far_as_it_has_arrived() {
    let (capture, graph) = capture(&[(200, false), (12, false)], &[(4, 206)]);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 1e-4,
        poisson_order: None,
        generator: "test".into(),
    };
    let (bytes, _) = encode(&input).unwrap();
    let mut player = Player::new(Loading::default(), || 0.0);
    assert!(player.picture().is_none() && !player.tick(0.1));
    assert_eq!(player.go_to(3), Err(PlayerError::NotLoaded));
    let mut pushed = 0;
    let mut phases = vec![player.loading().phase()];
    let mut stalled = false;
    for chunk in bytes.chunks(64) {
        player.push(chunk).unwrap();
        pushed += chunk.len();
        let phase = player.loading().phase();
        if phases.last() != Some(&phase) {
            phases.push(phase);
        }
        if player.picture().is_some() {
            player.set_loop(false);
            player.play();
            for _ in 0..20 {
                player.tick(0.1);
            }
            stalled |= player.take_events().iter().any(|event| matches!(event, Event::Stall { .. }));
        }
    }
    assert_eq!(pushed, bytes.len());
    assert_eq!((phases.first(), phases.last()), (Some(&Phase::Empty), Some(&Phase::Complete)));
    assert!(phases.contains(&Phase::FirstPose) || phases.contains(&Phase::Partial), "{phases:?}");
    assert!(stalled && player.loading().finish().is_ok());
    player.take_events();
    player.seek(0.0).unwrap();
    player.go_to(208).unwrap();
    assert_eq!(run(&mut player).last(), Some(&Event::Arrive { frame: 208 }));
    let damaged: Vec<_> = bytes.iter().enumerate().map(|(k, byte)| byte ^ u8::from(k == bytes.len() / 2)).collect();
    assert!(Player::new(Loading::default(), || 0.0).push(&damaged).is_err());
}

/// The cheapest walk between two frames of the capture that `player` plays.
fn walk_between(sequences: &[(u32, bool)], edges: &[(u32, u32)], from: u32, to: u32) -> actor::walk::Walk {
    let timeline = timeline(sequences);
    let (_, graph) = capture(sequences, edges);
    search::cheapest_walk(&graph, &timeline, from, to).unwrap()
}

#[test]
fn follows_a_walk_that_a_search_found_and_goes_on_with_the_next_without_a_stop() {
    let (sequences, edges) = ([(12, false), (12, false)], [(4, 18), (20, 2)]);
    let mut player = player(&sequences, &edges);
    let (start, placement) = player.leaves().unwrap();
    assert_eq!((start, placement), (0, Placement::IDENTITY));
    let out = walk_between(&sequences, &edges, 0, 19);
    assert_eq!(player.follow(3, &out), Err(PlayerError::Unreachable { from: 0, to: 3 }));
    assert!(player.follow(0, &actor::walk::Walk::default()).is_err());
    assert_eq!(player.follow(0, &out).unwrap().to, 19);
    player.tick(0.05);
    let back = walk_between(&sequences, &edges, 19, 6);
    assert!(!player.extend(5, &back));
    assert!(player.extend(19, &back));
    let events = run(&mut player);
    let passed = [
        Event::TransitionStart { from: 4, to: 18 },
        Event::TransitionEnd { from: 4, to: 18 },
        Event::TransitionStart { from: 20, to: 2 },
        Event::TransitionEnd { from: 20, to: 2 },
        Event::Arrive { frame: 6 },
    ];
    assert_eq!(events, passed);
    assert!(!player.extend(6, &back), "nothing is under edge");
}

#[test]
fn stands_where_it_is_told() {
    let mut player = player(&[(12, false)], &[]);
    player.go_to(8).unwrap();
    player.stand(5, glam::Vec2::new(2.0, -3.0), 0.7).unwrap();
    assert!(player.ground().unwrap().distance(glam::Vec2::new(2.0, -3.0)) < 1e-6);
    let state = player.state().unwrap();
    assert_eq!((state.frame, state.target, state.mode), (5.0, None, "paused"));
    assert!((state.heading - 0.7).abs() < 1e-6);
    assert_eq!(player.stand(99, glam::Vec2::ZERO, 0.0), Err(PlayerError::NoFrame(99)));
    assert!(player.stand(3, glam::Vec2::NAN, 0.0).is_err());
    assert!(player.ground().unwrap().distance(glam::Vec2::new(2.0, -3.0)) < 1e-6);
}

#[test]
fn paths_are_followed_by_the_vertices_asked_for() {
    let mut player = player(&[(20, false), (12, false)], &[(4, 26), (28, 6)]);
    let path = |vertices: &[u32]| {
        let points = vec![vec![0.0, 0.0], vec![0.15, 0.0]];
        // Not bent onto it: where the vertices are in the second frame is to be known.
        let path = PathRequest { points, vertices: vertices.to_vec(), exactness: 0.0, ..PathRequest::default() };
        Request::new(Target::Path(path))
    };
    let known = Known::from_words(player.known(1e9).unwrap().unwrap()).unwrap();
    let mut searcher = Searcher::new(known).unwrap();
    assert_eq!(searcher.follows(&[2, 4]), Err(SearchError::Request(RequestError::UnknownVertex(4))));
    assert_eq!(player.middles(&[2, 4], 1e9), Err(PlayerError::NoVertex(4)));
    let (frame, placement) = player.leaves().unwrap();
    for group in [&[][..], &[3], &[0, 1], &[]] {
        searcher.follow(group, player.middles(group, 1e9).unwrap().unwrap()).unwrap();
        assert!(searcher.prepare(|| false).unwrap());
        searcher.begin(&path(group), Origin::Here(Start { frame, placement })).unwrap();
        while searcher.advance(|| false).unwrap() == Progress::Running {}
        let report = searcher.report().unwrap();
        let Goal::Path(found) = &report.answer.parts[0].goal else { panic!("{report:?}") };
        let [_, x, _, z] = found.track[0];
        // Where they are in the second frame, as the capture was made.
        let turn = Quat::from_rotation_y(0.01);
        let weights = player.actor().unwrap().topology.weights().to_vec();
        let middle = match group {
            [] => kernels::align::centre_of_mass(&CORNERS.map(|p| turn * p), &weights),
            _ => group.iter().map(|&vertex| turn * CORNERS[vertex as usize]).sum::<Vec3>() / group.len() as f32,
        } + 0.01 * Vec3::X;
        assert!((x - middle.x).abs() + (z - middle.z).abs() < 1e-3, "{group:?}: {x} {z} {middle}");
        // Prepared for one group, no other can be asked for.
        assert!(searcher.begin(&path(&[1]), Origin::Anywhere).is_err());
        assert_eq!(searcher.report().err(), Some(SearchError::Nothing));
    }
}

/// Models of one texel whose only mode's coefficient is the frame's number, for colours and for warps.
fn numbered_looks(frame_count: u32) -> TextureModel {
    TextureModel {
        width: 1,
        height: 1,
        active: vec![true],
        mean_texture: vec![0.5; 3],
        textures: vec![vec![1.0, 0.0, 0.0]],
        mean_warp: vec![0.0; 2],
        warps: vec![vec![0.0, 1.0]],
        texture_coefficients: (0..frame_count).map(|frame| frame as f32).collect(),
        warp_coefficients: (0..frame_count).map(|frame| 2.0 * frame as f32).collect(),
    }
}

#[test]
fn coefficients_are_interpolated_as_the_shape_is() {
    let (capture, graph) = capture(&[(20, false), (12, false)], &[(4, 26)]);
    let input = BundleInput {
        capture: &capture,
        graph: &graph,
        first_frame: 0,
        max_error: 1e-4,
        poisson_order: None,
        generator: "test".into(),
    };
    let model = numbered_looks(32);
    let looks = AppearanceInput { model: &model, material: 0, quality: AppearanceQuality::default() };
    let (bytes, _) = encode_with_appearance(&input, Some(&looks)).unwrap();
    let mut player = Player::new(Loading::default(), || 0.0);
    player.push(&bytes).unwrap();
    assert!(!player.refine(1e9).unwrap());
    assert_eq!([player.modes(Textures::Aligned)[0].len(), player.modes(Textures::Aligned)[1].len()], [2, 2]);
    let layers = player.appearance(Textures::Aligned).unwrap().layers.clone();
    // The coefficient of the only mode: its weight, without its step.
    let coefficient = |weights: &[f32], layer: usize| weights[1] / layers[layer].steps[1];
    player.go_to(28).unwrap();
    let mut in_transition = 0;
    for _ in 0..600 {
        player.tick(0.01);
        let picture = player.picture().unwrap();
        let mixed = |kind: FrameKind| match kind {
            FrameKind::Recorded { frame } => frame as f32,
            FrameKind::Synthetic { source_frame, destination_frame, lambda, .. } => {
                source_frame as f32 + (destination_frame as f32 - source_frame as f32) * lambda
            }
        };
        let weight = picture.weight as f32;
        let wanted = mixed(picture.before.kind) * (1.0 - weight) + mixed(picture.after.kind) * weight;
        for layer in 0..2 {
            let own = coefficient(&picture.weights(&layers[layer]), layer);
            assert!((own - wanted * (layer + 1) as f32).abs() < 0.1, "{own} {wanted} {picture:?}");
            let ([source, destination], lambda) = picture.ends(&layers[layer]);
            let [source, destination] = [source, destination].map(|weights| coefficient(&weights, layer));
            assert!((0.0..=1.0).contains(&lambda));
            if picture.before.kind.is_synthetic() || picture.after.kind.is_synthetic() {
                in_transition += 1;
                // Each side is one texture, that of its own sequence.
                let sequence = 20.0 * (layer + 1) as f32;
                assert!(source < sequence && destination >= sequence - 0.1, "{source} {destination}");
            } else {
                assert!((source - own).abs() < 1e-3 && (destination - own).abs() < 1e-3);
            }
        }
    }
    assert!(in_transition > 4);
}

#[test]
fn frames_that_are_given_come_before_the_route() {
    let mut player = player(&[(20, false), (20, false)], &[(15, 25), (35, 5)]);
    player.seek(3.0).unwrap();
    let pose = |height: f32| CORNERS.map(|corner| corner + Vec3::Y * height).to_vec();
    assert_eq!(player.give(pose(1.0), [0; 2], 0.0, 0.0), [0, 0], "nothing is expected");
    let home = Placement { heading: 0.0, translation: glam::Vec2::new(5.0, 0.0) };
    assert_eq!(player.expect(99, home, 2), Err(PlayerError::NoFrame(99)));
    player.expect(30, home, 3).unwrap();
    assert_eq!(player.leaves().unwrap(), (30, home));
    assert!(player.hold().is_none(), "a frame that is none of the actor's own is edited");
    player.tick(0.1);
    assert_eq!(player.state().unwrap().frame, 3.0, "it goes on before the first frame is there");
    assert_eq!(player.give(Vec::new(), [0; 2], 0.0, 0.0), [0, 3]);
    assert_eq!(player.give(pose(1.0), [3, 7], 0.5, 0.0), [1, 2]);
    player.go_to(33).unwrap();
    player.give(pose(2.0), [7, 7], 0.0, 0.3);
    player.give(pose(3.0), [30, 30], 0.0, 0.0);
    let mut shown = Vec::new();
    while player.playing() {
        player.tick(0.04);
        let picture = player.picture().unwrap();
        shown.push((picture.before.kind.frame(), picture.before.kind.is_synthetic(), picture.before.pose[3].y));
        assert!(shown.len() < 20, "{shown:?}");
    }
    let heights: Vec<f32> = shown.iter().map(|(_, _, y)| y.round()).collect();
    assert!(heights.windows(3).any(|three| three == [3.0, 4.0, 5.0]), "{shown:?}");
    assert!(shown.contains(&(7, true, 2.8)) && shown.contains(&(7, false, 3.8)), "{shown:?}");
    assert_eq!(player.state().unwrap().frame, 33.0);
    let x = player.picture().unwrap().pose()[3].x;
    assert!((x - 5.0).abs() < 0.5, "it stands at {x}, not where it was to go on");

    // Whoever looks at another pose leaves them.
    player.expect(30, home, 3).unwrap();
    player.give(pose(1.0), [3, 7], 0.5, 0.0);
    player.seek(5.0).unwrap();
    assert_eq!(player.give(pose(1.0), [3, 7], 0.5, 0.0), [0, 0]);
    assert_eq!(player.state().unwrap().frame, 5.0);
}
