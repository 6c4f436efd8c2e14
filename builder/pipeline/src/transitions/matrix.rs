//! The optimal transition of every pair of frames.

/// The optimal transition between two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransitionCost {
    /// Surface deformation cost D(i, j): the sum of pose distances over the nodes of its warp, in radians (TVCG
    /// equation 8; thesis equation 2.57).
    pub deformation: f32,
    /// Duration L(i, j) in frames: the number of nodes of its warp (thesis equation 2.56).
    pub duration: u16,
    /// Frames li of the source segment [i, i + li - 1].
    pub source_length: u16,
    /// Frames lj of the destination segment [j - lj + 1, j].
    pub destination_length: u16,
}

impl TransitionCost {
    /// Bytes of [`Self::to_bytes`].
    pub(super) const BYTES: usize = 10;

    /// As it is kept.
    pub(super) fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[..4].copy_from_slice(&self.deformation.to_le_bytes());
        for (k, number) in [self.duration, self.source_length, self.destination_length].into_iter().enumerate() {
            bytes[4 + 2 * k..6 + 2 * k].copy_from_slice(&number.to_le_bytes());
        }
        bytes
    }

    /// From [`Self::to_bytes`].
    pub(super) fn from_bytes(bytes: &[u8]) -> Self {
        let number = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        Self {
            deformation: f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
            duration: number(4),
            source_length: number(6),
            destination_length: number(8),
        }
    }

    /// E(i, j) = D + alpha L (TVCG equation 10; thesis equation 3.3).
    #[must_use]
    pub fn cost(&self, alpha: f64) -> f64 {
        f64::from(self.deformation) + alpha * f64::from(self.duration)
    }
}

/// Optimal transitions between all pairs of n frames; none where a segment would leave its sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct TransitionMatrix {
    frame_count: usize,
    /// A duration of zero stands for no transition.
    costs: Vec<TransitionCost>,
}

impl TransitionMatrix {
    /// What stands for no transition.
    pub(crate) const NONE: TransitionCost =
        TransitionCost { deformation: f32::INFINITY, duration: 0, source_length: 0, destination_length: 0 };

    /// The matrix of `transition(i, j)` for all frames i and j.
    #[must_use]
    pub fn from_fn(frame_count: usize, mut transition: impl FnMut(usize, usize) -> Option<TransitionCost>) -> Self {
        let pairs = (0..frame_count).flat_map(|i| (0..frame_count).map(move |j| (i, j)));
        Self { frame_count, costs: pairs.map(|(i, j)| transition(i, j).unwrap_or(Self::NONE)).collect() }
    }

    /// No transitions, to be filled in by rows.
    pub(super) fn none(frame_count: usize) -> Self {
        Self { frame_count, costs: vec![Self::NONE; frame_count * frame_count] }
    }

    /// Its rows, by source frame.
    pub(super) fn costs_mut(&mut self) -> &mut [TransitionCost] {
        &mut self.costs
    }

    /// All transitions from frame `i`, which must exist, by destination; a duration of 0 stands for none.
    #[must_use]
    pub fn costs_from(&self, i: usize) -> &[TransitionCost] {
        &self.costs[i * self.frame_count..(i + 1) * self.frame_count]
    }

    /// Number of frames n.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.frame_count
    }

    /// The transition from frame `i` to frame `j`, which must exist.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> Option<TransitionCost> {
        let cost = self.costs[i * self.frame_count..(i + 1) * self.frame_count][j];
        (cost.duration > 0).then_some(cost)
    }

    /// The transitions from frame `i`, which must exist, as (destination, transition), by destination.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, TransitionCost)> {
        let row = &self.costs[i * self.frame_count..(i + 1) * self.frame_count];
        row.iter().copied().enumerate().filter(|(_, cost)| cost.duration > 0)
    }
}
