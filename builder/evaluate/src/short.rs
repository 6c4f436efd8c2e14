//! `builder report`: the short version for one's own bundle. What is in it, how good its transitions are, which
//! sequences are islands, its worst seams, and what to capture next.

use actor::capture::{Capture, Poses};
use actor::graph::EssentialGraph;
use actor::pose_source::PoseSource;
use actor::timeline::Sequence;
use actor::walk::{Leg, Walk};
use bundle::{BundleError, BundleReader};
use glam::{Vec2, Vec3};
use kernels::cholesky::elimination_order;
use rayon::prelude::*;
use search::cheapest_walk;
use thiserror::Error;

use super::EvaluateError;
use super::body;
use super::clay::{self, Camera};
use super::document::{Cell, Document, Picture, SectionReport, Table};
use super::performance::{Performance, Recordings};
use super::plot::{Plot, Series, SeriesStyle, histogram};
use super::seams::{self, Change, Ease, Own, SeamSummary, Seams};
use super::seen;
use super::statistics::{Moments, percentile};
use super::subject::progress_of;
use job::Job;
use kernels::random::mix;
use pipeline::essential::{StrongComponents, strongly_connected};

/// Transitions whose seams are measured.
const SEAM_TRANSITIONS: usize = 600;
/// Worst seams that are shown.
const PICTURES: usize = 6;
/// Suggestions of what to capture next.
const SUGGESTIONS: usize = 6;

/// Why there is no report.
#[derive(Debug, Error)]
pub enum ReportError {
    /// The bundle cannot be read.
    #[error(transparent)]
    Bundle(#[from] BundleError),
    /// The bundle ends too early.
    #[error("the bundle ends before its graph")]
    Incomplete,
    /// Its transitions cannot be made.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// A pose cannot be read.
    #[error(transparent)]
    Pose(#[from] actor::pose_source::PoseError),
    /// Its mesh cannot be interpolated.
    #[error(transparent)]
    Cholesky(#[from] kernels::cholesky::CholeskyError),
    /// Its parts do not fit together.
    #[error(transparent)]
    Capture(#[from] actor::capture::CaptureError),
    /// A picture cannot be encoded.
    #[error("a picture cannot be encoded: {0}")]
    Picture(#[from] image::ImageError),
}

/// A bundle, whole in memory.
struct Actor {
    bytes: usize,
    capture: Capture,
    graph: EssentialGraph,
    centres: Vec<Vec2>,
    /// The number of each vertex's part of the body, where parts were painted.
    parts: Option<Vec<u8>>,
}

/// The report on the bundle of `bytes`.
///
/// # Errors
/// A bundle that cannot be read or whose transitions cannot be made.
pub fn report_on(bytes: &[u8], job: &Job) -> Result<Document, ReportError> {
    let actor = read(bytes)?;
    let edges: Vec<(u32, u32)> = actor.graph.transitions().iter().map(|t| (t.from, t.to)).collect();
    let components = strongly_connected(&actor.capture.timeline, &edges);
    let walks = walks(&actor);
    let mut sections =
        vec![contents(&actor), quality(&actor, &walks), islands(&actor, &components), seam_section(&actor, job)?];
    let order = elimination_order(&actor.capture.topology);
    sections.push(seen::section(&actor.capture, &order, &actor.graph, job)?);
    sections.push(body::section(&actor.capture, actor.parts.as_deref())?);
    sections.push(suggestions(&actor, &components, &walks));
    for (index, section) in sections.iter_mut().enumerate() {
        section.number = index as u8 + 1;
    }
    let fact = |name: &str, value: String| (name.to_owned(), value);
    Ok(Document {
        title: format!("{}: report", actor.capture.name),
        lead: "What this actor can do, and where it will show that it is put together.".into(),
        facts: vec![
            fact(
                "Frames",
                format!("{} at {} a second", actor.capture.timeline.frame_count(), actor.capture.timeline.fps()),
            ),
            fact("Sequences", actor.capture.timeline.sequences().len().to_string()),
            fact("Vertices", actor.capture.topology.vertex_count().to_string()),
            fact("Transitions", actor.graph.transitions().len().to_string()),
            fact("Bundle", format!("{:.2} MB", actor.bytes as f64 / 1e6)),
        ],
        sections,
    })
}

fn read(bytes: &[u8]) -> Result<Actor, ReportError> {
    let mut reader = BundleReader::from_bytes(bytes)?;
    let (Some(meta), Some(timeline), Some(topology), Some(surface), Some(graph)) = (
        reader.meta(),
        reader.timeline().cloned(),
        reader.topology().cloned(),
        reader.surface().cloned(),
        reader.graph().cloned(),
    ) else {
        return Err(ReportError::Incomplete);
    };
    let name = meta.name.clone();
    let mut poses = Poses::new(topology.vertex_count());
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    for frame in 0..timeline.frame_count() {
        reader.read(frame, &mut pose)?;
        poses.push(&pose);
    }
    let centres = poses.ground_centres(topology.weights());
    let capture = Capture::new(name, topology, surface, timeline, poses)?;
    Ok(Actor { bytes: bytes.len(), capture, graph, centres, parts: reader.body_parts()? })
}

impl Actor {
    fn sequences(&self) -> &[Sequence] {
        self.capture.timeline.sequences()
    }

    fn name_of(&self, frame: u32) -> &str {
        self.capture.timeline.sequence_of(frame).map_or("", |sequence| &sequence.name)
    }

    /// A frame, as a reader finds it again.
    fn place(&self, frame: u32) -> String {
        let first = self.capture.timeline.sequence_of(frame).map_or(0, |sequence| sequence.first_frame);
        format!("{} {:.2} s", self.name_of(frame), (frame - first) as f32 / self.capture.timeline.fps())
    }

    fn recordings(&self) -> Recordings<'_> {
        Recordings {
            topology: &self.capture.topology,
            timeline: &self.capture.timeline,
            poses: &self.capture.poses,
            headings: None,
            centres: &self.centres,
            contacts: self.graph.contacts(),
        }
    }
}

/// Cheapest walks from the middle of each sequence to the middle of each other, by row.
fn walks(actor: &Actor) -> Vec<Vec<Option<Walk>>> {
    let middle = |sequence: &Sequence| sequence.first_frame + sequence.frame_count / 2;
    let walk =
        |from: &Sequence, to: &Sequence| cheapest_walk(&actor.graph, &actor.capture.timeline, middle(from), middle(to));
    let row = |from: &Sequence| actor.sequences().iter().map(|to| walk(from, to)).collect();
    actor.sequences().par_iter().map(row).collect()
}

fn contents(actor: &Actor) -> SectionReport {
    let mut section = SectionReport::new(0, "What is in it");
    let mut table = Table::new(
        "contents",
        "Sequences, and how many transitions leave and enter each.",
        &["sequence", "labels", "seconds", "frames", "transitions out", "in", "cyclic"],
    );
    for sequence in actor.sequences() {
        let count = |end: fn(&actor::graph::Transition) -> u32| {
            let away = |t: &&actor::graph::Transition| sequence.contains(t.from) != sequence.contains(t.to);
            let here = actor.graph.transitions().iter().filter(away).filter(|t| sequence.contains(end(t)));
            Cell::Count(here.count() as u64)
        };
        table.rows.push(vec![
            sequence.name.as_str().into(),
            sequence.labels.join(", ").into(),
            Cell::Number(f64::from(sequence.frame_count as f32 / actor.capture.timeline.fps()), 2),
            Cell::Count(sequence.frame_count.into()),
            count(|transition| transition.from),
            count(|transition| transition.to),
            if sequence.cyclic { "yes" } else { "no" }.into(),
        ]);
    }
    section.tables.push(table);
    section
}

fn quality(actor: &Actor, walks: &[Vec<Option<Walk>>]) -> SectionReport {
    let mut section = SectionReport::new(0, "How good its transitions are");
    let costs: Vec<f64> = actor
        .graph
        .transitions()
        .iter()
        .map(|transition| f64::from(transition.deformation) / transition.warp.duration() as f64)
        .collect();
    let at = |share| percentile(&costs, share).unwrap_or(0.0);
    section.text.push(format!(
        "A transition turns each triangle by {:.2} radians on average over its frames (a tenth of them by less than {:.2}, \
         a tenth by more than {:.2}). Below about 0.3 a blend is hard to tell from a recording; above about 0.6 the poses \
         have little in common.",
        Moments::of(costs.iter().copied()).mean,
        at(0.1),
        at(0.9)
    ));
    let names: Vec<&str> = actor.sequences().iter().map(|sequence| sequence.name.as_str()).collect();
    let mut columns = vec!["from \\ to"];
    columns.extend(&names);
    let mut table = Table::new(
        "walks",
        "The way from the middle of a sequence to the middle of another: mean deformation of its synthetic frames, in \
         radians, and its duration in seconds.",
        &columns,
    );
    for (name, row) in names.iter().zip(walks) {
        let cell = |walk: &Option<Walk>| match walk {
            Some(walk) => {
                let seconds = walk.duration as f32 / actor.capture.timeline.fps();
                let frames = synthetic_frames(actor, walk);
                if frames == 0 {
                    format!("0 / {seconds:.1}")
                } else {
                    format!("{:.2} / {seconds:.1}", walk.deformation / frames as f64)
                }
            }
            None => "none".into(),
        };
        table.rows.push(std::iter::once((*name).into()).chain(row.iter().map(|walk| cell(walk).into())).collect());
    }
    section.tables.push(table);
    section.plots.push(Plot {
        caption: "Mean deformation of each transition.".into(),
        x: "radians a frame".into(),
        y: "share of transitions".into(),
        series: vec![Series::new("", SeriesStyle::Bars, 0, histogram(&costs, 30))],
        ..Plot::default()
    });
    section
}

fn synthetic_frames(actor: &Actor, walk: &Walk) -> usize {
    let transitions = walk.legs.iter().filter_map(Leg::transition);
    let durations =
        transitions.filter_map(|index| Some(actor.graph.transitions().get(index as usize)?.warp.duration()));
    durations.sum()
}

fn islands(actor: &Actor, components: &StrongComponents) -> SectionReport {
    let mut section = SectionReport::new(0, "Islands");
    let mut table = Table::new(
        "islands",
        "Frames of each sequence from which every other can be reached and that can be reached from every other (the \
         largest strongly connected component).",
        &["sequence", "frames connected", "of", "verdict"],
    );
    let mut alone = Vec::new();
    for sequence in actor.sequences() {
        let frames = sequence.first_frame..sequence.end_frame();
        let here = |frame: &u32| components.component_of_frame.get(*frame as usize) == Some(&components.largest);
        let connected = frames.clone().filter(here).count() as u64;
        let leaves = frames.clone().any(|f| {
            actor.graph.transitions_from(f).any(|index| !sequence.contains(actor.graph.transitions()[index].to))
        });
        let entered = actor.graph.transitions().iter().any(|t| sequence.contains(t.to) && !sequence.contains(t.from));
        let verdict = match (connected > 0, leaves, entered) {
            (true, ..) => "connected",
            (_, false, false) => "island",
            (_, false, true) => "no way out",
            (_, true, false) => "no way in",
            (_, true, true) => "apart",
        };
        if connected == 0 {
            alone.push(format!("{} ({verdict})", sequence.name));
        }
        table.rows.push(vec![
            sequence.name.as_str().into(),
            Cell::Count(connected),
            Cell::Count(sequence.frame_count.into()),
            verdict.into(),
        ]);
    }
    section.text.push(if alone.is_empty() {
        "No sequence is an island: from each, every other can be reached and left again. Frames that are not connected \
         are the last ones of a sequence, from where no blend fits any more, and the first ones, where none can end."
            .into()
    } else {
        format!("Not connected to the rest: {}.", alone.join(", "))
    });
    section.tables.push(table);
    section
}

fn seam_section(actor: &Actor, job: &Job) -> Result<SectionReport, ReportError> {
    let mut section = SectionReport::new(0, "Seams");
    let order = elimination_order(&actor.capture.topology);
    let recordings = actor.recordings();
    let own = Own::of(&recordings);
    let limit = own.percentile(0.99);
    let count = actor.graph.transitions().len();
    let mut keyed: Vec<(u64, usize)> = (0..count).map(|index| (mix(1, index as u64), index)).collect();
    keyed.sort_unstable();
    let mut chosen: Vec<usize> = keyed.into_iter().take(SEAM_TRANSITIONS).map(|(_, index)| index).collect();
    chosen.sort_unstable();
    let progress = progress_of(job, "seams");
    let mut seams = seams::measure(recordings, &order, actor.graph.transitions(), &chosen, Ease::Smooth, &progress)?;
    let summary = SeamSummary::of(&seams, limit);
    section.text.push(format!(
        "{} seams of {} of {count} transitions, against the capture\u{2019}s own change from frame to frame: {} change \
         geometry and {} change velocity more than 99 % of the recorded frames do ({:.1} mm and {:.1} mm a frame, root \
         mean squares).",
        summary.count,
        chosen.len(),
        summary.above[0],
        summary.above[1],
        limit.geometry * 1e3,
        limit.velocity * 1e3
    ));
    seams.sort_by(|a, b| b.worst_velocity().total_cmp(&a.worst_velocity()).then(a.transition.cmp(&b.transition)));
    let mut table = Table::new(
        "worst_seams",
        "The worst of them by change of velocity; the pictures show the frame at the seam, red where the velocity \
         changes most.",
        &["from", "to", "velocity at its start, mm a frame", "at its end", "mean deformation, rad"],
    );
    let mut stage = Performance::new(recordings, &order)?;
    for seam in seams.iter().take(PICTURES) {
        let transition = &actor.graph.transitions()[seam.transition];
        let cell = |change: Option<Change>| change.map_or(Cell::Empty, |change| Cell::Number(change.velocity * 1e3, 1));
        table.rows.push(vec![
            actor.place(transition.from).into(),
            actor.place(transition.to).into(),
            cell(seam.start),
            cell(seam.end),
            Cell::Number(f64::from(transition.deformation) / transition.warp.duration() as f64, 3),
        ]);
        section.pictures.extend(picture(actor, &mut stage, seam)?);
    }
    section.tables.push(table);
    Ok(section)
}

/// The frame at the worse seam of a transition, coloured by change of velocity.
fn picture(actor: &Actor, stage: &mut Performance, seam: &Seams) -> Result<Option<Picture>, ReportError> {
    let transition = &actor.graph.transitions()[seam.transition];
    let blends = actor.recordings().blends(transition).map_err(EvaluateError::from)?;
    let [first, second, .., before_last, last] = blends.as_slice() else { return Ok(None) };
    let worth = |change: Option<Change>| change.map_or(0.0, |change| change.velocity);
    let at_start = worth(seam.start) >= worth(seam.end);
    let recorded = |frame: u32, step, placement| {
        let frame = actor.capture.timeline.offset(frame, step).unwrap_or(frame);
        actor.recordings().placed(frame, placement)
    };
    let frames = if at_start {
        let before = recorded(transition.from, -1, first.placements[0]);
        [before, stage.pose(first, 0.0)?, stage.pose(second, second.lambda)?]
    } else {
        let after = recorded(transition.to, 1, last.placements[1]);
        [stage.pose(before_last, before_last.lambda)?, stage.pose(last, 1.0)?, after]
    };
    let [before, at, after] = &frames;
    let changes: Vec<f32> =
        before.iter().zip(at).zip(after).map(|((b, m), a)| ((*a - *m) - (*m - *b)).length()).collect();
    let most = changes.iter().copied().fold(1e-6, f32::max);
    let clay = Vec3::new(0.62, 0.60, 0.57);
    let red = Vec3::new(0.80, 0.07, 0.04);
    let colours: Vec<Vec3> = changes.iter().map(|change| clay.lerp(red, (change / most).powi(2))).collect();
    let camera = Camera::framing(at, [300, 360], 0.6);
    let drawn = clay::draw(at, actor.capture.topology.triangles(), &colours, &camera);
    let [here, there] = [transition.from, transition.to].map(|frame| actor.place(frame));
    let caption = if at_start {
        format!("Leaving {here} for {there}: up to {:.0} mm a frame at a vertex.", most * 1e3)
    } else {
        format!("Arriving at {there} from {here}: up to {:.0} mm a frame at a vertex.", most * 1e3)
    };
    Ok(Some(Picture { png: clay::png(&drawn)?, size: camera.size, caption }))
}

fn suggestions(actor: &Actor, components: &StrongComponents, walks: &[Vec<Option<Walk>>]) -> SectionReport {
    let mut section = SectionReport::new(0, "What to capture next");
    let mut costly = Vec::new();
    for (from, row) in actor.sequences().iter().zip(walks) {
        for (to, walk) in actor.sequences().iter().zip(row).filter(|(to, _)| to.name != from.name) {
            let cost = walk.as_ref().map_or(f64::INFINITY, |walk| walk.deformation);
            costly.push((cost, from.name.as_str(), to.name.as_str()));
        }
    }
    costly.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)).then(a.2.cmp(b.2)));
    let mut table = Table::new(
        "suggestions",
        "The most deforming ways between sequences, from middle to middle. A take in which the actor goes from the one to \
         the other by itself would replace what is blended now.",
        &["record a take from", "to", "deformation on the way now"],
    );
    for (cost, from, to) in costly.into_iter().take(SUGGESTIONS) {
        let cost = if cost.is_finite() { Cell::Number(cost, 2) } else { "there is no way".into() };
        table.rows.push(vec![from.into(), to.into(), cost]);
    }
    section.tables.push(table);
    let n = actor.capture.timeline.frame_count();
    let loose = n as usize - components.largest_frames().count();
    let shortest = actor.graph.transitions().iter().map(|t| t.warp.lengths().0).min().unwrap_or(0);
    section.text.push(format!(
        "{loose} of {n} frames cannot be used as targets to go on from: at the end of a take, {shortest} frames are needed \
         to blend out of it, and as many to blend into its beginning. Let each take run on for about {:.1} s longer than \
         the action, best into a pose that other takes begin with.",
        shortest as f32 / actor.capture.timeline.fps()
    ));
    section
}
