//! Feet: the parts of the surface that stand on the ground, how far each of them moves what is around it, and the frames in
//! which it stands.
//!
//! Not in the papers. A blend of two poses moves a foot wherever both sides have it elsewhere; what makes it stay needs to
//! know which vertices follow a foot when it is put elsewhere. The builder finds that, once
//! (`builder/pipeline/src/feet.rs`); with it the foot of a transition's frame is put where it stands by adding up, without a
//! solve.

use crate::timeline::Timeline;

/// Feet that are told apart at most.
pub const MOST_FEET: usize = 8;
/// Shares of [`FootVertex`] are whole multiples of this.
pub const SHARE_STEP: f32 = 1.0 / 255.0;

/// A vertex that a foot moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FootVertex {
    /// The vertex.
    pub vertex: u32,
    /// How far it goes where the foot goes, in [`SHARE_STEP`]: 255 on the foot, less up the leg, never 0.
    pub leg: u8,
    /// How far it is part of what is put down as a whole, in [`SHARE_STEP`]: 255 on the sole, 0 above the ankle.
    pub sole: u8,
}

/// The feet of a capture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Feet {
    feet: Vec<Vec<FootVertex>>,
    /// Frame after frame, for each foot whether it stands.
    stands: Vec<bool>,
}

impl Feet {
    /// Feet over the vertices of a mesh; `stands` holds for each frame of `timeline` in turn whether each foot stands. `None`
    /// where their numbers do not fit, vertices are not in ascending order, or a foot has no sole.
    #[must_use]
    pub fn new(
        feet: Vec<Vec<FootVertex>>,
        stands: Vec<bool>,
        vertex_count: usize,
        timeline: &Timeline,
    ) -> Option<Self> {
        let fits = feet.len() <= MOST_FEET && stands.len() == feet.len() * timeline.frame_count() as usize;
        let holds = |foot: &Vec<FootVertex>| {
            foot.is_sorted_by(|a, b| a.vertex < b.vertex)
                && foot.last().is_some_and(|last| (last.vertex as usize) < vertex_count)
                && foot.iter().all(|vertex| vertex.leg > 0)
                && foot.iter().any(|vertex| vertex.sole > 0)
        };
        (fits && feet.iter().all(holds)).then_some(Self { feet, stands })
    }

    /// Number of feet.
    #[must_use]
    pub fn count(&self) -> usize {
        self.feet.len()
    }

    /// The vertices that foot `foot` moves, in ascending order; none where there is no such foot.
    #[must_use]
    pub fn vertices(&self, foot: usize) -> &[FootVertex] {
        self.feet.get(foot).map_or(&[], Vec::as_slice)
    }

    /// Whether foot `foot` stands in `frame`.
    #[must_use]
    pub fn stands(&self, frame: u32, foot: usize) -> bool {
        let at = (frame as usize).saturating_mul(self.feet.len()).saturating_add(foot);
        foot < self.feet.len() && self.stands.get(at).is_some_and(|&stands| stands)
    }
}
