//! What the tests of the solver share: random matrices, and their dense twins.
#![allow(dead_code, reason = "each test binary uses its part")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use faer::Mat;
use faer::linalg::solvers::Solve;
use kernels::cholesky::{SymmetricEntries, SymmetricMatrix, SymmetricPattern};
use proptest::prelude::*;

/// A small random number generator (xorshift): the same numbers everywhere.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Evenly between 0 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }

    /// Evenly between -1 and 1.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    pub fn shuffled(&mut self, count: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..count as u32).collect();
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }

    pub fn numbers(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.signed()).collect()
    }
}

/// A random pattern: some are chains, some are nearly full, some fall apart.
pub fn patterns() -> impl Strategy<Value = SymmetricPattern> {
    (1..70_usize, 0.0..4.0_f64, any::<u64>()).prop_map(|(rows, density, seed)| {
        let mut random = Random::new(seed);
        let edges: Vec<[u32; 2]> = (0..(rows as f64 * density) as usize)
            .map(|_| [random.below(rows) as u32, random.below(rows) as u32])
            .collect();
        SymmetricPattern::from_edges(rows, &edges).unwrap()
    })
}

/// A random positive definite matrix: each edge is an equation of its own, and each row one of a weight between `least` and
/// `least + 1`. Not diagonally dominant.
pub fn positive(pattern: &SymmetricPattern, least: f64, random: &mut Random) -> SymmetricMatrix {
    let mut matrix = SymmetricMatrix::zeros(pattern);
    for &[a, b] in pattern.edges() {
        matrix.add_equation(pattern, &[(a, random.signed()), (b, 2.0 * random.signed())], 1.0).unwrap();
    }
    for row in 0..pattern.row_count() as u32 {
        matrix.add_equation(pattern, &[(row, 1.0)], least + random.next()).unwrap();
    }
    matrix
}

/// The Laplacian of these weights, one for each edge.
pub fn laplacian(pattern: &SymmetricPattern, weights: &[f64]) -> SymmetricMatrix {
    let mut matrix = SymmetricMatrix::zeros(pattern);
    for (&[a, b], &weight) in pattern.edges().iter().zip(weights) {
        matrix.add_equation(pattern, &[(a, 1.0), (b, -1.0)], weight).unwrap();
    }
    matrix
}

/// The matrix written out.
pub fn dense(pattern: &SymmetricPattern, matrix: &impl SymmetricEntries) -> Mat<f64> {
    let n = pattern.row_count();
    let mut full = Mat::<f64>::zeros(n, n);
    for row in 0..n {
        full[(row, row)] = matrix.diagonal(row);
    }
    for (edge, &[a, b]) in pattern.edges().iter().enumerate() {
        full[(a as usize, b as usize)] = matrix.off_diagonal(edge);
        full[(b as usize, a as usize)] = matrix.off_diagonal(edge);
    }
    full
}

/// The solutions of a dense system by a general method, `k` numbers a row.
pub fn dense_solve(matrix: &Mat<f64>, right: &[f64], k: usize) -> Vec<f64> {
    let n = matrix.nrows();
    let mut x = Mat::from_fn(n, k, |row, side| right[row * k + side]);
    matrix.partial_piv_lu().solve_in_place(&mut x);
    (0..n).flat_map(|row| (0..k).map(move |side| (row, side))).map(|at| x[at]).collect()
}

/// Largest difference, as a part of the largest number expected.
pub fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let most = expected.iter().fold(1e-300_f64, |most, x| most.max(x.abs()));
    let worst = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    worst.fold(0.0, |worst, x| {
        if x >= worst {
            x
        } else if x.is_nan() {
            f64::INFINITY
        } else {
            worst
        }
    }) / most
}

pub fn singles(numbers: &[f64]) -> Vec<f32> {
    numbers.iter().map(|&x| x as f32).collect()
}

pub fn doubles(numbers: &[f32]) -> Vec<f64> {
    numbers.iter().map(|&x| f64::from(x)).collect()
}

/// A sheet of `width` by `height` vertices, two triangles a cell.
pub fn sheet(width: u32, height: u32) -> Vec<[u32; 3]> {
    let at = |x: u32, y: u32| y * width + x;
    let cells = (0..height - 1).flat_map(|y| (0..width - 1).map(move |x| (x, y)));
    cells
        .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x, y + 1)], [at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]])
        .collect()
}
