//! A Markov chain over a graph: its steps, its stationary distribution, and how good that is.

/// The weight of the distribution against the evenness of choices: alpha of Prada and others (2016), section 7.1.
const EVENNESS: f64 = 0.08;
/// Most sweeps for a linear system.
pub(super) const SWEEPS: u32 = 400;
/// The share of the new value that a sweep takes: below 1, so that it converges on chains with a period too.
const DAMPING: f64 = 0.9;
/// The sum of all changes below which a sweep was the last.
pub(super) const STILL: f64 = 1e-10;

/// A Markov chain over the states of a graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// First edge of each state, and the number of edges.
    first: Vec<u32>,
    /// Where edges lead.
    pub(super) ends: Vec<u32>,
    /// Probability of each edge; those of a state have the sum 1.
    pub(super) probabilities: Vec<f64>,
    /// First arrival of each state, and the number of arrivals: (state that it comes from, edge).
    first_arrival: Vec<u32>,
    arrivals: Vec<(u32, u32)>,
}

impl Chain {
    /// All edges of a state equally likely. `edges` are (from, to), sorted, and every one of `states` states has at least
    /// one; `None` where that is not so.
    #[must_use]
    pub fn even(states: u32, edges: &[(u32, u32)]) -> Option<Self> {
        let mut first = vec![0_u32; states as usize + 1];
        for &(from, to) in edges {
            if from >= states || to >= states {
                return None;
            }
            first[from as usize + 1] += 1;
        }
        if first[1..].contains(&0) || !edges.is_sorted() {
            return None;
        }
        for state in 0..states as usize {
            first[state + 1] += first[state];
        }
        let ends: Vec<u32> = edges.iter().map(|&(_, to)| to).collect();
        let (first_arrival, arrivals) = arrivals(states, edges);
        let rows = first.windows(2).flat_map(|pair| {
            let count = (pair[1] - pair[0]) as usize;
            std::iter::repeat_n(1.0 / count as f64, count)
        });
        let probabilities = rows.collect();
        Some(Self { first, ends, probabilities, first_arrival, arrivals })
    }

    /// Number of states.
    #[must_use]
    pub fn states(&self) -> usize {
        self.first.len() - 1
    }

    /// Edges of a state as (number of the edge, where it leads, probability).
    pub fn edges(&self, state: usize) -> impl Iterator<Item = (usize, u32, f64)> {
        self.row(state).map(|edge| (edge, self.ends[edge], self.probabilities[edge]))
    }

    /// The state that an edge leads to.
    #[must_use]
    pub fn end(&self, edge: usize) -> u32 {
        self.ends[edge]
    }

    /// Numbers of the edges of a state.
    pub(super) fn row(&self, state: usize) -> std::ops::Range<usize> {
        self.first[state] as usize..self.first[state + 1] as usize
    }

    /// `distribution` after a step.
    #[must_use]
    pub fn step(&self, distribution: &[f64]) -> Vec<f64> {
        let mut after = vec![0.0; self.states()];
        for (state, &mass) in distribution.iter().enumerate() {
            for edge in self.row(state) {
                after[self.ends[edge] as usize] += mass * self.probabilities[edge];
            }
        }
        after
    }

    /// The stationary distribution of an irreducible chain, from `guess` on.
    #[must_use]
    pub fn stationary(&self, guess: &[f64]) -> Vec<f64> {
        let mut now = guess.to_vec();
        for _ in 0..SWEEPS {
            if self.settle(&mut now) < STILL {
                break;
            }
        }
        now
    }

    /// A sweep towards the stationary distribution; the sum of the changes.
    pub(super) fn settle(&self, now: &mut [f64]) -> f64 {
        let (mut moved, mut sum) = (0.0, 0.0);
        for state in 0..self.states() {
            let arrivals = self.first_arrival[state] as usize..self.first_arrival[state + 1] as usize;
            let arriving: f64 = self.arrivals[arrivals]
                .iter()
                .map(|&(from, edge)| now[from as usize] * self.probabilities[edge as usize])
                .sum();
            let change = DAMPING * (arriving - now[state]);
            now[state] += change;
            moved += change.abs();
            sum += now[state];
        }
        now.iter_mut().for_each(|mass| *mass /= sum);
        moved
    }

    /// A sweep towards g with (I - P) g = `source`; the sum of the changes.
    pub(super) fn settle_potential(&self, potential: &mut [f64], source: &[f64]) -> f64 {
        let mut moved = 0.0;
        for state in (0..self.states()).rev() {
            let ahead: f64 =
                self.row(state).map(|edge| self.probabilities[edge] * potential[self.ends[edge] as usize]).sum();
            let change = DAMPING * (ahead + source[state] - potential[state]);
            potential[state] += change;
            moved += change.abs();
        }
        moved
    }

    /// The square of |P|_F.
    #[must_use]
    pub fn unevenness(&self) -> f64 {
        self.probabilities.iter().map(|p| p * p).sum()
    }

    /// The objective of Prada and others (2016), section 7.1, for a wanted distribution.
    #[must_use]
    pub fn objective(&self, wanted: &[f64], stationary: &[f64]) -> f64 {
        let off: f64 = stationary.iter().zip(wanted).map(|(s, w)| (s - w) * (s - w)).sum();
        self.weight_of_distribution() * off + self.weight_of_evenness() * self.unevenness()
    }

    pub(super) fn weight_of_distribution(&self) -> f64 {
        EVENNESS * self.states() as f64
    }

    pub(super) fn weight_of_evenness(&self) -> f64 {
        (1.0 - EVENNESS) * self.ends.len() as f64 / (self.states() as f64 * self.states() as f64)
    }
}

/// Edges by the state that they lead to.
fn arrivals(states: u32, edges: &[(u32, u32)]) -> (Vec<u32>, Vec<(u32, u32)>) {
    let mut first = vec![0_u32; states as usize + 1];
    for &(_, to) in edges {
        first[to as usize + 1] += 1;
    }
    for state in 0..states as usize {
        first[state + 1] += first[state];
    }
    let mut next = first.clone();
    let mut arrivals = vec![(0, 0); edges.len()];
    for (edge, &(from, to)) in edges.iter().enumerate() {
        let slot = &mut next[to as usize];
        arrivals[*slot as usize] = (from, edge as u32);
        *slot += 1;
    }
    (first, arrivals)
}
