//! A little capture to try things with.

use actor::capture::{Capture, Poses};
use actor::surface::Surface;
use actor::timeline::{Sequence, Timeline};
use glam::Vec3;
use kernels::topology::{Topology, barycentric_areas};

/// Vertices along a side.
const SIDE: u32 = 8;
/// Frames of each of the two sequences.
const FRAMES: u32 = 40;

/// A cloth of 8 x 8 vertices that waves for two sequences of 40 frames at 25 frames a second: `slow` and `fast`.
///
/// ```
/// let cloth = reprise::example::cloth();
/// assert_eq!(cloth.timeline.frame_count(), 80);
/// assert_eq!(cloth.topology.vertex_count(), 64);
/// ```
#[must_use]
pub fn cloth() -> Capture {
    let mut poses = Poses::new((SIDE * SIDE) as usize);
    for speed in [1.0, 2.0] {
        (0..FRAMES).for_each(|frame| poses.push(&pose(frame as f32 / 25.0 * speed)));
    }
    let square = |column: u32, row: u32| {
        let corner = row * SIDE + column;
        [[corner, corner + SIDE, corner + 1], [corner + 1, corner + SIDE, corner + SIDE + 1]]
    };
    let triangles: Vec<[u32; 3]> =
        (0..SIDE - 1).flat_map(|row| (0..SIDE - 1).flat_map(move |column| square(column, row))).collect();
    let weights = barycentric_areas(&triangles, poses.frame(0));
    let sequence = |name: &str, first_frame| Sequence {
        name: name.into(),
        labels: vec![],
        first_frame,
        frame_count: FRAMES,
        cyclic: false,
    };
    let topology = Topology::new(SIDE * SIDE, triangles, weights);
    let timeline = Timeline::new(25.0, vec![sequence("slow", 0), sequence("fast", FRAMES)]);
    match (topology, timeline) {
        (Ok(topology), Ok(timeline)) => {
            let surface = Surface::plain(&topology);
            let vertex_of_file_vertex = (0..SIDE * SIDE).collect();
            Capture { name: "cloth".into(), topology, surface, timeline, poses, vertex_of_file_vertex }
        }
        // Its parts are written above and fit.
        _ => unreachable!(),
    }
}

/// The cloth at a time, in metres: it hangs from a bar 1.5 m above the ground and waves.
fn pose(time: f32) -> Vec<Vec3> {
    let vertex = |k: u32| {
        let (x, y) = ((k % SIDE) as f32 / (SIDE - 1) as f32, (k / SIDE) as f32 / (SIDE - 1) as f32);
        Vec3::new(x - 0.5, 1.5 - y, 0.25 * y * (6.0 * time - 4.0 * y + x).sin())
    };
    (0..SIDE * SIDE).map(vertex).collect()
}
