//! Walks keep to the paths that are drawn, and their feet stand meanwhile.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that panics has failed; what it measured is printed"
)]

use std::sync::OnceLock;

use actor::graph::EssentialGraph;
use actor::motion::Motion;
use actor::pose_source::PoseSource;
use actor::timeline::Timeline;
use bundle::BundleReader;
use fixtures::Random;
use glam::{Vec2, Vec3, Vec3Swizzles};
use job::Job;
use kernels::align::{Placement, centre_of_mass};
use performer::{PerformerOptions, write_performer};
use reprise::pack::{PackOptions, pack};
use search::{
    Answer, Curve, Direction, FrameRef, Goal, PathRequest, PlaceRequest, Progress, Request, Scene, SearchGraph, Shape,
    Start, Target,
};
use synthesis::Synthesiser;

/// States that a search may expand.
const EFFORT: u32 = 100_000;
/// What is this close to the ground touches it, relative to the body's height: 2 cm of 1.8 m.
const TOUCHES: f32 = 0.011;

/// An actor that can be asked.
struct Actor {
    reader: BundleReader,
    timeline: Timeline,
    graph: EssentialGraph,
    search_graph: SearchGraph,
    /// What is below touches the ground.
    touches: f32,
    /// Slide from each recorded frame to the next one, in metres.
    slides: Vec<Option<f64>>,
}

impl Actor {
    fn of(bytes: &[u8]) -> Self {
        let mut reader = BundleReader::from_bytes(bytes).unwrap();
        let (timeline, graph) = (reader.timeline().unwrap().clone(), reader.graph().unwrap().clone());
        let weights = reader.topology().unwrap().weights().to_vec();
        let motion = Motion::measure(&timeline, &weights, &mut reader).unwrap();
        let search_graph = SearchGraph::new(&graph, &timeline, &motion).unwrap();
        let mut pose = vec![Vec3::ZERO; weights.len()];
        let mut lowest = Vec::new();
        let mut height = 0.0;
        for frame in 0..timeline.frame_count() {
            reader.read(frame, &mut pose).unwrap();
            let heights = || pose.iter().map(|point| point.y);
            lowest.push(heights().fold(f32::MAX, f32::min));
            if frame == 0 {
                height = heights().fold(f32::MIN, f32::max) - lowest[0];
            }
        }
        lowest.sort_unstable_by(f32::total_cmp);
        let touches = lowest[lowest.len() / 4] + TOUCHES * height;
        let mut slides = vec![None; timeline.frame_count() as usize];
        for sequence in timeline.sequences() {
            let mut before: Option<Vec<Vec3>> = None;
            for frame in sequence.first_frame..sequence.end_frame() {
                reader.read(frame, &mut pose).unwrap();
                if let Some(before) = before.replace(pose.clone()) {
                    slides[frame as usize - 1] = slide(Some(&before), &pose, touches);
                }
            }
        }
        Self { reader, timeline, graph, search_graph, touches, slides }
    }

    fn ask(&self, start: Option<Start>, target: Target) -> Answer {
        let scene = Scene { graph: &self.graph, timeline: &self.timeline, search_graph: &self.search_graph };
        let mut direction = Direction::new(&scene, start, &Request::new(target), EFFORT).unwrap();
        while direction.advance(&scene, EFFORT).unwrap() == Progress::Running {}
        direction.best(&scene)
    }

    /// Walks it, frame by frame.
    fn walk(&mut self, answer: &Answer) -> Walked {
        let begin = (answer.start_frame, placement(answer.start_placement));
        let weights = self.reader.topology().unwrap().weights().to_vec();
        let mut synthesiser = Synthesiser::new(self.reader.topology().unwrap(), None).unwrap();
        synthesiser.begin_walk(&self.graph, &self.timeline, begin, &answer.walk).unwrap();
        let mut pose = vec![Vec3::ZERO; weights.len()];
        let (mut walked, mut before) = (Walked::default(), None);
        while let Some(info) = synthesiser.next_frame(&self.graph, &self.timeline, &mut self.reader, &mut pose).unwrap()
        {
            walked.centres.push(centre_of_mass(&pose, &weights));
            let facing = self.search_graph.facings[info.kind.frame() as usize] + info.placement.heading;
            walked.facings.push(Vec2::new(facing.sin(), facing.cos()));
            walked.recorded.extend(self.slides[info.kind.frame() as usize]);
            walked.slides.extend(slide(before.replace(pose.clone()).as_deref(), &pose, self.touches));
        }
        walked
    }
}

#[derive(Default)]
struct Walked {
    centres: Vec<Vec3>,
    facings: Vec<Vec2>,
    slides: Vec<f64>,
    /// Slides of the recorded frames that these are or are nearest to.
    recorded: Vec<f64>,
}

fn placement([heading, x, z]: [f32; 3]) -> Placement {
    Placement { heading, translation: Vec2::new(x, z) }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn slide(before: Option<&[Vec3]>, after: &[Vec3], touches: f32) -> Option<f64> {
    let pairs = before?.iter().zip(after).filter(|(b, a)| b.y < touches && a.y < touches);
    let ways: Vec<f64> = pairs.map(|(b, a)| f64::from(b.xz().distance(a.xz()))).collect();
    (!ways.is_empty()).then(|| mean(&ways))
}

/// How well a walk keeps to a path.
#[derive(Debug)]
struct Kept {
    /// Distance of the centre of mass to the nearest point of the path, in metres.
    mean: f64,
    most: f64,
    /// Angle in degrees between where the body faces and where the path leads, on average.
    heading: f64,
}

fn kept(walked: &Walked, curve: &Curve) -> Kept {
    let (mut offs, mut angles, mut travelled) = (Vec::new(), Vec::new(), 0.0);
    for (at, pair) in walked.centres.windows(2).enumerate() {
        travelled += f64::from(pair[0].xz().distance(pair[1].xz()));
        offs.push(curve.nearest(pair[1], travelled));
        let here = travelled.min(curve.length() - 0.1).max(0.1);
        let along = (curve.at(here + 0.05) - curve.at(here - 0.05)).xz();
        angles.push(f64::from(along.angle_to(walked.facings[at + 1]).to_degrees().abs()));
    }
    Kept { mean: mean(&offs), most: offs.iter().copied().fold(0.0, f64::max), heading: mean(&angles) }
}

/// A line, a circle, a slalom, right angles and a figure eight, as `builder evaluate` has them, and an S.
fn standard() -> Vec<(&'static str, Vec<Vec<f32>>)> {
    let tau = std::f32::consts::TAU;
    let around = |count: usize, point: &dyn Fn(f32) -> [f32; 2]| -> Vec<Vec<f32>> {
        (0..=count).map(|k| point(k as f32 / count as f32).to_vec()).collect()
    };
    let list = |points: &[[f32; 2]]| points.iter().map(|point| point.to_vec()).collect();
    vec![
        ("line", list(&[[0.0, 0.0], [0.0, 10.0]])),
        ("circle", around(24, &|t| [1.6 - 1.6 * (t * tau).cos(), 1.6 * (t * tau).sin()])),
        ("slalom", around(40, &|t| [(2.0 * t * tau).sin() * 0.8, t * 9.0])),
        ("right angles", list(&[[0.0, 0.0], [0.0, 3.0], [3.0, 3.0], [3.0, 6.0], [4.0, 6.0]])),
        ("figure eight", around(48, &|t| [1.35 * (2.0 * t * tau).sin(), 2.2 * (t * tau).sin()])),
        ("S", list(&[[0.0, 0.0], [0.8, 1.0], [0.0, 2.0], [-0.8, 3.0], [0.0, 4.0]])),
    ]
}

/// As somebody draws: some points a metre or so apart, never turning back at once.
fn drawn(seed: u64) -> Vec<Vec<f32>> {
    let mut random = Random::new(seed);
    let (mut place, mut heading) = (Vec2::ZERO, 0.0_f32);
    let mut points = vec![place.to_array().to_vec()];
    for _ in 0..3 + random.below(6) {
        heading += random.range(-1.0, 1.0);
        place += Vec2::new(heading.sin(), heading.cos()) * random.range(0.7, 1.6);
        points.push(place.to_array().to_vec());
    }
    points
}

fn follow(actor: &mut Actor, points: &[Vec<f32>], exactness: f64) -> (Kept, Walked, Answer) {
    let request = PathRequest {
        points: points.to_vec(),
        shape: Shape::Spline,
        free_start: true,
        exactness,
        ..PathRequest::default()
    };
    let curve = Curve::new(&request.points(), request.shape, true, None);
    let answer = actor.ask(None, Target::Path(request));
    let walked = actor.walk(&answer);
    (kept(&walked, &curve), walked, answer)
}

/// What all paths of a kind come to.
#[derive(Debug, Default)]
struct Sums {
    /// Paths that are kept to a centimetre on average and to four at most.
    kept: usize,
    /// Means of all, before and after: distances, headings, slides in times the recorded one.
    distance: [f64; 2],
    heading: [f64; 2],
    slide: [f64; 2],
}

fn all(actor: &mut Actor, paths: &[(String, Vec<Vec<f32>>)]) -> Sums {
    let mut sums = Sums::default();
    for (name, points) in paths {
        let mut row = String::new();
        for (side, exactness) in [0.0, 1.0].into_iter().enumerate() {
            let (kept, walked, answer) = follow(actor, points, exactness);
            let slide = mean(&walked.slides) / mean(&walked.recorded);
            row += &format!(
                "  {:.1} cm, {:.1} at most, {:.1} degrees, slide {slide:.2}, planned {:.1} {}",
                100.0 * kept.mean,
                100.0 * kept.most,
                kept.heading,
                match &answer.parts[0].goal {
                    Goal::Path(report) => 100.0 * report.mean_aside,
                    _ => 0.0,
                },
                answer.notes().collect::<Vec<_>>().join(" ")
            );
            sums.distance[side] += kept.mean / paths.len() as f64;
            sums.heading[side] += kept.heading / paths.len() as f64;
            sums.slide[side] += slide / paths.len() as f64;
            sums.kept += usize::from(side == 1 && kept.mean <= 0.01 && kept.most <= 0.04);
        }
        println!("{name}: {row}");
    }
    println!("{} of {} kept; {sums:.3?}", sums.kept, paths.len());
    sums
}

fn named(paths: Vec<(&str, Vec<Vec<f32>>)>) -> Vec<(String, Vec<Vec<f32>>)> {
    paths.into_iter().map(|(name, points)| (name.to_owned(), points)).collect()
}

/// As many frames as there are motions to follow paths with, and few vertices, which do not matter here.
fn performed() -> Actor {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    Actor::of(BYTES.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let small = PerformerOptions { frames: 900, vertices: 1_500, texture_size: 128, ..PerformerOptions::default() };
        write_performer(&small, folder.path(), &|_| ()).unwrap();
        let inputs = [folder.path().to_str().unwrap().to_owned()];
        pack(&inputs, &PackOptions::default(), &Job::silent()).unwrap().0
    }))
}

#[test]
fn the_performer_keeps_to_paths() {
    let mut actor = performed();
    let sums = all(&mut actor, &named(standard()));
    assert_eq!(sums.kept, 6, "{sums:?}");
    assert!(sums.distance[1] < 0.01, "{sums:?}");
    assert!(sums.heading[1] < sums.heading[0] + 1.0, "{sums:?}");
    assert!(sums.slide[1] < 1.5, "{sums:?}");
    let drawn: Vec<_> = (0..10).map(|seed| (format!("drawn {seed}"), drawn(seed))).collect();
    let sums = all(&mut actor, &drawn);
    assert!(sums.kept >= 9, "{sums:?}");
    assert!(sums.slide[1] < 1.5, "{sums:?}");
}

#[test]
fn walks_are_bent_as_far_as_they_may_be() {
    let mut actor = performed();
    let points = &standard()[5].1;
    let (plain, _, answer) = follow(&mut actor, points, 0.0);
    assert!(answer.walk.bend.is_empty());
    let (half, ..) = follow(&mut actor, points, 0.5);
    let (whole, _, bent) = follow(&mut actor, points, 1.0);
    assert_eq!(bent.walk.bend.len(), bent.steps as usize + 1);
    assert!(whole.mean < half.mean && half.mean < plain.mean, "{whole:?} {half:?} {plain:?}");
    // Over any half second, but for what the weights of limits give way.
    for pair in bent.walk.bend.windows(26) {
        assert!((pair[25][0] - pair[0][0]).abs() < 1.25 * 10_f32.to_radians(), "{pair:?}");
    }
}

#[test]
fn places_are_reached() {
    let mut actor = performed();
    let start = Start {
        frame: actor.search_graph.main.iter().position(|&main| main).unwrap() as u32,
        placement: Placement::IDENTITY,
    };
    let mut random = Random::new(3);
    let (mut missed, mut count) = ([0.0, 0.0], 0);
    for _ in 0..12 {
        let (x, z) = (random.range(-3.0, 3.0), random.range(-3.0, 3.0));
        let heading = Some(random.range(-3.0, 3.0));
        for (side, exactness) in [0.0, 1.0].into_iter().enumerate() {
            let place = PlaceRequest { x, z, heading, exactness, ..PlaceRequest::default() };
            let answer = actor.ask(Some(start), Target::Place(place));
            let walked = actor.walk(&answer);
            let off = f64::from(walked.centres[walked.centres.len() - 1].xz().distance(Vec2::new(x, z)));
            let Goal::Place(report) = answer.parts[0].goal else { panic!() };
            assert!((report.distance - off).abs() < 0.01, "{} against {off}", report.distance);
            missed[side] += off;
            count += usize::from(side == 1 && off < 0.01);
        }
    }
    println!("places: {missed:.3?} m in all, {count} of 12 within a centimetre");
    assert!(count >= 10, "{count}");
}

/// Poses at places: the walk ends in the very pose, and it is the frames that are made that stand there.
#[test]
fn poses_are_taken_at_places() {
    let mut actor = performed();
    let main: Vec<u32> =
        (0..actor.search_graph.frame_count()).filter(|&frame| actor.search_graph.main[frame as usize]).collect();
    let start = Start { frame: main[0], placement: Placement::IDENTITY };
    let mut random = Random::new(5);
    let (mut offs, mut turns) = (Vec::new(), Vec::new());
    for _ in 0..12 {
        let (x, z) = (random.range(-3.0, 3.0), random.range(-3.0, 3.0));
        let heading = random.range(-3.0, 3.0);
        let pose = main[random.below(main.len())];
        let place = PlaceRequest {
            x,
            z,
            heading: Some(heading),
            pose: Some(FrameRef::Number(pose)),
            ..PlaceRequest::default()
        };
        let answer = actor.ask(Some(start), Target::Place(place));
        assert_eq!(answer.end_frame, pose);
        let walked = actor.walk(&answer);
        offs.push(f64::from(walked.centres[walked.centres.len() - 1].xz().distance(Vec2::new(x, z))));
        let Goal::Place(report) = answer.parts[0].goal else { panic!() };
        assert_eq!(report.frame, Some(pose));
        turns.push(report.turn.unwrap().to_degrees());
    }
    let count = offs.iter().filter(|&&off| off < 0.01).count();
    println!("poses at places: off {offs:.3?} m, {turns:.1?} degrees; {count} of 12 within a centimetre");
    assert!(count >= 8, "{count}");
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_captured_actor_keeps_to_paths() {
    let inputs =
        ["crane", "jumping"].map(|name| fixtures::unpacked(name)[0].parent().unwrap().to_str().unwrap().to_owned());
    let mut options = PackOptions::default();
    options.import.fps = Some(25.0);
    let mut actor = Actor::of(&pack(&inputs, &options, &Job::silent()).unwrap().0);
    let sums = all(&mut actor, &named(standard()));
    assert_eq!(sums.kept, 6, "{sums:?}");
    assert!(sums.slide[1] < 1.5, "{sums:?}");
}
