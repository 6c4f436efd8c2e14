//! Entropy coding of a layer's waves since 1.3: guessed from slower waves of the same block, from the blocks to the left and
//! above, from the channel before, and from how large the same wave was in the modes before. Both ways in one function, so
//! that they cannot differ.

use super::waves::{Scan, Waves};
use crate::entropy::mixing::{Decider, mixed};
use kernels::codec::mixing::Mixer;
use kernels::codec::zigzag::{unzigzag, zigzag};
use texture::basis::Block;
use texture::transform::{AREA, SIDE};

/// Classes of sizes by [`class`].
const CLASSES: usize = 13;
/// Bounds of the classes, in 1/16.
const BOUNDS: [u32; CLASSES - 1] = [0, 2, 6, 13, 21, 32, 48, 72, 112, 176, 288, 480];
/// Classes of waves by how fast they are.
const SPEEDS: usize = 7;
/// Sizes count up to this much in what is remembered.
const MOST_REMEMBERED: u32 = 15;
/// Steps of a size that are guessed; more are coded as a number.
const STEPS: u32 = 20;
/// Longest number of a constant wave.
const LONGEST: u32 = 24;
/// A row of a block with a border of two, so that looking back needs no test.
const WIDE: usize = SIDE + 2;

/// What has been learnt of the waves of a layer, from the mean on; modes follow each other.
#[derive(Clone, Debug)]
pub struct Learnt {
    channels: usize,
    scan: Scan,
    class: [u8; 512],
    /// Modes that are behind.
    modes: usize,
    /// Whether a wave is not zero.
    present: Mixer,
    /// Whether a size is larger yet.
    larger: Mixer,
    /// Bits of how far waves reach.
    reach: Mixer,
    /// Lengths of constant waves.
    constant: Mixer,
    /// Sizes of all waves in the modes before, decaying, in 1/16.
    before: Vec<u8>,
    /// The same of how far waves reach.
    reach_before: Vec<u16>,
    /// Sizes of the mode's waves.
    now: Vec<u8>,
    /// Constant waves and reaches of the mode, by block and channel.
    traces: Vec<(i32, u8)>,
}

impl Learnt {
    /// Nothing yet, for a layer with so many channels. What is remembered grows with what has been read.
    #[must_use]
    pub fn new(channels: usize) -> Self {
        let class = std::array::from_fn(|value| BOUNDS.iter().filter(|&&bound| value as u32 > bound).count() as u8);
        Self {
            channels,
            scan: Scan::default(),
            class,
            modes: 0,
            present: Mixer::new(
                &[
                    SPEEDS * CLASSES * 2,
                    AREA * 8 * 3,
                    CLASSES * CLASSES * 4,
                    CLASSES * 8 * 4 * 3,
                    CLASSES * CLASSES * 3,
                    CLASSES * SPEEDS * 3,
                ],
                SPEEDS * 3,
            ),
            larger: Mixer::new(
                &[CLASSES * 8 * 2, CLASSES * 8 * 8, CLASSES * 8 * 3, 64 * 8, CLASSES * SPEEDS * 8],
                8 * 3,
            ),
            reach: Mixer::new(&[9 * AREA, 9 * AREA, 9 * AREA, 9 * AREA, 64 * AREA], AREA),
            constant: Mixer::new(&[CLASSES * 32, CLASSES * 32, 64 * 32, CLASSES * 32], 32),
            before: Vec::new(),
            reach_before: Vec::new(),
            now: Vec::new(),
            traces: Vec::new(),
        }
    }

    /// The mode ends; the next one begins.
    pub fn end_mode(&mut self) {
        let first = self.modes == 0;
        for (before, now) in self.before.iter_mut().zip(&mut self.now) {
            let size = u32::from(*now).min(MOST_REMEMBERED) as i32 * 16;
            // The mean says less of a mode than other modes do.
            let moved = if first { size / 4 } else { i32::from(*before) + (((size - i32::from(*before)) * 5) >> 5) };
            *before = moved as u8;
            *now = 0;
        }
        self.modes += 1;
    }

    fn class(&self, sixteenths: u32) -> usize {
        usize::from(self.class[sixteenths.min(511) as usize])
    }

    /// Codes a channel of a block, which is the layer's `index`-th: `waves` are written, or all zero and filled in.
    pub fn block(
        &mut self,
        coder: &mut impl Decider,
        (index, block): (usize, &Block),
        channel: usize,
        waves: &mut Waves,
    ) -> Option<()> {
        let own = index * self.channels + channel;
        if self.traces.len() <= own {
            self.traces.resize(own + 1, (0, 0));
            self.reach_before.resize(own + 1, 0);
            self.before.resize((own + 1) * AREA, 0);
            self.now.resize((own + 1) * AREA, 0);
        }
        let near = [block.left, block.above].map(|other| Some(other? as usize * self.channels + channel));
        let [left, above] = near.map(|near| near.map(|near| self.traces[near]));
        let ends = [left.or(above), above.or(left)].map(Option::unwrap_or_default);
        self.constant_wave(coder, own, ends.map(|(constant, _)| constant), &mut waves[0]);
        let last = self.scan.order.iter().rposition(|&(at, _)| at > 0 && waves[usize::from(at)] != 0).unwrap_or(0);
        let reach = self.reach(coder, own, channel, ends.map(|(_, reach)| u32::from(reach)), last);
        self.traces[own] = (waves[0], reach as u8);
        let mut sizes = [0_u8; WIDE * WIDE];
        for index in 1..=reach {
            let (at, speed) = self.scan.order[index];
            let (at, speed) = (usize::from(at), usize::from(speed));
            let place = self.place(own, near, channel, (at, speed), &sizes, reach - index);
            if index < reach && !self.present(coder, &place, waves[at] != 0) {
                continue;
            }
            let size = self.size(coder, &place, waves[at].unsigned_abs())?;
            let negative = coder.toss(waves[at] < 0);
            waves[at] = if negative { -(size as i32) } else { size as i32 };
            sizes[inside(at)] = size.min(MOST_REMEMBERED) as u8;
            self.now[own * AREA + at] = size.min(MOST_REMEMBERED) as u8;
        }
        self.now[own * AREA] = waves[0].unsigned_abs().min(MOST_REMEMBERED) as u8;
        Some(())
    }

    fn constant_wave(&mut self, coder: &mut impl Decider, own: usize, near: [i32; 2], wave: &mut i32) {
        let expected = near[0].wrapping_add(near[1]) / 2;
        let apart = near[0].wrapping_sub(near[1]).unsigned_abs();
        let at = own * AREA;
        let (same, beside) =
            (u32::from(self.before[at]), u32::from(self.before[at + 1]) + u32::from(self.before[at + SIDE]));
        let classes = [self.class(apart.min(60) * 8), self.class(same), self.modes.min(63), self.class(beside)];
        let shifted = zigzag(wave.wrapping_sub(expected)).wrapping_add(1);
        let wanted = shifted.checked_ilog2().unwrap_or(LONGEST).min(LONGEST);
        let mut length = 0;
        while length < LONGEST {
            let contexts = classes.map(|class| class * 32 + length as usize);
            if !mixed(&mut self.constant, coder, &contexts, length as usize, length < wanted) {
                break;
            }
            length += 1;
        }
        let low = (0..length).rev().fold(0, |low, bit| low << 1 | u32::from(coder.toss(shifted >> bit & 1 == 1)));
        *wave = expected.wrapping_add(unzigzag((1 << length | low) - 1));
    }

    /// How far along the scan the last wave lies that is not zero.
    fn reach(&mut self, coder: &mut impl Decider, own: usize, channel: usize, near: [u32; 2], last: usize) -> usize {
        let near = (near[0] + near[1]) / 2;
        let before = u32::from(self.reach_before[own]) >> 4;
        let beside = if channel > 0 { u32::from(self.traces[own - channel].1) } else { 0 };
        let class = |value: u32| (value + 1).ilog2().min(8) as usize;
        let classes = [class(near), class(before), class(beside), class((near + before) / 2), self.modes.min(63)];
        let mut node = 1;
        for bit in (0..8).rev() {
            let contexts = classes.map(|class| class * AREA + node);
            node = node << 1 | usize::from(mixed(&mut self.reach, coder, &contexts, node, last >> bit & 1 == 1));
        }
        let reach = node - AREA;
        let before = i32::from(self.reach_before[own]);
        self.reach_before[own] = (before + (((reach as i32 * 16 - before) * 13) >> 5)) as u16;
        reach
    }

    /// What is known around a wave.
    fn place(
        &self,
        own: usize,
        near: [Option<usize>; 2],
        channel: usize,
        (at, speed): (usize, usize),
        sizes: &[u8; WIDE * WIDE],
        rest: usize,
    ) -> Place {
        let back = |steps: usize| u32::from(sizes[inside(at) - steps]);
        let slower = 13 * (back(1) + back(WIDE)) + 6 * (back(2) + back(2 * WIDE) + back(WIDE + 1)) + 5 * back(WIDE - 1);
        let before = |at: usize| u32::from(self.before[own * AREA + at]);
        let (column, row) = (at % SIDE, at / SIDE);
        let known = |there: bool, at: usize| if there { before(at) } else { 0 };
        let across = known(column > 0, at.wrapping_sub(1)) + known(column + 1 < SIDE, at + 1);
        let around = across + known(row > 0, at.wrapping_sub(SIDE)) + known(row + 1 < SIDE, at + SIDE);
        let same = before(at);
        let blocks = near.iter().flatten().map(|near| u32::from(self.now[near * AREA + at]).min(7)).sum::<u32>();
        let first = own - channel;
        let beside = if channel > 0 { usize::from(self.now[first * AREA + at]).min(3) } else { 0 };
        let rest = [0, 0, 1, 1, 1, 1, 1, 1].get(rest).copied().unwrap_or(if rest < 32 { 2 } else { 3 });
        Place {
            at,
            speed,
            channel,
            rest,
            beside,
            slower: self.class(slower),
            same: self.class(2 * same),
            around: self.class(around),
            blocks: self.class(16 * blocks).min(7),
            all: self.class(slower + same + around / 2),
        }
    }

    fn present(&mut self, coder: &mut impl Decider, place: &Place, wanted: bool) -> bool {
        let &Place { at, speed, channel, rest, beside, slower, same, around, blocks, all } = place;
        let contexts = [
            (speed * CLASSES + slower) * 2 + usize::from(channel > 0),
            (at * 8 + same.min(7)) * 3 + channel,
            (slower * CLASSES + same) * 4 + rest,
            ((same * 8 + blocks) * 4 + beside) * 3 + channel,
            (same * CLASSES + around) * 3 + channel,
            (all * SPEEDS + speed) * 3 + channel,
        ];
        mixed(&mut self.present, coder, &contexts, speed * 3 + channel, wanted)
    }

    /// The size of a wave that is not zero; `None` where it is out of range.
    fn size(&mut self, coder: &mut impl Decider, place: &Place, wanted: u32) -> Option<u32> {
        let &Place { speed, channel, slower, same, around, blocks, all, .. } = place;
        let mut size = 1;
        while size <= STEPS {
            let step = (size as usize - 1).min(7);
            let contexts = [
                (slower * 8 + step) * 2 + usize::from(channel > 0),
                (same * 8 + step) * 8 + blocks,
                (around * 8 + step) * 3 + channel,
                self.modes.min(63) * 8 + step,
                (all * SPEEDS + speed) * 8 + step,
            ];
            if !mixed(&mut self.larger, coder, &contexts, step * 3 + channel, wanted > size) {
                return Some(size);
            }
            size += 1;
        }
        // What is left, at least 0: its length, then its bits.
        let left = wanted.saturating_sub(size) + 1;
        let mut length = 0;
        while length < 15 && coder.toss(left.ilog2() > length) {
            length += 1;
        }
        let low = (0..length).rev().fold(0, |low, bit| low << 1 | u32::from(coder.toss(left >> bit & 1 == 1)));
        Some(size + (1 << length | low) - 1).filter(|&size| size <= i16::MAX as u32)
    }
}

/// What is known around a wave, as classes.
struct Place {
    at: usize,
    speed: usize,
    channel: usize,
    /// How many waves are left in the block.
    rest: usize,
    /// The same wave of the first channel.
    beside: usize,
    /// Slower waves of the block.
    slower: usize,
    /// The same wave in the modes before.
    same: usize,
    /// Its neighbours there.
    around: usize,
    /// The same wave in the blocks to the left and above.
    blocks: usize,
    /// All of these together.
    all: usize,
}

/// The place of a wave in a block with a border.
fn inside(at: usize) -> usize {
    (at / SIDE + 2) * WIDE + at % SIDE + 2
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::entropy::binary::{Decoder, Encoder};

    /// Blocks of three modes: three in a row and one below the first.
    const BLOCKS: [Block; 4] = [
        Block { x: 0, y: 0, left: None, above: None },
        Block { x: 1, y: 0, left: Some(0), above: None },
        Block { x: 2, y: 0, left: Some(1), above: None },
        Block { x: 0, y: 1, left: None, above: Some(0) },
    ];

    proptest! {
        #[test]
        fn modes_come_back(values in prop::collection::vec((0..3_usize, 0..4_usize, 0..2_usize, 0..AREA, -32_767..=32_767_i32, 0..4_u32), 0..600)) {
            let mut modes = vec![vec![[[0; AREA]; 2]; 4]; 3];
            for (mode, block, channel, at, value, shrink) in values {
                modes[mode][block][channel][at] = value >> (shrink * 4);
            }
            let mut learnt = Learnt::new(2);
            let written: Vec<Vec<u8>> = modes.iter().map(|mode| {
                let mut encoder = Encoder::default();
                for (index, block) in BLOCKS.iter().enumerate() {
                    for channel in 0..2 {
                        assert!(learnt.block(&mut encoder, (index, block), channel, &mut mode[index][channel].clone()).is_some());
                    }
                }
                learnt.end_mode();
                encoder.finish()
            }).collect();
            let mut learnt = Learnt::new(2);
            for (mode, bytes) in modes.iter().zip(&written) {
                let mut decoder = Decoder::new(bytes);
                for (index, block) in BLOCKS.iter().enumerate() {
                    for channel in 0..2 {
                        let mut waves = [0; AREA];
                        prop_assert!(learnt.block(&mut decoder, (index, block), channel, &mut waves).is_some());
                        prop_assert_eq!(waves, mode[index][channel]);
                    }
                }
                learnt.end_mode();
                prop_assert!(decoder.at_end());
            }
        }
    }

    #[test]
    fn a_mode_like_the_one_before_costs_less() {
        let waves = |sign: i32| -> Waves {
            std::array::from_fn(|at| if at * at % 11 == 3 { sign * (at as i32 % 5 - 2) } else { 0 })
        };
        let code = |learnt: &mut Learnt, sign: i32| {
            let mut encoder = Encoder::default();
            for (index, block) in BLOCKS.iter().enumerate() {
                assert!(learnt.block(&mut encoder, (index, block), 0, &mut waves(sign)).is_some());
            }
            learnt.end_mode();
            encoder.finish().len()
        };
        let mut learnt = Learnt::new(1);
        let costs = [1, -1, 1, -1, 1].map(|sign| code(&mut learnt, sign));
        assert!(costs[4] * 3 < costs[0] * 2, "{costs:?}");
    }
}
