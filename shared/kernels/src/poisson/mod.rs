//! Poisson shape interpolation: the surface between two poses whose triangles rotate and stretch evenly.
//!
//! This work is based on: Boukhayma, thesis (2017), section 2.4.3, equations 2.46 to 2.49; Boukhayma and Boyer, TVCG
//! equations 5 to 7; Xu, Zhang, Wang and Bao, "Poisson shape interpolation" (2005). Both sides are solved, each on its
//! own pose's cotangent Laplacian, and blended linearly.
//!
//! Exact to a stated tolerance: see [`TOLERANCE`]. What makes it fast is that both sides want the same edges
//! ([`crate::gradients`]); that the system is solved for what is missing from a good guess, the linear blend plus what
//! the frame before differed from its own; and that the factor of a pose a few frames away needs one or two iterations.

mod components;
mod conjugate_gradients;
mod factors;

use std::sync::Arc;

use glam::{Vec3, Vec4};

use crate::cholesky::{CholeskyError, EliminationOrder, Symbolic, Workspace};
use crate::gradients::{Batch, PairGradients, TriangleBatches};
use crate::lanes::{LANES, Lanes, Lanes3};
use crate::laplacian::{Laplacian, LaplacianPattern};
use crate::lru::LruCache;
use crate::topology::Topology;
use components::MeshComponents;
use conjugate_gradients::{Preconditioner, Stop, System};
use factors::KeptFactor;

/// Estimated largest error at a vertex, in metres, at which iterations stop. The estimate is no bound: it can be several
/// times too small where a pose's triangles are much softer than those of the factor's pose. Against exact solutions in
/// double precision the error stays below [`GUARANTEE`], which the tests check on captures.
pub const TOLERANCE: f32 = 1e-4;

/// Largest error at a vertex, in metres, that the tests allow against exact solutions.
pub const GUARANTEE: f32 = 3e-4;

/// Solves spent with another pose's factor before the pose gets its own: a little more than a factorisation costs.
const PATIENCE: usize = 12;

/// Solves spent with a pose's own factor at most; one is enough unless its Laplacian had to be regularised.
const MOST_SOLVES: usize = 60;

/// Factors that are kept.
const KEPT_FACTORS: usize = 6;

/// Laplacians that are kept.
const KEPT_LAPLACIANS: usize = 4;

/// A recorded pose, aligned and placed by whoever asks.
#[derive(Clone, Copy, Debug)]
pub struct KeyedPose<'a> {
    /// The frame it was recorded as; neighbouring frames are expected to hold similar poses.
    pub frame: u32,
    /// Its vertex positions in metres, possibly turned and moved.
    pub pose: &'a [Vec3],
}

/// What an interpolation took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Triangular solves for the source's and the destination's side.
    pub solves: [usize; 2],
    /// Numeric factorisations.
    pub factorisations: usize,
    /// Pivots that had to be regularised in the factors used.
    pub regularised: usize,
    /// Estimate of the largest error at a vertex in metres.
    pub error: f32,
}

/// What an interpolator remembers of the poses before: it decides how the next one is solved, and so its last bits.
#[derive(Clone)]
pub struct Memory {
    laplacians: LruCache<Arc<Laplacian>>,
    factors: LruCache<KeptFactor>,
}

impl Memory {
    fn new() -> Self {
        Self { laplacians: LruCache::new(KEPT_LAPLACIANS), factors: LruCache::new(KEPT_FACTORS) }
    }
}

/// An interpolation that has begun.
struct UnderWay {
    sides: [Side; 2],
    /// The side that is being solved.
    side: usize,
    /// Whether it has begun.
    has_begun: bool,
    effort: Effort,
}

/// One side of an interpolation.
#[derive(Clone, Copy)]
struct Side {
    frame: u32,
    weight: f32,
    laplacian: usize,
}

/// Interpolates between poses of one topology.
pub struct PoissonInterpolator {
    triangles: TriangleBatches,
    pattern: LaplacianPattern,
    symbolic: Symbolic,
    workspace: Workspace,
    components: MeshComponents,
    memory: Memory,
    under_way: Option<UnderWay>,
    gradients: PairGradients,
    system: System,
    /// By vertex: the linear blend, what the solution differs from it, and the guess that the system starts from.
    blend: Vec<Vec4>,
    guess: Vec<Vec4>,
    offset: Vec<Vec4>,
    /// What is missing at each vertex for the source's and the destination's side.
    missing: [Vec<Vec4>; 2],
}

impl PoissonInterpolator {
    /// An interpolator over `topology`; `order` is an elimination order found before ([`Self::elimination_order`]), or
    /// `None` to find one.
    ///
    /// # Errors
    /// An order that does not name each vertex once, or one by which the Laplacian fills in.
    pub fn new(topology: &Topology, order: Option<&[u32]>) -> Result<Self, CholeskyError> {
        let triangles = TriangleBatches::new(topology.triangles());
        let pattern = match order {
            Some(order) => LaplacianPattern::new(topology, &triangles, order)?,
            None => {
                // As `cholesky::elimination_order`, with no more code on the page than the pattern itself needs.
                let unheld = LaplacianPattern::unheld(topology, &triangles, &[])?;
                let order = EliminationOrder::minimum_degree(unheld.symmetric());
                LaplacianPattern::new(topology, &triangles, order.rows())?
            }
        };
        let symbolic = pattern.symbolic()?;
        let n = topology.vertex_count();
        Ok(Self {
            triangles,
            pattern,
            symbolic,
            workspace: Workspace::default(),
            components: MeshComponents::new(topology),
            memory: Memory::new(),
            under_way: None,
            gradients: PairGradients::default(),
            system: System::default(),
            blend: vec![Vec4::ZERO; n],
            guess: vec![Vec4::ZERO; n],
            offset: vec![Vec4::ZERO; n],
            missing: [vec![Vec4::ZERO; n], vec![Vec4::ZERO; n]],
        })
    }

    /// The order in which vertices are eliminated, to be stored and given to [`Self::new`].
    #[must_use]
    pub fn elimination_order(&self) -> &[u32] {
        self.pattern.order()
    }

    /// Forgets the frame before: the next interpolation starts from the linear blend.
    pub fn restart(&mut self) {
        self.offset.fill(Vec4::ZERO);
    }

    /// Forgets all poses: those of the frames that follow are others.
    pub fn forget_poses(&mut self) {
        self.recall(Memory::new());
    }

    /// What it remembers now.
    #[must_use]
    pub fn memory(&self) -> Memory {
        self.memory.clone()
    }

    /// Goes back to what it remembered then: an interpolation begun since has never been.
    pub fn recall(&mut self, memory: Memory) {
        self.memory = memory;
        self.under_way = None;
        self.restart();
    }

    /// Writes the pose at `lambda` between `source` (0) and `destination` (1) into `out`, all of one element per vertex
    /// and already aligned and placed. Each component's centre moves on the straight line between the two.
    ///
    /// # Errors
    /// A pose that is not finite.
    pub fn interpolate(
        &mut self,
        source: KeyedPose<'_>,
        destination: KeyedPose<'_>,
        lambda: f32,
        out: &mut [Vec3],
    ) -> Result<Effort, CholeskyError> {
        if lambda <= 0.0 || lambda >= 1.0 {
            out.copy_from_slice(if lambda <= 0.0 { source.pose } else { destination.pose });
            self.restart();
            return Ok(Effort::default());
        }
        self.begin([source, destination], lambda);
        while !self.advance()? {}
        Ok(self.finish(out))
    }

    /// Makes the Laplacian of a recorded pose: poses of the same frame that follow are weighed by it, wherever they are
    /// placed, those between this frame and the next one, too.
    pub fn weigh(&mut self, recorded: KeyedPose<'_>) {
        self.laplacian(recorded);
    }

    /// Begins an interpolation that is worked on a piece at a time: as [`Self::interpolate`] does it all at once, for a
    /// `lambda` between 0 and 1.
    pub fn begin(&mut self, [source, destination]: [KeyedPose<'_>; 2], lambda: f32) {
        self.gradients.set(&self.triangles, source.pose, destination.pose);
        let laplacians = [self.laplacian(source), self.laplacian(destination)];
        self.blend(source.pose, destination.pose, lambda);
        self.find_missing(laplacians, lambda);
        let sides = [
            Side { frame: source.frame, weight: 1.0 - lambda, laplacian: laplacians[0] },
            Side { frame: destination.frame, weight: lambda, laplacian: laplacians[1] },
        ];
        self.under_way = Some(UnderWay { sides, side: 0, has_begun: false, effort: Effort::default() });
    }

    /// Does the next piece of what was begun: at most one factorisation, and the solves with one factor. True once all is
    /// done, and where nothing was begun.
    ///
    /// # Errors
    /// A pose that is not finite; the interpolation is dropped.
    pub fn advance(&mut self) -> Result<bool, CholeskyError> {
        let Some(mut under_way) = self.under_way.take() else { return Ok(true) };
        if let Some(&side) = under_way.sides.get(under_way.side)
            && self.solve(side, &mut under_way).inspect_err(|_| self.restart())?
        {
            for (&vertex, &correction) in self.pattern.order().iter().zip(&self.system.correction) {
                self.offset[vertex as usize] += correction * side.weight;
            }
            (under_way.side, under_way.has_begun) = (under_way.side + 1, false);
        }
        let is_done = under_way.side == under_way.sides.len();
        self.under_way = Some(under_way);
        Ok(is_done)
    }

    /// What the interpolation under way has taken so far; nothing where none is.
    #[must_use]
    pub fn effort(&self) -> Effort {
        self.under_way.as_ref().map_or_else(Effort::default, |under_way| under_way.effort)
    }

    /// Writes the pose that was begun, once [`Self::advance`] has said that all is done, into `out`.
    pub fn finish(&mut self, out: &mut [Vec3]) -> Effort {
        self.components.centre(&mut self.offset);
        for ((out, &blend), &offset) in out.iter_mut().zip(&self.blend).zip(&self.offset) {
            *out = (blend + offset).truncate();
        }
        self.under_way.take().map_or_else(Effort::default, |under_way| under_way.effort)
    }

    /// Slot of the Laplacian of a pose, which does not depend on where the pose is placed.
    fn laplacian(&mut self, pose: KeyedPose<'_>) -> usize {
        let laplacians = &mut self.memory.laplacians;
        laplacians.find(pose.frame).unwrap_or_else(|| {
            let slot = laplacians.claim(pose.frame);
            let kept = laplacians.get_mut(slot);
            // One that somebody else remembers is left as it is; one that nobody does is written over.
            if Arc::get_mut(kept).is_none() {
                *kept = Arc::default();
            }
            self.pattern.assemble(&self.triangles, pose.pose, Arc::make_mut(kept));
            slot
        })
    }

    /// Slot of a new factor of a pose.
    fn factorise(&mut self, frame: u32, laplacian: usize, effort: &mut Effort) -> Result<usize, CholeskyError> {
        let laplacian: &Laplacian = self.memory.laplacians.get(laplacian);
        let factor = self.symbolic.factorise_regularised(laplacian, &mut self.workspace)?;
        effort.factorisations += 1;
        let kept = KeptFactor::new(frame, factor, &laplacian.diagonal);
        let slot = self.memory.factors.claim(frame);
        *self.memory.factors.get_mut(slot) = kept;
        Ok(slot)
    }

    /// Sets `blend` to the linear blend. The guess is the blend plus `offset`, what the frame before differed from its
    /// own.
    fn blend(&mut self, source: &[Vec3], destination: &[Vec3], lambda: f32) {
        for ((blend, &from), &to) in self.blend.iter_mut().zip(source).zip(destination) {
            *blend = (from + (to - from) * lambda).extend(0.0);
        }
    }

    /// Sets `missing` to the right sides of both systems minus their Laplacians times the guess, triangle by triangle:
    /// each edge pulls its ends by its weight times what it wants beyond what it has.
    fn find_missing(&mut self, laplacians: [usize; 2], lambda: f32) {
        for ((guess, &blend), &offset) in self.guess.iter_mut().zip(&self.blend).zip(&self.offset) {
            *guess = blend + offset;
        }
        let [source, destination] = &mut self.missing;
        source.fill(Vec4::ZERO);
        destination.fill(Vec4::ZERO);
        let source_weights = &self.memory.laplacians.get(laplacians[0]).half_cotangents;
        let destination_weights = &self.memory.laplacians.get(laplacians[1]).half_cotangents;
        for (index, batch) in self.triangles.batches().iter().enumerate() {
            let wanted = self.gradients.edges(index, lambda);
            let has = batch.edges4(&self.guess);
            let pulls = [wanted[0] - has[0], wanted[1] - has[1]];
            scatter(batch, pulls, &source_weights[index], source);
            scatter(batch, pulls, &destination_weights[index], destination);
        }
    }

    /// Solves one side with one factor: first one that is at hand, then the pose's own. Whether that was enough; the
    /// solution is the guess plus `system.correction`.
    fn solve(&mut self, side: Side, under_way: &mut UnderWay) -> Result<bool, CholeskyError> {
        let Side { frame, weight, laplacian } = side;
        let effort = &mut under_way.effort;
        let mut at_hand = None;
        if !under_way.has_begun {
            under_way.has_begun = true;
            self.system.reset(self.pattern.free_count());
            for (residual, &vertex) in self.system.residual.iter_mut().zip(self.pattern.order()) {
                *residual = self.missing[under_way.side][vertex as usize];
            }
            let factors = &mut self.memory.factors;
            at_hand = factors.nearest(frame).filter(|&slot| !factors.get(slot).is_worn_out(frame));
        }
        let slot = match at_hand {
            Some(slot) => slot,
            None => self.factorise(frame, laplacian, effort)?,
        };
        let kept = self.memory.factors.get(slot);
        let own = kept.frame == frame;
        let outcome = self.system.run(
            &self.pattern,
            self.memory.laplacians.get(laplacian),
            &Preconditioner { symbolic: &self.symbolic, factor: &kept.factor, diagonal: &kept.diagonal },
            Stop {
                expected: kept.expected_contraction(frame),
                // An error counts by the weight of its side in the blend.
                tolerance: 0.5 * TOLERANCE / weight,
                most_solves: if own { MOST_SOLVES } else { PATIENCE },
            },
        );
        effort.solves[under_way.side] += outcome.solves;
        effort.regularised += kept.factor.regularised;
        effort.error += weight * outcome.error;
        if !outcome.error.is_finite() {
            return Err(CholeskyError::NotFinite);
        }
        self.memory.factors.get_mut(slot).learn(frame, &outcome);
        if outcome.done || own {
            return Ok(true);
        }
        effort.error -= weight * outcome.error;
        Ok(false)
    }
}

/// Adds to each corner what its two edges pull it by.
#[inline(always)]
fn scatter(batch: &Batch, [first, second]: [Lanes3; 2], half_cotangents: &[Lanes; 3], sums: &mut [Vec4]) {
    let opposite = (second - first).scale(half_cotangents[0]);
    let second = second.scale(half_cotangents[1]);
    let first = first.scale(half_cotangents[2]);
    let pulls = [-(first + second), first - opposite, second + opposite];
    let [a, b, c] = [pulls[0].vectors(), pulls[1].vectors(), pulls[2].vectors()];
    let corners = batch.corners();
    for lane in 0..LANES {
        sums[corners[0][lane] as usize] += a[lane];
        sums[corners[1][lane] as usize] += b[lane];
        sums[corners[2][lane] as usize] += c[lane];
    }
}
