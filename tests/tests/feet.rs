//! Feet that stand stay where they are in transitions, as well as in the recordings.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that panics has failed; what it measured is printed"
)]

use actor::capture::{Capture, Poses};
use actor::feet::Feet;
use actor::graph::EssentialGraph;
use actor::pose_source::{PoseError, PoseSource};
use actor::timeline::{Sequence, Timeline};
use actor::walk::Walk;
use capture_io::import::{ImportOptions, import};
use capture_io::mocap::{MocapOptions, read_clip};
use drive::{Mapping, MappingFile, retarget};
use glam::{Vec3, Vec3Swizzles};
use job::Job;
use kernels::align::Placement;
use kernels::random::mix;
use performer::{PerformerOptions, write_performer};
use pipeline::distance;
use pipeline::graph::{GraphOptions, essential_graph};
use search::cheapest_walk;
use synthesis::Synthesiser;

/// Pairs of frames drawn at random; all transitions of the walks between them are looked at.
const DRAWN: u64 = 150;
/// What is this close to the ground touches it, relative to the body's height: 2 cm of 1.8 m.
const TOUCHES: f32 = 0.011;

struct Recorded<'a>(&'a Poses);

impl PoseSource for Recorded<'_> {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        pose.copy_from_slice(self.0.frame(frame));
        Ok(())
    }
}

/// What is seen of some frames in a row.
struct Seen {
    slides: Vec<f64>,
    lowest: f32,
    /// Frames, and those of them in which the body is in the air though it is on neither side of the blend.
    frames: usize,
    hops: usize,
}

impl Seen {
    fn none() -> Self {
        Self { slides: Vec::new(), lowest: f32::INFINITY, frames: 0, hops: 0 }
    }

    fn mean(&self) -> f64 {
        self.slides.iter().sum::<f64>() / self.slides.len() as f64
    }

    /// The mean way along the ground of all vertices that touch it in both frames, and how low the later frame reaches.
    fn look(&mut self, before: &[Vec3], after: &[Vec3], touches: f32) {
        let pairs = before.iter().zip(after).filter(|(b, a)| b.y < touches && a.y < touches);
        let ways: Vec<f64> = pairs.map(|(b, a)| f64::from(b.xz().distance(a.xz()))).collect();
        if !ways.is_empty() {
            self.slides.push(ways.iter().sum::<f64>() / ways.len() as f64);
        }
        self.lowest = self.lowest.min(lowest(after));
    }

    /// Whether a blended frame is further than `most` above the higher one of both sides.
    fn hop(&mut self, pose: &[Vec3], sides: [&[Vec3]; 2], most: f32) {
        let [one, other] = sides.map(lowest);
        self.frames += 1;
        self.hops += usize::from(lowest(pose) - one.max(other).max(0.0) > most);
    }
}

fn lowest(pose: &[Vec3]) -> f32 {
    pose.iter().map(|point| point.y).fold(f32::INFINITY, f32::min)
}

fn touches(poses: &Poses) -> f32 {
    let mut lowest: Vec<f32> = poses.iter().map(lowest).collect();
    lowest.sort_unstable_by(f32::total_cmp);
    let heights = || poses.frame(0).iter().map(|point| point.y);
    lowest[lowest.len() / 4] + TOUCHES * (heights().fold(f32::MIN, f32::max) - heights().fold(f32::MAX, f32::min))
}

fn recorded(capture: &Capture) -> Seen {
    let mut seen = Seen::none();
    for sequence in capture.timeline.sequences() {
        for frame in sequence.first_frame..sequence.end_frame() - 1 {
            seen.look(capture.poses.frame(frame), capture.poses.frame(frame + 1), touches(&capture.poses));
        }
    }
    seen
}

/// All transitions on cheapest walks.
fn synthetic(capture: &Capture, graph: &EssentialGraph) -> Seen {
    let (timeline, mut seen) = (&capture.timeline, Seen::none());
    let touches = touches(&capture.poses);
    let mut synthesiser = Synthesiser::new(&capture.topology, None).unwrap();
    let frame = |index: u64| (mix(7, index) % u64::from(timeline.frame_count())) as u32;
    let mut pose = vec![Vec3::ZERO; capture.topology.vertex_count()];
    let first = capture.poses.frame(0);
    let most = TOUCHES * (first.iter().map(|point| point.y).fold(f32::MIN, f32::max) - lowest(first));
    let walk = |index: u64| cheapest_walk(graph, timeline, frame(2 * index), frame(2 * index + 1));
    for walk in (0..DRAWN).filter_map(walk) {
        for leg in walk.legs.iter().filter(|leg| leg.transition().is_some()) {
            let from = leg.ends(graph).unwrap().0;
            let alone = Walk { legs: vec![*leg], ..Walk::default() };
            synthesiser.begin_walk(graph, timeline, (from, Placement::IDENTITY), &alone).unwrap();
            let transition = &graph.transitions()[leg.transition().unwrap() as usize];
            let begin = timeline.offset(transition.to, 1 - transition.warp.lengths().1 as i64).unwrap();
            let mut nodes = transition.warp.nodes();
            let mut before: Option<Vec<Vec3>> = None;
            let mut source = Recorded(&capture.poses);
            while synthesiser.next_frame(graph, timeline, &mut source, &mut pose).unwrap().is_some() {
                if let Some(before) = &before {
                    seen.look(before, &pose, touches);
                }
                if let Some((n, m)) = nodes.next() {
                    let sides = [(from, n), (begin, m)]
                        .map(|(frame, after)| capture.poses.frame(timeline.offset(frame, after as i64).unwrap()));
                    seen.hop(&pose, sides, most);
                }
                before = Some(pose.clone());
            }
        }
    }
    seen
}

/// Slide at most `most` times the recorded one, less than half of what it is without feet, and nothing lower than recorded.
fn check(capture: &Capture, most: f64) {
    let measured =
        distance::measure(&capture.topology, &capture.poses, &distance::DistanceOptions::default(), &Job::silent())
            .unwrap();
    let graph = essential_graph(capture, &measured, &GraphOptions::default(), &Job::silent()).unwrap().graph;
    assert_eq!(graph.feet().count(), 2);
    let (own, feet) = (recorded(capture), synthetic(capture, &graph));
    let without = synthetic(capture, &graph.with_feet(Feet::default()));
    let [own_slide, slide, free] = [&own, &feet, &without].map(Seen::mean);
    println!(
        "{:.2} mm recorded, {:.2} mm in transitions, {:.2} mm without feet",
        own_slide * 1e3,
        slide * 1e3,
        free * 1e3
    );
    println!("in the air: {} of {} frames", feet.hops, feet.frames);
    println!("lowest: {:.1} mm, {:.1} mm", own.lowest * 1e3, feet.lowest * 1e3);
    assert!(feet.slides.len() > 50, "{}", feet.slides.len());
    assert!(slide < most * own_slide, "{slide} against {own_slide}");
    assert!(slide < 0.5 * free, "{slide} against {free}");
    assert!(15 * feet.hops < feet.frames, "{} of {} frames in the air", feet.hops, feet.frames);
    assert!(feet.lowest > own.lowest - 1e-3, "{} against {}", feet.lowest, own.lowest);
}

#[test]
fn the_performer_stands_in_transitions() {
    let folder = tempfile::tempdir().unwrap();
    let small = PerformerOptions { frames: 300, vertices: 1_500, texture_size: 128, ..PerformerOptions::default() };
    write_performer(&small, folder.path(), &|_| ()).unwrap();
    let inputs = [folder.path().to_str().unwrap().to_owned()];
    let capture = import(&inputs, &ImportOptions::default(), &Job::silent()).unwrap().capture;
    check(&capture, 1.5);
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_captured_actor_stands_in_transitions() {
    let files = ["crane", "jumping"].map(fixtures::unpacked);
    let inputs = files.map(|files| files[0].parent().unwrap().to_str().unwrap().to_owned());
    let options = ImportOptions { fps: Some(25.0), ..ImportOptions::default() };
    check(&import(&inputs, &options, &Job::silent()).unwrap().capture, 1.5);
}

/// Real movements on a body that is known: clips of motion capture, done by the performer.
fn stranger() -> Capture {
    let folder = tempfile::tempdir().unwrap();
    let small = PerformerOptions { frames: 600, vertices: 1_500, texture_size: 128, ..PerformerOptions::default() };
    write_performer(&small, folder.path(), &|_| ()).unwrap();
    let inputs = [folder.path().to_str().unwrap().to_owned()];
    let performer = import(&inputs, &ImportOptions::default(), &Job::silent()).unwrap().capture;
    let (topology, fps) = (&performer.topology, performer.timeline.fps());
    let rig = rig::estimate(topology, &performer.poses, &rig::RigOptions::default()).unwrap().rig;
    let body = drive::body(&rig, &performer.poses).unwrap();
    let (mut sequences, mut positions, mut first_frame) = (Vec::new(), Vec::new(), 0);
    for name in ["02_01", "02_04"] {
        let mocap = fixtures::data().join("mocap");
        let files = format!("{}+{}", mocap.join("02.asf").display(), mocap.join(format!("{name}.amc")).display());
        let clip = read_clip(&files, &MocapOptions::default()).unwrap().clip;
        let mapping = Mapping::of(&clip, &MappingFile::default()).unwrap();
        let driven = retarget((&clip, &mapping), &body, (topology, None), (&performer.poses, fps)).unwrap();
        let frame_count = driven.poses.len() as u32;
        sequences.push(Sequence { name: name.into(), labels: vec![], first_frame, frame_count, cyclic: false });
        first_frame += frame_count;
        positions.extend(driven.poses.into_iter().flatten());
    }
    let poses = Poses::from_positions(topology.vertex_count(), positions);
    let timeline = Timeline::new(fps, sequences).unwrap();
    Capture::new("stranger", topology.clone(), performer.surface, timeline, poses).unwrap()
}

#[test]
#[ignore = "reads ../shared/data"]
fn a_stranger_stands_in_transitions() {
    check(&stranger(), 1.5);
}
