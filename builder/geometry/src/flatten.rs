//! Flattening a disc of triangles with little distortion and no flipped triangle.
//!
//! This work is based on: W. T. Tutte, "How to draw a graph", 1963 (a start that is never flipped), and L. Liu et al.,
//! "A local/global approach to mesh parameterization", 2008 (as rigid as possible). Where the second flips a triangle,
//! steps back to the first are taken until none is.

use glam::{Vec2, Vec3};

/// Coordinates in metres of the `count` vertices of a disc; `triangles` over them with corner positions in space.
#[must_use]
pub fn flatten(triangles: &[[u32; 3]], corners: &[[Vec3; 3]], count: usize) -> Vec<Vec2> {
    let shapes: Vec<[Vec2; 3]> = corners.iter().map(flat).collect();
    let true_area: f32 = shapes.iter().map(|s| 0.5 * (s[1] - s[0]).perp_dot(s[2] - s[0])).sum();
    let start = tutte(triangles, &shapes, count);
    let mut best = start.clone();
    let cotangents: Vec<[f32; 3]> = shapes.iter().map(cotangents).collect();
    let mut now = start;
    for round in 0..60 {
        now = rigid_step(triangles, &shapes, &cotangents, &now);
        if round >= 4 && flipped(triangles, &now) == 0 && (0.5..2.0).contains(&(area(triangles, &now) / true_area)) {
            best.clone_from(&now);
        }
    }
    best
}

/// Number of triangles that are turned over or have no area.
#[must_use]
pub fn flipped(triangles: &[[u32; 3]], places: &[Vec2]) -> usize {
    let turned = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|v| places[v as usize]);
        let area = (b - a).perp_dot(c - a);
        area.is_nan() || area <= 1e-10
    };
    triangles.iter().filter(turned).count()
}

fn area(triangles: &[[u32; 3]], places: &[Vec2]) -> f32 {
    let double = triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| places[v as usize]);
        (b - a).perp_dot(c - a)
    });
    0.5 * double.sum::<f32>()
}

/// A triangle laid into the plane.
fn flat(corners: &[Vec3; 3]) -> [Vec2; 3] {
    let (ab, ac) = (corners[1] - corners[0], corners[2] - corners[0]);
    let x = ab.normalize_or(Vec3::X);
    let along = ac.dot(x);
    let up = (ac - x * along).length().max(1e-7);
    [Vec2::ZERO, Vec2::new(ab.length().max(1e-7), 0.0), Vec2::new(along, up)]
}

/// Half cotangents opposite each edge (k, k + 1), kept positive.
fn cotangents(shape: &[Vec2; 3]) -> [f32; 3] {
    std::array::from_fn(|k| {
        let (a, b, tip) = (shape[k], shape[(k + 1) % 3], shape[(k + 2) % 3]);
        let (u, v) = (a - tip, b - tip);
        (0.5 * u.dot(v) / u.perp_dot(v).abs().max(1e-10)).clamp(0.02, 10.0)
    })
}

/// Boundary on a circle, every inner vertex in the middle of its neighbours.
fn tutte(triangles: &[[u32; 3]], shapes: &[[Vec2; 3]], count: usize) -> Vec<Vec2> {
    let area: f32 = shapes.iter().map(|s| 0.5 * (s[1] - s[0]).perp_dot(s[2] - s[0])).sum();
    let (ring, steps) = boundary(triangles, shapes);
    let length: f32 = steps.iter().sum();
    let radius = (area / std::f32::consts::PI).sqrt();
    let mut places = vec![Vec2::ZERO; count];
    let mut fixed = vec![false; count];
    let mut travelled = 0.0;
    for (&vertex, step) in ring.iter().zip(&steps) {
        places[vertex as usize] = Vec2::from_angle(travelled / length * std::f32::consts::TAU) * radius;
        fixed[vertex as usize] = true;
        travelled += step;
    }
    let mut neighbours = vec![Vec::new(); count];
    for t in triangles {
        for k in 0..3 {
            neighbours[t[k] as usize].push(t[(k + 1) % 3]);
            neighbours[t[k] as usize].push(t[(k + 2) % 3]);
        }
    }
    // Gauss-Seidel with over-relaxation; charts are small.
    for _ in 0..600 {
        for vertex in 0..count {
            if !fixed[vertex] && !neighbours[vertex].is_empty() {
                let sum: Vec2 = neighbours[vertex].iter().map(|&v| places[v as usize]).sum();
                let middle = sum / neighbours[vertex].len() as f32;
                let here = places[vertex];
                places[vertex] = here + (middle - here) * 1.6;
            }
        }
    }
    places
}

/// The boundary in order, and the length from each of its vertices to the next.
fn boundary(triangles: &[[u32; 3]], shapes: &[[Vec2; 3]]) -> (Vec<u32>, Vec<f32>) {
    let mut edges = std::collections::BTreeMap::new();
    for (t, shape) in triangles.iter().zip(shapes) {
        for k in 0..3 {
            let l = (k + 1) % 3;
            edges.insert((t[k], t[l]), shape[k].distance(shape[l]));
        }
    }
    let next: std::collections::BTreeMap<u32, (u32, f32)> = edges
        .iter()
        .filter(|&(&(a, b), _)| !edges.contains_key(&(b, a)))
        .map(|(&(a, b), &length)| (a, (b, length)))
        .collect();
    let (mut ring, mut steps) = (Vec::new(), Vec::new());
    let Some(&first) = next.keys().next() else { return (ring, steps) };
    let mut at = first;
    while let Some(&(to, length)) = next.get(&at) {
        ring.push(at);
        steps.push(length);
        at = to;
        if at == first || ring.len() > next.len() {
            break;
        }
    }
    (ring, steps)
}

/// One local and one global step towards triangles that are only turned and moved.
fn rigid_step(triangles: &[[u32; 3]], shapes: &[[Vec2; 3]], cotangents: &[[f32; 3]], now: &[Vec2]) -> Vec<Vec2> {
    let mut wanted = vec![Vec2::ZERO; now.len()];
    let mut diagonal = vec![0.0_f32; now.len()];
    for ((t, shape), cotangents) in triangles.iter().zip(shapes).zip(cotangents) {
        let (mut cosine, mut sine) = (0.0, 0.0);
        for k in 0..3 {
            let l = (k + 1) % 3;
            let (flat, edge) = (shape[l] - shape[k], now[t[l] as usize] - now[t[k] as usize]);
            cosine += cotangents[k] * flat.dot(edge);
            sine += cotangents[k] * flat.perp_dot(edge);
        }
        let turn = Vec2::new(cosine, sine).normalize_or(Vec2::X);
        for k in 0..3 {
            let l = (k + 1) % 3;
            let pull = turn.rotate(shape[l] - shape[k]) * cotangents[k];
            wanted[t[l] as usize] += pull;
            wanted[t[k] as usize] -= pull;
            diagonal[t[k] as usize] += cotangents[k];
            diagonal[t[l] as usize] += cotangents[k];
        }
    }
    let apply = |x: &[Vec2]| {
        let mut out = vec![Vec2::ZERO; x.len()];
        for (t, cotangents) in triangles.iter().zip(cotangents) {
            for k in 0..3 {
                let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
                let pull = (x[b] - x[a]) * cotangents[k];
                out[b] += pull;
                out[a] -= pull;
            }
        }
        out
    };
    conjugate_gradients(apply, &wanted, &diagonal, now)
}

/// Solves for both coordinates at once, each with its own step lengths, preconditioned by the diagonal.
fn conjugate_gradients(
    apply: impl Fn(&[Vec2]) -> Vec<Vec2>,
    right: &[Vec2],
    diagonal: &[f32],
    start: &[Vec2],
) -> Vec<Vec2> {
    // A coordinate that is solved already has no direction left; rounding must not make one.
    let share = |a: Vec2, b: Vec2| Vec2::select(b.cmpgt(Vec2::splat(1e-20)), a / b, Vec2::ZERO);
    let dot = |a: &[Vec2], b: &[Vec2]| a.iter().zip(b).map(|(x, y)| *x * *y).sum::<Vec2>();
    let precondition = |r: &[Vec2]| r.iter().zip(diagonal).map(|(r, d)| *r / d.max(1e-9)).collect::<Vec<_>>();
    let mut x = start.to_vec();
    let mut residual: Vec<Vec2> = right.iter().zip(apply(&x)).map(|(b, a)| *b - a).collect();
    let mut z = precondition(&residual);
    let mut direction = z.clone();
    let mut energy = dot(&residual, &z);
    let first = energy.max_element().max(1e-20);
    for _ in 0..120 {
        // In metres squared: a ten-thousandth of a millimetre is near enough.
        if energy.max_element() < (1e-9 * first).max(1e-14) {
            break;
        }
        let image = apply(&direction);
        let step = share(energy, dot(&direction, &image));
        for k in 0..x.len() {
            x[k] += direction[k] * step;
            residual[k] -= image[k] * step;
        }
        z = precondition(&residual);
        let next = dot(&residual, &z);
        let keep = share(next, energy);
        for k in 0..x.len() {
            direction[k] = z[k] + direction[k] * keep;
        }
        energy = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_sheet_is_unrolled_without_stretch() {
        // A quarter of a cylinder, 12 by 8 vertices.
        let place = |i: u32, j: u32| {
            let angle = i as f32 / 11.0 * 1.6;
            Vec3::new(angle.sin(), angle.cos(), j as f32 * 0.15)
        };
        let (mut triangles, mut corners) = (Vec::new(), Vec::new());
        for i in 0..11 {
            for j in 0..7 {
                for t in [[(i, j), (i, j + 1), (i + 1, j)], [(i + 1, j), (i, j + 1), (i + 1, j + 1)]] {
                    triangles.push(t.map(|(i, j)| i * 8 + j));
                    corners.push(t.map(|(i, j)| place(i, j)));
                }
            }
        }
        let places = flatten(&triangles, &corners, 96);
        assert_eq!(flipped(&triangles, &places), 0);
        for (t, space) in triangles.iter().zip(&corners) {
            for k in 0..3 {
                let l = (k + 1) % 3;
                let ratio = places[t[k] as usize].distance(places[t[l] as usize]) / space[k].distance(space[l]);
                assert!((ratio - 1.0).abs() < 0.02, "an edge is stretched by {ratio}");
            }
        }
    }
}
