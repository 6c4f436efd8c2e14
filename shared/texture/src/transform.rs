//! The transform of Eigen textures and warps: an orthonormal cosine transform of square blocks.

use std::f64::consts::{PI, SQRT_2};

/// Texels along a block.
pub const SIDE: usize = 16;
/// Texels of a block.
pub const AREA: usize = SIDE * SIDE;

/// Orthonormal opponent colours: sum, red against blue, green against both. Rows, so that the columns go back.
pub const OPPONENT: [[f32; 3]; 3] = [
    [0.577_350_26, 0.577_350_26, 0.577_350_26],
    [0.707_106_77, 0.0, -0.707_106_77],
    [-0.408_248_3, 0.816_496_6, -0.408_248_3],
];

/// `table[u * SIDE + x]`: wave `u` at texel `x` of a block that is restored `side` texels wide, 16 or fewer.
///
/// With fewer, waves that such a block cannot show are zero, and the others are scaled so that its colours stay: the block
/// comes out smaller, as if it had been made so.
#[must_use]
pub fn cosines(side: usize) -> [f32; AREA] {
    let mut table = [0.0; AREA];
    let scale = (2.0 / SIDE as f64).sqrt();
    for u in 0..side.min(SIDE) {
        for x in 0..side.min(SIDE) {
            let wave = (PI / side as f64 * (x as f64 + 0.5) * u as f64).cos();
            table[u * SIDE + x] = (scale * if u == 0 { wave / SQRT_2 } else { wave }) as f32;
        }
    }
    table
}

/// The block's waves: `out[v * SIDE + u]` of the colours `block[y * SIDE + x]`.
#[must_use]
pub fn forward(table: &[f32; AREA], block: &[f32; AREA]) -> [f32; AREA] {
    let by_texel = std::array::from_fn(|at| table[at % SIDE * SIDE + at / SIDE]);
    along_rows(block, &by_texel)
}

/// The colours of the waves that [`forward`] gives, or of a smaller block with a table for one.
#[must_use]
pub fn inverse(table: &[f32; AREA], waves: &[f32; AREA]) -> [f32; AREA] {
    along_rows(waves, table)
}

/// What the values of a row give, `table[i * SIDE + k]` of value `i` to value `k`, along rows and then along columns: two
/// passes that transpose.
fn along_rows(block: &[f32; AREA], table: &[f32; AREA]) -> [f32; AREA] {
    let pass = |from: &[f32; AREA]| -> [f32; AREA] {
        let mut to = [0.0; AREA];
        for (y, row) in from.chunks_exact(SIDE).enumerate() {
            let mut sums = [0.0; SIDE];
            for (value, factors) in row.iter().zip(table.chunks_exact(SIDE)) {
                for k in 0..SIDE {
                    sums[k] += value * factors[k];
                }
            }
            for k in 0..SIDE {
                to[k * SIDE + y] = sums[k];
            }
        }
        to
    };
    pass(&pass(block))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block() -> [f32; AREA] {
        std::array::from_fn(|at| ((at * at * 31 + at * 7) % 101) as f32 / 101.0)
    }

    #[test]
    fn the_inverse_undoes_and_energy_stays() {
        let table = cosines(SIDE);
        let waves = forward(&table, &block());
        let back = inverse(&table, &waves);
        assert!(back.iter().zip(block()).all(|(a, b)| (a - b).abs() < 1e-5));
        let energy = |of: &[f32; AREA]| of.iter().map(|value| value * value).sum::<f32>();
        assert!((energy(&waves) / energy(&block()) - 1.0).abs() < 1e-5);
        assert!((waves[0] - block().iter().sum::<f32>() / 16.0).abs() < 1e-4);
    }

    #[test]
    fn a_block_restored_smaller_keeps_its_colours() {
        let waves = forward(&cosines(SIDE), &std::array::from_fn(|at| (at % SIDE) as f32 / 16.0 + 0.25));
        let half = inverse(&cosines(SIDE / 2), &waves);
        for at in 0..64 {
            let (x, y) = (at % 8, at / 8);
            let wanted = (2.0 * x as f32 + 0.5) / 16.0 + 0.25;
            assert!((half[y * SIDE + x] - wanted).abs() < 0.02, "{} {wanted}", half[y * SIDE + x]);
        }
    }

    #[test]
    fn opponent_colours_are_orthonormal() {
        for (i, a) in OPPONENT.iter().enumerate() {
            for (j, b) in OPPONENT.iter().enumerate() {
                let dot: f32 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                assert!((dot - f32::from(u8::from(i == j))).abs() < 1e-6);
            }
        }
    }
}
