//! From the numbers of one part of the source to those of the target's.

use learn::dense::Matrix;
use learn::kernel::Kernel;
use learn::regression::{Regression, RegressionOptions};

/// A number goes beyond what was seen of it by this share of its range, at most.
const BEYOND: f64 = 0.5;

/// The noise of what a firm process leaves over of what bones foretell, beside that of the firm one: 1 mm of 1.8 m a number instead of 3.
const FINE: f64 = 1.0 / 3.0;

/// What was learned of a part.
pub struct Map {
    learned: Learned,
    /// The least and the most of each number of the target.
    range: Vec<[f64; 2]>,
}

enum Learned {
    /// What one process says, and another one of what it leaves over.
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

    /// Learns what is left over of a part that something else foretells. A process with much noise says what goes on beyond what was seen; what that leaves
    /// over of what was seen is much, where numbers are many, for each has that noise. A squared exponential with less of it learns this: far from
    /// what was seen it adds nothing.
    pub fn rest(inputs: &Matrix, outputs: &Matrix, options: &RegressionOptions) -> Self {
        let range = (0..outputs.columns()).map(|k| range(outputs, k)).collect();
        let Some(firm) = Regression::train(inputs, outputs, options) else {
            return Self { learned: Learned::still(outputs), range };
        };
        let fine = || {
            let kernel = Kernel::SquaredExponential;
            let options = RegressionOptions { kernel, floor: FINE * options.floor, ..*options };
            Regression::train(inputs, &left(inputs, outputs, &firm), &options)
        };
        let fine = if options.kernel.is_linear() { None } else { fine() };
        Self { learned: Learned::Moves(Box::new(firm), fine.map(Box::new)), range }
    }

    /// The target's numbers. They never leave what was seen by much: a few poses lead anywhere.
    pub fn predict(&self, input: &[f64]) -> Vec<f64> {
        let output = match &self.learned {
            Learned::Moves(first, None) => first.predict(input),
            Learned::Moves(first, Some(rest)) => {
                first.predict(input).iter().zip(rest.predict(input)).map(|(a, b)| a + b).collect()
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
        let Some(first) = linear(if options.kernel.is_linear() { options.kernel } else { Kernel::Linear }) else {
            return Self::still(outputs);
        };
        if options.kernel.is_linear() {
            return Self::Moves(Box::new(first), None);
        }
        let rest = Regression::train(inputs, &left(inputs, outputs, &first), options);
        Self::Moves(Box::new(first), rest.map(Box::new))
    }
}

/// What a process leaves over of pairs.
fn left(inputs: &Matrix, outputs: &Matrix, by: &Regression) -> Matrix {
    let guesses: Vec<Vec<f64>> = (0..inputs.rows()).map(|row| by.predict(inputs.row(row))).collect();
    Matrix::from_fn(outputs.rows(), outputs.columns(), |row, k| outputs[(row, k)] - guesses[row][k])
}

/// What a column may be: what it is, and some more on both sides.
fn range(rows: &Matrix, column: usize) -> [f64; 2] {
    let all = || (0..rows.rows()).map(|row| rows[(row, column)]);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    [low - BEYOND * (high - low), high + BEYOND * (high - low)]
}
