//! Laplacians of meshes: a pattern, and weights over it.
//!
//! This work is based on: Boukhayma, thesis (2017), equation 2.40: `(L v)_k = sum over l of w_kl (v_k - v_l)`. Cotangent
//! weights are those of that equation, half the sum of the cotangents opposite to the edge, and are not clamped; uniform
//! weights and any others are there too.
//!
//! Who solves with a Laplacian alone holds one vertex of each connected component, its *anchor*, which takes the null vectors
//! away: [`LaplacianPattern::new`] renumbers the vertices in an order of elimination, anchors last and left out. Who adds
//! constraints of his own keeps the mesh's numbers and holds nothing: [`LaplacianPattern::unheld`].
//!
//! Here the last vertex of a strip is drawn aside; the others follow as a sheet of rubber would:
//!
//! ```
//! use glam::Vec3;
//! use kernels::cholesky::{ConstrainedFactor, Constraints, EliminationOrder, SolveScratch, Symbolic, Workspace};
//! use kernels::gradients::TriangleBatches;
//! use kernels::laplacian::{Laplacian, LaplacianPattern};
//! use kernels::topology::Topology;
//!
//! let pose = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [2.0, 0.5]].map(|[x, y]| Vec3::new(x, y, 0.0));
//! let triangles = vec![[0, 2, 1], [2, 3, 1], [2, 4, 3]];
//! let topology = Topology::new(5, triangles, vec![1.0; 5]).unwrap();
//! let batches = TriangleBatches::new(topology.triangles());
//!
//! // The pose's Laplacian, negative weights clamped.
//! let pattern = LaplacianPattern::unheld(&topology, &batches, &[])?;
//! let mut laplacian = Laplacian::default();
//! pattern.assemble(&batches, &pose, &mut laplacian);
//! pattern.change_weights(&mut laplacian, |_, weight| weight.max(1e-3));
//!
//! // What keeps the shape is the Laplacian of the pose; two vertices stay and one is drawn.
//! let symmetric = pattern.symmetric();
//! let symbolic = Symbolic::new(symmetric, &EliminationOrder::minimum_degree(symmetric))?;
//! let mut constraints = Constraints::new();
//! constraints.hard(0);
//! constraints.hard(1);
//! constraints.soft(4, 30.0);
//! let mut workspace = Workspace::default();
//! let matrix = pattern.matrix(&laplacian);
//! let factor = ConstrainedFactor::<f32>::new(&symbolic, &matrix, &constraints, &mut workspace)?;
//! let mut places: Vec<f32> = pattern.multiply_points(&laplacian, &pose).iter().flat_map(|v| v.to_array()).collect();
//! let wanted = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 0.5, 0.5];
//! factor.solve(&symbolic, &wanted, 3, &mut places, &mut SolveScratch::default())?;
//! assert_eq!(places[..6], wanted[..6]);
//! assert!((places[14] - 0.5).abs() < 0.05 && places[8] > 0.1);
//! # Ok::<(), kernels::cholesky::CholeskyError>(())
//! ```

mod cotangents;
mod numbering;

use glam::{Vec3, Vec4};

use crate::cholesky::{CholeskyError, EliminationOrder, Symbolic, SymmetricEntries, SymmetricMatrix, SymmetricPattern};
use crate::components::connected_components;
use crate::gradients::TriangleBatches;
use crate::lanes::{LANES, Lanes};
use crate::topology::Topology;
use cotangents::set_half_cotangents;
use numbering::{anchors_last, check_ties, number_edges};

/// Which entries the Laplacian of any pose has, and where each triangle's weights go.
///
/// Rows are *positions*: the vertices in an order of elimination ([`Self::new`]) or as the mesh has them
/// ([`Self::unheld`]).
#[derive(Clone, Debug)]
pub struct LaplacianPattern {
    /// Vertices by position, anchors last.
    order: EliminationOrder,
    position_of_vertex: Vec<u32>,
    free_count: usize,
    pattern: SymmetricPattern,
    /// Edge opposite to each corner of each triangle, as the triangles' batches; the filling, and sides from a vertex to
    /// itself, point behind the last edge.
    edge_of_corner: Vec<[[u32; LANES]; 3]>,
}

/// The Laplacian of a pose, in single precision.
///
/// Its diagonal is rounded, too, so that its rows sum to zero only nearly, which is as good as a constraint of a weight of
/// 1e-7. That does no harm where a vertex of each component is held; where constraints are to hold the mesh, factorise
/// [`LaplacianPattern::matrix`], which knows a part that nothing holds.
#[derive(Clone, Debug, Default)]
pub struct Laplacian {
    /// Half cotangents at the three corners of each triangle, by batch.
    pub(crate) half_cotangents: Vec<[Lanes; 3]>,
    /// Weight of each edge of the pattern.
    weights: Vec<f32>,
    /// Diagonal entries, anchors' included.
    pub(crate) diagonal: Vec<f32>,
    /// The weights in the order of the pattern's rows.
    entries: Vec<f32>,
}

impl LaplacianPattern {
    /// The pattern of the Laplacians over `topology`, whose triangles are `triangles`. Vertices are eliminated in the
    /// order `order`; the last one of each component is its anchor, and is not.
    ///
    /// # Errors
    /// [`CholeskyError::Order`] where `order` does not name every vertex once.
    pub fn new(topology: &Topology, triangles: &TriangleBatches, order: &[u32]) -> Result<Self, CholeskyError> {
        let components = (topology.component_of_vertex(), topology.component_count());
        let order = anchors_last(components, order)?;
        Ok(Self::numbered(topology, triangles, order, topology.component_count(), &[]))
    }

    /// As [`Self::new`], with further edges, *ties*, between vertices: parts that are tied together have one anchor. Ties
    /// have no weight until [`Self::change_weights`] gives them one.
    ///
    /// # Errors
    /// [`CholeskyError::Order`]; [`CholeskyError::NoRow`] where a tie names a vertex that does not exist.
    pub fn tied(
        topology: &Topology,
        triangles: &TriangleBatches,
        order: &[u32],
        ties: &[[u32; 2]],
    ) -> Result<Self, CholeskyError> {
        check_ties(topology, ties)?;
        let sides = topology.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [a, c]]);
        let (component_of_vertex, count) =
            connected_components(topology.vertex_count(), sides.chain(ties.iter().copied()));
        let order = anchors_last((&component_of_vertex, count), order)?;
        Ok(Self::numbered(topology, triangles, order, count, ties))
    }

    /// The pattern in the mesh's own numbering, no vertex held, with further edges as in [`Self::tied`]. For systems with
    /// constraints of their own: see [`crate::cholesky::ConstrainedFactor`].
    ///
    /// # Errors
    /// [`CholeskyError::NoRow`] where a tie names a vertex that does not exist.
    pub fn unheld(topology: &Topology, triangles: &TriangleBatches, ties: &[[u32; 2]]) -> Result<Self, CholeskyError> {
        check_ties(topology, ties)?;
        Ok(Self::numbered(topology, triangles, EliminationOrder::natural(topology.vertex_count()), 0, ties))
    }

    fn numbered(
        topology: &Topology,
        triangles: &TriangleBatches,
        order: EliminationOrder,
        anchors: usize,
        ties: &[[u32; 2]],
    ) -> Self {
        let position_of_vertex = order.positions();
        let (edges, edge_of_corner) = number_edges(triangles, &position_of_vertex, ties);
        let pattern = SymmetricPattern::from_sorted(topology.vertex_count(), edges);
        Self { free_count: topology.vertex_count() - anchors, order, position_of_vertex, pattern, edge_of_corner }
    }

    /// The vertices by position: in the order of elimination, the anchors last.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        self.order.rows()
    }

    /// Number of vertices that are not anchors.
    #[must_use]
    pub fn free_count(&self) -> usize {
        self.free_count
    }

    /// Position of each vertex.
    #[must_use]
    pub fn position_of_vertex(&self) -> &[u32] {
        &self.position_of_vertex
    }

    /// The pattern by positions, anchors included.
    #[must_use]
    pub fn symmetric(&self) -> &SymmetricPattern {
        &self.pattern
    }

    /// The analysis of the pattern in the order of its positions, anchors left out.
    ///
    /// # Errors
    /// As [`Symbolic::of_first`].
    pub fn symbolic(&self) -> Result<Symbolic, CholeskyError> {
        Symbolic::of_first(&self.pattern, &EliminationOrder::natural(self.pattern.row_count()), self.free_count)
    }

    /// Sets `laplacian` to that of `pose`, in metres, with cotangent weights.
    pub fn assemble(&self, triangles: &TriangleBatches, pose: &[Vec3], laplacian: &mut Laplacian) {
        set_half_cotangents(triangles, pose, &mut laplacian.half_cotangents);
        let weights = &mut laplacian.weights;
        weights.clear();
        weights.resize(self.pattern.edges().len() + 1, 0.0);
        for (edges, cotangents) in self.edge_of_corner.iter().zip(&laplacian.half_cotangents) {
            for corner in 0..3 {
                let numbers = cotangents[corner].numbers();
                for lane in 0..LANES {
                    weights[edges[corner][lane] as usize] += numbers[lane];
                }
            }
        }
        weights.pop();
        self.set_entries(laplacian);
    }

    /// Sets `laplacian` to that of weight 1 on every edge, ties included.
    pub fn assemble_uniform(&self, laplacian: &mut Laplacian) {
        laplacian.half_cotangents.clear();
        laplacian.weights.clear();
        laplacian.weights.resize(self.pattern.edges().len(), 1.0);
        self.set_entries(laplacian);
    }

    /// Sets `laplacian` to that of these weights, one for each edge of [`Self::symmetric`].
    ///
    /// # Errors
    /// [`CholeskyError::Shape`] where there are more or fewer.
    pub fn assemble_given(&self, weights: &[f32], laplacian: &mut Laplacian) -> Result<(), CholeskyError> {
        let (found, expected) = (weights.len(), self.pattern.edges().len());
        if found != expected {
            return Err(CholeskyError::Shape { what: "weights", found, expected });
        }
        laplacian.half_cotangents.clear();
        laplacian.weights.clear();
        laplacian.weights.extend_from_slice(weights);
        self.set_entries(laplacian);
        Ok(())
    }

    /// Replaces the weight of each edge by what `change` makes of it and the edge's two vertices: clamps weights, or gives
    /// ties theirs.
    pub fn change_weights(&self, laplacian: &mut Laplacian, mut change: impl FnMut([u32; 2], f32) -> f32) {
        for (weight, ends) in laplacian.weights.iter_mut().zip(self.pattern.edges()) {
            *weight = change(ends.map(|position| self.order()[position as usize]), *weight);
        }
        self.set_entries(laplacian);
    }

    /// Sets all that follows from the weights.
    fn set_entries(&self, laplacian: &mut Laplacian) {
        laplacian.diagonal.clear();
        laplacian.diagonal.resize(self.pattern.row_count(), 0.0);
        for (&[k, l], &weight) in self.pattern.edges().iter().zip(&laplacian.weights) {
            laplacian.diagonal[k as usize] += weight;
            laplacian.diagonal[l as usize] += weight;
        }
        laplacian.entries.clear();
        laplacian.entries.extend(self.pattern.edge_of_entry().iter().map(|&edge| laplacian.weights[edge as usize]));
    }

    /// `out = L x` for the free vertices, by position, the anchors held at zero; one number a lane.
    pub fn multiply(&self, laplacian: &Laplacian, x: &[Vec4], out: &mut [Vec4]) {
        let x = &x[..self.free_count];
        for row in 0..self.free_count {
            let mut sum = x[row] * laplacian.diagonal[row];
            let entries = &laplacian.entries[self.pattern.entries(row)];
            for (&column, &weight) in self.pattern.row(row).0.iter().zip(entries) {
                // Anchors are the last columns.
                let Some(&x) = x.get(column as usize) else { break };
                sum -= x * weight;
            }
            out[row] = sum;
        }
    }

    /// `L x` for all vertices, `x` and the result by vertex: the differential coordinates of a pose.
    #[must_use]
    pub fn multiply_points(&self, laplacian: &Laplacian, x: &[Vec3]) -> Vec<Vec3> {
        let mut out = vec![Vec3::ZERO; self.pattern.row_count()];
        for (&ends, &weight) in self.pattern.edges().iter().zip(&laplacian.weights) {
            let [k, l] = ends.map(|position| self.order()[position as usize] as usize);
            let pull = (x[k] - x[l]) * weight;
            out[k] += pull;
            out[l] -= pull;
        }
        out
    }

    /// The Laplacian as a matrix in double precision, by position. Its rows sum to zero as nearly as double precision can.
    #[must_use]
    pub fn matrix(&self, laplacian: &Laplacian) -> SymmetricMatrix {
        let mut matrix = SymmetricMatrix::zeros(&self.pattern);
        for (edge, (&ends, &weight)) in self.pattern.edges().iter().zip(&laplacian.weights).enumerate() {
            matrix.off_diagonal_mut()[edge] = -f64::from(weight);
            for end in ends {
                matrix.diagonal_mut()[end as usize] += f64::from(weight);
            }
        }
        matrix
    }
}

impl Laplacian {
    /// The weight of each edge of the pattern.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The diagonal by position: for each vertex the sum of its edges' weights.
    #[must_use]
    pub fn diagonal(&self) -> &[f32] {
        &self.diagonal
    }
}

impl SymmetricEntries for Laplacian {
    fn size(&self) -> [usize; 2] {
        [self.diagonal.len(), self.weights.len()]
    }

    fn diagonal(&self, row: usize) -> f64 {
        f64::from(self.diagonal[row])
    }

    fn off_diagonal(&self, edge: usize) -> f64 {
        -f64::from(self.weights[edge])
    }
}
