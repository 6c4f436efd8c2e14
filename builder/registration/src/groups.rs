//! Keyframe groups: frames that have one mesh, or one set of texture coordinates, for a while. Inside of a group it is known which
//! point is which, so that one frame is tracked and the others follow it.
//!
//! Encoders renumber vertices and change faces within a group, but keep its texture coordinates to the bit: corners are matched by
//! these where faces differ.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use glam::{Mat3, Vec2, Vec3};

use super::scan::Scan;
use super::surface::{Surface, SurfacePoint};

/// So few texture coordinates are no mark of a mesh.
const LEAST_UVS: usize = 100;
/// Of the template's vertices at most this share may have no counterpart.
const MOST_MISSED: f32 = 0.02;
/// Places of one texture coordinate that are farther apart are several, metres on a person.
const ONE_PLACE: f32 = 1e-3;

/// What tells the mesh of a frame from others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshMark {
    faces: u64,
    uvs: Option<u64>,
}

impl MeshMark {
    /// The mark of `scan`.
    #[must_use]
    pub fn new(scan: &Scan) -> Self {
        let mut hasher = DefaultHasher::new();
        (scan.positions.len(), &scan.triangles).hash(&mut hasher);
        let faces = hasher.finish();
        let mut uvs: Vec<u64> = scan.uvs.as_flattened().iter().map(|&uv| bits(uv)).collect();
        uvs.sort_unstable();
        uvs.dedup();
        let mut hasher = DefaultHasher::new();
        uvs.hash(&mut hasher);
        Self { faces, uvs: (uvs.len() >= LEAST_UVS).then(|| hasher.finish()) }
    }

    /// How points of a frame with this mark are found in one with `other`.
    fn common(self, other: Self) -> Option<Keys> {
        if self.faces == other.faces {
            return Some(Keys::Vertices);
        }
        (self.uvs.is_some() && self.uvs == other.uvs).then_some(Keys::Uvs)
    }
}

/// The group of each frame, numbered as they appear.
#[must_use]
pub fn groups(marks: &[MeshMark]) -> Vec<usize> {
    let (mut of_faces, mut of_uvs) = (HashMap::new(), HashMap::new());
    let mut pairs = Vec::new();
    for (frame, mark) in marks.iter().enumerate() {
        let frame = frame as u32;
        pairs.push([*of_faces.entry(mark.faces).or_insert(frame), frame]);
        if let Some(uvs) = mark.uvs {
            pairs.push([*of_uvs.entry(uvs).or_insert(frame), frame]);
        }
    }
    let (group, _) = kernels::components::connected_components(marks.len(), pairs);
    group.into_iter().map(|group| group as usize).collect()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Keys {
    Vertices,
    Uvs,
}

/// How the template lies on one frame of a group: a point of the frame for each of its vertices, and how far off it is.
#[derive(Clone, Debug)]
pub struct Anchors {
    mark: MeshMark,
    scale: f32,
    anchors: Vec<Anchor>,
}

#[derive(Clone, Copy, Debug)]
struct Anchor {
    /// Vertices of the triangle, and texture coordinates of its corners.
    vertices: [u32; 3],
    uvs: [u64; 3],
    weights: Vec3,
    /// The template's vertex from the point, in the frame of the triangle.
    off: Vec3,
}

impl Anchors {
    /// For `pose` on the frame `scan`; `find` gives the closest point of its surface when it is clean, of whose triangles `kept`
    /// says which of the scan's each is. `None` where there is none for some vertex.
    #[must_use]
    pub fn new(
        (scan, kept): (&Scan, &[u32]),
        pose: &Surface,
        scale: f32,
        find: impl Fn(Vec3, Vec3) -> Option<SurfacePoint>,
    ) -> Option<Self> {
        let of = |(&place, &normal): (&Vec3, &Vec3)| -> Option<Anchor> {
            let point = find(place, normal)?;
            let raw = *kept.get(point.triangle as usize)? as usize;
            let uvs = scan.uvs.get(raw).map_or([0; 3], |uvs| uvs.map(bits));
            let vertices = scan.triangles[raw];
            let corners = vertices.map(|v| scan.positions[v as usize]);
            let off = frame_of(corners)?.transpose() * (place - at(corners, point.weights));
            Some(Anchor { vertices, uvs, weights: point.weights, off })
        };
        let anchors = pose.mesh.positions.iter().zip(&pose.normals).map(of).collect::<Option<Vec<_>>>()?;
        Some(Self { mark: MeshMark::new(scan), scale, anchors })
    }

    /// The template's pose on `scan`, another frame of the group; `neighbours` are those of its vertices. `None` where frames are
    /// not as alike as their marks, or texture coordinates do not say which place is meant.
    #[must_use]
    pub fn follow(&self, scan: &Scan, neighbours: &[Vec<u32>]) -> Option<Vec<Vec3>> {
        let keys = self.mark.common(MeshMark::new(scan))?;
        let places = match keys {
            Keys::Vertices => HashMap::new(),
            Keys::Uvs => places_of_uvs(scan, ONE_PLACE * self.scale),
        };
        let corner = |anchor: &Anchor, k: usize| match keys {
            Keys::Vertices => scan.positions.get(anchor.vertices[k] as usize).copied(),
            Keys::Uvs => places.get(&anchor.uvs[k]).copied().flatten(),
        };
        let of = |anchor: &Anchor| -> Option<Vec3> {
            let corners = [corner(anchor, 0)?, corner(anchor, 1)?, corner(anchor, 2)?];
            Some(at(corners, anchor.weights) + frame_of(corners)? * anchor.off)
        };
        complete(self.anchors.iter().map(of).collect(), neighbours)
    }
}

/// Where each texture coordinate is; `None` where it is in several places.
fn places_of_uvs(scan: &Scan, tolerance: f32) -> HashMap<u64, Option<Vec3>> {
    let mut places: HashMap<u64, Option<Vec3>> = HashMap::new();
    for (triangle, uvs) in scan.triangles.iter().zip(&scan.uvs) {
        for (&vertex, &uv) in triangle.iter().zip(uvs) {
            let place = scan.positions[vertex as usize];
            let known = places.entry(bits(uv)).or_insert(Some(place));
            if known.is_some_and(|known| known.distance(place) > tolerance) {
                *known = None;
            }
        }
    }
    places
}

/// `places` with the few that are missing between their neighbours; `None` where there are more.
pub(crate) fn complete(mut places: Vec<Option<Vec3>>, neighbours: &[Vec<u32>]) -> Option<Vec<Vec3>> {
    let missed = places.iter().filter(|place| place.is_none()).count();
    if missed as f32 > MOST_MISSED * places.len() as f32 {
        return None;
    }
    while places.iter().any(Option::is_none) {
        let between = |vertex: usize| {
            let near = || neighbours[vertex].iter().filter_map(|&other| places[other as usize]);
            (near().count() > 0).then(|| near().sum::<Vec3>() / near().count() as f32)
        };
        let missing = (0..places.len()).filter(|&vertex| places[vertex].is_none());
        let found: Vec<(usize, Vec3)> = missing.filter_map(|vertex| Some((vertex, between(vertex)?))).collect();
        if found.is_empty() {
            return None;
        }
        found.into_iter().for_each(|(vertex, place)| places[vertex] = Some(place));
    }
    places.into_iter().collect()
}

pub(crate) fn at([a, b, c]: [Vec3; 3], weights: Vec3) -> Vec3 {
    a * weights.x + b * weights.y + c * weights.z
}

/// The frame of a triangle: its first edge, what is across it, and its normal.
pub(crate) fn frame_of([a, b, c]: [Vec3; 3]) -> Option<Mat3> {
    let along = (b - a).try_normalize()?;
    let normal = along.cross(c - a).try_normalize()?;
    Some(Mat3::from_cols(along, normal.cross(along), normal))
}

fn bits(uv: Vec2) -> u64 {
    // -0 and 0 are one place.
    let of = |c: f32| u64::from((c + 0.0).to_bits());
    of(uv.x) << 32 | of(uv.y)
}

#[cfg(test)]
mod tests {
    use geometry::mesh::Mesh;
    use geometry::polygonise::polygonise;
    use glam::Quat;

    use super::*;
    use crate::track::Target;

    /// A ball with texture coordinates of its vertices, moved by `motion`.
    fn frame(motion: impl Fn(Vec3) -> Vec3) -> Scan {
        let mesh = polygonise(Vec3::splat(-0.7), Vec3::splat(0.7), 0.08, |p| p.length() - 0.5);
        let uv = |v: u32| {
            let p = mesh.positions[v as usize];
            Vec2::new(p.x * 0.9 + 0.01 * p.z, p.y * 0.9 - 0.02 * p.z) + if p.z > 0.0 { 0.5 } else { 3.0 }
        };
        let uvs = mesh.triangles.iter().map(|t| t.map(uv)).collect();
        let positions = mesh.positions.iter().map(|&p| motion(p)).collect();
        Scan { positions, triangles: mesh.triangles, uvs, colours: Vec::new() }
    }

    /// The same with vertices and triangles in another order, and the corners of each turned.
    fn renumbered(scan: &Scan) -> Scan {
        let count = scan.positions.len() as u32;
        let number = |v: u32| (v * 7 + 3) % count;
        assert_ne!(count % 7, 0);
        let mut positions = vec![Vec3::ZERO; count as usize];
        scan.positions.iter().enumerate().for_each(|(v, p)| positions[number(v as u32) as usize] = *p);
        let turned = |[a, b, c]: [u32; 3]| [b, c, a].map(number);
        let triangles = scan.triangles.iter().rev().map(|&t| turned(t)).collect();
        let uvs = scan.uvs.iter().rev().map(|&[a, b, c]| [b, c, a]).collect();
        Scan { positions, triangles, uvs, colours: Vec::new() }
    }

    fn bend(p: Vec3) -> Vec3 {
        Quat::from_rotation_z(0.4 * p.y) * (Quat::from_rotation_y(0.3) * p) + Vec3::new(0.2, 0.1, 0.0)
    }

    #[test]
    fn frames_of_a_group_follow_to_the_bit_of_their_texture_coordinates() {
        let first = frame(|p| p);
        let cleaned = first.cleaned().unwrap();
        let target = Target::new(cleaned.surface.clone(), 1.0);
        let anchored = |template: &Mesh| {
            let pose = Surface::new(template.clone(), None);
            Anchors::new((&first, &cleaned.kept), &pose, 1.0, |p, n| target.closest(p, n)).unwrap()
        };
        // A template of the same vertices, and one of other triangles, a little off.
        let other = polygonise(Vec3::splat(-0.7), Vec3::splat(0.7), 0.06, |p| p.length() - 0.504);
        let moved = frame(bend);
        for (template, most) in [(&cleaned.surface.mesh, 2e-6), (&other, 0.008)] {
            for frame in [moved.clone(), renumbered(&moved)] {
                let found = anchored(template).follow(&frame, &template.neighbours()).unwrap();
                let off = found.iter().zip(&template.positions).map(|(a, b)| a.distance(bend(*b)));
                let worst = off.fold(0.0, f32::max);
                assert!(worst < most, "{worst} of {most}");
            }
        }
        let (anchors, neighbours) = (anchored(&other), other.neighbours());
        // Another mesh does not follow.
        let mut other = renumbered(&moved);
        other.uvs[0][0].x += 1e-6;
        assert!(anchors.follow(&other, &neighbours).is_none());
        other.uvs.clear();
        assert!(anchors.follow(&other, &neighbours).is_none());
    }

    #[test]
    fn groups_are_of_equal_faces_or_equal_texture_coordinates() {
        let (a, b) = (frame(|p| p), frame(bend));
        let mut c = renumbered(&b);
        let same = [&a, &b, &c].map(MeshMark::new);
        assert_eq!(groups(&same), [0, 0, 0]);
        c.uvs.iter_mut().flatten().for_each(|uv| *uv *= 0.5);
        assert_eq!(groups(&[&a, &c, &b].map(MeshMark::new)), [0, 1, 0]);
        c.uvs.clear();
        assert_eq!(groups(&[&c, &a, &b].map(MeshMark::new)), [0, 1, 1]);
    }

    #[test]
    fn a_texture_coordinate_in_two_places_says_nothing() {
        let mut scan = frame(|p| p);
        let uv = scan.uvs[0][0];
        scan.uvs[20][1] = uv;
        assert_eq!(places_of_uvs(&scan, 1e-3)[&bits(uv)], None);
    }
}
