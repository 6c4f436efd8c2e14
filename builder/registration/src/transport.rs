//! Which point of a body becomes which where no closest point tells, for limbs lie elsewhere: optimal transport of area, made
//! smooth by entropy and lenient towards what has no counterpart (Chizat et al., *Scaling Algorithms for Unbalanced Optimal
//! Transport Problems*, 2018).
//!
//! Costs are bounded: a robust cost of distance leaves what lies on each other in peace, and moves only what does not, where a
//! square of the distance would shift the whole body a little to spare an arm a long way.

use glam::Vec3;
use kernels::random::mix;
use rayon::prelude::*;

use super::surface::Surface;

/// Order in which vertices are drawn.
const SEED: u64 = 2018;
/// Steps of scaling.
const STEPS: usize = 30;
/// What a difference of normals may cost, of colours, and a difference of colours that costs half of that.
const NORMAL: f32 = 0.25;
const COLOUR: f32 = 0.8;
const COLOUR_WIDTH: f32 = 0.15;
/// How much it costs to leave area without a counterpart, or to use it twice.
const LENIENCE: f32 = 0.5;

/// Some vertices of a surface that stand for all of it.
#[derive(Clone, Debug)]
pub struct Samples {
    /// The vertices.
    pub vertices: Vec<u32>,
    /// The share of the area that each stands for; they sum to 1.
    pub masses: Vec<f32>,
}

impl Samples {
    /// About `count` vertices of `surface`.
    #[must_use]
    pub fn new(surface: &Surface, count: usize) -> Self {
        let mut vertices: Vec<u32> =
            (0..surface.areas.len() as u32).filter(|&v| surface.areas[v as usize] > 0.0).collect();
        vertices.sort_by_key(|&v| (mix(SEED, u64::from(v)), v));
        vertices.truncate(count);
        vertices.sort_unstable();
        let sum: f32 = vertices.iter().map(|&v| surface.areas[v as usize]).sum();
        let masses = vertices.iter().map(|&v| surface.areas[v as usize] / sum.max(1e-12)).collect();
        Self { vertices, masses }
    }
}

/// What is compared at a sample.
#[derive(Clone, Copy, Debug)]
struct Feature {
    place: Vec3,
    normal: Vec3,
    colour: Vec3,
}

fn features(surface: &Surface, samples: &Samples, colours: bool) -> Vec<Feature> {
    let of = |&v: &u32| {
        let v = v as usize;
        let colour = surface.colours.as_ref().filter(|_| colours).map_or(Vec3::ZERO, |colours| colours[v]);
        Feature { place: surface.mesh.positions[v], normal: surface.normals[v], colour }
    };
    samples.vertices.iter().map(of).collect()
}

/// How strict a transport is.
#[derive(Clone, Copy, Debug)]
pub struct Strictness {
    /// Distance that costs half of what the longest one does, metres.
    pub width: f32,
    /// Entropy: costs that differ by much less are alike.
    pub entropy: f32,
    /// Weight of colours; 0 without.
    pub colour: f32,
}

/// Where a sample goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Destination {
    /// The mean of where its area goes.
    pub place: Vec3,
    /// How much of its area goes anywhere, of the whole surface's.
    pub mass: f32,
}

/// Where the samples of `from` go on `to`.
#[must_use]
pub fn transport(
    (from, of): (&Surface, &Samples),
    (to, on): (&Surface, &Samples),
    strictness: &Strictness,
) -> Vec<Destination> {
    let colours = strictness.colour > 0.0 && from.colours.is_some() && to.colours.is_some();
    let (sources, sinks) = (features(from, of, colours), features(to, on, colours));
    let (rows, columns) = (sources.len(), sinks.len());
    if rows == 0 || columns == 0 {
        return Vec::new();
    }
    let half = |squared: f32, width: f32| squared / (squared + width * width);
    let cost = |a: &Feature, b: &Feature| {
        half(a.place.distance_squared(b.place), strictness.width)
            + NORMAL * (0.5 - 0.5 * a.normal.dot(b.normal))
            + COLOUR * strictness.colour * half(a.colour.distance_squared(b.colour), COLOUR_WIDTH)
    };
    let kernel: Vec<f32> = sources
        .par_iter()
        .flat_map_iter(|a| sinks.iter().map(move |b| (-cost(a, b) / strictness.entropy).exp()))
        .collect();
    let power = LENIENCE / (LENIENCE + strictness.entropy);
    let (mut u, mut v) = (vec![1.0_f32; rows], vec![1.0_f32; columns]);
    let scaled = |mass: f32, sum: f32| (mass / sum.max(1e-30)).powf(power);
    for _ in 0..STEPS {
        u = kernel.par_chunks_exact(columns).zip(&of.masses).map(|(row, &mass)| scaled(mass, dot(row, &v))).collect();
        v = transposed(&kernel, columns, &u);
        v.iter_mut().zip(&on.masses).for_each(|(v, &mass)| *v = scaled(mass, *v));
    }
    kernel
        .par_chunks_exact(columns)
        .zip(&u)
        .map(|(row, u)| {
            let (mut place, mut mass) = (Vec3::ZERO, 0.0);
            for ((k, v), sink) in row.iter().zip(&v).zip(&sinks) {
                place += sink.place * (k * v);
                mass += k * v;
            }
            Destination { place: place / mass.max(1e-30), mass: mass * u }
        })
        .collect()
}

/// The sum of products, eight side by side.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0; 8];
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f32 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f32>() + rest
}

/// Columns in a block.
const BLOCK: usize = 128;

/// The kernel's columns times `u`.
fn transposed(kernel: &[f32], columns: usize, u: &[f32]) -> Vec<f32> {
    let blocks = (0..columns).step_by(BLOCK).collect::<Vec<_>>();
    let of = |&first: &usize| {
        let end = (first + BLOCK).min(columns);
        let mut sums = vec![0.0; end - first];
        for (row, &u) in kernel.chunks_exact(columns).zip(u) {
            sums.iter_mut().zip(&row[first..end]).for_each(|(sum, k)| *sum += k * u);
        }
        sums
    };
    blocks.par_iter().flat_map_iter(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::sheet;

    #[test]
    fn what_lies_on_itself_stays_and_colours_say_where_the_rest_goes() {
        let mesh = sheet(20);
        let red = |x: f32| Vec3::new(f32::from(u8::from(x > 0.7)), 0.0, 0.0);
        let colours: Vec<Vec3> = mesh.positions.iter().map(|p| red(p.x)).collect();
        let surface = Surface::new(mesh.clone(), Some(colours));
        // The same, where the red part is at the other side.
        let mut moved = mesh;
        moved.positions.iter_mut().for_each(|p| p.x = if p.x > 0.7 { p.x - 0.7 } else { p.x + 0.3 });
        let moved = Surface::new(moved, surface.colours.clone());
        let samples = Samples::new(&surface, 400);
        assert!((samples.masses.iter().sum::<f32>() - 1.0).abs() < 1e-4);
        let strictness = Strictness { width: 0.6, entropy: 0.02, colour: 1.0 };
        let off = |to: &Surface, strictness: &Strictness, only: &dyn Fn(Vec3) -> bool| {
            let found = transport((&surface, &samples), (to, &samples), strictness);
            let pairs = found.iter().zip(&samples.vertices).map(|(found, &v)| (found.place, v as usize));
            let off = pairs.filter(|&(_, v)| only(surface.mesh.positions[v]));
            let off: Vec<f32> = off.map(|(place, v)| place.distance(to.mesh.positions[v])).collect();
            off.iter().sum::<f32>() / off.len() as f32
        };
        let stays = off(&surface, &strictness, &|_| true);
        assert!(stays < 0.05, "{stays}");
        // Red is far away, and what is not red does not care.
        let goes = off(&moved, &strictness, &|p| p.x > 0.7);
        assert!(goes < 0.12, "{goes}");
        let blind = off(&moved, &Strictness { colour: 0.0, ..strictness }, &|p| p.x > 0.7);
        assert!(blind > 2.0 * goes, "{blind} and {goes}");
    }

    #[test]
    fn nothing_goes_nowhere() {
        let empty = Surface::new(geometry::mesh::Mesh::default(), None);
        let none = Samples::new(&empty, 10);
        let strictness = Strictness { width: 0.6, entropy: 0.02, colour: 1.0 };
        assert!(transport((&empty, &none), (&empty, &none), &strictness).is_empty());
    }
}
