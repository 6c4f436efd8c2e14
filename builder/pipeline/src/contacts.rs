//! Finds what stands on the ground: [`Contacts`] of a capture.
//!
//! A vertex that comes to rest near the ground again and again belongs to a sole or a palm; connected ones are one part.
//! Nothing is known about feet: a capture whose actor never stands has no parts, and its transitions are the papers'.

use actor::capture::Poses;
use actor::contacts::{Contact, Contacts, MOST_PARTS};
use actor::timeline::Timeline;
use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::topology::Topology;
use rayon::prelude::*;

/// What is this close to the ground may touch it, relative to the body's height: 2 cm of 1.8 m.
const NEAR: f32 = 0.011;
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

/// The contacts of all frames.
#[must_use]
pub fn contacts(topology: &Topology, timeline: &Timeline, poses: &Poses) -> Contacts {
    let floor = Floor::of(timeline, poses);
    let parts = parts(topology, &rests(timeline, poses, &floor), timeline.frame_count());
    let tracks: Vec<Vec<Contact>> = parts.iter().map(|part| track(poses, timeline, part, &floor)).collect();
    let frames = 0..timeline.frame_count() as usize;
    let contacts = frames.flat_map(|frame| tracks.iter().map(move |track| track[frame])).collect();
    Contacts::new(parts.len(), contacts, timeline).unwrap_or_default()
}

/// The ground, and what near and slow mean for this body.
struct Floor {
    /// Height of the ground in metres.
    height: f32,
    /// Height of the body in metres.
    body: f32,
    /// Frames per second.
    fps: f32,
}

impl Floor {
    /// The ground is where a capture's lowest vertices are in most frames.
    fn of(timeline: &Timeline, poses: &Poses) -> Self {
        let heights =
            |pose: &[Vec3]| pose.iter().fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
        let mut lowest: Vec<f32> = poses.iter().map(|pose| heights(pose).0).collect();
        lowest.sort_unstable_by(f32::total_cmp);
        let (low, high) = heights(poses.iter().next().unwrap_or_default());
        let height = lowest.get(lowest.len() / 4).copied().unwrap_or(0.0);
        Self { height, body: (high - low).max(0.0), fps: timeline.fps() }
    }

    /// Between two frames in a row.
    fn rests(&self, before: Vec3, after: Vec3) -> bool {
        let near = |point: Vec3| point.y - self.height < NEAR * self.body;
        near(before) && near(after) && before.xz().distance(after.xz()) * self.fps < RESTS * self.body
    }

    /// How firmly a part stands at a height in metres and a speed in metres per second.
    fn weight(&self, height: f32, speed: f32) -> f32 {
        fall((height - self.height) / self.body, NEAR, FAR) * fall(speed / self.body, RESTS, MOVES)
    }
}

/// 1 up to `from`, 0 from `to` on, smooth between.
fn fall(value: f32, from: f32, to: f32) -> f32 {
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
    let steps = sequences.iter().flat_map(|sequence| sequence.first_frame..sequence.end_frame().saturating_sub(1));
    let count = |mut counts: Vec<u32>, frame: u32| {
        let (before, after) = (poses.frame(frame), poses.frame(frame + 1));
        for ((count, &before), &after) in counts.iter_mut().zip(before).zip(after) {
            *count += u32::from(floor.rests(before, after));
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

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
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
    for sequence in timeline.sequences() {
        let centres = &centres[sequence.first_frame as usize..sequence.end_frame() as usize];
        let last = centres.len() - 1;
        let weights: Vec<f32> = (0..=last)
            .map(|frame| {
                let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
                let way: Vec2 = centres[after].xz() - centres[before].xz();
                floor.weight(centres[frame].y, way.length() * floor.fps / (after - before).max(1) as f32)
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
