//! Rounding positions to a grid, within a stated distance of where they were captured.
//!
//! The cells of the grid are as large as the bound allows, and a position may go to any grid point within the bound,
//! not only to the nearest: where the predicted one is within the bound, the residual is zero. That is worth a sixth of
//! the bytes at no loss of the bound (the mean error rises from 0.58 to 0.72 of it).

use glam::Vec3;

use super::super::limits::MAX_COORDINATE;
use kernels::codec::Steps;

/// A grid and how far a position may move on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Distance of grid points along an axis, in metres.
    pub step: f32,
    /// The square of the largest permitted distance, in steps.
    radius_squared: f64,
}

impl Grid {
    /// The coarsest grid on which no position moves farther than `max_error`; coordinates go up to `largest` metres.
    ///
    /// `None` where 32-bit positions are not that exact so far out.
    #[must_use]
    pub fn new(max_error: f32, largest: f32) -> Option<Self> {
        // Decoded positions are rounded to 32-bit numbers, half of the last of 24 bits in each coordinate.
        let rounding = f64::from(largest) * 3.0_f64.sqrt() / f64::from(1 << 24);
        let radius = f64::from(max_error) - rounding;
        let step = (radius * (2.0 / 3.0_f64.sqrt()) * (1.0 - 1e-6)) as f32;
        let steps = f64::from(largest) / f64::from(step);
        let fits = step.is_normal() && step > 0.0 && steps < f64::from(MAX_COORDINATE - 2);
        let radius = radius / f64::from(step);
        fits.then_some(Self { step, radius_squared: radius * radius })
    }

    /// `position` in steps, not yet rounded.
    #[must_use]
    pub fn in_steps(&self, position: Vec3) -> [f64; 3] {
        position.to_array().map(|coordinate| f64::from(coordinate) / f64::from(self.step))
    }

    /// The grid point nearest to `position`, which is in steps.
    #[must_use]
    pub fn nearest(position: [f64; 3]) -> Steps {
        let [x, y, z] = position.map(|coordinate| coordinate.round() as i32);
        [x, y, z, 0]
    }

    /// The grid point within the bound whose residual against `predicted` is cheapest.
    #[must_use]
    pub fn choose(&self, position: [f64; 3], predicted: Steps) -> Steps {
        let nearest = Self::nearest(position);
        let (mut squares, mut costs) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        for axis in 0..3 {
            for offset in 0..3 {
                let candidate = nearest[axis] + offset as i32 - 1;
                let distance = f64::from(candidate) - position[axis];
                squares[axis][offset] = distance * distance;
                costs[axis][offset] = cost(candidate.wrapping_sub(predicted[axis]));
            }
        }
        let mut best = [1; 3];
        let total = |table: &[[f64; 3]; 3], [x, y, z]: [usize; 3]| table[0][x] + table[1][y] + table[2][z];
        let mut least = (total(&costs, best), total(&squares, best));
        for index in 0..27 {
            let candidate = [index % 3, index / 3 % 3, index / 9];
            let square = total(&squares, candidate);
            let found = (total(&costs, candidate), square);
            if square <= self.radius_squared && found < least {
                (best, least) = (candidate, found);
            }
        }
        let [x, y, z] = [0, 1, 2].map(|axis| nearest[axis] + best[axis] as i32 - 1);
        [x, y, z, 0]
    }
}

/// About the bits that a residual costs.
fn cost(residual: i32) -> f64 {
    // log2(1 + |residual|) without a logarithm, which need not be the same on every machine.
    const SMALL: [f64; 8] = [0.0, 1.0, 1.585, 2.0, 2.322, 2.585, 2.807, 3.0];
    let size = residual.unsigned_abs();
    match SMALL.get(size as usize) {
        Some(&cost) => cost,
        None => {
            let length = 31 - size.leading_zeros();
            f64::from(length) + f64::from(size) / f64::from(1_u32 << length) - 1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use kernels::codec::frame::position;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_bound_holds(
            coordinates in prop::array::uniform3(-8.0..8.0_f32),
            offset in prop::array::uniform3(-3..3_i32),
            max_error in 0.0001..0.01_f32,
        ) {
            let grid = Grid::new(max_error, 8.0).unwrap();
            let exact = Vec3::from(coordinates);
            let nearest = Grid::nearest(grid.in_steps(exact));
            let predicted = [nearest[0] + offset[0], nearest[1] + offset[1], nearest[2] + offset[2], 0];
            for steps in [nearest, grid.choose(grid.in_steps(exact), predicted)] {
                let distance = position(steps, grid.step).as_dvec3().distance(exact.as_dvec3());
                prop_assert!(distance <= f64::from(max_error), "{} beyond {}", distance, max_error);
            }
        }
    }

    #[test]
    fn refuses_what_single_precision_cannot_do() {
        assert!(Grid::new(0.0005, 2.0).is_some());
        assert!(Grid::new(0.0005, 1e6).is_none());
        assert!(Grid::new(1e-9, 2.0).is_none());
    }
}
