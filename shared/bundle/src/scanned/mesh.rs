//! The mesh of a group of scanned frames as adaptive decisions: triangles, then each corner and vertex where a triangle first uses
//! it, foretold by the parallelogram over the edge that the triangle shares; then how vertices move from frame to frame.

use glam::Vec3;

use super::{ScannedCorner, ScannedGroup, ScannedHead};
use crate::entropy::binary::{Bit, Decoder, Encoder};
use crate::entropy::numbers::Number;
use crate::limits::MAX_COORDINATE;
use crate::triangles;
use kernels::codec::zigzag::{unzigzag, zigzag};

/// Texture coordinates are stored in so many steps of their range.
const UV_STEPS: f64 = 32_767.0;
/// They may be so far out: pictures repeat.
pub const FARTHEST_UV: f32 = 1e4;
/// How large the residual before was, in classes: it tells how large the next one is.
const CLASSES: usize = 6;

/// A point on the grid of positions, of texture coordinates (of which the third is 0), or of colours.
type Whole = [i32; 3];

/// Learnt probabilities of points of one kind.
struct Points {
    models: [[Number; 3]; CLASSES],
    class: usize,
    axes: usize,
}

impl Points {
    fn new(axes: usize) -> Self {
        Self { models: std::array::from_fn(|_| std::array::from_fn(|_| Number::default())), class: 0, axes }
    }
}

/// Either direction of the codec, so that encoder and decoder cannot part: what is given counts where it is written, what is given
/// back where it is read.
trait Coder {
    fn bit(&mut self, model: &mut Bit, bit: bool) -> bool;
    fn number(&mut self, model: &mut Number, value: u32) -> u32;
    fn word(&mut self, value: u32) -> u32;
    fn exhausted(&self) -> bool;
}

impl Coder for Encoder {
    fn bit(&mut self, model: &mut Bit, bit: bool) -> bool {
        Self::bit(self, model, bit);
        bit
    }

    fn number(&mut self, model: &mut Number, value: u32) -> u32 {
        model.encode(self, value);
        value
    }

    fn word(&mut self, value: u32) -> u32 {
        self.raw(value, 32);
        value
    }

    fn exhausted(&self) -> bool {
        false
    }
}

impl Coder for Decoder<'_> {
    fn bit(&mut self, model: &mut Bit, _: bool) -> bool {
        Self::bit(self, model)
    }

    fn number(&mut self, model: &mut Number, _: u32) -> u32 {
        model.decode(self)
    }

    fn word(&mut self, _: u32) -> u32 {
        self.raw(32)
    }

    fn exhausted(&self) -> bool {
        Self::exhausted(self)
    }
}

/// `value`, which `guess` comes near to.
#[inline(never)]
fn point<C: Coder>(coder: &mut C, points: &mut Points, value: Whole, guess: Whole) -> Whole {
    let models = &mut points.models[points.class];
    let (mut size, mut found) = (0_u32, [0; 3]);
    for axis in 0..points.axes {
        let off = unzigzag(coder.number(&mut models[axis], zigzag(value[axis].wrapping_sub(guess[axis]))));
        size = size.saturating_add(off.unsigned_abs());
        found[axis] = guess[axis].wrapping_add(off);
    }
    points.class = ((33 - size.leading_zeros()) as usize / 2).min(CLASSES - 1);
    found
}

/// What positions and texture coordinates are multiples of.
struct Scale {
    /// Metres.
    step: f32,
    /// Least texture coordinate and extent along each axis.
    uvs: [(f32, f32); 2],
}

impl Scale {
    fn code<C: Coder>(&mut self, coder: &mut C) {
        let [(u, width), (v, height)] = &mut self.uvs;
        for number in [&mut self.step, u, width, v, height] {
            *number = f32::from_bits(coder.word(number.to_bits()));
        }
    }

    fn is_sound(&self) -> bool {
        let is_range =
            |&(low, extent): &(f32, f32)| low.abs() <= FARTHEST_UV && (0.0..=2.0 * FARTHEST_UV).contains(&extent);
        self.step > 0.0 && self.step < 1e6 && self.uvs.iter().all(is_range)
    }
}

/// What a group holds, in whole numbers: filled in where it is read.
struct Content {
    vertices: Vec<u32>,
    uvs: Vec<Whole>,
    colours: Vec<Whole>,
    poses: Vec<Vec<Whole>>,
}

impl Content {
    fn empty(head: &ScannedHead) -> Self {
        let vertices = head.vertices as usize;
        Self {
            vertices: vec![0; head.corners as usize],
            uvs: vec![[0; 3]; head.corners as usize],
            colours: vec![[0; 3]; if head.coloured { vertices } else { 0 }],
            poses: vec![vec![[0; 3]; vertices]; head.frames as usize],
        }
    }
}

/// The mesh of `group`, which is [`ordered`](super::ordered), with positions as multiples of `step`.
pub fn encode(group: &ScannedGroup, head: &ScannedHead, step: f32) -> Vec<u8> {
    let mut scale = Scale { step, uvs: [0, 1].map(|axis| uv_range(group, axis)) };
    let mut content = Content {
        vertices: group.corners.iter().map(|corner| corner.vertex).collect(),
        uvs: group.corners.iter().map(|corner| quantised(corner.uv, &scale)).collect(),
        colours: group.colours.iter().map(|colour| colour.map(i32::from)).collect(),
        poses: group.poses.iter().map(|pose| pose.iter().map(|&p| on_grid(p, step)).collect()).collect(),
    };
    let mut encoder = Encoder::default();
    scale.code(&mut encoder);
    let mut shared = Vec::new();
    triangles::encode_told(&mut encoder, &group.triangles, &mut |edge| shared.push(edge));
    // What is written is there, and every corner and vertex is used: nothing can go wrong.
    let _ = run(&mut encoder, head, &group.triangles, &shared, &mut content);
    encoder.finish()
}

/// Reads the mesh of a group of which `head` tells; the reason where that cannot be.
pub fn decode(bytes: &[u8], head: &ScannedHead) -> Result<ScannedGroup, &'static str> {
    let mut decoder = Decoder::new(bytes);
    let mut scale = Scale { step: 0.0, uvs: [(0.0, 0.0); 2] };
    scale.code(&mut decoder);
    if !scale.is_sound() {
        return Err("has positions or texture coordinates in steps that are none");
    }
    let mut shared = Vec::new();
    let triangles = triangles::decode_told(&mut decoder, head.triangles, head.corners, &mut |edge| shared.push(edge))?;
    let mut content = Content::empty(head);
    run(&mut decoder, head, &triangles, &shared, &mut content)?;
    if !decoder.at_end() {
        return Err("has bytes left over");
    }
    let place = |p: &Whole| Vec3::from_array(p.map(|coordinate| coordinate as f32 * scale.step));
    if content.poses.iter().flatten().flatten().any(|p| p.unsigned_abs() > MAX_COORDINATE as u32) {
        return Err("has a vertex that is too far out");
    }
    let corner = |(&vertex, uv): (&u32, &Whole)| ScannedCorner { vertex, uv: restored(*uv, &scale) };
    Ok(ScannedGroup {
        first_frame: head.first_frame,
        corners: content.vertices.iter().zip(&content.uvs).map(corner).collect(),
        triangles,
        poses: content.poses.iter().map(|pose| pose.iter().map(place).collect()).collect(),
        colours: content.colours.iter().map(|colour| colour.map(|channel| channel as u8)).collect(),
        images: Vec::new(),
        worn: head.worn.clone(),
    })
}

/// Goes through corners, vertices and frames in the one order that both directions have.
fn run<C: Coder>(
    coder: &mut C,
    head: &ScannedHead,
    triangles: &[[u32; 3]],
    shared: &[Option<usize>],
    content: &mut Content,
) -> Result<(), &'static str> {
    let mut seen = vec![false; head.corners as usize];
    // Vertices in the order of their first use, each with the one that it is foretold by.
    let mut order: Vec<(u32, u32)> = Vec::new();
    let (mut is_new, mut back) = (Bit::default(), Number::default());
    let (mut uvs, mut colours, mut places) = (Points::new(2), Points::new(3), Points::new(3));
    let mut last = None;
    for (triangle, edge) in triangles.iter().zip(shared) {
        let beside = edge.and_then(|edge| parallelogram(triangles, edge));
        for &corner in triangle {
            if std::mem::replace(&mut seen[corner as usize], true) {
                continue;
            }
            let corner = corner as usize;
            // Without a parallelogram it is where the corner before is.
            let from = beside.or(last.map(|last| [last; 3])).map(|corners| corners.map(|corner| corner as usize));
            if !head.images.is_empty() {
                let guess = from.map_or([0; 3], |from| across(&content.uvs, from));
                content.uvs[corner] = point(coder, &mut uvs, content.uvs[corner], guess);
            }
            let next = order.len() as u32;
            let given = content.vertices[corner];
            let vertex = if coder.bit(&mut is_new, given == next) {
                next
            } else {
                let behind = coder.number(&mut back, next.wrapping_sub(given).wrapping_sub(1));
                next.wrapping_sub(behind).wrapping_sub(1)
            };
            if vertex > next || vertex >= head.vertices || coder.exhausted() {
                return Err("has a corner without a vertex");
            }
            content.vertices[corner] = vertex;
            if vertex == next {
                let from = from.map(|from| from.map(|corner| content.vertices[corner] as usize));
                let pose = &mut content.poses[0];
                let guess = from.map_or([0; 3], |from| across(pose, from));
                pose[vertex as usize] = point(coder, &mut places, pose[vertex as usize], guess);
                if head.coloured {
                    let guess = from.map_or([0; 3], |[a, ..]| content.colours[a]);
                    let colour = &mut content.colours[vertex as usize];
                    *colour = point(coder, &mut colours, *colour, guess);
                }
                order.push((vertex, from.map_or(vertex, |[a, ..]| a as u32)));
            }
            last = Some(corner as u32);
        }
    }
    if order.len() != head.vertices as usize || seen.contains(&false) {
        return Err("has a corner or a vertex that no triangle uses");
    }
    for frame in 1..content.poses.len() {
        let mut places = Points::new(3);
        let (before, after) = content.poses.split_at_mut(frame);
        let (before, pose) = (&before[frame - 1], &mut after[0]);
        for &(vertex, from) in &order {
            let (vertex, from) = (vertex as usize, from as usize);
            // A vertex that is its own forerunner does not move, as far as one can tell.
            let guess = std::array::from_fn(|axis| {
                let moved = if from == vertex { 0 } else { pose[from][axis].wrapping_sub(before[from][axis]) };
                before[vertex][axis].wrapping_add(moved)
            });
            pose[vertex] = point(coder, &mut places, pose[vertex], guess);
        }
        if coder.exhausted() {
            return Err("ends within its frames");
        }
    }
    Ok(())
}

/// The two ends of the edge numbered `edge`, and the corner that lies across it in its triangle.
fn parallelogram(triangles: &[[u32; 3]], edge: usize) -> Option<[u32; 3]> {
    let triangle = triangles.get(edge / 3)?;
    Some([0, 1, 2].map(|corner| triangle[(edge + corner) % 3]))
}

/// The fourth point of the parallelogram of which the first two are a diagonal's ends.
fn across(points: &[Whole], [a, b, c]: [usize; 3]) -> Whole {
    std::array::from_fn(|axis| points[a][axis].wrapping_add(points[b][axis]).wrapping_sub(points[c][axis]))
}

/// `place` as the nearest multiples of `step`.
fn on_grid(place: Vec3, step: f32) -> Whole {
    place.to_array().map(|coordinate| (f64::from(coordinate) / f64::from(step)).round() as i32)
}

/// Least texture coordinate and extent along `axis`; zero where there are no images.
fn uv_range(group: &ScannedGroup, axis: usize) -> (f32, f32) {
    let values = group.corners.iter().map(|corner| corner.uv[axis]);
    let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), uv| (low.min(uv), high.max(uv)));
    if low <= high && !group.images.is_empty() { (low, high - low) } else { (0.0, 0.0) }
}

fn quantised(uv: [f32; 2], scale: &Scale) -> Whole {
    let axis = |axis: usize| {
        let (low, extent) = scale.uvs[axis];
        let share = (f64::from(uv[axis]) - f64::from(low)) / f64::from(extent);
        if extent > 0.0 { (share * UV_STEPS).round() as i32 } else { 0 }
    };
    [axis(0), axis(1), 0]
}

fn restored(uv: Whole, scale: &Scale) -> [f32; 2] {
    [0, 1].map(|axis| {
        let (low, extent) = scale.uvs[axis];
        (f64::from(low) + f64::from(extent) * f64::from(uv[axis]) / UV_STEPS) as f32
    })
}
