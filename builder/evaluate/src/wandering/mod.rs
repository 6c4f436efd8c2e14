//! Section 10: wandering (Prada and others 2016, section 7.1). The chain's objective, and what walks of five minutes do.

mod measure;

use actor::motion::Motion;
use actor::walk::Walk;
use kernels::cholesky::elimination_order;
use search::{DEFAULT_EFFORT, Direction, Goal, Progress as Found, Request, Scene, SearchGraph, Target, WanderRequest};

pub use self::measure::Wandered;
pub(super) use self::measure::{edges, longest_repeat};
use super::EvaluateError;
use super::document::{Agreement, Cell, SectionReport, Table, Verdict};
use super::motion::{Begun, Borrowed, Own, frames_table, percent, show};
use super::statistics::percentile;
use super::subject::{Subject, progress_of};
use job::Job;

/// Seconds of a walk, and of it those that are made frame by frame.
const SECONDS: f64 = 300.0;
const SHOWN_SECONDS: f64 = 60.0;
/// Walks, each with a seed of its own.
const WALKS: u64 = 4;
/// States expanded between two reports of progress.
const SLICE: u32 = 2_000;

/// Our marks: shares of the frames shown and of the steps that are synthetic, seconds at a stretch, and how much more often
/// one place is visited than another.
const MARKS: [f64; 4] = [0.9, 0.25, 1.0, 3.0];

/// A walk that wandering took.
struct Taken {
    begun: Begun,
    wandered: Wandered,
    objectives: [f64; 3],
    frames: u32,
    /// Seconds until the answer, of this walk and of one of 20 s.
    searched: f64,
}

/// Makes the section.
pub(super) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let graph = subject.graph(subject.options.transition.choice, job)?;
    let timeline = subject.timeline();
    let weights = subject.capture.topology.weights();
    let motion = Motion::measure(timeline, weights, &mut Borrowed(&subject.capture.poses))?;
    let search_graph = SearchGraph::new(&graph, timeline, &motion)?;
    let scene = Scene { graph: &graph, timeline, search_graph: &search_graph };
    let mut taken = Vec::new();
    for seed in subject.options.seed..subject.options.seed + WALKS {
        job.tell("wandering", seed - subject.options.seed, WALKS)?;
        let Some(walk) = wander(&scene, seed, SECONDS) else {
            return Ok(super::missing("The graph has no loop to wander in."));
        };
        taken.push(walk);
    }
    let mut section = SectionReport::default();
    let fps = f64::from(timeline.fps());
    section.tables.extend([
        walks_table(&taken, fps),
        places_table(&taken),
        chain_table(&taken),
        times_table(&scene, &taken),
    ]);
    section.agreements.extend(agreements(&taken, fps, timeline_allows(&search_graph)));
    let own = Own::of(&subject.capture);
    let mut frames = frames_table(&own);
    frames.name = "wandering_frames";
    let most = (SHOWN_SECONDS * fps) as usize;
    let order = elimination_order(&subject.capture.topology);
    let begun: Vec<Begun> = taken.iter().take(2).map(|taken| taken.begun.clone()).collect();
    let shown = show(&subject.capture, &order, &graph, &begun, most, &progress_of(job, "walks"))?;
    frames.rows.push(own.compare("wandering", (&subject.capture, &graph), &shown));
    section.tables.push(frames);
    Ok(section)
}

/// A walk of five minutes.
pub(super) fn walk(scene: &Scene, seed: u64) -> Option<Walk> {
    wander(scene, seed, SECONDS).map(|taken| taken.begun.walk)
}

fn wander(scene: &Scene, seed: u64, seconds: f64) -> Option<Taken> {
    let began = std::time::Instant::now();
    let request =
        Request { seed, ..Request::new(Target::Wander(WanderRequest { seconds, ..WanderRequest::default() })) };
    let mut direction = Direction::new(scene, None, &request, DEFAULT_EFFORT).ok()?;
    while direction.advance(scene, SLICE).ok()? == Found::Running {}
    let answer = direction.best(scene);
    let searched = began.elapsed().as_secs_f64();
    let Goal::Wander { objectives, frames } = answer.parts.first()?.goal else { return None };
    let (start, walk): (u32, Walk) = (answer.start_frame, answer.walk);
    if walk.legs.is_empty() {
        return None;
    }
    let wandered = Wandered::of(&walk, start, scene.graph, scene.timeline, &scene.search_graph.main);
    Some(Taken { begun: Begun { start, walk }, wandered, objectives, frames, searched })
}

/// The longest run of frames that can be left and reached again, in frames: no stretch can be longer, but for loops.
fn timeline_allows(search_graph: &SearchGraph) -> f64 {
    let mut runs = search_graph.main.split(|main| !main).map(<[bool]>::len).collect::<Vec<_>>();
    runs.sort_unstable();
    runs.last().copied().unwrap_or(0) as f64
}

fn walks_table(taken: &[Taken], fps: f64) -> Table {
    let mut table = Table::new(
        "wandering",
        format!(
            "Walks of {SECONDS:.0} s. Shown: frames that can be left and reached again and are shown as recorded. Stretch: \
             recorded seconds between two transitions. Uneven: the most over the least visited half second of a behaviour, \
             the median behaviour and the worst. Repeated: the longest run that begins again exactly within ten seconds."
        ),
        &[
            "walk",
            "shown, %",
            "synthetic, %",
            "stretch, median s",
            "stretch, 10th s",
            "transitions a second",
            "uneven, median",
            "uneven, worst",
            "repeated, s",
        ],
    );
    for (number, Taken { wandered, .. }) in taken.iter().enumerate() {
        let at = |share| percentile(&wandered.stretches, share).unwrap_or(f64::NAN) / fps;
        let uneven: Vec<f64> = wandered.unevenness.iter().map(|entry| entry.1).collect();
        table.rows.push(vec![
            Cell::Count(number as u64 + 1),
            percent(wandered.coverage),
            percent(wandered.synthetic),
            Cell::Number(at(0.5), 2),
            Cell::Number(at(0.1), 2),
            Cell::Number(wandered.transitions as f64 / SECONDS, 2),
            Cell::Number(percentile(&uneven, 0.5).unwrap_or(f64::NAN), 2),
            Cell::Number(percentile(&uneven, 1.0).unwrap_or(f64::NAN), 2),
            Cell::Number(wandered.repeat as f64 / fps, 2),
        ]);
    }
    table
}

fn places_table(taken: &[Taken]) -> Table {
    let heads: Vec<String> = (1..=taken.len()).map(|walk| format!("walk {walk}")).collect();
    let columns: Vec<&str> = std::iter::once("behaviour").chain(heads.iter().map(String::as_str)).collect();
    let caption = "How unevenly the places of each behaviour are visited: the most over the least visited half second.";
    let mut table = Table::new("wandering_places", caption, &columns);
    for (row, (name, _)) in taken.first().into_iter().flat_map(|taken| taken.wandered.unevenness.iter()).enumerate() {
        let ratio = |taken: &Taken| Cell::Number(taken.wandered.unevenness[row].1, 2);
        table.rows.push(std::iter::once(name.as_str().into()).chain(taken.iter().map(ratio)).collect());
    }
    table
}

fn chain_table(taken: &[Taken]) -> Table {
    let caption = "The chain that walks follow: the objective of Prada and others (2016), section 7.1.";
    let mut table = Table::new("wandering_chain", caption, &["measure", "value"]);
    let Some(&Taken { objectives: [even, proxy, now], frames, .. }) = taken.first() else { return table };
    table.rows = vec![
        vec!["objective, equal probabilities".into(), Cell::Number(even, 4)],
        vec!["objective, after the convex proxy".into(), Cell::Number(proxy, 4)],
        vec!["objective, as used".into(), Cell::Number(now, 4)],
        vec!["frames that the chain visits".into(), Cell::Count(u64::from(frames))],
    ];
    table
}

fn times_table(scene: &Scene, taken: &[Taken]) -> Table {
    let mut table = Table::new("wandering_times", "Seconds until the answer.", &["walk of", "seconds"]);
    table.timed = true;
    let first = taken.first().map_or(f64::NAN, |taken| taken.searched);
    let short = wander(scene, 1, 20.0).map_or(f64::NAN, |taken| taken.searched);
    table.rows = vec![
        vec!["20 s".into(), Cell::Number(short, 3)],
        vec![format!("{SECONDS:.0} s").into(), Cell::Number(first, 3)],
    ];
    table
}

fn agreements(taken: &[Taken], fps: f64, longest: f64) -> Vec<Agreement> {
    let worst = |of: &dyn Fn(&Wandered) -> f64| taken.iter().map(|taken| of(&taken.wandered)).fold(0.0, f64::max);
    let hidden = worst(&|w| 1.0 - w.coverage);
    let synthetic = worst(&|w| w.synthetic);
    let short = worst(&|w| -percentile(&w.stretches, 0.5).unwrap_or(0.0) + longest);
    let stretch = (longest - short) / fps;
    let uneven = worst(&|w| w.unevenness.iter().map(|entry| entry.1).fold(0.0, f64::max));
    let repeat = worst(&|w| w.repeat as f64) / fps;
    let objective = taken.first().map_or([f64::NAN; 3], |taken| taken.objectives);
    let mark = |papers: String, found: String, holds: bool| Agreement {
        papers,
        found,
        verdict: Verdict::of(holds, holds),
        why: String::new(),
    };
    let stretch_mark = MARKS[2].min(0.5 * longest / fps);
    vec![
        Agreement {
            papers:
                "Optimised probabilities make the stationary distribution closer to uniform than equal ones (Prada 7.1)."
                    .into(),
            found: format!(
                "The objective falls from {:.4} to {:.4} by the proxy and {:.4} in the end.",
                objective[0], objective[1], objective[2]
            ),
            verdict: Verdict::of(objective[2] < objective[0], objective[2] <= objective[1]),
            why: String::new(),
        },
        mark(
            format!("Our own mark: {:.0} % of the frames are shown in five minutes.", 100.0 * MARKS[0]),
            format!("{:.1} % in the walk that shows least", 100.0 * (1.0 - hidden)),
            1.0 - hidden >= MARKS[0],
        ),
        mark(
            format!("Our own mark: at most {:.0} % of the time is synthetic.", 100.0 * MARKS[1]),
            format!("{:.1} % at most", 100.0 * synthetic),
            synthetic <= MARKS[1],
        ),
        mark(
            format!("Our own mark: recorded stretches of {:.0} s in the median, where sequences allow it.", MARKS[2]),
            format!("{stretch:.2} s; the longest sequence has {:.2} s that can be left and reached again", longest / fps),
            stretch >= stretch_mark,
        ),
        mark(
            format!("Our own mark: no place is visited {:.0} times as often as another of its behaviour.", MARKS[3]),
            format!("{uneven:.2} times at most"),
            uneven <= MARKS[3],
        ),
        mark(
            "Our own mark: nothing of a second is repeated exactly within ten.".into(),
            format!("{repeat:.2} s at most"),
            repeat < 1.0,
        ),
    ]
}
