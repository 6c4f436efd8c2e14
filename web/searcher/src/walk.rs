//! Walks as numbers: what the searcher's memory holds, for the player's.

use actor::walk::Leg;
use glam::Vec2;
use kernels::align::Placement;
use search::{Answer, Start};

/// Numbers before the legs, and of each leg.
const HEAD: usize = 4;
const LEG: usize = 4;

/// Where the walk of `answer` begins (frame, heading, x, z), then its legs: recorded 0, synthetic 1 or back 2, and up to three
/// numbers more.
#[must_use]
pub fn numbers(answer: &Answer) -> Vec<f64> {
    let [heading, x, z] = answer.start_placement.map(f64::from);
    let mut numbers = vec![answer.start_frame.into(), heading, x, z];
    for leg in &answer.walk.legs {
        numbers.extend(match *leg {
            Leg::Recorded { first, last, steps } => [0, first, last, steps].map(f64::from),
            Leg::Synthetic(edge) => [1, edge, 0, 0].map(f64::from),
            Leg::Back { first, last, steps } => [2, first, last, steps].map(f64::from),
        });
    }
    numbers
}

/// The walk that [`numbers`] wrote: where it begins, and its legs. `None` for other numbers.
#[must_use]
pub fn from_numbers(numbers: &[f64]) -> Option<(Start, Vec<Leg>)> {
    let (head, legs) = numbers.split_at_checked(HEAD)?;
    let placement = Placement { heading: head[1] as f32, translation: Vec2::new(head[2] as f32, head[3] as f32) };
    let leg = |leg: &[f64]| {
        let [first, last, steps] = [leg[1] as u32, leg[2] as u32, leg[3] as u32];
        match leg[0] as u32 {
            0 => Some(Leg::Recorded { first, last, steps }),
            1 => Some(Leg::Synthetic(first)),
            2 => Some(Leg::Back { first, last, steps }),
            _ => None,
        }
    };
    let chunks = legs.chunks_exact(LEG);
    let is_whole = chunks.remainder().is_empty();
    let legs = chunks.map(leg).collect::<Option<_>>()?;
    is_whole.then_some((Start { frame: head[0] as u32, placement }, legs))
}
