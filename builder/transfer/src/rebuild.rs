//! One surface of parts that overlap: what triangles do in each part, blended where parts overlap, and solved for once.
//!
//! Thesis section 5.6.2 aligns parts on their overlap, cuts and solves; the overlap of an arm is too small to say how the arm is
//! turned. Here parts are in one frame already: in bands the rotations R and the stretches S of triangles (T = R S, equations 2.35 and 2.46) are averaged,
//! and one Poisson system gives the surface with these triangles.

use glam::{DMat3, DVec3, Vec3};
use kernels::cholesky::{
    CholeskyError, EliminationOrder, Factor, SolveScratch, Symbolic, SymmetricMatrix, SymmetricPattern, Workspace,
};
use kernels::rotation::best_rotation;
use kernels::topology::Topology;

/// Half cotangents are within these: negative ones would not be positive definite, large ones hide all others.
const COTANGENTS: [f64; 2] = [1e-3, 10.0];
/// How firmly vertices are kept where the parts have them on average, beside the weights of edges, whose sum at a vertex is about 4: it
/// says where the surface is.
const ANCHOR: f64 = 1e-3;

/// Makes surfaces of one mesh from its parts.
pub struct Rebuilder {
    vertex_count: usize,
    /// For each part the weight of each vertex; none where the body is one part.
    weights: Vec<Vec<f32>>,
    triangles: Vec<Rest>,
    /// Triangles in bands.
    bands: Vec<Band>,
    symbolic: Symbolic,
    factor: Factor<f64>,
}

/// A triangle of the rest pose.
struct Rest {
    corners: [u32; 3],
    /// Half cotangents at its corners.
    cotangents: [f64; 3],
    /// Edges and normal of the rest pose, and their inverse.
    rest: DMat3,
    inverse: DMat3,
}

/// A triangle that several parts share.
struct Band {
    /// Its number.
    triangle: usize,
    /// Parts that have all its corners, and their shares.
    shares: Vec<(usize, f64)>,
}

impl Rebuilder {
    /// For the mesh `topology` with the rest pose `rest`, whose parts have `weights` at its vertices, adding up to 1; none at all
    /// where the body is one part.
    ///
    /// # Errors
    /// A mesh too large to factorise, or a rest pose that is not finite.
    pub fn new(topology: &Topology, rest: &[Vec3], weights: &[&[f32]]) -> Result<Self, CholeskyError> {
        let pattern = SymmetricPattern::from_triangles(topology.vertex_count(), topology.triangles())?;
        let mut matrix = SymmetricMatrix::zeros(&pattern);
        matrix.diagonal_mut().fill(ANCHOR);
        let (mut triangles, mut bands) = (Vec::new(), Vec::new());
        for (triangle, &corners) in topology.triangles().iter().enumerate() {
            let at = corners.map(|vertex| rest[vertex as usize].as_dvec3());
            let cotangents = half_cotangents(at);
            for (k, &cotangent) in cotangents.iter().enumerate() {
                let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                if a != b {
                    matrix.add(&pattern, a, a, cotangent)?;
                    matrix.add(&pattern, b, b, cotangent)?;
                    matrix.add(&pattern, a, b, -cotangent)?;
                }
            }
            let shares = shares(weights, corners);
            let rest = frame(at);
            let inverse = rest.inverse();
            if shares.len() > 1 && inverse.is_finite() {
                bands.push(Band { triangle, shares });
            }
            triangles.push(Rest { corners, cotangents, rest, inverse });
        }
        let symbolic = Symbolic::new(&pattern, &EliminationOrder::minimum_degree(&pattern))?;
        let factor = symbolic.factorise(&matrix, &mut Workspace::default())?;
        let weights = weights.iter().map(|own| own.to_vec()).collect();
        Ok(Self { vertex_count: topology.vertex_count(), weights, triangles, bands, symbolic, factor })
    }

    /// The surface of parts, given as their vertices and the places of these.
    ///
    /// # Errors
    /// Places that are not finite.
    pub fn surface(&self, parts: &[(&[u32], Vec<Vec3>)]) -> Result<Vec<Vec3>, CholeskyError> {
        let places: Vec<Vec<Vec3>> = parts
            .iter()
            .map(|(vertices, own)| {
                let mut all = vec![Vec3::ZERO; self.vertex_count];
                vertices.iter().zip(own).for_each(|(&vertex, &place)| all[vertex as usize] = place);
                all
            })
            .collect();
        let mean = |vertex: usize| match self.weights.is_empty() {
            true => places[0][vertex],
            false => places.iter().zip(&self.weights).map(|(place, own)| place[vertex] * own[vertex]).sum(),
        };
        let mut surface: Vec<Vec3> = (0..self.vertex_count).map(mean).collect();
        let mut missing = vec![DVec3::ZERO; self.vertex_count];
        for band in &self.bands {
            let rest = &self.triangles[band.triangle];
            if let Some(wanted) = band.wanted(rest, &places) {
                rest.miss(wanted, &surface, &mut missing);
            }
        }
        self.add(&missing, &mut surface)?;
        Ok(surface)
    }

    /// The same surface, its triangles turned as they are, but stretched from the rest pose as `stretch` says of each; those of which
    /// it says nothing stay.
    ///
    /// # Errors
    /// Places that are not finite.
    pub fn stretched(
        &self,
        surface: &[Vec3],
        stretch: impl Fn(usize) -> Option<DMat3>,
    ) -> Result<Vec<Vec3>, CholeskyError> {
        let mut missing = vec![DVec3::ZERO; self.vertex_count];
        for (triangle, rest) in self.triangles.iter().enumerate() {
            if let (Some(stretch), Some((rotation, _))) = (stretch(triangle), rest.apart(surface)) {
                rest.miss(rotation * stretch * rest.rest, surface, &mut missing);
            }
        }
        let mut surface = surface.to_vec();
        self.add(&missing, &mut surface)?;
        Ok(surface)
    }

    /// How a triangle is stretched from the rest pose in another one; `None` where either is degenerate.
    #[must_use]
    pub fn stretch(&self, triangle: usize, pose: &[Vec3]) -> Option<DMat3> {
        self.triangles[triangle].apart(pose).map(|(_, stretch)| stretch)
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [u32; 3] {
        self.triangles[triangle].corners
    }

    /// Moves the surface so that what was missing is there.
    fn add(&self, missing: &[DVec3], surface: &mut [Vec3]) -> Result<(), CholeskyError> {
        if missing.iter().any(|own| *own != DVec3::ZERO) {
            let mut x: Vec<f64> = missing.iter().flat_map(|own| own.to_array()).collect();
            self.symbolic.solve(&self.factor, &mut x, 3, &mut SolveScratch::default())?;
            surface.iter_mut().zip(x.chunks_exact(3)).for_each(|(point, by)| *point += DVec3::from_slice(by).as_vec3());
        }
        Ok(())
    }
}

impl Rest {
    fn at(&self, pose: &[Vec3]) -> [DVec3; 3] {
        self.corners.map(|vertex| pose[vertex as usize].as_dvec3())
    }

    /// How the triangle is turned and stretched in a pose.
    fn apart(&self, pose: &[Vec3]) -> Option<(DMat3, DMat3)> {
        let gradient = frame(self.at(pose)) * self.inverse;
        let rotation = DMat3::from_quat(best_rotation(&gradient));
        let stretch = rotation.transpose() * gradient;
        stretch.is_finite().then_some((rotation, stretch))
    }

    /// Adds what the triangle's edges miss in `surface`, times their weights.
    fn miss(&self, wanted: DMat3, surface: &[Vec3], missing: &mut [DVec3]) {
        let own = self.at(surface);
        let edge = |k: usize| wanted.col(k);
        // From the first corner to the second, from the second to the third, and back.
        let wanted = [edge(0), edge(1) - edge(0), -edge(1)];
        for (k, wanted) in wanted.into_iter().enumerate() {
            let (from, to) = (k, (k + 1) % 3);
            let pull = (wanted - (own[to] - own[from])) * self.cotangents[(k + 2) % 3];
            missing[self.corners[to] as usize] += pull;
            missing[self.corners[from] as usize] -= pull;
        }
    }
}

impl Band {
    /// Edges and normal that the parts make together; `None` where they agree.
    fn wanted(&self, rest: &Rest, places: &[Vec<Vec3>]) -> Option<DMat3> {
        let (mut turns, mut stretch) = (DMat3::ZERO, DMat3::ZERO);
        let (mut first, mut alike) = (DMat3::ZERO, true);
        for (k, &(part, share)) in self.shares.iter().enumerate() {
            let edges = frame(rest.at(&places[part]));
            alike &= k == 0 || edges == first;
            first = edges;
            let gradient = edges * rest.inverse;
            let rotation = DMat3::from_quat(best_rotation(&gradient));
            turns += rotation * share;
            stretch += rotation.transpose() * gradient * share;
        }
        (!alike).then(|| DMat3::from_quat(best_rotation(&turns)) * stretch * rest.rest)
    }
}

/// Both edges from the first corner, and the unit normal.
fn frame([a, b, c]: [DVec3; 3]) -> DMat3 {
    let (first, second) = (b - a, c - a);
    DMat3::from_cols(first, second, first.cross(second).normalize_or_zero())
}

fn half_cotangents(at: [DVec3; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let (a, b) = (at[(k + 1) % 3] - at[k], at[(k + 2) % 3] - at[k]);
        let cotangent = a.dot(b) / a.cross(b).length().max(1e-12);
        (0.5 * cotangent).clamp(COTANGENTS[0], COTANGENTS[1])
    })
}

/// The parts that have all corners of a triangle, and their shares of it.
fn shares(weights: &[&[f32]], corners: [u32; 3]) -> Vec<(usize, f64)> {
    let whole = |own: &&[f32]| corners.iter().all(|&vertex| own[vertex as usize] > 0.0);
    let mean = |own: &[f32]| corners.iter().map(|&vertex| f64::from(own[vertex as usize])).sum::<f64>();
    let mut shares: Vec<(usize, f64)> =
        weights.iter().enumerate().filter(|(_, own)| whole(own)).map(|(part, own)| (part, mean(own))).collect();
    let total: f64 = shares.iter().map(|share| share.1).sum();
    shares.iter_mut().for_each(|share| share.1 /= total);
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    /// A tube of 30 rings of 8 vertices, and two parts that overlap between rings 10 and 20.
    fn tube() -> (Topology, Vec<Vec3>, Vec<Vec<f32>>) {
        let rest: Vec<Vec3> = (0..240)
            .map(|k| {
                let angle = (k % 8) as f32 * std::f32::consts::FRAC_PI_4;
                Vec3::new(0.05 * angle.cos(), 0.02 * (k / 8) as f32, 0.05 * angle.sin())
            })
            .collect();
        let quad = |k: u32| {
            let (a, b) = (k, k / 8 * 8 + (k + 1) % 8);
            [[a, a + 8, b], [b, a + 8, b + 8]]
        };
        let topology = Topology::new(240, (0..232).flat_map(quad).collect(), vec![1.0; 240]).unwrap();
        let upper: Vec<f32> = (0..240).map(|k| ((k / 8) as f32 / 10.0 - 1.0).clamp(0.0, 1.0)).collect();
        let lower = upper.iter().map(|w| 1.0 - w).collect();
        (topology, rest, vec![lower, upper])
    }

    fn parts<'a>(vertices: &'a [Vec<u32>], poses: [&[Vec3]; 2]) -> Vec<(&'a [u32], Vec<Vec3>)> {
        let own = |k: usize| vertices[k].iter().map(|&v| poses[k][v as usize]).collect();
        (0..2).map(|k| (vertices[k].as_slice(), own(k))).collect()
    }

    fn members(weights: &[Vec<f32>]) -> Vec<Vec<u32>> {
        let own = |own: &Vec<f32>| (0..240).filter(|&v| own[v as usize] > 0.0).collect();
        weights.iter().map(own).collect()
    }

    #[test]
    fn parts_that_agree_are_the_surface() {
        let (topology, rest, weights) = tube();
        let own: Vec<&[f32]> = weights.iter().map(Vec::as_slice).collect();
        let rebuilder = Rebuilder::new(&topology, &rest, &own).unwrap();
        let bend = |p: &Vec3| Quat::from_rotation_x(2.0 * p.y) * *p * 1.2 + Vec3::new(3.0, 0.1, -1.0);
        let pose: Vec<Vec3> = rest.iter().map(bend).collect();
        let members = members(&weights);
        let found = rebuilder.surface(&parts(&members, [&pose, &pose])).unwrap();
        let off = found.iter().zip(&pose).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(off < 1e-6, "{off}");
        let whole = Rebuilder::new(&topology, &rest, &[]).unwrap();
        let all: Vec<u32> = (0..240).collect();
        assert_eq!(whole.surface(&[(&all, pose.clone())]).unwrap(), pose);
    }

    #[test]
    fn parts_that_are_turned_against_each_other_bend_evenly() {
        let (topology, rest, weights) = tube();
        let own: Vec<&[f32]> = weights.iter().map(Vec::as_slice).collect();
        let rebuilder = Rebuilder::new(&topology, &rest, &own).unwrap();
        let pivot = Vec3::new(0.0, 0.3, 0.0);
        let turned: Vec<Vec3> = rest.iter().map(|&p| Quat::from_rotation_y(2.0) * (p - pivot) + pivot).collect();
        let found = rebuilder.surface(&parts(&members(&weights), [&rest, &turned])).unwrap();
        // Places that are averaged shrink to half as wide; triangles that are turned do so less.
        let width = |pose: &[Vec3]| pose[15 * 8].distance(pose[15 * 8 + 4]);
        let mean: Vec<Vec3> = rest.iter().zip(&turned).map(|(a, b)| (*a + *b) / 2.0).collect();
        assert!(width(&mean) < 0.06 && width(&found) > 0.075, "{} {}", width(&mean), width(&found));
        let ends = |k: usize, pose: &[Vec3]| found[k].distance(pose[k]);
        assert!(ends(0, &rest) < 0.02 && ends(239, &turned) < 0.02, "{} {}", ends(0, &rest), ends(239, &turned));
    }
}
