//! Dense optical flow on the active texels, from one texture to another, never across the border of a chart.
//!
//! ```text
//! prepared textures -> detail -> pyramid -> on each level, coarse to fine: patch search -> densify -> refine -> flow
//! ```
//!
//! This work is based on: Kroeger, Timofte, Dai, Van Gool, *Fast Optical Flow using Dense Inverse Search*, 2016, with the
//! variational refinement of Brox, Bruhn, Papenberg, Weickert, *High accuracy optical flow estimation based on a theory
//! for warping*, 2004. The thesis (section 4.4.1) uses TV-L1; any dense flow of that quality serves.

mod patch;
mod plane;
mod refine;

use rayon::prelude::*;

use self::patch::{Densify, Found, Propagate, Search, Sides};
use self::plane::Plane;
use super::charts::Charts;
use super::level::{BAND, Level, PAD, PATCH};
use kernels::simd::Level as Instructions;

/// The coarsest level is not smaller than this, in texels.
const COARSEST: usize = 48;
/// Levels at most.
const MOST_LEVELS: usize = 6;
/// Detail is what differs from the mean over this part of the texture's longer side: light that moves over skin and cloth
/// changes more slowly.
const NEIGHBOURHOODS: usize = 64;
/// But at least over this many texels.
const LEAST_NEIGHBOURHOOD: usize = 8;
/// Contrast below which detail is not made stronger: a flat neighbourhood has nothing to match but light.
const LEAST_CONTRAST: f32 = 0.1;
/// Standard deviation of detail where there is plenty.
const CONTRAST: f32 = 0.2;

/// How much work the flow is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowOptions {
    /// The finest level on which patches are searched: 0 is the full resolution.
    pub finest_search: usize,
    /// Whether the full resolution is refined where patches are not searched on it.
    pub refine_full: bool,
}

impl Default for FlowOptions {
    fn default() -> Self {
        Self { finest_search: 1, refine_full: true }
    }
}

/// Where each texel of one texture is found in another: plane of texels without margin, row-major, in texels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flow {
    /// To the right.
    pub x: Vec<f32>,
    /// Downwards.
    pub y: Vec<f32>,
}

/// What all flows of an atlas share.
#[derive(Clone, Debug)]
pub struct FlowGrid {
    /// Full resolution first; those beyond `depth` only serve means.
    levels: Vec<Level>,
    /// Levels that flows are found on.
    depth: usize,
    /// The level whose texels are as large as the neighbourhoods that means are taken over.
    neighbourhood: usize,
    options: FlowOptions,
    instructions: Instructions,
}

/// A texture made ready for flows: one value a texel, on all levels.
#[derive(Clone, Debug)]
pub struct Prepared {
    planes: Vec<Plane>,
}

impl FlowGrid {
    /// Prepares for flows over `charts`.
    #[must_use]
    pub fn new(charts: &Charts, options: FlowOptions) -> Self {
        let neighbourhood =
            (charts.width.max(charts.height) / NEIGHBOURHOODS).max(LEAST_NEIGHBOURHOOD).ilog2() as usize;
        let mut levels = vec![Level::new(charts.clone())];
        let (mut charts, mut depth) = (charts.halved(), 1);
        loop {
            let large = depth < MOST_LEVELS && charts.width.min(charts.height) >= COARSEST && depth == levels.len();
            if !large && levels.len() > neighbourhood {
                break;
            }
            depth += usize::from(large);
            let next = charts.halved();
            levels.push(Level::new(charts));
            charts = next;
        }
        Self { levels, depth, neighbourhood, options, instructions: Instructions::best() }
    }

    /// Makes a texture ready; `values` of all texels row-major, about 0 to 1; `seen` where some were hidden.
    #[must_use]
    pub fn prepare(&self, values: &[f32], seen: Option<&[bool]>) -> Prepared {
        let mut planes: Vec<Plane> = Vec::with_capacity(self.levels.len());
        for (index, level) in self.levels.iter().enumerate().take(self.depth) {
            let (mut value, seen) = match planes.last() {
                None => {
                    let ones = |seen: &[bool]| seen.iter().map(|&seen| f32::from(u8::from(seen))).collect::<Vec<_>>();
                    let seen = seen.map(|seen| level.padded(&ones(seen)));
                    (self.detail(level.padded(values), seen.as_deref()), seen)
                }
                Some(finer) => {
                    let fine = &self.levels[index - 1];
                    let seen = finer.seen.as_ref().map(|seen| {
                        let mut shrunk = level.shrink(fine, seen);
                        // A texel of which a part was hidden counts as hidden.
                        shrunk.iter_mut().for_each(|seen| *seen = seen.floor());
                        shrunk
                    });
                    (level.shrink(fine, &finer.value), seen)
                }
            };
            level.extend(&mut value);
            let seen = seen.map(|mut seen| {
                level.extend(&mut seen);
                seen
            });
            let (across, along) = refine::gradients(level, &value);
            planes.push(Plane { value, across, along, seen });
        }
        Prepared { planes }
    }

    /// `plane` without its local mean, at an even contrast, about 0.5; where it was not seen it counts for nothing.
    fn detail(&self, plane: Vec<f32>, seen: Option<&[f32]>) -> Vec<f32> {
        let known = seen.map(|seen| self.blurred(seen));
        let mean = |plane: &[f32]| -> Vec<f32> {
            match seen.zip(known.as_ref()) {
                Some((seen, known)) => {
                    let part: Vec<f32> = plane.iter().zip(seen).map(|(value, seen)| value * seen).collect();
                    let part = self.blurred(&part);
                    part.iter().zip(known).map(|(part, known)| part / known.max(1e-3)).collect()
                }
                None => self.blurred(plane),
            }
        };
        let mut detail = plane;
        let local = mean(&detail);
        detail.iter_mut().zip(&local).for_each(|(value, mean)| *value -= mean);
        let squares: Vec<f32> = detail.iter().map(|value| value * value).collect();
        for (value, variance) in detail.iter_mut().zip(mean(&squares)) {
            *value = 0.5 + CONTRAST * *value / (variance + LEAST_CONTRAST * LEAST_CONTRAST).sqrt();
        }
        detail
    }

    /// Means over neighbourhoods, within charts, interpolated.
    fn blurred(&self, plane: &[f32]) -> Vec<f32> {
        let scale = self.neighbourhood;
        let mut mean = plane.to_vec();
        for index in 1..=scale {
            mean = self.levels[index].shrink(&self.levels[index - 1], &mean);
        }
        for index in (1..=scale).rev() {
            mean = self.levels[index - 1].enlarge(&self.levels[index], &mean, 1.0);
        }
        mean
    }

    /// The flow w with `template(x) = other(x + w(x))`, as well as the two can be matched.
    #[must_use]
    pub fn flow(&self, template: &Prepared, other: &Prepared) -> Flow {
        let mut flow: Option<[Vec<f32>; 2]> = None;
        let finest_search = self.options.finest_search.min(self.depth - 1);
        for index in (0..self.depth).rev() {
            let level = &self.levels[index];
            let mut current = match flow.take() {
                Some([x, y]) => {
                    let coarse = &self.levels[index + 1];
                    [level.enlarge(coarse, &x, 2.0), level.enlarge(coarse, &y, 2.0)]
                }
                None => [vec![0.0; level.labels.len()], vec![0.0; level.labels.len()]],
            };
            let sides = Sides { level, template: &template.planes[index], other: &other.planes[index] };
            if index >= finest_search {
                self.search(&sides, &mut current);
            }
            let margin = if index == 0 { 0 } else { PAD };
            flow = Some(match index >= finest_search || self.options.refine_full {
                true => refine::refine(self.instructions, &sides, &current, margin),
                false if index == 0 => current.map(|plane| level.cropped(&plane)),
                false => current,
            });
        }
        let [x, y] = flow.unwrap_or_default();
        Flow { x, y }
    }

    /// Makes a flow better that is nearly right, at full resolution.
    #[must_use]
    pub fn refine(&self, template: &Prepared, other: &Prepared, flow: &Flow) -> Flow {
        let level = &self.levels[0];
        let current = [level.padded(&flow.x), level.padded(&flow.y)];
        let sides = Sides { level, template: &template.planes[0], other: &other.planes[0] };
        let [x, y] = refine::refine(self.instructions, &sides, &current, 0);
        Flow { x, y }
    }

    fn search(&self, sides: &Sides<'_>, flow: &mut [Vec<f32>; 2]) {
        let level = sides.level;
        let mut found = vec![Found::default(); level.patches.len()];
        let initial = [flow[0].as_slice(), flow[1].as_slice()];
        found.par_chunks_mut(256).zip(level.patches.par_chunks(256)).for_each(|(found, patches)| {
            self.instructions.run(Search { sides: *sides, initial, patches, found });
        });
        let before = found.clone();
        let all = level.patches.par_chunks(256).zip(level.neighbours.par_chunks(256));
        found.par_chunks_mut(256).zip(all).for_each(|(found, (patches, neighbours))| {
            self.instructions.run(Propagate { sides: *sides, patches, neighbours, before: &before, found });
        });
        let [x, y] = flow;
        let bands = x.par_chunks_mut(BAND * level.stride).zip(y.par_chunks_mut(BAND * level.stride)).enumerate();
        let unknown: Vec<Vec<bool>> = bands
            .map(|(band, (x, y))| {
                let first_row = band * BAND;
                let over = level.patches_in((first_row + 1).saturating_sub(PATCH)..first_row + BAND);
                let (patches, found) = (&level.patches[over.clone()], &found[over]);
                self.instructions.run(Densify { sides: *sides, patches, found, first_row, flow: [x, y] })
            })
            .collect();
        level.fill(&unknown.concat(), x, y);
    }
}

#[cfg(test)]
mod tests;
