//! One resolution of the atlas: labels, neighbours, patches, and how planes of texels are laid out on it.
//!
//! Planes have a margin of [`PAD`] texels on all sides, so that a patch near the edge of the texture needs no special
//! case. Around each chart its values are spread outwards into its *territory*: the texels nearer to it than to another
//! chart. Sampling a chart stays in its territory.

use std::ops::Range;

use crate::appearance::charts::Charts;

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
    /// 1 where a texel and its right neighbour belong to one chart.
    pub right: Vec<f32>,
    /// 1 where a texel and the one below belong to one chart.
    pub down: Vec<f32>,
    /// Patches by rows.
    pub patches: Vec<Patch>,
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
        let patches = patches(&labels, stride, rows);
        Self { charts, stride, rows, labels, territory, right, down, patches, extension }
    }

    /// The rows without margins, in bands of at most [`BAND`].
    pub(super) fn bands(&self) -> Vec<Range<usize>> {
        let end = self.rows - PAD;
        (PAD..end).step_by(BAND).map(|start| start..(start + BAND).min(end)).collect()
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
    pub(super) fn extend(&self, plane: &mut [f32]) {
        for &(to, from) in &self.extension {
            plane[to as usize] = plane[from as usize];
        }
    }

    /// The means of `finer` over the texels of the same chart, this level being half of that one.
    pub(super) fn shrink(&self, fine: &Level, finer: &[f32]) -> Vec<f32> {
        let mut plane = vec![0.0; self.stride * self.rows];
        for y in 0..self.charts.height {
            for x in 0..self.charts.width {
                let index = (y + PAD) * self.stride + x + PAD;
                let label = self.labels[index];
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
                plane[index] = sum / count;
            }
        }
        plane
    }

    /// `plane` of `coarse`, the level of half this resolution, interpolated on this one and multiplied by `scale`.
    pub(super) fn enlarge(&self, coarse: &Level, plane: &[f32], scale: f32) -> Vec<f32> {
        let mut fine = vec![0.0; self.stride * self.rows];
        for y in 0..self.charts.height {
            for x in 0..self.charts.width {
                let index = (y + PAD) * self.stride + x + PAD;
                let label = self.labels[index];
                if label == 0 {
                    continue;
                }
                let near = (y / 2 + PAD) * coarse.stride + x / 2 + PAD;
                let beside = if x % 2 == 0 { near - 1 } else { near + 1 };
                let (over, both) =
                    if y % 2 == 0 { (near - coarse.stride, beside - coarse.stride) } else { (near + coarse.stride, beside + coarse.stride) };
                let (mut sum, mut weight) = (0.0, 0.0);
                for (from, share) in [(near, 9.0), (beside, 3.0), (over, 3.0), (both, 1.0)] {
                    if coarse.labels[from] == label {
                        sum += share * plane[from];
                        weight += share;
                    }
                }
                fine[index] = if weight > 0.0 { scale * sum / weight } else { 0.0 };
            }
        }
        fine
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
