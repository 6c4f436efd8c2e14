//! Triangles as adaptive decisions, in their own order and with their own first corners.
//!
//! A triangle usually shares an edge with one that came shortly before it: then it costs the age of that edge, which
//! of its corners comes first, and its third corner.

use std::collections::HashMap;

use super::entropy::binary::{Bit, Decoder, Encoder};
use super::entropy::numbers::Number;

/// Edges older than this many are forgotten.
const MEMORY: usize = 1 << 16;

#[derive(Default)]
struct Models {
    shares_edge: [Bit; 2],
    age: Number,
    turn: [Bit; 3],
    is_new: [Bit; 4],
    difference: [Number; 4],
}

/// What both sides know after some triangles.
struct History {
    /// The two ends of each edge, in the direction in which a neighbour runs along it.
    edges: Vec<(u32, u32)>,
    next_new: u32,
    shared: usize,
    before: u32,
}

impl History {
    fn new() -> Self {
        Self { edges: Vec::new(), next_new: 0, shared: 0, before: 0 }
    }

    fn remember(&mut self, [a, b, c]: [u32; 3], shared: bool) {
        self.edges.extend([(b, a), (c, b), (a, c)]);
        self.shared = usize::from(shared);
        self.before = c;
    }

    fn saw(&mut self, corner: u32) {
        self.next_new = self.next_new.max(corner.wrapping_add(1));
    }
}

/// Appends `triangles` to what `encoder` holds.
pub fn encode(encoder: &mut Encoder, triangles: &[[u32; 3]]) {
    encode_told(encoder, triangles, &mut |_| {});
}

/// As [`encode`]; `told` hears of each triangle which edge of an earlier one it shares: edge 3 t + s of triangle t runs from its
/// corner s to the next one.
pub fn encode_told(encoder: &mut Encoder, triangles: &[[u32; 3]], told: &mut impl FnMut(Option<usize>)) {
    let (mut models, mut history) = (Models::default(), History::new());
    let mut newest: HashMap<(u32, u32), usize> = HashMap::new();
    for &triangle in triangles {
        let found = (0..3)
            .filter_map(|turn| {
                let edge = (triangle[turn], triangle[(turn + 1) % 3]);
                let age = history.edges.len() - newest.get(&edge)? - 1;
                (age < MEMORY).then_some((age, turn))
            })
            .min();
        encoder.bit(&mut models.shares_edge[history.shared], found.is_some());
        told(found.map(|(age, _)| history.edges.len() - 1 - age));
        if let Some((age, turn)) = found {
            models.age.encode(encoder, age as u32);
            encoder.bit(&mut models.turn[0], turn > 0);
            if turn > 0 {
                encoder.bit(&mut models.turn[1], turn > 1);
            }
            let (from, third) = (triangle[turn], triangle[(turn + 2) % 3]);
            encode_corner(encoder, &mut models, &mut history, 3, from, third);
        } else {
            let mut from = history.before;
            for (place, &corner) in triangle.iter().enumerate() {
                encode_corner(encoder, &mut models, &mut history, place, from, corner);
                from = corner;
            }
        }
        history.remember(triangle, found.is_some());
        for back in 1..=3 {
            let index = history.edges.len() - back;
            newest.insert(history.edges[index], index);
        }
    }
}

fn encode_corner(e: &mut Encoder, models: &mut Models, history: &mut History, place: usize, from: u32, corner: u32) {
    let is_new = corner == history.next_new;
    e.bit(&mut models.is_new[place], is_new);
    if !is_new {
        models.difference[place].encode_signed(e, corner.wrapping_sub(from) as i32);
    }
    history.saw(corner);
}

/// Reads `count` triangles over `corner_count` corners; the reason where that cannot be.
///
/// `count` must be bounded by the caller: memory for it is allocated as triangles come.
pub fn decode(decoder: &mut Decoder, count: u32, corner_count: u32) -> Result<Vec<[u32; 3]>, &'static str> {
    decode_told(decoder, count, corner_count, &mut |_| {})
}

/// As [`decode`]; `told` hears what that of [`encode_told`] heard.
pub fn decode_told(
    decoder: &mut Decoder,
    count: u32,
    corner_count: u32,
    told: &mut impl FnMut(Option<usize>),
) -> Result<Vec<[u32; 3]>, &'static str> {
    let (mut models, mut history) = (Models::default(), History::new());
    let mut triangles = Vec::new();
    for _ in 0..count {
        let shared = decoder.bit(&mut models.shares_edge[history.shared]);
        let mut triangle = [0; 3];
        if shared {
            let age = models.age.decode(decoder) as usize;
            let turn = if !decoder.bit(&mut models.turn[0]) {
                0
            } else if !decoder.bit(&mut models.turn[1]) {
                1
            } else {
                2
            };
            let index = history.edges.len().checked_sub(age.saturating_add(1));
            let edge = index.and_then(|i| history.edges.get(i));
            let &(from, to) = edge.ok_or("names an edge that does not exist")?;
            told(index);
            let third = decode_corner(decoder, &mut models, &mut history, 3, from);
            triangle[turn] = from;
            triangle[(turn + 1) % 3] = to;
            triangle[(turn + 2) % 3] = third;
        } else {
            told(None);
            let mut from = history.before;
            for (place, corner) in triangle.iter_mut().enumerate() {
                *corner = decode_corner(decoder, &mut models, &mut history, place, from);
                from = *corner;
            }
        }
        if decoder.exhausted() {
            return Err("ends within its triangles");
        }
        if triangle.iter().any(|&corner| corner >= corner_count) {
            return Err("has a triangle with a corner that does not exist");
        }
        history.remember(triangle, shared);
        triangles.push(triangle);
    }
    Ok(triangles)
}

fn decode_corner(d: &mut Decoder, models: &mut Models, history: &mut History, place: usize, from: u32) -> u32 {
    let corner = if d.bit(&mut models.is_new[place]) {
        history.next_new
    } else {
        from.wrapping_add(models.difference[place].decode_signed(d) as u32)
    };
    history.saw(corner);
    corner
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn triangles_come_back(triangles in prop::collection::vec([0..40_u32, 0..40_u32, 0..40_u32], 1..300)) {
            let mut encoder = Encoder::default();
            encode(&mut encoder, &triangles);
            let bytes = encoder.finish();
            let mut decoder = Decoder::new(&bytes);
            prop_assert_eq!(decode(&mut decoder, triangles.len() as u32, 40), Ok(triangles));
            prop_assert!(decoder.at_end());
        }
    }

    #[test]
    fn a_strip_costs_little() {
        let strip: Vec<_> = (0..1000).map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] }).collect();
        let mut encoder = Encoder::default();
        encode(&mut encoder, &strip);
        assert!(encoder.finish().len() < 400);
    }
}
