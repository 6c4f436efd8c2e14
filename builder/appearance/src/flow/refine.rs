//! Variational refinement of a flow: brightness and gradients stay, the flow is smooth but may break.
//!
//! This work is based on: Brox, Bruhn, Papenberg, Weickert, *High accuracy optical flow estimation based on a theory for
//! warping*, 2004: the energy, its linearisation about the present flow and the nested fixed points. The equations are
//! divided by the gradients' squares (Zimmer et al. 2009), so that all count as distances in texels. Each linear system
//! is relaxed by a few Jacobi steps with Chebyshev weights, which run in vectors, unlike successive over-relaxation.
//!
//! Square tiles are relaxed one by one in the processor's cache, each with a border as wide as what a step can reach:
//! the result is the same as without tiles.

use std::ops::Range;

use rayon::prelude::*;

use super::patch::Sides;
use crate::level::{Level, PAD};
use kernels::simd::{Kernel, Level as Instructions};

/// Times that the robust weights are found anew.
const ROBUST_STEPS: usize = 2;
/// Jacobi steps for each.
const JACOBI_STEPS: usize = 4;
/// How far a tile's edge reaches inwards: two for derivatives, then one for the weights and one for each Jacobi step.
const BORDER: usize = 2 + ROBUST_STEPS * (1 + JACOBI_STEPS);
/// Width and height of a tile with its border.
const TILE: usize = 128;
const CORE: usize = TILE - 2 * BORDER;
const SIZE: usize = TILE * TILE;

/// Weight of brightness.
const BRIGHTNESS: f32 = 5.0;
/// Weight of gradients.
const GRADIENTS: f32 = 10.0;
/// Weight of smoothness.
const SMOOTHNESS: f32 = 20.0;
/// Squared gradient that counts as noise, values being 0 to 255.
const NOISE: f32 = 1.0;
/// Squared distance below which a robust weight stays the same, in texels.
const EPSILON: f32 = 1e-6;
/// Square of the spectral radius that the Chebyshev weights assume.
const RADIUS: f32 = 0.9;

/// Derivatives of `plane` to the right and downwards, within charts: central, one-sided at borders.
pub(super) fn gradients(level: &Level, plane: &[f32]) -> (Vec<f32>, Vec<f32>) {
    let (mut across, mut along) = (vec![0.0; plane.len()], vec![0.0; plane.len()]);
    let bands = across.par_chunks_mut(level.stride).zip(along.par_chunks_mut(level.stride)).enumerate();
    bands.filter(|(y, _)| (PAD..level.rows - PAD).contains(y)).for_each(|(y, (across, along))| {
        let start = y * level.stride;
        for x in PAD..level.stride - PAD {
            let i = start + x;
            let (right, left) = (level.right[i], level.right[i - 1]);
            let (down, up) = (level.down[i], level.down[i - level.stride]);
            let slope = |before: usize, after: usize, a: f32, b: f32| {
                (a * (plane[after] - plane[i]) + b * (plane[i] - plane[before])) / (a + b).max(1.0)
            };
            across[x] = slope(i - 1, i + 1, right, left);
            along[x] = slope(i - level.stride, i + level.stride, down, up);
        }
    });
    (across, along)
}

/// Refines `flow`, two planes of the level. What comes out has a margin of `margin` texels: [`PAD`], or none.
pub(super) fn refine(
    instructions: Instructions,
    sides: &Sides<'_>,
    flow: &[Vec<f32>; 2],
    margin: usize,
) -> [Vec<f32>; 2] {
    let level = sides.level;
    let (width, height) = (level.charts.width, level.charts.height);
    let stride = width + 2 * margin;
    let mut refined = [(); 2].map(|()| vec![0.0; stride * (height + 2 * margin)]);
    let [x, y] = &mut refined;
    let inner = margin * stride..(margin + height) * stride;
    let bands = x[inner.clone()].par_chunks_mut(CORE * stride).zip(y[inner].par_chunks_mut(CORE * stride));
    bands.enumerate().for_each(|(band, (band_x, band_y))| {
        let first_row = PAD + band * CORE;
        let rows = band_x.len() / stride;
        for column in (0..width).step_by(CORE) {
            let columns = CORE.min(width - column);
            let at = |row: usize| (first_row + row) * level.stride + PAD + column;
            let active = (0..rows).any(|row| level.labels[at(row)..at(row) + columns].iter().any(|&label| label != 0));
            let corner = (PAD + column, first_row);
            let tile =
                active.then(|| instructions.run(Relax { sides: *sides, flow: [&flow[0], &flow[1]], corner, rows }));
            for row in 0..rows {
                let to = row * stride + margin + column;
                // A tile without active texels stays as it was.
                let ([from_x, from_y], from) = match &tile {
                    Some(tile) => (tile, (row + BORDER) * TILE + BORDER),
                    None => (flow, at(row)),
                };
                band_x[to..to + columns].copy_from_slice(&from_x[from..from + columns]);
                band_y[to..to + columns].copy_from_slice(&from_y[from..from + columns]);
            }
        }
    });
    refined
}

/// Refines the flow in one tile, whose core begins at `corner`.
struct Relax<'a> {
    sides: Sides<'a>,
    flow: [&'a [f32]; 2],
    corner: (usize, usize),
    /// Rows of its core that are wanted.
    rows: usize,
}

/// What the linear system of a tile is made of.
struct Terms {
    /// Derivatives of brightness, and its difference.
    x: Vec<f32>,
    y: Vec<f32>,
    t: Vec<f32>,
    /// The same of the derivatives.
    xx: Vec<f32>,
    xy: Vec<f32>,
    yy: Vec<f32>,
    xt: Vec<f32>,
    yt: Vec<f32>,
    /// 1 where the other side is seen.
    valid: Vec<f32>,
    /// Links to the right and downwards.
    right: Vec<f32>,
    down: Vec<f32>,
}

/// The linear system: a symmetric matrix of two rows and a right side a texel, and a weight a link.
struct System {
    xx: Vec<f32>,
    xy: Vec<f32>,
    yy: Vec<f32>,
    bx: Vec<f32>,
    by: Vec<f32>,
    right: Vec<f32>,
    down: Vec<f32>,
}

impl Kernel for Relax<'_> {
    type Output = [Vec<f32>; 2];

    #[inline(always)]
    fn run(self) -> [Vec<f32>; 2] {
        let start = [self.cut(self.flow[0]), self.cut(self.flow[1])];
        let terms = self.terms(&start);
        let [mut x, mut y] = start.clone();
        for step in 0..ROBUST_STEPS {
            // Steps after this one need a little less all around.
            let later = (ROBUST_STEPS - 1 - step) * (1 + JACOBI_STEPS);
            let system = system(&terms, &start, [&x, &y], self.needed(later + JACOBI_STEPS - 1));
            let (mut before_x, mut before_y) = (x.clone(), y.clone());
            let mut weight = 1.0;
            for step in 0..JACOBI_STEPS {
                // Chebyshev's weights.
                weight = match step {
                    0 => 1.0,
                    1 => 2.0 / (2.0 - RADIUS),
                    _ => 4.0 / (4.0 - RADIUS * weight),
                };
                let rows = self.needed(later + JACOBI_STEPS - 1 - step);
                jacobi(&system, [&x, &y], [&mut before_x, &mut before_y], weight, rows);
                std::mem::swap(&mut x, &mut before_x);
                std::mem::swap(&mut y, &mut before_y);
            }
        }
        [x, y]
    }
}

impl Relax<'_> {
    /// Rows of the tile that the core's result depends on, `reach` neighbours from now.
    #[inline(always)]
    fn needed(&self, reach: usize) -> Range<usize> {
        BORDER - reach..BORDER + self.rows + reach
    }

    /// The tile's part of a plane; zero beyond the plane.
    #[inline(always)]
    fn cut(&self, plane: &[f32]) -> Vec<f32> {
        let level = self.sides.level;
        let mut tile = vec![0.0; SIZE];
        let (left, top) = (self.corner.0 as isize - BORDER as isize, self.corner.1 as isize - BORDER as isize);
        let skip = (-left).max(0) as usize;
        let width = (TILE as isize).min(level.stride as isize - left) as usize;
        for row in self.needed(BORDER) {
            let y = top + row as isize;
            if y < 0 || y >= level.rows as isize || width <= skip {
                continue;
            }
            let from = y as usize * level.stride + (left + skip as isize) as usize;
            tile[row * TILE + skip..row * TILE + width].copy_from_slice(&plane[from..from + width - skip]);
        }
        tile
    }

    /// Linearises both constancy assumptions about the flow `start`.
    #[inline(always)]
    fn terms(&self, start: &[Vec<f32>; 2]) -> Terms {
        let (template, level) = (self.sides.template, self.sides.level);
        let (right, down) = (self.cut(&level.right), self.cut(&level.down));
        let mut value = self.cut(&template.value);
        let (mut valid, warped) = self.warp(&value, start);
        if let Some(seen) = &template.seen {
            let seen = self.cut(seen);
            for k in 0..SIZE {
                valid[k] *= seen[k];
            }
        }
        let (wx, wy) = slopes(&warped, &right, &down, self.needed(BORDER - 1));
        let (tx, ty) = (self.cut(&template.across), self.cut(&template.along));
        let mut x = vec![0.0; SIZE];
        let (mut y, mut xt, mut yt) = (x.clone(), x.clone(), x.clone());
        let rows = self.needed(BORDER - 1);
        for k in rows.start * TILE..rows.end * TILE {
            x[k] = 127.5 * (wx[k] + tx[k]);
            y[k] = 127.5 * (wy[k] + ty[k]);
            xt[k] = 255.0 * (wx[k] - tx[k]);
            yt[k] = 255.0 * (wy[k] - ty[k]);
            value[k] = 255.0 * (warped[k] - value[k]);
        }
        let rows = self.needed(BORDER - 2);
        let (xx, xy) = slopes(&x, &right, &down, rows.clone());
        let (_, yy) = slopes(&y, &right, &down, rows);
        Terms { x, y, t: value, xx, xy, yy, xt, yt, valid, right, down }
    }

    /// The other side moved by the flow, and where it stays within the chart; elsewhere the template.
    #[inline(always)]
    fn warp(&self, template: &[f32], flow: &[Vec<f32>; 2]) -> (Vec<f32>, Vec<f32>) {
        let level = self.sides.level;
        let (mut valid, mut warped) = (vec![0.0; SIZE], template.to_vec());
        let (left, top) = (self.corner.0 as isize - BORDER as isize, self.corner.1 as isize - BORDER as isize);
        let columns = (-left).max(0) as usize..TILE.min((level.stride as isize - left) as usize);
        for row in self.needed(BORDER) {
            let y = top + row as isize;
            if y < 0 || y >= level.rows as isize {
                continue;
            }
            let of_row = row * TILE + columns.start..row * TILE + columns.end;
            let x = left + columns.start as isize;
            let ways = [&flow[0][of_row.clone()], &flow[1][of_row.clone()]];
            self.warp_row((x as usize, y as usize), ways, &mut valid[of_row.clone()], &mut warped[of_row]);
        }
        (valid, warped)
    }

    /// [`Self::warp`] for part of a row, which begins at texel `at`. Coordinates and colours are found in vectors, a row at
    /// a time; between them the four texels about each place are fetched one by one.
    #[inline(always)]
    fn warp_row(&self, at: (usize, usize), ways: [&[f32]; 2], valid: &mut [f32], warped: &mut [f32]) {
        let (level, other) = (self.sides.level, self.sides.other);
        let (stride, count) = (level.stride, valid.len().min(TILE));
        let (mut place, mut inside) = ([0_i32; TILE], [false; TILE]);
        let (mut share_x, mut share_y) = ([0.0_f32; TILE], [0.0_f32; TILE]);
        let (right, bottom) = ((stride - 1) as f32, (level.rows - 1) as f32);
        for k in 0..count {
            let (px, py) = ((at.0 + k) as f32 + ways[0][k], at.1 as f32 + ways[1][k]);
            let (fx, fy) = (px.floor(), py.floor());
            // Written so that NaN is outside.
            inside[k] = fx >= 0.0 && fy >= 0.0 && fx < right && fy < bottom;
            let (fx, fy) = if inside[k] { (fx, fy) } else { (0.0, 0.0) };
            place[k] = fy as i32 * stride as i32 + fx as i32;
            (share_x[k], share_y[k]) = (px - fx, py - fy);
        }
        let mut fetched = [[0.0_f32; TILE]; 4];
        let mut own = [0_u32; TILE];
        for k in 0..count {
            let place = place[k] as usize;
            let (upper, lower) = (&other.value[place..place + 2], &other.value[place + stride..place + stride + 2]);
            (fetched[0][k], fetched[1][k]) = (upper[0], upper[1]);
            (fetched[2][k], fetched[3][k]) = (lower[0], lower[1]);
            own[k] = level.quads[place];
            if let Some(seen) = &other.seen {
                let (upper, lower) = (&seen[place..place + 2], &seen[place + stride..place + stride + 2]);
                own[k] = if upper[0] * upper[1] * lower[0] * lower[1] > 0.0 { own[k] } else { 0 };
            }
        }
        let labels = &level.labels[at.1 * stride + at.0..][..count];
        let (valid, warped) = (&mut valid[..count], &mut warped[..count]);
        for k in 0..count {
            let upper = fetched[0][k] + share_x[k] * (fetched[1][k] - fetched[0][k]);
            let lower = fetched[2][k] + share_x[k] * (fetched[3][k] - fetched[2][k]);
            let colour = upper + share_y[k] * (lower - upper);
            let known = inside[k] & (labels[k] != 0) & (own[k] == labels[k]);
            warped[k] = if known { colour } else { warped[k] };
            valid[k] = if known { 1.0 } else { 0.0 };
        }
    }
}

/// Derivatives of some rows within charts, as [`gradients`]. Those at the left and right edge mean nothing: each takes the
/// other for its neighbour, so that all rows are whole vectors, and the border keeps them from the core.
#[inline(always)]
fn slopes(plane: &[f32], right: &[f32], down: &[f32], rows: Range<usize>) -> (Vec<f32>, Vec<f32>) {
    let (mut across, mut along) = (vec![0.0; SIZE], vec![0.0; SIZE]);
    for row in rows {
        let o = row * TILE;
        let (across, along) = (&mut across[o..o + TILE], &mut along[o..o + TILE]);
        let (here, before, after) = (&plane[o..o + TILE], &plane[o - 1..o - 1 + TILE], &plane[o + 1..o + 1 + TILE]);
        let (above, below) = (&plane[o - TILE..o], &plane[o + TILE..o + 2 * TILE]);
        let (r, l) = (&right[o..o + TILE], &right[o - 1..o - 1 + TILE]);
        let (d, u) = (&down[o..o + TILE], &down[o - TILE..o]);
        for k in 0..TILE {
            across[k] = (r[k] * (after[k] - here[k]) + l[k] * (here[k] - before[k])) / (r[k] + l[k]).max(1.0);
            along[k] = (d[k] * (below[k] - here[k]) + u[k] * (here[k] - above[k])) / (d[k] + u[k]).max(1.0);
        }
    }
    (across, along)
}

/// The linear system of some rows about the flow `start`, its robust weights taken at the flow `now`.
#[inline(always)]
fn system(terms: &Terms, start: &[Vec<f32>; 2], now: [&[f32]; 2], rows: Range<usize>) -> System {
    let zero = || vec![0.0; SIZE];
    let mut system = System { xx: zero(), xy: zero(), yy: zero(), bx: zero(), by: zero(), right: zero(), down: zero() };
    let mut robust = zero();
    for k in rows.start * TILE..rows.end * TILE {
        let (dx, dy) = (now[0][k] - start[0][k], now[1][k] - start[1][k]);
        let (x, y, t) = (terms.x[k], terms.y[k], terms.t[k]);
        let scale = 1.0 / (x * x + y * y + NOISE);
        let off = t + x * dx + y * dy;
        let brightness = BRIGHTNESS * scale / (off * off * scale + EPSILON).sqrt();
        let (xx, xy, yy, xt, yt) = (terms.xx[k], terms.xy[k], terms.yy[k], terms.xt[k], terms.yt[k]);
        let (scale_x, scale_y) = (1.0 / (xx * xx + xy * xy + NOISE), 1.0 / (xy * xy + yy * yy + NOISE));
        let (off_x, off_y) = (xt + xx * dx + xy * dy, yt + xy * dx + yy * dy);
        let gradients = GRADIENTS / (off_x * off_x * scale_x + off_y * off_y * scale_y + EPSILON).sqrt();
        let (b, gx, gy) =
            (terms.valid[k] * brightness, terms.valid[k] * gradients * scale_x, terms.valid[k] * gradients * scale_y);
        let (a11, a12, a22) = (
            b * x * x + gx * xx * xx + gy * xy * xy,
            b * x * y + gx * xx * xy + gy * xy * yy,
            b * y * y + gx * xy * xy + gy * yy * yy,
        );
        (system.xx[k], system.xy[k], system.yy[k]) = (a11, a12, a22);
        // For the whole flow, not for its change.
        let (sx, sy) = (start[0][k], start[1][k]);
        system.bx[k] = a11 * sx + a12 * sy - (b * x * t + gx * xx * xt + gy * xy * yt);
        system.by[k] = a12 * sx + a22 * sy - (b * y * t + gx * xy * xt + gy * yy * yt);
    }
    // Links go to the rows above and below.
    let (around, above) = (rows.start - 1..rows.end + 1, rows.start - 1..rows.end);
    let (ux, uy) = slopes(now[0], &terms.right, &terms.down, around.clone());
    let (vx, vy) = slopes(now[1], &terms.right, &terms.down, around.clone());
    for k in around.start * TILE..around.end * TILE {
        let steep = ux[k] * ux[k] + uy[k] * uy[k] + vx[k] * vx[k] + vy[k] * vy[k];
        robust[k] = SMOOTHNESS / (steep + EPSILON).sqrt();
    }
    for k in above.start * TILE..above.end * TILE {
        system.right[k] = 0.5 * terms.right[k] * (robust[k] + robust[k + 1]);
        system.down[k] = 0.5 * terms.down[k] * (robust[k] + robust[k + TILE]);
    }
    system
}

/// One step of some rows from the flow `now`; `before` comes in as the flow before it and goes out as the flow after it.
#[inline(always)]
fn jacobi(system: &System, now: [&[f32]; 2], before: [&mut [f32]; 2], weight: f32, rows: Range<usize>) {
    let [next_x, next_y] = before;
    for row in rows {
        // Whole rows: as in [`slopes`], the outermost columns mean nothing.
        let o = row * TILE;
        let (r, l) = (&system.right[o..o + TILE], &system.right[o - 1..o - 1 + TILE]);
        let (d, u) = (&system.down[o..o + TILE], &system.down[o - TILE..o]);
        let (a11, a12, a22) = (&system.xx[o..o + TILE], &system.xy[o..o + TILE], &system.yy[o..o + TILE]);
        let (bx, by) = (&system.bx[o..o + TILE], &system.by[o..o + TILE]);
        let (x_r, x_l) = (&now[0][o + 1..o + 1 + TILE], &now[0][o - 1..o - 1 + TILE]);
        let (x_d, x_u) = (&now[0][o + TILE..o + 2 * TILE], &now[0][o - TILE..o]);
        let (y_r, y_l) = (&now[1][o + 1..o + 1 + TILE], &now[1][o - 1..o - 1 + TILE]);
        let (y_d, y_u) = (&now[1][o + TILE..o + 2 * TILE], &now[1][o - TILE..o]);
        let (x, y) = (&mut next_x[o..o + TILE], &mut next_y[o..o + TILE]);
        for k in 0..TILE {
            let links = r[k] + l[k] + d[k] + u[k];
            let p = bx[k] + r[k] * x_r[k] + l[k] * x_l[k] + d[k] * x_d[k] + u[k] * x_u[k];
            let q = by[k] + r[k] * y_r[k] + l[k] * y_l[k] + d[k] * y_d[k] + u[k] * y_u[k];
            let (a, b, c) = (a11[k] + links + 1e-9, a12[k], a22[k] + links + 1e-9);
            let inverse = 1.0 / (a * c - b * b);
            let (want_x, want_y) = ((c * p - b * q) * inverse, (a * q - b * p) * inverse);
            x[k] += weight * (want_x - x[k]);
            y[k] += weight * (want_y - y[k]);
        }
    }
}
