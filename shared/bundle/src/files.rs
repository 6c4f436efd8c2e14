//! The sections about the files that a capture came from: their faces, and where they are. Optional, and written only
//! where they do not follow from the drawn mesh: without them exports write the triangles, in metres.

use super::entropy::binary::{Bit, Decoder, Encoder, MOST_DECISIONS_PER_BYTE};
use super::entropy::numbers::Number;
use actor::files::{FaceRun, FileFaces, FilePlace};
use actor::surface::Surface;
use glam::DVec3;

/// Bytes of a place: offset and unit, 8 each, and which axis points up.
const PLACE_BYTES: usize = 33;

#[derive(Default)]
struct Models {
    count: Number,
    part: Number,
    faces: Number,
    joined: [Bit; 2],
    /// Whether a corner is the file vertex that the drawn corner was the last time.
    same_vertex: Bit,
    vertex: Number,
    has_normals: Bit,
    /// Whether a corner has the normal that is expected, for file vertices that are new and that are known.
    same_normal: [Bit; 2],
    normal: Number,
}

/// The file vertices of each welded vertex, ascending.
struct Groups {
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Groups {
    fn new(file_vertices: &[u32], vertex_count: usize) -> Self {
        let mut starts = vec![0_u32; vertex_count + 1];
        for &vertex in file_vertices {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            starts[vertex + 1] += starts[vertex];
        }
        let (mut next, mut members) = (starts.clone(), vec![0; file_vertices.len()]);
        for (file_vertex, &vertex) in (0..).zip(file_vertices) {
            members[next[vertex as usize] as usize] = file_vertex;
            next[vertex as usize] += 1;
        }
        Self { starts, members }
    }

    fn of(&self, vertex: u32) -> &[u32] {
        &self.members[self.starts[vertex as usize] as usize..self.starts[vertex as usize + 1] as usize]
    }
}

/// What is expected of normals: that of a file vertex is the one that it had the last time, else a new one.
struct Normals {
    of_file_vertex: Vec<Option<u32>>,
    /// Normals about each welded vertex so far.
    counts: Vec<u32>,
}

impl Normals {
    fn new(file_vertex_count: usize, vertex_count: usize) -> Self {
        Self { of_file_vertex: vec![None; file_vertex_count], counts: vec![0; vertex_count] }
    }

    /// Whether the file vertex is known, and the normal to expect.
    fn expected(&self, file_vertex: u32, vertex: u32) -> (bool, u32) {
        let known = self.of_file_vertex[file_vertex as usize];
        (known.is_some(), known.unwrap_or(self.counts[vertex as usize]))
    }

    fn learn(&mut self, file_vertex: u32, vertex: u32, normal: u32) {
        self.of_file_vertex[file_vertex as usize] = Some(normal);
        let count = &mut self.counts[vertex as usize];
        *count = (*count).max(normal.saturating_add(1));
    }
}

/// The section's bytes; `faces` have been checked.
pub(super) fn encode_faces(
    faces: &FileFaces,
    surface: &Surface,
    file_vertices: &[u32],
    vertex_count: usize,
) -> Vec<u8> {
    let (mut encoder, mut models) = (Encoder::default(), Models::default());
    models.count.encode(&mut encoder, faces.runs.len() as u32);
    for run in &faces.runs {
        models.part.encode(&mut encoder, run.part);
        models.faces.encode(&mut encoder, run.faces);
    }
    let has_normals = !faces.normals.is_empty();
    encoder.bit(&mut models.has_normals, has_normals);
    let groups = Groups::new(file_vertices, vertex_count);
    let mut last = vec![None; surface.corners.len()];
    let mut normals = Normals::new(file_vertices.len(), vertex_count);
    let mut before = false;
    for (triangle, drawn) in surface.triangles.iter().enumerate() {
        encoder.bit(&mut models.joined[usize::from(before)], faces.joined[triangle]);
        before = faces.joined[triangle];
        for k in 0..3 {
            let (corner, file_vertex) = (drawn[k] as usize, faces.corners[triangle][k]);
            let vertex = surface.corners[corner].vertex;
            let group = groups.of(vertex);
            if group.len() > 1 {
                let same = last[corner] == Some(file_vertex);
                if last[corner].is_some() {
                    encoder.bit(&mut models.same_vertex, same);
                }
                if !same {
                    let at = group.iter().position(|&member| member == file_vertex).unwrap_or(0);
                    models.vertex.encode(&mut encoder, at as u32);
                }
                last[corner] = Some(file_vertex);
            }
            if has_normals {
                let normal = faces.normals[triangle][k];
                let (known, expected) = normals.expected(file_vertex, vertex);
                encoder.bit(&mut models.same_normal[usize::from(known)], normal == expected);
                if normal != expected {
                    models.normal.encode(&mut encoder, normal);
                }
                normals.learn(file_vertex, vertex, normal);
            }
        }
    }
    encoder.finish()
}

/// Reads the section; the reason where it is none.
pub(super) fn decode_faces(
    bytes: &[u8],
    surface: &Surface,
    file_vertices: &[u32],
    vertex_count: usize,
) -> Result<FileFaces, &'static str> {
    let count = surface.triangles.len();
    if count > bytes.len().saturating_mul(MOST_DECISIONS_PER_BYTE) {
        return Err("is too short for its triangles");
    }
    let (mut decoder, mut models) = (Decoder::new(bytes), Models::default());
    let runs = models.count.decode(&mut decoder) as usize;
    if runs > count {
        return Err("declares more runs of faces than there are triangles");
    }
    let mut faces = FileFaces::default();
    for _ in 0..runs {
        let part = models.part.decode(&mut decoder);
        faces.runs.push(FaceRun { part, faces: models.faces.decode(&mut decoder) });
    }
    let has_normals = decoder.bit(&mut models.has_normals);
    let groups = Groups::new(file_vertices, vertex_count);
    let mut last = vec![None; surface.corners.len()];
    let mut normals = Normals::new(file_vertices.len(), vertex_count);
    let mut before = false;
    for drawn in &surface.triangles {
        before = decoder.bit(&mut models.joined[usize::from(before)]);
        faces.joined.push(before);
        let (mut own, mut own_normals) = ([0; 3], [0; 3]);
        for k in 0..3 {
            let corner = drawn[k] as usize;
            let vertex = surface.corners[corner].vertex;
            let group = groups.of(vertex);
            let file_vertex = match group {
                [] => return Err("draws a vertex that the files do not have"),
                [only] => *only,
                _ => match last[corner] {
                    Some(last) if decoder.bit(&mut models.same_vertex) => last,
                    _ => {
                        let at = models.vertex.decode(&mut decoder);
                        *group.get(at as usize).ok_or("names a file vertex that does not exist")?
                    }
                },
            };
            last[corner] = Some(file_vertex);
            own[k] = file_vertex;
            if has_normals {
                let (known, expected) = normals.expected(file_vertex, vertex);
                let same = decoder.bit(&mut models.same_normal[usize::from(known)]);
                own_normals[k] = if same { expected } else { models.normal.decode(&mut decoder) };
                if own_normals[k] as usize > 3 * count {
                    return Err("numbers normals beyond their number");
                }
                normals.learn(file_vertex, vertex, own_normals[k]);
            }
        }
        faces.corners.push(own);
        if has_normals {
            faces.normals.push(own_normals);
        }
        if decoder.exhausted() {
            return Err("ends too early");
        }
    }
    if !decoder.at_end() {
        return Err("has bytes left over");
    }
    faces.check(surface, file_vertices)?;
    Ok(faces)
}

/// The section's bytes.
pub(super) fn encode_place(place: &FilePlace) -> Vec<u8> {
    let numbers = place.offset.to_array().into_iter().chain([place.unit]);
    numbers.flat_map(f64::to_le_bytes).chain([u8::from(place.z_up)]).collect()
}

/// Reads the section; the reason where it is none.
pub(super) fn decode_place(bytes: &[u8]) -> Result<FilePlace, &'static str> {
    let bytes: &[u8; PLACE_BYTES] = bytes.try_into().map_err(|_| "has another size than a place")?;
    let (numbers, _) = bytes.as_chunks::<8>();
    let [x, y, z, unit] = [0, 1, 2, 3].map(|k: usize| f64::from_le_bytes(numbers[k]));
    let place = FilePlace { offset: DVec3::new(x, y, z), unit, z_up: bytes[PLACE_BYTES - 1] == 1 };
    let holds = place.offset.is_finite() && unit.is_finite() && unit > 0.0 && bytes[PLACE_BYTES - 1] <= 1;
    if holds { Ok(place) } else { Err("has a number out of range") }
}
