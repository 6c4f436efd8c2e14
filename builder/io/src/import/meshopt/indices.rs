//! Modes 1 and 2: indices.

use super::MeshoptError;

/// Indices as little-endian numbers of `stride` (2 or 4) bytes.
pub(super) fn narrow(indices: &[u32], stride: usize) -> Vec<u8> {
    indices.iter().flat_map(|index| index.to_le_bytes().into_iter().take(stride)).collect()
}

/// Mode 2: `count` indices, each a difference from one of two that run beside each other.
pub(super) fn sequence(stream: &[u8], count: usize) -> Result<Vec<u32>, MeshoptError> {
    let mut data = Data::new(body(stream, 0xd1, 4, count)?, count);
    data.expect(count)?;
    let mut last = [0_u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let value = data.number()?;
        let slot = &mut last[(value & 1) as usize];
        *slot = slot.wrapping_add(zigzag(value >> 1));
        indices.push(*slot);
    }
    data.finish()?;
    Ok(indices)
}

/// Mode 1: `count` indices of triangles, most of which share an edge with one of the last 16.
pub(super) fn triangles(stream: &[u8], count: usize) -> Result<Vec<u32>, MeshoptError> {
    let body = body(stream, 0xe1, 16, count)?;
    let table = &stream[stream.len() - 16..];
    if table[14] != 0 || table[15] != 0 || table.iter().any(|&pair| pair >> 4 == 15 || pair & 15 == 15) {
        return Err(MeshoptError::Code("the table of codes of the compressed triangles is damaged"));
    }
    let (codes, data) = body.split_at_checked(count / 3).ok_or(MeshoptError::Short(count))?;
    let mut decoder =
        Triangles { data: Data::new(data, count), next: 0, last: 0, edges: Fifo::new(), vertices: Fifo::new() };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        indices.extend(match (code >> 4, code & 15) {
            (15, 14) => decoder.explicit(false)?,
            (15, 15) => decoder.explicit(true)?,
            (15, row) => decoder.looked_up(table[usize::from(row)])?,
            (edge, third) => decoder.beside_edge(edge, third)?,
        });
    }
    decoder.data.finish()?;
    Ok(indices)
}

/// What lies between the header byte and a tail of `tail` bytes.
fn body(stream: &[u8], header: u8, tail: usize, count: usize) -> Result<&[u8], MeshoptError> {
    match stream.first() {
        Some(&first) if first != header => Err(MeshoptError::Header(first)),
        _ => stream.len().checked_sub(tail).and_then(|end| stream.get(1..end)).ok_or(MeshoptError::Short(count)),
    }
}

/// The state of the section "Mode 1: triangles".
struct Triangles<'a> {
    data: Data<'a>,
    /// The lowest index that has not been used, as a rule.
    next: u32,
    /// The last index that was written out.
    last: u32,
    edges: Fifo<[u32; 2]>,
    vertices: Fifo<u32>,
}

impl Triangles<'_> {
    /// A triangle on an edge that is known.
    fn beside_edge(&mut self, edge: u8, third: u8) -> Result<[u32; 3], MeshoptError> {
        let [a, b] = self.edges.get(edge)?;
        let c = match third {
            0 => self.take_next(),
            1..=12 => self.vertices.get(third)?,
            13 | 14 => {
                self.last = if third == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
            _ => self.written_out()?,
        };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if !(1..=12).contains(&third) {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// A triangle that begins with a new vertex; `pair` says where the other two come from.
    fn looked_up(&mut self, pair: u8) -> Result<[u32; 3], MeshoptError> {
        let a = self.take_next();
        self.around(a, pair)
    }

    /// A triangle whose vertices are given one by one.
    fn explicit(&mut self, first_written_out: bool) -> Result<[u32; 3], MeshoptError> {
        let pair = self.data.byte()?;
        if pair == 0 {
            self.next = 0;
        }
        let a = if first_written_out { self.written_out()? } else { self.take_next() };
        self.around(a, pair)
    }

    fn around(&mut self, a: u32, pair: u8) -> Result<[u32; 3], MeshoptError> {
        let (b, b_is_new) = self.vertex(pair >> 4)?;
        let (c, c_is_new) = self.vertex(pair & 15)?;
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        self.vertices.push(a);
        if b_is_new {
            self.vertices.push(b);
        }
        if c_is_new {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// A vertex by half a byte, and whether it joins the recent ones.
    fn vertex(&mut self, code: u8) -> Result<(u32, bool), MeshoptError> {
        Ok(match code {
            0 => (self.take_next(), true),
            15 => (self.written_out()?, true),
            _ => (self.vertices.get(code - 1)?, false),
        })
    }

    fn take_next(&mut self) -> u32 {
        let index = self.next;
        self.next = self.next.wrapping_add(1);
        index
    }

    fn written_out(&mut self) -> Result<u32, MeshoptError> {
        self.last = self.last.wrapping_add(zigzag(self.data.number()?));
        Ok(self.last)
    }
}

/// The last 16 of something.
struct Fifo<T> {
    entries: [Option<T>; 16],
    /// Where the next entry goes.
    at: usize,
}

impl<T: Copy> Fifo<T> {
    fn new() -> Self {
        Self { entries: [None; 16], at: 0 }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.at] = Some(entry);
        self.at = (self.at + 1) % 16;
    }

    /// The entry that was pushed `age` entries before the last one.
    fn get(&self, age: u8) -> Result<T, MeshoptError> {
        let entry = self.entries[(self.at + 31 - usize::from(age)) % 16];
        entry.ok_or(MeshoptError::Code("the compressed triangles name a vertex before there is one"))
    }
}

/// Bytes beside the codes.
struct Data<'a> {
    rest: &'a [u8],
    /// Elements of the whole stream, for the message.
    count: usize,
}

impl<'a> Data<'a> {
    fn new(rest: &'a [u8], count: usize) -> Self {
        Self { rest, count }
    }

    /// Refuses a stream that has less than `count` bytes, before memory is reserved for as many numbers.
    fn expect(&self, count: usize) -> Result<(), MeshoptError> {
        if self.rest.len() < count { Err(MeshoptError::Short(count)) } else { Ok(()) }
    }

    fn byte(&mut self) -> Result<u8, MeshoptError> {
        let (&first, rest) = self.rest.split_first().ok_or(MeshoptError::Short(self.count))?;
        self.rest = rest;
        Ok(first)
    }

    /// A number of one to five bytes with seven bits each, the lowest first.
    fn number(&mut self) -> Result<u32, MeshoptError> {
        let mut value = 0_u32;
        for place in 0..5 {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << (7 * place);
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(MeshoptError::Code("an index of the compressed stream has more than five bytes"))
    }

    fn finish(&self) -> Result<(), MeshoptError> {
        match self.rest.len() {
            0 => Ok(()),
            left => Err(MeshoptError::LeftOver(left)),
        }
    }
}

/// A signed number whose lowest bit is its sign.
fn zigzag(value: u32) -> u32 {
    if value & 1 == 1 { !(value >> 1) } else { value >> 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_lowest_bits_first() {
        // The first two are the text's own examples; its third one has its bytes the other way round.
        for (bytes, value) in [(&[0x7f][..], 0x7f), (&[0x81, 0x04], 0x201), (&[0xff, 0xa0, 0x05], 0x1_507f)] {
            let mut data = Data::new(bytes, 1);
            assert_eq!(data.number().unwrap(), value);
            data.finish().unwrap();
        }
        assert!(Data::new(&[0x80, 0x80, 0x80, 0x80, 0x80], 1).number().is_err());
        assert!(Data::new(&[0x80], 1).number().is_err());
    }
}
