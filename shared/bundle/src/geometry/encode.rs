//! Encoding all frames of a capture: rounding, prediction as the decoder will do it, then tables, then bytes.

use glam::Vec3;

use super::super::meta::Chunk;
use super::model::{self, Weights};
use super::quantise::Grid;
use super::schedule::{CLASSES, Coding, chunk_lengths, coding, coding_order};
use super::training::{Trainer, untrained};
use super::traversal::Traversal;
use actor::capture::Capture;
use kernels::codec::Steps;
use kernels::codec::frame::{mean, position, predict};
use kernels::codec::rans::{Encoder, Table, frequencies};
use kernels::codec::residual::{CONTEXTS, Coded, SYMBOLS, context_of_sum, magnitude};

/// Frames of a chunk: a few groups and the frame that ends the last one.
const CHUNK_FRAMES: u32 = 33;
/// Frames that prediction weights are learnt from at most.
const SAMPLE: usize = 256;
/// Captures shorter than this are not worth the bytes of learnt weights.
const SHORT: usize = 8;

/// The geometry of a capture as bytes.
pub struct Geometry {
    /// The frames of each chunk.
    pub chunks: Vec<Chunk>,
    /// The bytes of each chunk.
    pub chunk_bytes: Vec<Vec<u8>>,
    /// The bytes of the model section.
    pub model: Vec<u8>,
    /// Frames from one independent frame to the next.
    pub group: u32,
    /// Root mean square distance in metres between decoded and captured vertices.
    pub rms_error: f64,
    /// Largest distance in metres between decoded and captured vertices.
    pub max_error: f64,
}

/// Encodes the positions of `capture` on `grid`; `first_frame` is the pose on which components are linked.
#[must_use]
pub fn encode(capture: &Capture, grid: &Grid, group: u32, first_frame: u32) -> Geometry {
    let frame_count = capture.poses.len();
    let most_parents = if frame_count < SHORT { 2 } else { 8 };
    let links = nearest_links(capture, capture.poses.frame(first_frame));
    let traversal = Traversal::new(&capture.topology, &links, most_parents).unwrap_or_else(|_| {
        // Links were made for this very topology.
        unreachable!("links that do not fit")
    });
    let chunks = divide(capture);
    let weights = learn(capture, grid, &traversal, &chunks, group);
    let mut writer = Writer::new(grid, &traversal, &weights);
    let coded: Vec<Vec<Residuals>> =
        chunks.iter().map(|&chunk| writer.residuals_of_chunk(capture, chunk, group)).collect();
    let frequencies: Vec<Vec<u32>> = writer.counts.iter().map(|counts| frequencies(counts)).collect();
    let tables: Vec<Table> = frequencies.iter().filter_map(|row| Table::new(row)).collect();
    let chunk_bytes = coded.iter().map(|frames| writer.bytes_of_chunk(frames, group, &tables)).collect();
    let vertices = frame_count as f64 * capture.poses.vertex_count() as f64;
    Geometry {
        chunk_bytes,
        chunks,
        model: model::encode(&links, &traversal, &weights, &frequencies, group > 1),
        group,
        rms_error: (writer.squares / vertices.max(1.0)).sqrt(),
        max_error: writer.largest_square.sqrt(),
    }
}

fn divide(capture: &Capture) -> Vec<Chunk> {
    let mut chunks = Vec::new();
    for sequence in capture.timeline.sequences() {
        let mut first_frame = sequence.first_frame;
        for frame_count in chunk_lengths(sequence.frame_count, CHUNK_FRAMES) {
            chunks.push(Chunk { first_frame, frame_count });
            first_frame += frame_count;
        }
    }
    chunks
}

/// For the first vertex of each component but the first, the nearest of (a sample of) the vertices before it.
fn nearest_links(capture: &Capture, pose: &[Vec3]) -> Vec<u32> {
    const LOOKED_AT: usize = 4096;
    let components = capture.topology.component_of_vertex();
    let (mut links, mut next) = (Vec::new(), 0);
    for (vertex, &component) in components.iter().enumerate() {
        if component != next {
            continue;
        }
        next += 1;
        if component > 0 {
            // All vertices before the first one of a component belong to earlier components.
            let stride = vertex.div_ceil(LOOKED_AT).max(1);
            let square = |other: &usize| pose[*other].distance_squared(pose[vertex]);
            let nearest = (0..vertex).step_by(stride).min_by(|a, b| square(a).total_cmp(&square(b)));
            links.push(nearest.unwrap_or(0) as u32);
        }
    }
    links
}

/// Prediction weights from a sample of the frames, rounded to the grid.
fn learn(capture: &Capture, grid: &Grid, traversal: &Traversal, chunks: &[Chunk], group: u32) -> Weights {
    let frame_count = capture.poses.len();
    if frame_count < SHORT {
        return untrained(traversal);
    }
    let slots_of = |frame: u32| rounded(capture.poses.frame(frame), grid, traversal);
    let mut independent = Trainer::new(traversal, 0);
    for frame in (0..frame_count).step_by(frame_count.div_ceil(SAMPLE)) {
        independent.add(&slots_of(frame as u32));
    }
    let dependent: Vec<(u32, u32, u32)> = chunks
        .iter()
        .flat_map(|chunk| (0..chunk.frame_count).map(move |local| (chunk, local)))
        .filter_map(|(chunk, local)| {
            let (low, high) = coding(local, chunk.frame_count, group).references?;
            let first = chunk.first_frame;
            Some((first + local, first + low, first + high))
        })
        .collect();
    let mut differences = Trainer::new(traversal, 1);
    for &(frame, low, high) in dependent.iter().step_by(dependent.len().div_ceil(SAMPLE).max(1)) {
        let mut slots = slots_of(frame);
        subtract_mean(&mut slots, &slots_of(low), &slots_of(high));
        differences.add(&slots);
    }
    [independent.weights(), differences.weights()]
}

fn rounded(pose: &[Vec3], grid: &Grid, traversal: &Traversal) -> Vec<Steps> {
    let vertices = traversal.vertex_of_place.iter();
    let slots = vertices.map(|&vertex| Grid::nearest(grid.in_steps(pose[vertex as usize])));
    std::iter::once([0; 4]).chain(slots).collect()
}

fn subtract_mean(slots: &mut [Steps], low: &[Steps], high: &[Steps]) {
    for ((slot, a), b) in slots.iter_mut().zip(low).zip(high) {
        for lane in 0..4 {
            slot[lane] = slot[lane].wrapping_sub(mean(a[lane], b[lane]));
        }
    }
}

/// Residuals of a frame, three a vertex. Few are large, so they are kept small: a capture has millions.
#[derive(Default)]
struct Residuals {
    small: Vec<i16>,
    /// Those that `small` holds as `i16::MIN`, in order.
    large: Vec<i32>,
}

impl Residuals {
    fn push(&mut self, residual: i32) {
        match i16::try_from(residual) {
            Ok(small) if small != i16::MIN => self.small.push(small),
            _ => {
                self.small.push(i16::MIN);
                self.large.push(residual);
            }
        }
    }

    fn iter(&self) -> impl Iterator<Item = i32> {
        let mut large = self.large.iter();
        self.small.iter().map(move |&small| match small {
            i16::MIN => large.next().copied().unwrap_or(0),
            small => i32::from(small),
        })
    }
}

struct Writer<'a> {
    grid: &'a Grid,
    traversal: &'a Traversal,
    weights: &'a Weights,
    contexts: Box<[u8]>,
    /// How often each symbol occurs in each context of each class.
    counts: Vec<Vec<u64>>,
    squares: f64,
    largest_square: f64,
}

impl<'a> Writer<'a> {
    fn new(grid: &'a Grid, traversal: &'a Traversal, weights: &'a Weights) -> Self {
        let counts = vec![vec![0; SYMBOLS]; CLASSES * CONTEXTS];
        let contexts = Box::new(context_of_sum());
        Self { grid, traversal, weights, contexts, counts, squares: 0.0, largest_square: 0.0 }
    }

    /// Residuals of the frames of a chunk, in the order of the frames.
    fn residuals_of_chunk(&mut self, capture: &Capture, chunk: Chunk, group: u32) -> Vec<Residuals> {
        let mut decoded: Vec<Vec<Steps>> = vec![Vec::new(); chunk.frame_count as usize];
        let mut residuals: Vec<Residuals> = Vec::new();
        residuals.resize_with(chunk.frame_count as usize, Residuals::default);
        for (local, coding) in coding_order(chunk.frame_count, group) {
            let pose = capture.poses.frame(chunk.first_frame + local);
            let references = coding.references.map(|(a, b)| [&decoded[a as usize][..], &decoded[b as usize][..]]);
            let (found, slots) = match self.traversal.most_parents {
                2 => self.residuals_of_frame::<2>(pose, coding, references),
                4 => self.residuals_of_frame::<4>(pose, coding, references),
                _ => self.residuals_of_frame::<8>(pose, coding, references),
            };
            self.count(&found, coding);
            residuals[local as usize] = found;
            decoded[local as usize] = slots;
        }
        residuals
    }

    /// Residuals of a frame, and the frame as the decoder will see it.
    fn residuals_of_frame<const PARENTS: usize>(
        &mut self,
        pose: &[Vec3],
        coding: Coding,
        references: Option<[&[Steps]; 2]>,
    ) -> (Residuals, Vec<Steps>) {
        let kind = usize::from(references.is_some());
        let parents = self.traversal.parent_slots.as_chunks::<PARENTS>().0;
        let weights = self.weights[kind].as_chunks::<PARENTS>().0;
        let mut residuals = Residuals::default();
        // Differences from the references, which the decoder predicts; and the frame itself.
        let mut slots: Vec<Steps> = vec![[0; 4]; pose.len() + 1];
        let mut decoded = slots.clone();
        debug_assert_eq!(kind == 0, coding.references.is_none());
        for (place, &vertex) in self.traversal.vertex_of_place.iter().enumerate() {
            let expected = references.map_or([0; 4], |[low, high]| {
                std::array::from_fn(|lane| mean(low[place + 1][lane], high[place + 1][lane]))
            });
            let predicted = predict(&slots, &parents[place], &weights[place]);
            let guess: Steps = std::array::from_fn(|lane| expected[lane].wrapping_add(predicted[lane]));
            let exact = pose[vertex as usize];
            let chosen = self.grid.choose(self.grid.in_steps(exact), guess);
            for lane in 0..3 {
                residuals.push(chosen[lane].wrapping_sub(guess[lane]));
                slots[place + 1][lane] = chosen[lane].wrapping_sub(expected[lane]);
            }
            decoded[place + 1] = chosen;
            let square = position(chosen, self.grid.step).as_dvec3().distance_squared(exact.as_dvec3());
            self.squares += square;
            self.largest_square = self.largest_square.max(square);
        }
        (residuals, decoded)
    }

    fn count(&mut self, residuals: &Residuals, coding: Coding) {
        let start = coding.class() * CONTEXTS;
        let mut counts = std::mem::take(&mut self.counts);
        self.for_each_in_context(residuals, |context, [x, y, z]| {
            for residual in [x, y, z] {
                counts[start + context][usize::from(Coded::new(residual).symbol)] += 1;
            }
        });
        self.counts = counts;
    }

    fn bytes_of_chunk(&self, frames: &[Residuals], group: u32, tables: &[Table]) -> Vec<u8> {
        let (mut ends, mut streams) = (Vec::new(), Vec::new());
        for (local, residuals) in frames.iter().enumerate() {
            let class = coding(local as u32, frames.len() as u32, group).class();
            let mut encoder = Encoder::default();
            self.for_each_in_context(residuals, |context, vertex| {
                for (lane, residual) in vertex.into_iter().enumerate() {
                    Coded::new(residual).write(&mut encoder, lane, &tables[class * CONTEXTS + context]);
                }
            });
            streams.extend(encoder.finish());
            ends.extend((streams.len() as u32).to_le_bytes());
        }
        ends.extend(streams);
        ends
    }

    /// Calls `act` with each vertex's context and residuals; the decoder finds contexts the same way.
    fn for_each_in_context(&self, residuals: &Residuals, mut act: impl FnMut(usize, [i32; 3])) {
        let most = self.traversal.most_parents;
        let mut magnitudes = vec![0_u8; self.traversal.vertex_of_place.len() + 1];
        let mut all = residuals.iter();
        for place in 0..self.traversal.vertex_of_place.len() {
            let row = &self.traversal.parent_slots[place * most..];
            let sum: usize = [row[0] as usize, row[1] as usize, place].map(|s| usize::from(magnitudes[s])).iter().sum();
            let vertex: [i32; 3] = std::array::from_fn(|_| all.next().unwrap_or(0));
            magnitudes[place + 1] = magnitude(vertex[0], vertex[1], vertex[2]);
            act(usize::from(self.contexts[sum]), vertex);
        }
    }
}
