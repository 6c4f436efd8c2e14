//! Section 7: size and speed of each stage, and how they grow with the frames n and the triangles M.

use std::time::Instant;

use actor::capture::Poses;
use actor::timeline::Timeline;
use bundle::{self, BundleInput, default_max_error};
use kernels::cholesky::elimination_order;
use kernels::topology::Topology;

use super::EvaluateError;
use super::document::{Cell, SectionReport, Table};
use super::performance::{Performance, Recordings};
use super::plot::{Plot, Series, SeriesStyle};
use super::statistics::fit_exponent;
use super::subject::Subject;
use job::Job;
use job::memory;
use kernels::random::mix;
use pipeline::distance::{DistanceOptions, measure};
use pipeline::essential::essential_edges;
use pipeline::transitions::{LengthChoice, TransitionOptions, optimal_transitions};

/// Shares of the frames and of the triangles that are tried.
const SHARES: [f64; 3] = [0.25, 0.5, 1.0];
/// In-betweens that are timed.
const IN_BETWEENS: u64 = 100;

/// A stage's time for a size.
struct Time {
    stage: &'static str,
    frames: usize,
    triangles: usize,
    wall: f64,
    /// Of all threads together.
    cpu: Option<f64>,
}

/// Makes the section.
pub(super) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let mut times = Vec::new();
    for (done, share) in SHARES.into_iter().enumerate() {
        job.tell("scaling in n", done as u64, SHARES.len() as u64)?;
        by_frames(subject, share, &mut times)?;
    }
    let mut by_triangles = Vec::new();
    for (done, share) in SHARES.into_iter().enumerate() {
        job.tell("scaling in M", done as u64, SHARES.len() as u64)?;
        distances_of_part(subject, share, &mut by_triangles)?;
    }
    let in_betweens = in_betweens(subject)?;
    let (bundle, bundle_time) = encode(subject, job)?;
    times.push(bundle_time);
    let mut section = SectionReport::default();
    section.text.push(format!(
        "Times of one run in this process, on whatever else the machine was doing: processor time is the steadier \
         figure. They differ from run to run; all other tables are the same for the same seed. Peak memory of the whole \
         evaluation, which holds all poses and several matrices of n \u{d7} n: {}.",
        memory::peak_bytes().map_or("unknown".into(), |bytes| format!("{:.0} MB", bytes as f64 / 1e6))
    ));
    section.text.push(format!(
        "{IN_BETWEENS} Poisson in-betweens of frames drawn at random, each with its own factor, one thread: {:.0} a \
         second of processor time.",
        1.0 / in_betweens
    ));
    section.tables = vec![stages(&times, &by_triangles), exponents(&times, &by_triangles), sizes(&bundle)];
    section.plots = vec![plot(&times)];
    Ok(section)
}

/// The processor time of all threads of this process so far, in seconds, where the system tells.
fn cpu_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Fields 14 and 15, counted after the name in brackets, in hundredths of a second.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let (user, system): (f64, f64) = (fields.next()?.parse().ok()?, fields.next()?.parse().ok()?);
    Some((user + system) / 100.0)
}

fn timed<T>(stage: &'static str, frames: usize, triangles: usize, work: impl FnOnce() -> T) -> (T, Time) {
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let result = work();
    let cpu = cpu_seconds().zip(cpu).map(|(after, before)| after - before);
    (result, Time { stage, frames, triangles, wall: start.elapsed().as_secs_f64(), cpu })
}

/// Times the stages on the first sequences that hold a share of the frames.
fn by_frames(subject: &Subject, share: f64, times: &mut Vec<Time>) -> Result<(), EvaluateError> {
    let timeline = subject.timeline();
    let wanted = share * f64::from(timeline.frame_count());
    let mut sequences = Vec::new();
    for sequence in timeline.sequences() {
        sequences.push(sequence.clone());
        if f64::from(sequence.end_frame()) >= wanted {
            break;
        }
    }
    let Ok(part) = Timeline::new(timeline.fps(), sequences) else { return Ok(()) };
    let frames = part.frame_count() as usize;
    if times.iter().any(|time| time.frames == frames) {
        return Ok(());
    }
    let topology = &subject.capture.topology;
    let mut poses = Poses::new(topology.vertex_count());
    subject.capture.poses.iter().take(frames).for_each(|pose| poses.push(pose));
    let triangles = topology.triangles().len();
    let options = DistanceOptions::default();
    let (measured, time) =
        timed("distances", frames, triangles, || measure(topology, &poses, &options, &Job::silent()));
    times.push(time);
    let distances = measured?.distances;
    for (stage, choice) in
        [("transitions, by the mean", LengthChoice::Mean), ("transitions, by the sum", LengthChoice::Total)]
    {
        let options = TransitionOptions { choice, ..subject.options.transition };
        let search = || optimal_transitions(&distances, &part, &options, &Job::silent());
        let (transitions, time) = timed(stage, frames, triangles, search);
        times.push(time);
        if choice == LengthChoice::Total {
            let transitions = transitions?;
            let alpha = subject.options.alpha;
            let (graph, time) =
                timed("essential graph", frames, triangles, || essential_edges(&transitions, &part, alpha));
            times.push(time);
            graph?;
        }
    }
    Ok(())
}

/// Times the distances over a share of the triangles; no other stage of all pairs depends on them.
fn distances_of_part(subject: &Subject, share: f64, times: &mut Vec<Time>) -> Result<(), EvaluateError> {
    let topology = &subject.capture.topology;
    let count = ((topology.triangles().len() as f64 * share) as usize).max(1);
    let triangles = topology.triangles()[..count].to_vec();
    let weights = topology.weights().to_vec();
    let Ok(part) = Topology::new(topology.vertex_count() as u32, triangles, weights) else { return Ok(()) };
    // Half of the frames tell as much in a quarter of the time.
    let frames = subject.frame_count().div_ceil(2);
    let mut poses = Poses::new(topology.vertex_count());
    subject.capture.poses.iter().take(frames).for_each(|pose| poses.push(pose));
    let options = DistanceOptions::default();
    let (measured, time) = timed("distances", frames, count, || measure(&part, &poses, &options, &Job::silent()));
    times.push(time);
    measured?;
    Ok(())
}

/// Seconds of processor time for a Poisson in-between of any two frames.
fn in_betweens(subject: &Subject) -> Result<f64, EvaluateError> {
    let order = elimination_order(&subject.capture.topology);
    let recordings = Recordings::of(&subject.capture, &subject.measured.headings, &subject.centres, &subject.contacts);
    let mut stage = Performance::new(recordings, &order)?;
    let (n, seed) = (subject.frame_count() as u64, subject.options.seed);
    let frame = |index: u64| (mix(seed, index) % n) as u32;
    let (made, time) = timed("in-betweens", 0, 0, || {
        (0..IN_BETWEENS).try_for_each(|index| {
            let (i, j) = (frame(2 * index), frame(2 * index + 1));
            let (a, b) = (subject.capture.poses.frame(i), subject.capture.poses.frame(j));
            stage.between((i, a), (j, b), 0.5).map(|_| ())
        })
    });
    made?;
    Ok(time.cpu.unwrap_or(time.wall).max(1e-9) / IN_BETWEENS as f64)
}

fn encode(subject: &Subject, job: &Job) -> Result<(Option<bundle::EncodeReport>, Time), EvaluateError> {
    let graph = subject.graph(LengthChoice::Total, job)?;
    job.begin("bundle")?;
    let order = elimination_order(&subject.capture.topology);
    let input = BundleInput {
        capture: &subject.capture,
        graph: &graph,
        first_frame: 0,
        max_error: default_max_error(&subject.capture, 0),
        poisson_order: Some(&order),
        generator: format!("Reprise builder {}", env!("CARGO_PKG_VERSION")),
    };
    let triangles = subject.capture.topology.triangles().len();
    let (encoded, time) = timed("bundle", subject.frame_count(), triangles, || bundle::encode(&input));
    // A capture that cannot be bundled is no failure of its evaluation.
    Ok((encoded.ok().map(|(_, report)| report), time))
}

fn stages(times: &[Time], by_triangles: &[Time]) -> Table {
    let mut table =
        Table::new("stages", "Times by stage and size.", &["stage", "frames", "triangles", "wall, s", "processor, s"]);
    table.timed = true;
    for time in times.iter().chain(by_triangles) {
        table.rows.push(vec![
            time.stage.into(),
            Cell::Count(time.frames as u64),
            Cell::Count(time.triangles as u64),
            Cell::Number(time.wall, 2),
            time.cpu.map_or(Cell::Empty, |cpu| Cell::Number(cpu, 2)),
        ]);
    }
    table
}

fn exponents(times: &[Time], by_triangles: &[Time]) -> Table {
    let mut table = Table::new(
        "exponents",
        "Exponents e of n^e and M^e fitted to the processor times above, with the share of variance explained. All pairs \
         are n\u{b2}; shortest paths n\u{b3}.",
        &["stage", "grows with", "exponent", "explained", "sizes"],
    );
    table.timed = true;
    let mut add = |stage: &'static str, with: &str, points: Vec<(f64, f64)>| {
        let Some(fit) = fit_exponent(&points).filter(|_| points.len() >= 3) else { return };
        table.rows.push(vec![
            stage.into(),
            with.into(),
            Cell::Number(fit.slope, 2),
            Cell::Number(fit.explained, 3),
            Cell::Count(points.len() as u64),
        ]);
    };
    for stage in STAGES {
        let of = times.iter().filter(|time| time.stage == stage);
        add(stage, "n", of.map(|time| (time.frames as f64, time.cpu.unwrap_or(time.wall))).collect());
    }
    let of = by_triangles.iter();
    add("distances", "M", of.map(|time| (time.triangles as f64, time.cpu.unwrap_or(time.wall))).collect());
    table
}

const STAGES: [&str; 4] = ["distances", "transitions, by the sum", "transitions, by the mean", "essential graph"];

fn sizes(bundle: &Option<bundle::EncodeReport>) -> Table {
    let mut table = Table::new("size", "The bundle, without appearance.", &["what", "value"]);
    let Some(bundle) = bundle else { return table };
    table.rows = vec![
        vec!["bundle, bytes".into(), Cell::Count(bundle.bytes)],
        vec!["positions, bytes a frame".into(), Cell::Number(bundle.bytes_per_frame, 0)],
        vec!["error of positions, RMS, mm".into(), Cell::Number(bundle.rms_error * 1e3, 3)],
        vec!["error of positions, most, mm".into(), Cell::Number(bundle.max_error * 1e3, 3)],
    ];
    table
}

fn plot(times: &[Time]) -> Plot {
    let series = STAGES.into_iter().enumerate().map(|(colour, stage)| {
        let points = times.iter().filter(|time| time.stage == stage);
        let place = |time: &Time| ((time.frames as f64).log10(), time.cpu.unwrap_or(time.wall).max(1e-3).log10());
        Series::new(stage, SeriesStyle::DottedLine, colour, points.map(place).collect())
    });
    Plot {
        caption: "Processor time by number of frames, both in powers of ten.".into(),
        x: "log\u{2081}\u{2080} of frames".into(),
        y: "log\u{2081}\u{2080} of seconds".into(),
        series: series.collect(),
        ..Plot::default()
    }
}
