//! The alternatives section: motion that differs from recorded stretches. Optional: without it stretches are shown as they were
//! recorded. It is read in pieces, for all of it takes longer than a display frame.
//!
//! A vertex of a mode is foretold by its neighbours that come before it, and a mode's coefficients are multiples of one number and go on
//! as they were or as they went, whichever is shorter. Bundles until 1.13 have them coded more plainly (`Coding::Earlier`).

use super::entropy::binary::{Decoder, Encoder, MOST_DECISIONS_PER_BYTE, Paused};
use super::entropy::numbers::Number;
use actor::alternatives::{Alternatives, MOST_ALTERNATIVES, MOST_MODES, Stretch};
use actor::timeline::Timeline;
use kernels::topology::Topology;

use super::body_parts::earlier_neighbours;

/// How the section is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coding {
    /// Modes from vertex to vertex, coefficients by the change of their change. Until 1.13.
    Earlier,
    /// Modes over the surface, coefficients in steps.
    Later,
}

/// What has been learnt about the numbers of the section.
#[derive(Clone, Debug, Default)]
struct Models {
    /// Counts, first frames, lengths, numbers of alternatives.
    plain: [Number; 4],
    /// Parts of modes, by coordinate and by how much the vertex before moves.
    part: [[Number; 4]; 3],
    heading: Number,
    /// Steps of coefficients.
    step: Number,
    /// Changes of the coefficients, or of their changes, by mode.
    coefficient: Vec<Number>,
}

/// How the coefficients of a mode are coded.
#[derive(Clone, Copy, Debug)]
struct Lines {
    /// All are multiples of this.
    step: i32,
    /// Whether they go on as they went, not as they were.
    straight: bool,
}

impl Lines {
    const EARLIER: Self = Self { step: 1, straight: true };
}

impl Models {
    /// The model of a part where it varies so much.
    fn part(&mut self, coordinate: usize, busy: u8) -> &mut Number {
        &mut self.part[coordinate][usize::from(busy > 0) + usize::from(busy > 7) + usize::from(busy > 31)]
    }
}

/// The part of a mode at a vertex as its neighbours foretell it, and how much these vary.
fn foretold(mode: &[[i8; 3]], [low, high]: [u32; 2], coordinate: usize) -> (i32, u8) {
    let part = |vertex: u32| mode.get(vertex as usize).map_or(0, |part| i32::from(part[coordinate]));
    let (a, b) = (part(low), part(high));
    ((a + b) >> 1, a.abs_diff(b).min(255) as u8)
}

/// How the coefficients of a mode are coded best.
fn lines(alternatives: &Alternatives, mode: usize) -> Lines {
    let count = alternatives.modes().len();
    let all = || alternatives.stretches().iter().flat_map(|stretch| &stretch.coefficients);
    let of_mode = |rows: &[i16]| rows.chunks_exact(count).map(|row| i32::from(row[mode])).collect::<Vec<_>>();
    let step = all().flat_map(|rows| of_mode(rows)).fold(0, divisor).max(1);
    let length = |straight: bool| -> u64 {
        let of = |rows: &Vec<i16>| {
            let mut line = Line::default();
            let bits = of_mode(rows).into_iter().map(|value| {
                let change = (value / step - line.guess(straight)).unsigned_abs();
                line.push(value / step);
                u64::from(u32::BITS - change.leading_zeros())
            });
            bits.sum::<u64>()
        };
        all().map(of).sum()
    };
    Lines { step, straight: length(true) < length(false) }
}

/// The largest number that both are multiples of.
fn divisor(mut a: i32, b: i32) -> i32 {
    let mut b = b.abs();
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The section's bytes, in the later coding.
pub(super) fn encode(alternatives: &Alternatives, topology: &Topology) -> Vec<u8> {
    let (mut encoder, mut models) = (Encoder::default(), Models::default());
    let modes = alternatives.modes();
    models.coefficient = vec![Number::default(); modes.len()];
    models.plain[0].encode(&mut encoder, modes.len() as u32);
    models.plain[0].encode(&mut encoder, alternatives.stretches().len() as u32);
    let neighbours = earlier_neighbours(topology);
    let mut all_lines = Vec::new();
    for (number, mode) in modes.iter().enumerate() {
        let lines = lines(alternatives, number);
        // A mode of no coefficients may be of any step.
        models.step.encode(&mut encoder, 2 * lines.step as u32 + u32::from(lines.straight));
        all_lines.push(lines);
        for (vertex, part) in mode.iter().enumerate() {
            for coordinate in 0..3 {
                let (guess, busy) = foretold(&mode[..vertex], neighbours[vertex], coordinate);
                models.part(coordinate, busy).encode_signed(&mut encoder, i32::from(part[coordinate]) - guess);
            }
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
            for (mode, &Lines { step, straight }) in all_lines.iter().enumerate() {
                let mut line = Line::default();
                for row in rows.chunks_exact(modes.len()) {
                    let value = i32::from(row[mode]) / step;
                    models.coefficient[mode].encode_signed(&mut encoder, value - line.guess(straight));
                    line.push(value);
                }
            }
        }
    }
    encoder.finish()
}

/// The last two values of a coefficient: it goes on as it went, or as it was.
#[derive(Clone, Copy, Default)]
struct Line([i32; 2]);

impl Line {
    fn guess(self, straight: bool) -> i32 {
        if straight { self.0[1].wrapping_mul(2).wrapping_sub(self.0[0]) } else { self.0[1] }
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
    coding: Coding,
    /// For each vertex two that foretell it; for the earlier coding the one before.
    neighbours: Vec<[u32; 2]>,
    lines: Vec<Lines>,
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
    pub(super) fn new(
        bytes: Vec<u8>,
        coding: Coding,
        topology: &Topology,
        timeline: &Timeline,
    ) -> Result<Self, &'static str> {
        let vertex_count = topology.vertex_count();
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
            coding,
            neighbours: earlier_neighbours(topology),
            lines: Vec::new(),
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
        let all = Alternatives::new(modes, stretches, self.neighbours.len(), &self.timeline);
        all.map(Some).ok_or("has a stretch that does not fit the sequences")
    }

    /// Whether there was more.
    fn read(&mut self, decoder: &mut Decoder) -> Result<bool, &'static str> {
        if self.modes.len() < self.mode_count {
            let mode = match self.coding {
                Coding::Earlier => self.earlier_mode(decoder),
                Coding::Later => self.mode(decoder)?,
            };
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

    fn mode(&mut self, decoder: &mut Decoder) -> Result<Vec<[i8; 3]>, &'static str> {
        let lines = self.models.step.decode(decoder);
        let step = i32::try_from(lines >> 1).ok().filter(|step| (1..=i32::from(i16::MAX) + 1).contains(step));
        self.lines
            .push(Lines { step: step.ok_or("has a step of coefficients that is none")?, straight: lines & 1 == 1 });
        let mut mode: Vec<[i8; 3]> = Vec::with_capacity(self.neighbours.len());
        for vertex in 0..self.neighbours.len() {
            let mut part = [0_i8; 3];
            for (coordinate, part) in part.iter_mut().enumerate() {
                let (guess, busy) = foretold(&mode, self.neighbours[vertex], coordinate);
                // What is damaged may be anything.
                *part = guess.wrapping_add(self.models.part(coordinate, busy).decode_signed(decoder)) as i8;
            }
            mode.push(part);
        }
        Ok(mode)
    }

    fn earlier_mode(&mut self, decoder: &mut Decoder) -> Vec<[i8; 3]> {
        self.lines.push(Lines::EARLIER);
        let mut before = [0_i8; 3];
        (0..self.neighbours.len())
            .map(|_| {
                before = std::array::from_fn(|coordinate| {
                    let change = self.models.part(coordinate, before[coordinate].unsigned_abs()).decode_signed(decoder);
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
            let (mut line, Lines { step, straight }) = (Line::default(), self.lines[mode]);
            for frame in 0..between {
                let value = line.guess(straight).wrapping_add(self.models.coefficient[mode].decode_signed(decoder));
                let stored = value.checked_mul(step).and_then(|value| i16::try_from(value).ok());
                let stored = stored.ok_or("has a coefficient out of range")?;
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

    fn topology() -> Topology {
        Topology::new(50, (2..50).map(|v| [v - 2, v - 1, v]).collect(), vec![1.0; 50]).unwrap()
    }

    fn read(bytes: Vec<u8>, timeline: &Timeline) -> Result<Alternatives, &'static str> {
        read_as(Coding::Later, bytes, timeline)
    }

    fn read_as(coding: Coding, bytes: Vec<u8>, timeline: &Timeline) -> Result<Alternatives, &'static str> {
        let mut decoder = AlternativesDecoder::new(bytes, coding, &topology(), timeline)?;
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
            assert_eq!(read(encode(&all, &topology()), &timeline), Ok(all.clone()));
            let mut coarse = all.stretches().to_vec();
            coarse.iter_mut().flat_map(|one| &mut one.coefficients).flatten().for_each(|c| *c = *c / 24 * 24);
            let coarse = Alternatives::new(all.modes().to_vec(), coarse, 50, &timeline).unwrap();
            let bytes = encode(&coarse, &topology());
            assert!(10 * bytes.len() < 9 * encode(&all, &topology()).len());
            assert_eq!(read(bytes, &timeline), Ok(coarse));
        }
    }

    #[test]
    fn what_is_damaged_is_refused_or_is_another_section() {
        let (all, timeline) = made(1);
        let bytes = encode(&all, &topology());
        for length in 0..bytes.len() {
            assert!(read(bytes[..length].to_vec(), &timeline).is_err(), "cut off at {length}");
        }
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x55;
            let _ = read_as(Coding::Earlier, damaged.clone(), &timeline);
            let _ = read(damaged, &timeline);
        }
    }
}
