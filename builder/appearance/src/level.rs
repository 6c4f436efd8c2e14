//! One resolution of the atlas: labels, neighbours, patches, and how planes of texels are laid out on it.
//!
//! Planes have a margin of [`PAD`] texels on all sides, so that a patch near the edge of the texture needs no special
//! case. Around each chart its values are spread outwards into its *territory*: the texels nearer to it than to another
//! chart. Sampling a chart stays in its territory.

use std::ops::Range;

use rayon::prelude::*;

use crate::charts::Charts;

/// Width of the margin, and of the widest territory around a chart.
pub(super) const PAD: usize = 8;
/// Width and height of a patch.
pub(super) const PATCH: usize = 8;
/// From one patch to the next.
const STEP: usize = 4;
/// A patch with fewer texels of its chart says nothing.
pub(super) const LEAST_TEXELS: usize = 12;
/// Rows that one task works on.
pub(super) const BAND: usize = 16;

/// A square of texels of one chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Patch {
    /// First column, with the margin.
    pub x: u32,
    /// First row, with the margin.
    pub y: u32,
    /// Its chart.
    pub label: u32,
}

/// One resolution of the atlas.
#[derive(Clone, Debug)]
pub(super) struct Level {
    /// The charts, without margin.
    pub charts: Charts,
    /// Width of a plane, with margins.
    pub stride: usize,
    /// Height of a plane, with margins.
    pub rows: usize,
    /// Chart of each texel; 0 outside.
    pub labels: Vec<u32>,
    /// Chart in whose territory a texel lies; 0 outside.
    pub territory: Vec<u32>,
    /// Chart in whose territory a texel, that to the right, the one below it and the one below lie all; 0 for none.
    pub quads: Vec<u32>,
    /// 1 where a texel and its right neighbour belong to one chart.
    pub right: Vec<f32>,
    /// 1 where a texel and the one below belong to one chart.
    pub down: Vec<f32>,
    /// Patches by rows.
    pub patches: Vec<Patch>,
    /// The patches of the same chart to the left and right, above and below; `u32::MAX` for none.
    pub neighbours: Vec<[u32; 4]>,
    /// Texels outside of charts and the active texel each copies.
    extension: Vec<(u32, u32)>,
}

impl Level {
    pub(super) fn new(charts: Charts) -> Self {
        let (stride, rows) = (charts.width + 2 * PAD, charts.height + 2 * PAD);
        let mut labels = vec![0; stride * rows];
        for (y, row) in charts.labels.chunks_exact(charts.width).enumerate() {
            let start = (y + PAD) * stride + PAD;
            labels[start..start + charts.width].copy_from_slice(row);
        }
        let link = |step: usize| -> Vec<f32> {
            let pairs = labels.iter().zip(labels[step..].iter().chain(std::iter::repeat(&0)));
            pairs.map(|(a, b)| f32::from(u8::from(*a != 0 && a == b))).collect()
        };
        let (right, down) = (link(1), link(stride));
        let (territory, extension) = spread(&labels, stride);
        let quad = |at: usize| {
            let label = territory[at];
            let alike = |step: usize| territory.get(at + step) == Some(&label);
            if [1, stride, stride + 1].into_iter().all(alike) { label } else { 0 }
        };
        let quads = (0..territory.len()).map(quad).collect();
        let patches = patches(&labels, stride, rows);
        let neighbours = neighbours(&patches);
        Self { charts, stride, rows, labels, territory, quads, right, down, patches, neighbours, extension }
    }

    /// The patches that begin in rows `rows`.
    pub(super) fn patches_in(&self, rows: Range<usize>) -> Range<usize> {
        let first_at = |row: usize| self.patches.partition_point(|patch| (patch.y as usize) < row);
        first_at(rows.start)..first_at(rows.end)
    }

    /// A plane of this level from a plane without margins.
    pub(super) fn padded(&self, plane: &[f32]) -> Vec<f32> {
        let mut padded = vec![0.0; self.stride * self.rows];
        for (y, row) in plane.chunks_exact(self.charts.width).enumerate() {
            let start = (y + PAD) * self.stride + PAD;
            padded[start..start + row.len()].copy_from_slice(row);
        }
        padded
    }

    /// A plane without margins.
    pub(super) fn cropped(&self, plane: &[f32]) -> Vec<f32> {
        let mut cropped = Vec::with_capacity(self.charts.width * self.charts.height);
        for row in plane.chunks_exact(self.stride).skip(PAD).take(self.charts.height) {
            cropped.extend_from_slice(&row[PAD..PAD + self.charts.width]);
        }
        cropped
    }

    /// Spreads the values of each chart over its territory.
    pub(super) fn extend<T: Copy>(&self, plane: &mut [T]) {
        for &(to, from) in &self.extension {
            plane[to as usize] = plane[from as usize];
        }
    }

    /// Gives active texels that are `unknown` the mean of their known neighbours, from the rim of each gap inwards.
    pub(super) fn fill(&self, unknown: &[bool], x: &mut [f32], y: &mut [f32]) {
        let mut unknown = unknown.to_vec();
        let mut gap: Vec<usize> = (0..unknown.len()).filter(|&k| unknown[k] && self.labels[k] != 0).collect();
        loop {
            let mut filled = Vec::new();
            for &k in &gap {
                let (mut sum_x, mut sum_y, mut count) = (0.0, 0.0, 0.0);
                for near in [k - 1, k + 1, k - self.stride, k + self.stride] {
                    if self.labels[near] == self.labels[k] && !unknown[near] {
                        sum_x += x[near];
                        sum_y += y[near];
                        count += 1.0;
                    }
                }
                if count > 0.0 {
                    filled.push((k, sum_x / count, sum_y / count));
                }
            }
            if filled.is_empty() {
                return;
            }
            for (k, mean_x, mean_y) in filled {
                (x[k], y[k], unknown[k]) = (mean_x, mean_y, false);
            }
            gap.retain(|&k| unknown[k]);
        }
    }

    /// The means of `finer` over the texels of the same chart, this level being half of that one.
    pub(super) fn shrink(&self, fine: &Level, finer: &[f32]) -> Vec<f32> {
        let mut plane = vec![0.0; self.stride * self.rows];
        plane.par_chunks_mut(self.stride).enumerate().skip(PAD).take(self.charts.height).for_each(|(row, plane)| {
            let y = row - PAD;
            for x in 0..self.charts.width {
                let label = self.labels[row * self.stride + x + PAD];
                if label == 0 {
                    continue;
                }
                let (mut sum, mut count) = (0.0, 0.0);
                let first = (2 * y + PAD) * fine.stride + 2 * x + PAD;
                for from in [first, first + 1, first + fine.stride, first + fine.stride + 1] {
                    if fine.labels[from] == label {
                        sum += finer[from];
                        count += 1.0;
                    }
                }
                plane[x + PAD] = sum / count;
            }
        });
        plane
    }

    /// `plane` of `coarse`, the level of half this resolution, interpolated on this one and multiplied by `scale`.
    pub(super) fn enlarge(&self, coarse: &Level, plane: &[f32], scale: f32) -> Vec<f32> {
        let mut fine = vec![0.0; self.stride * self.rows];
        fine.par_chunks_mut(self.stride).enumerate().skip(PAD).take(self.charts.height).for_each(|(row, fine)| {
            let y = row - PAD;
            let inner = PAD..PAD + self.charts.width;
            let labels = &self.labels[row * self.stride..][inner.clone()];
            let near = (y / 2 + PAD) * coarse.stride + PAD;
            let over = if y.is_multiple_of(2) { near - coarse.stride } else { near + coarse.stride };
            let rows = [Row::new(coarse, plane, near), Row::new(coarse, plane, over)];
            for (k, (fine, labels)) in fine[inner].chunks_mut(2).zip(labels.chunks(2)).enumerate() {
                enlarge_two(&rows, k, labels, fine, scale);
            }
        });
        fine
    }
}

/// A row of a plane, from one texel before its first.
struct Row<'a> {
    labels: &'a [u32],
    values: &'a [f32],
}

impl<'a> Row<'a> {
    fn new(level: &'a Level, plane: &'a [f32], first: usize) -> Self {
        let texels = first - 1..first + level.charts.width + 1;
        Self { labels: &level.labels[texels.clone()], values: &plane[texels] }
    }
}

/// Interpolates the two texels of a row that lie in texel `k` of the coarser rows: the `near` one, and that beyond.
#[inline(always)]
fn enlarge_two([near, over]: &[Row<'_>; 2], k: usize, labels: &[u32], fine: &mut [f32], scale: f32) {
    let (near_labels, over_labels) = (&near.labels[k..k + 3], &over.labels[k..k + 3]);
    let (n, o) = (&near.values[k..k + 3], &over.values[k..k + 3]);
    let alike = |label: u32| near_labels.iter().chain(over_labels).all(|&other| other == label);
    match (labels, &mut *fine) {
        // Nearly everywhere: all is of one chart.
        ([label, beside], [left, right]) if *label != 0 && label == beside && alike(*label) => {
            *left = scale * (9.0 * n[1] + 3.0 * n[0] + 3.0 * o[1] + o[0]) * 0.0625;
            *right = scale * (9.0 * n[1] + 3.0 * n[2] + 3.0 * o[1] + o[2]) * 0.0625;
        }
        _ => {
            for ((fine, &label), beside) in
                fine.iter_mut().zip(labels).zip([0, 2]).filter(|((_, label), _)| **label != 0)
            {
                let (mut sum, mut weight) = (0.0, 0.0);
                let of_near = [(near_labels[1], n[1], 9.0), (near_labels[beside], n[beside], 3.0)];
                let of_over = [(over_labels[1], o[1], 3.0), (over_labels[beside], o[beside], 1.0)];
                for (other, value, share) in of_near.into_iter().chain(of_over) {
                    if other == label {
                        sum += share * value;
                        weight += share;
                    }
                }
                *fine = if weight > 0.0 { scale * sum / weight } else { 0.0 };
            }
        }
    }
}

/// The territory of every chart, and for each texel of it outside the chart the active texel that is nearest.
fn spread(labels: &[u32], stride: usize) -> (Vec<u32>, Vec<(u32, u32)>) {
    let mut territory = labels.to_vec();
    let mut source: Vec<u32> = (0..labels.len() as u32).collect();
    let mut extension = Vec::new();
    let mut front: Vec<u32> = source.iter().copied().filter(|&texel| labels[texel as usize] != 0).collect();
    for _ in 0..PAD {
        let mut next = Vec::new();
        for &texel in &front {
            let at = texel as usize;
            let column = at % stride;
            let neighbours = [
                (column > 0).then(|| at - 1),
                (column + 1 < stride).then_some(at + 1),
                at.checked_sub(stride),
                Some(at + stride).filter(|&below| below < labels.len()),
            ];
            for neighbour in neighbours.into_iter().flatten().filter(|&n| territory[n] == 0).collect::<Vec<_>>() {
                territory[neighbour] = territory[at];
                source[neighbour] = source[at];
                extension.push((neighbour as u32, source[at]));
                next.push(neighbour as u32);
            }
        }
        front = next;
    }
    (territory, extension)
}

fn patches(labels: &[u32], stride: usize, rows: usize) -> Vec<Patch> {
    let mut patches = Vec::new();
    for y in (PAD - STEP..rows - PAD).step_by(STEP) {
        for x in (PAD - STEP..stride - PAD).step_by(STEP) {
            let mut counts: Vec<(u32, usize)> = Vec::new();
            for row in y..y + PATCH {
                for &label in labels[row * stride + x..row * stride + x + PATCH].iter().filter(|&&label| label != 0) {
                    match counts.iter_mut().find(|(other, _)| *other == label) {
                        Some((_, count)) => *count += 1,
                        None => counts.push((label, 1)),
                    }
                }
            }
            let enough = counts.into_iter().filter(|&(_, count)| count >= LEAST_TEXELS);
            patches.extend(enough.map(|(label, _)| Patch { x: x as u32, y: y as u32, label }));
        }
    }
    patches
}

fn neighbours(patches: &[Patch]) -> Vec<[u32; 4]> {
    let key = |patch: &Patch| (patch.y, patch.x, patch.label);
    // Patches lie in this order but for the labels of one place.
    let index: std::collections::HashMap<_, u32> = patches.iter().map(key).zip(0..).collect();
    let step = STEP as u32;
    let at = |y: u32, x: u32, label: u32| index.get(&(y, x, label)).copied().unwrap_or(u32::MAX);
    let of = |p: &Patch| {
        [
            at(p.y, p.x.wrapping_sub(step), p.label),
            at(p.y, p.x + step, p.label),
            at(p.y.wrapping_sub(step), p.x, p.label),
            at(p.y + step, p.x, p.label),
        ]
    };
    patches.iter().map(of).collect()
}
