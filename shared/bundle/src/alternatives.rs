//! The alternatives section: motion that differs from recorded stretches. Optional: without it stretches are shown as they were
//! recorded. It is read in pieces, for all of it takes longer than a display frame.

use super::entropy::binary::{Decoder, Encoder, MOST_DECISIONS_PER_BYTE, Paused};
use super::entropy::numbers::Number;
use actor::alternatives::{Alternatives, MOST_ALTERNATIVES, MOST_MODES, Stretch};
use actor::timeline::Timeline;

/// What has been learnt about the numbers of the section.
#[derive(Clone, Debug, Default)]
struct Models {
    /// Counts, first frames, lengths, numbers of alternatives.
    plain: [Number; 4],
    /// Parts of modes, by coordinate and by how much the vertex before moves.
    part: [[Number; 4]; 3],
    heading: Number,
    /// Changes of the coefficients' changes, by mode.
    coefficient: Vec<Number>,
}

impl Models {
    fn part(&mut self, coordinate: usize, before: i8) -> &mut Number {
        let busy = before.unsigned_abs();
        &mut self.part[coordinate][usize::from(busy > 0) + usize::from(busy > 7) + usize::from(busy > 31)]
    }
}

/// The section's bytes.
pub(super) fn encode(alternatives: &Alternatives) -> Vec<u8> {
    let (mut encoder, mut models) = (Encoder::default(), Models::default());
    let modes = alternatives.modes();
    models.coefficient = vec![Number::default(); modes.len()];
    models.plain[0].encode(&mut encoder, modes.len() as u32);
    models.plain[0].encode(&mut encoder, alternatives.stretches().len() as u32);
    for mode in modes {
        let mut before = [0_i8; 3];
        for part in mode {
            for coordinate in 0..3 {
                let change = i32::from(part[coordinate]) - i32::from(before[coordinate]);
                models.part(coordinate, before[coordinate]).encode_signed(&mut encoder, change);
            }
            before = *part;
        }
    }
    let mut first = 0;
    for stretch in alternatives.stretches() {
        models.plain[1].encode(&mut encoder, stretch.first - first);
        models.plain[2].encode(&mut encoder, stretch.last - stretch.first);
        models.plain[3].encode(&mut encoder, stretch.coefficients.len() as u32);
        first = stretch.first;
        let mut before = 0_i16;
        for &heading in &stretch.headings {
            // Round about: a step from just below half a turn to just above is a small one.
            models.heading.encode_signed(&mut encoder, heading.wrapping_sub(before).into());
            before = heading;
        }
        for rows in &stretch.coefficients {
            for mode in 0..modes.len() {
                let mut line = Line::default();
                for row in rows.chunks_exact(modes.len()) {
                    models.coefficient[mode].encode_signed(&mut encoder, i32::from(row[mode]) - line.guess());
                    line.push(row[mode].into());
                }
            }
        }
    }
    encoder.finish()
}

/// The last two values of a coefficient: it goes on as it did.
#[derive(Clone, Copy, Default)]
struct Line([i32; 2]);

impl Line {
    fn guess(self) -> i32 {
        2 * self.0[1] - self.0[0]
    }

    fn push(&mut self, value: i32) {
        self.0 = [self.0[1], value];
    }
}

/// Reads the section, a piece at a time.
#[derive(Clone, Debug)]
pub struct AlternativesDecoder {
    bytes: Vec<u8>,
    paused: Paused,
    models: Models,
    timeline: Timeline,
    vertex_count: usize,
    mode_count: usize,
    stretch_count: usize,
    modes: Vec<Vec<[i8; 3]>>,
    stretches: Vec<Stretch>,
    /// Alternatives of the last stretch that are still to come.
    to_come: usize,
}

impl AlternativesDecoder {
    /// Begins to read `bytes`.
    ///
    /// # Errors
    /// The reason where it holds no alternatives.
    pub fn new(bytes: Vec<u8>, vertex_count: usize, timeline: &Timeline) -> Result<Self, &'static str> {
        let (mut decoder, mut models) = (Decoder::new(&bytes), Models::default());
        let mode_count = models.plain[0].decode(&mut decoder) as usize;
        let stretch_count = models.plain[0].decode(&mut decoder) as usize;
        let most = bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE);
        if mode_count > MOST_MODES || mode_count * vertex_count > most || stretch_count > most {
            return Err("has too many modes or stretches");
        }
        models.coefficient = vec![Number::default(); mode_count];
        let paused = decoder.pause();
        Ok(Self {
            bytes,
            paused,
            models,
            timeline: timeline.clone(),
            vertex_count,
            mode_count,
            stretch_count,
            modes: Vec::new(),
            stretches: Vec::new(),
            to_come: 0,
        })
    }

    /// Reads the next mode, or the next alternative of a stretch; all of them once there is no more.
    ///
    /// # Errors
    /// The reason where what comes is damaged, and some reason again from then on.
    pub fn advance(&mut self) -> Result<Option<Alternatives>, &'static str> {
        let bytes = std::mem::take(&mut self.bytes);
        let mut decoder = Decoder::resume(&bytes, self.paused);
        let read = self.read(&mut decoder);
        let is_short = decoder.exhausted();
        self.paused = decoder.pause();
        let is_whole = decoder.at_end();
        self.bytes = bytes;
        if is_short {
            return Err("ends too early");
        }
        if read? {
            return Ok(None);
        }
        if !is_whole {
            return Err("has bytes left over, or too few");
        }
        let (modes, stretches) = (std::mem::take(&mut self.modes), std::mem::take(&mut self.stretches));
        let all = Alternatives::new(modes, stretches, self.vertex_count, &self.timeline);
        all.map(Some).ok_or("has a stretch that does not fit the sequences")
    }

    /// Whether there was more.
    fn read(&mut self, decoder: &mut Decoder) -> Result<bool, &'static str> {
        if self.modes.len() < self.mode_count {
            let mode = self.mode(decoder);
            self.modes.push(mode);
        } else if self.to_come > 0 {
            let between = self.stretches.last().map_or(0, Stretch::between);
            let rows = self.rows(decoder, between)?;
            self.to_come -= 1;
            if let Some(last) = self.stretches.last_mut() {
                last.coefficients.push(rows);
            }
        } else if self.stretches.len() < self.stretch_count {
            let stretch = self.stretch(decoder)?;
            self.stretches.push(stretch);
        } else {
            return Ok(false);
        }
        Ok(true)
    }

    fn mode(&mut self, decoder: &mut Decoder) -> Vec<[i8; 3]> {
        let mut before = [0_i8; 3];
        (0..self.vertex_count)
            .map(|_| {
                before = std::array::from_fn(|coordinate| {
                    let change = self.models.part(coordinate, before[coordinate]).decode_signed(decoder);
                    // What is damaged may be anything.
                    i32::from(before[coordinate]).wrapping_add(change) as i8
                });
                before
            })
            .collect()
    }

    fn stretch(&mut self, decoder: &mut Decoder) -> Result<Stretch, &'static str> {
        let [_, first, length, alternatives] = &mut self.models.plain;
        let first = self.stretches.last().map_or(0, |last| last.first).wrapping_add(first.decode(decoder));
        let last = first.wrapping_add(length.decode(decoder));
        let count = alternatives.decode(decoder) as usize;
        if last <= first || last >= self.timeline.frame_count() || count > MOST_ALTERNATIVES {
            return Err("has a stretch that does not fit the sequences");
        }
        let mut before = 0_i16;
        let headings = (first + 1..last).map(|_| {
            before = before.wrapping_add(self.models.heading.decode_signed(decoder) as i16);
            before
        });
        let headings = headings.collect();
        self.to_come = count;
        Ok(Stretch { first, last, headings, coefficients: Vec::new() })
    }

    fn rows(&mut self, decoder: &mut Decoder, between: usize) -> Result<Vec<i16>, &'static str> {
        let mut rows = vec![0_i16; between * self.mode_count];
        for mode in 0..self.mode_count {
            let mut line = Line::default();
            for frame in 0..between {
                let value = line.guess().wrapping_add(self.models.coefficient[mode].decode_signed(decoder));
                let stored = i16::try_from(value).map_err(|_| "has a coefficient out of range")?;
                rows[frame * self.mode_count + mode] = stored;
                line.push(value);
            }
        }
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::timeline::Sequence;

    fn made(seed: u64) -> (Alternatives, Timeline) {
        let mix = |index: u64| kernels::random::mix(seed, index);
        let sequence = |first_frame| Sequence {
            name: format!("s{first_frame}"),
            labels: vec![],
            first_frame,
            frame_count: 40,
            cyclic: false,
        };
        let timeline = Timeline::new(25.0, vec![sequence(0), sequence(40)]).unwrap();
        let modes =
            (0..3).map(|m| (0..50).map(|v| [0, 1, 2].map(|c| mix(m * 150 + v * 3 + c) as i8 / 9)).collect()).collect();
        let stretch = |first: u32, last: u32, count: u64| {
            let between = u64::from(last - first - 1);
            let wave = |a: u64, at: u64| (300.0 * ((at as f64) * 0.1 + a as f64).sin()) as i16;
            Stretch {
                first,
                last,
                headings: (0..between).map(|at| 32_000_i16.wrapping_add(at as i16 * 100)).collect(),
                coefficients: (0..count).map(|a| (0..3 * between).map(|at| wave(a, at)).collect()).collect(),
            }
        };
        let stretches = vec![stretch(0, 20, 2), stretch(0, 39, 1), stretch(20, 39, 3), stretch(45, 46, 1)];
        (Alternatives::new(modes, stretches, 50, &timeline).unwrap(), timeline)
    }

    fn read(bytes: Vec<u8>, timeline: &Timeline) -> Result<Alternatives, &'static str> {
        let mut decoder = AlternativesDecoder::new(bytes, 50, timeline)?;
        loop {
            if let Some(all) = decoder.advance()? {
                return Ok(all);
            }
        }
    }

    #[test]
    fn alternatives_come_back() {
        for seed in 0..5 {
            let (all, timeline) = made(seed);
            assert_eq!(read(encode(&all), &timeline), Ok(all));
        }
    }

    #[test]
    fn what_is_damaged_is_refused_or_is_another_section() {
        let (all, timeline) = made(1);
        let bytes = encode(&all);
        for length in 0..bytes.len() {
            assert!(read(bytes[..length].to_vec(), &timeline).is_err(), "cut off at {length}");
        }
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x55;
            let _ = read(damaged, &timeline);
        }
    }
}
