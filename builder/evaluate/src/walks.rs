//! Section 6: walks along paths and through key poses at times (TVCG section 4.3; thesis section 3.5 and figure
//! 3.18).

use actor::motion::Motion;
use search::{
    Answer, DEFAULT_EFFORT, Direction, FrameRef, Goal, Key, KeysRequest, PathReport, PathRequest, Progress as Found,
    Request, Scene, SearchGraph, Shape, Start, Target,
};

use super::EvaluateError;
use super::document::{Agreement, Cell, SectionReport, Table, Verdict};
use super::plot::{Plot, Series, SeriesStyle};
use super::subject::Subject;
use job::Job;
use pipeline::transitions::LengthChoice;

/// States expanded between two reports of progress.
const SLICE: u32 = 20_000;
/// The mean error in frames of the papers' ten key poses (thesis figure 3.18), at 50 frames a second.
const PAPERS_FRAMES: f64 = 5.0;
const PAPERS_FPS: f64 = 50.0;

/// Makes the section.
pub(super) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let graph = subject.graph(LengthChoice::Total, job)?;
    let timeline = subject.timeline();
    let mut poses = subject.capture.poses.clone();
    let motion = Motion::measure(timeline, subject.capture.topology.weights(), &mut poses)?;
    let search_graph = SearchGraph::new(&graph, timeline, &motion)?;
    let scene = Scene { graph: &graph, timeline, search_graph: &search_graph };
    let mut section = SectionReport::default();
    section.text.push(format!(
        "The tool's search at its usual effort: {DEFAULT_EFFORT} states a target. Distances are those of the centre of mass as \
         planned, to the path's point of equal arc length (the papers' measure) and to the nearest point."
    ));
    paths(&scene, &mut section, job);
    keys(&scene, &mut section, job);
    Ok(section)
}

/// A path by name, as points (x, z) of the ground in metres.
type StandardPath = (&'static str, Vec<Vec<f32>>);

/// The five standard paths: a line, a circle, a slalom, right angles and a figure eight, 10 to 15 m each.
fn standard_paths() -> Vec<StandardPath> {
    let tau = std::f32::consts::TAU;
    let around = |count: usize, point: &dyn Fn(f32) -> [f32; 2]| -> Vec<Vec<f32>> {
        (0..=count).map(|k| point(k as f32 / count as f32).to_vec()).collect()
    };
    let corners = [[0.0, 0.0], [0.0, 3.0], [3.0, 3.0], [3.0, 6.0], [4.0, 6.0]];
    vec![
        ("line", vec![vec![0.0, 0.0], vec![0.0, 10.0]]),
        ("circle", around(24, &|t| [1.6 - 1.6 * (t * tau).cos(), 1.6 * (t * tau).sin()])),
        ("slalom", around(40, &|t| [(2.0 * t * tau).sin() * 0.8, t * 9.0])),
        ("right angles", corners.iter().map(|corner| corner.to_vec()).collect()),
        ("figure eight", around(48, &|t| [1.35 * (2.0 * t * tau).sin(), 2.2 * (t * tau).sin()])),
    ]
}

fn ask(scene: &Scene, start: Option<Start>, request: &Request, job: &Job, what: &'static str) -> Option<Answer> {
    let mut direction = Direction::new(scene, start, request, DEFAULT_EFFORT).ok()?;
    let mut done = 0;
    while direction.advance(scene, SLICE).ok()? == Found::Running {
        done = (done + u64::from(SLICE)).min(u64::from(DEFAULT_EFFORT));
        job.tell(what, done, u64::from(DEFAULT_EFFORT)).ok()?;
    }
    Some(direction.best(scene))
}

fn paths(scene: &Scene, section: &mut SectionReport, job: &Job) {
    let columns = [
        "path",
        "tool",
        "exactness",
        "length, m",
        "mean, cm",
        "most, cm",
        "to the nearest point, mean, cm",
        "to the nearest point, most, cm",
        "seconds",
        "transitions",
    ];
    let caption = "Five paths with both path tools, begun with any pose, as they are found (exactness 0) and bent (1): \
                   distance of the centre of mass.";
    let mut table = Table::new("walk_paths", caption, &columns);
    for (name, points) in standard_paths() {
        let tools = [("polyline", Shape::Polyline), ("spline", Shape::Spline)];
        for ((tool, shape), exactness) in tools.into_iter().flat_map(|tool| [(tool, 0.0), (tool, 1.0)]) {
            let request =
                PathRequest { points: points.clone(), shape, free_start: true, exactness, ..PathRequest::default() };
            let answer = ask(scene, None, &Request::new(Target::Path(request)), job, "paths");
            let goal = answer.as_ref().and_then(|answer| Some((answer, &answer.parts.first()?.goal)));
            let Some((answer, Goal::Path(found))) = goal else {
                let empty = std::iter::repeat_n(Cell::Empty, columns.len() - 3);
                table
                    .rows
                    .push([name.into(), tool.into(), Cell::Number(exactness, 1)].into_iter().chain(empty).collect());
                continue;
            };
            let named = [name.into(), tool.into(), Cell::Number(exactness, 1)];
            table.rows.push(named.into_iter().chain(path_row(found, answer)).collect());
            if shape == Shape::Spline && exactness > 0.0 {
                section.plots.push(path_plot(name, found));
            }
        }
    }
    section.tables.push(table);
}

fn path_row(found: &PathReport, answer: &Answer) -> Vec<Cell> {
    let centimetres = |metres: f64| Cell::Number(100.0 * metres, 1);
    vec![
        Cell::Number(found.length, 1),
        centimetres(found.mean),
        centimetres(found.max),
        centimetres(found.mean_aside),
        centimetres(found.max_aside),
        Cell::Number(answer.seconds, 1),
        Cell::Count(answer.walk.transition_count() as u64),
    ]
}

/// The path and the way that was walked, as seen from above.
fn path_plot(name: &str, found: &PathReport) -> Plot {
    let asked = found.curve.iter().map(|&[x, _, z]| (f64::from(x), f64::from(z))).collect();
    let walked = found.track.iter().map(|&[_, x, _, z]| (f64::from(x), f64::from(z))).collect();
    Plot {
        caption: format!("The path ({name}, as a spline) and the centre of mass along it, from above."),
        x: "x, m".into(),
        y: "z, m".into(),
        series: vec![
            Series::new("path", SeriesStyle::Dashes, 5, asked),
            Series::new("walk", SeriesStyle::Line, 0, walked),
        ],
        equal: true,
        ..Plot::default()
    }
}

/// Ten key poses of all over the capture, at times that differ from the recorded ones: shares of the frames, and the
/// papers' kind of times in seconds.
const KEY_SHARES: [f64; 10] = [0.12, 0.25, 0.012, 0.064, 0.15, 0.66, 0.29, 0.47, 0.95, 0.79];
const KEY_SECONDS: [f64; 10] = [0.0, 5.0, 9.2, 10.2, 12.2, 17.8, 19.4, 28.4, 30.4, 36.0];

fn keys(scene: &Scene, section: &mut SectionReport, job: &Job) {
    let frames = f64::from(scene.timeline.frame_count());
    let pose = |share: f64| FrameRef::Number((share * frames) as u32);
    let poses = KEY_SHARES.iter().zip(KEY_SECONDS).map(|(&share, time)| Key { pose: pose(share), time }).collect();
    let answer = ask(scene, None, &Request::new(Target::Keys(KeysRequest { poses })), job, "key poses");
    let goal = answer.as_ref().and_then(|answer| Some((answer, &answer.parts.first()?.goal)));
    let Some((answer, Goal::Keys { rows, mean_error })) = goal else { return };
    let columns = ["pose", "frame", "frame shown", "wanted", "reached", "error"];
    let caption = "Key poses in time (thesis figure 3.18), in frames.";
    let mut table = Table::new("walk_key_poses", caption, &columns);
    for (index, row) in rows.iter().enumerate() {
        let count = |number: u32| Cell::Count(u64::from(number));
        let error = row.reached.map(|reached| f64::from(reached) - f64::from(row.wanted));
        table.rows.push(vec![
            count(index as u32 + 1),
            count(row.frame),
            count(row.shown),
            count(row.wanted),
            row.reached.map_or(Cell::Empty, count),
            error.map_or(Cell::Empty, |error| Cell::Number(error, 0)),
        ]);
    }
    section.tables.push(table);
    let most = rows.iter().filter_map(|row| Some(row.reached?.abs_diff(row.wanted))).max().unwrap_or(0);
    let reached = rows.iter().filter(|row| row.reached.is_some()).count();
    // The papers' frames are 20 ms each.
    let limit = PAPERS_FRAMES * scene.search_graph.fps / PAPERS_FPS;
    section.agreements.push(Agreement {
        papers: "Ten key poses are reached with a mean error of 5 frames at 50 frames a second (thesis figure 3.18).".into(),
        found: format!(
            "{reached} of {} are reached, with a mean error of {mean_error:.2} frames and {most} at most, at {} frames a second; \
             the walk has {} transitions and J {:.1}.",
            rows.len(),
            scene.search_graph.fps,
            answer.walk.transition_count(),
            answer.walk.cost
        ),
        verdict: Verdict::of(reached == rows.len(), reached == rows.len() && *mean_error <= limit),
        why: "Legs are solved exactly over frames and steps, where the papers search depth-first; half a unit of J is given \
              for each frame."
            .into(),
    });
}
