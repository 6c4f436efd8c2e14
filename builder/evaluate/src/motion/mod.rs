//! Section 9: what walks look like. Whether a walk passes for the recording: what its blends add to the motion, its seams,
//! frames that freeze or leap, slide, all against the capture's own, on cheapest walks between frames drawn at random.

mod added;
mod parts;
mod pictures;
mod played;
mod series;
mod standing;

use actor::capture::Capture;
use actor::graph::{EssentialGraph, Transition};
use actor::timeline::Timeline;
use actor::walk::{Leg, steps_of};
use kernels::cholesky::elimination_order;
use rayon::prelude::*;
use search::cheapest_walk;

pub(super) use self::added::Added;
use self::pictures::Strips;
pub(super) use self::played::{Begun, Borrowed, Shown, show};
pub(super) use self::series::{Look, Series};
use self::standing::Slid;
use super::EvaluateError;
use super::blended;
use super::document::{Cell, SectionReport, Table};
use super::performance::Recordings;
use super::statistics::{Moments, percentile};
use super::subject::{Subject, progress_of};
use job::Job;
use kernels::random::mix;
use pipeline::transitions::LengthChoice;

/// Cheapest walks between frames drawn at random.
const WALKS: u64 = 300;
/// Those whose frames are all made.
const SHOWN: usize = 100;
/// Frames of a walk that are made at most.
const MOST_FRAMES: usize = 2000;
/// Ways below this share of the capture's median are no motion that could freeze or leap.
const LEAST_WAY: f64 = 0.5;

/// Makes the section.
pub(super) fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let order = elimination_order(&subject.capture.topology);
    let own = Own::of(&subject.capture);
    let mut section = SectionReport::default();
    section.text.push(
        "Walks are shown frame by frame as the player makes them, with four recorded frames before and after, and measured \
         beside the capture\u{2019}s own frames. A step is frozen where it is less than half as long as both steps beside \
         it, and leaps where it is more than 1.8 times as long, as seen or once both frames are aligned in the plane."
            .into(),
    );
    let turning = turning(subject);
    let (mut lengths, mut parts) = (lengths_table(), parts::table());
    let mut frames = frames_table(&own);
    frames.rows.push(own.row());
    for choice in LengthChoice::ALL {
        let graph = subject.graph(choice, job)?;
        let walks = walks(subject, &graph, job)?;
        let recordings =
            Recordings::of(&subject.capture, &subject.measured.headings, &subject.centres, &subject.contacts);
        let added = Added::of(&recordings, &subject.measured.distances, &graph, &walks)?;
        lengths.rows.push(lengths_row(subject, choice, &graph, &walks, &added, turning));
        let few: Vec<Begun> =
            walks.iter().take(SHOWN).map(|walk| walk.with_surroundings(&graph, subject.timeline())).collect();
        let shown = show(&subject.capture, &order, &graph, &few, MOST_FRAMES, &progress_of(job, "walks"))?;
        frames.rows.push(own.compare(choice.word(), (&subject.capture, &graph), &shown));
        if choice == subject.options.transition.choice {
            parts.rows = parts::rows(&subject.capture, &order, &graph, &few)?;
            let ground = Look::of(&subject.capture.poses, subject.capture.topology.weights()).ground;
            let strips = Strips { capture: &subject.capture, order: &order, graph: &graph, ground };
            section.pictures = strips.of(&added)?;
        }
    }
    section.tables.extend([lengths, frames]);
    if !parts.rows.is_empty() {
        section.tables.push(parts);
    }
    Ok(section)
}

/// Cheapest walks between frames drawn at random, those that exist and have a transition.
fn walks(subject: &Subject, graph: &EssentialGraph, job: &Job) -> Result<Vec<Begun>, EvaluateError> {
    let (n, seed) = (u64::from(subject.timeline().frame_count()), subject.options.seed);
    let frame = |index: u64| (mix(seed, index) % n) as u32;
    job.tell("walks", 0, 0)?;
    let found: Vec<Option<Begun>> = (0..WALKS)
        .into_par_iter()
        .map(|index| {
            let start = frame(2 * index);
            let walk = cheapest_walk(graph, subject.timeline(), start, frame(2 * index + 1))?;
            (walk.transition_count() > 0).then_some(Begun { start, walk })
        })
        .collect();
    Ok(found.into_iter().flatten().collect())
}

/// Median and 99th percentile of the distance between frames in a row, in radians a second.
fn turning(subject: &Subject) -> [f64; 2] {
    let timeline = subject.timeline();
    let frames = 0..timeline.frame_count().saturating_sub(1);
    let beside = frames.filter(|&frame| timeline.next(frame) == Some(frame + 1));
    let apart = |frame: u32| f64::from(subject.measured.distances.get(frame as usize, frame as usize + 1));
    let distances: Vec<f64> = beside.map(|frame| apart(frame) * f64::from(timeline.fps())).collect();
    [0.5, 0.99].map(|share| percentile(&distances, share).unwrap_or(0.0))
}

/// The capture's own frames.
pub(super) struct Own {
    /// Steps of all sequences.
    ways: Vec<f64>,
    changes: Vec<f64>,
    slides: Vec<f64>,
    /// For each frame the slide in the step from it to the next one, where anything touches the ground in both.
    slide_from: Vec<Option<f64>>,
    stutters: [usize; 2],
    /// Median and 99th percentile of the ways and of their changes, in metres.
    way: [f64; 2],
    change: [f64; 2],
    /// Height of the lowest vertex of each frame from the ground.
    pub(super) lowest: Vec<f64>,
    height: f64,
}

impl Own {
    pub(super) fn of(capture: &Capture) -> Self {
        let (poses, timeline) = (&capture.poses, &capture.timeline);
        let look = Look::of(poses, capture.topology.weights());
        let sequences: Vec<Series> = timeline
            .sequences()
            .par_iter()
            .map(|sequence| {
                let mut series = Series::default();
                (sequence.first_frame..sequence.end_frame()).for_each(|frame| series.push(poses.frame(frame), &look));
                series
            })
            .collect();
        let all = |of: &dyn Fn(&Series) -> Vec<f64>| sequences.iter().flat_map(of).collect::<Vec<f64>>();
        let (ways, changes) = (all(&|series| series.way.clone()), all(&|series| series.change.clone()));
        let slides = all(&|series| series.slide.iter().flatten().copied().collect());
        let both = |values: &[f64]| [0.5, 0.99].map(|share| percentile(values, share).unwrap_or(0.0));
        let (way, change) = (both(&ways), both(&changes));
        let mut stutters = [0, 0];
        for series in &sequences {
            let found = series.stutter(LEAST_WAY * way[0]);
            (0..2).for_each(|kind| stutters[kind] += found[kind].len());
        }
        let lowest = all(&|series| series.lowest.clone());
        let slide_from = sequences.iter().flat_map(|series| series.slide.iter().copied().chain([None])).collect();
        Self { ways, changes, slides, slide_from, stutters, way, change, lowest, height: f64::from(look.height) }
    }

    /// Mean slide of what touches the ground, in metres a frame.
    pub(super) fn slide(&self) -> f64 {
        Moments::of(self.slides.iter().copied()).mean
    }

    /// The same in the steps from these frames on.
    pub(super) fn slide_of(&self, frames: impl Iterator<Item = u32>) -> f64 {
        Moments::of(frames.filter_map(|frame| *self.slide_from.get(frame as usize)?)).mean
    }

    /// The 99th percentiles of steps and of changes of step, in metres a frame.
    pub(super) fn limits(&self) -> [f64; 2] {
        [self.way[1], self.change[1]]
    }

    /// Height of the body in metres.
    pub(super) fn height(&self) -> f64 {
        self.height
    }

    fn row(&self) -> Vec<Cell> {
        let mut row = self.cells("recorded", &self.ways, &self.changes, &self.slides, self.stutters);
        row.splice(4..4, [Cell::Empty, Cell::Empty, Cell::Empty]);
        row.extend([Cell::Empty, Cell::Empty, Cell::Empty, Cell::Empty]);
        row
    }

    /// Mean slide of the recorded frames that the transitions of `shown` blend, in metres a frame: of each transition both sides,
    /// as often as it slides itself.
    fn slide_there(&self, (graph, timeline): (&EssentialGraph, &Timeline), shown: &[Shown]) -> f64 {
        let of = |transition: &Transition| {
            let slides = blended::sides(timeline, transition).map(|frames| self.slide_of(frames.into_iter()));
            Moments::of(slides.into_iter().filter(|slide| slide.is_finite())).mean
        };
        let slides = |walk: &Shown| -> Vec<u32> {
            let at = walk.transitions.iter().zip(&walk.series.slide);
            at.filter_map(|(transition, slide)| slide.and(*transition)).collect()
        };
        let taken = shown.iter().flat_map(slides).filter_map(|index| graph.transitions().get(index as usize));
        Moments::of(taken.map(of).filter(|slide| slide.is_finite())).mean
    }

    /// A row of the steps within transitions, and at their seams.
    pub(super) fn compare(
        &self,
        name: &str,
        (capture, graph): (&Capture, &EssentialGraph),
        shown: &[Shown],
    ) -> Vec<Cell> {
        let (mut ways, mut changes, mut slides, mut stutters) = (Vec::new(), Vec::new(), Vec::new(), [0, 0]);
        let (mut seams, mut above) = (0, [0, 0]);
        for walk in shown {
            let Series { way, change, slide, .. } = &walk.series;
            let inside = |at: usize| walk.transitions.get(at).is_some_and(Option::is_some);
            for at in (0..way.len()).filter(|&at| inside(at)) {
                ways.push(way[at]);
                slides.extend(slide[at]);
            }
            // A change is at a frame; frames at seams belong to the transition.
            changes.extend((0..change.len()).filter(|&at| inside(at) || inside(at + 1)).map(|at| change[at]));
            let found = walk.series.stutter(LEAST_WAY * self.way[0]);
            for kind in 0..2 {
                // A seam's own stutter may fall on the recorded step beside it.
                let near = |&&at: &&usize| inside(at) || inside(at + 1) || (at > 0 && inside(at - 1));
                stutters[kind] += found[kind].iter().filter(near).count();
            }
            for &seam in &walk.seams {
                let (Some(before), Some(after)) = (way.get(seam - 1), way.get(seam)) else { continue };
                let Some(turn) = change.get(seam - 1) else { continue };
                seams += 1;
                above[0] += usize::from(before.max(*after) > self.way[1]);
                above[1] += usize::from(*turn > self.change[1]);
            }
        }
        let mut row = self.cells(name, &ways, &changes, &slides, stutters);
        let share = |count: usize| percent(count as f64 / (seams as f64).max(1.0));
        row.splice(4..4, [Cell::Count(seams as u64), share(above[0]), share(above[1])]);
        let there = Moments::of(slides.iter().copied()).mean / self.slide_there((graph, &capture.timeline), shown);
        // A transition's index, and what slid in one of its steps.
        let slid = |walk: &Shown| -> Vec<(u32, Slid)> {
            let at = walk.transitions.iter().zip(&walk.slid);
            at.filter_map(|(transition, slid)| Some(((*transition)?, *slid))).collect()
        };
        let slid: Vec<(u32, Slid)> = shown.iter().flat_map(slid).collect();
        let standing = standing::mean(slid.iter().map(|slid| slid.1));
        let recorded = standing::recorded(capture, graph.feet(), &Look::of(&capture.poses, capture.topology.weights()));
        let of_transitions =
            slid.iter().filter_map(|&(index, slid)| Some((graph.transitions().get(index as usize)?, slid)));
        let recorded_there = standing::there(&recorded, &capture.timeline, of_transitions);
        let recorded = standing::mean(recorded.into_iter());
        let number = |value: f64| if value.is_finite() { Cell::Number(value, 2) } else { Cell::Empty };
        row.extend([there, standing * 1e3, standing / recorded, standing / recorded_there].map(number));
        row
    }

    fn cells(&self, name: &str, ways: &[f64], changes: &[f64], slides: &[f64], stutters: [usize; 2]) -> Vec<Cell> {
        let above = |values: &[f64], limit: f64| {
            percent(values.iter().filter(|value| **value > limit).count() as f64 / (values.len() as f64).max(1.0))
        };
        let slide = Moments::of(slides.iter().copied());
        let thousandth = |count: usize| Cell::Number(1e3 * count as f64 / (ways.len() as f64).max(1.0), 1);
        vec![
            name.into(),
            Cell::Count(ways.len() as u64),
            above(ways, self.way[1]),
            above(changes, self.change[1]),
            thousandth(stutters[0]),
            thousandth(stutters[1]),
            if slide.count > 0 { Cell::Number(slide.mean * 1e3, 2) } else { Cell::Empty },
            if slide.count > 0 { Cell::Number(slide.mean / self.slide(), 2) } else { Cell::Empty },
        ]
    }
}

pub(super) fn percent(share: f64) -> Cell {
    Cell::Number(100.0 * share, 1)
}

/// The head of a table with rows of [`Own::compare`].
pub(super) fn frames_table(own: &Own) -> Table {
    Table::new(
        "motion_frames",
        format!(
            "Steps within transitions of {SHOWN} cheapest walks, and recorded ones. Ways and changes of way (accelerations) \
             are root mean squares over the vertices, held against the capture\u{2019}s own 99th percentiles: {:.2} mm and \
             {:.2} mm a frame (medians {:.2} and {:.2}). Slide: vertices within 1.1 % of the body\u{2019}s height of the \
             ground in both frames, of a foot that swings as well as of one that stands: the mean of the frames' means, against \
             that of all recorded frames and of those that the transitions blend. Standing: the same vertices of the soles of feet \
             that stand alone, each counting once.",
            own.way[1] * 1e3,
            own.change[1] * 1e3,
            own.way[0] * 1e3,
            own.change[0] * 1e3
        ),
        &[
            "frames",
            "steps",
            "way above, %",
            "change above, %",
            "seams",
            "seams: way above, %",
            "seams: change above, %",
            "frozen in 1000",
            "leaps in 1000",
            "slide, mm",
            "slide, times recorded",
            "slide, times recorded there",
            "standing feet, mm",
            "standing, times recorded",
            "standing, times recorded there",
        ],
    )
}

fn lengths_table() -> Table {
    Table::new(
        "motion_lengths",
        format!(
            "Up to {WALKS} cheapest walks between frames drawn at random, and what their transitions add to the motion: \
             v = weight\u{2019}s growth times pose distance, radians a second; against the median of the capture\u{2019}s \
             own distance between frames in a row."
        ),
        &[
            "lengths by",
            "transitions kept",
            "density",
            "walks",
            "cost",
            "seconds",
            "transitions a walk",
            "synthetic, %",
            "length, median s",
            "length, 90th s",
            "added, mean",
            "added, peak median",
            "added, peak 90th",
            "own, median",
            "own, 99th",
        ],
    )
}

fn lengths_row(
    subject: &Subject,
    choice: LengthChoice,
    graph: &EssentialGraph,
    walks: &[Begun],
    added: &Added,
    turning: [f64; 2],
) -> Vec<Cell> {
    let fps = f64::from(subject.timeline().fps());
    let steps = |synthetic: bool| -> f64 {
        let of = |leg: &Leg| match *leg {
            Leg::Recorded { steps, .. } if !synthetic => steps,
            Leg::Synthetic(index) if synthetic => graph.transitions().get(index as usize).map_or(0, steps_of),
            _ => 0,
        };
        walks.iter().flat_map(|begun| &begun.walk.legs).map(|leg| f64::from(of(leg))).sum()
    };
    let (recorded, synthetic) = (steps(false), steps(true));
    let mean = |of: &dyn Fn(&Begun) -> f64| Moments::of(walks.iter().map(of)).mean;
    let at = |values: &[f64], share| percentile(values, share).unwrap_or(f64::NAN);
    let seconds: Vec<f64> = added.durations.iter().map(|steps| steps / fps).collect();
    vec![
        choice.word().into(),
        Cell::Count(graph.transitions().len() as u64),
        Cell::Number(graph.density(subject.timeline()), 4),
        Cell::Count(walks.len() as u64),
        Cell::Number(mean(&|begun| begun.walk.cost), 2),
        Cell::Number(mean(&|begun| f64::from(begun.walk.steps(graph)) / fps), 2),
        Cell::Number(mean(&|begun| begun.walk.transition_count() as f64), 2),
        percent(synthetic / (recorded + synthetic).max(1.0)),
        Cell::Number(at(&seconds, 0.5), 2),
        Cell::Number(at(&seconds, 0.9), 2),
        Cell::Number(Moments::of(added.means.iter().copied()).mean * fps, 2),
        Cell::Number(at(&added.peaks, 0.5) * fps, 2),
        Cell::Number(at(&added.peaks, 0.9) * fps, 2),
        Cell::Number(turning[0], 2),
        Cell::Number(turning[1], 2),
    ]
}
