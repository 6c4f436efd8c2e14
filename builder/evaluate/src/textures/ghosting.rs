//! Transitions between sequences against the truth, where a program knows what lies between two of its frames: how close
//! interpolated coefficients come, and how close a linear cross-fade, by how far the two textures have slid apart.

use bundle::{AppearanceInput, store_appearance};
use rayon::prelude::*;
use serde::Serialize;
use texture::quality::Similarity;

use super::quality::{Quality, evenly};
use super::seams::{Moment, worn};
use appearance::AppearanceError;
use appearance::align::{Aligned, colours};
use appearance::basis::Basis;
use appearance::charts::Charts;
use appearance::stored::{self, CYCLES};
use appearance::textures::{Texture, TextureSource};

/// Where between two frames it is measured. At 0 it is the first frame: what the model costs there, no blending does.
pub const LAMBDAS: [f32; 3] = [0.0, 0.25, 0.5];
/// From which slide to which, in texels, a class of texels reaches.
pub const CLASSES: [[f32; 2]; 4] = [[0.0, 0.5], [0.5, 1.0], [1.0, 2.0], [2.0, f32::INFINITY]];
/// Pairs of frames that are measured at most.
const PAIRS: usize = 32;

/// What makes the texture between two frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Our coefficients, interpolated.
    Eigen,
    /// The same after storing, as the player shows it.
    Stored,
    /// The captured textures, cross-faded.
    FadeCaptured,
    /// Our textures of both frames after storing, cross-faded, as the player does it to compare.
    FadeStored,
}

impl Way {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Eigen, Self::Stored, Self::FadeCaptured, Self::FadeStored];
}

/// The truth about a performance.
pub trait Truth: Sync {
    /// The texture `lambda` of the way from the first frame to the second; `None` where it is not known.
    fn between(&self, frames: [usize; 2], lambda: f32) -> Option<Texture>;

    /// How far these frames' textures have slid apart at each texel, in texels, row-major; NaN where it is not known.
    fn slides(&self, frames: [usize; 2]) -> Option<Vec<f32>>;
}

/// Transitions whose truth is known.
pub struct Crossings<'a> {
    /// Two frames that are blended in each; those with a gap are left out.
    pub pairs: &'a [[usize; 2]],
    /// What lies between them.
    pub truth: &'a dyn Truth,
}

/// How close one way comes to the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Closeness {
    /// Similarity and error.
    pub quality: Quality,
    /// Mean gradient over that of the truth: below 1 is blur.
    pub sharpness: f64,
}

/// All texels that slid as far, in all pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Row {
    /// How far from the first frame to the second.
    pub lambda: f32,
    /// From which slide to which, in texels; all texels where none is told.
    pub slides: Option<[f32; 2]>,
    /// Their share of all texels.
    pub share: f64,
    /// Their mean slide in texels.
    pub slide: f64,
    /// By [`Way::ALL`].
    pub ways: [Closeness; 4],
}

/// Half way between the two frames that slid furthest apart: three values per active texel, as a screen shows them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Worst {
    /// Both frames.
    pub frames: [usize; 2],
    /// Mean slide in texels.
    pub slide: f64,
    /// What it should be.
    pub truth: Vec<f32>,
    /// By [`Way::ALL`].
    pub ways: [Vec<f32>; 4],
    /// Slides of active texels, in texels.
    pub slides: Vec<f32>,
}

/// Transitions against the truth.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AgainstTruth {
    /// Pairs that were measured.
    pub pairs: usize,
    /// By lambda, all texels first.
    pub rows: Vec<Row>,
    /// The pair that slid furthest apart.
    #[serde(skip)]
    pub worst: Option<Worst>,
}

/// A capture and its appearance.
pub struct Scene<'a, S: TextureSource + ?Sized> {
    /// Textures of all frames.
    pub source: &'a S,
    /// The same, aligned.
    pub aligned: &'a Aligned,
    /// The models of them.
    pub basis: &'a Basis,
    /// Over the active texels.
    pub similarity: &'a Similarity,
}

/// Measures `crossings`.
///
/// # Errors
/// Textures that cannot be read, or a model that cannot be stored.
pub fn against_truth(
    scene: &Scene<'_, impl TextureSource + ?Sized>,
    crossings: &Crossings<'_>,
) -> Result<AgainstTruth, AppearanceError> {
    let complete = |frame: &usize| scene.aligned.complete.binary_search(frame).is_ok();
    let whole: Vec<[usize; 2]> = crossings.pairs.iter().copied().filter(|pair| pair.iter().all(complete)).collect();
    let pairs = evenly(&whole, PAIRS);
    if pairs.is_empty() {
        return Ok(AgainstTruth::default());
    }
    let maker = Maker::new(scene)?;
    let neighbours = Neighbours::new(&scene.aligned.charts);
    let measured: Vec<Result<Option<Measured>, AppearanceError>> =
        pairs.par_iter().map(|&pair| measure(scene, &maker, &neighbours, crossings.truth, pair)).collect();
    let mut found = AgainstTruth::default();
    let mut sums = [[Sums::default(); 1 + CLASSES.len()]; LAMBDAS.len()];
    let mut furthest: Option<([usize; 2], f64)> = None;
    for (measured, &pair) in measured.into_iter().zip(&pairs) {
        let Some(measured) = measured? else { continue };
        found.pairs += 1;
        sums.as_flattened_mut().iter_mut().zip(measured.as_flattened()).for_each(|(sum, own)| sum.add(own));
        let slide = measured[0][0].slide / measured[0][0].slid.max(1.0);
        if furthest.is_none_or(|(_, most)| slide > most) {
            furthest = Some((pair, slide));
        }
    }
    for (sums, &lambda) in sums.iter().zip(&LAMBDAS) {
        // Where nothing is blended nothing can ghost: classes would tell nothing.
        let classes = if lambda == 0.0 { 1 } else { sums.len() };
        for (class, own) in sums.iter().enumerate().take(classes).filter(|(_, own)| own.count > 0.0) {
            let slides = class.checked_sub(1).map(|class| CLASSES[class]);
            found.rows.push(own.row(lambda, slides, sums[0].count));
        }
    }
    if let Some((frames, slide)) = furthest.filter(|(_, slide)| *slide > 0.0) {
        let known = crossings.truth.between(frames, 0.5).zip(crossings.truth.slides(frames));
        if let Some((truth, slides)) = known {
            let charts = &scene.aligned.charts;
            let ways = maker.ways(&maker.ends(frames)?, 0.5);
            found.worst =
                Some(Worst { frames, slide, truth: colours(&truth, charts), ways, slides: active(&slides, charts) });
        }
    }
    Ok(found)
}

/// Makes textures in all ways.
struct Maker<'a, S: TextureSource + ?Sized> {
    scene: &'a Scene<'a, S>,
    stored: bundle::StoredAppearance,
}

impl<'a, S: TextureSource + ?Sized> Maker<'a, S> {
    fn new(scene: &'a Scene<'a, S>) -> Result<Self, AppearanceError> {
        let &Scene { source, aligned, basis, .. } = scene;
        let sample = evenly(&aligned.complete, 16);
        let (ssim, _) = basis.quality(source, aligned, &sample, basis.textures.modes.len(), basis.warps.modes.len())?;
        let model = basis.clone().into_model(&aligned.charts);
        let (quality, _) = stored::choose(source, &aligned.charts, &model, ssim, &sample)?;
        let input = AppearanceInput { model: &model, material: 0, quality };
        Ok(Self { scene, stored: store_appearance(&input, source.frame_count() as u32, 1)? })
    }

    /// What both frames show.
    fn ends(&self, frames: [usize; 2]) -> Result<Ends, AppearanceError> {
        let Scene { source, aligned, .. } = self.scene;
        let captured = |frame: usize| Ok::<_, AppearanceError>(colours(&source.read(frame)?, &aligned.charts));
        Ok(Ends {
            frames,
            captured: [captured(frames[0])?, captured(frames[1])?],
            stored: frames.map(|frame| self.stored([frame; 2], 0.0)),
        })
    }

    fn stored(&self, frames: [usize; 2], lambda: f32) -> Vec<f32> {
        shown(self.stored.between(frames.map(|frame| frame as u32), lambda, CYCLES))
    }

    /// By [`Way::ALL`], as a screen shows them.
    fn ways(&self, ends: &Ends, lambda: f32) -> [Vec<f32>; 4] {
        let (&Scene { aligned, basis, .. }, frames) = (self.scene, ends.frames);
        [
            shown(worn(aligned, basis, Moment { frames, lambda })),
            self.stored(frames, lambda),
            faded(&ends.captured, lambda),
            faded(&ends.stored, lambda),
        ]
    }
}

/// The textures of two frames: as captured, and as the player shows them.
struct Ends {
    frames: [usize; 2],
    captured: [Vec<f32>; 2],
    stored: [Vec<f32>; 2],
}

fn shown(mut colours: Vec<f32>) -> Vec<f32> {
    colours.iter_mut().for_each(|value| *value = value.clamp(0.0, 1.0));
    colours
}

fn faded([a, b]: &[Vec<f32>; 2], lambda: f32) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| a + lambda * (b - a)).collect()
}

/// The values of active texels.
fn active(plane: &[f32], charts: &Charts) -> Vec<f32> {
    plane.iter().zip(&charts.labels).filter(|(_, label)| **label != 0).map(|(value, _)| *value).collect()
}

/// The active texels to the right of each and below it, in the same chart.
struct Neighbours(Vec<[Option<u32>; 2]>);

impl Neighbours {
    fn new(charts: &Charts) -> Self {
        let texels = charts.texels();
        let mut numbers = vec![0; charts.labels.len()];
        (0..).zip(&texels).for_each(|(number, &texel)| numbers[texel as usize] = number);
        let of = |&texel: &u32| {
            let at = texel as usize;
            let right = (!(at + 1).is_multiple_of(charts.width)).then_some(at + 1);
            [right, Some(at + charts.width)].map(|near| {
                near.filter(|&near| charts.labels.get(near) == Some(&charts.labels[at])).map(|near| numbers[near])
            })
        };
        Self(texels.iter().map(of).collect())
    }

    /// How steep `colours` are from texel `k` to those beside it.
    fn steepness(&self, colours: &[f32], k: usize) -> f64 {
        let near = self.0[k].iter().flatten().map(|&near| 3 * near as usize);
        near.map(|near| (0..3).map(|c| f64::from((colours[near + c] - colours[3 * k + c]).abs())).sum::<f64>()).sum()
    }
}

/// Sums over texels of one class.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: f64,
    /// Texels whose slide is known, and their slides.
    slid: f64,
    slide: f64,
    steepness: f64,
    ways: [WaySums; 4],
}

#[derive(Clone, Copy, Debug, Default)]
struct WaySums {
    similarity: f64,
    error: f64,
    steepness: f64,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.slid += other.slid;
        self.slide += other.slide;
        self.steepness += other.steepness;
        for (sum, own) in self.ways.iter_mut().zip(&other.ways) {
            sum.similarity += own.similarity;
            sum.error += own.error;
            sum.steepness += own.steepness;
        }
    }

    fn row(&self, lambda: f32, slides: Option<[f32; 2]>, all: f64) -> Row {
        let ways = self.ways.map(|way| Closeness {
            quality: Quality { ssim: way.similarity / self.count, mse: way.error / (3.0 * self.count) },
            sharpness: way.steepness / self.steepness.max(1e-12),
        });
        Row { lambda, slides, share: self.count / all, slide: self.slide / self.slid.max(1.0), ways }
    }
}

/// By lambda; all texels, then each class.
type Measured = [[Sums; 1 + CLASSES.len()]; LAMBDAS.len()];

fn measure(
    scene: &Scene<'_, impl TextureSource + ?Sized>,
    maker: &Maker<'_, impl TextureSource + ?Sized>,
    neighbours: &Neighbours,
    truth: &dyn Truth,
    pair: [usize; 2],
) -> Result<Option<Measured>, AppearanceError> {
    let charts = &scene.aligned.charts;
    let Some(slides) = truth.slides(pair) else { return Ok(None) };
    let slides = active(&slides, charts);
    let ends = maker.ends(pair)?;
    let mut measured = Measured::default();
    for (sums, &lambda) in measured.iter_mut().zip(&LAMBDAS) {
        let Some(wanted) = truth.between(pair, lambda) else { return Ok(None) };
        let wanted = colours(&wanted, charts);
        let ways = maker.ways(&ends, lambda);
        let similarities = ways.each_ref().map(|way| scene.similarity.of_texels(&wanted, way));
        for (k, &slide) in slides.iter().enumerate() {
            let class = CLASSES.iter().position(|[from, to]| (*from..*to).contains(&slide));
            let steepness = neighbours.steepness(&wanted, k);
            let own = std::array::from_fn(|way| WaySums {
                similarity: f64::from(similarities[way][k]),
                error: (3 * k..3 * k + 3).map(|i| f64::from(ways[way][i] - wanted[i]).powi(2)).sum(),
                steepness: neighbours.steepness(&ways[way], k),
            });
            let known = if slide.is_finite() { slide } else { 0.0 };
            let slid = f64::from(u8::from(slide.is_finite()));
            let own = Sums { count: 1.0, slid, slide: f64::from(known), steepness, ways: own };
            sums[0].add(&own);
            if let Some(class) = class {
                sums[1 + class].add(&own);
            }
        }
    }
    Ok(Some(measured))
}
