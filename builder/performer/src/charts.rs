//! Which triangles lie in which chart of the texture: front and back of each garment, so that seams run along the
//! sides, where a tailor would put them.

use glam::Vec3;

use super::body::Body;
use super::skirt;
use geometry::mesh::Mesh;

/// A chart before it is flattened.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Its triangles, ascending.
    pub triangles: Vec<u32>,
    /// Texels per metre, relative to other charts.
    pub density: f32,
}

/// Groups of the surface and the relative texel density of each.
const DENSITIES: [f32; 12] = [1.75, 0.7, 1.0, 0.95, 0.95, 0.85, 0.85, 1.0, 1.0, 0.95, 0.42, 1.0];
const SMALL: usize = 24;

/// Cuts `mesh`, the figure in the bind pose, into charts that are discs.
#[must_use]
pub fn cut(body: &Body, mesh: &Mesh) -> Vec<Chart> {
    let adjacent = adjacency(mesh);
    let mut labels = first_labels(body, mesh);
    for _ in 0..6 {
        smooth(&mut labels, &adjacent);
    }
    let mut labels = components(&labels, &adjacent);
    merge_small(mesh, &mut labels, &adjacent);
    gather(&labels).into_iter().flat_map(|triangles| discs(body, mesh, &adjacent, triangles)).collect()
}

/// Cuts a chart that cannot be laid flat into two or more.
#[must_use]
pub fn divide(body: &Body, mesh: &Mesh, chart: &Chart) -> Vec<Chart> {
    let adjacent = adjacency(mesh);
    let parts = halves(mesh, &chart.triangles, &adjacent);
    parts.into_iter().flat_map(|triangles| discs(body, mesh, &adjacent, triangles)).collect()
}

/// Cuts connected `triangles` into discs.
fn discs(body: &Body, mesh: &Mesh, adjacent: &[[u32; 3]], triangles: Vec<u32>) -> Vec<Chart> {
    let mut charts = Vec::new();
    let mut open = vec![triangles];
    while let Some(triangles) = open.pop() {
        if triangles.is_empty() {
            continue;
        }
        if is_disc(mesh, &triangles) {
            let density = density(body, mesh, &triangles);
            charts.push(Chart { triangles, density });
        } else {
            open.extend(halves(mesh, &triangles, adjacent));
        }
    }
    charts
}

/// The triangle across each of a triangle's edges.
fn adjacency(mesh: &Mesh) -> Vec<[u32; 3]> {
    let edges = mesh.half_edges();
    let across = |a: u32, b: u32| edges.get(&(b, a)).copied().unwrap_or(u32::MAX);
    mesh.triangles.iter().map(|&[a, b, c]| [across(a, b), across(b, c), across(c, a)]).collect()
}

fn centre_and_normal(mesh: &Mesh, triangle: [u32; 3]) -> (Vec3, Vec3) {
    let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
    ((a + b + c) / 3.0, (b - a).cross(c - a).normalize_or(Vec3::Y))
}

fn group(body: &Body, p: Vec3) -> usize {
    let f = body.fields(p);
    let side = usize::from(p.x < 0.0);
    let across = skirt::across(p);
    let candidates = [
        (f.head.min(f.hair), 0),
        (f.tail, 1),
        (f.shirt, 2),
        (f.arms[side], 3 + side),
        (f.legs[side], 5 + side),
        (f.shoes[side], 7 + side),
        (f.skirt, if across > -0.003 || p.y > 0.98 { 9 } else { 10 }),
    ];
    candidates.iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |c| c.1)
}

fn first_labels(body: &Body, mesh: &Mesh) -> Vec<usize> {
    mesh.triangles
        .iter()
        .map(|&t| {
            let (p, n) = centre_and_normal(mesh, t);
            let group = group(body, p);
            let second = match group {
                1 | 7 | 8 => n.x < 0.0,
                9 | 10 => p.z < 0.0,
                0 => n.z + 0.25 * (p.z + 0.02) / 0.1 < 0.0,
                _ => n.z < 0.0,
            };
            group * 2 + usize::from(second)
        })
        .collect()
}

/// Gives a triangle the label of its neighbours where two of them agree against it.
fn smooth(labels: &mut [usize], adjacent: &[[u32; 3]]) {
    let before = labels.to_vec();
    for (label, near) in labels.iter_mut().zip(adjacent) {
        let [a, b, c] = near.map(|t| before[t as usize]);
        if a == b || a == c {
            *label = a;
        } else if b == c {
            *label = b;
        }
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
                if parts[next] == usize::MAX && labels[next] == labels[start] {
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

/// Gives small parts to the neighbour with which they share most edges.
fn merge_small(mesh: &Mesh, labels: &mut [usize], adjacent: &[[u32; 3]]) {
    let small = SMALL.max(mesh.triangles.len() / 120);
    loop {
        let lists = gather(labels);
        let smallest = (0..lists.len()).filter(|&k| !lists[k].is_empty()).min_by_key(|&k| lists[k].len());
        let Some(part) = smallest else { return };
        if lists[part].len() >= small {
            return;
        }
        let mut shared = vec![0_usize; lists.len()];
        for &triangle in &lists[part] {
            for next in adjacent[triangle as usize] {
                shared[labels[next as usize]] += 1;
            }
        }
        shared[part] = 0;
        let Some(into) = (0..shared.len()).rev().max_by_key(|&k| shared[k]) else { return };
        for &triangle in &lists[part] {
            labels[triangle as usize] = into;
        }
    }
}

/// The corners of a chart joined across its inner edges: a number for each corner of each triangle, and their count.
/// A vertex where the chart touches itself gets one number for each side.
pub(super) fn weld_corners(mesh: &Mesh, triangles: &[u32]) -> (Vec<[u32; 3]>, usize) {
    let mut parent: Vec<u32> = (0..triangles.len() as u32 * 3).collect();
    fn root(parent: &mut [u32], mut x: u32) -> u32 {
        while parent[x as usize] != x {
            parent[x as usize] = parent[parent[x as usize] as usize];
            x = parent[x as usize];
        }
        x
    }
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
                    let (x, y) = (root(&mut parent, here as u32), root(&mut parent, there as u32));
                    parent[x.max(y) as usize] = x.min(y);
                }
            }
        }
    }
    let mut number = vec![u32::MAX; parent.len()];
    let mut count = 0;
    let corners = (0..triangles.len())
        .map(|k| {
            std::array::from_fn(|e| {
                let slot = root(&mut parent, (3 * k + e) as u32) as usize;
                if number[slot] == u32::MAX {
                    number[slot] = count;
                    count += 1;
                }
                number[slot]
            })
        })
        .collect();
    (corners, count as usize)
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
    let centres: Vec<Vec3> = triangles.iter().map(|&t| centre_and_normal(mesh, mesh.triangles[t as usize]).0).collect();
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

/// The density of the group that most of the triangles belong to.
fn density(body: &Body, mesh: &Mesh, triangles: &[u32]) -> f32 {
    let mut votes = [0_usize; 12];
    for &triangle in triangles {
        let (p, n) = centre_and_normal(mesh, mesh.triangles[triangle as usize]);
        let group = group(body, p);
        // The back of the head is hair only.
        votes[if group == 0 && n.z < -0.3 { 11 } else { group }] += 1;
    }
    (0..12).rev().max_by_key(|&k| votes[k]).map_or(1.0, |k| DENSITIES[k])
}
