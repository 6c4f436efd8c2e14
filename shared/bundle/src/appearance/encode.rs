//! Writing appearance: each mode's waves in steps that spread the error evenly over a frame's texture.
//!
//! A mode's error reaches the texture times its coefficient, so its step is the common step divided by the root mean
//! square of its coefficients: bits go where the variance is, and what is never seen costs next to nothing. Over the texture,
//! steps follow how much an error lowers structural similarity: they are larger where there is much to see.

use serde::{Deserialize, Serialize};

use super::mixed::Learnt;
use super::texels::active as code_active;
use super::{Head, expected, place, scale};
use crate::entropy::binary::Encoder;
use crate::entropy::numbers::Number;
use crate::error::EncodeError;
use crate::limits::{MAX_MODES, MAX_TEXTURE_SIDE};
use texture::TextureModel;
use texture::basis::{Block, CHROMA, Layer};
use texture::dealign::{Between, Field};
use texture::mask::{ACTIVE, LEVELS, Level, Mask};
use texture::quality::Similarity;
use texture::transform::{AREA, OPPONENT, SIDE, cosines, forward, inverse};

/// Classes of steps that are used.
const CLASSES: (i32, i32) = (-4, 12);

/// How finely appearance is stored.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AppearanceQuality {
    /// Step of colours, 1 being the range of a channel: that of blocks where errors count as much as in the mean over blocks.
    pub texture_step: f32,
    /// Step of warps, in texels.
    pub warp_step: f32,
    /// Warps are stored 2^warp_level times smaller than textures.
    pub warp_level: u32,
    /// Both steps grow until all sections together have no more bytes than this.
    pub most_bytes: Option<u64>,
}

impl Default for AppearanceQuality {
    fn default() -> Self {
        Self { texture_step: 0.012, warp_step: 0.12, warp_level: 2, most_bytes: None }
    }
}

/// What is written besides the capture.
#[derive(Clone, Copy, Debug)]
pub struct AppearanceInput<'a> {
    /// The models, with coefficients for every frame of the capture.
    pub model: &'a TextureModel,
    /// Index of the material that they paint.
    pub material: u32,
    /// How finely they are stored.
    pub quality: AppearanceQuality,
}

/// What became of appearance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AppearanceReport {
    /// Bytes of all its sections.
    pub bytes: u64,
    /// The same per frame of the capture.
    pub bytes_per_frame: f64,
    /// Step of colours that was used in the end.
    pub texture_step: f32,
    /// Root mean square error that storing adds to an aligned texture, 1 being the range of a channel.
    pub texture_error: f64,
    /// Root mean square error that storing adds to a warp, in texels.
    pub warp_error: f64,
}

/// The section `appearance`, and those of its modes in order.
pub struct Sections {
    pub head: Vec<u8>,
    pub modes: Vec<Vec<u8>>,
    pub report: AppearanceReport,
}

/// Codes the models of `input` for a capture of `frame_count` frames.
pub fn encode(input: &AppearanceInput, frame_count: u32, material_count: usize) -> Result<Sections, EncodeError> {
    check(input, frame_count, material_count)?;
    let mut quality = input.quality;
    for attempt in 0.. {
        let sections = encode_once(input.model, input.material, &quality, frame_count)?;
        let most = quality.most_bytes.unwrap_or(u64::MAX);
        if sections.report.bytes <= most || attempt == 12 {
            return Ok(sections);
        }
        // Bytes shrink a little slower than steps grow.
        let growth = (sections.report.bytes as f32 / most.max(1) as f32).powf(1.1).clamp(1.02, 4.0);
        quality.texture_step *= growth;
        quality.warp_step *= growth;
    }
    Err(EncodeError::Inconsistent("the appearance does not fit into its bytes".into()))
}

fn check(input: &AppearanceInput, frame_count: u32, material_count: usize) -> Result<(), EncodeError> {
    let (model, quality) = (input.model, &input.quality);
    let wrong = |what: &str| Err(EncodeError::Inconsistent(format!("the appearance {what}")));
    let (count, frames) = (model.active_count(), frame_count as usize);
    let lengths = |mean: &[f32], modes: &[Vec<f32>], coefficients: &[f32], channels: usize| {
        mean.len() == channels * count
            && modes.iter().all(|mode| mode.len() == channels * count)
            && coefficients.len() == frames * modes.len()
    };
    let side = |side: u32| (1..=MAX_TEXTURE_SIDE).contains(&side);
    if !side(model.width) || !side(model.height) || model.active.len() != (model.width * model.height) as usize {
        return wrong("has another size than its texels, or one out of range");
    }
    if !lengths(&model.mean_texture, &model.textures, &model.texture_coefficients, 3)
        || !lengths(&model.mean_warp, &model.warps, &model.warp_coefficients, 2)
    {
        return wrong("has modes or coefficients of another length than its texels and the capture's frames say");
    }
    if input.material as usize >= material_count || quality.warp_level as usize >= LEVELS {
        return wrong("paints a material that does not exist, or stores warps too small");
    }
    let largest = model.textures.len().max(model.warps.len());
    if largest > MAX_MODES as usize {
        return Err(EncodeError::TooLarge { what: "modes", count: largest as u64, limit: u64::from(MAX_MODES) });
    }
    let numbers = [&model.mean_texture, &model.mean_warp, &model.texture_coefficients, &model.warp_coefficients];
    let mut all = numbers.into_iter().chain(&model.textures).chain(&model.warps).flatten();
    if !(all.all(|value| value.is_finite()) && quality.texture_step > 1e-4 && quality.warp_step > 1e-4) {
        return wrong("has a number that is not finite, or steps that are too small");
    }
    Ok(())
}

fn encode_once(
    model: &TextureModel,
    material: u32,
    quality: &AppearanceQuality,
    frame_count: u32,
) -> Result<Sections, EncodeError> {
    let (width, height) = (model.width as usize, model.height as usize);
    let mask = Mask::new(width, &model.active);
    let count = model.active_count().max(1) as f32;
    let warp_level = quality.warp_level as usize;
    let classes = coarseness(model, &mask);
    let (mut colours, colour_error) = LayerCoder::new(&mask, 3, 0, &classes).encode(
        &model.mean_texture,
        &model.textures,
        &model.texture_coefficients,
        quality.texture_step,
    );
    let (mut warps, warp_error) = LayerCoder::new(&mask, 2, warp_level, &[]).encode(
        &model.mean_warp,
        &model.warps,
        &model.warp_coefficients,
        quality.warp_step,
    );
    // A mode of unit length changes a texel by 1 / sqrt(values): a 32nd of a step on the whole texture is not seen.
    let coefficient_steps =
        [quality.texture_step * (3.0 * count).sqrt() / 32.0, quality.warp_step * (2.0 * count).sqrt() / 32.0];
    let head = Head {
        material,
        size: [model.width, model.height],
        warp_level: quality.warp_level,
        steps: [colours.steps, warps.steps],
        coefficient_steps,
    };
    let mut bytes = postcard::to_stdvec(&head).map_err(|error| EncodeError::Inconsistent(error.to_string()))?;
    let mut encoder = Encoder::default();
    code_active(&mut encoder, (width, height), &model.active);
    for (coefficients, modes, step) in [
        (&model.texture_coefficients, model.textures.len(), coefficient_steps[0]),
        (&model.warp_coefficients, model.warps.len(), coefficient_steps[1]),
    ] {
        encode_coefficients(&mut encoder, coefficients, modes, step);
    }
    encode_classes(&mut encoder, &classes, &Layer::blocks_of(mask.full()));
    bytes.extend(encoder.finish());
    let counts = [model.textures.len(), model.warps.len()];
    let mut layers = [&mut colours.modes, &mut warps.modes];
    let modes: Vec<Vec<u8>> = (0..)
        .map_while(|ordinal| place(counts, ordinal))
        .map(|(layer, mode)| layers[layer].get_mut(mode).map(std::mem::take).unwrap_or_default())
        .collect();
    let total = (bytes.len() + modes.iter().map(Vec::len).sum::<usize>()) as u64;
    let report = AppearanceReport {
        bytes: total,
        bytes_per_frame: total as f64 / f64::from(frame_count.max(1)),
        texture_step: quality.texture_step,
        texture_error: colour_error,
        warp_error,
    };
    Ok(Sections { head: bytes, modes, report })
}

fn encode_coefficients(encoder: &mut Encoder, coefficients: &[f32], modes: usize, step: f32) {
    let mut models = vec![Number::default(); modes];
    let mut before = vec![0_i32; modes];
    for frame in coefficients.chunks_exact(modes.max(1)) {
        for mode in 0..modes {
            let value = (frame[mode] / step).round().clamp(-1e9, 1e9) as i32;
            models[mode].encode_signed(encoder, value - before[mode]);
            before[mode] = value;
        }
    }
}

fn encode_classes(encoder: &mut Encoder, classes: &[i32], blocks: &[Block]) {
    let mut model = Number::default();
    for (index, block) in blocks.iter().enumerate() {
        model.encode_signed(encoder, classes[index] - expected(&classes[..index], block));
    }
}

/// Classes of the steps of the colours' blocks: errors count as much in all of them. Where there is much to see they are hard
/// to see, and steps may be larger.
fn coarseness(model: &TextureModel, mask: &Mask) -> Vec<i32> {
    let full = mask.full();
    let texels = (0..full.flags.len()).filter(|&at| full.flags[at] & ACTIVE != 0);
    let counts = Similarity::new(model.width, &model.active).sensitivity(&model.mean_texture);
    let blocks = Layer::blocks_of(full);
    let wide = full.width.div_ceil(SIDE);
    let mut sums = vec![0.0_f64; wide * full.height.div_ceil(SIDE)];
    for (at, count) in texels.zip(counts) {
        sums[at / full.width / SIDE * wide + at % full.width / SIDE] += f64::from(count);
    }
    let own: Vec<f64> = blocks.iter().map(|block| sums[usize::from(block.y) * wide + usize::from(block.x)]).collect();
    let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
    let class =
        |sum: &f64| ((-2.0 * (sum / mean.max(1e-12)).max(1e-6).log2()).round() as i32).clamp(CLASSES.0, CLASSES.1);
    own.iter().map(class).collect()
}

/// A coded layer: the step and the bytes of its mean and of each mode.
struct CodedLayer {
    steps: Vec<f32>,
    modes: Vec<Vec<u8>>,
}

/// What coding the modes of a layer has in common.
struct LayerCoder<'a> {
    mask: &'a Mask,
    layer: Layer,
    /// Positions of active texels at full size.
    texels: Vec<usize>,
    /// For texels of stored blocks at the layer's size, the nearest active one.
    nearest: Vec<u32>,
    table: [f32; AREA],
}

impl<'a> LayerCoder<'a> {
    fn new(mask: &'a Mask, channels: usize, level: usize, classes: &[i32]) -> Self {
        let own = &mask.levels[level];
        let blocks = Layer::blocks_of(own);
        let texels = (0..mask.full().flags.len()).filter(|&at| mask.full().flags[at] & ACTIVE != 0).collect();
        let scales = (0..blocks.len()).map(|index| scale(classes.get(index).copied().unwrap_or(0))).collect();
        let layer = Layer { channels, level, blocks, steps: Vec::new(), scales, coefficients: Vec::new() };
        Self { mask, layer, texels, nearest: nearest_active(own), table: cosines(SIDE) }
    }

    /// Codes a mean and its modes; the root mean square error over texels and frames.
    fn encode(&self, mean: &[f32], modes: &[Vec<f32>], coefficients: &[f32], step: f32) -> (CodedLayer, f64) {
        let frames = coefficients.len().checked_div(modes.len()).unwrap_or(0);
        let squares = |mode: usize| -> f64 {
            let of = (0..frames).map(|frame| f64::from(coefficients[frame * modes.len() + mode]).powi(2));
            of.sum::<f64>() / frames.max(1) as f64
        };
        let mut coded = CodedLayer { steps: Vec::new(), modes: Vec::new() };
        let (mut error, mut learnt) = (0.0, Learnt::new(self.layer.channels));
        for (index, mode) in std::iter::once(mean).chain(modes.iter().map(Vec::as_slice)).enumerate() {
            let square = if index == 0 { 1.0 } else { squares(index - 1) };
            let own = (f64::from(step) / square.sqrt().max(1e-6)) as f32;
            let (bytes, lost) = self.mode(mode, own, &mut learnt);
            error += lost * square;
            coded.steps.push(own);
            coded.modes.push(bytes);
        }
        (coded, (error / mean.len().max(1) as f64).sqrt())
    }

    /// Codes a mode with this step; the sum of squares of what is lost.
    fn mode(&self, mode: &[f32], step: f32, learnt: &mut Learnt) -> (Vec<u8>, f64) {
        let field = self.field(mode);
        let level = &self.mask.levels[self.layer.level];
        let channels = self.layer.channels;
        let mut restored = Field { texels: vec![[0.0; 4]; field.len()], width: level.width, height: level.height };
        let mut encoder = Encoder::default();
        for (index, block) in self.layer.blocks.iter().enumerate() {
            let step = step * self.layer.scales[index];
            let corner = [usize::from(block.x) * SIDE, usize::from(block.y) * SIDE];
            let mut planes = self.block(&field, corner);
            if channels == 3 {
                turn(&mut planes, |row, column| OPPONENT[row][column]);
            }
            for channel in 0..channels {
                let step = if channels == 3 && channel > 0 { step * CHROMA } else { step };
                let mut waves = quantise(&forward(&self.table, &planes[channel]), step);
                planes[channel] = inverse(&self.table, &waves.map(|wave| wave as f32 * step));
                // What is written is never out of range: it was limited when it was quantised.
                let _ = learnt.block(&mut encoder, (index, block), channel, &mut waves);
            }
            if channels == 3 {
                turn(&mut planes, |row, column| OPPONENT[column][row]);
            }
            for at in 0..AREA {
                let (x, y) = (corner[0] + at % SIDE, corner[1] + at / SIDE);
                if x < level.width && y < level.height {
                    let known = f32::from(level.flags[y * level.width + x] & ACTIVE);
                    restored.texels[y * level.width + x] = [planes[0][at], planes[1][at], planes[2][at], known];
                }
            }
        }
        learnt.end_mode();
        (encoder.finish(), self.lost(mode, &restored))
    }

    /// `mode` at the layer's size: means over active texels.
    fn field(&self, mode: &[f32]) -> Vec<[f32; 4]> {
        let (full, level) = (self.mask.full(), &self.mask.levels[self.layer.level]);
        let mut field = vec![[0.0; 4]; level.width * level.height];
        for (&at, values) in self.texels.iter().zip(mode.chunks_exact(self.layer.channels)) {
            let (x, y) = ((at % full.width) >> self.layer.level, (at / full.width) >> self.layer.level);
            let cell = &mut field[y * level.width + x];
            for (sum, value) in cell.iter_mut().zip(values) {
                *sum += value;
            }
            cell[3] += 1.0;
        }
        for cell in &mut field {
            *cell = cell.map(|sum| sum / cell[3].max(1.0));
        }
        field
    }

    /// A block of `field`, by channel. What is not active continues what is, smoothly, so that it costs few waves.
    fn block(&self, field: &[[f32; 4]], corner: [usize; 2]) -> [[f32; AREA]; 3] {
        let level = &self.mask.levels[self.layer.level];
        let mut planes = [[0.0; AREA]; 3];
        let mut free = Vec::new();
        for at in 0..AREA {
            let (x, y) = ((corner[0] + at % SIDE).min(level.width - 1), (corner[1] + at / SIDE).min(level.height - 1));
            let own = y * level.width + x;
            for channel in 0..3 {
                planes[channel][at] = field[self.nearest[own] as usize][channel];
            }
            let inside = corner[0] + at % SIDE < level.width && corner[1] + at / SIDE < level.height;
            if !inside || level.flags[own] & ACTIVE == 0 {
                free.push(at);
            }
        }
        for _ in 0..12 {
            for &at in &free {
                let (x, y) = (at % SIDE, at / SIDE);
                let around = [
                    (x > 0).then(|| at - 1),
                    (x + 1 < SIDE).then(|| at + 1),
                    (y > 0).then(|| at - SIDE),
                    (y + 1 < SIDE).then(|| at + SIDE),
                ];
                let count = around.iter().flatten().count() as f32;
                for plane in &mut planes {
                    plane[at] = around.iter().flatten().map(|&other| plane[other]).sum::<f32>() / count;
                }
            }
        }
        planes
    }

    /// Sum of squares of the difference between `mode` and what is `restored`, at full size.
    fn lost(&self, mode: &[f32], restored: &Field) -> f64 {
        let (full, cell) = (self.mask.full(), (1 << self.layer.level) as f32);
        let between = |texel: usize| Between::at((texel as f32 + 0.5) / cell - 0.5);
        let columns: Vec<Between> = (0..full.width).map(between).collect();
        let rows: Vec<Between> = (0..full.height).map(between).collect();
        let mut sum = 0.0;
        for (&at, values) in self.texels.iter().zip(mode.chunks_exact(self.layer.channels)) {
            let found = restored.sample_between(columns[at % full.width], rows[at / full.width]).unwrap_or_default();
            sum += values.iter().zip(found).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
        }
        sum
    }
}

/// `planes` times a matrix.
fn turn(planes: &mut [[f32; AREA]; 3], matrix: impl Fn(usize, usize) -> f32) {
    for at in 0..AREA {
        let old = [planes[0][at], planes[1][at], planes[2][at]];
        for (row, plane) in planes.iter_mut().enumerate() {
            plane[at] = (0..3).map(|column| matrix(row, column) * old[column]).sum();
        }
    }
}

/// Whole steps. All but the constant wave are rounded towards zero a little, fast waves more than slow ones: at equal bytes
/// that keeps more of the structure than finer steps would.
fn quantise(waves: &[f32; AREA], step: f32) -> [i32; AREA] {
    std::array::from_fn(|at| {
        let steps = waves[at] / step;
        let rounding = if at == 0 { 0.5 } else { 0.34 - 0.004 * (at % SIDE + at / SIDE) as f32 };
        ((steps.abs() + rounding).floor().min(32767.0) as i32) * if steps < 0.0 { -1 } else { 1 }
    })
}

/// For every texel the index of an active one nearby: by steps to neighbours, outwards from the active ones.
fn nearest_active(level: &Level) -> Vec<u32> {
    let mut nearest: Vec<Option<u32>> =
        (0..level.flags.len()).map(|at| (level.flags[at] & ACTIVE != 0).then_some(at as u32)).collect();
    let mut front: Vec<usize> = (0..nearest.len()).filter(|&at| nearest[at].is_some()).collect();
    while !front.is_empty() {
        let mut next = Vec::new();
        for at in front {
            let (x, y) = (at % level.width, at / level.width);
            let around = [
                (x > 0).then(|| at - 1),
                (x + 1 < level.width).then(|| at + 1),
                (y > 0).then(|| at - level.width),
                (y + 1 < level.height).then(|| at + level.width),
            ];
            for other in around.into_iter().flatten() {
                if nearest[other].is_none() {
                    nearest[other] = nearest[at];
                    next.push(other);
                }
            }
        }
        front = next;
    }
    nearest.into_iter().map(|nearest| nearest.unwrap_or(0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entropy::binary::Decoder;

    #[test]
    fn steps_are_larger_where_there_is_much_to_see() {
        let (width, height) = (64, 32);
        let value = |at: usize| if at % width < 32 { 0.5 } else { (at % 2) as f32 };
        let model = TextureModel {
            width: width as u32,
            height: height as u32,
            active: vec![true; width * height],
            mean_texture: (0..width * height).flat_map(|at| [value(at); 3]).collect(),
            mean_warp: vec![0.0; 2 * width * height],
            ..TextureModel::default()
        };
        let mask = Mask::new(width, &model.active);
        let classes = coarseness(&model, &mask);
        assert_eq!(classes, [classes[0], classes[0], CLASSES.1, CLASSES.1].repeat(2));
        assert!(classes[0] < 0);
        let mut encoder = Encoder::default();
        let blocks = Layer::blocks_of(mask.full());
        encode_classes(&mut encoder, &classes, &blocks);
        let bytes = encoder.finish();
        let read = super::super::decode::scales(&mut Decoder::new(&bytes), &blocks);
        assert_eq!(read, classes.iter().map(|&class| scale(class)).collect::<Vec<_>>());
        assert_eq!([-8, 0, 2, 4].map(scale), [0.25, 1.0, std::f32::consts::SQRT_2, 2.0]);
    }
}
