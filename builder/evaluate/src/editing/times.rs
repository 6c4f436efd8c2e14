//! Times of edits of one frame beside the paper's (Table I): grabbing, dragging, coming to rest, and spreading over the frames around.

use std::time::Instant;

use actor::capture::Capture;
use actor::pose_source::PoseSource;
use editing::soles::sole;
use editing::{EditDocument, EditedPoses, Editor, Grip, Method, Rig, Scope};
use glam::Vec3;
use job::Job;
use rig::{SpaceOptions, learn_space};
use serde_json::json;

use super::propagated::hand;
use super::shape::tall;
use crate::EvaluateError;
use crate::document::{Cell, Table};

/// The paper's meshes: vertices, constraints and seconds of the edits in its Table I, the least and the most.
const PAPER: [(&str, u64, [u32; 2], [f64; 2]); 4] = [
    ("paper: cones, Fig. 12(b)", 2886, [236, 268], [0.631, 0.644]),
    ("paper: dancer, Fig. 14", 5580, [704, 1585], [0.880, 1.446]),
    ("paper: skirt, Fig. 15(a)", 2854, [550, 722], [0.396, 0.829]),
    ("paper: horse, Fig. 16", 8431, [6753, 6753], [1.601, 1.601]),
];
/// Edits that are timed, and the moves of each drag.
const EDITS: u32 = 6;
const MOVES: u32 = 20;
/// How far a hand is raised, as a share of the body's height, and seconds to both sides that the edit reaches.
const RAISED: f32 = 0.25;
const WINDOW: f32 = 0.25;

/// Milliseconds of one edit.
#[derive(Default)]
struct Times {
    constraints: Vec<f64>,
    grab: Vec<f64>,
    moves: Vec<f64>,
    rest: Vec<f64>,
    whole: Vec<f64>,
    spread: Vec<f64>,
}

/// Makes the table.
pub fn times(capture: &Capture, rig: &Rig, job: &Job) -> Result<Table, EvaluateError> {
    let columns = [
        "edits of",
        "vertices",
        "constraints",
        "grab ms",
        "move ms",
        "slowest move ms",
        "rest ms",
        "whole edit ms",
        "a frame around ms",
    ];
    let caption = format!(
        "Table I: times of single-frame edits, one processor; ours are medians (whole edit: least to most) of {EDITS} edits, a hand raised by {RAISED} of the body's \
         height in {MOVES} moves, standing soles held. Whole edit: grab, and come to rest at the end of the move; a frame around: \
         non-linear propagation"
    );
    let mut table = Table { timed: true, ..Table::new("editing_times", caption, &columns) };
    for (name, vertices, constraints, seconds) in PAPER {
        table.rows.push(vec![
            name.into(),
            Cell::Count(vertices),
            range(constraints.map(f64::from), 0).into(),
            Cell::Empty,
            Cell::Empty,
            Cell::Empty,
            Cell::Empty,
            range(seconds.map(|seconds| 1e3 * seconds), 0).into(),
            Cell::Empty,
        ]);
    }
    for (name, method) in [
        ("rig", Method::Rig),
        ("learned", Method::Learned),
        ("learned by part", Method::Parts),
        ("as rigid as possible", Method::Arap),
        ("Laplacian", Method::Laplace),
    ] {
        job.begin("times")?;
        let times = of_method(capture, rig, method).map_err(EvaluateError::Edit)?;
        let number = |values: &[f64], digits| Cell::Number(middle(values), digits);
        let least = times.whole.iter().copied().fold(f64::INFINITY, f64::min);
        table.rows.push(vec![
            format!("{}: {name}", capture.name).into(),
            Cell::Count(capture.topology.vertex_count() as u64),
            number(&times.constraints, 0),
            number(&times.grab, 1),
            number(&times.moves, 2),
            Cell::Number(most(&times.moves), 2),
            number(&times.rest, 1),
            range([least, most(&times.whole)], 0).into(),
            if times.spread.is_empty() { Cell::Empty } else { number(&times.spread, 2) },
        ]);
    }
    Ok(table)
}

fn range([least, most]: [f64; 2], digits: usize) -> String {
    if least == most { format!("{least:.digits$}") } else { format!("{least:.digits$} to {most:.digits$}") }
}

fn middle(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn milliseconds(since: Instant) -> f64 {
    1e3 * since.elapsed().as_secs_f64()
}

fn of_method(capture: &Capture, rig: &Rig, method: Method) -> Result<Times, String> {
    let Capture { topology, timeline, poses, .. } = capture;
    let wrong = |error: &dyn std::fmt::Display| error.to_string();
    let feet = pipeline::feet::feet(topology, timeline, poses);
    let mut editor = Editor::new(topology, None, Some(rig.clone())).map_err(|error| wrong(&error))?;
    if method.is_learned() {
        let frames: Vec<u32> = (0..timeline.frame_count()).collect();
        if let Some(learned) = learn_space(topology, poses, &frames, &SpaceOptions::default()) {
            let own: Vec<Vec<Vec3>> = learned.space.frames.iter().map(|&frame| poses.frame(frame).to_vec()).collect();
            let space = learned.space.space(&own, topology.weights()).map_err(|error| wrong(&error))?;
            editor.learn(space).map_err(|error| wrong(&error))?;
        }
    }
    let mut times = Times::default();
    for edit in 0..EDITS {
        let frame = (timeline.frame_count() - 1) * (2 * edit + 1) / (2 * EDITS);
        let pose = poses.frame(frame);
        let hand = hand(rig, pose);
        let standing = (0..feet.count()).filter(|&foot| feet.stands(frame, foot));
        let pins: Vec<u32> = standing.flat_map(|foot| sole(&feet, foot)).filter(|&v| v != hand).collect();
        times.constraints.push(pins.len() as f64 + 1.0);
        let grip = Grip { handles: vec![hand], pins, eased: Vec::new(), scope: Scope::Body, method };
        let way = Vec3::Y * RAISED * tall(pose);
        let at = |share: f32| [pose[hand as usize] + way * share];
        let began = Instant::now();
        let mut grab = editor.grab(pose, &grip).map_err(|error| wrong(&error))?;
        let grabbed = milliseconds(began);
        for step in 1..=MOVES {
            let began = Instant::now();
            editor.drag(&mut grab, &at(step as f32 / MOVES as f32)).map_err(|error| wrong(&error))?;
            times.moves.push(milliseconds(began));
        }
        let began = Instant::now();
        editor.settle(grab, &at(1.0)).map_err(|error| wrong(&error))?;
        times.grab.push(grabbed);
        times.rest.push(milliseconds(began));
        // The paper's edit: the constraints are there, and the surface is solved for them.
        let began = Instant::now();
        let grab = editor.grab(pose, &grip).map_err(|error| wrong(&error))?;
        editor.settle(grab, &at(1.0)).map_err(|error| wrong(&error))?;
        times.whole.push(milliseconds(began));
        if method == Method::Rig {
            times.spread.push(spread(capture, rig, &feet, (frame, hand, at(1.0)[0]))?);
        }
    }
    Ok(times)
}

/// Milliseconds of each frame that an edit spreads over.
fn spread(
    capture: &Capture,
    rig: &Rig,
    feet: &actor::feet::Feet,
    (frame, hand, to): (u32, u32, Vec3),
) -> Result<f64, String> {
    let Capture { topology, timeline, poses, .. } = capture;
    let wrong = |error: &dyn std::fmt::Display| error.to_string();
    let Some(sequence) = timeline.sequence_of(frame) else { return Ok(f64::NAN) };
    let reach = (WINDOW * timeline.fps()).round() as u32;
    let (first, last) =
        (frame.saturating_sub(reach).max(sequence.first_frame), (frame + reach).min(sequence.end_frame() - 1));
    let local = |frame: u32| i64::from(frame - sequence.first_frame);
    let document = json!({"version": 1, "edits": [{
        "sequence": sequence.name,
        "frame": local(frame),
        "window": [local(first), local(last)],
        "handles": [{"vertex": hand, "to": to.to_array()}],
    }]});
    let document = EditDocument::from_json(&document.to_string()).map_err(|error| wrong(&error))?;
    let editor = Editor::new(topology, None, Some(rig.clone())).map_err(|error| wrong(&error))?;
    let mut source = poses.clone();
    let edited = EditedPoses::new(&mut source, (timeline, feet), topology.weights(), editor, document);
    let mut edited = edited.map_err(|error| wrong(&error))?;
    edited.prepare().map_err(|error| wrong(&error))?;
    let began = Instant::now();
    for around in first..=last {
        let mut pose = poses.frame(around).to_vec();
        edited.read(around, &mut pose).map_err(|error| wrong(&error))?;
    }
    Ok(milliseconds(began) / f64::from(last - first + 1))
}
