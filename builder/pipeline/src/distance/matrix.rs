//! All pose distances of a capture.

/// Pose distances between all pairs of n frames: symmetric, with a zero diagonal.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceMatrix {
    frame_count: usize,
    values: Vec<f32>,
}

impl DistanceMatrix {
    /// The matrix whose value for frames i < j is `distance(i, j)`.
    #[must_use]
    pub fn from_fn(frame_count: usize, mut distance: impl FnMut(usize, usize) -> f32) -> Self {
        let mut matrix = Self::zeros(frame_count);
        for i in 0..frame_count {
            for j in i + 1..frame_count {
                matrix.set(i, j, distance(i, j));
            }
        }
        matrix
    }

    /// Distances that are all zero.
    pub(super) fn zeros(frame_count: usize) -> Self {
        Self { frame_count, values: vec![0.0; frame_count * frame_count] }
    }

    /// Sets the distance between two frames, both ways.
    pub(super) fn set(&mut self, i: usize, j: usize, distance: f32) {
        self.values[i * self.frame_count + j] = distance;
        self.values[j * self.frame_count + i] = distance;
    }

    /// Number of frames n.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.frame_count
    }

    /// Distances of frame `frame`, which must exist, to all frames.
    #[must_use]
    pub fn row(&self, frame: usize) -> &[f32] {
        &self.values[frame * self.frame_count..(frame + 1) * self.frame_count]
    }

    /// The distance between two frames, which must exist.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> f32 {
        self.row(i)[j]
    }
}
