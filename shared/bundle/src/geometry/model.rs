//! What decoding a frame needs besides its bytes: the traversal, the prediction weights and the tables of residuals.

use super::super::entropy::binary::{Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::super::entropy::numbers::Number;
use super::schedule::CLASSES;
use super::traversal::Traversal;
pub use kernels::codec::frame::WEIGHT_BITS;
use kernels::codec::rans::{FREQUENCY_SUM, Table};
use kernels::codec::residual::{CONTEXTS, SYMBOLS};
use kernels::topology::Topology;

/// The weight 1.
pub const ONE: i32 = 1 << WEIGHT_BITS;
/// Numbers of parents that a model may have.
pub const PARENTS: [usize; 3] = [2, 4, 8];
/// Kinds of weights: for independent frames, and for differences from other frames.
pub const KINDS: usize = 2;

/// Prediction weights: for each kind, one per parent slot of the traversal.
pub type Weights = [Vec<i16>; KINDS];

/// Everything that all frames share.
#[derive(Clone, Debug)]
pub struct Model {
    /// The order of the vertices and their parents.
    pub traversal: Traversal,
    /// How parents are weighted.
    pub weights: Weights,
    /// Tables of residuals, [`CONTEXTS`] of them for each class.
    pub tables: Vec<Table>,
}

impl Model {
    /// The tables of a class of frames.
    #[must_use]
    pub fn tables_of(&self, class: usize) -> &[Table] {
        let start = class.min(CLASSES - 1) * CONTEXTS;
        self.tables.get(start..start + CONTEXTS).unwrap_or_default()
    }

    /// Reads a model over `topology`; the reason where it is none.
    ///
    /// # Errors
    /// Forged or contradictory bytes.
    pub fn decode(bytes: &[u8], topology: &Topology, with_differences: bool) -> Result<Self, &'static str> {
        let mut decoder = Decoder::new(bytes);
        let mut number = Number::default();
        let most_parents = number.decode(&mut decoder) as usize;
        if !PARENTS.contains(&most_parents) {
            return Err("has a number of parents that does not exist");
        }
        if topology.vertex_count() > bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
            return Err("is too short for this many vertices");
        }
        let links = decode_links(&mut decoder, topology)?;
        let traversal = Traversal::new(topology, &links, most_parents)?;
        let kinds = if with_differences { KINDS } else { 1 };
        let weights = decode_weights(&mut decoder, &traversal, kinds)?;
        let tables = decode_tables(&mut decoder)?;
        if decoder.exhausted() || !decoder.at_end() {
            return Err("ends too early or has bytes left over");
        }
        Ok(Self { traversal, weights, tables })
    }
}

/// The bytes of a model; `frequencies` has one row per table.
#[must_use]
pub fn encode(
    links: &[u32],
    traversal: &Traversal,
    weights: &Weights,
    frequencies: &[Vec<u32>],
    with_differences: bool,
) -> Vec<u8> {
    let mut encoder = Encoder::default();
    Number::default().encode(&mut encoder, traversal.most_parents as u32);
    let mut link_model = Number::default();
    let mut before = 0;
    for &link in links {
        link_model.encode_signed(&mut encoder, link as i32 - before);
        before = link as i32;
    }
    encode_weights(&mut encoder, traversal, weights, if with_differences { KINDS } else { 1 });
    encode_tables(&mut encoder, frequencies);
    encoder.finish()
}

fn decode_links(decoder: &mut Decoder, topology: &Topology) -> Result<Vec<u32>, &'static str> {
    let (mut model, mut links, mut before) = (Number::default(), Vec::new(), 0_i32);
    for _ in 1..topology.component_count() {
        before = before.wrapping_add(model.decode_signed(decoder));
        if decoder.exhausted() {
            return Err("ends within its links");
        }
        links.push(before as u32);
    }
    Ok(links)
}

/// The weight that a vertex of `count` parents gives each of them before anything is learnt.
#[must_use]
pub fn prior(count: usize) -> i32 {
    ONE / count.max(1) as i32
}

/// Weights are coded as differences from [`prior`], counted apart by kind, number and place of the parent.
struct WeightModels(Vec<Number>);

impl WeightModels {
    fn new() -> Self {
        Self(vec![Number::default(); KINDS * 9 * 8])
    }

    fn of(&mut self, kind: usize, count: usize, parent: usize) -> &mut Number {
        &mut self.0[(kind * 9 + count) * 8 + parent]
    }
}

fn encode_weights(encoder: &mut Encoder, traversal: &Traversal, weights: &Weights, kinds: usize) {
    let mut models = WeightModels::new();
    for (place, &count) in traversal.parent_count.iter().enumerate() {
        let count = usize::from(count);
        for kind in 0..kinds {
            // The first weight of an independent frame is what the others leave to 1.
            for parent in usize::from(kind == 0)..count {
                let weight = i32::from(weights[kind][place * traversal.most_parents + parent]);
                models.of(kind, count, parent).encode_signed(encoder, weight - prior(count));
            }
        }
    }
}

fn decode_weights(decoder: &mut Decoder, traversal: &Traversal, kinds: usize) -> Result<Weights, &'static str> {
    let mut models = WeightModels::new();
    let length = traversal.parent_slots.len();
    let mut weights = [vec![0; length], if kinds > 1 { vec![0; length] } else { Vec::new() }];
    for (place, &count) in traversal.parent_count.iter().enumerate() {
        let (count, row) = (usize::from(count), place * traversal.most_parents);
        for (kind, weights) in weights.iter_mut().enumerate().take(kinds) {
            let mut sum = 0_i32;
            for parent in usize::from(kind == 0)..count {
                let difference = models.of(kind, count, parent).decode_signed(decoder);
                weights[row + parent] = narrow(prior(count).wrapping_add(difference))?;
                sum += i32::from(weights[row + parent]);
            }
            if kind == 0 && count > 0 {
                weights[row] = narrow(ONE - sum)?;
            }
        }
        if decoder.exhausted() {
            return Err("ends within its weights");
        }
    }
    Ok(weights)
}

fn narrow(weight: i32) -> Result<i16, &'static str> {
    i16::try_from(weight).map_err(|_| "has a weight out of range")
}

fn encode_tables(encoder: &mut Encoder, frequencies: &[Vec<u32>]) {
    let (mut length, mut value) = (Number::default(), Number::default());
    for row in frequencies {
        let used = row.iter().rposition(|&frequency| frequency > 0).map_or(0, |last| last + 1);
        length.encode(encoder, used as u32);
        for &frequency in &row[..used] {
            value.encode(encoder, frequency);
        }
    }
}

fn decode_tables(decoder: &mut Decoder) -> Result<Vec<Table>, &'static str> {
    let (mut length, mut value) = (Number::default(), Number::default());
    let mut tables = Vec::with_capacity(CLASSES * CONTEXTS);
    for _ in 0..CLASSES * CONTEXTS {
        let used = length.decode(decoder) as usize;
        if used > SYMBOLS {
            return Err("has a table of too many symbols");
        }
        let row: Vec<u32> = (0..used).map(|_| value.decode(decoder).min(FREQUENCY_SUM + 1)).collect();
        tables.push(Table::new(&row).ok_or("has a table whose frequencies have the wrong sum")?);
    }
    Ok(tables)
}
