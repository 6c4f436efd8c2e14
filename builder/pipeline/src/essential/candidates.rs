//! Transitions that may be essential, and what a frame's neighbours say about its transitions.

use actor::timeline::Timeline;

use crate::transitions::TransitionCost;

/// Transitions that may be essential: by source frame, then by destination.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    /// Where those of each frame begin; one more than there are frames.
    first: Vec<usize>,
    /// Destination and transition.
    transitions: Vec<(u32, TransitionCost)>,
}

impl Candidates {
    /// Those whose rows are not yet seen come later, by [`Self::push_row`].
    #[must_use]
    pub fn new() -> Self {
        Self { first: vec![0], transitions: Vec::new() }
    }

    /// Appends what [`row_candidates`] leaves of the next frame's row.
    pub fn push_row(&mut self, row: impl IntoIterator<Item = (u32, TransitionCost)>) {
        self.transitions.extend(row);
        self.first.push(self.transitions.len());
    }

    /// The transitions that leave from `frame`, by destination.
    #[must_use]
    pub fn from(&self, frame: u32) -> &[(u32, TransitionCost)] {
        &self.transitions[self.first[frame as usize]..self.first[frame as usize + 1]]
    }

    /// The transition between two frames, where it is among them.
    #[must_use]
    pub fn get(&self, from: u32, to: u32) -> Option<TransitionCost> {
        let row = self.from(from);
        row.binary_search_by_key(&to, |&(to, _)| to).ok().map(|place| row[place].1)
    }

    /// Number of frames whose rows were seen.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        (self.first.len() - 1) as u32
    }

    /// Number of transitions.
    #[must_use]
    pub fn len(&self) -> usize {
        self.transitions.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.transitions.is_empty()
    }
}

/// What of the transitions from frame `from` may be essential: `row` holds those to all frames, and `next` those from the
/// frame recorded after it, where that is known. `cost` is E of a transition that exists, or infinity.
pub fn row_candidates(
    timeline: &Timeline,
    alpha: f64,
    from: u32,
    row: &[TransitionCost],
    next: Option<&[TransitionCost]>,
) -> Vec<(u32, TransitionCost)> {
    let cost = |cost: &TransitionCost| if cost.duration > 0 { cost.cost(alpha) } else { f64::INFINITY };
    let mut kept = Vec::new();
    for sequence in timeline.sequences() {
        for to in sequence.first_frame..sequence.end_frame() {
            let own = cost(&row[to as usize]);
            if to == from || own == f64::INFINITY || own >= recorded(timeline, alpha, from, to) {
                continue;
            }
            let before = timeline.offset(to, -1).filter(|&before| timeline.next(before) == Some(to));
            let earlier = before.map_or(f64::INFINITY, |before| {
                let arrival = if before == from { 0.0 } else { cost(&row[before as usize]) };
                arrival.min(recorded(timeline, alpha, from, before)) + alpha
            });
            let later = match (timeline.next(from), next) {
                (Some(after), Some(next)) if after != to => {
                    alpha + cost(&next[to as usize]).min(recorded(timeline, alpha, after, to))
                }
                _ => f64::INFINITY,
            };
            if own < earlier && own < later {
                kept.push((to, row[to as usize]));
            }
        }
    }
    kept
}

/// alpha times the recorded steps from i to j, or infinity.
fn recorded(timeline: &Timeline, alpha: f64, i: u32, j: u32) -> f64 {
    let Some(sequence) = timeline.sequence_of(i).filter(|sequence| sequence.contains(j)) else {
        return f64::INFINITY;
    };
    let steps = i64::from(j) - i64::from(i);
    match (steps >= 0, sequence.cyclic) {
        (true, _) => alpha * steps as f64,
        (false, true) => alpha * (steps + i64::from(sequence.frame_count)) as f64,
        (false, false) => f64::INFINITY,
    }
}
