//! An edit that spreads over the frames around it: a hand is raised, by each of the paper's three ways (section III-C).

use actor::capture::Capture;
use actor::pose_source::PoseSource;
use editing::soles::sole;
use editing::{EditDocument, EditedPoses, Editor, Rig};
use glam::Vec3;
use job::Job;
use kernels::align::centre_of_mass;
use serde_json::json;

use super::shape::{Limbs, stretch, tall, volume};
use super::strip::{EDITED, RECORDED, Shown, strip};
use crate::EvaluateError;
use crate::document::{Cell, Picture, Table};

/// How far the hand is raised, as a share of the body's height.
const RAISED: f32 = 0.35;
/// Seconds to both sides that the edit reaches.
const WINDOW: f32 = 0.28;
/// Frames of the picture.
const SHOWN: usize = 8;

/// The table, and of the non-linear way the volume's and the limbs' largest change and how much more feet slide, in millimetres.
pub struct Propagated {
    pub table: Table,
    /// What is not as it was wanted, in sentences.
    pub notes: Vec<String>,
    pub nonlinear: Option<[f64; 3]>,
    /// The frames around, as recorded and by each way.
    pub picture: Picture,
}

/// Makes the table.
pub fn propagated(capture: &Capture, rig: &Rig, job: &Job) -> Result<Propagated, EvaluateError> {
    let columns = [
        "propagation",
        "handle off mm",
        "stretch mean %",
        "stretch worst %",
        "volume least",
        "volume most",
        "limbs %",
        "slide before mm",
        "slide mm",
        "hand mm/frame^2",
    ];
    let (hand, key, window) = task(capture, rig);
    let name = capture.timeline.sequence_of(key).map_or("", |sequence| sequence.name.as_str());
    let caption = format!(
        "A hand (vertex {hand}) raised by {:.2} m in frame {key}, in {name}, frames {} to {}: edges, volume and limbs beside the \
         recorded frames', mean slide of soles that stand in two frames in a row, and the hand's mean acceleration",
        RAISED * tall(capture.poses.frame(key)),
        window[0],
        window[1]
    );
    let mut table = Table::new("editing_propagation", caption, &columns);
    let (mut notes, mut nonlinear) = (Vec::new(), None);
    let shown: Vec<u32> =
        (0..SHOWN as u32).map(|k| window[0] + (window[1] - window[0]) * k / (SHOWN as u32 - 1)).collect();
    let mut rows =
        vec![shown.iter().map(|&frame| Shown::plain(capture.poses.frame(frame), RECORDED)).collect::<Vec<_>>()];
    for (way, words) in
        [("nonlinear", "non-linear"), ("linear", "linear"), ("constraint", "interpolation of constraints")]
    {
        job.begin("propagation")?;
        let (row, marks, told, made) = one(capture, rig, (hand, key, window), (way, words))?;
        rows.push(
            shown
                .iter()
                .filter_map(|&frame| Some(Shown::plain(made.get((frame - window[0]) as usize)?, EDITED)))
                .collect(),
        );
        notes.extend(told.into_iter().map(|note| format!("{words}: {note}")));
        table.rows.push(row);
        if way == "nonlinear" {
            nonlinear = Some(marks);
        }
    }
    let caption = format!(
        "Figs. 4 to 6: a hand raised in {name}, frames {} to {}; rows: recorded (blue), non-linear, linear, interpolation of constraints",
        window[0], window[1]
    );
    let floor = capture.poses.frame(key).iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    let Capture { topology, .. } = capture;
    let picture = strip(topology.triangles(), topology.weights(), &rows, (0.6, floor), caption)?;
    Ok(Propagated { table, notes, nonlinear, picture })
}

/// The hand, the frame in which it is raised, and the window: the middle of a walk, or of the sequence that leads farthest.
fn task(capture: &Capture, rig: &Rig) -> (u32, u32, [u32; 2]) {
    let sequences = capture.timeline.sequences();
    let weights = capture.topology.weights();
    let centre = |frame: u32| centre_of_mass(capture.poses.frame(frame), weights);
    let way = |number: usize| centre(sequences[number].first_frame).distance(centre(sequences[number].end_frame() - 1));
    let longest = (0..sequences.len()).fold(0, |best, number| if way(number) > way(best) { number } else { best });
    let number = sequences.iter().position(|one| one.name == "walk").unwrap_or(longest);
    let sequence = &sequences[number];
    let key = sequence.first_frame + sequence.frame_count / 2;
    let reach = ((WINDOW * capture.timeline.fps()).round() as u32).max(1);
    let window = [key.saturating_sub(reach).max(sequence.first_frame), (key + reach).min(sequence.end_frame() - 1)];
    (hand(rig, capture.poses.frame(key)), key, window)
}

/// Of a human's left forearm the vertex that is farthest from the elbow; else what is farthest from the root.
pub fn hand(rig: &Rig, pose: &[Vec3]) -> u32 {
    let joints = rig.joints(&rig.fit(pose));
    let forearm = rig.bones().iter().position(|bone| bone.name == "forearm_l");
    let joint = joints[forearm.unwrap_or(0)];
    let own = (0..pose.len() as u32).filter(|&v| forearm.is_none_or(|bone| rig.bone_of(v) == bone));
    let farther = |best: u32, v: u32| {
        if pose[v as usize].distance(joint) > pose[best as usize].distance(joint) { v } else { best }
    };
    own.reduce(farther).unwrap_or(0)
}

type Row = (Vec<Cell>, [f64; 3], Vec<String>, Vec<Vec<Vec3>>);

fn one(
    capture: &Capture,
    rig: &Rig,
    (hand, key, window): (u32, u32, [u32; 2]),
    (way, words): (&str, &str),
) -> Result<Row, EvaluateError> {
    let Capture { topology, timeline, poses, .. } = capture;
    let feet = pipeline::feet::feet(topology, timeline, poses);
    let recorded = |frame: u32| poses.frame(frame);
    let Some(sequence) = timeline.sequence_of(key) else { return Ok((Vec::new(), [0.0; 3], Vec::new(), Vec::new())) };
    let local = |frame: u32| i64::from(frame) - i64::from(sequence.first_frame);
    let to = recorded(key)[hand as usize] + Vec3::Y * RAISED * tall(recorded(key));
    let document = json!({"version": 1, "edits": [{
        "sequence": sequence.name,
        "frame": local(key),
        "window": [local(window[0]), local(window[1])],
        "handles": [{"vertex": hand, "to": to.to_array()}],
        "propagate": way,
    }]});
    let wrong = |error: &dyn std::fmt::Display| EvaluateError::Edit(error.to_string());
    let document = EditDocument::from_json(&document.to_string()).map_err(|error| wrong(&error))?;
    let editor = Editor::new(topology, None, Some(rig.clone())).map_err(|error| wrong(&error))?;
    let mut source = poses.clone();
    let mut edited = EditedPoses::new(&mut source, (timeline, &feet), topology.weights(), editor, document)
        .map_err(|error| wrong(&error))?;
    let notes = edited.prepare().map_err(|error| wrong(&error))?;
    let frames: Vec<u32> = (window[0]..=window[1]).collect();
    let mut made = Vec::with_capacity(frames.len());
    for &frame in &frames {
        let mut pose = recorded(frame).to_vec();
        edited.read(frame, &mut pose)?;
        made.push(pose);
    }
    let stretches: Vec<f64> =
        frames.iter().zip(&made).map(|(&frame, pose)| 100.0 * stretch(topology, recorded(frame), pose)).collect();
    let volumes: Vec<f64> = frames
        .iter()
        .zip(&made)
        .map(|(&frame, pose)| volume(topology, pose) / volume(topology, recorded(frame)))
        .collect();
    let limbs = Limbs::of(rig);
    let changes = frames.iter().zip(&made).filter_map(|(&frame, pose)| limbs.change(recorded(frame), pose));
    let limbs = changes.reduce(f64::max).map_or(f64::NAN, |change| 100.0 * change);
    // Of a walk's two feet one moves: only those are looked at that stand in both frames.
    let slide = |pose: &dyn Fn(usize) -> Vec3, before: &dyn Fn(usize) -> Vec3, soles: &[u32]| {
        let steps = soles.iter().map(|&v| f64::from((pose(v as usize) - before(v as usize)).length()));
        (steps.sum::<f64>(), soles.len())
    };
    let (mut slides, mut count) = ([0.0; 2], 0);
    for k in 1..frames.len() {
        let stands = |foot: usize| feet.stands(frames[k], foot) && feet.stands(frames[k - 1], foot);
        let soles: Vec<u32> =
            (0..feet.count()).filter(|&foot| stands(foot)).flat_map(|foot| sole(&feet, foot)).collect();
        let was = slide(&|v| recorded(frames[k])[v], &|v| recorded(frames[k - 1])[v], &soles);
        let is = slide(&|v| made[k][v], &|v| made[k - 1][v], &soles);
        slides = [slides[0] + was.0, slides[1] + is.0];
        count += was.1;
    }
    let slides = slides.map(|sum| 1e3 * sum / f64::from(count.max(1) as u32));
    let bends: Vec<f64> = made
        .windows(3)
        .map(|three| {
            f64::from((three[0][hand as usize] + three[2][hand as usize] - 2.0 * three[1][hand as usize]).length())
        })
        .collect();
    let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let at_key = &made[(key - window[0]) as usize];
    let row = vec![
        words.into(),
        Cell::Number(f64::from(at_key[hand as usize].distance(to)) * 1e3, 3),
        Cell::Number(mean(&stretches), 2),
        Cell::Number(most(&stretches), 2),
        Cell::Number(least(&volumes), 3),
        Cell::Number(most(&volumes), 3),
        Cell::Number(limbs, 2),
        Cell::Number(slides[0], 3),
        Cell::Number(slides[1], 3),
        Cell::Number(1e3 * mean(&bends), 1),
    ];
    let off = 100.0 * (most(&volumes) - 1.0).max(1.0 - least(&volumes));
    Ok((row, [off, limbs, slides[1] - slides[0]], notes, made))
}
