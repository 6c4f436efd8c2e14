//! The walk itself: the chain's probabilities, and a memory.
//!
//! A chain forgets. Its walks come back to what they have just shown, leave where they have just arrived, and in some minutes
//! some places are visited many times and others never, although all are equally likely in the long run. So the choices of a
//! walk are held to the chain's probabilities as evenly as can be: each edge gathers its probability when its segment's end is
//! reached and pays one when it is taken (as in rotor walks: Cooper and Spencer 2006), and what has gathered most is most
//! likely. Beside that a stretch is not left before it has lasted for a second, if it can go on, and what was shown within the
//! last ten seconds is not shown again, if anything else can be.

use super::segments::Segments;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::{Leg, Walk, steps_of};

/// Seconds that a recorded stretch lasts at least.
const STRETCH: f64 = 1.0;
/// Seconds after which something may be shown again.
const FORGETS: f64 = 10.0;
/// Most that an edge has gathered when a walk begins.
const FIRST_CREDIT: f64 = 1.0;
/// Most that an edge gathers or owes.
const MOST_CREDIT: f64 = 3.0;

/// What a walk remembers.
#[derive(Clone, Debug)]
pub(super) struct Stroll {
    /// What each edge has gathered.
    credits: Vec<f64>,
    /// Step at which each frame was shown last.
    shown: Vec<Option<u32>>,
    step: u32,
    /// Recorded steps since the last transition.
    stretch: u32,
    /// Steps that a stretch lasts at least, and after which something may be shown again.
    least: u32,
    forgets: u32,
}

impl Stroll {
    /// A walk that has shown nothing yet. What edges have gathered already is drawn from `random`, numbers in [0, 1): else all
    /// walks would visit the places of a small graph in the same order.
    pub(super) fn new(segments: &Segments, timeline: &Timeline, random: &mut dyn FnMut() -> f64) -> Self {
        let steps = |seconds: f64| (seconds * f64::from(timeline.fps())).ceil() as u32;
        Self {
            credits: segments.transitions.iter().map(|_| FIRST_CREDIT * random()).collect(),
            shown: vec![None; timeline.frame_count() as usize],
            step: 0,
            stretch: 0,
            least: steps(STRETCH),
            forgets: steps(FORGETS),
        }
    }

    /// Walks on from `frame`, which is inside, for at least `steps` steps. `random` gives numbers in [0, 1).
    pub(super) fn walk(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        segments: &Segments,
        frame: u32,
        steps: u32,
        random: &mut dyn FnMut() -> f64,
    ) -> Option<Walk> {
        let mut walk = Walk::default();
        let mut state = segments.segments.partition_point(|segment| segment.first <= frame).checked_sub(1)?;
        let mut frame = frame;
        self.show(frame);
        let end = self.step + steps;
        while self.step < end {
            let last = segments.segments.get(state)?.last;
            self.record(&mut walk, frame, last.checked_sub(frame)?);
            let (edge, to) = self.choose(timeline, segments, state, random)?;
            state = to as usize;
            let next = segments.segments.get(state)?.first;
            match segments.transitions[edge] {
                None => {
                    walk.push_recorded(last, next, 1);
                    self.step += 1;
                    self.stretch += 1;
                    self.show(next);
                }
                Some(index) => {
                    walk.legs.push(Leg::Synthetic(index));
                    self.step += steps_of(graph.transitions().get(index as usize)?);
                    self.stretch = 0;
                    self.show(next);
                }
            }
            frame = next;
        }
        Walk::of_legs(walk.legs, graph).ok()
    }

    fn show(&mut self, frame: u32) {
        if let Some(shown) = self.shown.get_mut(frame as usize) {
            *shown = Some(self.step);
        }
    }

    fn record(&mut self, walk: &mut Walk, first: u32, steps: u32) {
        walk.push_recorded(first, first + steps, steps);
        for frame in first + 1..=first + steps {
            self.step += 1;
            self.show(frame);
        }
        self.stretch += steps;
    }

    /// The edge to take at the end of segment `state`, and the segment that it leads to.
    fn choose(
        &mut self,
        timeline: &Timeline,
        segments: &Segments,
        state: usize,
        random: &mut dyn FnMut() -> f64,
    ) -> Option<(usize, u32)> {
        let edges: Vec<(usize, u32, f64)> = segments.optimiser.chain().edges(state).collect();
        let goes_on = edges.iter().any(|edge| segments.transitions[edge.0].is_none());
        // Where going on ends too soon in any case, there is nothing to wait for.
        let lasts = |last: u32| self.stretch + self.room(timeline, segments, last) >= self.least;
        let must_go_on =
            goes_on && self.stretch < self.least && segments.segments.get(state).is_some_and(|s| lasts(s.last));
        let mut weights = Vec::with_capacity(edges.len());
        let mut stalest = f64::INFINITY;
        for &(edge, to, probability) in &edges {
            let credit = (self.credits[edge] + probability).min(MOST_CREDIT);
            self.credits[edge] = credit;
            let allowed = !must_go_on || segments.transitions[edge].is_none();
            let stale = if allowed { self.staleness(timeline, segments.segments[to as usize].first) } else { 2.0 };
            stalest = stalest.min(stale);
            weights.push((stale, credit.max(0.05 * probability).powi(2)));
        }
        // Of what is shown again in any case, what was shown longest ago; the sooner that was, the less it matters.
        let most = stalest + 0.1 + 0.5 * stalest;
        weights.iter_mut().filter(|weight| weight.0 > most).for_each(|weight| weight.1 = 0.0);
        let mut left = random() * weights.iter().map(|weight| weight.1).sum::<f64>();
        let chosen = weights.iter().position(|weight| {
            left -= weight.1;
            weight.1 > 0.0 && left < 0.0
        });
        let chosen = chosen.or_else(|| weights.iter().rposition(|weight| weight.1 > 0.0)).unwrap_or(0);
        let &(edge, to, _) = edges.get(chosen)?;
        self.credits[edge] = (self.credits[edge] - 1.0).max(-MOST_CREDIT);
        Some((edge, to))
    }

    /// Recorded steps that can follow `frame`, as many as a shortest stretch has at most.
    fn room(&self, timeline: &Timeline, segments: &Segments, frame: u32) -> u32 {
        let is_inside = |frame: &u32| {
            let state = segments.segments.partition_point(|segment| segment.first <= *frame);
            state.checked_sub(1).is_some_and(|state| *frame <= segments.segments[state].last)
        };
        let ahead = std::iter::successors(Some(frame), |&frame| timeline.next(frame).filter(is_inside));
        ahead.skip(1).take(self.least as usize).count() as u32
    }

    /// How lately what begins with `frame` was shown: 0 where that was long ago or never, 1 where it is shown now; the mean of
    /// the frames of a shortest stretch.
    fn staleness(&self, timeline: &Timeline, frame: u32) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        let mut next = Some(frame);
        for _ in 0..=self.least {
            let Some(frame) = next else { break };
            let ago = self.shown.get(frame as usize).copied().flatten().map_or(u32::MAX, |shown| self.step - shown);
            sum += 1.0 - f64::from(ago.min(self.forgets)) / f64::from(self.forgets.max(1));
            count += 1.0;
            next = timeline.next(frame);
        }
        sum / f64::max(count, 1.0)
    }
}
