//! Reading appearance: the head at once, each mode in slices of any length.

use std::rc::Rc;

use super::texels::active;
use super::waves::{Model, Scan, Trace};
use super::{Appearance, Head};
use crate::appearance::basis::{Layer, Mode};
use crate::appearance::mask::{LEVELS, Mask};
use crate::appearance::transform::{AREA, SIDE};
use crate::bundle::entropy::binary::{Decoder, MOST_DECISIONS_PER_BYTE, Paused};
use crate::bundle::entropy::numbers::Number;
use crate::bundle::limits::{MAX_MODES, MAX_TEXTURE_SIDE};

/// Reads the section `appearance` of a capture of `frame_count` frames with `material_count` materials.
pub fn head(bytes: &[u8], frame_count: u32, material_count: usize) -> Result<Appearance, &'static str> {
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
    if decoder.exhausted() || !decoder.at_end() {
        return Err("ends too early or has bytes left over");
    }
    let mask = Mask::new(width, &active);
    let mut layers = [(3, 0), (2, head.warp_level as usize)].into_iter().zip(head.steps).zip(coefficients).map(
        |(((channels, level), steps), coefficients)| Layer {
            channels,
            level,
            blocks: Layer::blocks_of(&mask.levels[level]),
            steps,
            coefficients,
        },
    );
    let (Some(colours), Some(warps)) = (layers.next(), layers.next()) else { return Err("cannot be read") };
    Ok(Appearance { material: head.material, size: head.size, mask: Rc::new(mask), layers: [colours, warps] })
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

/// Reads a mean or a mode, some blocks at a time.
#[derive(Debug)]
pub struct ModeDecoder {
    paused: Option<Paused>,
    scan: Scan,
    models: Vec<Model>,
    traces: Vec<[Trace; 3]>,
    mode: Mode,
}

impl Default for ModeDecoder {
    fn default() -> Self {
        let mode = Mode { offsets: vec![0], entries: Vec::new() };
        Self { paused: None, scan: Scan::default(), models: Vec::new(), traces: Vec::new(), mode }
    }
}

impl ModeDecoder {
    /// Reads at most `most` further blocks of `bytes`, which are the same at each call; the mode once it is complete.
    ///
    /// # Errors
    /// What the bytes do not hold; the decoder is of no use from then on.
    pub fn advance(&mut self, bytes: &[u8], layer: &Layer, most: usize) -> Result<Option<Mode>, &'static str> {
        let mut decoder = match self.paused {
            Some(paused) => Decoder::resume(bytes, paused),
            None => Decoder::new(bytes),
        };
        self.models.resize_with(layer.channels, Model::default);
        for _ in 0..most {
            let Some(block) = layer.blocks.get(self.traces.len()) else { break };
            let near = [block.left, block.above].map(|index| Some(self.traces[index? as usize]));
            let mut traces = [Trace::default(); 3];
            for (channel, model) in self.models.iter_mut().enumerate() {
                let mut waves = [0; AREA];
                let near = near.map(|near| Some(near?[channel]));
                traces[channel] = model.block(&mut decoder, &self.scan, near, &mut waves).ok_or("holds no waves")?;
                for (at, &value) in waves.iter().enumerate().filter(|(_, value)| **value != 0) {
                    let value = i16::try_from(value).map_err(|_| "holds a wave out of range")?;
                    self.mode.entries.push((channel * AREA + at) as u32 | (value as u32) << 16);
                }
            }
            self.traces.push(traces);
            self.mode.offsets.push(self.mode.entries.len() as u32);
            if decoder.exhausted() {
                return Err("ends too early");
            }
        }
        if self.traces.len() < layer.blocks.len() {
            self.paused = Some(decoder.pause());
            return Ok(None);
        }
        if decoder.exhausted() || !decoder.at_end() {
            return Err("ends too early or has bytes left over");
        }
        Ok(Some(std::mem::take(&mut self.mode)))
    }
}
