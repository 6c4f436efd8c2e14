//! The planar alignment of all pairs of frames.

/// The angle of planar alignment between all pairs of n frames: antisymmetric, with a zero diagonal.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadingMatrix {
    frame_count: usize,
    /// Row after row above the diagonal: (0, 1), (0, 2), ... (1, 2), ...
    upper: Vec<f32>,
}

impl HeadingMatrix {
    /// The matrix whose angle for frames i < j, i fixed and j moving, is `heading(i, j)`.
    #[must_use]
    pub fn from_fn(frame_count: usize, mut heading: impl FnMut(usize, usize) -> f32) -> Self {
        let pairs = (0..frame_count).flat_map(|i| (i + 1..frame_count).map(move |j| (i, j)));
        Self { frame_count, upper: pairs.map(|(i, j)| heading(i, j)).collect() }
    }

    /// Angles that are all zero.
    pub(super) fn zeros(frame_count: usize) -> Self {
        Self { frame_count, upper: vec![0.0; frame_count * frame_count.saturating_sub(1) / 2] }
    }

    /// Sets the angle of frames i < j.
    pub(super) fn set(&mut self, i: usize, j: usize, heading: f32) {
        let place = self.place(i, j);
        self.upper[place] = heading;
    }

    fn place(&self, i: usize, j: usize) -> usize {
        i * (2 * self.frame_count - i - 1) / 2 + j - i - 1
    }

    /// The angle in radians by which frame `moving` must be turned about +Y to lie best on frame `fixed`; both must
    /// exist.
    #[must_use]
    pub fn get(&self, fixed: usize, moving: usize) -> f32 {
        match fixed.cmp(&moving) {
            std::cmp::Ordering::Less => self.upper[self.place(fixed, moving)],
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Greater => -self.upper[self.place(moving, fixed)],
        }
    }
}
