//! Hybrid Monte Carlo: places drawn with the likelihood exp(-energy), each some way along a frictionless slide from the one before
//! (Duane et al. 1987; thesis section 6.6).

use std::f64::consts::TAU;

use kernels::random::mix;

/// How a chain is walked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HmcOptions {
    /// Steps of a slide.
    pub steps: usize,
    /// Length of a step at first; halved while too few slides are accepted.
    pub length: f64,
    /// Slides before the first sample.
    pub before: usize,
    /// Slides from one sample to the next.
    pub between: usize,
    /// Samples that are wanted.
    pub samples: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// The samples of a chain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain {
    /// Places.
    pub samples: Vec<Vec<f64>>,
    /// The share of slides after the first ones that were accepted.
    pub accepted: f64,
}

/// Of the first slides at least this share are to be accepted.
const ACCEPTED: f64 = 0.65;
/// The length of a step is looked at after so many slides.
const LOOK: usize = 5;
/// How often it is halved at most.
const HALVINGS: usize = 12;

/// Walks a chain from `start`. `energy` writes its gradient and returns its value; one that is not finite is never accepted.
pub fn sample(start: &[f64], options: &HmcOptions, mut energy: impl FnMut(&[f64], &mut [f64]) -> f64) -> Chain {
    let mut random = Random { seed: options.seed, drawn: 0 };
    let mut here = Place { at: start.to_vec(), gradient: vec![0.0; start.len()], energy: 0.0 };
    here.energy = energy(&here.at, &mut here.gradient);
    let (mut length, mut halvings) = (options.length, 0);
    let mut slides = 0;
    while slides < options.before {
        let looked = LOOK.min(options.before - slides).max(1);
        let accepted =
            (0..looked).filter(|_| slide(&mut here, options.steps, length, &mut random, &mut energy)).count();
        slides += looked;
        if (accepted as f64) < ACCEPTED * looked as f64 && halvings < HALVINGS {
            // From the beginning, with shorter steps.
            (length, halvings, slides) = (0.5 * length, halvings + 1, 0);
        }
    }
    let mut chain = Chain::default();
    let mut accepted = 0;
    for _ in 0..options.samples {
        for _ in 0..options.between {
            accepted += usize::from(slide(&mut here, options.steps, length, &mut random, &mut energy));
        }
        chain.samples.push(here.at.clone());
    }
    chain.accepted = accepted as f64 / (options.samples * options.between).max(1) as f64;
    chain
}

struct Place {
    at: Vec<f64>,
    gradient: Vec<f64>,
    energy: f64,
}

/// Slides from `here` with a random push (leapfrog); whether the end is accepted, and then `here`.
fn slide(
    here: &mut Place,
    steps: usize,
    length: f64,
    random: &mut Random,
    energy: &mut impl FnMut(&[f64], &mut [f64]) -> f64,
) -> bool {
    let length = length * (0.8 + 0.4 * random.uniform());
    let mut push: Vec<f64> = here.at.iter().map(|_| random.normal()).collect();
    let kinetic = |push: &[f64]| 0.5 * push.iter().map(|p| p * p).sum::<f64>();
    let before = here.energy + kinetic(&push);
    let (mut at, mut gradient) = (here.at.clone(), here.gradient.clone());
    let mut value = here.energy;
    for _ in 0..steps {
        push.iter_mut().zip(&gradient).for_each(|(p, g)| *p -= 0.5 * length * g);
        at.iter_mut().zip(&push).for_each(|(x, p)| *x += length * p);
        value = energy(&at, &mut gradient);
        if !value.is_finite() {
            break;
        }
        push.iter_mut().zip(&gradient).for_each(|(p, g)| *p -= 0.5 * length * g);
    }
    let after = value + kinetic(&push);
    // Drawn in any case, so that what comes later does not hang on rounding here.
    let threshold = random.uniform();
    let accepted = after.is_finite() && (before - after).exp() > threshold;
    if accepted {
        *here = Place { at, gradient, energy: value };
    }
    accepted
}

/// Random numbers one after the other.
struct Random {
    seed: u64,
    drawn: u64,
}

impl Random {
    /// Between 0 and 1, neither of them.
    fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        ((mix(self.seed, self.drawn) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Of mean 0 and variance 1 (Box and Muller).
    fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.uniform().ln()).sqrt(), TAU * self.uniform());
        radius * angle.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two numbers of covariance [[1, 0.8], [0.8, 2]].
    fn energy(x: &[f64], gradient: &mut [f64]) -> f64 {
        let determinant = 1.0 * 2.0 - 0.8 * 0.8;
        gradient[0] = (2.0 * x[0] - 0.8 * x[1]) / determinant;
        gradient[1] = (x[1] - 0.8 * x[0]) / determinant;
        0.5 * (x[0] * gradient[0] + x[1] * gradient[1])
    }

    #[test]
    fn samples_vary_as_they_are_likely() {
        let options = HmcOptions { steps: 12, length: 0.3, before: 20, between: 2, samples: 4000, seed: 7 };
        let chain = sample(&[3.0, -3.0], &options, energy);
        assert!(chain.accepted > 0.8);
        let mean = |of: &dyn Fn(&[f64]) -> f64| chain.samples.iter().map(|x| of(x)).sum::<f64>() / 4000.0;
        assert!(mean(&|x| x[0]).abs() < 0.06 && mean(&|x| x[1]).abs() < 0.09);
        assert!((mean(&|x| x[0] * x[0]) - 1.0).abs() < 0.1);
        assert!((mean(&|x| x[0] * x[1]) - 0.8).abs() < 0.12);
        assert!((mean(&|x| x[1] * x[1]) - 2.0).abs() < 0.2);
        assert_eq!(chain, sample(&[3.0, -3.0], &options, energy));
    }

    #[test]
    fn steps_that_are_too_long_are_halved() {
        let options = HmcOptions { steps: 12, length: 8.0, before: 10, between: 1, samples: 50, seed: 1 };
        assert!(sample(&[0.0, 0.0], &options, energy).accepted > 0.5);
        let wall = |x: &[f64], gradient: &mut [f64]| {
            let inside = energy(x, gradient);
            if x[0] > 1.0 { f64::NAN } else { inside }
        };
        assert!(sample(&[0.0, 0.0], &options, wall).samples.iter().all(|x| x[0] <= 1.0));
    }

    #[test]
    fn a_slide_can_be_slid_back() {
        let mut gradient = [0.0; 2];
        let (mut at, mut push) = ([1.0, 0.5], [0.3, -0.9]);
        let mut leap = |at: &mut [f64; 2], push: &mut [f64; 2]| {
            for _ in 0..40 {
                energy(at, &mut gradient);
                (0..2).for_each(|k| push[k] -= 0.05 * gradient[k]);
                (0..2).for_each(|k| at[k] += 0.1 * push[k]);
                energy(at, &mut gradient);
                (0..2).for_each(|k| push[k] -= 0.05 * gradient[k]);
            }
        };
        leap(&mut at, &mut push);
        push = push.map(|p| -p);
        leap(&mut at, &mut push);
        assert!((at[0] - 1.0).abs() < 1e-12 && (at[1] - 0.5).abs() < 1e-12);
    }
}
