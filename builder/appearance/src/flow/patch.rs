//! Patches: finding where one has gone, and spreading what they found over texels.
//!
//! This work is based on: Kroeger, Timofte, Dai, Van Gool, *Fast Optical Flow using Dense Inverse Search*, 2016. Patches
//! are compared after their means are taken out, so that a change of brightness does not count, and only over texels of
//! their own chart. Ways spread between neighbours in a round of its own, so that all patches are independent.

use super::plane::Plane;
use crate::level::{LEAST_TEXELS, Level, PAD, PATCH, Patch};
use kernels::simd::Kernel;

/// Steps of the search at most.
const STEPS: usize = 12;
/// The search ends when a step is shorter than this, in texels.
const SHORT: f32 = 0.02;
/// A patch that moves further than this from where it began has lost its way, in texels.
const FAR: f32 = PATCH as f32;
/// Variance of values below which a patch has nothing to go by, a texel.
const FLAT: f32 = 1e-6;
/// Differences below this count all the same when patches are weighed.
const LEAST_DIFFERENCE: f32 = 1.0 / 255.0;
/// What the initial flow counts, against mean square gradients over differences.
const PRIOR: f32 = 0.35;
/// Mean square gradient of a patch with plenty of detail: it is trusted as much as it says. One with less counts less than
/// that, for what moves in it may be light.
const PLENTY: f32 = 0.01;
/// The least and the most that patches count for having less detail or more.
const TRUST: (f32, f32) = (0.02, 10.0);

/// A neighbour's way is tried where it leaves less than this part of a patch's error.
const CLEARLY: f32 = 0.8;

type Block = [[f32; PATCH]; PATCH];

/// Where a patch was found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Found {
    /// How far it went, in texels.
    pub way: [f32; 2],
    /// How much brighter it is there.
    pub brighter: f32,
    /// Mean square of what is left; infinite where nothing could be compared.
    pub error: f32,
    /// How sure the way is: the mean square gradients xx, xy, yy of the patch.
    pub certainty: [f32; 3],
}

/// The two sides of a search on one level.
#[derive(Clone, Copy)]
pub(super) struct Sides<'a> {
    pub level: &'a Level,
    pub template: &'a Plane,
    pub other: &'a Plane,
}

/// Finds patches: inverse compositional Gauss-Newton steps from the initial flow.
pub(super) struct Search<'a> {
    pub sides: Sides<'a>,
    /// Where to begin, in planes of the level.
    pub initial: [&'a [f32]; 2],
    pub patches: &'a [Patch],
    pub found: &'a mut [Found],
}

impl Kernel for Search<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (patch, found) in self.patches.iter().zip(self.found) {
            *found = search(&self.sides, self.initial, patch);
        }
    }
}

/// Tries where the neighbours of each patch were found, and searches on from there where that is better.
pub(super) struct Propagate<'a> {
    pub sides: Sides<'a>,
    pub patches: &'a [Patch],
    pub neighbours: &'a [[u32; 4]],
    /// Of all patches of the level, before this.
    pub before: &'a [Found],
    pub found: &'a mut [Found],
}

impl Kernel for Propagate<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for ((patch, neighbours), found) in self.patches.iter().zip(self.neighbours).zip(self.found) {
            let mut best = found.error * CLEARLY;
            let mut way = None;
            for &neighbour in neighbours {
                let Some(other) = self.before.get(neighbour as usize) else { continue };
                let (x, y) = (other.way[0] - found.way[0], other.way[1] - found.way[1]);
                if x * x + y * y < 0.25 {
                    continue;
                }
                let error = error_at(&self.sides, patch, other.way);
                if error < best {
                    best = error;
                    way = Some(other.way);
                }
            }
            if let Some(way) = way {
                let again = search_from(&self.sides, patch, way);
                if again.error < found.error {
                    *found = again;
                }
            }
        }
    }
}

/// Spreads the ways of patches over the texels of some rows: each texel takes the mean of the patches over it and of the
/// initial flow. Patches that explain the texel best count most, each in the directions in which it has detail: along a
/// straight edge, and where a patch is flat, what the coarser level said stays. Returns where no patch said anything.
pub(super) struct Densify<'a> {
    pub sides: Sides<'a>,
    pub patches: &'a [Patch],
    pub found: &'a [Found],
    /// First row of the flow's two slices of planes.
    pub first_row: usize,
    /// The initial flow comes in; it stays where no patch lies.
    pub flow: [&'a mut [f32]; 2],
}

impl Kernel for Densify<'_> {
    type Output = Vec<bool>;

    #[inline(always)]
    fn run(self) -> Vec<bool> {
        let Self { sides, patches, found, first_row, flow: [flow_x, flow_y] } = self;
        let stride = sides.level.stride;
        let mut sums = vec![[0.0_f32; 5]; flow_x.len()];
        let end_row = first_row + flow_x.len() / stride;
        for (patch, found) in patches.iter().zip(found) {
            let (template, mask) = (block(&sides.template.value, stride, patch), mask(&sides, patch));
            let Some((sample, valid)) = sampled(&sides, patch, found.way) else { continue };
            for row in 0..PATCH {
                let y = patch.y as usize + row;
                if y < first_row || y >= end_row {
                    continue;
                }
                let start = (y - first_row) * stride + patch.x as usize;
                let sums = &mut sums[start..start + PATCH];
                let ([xx, xy, yy], [x, y]) = (found.certainty, found.way);
                let trust = ((xx + yy) / PLENTY).clamp(TRUST.0, TRUST.1);
                for k in 0..PATCH {
                    let difference = (sample[row][k] - template[row][k] - found.brighter).abs();
                    let weight = trust * mask[row][k] * valid[row][k] / difference.max(LEAST_DIFFERENCE);
                    sums[k][0] += weight * xx;
                    sums[k][1] += weight * xy;
                    sums[k][2] += weight * yy;
                    sums[k][3] += weight * (xx * x + xy * y);
                    sums[k][4] += weight * (xy * x + yy * y);
                }
            }
        }
        let mut unknown = vec![false; flow_x.len()];
        for k in 0..flow_x.len() {
            let [xx, xy, yy, x, y] = sums[k];
            unknown[k] = xx + yy == 0.0;
            let (xx, yy) = (xx + PRIOR, yy + PRIOR);
            let (x, y) = (x + PRIOR * flow_x[k], y + PRIOR * flow_y[k]);
            let inverse = 1.0 / (xx * yy - xy * xy);
            flow_x[k] = (yy * x - xy * y) * inverse;
            flow_y[k] = (xx * y - xy * x) * inverse;
        }
        unknown
    }
}

#[inline(always)]
fn search(sides: &Sides<'_>, initial: [&[f32]; 2], patch: &Patch) -> Found {
    let stride = sides.level.stride;
    let mask = mask(sides, patch);
    let count = sum(&mask);
    let start = [
        sum_of_products(&mask, &block(initial[0], stride, patch)) / count.max(1.0),
        sum_of_products(&mask, &block(initial[1], stride, patch)) / count.max(1.0),
    ];
    search_from(sides, patch, start)
}

/// How far off a patch is after going `way`.
#[inline(always)]
fn error_at(sides: &Sides<'_>, patch: &Patch, way: [f32; 2]) -> f32 {
    let stride = sides.level.stride;
    let (mask, template) = (mask(sides, patch), block(&sides.template.value, stride, patch));
    let Some((sample, valid)) = sampled(sides, patch, way) else { return f32::INFINITY };
    compare(&mask, &valid, &sample, &template).map_or(f32::INFINITY, |compared| compared.error)
}

/// The difference of a patch to where it is sought.
struct Compared {
    /// Differences without their mean, nothing where not both sides count.
    residual: Block,
    brighter: f32,
    error: f32,
}

#[inline(always)]
fn compare(mask: &Block, valid: &Block, sample: &Block, template: &Block) -> Option<Compared> {
    let (mut weight, mut residual) = ([[0.0; PATCH]; PATCH], [[0.0; PATCH]; PATCH]);
    for row in 0..PATCH {
        for k in 0..PATCH {
            weight[row][k] = mask[row][k] * valid[row][k];
            residual[row][k] = sample[row][k] - template[row][k];
        }
    }
    let seen = sum(&weight);
    if seen < LEAST_TEXELS as f32 {
        return None;
    }
    let brighter = sum_of_products(&weight, &residual) / seen;
    for row in 0..PATCH {
        for k in 0..PATCH {
            residual[row][k] = weight[row][k] * (residual[row][k] - brighter);
        }
    }
    let error = sum_of_products(&residual, &residual) / seen;
    Some(Compared { residual, brighter, error })
}

#[inline(always)]
fn search_from(sides: &Sides<'_>, patch: &Patch, start: [f32; 2]) -> Found {
    let stride = sides.level.stride;
    let mask = mask(sides, patch);
    let count = sum(&mask);
    let template = block(&sides.template.value, stride, patch);
    let gradient_x = without_mean(&block(&sides.template.across, stride, patch), &mask, count);
    let gradient_y = without_mean(&block(&sides.template.along, stride, patch), &mask, count);
    let (a, b, c) = (
        sum_of_products(&gradient_x, &gradient_x) + FLAT * count,
        sum_of_products(&gradient_x, &gradient_y),
        sum_of_products(&gradient_y, &gradient_y) + FLAT * count,
    );
    let determinant = a * c - b * b;
    let share = 1.0 / count.max(1.0);
    let certainty = [a * share - FLAT, b * share, c * share - FLAT];
    let mut best = Found { way: start, brighter: 0.0, error: f32::INFINITY, certainty };
    let mut way = start;
    for _ in 0..STEPS {
        let Some((sample, valid)) = sampled(sides, patch, way) else { break };
        let Some(Compared { residual, brighter, error }) = compare(&mask, &valid, &sample, &template) else { break };
        if error.is_nan() || error >= best.error {
            break;
        }
        best = Found { way, brighter, error, certainty };
        let (bx, by) = (sum_of_products(&gradient_x, &residual), sum_of_products(&gradient_y, &residual));
        let step = [(c * bx - b * by) / determinant, (a * by - b * bx) / determinant];
        way = [way[0] - step[0], way[1] - step[1]];
        let (from_x, from_y) = (way[0] - start[0], way[1] - start[1]);
        let away = from_x * from_x + from_y * from_y;
        if away.is_nan() || away > FAR * FAR {
            break;
        }
        if step[0] * step[0] + step[1] * step[1] < SHORT * SHORT {
            best.way = way;
            break;
        }
    }
    best
}

/// The values of `plane` under a patch.
#[inline(always)]
fn block(plane: &[f32], stride: usize, patch: &Patch) -> Block {
    let mut block = [[0.0; PATCH]; PATCH];
    let first = patch.y as usize * stride + patch.x as usize;
    for (row, values) in block.iter_mut().enumerate() {
        let start = first + row * stride;
        values.copy_from_slice(&plane[start..start + PATCH]);
    }
    block
}

/// What each texel of a patch counts: those of other charts nothing, and those that were not seen.
#[inline(always)]
fn mask(sides: &Sides<'_>, patch: &Patch) -> Block {
    let stride = sides.level.stride;
    let mut mask = match &sides.template.seen {
        Some(seen) => block(seen, stride, patch),
        None => [[1.0; PATCH]; PATCH],
    };
    let first = patch.y as usize * stride + patch.x as usize;
    for (row, values) in mask.iter_mut().enumerate() {
        let labels = &sides.level.labels[first + row * stride..first + row * stride + PATCH];
        for k in 0..PATCH {
            values[k] = if labels[k] == patch.label { values[k] } else { 0.0 };
        }
    }
    mask
}

/// The other side where the patch lies after going `way`, and which of its values come from the patch's chart alone;
/// nothing where the patch would leave the plane.
#[inline(always)]
fn sampled(sides: &Sides<'_>, patch: &Patch, way: [f32; 2]) -> Option<(Block, Block)> {
    let level = sides.level;
    let (x, y) = (patch.x as f32 + way[0], patch.y as f32 + way[1]);
    let (left, top) = (x.floor(), y.floor());
    let inside = left >= 0.0
        && top >= 0.0
        && left <= (level.stride - PATCH - 1) as f32
        && top <= (level.rows - PATCH - 1) as f32;
    if !inside {
        return None;
    }
    let (fx, fy) = (x - left, y - top);
    let first = top as usize * level.stride + left as usize;
    let mut lines = [[0.0; PATCH]; PATCH + 1];
    for (row, line) in lines.iter_mut().enumerate() {
        let start = first + row * level.stride;
        let values = &sides.other.value[start..start + PATCH + 1];
        for k in 0..PATCH {
            line[k] = values[k] + fx * (values[k + 1] - values[k]);
        }
    }
    let (mut sample, mut valid) = ([[0.0; PATCH]; PATCH], [[0.0; PATCH]; PATCH]);
    for row in 0..PATCH {
        let start = first + row * level.stride;
        let quads = &level.quads[start..start + PATCH];
        for k in 0..PATCH {
            sample[row][k] = lines[row][k] + fy * (lines[row + 1][k] - lines[row][k]);
            valid[row][k] = if quads[k] == patch.label { 1.0 } else { 0.0 };
        }
    }
    if let Some(seen) = &sides.other.seen {
        for (row, valid) in valid.iter_mut().enumerate() {
            let start = first + row * level.stride;
            let (upper, lower) = (&seen[start..start + PATCH + 1], &seen[start + level.stride..][..PATCH + 1]);
            for k in 0..PATCH {
                valid[k] *= upper[k] * upper[k + 1] * lower[k] * lower[k + 1];
            }
        }
    }
    Some((sample, valid))
}

#[inline(always)]
fn without_mean(block: &Block, mask: &Block, count: f32) -> Block {
    let mean = sum_of_products(block, mask) / count.max(1.0);
    let mut centred = [[0.0; PATCH]; PATCH];
    for row in 0..PATCH {
        for k in 0..PATCH {
            centred[row][k] = mask[row][k] * (block[row][k] - mean);
        }
    }
    centred
}

#[inline(always)]
fn sum(block: &Block) -> f32 {
    let mut lanes = [0.0; PATCH];
    for row in block {
        for k in 0..PATCH {
            lanes[k] += row[k];
        }
    }
    total(&lanes)
}

#[inline(always)]
fn sum_of_products(a: &Block, b: &Block) -> f32 {
    let mut lanes = [0.0; PATCH];
    for row in 0..PATCH {
        for k in 0..PATCH {
            lanes[k] += a[row][k] * b[row][k];
        }
    }
    total(&lanes)
}

#[inline(always)]
fn total(lanes: &[f32; PATCH]) -> f32 {
    ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))
}

const _: () = assert!(PAD >= PATCH, "a patch that begins in the margin must end in the plane");
