//! What variations of a capture's sequences come to, as they are stored and played: each sequence by itself.
//!
//!     cargo run -p reprise-evaluate --example varied -- CAPTURE FPS AMOUNTS [SEQUENCE...]
//!
//! `CAPTURE` is what `pack` takes, or `woman:TIMES`: the built-in performer (seed 1) in memory, each behaviour that many times as long as usual.
//! `AMOUNTS` are separated by commas. What is named `+SEQUENCE` is gone through for ten minutes, too, by four seeds.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that prints, and may panic")]

#[path = "../src/variations/lasting.rs"]
#[allow(dead_code)]
mod lasting;
#[path = "../src/variations/stored.rs"]
#[allow(dead_code)]
mod stored;

use std::sync::Arc;

use actor::alternatives::Alternatives;
use actor::capture::{Capture, Poses};
use actor::surface::Surface;
use actor::timeline::{Sequence, Timeline};

use capture_io::import::{ImportOptions, import};
use evaluate::clay::{self, Camera};
use glam::Vec3;
use image::{RgbaImage, imageops};
use job::Job;
use kernels::random::mix;
use kernels::topology::{Topology, barycentric_areas};
use motion::alternatives::alternatives;
use motion::vary::{VaryOptions, vary};
use performer::Kind;
use performer::figure::Figure;
use performer::motion::BEHAVIOURS;
use performer::perform::{Take, perform};
use synthesis::Varied;

/// Mixtures of each amount.
const MIXED: u64 = 6;
/// Edges that are shorter than this before and after, in metres, are not looked at.
const SHORT: f32 = 0.004;
/// Variations of each sequence.
const COUNT: usize = 8;
/// Seeds by which ten minutes are drawn.
const SEEDS: u64 = 4;

/// The built-in performer, each behaviour `times` as long as usual.
fn woman(fps: f32, times: f32) -> Capture {
    let figure = Figure::of(Kind::Woman, 2500, 128);
    let mut poses = Poses::new(figure.mesh.positions.len());
    let mut sequences = Vec::new();
    for (behaviour, (name, seconds)) in BEHAVIOURS.iter().enumerate() {
        let (first_frame, frames) = (poses.len(), (seconds * times * fps).round() as usize);
        let take = Take { name: (*name).into(), behaviour, first_frame, frames, seed: mix(1, behaviour as u64) };
        perform(&figure, &take, fps).iter().for_each(|frame| poses.push(&frame.positions));
        let (first_frame, frame_count) = (first_frame as u32, frames as u32);
        sequences.push(Sequence { name: take.name, labels: vec![], first_frame, frame_count, cyclic: false });
    }
    let areas = barycentric_areas(&figure.mesh.triangles, poses.frame(0));
    let topology = Topology::new(poses.vertex_count() as u32, figure.mesh.triangles, areas).unwrap();
    let timeline = Timeline::new(fps, sequences).unwrap();
    Capture {
        name: "woman".into(),
        topology,
        surface: Surface::default(),
        timeline,
        poses,
        vertex_of_file_vertex: Vec::new(),
    }
}

/// How often an edge is more than half as long again, or half as short, as recorded, and the frame in which most are; where the variable `SHEETS` names a
/// folder, that frame from four sides, as recorded and below it as it is.
fn torn(capture: &Capture, all: &Arc<Alternatives>, sequence: &Sequence, amount: f64) -> String {
    let triangles = capture.topology.triangles();
    let (mut sum, mut frames, mut worst) = (0, 0, (0, 0, Vec::new()));
    for draw in 0..MIXED {
        let mut varied = Varied::new(Arc::clone(all), draw, 1.0);
        for frame in sequence.first_frame..sequence.end_frame() {
            let was = capture.poses.frame(frame);
            let mut pose = was.to_vec();
            varied.enters(frame);
            varied.add(frame, &mut pose);
            let length = |pose: &[Vec3], [a, b, _]: [u32; 3]| pose[a as usize].distance(pose[b as usize]);
            let is_odd = |&&triangle: &&[u32; 3]| {
                let (now, before) = (length(&pose, triangle), length(was, triangle));
                (now > 1.5 * before || now < 0.5 * before) && f32::max(now, before) > SHORT
            };
            let odd = triangles.iter().filter(is_odd).count();
            (sum, frames) = (sum + odd, frames + 1);
            if odd > worst.0 {
                worst = (odd, frame, pose);
            }
        }
    }
    if let Some(folder) = std::env::var_os("SHEETS").filter(|_| worst.0 > 0) {
        let mut sheet = RgbaImage::new(4 * 400, 2 * 400);
        let clay = vec![Vec3::new(0.62, 0.60, 0.57); worst.2.len()];
        for side in 0..4_u32 {
            let camera = Camera::framing(capture.poses.frame(worst.1), [400, 400], 1.57 * side as f32);
            for (row, pose) in [capture.poses.frame(worst.1), &worst.2].into_iter().enumerate() {
                let drawn = clay::draw(pose, triangles, &clay, &camera);
                imageops::replace(&mut sheet, &drawn, i64::from(400 * side), 400 * row as i64);
            }
        }
        sheet.save(std::path::Path::new(&folder).join(format!("{}-{amount}.png", sequence.name))).unwrap();
    }
    format!(
        ", {:.2} odd edges a frame, {} in frame {}",
        f64::from(sum as u32) / f64::from(frames),
        worst.0,
        worst.1 - sequence.first_frame * u32::from(worst.0 > 0)
    )
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, fps, amounts, names @ ..] = arguments.as_slice() else { panic!("CAPTURE FPS AMOUNTS [SEQUENCE...]") };
    let fps: f32 = fps.parse().unwrap();
    let job = Job::silent();
    let capture = match path.strip_prefix("woman:") {
        Some(times) => woman(fps, times.parse().unwrap()),
        None => {
            let options = ImportOptions { fps: Some(fps), ..Default::default() };
            import(std::slice::from_ref(path), &options, &job).unwrap().capture
        }
    };
    let (topology, timeline, poses) = (&capture.topology, &capture.timeline, &capture.poses);
    let feet = pipeline::feet::feet(topology, timeline, poses);
    let motion = actor::motion::Motion::measure(timeline, topology.weights(), &mut poses.clone()).unwrap();
    let wanted = |name: &str| names.is_empty() || names.iter().any(|own| own.trim_start_matches('+') == name);
    for sequence in timeline.sequences().iter().filter(|sequence| wanted(&sequence.name)) {
        for amount in amounts.split(',').map(|amount| amount.parse::<f64>().unwrap()) {
            let mut options = VaryOptions::default();
            (options.amount, options.count) = (amount, COUNT);
            let frames = sequence.first_frame..sequence.end_frame();
            let varied = vary(poses, topology, (frames.clone(), timeline.fps()), &options, &job).unwrap();
            let (rejected, stretches) = (varied.rejected, varied.stretches);
            let (all, _) = alternatives(&capture, &feet, &motion.facings, &[varied], COUNT, &job).unwrap();
            let all = Arc::new(all);
            let found = stored::played(&capture, &feet, &all, frames);
            let mut line = format!(
                "{} {amount}: apart {:.1} mm, off {:.1} mm, acceleration {:.2}, edges {:.2} %, ends {:.3} mm, {rejected} of {stretches} rejected",
                sequence.name,
                1e3 * found.apart,
                1e3 * found.off,
                found.acceleration,
                1e2 * found.edges,
                1e3 * found.ends
            );
            if names.contains(&format!("+{}", sequence.name)) {
                for seed in 1..=SEEDS {
                    let shown = (sequence, topology.vertex_count());
                    let own = lasting::lasting(&all, shown, timeline.fps(), 600.0, seed);
                    line += &format!(
                        "; nearest {:.2} mm, longest {:.1} s of {} passes",
                        1e3 * own.nearest,
                        own.longest,
                        own.passes
                    );
                }
            }
            println!("{line}{}", torn(&capture, &all, sequence, amount));
        }
    }
}
