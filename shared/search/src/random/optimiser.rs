//! Projected gradients on the proxy, then on the true objective, in sweeps.

use super::chain::{Chain, STILL, SWEEPS};
use crate::meter;

/// Rounds of the proxy.
const PROXY_ROUNDS: u32 = 150;
/// Rounds of the true objective.
const TRUE_ROUNDS: u32 = 40;

/// Makes a chain's stationary distribution close to a wanted one, a sweep over all edges at a time.
#[derive(Clone, Debug)]
pub struct Optimiser {
    chain: Chain,
    wanted: Vec<f64>,
    stage: Sweep,
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
    /// The objective of Prada and others (2016), section 7.1: for equal probabilities, after the proxy, and now.
    objectives: [f64; 3],
    step: f64,
}

/// What the next sweep is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sweep {
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
            stage: Sweep::Even,
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
                Sweep::Even | Sweep::Proxied => self.chain.settle(&mut self.iterate),
                Sweep::Trial => self.tried.settle(&mut self.iterate),
                Sweep::Potential => self.chain.settle_potential(&mut self.iterate, &self.source),
                Sweep::Proxy => {
                    self.proxy_round();
                    continue;
                }
                Sweep::Done => return true,
            };
            self.sweeps += 1;
            if moved < STILL || self.sweeps >= SWEEPS {
                self.sweeps = 0;
                self.solved();
            }
        }
        self.stage == Sweep::Done
    }

    /// Goes on with what a system was solved for.
    fn solved(&mut self) {
        let objective = |chain: &Chain| chain.objective(&self.wanted, &self.iterate);
        match self.stage {
            Sweep::Even => {
                self.objectives = [objective(&self.chain); 3];
                self.stationary.clone_from(&self.iterate);
                self.stage = Sweep::Proxy;
            }
            Sweep::Proxied => {
                self.objectives[1] = objective(&self.chain);
                self.objectives[2] = self.objectives[1];
                self.stationary.clone_from(&self.iterate);
                self.step = 1.0 / self.chain.weight_of_evenness();
                self.round = 0;
                self.begin_potential();
            }
            Sweep::Potential => {
                self.gradient = self.true_gradient();
                self.tries = 0;
                self.begin_trial();
            }
            Sweep::Trial => {
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
            Sweep::Proxy | Sweep::Done => {}
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

    /// The objective of Prada and others (2016), section 7.1: for equal probabilities, after the proxy, and now;
    /// infinite before it is known.
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
            self.stage = Sweep::Proxied;
        }
    }

    fn begin_potential(&mut self) {
        if self.round >= TRUE_ROUNDS {
            self.stage = Sweep::Done;
            return;
        }
        let a = 2.0 * self.chain.weight_of_distribution();
        self.source = self.stationary.iter().zip(&self.wanted).map(|(s, w)| a * (s - w)).collect();
        let mean: f64 = self.source.iter().zip(&self.stationary).map(|(r, s)| r * s).sum();
        self.source.iter_mut().for_each(|r| *r -= mean);
        self.iterate = vec![0.0; self.chain.states()];
        self.stage = Sweep::Potential;
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
            self.stage = Sweep::Done;
            return;
        }
        self.tried.probabilities = self.chain.moved(&self.chain.probabilities, &self.gradient, self.step);
        // Edges stay open, so that the chain stays irreducible and its distribution unique.
        self.tried.open(0.0001);
        self.iterate.clone_from(&self.stationary);
        self.stage = Sweep::Trial;
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
