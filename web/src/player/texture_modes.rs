//! How the actor looks: modes as they arrive, and the coefficients of a moment.

use bundle::{Appearance, BundleReader, ModeDecoder, Textures};
use synthesis::FrameKind;
use texture::basis::{Layer, Mode};

use super::loading::Recorded;
use super::state::Picture;
use super::{Player, PlayerError};

/// Blocks that are read between two looks at the clock.
const BLOCKS: usize = 64;

/// Modes that have arrived and been read.
#[derive(Debug, Default)]
pub struct TextureModes {
    /// The mean and the modes of colours, then those of warps.
    pub modes: [Vec<Mode>; 2],
    decoder: ModeDecoder,
    /// Section that is being read.
    section: u32,
}

impl TextureModes {
    /// Reads on until `end` says so. True where there is more to read at once.
    fn refine(&mut self, reader: &BundleReader, of: Textures, end: &dyn Fn() -> bool) -> Result<bool, PlayerError> {
        let Some(appearance) = reader.appearance_of(of) else { return Ok(false) };
        while let (Some((layer, _)), Some(bytes)) =
            (appearance.place(self.section), reader.mode_bytes_of(of, self.section))
        {
            if end() {
                return Ok(true);
            }
            let read = self.decoder.advance(bytes, appearance, layer, BLOCKS);
            if read.is_err() {
                // Said once; what has been read stays.
                self.section = u32::MAX;
            }
            if let Some(mode) = read.map_err(|_| PlayerError::DamagedLooks)? {
                self.modes[layer].push(mode);
                self.section += 1;
                if self.section == appearance.section_count() {
                    // What it has learnt is as large as all waves of a mode.
                    self.decoder = ModeDecoder::default();
                }
            }
        }
        Ok(false)
    }
}

impl Player {
    /// Reads modes for about `milliseconds`. True where there is more to read at once.
    ///
    /// # Errors
    /// A mode that is damaged.
    pub fn refine(&mut self, milliseconds: f64) -> Result<bool, PlayerError> {
        let Recorded::Bundle(reader) = &self.loading.source.recorded else { return Ok(false) };
        let (now, start) = (self.now, (self.now)());
        let end = || now() - start > milliseconds;
        for of in [Textures::Aligned, Textures::Naive] {
            if self.looks[of as usize].refine(reader, of, &end)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// What all textures share, once it has arrived.
    #[must_use]
    pub fn appearance(&self, of: Textures) -> Option<&Appearance> {
        match &self.loading.source.recorded {
            Recorded::Bundle(reader) => reader.appearance_of(of),
            Recorded::Memory(_) => None,
        }
    }

    /// Modes that have been read.
    #[must_use]
    pub fn modes(&self, of: Textures) -> &[Vec<Mode>; 2] {
        &self.looks[of as usize].modes
    }
}

/// Source, destination and the destination's weight.
type Side = (u32, u32, f32);

impl Picture<'_> {
    /// The frames before and after the moment as mixtures of two recorded ones. A recorded frame beside a transition is
    /// that transition's beginning or end.
    fn sides(&self) -> [Side; 2] {
        let side = |kind: FrameKind| match kind {
            FrameKind::Synthetic { source_frame, destination_frame, lambda, .. } => {
                (source_frame, destination_frame, lambda)
            }
            FrameKind::Recorded { frame } => (frame, frame, 0.0),
        };
        let [before, after] = [side(self.before.kind), side(self.after.kind)];
        match (self.before.kind.is_synthetic(), self.after.kind.is_synthetic()) {
            (false, true) => [(before.0, after.1, 0.0), after],
            (true, false) => [before, (before.0, after.1, 1.0)],
            _ => [before, after],
        }
    }

    /// Weights of the moment's texture in `layer`: coefficients are interpolated as the shape is.
    #[must_use]
    pub fn weights(&self, layer: &Layer) -> Vec<f32> {
        let [before, after] = self.sides().map(|(from, to, lambda)| layer.weights(from, to, lambda));
        mixed(&before, &after, self.weight as f32)
    }

    /// Weights of the source's and of the destination's texture, and how much the latter counts.
    #[must_use]
    pub fn ends(&self, layer: &Layer) -> ([Vec<f32>; 2], f32) {
        let sides = self.sides();
        let weight = self.weight as f32;
        let of = |frame: u32| layer.weights(frame, frame, 0.0);
        let source = mixed(&of(sides[0].0), &of(sides[1].0), weight);
        let destination = mixed(&of(sides[0].1), &of(sides[1].1), weight);
        ([source, destination], sides[0].2 + (sides[1].2 - sides[0].2) * weight)
    }
}

fn mixed(before: &[f32], after: &[f32], weight: f32) -> Vec<f32> {
    before.iter().zip(after).map(|(a, b)| a + (b - a) * weight).collect()
}
