//! The minimum of a smooth function of many numbers: L-BFGS (Nocedal 1980), with a search for the length of each step that
//! halves and doubles.

use std::collections::VecDeque;

/// Steps that are remembered.
const MEMORY: usize = 12;
/// A step that lowers the value by less than this part of what the slope promises is too long (Armijo).
const ENOUGH: f64 = 1e-4;
/// After a step the slope has fallen to this part of what it was (Wolfe), or the step was too short.
const FLATTER: f64 = 0.9;
/// Lengths that are tried for one step.
const TRIES: usize = 30;

/// Where a descent ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Descent {
    /// The place.
    pub place: Vec<f64>,
    /// The value there.
    pub value: f64,
    /// Steps that were made.
    pub steps: usize,
}

/// Goes down from `start` for at most `steps` steps. `function` writes the gradient at a place and returns the value; one that is
/// not finite is as good as very high. `None` where there is no value at the start.
pub fn descend(start: Vec<f64>, steps: usize, function: impl FnMut(&[f64], &mut [f64]) -> f64) -> Option<Descent> {
    descend_until(start, steps, 0.0, function)
}

/// The same, which ends where two steps after each other gain no more than `least` each.
pub fn descend_until(
    start: Vec<f64>,
    steps: usize,
    least: f64,
    mut function: impl FnMut(&[f64], &mut [f64]) -> f64,
) -> Option<Descent> {
    let mut place = start;
    let mut gradient = vec![0.0; place.len()];
    let mut value = function(&place, &mut gradient);
    if !value.is_finite() {
        return None;
    }
    let mut past: VecDeque<Past> = VecDeque::new();
    let mut before = f64::INFINITY;
    for step in 0..steps {
        let mut direction = downwards(&gradient, &past);
        let mut slope = dot(&direction, &gradient);
        if slope >= 0.0 || !slope.is_finite() {
            past.clear();
            direction = gradient.iter().map(|g| -g).collect();
            slope = dot(&direction, &gradient);
        }
        let first = if past.is_empty() { 1.0 / norm(&gradient).max(1.0) } else { 1.0 };
        let Some(found) = along(&place, &direction, (value, slope), first, &mut function) else {
            return Some(Descent { place, value, steps: step });
        };
        let moved: Vec<f64> = found.place.iter().zip(&place).map(|(new, old)| new - old).collect();
        let turned: Vec<f64> = found.gradient.iter().zip(&gradient).map(|(new, old)| new - old).collect();
        let curvature = dot(&moved, &turned);
        if curvature > 1e-12 * norm(&moved) * norm(&turned) {
            if past.len() == MEMORY {
                past.pop_front();
            }
            past.push_back(Past { moved, turned, curvature });
        }
        let gained = value - found.value;
        (place, gradient, value) = (found.place, found.gradient, found.value);
        if gained <= 1e-10 * value.abs().max(1.0) || f64::max(gained, before) <= least {
            return Some(Descent { place, value, steps: step + 1 });
        }
        before = gained;
    }
    Some(Descent { place, value, steps })
}

/// A step that was made, and how the gradient changed over it.
struct Past {
    moved: Vec<f64>,
    turned: Vec<f64>,
    curvature: f64,
}

/// The direction that the remembered steps say leads to the minimum.
fn downwards(gradient: &[f64], past: &VecDeque<Past>) -> Vec<f64> {
    let mut direction: Vec<f64> = gradient.iter().map(|g| -g).collect();
    let mut shares = Vec::with_capacity(past.len());
    for step in past.iter().rev() {
        let share = dot(&step.moved, &direction) / step.curvature;
        add(&mut direction, -share, &step.turned);
        shares.push(share);
    }
    if let Some(last) = past.back() {
        let scale = last.curvature / dot(&last.turned, &last.turned);
        direction.iter_mut().for_each(|x| *x *= scale);
    }
    for (step, share) in past.iter().zip(shares.into_iter().rev()) {
        let back = dot(&step.turned, &direction) / step.curvature;
        add(&mut direction, share - back, &step.moved);
    }
    direction
}

struct Found {
    place: Vec<f64>,
    gradient: Vec<f64>,
    value: f64,
}

/// The first length along `direction` that lowers the value enough and flattens the slope enough, by halving intervals.
fn along(
    from: &[f64],
    direction: &[f64],
    (value, slope): (f64, f64),
    first: f64,
    function: &mut impl FnMut(&[f64], &mut [f64]) -> f64,
) -> Option<Found> {
    let (mut short, mut long, mut length) = (0.0, f64::INFINITY, first);
    let mut best: Option<Found> = None;
    for _ in 0..TRIES {
        let place: Vec<f64> = from.iter().zip(direction).map(|(x, d)| x + length * d).collect();
        let mut gradient = vec![0.0; place.len()];
        let there = function(&place, &mut gradient);
        if !there.is_finite() || there > value + ENOUGH * length * slope {
            long = length;
        } else {
            let flat = dot(&gradient, direction) >= FLATTER * slope;
            if best.as_ref().is_none_or(|best| there < best.value) {
                best = Some(Found { place, gradient, value: there });
            }
            if flat {
                return best;
            }
            short = length;
        }
        length = if long.is_finite() { 0.5 * (short + long) } else { 2.0 * length };
    }
    best
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn add(to: &mut [f64], factor: f64, other: &[f64]) {
    to.iter_mut().zip(other).for_each(|(to, other)| *to += factor * other);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_bottom_of_a_bent_valley() {
        // Rosenbrock's, in six dimensions.
        let function = |x: &[f64], gradient: &mut [f64]| {
            gradient.fill(0.0);
            let mut value = 0.0;
            for k in 0..x.len() - 1 {
                let (a, b) = (1.0 - x[k], x[k + 1] - x[k] * x[k]);
                value += a * a + 100.0 * b * b;
                gradient[k] += -2.0 * a - 400.0 * b * x[k];
                gradient[k + 1] += 200.0 * b;
            }
            value
        };
        let start = vec![-1.2, 1.0, -0.5, 0.3, 2.0, 0.1];
        let found = descend(start.clone(), 500, function).unwrap();
        assert!(found.value < 1e-8 && found.place.iter().all(|x| (x - 1.0).abs() < 1e-3), "{found:?}");
        let early = descend_until(start, 500, 1e-5, function).unwrap();
        assert!(early.steps < found.steps && early.value > found.value && early.value < 1e-4, "{early:?}");
    }

    #[test]
    fn what_is_not_finite_is_not_entered() {
        let well = |x: &[f64], gradient: &mut [f64]| {
            gradient[0] = 1.0 - 1.0 / x[0];
            if x[0] > 0.0 { x[0] - x[0].ln() } else { f64::NAN }
        };
        let found = descend(vec![30.0], 100, well).unwrap();
        assert!((found.place[0] - 1.0).abs() < 1e-4);
        assert!(descend(vec![-1.0], 100, well).is_none());
    }
}
