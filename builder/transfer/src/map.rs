//! From the numbers of one part of the source to those of the target's.

use learn::dense::Matrix;
use learn::kernel::Kernel;
use learn::regression::{Regression, RegressionOptions};

/// A number goes beyond what was seen of it by this share of its range, at most.
const BEYOND: f64 = 0.5;

/// What was learned of a part.
pub struct Map {
    learned: Learned,
    /// The least and the most of each number of the target.
    range: Vec<[f64; 2]>,
}

enum Learned {
    /// What a linear map says, and what it leaves over.
    Moves(Box<Regression>, Option<Box<Regression>>),
    /// A part that does not move.
    Still(Vec<f64>),
}

impl Map {
    /// Learns a part. A process whose kernel is not linear learns what a linear one leaves over: far from what was seen it says
    /// nothing, and the linear one goes on.
    pub fn learn(inputs: &Matrix, outputs: &Matrix, options: &RegressionOptions) -> Self {
        let range = (0..outputs.columns()).map(|k| range(outputs, k)).collect();
        Self { learned: Learned::of(inputs, outputs, options), range }
    }

    /// Learns what is left over of a part that something else foretells: far from what was seen nothing is added.
    pub fn rest(inputs: &Matrix, outputs: &Matrix, options: &RegressionOptions) -> Self {
        let range = (0..outputs.columns()).map(|k| range(outputs, k)).collect();
        let learned = match Regression::train(inputs, outputs, options) {
            Some(map) => Learned::Moves(Box::new(map), None),
            None => Learned::still(outputs),
        };
        Self { learned, range }
    }

    /// The target's numbers. They never leave what was seen by much: a few poses lead anywhere.
    pub fn predict(&self, input: &[f64]) -> Vec<f64> {
        let output = match &self.learned {
            Learned::Moves(linear, None) => linear.predict(input),
            Learned::Moves(linear, Some(rest)) => {
                linear.predict(input).iter().zip(rest.predict(input)).map(|(a, b)| a + b).collect()
            }
            Learned::Still(output) => output.clone(),
        };
        output.iter().zip(&self.range).map(|(number, [low, high])| number.clamp(*low, *high)).collect()
    }
}

impl Learned {
    /// The mean of what was seen.
    fn still(outputs: &Matrix) -> Self {
        let mean = |k: usize| (0..outputs.rows()).map(|row| outputs[(row, k)]).sum::<f64>() / outputs.rows() as f64;
        Self::Still((0..outputs.columns()).map(mean).collect())
    }

    fn of(inputs: &Matrix, outputs: &Matrix, options: &RegressionOptions) -> Self {
        let linear = |kernel| Regression::train(inputs, outputs, &RegressionOptions { kernel, ..*options });
        let is_linear = matches!(options.kernel, Kernel::Linear | Kernel::Affine);
        let Some(first) = linear(if is_linear { options.kernel } else { Kernel::Linear }) else {
            return Self::still(outputs);
        };
        if is_linear {
            return Self::Moves(Box::new(first), None);
        }
        let guesses: Vec<Vec<f64>> = (0..inputs.rows()).map(|row| first.predict(inputs.row(row))).collect();
        let left = Matrix::from_fn(outputs.rows(), outputs.columns(), |row, k| outputs[(row, k)] - guesses[row][k]);
        Self::Moves(Box::new(first), Regression::train(inputs, &left, options).map(Box::new))
    }
}

/// What a column may be: what it is, and some more on both sides.
fn range(rows: &Matrix, column: usize) -> [f64; 2] {
    let all = || (0..rows.rows()).map(|row| rows[(row, column)]);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    [low - BEYOND * (high - low), high + BEYOND * (high - low)]
}
