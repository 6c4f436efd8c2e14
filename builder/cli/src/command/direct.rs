//! `builder direct`: a walk is planned, made, and written.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use actor::graph::EssentialGraph;
use actor::motion::{Motion, measure_group};
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk};
use anyhow::{Context, anyhow};
use bundle::BundleReader;
use capture_io::export::{Actor, ExportError, ExportOptions, Output, Written, export, play, play_from};
use capture_io::import::Warning;
use editing::{EditDocument, EditedPoses};
use glam::Vec3;
use job::{Job, Progress as Step};
use kernels::align::Placement;
use search::{
    Answer, Direction, Goal, Progress, Request, RequestError, Scene, SearchGraph, SearchGraphBuilder, Start, Target,
};
use serde::Serialize;
use synthesis::{Varied, VariedPoses};

use super::args::DirectArguments;
use super::asked::{Asked, asked};
use super::failure::Failure;
use super::output::print_json;
use super::rigged;
use super::terminal::Terminal;
use super::walked::{Walked, walked, write_times};

/// By this alternatives are drawn, as in the player.
const VARIETY_SEED: u64 = 1;
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
    /// What is not as in the actor, or may be mistaken.
    warnings: Vec<Warning>,
}

/// What `--json` prints of a sequence.
#[derive(Serialize)]
struct SequenceReport {
    /// Its name.
    sequence: String,
    /// Frames that were written.
    frames: u32,
    /// Where.
    output: String,
    /// What is not as in the actor, or may be mistaken.
    warnings: Vec<Warning>,
}

/// Plans, makes and writes.
pub fn run(arguments: &DirectArguments, terminal: &Terminal) -> Result<(), Failure> {
    let output = Output::parse(&arguments.output).map_err(|error| Failure::Usage(error.to_string()))?;
    if let Some(name) = &arguments.sequence {
        return sequence(name, arguments, &output, terminal);
    }
    let Asked { request, start } = asked(arguments)?;
    let mut reader = read_bundle(&arguments.bundle)?;
    let timeline = reader.timeline_with_families().with_context(|| arguments.bundle.display().to_string());
    let (Some(timeline), Some(mut graph)) = (timeline.map_err(Failure::Input)?, reader.graph().cloned()) else {
        return Err(Failure::Input(anyhow!("{} ends before its graph", arguments.bundle.display())));
    };
    if let Some(quickness) = request.quickness {
        graph.set_alpha(quickness).map_err(|error| Failure::Input(error.into()))?;
    }
    let search_graph = search_graph(&mut reader, &graph, &timeline, &request)?;
    let scene = Scene { graph: &graph, timeline: &timeline, search_graph: &search_graph };
    let began = Instant::now();
    let answer = search(&scene, arguments, start, &request, terminal)?;
    let search_seconds = began.elapsed().as_secs_f64();
    if let Some(path) = &arguments.times {
        write_times(&answer, scene.search_graph.fps, path)?;
    }
    answer.notes().for_each(|note| terminal.log(&format!("note: {note}")));
    members(&request, &scene).iter().for_each(|member| terminal.log(member));

    let [heading, x, z] = answer.start_placement;
    let placement = Placement { heading, translation: glam::Vec2::new(x, z) };
    let begin = (answer.start_frame, placement);
    let (written, centres) =
        write(&mut reader, (&graph, &timeline), begin, &answer.walk, arguments, &output, terminal)?;
    let Written { frames, warnings } = written;
    let walked = walked(&answer, &centres, search_graph.group.is_empty());
    terminal.log(&summary(&answer, &walked, search_seconds, frames, &arguments.output));
    if arguments.json {
        let output = arguments.output.clone();
        print_json(&DirectReport { request, answer, walked, search_seconds, frames, output, warnings })?;
    }
    Ok(())
}

/// Writes a sequence as it was recorded.
fn sequence(name: &str, arguments: &DirectArguments, output: &Output, terminal: &Terminal) -> Result<(), Failure> {
    let mut reader = read_bundle(&arguments.bundle)?;
    let (Some(timeline), Some(graph)) = (reader.timeline().cloned(), reader.graph().cloned()) else {
        return Err(Failure::Input(anyhow!("{} ends before its graph", arguments.bundle.display())));
    };
    let Some(found) = timeline.sequences().iter().find(|sequence| sequence.name == name) else {
        let names: Vec<&str> = timeline.sequences().iter().map(|sequence| sequence.name.as_str()).collect();
        return Err(Failure::Input(anyhow!("there is no sequence {name:?}; there are: {}", names.join(", "))));
    };
    let (first, steps) = (found.first_frame, found.frame_count - 1);
    let legs = vec![Leg::Recorded { first, last: first + steps, steps }];
    let walk = Walk::of_legs(legs, &graph).map_err(|error| Failure::Internal(error.into()))?;
    let begin = (first, Placement::IDENTITY);
    let (written, _) = write(&mut reader, (&graph, &timeline), begin, &walk, arguments, output, terminal)?;
    let Written { frames, warnings } = written;
    terminal.log(&format!("{}: {frames} frames of \"{name}\"", arguments.output));
    if arguments.json {
        let output = arguments.output.clone();
        print_json(&SequenceReport { sequence: name.into(), frames, output, warnings })?;
    }
    Ok(())
}

/// Makes the frames of `walk` and writes them; what was written, and where the centre of mass was in each frame.
fn write(
    reader: &mut BundleReader,
    (graph, timeline): (&EssentialGraph, &Timeline),
    begin: (u32, Placement),
    walk: &Walk,
    arguments: &DirectArguments,
    output: &Output,
    terminal: &Terminal,
) -> Result<(Written, Vec<Vec3>), Failure> {
    let actor = Actor::of(reader).map_err(failure)?;
    let options = ExportOptions {
        every: arguments.every,
        size: arguments.size,
        turn_seconds: arguments.turn.max(0.1) as f32,
        most_texture_bytes: arguments.glb_textures << 20,
    };
    let report = |step: Step| terminal.progress(step);
    let job = Job::new(&report);
    let Some(file) = &arguments.edits else {
        // A sequence is asked for as it was recorded.
        let varied = if arguments.sequence.is_none() { variety(reader, arguments.variety)? } else { None };
        let topology = reader.topology().cloned();
        let order = reader.order().map(<[u32]>::to_vec);
        let (Some(topology), Some(varied)) = (topology, varied) else {
            let mut played = play(reader, graph, timeline, begin, walk).map_err(failure)?;
            let written = export(&actor, &mut played, output, &options, &job).map_err(failure)?;
            written.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
            return Ok((written, played.centres));
        };
        let mut poses = VariedPoses { recorded: reader, varied };
        let mut played =
            play_from(&mut poses, (&topology, order.as_deref()), graph, timeline, begin, walk).map_err(failure)?;
        let written = export(&actor, &mut played, output, &options, &job).map_err(failure)?;
        written.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
        return Ok((written, played.centres));
    };
    let document = read_edits(file)?;
    let (Some(topology), order) = (reader.topology().cloned(), reader.order().map(<[u32]>::to_vec)) else {
        return Err(failure(ExportError::NotWhole));
    };
    let rig = (&document, arguments.rig.as_deref());
    let editor = rigged::editor(reader, (&topology, order.as_deref()), timeline, rig, terminal)?;
    let weights = topology.weights().to_vec();
    let mut edited = EditedPoses::new(reader, (timeline, graph.feet()), &weights, editor, document)
        .with_context(|| file.display().to_string())
        .map_err(Failure::Input)?;
    let notes = edited.prepare().with_context(|| file.display().to_string()).map_err(Failure::Input)?;
    notes.iter().for_each(|note| terminal.log(&format!("note: {note}")));
    let mut played =
        play_from(&mut edited, (&topology, order.as_deref()), graph, timeline, begin, walk).map_err(failure)?;
    let written = export(&actor, &mut played, output, &options, &job).map_err(failure)?;
    written.warnings.iter().for_each(|warning| terminal.log(&format!("warning: {warning}")));
    Ok((written, played.centres))
}

/// The alternatives of recorded stretches, drawn as the player draws them; `None` where there are none or none are wanted.
fn variety(reader: &mut BundleReader, amount: f32) -> Result<Option<Varied>, Failure> {
    if amount <= 0.0 {
        return Ok(None);
    }
    let all = reader.read_alternatives().map_err(|error| Failure::Input(error.into()))?;
    Ok(all.map(|all| Varied::new(Arc::new(all), VARIETY_SEED, amount)))
}

fn read_edits(file: &Path) -> Result<EditDocument, Failure> {
    let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()));
    let document = text.and_then(|text| EditDocument::from_json(&text).with_context(|| file.display().to_string()));
    document.map_err(Failure::Input)
}

fn failure(error: ExportError) -> Failure {
    match error {
        ExportError::Mesh(_) => Failure::Internal(error.into()),
        _ => Failure::Input(error.into()),
    }
}

fn read_bundle(path: &Path) -> Result<BundleReader, Failure> {
    let bytes =
        std::fs::read(path).with_context(|| format!("cannot read {}", path.display())).map_err(Failure::Input)?;
    BundleReader::from_bytes(&bytes).with_context(|| path.display().to_string()).map_err(Failure::Input)
}

/// The ways of the centre of mass, or of the vertices that the request wants to follow its path.
fn search_graph(
    reader: &mut BundleReader,
    graph: &EssentialGraph,
    timeline: &Timeline,
    request: &Request,
) -> Result<SearchGraph, Failure> {
    let ours = |error: actor::pose_source::PoseError| Failure::Input(error.into());
    let Some(topology) = reader.topology() else {
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
    let mut survey = SearchGraphBuilder::new(graph, timeline, &motion, group).map_err(ours)?;
    // Which frames are dead ends.
    survey.advance(graph, timeline, &motion, 0).map_err(ours)?;
    // Nothing else asks where transitions lead, and a second is saved where there are a million.
    if targets.iter().any(|target| matches!(target, Target::Place(_) | Target::Path(_))) {
        while !survey.advance(graph, timeline, &motion, usize::MAX).map_err(ours)? {}
    }
    Ok(survey.finish())
}

/// Which members of families were meant, of a request that asks for some by a number.
fn members(request: &Request, scene: &Scene) -> Vec<String> {
    let targets = match &request.target {
        Target::Queue(targets) => targets.as_slice(),
        target => std::slice::from_ref(target),
    };
    let names = targets.iter().flat_map(|target| match target {
        Target::Behaviour(behaviour) => vec![&behaviour.name],
        Target::Path(path) => path.stretches.iter().map(|stretch| &stretch.behaviour).collect(),
        Target::Wander(wander) => wander.weights.keys().collect(),
        _ => Vec::new(),
    });
    let told = names.filter_map(|name| {
        let member = scene.search_graph.member(scene.search_graph.behaviour(name).ok()?)?;
        let family = &scene.timeline.families()[member.family];
        let sequence = &scene.timeline.sequence_of(member.frames[0])?.name;
        Some(format!("{name}: \"{sequence}\", {} {:.2} {}", family.parameter, member.value, family.unit))
    });
    told.collect()
}

fn search(
    scene: &Scene,
    arguments: &DirectArguments,
    start: Option<Start>,
    request: &Request,
    terminal: &Terminal,
) -> Result<Answer, Failure> {
    let input = |error: RequestError| Failure::Input(error.into());
    let start = match &arguments.start {
        Some(start) => {
            let frame = start.0.find(scene.timeline).map_err(input)?;
            Some(Start { frame, placement: Placement::IDENTITY })
        }
        None => start,
    };
    let mut direction = Direction::new(scene, start, request, arguments.effort).map_err(input)?;
    let mut done = 0;
    while direction.advance(scene, SLICE).map_err(input)? == Progress::Running {
        done += u64::from(SLICE);
        let _ = terminal.progress(Step {
            what: "search",
            done: done.min(arguments.effort.into()),
            total: arguments.effort.into(),
        });
    }
    Ok(direction.best(scene))
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
