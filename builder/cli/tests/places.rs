//! Places with headings, on the built-in performer and on a real character: how near the walk ends, and what is said where it
//! ends elsewhere.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::f32::consts::{FRAC_PI_2, PI};
use std::path::Path;
use std::process::Command;

use actor::motion::Motion;
use bundle::BundleReader;
use kernels::align::Placement;
use performer::{PerformerOptions, write_performer};
use search::{
    Answer, DEFAULT_EFFORT, DEFAULT_REALISM, Direction, Goal, GroundPose, PlaceReport, PlaceRequest, Progress, Request,
    Scene, SearchGraph, Start, Target,
};

/// A capture packed and read back.
struct Actor {
    reader: BundleReader,
    search_graph: SearchGraph,
}

impl Actor {
    fn pack(capture: &Path, folder: &Path) -> Self {
        let bundle = folder.join("actor.reprise");
        let mut command = Command::new(env!("CARGO_BIN_EXE_builder"));
        let packed = command.arg("pack").arg(capture).arg("-o").arg(&bundle).output().unwrap();
        assert!(packed.status.success(), "{}", String::from_utf8_lossy(&packed.stderr));
        let mut reader = BundleReader::from_bytes(&std::fs::read(bundle).unwrap()).unwrap();
        let (timeline, graph) = (reader.timeline().unwrap().clone(), reader.graph().unwrap().clone());
        let weights = reader.topology().unwrap().weights().to_vec();
        let motion = Motion::measure(&timeline, &weights, &mut reader).unwrap();
        let search_graph = SearchGraph::new(&graph, &timeline, &motion).unwrap();
        Self { reader, search_graph }
    }

    /// Goes from `frame` to the place so many metres away in a direction, facing a way.
    fn go(&self, frame: u32, (metres, direction): (f32, f32), heading: f32) -> (PlaceReport, Answer) {
        let (graph, timeline) = (self.reader.graph().unwrap(), self.reader.timeline().unwrap());
        let scene = Scene { graph, timeline, search_graph: &self.search_graph };
        let here = self.search_graph.point_at(frame, GroundPose::IDENTITY);
        let place = PlaceRequest {
            x: here.x + metres * direction.sin(),
            z: here.z + metres * direction.cos(),
            heading: Some(heading),
            pose: None,
            realism: DEFAULT_REALISM,
            // What searches find is measured here.
            exactness: 0.0,
        };
        let start = Some(Start { frame, placement: Placement::IDENTITY });
        let request = Request::new(Target::Place(place));
        let mut direction = Direction::new(&scene, start, &request, DEFAULT_EFFORT).unwrap();
        while direction.advance(&scene, 20_000).unwrap() == Progress::Running {}
        let answer = direction.best(&scene);
        let Goal::Place(report) = answer.parts[0].goal else { panic!("{answer:?}") };
        let is_far = report.distance > 0.1 || report.turn.unwrap() > 0.175;
        assert_eq!(answer.notes().next().is_some(), is_far, "{report:?} {:?}", answer.parts[0].notes);
        (report, answer)
    }
}

#[test]
fn the_performer_comes_to_places_and_faces_as_asked() {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("performer");
    let options = PerformerOptions { frames: 500, vertices: 1500, texture_size: 128, ..PerformerOptions::default() };
    write_performer(&options, &capture, &|_| ()).unwrap();
    let actor = Actor::pack(&capture, folder.path());
    let (mut sums, mut most, mut count) = ([0.0; 2], [0.0_f64; 2], 0.0);
    for place in [(0.8, PI), (1.5, 0.8), (2.0, -2.2), (4.0, 0.2)] {
        for quarter in [0, 2] {
            let (report, _) = actor.go(10, place, quarter as f32 * FRAC_PI_2 - 1.0);
            for (at, error) in [report.distance, report.turn.unwrap()].into_iter().enumerate() {
                sums[at] += error;
                most[at] = most[at].max(error);
            }
            count += 1.0;
        }
    }
    println!(
        "off by {:.1} cm and {:.1} degrees on average, {:.1} cm and {:.1} degrees at most",
        100.0 * sums[0] / count,
        (sums[1] / count).to_degrees(),
        100.0 * most[0],
        most[1].to_degrees()
    );
    assert!(sums[0] / count < 0.03 && sums[1] / count < 0.05, "{sums:?} of {count}");
    assert!(most[0] < 0.15 && most[1] < 0.26, "{most:?}");
}

#[test]
fn where_no_motion_leads_the_answer_says_so() {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    if !data.is_dir() {
        assert!(std::env::var("CI").as_deref() != Ok("true"), "the real data is missing at {}", data.display());
        eprintln!("skipped: no real data at {}", data.display());
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    // A fox that walks and runs straight on: nothing turns it.
    let actor = Actor::pack(&data.join("gltf/fox/Fox.glb"), folder.path());
    let (report, answer) = actor.go(5, (2.0, 0.7), 1.0);
    println!("{report:?} {:?}", answer.parts[0].notes);
    assert!(report.turn.unwrap() > 0.5, "{report:?}");
    assert!(answer.notes().any(|note| note.contains("the heading asked for")), "{:?}", answer.parts[0].notes);
}
