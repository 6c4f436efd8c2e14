//! Random walks whose stationary distribution is close to a wanted one (Prada and others 2016, section 7.1).
//!
//! Over row-stochastic P on given edges, minimise `a |F| |S(P) - pi|^2 + (1 - a) |E| / |F|^2 |P|_F^2`, where S(P) is the
//! stationary distribution and a = 0.08. As in the paper, the convex proxy with pi P in place of S(P) gives the start; it
//! is minimised by accelerated projected gradients. Where the paper then searches for patterns, the true objective is
//! minimised by projected gradients too: its derivative by P(i, j) is S(i) g(j), where g solves (I - P) g = r - (S r) for the
//! derivative r by S.
//!
//! Both linear systems are solved by damped Gauss-Seidel sweeps in the order of the frames: as most edges lead to the next
//! frame, a sweep carries what it has through whole sequences, and a few dozen do what thousands of steps of the chain would.
//! Work is counted in sweeps.

use super::meter;

/// The weight of the distribution against the evenness of choices: the paper's.
const EVENNESS: f64 = 0.08;
/// Rounds of the proxy.
const PROXY_ROUNDS: u32 = 150;
/// Rounds of the true objective.
const TRUE_ROUNDS: u32 = 40;
/// Most sweeps for a linear system.
const SWEEPS: u32 = 400;
/// The share of the new value that a sweep takes: below 1, so that it converges on chains with a period too.
const DAMPING: f64 = 0.9;
/// The sum of all changes below which a sweep was the last.
const STILL: f64 = 1e-10;

/// A Markov chain over the states of a graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// First edge of each state, and the number of edges.
    first: Vec<u32>,
    /// Where edges lead.
    ends: Vec<u32>,
    /// Probability of each edge; those of a state have the sum 1.
    probabilities: Vec<f64>,
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
    fn settle(&self, now: &mut [f64]) -> f64 {
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
    fn settle_potential(&self, potential: &mut [f64], source: &[f64]) -> f64 {
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

    /// Mixes a share of equal probabilities in.
    fn open(&mut self, share: f64) {
        for state in 0..self.states() {
            let row = self.row(state);
            let even = share / row.len() as f64;
            self.probabilities[row].iter_mut().for_each(|p| *p = (1.0 - share) * *p + even);
        }
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

/// The nearest point whose coordinates are not negative and have the sum 1 (Held, Wolfe and Crowder 1974).
fn project(row: &mut [f64]) {
    if let [only] = row {
        *only = 1.0;
        return;
    }
    let mut sorted = row.to_vec();
    // Rows are short, and a sort of their own would weigh 2 KB on the page.
    for end in 1..sorted.len() {
        let mut at = end;
        while at > 0 && sorted[at - 1] < sorted[at] {
            sorted.swap(at - 1, at);
            at -= 1;
        }
    }
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

/// Makes a chain's stationary distribution close to a wanted one, a sweep over all edges at a time.
#[derive(Clone, Debug)]
pub struct Optimiser {
    chain: Chain,
    wanted: Vec<f64>,
    stage: Stage,
    /// Rounds of the proxy or of the true objective that are done, and sweeps of the system that is being solved.
    round: u32,
    sweeps: u32,
    /// The proxy's look-ahead, and its momentum.
    ahead: Vec<f64>,
    momentum: f64,
    stationary: Vec<f64>,
    /// What is being solved for: a stationary distribution or a potential, and the potential's source.
    iterate: Vec<f64>,
    source: Vec<f64>,
    /// The descent under way: its gradient, the chain that is tried, and how often one was.
    gradient: Vec<f64>,
    tried: Chain,
    tries: u32,
    /// The paper's objective: for equal probabilities, after the proxy, and now.
    objectives: [f64; 3],
    step: f64,
}

/// What the next sweep is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The stationary distribution of equal probabilities.
    Even,
    /// A round of the proxy.
    Proxy,
    /// The stationary distribution after the proxy.
    Proxied,
    /// The potential that the true objective's gradient takes.
    Potential,
    /// The stationary distribution of a step along that gradient.
    Trial,
    /// Nothing.
    Done,
}

impl Optimiser {
    /// Starts from equal probabilities. `wanted` has one positive number a state; its sum is brought to 1.
    #[must_use]
    pub fn new(chain: Chain, wanted: &[f64]) -> Self {
        let sum: f64 = wanted.iter().sum();
        let wanted: Vec<f64> = wanted.iter().map(|w| w / sum).collect();
        Self {
            ahead: chain.probabilities.clone(),
            tried: chain.clone(),
            chain,
            stationary: wanted.clone(),
            iterate: wanted.clone(),
            wanted,
            stage: Stage::Even,
            round: 0,
            sweeps: 0,
            momentum: 1.0,
            source: Vec::new(),
            gradient: Vec::new(),
            tries: 0,
            objectives: [f64::INFINITY; 3],
            step: 1.0,
        }
    }

    /// Does up to `sweeps` sweeps over all edges; whether it has converged.
    pub fn advance(&mut self, sweeps: u32) -> bool {
        for _ in 0..sweeps {
            meter::count(self.chain.ends.len());
            let moved = match self.stage {
                Stage::Even | Stage::Proxied => self.chain.settle(&mut self.iterate),
                Stage::Trial => self.tried.settle(&mut self.iterate),
                Stage::Potential => self.chain.settle_potential(&mut self.iterate, &self.source),
                Stage::Proxy => {
                    self.proxy_round();
                    continue;
                }
                Stage::Done => return true,
            };
            self.sweeps += 1;
            if moved < STILL || self.sweeps >= SWEEPS {
                self.sweeps = 0;
                self.solved();
            }
        }
        self.stage == Stage::Done
    }

    /// Goes on with what a system was solved for.
    fn solved(&mut self) {
        let objective = |chain: &Chain| chain.objective(&self.wanted, &self.iterate);
        match self.stage {
            Stage::Even => {
                self.objectives = [objective(&self.chain); 3];
                self.stationary.clone_from(&self.iterate);
                self.stage = Stage::Proxy;
            }
            Stage::Proxied => {
                self.objectives[1] = objective(&self.chain);
                self.objectives[2] = self.objectives[1];
                self.stationary.clone_from(&self.iterate);
                self.step = 1.0 / self.chain.weight_of_evenness();
                self.round = 0;
                self.begin_potential();
            }
            Stage::Potential => {
                self.gradient = self.true_gradient();
                self.tries = 0;
                self.begin_trial();
            }
            Stage::Trial => {
                let now = objective(&self.tried);
                if now < self.objectives[2] * (1.0 - 1e-7) {
                    std::mem::swap(&mut self.chain, &mut self.tried);
                    self.stationary.clone_from(&self.iterate);
                    self.objectives[2] = now;
                    self.step *= 1.6;
                    self.round += 1;
                    self.begin_potential();
                } else {
                    self.step *= 0.4;
                    self.tries += 1;
                    self.begin_trial();
                }
            }
            Stage::Proxy | Stage::Done => {}
        }
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

    /// The paper's objective: for equal probabilities, after the proxy, and now; infinite before it is known.
    #[must_use]
    pub fn objectives(&self) -> [f64; 3] {
        self.objectives
    }

    /// A round of FISTA (Beck and Teboulle 2009) on `a |F| |pi P - pi|^2 + ...`.
    fn proxy_round(&mut self) {
        let looked = std::mem::take(&mut self.ahead);
        std::mem::swap(&mut self.tried.probabilities, &mut self.ahead);
        self.tried.probabilities = looked;
        let (chain, looked) = (&self.chain, &self.tried);
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
        self.round += 1;
        if self.round == PROXY_ROUNDS {
            // The proxy's solution may close states off: a little of the even chain keeps every edge open.
            self.chain.open(0.02);
            self.iterate.clone_from(&self.wanted);
            self.stage = Stage::Proxied;
        }
    }

    fn begin_potential(&mut self) {
        if self.round >= TRUE_ROUNDS {
            self.stage = Stage::Done;
            return;
        }
        let a = 2.0 * self.chain.weight_of_distribution();
        self.source = self.stationary.iter().zip(&self.wanted).map(|(s, w)| a * (s - w)).collect();
        let mean: f64 = self.source.iter().zip(&self.stationary).map(|(r, s)| r * s).sum();
        self.source.iter_mut().for_each(|r| *r -= mean);
        self.iterate = vec![0.0; self.chain.states()];
        self.stage = Stage::Potential;
    }

    /// The derivative of the objective by each probability, once the potential is solved for.
    fn true_gradient(&self) -> Vec<f64> {
        let chain = &self.chain;
        let b = 2.0 * chain.weight_of_evenness();
        let mut gradient = vec![0.0; chain.ends.len()];
        for state in 0..chain.states() {
            for (edge, end, p) in chain.edges(state) {
                gradient[edge] = self.stationary[state] * self.iterate[end as usize] + b * p;
            }
        }
        gradient
    }

    /// Tries a projected step along the gradient, shorter each time; after twelve there is nothing to be had.
    fn begin_trial(&mut self) {
        if self.tries == 12 {
            self.stage = Stage::Done;
            return;
        }
        self.tried.probabilities = self.chain.moved(&self.chain.probabilities, &self.gradient, self.step);
        // Edges stay open, so that the chain stays irreducible and its distribution unique.
        self.tried.open(0.0001);
        self.iterate.clone_from(&self.stationary);
        self.stage = Stage::Trial;
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
