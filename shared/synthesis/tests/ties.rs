//! Components that are tied stay where they are on each other; those that are not go their own way.
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

use actor::graph::{EssentialGraph, Transition};
use actor::pose_source::{PoseError, PoseSource};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::ties::{Tie, Ties};
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, Walk};
use glam::{Quat, Vec2, Vec3};
use kernels::align::Placement;
use kernels::topology::Topology;
use synthesis::Synthesiser;

/// A large and a small octahedron: the small one sits on a corner of the large one, which tumbles.
struct Tumbling(Vec<Vec<Vec3>>);

impl PoseSource for Tumbling {
    fn read(&mut self, frame: u32, pose: &mut [Vec3]) -> Result<(), PoseError> {
        pose.copy_from_slice(self.0.get(frame as usize).ok_or(PoseError::OutOfRange(frame))?);
        Ok(())
    }
}

const CORNERS: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

fn triangles() -> Vec<[u32; 3]> {
    let faces = [[2, 4, 0], [2, 0, 5], [2, 5, 1], [2, 1, 4], [3, 0, 4], [3, 5, 0], [3, 1, 5], [3, 4, 1]];
    [0, 6].iter().flat_map(|first| faces.iter().map(move |face| face.map(|corner: u32| corner + first))).collect()
}

fn tumbling(frames: usize) -> Tumbling {
    let pose = |frame: usize| {
        let turn = Quat::from_rotation_z(1.6 * frame as f32 / frames as f32);
        let small = Vec3::new(0.0, 1.1, 0.0);
        let all = CORNERS.iter().copied().chain(CORNERS.iter().map(move |corner| small + 0.1 * *corner));
        all.map(|point| turn * point + Vec3::Y).collect()
    };
    Tumbling((0..frames).map(pose).collect())
}

/// The largest distance between the top of the large one and the middle of the small one, in blends from begin to end.
fn most_apart(ties: Ties) -> f32 {
    let frames = 40;
    let sequence = Sequence { name: "t".into(), labels: vec![], first_frame: 0, frame_count: frames, cyclic: false };
    let timeline = Timeline::new(25.0, vec![sequence]).unwrap();
    let topology = Topology::new(12, triangles(), vec![1.0; 12]).unwrap();
    let warp = TemporalWarp::new(vec![Move::Both; 9]);
    let placement = Placement { heading: 0.0, translation: Vec2::ZERO };
    let transition = Transition { from: 2, to: 39, deformation: 1.0, warp, placement, turn: 0.0 };
    let graph = EssentialGraph::new(0.01, vec![transition], &timeline).unwrap().with_ties(ties);
    let mut synthesiser = Synthesiser::new(&topology, None).unwrap();
    let walk = Walk { legs: vec![Leg::Synthetic(0)], ..Walk::default() };
    synthesiser.begin_walk(&graph, &timeline, (2, Placement::IDENTITY), &walk).unwrap();
    let (mut source, mut pose, mut most) = (tumbling(frames as usize), vec![Vec3::ZERO; 12], 0.0_f32);
    while synthesiser.next_frame(&graph, &timeline, &mut source, &mut pose).unwrap().is_some() {
        let small = pose[6..].iter().sum::<Vec3>() / 6.0;
        most = most.max((pose[2].distance(small) - 0.1).abs());
    }
    most
}

#[test]
fn what_is_tied_stays() {
    let topology = Topology::new(12, triangles(), vec![1.0; 12]).unwrap();
    let tie = Tie { contact: (6..12).collect(), patch: vec![0, 1, 2, 4, 5] };
    let tied = most_apart(Ties::new(vec![tie], &topology).unwrap());
    let free = most_apart(Ties::default());
    assert!(tied < 0.01 && free > 0.05, "{tied} against {free}");
}
