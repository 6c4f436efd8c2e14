//! Temporal warps: how the source and destination segments of a transition are matched, frame by frame.
//!
//! A warp is a path through the grid of a dynamic time warping (thesis section 2.5.2), from (0, 0) to (li - 1, lj - 1).

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_follow_the_moves() {
        let warp = TemporalWarp::new(vec![Move::Both, Move::Source, Move::Both, Move::Destination]);
        assert_eq!(warp.nodes().collect::<Vec<_>>(), [(0, 0), (1, 1), (2, 1), (3, 2), (3, 3)]);
        assert_eq!(warp.lengths(), (4, 4));
        assert_eq!(warp.duration(), 5);
    }
}
