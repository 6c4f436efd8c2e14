//! A scanned frame made fit for registration: vertices of one place become one, crumbs go, wedges stay.

use std::collections::{HashMap, HashSet};

use geometry::mesh::Mesh;
use glam::{IVec3, Vec2, Vec3};
use kernels::components::connected_components;

use super::surface::Surface;

/// Vertices nearer than this are one, metres on a person.
const WELD: f32 = 1e-4;
/// Parts of fewer triangles are crumbs.
const CRUMB: usize = 60;
/// Parts of more triangles, but a smaller share of the area of all, float about: a hand that is cut off has twice as much.
const DEBRIS: f32 = 0.01;

/// A frame as it was scanned.
#[derive(Clone, Debug, Default)]
pub struct Scan {
    /// Vertices in metres, +Y up.
    pub positions: Vec<Vec3>,
    /// Triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates of the corners of each triangle; empty where there are none.
    pub uvs: Vec<[Vec2; 3]>,
    /// Colours of the vertices, 0 to 1; empty where there are none.
    pub colours: Vec<Vec3>,
}

/// Triangles of a scan that are no part of its surface: what was left out without a loss.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mended {
    /// They lie on others.
    pub doubled: usize,
    /// They have no area once vertices of one place are one.
    pub collapsed: usize,
    /// They hang together with fewer than 60.
    pub crumbs: usize,
}

/// A scan without its faults.
#[derive(Clone, Debug)]
pub struct Cleaned {
    /// The surface.
    pub surface: Surface,
    /// Texture coordinates of the corners of the surface's triangles; empty where there are none.
    pub uvs: Vec<[Vec2; 3]>,
    /// The scan's triangle that each of the surface's is.
    pub kept: Vec<u32>,
    /// Connected parts that are left.
    pub parts: usize,
    /// Parts that were more than crumbs, but float about.
    pub debris: usize,
    /// Triangles that were left out, but for debris.
    pub mended: Mended,
}

impl Scan {
    /// The scan with vertices of one place welded, doubled and collapsed triangles and small loose parts taken out. `None` where
    /// nothing is left. Colours are those of the first of the vertices that were welded.
    #[must_use]
    pub fn cleaned(&self) -> Option<Cleaned> {
        let (low, high) = bounds(&self.positions);
        // Of a body that is not a person's size, so much less or more.
        let tolerance = WELD * (high - low).max_element() / 1.8;
        let number = welded(&self.positions, tolerance.max(1e-9));
        let corners = |k: usize| self.triangles[k].map(|v| number[v as usize]);
        let (kept, mut mended) = single(self.triangles.len(), corners);
        let pairs = kept.iter().flat_map(|&k| {
            let [a, b, c] = corners(k);
            [[a, b], [b, c]]
        });
        let (part, _) = connected_components(self.positions.len(), pairs);
        let mut sizes: HashMap<u32, (usize, f32)> = HashMap::new();
        for &k in &kept {
            let (count, area) = sizes.entry(part[corners(k)[0] as usize]).or_default();
            let [a, b, c] = corners(k).map(|v| self.positions[v as usize]);
            *count += 1;
            *area += area_of([a, b, c]);
        }
        // A mesh of crumbs alone keeps its largest.
        let least = CRUMB.min(sizes.values().map(|size| size.0).max().unwrap_or(0));
        let smallest =
            DEBRIS * kept.iter().map(|&k| area_of(corners(k).map(|v| self.positions[v as usize]))).sum::<f32>();
        let is_debris = |&(count, area): &(usize, f32)| count >= least && area < smallest;
        let is_body = |size: &(usize, f32)| size.0 >= least && !is_debris(size);
        let in_crumbs = |count: &usize| *count < least;
        mended.crumbs = sizes.values().map(|size| size.0).filter(in_crumbs).sum();
        let kept: Vec<usize> = kept.into_iter().filter(|&k| is_body(&sizes[&part[corners(k)[0] as usize]])).collect();
        let parts = sizes.values().filter(|size| is_body(size)).count();
        let debris = sizes.values().filter(|size| is_debris(size)).count();
        let mut compact = vec![u32::MAX; self.positions.len()];
        let (mut positions, mut colours) = (Vec::new(), Vec::new());
        let triangles: Vec<[u32; 3]> = kept
            .iter()
            .map(|&k| {
                corners(k).map(|vertex| {
                    let slot = &mut compact[vertex as usize];
                    if *slot == u32::MAX {
                        *slot = positions.len() as u32;
                        positions.push(self.positions[vertex as usize]);
                        colours.extend(self.colours.get(vertex as usize));
                    }
                    *slot
                })
            })
            .collect();
        if triangles.is_empty() {
            return None;
        }
        let uvs = if self.uvs.is_empty() { Vec::new() } else { kept.iter().map(|&k| self.uvs[k]).collect() };
        let colours = (colours.len() == positions.len()).then_some(colours);
        let surface = Surface::new(Mesh { positions, triangles }, colours);
        let kept = kept.into_iter().map(|k| k as u32).collect();
        Some(Cleaned { surface, uvs, kept, parts, debris, mended })
    }
}

impl Cleaned {
    /// The surface as a template may be: every edge has at most one triangle on each side.
    #[must_use]
    pub fn manifold(&self) -> Surface {
        let mut used = HashSet::new();
        let mesh = &self.surface.mesh;
        let fits = |&[a, b, c]: &[u32; 3]| {
            let edges = [(a, b), (b, c), (c, a)];
            let free = edges.iter().all(|edge| !used.contains(edge));
            if free {
                used.extend(edges);
            }
            free
        };
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().copied().filter(fits).collect();
        if triangles.len() == mesh.triangles.len() {
            return self.surface.clone();
        }
        let mut number = vec![u32::MAX; mesh.positions.len()];
        let (mut positions, mut colours) = (Vec::new(), Vec::new());
        let mut renumbered = |vertex: u32| {
            let slot = &mut number[vertex as usize];
            if *slot == u32::MAX {
                *slot = positions.len() as u32;
                positions.push(mesh.positions[vertex as usize]);
                colours.extend(self.surface.colours.as_ref().map(|colours| colours[vertex as usize]));
            }
            *slot
        };
        let triangles = triangles.into_iter().map(|triangle| triangle.map(&mut renumbered)).collect();
        let colours = self.surface.colours.is_some().then_some(colours);
        Surface::new(Mesh { positions, triangles }, colours)
    }
}

/// Of `count` triangles with `corners` those that have an area and do not lie on one before them, and how many others there are.
fn single(count: usize, corners: impl Fn(usize) -> [u32; 3]) -> (Vec<usize>, Mended) {
    let (mut seen, mut kept, mut mended) =
        (HashSet::with_capacity(count), Vec::with_capacity(count), Mended::default());
    for k in 0..count {
        let mut sorted = corners(k);
        sorted.sort_unstable();
        if sorted[0] == sorted[1] || sorted[1] == sorted[2] {
            mended.collapsed += 1;
        } else if seen.insert(sorted) {
            kept.push(k);
        } else {
            mended.doubled += 1;
        }
    }
    (kept, mended)
}

fn area_of([a, b, c]: [Vec3; 3]) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}

fn bounds(positions: &[Vec3]) -> (Vec3, Vec3) {
    let wide = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = positions.iter().fold(wide, |(low, high), &p| (low.min(p), high.max(p)));
    if positions.is_empty() { (Vec3::ZERO, Vec3::ZERO) } else { (low, high) }
}

/// For each vertex the first that is no farther than `tolerance` from it, through such steps.
fn welded(positions: &[Vec3], tolerance: f32) -> Vec<u32> {
    let cell_of = |p: Vec3| (p / tolerance).floor().as_ivec3();
    let mut cells: HashMap<IVec3, Vec<u32>> = HashMap::with_capacity(positions.len());
    let mut number: Vec<u32> = Vec::with_capacity(positions.len());
    for (vertex, &position) in positions.iter().enumerate() {
        let cell = cell_of(position);
        let mut first = vertex as u32;
        for step in 0..27 {
            let beside = cell + IVec3::new(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
            for &other in cells.get(&beside).map_or(&[][..], Vec::as_slice) {
                if positions[other as usize].distance(position) <= tolerance {
                    first = first.min(other);
                }
            }
        }
        if first == vertex as u32 {
            cells.entry(cell).or_default().push(first);
        }
        number.push(first);
    }
    number
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A closed box of `n` squares along each edge, with every triangle's corners vertices of their own.
    fn soup(n: u32) -> Scan {
        let mut scan = Scan::default();
        let half = n as f32 / 2.0;
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                for u in 0..n {
                    for v in 0..n {
                        let at = |u: u32, v: u32| {
                            let (u, v) = (u as f32 - half, v as f32 - half);
                            let mut place = [0.0; 3];
                            place[axis] = side * half;
                            place[(axis + 1) % 3] = if side > 0.0 { u } else { v };
                            place[(axis + 2) % 3] = if side > 0.0 { v } else { u };
                            Vec3::from(place)
                        };
                        let (a, b, c, d) = (at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1));
                        for corners in [[a, b, c], [a, c, d]] {
                            let first = scan.positions.len() as u32;
                            scan.positions.extend(corners);
                            scan.triangles.push([first, first + 1, first + 2]);
                        }
                    }
                }
            }
        }
        scan
    }

    #[test]
    fn a_soup_of_triangles_becomes_a_closed_surface() {
        let mut scan = soup(4);
        let whole = scan.triangles.len();
        scan.uvs = (0..whole).map(|k| [Vec2::splat(k as f32); 3]).collect();
        // A doubled triangle, one without an area, and a crumb.
        scan.triangles.extend([[2, 0, 1], [5, 5, 6]]);
        let first = scan.positions.len() as u32;
        scan.positions.extend([Vec3::splat(9.0), Vec3::new(9.0, 9.0, 10.0), Vec3::new(9.0, 10.0, 9.0)]);
        scan.triangles.push([first, first + 1, first + 2]);
        scan.uvs.extend([[Vec2::splat(-1.0); 3]; 3]);
        let cleaned = scan.cleaned().unwrap();
        cleaned.surface.mesh.check_closed().unwrap();
        assert_eq!((cleaned.parts, cleaned.mended), (1, Mended { doubled: 1, collapsed: 1, crumbs: 1 }));
        assert!(cleaned.surface.mesh.volume() > 0.0);
        let wanted: Vec<_> = (0..whole).map(|k| [Vec2::splat(k as f32); 3]).collect();
        assert_eq!(cleaned.uvs, wanted);
    }

    #[test]
    fn a_web_is_no_part_of_a_template() {
        let mut scan = soup(4).cleaned().unwrap();
        let [a, b, _] = scan.surface.mesh.triangles[0];
        let mut mesh = scan.surface.mesh.clone();
        mesh.positions.push(Vec3::splat(3.0));
        mesh.triangles.push([a, b, mesh.positions.len() as u32 - 1]);
        scan.surface = Surface::new(mesh, None);
        scan.manifold().mesh.check_closed().unwrap();
    }

    #[test]
    fn nothing_is_left_of_nothing() {
        assert!(Scan::default().cleaned().is_none());
        let point = Scan { positions: vec![Vec3::ONE; 3], triangles: vec![[0, 1, 2]], ..Scan::default() };
        assert!(point.cleaned().is_none());
    }
}
