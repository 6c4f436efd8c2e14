//! `builder direct`: a walk is planned, made, and written.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow};
use builder::export::{Actor, ExportError, ExportOptions, Output, export, play};
use builder::progress::Progress as Step;
use glam::Vec3;
use serde::Serialize;
use shared::align::Placement;
use shared::bundle::BundleReader;
use shared::search::{
    Answer, Curve, Direction, FrameRef, Goal, KeysRequest, Motion, PathRequest, Progress, Request, RequestError, Scene,
    Shape, Start, Survey, Target, WanderRequest, Ways, WithinSequence, measure_group,
};
use shared::timeline::Timeline;

use super::args::DirectArguments;
use super::failure::Failure;
use super::output::print_json;
use super::terminal::Terminal;

/// States expanded between two looks at the progress bar.
const SLICE: u32 = 500;

/// What `--json` prints.
#[derive(Serialize)]
struct DirectReport {
    /// The request, as it can be given again with `--request`.
    request: Request,
    /// The walk and what it reaches, as planned.
    answer: Answer,
    /// Paths as they were really walked.
    walked: Vec<Walked>,
    /// Seconds of the search until the answer that was taken.
    search_seconds: f64,
    /// Frames that were written.
    frames: u32,
    /// Where.
    output: String,
}

/// A path as it was walked: centres of mass of the frames that were made against the point of equal arc length.
#[derive(Serialize)]
struct Walked {
    /// Index of the part.
    part: usize,
    /// Mean distance in metres.
    mean: f64,
    /// Largest distance in metres.
    max: f64,
    /// Mean distance in metres to the nearest point of the path.
    mean_aside: f64,
    /// The largest such distance.
    max_aside: f64,
}

/// Plans, makes and writes.
pub fn run(arguments: &DirectArguments, terminal: &Terminal) -> Result<(), Failure> {
    let output = Output::parse(&arguments.output).map_err(|error| Failure::Usage(error.to_string()))?;
    let request = request(arguments)?;
    let mut reader = read_bundle(&arguments.bundle)?;
    let (Some(timeline), Some(graph)) = (reader.timeline().cloned(), reader.graph().cloned()) else {
        return Err(Failure::Input(anyhow!("{} ends before its graph", arguments.bundle.display())));
    };
    let ways = ways(&mut reader, &timeline, &request)?;
    let scene = Scene { graph: &graph, timeline: &timeline, ways: &ways };
    let began = Instant::now();
    let answer = search(&scene, arguments, &request, terminal)?;
    let search_seconds = began.elapsed().as_secs_f64();
    answer.notes().for_each(|note| terminal.log(&format!("note: {note}")));

    let [heading, x, z] = answer.start_placement;
    let placement = Placement { heading, translation: glam::Vec2::new(x, z) };
    let actor = Actor::of(&reader).map_err(failure)?;
    let options =
        ExportOptions { every: arguments.every, size: arguments.size, turn_seconds: arguments.turn.max(0.1) as f32 };
    let mut played =
        play(&mut reader, &graph, &timeline, (answer.start_frame, placement), &answer.walk).map_err(failure)?;
    let frames =
        export(&actor, &mut played, &output, &options, &|step: Step| terminal.progress(step)).map_err(failure)?;
    let walked = walked(&answer, &played.centres, ways.group.is_empty());
    terminal.log(&summary(&answer, &walked, search_seconds, frames, &arguments.output));
    if arguments.json {
        let output = arguments.output.clone();
        print_json(&DirectReport { request, answer, walked, search_seconds, frames, output })?;
    }
    Ok(())
}

fn failure(error: ExportError) -> Failure {
    match error {
        ExportError::Mesh(_) => Failure::Ours(error.into()),
        _ => Failure::Input(error.into()),
    }
}

fn read_bundle(path: &Path) -> Result<BundleReader, Failure> {
    let bytes =
        std::fs::read(path).with_context(|| format!("cannot read {}", path.display())).map_err(Failure::Input)?;
    BundleReader::from_bytes(&bytes).with_context(|| path.display().to_string()).map_err(Failure::Input)
}

/// What was asked for, by whichever option.
fn request(arguments: &DirectArguments) -> Result<Request, Failure> {
    let file = |path: &Path| {
        let text = std::fs::read_to_string(path);
        text.with_context(|| format!("cannot read {}", path.display())).map_err(Failure::Input)
    };
    let wrong = |path: &Path, error: &dyn std::fmt::Display| Failure::Input(anyhow!("{}: {error}", path.display()));
    let mut targets = Vec::new();
    if let Some(path) = &arguments.request {
        let request = Request::from_json(&file(path)?).map_err(|error| wrong(path, &error))?;
        return Ok(Request { seed: arguments.seed.unwrap_or(request.seed), ..request });
    }
    if let Some(path) = &arguments.path {
        let request: PathRequest = serde_json::from_str(&file(path)?).map_err(|error| wrong(path, &error))?;
        targets.push(Target::Path(request));
    }
    if let Some(path) = &arguments.keys {
        let request: KeysRequest = toml::from_str(&file(path)?).map_err(|error| wrong(path, &error))?;
        targets.push(Target::Keys(request));
    }
    if let Some(seconds) = arguments.wander {
        targets.push(Target::Wander(WanderRequest { seconds, ..WanderRequest::default() }));
    }
    targets.extend(arguments.to.iter().map(|to| Target::Pose(to.0.clone())));
    let target = match (targets.len(), targets.pop()) {
        (1, Some(target)) => target,
        (_, Some(last)) => Target::Queue(targets.into_iter().chain([last]).collect()),
        (_, None) => {
            return Err(Failure::Usage("say what to do: --path, --keys, --wander, --to or --request".into()));
        }
    };
    let request = Request { seed: arguments.seed.unwrap_or(0), ..Request::new(target) };
    request.check_numbers().map_err(|error| Failure::Input(error.into()))?;
    Ok(request)
}

/// The ways of the centre of mass, or of the vertices that the request wants to follow its path.
fn ways(reader: &mut BundleReader, timeline: &Timeline, request: &Request) -> Result<Ways, Failure> {
    let ours = |error: shared::pose_source::PoseError| Failure::Input(error.into());
    let (Some(topology), Some(graph)) = (reader.topology(), reader.graph().cloned()) else {
        return Err(Failure::Input(anyhow!("the bundle is not whole")));
    };
    let weights = topology.weights().to_vec();
    let motion = match reader.motion() {
        Some(motion) => motion.clone(),
        None => Motion::measure(timeline, &weights, reader).map_err(ours)?,
    };
    let targets = match &request.target {
        Target::Queue(targets) => targets.as_slice(),
        target => std::slice::from_ref(target),
    };
    let group = targets.iter().find_map(|target| match target {
        Target::Path(path) if !path.vertices.is_empty() => Some(path.vertices.clone()),
        _ => None,
    });
    let group = match group {
        Some(vertices) => {
            if let Some(&vertex) = vertices.iter().find(|&&vertex| vertex as usize >= weights.len()) {
                return Err(Failure::Input(RequestError::UnknownVertex(vertex).into()));
            }
            let mut points = Vec::new();
            measure_group(timeline, reader, weights.len(), &vertices, &mut points, u32::MAX).map_err(ours)?;
            Some((vertices, points))
        }
        None => None,
    };
    let mut survey = Survey::new(&graph, timeline, &motion, group).map_err(ours)?;
    while !survey.advance(&graph, timeline, &motion, usize::MAX).map_err(ours)? {}
    Ok(survey.finish())
}

fn search(
    scene: &Scene,
    arguments: &DirectArguments,
    request: &Request,
    terminal: &Terminal,
) -> Result<Answer, Failure> {
    let input = |error: RequestError| Failure::Input(error.into());
    let start = match &arguments.start {
        Some(start) => {
            let frame = start.0.find(scene.timeline).map_err(input)?;
            Some(Start { frame, placement: Placement::IDENTITY })
        }
        None => None,
    };
    let mut direction = Direction::new(scene, start, request, arguments.effort).map_err(input)?;
    let mut done = 0;
    while direction.advance(scene, SLICE).map_err(input)? == Progress::Running {
        done += u64::from(SLICE);
        terminal.progress(Step {
            what: "search",
            done: done.min(arguments.effort.into()),
            total: arguments.effort.into(),
        });
    }
    Ok(direction.best(scene))
}

/// Deviations of the centres of mass that were really walked from each path.
fn walked(answer: &Answer, centres: &[Vec3], is_centre: bool) -> Vec<Walked> {
    let mut walked = Vec::new();
    for (part, planned) in answer.parts.iter().enumerate() {
        let Goal::Path(report) = &planned.goal else { continue };
        let first = planned.first_step as usize;
        let Some(frames) = centres.get(first..=first + planned.steps as usize) else { continue };
        if !is_centre {
            continue;
        }
        let points: Vec<Vec3> = report.curve.iter().map(|&point| point.into()).collect();
        let curve = Curve::new(&points, Shape::Polyline, report.flat, None);
        let mut sums = Walked { part, mean: 0.0, max: 0.0, mean_aside: 0.0, max_aside: 0.0 };
        let mut travelled = 0.0;
        for pair in frames.windows(2) {
            let step = pair[1] - pair[0];
            travelled += f64::from(if report.flat { step.x.hypot(step.z) } else { step.length() });
            let (off, aside) = (curve.distance(pair[1], travelled), curve.nearest(pair[1], travelled));
            (sums.mean, sums.max) = (sums.mean + off, sums.max.max(off));
            (sums.mean_aside, sums.max_aside) = (sums.mean_aside + aside, sums.max_aside.max(aside));
        }
        let count = (frames.len() - 1).max(1) as f64;
        (sums.mean, sums.mean_aside) = (sums.mean / count, sums.mean_aside / count);
        walked.push(sums);
    }
    walked
}

fn summary(answer: &Answer, walked: &[Walked], seconds: f64, frames: u32, output: &str) -> String {
    let mut lines = vec![format!(
        "a walk of {:.2} s through {} transitions, cost {:.2}, deformation {:.2}; searched for {seconds:.2} s",
        answer.seconds,
        answer.walk.transition_count(),
        answer.walk.cost,
        answer.walk.deformation
    )];
    for path in walked {
        lines.push(format!(
            "path: {:.1} cm off on average and {:.1} cm at most (nearest point: {:.1} and {:.1} cm)",
            100.0 * path.mean,
            100.0 * path.max,
            100.0 * path.mean_aside,
            100.0 * path.max_aside
        ));
    }
    for part in &answer.parts {
        if let Goal::Keys { rows, mean_error } = &part.goal {
            let row = |number: Option<u32>| number.map_or("-".into(), |number| number.to_string());
            lines.push("pose     wanted    reached (frames)".into());
            lines.extend(rows.iter().map(|r| format!("{:<8} {:<9} {}", r.frame, r.wanted, row(r.reached))));
            lines.push(format!("mean error: {mean_error:.2} frames"));
        }
        if let Goal::Wander { objectives: [even, proxy, now], frames } = &part.goal {
            lines.push(format!(
                "wandering over {frames} frames; objective {even:.4} even, {proxy:.4} proxy, {now:.4} used"
            ));
        }
    }
    lines.push(format!("{output}: {frames} frames"));
    lines.join("\n")
}

/// A pose as it is typed: a frame's number, or `NAME:SECONDS`.
#[derive(Clone, Debug)]
pub struct TypedPose(FrameRef);

/// Reads a pose as it is typed.
pub fn parse_pose(text: &str) -> Result<TypedPose, String> {
    if let Ok(number) = text.parse() {
        return Ok(TypedPose(FrameRef::Number(number)));
    }
    let (name, time) = text.rsplit_once(':').unwrap_or((text, "0"));
    let time: f64 = time.parse().map_err(|_| format!("{time:?} is no time in seconds"))?;
    let within = WithinSequence { sequence: name.into(), frame: None, time: Some(time) };
    Ok(TypedPose(FrameRef::Within(within)))
}

/// Reads a duration as it is typed: `60`, `60s` or `2min`.
pub fn parse_seconds(text: &str) -> Result<f64, String> {
    let (number, unit) = match text {
        text if text.ends_with("min") => (&text[..text.len() - 3], 60.0),
        text if text.ends_with('s') => (&text[..text.len() - 1], 1.0),
        text => (text, 1.0),
    };
    let seconds: f64 = number.trim().parse().map_err(|_| format!("{text:?} is no duration, such as 60s"))?;
    if seconds.is_finite() && seconds >= 0.0 { Ok(seconds * unit) } else { Err("a duration is not negative".into()) }
}

/// Reads a size in pixels as it is typed: `720x720`.
pub fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let wrong = || format!("{text:?} is no size, such as 720x720, of 16 to 4096 pixels");
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let side = |side: &str| side.parse().ok().filter(|side| (16..=4096).contains(side)).ok_or_else(wrong);
    Ok((side(width)?, side(height)?))
}
