//! The graph section: alpha, and for each transition its ends, its deformation, its warp and its placement.

use glam::Vec2;

use super::entropy::binary::{Bit, Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;
use super::error::BundleError;
use super::kind::SectionKind;
use actor::graph::{EssentialGraph, Transition};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::Timeline;
use kernels::align::Placement;

/// Headings are multiples of this many radians.
pub(super) const HEADING_STEP: f32 = 1.0 / 65536.0;
/// Translations are multiples of this many metres.
pub(super) const TRANSLATION_STEP: f32 = 1.0 / 32768.0;

struct Models {
    from: Number,
    to: [Number; 2],
    /// The high half of the deformation's bits, which changes slowly; the low half is noise.
    deformation: Number,
    length: Number,
    /// Decisions of a move, by the two moves before it: whether both advance, and if not, which one.
    both: [[Bit; 4]; 4],
    source: [[Bit; 4]; 4],
    placement: [[Number; 3]; 2],
}

impl Models {
    fn new() -> Self {
        Self {
            from: Number::default(),
            to: Default::default(),
            deformation: Number::default(),
            length: Number::default(),
            both: Default::default(),
            source: Default::default(),
            placement: Default::default(),
        }
    }
}

/// The numbers of the transition before, from which those of the next are coded.
#[derive(Default)]
struct Before {
    from: u32,
    to: u32,
    high: i32,
    moves: i32,
    placement: [i32; 3],
}

/// The section's bytes; a placement that is too far out to be rounded gives the index of its transition.
pub(super) fn encode(graph: &EssentialGraph) -> Result<Vec<u8>, usize> {
    let mut bytes = graph.alpha().to_le_bytes().to_vec();
    let (mut encoder, mut models, mut before) = (Encoder::default(), Models::new(), Before::default());
    for (index, transition) in graph.transitions().iter().enumerate() {
        let placement = rounded(&transition.placement).ok_or(index)?;
        let same_source = encode_ends(&mut encoder, &mut models, &before, transition);
        let bits = transition.deformation.to_bits();
        let (high, moves) = ((bits >> 16) as i32, transition.warp.moves().len() as i32);
        models.deformation.encode_signed(&mut encoder, high - before.high);
        encoder.raw(bits & 0xffff, 16);
        models.length.encode_signed(&mut encoder, moves - before.moves);
        encode_moves(&mut encoder, &mut models, transition.warp.moves());
        for (axis, model) in models.placement[same_source].iter_mut().enumerate() {
            model.encode_signed(&mut encoder, placement[axis] - before.placement[axis]);
        }
        before = Before { from: transition.from, to: transition.to, high, moves, placement };
    }
    bytes.extend(encoder.finish());
    Ok(bytes)
}

/// Reads a graph of `count` transitions over `timeline`.
pub(super) fn decode(bytes: &[u8], count: u32, timeline: &Timeline) -> Result<EssentialGraph, BundleError> {
    let wrong = |reason: String| BundleError::section(SectionKind::Graph, reason);
    let Some((alpha, coded)) = bytes.split_first_chunk::<8>() else { return Err(wrong("is too short".into())) };
    if count as usize > coded.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err(wrong("cannot hold as many transitions as the meta section declares".into()));
    }
    let (mut decoder, mut models, mut before) = (Decoder::new(coded), Models::new(), Before::default());
    let mut transitions = Vec::new();
    for _ in 0..count {
        let (from, to, same_source) = decode_ends(&mut decoder, &mut models, &before);
        let high = before.high.wrapping_add(models.deformation.decode_signed(&mut decoder));
        let deformation = f32::from_bits((high as u32) << 16 | decoder.raw(16));
        let moves = before.moves.wrapping_add(models.length.decode_signed(&mut decoder));
        // A warp of a cyclic sequence may be longer than the sequence, but hardly than two whole captures.
        if decoder.exhausted() || !(0..=2 * Timeline::MAX_FRAMES as i32).contains(&moves) {
            return Err(wrong("ends too early or has a warp that is too long".into()));
        }
        let warp = decode_moves(&mut decoder, &mut models, moves);
        let mut placement = before.placement;
        for (axis, model) in models.placement[same_source].iter_mut().enumerate() {
            placement[axis] = placement[axis].wrapping_add(model.decode_signed(&mut decoder));
        }
        if decoder.exhausted() {
            return Err(wrong("ends too early".into()));
        }
        transitions.push(Transition {
            from,
            to,
            deformation,
            warp: TemporalWarp::new(warp),
            placement: restored(placement),
            turn: 0.0,
        });
        before = Before { from, to, high, moves, placement };
    }
    if !decoder.at_end() {
        return Err(wrong("has bytes left over".into()));
    }
    EssentialGraph::new(f64::from_le_bytes(*alpha), transitions, timeline).map_err(|error| wrong(error.to_string()))
}

/// Codes both ends; transitions are ordered by them. Returns whether the source is that of the transition before.
fn encode_ends(encoder: &mut Encoder, models: &mut Models, before: &Before, transition: &Transition) -> usize {
    models.from.encode(encoder, transition.from - before.from);
    let same = transition.from == before.from;
    let reference = if same { before.to } else { 0 };
    models.to[usize::from(same)].encode(encoder, transition.to - reference);
    usize::from(same)
}

fn decode_ends(decoder: &mut Decoder, models: &mut Models, before: &Before) -> (u32, u32, usize) {
    let from = before.from.wrapping_add(models.from.decode(decoder));
    let same = from == before.from;
    let reference = if same { before.to } else { 0 };
    (from, reference.wrapping_add(models.to[usize::from(same)].decode(decoder)), usize::from(same))
}

/// 0 stands for the beginning of a warp.
fn state(step: Move) -> usize {
    match step {
        Move::Both => 1,
        Move::Source => 2,
        Move::Destination => 3,
    }
}

fn encode_moves(encoder: &mut Encoder, models: &mut Models, moves: &[Move]) {
    let (mut last, mut last_but_one) = (0, 0);
    for &step in moves {
        encoder.bit(&mut models.both[last_but_one][last], step == Move::Both);
        if step != Move::Both {
            encoder.bit(&mut models.source[last_but_one][last], step == Move::Source);
        }
        (last_but_one, last) = (last, state(step));
    }
}

/// Stops early where the bytes end, so that a forged length costs no more than what arrived.
fn decode_moves(decoder: &mut Decoder, models: &mut Models, count: i32) -> Vec<Move> {
    let (mut last, mut last_but_one) = (0, 0);
    let mut moves = Vec::new();
    for _ in 0..count {
        if decoder.exhausted() {
            break;
        }
        let step = if decoder.bit(&mut models.both[last_but_one][last]) {
            Move::Both
        } else if decoder.bit(&mut models.source[last_but_one][last]) {
            Move::Source
        } else {
            Move::Destination
        };
        moves.push(step);
        (last_but_one, last) = (last, state(step));
    }
    moves
}

/// Heading and translation as multiples of their steps. The heading keeps its turns: they do not matter to anyone.
fn rounded(placement: &Placement) -> Option<[i32; 3]> {
    let heading = f64::from(placement.heading).rem_euclid(std::f64::consts::TAU) / f64::from(HEADING_STEP);
    let heading = if heading > std::f64::consts::PI / f64::from(HEADING_STEP) {
        heading - std::f64::consts::TAU / f64::from(HEADING_STEP)
    } else {
        heading
    };
    let translation = placement.translation.as_dvec2() / f64::from(TRANSLATION_STEP);
    let numbers = [heading, translation.x, translation.y];
    numbers.iter().all(|number| number.abs() < f64::from(1 << 28)).then(|| numbers.map(|n| n.round() as i32))
}

fn restored([heading, x, z]: [i32; 3]) -> Placement {
    Placement {
        heading: heading as f32 * HEADING_STEP,
        translation: Vec2::new(x as f32 * TRANSLATION_STEP, z as f32 * TRANSLATION_STEP),
    }
}
