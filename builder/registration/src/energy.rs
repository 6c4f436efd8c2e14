//! The equations of a Gauss-Newton step of the deformation graph.
//!
//! Vertex i lies at x_i = sum over its nodes k of w_ik (R_k (b_i - g_k) + g_k + t_k): b_i its rest place, g_k the node's. A
//! step turns node k by a small angle o_k and moves it by s_k, which moves the vertex by
//! sum of w_ik (o_k x R_k (b_i - g_k) + s_k). Whatever pulls at a vertex is linear in that: the rows n . (x_i - y) = r of one
//! vertex, whatever they are, are summed to one matrix and one vector before nodes are looked at, so that a vertex costs the
//! same however many rows it has.

use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Mat, Par, Side};
use glam::{DMat3, DQuat, DVec3, Vec3};
use rayon::prelude::*;

use super::graph::{CARRIERS, Graph, Motion};

/// Unknowns of a node: three of its turn, three of its move.
const SIZE: usize = 6;
/// Added to the diagonal, as a part of its mean: what nothing pulls at stays.
const DAMPING: f64 = 1e-9;

/// What pulls at a vertex: the sum of the squares of w (n . d + r) over its rows, d being how the vertex moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pull {
    /// Sum of w n n^T.
    pub matrix: DMat3,
    /// Sum of w r n.
    pub vector: DVec3,
    /// Sum of w r^2.
    pub energy: f64,
}

impl Pull {
    /// Nothing.
    pub const NONE: Self = Self { matrix: DMat3::ZERO, vector: DVec3::ZERO, energy: 0.0 };

    /// Adds the row `direction` . d + `residual` with a weight.
    pub fn add(&mut self, weight: f32, direction: Vec3, residual: f32) {
        let (weight, direction, residual) = (f64::from(weight), direction.as_dvec3(), f64::from(residual));
        self.matrix += DMat3::from_cols(
            direction * (weight * direction.x),
            direction * (weight * direction.y),
            direction * (weight * direction.z),
        );
        self.vector += direction * (weight * residual);
        self.energy += weight * residual * residual;
    }

    /// Adds the three rows of d + `residual`.
    pub fn add_point(&mut self, weight: f32, residual: Vec3) {
        let (weight, residual) = (f64::from(weight), residual.as_dvec3());
        self.matrix += DMat3::from_diagonal(DVec3::splat(weight));
        self.vector += residual * weight;
        self.energy += weight * residual.length_squared();
    }
}

/// The equations' pattern, which does not change.
#[derive(Debug)]
pub struct System {
    nodes: usize,
    /// For each node the nodes that it has a block with, itself first, then those after it.
    rows: Vec<Vec<u32>>,
    /// Where the blocks of each node begin.
    first: Vec<usize>,
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLlt<usize>,
}

type Block = [[f64; SIZE]; SIZE];

/// The pose of a graph's vertices under the motions of its nodes.
#[must_use]
pub fn deform(graph: &Graph, rest: &[Vec3], motions: &[Motion]) -> Vec<Vec3> {
    let of = |(carriers, &b): (&[(u32, f32); CARRIERS], &Vec3)| {
        let mut sum = DVec3::ZERO;
        for &(node, share) in carriers {
            let (motion, g) = (&motions[node as usize], rest[graph.nodes[node as usize] as usize]);
            let moved = motion.rotation * (b - g).as_dvec3() + g.as_dvec3() + motion.translation;
            sum += moved * f64::from(share);
        }
        sum.as_vec3()
    };
    graph.carriers.par_iter().zip(rest).map(of).collect()
}

impl System {
    /// The pattern of `graph`; `None` where it has no nodes.
    #[must_use]
    pub fn new(graph: &Graph) -> Option<Self> {
        let nodes = graph.nodes.len();
        let mut rows: Vec<Vec<u32>> = (0..nodes as u32).map(|node| vec![node]).collect();
        for &[a, b] in &graph.edges {
            rows[a as usize].push(b);
        }
        rows.iter_mut().for_each(|row| row.sort_unstable());
        let mut first = vec![0; nodes + 1];
        for k in 0..nodes {
            first[k + 1] = first[k] + rows[k].len();
        }
        let (mut columns, mut places) = (vec![0], Vec::new());
        for (node, blocks) in rows.iter().enumerate() {
            for column in 0..SIZE {
                for &block in blocks {
                    let from = if block as usize == node { column } else { 0 };
                    places.extend((from..SIZE).map(|row| SIZE * block as usize + row));
                }
                columns.push(places.len());
            }
        }
        if nodes == 0 {
            return None;
        }
        let size = SIZE * nodes;
        let pattern = SymbolicSparseColMat::new_checked(size, size, columns, None, places);
        let symbolic = SymbolicLlt::try_new(pattern.as_ref(), Side::Lower).ok()?;
        Some(Self { nodes, rows, first, pattern, symbolic })
    }

    fn block(&self, low: usize, high: usize) -> Option<usize> {
        self.rows[low].binary_search(&(high as u32)).ok().map(|at| self.first[low] + at)
    }

    /// Takes a step: changes `motions` so that vertices give way to `pulls`, and nodes move as those beside them, with
    /// weight `stiffness`. Returns the energy before the step, or `None` where the equations cannot be solved.
    pub fn step(
        &self,
        graph: &Graph,
        rest: &[Vec3],
        pulls: &[Pull],
        stiffness: f64,
        motions: &mut [Motion],
    ) -> Option<f64> {
        let mut blocks: Vec<Block> = vec![[[0.0; SIZE]; SIZE]; self.first[self.nodes]];
        let mut right = vec![[0.0; SIZE]; self.nodes];
        let mut energy = 0.0;
        for (vertex, pull) in
            pulls.iter().enumerate().filter(|(_, pull)| pull.energy > 0.0 || pull.matrix != DMat3::ZERO)
        {
            energy += pull.energy;
            let carried = graph.carriers[vertex].map(|(node, share)| {
                let g = rest[graph.nodes[node as usize] as usize];
                (node as usize, f64::from(share), motions[node as usize].rotation * (rest[vertex] - g).as_dvec3())
            });
            for (k, &(a, share, p)) in carried.iter().enumerate().filter(|(_, carrier)| carrier.1 > 0.0) {
                add_right(&mut right[a], share, p, pull.vector);
                for &(b, other, q) in carried[k..].iter().filter(|carrier| carrier.1 > 0.0) {
                    // A block belongs to the lower node's column; its rows are those of the higher one.
                    let ((low, p_low), (high, p_high)) = if a <= b { ((a, p), (b, q)) } else { ((b, q), (a, p)) };
                    let Some(block) = self.block(low, high) else { continue };
                    add_block(&mut blocks[block], share * other, p_high, &pull.matrix, p_low);
                }
            }
        }
        energy += self.add_stiffness(graph, rest, motions, stiffness, &mut blocks, &mut right);
        let solution = self.solve(&blocks, &right)?;
        for (motion, step) in motions.iter_mut().zip(&solution) {
            let turn = DVec3::new(step[0], step[1], step[2]);
            motion.rotation = (DQuat::from_scaled_axis(turn) * motion.rotation).normalize();
            motion.translation += DVec3::new(step[3], step[4], step[5]);
        }
        Some(energy)
    }

    /// a / |E| times the sum over ordered pairs of |R_k (g_l - g_k) + g_k + t_k - g_l - t_l|^2.
    fn add_stiffness(
        &self,
        graph: &Graph,
        rest: &[Vec3],
        motions: &[Motion],
        stiffness: f64,
        blocks: &mut [Block],
        right: &mut [[f64; SIZE]],
    ) -> f64 {
        let weight = stiffness / (2 * graph.edges.len()).max(1) as f64;
        let place = |node: usize| rest[graph.nodes[node] as usize].as_dvec3();
        let mut energy = 0.0;
        for edge in &graph.edges {
            for [k, l] in [*edge, [edge[1], edge[0]]].map(|pair| pair.map(|node| node as usize)) {
                let d = motions[k].rotation * (place(l) - place(k));
                let off = d + place(k) + motions[k].translation - place(l) - motions[l].translation;
                energy += weight * off.length_squared();
                let whole = DMat3::from_diagonal(DVec3::splat(weight));
                add_right(&mut right[k], 1.0, d, off * weight);
                add_right(&mut right[l], -1.0, DVec3::ZERO, off * weight);
                for (a, p, b, q, sign) in
                    [(k, d, k, d, 1.0), (l, DVec3::ZERO, l, DVec3::ZERO, 1.0), (k, d, l, DVec3::ZERO, -1.0)]
                {
                    let ((low, p_low), (high, p_high)) = if a <= b { ((a, p), (b, q)) } else { ((b, q), (a, p)) };
                    if let Some(block) = self.block(low, high) {
                        add_block(&mut blocks[block], sign, p_high, &whole, p_low);
                    }
                }
            }
        }
        energy
    }

    fn solve(&self, blocks: &[Block], right: &[[f64; SIZE]]) -> Option<Vec<[f64; SIZE]>> {
        let diagonal = |node: usize| (0..SIZE).map(move |k| blocks[self.first[node]][k][k]);
        let mean = (0..self.nodes).flat_map(diagonal).sum::<f64>() / (SIZE * self.nodes) as f64;
        let mut values = Vec::with_capacity(self.pattern.row_idx().len());
        for (node, rows) in self.rows.iter().enumerate() {
            for column in 0..SIZE {
                for (at, &other) in rows.iter().enumerate() {
                    let block = &blocks[self.first[node] + at];
                    let from = if other as usize == node { column } else { 0 };
                    values.extend((from..SIZE).map(|row| {
                        block[row][column] + if other as usize == node && row == column { DAMPING * mean } else { 0.0 }
                    }));
                }
            }
        }
        let matrix = SparseColMat::new(self.pattern.clone(), values);
        let factor = Llt::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref(), Side::Lower).ok()?;
        let mut x = Mat::from_fn(SIZE * self.nodes, 1, |row, _| -right[row / SIZE][row % SIZE]);
        factor.solve_in_place(x.as_mut());
        let solution: Vec<[f64; SIZE]> =
            (0..self.nodes).map(|node| std::array::from_fn(|k| x[(SIZE * node + k, 0)])).collect();
        solution.iter().flatten().all(|x| x.is_finite()).then_some(solution)
    }
}

/// Adds the transpose of share [-[p]x, 1] times `vector`.
fn add_right(right: &mut [f64; SIZE], share: f64, p: DVec3, vector: DVec3) {
    let turn = p.cross(vector) * share;
    for k in 0..3 {
        right[k] += turn[k];
        right[3 + k] += share * vector[k];
    }
}

/// Adds weight [-[p]x, 1]^T matrix [-[q]x, 1].
fn add_block(block: &mut Block, weight: f64, p: DVec3, matrix: &DMat3, q: DVec3) {
    let (p, q) = (cross_matrix(p), cross_matrix(q));
    let beside = *matrix * q * -1.0;
    let parts = [[p * beside, p * *matrix], [beside, *matrix]];
    for (half, row) in parts.iter().enumerate() {
        for (side, part) in row.iter().enumerate() {
            for r in 0..3 {
                for c in 0..3 {
                    block[3 * half + r][3 * side + c] += weight * part.col(c)[r];
                }
            }
        }
    }
}

/// The matrix that multiplies as `v` x does.
fn cross_matrix(v: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, v.z, -v.y), DVec3::new(-v.z, 0.0, v.x), DVec3::new(v.y, -v.x, 0.0))
}

/// Sums of this crate are those of one thread, whatever others do: its own parallelism is over vertices and frames.
pub fn alone() {
    faer::set_global_parallelism(Par::Seq);
}

#[cfg(test)]
mod tests {
    use kernels::random::signed;

    use super::*;
    use crate::surface::tests::sheet;

    /// The step of a plain dense solution: derivatives by differences, normal equations by Gauss.
    fn plain(
        graph: &Graph,
        rest: &[Vec3],
        rows: &[(usize, f32, Vec3, f32)],
        stiffness: f64,
        motions: &[Motion],
    ) -> Vec<f64> {
        let nodes = graph.nodes.len();
        let residuals = |motions: &[Motion]| -> Vec<f64> {
            let moved = |vertex: usize| {
                let mut sum = DVec3::ZERO;
                for &(node, share) in &graph.carriers[vertex] {
                    let g = rest[graph.nodes[node as usize] as usize];
                    let motion = &motions[node as usize];
                    sum += f64::from(share)
                        * (motion.rotation * (rest[vertex] - g).as_dvec3() + g.as_dvec3() + motion.translation);
                }
                sum
            };
            let mut all: Vec<f64> = rows
                .iter()
                .map(|&(vertex, weight, n, target)| {
                    f64::from(weight).sqrt() * (n.as_dvec3().dot(moved(vertex)) - f64::from(target))
                })
                .collect();
            let weight = (stiffness / (2 * graph.edges.len()) as f64).sqrt();
            for edge in &graph.edges {
                for [k, l] in [*edge, [edge[1], edge[0]]].map(|pair| pair.map(|node| node as usize)) {
                    let place = |node: usize| rest[graph.nodes[node] as usize].as_dvec3();
                    let off = motions[k].rotation * (place(l) - place(k)) + place(k) + motions[k].translation
                        - place(l)
                        - motions[l].translation;
                    all.extend((off * weight).to_array());
                }
            }
            all
        };
        let change = |unknown: usize, by: f64| -> Vec<Motion> {
            let mut motions = motions.to_vec();
            let axis = DVec3::from_array(std::array::from_fn(|k| if k == unknown % 3 { by } else { 0.0 }));
            let motion = &mut motions[unknown / SIZE];
            if unknown % SIZE < 3 {
                motion.rotation = DQuat::from_scaled_axis(axis) * motion.rotation;
            } else {
                motion.translation += axis;
            }
            motions
        };
        let before = residuals(motions);
        let size = SIZE * nodes;
        let derivatives: Vec<Vec<f64>> = (0..size)
            .map(|unknown| {
                let (more, less) = (residuals(&change(unknown, 1e-5)), residuals(&change(unknown, -1e-5)));
                more.iter().zip(&less).map(|(a, b)| (a - b) / 2e-5).collect()
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let matrix = Mat::from_fn(size, size, |i, j| dot(&derivatives[i], &derivatives[j]));
        let mut x = Mat::from_fn(size, 1, |i, _| -dot(&derivatives[i], &before));
        let damped = (0..size).map(|k| matrix[(k, k)]).sum::<f64>() / size as f64 * DAMPING;
        let matrix = Mat::from_fn(size, size, |i, j| matrix[(i, j)] + if i == j { damped } else { 0.0 });
        matrix.full_piv_lu().solve_in_place(x.as_mut());
        (0..size).map(|k| x[(k, 0)]).collect()
    }

    #[test]
    fn a_step_is_that_of_the_plain_equations() {
        let mesh = sheet(9);
        let graph = Graph::new(&mesh, 0.35, 5);
        let system = System::new(&graph).unwrap();
        let mut drawn = 0;
        let mut random = || {
            drawn += 1;
            signed(11, drawn)
        };
        let mut motions: Vec<Motion> = (0..graph.nodes.len())
            .map(|_| Motion {
                rotation: DQuat::from_scaled_axis(DVec3::new(random().into(), random().into(), random().into()) * 0.3),
                translation: DVec3::new(random().into(), random().into(), random().into()) * 0.1,
            })
            .collect();
        let now = deform(&graph, &mesh.positions, &motions);
        let mut pulls = vec![Pull::NONE; now.len()];
        let mut rows = Vec::new();
        for _ in 0..400 {
            let vertex = ((random() * 0.5 + 0.5) * now.len() as f32) as usize % now.len();
            let n = Vec3::new(random(), random(), random()).normalize_or(Vec3::X);
            let (weight, target) = (random().abs(), n.dot(now[vertex]) + 0.1 * random());
            pulls[vertex].add(weight, n, n.dot(now[vertex]) - target);
            rows.push((vertex, weight, n, target));
        }
        let wanted = plain(&graph, &mesh.positions, &rows, 3.0, &motions);
        let before = motions.clone();
        system.step(&graph, &mesh.positions, &pulls, 3.0, &mut motions).unwrap();
        for (node, (motion, before)) in motions.iter().zip(&before).enumerate() {
            let turn = (motion.rotation * before.rotation.conjugate()).to_scaled_axis();
            let step = motion.translation - before.translation;
            for (k, got) in turn.to_array().into_iter().chain(step.to_array()).enumerate() {
                assert!((got - wanted[SIZE * node + k]).abs() < 2e-4, "{got} for {}", wanted[SIZE * node + k]);
            }
        }
    }

    #[test]
    fn steps_bring_a_bent_sheet_to_its_target() {
        let mesh = sheet(16);
        let graph = Graph::new(&mesh, 0.2, 5);
        let system = System::new(&graph).unwrap();
        let bent = |p: &Vec3| {
            let angle = 1.2 * p.x;
            Vec3::new(angle.sin() / 1.2, (1.0 - angle.cos()) / 1.2, p.z)
        };
        let target: Vec<Vec3> = mesh.positions.iter().map(bent).collect();
        let mut motions = vec![Motion::NONE; graph.nodes.len()];
        for _ in 0..12 {
            let now = deform(&graph, &mesh.positions, &motions);
            let pulls: Vec<Pull> = now
                .iter()
                .zip(&target)
                .map(|(now, target)| {
                    let mut pull = Pull::NONE;
                    pull.add_point(1.0 / now.length().max(1.0), *now - *target);
                    pull
                })
                .collect();
            system.step(&graph, &mesh.positions, &pulls, 0.01, &mut motions).unwrap();
        }
        let now = deform(&graph, &mesh.positions, &motions);
        let worst = now.iter().zip(&target).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(worst < 0.01, "{worst}");
    }
}
