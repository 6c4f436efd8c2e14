//! Moving an aligned texture by a backward warp: directly, or with its gradients (Poisson reconstruction).
//!
//! This work is based on: A. Boukhayma, thesis 2017, section 4.4.1, equations 4.1 to 4.3. The texture A that minimises
//! `|lap A - div(grad I)(x + w)|^2 + lambda^2 |A - I(x + w)|^2` solves `(M^2 + lambda^2) A = ...` with M = -lap, which has
//! natural boundaries at chart borders. With A = c + e, c the texture moved directly, `(M^2 + lambda^2) e = M r`, and
//! since `M / (M^2 + lambda^2)` is the real part of `1 / (M + i lambda)`, e is the real part of the solution of
//! `(M + i lambda) z = r`: a Poisson equation screened after about 1 / sqrt(lambda) = 7 texels, which one multigrid cycle
//! all but solves. The GPU's passes (`appearance_*.wgsl`) are the twins of the functions here and have their names.

use super::mask::{ACTIVE, LEVELS, Level, Mask};

/// Weight of colours against gradients, lambda of thesis equation 4.1; thesis section 4.4.1 found 0.02 best.
pub const LAMBDA: f32 = 0.02;
/// Damping of the Jacobi sweeps.
pub const OMEGA: f32 = 0.8;
/// What the next smaller level gets is a mean over as many texels at least: beside a border, where there are fewer, three
/// were found to take most of the error away in the first cycle.
pub const LEAST: f32 = 3.0;
/// A sample whose texels weigh less is not known.
pub const KNOWN: f32 = 1e-6;
/// Weight of texels that are known but not active, where a sample finds no active one.
pub const PADDING: f32 = 1.0 / 1024.0;

/// A texture, or a warp, that may be known in places only.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Three values, and how much they count: 1 where active, [`PADDING`] or 0 elsewhere.
    pub texels: Vec<[f32; 4]>,
}

impl Field {
    /// Interpolates between the four texels around (`x`, `y`), texel centres being whole numbers; `None` where none of
    /// them is known.
    #[must_use]
    pub fn sample(&self, x: f32, y: f32) -> Option<[f32; 3]> {
        self.sample_between(Between::at(x), Between::at(y))
    }

    /// The same where `column` and `row` were found before.
    #[inline]
    #[must_use]
    pub fn sample_between(&self, column: Between, row: Between) -> Option<[f32; 3]> {
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        for (y, down) in row.texels() {
            for (x, along) in column.texels() {
                if x >= self.width || y >= self.height {
                    continue;
                }
                let Some([r, g, b, known]) = self.texels.get(y * self.width + x) else { continue };
                let weight = along * down * known;
                sum = [sum[0] + weight * r, sum[1] + weight * g, sum[2] + weight * b];
                total += weight;
            }
        }
        (total > KNOWN).then(|| sum.map(|value| value / total))
    }
}

/// A place between two neighbouring columns of texels, or rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    first: i32,
    /// What the first counts, and the second.
    shares: [f32; 2],
}

impl Between {
    /// The place `at`, texel centres being whole numbers.
    #[inline]
    #[must_use]
    pub fn at(at: f32) -> Self {
        let towards_zero = at as i32;
        let first = towards_zero.saturating_sub(i32::from(towards_zero as f32 > at));
        let share = at - first as f32;
        Self { first, shares: [1.0 - share, share] }
    }

    /// Both and their shares; one before the first texel has a number beyond all.
    #[inline]
    fn texels(self) -> [(usize, f32); 2] {
        let number = |texel: i32| texel as u32 as usize;
        [(number(self.first), self.shares[0]), (number(self.first.wrapping_add(1)), self.shares[1])]
    }
}

/// What is moved, and how.
#[derive(Clone, Debug)]
pub struct Aligned {
    /// The aligned texture.
    pub texture: Field,
    /// The backward warp (dx, dy, unused), in texels of the full size.
    pub warp: Field,
    /// Texels of the full size along a texel of `texture`: 1, or 2 where it was rebuilt at half the size.
    pub texel: f32,
    /// Texels of the full size along a texel of `warp`.
    pub cell: f32,
    /// Colour where nothing is known.
    pub fill: [f32; 3],
}

impl Aligned {
    /// The warp of a texel, in its texels.
    #[must_use]
    pub fn warp_at(&self, x: usize, y: usize) -> [f32; 2] {
        self.warp_between(self.between(x), self.between(y))
    }

    /// The warps of all texels, row by row: [`Self::warp_at`] with what a row or a column shares found once.
    #[must_use]
    pub fn warps(&self) -> Vec<[f32; 2]> {
        let columns: Vec<Between> = (0..self.texture.width).map(|x| self.between(x)).collect();
        let mut warps = Vec::with_capacity(self.texture.width * self.texture.height);
        for y in 0..self.texture.height {
            let row = self.between(y);
            warps.extend(columns.iter().map(|&column| self.warp_between(column, row)));
        }
        warps
    }

    /// Where the warp of a column or a row of texels lies.
    fn between(&self, texel: usize) -> Between {
        Between::at((texel as f32 + 0.5) * self.texel / self.cell - 0.5)
    }

    fn warp_between(&self, column: Between, row: Between) -> [f32; 2] {
        let warp = self.warp.sample_between(column, row);
        warp.map_or([0.0; 2], |[dx, dy, _]| [dx / self.texel, dy / self.texel])
    }

    fn moved(&self, x: usize, y: usize, warp: [f32; 2]) -> [f32; 3] {
        self.texture.sample(x as f32 + warp[0], y as f32 + warp[1]).unwrap_or(self.fill)
    }

    /// The texture moved directly: c(x) = I(x + w(x)).
    #[must_use]
    pub fn remap(&self) -> Vec<[f32; 3]> {
        let width = self.texture.width;
        let moved = |(at, warp): (usize, [f32; 2])| self.moved(at % width, at / width, warp);
        self.warps().into_iter().enumerate().map(moved).collect()
    }

    /// `r` = lap c - div(grad I)(x + w): what the texture moved directly lacks of the moved gradients.
    ///
    /// Along an edge, a moved gradient minus the gradient of c is the far end as the near end's warp moves it minus the
    /// far end itself.
    #[must_use]
    pub fn residual(&self, mask: &Level, moved: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let mut residual = vec![[0.0; 3]; moved.len()];
        for (at, warp) in self.warps().into_iter().enumerate() {
            let (x, y) = (at % mask.width, at / mask.width);
            for (flag, other, [nx, ny]) in [(2, at + 1, [x + 1, y]), (8, at + mask.width, [x, y + 1])] {
                if mask.flags[at] & flag != 0 {
                    let far = self.moved(nx, ny, warp);
                    for channel in 0..3 {
                        let lacking = far[channel] - moved[other][channel];
                        residual[at][channel] -= lacking;
                        residual[other][channel] += lacking;
                    }
                }
            }
        }
        residual
    }

    /// The texture moved with its gradients, by `cycles` multigrid cycles: 0 moves directly, 1 is what the GPU does.
    #[must_use]
    pub fn dealign(&self, mask: &Mask, cycles: usize) -> Vec<[f32; 3]> {
        let mut moved = self.remap();
        if cycles == 0 {
            return moved;
        }
        let right: Vec<Complex> =
            self.residual(mask.full(), &moved).iter().map(|&[r, g, b]| [r, g, b, 0.0, 0.0, 0.0]).collect();
        let mut z = cycle(mask, 0, &right);
        for _ in 1..cycles {
            let rest: Vec<Complex> = (0..z.len()).map(|at| rest(mask.full(), 0, &right, &z, at)).collect();
            for (z, more) in z.iter_mut().zip(cycle(mask, 0, &rest)) {
                *z = add(*z, more);
            }
        }
        for (moved, z) in moved.iter_mut().zip(z) {
            *moved = [moved[0] + z[0], moved[1] + z[1], moved[2] + z[2]];
        }
        moved
    }
}

/// Real parts of three channels, then their imaginary parts.
type Complex = [f32; 6];

fn add(a: Complex, b: Complex) -> Complex {
    std::array::from_fn(|part| a[part] + b[part])
}

/// `right` - (M + i lambda) z at texel `at` of a level.
fn rest(mask: &Level, level: usize, right: &[Complex], z: &[Complex], at: usize) -> Complex {
    if mask.flags[at] & ACTIVE == 0 {
        return [0.0; 6];
    }
    let stiffness = stiffness(level);
    let mut rest = right[at];
    for other in mask.neighbours(at) {
        for part in 0..6 {
            rest[part] -= stiffness * (z[at][part] - z[other][part]);
        }
    }
    for channel in 0..3 {
        rest[channel] += LAMBDA * z[at][channel + 3];
        rest[channel + 3] -= LAMBDA * z[at][channel];
    }
    rest
}

/// `rest` divided by the diagonal of M + i lambda and damped: a Jacobi step.
fn step(mask: &Level, level: usize, rest: Complex, at: usize) -> Complex {
    let neighbours = (mask.flags[at] >> 1).count_ones() as f32;
    let diagonal = stiffness(level) * neighbours;
    let scale = OMEGA / (diagonal * diagonal + LAMBDA * LAMBDA);
    std::array::from_fn(|part| {
        let (real, imaginary) = (rest[part % 3], rest[part % 3 + 3]);
        scale * if part < 3 { diagonal * real + LAMBDA * imaginary } else { diagonal * imaginary - LAMBDA * real }
    })
}

/// Weight of an edge of M at a level, whose texels are 2^level wide.
fn stiffness(level: usize) -> f32 {
    0.25_f32.powi(level as i32)
}

/// A multigrid cycle for (M + i lambda) z = right, from z = 0: a Jacobi step before and one after the smaller level's.
fn cycle(mask: &Mask, level: usize, right: &[Complex]) -> Vec<Complex> {
    let own = &mask.levels[level];
    let mut z: Vec<Complex> = (0..right.len()).map(|at| step(own, level, right[at], at)).collect();
    if level + 1 < LEVELS {
        let smaller = cycle(mask, level + 1, &down(mask, level, right, &z));
        for at in 0..z.len() {
            z[at] = add(z[at], prolonged(mask, level, &smaller, at));
        }
    }
    (0..z.len()).map(|at| add(z[at], step(own, level, rest(own, level, right, &z, at), at))).collect()
}

/// What `z` leaves to the next smaller level: the mean over the active ones of four texels.
fn down(mask: &Mask, level: usize, right: &[Complex], z: &[Complex]) -> Vec<Complex> {
    let (own, smaller) = (&mask.levels[level], &mask.levels[level + 1]);
    let mut sums = vec![([0.0; 6], 0.0); smaller.flags.len()];
    for at in 0..right.len() {
        if own.flags[at] & ACTIVE != 0 {
            let (x, y) = (at % own.width, at / own.width);
            let (sum, count) = &mut sums[y / 2 * smaller.width + x / 2];
            *sum = add(*sum, rest(own, level, right, z, at));
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count): (Complex, f32)| sum.map(|value| value / count.max(LEAST))).collect()
}

/// The smaller level's solution at texel `at`, interpolated over its active texels.
fn prolonged(mask: &Mask, level: usize, smaller: &[Complex], at: usize) -> Complex {
    let (own, coarse) = (&mask.levels[level], &mask.levels[level + 1]);
    if own.flags[at] & ACTIVE == 0 {
        return [0.0; 6];
    }
    let (x, y) = ((at % own.width) as i32, (at / own.width) as i32);
    let (mut sum, mut total) = ([0.0; 6], 0.0);
    // Three quarters of the way lies the texel's own centre, one quarter the neighbour's on its side.
    for (dx, along) in [(0, 0.75), (x % 2 * 2 - 1, 0.25)] {
        for (dy, across) in [(0, 0.75), (y % 2 * 2 - 1, 0.25)] {
            let (x, y) = (x / 2 + dx, y / 2 + dy);
            if coarse.active(x, y) {
                let weight = along * across;
                let value = smaller[y as usize * coarse.width + x as usize];
                sum = std::array::from_fn(|part| sum[part] + weight * value[part]);
                total += weight;
            }
        }
    }
    sum.map(|value: f32| value / total)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(seed: u32) -> f32 {
        let mixed = seed.wrapping_mul(2_654_435_761) ^ seed.wrapping_mul(40_503) >> 7;
        (mixed.wrapping_mul(2_246_822_519) >> 8) as f32 / (1 << 24) as f32
    }

    /// Two charts with a ragged border and a gutter, a texture with edges, and a warp of a few texels.
    fn scene(size: usize) -> (Mask, Aligned) {
        let chart = |x: f32, y: f32, cx: f32, r: f32| {
            let (dx, dy) = (x - cx * size as f32, y - 0.5 * size as f32);
            (dx * dx + dy * dy).sqrt() < r * size as f32 * (1.0 + 0.2 * (6.0 * dy.atan2(dx)).sin())
        };
        let active: Vec<bool> = (0..size * size)
            .map(|at| ((at % size) as f32, (at / size) as f32))
            .map(|(x, y)| chart(x, y, 0.27, 0.2) || chart(x, y, 0.75, 0.18))
            .collect();
        let texels = (0..size * size).map(|at| {
            let (x, y) = ((at % size) as f32, (at / size) as f32);
            let edge = f32::from(u8::from(((0.3 * x + 0.1 * y) as u32).is_multiple_of(3)));
            let known = if active[at] { 1.0 } else { 0.0 };
            [0.2 + 0.5 * edge, 0.5 + 0.4 * (0.2 * x).sin(), 0.3 + 0.2 * noise(at as u32), known]
        });
        let texture = Field { width: size, height: size, texels: texels.collect() };
        let small = size / 4;
        let warp = (0..small * small).map(|at| {
            let (x, y) = ((at % small) as f32, (at / small) as f32);
            [3.0 * (0.9 * x + 0.3 * y).sin(), 2.0 * (0.5 * y - 0.7 * x).cos(), 0.0, 1.0]
        });
        let warp = Field { width: small, height: small, texels: warp.collect() };
        (Mask::new(size, &active), Aligned { texture, warp, texel: 1.0, cell: 4.0, fill: [0.4; 3] })
    }

    /// `(M^2 + lambda^2) x - M r`, the normal equations (thesis equation 4.3), by definition.
    fn normal_rest(mask: &Level, x: &[[f32; 3]], r: &[[f32; 3]]) -> f64 {
        let m = |of: &[f64]| -> Vec<f64> {
            (0..of.len()).map(|at| mask.neighbours(at).map(|other| of[at] - of[other]).sum()).collect()
        };
        let mut largest = 0.0_f64;
        for channel in 0..3 {
            let column = |of: &[[f32; 3]]| -> Vec<f64> { of.iter().map(|texel| f64::from(texel[channel])).collect() };
            let (x, mr) = (column(x), m(&column(r)));
            let mmx = m(&m(&x));
            for at in 0..x.len() {
                largest = largest.max((mmx[at] + f64::from(LAMBDA * LAMBDA) * x[at] - mr[at]).abs());
            }
        }
        largest
    }

    /// Root mean square difference over active texels.
    fn difference(a: &[[f32; 3]], b: &[[f32; 3]], mask: &Level) -> f32 {
        let active = (0..a.len()).filter(|&at| mask.flags[at] & ACTIVE != 0);
        let squares: Vec<f32> = active.flat_map(|at| (0..3).map(move |c| (a[at][c] - b[at][c]).powi(2))).collect();
        (squares.iter().sum::<f32>() / squares.len() as f32).sqrt()
    }

    #[test]
    fn cycles_converge_to_the_normal_equations() {
        let (mask, aligned) = scene(96);
        let moved = aligned.remap();
        let residual = aligned.residual(mask.full(), &moved);
        let exact = aligned.dealign(&mask, 40);
        let correction: Vec<[f32; 3]> =
            exact.iter().zip(&moved).map(|(e, m)| std::array::from_fn(|c| e[c] - m[c])).collect();
        let zero = vec![[0.0; 3]; moved.len()];
        let before = normal_rest(mask.full(), &zero, &residual);
        let after = normal_rest(mask.full(), &correction, &residual);
        assert!(after < 2e-5 * before.max(1.0), "{before} before, {after} after");
        let left: Vec<f32> =
            (0..6).map(|cycles| difference(&aligned.dealign(&mask, cycles), &exact, mask.full())).collect();
        assert!(left[1] < 0.4 * left[0] && left[3] < 0.1 * left[0] && left[5] < 0.03 * left[0], "{left:?}");
    }

    #[test]
    fn a_warp_that_is_the_same_everywhere_needs_no_correction() {
        let (mask, mut aligned) = scene(64);
        for texel in &mut aligned.warp.texels {
            *texel = [1.5, -0.75, 0.0, 1.0];
        }
        let difference = difference(&aligned.dealign(&mask, 1), &aligned.remap(), mask.full());
        assert!(difference < 1e-5, "{difference}");
    }

    #[test]
    fn no_warp_gives_the_texture_back() {
        let (mask, mut aligned) = scene(64);
        for texel in &mut aligned.warp.texels {
            *texel = [0.0, 0.0, 0.0, 1.0];
        }
        let own: Vec<[f32; 3]> = aligned.texture.texels.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        assert!(difference(&aligned.dealign(&mask, 1), &own, mask.full()) < 1e-6);
    }

    #[test]
    fn samples_prefer_what_is_active() {
        let texels = vec![[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, PADDING], [0.0; 4]];
        let field = Field { width: 2, height: 2, texels };
        let near = field.sample(0.4, 0.4).unwrap();
        assert!(near[0] > 0.99 && near[1] == 0.0);
        assert_eq!(field.sample(0.0, 1.0), Some([0.0, 0.0, 1.0]));
        assert_eq!(field.sample(1.0, 1.0), None);
        assert_eq!(field.sample(-7.0, f32::NAN), None);
    }
}
