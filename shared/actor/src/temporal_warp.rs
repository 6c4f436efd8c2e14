//! Temporal warps: how the source and destination segments of a transition are matched, frame by frame.
//!
//! A warp is a path through the grid of a dynamic time warping (thesis section 2.5.2), from (0, 0) to (li - 1, lj - 1).
//! It is played as a smooth curve beside that path ([`Pace`]): in the path a side stands still for a frame or two wherever
//! the other one advances alone, which is seen as a stutter.

/// One step of a warp's path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// Both segments advance by a frame.
    Both,
    /// Only the source segment advances.
    Source,
    /// Only the destination segment advances.
    Destination,
}

impl Move {
    /// Whether the source segment advances.
    #[must_use]
    pub fn advances_source(self) -> bool {
        self != Self::Destination
    }

    /// Whether the destination segment advances.
    #[must_use]
    pub fn advances_destination(self) -> bool {
        self != Self::Source
    }
}

/// A warp's path as its moves; a transition of L frames has L - 1 of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TemporalWarp {
    moves: Vec<Move>,
}

impl TemporalWarp {
    /// The warp that takes `moves` one after another.
    #[must_use]
    pub fn new(moves: Vec<Move>) -> Self {
        Self { moves }
    }

    /// The shortest warp of segments of `li` and `lj` frames: the shorter one is paused evenly.
    #[must_use]
    pub fn even(li: usize, lj: usize) -> Self {
        let last = li.max(lj).max(1) - 1;
        let advances = |length: usize, step: usize| {
            let at = |step: usize| step * length.saturating_sub(1) / last.max(1);
            at(step) > at(step - 1)
        };
        let step = |step: usize| match (advances(li, step), advances(lj, step)) {
            (true, true) => Move::Both,
            (true, false) => Move::Source,
            _ => Move::Destination,
        };
        Self::new((1..=last).map(step).collect())
    }

    /// Its moves, L - 1 of them.
    #[must_use]
    pub fn moves(&self) -> &[Move] {
        &self.moves
    }

    /// Number of nodes L: the transition's frames.
    #[must_use]
    pub fn duration(&self) -> usize {
        self.moves.len() + 1
    }

    /// Lengths (li, lj) in frames of the source and the destination segment.
    #[must_use]
    pub fn lengths(&self) -> (usize, usize) {
        let advances = |stays: Move| self.moves.iter().filter(|&&step| step != stays).count() + 1;
        (advances(Move::Destination), advances(Move::Source))
    }

    /// Its nodes (k, l), from (0, 0): `k` frames into the source segment, `l` into the destination segment.
    pub fn nodes(&self) -> impl Iterator<Item = (usize, usize)> {
        std::iter::once((0, 0)).chain(self.moves.iter().scan((0, 0), |(k, l), step| {
            *k += usize::from(*step != Move::Destination);
            *l += usize::from(*step != Move::Source);
            Some((*k, *l))
        }))
    }
}

/// Places along a segment are whole multiples of this part of a frame.
pub const PLACES_A_FRAME: u32 = 256;
/// A pause is spread over this many seconds before and after it.
const SPREAD_SECONDS: f32 = 0.16;
/// And over as many frames at least.
const FEWEST_FRAMES: f32 = 2.0;
/// Pauses take no more than this of any frame: a slope of the papers' limit of 3.
const MOST_PAUSED: f32 = 2.0 / 3.0;

/// How one side of a warp is gone through: each of its pauses, a frame each, is spread smoothly over the frames around it.
///
/// Not in the papers. The curve has the warp's number of nodes and its ends, so that durations, costs and stored warps are
/// what they were. It begins and ends as fast as the recording, where its pauses leave it the room; it never stands still
/// and never goes faster than the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Frames over which a pause is spread.
    width: f32,
    /// Share of the pauses that is spread over all of the warp, so that no frame is paused too much.
    evenly: f32,
    /// Whether there is none.
    is_straight: bool,
}

impl Pace {
    /// The pace of the source (0) or the destination (1) of `warp`, whose frames are `fps` a second.
    #[must_use]
    pub fn of(warp: &TemporalWarp, side: usize, fps: f32) -> Self {
        let total = warp.moves.len() as f32;
        let width = (2.0 * (SPREAD_SECONDS * fps).max(FEWEST_FRAMES)).min(total);
        let is_straight = !warp.moves.contains(&[Move::Destination, Move::Source][side & 1]);
        let mut pace = Self { width, evenly: 0.0, is_straight };
        if is_straight {
            return pace;
        }
        let (mut before, mut most) = (0.0, 0.0_f32);
        for node in 1..=warp.moves.len() {
            let paused = pace.paused(warp, side, node);
            most = most.max(paused - before);
            before = paused;
        }
        if most > MOST_PAUSED {
            let mean = before / total;
            let room = (MOST_PAUSED - mean).max(0.0);
            pace.evenly = 1.0 - room / (most - mean).max(room).max(f32::MIN_POSITIVE);
        }
        pace
    }

    /// Where node `node` is in its segment, in parts of a frame ([`PLACES_A_FRAME`]).
    #[must_use]
    pub fn place(&self, warp: &TemporalWarp, side: usize, node: usize) -> u32 {
        if self.is_straight {
            return node.min(warp.moves.len()) as u32 * PLACES_A_FRAME;
        }
        let (node, nodes) = (node.min(warp.moves.len()), warp.moves.len().max(1) as f32);
        let paused = self.paused(warp, side, node);
        let even = self.paused(warp, side, warp.moves.len()) * node as f32 / nodes;
        let place = node as f32 - (paused + self.evenly * (even - paused));
        (place * PLACES_A_FRAME as f32).round() as u32
    }

    /// Frames that a side has been paused for at a node, but for what is spread over all.
    fn paused(&self, warp: &TemporalWarp, side: usize, node: usize) -> f32 {
        let mut sum = 0.0;
        for (index, step) in warp.moves.iter().enumerate() {
            if [Move::Destination, Move::Source][side & 1] == *step {
                let room = warp.moves.len() as f32 - self.width;
                let begin = (index as f32 + 0.5 - self.width / 2.0).max(0.0).min(room);
                sum += ease(((node as f32 - begin) / self.width).clamp(0.0, 1.0));
            }
        }
        sum
    }
}

/// `3 t^2 - 2 t^3`: from 0 to 1, at rest at both ends.
///
/// The papers' weight grows evenly (thesis algorithm 2): at the first node of a blend the surface then takes on the
/// velocity (destination - source) / (L - 1) at once, and loses it at the last, which is seen where L is small.
#[must_use]
pub fn ease(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Warps as the slope limit 3 allows them: a diagonal step, then up to two straight ones.
    fn warps() -> impl Iterator<Item = TemporalWarp> {
        (0..2000_u64).map(|seed| {
            let mut moves = Vec::new();
            for index in 0..3 + kernels::random::mix(seed, 0) % 30 {
                let drawn = kernels::random::mix(seed, index + 1);
                moves.push(Move::Both);
                let straight = if drawn.is_multiple_of(2) { Move::Source } else { Move::Destination };
                moves.extend(std::iter::repeat_n(straight, (drawn / 2 % 3) as usize));
            }
            TemporalWarp::new(moves)
        })
    }

    #[test]
    fn paces_keep_the_ends_and_never_stand_still() {
        for (warp, fps) in warps().flat_map(|warp| [(warp.clone(), 25.0), (warp, 60.0)]) {
            let nodes: Vec<_> = warp.nodes().collect();
            for side in 0..2 {
                let pace = Pace::of(&warp, side, fps);
                let places: Vec<u32> = (0..nodes.len()).map(|node| pace.place(&warp, side, node)).collect();
                let length = [warp.lengths().0, warp.lengths().1][side] as u32 - 1;
                assert_eq!((places[0], places[nodes.len() - 1]), (0, length * PLACES_A_FRAME));
                let mean = f64::from(length) / (nodes.len() - 1) as f64;
                let least = mean.min(1.0 - f64::from(MOST_PAUSED)) * f64::from(PLACES_A_FRAME) - 1.0;
                for pair in places.windows(2) {
                    let step = f64::from(pair[1]) - f64::from(pair[0]);
                    assert!(step >= least, "{step} of {PLACES_A_FRAME} in {warp:?}");
                    assert!(step <= f64::from(PLACES_A_FRAME) + 1.0, "{step} in {warp:?}");
                }
            }
        }
    }

    #[test]
    fn a_warp_without_pauses_is_played_as_it_is() {
        let warp = TemporalWarp::new(vec![Move::Both; 9]);
        let pace = Pace::of(&warp, 1, 25.0);
        assert!((0..10).all(|node| pace.place(&warp, 1, node) == node as u32 * PLACES_A_FRAME));
        let none = TemporalWarp::default();
        assert_eq!(Pace::of(&none, 0, 25.0).place(&none, 0, 0), 0);
    }

    #[test]
    fn even_warps_have_the_lengths_that_are_asked() {
        for (li, lj) in [(1, 1), (1, 9), (9, 1), (7, 9), (9, 9), (20, 3)] {
            let warp = TemporalWarp::even(li, lj);
            assert_eq!((warp.lengths(), warp.duration()), ((li, lj), li.max(lj)));
        }
        assert_eq!(TemporalWarp::even(4, 4), TemporalWarp::new(vec![Move::Both; 3]));
    }

    #[test]
    fn nodes_follow_the_moves() {
        let warp = TemporalWarp::new(vec![Move::Both, Move::Source, Move::Both, Move::Destination]);
        assert_eq!(warp.nodes().collect::<Vec<_>>(), [(0, 0), (1, 1), (2, 1), (3, 2), (3, 3)]);
        assert_eq!(warp.lengths(), (4, 4));
        assert_eq!(warp.duration(), 5);
    }
}
