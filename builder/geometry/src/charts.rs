//! Charts: a surface cut into connected pieces that are discs, so that each can be laid flat.

use glam::Vec3;
use kernels::components::UnionFind;

use super::mesh::Mesh;

/// Charts have this many triangles or more, and as many as one in [`SHARE`] of the mesh's, unless a disc needs to be smaller.
const SMALL: usize = 24;
const SHARE: usize = 120;
/// How often borders are smoothed.
const SMOOTHINGS: usize = 6;

/// Cuts `mesh` into charts that are discs, each the list of its triangles: first along the borders between `labels`, one for
/// each triangle, then wherever discs need it.
#[must_use]
pub fn cut(mesh: &Mesh, mut labels: Vec<usize>) -> Vec<Vec<u32>> {
    let adjacent = adjacency(mesh);
    for _ in 0..SMOOTHINGS {
        smooth(&mut labels, &adjacent);
    }
    let mut labels = components(&labels, &adjacent);
    merge_small(mesh, &mut labels, &adjacent);
    gather(&labels).into_iter().flat_map(|triangles| discs(mesh, &adjacent, triangles)).collect()
}

/// Cuts the chart `triangles`, which cannot be laid flat, into two or more.
#[must_use]
pub fn divide(mesh: &Mesh, triangles: &[u32]) -> Vec<Vec<u32>> {
    let adjacent = adjacency(mesh);
    let parts = halves(mesh, triangles, &adjacent);
    parts.into_iter().flat_map(|triangles| discs(mesh, &adjacent, triangles)).collect()
}

/// Cuts connected `triangles` into discs.
fn discs(mesh: &Mesh, adjacent: &[[u32; 3]], triangles: Vec<u32>) -> Vec<Vec<u32>> {
    let mut charts = Vec::new();
    let mut open = vec![triangles];
    while let Some(triangles) = open.pop() {
        if triangles.is_empty() {
            continue;
        }
        if is_disc(mesh, &triangles) {
            charts.push(triangles);
        } else {
            open.extend(halves(mesh, &triangles, adjacent));
        }
    }
    charts
}

/// The triangle across each of a triangle's edges; `u32::MAX` where there is none.
fn adjacency(mesh: &Mesh) -> Vec<[u32; 3]> {
    let edges = mesh.half_edges();
    let across = |a: u32, b: u32| edges.get(&(b, a)).copied().unwrap_or(u32::MAX);
    mesh.triangles.iter().map(|&[a, b, c]| [across(a, b), across(b, c), across(c, a)]).collect()
}

/// Centre and unit normal of a triangle.
#[must_use]
pub fn centre_and_normal(mesh: &Mesh, triangle: u32) -> (Vec3, Vec3) {
    let [a, b, c] = mesh.triangles[triangle as usize].map(|v| mesh.positions[v as usize]);
    ((a + b + c) / 3.0, (b - a).cross(c - a).normalize_or(Vec3::Y))
}

/// Gives a triangle the label of its neighbours where two of them agree against it.
fn smooth(labels: &mut [usize], adjacent: &[[u32; 3]]) {
    let before = labels.to_vec();
    for (label, near) in labels.iter_mut().zip(adjacent) {
        let [a, b, c] = near.map(|t| before.get(t as usize).copied());
        let two = if a == b || a == c { a } else { b.filter(|_| b == c) };
        *label = two.unwrap_or(*label);
    }
}

/// Numbers the connected parts of equal label.
fn components(labels: &[usize], adjacent: &[[u32; 3]]) -> Vec<usize> {
    let mut parts = vec![usize::MAX; labels.len()];
    let mut count = 0;
    for start in 0..labels.len() {
        if parts[start] != usize::MAX {
            continue;
        }
        parts[start] = count;
        let mut stack = vec![start];
        while let Some(triangle) = stack.pop() {
            for next in adjacent[triangle].map(|t| t as usize) {
                if parts.get(next) == Some(&usize::MAX) && labels[next] == labels[start] {
                    parts[next] = count;
                    stack.push(next);
                }
            }
        }
        count += 1;
    }
    parts
}

fn gather(labels: &[usize]) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); labels.iter().max().map_or(0, |&m| m + 1)];
    for (triangle, &label) in labels.iter().enumerate() {
        lists[label].push(triangle as u32);
    }
    lists
}

/// Gives small parts to the neighbour with which they share most edges, the smallest first. What has no neighbour stays.
fn merge_small(mesh: &Mesh, labels: &mut [usize], adjacent: &[[u32; 3]]) {
    let small = SMALL.max(mesh.triangles.len() / SHARE);
    let mut alone = std::collections::BTreeSet::new();
    loop {
        let lists = gather(labels);
        let open = |k: &usize| !lists[*k].is_empty() && !alone.contains(k);
        let smallest = (0..lists.len()).filter(open).min_by_key(|&k| lists[k].len());
        let Some(part) = smallest.filter(|&part| lists[part].len() < small) else { return };
        let mut shared = vec![0_usize; lists.len()];
        for next in lists[part].iter().flat_map(|&triangle| adjacent[triangle as usize]) {
            if let Some(&label) = labels.get(next as usize) {
                shared[label] += 1;
            }
        }
        shared[part] = 0;
        let into = (0..shared.len()).rev().max_by_key(|&k| shared[k]).filter(|&k| shared[k] > 0);
        let Some(into) = into else {
            alone.insert(part);
            continue;
        };
        for &triangle in &lists[part] {
            labels[triangle as usize] = into;
        }
    }
}

/// The corners of a chart joined across its inner edges: a number for each corner of each triangle, and their count.
/// A vertex where the chart touches itself gets one number for each side.
#[must_use]
pub fn weld_corners(mesh: &Mesh, triangles: &[u32]) -> (Vec<[u32; 3]>, usize) {
    let mut corners = UnionFind::new(3 * triangles.len());
    let mut edges = std::collections::HashMap::new();
    for (k, &triangle) in triangles.iter().enumerate() {
        let t = mesh.triangles[triangle as usize];
        for e in 0..3 {
            edges.insert((t[e], t[(e + 1) % 3]), (3 * k + e, 3 * k + (e + 1) % 3));
        }
    }
    for (k, &triangle) in triangles.iter().enumerate() {
        let t = mesh.triangles[triangle as usize];
        for e in 0..3 {
            if let Some(&(far_start, far_end)) = edges.get(&(t[(e + 1) % 3], t[e])) {
                for (here, there) in [(3 * k + e, far_end), (3 * k + (e + 1) % 3, far_start)] {
                    corners.join(here as u32, there as u32);
                }
            }
        }
    }
    let (numbers, count) = corners.numbered();
    (numbers.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(), count)
}

/// Whether connected `triangles` are a disc: V - E + F = 1.
fn is_disc(mesh: &Mesh, triangles: &[u32]) -> bool {
    let (corners, vertices) = weld_corners(mesh, triangles);
    let mut edges: Vec<(u32, u32)> = Vec::with_capacity(corners.len() * 3);
    for t in &corners {
        edges.extend((0..3).map(|e| (t[e].min(t[(e + 1) % 3]), t[e].max(t[(e + 1) % 3]))));
    }
    edges.sort_unstable();
    edges.dedup();
    vertices as i64 - edges.len() as i64 + corners.len() as i64 == 1
}

/// The connected parts on both sides of the plane through the middle of the longest side of the bounding box.
fn halves(mesh: &Mesh, triangles: &[u32], adjacent: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let centres: Vec<Vec3> = triangles.iter().map(|&t| centre_and_normal(mesh, t).0).collect();
    let low = centres.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = centres.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let size = high - low;
    let axis = if size.x >= size.y.max(size.z) {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let mut labels = vec![0; mesh.triangles.len()];
    for (&triangle, centre) in triangles.iter().zip(&centres) {
        labels[triangle as usize] = if centre[axis] < 0.5 * (low + high)[axis] { 1 } else { 2 };
    }
    let parts = components(&labels, adjacent);
    let mut kept: Vec<Vec<u32>> = Vec::new();
    let mut number = std::collections::BTreeMap::new();
    for &triangle in triangles {
        let index = *number.entry(parts[triangle as usize]).or_insert_with(|| {
            kept.push(Vec::new());
            kept.len() - 1
        });
        kept[index].push(triangle);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tube of `around` by `along` squares: its Euler characteristic is that of a ring, so it must be cut.
    fn tube(around: u32, along: u32) -> Mesh {
        let positions = (0..=along)
            .flat_map(|y| {
                (0..around).map(move |k| {
                    let angle = std::f32::consts::TAU * k as f32 / around as f32;
                    Vec3::new(angle.cos(), 0.3 * y as f32, angle.sin())
                })
            })
            .collect();
        let mut triangles = Vec::new();
        for y in 0..along {
            for k in 0..around {
                let (a, b) = (y * around + k, y * around + (k + 1) % around);
                triangles.extend([[a, a + around, b], [b, a + around, b + around]]);
            }
        }
        Mesh { positions, triangles }
    }

    #[test]
    fn a_tube_is_cut_into_discs_that_cover_it_once() {
        let mesh = tube(24, 10);
        let charts = cut(&mesh, vec![0; mesh.triangles.len()]);
        assert!(charts.len() > 1);
        let mut all: Vec<u32> = charts.iter().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, (0..mesh.triangles.len() as u32).collect::<Vec<_>>());
        for chart in &charts {
            assert!(is_disc(&mesh, chart));
            assert!(divide(&mesh, chart).len() > 1);
        }
    }

    #[test]
    fn borders_between_labels_are_kept_and_small_islands_are_not() {
        let mesh = tube(24, 20);
        let mut labels: Vec<usize> =
            (0..mesh.triangles.len() as u32).map(|t| usize::from(centre_and_normal(&mesh, t).0.x > 0.0)).collect();
        labels[100] = 7;
        let charts = cut(&mesh, labels);
        assert_eq!(charts.len(), 2);
    }
}
