//! Searches against their oracles on small graphs, bounds that must not lie, walks that must be in the graph.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod common;

use actor::walk::{Leg, steps_of};
use common::{random_scene, small_scene};
use fixtures::Random;
use glam::{Vec2, Vec3};
use kernels::align::Placement;
use proptest::prelude::*;
use search::{
    Anytime, Chain, Curve, Demand, Direction, Found, Goal, GroundPose, KeyLeg, LegEnd, Measure, Optimiser, PathRequest,
    PathTask, PlaceRequest, PlaceTask, Progress, Request, SearchGraph, Shape, Start, State, Target, Task,
    WanderRequest, cheapest_walk, depth_first, edges_looked_at, holding_loop, main_component, to_targets, walk_down,
};

/// Runs a search to its end.
fn finish(task: &impl Task, search_graph: &SearchGraph) -> (Anytime, Progress) {
    let mut search = Anytime::new(task, search_graph);
    for _ in 0..100_000 {
        if search.advance(task, search_graph, 1000) != Progress::Running {
            break;
        }
    }
    let progress = search.progress();
    (search, progress)
}

fn path_task(search_graph: &SearchGraph, random: &mut Random, length: f32) -> PathTask {
    let bend = random.range(-0.5, 0.5);
    let points = [Vec3::ZERO, Vec3::new(bend, 0.0, length / 2.0), Vec3::new(0.0, 0.0, length)];
    let shape = if random.below(2) == 0 { Shape::Polyline } else { Shape::Spline };
    let curve = Curve::new(&points, shape, true, None);
    let demands = match random.below(2) {
        0 => Vec::new(),
        _ => vec![Demand { from: 0.2 * curve.length(), to: 0.6 * curve.length(), behaviour: random.below(2) }],
    };
    let start = PathTask::start_on(search_graph, &curve, 0).unwrap();
    PathTask::new(search_graph, curve, demands, vec![start], 0.03)
}

#[test]
fn the_tool_finds_what_the_exhaustive_oracle_finds() {
    let mut proven = 0;
    for seed in 0..12 {
        let mut random = Random::new(seed);
        let scene = small_scene(seed);
        let task = path_task(&scene.search_graph, &mut random, 0.5);
        let oracle = depth_first(&task, &scene.search_graph, 3_000_000);
        let (search, progress) = finish(&task, &scene.search_graph);
        let (found, best) = (search.best().unwrap(), oracle.found.unwrap());
        check_found(&task, &scene, found);
        check_found(&task, &scene, &best);
        if oracle.complete && progress == Progress::Proven {
            assert!((found.cost - best.cost).abs() < 1e-9, "seed {seed}: {} against {}", found.cost, best.cost);
            proven += 1;
        }
        assert!(found.cost <= best.cost * 1.05 || !oracle.complete, "seed {seed}");
    }
    assert!(proven >= 6, "only {proven} of 12 searches were finished by both");
}

#[test]
fn places_are_found_as_the_oracle_finds_them() {
    let mut proven = 0;
    for seed in 0..8 {
        let mut random = Random::new(100 + seed);
        let scene = small_scene(seed);
        let place = Vec2::new(random.range(-0.3, 0.3), random.range(0.1, 0.6));
        let heading = (random.below(2) == 0).then(|| random.range(-1.0, 1.0));
        let mut task = PlaceTask::new(&scene.search_graph, State::start(0, GroundPose::IDENTITY), place, heading, 0.03);
        task.most_steps = 18;
        let oracle = depth_first(&task, &scene.search_graph, 3_000_000);
        let (search, progress) = finish(&task, &scene.search_graph);
        if oracle.complete && progress == Progress::Proven {
            let (found, best) = (search.best().unwrap(), oracle.found.unwrap());
            assert!((found.cost - best.cost).abs() < 1e-9, "seed {seed}: {} against {}", found.cost, best.cost);
            proven += 1;
        }
    }
    assert!(proven >= 4, "only {proven} of 8 searches were finished by both");
}

/// A walk to a place that ends in a pose costs what the same walk costs edge by edge, and no walk of all that are short enough to be
/// tried one by one is cheaper.
#[test]
fn places_are_found_in_poses() {
    let mut proven = 0;
    for seed in 0..12 {
        let mut random = Random::new(300 + seed);
        let scene = small_scene(seed);
        let graph = &scene.search_graph;
        let main: Vec<u32> = (0..graph.frame_count()).filter(|&frame| graph.main[frame as usize]).collect();
        let Some(&pose) = main.get(random.below(main.len().max(1))) else { continue };
        let place = Vec2::new(random.range(-0.3, 0.3), random.range(0.1, 0.6));
        let plain = PlaceTask::new(graph, State::start(0, GroundPose::IDENTITY), place, None, 0.03);
        let mut task = plain.clone().in_pose(graph, pose);
        while task.prepare(graph, 10) == 10 {}
        task.most_steps = 18;
        let (search, progress) = finish(&task, graph);
        let Some(found) = search.best() else { continue };
        let whole = task.completed(graph, found);
        assert_eq!(whole.end.frame, pose);
        assert_eq!(whole.walk(graph).check(&scene.graph, &scene.timeline, 0), Ok(pose));
        let report = task.judge(graph, &whole);
        assert_eq!(report.frame, Some(pose));
        // What is missing at its end costs what it costs any walk that ends there.
        let missing = plain.ending(graph, &whole.end).unwrap();
        assert!(
            (whole.end.cost + missing - found.cost).abs() < 1e-4,
            "{} and {missing}, {}",
            whole.end.cost,
            found.cost
        );
        if progress == Progress::Proven {
            let oracle = depth_first(&task, graph, 3_000_000);
            if let Some(best) = oracle.found.filter(|_| oracle.complete) {
                assert!((found.cost - best.cost).abs() < 1e-9, "seed {seed}: {} against {}", found.cost, best.cost);
                proven += 1;
            }
        }
    }
    assert!(proven >= 6, "only {proven} of 12 searches were finished by both");
}

/// A walk that was found is in the graph, costs what the task says, and ends where it says.
fn check_found(task: &impl Task, scene: &random_scene::Made, found: &Found) {
    let walk = found.walk(&scene.search_graph);
    assert_eq!(walk.check(&scene.graph, &scene.timeline, found.start.frame), Ok(found.end.frame));
    let end = *found.states(task, &scene.search_graph).last().unwrap();
    assert_eq!(end, found.end);
    assert_eq!(walk.steps(&scene.graph), end.steps);
    let ending = task.ending(&scene.search_graph, &end).unwrap();
    assert!((end.cost + ending - found.cost).abs() < 1e-9);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// The bound never exceeds what any walk from there on really adds.
    #[test]
    fn bounds_are_admissible(seed in 0_u64..1000, length in 0.3_f32..3.0) {
        let mut random = Random::new(seed);
        let scene = small_scene(seed % 16);
        let path = path_task(&scene.search_graph, &mut random, length);
        check_bounds(&path, &scene.search_graph, &mut random);
        let place = Vec2::new(random.range(-2.0, 2.0), random.range(-2.0, 2.0));
        let heading = (random.below(2) == 0).then(|| random.range(-3.0, 3.0));
        let place = PlaceTask::new(&scene.search_graph, State::start(0, GroundPose::IDENTITY), place, heading, 0.03);
        check_bounds(&place, &scene.search_graph, &mut random);
        let mut posed = place.in_pose(&scene.search_graph, random.below(scene.search_graph.frame_count() as usize) as u32);
        while posed.prepare(&scene.search_graph, 100) == 100 {}
        check_bounds(&posed, &scene.search_graph, &mut random);
    }

    #[test]
    fn requests_survive_any_text(text in "\\PC*") {
        let _ = Request::from_json(&text);
    }

    /// Whatever numbers a request holds, it is refused or ends with a walk through the graph.
    #[test]
    fn hostile_numbers_end(points in prop::collection::vec((any::<f32>(), any::<f32>()), 0..6), seed in any::<u64>(), small in any::<bool>()) {
        let scene = small_scene(seed % 16);
        let scale = |v: f32| if small && v.is_finite() { v % 3.0 } else { v };
        let points = points.iter().map(|&(x, z)| vec![scale(x), scale(z)]).collect();
        let request = Request::new(Target::Path(PathRequest { points, free_start: seed % 2 == 0, ..PathRequest::default() }));
        if let Ok(mut direction) = Direction::new(&scene.borrowed(), None, &request, 300) {
            while direction.advance(&scene.borrowed(), 100).unwrap() == Progress::Running {}
            let answer = direction.best(&scene.borrowed());
            prop_assert_eq!(answer.walk.check(&scene.graph, &scene.timeline, answer.start_frame), Ok(answer.end_frame));
        }
    }
}

fn check_bounds(task: &impl Task, search_graph: &SearchGraph, random: &mut Random) {
    for start in task.starts(search_graph) {
        let mut states = vec![start];
        while let Some(last) =
            states.last().copied().filter(|last| !task.halts(search_graph, last) && states.len() < 300)
        {
            let from = search_graph.from(last.frame);
            if from.is_empty() {
                break;
            }
            let edge = from.start + random.below(from.len()) as u32;
            states.push(task.follow(search_graph, &last, edge).unwrap());
        }
        let costs: Vec<f64> = states
            .iter()
            .map(|state| task.ending(search_graph, state).map_or(f64::INFINITY, |e| state.cost + e))
            .collect();
        let mut least = f64::INFINITY;
        for (state, cost) in states.iter().zip(costs).rev() {
            least = least.min(cost);
            let bound = state.cost + task.remaining(search_graph, state);
            assert!(bound <= least * (1.0 + 1e-6) + 1e-6, "{bound} promised, {least} possible");
        }
    }
}

#[test]
fn tables_agree_with_walks() {
    for seed in 0..10 {
        let scene = random_scene::make(seed, &[14, 9, 11], 30);
        let to = (seed * 7 % 34) as u32;
        let table = to_targets(&scene.graph, &scene.timeline, &[to], Measure::Cost);
        let steps = to_targets(&scene.graph, &scene.timeline, &[to], Measure::Steps);
        for from in 0..34 {
            let walk = cheapest_walk(&scene.graph, &scene.timeline, from, to);
            assert_eq!(walk.is_some(), table[from as usize].is_finite());
            let down = walk_down(&scene.graph, &scene.timeline, &table, from);
            assert_eq!(walk.is_some(), down.is_some());
            if let (Some(walk), Some(down)) = (walk, down) {
                assert!((walk.cost - table[from as usize]).abs() < 1e-9);
                assert!((walk.cost - down.cost).abs() < 1e-9);
                assert_eq!(down.check(&scene.graph, &scene.timeline, from), Ok(to));
                assert!(f64::from(walk.steps(&scene.graph)) >= steps[from as usize]);
            }
        }
    }
}

/// Least price of any walk from `from` to `to`, by brute force over (frame, steps).
fn brute_price(scene: &random_scene::Made, from: u32, to: u32, wanted: u32, most: u32) -> f64 {
    let n = scene.timeline.frame_count() as usize;
    let mut cost = vec![vec![f64::INFINITY; n]; most as usize + 1];
    cost[0][from as usize] = 0.0;
    for step in 0..=most {
        for frame in 0..n as u32 {
            let here = cost[step as usize][frame as usize];
            let recorded = scene.timeline.next(frame).map(|next| (next, 1, scene.graph.alpha()));
            let synthetic = scene.graph.transitions().iter().filter(|t| t.from == frame);
            let synthetic = synthetic.map(|t| (t.to, steps_of(t), t.cost(scene.graph.alpha())));
            for (next, steps, more) in recorded.into_iter().chain(synthetic) {
                if step + steps <= most {
                    let cell = &mut cost[(step + steps) as usize][next as usize];
                    *cell = cell.min(here + more);
                }
            }
        }
    }
    let price = |step: u32| cost[step as usize][to as usize] + 0.5 * f64::from(step.abs_diff(wanted));
    (0..=most).map(price).fold(f64::INFINITY, f64::min)
}

#[test]
fn key_legs_are_the_best_of_all() {
    for seed in 0..20 {
        let scene = random_scene::make(seed, &[14, 9, 11], 30);
        let mut random = Random::new(seed);
        let (from, to, wanted) = (random.below(34) as u32, random.below(34) as u32, random.below(40) as u32);
        let mut leg = KeyLeg::new(&scene.graph, &scene.timeline, from, to, wanted);
        while !leg.advance(&scene.graph, &scene.timeline, 17) {}
        let brute = brute_price(&scene, from, to, wanted, wanted + 25);
        match leg.finish(&scene.graph, &scene.timeline) {
            LegEnd::Walk(walk, steps) => {
                assert_eq!(walk.check(&scene.graph, &scene.timeline, from), Ok(to));
                assert_eq!(walk.steps(&scene.graph), steps);
                let price = walk.cost + 0.5 * f64::from(steps.abs_diff(wanted));
                if brute.is_finite() {
                    assert!((price - brute).abs() < 1e-3, "seed {seed}: {price} against {brute}");
                }
            }
            LegEnd::NoWay => assert!(cheapest_walk(&scene.graph, &scene.timeline, from, to).is_none()),
        }
    }
}

#[test]
fn slices_do_not_change_the_answer() {
    let scene = random_scene::make(3, &[40, 30, 20], 120);
    let target = |json: &str| Request::from_json(json).unwrap();
    let json = r#"{"version":1,"seed":5,"target":{"queue":[
        {"path":{"points":[[0,0],[0,1],[1,1.5]],"shape":"spline"}},
        {"behaviour":{"name":"a","hold":2.0}},
        {"keys":{"poses":[{"pose":3,"time":1.0},{"pose":{"sequence":"s1","frame":4},"time":2.5}]}},
        {"place":{"x":1.0,"z":-0.5,"heading":0.5}},
        {"wander":{"seconds":5.0,"weights":{"b":2.0}}},
        {"pose":{"sequence":"s2","time":0.2}}]}}"#;
    let start = Some(Start { frame: 2, placement: Placement::IDENTITY });
    let mut answers = Vec::new();
    for slice in [1, 37, 5000] {
        let mut direction = Direction::new(&scene.borrowed(), start, &target(json), 2000).unwrap();
        while direction.advance(&scene.borrowed(), slice).unwrap() == Progress::Running {
            let answer = direction.best(&scene.borrowed());
            assert_eq!(answer.walk.check(&scene.graph, &scene.timeline, 2), Ok(answer.end_frame));
        }
        answers.push(direction.best(&scene.borrowed()));
    }
    assert_eq!(answers[0].parts.len(), 6);
    assert_eq!(answers[0].walk.check(&scene.graph, &scene.timeline, 2), Ok(answers[0].end_frame));
    for other in &answers[1..] {
        assert_eq!(other.walk, answers[0].walk);
    }
    let steps: u32 = answers[0].parts.iter().map(|part| part.steps).sum();
    assert_eq!(steps, answers[0].steps);
}

#[test]
fn wandering_is_close_to_uniform_and_never_stuck() {
    let scene = random_scene::make(9, &[60, 50, 40], 90);
    let request =
        Request { seed: 4, ..Request::new(Target::Wander(WanderRequest { seconds: 400.0, ..Default::default() })) };
    let mut direction = Direction::new(&scene.borrowed(), None, &request, 100_000).unwrap();
    while direction.advance(&scene.borrowed(), 1000).unwrap() == Progress::Running {}
    let answer = direction.best(&scene.borrowed());
    assert!(answer.steps >= 400 * 25);
    assert_eq!(answer.walk.check(&scene.graph, &scene.timeline, answer.start_frame), Ok(answer.end_frame));
    let Goal::Wander { objectives: [even, _, now], frames } = answer.parts[0].goal else { panic!("no wander") };
    assert!(now < even && frames > 1, "{now} against {even}");
    let again = direction.best(&scene.borrowed());
    assert_eq!(again.walk, answer.walk);
}

#[test]
fn wandering_repeats_nothing_at_once_and_is_mostly_recorded() {
    // Long sequences, as captures have them: a second of each can be shown before there is a choice.
    let scene = random_scene::make(5, &[300, 250, 200], 1500);
    let request =
        Request { seed: 2, ..Request::new(Target::Wander(WanderRequest { seconds: 300.0, ..Default::default() })) };
    let answer_of = |slice: u32| {
        let mut direction = Direction::new(&scene.borrowed(), None, &request, 100_000).unwrap();
        while direction.advance(&scene.borrowed(), slice).unwrap() == Progress::Running {}
        direction.best(&scene.borrowed())
    };
    let answer = answer_of(1000);
    // The same however it is cut into slices.
    assert_eq!(answer.walk, answer_of(7).walk);
    let mut shown = vec![false; scene.timeline.frame_count() as usize];
    let (mut recorded, mut synthetic) = (0, 0);
    for leg in &answer.walk.legs {
        match *leg {
            Leg::Recorded { first, steps, .. } => {
                recorded += steps;
                let frames = (0..=i64::from(steps)).filter_map(|step| scene.timeline.offset(first, step));
                frames.for_each(|frame| shown[frame as usize] = true);
            }
            Leg::Synthetic(index) => synthetic += steps_of(&scene.graph.transitions()[index as usize]),
            Leg::Back { .. } => panic!("wandering goes back"),
        }
    }
    assert!(f64::from(synthetic) < 0.25 * f64::from(recorded + synthetic), "{synthetic} of {recorded}");
    let main = |frame: &usize| scene.search_graph.main[*frame];
    let (all, seen) =
        ((0..shown.len()).filter(main).count(), (0..shown.len()).filter(main).filter(|&f| shown[f]).count());
    assert!(seen as f64 >= 0.95 * all as f64, "{seen} of {all}");
    // Another seed takes other ways.
    let other = Request { seed: 3, ..request.clone() };
    let mut direction = Direction::new(&scene.borrowed(), None, &other, 100_000).unwrap();
    while direction.advance(&scene.borrowed(), 1000).unwrap() == Progress::Running {}
    let walks = [answer.walk.clone(), direction.best(&scene.borrowed()).walk];
    let same = walks[0].legs.iter().zip(&walks[1].legs).take_while(|(a, b)| a == b).count();
    assert!(same < 10, "{same} legs are the same");
    // No two transitions in a row are taken again within ten seconds.
    let mut taken: Vec<(u32, u32)> = Vec::new();
    let mut step = 0;
    for leg in &answer.walk.legs {
        match *leg {
            Leg::Recorded { steps, .. } => step += steps,
            Leg::Synthetic(index) => {
                taken.push((index, step));
                step += steps_of(&scene.graph.transitions()[index as usize]);
            }
            Leg::Back { .. } => panic!("wandering goes back"),
        }
    }
    let pairs: Vec<[(u32, u32); 2]> = taken.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    for (place, pair) in pairs.iter().enumerate() {
        let again = pairs[place + 1..].iter().take_while(|later| later[0].1 < pair[0].1 + 250);
        let repeats = again.filter(|later| later[0].0 == pair[0].0 && later[1].0 == pair[1].0).count();
        assert_eq!(repeats, 0, "transitions {} and {} at step {}", pair[0].0, pair[1].0, pair[0].1);
    }
}

#[test]
fn the_optimiser_makes_distributions_even() {
    let mut random = Random::new(1);
    let states = 40_u32;
    let mut edges: Vec<(u32, u32)> = (0..states).map(|state| (state, (state + 1) % states)).collect();
    edges.extend((0..60).map(|_| (random.below(40) as u32, random.below(40) as u32)));
    edges.sort_unstable();
    edges.dedup();
    let chain = Chain::even(states, &edges).unwrap();
    let uniform = vec![1.0 / f64::from(states); states as usize];
    let off = |distribution: &[f64]| distribution.iter().zip(&uniform).map(|(a, b)| (a - b).abs()).sum::<f64>();
    let before = off(&chain.stationary(&uniform));
    let mut optimiser = Optimiser::new(chain, &uniform);
    while !optimiser.advance(10) {}
    let stationary = optimiser.stationary();
    // It is stationary, by definition and by simulation, and nearer to the uniform one.
    let moved = optimiser.chain().step(stationary);
    assert!(moved.iter().zip(stationary).all(|(a, b)| (a - b).abs() < 1e-7));
    assert!(off(stationary) < before, "{} against {before}", off(stationary));
    let [even, proxy, now] = optimiser.objectives();
    assert!(now <= proxy && now < even, "{now} {proxy} {even}");
    for state in 0..states as usize {
        let sum: f64 = optimiser.chain().edges(state).map(|edge| edge.2).sum();
        assert!((sum - 1.0).abs() < 1e-9);
    }
}

#[test]
fn loops_close_inside_their_behaviour() {
    for seed in 0..8 {
        let scene = random_scene::make(seed, &[40, 30, 20], 150);
        for behaviour in 0..2 {
            let Some(hold) = holding_loop(&scene.graph, &scene.timeline, &scene.search_graph, behaviour) else {
                continue;
            };
            assert_eq!(hold.walk.check(&scene.graph, &scene.timeline, hold.frame), Ok(hold.frame));
            for entry in hold.entries(&scene.timeline) {
                assert!(scene.search_graph.shows(behaviour, entry));
                let turned = hold.entered_at(&scene.timeline, entry);
                assert_eq!(turned.walk.check(&scene.graph, &scene.timeline, entry), Ok(entry));
            }
        }
    }
}

#[test]
fn the_actor_never_gets_stuck() {
    for seed in 0..10 {
        let scene = random_scene::make(seed, &[14, 9, 11], 30);
        let found = main_component(&scene.graph, &scene.timeline);
        for frame in 0..34_u32 {
            let reaches = |to: u32| frame == to || cheapest_walk(&scene.graph, &scene.timeline, frame, to).is_some();
            if let Some(inside) =
                found.main.iter().position(|&main| main).filter(|_| found.main.iter().filter(|&&m| m).count() > 1)
            {
                assert_eq!(found.live[frame as usize], reaches(inside as u32));
            }
            for edge in scene.search_graph.from(frame) {
                assert!(found.live[scene.search_graph.edge(edge).to as usize]);
            }
        }
    }
}

#[test]
fn what_makes_no_sense_is_refused_with_a_sentence() {
    let scene = random_scene::make(1, &[14, 9], 20);
    let refuse = |json: &str, word: &str| {
        let error = Request::from_json(json)
            .and_then(|request| Direction::new(&scene.borrowed(), None, &request, 100).map(|_| ()))
            .unwrap_err();
        assert!(error.to_string().contains(word), "{error} does not say {word}");
    };
    refuse("", "not a request");
    refuse("[1,2", "not a request");
    refuse(r#"{"version":2,"target":{"fly":true}}"#, "version 2");
    refuse(r#"{"version":1,"target":{"pose":99}}"#, "no frame 99");
    refuse(r#"{"version":1,"target":{"pose":{"sequence":"none"}}}"#, "none");
    refuse(r#"{"version":1,"target":{"behaviour":{"name":"fly"}}}"#, "there are: a, b");
    refuse(r#"{"version":1,"target":{"path":{"points":[]}}}"#, "nothing in it");
    refuse(r#"{"version":1,"target":{"path":{"points":[[1,1],[1,1]]}}}"#, "no length");
    refuse(r#"{"version":1,"target":{"path":{"points":[[1,1],[1,1,2]]}}}"#, "coordinates");
    refuse(r#"{"version":1,"target":{"path":{"points":[[1,1],[1e9,1]]}}}"#, "number from");
    refuse(r#"{"version":1,"target":{"path":{"points":[[1,1],[2,1]],"vertices":[3]}}}"#, "measured");
    refuse(r#"{"version":1,"target":{"path":{"points":[[1,1],[2,1]],"speed":3}}}"#, "speed");
    refuse(r#"{"version":1,"target":{"keys":{"poses":[]}}}"#, "nothing in it");
    refuse(r#"{"version":1,"target":{"keys":{"poses":[{"pose":1,"time":-1}]}}}"#, "number from");
    refuse(r#"{"version":1,"target":{"wander":{"seconds":1e300}}}"#, "number from");
    refuse(r#"{"version":1,"target":{"queue":[{"queue":[]}]}}"#, "queue");
    refuse(&format!(r#"{{"version":1,"target":{{"queue":[{}]}}}}"#, vec![r#"{"pose":1}"#; 300].join(",")), "at most");
    refuse(&" ".repeat(2 << 20), "bytes");
    let deep = format!("{}{}", r#"{"version":1,"target":"#, "[".repeat(100_000));
    refuse(&deep, "not a request");
    let place = Request::new(Target::Place(PlaceRequest { x: f32::NAN, ..PlaceRequest::default() }));
    assert!(Direction::new(&scene.borrowed(), None, &place, 100).is_err());
}

/// The page refuses the same with the same words: `tests/browser` reads the same list.
#[test]
fn requests_are_refused_in_the_same_words_everywhere() {
    let list: Vec<(String, Option<String>)> =
        serde_json::from_str(include_str!("../../../tests/fixtures/requests.json")).unwrap();
    for (text, sentence) in list {
        let refused = Request::from_json(&text).err().map(|error| error.to_string());
        assert_eq!(refused, sentence, "{text}");
    }
}

#[test]
fn a_search_graph_of_another_alpha_is_as_if_made_for_it() {
    let mut scene = random_scene::make(7, &[14, 9, 11], 30);
    for alpha in [0.2, 0.013, 0.01] {
        scene.graph.set_alpha(alpha).unwrap();
        let (mut changed, alpha) = (scene.search_graph.clone(), scene.graph.alpha());
        changed.set_alpha(alpha);
        let fresh = SearchGraph::new(&scene.graph, &scene.timeline, &scene.motion).unwrap();
        assert_eq!(changed.alpha, fresh.alpha);
        for frame in 0..fresh.frame_count() {
            assert_eq!(changed.from(frame), fresh.from(frame));
            assert!(fresh.from(frame).all(|edge| changed.edge(edge) == fresh.edge(edge)));
        }
    }
    assert!(scene.graph.set_alpha(f64::NAN).is_err() && scene.graph.set_alpha(-1.0).is_err());
}

#[test]
fn requests_are_the_same_after_a_round_trip() {
    let text = r#"{"version":1,"seed":3,"quickness":0.05,"target":{"path":{"points":[[0.0,1.0],[2.5,3.0]],"shape":"spline","stretches":[{"from":0.0,"to":0.5,"behaviour":"a"}],"free_start":true,"realism":0.5,"exactness":0.25}}}"#;
    let request = Request::from_json(text).unwrap();
    assert_eq!(request.to_json(), text);
    assert_eq!(Request::from_json(&request.to_json()), Ok(request));
}

/// The frame that takes longest to come to from frame 0, and how many steps that is.
fn furthest(scene: &random_scene::Made) -> (usize, u32) {
    let frames = scene.timeline.frame_count();
    let mut steps = vec![u32::MAX; frames as usize];
    steps[0] = 0;
    for _ in 0..frames {
        for frame in 0..frames {
            let Some(here) = steps.get(frame as usize).copied().filter(|&here| here != u32::MAX) else { continue };
            let recorded = scene.timeline.next(frame).map(|next| (next, 1));
            let left = scene.graph.transitions_from(frame).map(|edge| &scene.graph.transitions()[edge]);
            for (to, taken) in recorded.into_iter().chain(left.map(|edge| (edge.to, edge.warp.duration() as u32))) {
                steps[to as usize] = steps[to as usize].min(here + taken);
            }
        }
    }
    let reached = (0..steps.len()).filter(|&frame| steps[frame] != u32::MAX);
    let far = reached.max_by_key(|&frame| steps[frame]).unwrap();
    (far, steps[far])
}

#[test]
fn what_cannot_be_met_is_met_as_closely_as_can_be() {
    let scene = random_scene::make(2, &[40, 30], 60);
    let (far, steps) = furthest(&scene);
    assert!(steps > 8);
    let too_soon = format!(
        r#"{{"version":1,"target":{{"keys":{{"poses":[{{"pose":0,"time":0}},{{"pose":{far},"time":{}}}]}}}}}}"#,
        0.04 * (steps / 3) as f32
    );
    // A path of 300 m within a hundred states, a pose that is too far away in time, a place far off.
    for json in [
        r#"{"version":1,"target":{"path":{"points":[[0,0],[300,0]]}}}"#,
        too_soon.as_str(),
        r#"{"version":1,"target":{"place":{"x":900,"z":900}}}"#,
    ] {
        let request = Request::from_json(json).unwrap();
        let mut direction = Direction::new(&scene.borrowed(), None, &request, 100).unwrap();
        while direction.advance(&scene.borrowed(), 50).unwrap() == Progress::Running {}
        let answer = direction.best(&scene.borrowed());
        assert!(answer.notes().count() > 0, "{json}: {answer:?}");
        assert_eq!(answer.walk.check(&scene.graph, &scene.timeline, answer.start_frame), Ok(answer.end_frame));
    }
}

#[test]
fn curves_are_followed_by_arc_length() {
    let circle: Vec<Vec3> = (0..=8)
        .map(|k| {
            let angle = std::f32::consts::TAU * k as f32 / 8.0;
            Vec3::new(angle.cos(), 0.7, angle.sin())
        })
        .collect();
    let spline = Curve::new(&circle, Shape::Spline, true, None);
    assert!((spline.length() - std::f64::consts::TAU).abs() < 0.05, "{}", spline.length());
    for (index, point) in circle.iter().enumerate() {
        let at = spline.at(spline.length_at_knot(index as f64));
        assert!(at.distance(Vec3::new(point.x, 0.0, point.z)) < 0.01, "{at} {point}");
    }
    let line = Curve::new(&circle[..2], Shape::Polyline, false, Some(Vec3::new(3.0, 0.7, 0.0)));
    assert!((line.length() - 2.0 - f64::from(circle[0].distance(circle[1]))).abs() < 1e-5);
    assert!((line.length_at_knot(0.0) - 2.0).abs() < 1e-5);
    assert!((line.length_at_knot(1.0) - line.length()).abs() < 1e-5);
}

/// No call looks at more edges than a graph has a few times over, whatever was asked for: the page goes on drawing meanwhile.
#[test]
fn no_slice_is_long() {
    let scene = random_scene::make(7, &[120, 110, 100], 6000);
    let all = scene.graph.transitions().len() as u64 + u64::from(scene.timeline.frame_count());
    let targets = [
        r#"{"path":{"points":[[0,0],[0,1],[1,1.5]]}}"#,
        r#"{"behaviour":{"name":"b","hold":5.0}}"#,
        r#"{"keys":{"poses":[{"pose":30,"time":1.0},{"pose":250,"time":4.5}]}}"#,
        r#"{"place":{"x":1.0,"z":-0.5,"heading":0.5}}"#,
        r#"{"wander":{"seconds":20.0}}"#,
        r#"{"pose":200}"#,
    ];
    for target in targets {
        let request = Request::from_json(&format!(r#"{{"version":1,"target":{target}}}"#)).unwrap();
        let start = Some(Start { frame: 40, placement: Placement::IDENTITY });
        let mut before = edges_looked_at();
        let mut took = || {
            let now = edges_looked_at();
            now - std::mem::replace(&mut before, now)
        };
        let mut direction = Direction::new(&scene.borrowed(), start, &request, 3000).unwrap();
        assert!(took() <= 2 * all, "{target} begins with much");
        let mut slices = 0;
        while direction.advance(&scene.borrowed(), 20).unwrap() == Progress::Running {
            slices += 1;
            let edges = took();
            assert!(edges <= 2 * all, "slice {slices} of {target} looked at {edges} of {all} edges");
            if slices % 50 == 1 {
                let _ = direction.best(&scene.borrowed());
                let edges = took();
                assert!(edges <= 4 * all, "the answer to {target} looked at {edges} of {all} edges");
            }
            assert!(slices < 100_000, "{target} does not end");
        }
    }
}

#[test]
fn an_answer_is_the_same_however_it_is_polished() {
    let scene = random_scene::make(9, &[120, 110, 100], 6000);
    let json = r#"{"version":1,"target":{"path":{"points":[[0,0],[0,2],[1,3],[3,3]]}}}"#;
    let request = Request::from_json(json).unwrap();
    for start in [None, Some(Start { frame: 40, placement: Placement::IDENTITY })] {
        let mut direction = Direction::new(&scene.borrowed(), start, &request, 6000).unwrap();
        let mut bent = 0;
        while direction.advance(&scene.borrowed(), 300).unwrap() == Progress::Running {
            let expected = direction.best(&scene.borrowed());
            // A pass at a time, with a search that goes on in between now and then: then it begins anew.
            let slices = (1..).take_while(|_| !direction.polish(&scene.borrowed(), || true)).count();
            assert_eq!(direction.best(&scene.borrowed()), expected);
            if !expected.walk.bend.is_empty() && slices > 0 {
                bent += 1;
            }
            let _ = direction.polish(&scene.borrowed(), || true);
        }
        assert!(bent > 0, "the test is about nothing");
    }
}

/// The first frames of a sequence leave no room for a transition that arrives: their neighbours are shown instead.
#[test]
fn unreachable_key_poses_are_replaced_by_their_neighbours() {
    let scene = random_scene::make(5, &[40, 40, 40], 300);
    let json = r#"{"version":1,"target":{"keys":{"poses":[{"pose":40,"time":1.0}]}}}"#;
    let start = Some(Start { frame: 10, placement: Placement::IDENTITY });
    let mut direction = Direction::new(&scene.borrowed(), start, &Request::from_json(json).unwrap(), 3000).unwrap();
    while direction.advance(&scene.borrowed(), 100).unwrap() == Progress::Running {}
    let answer = direction.best(&scene.borrowed());
    let Goal::Keys { rows, .. } = &answer.parts[0].goal else { panic!("no table") };
    assert!(cheapest_walk(&scene.graph, &scene.timeline, 10, 40).is_none(), "the test is about nothing");
    assert!(rows[0].reached.is_some() && rows[0].frame == 40 && (41..50).contains(&rows[0].shown), "{rows:?}");
    assert_eq!(answer.end_frame, rows[0].shown);
    assert_eq!(answer.notes().count(), 1);
}
