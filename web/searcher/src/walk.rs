//! Walks as numbers: what the searcher's memory holds, for the player's.

use actor::walk::{Leg, Walk};
use glam::Vec2;
use kernels::align::Placement;
use search::{Answer, Start};

/// Numbers before the legs, and of each leg and step of the bend.
const HEAD: usize = 4;
const LEG: usize = 4;

/// Where the walk of `answer` begins (frame, heading, x, z), then its legs: recorded 0, synthetic 1 or back 2, and up to three
/// numbers more; then its bend: 3, heading, x and z.
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
    for &[heading, x, z] in &answer.walk.bend {
        numbers.extend([3.0, heading, x, z].map(f64::from));
    }
    numbers
}

/// The walk that [`numbers`] wrote, without its sums, and where it begins. `None` for other numbers.
#[must_use]
pub fn from_numbers(numbers: &[f64]) -> Option<(Start, Walk)> {
    let (head, legs) = numbers.split_at_checked(HEAD)?;
    let placement = Placement { heading: head[1] as f32, translation: Vec2::new(head[2] as f32, head[3] as f32) };
    let mut walk = Walk::default();
    let chunks = legs.chunks_exact(LEG);
    let is_whole = chunks.remainder().is_empty();
    for leg in chunks {
        let [first, last, steps] = [leg[1] as u32, leg[2] as u32, leg[3] as u32];
        match leg[0] as u32 {
            0 => walk.legs.push(Leg::Recorded { first, last, steps }),
            1 => walk.legs.push(Leg::Synthetic(first)),
            2 => walk.legs.push(Leg::Back { first, last, steps }),
            3 if leg.iter().all(|number| number.abs() < 1e6) => {
                walk.bend.push([leg[1] as f32, leg[2] as f32, leg[3] as f32]);
            }
            _ => return None,
        }
    }
    is_whole.then_some((Start { frame: head[0] as u32, placement }, walk))
}
