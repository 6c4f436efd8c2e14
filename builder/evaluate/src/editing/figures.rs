//! The paper's pictures of edits, made again with whoever was captured: a key frame by several methods (Fig. 3), a walk whose step, head or
//! hand goes elsewhere (Fig. 12), a step onto a platform (Fig. 13), a walk with a style (Fig. 15), a gait edited all along (Fig. 16).

use std::ops::Range;

use actor::capture::Capture;
use actor::feet::Feet;
use actor::pose_source::PoseSource;
use actor::timeline::Sequence;
use editing::soles::sole;
use editing::{EditDocument, EditedPoses, Editor, Rig};
use glam::Vec3;
use job::Job;
use kernels::align::centre_of_mass;
use rig::{SpaceOptions, learn_space};
use serde_json::{Value, json};

use super::shape::tall;
use super::steps::{Step, ends, swung};
use super::strip::{EDITED, RECORDED, Shown, strip};
use crate::EvaluateError;
use crate::document::Picture;

/// Frames of a row.
const SHOWN: usize = 8;
/// Seconds to both sides that an edit reaches, and between the edits of a style.
const WINDOW: f32 = 0.4;
/// From where a walk is seen, about +Y in radians.
const ASIDE: f32 = 1.05;
/// How high the platform is, as a share of the body's height.
const RISE: f32 = 0.1;
/// From where a step aside is seen beside that, in radians: from ahead.
const AHEAD: f32 = -0.75;
/// A foot swings where its lowest point is higher than this share of the body.
const SWINGS: f32 = 0.02;

/// What is drawn of: a sequence, and the vertices that are grabbed.
#[derive(Clone, Copy)]
struct Scene<'a> {
    capture: &'a Capture,
    rig: &'a Rig,
    feet: &'a Feet,
    sequence: &'a Sequence,
    body: f32,
}

/// A row of figures, and the same edited: the edits, the frames that are shown, how it is turned beside other rows, and what stands there.
struct Row {
    edits: Vec<Value>,
    frames: Range<u32>,
    turned: f32,
    block: Option<[Vec3; 8]>,
}

impl Row {
    fn new((edits, frames): (Vec<Value>, Range<u32>)) -> Self {
        Self { edits, frames, turned: 0.0, block: None }
    }
}

/// The pictures; none of a body that is no human's.
pub fn figures(capture: &Capture, rig: &Rig, job: &Job) -> Result<Vec<Picture>, EvaluateError> {
    let is_human =
        ["head", "forearm_l", "forearm_r", "foot_l", "foot_r"].map(|name| bone(rig, name)).iter().all(Option::is_some);
    let feet = pipeline::feet::feet(&capture.topology, &capture.timeline, &capture.poses);
    let Some(walk) = Scene::of((capture, rig, &feet), "walk").filter(|_| is_human) else { return Ok(Vec::new()) };
    let run = Scene::of((capture, rig, &feet), "run").unwrap_or(walk);
    job.begin("figures")?;
    Ok(vec![walk.key_frame()?, walk.corrected()?, walk.platform()?, walk.styled()?, run.all_along()?])
}

fn bone(rig: &Rig, name: &str) -> Option<usize> {
    rig.bones().iter().position(|bone| bone.name == name)
}

impl<'a> Scene<'a> {
    /// The sequence of this name, or that which leads farthest.
    fn of((capture, rig, feet): (&'a Capture, &'a Rig, &'a Feet), name: &str) -> Option<Self> {
        let sequences = capture.timeline.sequences();
        let centre = |frame: u32| centre_of_mass(capture.poses.frame(frame), capture.topology.weights());
        let way = |one: &Sequence| centre(one.first_frame).distance(centre(one.end_frame() - 1));
        let named = sequences.iter().find(|one| one.name == name);
        let farthest = || sequences.iter().max_by(|a, b| way(a).total_cmp(&way(b)));
        let sequence = named.or_else(farthest).filter(|one| one.frame_count > 4)?;
        Some(Self { capture, rig, feet, sequence, body: tall(capture.poses.frame(sequence.first_frame)) })
    }

    fn pose(&self, frame: u32) -> &[Vec3] {
        self.capture.poses.frame(self.sequence.first_frame + frame)
    }

    /// Which way the body goes over the ground, of length 1.
    fn ahead(&self, frame: u32) -> Vec3 {
        let centre = |frame: u32| {
            centre_of_mass(self.pose(frame.min(self.sequence.frame_count - 1)), self.capture.topology.weights())
        };
        let way = (centre(frame + 2) - centre(frame.saturating_sub(2))).with_y(0.0);
        way.normalize_or(Vec3::Z)
    }

    /// Of a bone's vertices that which is farthest from its joint.
    fn end(&self, name: &str) -> u32 {
        let bone = bone(self.rig, name).unwrap_or(0);
        let (rest, joint) = (self.rig.rest(), self.rig.bones()[bone].joint);
        let own = (0..rest.len() as u32).filter(|&v| self.rig.bone_of(v) == bone);
        let far = |v: u32| rest[v as usize].distance(joint);
        own.reduce(|best, v| if far(v) > far(best) { v } else { best }).unwrap_or(0)
    }

    /// The frame around the middle in which a foot that swings is farthest ahead of the body: where its step goes.
    fn swing(&self, foot: &str) -> u32 {
        let (bone, count) = (bone(self.rig, foot).unwrap_or(0), self.sequence.frame_count);
        let own: Vec<u32> = (0..self.rig.rest().len() as u32).filter(|&v| self.rig.bone_of(v) == bone).collect();
        let low =
            |frame: u32, of: &[u32]| of.iter().map(|&v| self.pose(frame)[v as usize].y).fold(f32::INFINITY, f32::min);
        let all: Vec<u32> = (0..self.rig.rest().len() as u32).collect();
        let swings = |frame: &u32| low(*frame, &own) - low(*frame, &all) > SWINGS * self.body;
        let ahead = |frame: u32| {
            let middle = centre_of_mass(self.pose(frame), self.capture.topology.weights());
            own.iter().map(|&v| (self.pose(frame)[v as usize] - middle).dot(self.ahead(frame))).sum::<f32>()
        };
        let farther = |best, frame| if ahead(frame) > ahead(best) { frame } else { best };
        (count / 4..3 * count / 4).filter(swings).reduce(farther).unwrap_or(count / 2)
    }

    /// The frames around one that an edit reaches.
    fn around(&self, frame: u32) -> [i64; 2] {
        let reach = i64::from(((WINDOW * self.capture.timeline.fps()).round() as u32).max(2));
        let last = i64::from(self.sequence.frame_count) - 1;
        [(i64::from(frame) - reach).max(0), (i64::from(frame) + reach).min(last)]
    }

    /// An edit of `frame` that moves vertices.
    fn edit(&self, frame: u32, moves: &[(u32, Vec3)], more: &Value) -> Value {
        let handle = |&(vertex, by): &(u32, Vec3)| {
            let to = self.pose(frame)[vertex as usize] + by;
            json!({"vertex": vertex, "to": to.to_array()})
        };
        let mut edit = json!({
            "sequence": self.sequence.name,
            "frame": frame,
            "window": self.around(frame),
            "handles": moves.iter().map(handle).collect::<Vec<_>>(),
        });
        if let (Some(edit), Some(more)) = (edit.as_object_mut(), more.as_object()) {
            edit.extend(more.clone());
        }
        edit
    }

    /// These frames with `edits`.
    fn edited(&self, edits: &[Value], frames: &[u32]) -> Result<Vec<Vec<Vec3>>, EvaluateError> {
        let Capture { topology, timeline, poses, .. } = self.capture;
        let wrong = |error: &dyn std::fmt::Display| EvaluateError::Edit(error.to_string());
        let document = json!({"version": 1, "edits": edits}).to_string();
        let document = EditDocument::from_json(&document).map_err(|error| wrong(&error))?;
        let mut editor = Editor::new(topology, None, Some(self.rig.clone())).map_err(|error| wrong(&error))?;
        if document.wants_space() {
            let all: Vec<u32> = (0..timeline.frame_count()).collect();
            if let Some(learned) = learn_space(topology, poses, &all, &SpaceOptions::default()) {
                let own: Vec<Vec<Vec3>> =
                    learned.space.frames.iter().map(|&frame| poses.frame(frame).to_vec()).collect();
                let space = learned.space.space(&own, topology.weights()).map_err(|error| wrong(&error))?;
                editor.learn(space).map_err(|error| wrong(&error))?;
            }
        }
        let mut source = poses.clone();
        let mut edited = EditedPoses::new(&mut source, (timeline, self.feet), topology.weights(), editor, document)
            .map_err(|error| wrong(&error))?;
        edited.prepare().map_err(|error| wrong(&error))?;
        let mut made = Vec::with_capacity(frames.len());
        for &frame in frames {
            let mut pose = self.pose(frame).to_vec();
            edited.read(self.sequence.first_frame + frame, &mut pose)?;
            made.push(pose);
        }
        Ok(made)
    }

    /// Recorded frames over the same frames edited, for each list of edits and its frames.
    fn rows(&self, lists: &[Row], caption: String) -> Result<Picture, EvaluateError> {
        let mut rows = Vec::new();
        for Row { edits, frames, turned, block } in lists {
            let shown = |pose: &[Vec3], colour| Shown { turned: *turned, block: *block, ..Shown::plain(pose, colour) };
            let last = SHOWN as u32 - 1;
            let length = frames.end.saturating_sub(frames.start + 1);
            let frames: Vec<u32> = (0..SHOWN as u32).map(|k| frames.start + length * k / last).collect();
            rows.push(frames.iter().map(|&frame| shown(self.pose(frame), RECORDED)).collect());
            let made = self.edited(edits, &frames)?;
            rows.push(made.iter().map(|pose| shown(pose, EDITED)).collect());
        }
        self.strip(&rows, caption)
    }

    fn strip(&self, rows: &[Vec<Shown>], caption: String) -> Result<Picture, EvaluateError> {
        let floor = self.pose(0).iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
        let topology = &self.capture.topology;
        let ahead = self.ahead(self.sequence.frame_count / 2);
        let heading = kernels::scalar::atan2(ahead.x, ahead.z) + ASIDE;
        strip(topology.triangles(), topology.weights(), rows, (heading, floor), caption)
    }

    /// Figure 3: one frame by each method.
    fn key_frame(&self) -> Result<Picture, EvaluateError> {
        let (foot, frame) = (self.end("foot_r"), self.swing("foot_r"));
        let by = Vec3::Y * (0.2 * self.body) + self.ahead(frame) * (0.1 * self.body);
        let mut row = vec![Shown::plain(self.pose(frame), RECORDED)];
        for method in ["laplace", "arap", "learned", "parts", "rig"] {
            let edit = self.edit(frame, &[(foot, by)], &json!({"method": method}));
            row.extend(self.edited(&[edit], &[frame])?.iter().map(|pose| Shown::plain(pose, EDITED)));
        }
        let caption = format!(
            "Fig. 3: the right foot, in its swing, put {:.2} m up and half as far ahead; recorded (blue), Laplacian, as rigid as possible, learned, \
             learned by part, rig",
            0.2 * self.body
        );
        self.strip(&[row], caption)
    }

    /// The foot whose sole the bone `name` moves.
    fn foot(&self, name: &str) -> Option<usize> {
        let bone = bone(self.rig, name)?;
        let own = |foot: usize| sole(self.feet, foot).filter(|&vertex| self.rig.bone_of(vertex) == bone).count();
        (0..self.feet.count()).filter(|&foot| own(foot) > 0).max_by_key(|&foot| own(foot))
    }

    /// The left foot's step around the middle of the sequence, with the other foot; `None` where no foot was found to stand.
    fn step(&self) -> Option<(Step, [usize; 2])> {
        let [left, right] = [self.foot("foot_l")?, self.foot("foot_r")?];
        Some((Step::around(self.feet, self.sequence, left, self.swing("foot_l"))?, [left, right]))
    }

    /// A foot that steps aside, stands there, and comes back; the other one stays where it was all the while.
    fn aside(&self) -> (Vec<Value>, Range<u32>) {
        let by = |frame: u32| self.ahead(frame).cross(Vec3::Y) * -(0.15 * self.body);
        let Some((step, [left, right])) = self.step() else {
            let frame = self.swing("foot_l");
            return (vec![self.edit(frame, &[(self.end("foot_l"), by(frame))], &json!({}))], self.shown(frame));
        };
        let (aside, pins) = (by(step.land), sole(self.feet, right).collect::<Vec<u32>>());
        let held = ends(self.feet, left, self.pose(step.land), self.ahead(step.land));
        let moves: Vec<(u32, Vec3)> = held.into_iter().map(|vertex| (vertex, aside)).collect();
        let edit = |(key, window)| self.edit(key, &moves, &json!({"window": window, "pins": pins}));
        (step.keys().into_iter().map(edit).collect(), step.lift..step.back + 1)
    }

    /// Figure 12: a step aside, a head that ducks, a hand elsewhere.
    fn corrected(&self) -> Result<Picture, EvaluateError> {
        let middle = self.sequence.frame_count / 2;
        let head = self.edit(middle, &[(self.end("head"), Vec3::Y * -(0.18 * self.body))], &json!({}));
        let by = self.ahead(middle) * (0.15 * self.body) + Vec3::Y * (0.2 * self.body);
        let hand = self.edit(middle, &[(self.end("forearm_r"), by)], &json!({}));
        let lists = [
            Row { turned: AHEAD, ..Row::new(self.aside()) },
            Row::new((vec![head], self.shown(middle))),
            Row::new((vec![hand], self.shown(middle))),
        ];
        self.rows(&lists, "Fig. 12: recorded (blue) over edited: the left foot steps aside and stands there; the head ducks; the right hand goes elsewhere".into())
    }

    fn shown(&self, frame: u32) -> Range<u32> {
        let [first, last] = self.around(frame);
        first as u32..last as u32 + 1
    }

    /// Figure 13: onto a platform: a foot, its leg and the body rise, and the other foot passes higher.
    fn platform(&self) -> Result<Picture, EvaluateError> {
        let height = RISE * self.body;
        let Some((step, feet)) = self.step() else {
            let frame = self.swing("foot_l");
            let edit = self.edit(frame, &[(self.end("foot_l"), Vec3::Y * height)], &json!({}));
            let row = Row::new((vec![edit], self.shown(frame)));
            return self.rows(&[row], "Fig. 13: recorded (blue) over edited: the left foot steps high".into());
        };
        let [left, right] = feet.map(|foot| ends(self.feet, foot, self.pose(step.land), self.ahead(step.land)));
        let edit = |(key, window): (u32, [u32; 2])| {
            // Over one leg the body is as high as the platform; while the other foot is on the ground, only so far as that leg reaches.
            let other = (std::f32::consts::PI * swung(self.feet, self.sequence, feet[1], key)).sin();
            let rises = [(&left, 1.0), (&right, 0.6 * other), (&vec![self.end("head")], 0.35 + 0.55 * other)];
            let moves = rises.iter().flat_map(|(own, share)| own.iter().map(move |&v| (v, Vec3::Y * height * *share)));
            self.edit(key, &moves.collect::<Vec<_>>(), &json!({"window": window, "pins": "none"}))
        };
        let edits = step.keys().into_iter().map(edit).collect();
        let block = Some(self.block(feet[0], step.land + (step.leave - step.land) / 3, height));
        let row = Row { block, ..Row::new((edits, step.lift..step.back + 1)) };
        self.rows(
            &[row],
            "Fig. 13: recorded (blue) over edited: the left foot steps onto a platform, and the body with it; several edits that compose".into(),
        )
    }

    /// A block under the sole of `foot` as it stands in `frame`, `height` high, along the way.
    fn block(&self, foot: usize, frame: u32, height: f32) -> [Vec3; 8] {
        let (ahead, margin) = (self.ahead(frame), 0.03 * self.body);
        let aside = ahead.cross(Vec3::Y);
        let points = || sole(self.feet, foot).map(|vertex| self.pose(frame)[vertex as usize]);
        let [low, high] = [f32::min, f32::max].map(|of| {
            [ahead, aside, Vec3::Y].map(|axis| points().map(|point| point.dot(axis)).reduce(of).unwrap_or(0.0))
        });
        let (near, far) = ([low[0] - margin, low[1] - margin], [high[0] + margin, high[1] + margin]);
        let corner = |k: usize| {
            let [along, across] = [[near[0], near[1]], [far[0], near[1]], [far[0], far[1]], [near[0], far[1]]][k % 4];
            ahead * along + aside * across + Vec3::Y * (low[2] + if k < 4 { 0.0 } else { height })
        };
        std::array::from_fn(corner)
    }

    /// Figure 15: hands out to the sides all along the walk.
    fn styled(&self) -> Result<Picture, EvaluateError> {
        let moves = |frame: u32| {
            let left = self.ahead(frame).cross(Vec3::Y) * -(0.16 * self.body);
            let up = Vec3::Y * (0.14 * self.body);
            vec![(self.end("forearm_l"), left + up), (self.end("forearm_r"), up - left)]
        };
        let caption =
            "Fig. 15: recorded (blue) over edited: a walk whose hands are held out, several edits that compose";
        self.rows(&[Row::new((self.along(moves), 0..self.sequence.frame_count))], caption.into())
    }

    /// Figure 16: the trunk leans all along a gait.
    fn all_along(&self) -> Result<Picture, EvaluateError> {
        let moves = |frame: u32| {
            let ahead = self.ahead(frame) * (0.1 * self.body);
            vec![(self.end("head"), ahead - Vec3::Y * (0.06 * self.body))]
        };
        let caption = format!(
            "Fig. 16: {}, recorded (blue) over edited: bent forwards all along, several edits that compose",
            self.sequence.name
        );
        self.rows(&[Row::new((self.along(moves), 0..self.sequence.frame_count))], caption)
    }

    /// Edits all along the sequence, `moves` of each of their frames: each fades until the next one is whole.
    fn along(&self, moves: impl Fn(u32) -> Vec<(u32, Vec3)>) -> Vec<Value> {
        let reach = ((WINDOW * self.capture.timeline.fps()).round() as u32).max(2);
        let last = self.sequence.frame_count - 1;
        let count = (last / reach).max(1);
        let at = |k: u32| k * last / count;
        let edit = |k: u32| {
            let window = [at(k.saturating_sub(1)), at((k + 1).min(count))];
            self.edit(at(k), &moves(at(k)), &json!({"window": window}))
        };
        (0..=count).map(edit).collect()
    }
}
