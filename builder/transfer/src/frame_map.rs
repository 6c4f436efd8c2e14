//! What of a stretch is shown to those who chose its keys: the path that was found, and the costs that it was found among.

use learn::dense::Matrix;

/// Which moment of the source belongs to each frame of the target between the first and the last key of a stretch.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameMap {
    /// The stretch of its keys.
    pub stretch: u32,
    /// First and last frame of the source, of the whole capture.
    pub source: [u32; 2],
    /// First and last frame of the target, of the whole capture.
    pub target: [u32; 2],
    /// For each of the target's frames the moment of the source, in frames of the whole capture.
    pub path: Vec<f64>,
    /// How improbable it is that frames belong together.
    pub costs: Costs,
}

/// A matrix of costs (equation 5.8) as a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Costs {
    /// Rows: the source's frames from the first to the last, evenly.
    pub rows: usize,
    /// Columns: the target's.
    pub columns: usize,
    /// Row by row: 255 times the square root of a cost's share, 0 for the least of all and 1 for the greatest. Costs are squares of
    /// distances; the root keeps apart what is nearly as probable as the path.
    pub values: Vec<u8>,
}

impl Costs {
    /// Rows and columns at most.
    pub const FINEST: usize = 200;

    /// A picture of `costs`; where there are more rows or columns than are shown, means of neighbours.
    #[must_use]
    pub fn of(costs: &Matrix) -> Self {
        let (rows, columns) = (costs.rows().min(Self::FINEST), costs.columns().min(Self::FINEST));
        let mut means = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            for column in 0..columns {
                means.push(mean(costs, span(row, rows, costs.rows()), span(column, columns, costs.columns())));
            }
        }
        let low = means.iter().copied().fold(f64::INFINITY, f64::min);
        let high = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let range = if high > low { high - low } else { 1.0 };
        let values = means.iter().map(|cost| (255.0 * ((cost - low) / range).sqrt()).round() as u8).collect();
        Self { rows, columns, values }
    }
}

/// What of `all` the part `index` of `parts` stands for.
fn span(index: usize, parts: usize, all: usize) -> std::ops::Range<usize> {
    index * all / parts..(index + 1) * all / parts
}

fn mean(costs: &Matrix, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) -> f64 {
    let count = (rows.len() * columns.len()) as f64;
    rows.map(|row| columns.clone().map(|column| costs[(row, column)]).sum::<f64>()).sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_is_black_and_the_greatest_white() {
        let costs = Costs::of(&Matrix::from_fn(2, 3, |i, j| (i * 3 + j) as f64 - 7.0));
        assert_eq!((costs.rows, costs.columns), (2, 3));
        let root = |share: f64| (255.0 * share.sqrt()).round() as u8;
        assert_eq!(costs.values, [0, root(0.2), root(0.4), root(0.6), root(0.8), 255]);
    }

    #[test]
    fn many_rows_become_as_many_as_are_shown() {
        let costs = Costs::of(&Matrix::from_fn(450, 3, |i, _| (i / 225) as f64));
        assert_eq!((costs.rows, costs.columns), (Costs::FINEST, 3));
        assert_eq!((costs.values[0], costs.values[3 * 99], costs.values[3 * 100]), (0, 0, 255));
    }

    #[test]
    fn a_single_pair_is_a_picture_too() {
        let costs = Costs::of(&Matrix::zeros(1, 1));
        assert_eq!(costs.values, [0]);
    }
}
