//! Textures between two frames of a capture, which no camera sees: what a transition should show, drift by drift and
//! light by light. They are made again from what a capture's truth says that the performer was asked for.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::artefacts::{self, Hole, Light, UNLIT, shown};
use super::figure::{Figure, bytes};
use super::perform::{Take, perform, takes};
use super::{Artefacts, Kind, PerformerOptions, check};
use geometry::mesh::vertex_normals;

/// What the performer was asked for, in `truth/capture.json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Asked {
    pub frames: usize,
    pub vertices: usize,
    pub texture_size: usize,
    pub fps: f32,
    #[serde(default, skip_serializing_if = "is_usual")]
    pub figure: Kind,
}

fn is_usual(figure: &Kind) -> bool {
    *figure == Kind::default()
}

/// The part of `truth/capture.json` that a capture is made again from.
#[derive(Deserialize)]
struct Constants {
    seed: u64,
    artefacts: Vec<(String, bool)>,
    asked: Option<Asked>,
}

/// The options that the capture with the folder `truth` was performed with.
///
/// # Errors
/// Why they cannot be told, as an end of a sentence.
pub fn options(truth: &Path) -> Result<PerformerOptions, String> {
    let path = truth.join("capture.json");
    let text = fs::read(&path).map_err(|error| format!("{} cannot be read ({error})", path.display()))?;
    let constants: Constants =
        serde_json::from_slice(&text).map_err(|error| format!("{} is not a truth file ({error})", path.display()))?;
    let Asked { frames, vertices, texture_size, fps, figure } = constants
        .asked
        .ok_or_else(|| format!("{} was written by an earlier version: perform the capture again", path.display()))?;
    let on: Vec<&str> = constants.artefacts.iter().filter(|(_, on)| *on).map(|(name, _)| name.as_str()).collect();
    let artefacts: Artefacts = on.join(",").parse()?;
    let options = PerformerOptions { frames, vertices, texture_size, artefacts, seed: constants.seed, fps, figure };
    check(&options).map_err(|error| format!("{} is not a truth file ({error})", path.display()))?;
    Ok(options)
}

/// What a frame's texture depends on.
struct Look {
    /// From each vertex to where it has drifted, in the bind pose; all zero without drift.
    ways: Vec<Vec3>,
    /// Normals of the surface as performed.
    normals: Vec<Vec3>,
    light: Option<Light>,
    hole: Option<Hole>,
}

/// Makes the textures between any two of some frames of a performance.
pub struct Between {
    figure: Figure,
    /// By frame, counted over the whole performance.
    looks: BTreeMap<usize, Look>,
    /// Metres from each texel to the next, in the bind pose.
    spacing: Vec<f32>,
}

impl Between {
    /// Performs again what `options` say, and keeps what the textures of `frames` depend on. Frames are counted over the
    /// sequences of [`takes`]; those beyond are left out.
    #[must_use]
    pub fn new(options: &PerformerOptions, frames: &[usize]) -> Self {
        let figure = Figure::of(options.figure, options.vertices, options.texture_size);
        let around = figure.mesh.triangles_of_vertices();
        let rest_normals = vertex_normals(&figure.mesh.positions, &figure.mesh.triangles);
        let (on, fps) = (options.artefacts, options.fps);
        let looks_of = |take: &Take| -> Vec<(usize, Look)> {
            let own = take.first_frame..take.first_frame + take.frames;
            let mut wanted: Vec<usize> = frames.iter().copied().filter(|frame| own.contains(frame)).collect();
            wanted.sort_unstable();
            wanted.dedup();
            if wanted.is_empty() {
                return Vec::new();
            }
            let performed = perform(&figure, take, fps);
            let look = |frame: usize| {
                let index = frame - take.first_frame;
                let ways = if on.drift {
                    artefacts::drift(&figure, &around, &rest_normals, take, index, fps).ways
                } else {
                    vec![Vec3::ZERO; figure.mesh.positions.len()]
                };
                let normals = vertex_normals(&performed[index].positions, &figure.mesh.triangles);
                let light = on.light.then(|| Light::new(take, index, fps));
                let hole = if on.holes { Hole::new(&figure, take, index) } else { None };
                (frame, Look { ways, normals, light, hole })
            };
            wanted.into_iter().map(look).collect()
        };
        let takes = takes(options.frames, fps, options.seed);
        let looks: Vec<Vec<(usize, Look)>> = takes.par_iter().map(looks_of).collect();
        let spacing = spacing(&figure);
        Self { figure, looks: looks.into_iter().flatten().collect(), spacing }
    }

    /// Width and height of the textures.
    #[must_use]
    pub fn size(&self) -> usize {
        self.figure.atlas.size
    }

    /// The texture of a frame as it was captured, with its hole. `None` for a frame that was not kept.
    #[must_use]
    pub fn recorded(&self, frame: usize) -> Option<Vec<[u8; 3]>> {
        let look = self.looks.get(&frame)?;
        Some(self.draw([look; 2], 0.0, look.hole.as_ref()))
    }

    /// The texture `lambda` of the way from the first frame to the second, without holes: each texel shows the point of
    /// the body at the interpolated drift, in the interpolated shade. `None` for a frame that was not kept.
    #[must_use]
    pub fn texture(&self, frames: [usize; 2], lambda: f32) -> Option<Vec<[u8; 3]>> {
        Some(self.draw([self.looks.get(&frames[0])?, self.looks.get(&frames[1])?], lambda, None))
    }

    fn draw(&self, looks: [&Look; 2], lambda: f32, hole: Option<&Hole>) -> Vec<[u8; 3]> {
        let figure = &self.figure;
        let mixed = |a: f32, b: f32| a + lambda * (b - a);
        let texels = figure.atlas.texels.par_iter().zip(&figure.texel_points);
        let colours: Vec<[u8; 3]> = texels
            .map(|(&(_, point), &rest)| {
                let [a, b] = looks.map(|look| figure.at(&look.ways, point));
                let seen = rest + (a + lambda * (b - a));
                if hole.is_some_and(|hole| seen.distance(hole.centre) < hole.radius) {
                    return [0; 3];
                }
                let [a, b] = looks.map(|look| {
                    let normal = figure.at(&look.normals, point).normalize_or(Vec3::Y);
                    look.light.map_or(UNLIT, |light| light.shade(normal))
                });
                bytes(shown(figure, point, seen, (mixed(a.0, b.0), mixed(a.1, b.1))))
            })
            .collect();
        let mut image = vec![[128; 3]; self.size() * self.size()];
        for (&(index, _), colour) in figure.atlas.texels.iter().zip(colours) {
            image[index as usize] = colour;
        }
        figure.atlas.dilate(&mut image);
        image
    }

    /// How far the textures of two frames have slid apart at each texel, in texels of the bind pose; NaN outside of the
    /// atlas's triangles. `None` for a frame that was not kept.
    #[must_use]
    pub fn slides(&self, frames: [usize; 2]) -> Option<Vec<f32>> {
        let [a, b] = [self.looks.get(&frames[0])?, self.looks.get(&frames[1])?];
        let mut slides = vec![f32::NAN; self.size() * self.size()];
        for (&(index, point), spacing) in self.figure.atlas.texels.iter().zip(&self.spacing) {
            let way = self.figure.at(&b.ways, point) - self.figure.at(&a.ways, point);
            slides[index as usize] = way.length() / spacing;
        }
        Some(slides)
    }
}

/// Metres from each texel of the atlas to its neighbours in the same chart, in the bind pose: the mean of those to the
/// right and below. Where it has none, what the atlas has on average.
fn spacing(figure: &Figure) -> Vec<f32> {
    let atlas = &figure.atlas;
    let mut numbers = vec![u32::MAX; atlas.size * atlas.size];
    for (number, &(index, _)) in (0..).zip(&atlas.texels) {
        numbers[index as usize] = number;
    }
    let chart = |number: usize| atlas.chart_of_triangle[atlas.texels[number].1.triangle as usize];
    let on_triangle = |number: usize| {
        let point = atlas.texels[number].1;
        figure.rest_point(point.triangle, point.weights)
    };
    let own = |number: usize| -> Option<f32> {
        let index = atlas.texels[number].0 as usize;
        let right = !(index + 1).is_multiple_of(atlas.size);
        let beside = [right.then_some(index + 1), Some(index + atlas.size)];
        let near = beside.into_iter().flatten().filter_map(|index| numbers.get(index)).map(|&number| number as usize);
        let lengths: Vec<f32> = near
            .filter(|&near| near < atlas.texels.len() && chart(near) == chart(number))
            .map(|near| on_triangle(near).distance(on_triangle(number)))
            .filter(|&length| length > 0.0)
            .collect();
        (!lengths.is_empty()).then(|| lengths.iter().sum::<f32>() / lengths.len() as f32)
    };
    let found: Vec<Option<f32>> = (0..atlas.texels.len()).map(own).collect();
    let known: Vec<f32> = found.iter().copied().flatten().collect();
    let mean = known.iter().map(|&length| f64::from(length)).sum::<f64>() / known.len().max(1) as f64;
    found.into_iter().map(|length| length.unwrap_or(mean.max(1e-6) as f32)).collect()
}
