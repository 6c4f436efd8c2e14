//! How far pairs agree with each other: whether some of them foretell the others.
//!
//! Where two actors share nothing between keys, frames are matched all the same, for something must be. Then what is learned
//! from most of these pairs says nothing about the rest.

use learn::dense::Matrix;
use learn::linear_map::LinearMap;

/// Blocks that are held back, one after the other.
const BLOCKS: usize = 8;
/// Fewer pairs than this tell nothing of each other.
const FEWEST: usize = 6 * BLOCKS;

/// Numbers of all parts.
pub type Row = Vec<Vec<f64>>;

/// How much of what targets vary by is foretold by pairs that are farther off: 1 where all is, 0 or less where the mean pose would do
/// as well; `None` of too few pairs. `x` and `y` hold the numbers of pairs in their order; the noise has the variance `noise`.
pub fn agreement(x: &[Row], y: &[&Row], noise: f64) -> Option<f64> {
    let count = x.len();
    if count < FEWEST {
        return None;
    }
    let (mut off, mut all) = (0.0, 0.0);
    for block in 0..BLOCKS {
        let held = block * count / BLOCKS..(block + 1) * count / BLOCKS;
        // What touches the block is too much like it to count.
        let margin = held.len() / 2;
        let shown: Vec<usize> = (0..count).filter(|k| k + margin < held.start || *k >= held.end + margin).collect();
        for part in 0..x[0].len() {
            let rows = |row: usize| (&x[row][part], &y[row][part]);
            let inputs = Matrix::from_fn(shown.len(), x[0][part].len(), |row, k| rows(shown[row]).0[k]);
            let outputs = Matrix::from_fn(shown.len(), y[0][part].len(), |row, k| rows(shown[row]).1[k]);
            let map = LinearMap::fit(&inputs, &outputs, noise)?;
            let mean = |k: usize| (0..shown.len()).map(|row| outputs[(row, k)]).sum::<f64>() / shown.len() as f64;
            let means: Vec<f64> = (0..outputs.columns()).map(mean).collect();
            let squares = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            for row in held.clone() {
                let (input, output) = rows(row);
                off += squares(&map.predict(input).0, output);
                all += squares(&means, output);
            }
        }
    }
    (all > 0.0).then(|| 1.0 - off / all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::random::signed;

    #[test]
    fn what_belongs_together_agrees() {
        let wave = |k: usize, speed: f64| (k as f64 * speed).sin();
        let x: Vec<Row> = (0..120).map(|k| vec![vec![wave(k, 0.3), wave(k, 0.5)]]).collect();
        let same: Vec<Row> = x.iter().map(|row| vec![vec![2.0 * row[0][0] - row[0][1]]]).collect();
        let other: Vec<Row> = (0..120).map(|k| vec![vec![f64::from(signed(3, k / 9))]]).collect();
        let of = |y: &[Row]| agreement(&x, &y.iter().collect::<Vec<_>>(), 1e-4).unwrap();
        assert!(of(&same) > 0.99, "{}", of(&same));
        assert!(of(&other) < 0.2, "{}", of(&other));
        assert!(agreement(&x[..40], &same[..40].iter().collect::<Vec<_>>(), 1e-4).is_none());
    }
}
