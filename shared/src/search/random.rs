//! Random walks whose stationary distribution is close to a wanted one (Prada and others 2016, section 7.1).
//!
//! Over row-stochastic P on given edges, minimise `a |F| |S(P) - pi|^2 + (1 - a) |E| / |F|^2 |P|_F^2`, where S(P) is the
//! stationary distribution and a = 0.08. As in the paper, the convex proxy with pi P in place of S(P) gives the start; it
//! is minimised by accelerated projected gradients. Where the paper then searches for patterns, the true objective is
//! minimised by projected gradients too: its derivative by P(i, j) is S(i) g(j), where g solves (I - P) g = r - (S r) for the
//! derivative r by S.

/// The weight of the distribution against the evenness of choices: the paper's.
const EVENNESS: f64 = 0.08;
/// Rounds of the proxy.
const PROXY_ROUNDS: u32 = 150;
/// Rounds of the true objective.
const TRUE_ROUNDS: u32 = 40;
/// Most sweeps for a stationary distribution.
const SWEEPS: u32 = 2000;

/// A Markov chain over the states of a graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// First edge of each state, and the number of edges.
    first: Vec<u32>,
    /// Where edges lead.
    ends: Vec<u32>,
    /// Probability of each edge; those of a state have the sum 1.
    probabilities: Vec<f64>,
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
        let ends = edges.iter().map(|&(_, to)| to).collect();
        let rows = first.windows(2).flat_map(|pair| {
            let count = (pair[1] - pair[0]) as usize;
            std::iter::repeat_n(1.0 / count as f64, count)
        });
        let probabilities = rows.collect();
        Some(Self { first, ends, probabilities })
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

    fn row(&self, state: usize) -> std::ops::Range<usize> {
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

    /// The stationary distribution of an irreducible chain: steps of the lazy chain (which has the same one, and no period)
    /// from `guess` until nothing moves.
    #[must_use]
    pub fn stationary(&self, guess: &[f64]) -> Vec<f64> {
        let mut now = guess.to_vec();
        for _ in 0..SWEEPS {
            let after = self.step(&now);
            let moved: f64 = after.iter().zip(&now).map(|(a, b)| (a - b).abs()).sum();
            now.iter_mut().zip(&after).for_each(|(now, after)| *now = 0.5 * (*now + after));
            if moved < 1e-9 {
                break;
            }
        }
        now
    }

    /// The square of |P|_F.
    #[must_use]
    pub fn unevenness(&self) -> f64 {
        self.probabilities.iter().map(|p| p * p).sum()
    }

    /// The paper's objective for a wanted distribution.
    #[must_use]
    pub fn objective(&self, wanted: &[f64], stationary: &[f64]) -> f64 {
        let off: f64 = stationary.iter().zip(wanted).map(|(s, w)| (s - w) * (s - w)).sum();
        self.weight_of_distribution() * off + self.weight_of_evenness() * self.unevenness()
    }

    fn weight_of_distribution(&self) -> f64 {
        EVENNESS * self.states() as f64
    }

    fn weight_of_evenness(&self) -> f64 {
        (1.0 - EVENNESS) * self.ends.len() as f64 / (self.states() as f64 * self.states() as f64)
    }

    /// Moves against `gradient` and back onto the rows' simplices.
    fn moved(&self, from: &[f64], gradient: &[f64], step: f64) -> Vec<f64> {
        let mut to: Vec<f64> = from.iter().zip(gradient).map(|(p, g)| p - step * g).collect();
        for state in 0..self.states() {
            project(&mut to[self.row(state)]);
        }
        to
    }
}

/// The nearest point whose coordinates are not negative and have the sum 1 (Held, Wolfe and Crowder 1974).
fn project(row: &mut [f64]) {
    let mut sorted = row.to_vec();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let (mut sum, mut shift) = (0.0, 0.0);
    for (index, value) in sorted.iter().enumerate() {
        sum += value;
        let candidate = (sum - 1.0) / (index + 1) as f64;
        if value - candidate > 0.0 {
            shift = candidate;
        }
    }
    row.iter_mut().for_each(|value| *value = (*value - shift).max(0.0));
}

/// Makes a chain's stationary distribution close to a wanted one, a round at a time.
#[derive(Clone, Debug)]
pub struct Optimiser {
    chain: Chain,
    wanted: Vec<f64>,
    round: u32,
    /// The proxy's look-ahead, and its momentum.
    ahead: Vec<f64>,
    momentum: f64,
    stationary: Vec<f64>,
    objective: f64,
    even_objective: f64,
    proxy_objective: f64,
    step: f64,
}

impl Optimiser {
    /// Starts from equal probabilities. `wanted` has one positive number a state; its sum is brought to 1.
    #[must_use]
    pub fn new(chain: Chain, wanted: &[f64]) -> Self {
        let sum: f64 = wanted.iter().sum();
        let wanted: Vec<f64> = wanted.iter().map(|w| w / sum).collect();
        let stationary = chain.stationary(&wanted);
        let objective = chain.objective(&wanted, &stationary);
        Self {
            ahead: chain.probabilities.clone(),
            chain,
            wanted,
            round: 0,
            momentum: 1.0,
            stationary,
            objective,
            even_objective: objective,
            proxy_objective: objective,
            step: 1.0,
        }
    }

    /// Does up to `rounds` rounds, a few sweeps over all edges each; whether it has converged.
    pub fn advance(&mut self, rounds: u32) -> bool {
        for _ in 0..rounds {
            match self.round {
                round if round < PROXY_ROUNDS => self.proxy_round(),
                round if round < PROXY_ROUNDS + TRUE_ROUNDS => {
                    if !self.true_round() {
                        self.round = PROXY_ROUNDS + TRUE_ROUNDS;
                    }
                }
                _ => return true,
            }
            self.round += 1;
        }
        self.round >= PROXY_ROUNDS + TRUE_ROUNDS
    }

    /// The chain so far.
    #[must_use]
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// The wanted distribution.
    #[must_use]
    pub fn wanted(&self) -> &[f64] {
        &self.wanted
    }

    /// The stationary distribution so far.
    #[must_use]
    pub fn stationary(&self) -> &[f64] {
        &self.stationary
    }

    /// The paper's objective: for equal probabilities, after the proxy, and now.
    #[must_use]
    pub fn objectives(&self) -> [f64; 3] {
        [self.even_objective, self.proxy_objective, self.objective]
    }

    /// A round of FISTA (Beck and Teboulle 2009) on `a |F| |pi P - pi|^2 + ...`.
    fn proxy_round(&mut self) {
        let chain = &self.chain;
        let looked = Chain { probabilities: std::mem::take(&mut self.ahead), ..chain.clone() };
        let reached = looked.step(&self.wanted);
        let off: Vec<f64> = reached.iter().zip(&self.wanted).map(|(r, w)| r - w).collect();
        let (a, b) = (2.0 * chain.weight_of_distribution(), 2.0 * chain.weight_of_evenness());
        let mut gradient = vec![0.0; chain.ends.len()];
        let mut incoming = vec![0.0; chain.states()];
        for state in 0..chain.states() {
            for edge in chain.row(state) {
                let end = chain.ends[edge] as usize;
                gradient[edge] = a * self.wanted[state] * off[end] + b * looked.probabilities[edge];
                incoming[end] += self.wanted[state] * self.wanted[state];
            }
        }
        // The Hessian of the first term is a block of rank one for each end.
        let steepest = a * incoming.iter().copied().fold(0.0, f64::max) + b;
        let next = chain.moved(&looked.probabilities, &gradient, 1.0 / steepest);
        let momentum = 0.5 * (1.0 + (1.0 + 4.0 * self.momentum * self.momentum).sqrt());
        let push = (self.momentum - 1.0) / momentum;
        self.ahead = next.iter().zip(&chain.probabilities).map(|(new, old)| new + push * (new - old)).collect();
        self.momentum = momentum;
        self.chain.probabilities = next;
        if self.round + 1 == PROXY_ROUNDS {
            self.begin_true();
        }
    }

    /// The proxy's solution may close states off: a little of the even chain keeps every edge open.
    fn begin_true(&mut self) {
        for state in 0..self.chain.states() {
            let row = self.chain.row(state);
            let even = 1.0 / row.len() as f64;
            self.chain.probabilities[row].iter_mut().for_each(|p| *p = 0.98 * *p + 0.02 * even);
        }
        self.stationary = self.chain.stationary(&self.wanted);
        self.objective = self.chain.objective(&self.wanted, &self.stationary);
        self.proxy_objective = self.objective;
        self.step = 1.0 / self.chain.weight_of_evenness();
    }

    /// A projected gradient step with backtracking on the true objective; whether it went down.
    fn true_round(&mut self) -> bool {
        let gradient = self.true_gradient();
        for _ in 0..12 {
            let probabilities = self.chain.moved(&self.chain.probabilities, &gradient, self.step);
            let mut tried = Chain { probabilities, ..self.chain.clone() };
            // Edges stay open, so that the chain stays irreducible and its distribution unique.
            for state in 0..tried.states() {
                let row = tried.row(state);
                let even = 1.0 / row.len() as f64;
                tried.probabilities[row].iter_mut().for_each(|p| *p = 0.9999 * *p + 0.0001 * even);
            }
            let stationary = tried.stationary(&self.stationary);
            let objective = tried.objective(&self.wanted, &stationary);
            if objective < self.objective * (1.0 - 1e-7) {
                (self.chain, self.stationary, self.objective) = (tried, stationary, objective);
                self.step *= 1.6;
                return true;
            }
            self.step *= 0.4;
        }
        false
    }

    fn true_gradient(&self) -> Vec<f64> {
        let chain = &self.chain;
        let (a, b) = (2.0 * chain.weight_of_distribution(), 2.0 * chain.weight_of_evenness());
        let by_stationary: Vec<f64> = self.stationary.iter().zip(&self.wanted).map(|(s, w)| a * (s - w)).collect();
        let mean: f64 = by_stationary.iter().zip(&self.stationary).map(|(r, s)| r * s).sum();
        let source: Vec<f64> = by_stationary.iter().map(|r| r - mean).collect();
        // g = sum of P^k source, by the lazy chain: (I - (I + P) / 2) is half of (I - P).
        let mut potential = vec![0.0; chain.states()];
        for _ in 0..SWEEPS {
            let mut moved = 0.0_f64;
            let mut next = potential.clone();
            for state in 0..chain.states() {
                let ahead: f64 = chain.edges(state).map(|(_, end, p)| p * potential[end as usize]).sum();
                next[state] = 0.5 * (potential[state] + ahead + source[state]);
                moved = moved.max((next[state] - potential[state]).abs());
            }
            potential = next;
            if moved < 1e-9 {
                break;
            }
        }
        let mut gradient = vec![0.0; chain.ends.len()];
        for state in 0..chain.states() {
            for (edge, end, p) in chain.edges(state) {
                gradient[edge] = self.stationary[state] * potential[end as usize] + b * p;
            }
        }
        gradient
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No small shift between two choices of a state makes the objective better by more than the rounds' tolerance.
    #[test]
    fn the_optimum_cannot_be_shifted() {
        let states = 12_u32;
        let mut edges: Vec<(u32, u32)> = (0..states).map(|state| (state, (state + 1) % states)).collect();
        edges.extend((0..20).map(|k| (k * 7 % states, k * 5 % states)));
        edges.sort_unstable();
        edges.dedup();
        let wanted: Vec<f64> = (0..states).map(|state| f64::from(1 + state % 3)).collect();
        let Some(chain) = Chain::even(states, &edges) else { panic!("every state has an edge") };
        let mut optimiser = Optimiser::new(chain, &wanted);
        while !optimiser.advance(1) {}
        let (best, shift) = (optimiser.objectives()[2], 1e-3);
        for state in 0..optimiser.chain.states() {
            let row = optimiser.chain.row(state);
            for (from, to) in row.clone().flat_map(|from| row.clone().map(move |to| (from, to))) {
                let mut shifted = optimiser.chain.clone();
                if shifted.probabilities[from] > 2.0 * shift {
                    shifted.probabilities[from] -= shift;
                    shifted.probabilities[to] += shift;
                    let objective = shifted.objective(&optimiser.wanted, &shifted.stationary(&optimiser.stationary));
                    assert!(objective > best - 2e-6, "{objective} against {best}");
                }
            }
        }
    }
}
