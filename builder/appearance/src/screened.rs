//! The screened Poisson equation `(L - i weight) z = right` over an atlas, L being the graph Laplacian of its charts.
//!
//! What warping solves ([`super::warp`]). Conjugate gradients read and write planes of millions of texels again and again,
//! so what a step does is gathered into three passes, and stretches of planes without an active texel are left out: all
//! is zero there. Sums run in a fixed order, lanes along each row and rows one after the other: neither passes nor
//! stretches change a bit.

use super::level::Level;
use kernels::simd::{Kernel, Level as Instructions};

/// Steps of conjugate gradients at most.
const MOST_STEPS: usize = 60;
/// The residual that is left, as a part of the first one.
const TOLERANCE: f64 = 2e-3;
/// Lanes of a sum along a row.
const LANES: usize = 16;

/// The rows of a level's planes that have active texels, by the stretches that do.
#[derive(Clone, Debug)]
pub(super) struct Stretches {
    /// The first texel of each stretch and the one after its last: both whole [`LANES`] from the beginning of their row,
    /// or at its end.
    ends: Vec<[u32; 2]>,
    /// For each row that has any, where its stretches begin in `ends`, and the end of all.
    rows: Vec<u32>,
}

impl Stretches {
    pub fn new(level: &Level) -> Self {
        let (mut ends, mut rows) = (Vec::<[u32; 2]>::new(), Vec::new());
        for (row, labels) in level.labels.chunks_exact(level.stride).enumerate() {
            let (first, mut open) = (ends.len() as u32, false);
            for (k, lanes) in labels.chunks(LANES).enumerate() {
                let active = lanes.iter().any(|&label| label != 0);
                let begin = (row * level.stride + k * LANES) as u32;
                let end = begin + lanes.len() as u32;
                match ends.last_mut().filter(|_| open) {
                    Some(stretch) if active => stretch[1] = end,
                    _ if active => ends.push([begin, end]),
                    _ => {}
                }
                open = active;
            }
            if ends.len() as u32 > first {
                rows.push(first);
            }
        }
        rows.push(ends.len() as u32);
        Self { ends, rows }
    }

    /// The stretches of each row.
    #[inline(always)]
    fn rows(&self) -> impl Iterator<Item = &[[u32; 2]]> {
        self.rows.windows(2).map(|row| &self.ends[row[0] as usize..row[1] as usize])
    }
}

/// Complex numbers over a plane.
#[derive(Clone, Debug)]
pub(super) struct Complex {
    pub re: Vec<f32>,
    pub im: Vec<f32>,
}

impl Complex {
    fn zero(length: usize) -> Self {
        Self { re: vec![0.0; length], im: vec![0.0; length] }
    }
}

/// The solution z, by conjugate gradients without conjugation (van der Vorst, Melissen 1990), which fit symmetric complex
/// matrices. `right` is 0 where no texel is active.
pub(super) fn solve(
    level: &Level,
    stretches: &Stretches,
    weight: f32,
    right: Vec<f32>,
    instructions: Instructions,
) -> Complex {
    let length = right.len();
    let (mut x, mut image) = (Complex::zero(length), Complex::zero(length));
    let mut residual = Complex { im: vec![0.0; length], re: right };
    let mut direction = residual.clone();
    // No step yet: only what the residual comes to.
    let first = Advance {
        stretches,
        step: (0.0, 0.0),
        x: &mut x,
        residual: &mut residual,
        direction: &direction,
        image: &image,
    };
    let mut now = instructions.run(first);
    let enough = TOLERANCE * TOLERANCE * now.length();
    for _ in 0..MOST_STEPS {
        if now.product() == (0.0, 0.0) {
            break;
        }
        let image_product =
            instructions.run(Apply { level, stretches, weight, direction: &direction, image: &mut image });
        let step = divide(now.product(), image_product);
        let step = (step.0 as f32, step.1 as f32);
        let before = now;
        let advance =
            Advance { stretches, step, x: &mut x, residual: &mut residual, direction: &direction, image: &image };
        now = instructions.run(advance);
        if now.length() <= enough {
            break;
        }
        let (re, im) = divide(now.product(), before.product());
        instructions.run(Turn {
            stretches,
            re: re as f32,
            im: im as f32,
            residual: &residual,
            direction: &mut direction,
        });
    }
    x
}

/// a / b of complex numbers.
fn divide(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let length = b.0 * b.0 + b.1 * b.1;
    ((a.0 * b.0 + a.1 * b.1) / length, (a.1 * b.0 - a.0 * b.1) / length)
}

/// Sums of products over a residual's real and imaginary parts.
#[derive(Clone, Copy, Debug, Default)]
struct Squares {
    re_re: f64,
    im_im: f64,
    re_im: f64,
}

impl Squares {
    /// r^T r.
    fn product(&self) -> (f64, f64) {
        (self.re_re - self.im_im, self.re_im + self.re_im)
    }

    /// r^* r.
    fn length(&self) -> f64 {
        self.re_re + self.im_im
    }
}

/// A sum over a row: its lanes, and what the row has beyond whole ones.
#[derive(Clone, Copy)]
struct RowSum {
    lanes: [f32; LANES],
    rest: f32,
}

impl RowSum {
    const ZERO: Self = Self { lanes: [0.0; LANES], rest: 0.0 };

    #[inline(always)]
    fn add(&mut self, a: &[f32], b: &[f32]) {
        let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
        for (a, b) in a.remainder().iter().zip(b.remainder()) {
            self.rest += a * b;
        }
        for (a, b) in a.zip(b) {
            for k in 0..LANES {
                self.lanes[k] += a[k] * b[k];
            }
        }
    }

    #[inline(always)]
    fn sum(&self) -> f64 {
        f64::from(self.rest + self.lanes.iter().sum::<f32>())
    }
}

/// `image = (L - i weight) direction`; direction^T image.
struct Apply<'a> {
    level: &'a Level,
    stretches: &'a Stretches,
    weight: f32,
    direction: &'a Complex,
    image: &'a mut Complex,
}

impl Kernel for Apply<'_> {
    type Output = (f64, f64);

    #[inline(always)]
    fn run(self) -> (f64, f64) {
        let Self { level, stretches, weight, direction, image } = self;
        let mut totals = [0.0; 4];
        for row in stretches.rows() {
            let mut sums = [RowSum::ZERO; 4];
            for &[begin, end] in row {
                let (begin, end) = (begin as usize, end as usize);
                laplacian(level, &direction.re, begin, end, &mut image.re);
                laplacian(level, &direction.im, begin, end, &mut image.im);
                let (re, im) = (&direction.re[begin..end], &direction.im[begin..end]);
                let (to_re, to_im) = (&mut image.re[begin..end], &mut image.im[begin..end]);
                add(weight, im, to_re);
                add(-weight, re, to_im);
                for (sum, (a, b)) in sums.iter_mut().zip([(re, &*to_re), (im, to_im), (re, to_im), (im, to_re)]) {
                    sum.add(a, b);
                }
            }
            for (total, sum) in totals.iter_mut().zip(&sums) {
                *total += sum.sum();
            }
        }
        (totals[0] - totals[1], totals[2] + totals[3])
    }
}

/// The graph Laplacian from `begin` to `end`, in one row: the sum of differences to linked texels.
#[inline(always)]
fn laplacian(level: &Level, input: &[f32], begin: usize, end: usize, output: &mut [f32]) {
    let stride = level.stride;
    let n = end - begin;
    let out = &mut output[begin..end];
    let here = &input[begin..end];
    let (before, after) = (&input[begin - 1..begin - 1 + n], &input[begin + 1..begin + 1 + n]);
    let (above, below) = (&input[begin - stride..begin - stride + n], &input[begin + stride..begin + stride + n]);
    let (r, l) = (&level.right[begin..end], &level.right[begin - 1..begin - 1 + n]);
    let (d, u) = (&level.down[begin..end], &level.down[begin - stride..begin - stride + n]);
    for k in 0..n {
        out[k] = r[k] * (after[k] - here[k])
            + l[k] * (before[k] - here[k])
            + d[k] * (below[k] - here[k])
            + u[k] * (above[k] - here[k]);
    }
}

/// `to += weight * from`.
#[inline(always)]
fn add(weight: f32, from: &[f32], to: &mut [f32]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += weight * from;
    }
}

/// `x += step direction`, `residual -= step image`; what the residual then comes to.
struct Advance<'a> {
    stretches: &'a Stretches,
    step: (f32, f32),
    x: &'a mut Complex,
    residual: &'a mut Complex,
    direction: &'a Complex,
    image: &'a Complex,
}

impl Kernel for Advance<'_> {
    type Output = Squares;

    #[inline(always)]
    fn run(self) -> Squares {
        let Self { stretches, step: (re, im), x, residual, direction, image } = self;
        let mut totals = Squares::default();
        for row in stretches.rows() {
            let mut sums = [RowSum::ZERO; 3];
            for &[begin, end] in row {
                let of = begin as usize..end as usize;
                let (from_re, from_im) = (&direction.re[of.clone()], &direction.im[of.clone()]);
                add(re, from_re, &mut x.re[of.clone()]);
                add(-im, from_im, &mut x.re[of.clone()]);
                add(re, from_im, &mut x.im[of.clone()]);
                add(im, from_re, &mut x.im[of.clone()]);
                let (from_re, from_im) = (&image.re[of.clone()], &image.im[of.clone()]);
                let (to_re, to_im) = (&mut residual.re[of.clone()], &mut residual.im[of]);
                add(-re, from_re, to_re);
                add(im, from_im, to_re);
                add(-re, from_im, to_im);
                add(-im, from_re, to_im);
                for (sum, (a, b)) in sums.iter_mut().zip([(&*to_re, &*to_re), (to_im, to_im), (to_re, to_im)]) {
                    sum.add(a, b);
                }
            }
            totals.re_re += sums[0].sum();
            totals.im_im += sums[1].sum();
            totals.re_im += sums[2].sum();
        }
        totals
    }
}

/// `direction = residual + (re + i im) direction`.
struct Turn<'a> {
    stretches: &'a Stretches,
    re: f32,
    im: f32,
    residual: &'a Complex,
    direction: &'a mut Complex,
}

impl Kernel for Turn<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { stretches, re, im, residual, direction } = self;
        for &[begin, end] in &stretches.ends {
            let of = begin as usize..end as usize;
            let parts = direction.re[of.clone()].iter_mut().zip(&mut direction.im[of.clone()]);
            for ((x, y), (rx, ry)) in parts.zip(residual.re[of.clone()].iter().zip(&residual.im[of])) {
                (*x, *y) = (rx + re * *x - im * *y, ry + re * *y + im * *x);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charts::Charts;

    fn noise(k: usize) -> f32 {
        let hash = (k as u32 ^ 0x51ED).wrapping_mul(0x9E37_79B9).rotate_left(11).wrapping_mul(0x85EB_CA6B);
        (hash >> 8) as f32 / (1 << 24) as f32
    }

    /// Two charts with room between them, whose rows are no whole number of lanes.
    fn level() -> Level {
        let (width, height) = (101, 60);
        let label = |x: usize, y: usize| match (x, y) {
            (2..30, 3..50) => 1,
            (60..101, 20..60) if !(x + y).is_multiple_of(17) => 2,
            _ => 0,
        };
        let labels = (0..width * height).map(|k| label(k % width, k / width)).collect();
        Level::new(Charts { width, height, labels })
    }

    /// Everything written out, in double precision: what is missing of `right`.
    fn missing(level: &Level, weight: f64, right: &[f32], z: &Complex) -> f64 {
        let mut sum = 0.0;
        for at in (0..right.len()).filter(|&at| level.labels[at] != 0) {
            let linked = [at + 1, at - 1, at + level.stride, at - level.stride];
            let linked = linked.into_iter().filter(|&other| level.labels[other] == level.labels[at]);
            let (mut re, mut im) = (0.0, 0.0);
            for other in linked {
                re += f64::from(z.re[other]) - f64::from(z.re[at]);
                im += f64::from(z.im[other]) - f64::from(z.im[at]);
            }
            let (re, im) = (re + weight * f64::from(z.im[at]), im - weight * f64::from(z.re[at]));
            sum += (f64::from(right[at]) - re).powi(2) + im * im;
        }
        sum.sqrt()
    }

    #[test]
    fn the_equation_holds() {
        let level = level();
        // A divergence, as in warping: what flows out of a texel flows into the next one.
        let mut right = vec![0.0; level.labels.len()];
        for at in (0..right.len()).filter(|&at| level.labels[at] != 0) {
            for (linked, other) in [(level.right[at], at + 1), (level.down[at], at + level.stride)] {
                let flow = linked * (noise(at + other) - 0.5);
                right[at] += flow;
                right[other] -= flow;
            }
        }
        let size = right.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
        let all: Vec<Complex> = Instructions::available()
            .into_iter()
            .map(|instructions| solve(&level, &Stretches::new(&level), 0.02, right.clone(), instructions))
            .collect();
        for z in &all {
            let left = missing(&level, 0.02, &right, z) / size;
            assert!(left < 1.01 * TOLERANCE, "{left}");
            assert!(z.re == all[0].re && z.im == all[0].im, "instructions change bits");
        }
    }

    #[test]
    fn stretches_hold_all_active_texels_and_little_else() {
        let level = level();
        let stretches = Stretches::new(&level);
        let held: Vec<usize> =
            stretches.rows().flatten().flat_map(|&[begin, end]| begin as usize..end as usize).collect();
        assert!(held.is_sorted_by(|a, b| a < b));
        let active = (0..level.labels.len()).filter(|&at| level.labels[at] != 0);
        assert!(active.clone().all(|at| held.binary_search(&at).is_ok()));
        assert!(held.len() < 2 * active.count());
    }
}
