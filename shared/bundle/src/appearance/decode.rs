//! Reading appearance: the head at once, each mode in slices of any length.

use std::rc::Rc;

use super::mixed::Learnt;
use super::texels::active;
use super::waves::{Model, Scan, Trace, Waves};
use super::{Appearance, COARSENESS, Coding, Head, expected, scale};
use crate::entropy::binary::{Decoder, MOST_DECISIONS_PER_BYTE, Paused};
use crate::entropy::numbers::Number;
use crate::limits::{MAX_MODES, MAX_TEXTURE_SIDE};
use texture::basis::{Block, Layer, Mode};
use texture::mask::{LEVELS, Mask};
use texture::transform::{AREA, SIDE};

/// Reads the section `appearance` of a capture of `frame_count` frames with `material_count` materials.
pub fn head(bytes: &[u8], coding: Coding, frame_count: u32, material_count: usize) -> Result<Appearance, &'static str> {
    let (head, coded) = postcard::take_from_bytes::<Head>(bytes).map_err(|_| "cannot be read")?;
    check(&head, material_count)?;
    let [width, height] = head.size.map(|side| side as usize);
    let modes: usize = head.steps.iter().map(|steps| steps.len() - 1).sum();
    let elements = width.div_ceil(SIDE) * height.div_ceil(SIDE) + modes * frame_count as usize;
    if elements > coded.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err("cannot hold as many texels or frames as it declares");
    }
    let mut decoder = Decoder::new(coded);
    let active = active(&mut decoder, (width, height), &[]);
    let coefficients = [0, 1].map(|layer| {
        let count = head.steps[layer].len() - 1;
        coefficients(&mut decoder, count, frame_count as usize, head.coefficient_steps[layer])
    });
    let mask = Mask::new(width, &active);
    let mut layers = [(3, 0), (2, head.warp_level as usize)].into_iter().zip(head.steps).zip(coefficients).map(
        |(((channels, level), steps), coefficients)| {
            let blocks = Layer::blocks_of(&mask.levels[level]);
            let scales = match (coding, channels) {
                (Coding::Mixed, 3) => scales(&mut decoder, &blocks),
                _ => vec![1.0; blocks.len()],
            };
            Layer { channels, level, blocks, steps, scales, coefficients }
        },
    );
    let (Some(colours), Some(warps)) = (layers.next(), layers.next()) else { return Err("cannot be read") };
    drop(layers);
    if decoder.exhausted() || !decoder.at_end() {
        return Err("ends too early or has bytes left over");
    }
    let layers = [colours, warps];
    Ok(Appearance { material: head.material, size: head.size, mask: Rc::new(mask), layers, coding })
}

fn check(head: &Head, material_count: usize) -> Result<(), &'static str> {
    let within = |side: &u32| (1..=MAX_TEXTURE_SIDE).contains(side);
    let steps = head.steps.iter().flatten().chain(&head.coefficient_steps);
    let holds = head.size.iter().all(within)
        && head.steps.iter().all(|steps| (1..=MAX_MODES as usize + 1).contains(&steps.len()))
        && (head.warp_level as usize) < LEVELS
        && steps.into_iter().all(|step| step.is_finite() && *step > 0.0);
    if !holds {
        return Err("has a number out of range");
    }
    if head.material as usize >= material_count { Err("paints a material that does not exist") } else { Ok(()) }
}

/// How much larger the steps of each block are.
pub(super) fn scales(decoder: &mut Decoder, blocks: &[Block]) -> Vec<f32> {
    let (mut model, mut classes) = (Number::default(), Vec::new());
    for block in blocks {
        let expected = expected(&classes, block);
        classes.push(expected.wrapping_add(model.decode_signed(decoder)).clamp(COARSENESS.0, COARSENESS.1));
    }
    classes.into_iter().map(scale).collect()
}

/// Each mode's coefficients as differences from the frame before.
fn coefficients(decoder: &mut Decoder, modes: usize, frames: usize, step: f32) -> Vec<f32> {
    let mut models = vec![Number::default(); modes];
    let mut now = vec![0_i32; modes];
    let mut all = Vec::new();
    for _ in 0..frames {
        for (value, model) in now.iter_mut().zip(&mut models) {
            *value = value.wrapping_add(model.decode_signed(decoder));
            all.push(*value as f32 * step);
        }
        if decoder.exhausted() {
            break;
        }
    }
    all
}

/// Reads the mean and the modes of both layers, each after those before it, some blocks at a time.
#[derive(Debug)]
pub struct ModeDecoder {
    paused: Option<Paused>,
    mode: Mode,
    /// What has been learnt of colours and of warps.
    learnt: [Option<Learnt>; 2],
    /// What a mode that is coded alone has learnt so far.
    alone: Alone,
}

#[derive(Debug, Default)]
struct Alone {
    scan: Scan,
    models: Vec<Model>,
    traces: Vec<[Trace; 3]>,
}

impl Default for ModeDecoder {
    fn default() -> Self {
        Self { paused: None, mode: empty(), learnt: [None, None], alone: Alone::default() }
    }
}

fn empty() -> Mode {
    Mode { offsets: vec![0], entries: Vec::new() }
}

impl ModeDecoder {
    /// Reads at most `most` further blocks of `bytes`, which are the same at each call, of the layer with the number `layer`;
    /// the mode once it is complete.
    ///
    /// # Errors
    /// What the bytes do not hold; the decoder is of no use from then on.
    pub fn advance(
        &mut self,
        bytes: &[u8],
        appearance: &Appearance,
        layer: usize,
        most: usize,
    ) -> Result<Option<Mode>, &'static str> {
        let (own, learnt) = (&appearance.layers[layer], &mut self.learnt[layer]);
        let mut decoder = match self.paused.take() {
            Some(paused) => Decoder::resume(bytes, paused),
            None => Decoder::new(bytes),
        };
        let mut coder = match appearance.coding {
            Coding::Alone => Either::Alone(&mut self.alone),
            Coding::Mixed => Either::Mixed(learnt.get_or_insert_with(|| Learnt::new(own.channels))),
        };
        for _ in 0..most {
            let index = self.mode.offsets.len() - 1;
            let Some(block) = own.blocks.get(index) else { break };
            for channel in 0..own.channels {
                let mut waves = [0; AREA];
                coder.block(&mut decoder, (index, block), channel, &mut waves).ok_or("holds no waves")?;
                for (at, &value) in waves.iter().enumerate().filter(|(_, value)| **value != 0) {
                    let value = i16::try_from(value).map_err(|_| "holds a wave out of range")?;
                    self.mode.entries.push((channel * AREA + at) as u32 | (value as u32) << 16);
                }
            }
            self.mode.offsets.push(self.mode.entries.len() as u32);
            if decoder.exhausted() {
                return Err("ends too early");
            }
        }
        if self.mode.offsets.len() <= own.blocks.len() {
            self.paused = Some(decoder.pause());
            return Ok(None);
        }
        if decoder.exhausted() || !decoder.at_end() {
            return Err("ends too early or has bytes left over");
        }
        coder.end_mode();
        Ok(Some(std::mem::replace(&mut self.mode, empty())))
    }
}

/// How a mode is coded, with what is known for it.
enum Either<'a> {
    Alone(&'a mut Alone),
    Mixed(&'a mut Learnt),
}

impl Either<'_> {
    fn block(
        &mut self,
        decoder: &mut Decoder,
        (index, block): (usize, &Block),
        channel: usize,
        waves: &mut Waves,
    ) -> Option<()> {
        let alone = match self {
            Self::Mixed(learnt) => return learnt.block(decoder, (index, block), channel, waves),
            Self::Alone(alone) => alone,
        };
        alone.models.resize_with(alone.models.len().max(channel + 1), Model::default);
        alone.traces.resize(alone.traces.len().max(index + 1), [Trace::default(); 3]);
        let near = [block.left, block.above].map(|other| Some(alone.traces[other? as usize][channel]));
        alone.traces[index][channel] = alone.models[channel].block(decoder, &alone.scan, near, waves)?;
        Some(())
    }

    fn end_mode(&mut self) {
        match self {
            Self::Mixed(learnt) => learnt.end_mode(),
            Self::Alone(alone) => **alone = Alone::default(),
        }
    }
}
