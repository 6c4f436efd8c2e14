//! Variational refinement of a flow: brightness and gradients stay, the flow is smooth but may break.
//!
//! This work is based on: Brox, Bruhn, Papenberg, Weickert, *High accuracy optical flow estimation based on a theory for
//! warping*, 2004: the energy, its linearisation about the present flow and the nested fixed points. The equations are
//! divided by the gradients' squares (Zimmer et al. 2009), so that all count as distances in texels. Each linear system
//! is relaxed by a few Jacobi steps with Chebyshev weights, which run in vectors, unlike successive over-relaxation.
//!
//! Square tiles are relaxed one by one in the processor's cache, each with a border as wide as what a step can reach:
//! the result is the same as without tiles.

use rayon::prelude::*;

use super::patch::Sides;
use crate::appearance::level::{Level, PAD};
use crate::simd::{Kernel, Level as Instructions};

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

/// Refines `flow`, two planes of the level.
pub(super) fn refine(instructions: Instructions, sides: &Sides<'_>, flow: &mut [Vec<f32>; 2]) {
    let level = sides.level;
    let mut corners = Vec::new();
    for y in (PAD..level.rows - PAD).step_by(CORE) {
        for x in (PAD..level.stride - PAD).step_by(CORE) {
            let end = (y + CORE).min(level.rows - PAD);
            let width = CORE.min(level.stride - PAD - x);
            let row = |y: usize| &level.labels[y * level.stride + x..y * level.stride + x + width];
            if (y..end).any(|y| row(y).iter().any(|&label| label != 0)) {
                corners.push((x, y));
            }
        }
    }
    let [flow_x, flow_y] = flow;
    let (present_x, present_y) = (&*flow_x, &*flow_y);
    let refined: Vec<[Vec<f32>; 2]> = corners
        .par_iter()
        .map(|&(x, y)| instructions.run(Relax { sides: *sides, flow: [present_x, present_y], corner: (x, y) }))
        .collect();
    for (&(x, y), [tile_x, tile_y]) in corners.iter().zip(&refined) {
        for row in 0..CORE.min(level.rows - PAD - y) {
            let width = CORE.min(level.stride - PAD - x);
            let to = (y + row) * level.stride + x;
            let from = (row + BORDER) * TILE + BORDER;
            flow_x[to..to + width].copy_from_slice(&tile_x[from..from + width]);
            flow_y[to..to + width].copy_from_slice(&tile_y[from..from + width]);
        }
    }
}

/// Refines the flow in one tile, whose core begins at `corner`.
struct Relax<'a> {
    sides: Sides<'a>,
    flow: [&'a [f32]; 2],
    corner: (usize, usize),
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
        for _ in 0..ROBUST_STEPS {
            let system = system(&terms, &start, [&x, &y]);
            relax(&system, &mut x, &mut y);
        }
        [x, y]
    }
}

impl Relax<'_> {
    /// The tile's part of a plane; zero beyond the plane.
    #[inline(always)]
    fn cut(&self, plane: &[f32]) -> Vec<f32> {
        let level = self.sides.level;
        let mut tile = vec![0.0; SIZE];
        let (left, top) = (self.corner.0 as isize - BORDER as isize, self.corner.1 as isize - BORDER as isize);
        let skip = (-left).max(0) as usize;
        let width = (TILE as isize).min(level.stride as isize - left) as usize;
        for row in 0..TILE {
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
        let (wx, wy) = slopes(&warped, &right, &down);
        let (tx, ty) = (self.cut(&template.across), self.cut(&template.along));
        let mut x = vec![0.0; SIZE];
        let (mut y, mut xt, mut yt) = (x.clone(), x.clone(), x.clone());
        for k in 0..SIZE {
            x[k] = 127.5 * (wx[k] + tx[k]);
            y[k] = 127.5 * (wy[k] + ty[k]);
            xt[k] = 255.0 * (wx[k] - tx[k]);
            yt[k] = 255.0 * (wy[k] - ty[k]);
            value[k] = 255.0 * (warped[k] - value[k]);
        }
        let (xx, xy) = slopes(&x, &right, &down);
        let (_, yy) = slopes(&y, &right, &down);
        Terms { x, y, t: value, xx, xy, yy, xt, yt, valid, right, down }
    }

    /// The other side moved by the flow, and where it stays within the chart; elsewhere the template.
    #[inline(always)]
    fn warp(&self, template: &[f32], flow: &[Vec<f32>; 2]) -> (Vec<f32>, Vec<f32>) {
        let (level, other) = (self.sides.level, self.sides.other);
        let (mut valid, mut warped) = (vec![0.0; SIZE], template.to_vec());
        let (left, top) = (self.corner.0 as isize - BORDER as isize, self.corner.1 as isize - BORDER as isize);
        let columns = (-left).max(0) as usize..TILE.min((level.stride as isize - left) as usize);
        for row in 0..TILE {
            let y = top + row as isize;
            if y < 0 || y >= level.rows as isize {
                continue;
            }
            for column in columns.clone() {
                let (k, x) = (row * TILE + column, left + column as isize);
                let label = level.labels[y as usize * level.stride + x as usize];
                let (px, py) = (x as f32 + flow[0][k], y as f32 + flow[1][k]);
                let (fx, fy) = (px.floor(), py.floor());
                // Written so that NaN is outside.
                let inside = fx >= 0.0 && fy >= 0.0 && fx < (level.stride - 1) as f32 && fy < (level.rows - 1) as f32;
                if label == 0 || !inside {
                    continue;
                }
                let at = fy as usize * level.stride + fx as usize;
                let below = at + level.stride;
                let own = level.territory[at] == label
                    && level.territory[at + 1] == label
                    && level.territory[below] == label
                    && level.territory[below + 1] == label;
                if own
                    && other
                        .seen
                        .as_ref()
                        .is_none_or(|seen| seen[at] * seen[at + 1] * seen[below] * seen[below + 1] > 0.0)
                {
                    let v = &other.value;
                    let (sx, sy) = (px - fx, py - fy);
                    let upper = v[at] + sx * (v[at + 1] - v[at]);
                    let lower = v[below] + sx * (v[below + 1] - v[below]);
                    warped[k] = upper + sy * (lower - upper);
                    valid[k] = 1.0;
                }
            }
        }
        (valid, warped)
    }
}

/// Derivatives within charts, as [`gradients`]; zero along the tile's edge.
#[inline(always)]
fn slopes(plane: &[f32], right: &[f32], down: &[f32]) -> (Vec<f32>, Vec<f32>) {
    let (mut across, mut along) = (vec![0.0; SIZE], vec![0.0; SIZE]);
    const N: usize = TILE - 2;
    for row in 1..TILE - 1 {
        let o = row * TILE + 1;
        let (across, along) = (&mut across[o..o + N], &mut along[o..o + N]);
        let (here, before, after) = (&plane[o..o + N], &plane[o - 1..o - 1 + N], &plane[o + 1..o + 1 + N]);
        let (above, below) = (&plane[o - TILE..o - TILE + N], &plane[o + TILE..o + TILE + N]);
        let (r, l) = (&right[o..o + N], &right[o - 1..o - 1 + N]);
        let (d, u) = (&down[o..o + N], &down[o - TILE..o - TILE + N]);
        for k in 0..N {
            across[k] = (r[k] * (after[k] - here[k]) + l[k] * (here[k] - before[k])) / (r[k] + l[k]).max(1.0);
            along[k] = (d[k] * (below[k] - here[k]) + u[k] * (here[k] - above[k])) / (d[k] + u[k]).max(1.0);
        }
    }
    (across, along)
}

/// The linear system about the flow `start`, its robust weights taken at the flow `now`.
#[inline(always)]
fn system(terms: &Terms, start: &[Vec<f32>; 2], now: [&[f32]; 2]) -> System {
    let zero = || vec![0.0; SIZE];
    let mut system = System { xx: zero(), xy: zero(), yy: zero(), bx: zero(), by: zero(), right: zero(), down: zero() };
    let mut robust = zero();
    for k in 0..SIZE {
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
    let (ux, uy) = slopes(now[0], &terms.right, &terms.down);
    let (vx, vy) = slopes(now[1], &terms.right, &terms.down);
    for k in 0..SIZE {
        let steep = ux[k] * ux[k] + uy[k] * uy[k] + vx[k] * vx[k] + vy[k] * vy[k];
        robust[k] = SMOOTHNESS / (steep + EPSILON).sqrt();
    }
    for k in 0..SIZE - TILE {
        system.right[k] = 0.5 * terms.right[k] * (robust[k] + robust[k + 1]);
        system.down[k] = 0.5 * terms.down[k] * (robust[k] + robust[k + TILE]);
    }
    system
}

/// Jacobi steps with Chebyshev weights on the flow `x`, `y`.
#[inline(always)]
fn relax(system: &System, x: &mut Vec<f32>, y: &mut Vec<f32>) {
    let (mut before_x, mut before_y) = (x.clone(), y.clone());
    let mut weight = 1.0;
    for step in 0..JACOBI_STEPS {
        weight = match step {
            0 => 1.0,
            1 => 2.0 / (2.0 - RADIUS),
            _ => 4.0 / (4.0 - RADIUS * weight),
        };
        jacobi(system, [x, y], [&mut before_x, &mut before_y], weight);
        std::mem::swap(x, &mut before_x);
        std::mem::swap(y, &mut before_y);
    }
}

/// One step from the flow `now`; `before` comes in as the flow before it and goes out as the flow after it.
#[inline(always)]
fn jacobi(system: &System, now: [&[f32]; 2], before: [&mut [f32]; 2], weight: f32) {
    const N: usize = TILE - 2;
    let [next_x, next_y] = before;
    for row in 1..TILE - 1 {
        let o = row * TILE + 1;
        let (r, l) = (&system.right[o..o + N], &system.right[o - 1..o - 1 + N]);
        let (d, u) = (&system.down[o..o + N], &system.down[o - TILE..o - TILE + N]);
        let (a11, a12, a22) = (&system.xx[o..o + N], &system.xy[o..o + N], &system.yy[o..o + N]);
        let (bx, by) = (&system.bx[o..o + N], &system.by[o..o + N]);
        let (x_r, x_l) = (&now[0][o + 1..o + 1 + N], &now[0][o - 1..o - 1 + N]);
        let (x_d, x_u) = (&now[0][o + TILE..o + TILE + N], &now[0][o - TILE..o - TILE + N]);
        let (y_r, y_l) = (&now[1][o + 1..o + 1 + N], &now[1][o - 1..o - 1 + N]);
        let (y_d, y_u) = (&now[1][o + TILE..o + TILE + N], &now[1][o - TILE..o - TILE + N]);
        let (x, y) = (&mut next_x[o..o + N], &mut next_y[o..o + N]);
        for k in 0..N {
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
