//! How an actor goes into clips of motion capture and back, with the clips' ends edited towards the recording (Tejera, Casas and Hilton
//! 2013, V-C) and as they were driven: what the page does, measured.
//!
//! ```text
//! joins ACTOR.reprise CLIP.bvh SKELETON.asf+CLIP.amc ...
//! ```
//!
//! Each clip is performed from some frames of the recording, and the two joins of each performance are measured. Every other start is
//! one of those that constants were chosen by. How far apart: the poses that are blended in the middle, mean distance of vertices once
//! laid on one another over the ground. Speed and acceleration: means over the vertices, the largest of any frame of the blend and of the
//! 1.2 s beside it, within which the longest edit fades; feet below the floor and soles that slide are measured over the same frames.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a tool for measuring: it prints, and may stop at what is amiss"
)]

use std::fs;

use bundle::BundleReader;
use driver::session::Session;
use editor::scene::{Known, words};
use glam::{Vec3, Vec3Swizzles};
use kernels::align::{Placement, align_heading, centre_of_mass, rotate};

use actor::capture::Poses;
use actor::pose_source::PoseSource;

/// Frames of the recording that each clip is performed from.
const STARTS: u32 = 12;
/// What belongs to a join beside its blend, in seconds.
const BESIDE: f32 = 1.2;

/// What is measured of a join.
#[derive(Clone, Copy, Default)]
struct Measured {
    apart: f32,
    speed: f32,
    acceleration: f32,
    below: f32,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let bytes = fs::read(&arguments[0]).unwrap();
    let mut reader = BundleReader::from_bytes(&bytes).unwrap();
    let (timeline, topology) = (reader.timeline().unwrap().clone(), reader.topology().unwrap().clone());
    let mut poses = Poses::new(topology.vertex_count());
    let mut pose = vec![Vec3::ZERO; topology.vertex_count()];
    for frame in 0..timeline.frame_count() {
        reader.read(frame, &mut pose).unwrap();
        poses.push(&pose);
    }
    let rig = reader.rig_bytes().unwrap().to_vec();
    let feet = reader.graph().unwrap().feet().clone();
    let known = Known::from_words(&words(&timeline, &topology, &feet, reader.order())).unwrap();
    let mut session = Session::new(known, &rig).unwrap();
    while let Some(&frame) = session.needs().first() {
        session.give(poses.frame(frame).to_vec()).unwrap();
    }
    let fps = timeline.fps();
    println!("| clip | join | starts | apart, mm | speed, m/s | acceleration, m/s^2 | lowest, mm |");
    println!("|---|---|---|---|---|---|---|");
    for clip in &arguments[1..] {
        let files: Vec<(String, Vec<u8>)> = clip
            .split('+')
            .map(|path| (path.rsplit('/').next().unwrap().to_owned(), fs::read(path).unwrap()))
            .collect();
        let files: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (&**name, &**bytes)).collect();
        session.begin(&files).unwrap();
        // By half of the starts, by join, as driven and edited.
        let mut all: [[[Vec<Measured>; 2]; 2]; 2] = Default::default();
        for start in 0..STARTS {
            let from =
                (u64::from(timeline.frame_count() - 1) * u64::from(2 * start + 1) / u64::from(2 * STARTS)) as u32;
            for edited in [false, true] {
                session.as_driven = !edited;
                let joins = performed(&mut session, &poses, &timeline, topology.weights(), from, fps);
                for (join, measured) in joins.into_iter().enumerate() {
                    all[(start % 2) as usize][join][usize::from(edited)].push(measured);
                }
            }
        }
        for (half, joins) in ["chosen by", "held out"].iter().zip(&all) {
            for (name, [before, after]) in ["in", "back"].iter().zip(joins) {
                // Where the clip ends is the same from everywhere.
                let mean = |of: &dyn Fn(&Measured) -> f32, list: &[Measured]| {
                    list.iter().map(of).sum::<f32>() / list.len() as f32
                };
                let both = |of: &dyn Fn(&Measured) -> f32, digits: usize| {
                    let better = before.iter().zip(after).filter(|(b, a)| of(a) < of(b)).count();
                    format!("{:.digits$} -> {:.digits$} ({better} better)", mean(of, before), mean(of, after))
                };
                println!(
                    "| {} | {name} | {} {half} | {} | {} | {} | {} |",
                    clip.rsplit('/').next().unwrap(),
                    before.len(),
                    both(&|m| 1000.0 * m.apart, 0),
                    both(&|m| m.speed, 2),
                    both(&|m| m.acceleration, 1),
                    both(&|m| 1000.0 * m.below, 0),
                );
            }
        }
    }
}

/// Performs the clip from `from`; the way in, and the way back.
fn performed(
    session: &mut Session,
    poses: &Poses,
    timeline: &actor::timeline::Timeline,
    weights: &[f32],
    from: u32,
    fps: f32,
) -> [Measured; 2] {
    let windows = session.prepare(from, poses.frame(from)).unwrap();
    let recorded = windows.map(|window| {
        let frames = (0..window.count).map(|step| timeline.offset(window.first, step.into()).unwrap());
        frames.flat_map(|frame| poses.frame(frame).to_vec()).collect::<Vec<Vec3>>()
    });
    let keys = session.keys().unwrap();
    session.perform(recorded, Placement::IDENTITY).unwrap();
    let apart = keys.map(|[of_recorded, of_clip]| {
        apart(poses.frame(of_recorded), &session.make(of_clip as usize).unwrap(), weights)
    });
    let nodes = [windows[0].count, windows[1].count];
    let mut shown: Vec<Vec<Vec3>> = vec![poses.frame(from).to_vec()];
    while let Some(frame) = session.next_frame().unwrap() {
        shown.push(frame.pose);
    }
    let beside = (BESIDE * fps) as usize;
    let long = [nodes[0] as usize + beside, nodes[1] as usize + beside].map(|frames| frames.min(shown.len()));
    let parts = [&shown[..long[0]], &shown[shown.len() - long[1]..]];
    [0, 1].map(|join| measured(parts[join], apart[join], fps))
}

fn measured(shown: &[Vec<Vec3>], apart: f32, fps: f32) -> Measured {
    let mean = |of: &dyn Fn(usize) -> f32| (0..shown[0].len()).map(of).sum::<f32>() / shown[0].len() as f32;
    let speed = shown.windows(2).map(|two| mean(&|v| two[0][v].distance(two[1][v])) * fps).fold(0.0, f32::max);
    let bend = |three: &[Vec<Vec3>]| mean(&|v| (three[0][v] + three[2][v] - 2.0 * three[1][v]).length());
    let acceleration = shown.windows(3).map(|three| bend(three) * fps * fps).fold(0.0, f32::max);
    let below = -shown.iter().flatten().map(|point| point.y).fold(f32::INFINITY, f32::min);
    Measured { apart, speed, acceleration, below }
}

/// Mean distance of vertices, the one pose turned and moved over the ground onto the other.
fn apart(onto: &[Vec3], pose: &[Vec3], weights: &[f32]) -> f32 {
    let turn = align_heading(onto, pose, weights);
    let to = centre_of_mass(onto, weights).xz() - rotate(turn, centre_of_mass(pose, weights).xz());
    let laid = pose.iter().map(|point| {
        let ground = rotate(turn, point.xz()) + to;
        Vec3::new(ground.x, point.y, ground.y)
    });
    laid.zip(onto).map(|(a, b)| a.distance(*b)).sum::<f32>() / onto.len() as f32
}
