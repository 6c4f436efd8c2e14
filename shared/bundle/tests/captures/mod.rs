//! Captures that the bundle's tests and its benchmark share: made in code, and the real one.
#![allow(dead_code, reason = "each test uses some of them")]

use actor::capture::{Capture, Poses};
use actor::contacts::{Contact, Contacts};
use actor::feet::{Feet, FootVertex};
use actor::graph::{EssentialGraph, Transition};
use actor::surface::{Corner, Image, ImageFormat, Material, Part, Surface};
use actor::temporal_warp::{Move, TemporalWarp};
use actor::ties::{Tie, Ties};
use actor::timeline::{Sequence, Timeline};
use editing::rig::NO_BONE;
use editing::{Bone, StoredRig};
use glam::{Mat3, Quat, Vec2, Vec3};
use kernels::align::Placement;
use kernels::topology::{Topology, barycentric_areas};

/// A cloth of `width` x `height` vertices that waves, walks and turns, with a second, free-floating piece beside it.
pub fn cloth(width: u32, height: u32, frames_of_sequence: &[u32]) -> Capture {
    let mut triangles = Vec::new();
    for (columns, first) in [(width, 0), (3, width * height)] {
        let rows = if first == 0 { height } else { 3 };
        for y in 0..rows - 1 {
            for x in 0..columns - 1 {
                let a = first + y * columns + x;
                triangles.extend([[a, a + columns, a + 1], [a + 1, a + columns, a + columns + 1]]);
            }
        }
    }
    let vertex_count = width * height + 9;
    let frame_count: u32 = frames_of_sequence.iter().sum();
    let mut poses = Poses::new(vertex_count as usize);
    for frame in 0..frame_count {
        poses.push(&cloth_pose(width, height, frame as f32));
    }
    let weights = barycentric_areas(&triangles, poses.frame(0));
    let topology = Topology::new(vertex_count, triangles.clone(), weights).unwrap();
    let surface = cloth_surface(&triangles, poses.frame(0));
    let vertex_of_file_vertex = (0..vertex_count).rev().collect();
    let timeline = timeline(frames_of_sequence);
    Capture { name: "cloth".into(), topology, surface, timeline, poses, vertex_of_file_vertex }
}

fn cloth_pose(width: u32, height: u32, time: f32) -> Vec<Vec3> {
    let turn = Quat::from_rotation_y(0.05 * time);
    let walk = Vec3::new(0.03 * time, 0.0, 0.1 * (0.2 * time).sin());
    let mut pose = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
            let wave = 0.1 * v * (6.0 * u + 0.3 * time).sin();
            pose.push(turn * Vec3::new(u - 0.5, 1.8 * (1.0 - v), wave) + walk);
        }
    }
    let hop = Vec3::new(0.8, 0.5 + 0.3 * (0.4 * time).sin().abs(), 0.2);
    pose.extend((0..9).map(|i| turn * (hop + 0.05 * Vec3::new((i % 3) as f32, (i / 3) as f32, 0.0)) + walk));
    pose
}

/// Two parts with two materials, one image, colours, and a seam: the first vertex has two corners.
fn cloth_surface(triangles: &[[u32; 3]], pose: &[Vec3]) -> Surface {
    let corner = |vertex: usize| Corner {
        vertex: vertex as u32,
        uv: [pose[vertex].x + 0.5, 1.0 - pose[vertex].y / 1.8],
        colour: [255, (vertex * 7 % 256) as u8, 128, 255],
    };
    let mut corners: Vec<Corner> = (0..pose.len()).map(corner).collect();
    let mut drawn = triangles.to_vec();
    let seam = Corner { uv: [0.25, 0.75], ..corners[drawn[1][0] as usize] };
    drawn[1][0] = corners.len() as u32;
    corners.push(seam);
    let half = drawn.len() as u32 / 2;
    let rest = drawn.len() as u32 - half;
    let material = |name: &str, image| Material {
        name: name.into(),
        base_colour: [1.0, 0.5, 0.25, 1.0],
        image,
        double_sided: true,
    };
    Surface {
        corners,
        triangles: drawn,
        parts: vec![
            Part { material: 0, first_triangle: 0, triangle_count: half },
            Part { material: 1, first_triangle: half, triangle_count: rest },
        ],
        materials: vec![material("cloth", Some(0)), material("patch", None)],
        images: vec![Image { format: ImageFormat::Png, width: 2, height: 2, bytes: b"not really a picture".to_vec() }],
    }
}

pub fn timeline(frames_of_sequence: &[u32]) -> Timeline {
    let mut first_frame = 0;
    let sequences = frames_of_sequence.iter().enumerate().map(|(index, &frame_count)| {
        let sequence = Sequence {
            name: format!("sequence {index}"),
            labels: vec!["walk".into(); index % 2],
            first_frame,
            frame_count,
            cyclic: index % 3 == 2,
        };
        first_frame += frame_count;
        sequence
    });
    Timeline::new(25.0, sequences.collect()).unwrap()
}

/// Some transitions between any frames that have room for them.
pub fn graph(timeline: &Timeline) -> EssentialGraph {
    let n = timeline.frame_count();
    let mut transitions = Vec::new();
    for from in 0..n {
        for to in (0..n).filter(|to| (from * 7 + to * 3) % 5 == 0) {
            let moves = [Move::Both, Move::Source, Move::Both, Move::Destination, Move::Both];
            let length = ((from + to) % 6) as usize;
            let transition = Transition {
                from,
                to,
                deformation: 0.1 + (from as f32 * 0.37).sin().abs() + to as f32 * 0.01,
                warp: TemporalWarp::new(moves[..length].to_vec()),
                placement: Placement {
                    heading: (from as f32 * 0.3 - to as f32 * 0.2).sin(),
                    translation: Vec2::new(from as f32 * 0.03, -(to as f32) * 0.01),
                },
                turn: 0.0,
            };
            let (li, lj) = transition.warp.lengths();
            let room = timeline.offset(from, li as i64 - 1).is_some() && timeline.offset(to, 1 - lj as i64).is_some();
            if room {
                transitions.push(transition);
            }
        }
    }
    EssentialGraph::new(0.01, transitions, timeline).unwrap().with_contacts(contacts(timeline))
}

/// Two parts that stand now and then and move on while they do not.
pub fn contacts(timeline: &Timeline) -> Contacts {
    let contact = |index: u32| {
        let (frame, part) = ((index / 2) as f32, (index % 2) as f32);
        Contact::rounded(Vec2::new(part - frame / 8.0, frame / 64.0), ((index % 5) as f32 - 1.0) / 3.0)
    };
    Contacts::new(2, (0..2 * timeline.frame_count()).map(contact).collect(), timeline).unwrap()
}

/// The real capture of MIT (Vlasic et al. 2008): crane and jumping, 325 frames of 10,002 vertices.
pub fn crane_and_jumping() -> Capture {
    let fixtures::Captured { topology, poses, timeline } = fixtures::crane_and_jumping(1);
    let surface = Surface::plain(&topology);
    Capture::new("crane and jumping", topology, surface, timeline, poses).unwrap()
}

/// The last component follows the first one, where there are two.
pub fn ties(topology: &Topology) -> Ties {
    let ends = |component: u32| {
        let of = (0_u32..).zip(topology.component_of_vertex()).filter(move |(_, of)| **of == component);
        of.map(|(vertex, _)| vertex).step_by(3).take(20).collect()
    };
    let last = topology.component_count() as u32 - 1;
    let ties = (last > 0).then(|| Tie { contact: ends(last), patch: ends(0) });
    Ties::new(ties.into_iter().collect(), topology).unwrap()
}

/// Two feet over some of a mesh's vertices that stand now and then.
pub fn feet(vertex_count: usize, timeline: &Timeline) -> Feet {
    let foot = |foot: u32| {
        let vertices = (foot..vertex_count as u32).step_by(2 + foot as usize);
        vertices.map(|vertex| FootVertex {
            vertex,
            leg: 1 + (vertex * 37 % 255) as u8,
            sole: (vertex * 91 % 256) as u8,
        })
    };
    let mut feet: Vec<Vec<FootVertex>> = (0..2).map(|index| foot(index).collect()).collect();
    feet.iter_mut().for_each(|foot| foot[0].sole = 255);
    let stands = (0..2 * timeline.frame_count()).map(|index| index % 7 < 4).collect();
    Feet::new(feet, stands, vertex_count, timeline).unwrap()
}

/// Three bones over a mesh of `vertex_count` vertices, by whole numbers over powers of two.
pub fn rig(vertex_count: usize, rest_frame: u32) -> StoredRig {
    let bone = |name: &str, parent: usize, y: f32| Bone {
        name: name.into(),
        parent,
        joint: Vec3::new(0.25, y, -0.5),
        limb: u32::from(y > 0.75),
        range: [Vec3::splat(-y), Vec3::new(0.5, y, 1.0)],
        spread: Mat3::from_cols(Vec3::X * 0.25, Vec3::new(0.0, 0.125, 0.0625), Vec3::new(0.0, 0.0625, 0.5)),
        gap: 0.015625 * y,
    };
    let influences = (0..vertex_count).map(|vertex| match vertex % 4 {
        0 => vec![((vertex % 3) as u8, 255)],
        1 => vec![(1, 200), (2, 55)],
        2 => vec![(2, 128), (0, 127)],
        _ => vec![(0, 100), (1, 100), (2, 55)],
    });
    let core = (0..vertex_count).map(|vertex| if vertex % 5 == 4 { NO_BONE } else { (vertex % 3) as u8 });
    let bones = vec![bone("root", 0, 0.5), bone("left", 0, 1.0), bone("hand", 1, 1.5)];
    StoredRig { rest_frame, bones, influences: influences.collect(), core: core.collect() }
}
