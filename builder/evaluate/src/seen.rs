//! What an animator would see: slide, feet in the ground, leaps and stutter in the transitions of walks, against what was
//! recorded.

use std::collections::BTreeMap;

use actor::capture::Capture;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use job::Job;
use kernels::random::mix;
use search::cheapest_walk;

use crate::EvaluateError;
use crate::blended;
use crate::document::{Cell, SectionReport, Table};
use crate::motion::{Begun, Own, Shown, show};
use crate::statistics::percentile;
use crate::subject::progress_of;

/// Cheapest walks between frames drawn at random.
const WALKS: u64 = 60;
/// Frames of a walk that are made at most.
const MOST_FRAMES: usize = 600;
/// A foot that slides so many times as far as in all recorded frames, and as in those that are blended, is seen; what is
/// shorter, in metres a frame, never is.
const SLIDES: f64 = 1.5;
const LEAST_SLIDE: f64 = 1e-3;
/// A body that is so much further above the ground than both sides of a blend, as a part of its height, hops: 1.8 cm of 1.8 m.
const HOPS: f64 = 0.01;
/// What lies deeper in the ground than recorded frames, as a part of the body's height, is seen.
const SINKS: f64 = 0.004;
/// A step or a change of step that is so many times the recorded 99th percentile is seen.
const LEAPS: f64 = 1.5;

/// What can be seen.
struct Fault {
    /// In a table.
    name: &'static str,
    /// In a sentence.
    does: &'static str,
    /// From how much on it is seen, and what recorded frames have.
    limit: f64,
    recorded: f64,
    /// How many of its units a metre has, and what they are.
    unit: (f64, &'static str),
    /// What to do.
    remedy: &'static str,
}

/// Makes the section.
pub(crate) fn section(
    capture: &Capture,
    order: &[u32],
    graph: &EssentialGraph,
    job: &Job,
) -> Result<SectionReport, EvaluateError> {
    let mut section = SectionReport::new(0, "What an animator would see");
    let walks = walks(capture, graph);
    let shown = show(capture, order, graph, &walks, MOST_FRAMES, &progress_of(job, "walks"))?;
    let own = Own::of(capture);
    let faults = faults(&own);
    let mut table = Table::new(
        "seen",
        format!(
            "Transitions of {} cheapest walks between frames drawn at random, as the player shows them: how many show a fault, \
             the worst of all, and the limit, which follows from the recorded frames.",
            walks.len()
        ),
        &["what", "transitions", "of", "worst", "limit", "recorded", "unit", "from", "to"],
    );
    let place = |frame: u32| place(&capture.timeline, frame);
    let sides = slides_of_sides(&capture.timeline, &own, graph, &shown);
    let mut seen = Vec::new();
    for (kind, fault) in faults.iter().enumerate() {
        let values = worst_of_transitions(&capture.timeline, &own, graph, &shown, kind);
        // What both sides do by themselves is no fault of the transition.
        let excess = |&(index, value): &(u32, f64)| match kind {
            SLIDE => value - fault.limit.max(SLIDES * sides[&index]),
            _ => value - fault.limit,
        };
        let over = values.iter().filter(|value| excess(value) > 0.0).count();
        let worst = values.iter().max_by(|a, b| excess(a).total_cmp(&excess(b)));
        let (scale, unit) = fault.unit;
        let number = |value: f64| Cell::Number(scale * value, 1);
        let [from, to] = worst.map_or_else(Default::default, |&(index, _)| {
            let transition = &graph.transitions()[index as usize];
            [place(transition.from), place(transition.to)]
        });
        if let Some((_, value)) = worst.filter(|_| over > 0) {
            seen.push(format!(
                "{} in {over} of {} transitions; at worst {:.1} {unit} from {from} to {to} (recorded {:.1}). {}",
                fault.does,
                values.len(),
                scale * value,
                scale * fault.recorded,
                fault.remedy
            ));
        }
        table.rows.push(vec![
            fault.name.into(),
            Cell::Count(over as u64),
            Cell::Count(values.len() as u64),
            worst.map_or(Cell::Empty, |worst| number(worst.1)),
            number(fault.limit),
            number(fault.recorded),
            unit.into(),
            from.into(),
            to.into(),
        ]);
    }
    if graph.feet().count() == 0 {
        seen.push("No feet are known of this actor: nothing holds them in transitions. Pack it again.".into());
    }
    if seen.is_empty() {
        seen.push("Nothing: feet stay, nothing sinks, leaps or stutters beyond what was recorded.".into());
    }
    section.text = seen;
    section.tables.push(table);
    Ok(section)
}

fn walks(capture: &Capture, graph: &EssentialGraph) -> Vec<Begun> {
    let n = u64::from(capture.timeline.frame_count());
    let frame = |index: u64| (mix(7, index) % n) as u32;
    let walk = |index: u64| {
        let start = frame(2 * index);
        let walk = cheapest_walk(graph, &capture.timeline, start, frame(2 * index + 1))?;
        (walk.transition_count() > 0).then(|| Begun { start, walk }.with_surroundings(graph, &capture.timeline))
    };
    (0..WALKS).filter_map(walk).collect()
}

/// What is looked for, in the order of [`values_of`].
fn faults(own: &Own) -> [Fault; 5] {
    let slide = own.slide();
    let [step, change] = own.limits();
    let millimetres = (1e3, "mm a frame");
    [
        Fault {
            name: "slide of what touches the ground",
            does: "Feet slide",
            limit: (SLIDES * slide).max(LEAST_SLIDE),
            recorded: slide,
            unit: millimetres,
            remedy: "Takes in which the feet stand where others stand help.",
        },
        Fault {
            name: "depth in the ground",
            does: "The body sinks into the ground",
            limit: own.depth() + SINKS * own.height(),
            recorded: own.depth(),
            unit: (1e3, "mm"),
            remedy: "See whether the takes have one ground (W_FLOOR).",
        },
        Fault {
            name: "height above the ground, beyond both sides",
            does: "The body hops",
            limit: HOPS * own.height(),
            recorded: 0.0,
            unit: (1e3, "mm"),
            remedy: "Takes in which the feet stand where others stand help.",
        },
        Fault {
            name: "step from frame to frame",
            does: "The body leaps",
            limit: LEAPS * step,
            recorded: step,
            unit: millimetres,
            remedy: "A smaller quickness, or pack --transition-length haste, takes longer ways.",
        },
        Fault {
            name: "change of step",
            does: "The body jerks",
            limit: LEAPS * change,
            recorded: change,
            unit: millimetres,
            remedy: "Takes that go from the one to the other help.",
        },
    ]
}

/// The place of slides and of hops among [`faults`].
const SLIDE: usize = 0;
const HOP: usize = 2;

/// For each transition of the walks, how far what touches the ground slides in the recorded frames that it blends: the side
/// that slides more, in metres a frame.
fn slides_of_sides(timeline: &Timeline, own: &Own, graph: &EssentialGraph, shown: &[Shown]) -> BTreeMap<u32, f64> {
    let of = |index: u32| {
        let sides = blended::sides(timeline, &graph.transitions()[index as usize]);
        sides.into_iter().map(|frames| own.slide_of(frames.into_iter())).fold(0.0, f64::max)
    };
    shown.iter().flat_map(|walk| walk.transitions.iter().flatten()).map(|&index| (index, of(index))).collect()
}

/// How much of each fault a transition shows: means of slide, else the most of its frames, in metres.
fn worst_of_transitions(
    timeline: &Timeline,
    own: &Own,
    graph: &EssentialGraph,
    shown: &[Shown],
    kind: usize,
) -> Vec<(u32, f64)> {
    let mut found = Vec::new();
    for walk in shown {
        let mut at = 0;
        while at < walk.transitions.len() {
            let first = at;
            while at < walk.transitions.len() && walk.transitions[at] == walk.transitions[first] {
                at += 1;
            }
            if let Some(index) = walk.transitions[first] {
                let value = match kind {
                    HOP => {
                        hop(walk, first, &blended::nodes(timeline, &graph.transitions()[index as usize]), &own.lowest)
                    }
                    _ => value_of(walk, first..at, kind),
                };
                found.extend(value.map(|value| (index, value)));
            }
        }
    }
    found
}

/// How far the body is above where it is lowest on the higher of both sides, at most, in metres; `first` is the frame that the
/// transition leaves.
fn hop(walk: &Shown, first: usize, nodes: &[[u32; 2]], lowest: &[f64]) -> Option<f64> {
    let above = nodes.iter().enumerate().filter_map(|(node, [source, destination])| {
        let sides = lowest.get(*source as usize)?.max(*lowest.get(*destination as usize)?);
        Some(walk.series.lowest.get(first + node)? - sides.max(0.0))
    });
    above.reduce(f64::max)
}

fn value_of(walk: &Shown, steps: std::ops::Range<usize>, kind: usize) -> Option<f64> {
    let series = &walk.series;
    let most = |values: &[f64], range: std::ops::Range<usize>| {
        values.get(range.start.min(values.len())..range.end.min(values.len()))?.iter().copied().reduce(f64::max)
    };
    match kind {
        0 => {
            let slides: Vec<f64> = series.slide.get(steps)?.iter().flatten().copied().collect();
            (slides.len() > 1).then(|| slides.iter().sum::<f64>() / slides.len() as f64)
        }
        // A walk's frames are one more than its steps.
        1 => most(&series.lowest.iter().map(|low| -low).collect::<Vec<f64>>(), steps.start..steps.end + 1),
        2 => most(&series.way, steps),
        // The change at a frame is that of the steps before and after it; seams belong to the transition.
        _ => most(&series.change, steps.start.saturating_sub(1)..steps.end),
    }
}

/// A frame, as a reader finds it again.
fn place(timeline: &Timeline, frame: u32) -> String {
    let Some(sequence) = timeline.sequence_of(frame) else { return String::new() };
    format!("{} {:.2} s", sequence.name, (frame - sequence.first_frame) as f32 / timeline.fps())
}

impl Own {
    /// How deep the recorded frames lie in the ground: the deepest but one in a hundred.
    fn depth(&self) -> f64 {
        percentile(&self.lowest, 0.01).map_or(0.0, |low| -low)
    }
}
