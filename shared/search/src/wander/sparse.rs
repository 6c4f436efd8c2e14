//! Which transitions wandering chooses from: few, good, and spread over the capture.
//!
//! Prada and others (2016, section 4) take pairs of frames that are alike and not too near pairs that are taken already; their
//! graph has 72 transitions on 2,283 frames. Such a choice need not be connected. So what connects comes first here, ear by
//! ear: from what is joined already the cheapest way to the beginning of a stretch that is not, along the stretch, and the
//! cheapest way back from its end; the longest stretch first, until nearly every frame can be left and reached again. Then the
//! best of the others, none too near another.

use crate::meter;
use crate::queue::Queue;
use crate::search_graph::SearchGraph;
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;

/// Share of a stretch at either end that need not be shown, where better transitions arrive after it or leave before it.
const SLACK: f64 = 0.03;
/// Seconds of a stretch that is too short to be worth an ear of its own.
const SHORT: f64 = 0.1;
/// Seconds within which both ends of two transitions must not lie (20 frames of 30 a second in the paper).
const APART: f64 = 0.66;
/// Seconds of recorded frames for each transition of the graph, and for each that is added whatever connects.
const SECONDS_A_TRANSITION: f64 = 1.0;
const SECONDS_ANYWAY: f64 = 2.0;
/// How many times that far a transition within a sequence leads at least.
const LEADS_ON: u32 = 2;
/// What a transition costs beside its distance, as a share of the median one's: fewer that are a little worse are better.
const EACH: f64 = 0.5;
/// Frames and transitions looked at that count as an expanded state.
const LOOKED_AT: usize = 64;

/// From where, or to where, the cheapest ways lead that join a frame to what is joined already.
#[derive(Clone, Debug)]
struct Reach {
    cost: Vec<f64>,
    via: Vec<Via>,
    queue: Queue,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Via {
    Nothing,
    Recorded,
    Transition(u32),
}

/// Chooses transitions, some at a time.
#[derive(Clone, Debug)]
pub(super) struct Sparse {
    /// All transitions of the main component, the best first, and what each costs, by its number in the graph.
    order: Vec<u32>,
    cost: Vec<f64>,
    /// Transitions by the frame that they arrive at: where those of each frame begin, and their numbers.
    first_arrival: Vec<u32>,
    arrivals: Vec<u32>,
    /// Frames that are joined, and frames that were given up.
    inside: Vec<bool>,
    given_up: Vec<bool>,
    /// Ways from what is joined, and ways to it.
    reach: [Reach; 2],
    is_joined: bool,
    /// Transitions of the order that have been looked at, and how many are to be chosen.
    next: usize,
    enough: usize,
    /// How many are chosen when half of those that connect nothing lead to other sequences, and what they cost at most.
    crossing: usize,
    dearest: f64,
    chosen: Vec<u32>,
}

impl Sparse {
    /// Nothing is chosen yet; `order` are transitions between frames of the main component, the best first.
    pub(super) fn new(
        graph: &EssentialGraph,
        timeline: &Timeline,
        search_graph: &SearchGraph,
        order: Vec<u32>,
    ) -> Self {
        let frames = search_graph.main.len();
        let apart = |index: u32| mean_distance(graph, index);
        let median = order.get(order.len() / 2).map_or(0.0, |&index| apart(index));
        let mut cost = vec![f64::INFINITY; graph.transitions().len()];
        let mut first_arrival = vec![0_u32; frames + 1];
        for &index in &order {
            cost[index as usize] = apart(index) + EACH * median;
            first_arrival[graph.transitions()[index as usize].to as usize + 1] += 1;
        }
        for frame in 0..frames {
            first_arrival[frame + 1] += first_arrival[frame];
        }
        let mut next = first_arrival.clone();
        let mut arrivals = vec![0; order.len()];
        for &index in &order {
            let slot = &mut next[graph.transitions()[index as usize].to as usize];
            arrivals[*slot as usize] = index;
            *slot += 1;
        }
        meter::count(order.len() + frames);
        let reach =
            Reach { cost: vec![f64::INFINITY; frames], via: vec![Via::Nothing; frames], queue: Queue::default() };
        let mut sparse = Self {
            order,
            cost,
            first_arrival,
            arrivals,
            inside: vec![false; frames],
            given_up: vec![false; frames],
            reach: [reach.clone(), reach],
            is_joined: false,
            next: 0,
            enough: 0,
            crossing: 0,
            dearest: 0.0,
            chosen: Vec::new(),
        };
        if let Some((first, last)) = sparse.longest_stretch(timeline, search_graph) {
            sparse.join(first + (last - first) / 2);
        }
        sparse
    }

    /// Looks at some more transitions; how many expanded states that counts as, or `None` once all are chosen.
    pub(super) fn advance(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        search_graph: &SearchGraph,
    ) -> Option<usize> {
        let looked_at = match self.is_joined {
            false => self
                .spread(graph, timeline, search_graph)
                .unwrap_or_else(|| self.add_ear(graph, timeline, search_graph)),
            true => self.fill(graph, search_graph)?,
        };
        meter::count(looked_at);
        Some(looked_at.div_ceil(LOOKED_AT))
    }

    /// The transitions chosen.
    pub(super) fn chosen(self) -> Vec<u32> {
        self.chosen
    }

    fn join(&mut self, frame: u32) {
        if std::mem::replace(&mut self.inside[frame as usize], true) {
            return;
        }
        for reach in &mut self.reach {
            reach.cost[frame as usize] = 0.0;
            reach.via[frame as usize] = Via::Nothing;
            reach.queue.push(0.0, u64::from(frame));
        }
    }

    /// Finds cheapest ways on from and to what is joined, those of some frames; how much was looked at, or `None` where all are
    /// known.
    fn spread(&mut self, graph: &EssentialGraph, timeline: &Timeline, search_graph: &SearchGraph) -> Option<usize> {
        let way = (0..2).find(|&way| self.reach[way].queue.len() > 0)?;
        let reach = &mut self.reach[way];
        let mut looked_at = 0;
        while looked_at < LOOKED_AT {
            let Some((cost, frame)) = reach.queue.pop() else { break };
            let frame = frame as u32;
            looked_at += 1;
            if cost > reach.cost[frame as usize] {
                continue;
            }
            let mut relax = |to: u32, more: f64, via: Via| {
                looked_at += 1;
                if search_graph.main[to as usize] && cost + more < reach.cost[to as usize] {
                    reach.cost[to as usize] = cost + more;
                    reach.via[to as usize] = via;
                    reach.queue.push(cost + more, u64::from(to));
                }
            };
            if let Some(beside) = timeline.offset(frame, if way == 0 { 1 } else { -1 }) {
                relax(beside, 0.0, Via::Recorded);
            }
            if way == 0 {
                for index in graph.transitions_from(frame) {
                    relax(graph.transitions()[index].to, self.cost[index], Via::Transition(index as u32));
                }
            } else {
                let arrivals =
                    self.first_arrival[frame as usize] as usize..self.first_arrival[frame as usize + 1] as usize;
                for &index in &self.arrivals[arrivals] {
                    let from = graph.transitions()[index as usize].from;
                    relax(from, self.cost[index as usize], Via::Transition(index));
                }
            }
        }
        Some(looked_at)
    }

    /// The longest run of recorded frames of the main component that is neither joined nor given up.
    fn longest_stretch(&self, timeline: &Timeline, search_graph: &SearchGraph) -> Option<(u32, u32)> {
        let mut longest: Option<(u32, u32)> = None;
        for sequence in timeline.sequences() {
            let mut begin = None;
            for frame in sequence.first_frame..=sequence.end_frame() {
                let at = frame as usize;
                let is_open =
                    frame < sequence.end_frame() && search_graph.main[at] && !self.inside[at] && !self.given_up[at];
                match begin {
                    None if is_open => begin = Some(frame),
                    Some(first) if !is_open => {
                        if longest.is_none_or(|(from, to)| frame - first > to + 1 - from) {
                            longest = Some((first, frame - 1));
                        }
                        begin = None;
                    }
                    _ => {}
                }
            }
        }
        longest
    }

    /// Joins the longest stretch that is not joined by the cheapest ways to its beginning and back from its end; how much was
    /// looked at.
    fn add_ear(&mut self, graph: &EssentialGraph, timeline: &Timeline, search_graph: &SearchGraph) -> usize {
        let looked_at = self.inside.len();
        let short = (SHORT * search_graph.fps) as u32;
        let stretch = self.longest_stretch(timeline, search_graph).filter(|(first, last)| last - first >= short);
        let Some((first, last)) = stretch else {
            self.is_joined = true;
            let seconds = self.inside.iter().filter(|&&inside| inside).count() as f64 / search_graph.fps;
            let anyway = self.chosen.len() + (seconds / SECONDS_ANYWAY) as usize;
            self.enough = anyway.max((seconds / SECONDS_A_TRANSITION) as usize);
            self.crossing = self.chosen.len() + (self.enough - self.chosen.len()) / 2;
            self.dearest = self.chosen.iter().map(|&index| self.cost[index as usize]).fold(0.0, f64::max);
            return looked_at;
        };
        let slack = (SLACK * f64::from(last + 1 - first)) as u32;
        let is_known = |way: usize, frame: &u32| self.reach[way].cost[*frame as usize].is_finite();
        // A frame of the main component is reached by something; only, what leads there may begin after the stretch's end.
        let enters = (first + slack..=last).find(|frame| is_known(0, frame));
        let leaves = (first..=last - slack).rev().find(|frame| is_known(1, frame));
        let (Some(enters), Some(leaves)) = (enters, leaves) else {
            self.given_up[first as usize..=last as usize].fill(true);
            return looked_at;
        };
        let leaves = leaves.max(enters);
        if !is_known(1, &leaves) {
            self.given_up[first as usize..=last as usize].fill(true);
            return looked_at;
        }
        let mut frames: Vec<u32> = (enters..=leaves).collect();
        let mut taken = Vec::new();
        for (way, mut frame) in [(0, enters), (1, leaves)] {
            // Ways are trees that begin within what is joined: no longer than there are frames.
            for _ in 0..self.inside.len() {
                frames.push(frame);
                frame = match self.reach[way].via[frame as usize] {
                    Via::Nothing => break,
                    Via::Recorded => match timeline.offset(frame, if way == 0 { -1 } else { 1 }) {
                        Some(beside) => beside,
                        None => break,
                    },
                    Via::Transition(index) => {
                        taken.push(index);
                        let transition = &graph.transitions()[index as usize];
                        if way == 0 { transition.from } else { transition.to }
                    }
                };
            }
        }
        for index in taken {
            if !self.chosen.contains(&index) {
                self.chosen.push(index);
            }
        }
        frames.into_iter().for_each(|frame| self.join(frame));
        // What is left at the stretch's ends stays so: an ear for it would be as long as its slack.
        for frame in (first..enters).chain(leaves + 1..=last) {
            self.given_up[frame as usize] = !self.inside[frame as usize];
        }
        looked_at
    }

    /// Looks at the best transitions that are left, and takes those between joined frames that are far enough from all others:
    /// first what leads to another sequence, then anything.
    fn fill(&mut self, graph: &EssentialGraph, search_graph: &SearchGraph) -> Option<usize> {
        let apart = (APART * search_graph.fps) as u32;
        if self.next == 2 * self.order.len() || self.chosen.len() >= self.enough {
            return None;
        }
        let end = (self.next + LOOKED_AT).min(2 * self.order.len());
        for place in self.next..end {
            let is_second = place >= self.order.len();
            let index = self.order[place % self.order.len()];
            let transition = &graph.transitions()[index as usize];
            let is_near = |&other: &u32| {
                let other = &graph.transitions()[other as usize];
                transition.from.abs_diff(other.from) < apart && transition.to.abs_diff(other.to) < apart
            };
            let is_inside = self.inside[transition.from as usize] && self.inside[transition.to as usize];
            let [from, to] = [transition.from, transition.to].map(|frame| search_graph.sequence(frame));
            let enough = if is_second { self.enough } else { self.crossing };
            // What comes back to where it was shows it again, or holds it still.
            let leads_on = from != to || is_second && transition.from.abs_diff(transition.to) >= LEADS_ON * apart;
            let is_good = self.cost[index as usize] <= self.dearest;
            if is_inside && leads_on && is_good && self.chosen.len() < enough && !self.chosen.iter().any(is_near) {
                self.chosen.push(index);
            }
        }
        let looked_at = (end - self.next) * self.chosen.len().max(1);
        self.next = end;
        Some(looked_at)
    }
}

/// How far apart the two sides are that a transition blends, on average.
pub(super) fn mean_distance(graph: &EssentialGraph, index: u32) -> f64 {
    let transition = &graph.transitions()[index as usize];
    f64::from(transition.deformation) / transition.warp.duration() as f64
}
