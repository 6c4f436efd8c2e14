//! Finds what stands on the ground: [`Contacts`] of a capture.
//!
//! A vertex that comes to rest near the ground again and again belongs to a sole or a palm; connected ones are one part.
//! Nothing is known about feet: a capture whose actor never stands has no parts, and its transitions are the papers'.

use actor::capture::Poses;
use actor::contacts::{Contact, Contacts, Facings, MOST_PARTS};
use actor::timeline::{Sequence, Timeline};
use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::align::align_heading;
use kernels::topology::Topology;
use rayon::prelude::*;

/// What is this close to the ground may touch it, relative to the body's height: 2 cm of 1.8 m.
const NEAR: f32 = 0.011;
/// A sequence whose ground is less than this away from the common one has its own, in body heights: 11 cm of 1.8 m.
const FLOATS: f32 = 0.06;
/// Grounds that differ by less than this are one, in body heights: 3.6 cm of 1.8 m.
const UNEVEN: f32 = 0.02;
/// What is further above it than this does not stand at all.
const FAR: f32 = 2.5 * NEAR;
/// What moves slower than this is at rest, in body heights per second: 0.15 m/s of 1.8 m.
const RESTS: f32 = 0.085;
/// What moves faster than this does not stand at all.
const MOVES: f32 = 4.0 * RESTS;
/// A vertex belongs to a part where it is at rest near the ground in this share of the frames, and in as many at least.
const SHARE: f32 = 0.01;
const FEWEST_FRAMES: u32 = 4;
/// Smaller parts are no feet.
const FEWEST_VERTICES: usize = 3;

/// Parts of the surface that stand on the ground, and where the ground is.
pub(crate) struct Standing {
    pub floor: Floor,
    /// Vertices of each part, those that rest most first.
    pub parts: Vec<Vec<u32>>,
}

impl Standing {
    pub fn of(topology: &Topology, timeline: &Timeline, poses: &Poses) -> Self {
        let floor = Floor::of(timeline, poses);
        let parts = parts(topology, &rests(timeline, poses, &floor), timeline.frame_count());
        Self { floor, parts }
    }
}

/// Height of the ground in metres that each sequence is taken to stand on; `None` where all stand on nearly one.
#[must_use]
pub fn uneven_floor(timeline: &Timeline, poses: &Poses) -> Option<Vec<f32>> {
    let floor = Floor::of(timeline, poses);
    let [low, high] = [f32::min, f32::max].map(|of| floor.heights.iter().copied().reduce(of).unwrap_or(0.0));
    (high - low > UNEVEN * floor.body).then_some(floor.heights)
}

/// Height of the ground in metres that each sequence is taken to stand on.
#[must_use]
pub fn floors(timeline: &Timeline, poses: &Poses) -> Vec<f32> {
    Floor::of(timeline, poses).heights
}

/// The contacts of all frames, and which way each part points in them.
#[must_use]
pub fn contacts(topology: &Topology, timeline: &Timeline, poses: &Poses) -> (Contacts, Facings) {
    let Standing { floor, parts } = Standing::of(topology, timeline, poses);
    let tracks: Vec<Vec<Contact>> = parts.iter().map(|part| track(poses, timeline, part, &floor)).collect();
    let frames = 0..timeline.frame_count() as usize;
    let contacts = frames.flat_map(|frame| tracks.iter().map(move |track| track[frame])).collect();
    let contacts = Contacts::new(parts.len(), contacts, timeline).unwrap_or_default();
    let facings: Vec<Vec<f32>> = parts.iter().zip(&tracks).map(|(part, track)| facings(poses, part, track)).collect();
    let facings = (0..poses.len()).flat_map(|frame| facings.iter().map(move |facings| facings[frame])).collect();
    let facings = Facings::new(parts.len(), facings);
    (contacts, facings)
}

/// How a part is turned about +Y in every frame, from the first one of those in which it stands firmest.
fn facings(poses: &Poses, part: &[u32], track: &[Contact]) -> Vec<f32> {
    let firmest = |best: usize, frame: usize| if track[frame].weight > track[best].weight { frame } else { best };
    let reference = (0..track.len()).fold(0, firmest) as u32;
    let of = |frame: u32| part.iter().map(|&vertex| poses.frame(frame)[vertex as usize]).collect::<Vec<Vec3>>();
    let (reference, weights) = (of(reference), vec![1.0 / part.len() as f32; part.len()]);
    (0..poses.len() as u32).map(|frame| align_heading(&of(frame), &reference, &weights)).collect()
}

/// The ground, and what near and slow mean for this body.
pub(crate) struct Floor {
    /// Height of the ground in metres, for each sequence.
    heights: Vec<f32>,
    /// Height of the body in metres.
    pub body: f32,
    /// Frames per second.
    fps: f32,
}

impl Floor {
    /// The ground is where the lowest vertices are in most frames of a sequence, if that is near where they are in most
    /// frames of all: captures float or sink by centimetres, but a sequence in the air has no ground of its own.
    fn of(timeline: &Timeline, poses: &Poses) -> Self {
        let heights =
            |pose: &[Vec3]| pose.iter().fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
        let lowest: Vec<f32> = poses.iter().map(|pose| heights(pose).0).collect();
        let (low, high) = heights(poses.iter().next().unwrap_or_default());
        let (common, body) = (quarter(&lowest), (high - low).max(0.0));
        let floor = |sequence: &Sequence| {
            let own = quarter(&lowest[sequence.first_frame as usize..sequence.end_frame() as usize]);
            if (own - common).abs() < FLOATS * body { own } else { common }
        };
        Self { heights: timeline.sequences().iter().map(floor).collect(), body, fps: timeline.fps() }
    }

    /// Between two frames in a row of a sequence.
    pub fn rests(&self, sequence: usize, before: Vec3, after: Vec3) -> bool {
        let near = |point: Vec3| point.y - self.heights[sequence] < NEAR * self.body;
        near(before) && near(after) && before.xz().distance(after.xz()) * self.fps < RESTS * self.body
    }

    /// How firmly a part stands at a height in metres and a speed in metres per second.
    fn weight(&self, sequence: usize, height: f32, speed: f32) -> f32 {
        fall((height - self.heights[sequence]) / self.body, NEAR, FAR) * fall(speed / self.body, RESTS, MOVES)
    }
}

/// A value that a quarter of `values` do not exceed.
fn quarter(values: &[f32]) -> f32 {
    let mut values = values.to_vec();
    values.sort_unstable_by(f32::total_cmp);
    values.get(values.len() / 4).copied().unwrap_or(0.0)
}

/// 1 up to `from`, 0 from `to` on, smooth between.
pub(crate) fn fall(value: f32, from: f32, to: f32) -> f32 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    1.0 - t * t * (3.0 - 2.0 * t)
}

/// Vertices of each part, those that rest most first.
fn parts(topology: &Topology, rests: &[u32], frame_count: u32) -> Vec<Vec<u32>> {
    let enough = ((SHARE * frame_count as f32) as u32).max(FEWEST_FRAMES);
    let mut parent: Vec<u32> = (0..rests.len() as u32).collect();
    for &[a, b, c] in topology.triangles() {
        for (one, other) in [(a, b), (b, c), (c, a)] {
            if rests[one as usize] >= enough && rests[other as usize] >= enough {
                let (one, other) = (root(&mut parent, one), root(&mut parent, other));
                parent[one.max(other) as usize] = one.min(other);
            }
        }
    }
    let mut members = vec![Vec::new(); rests.len()];
    for vertex in (0..rests.len() as u32).filter(|&vertex| rests[vertex as usize] >= enough) {
        members[root(&mut parent, vertex) as usize].push(vertex);
    }
    members.retain(|part| part.len() >= FEWEST_VERTICES);
    let sum = |part: &[u32]| part.iter().map(|&vertex| u64::from(rests[vertex as usize])).sum::<u64>();
    members.sort_by_key(|part| std::cmp::Reverse(sum(part)));
    members.truncate(MOST_PARTS);
    members
}

/// For each vertex the steps from frame to frame in which it is at rest near the ground.
fn rests(timeline: &Timeline, poses: &Poses, floor: &Floor) -> Vec<u32> {
    let sequences = timeline.sequences();
    let steps = (0..).zip(sequences).flat_map(|(index, sequence)| {
        (sequence.first_frame..sequence.end_frame().saturating_sub(1)).map(move |frame| (index, frame))
    });
    let count = |mut counts: Vec<u32>, (sequence, frame): (usize, u32)| {
        let (before, after) = (poses.frame(frame), poses.frame(frame + 1));
        for ((count, &before), &after) in counts.iter_mut().zip(before).zip(after) {
            *count += u32::from(floor.rests(sequence, before, after));
        }
        counts
    };
    let none = || vec![0_u32; poses.vertex_count()];
    let add = |mut a: Vec<u32>, b: Vec<u32>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        a
    };
    steps.collect::<Vec<_>>().into_par_iter().fold(none, count).reduce(none, add)
}

pub(crate) fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        parent[vertex as usize] = parent[parent[vertex as usize] as usize];
        vertex = parent[vertex as usize];
    }
    vertex
}

/// Where a part is in every frame and how firmly it stands.
fn track(poses: &Poses, timeline: &Timeline, part: &[u32], floor: &Floor) -> Vec<Contact> {
    let centre = |frame: u32| {
        let pose = poses.frame(frame);
        part.iter().map(|&vertex| pose[vertex as usize]).sum::<Vec3>() / part.len() as f32
    };
    let centres: Vec<Vec3> = (0..timeline.frame_count()).map(centre).collect();
    let mut track = Vec::with_capacity(centres.len());
    for (index, sequence) in timeline.sequences().iter().enumerate() {
        let centres = &centres[sequence.first_frame as usize..sequence.end_frame() as usize];
        let last = centres.len() - 1;
        let weights: Vec<f32> = (0..=last)
            .map(|frame| {
                let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
                let way: Vec2 = centres[after].xz() - centres[before].xz();
                floor.weight(index, centres[frame].y, way.length() * floor.fps / (after - before).max(1) as f32)
            })
            .collect();
        for frame in 0..=last {
            // A foot gains and loses its hold over some frames, even where the measurement trembles.
            let beside = weights[frame.saturating_sub(1)] + weights[(frame + 1).min(last)];
            track.push(Contact::rounded(centres[frame].xz(), (2.0 * weights[frame] + beside) / 4.0));
        }
    }
    track
}
