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

mod chain;
mod optimiser;
mod simplex;

pub use chain::Chain;
pub use optimiser::Optimiser;
