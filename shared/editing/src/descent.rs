//! How a drag by modes comes to rest: a step at a time, so that a page can do other work between.

use glam::{Quat, Vec3};
use kernels::cholesky::CholeskyError;

use crate::deform::{Deformer, Held};
use crate::learned::{Learned, System};

/// Iterations without modes, how often the system is made anew then, and iterations with each.
const RIGID_ITERATIONS: usize = 15;
const ROUNDS: usize = 4;
const ITERATIONS: usize = 6;
/// There are several valleys. From modes one gets into those where modes explain what a turn would; from turns alone, into those where
/// modes come too late. The lower one counts.
const STARTS: [usize; 2] = [0, RIGID_ITERATIONS];
/// It rests where no vertex moves further than this, in metres.
const STILL: f32 = 1e-4;

/// The way into each valley.
pub(crate) struct Descent {
    /// Which of the starts.
    start: usize,
    next: Next,
    displacements: Vec<Vec3>,
    lowest: Option<Valley>,
}

/// What is done next.
enum Next {
    /// So many iterations without modes, and then the system.
    Turn(usize),
    /// The system is made anew: how often it was before.
    Prepare(usize, System),
    /// An iteration with modes: of which system, and how many there were.
    Iterate(usize, usize),
}

/// Where a descent has come to rest.
struct Valley {
    energy: f64,
    displacements: Vec<Vec3>,
    turns: Vec<Quat>,
    rest: Vec<Vec3>,
}

impl Descent {
    /// From the pose that was grabbed, of `count` vertices.
    pub(crate) fn new(learned: &mut Learned, count: usize) -> Self {
        learned.begin();
        Self { start: 0, next: Next::Turn(STARTS[0]), displacements: vec![Vec3::ZERO; count], lowest: None }
    }

    /// One step: an iteration, or a part of a system. Displacements of all vertices once it is at rest.
    pub(crate) fn step(
        &mut self,
        learned: &mut Learned,
        deformer: &mut Deformer,
        held: &Held,
        (pose, wanted): (&[Vec3], &[Vec3]),
    ) -> Result<Option<Vec<Vec3>>, CholeskyError> {
        match &mut self.next {
            Next::Turn(0) => self.next = Next::Prepare(0, learned.begin_system(deformer)),
            Next::Turn(left) => {
                *left -= 1;
                self.displacements = learned.iterate(deformer, held, pose, wanted, false)?;
            }
            Next::Prepare(round, system) => {
                if learned.add_some(system, deformer, held, pose)? {
                    self.next = Next::Iterate(*round, 0);
                }
            }
            &mut Next::Iterate(round, iteration) => {
                let next = learned.iterate(deformer, held, pose, wanted, true)?;
                let moved = next.iter().zip(&self.displacements).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
                self.displacements = next;
                let is_still = moved < STILL;
                // For this system nothing moves any more; nor did it for the one before, where it is the first iteration.
                let is_rest = is_still && iteration == 0;
                if !is_still && iteration + 1 < ITERATIONS {
                    self.next = Next::Iterate(round, iteration + 1);
                } else if !is_rest && round + 1 < ROUNDS {
                    self.next = Next::Prepare(round + 1, learned.begin_system(deformer));
                } else {
                    return Ok(self.arrive(learned, deformer, held, pose));
                }
            }
        }
        Ok(None)
    }

    /// At the ground of one valley: on to the next start, or the lowest of them.
    fn arrive(&mut self, learned: &mut Learned, deformer: &Deformer, held: &Held, pose: &[Vec3]) -> Option<Vec<Vec3>> {
        let energy = learned.energy(deformer, held, pose, &self.displacements);
        if self.lowest.as_ref().is_none_or(|other| energy < other.energy) {
            let (turns, rest) = (learned.turns().to_vec(), learned.rest().to_vec());
            let displacements = std::mem::take(&mut self.displacements);
            self.lowest = Some(Valley { energy, displacements, turns, rest });
        }
        self.start += 1;
        if let Some(&rigid) = STARTS.get(self.start) {
            learned.begin();
            self.displacements = vec![Vec3::ZERO; pose.len()];
            self.next = Next::Turn(rigid);
            return None;
        }
        let lowest = self.lowest.take()?;
        learned.take(lowest.turns, lowest.rest);
        Some(lowest.displacements)
    }
}
