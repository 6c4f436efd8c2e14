//! The paper's pictures of edits, made again with whoever was captured: a key frame by several methods (Fig. 3), a walk whose step, head or
//! hand goes elsewhere (Fig. 12), a step onto a platform (Fig. 13), a walk with a style (Fig. 15), a gait edited all along (Fig. 16).

use std::ops::Range;

use actor::capture::Capture;
use actor::pose_source::PoseSource;
use actor::timeline::Sequence;
use editing::{EditDocument, EditedPoses, Editor, Rig};
use glam::Vec3;
use job::Job;
use kernels::align::centre_of_mass;
use rig::{SpaceOptions, learn_space};
use serde_json::{Value, json};

use super::shape::tall;
use super::strip::{EDITED, RECORDED, Shown, strip};
use crate::EvaluateError;
use crate::document::Picture;

/// Frames of a row.
const SHOWN: usize = 8;
/// Seconds to both sides that an edit reaches, and between the edits of a style.
const WINDOW: f32 = 0.4;
/// From where a walk is seen, about +Y in radians.
const ASIDE: f32 = 1.05;
/// A foot swings where its lowest point is higher than this share of the body.
const SWINGS: f32 = 0.02;

/// What is drawn of: a sequence, and the vertices that are grabbed.
#[derive(Clone, Copy)]
struct Scene<'a> {
    capture: &'a Capture,
    rig: &'a Rig,
    sequence: &'a Sequence,
    body: f32,
}

/// The pictures; none of a body that is no human's.
pub fn figures(capture: &Capture, rig: &Rig, job: &Job) -> Result<Vec<Picture>, EvaluateError> {
    let is_human =
        ["head", "forearm_l", "forearm_r", "foot_l", "foot_r"].map(|name| bone(rig, name)).iter().all(Option::is_some);
    let Some(walk) = Scene::of(capture, rig, "walk").filter(|_| is_human) else { return Ok(Vec::new()) };
    let run = Scene::of(capture, rig, "run").unwrap_or(walk);
    job.begin("figures")?;
    Ok(vec![walk.key_frame()?, walk.corrected()?, walk.platform()?, walk.styled()?, run.all_along()?])
}

fn bone(rig: &Rig, name: &str) -> Option<usize> {
    rig.bones().iter().position(|bone| bone.name == name)
}

impl<'a> Scene<'a> {
    /// The sequence of this name, or that which leads farthest.
    fn of(capture: &'a Capture, rig: &'a Rig, name: &str) -> Option<Self> {
        let sequences = capture.timeline.sequences();
        let centre = |frame: u32| centre_of_mass(capture.poses.frame(frame), capture.topology.weights());
        let way = |one: &Sequence| centre(one.first_frame).distance(centre(one.end_frame() - 1));
        let named = sequences.iter().find(|one| one.name == name);
        let farthest = || sequences.iter().max_by(|a, b| way(a).total_cmp(&way(b)));
        let sequence = named.or_else(farthest).filter(|one| one.frame_count > 4)?;
        Some(Self { capture, rig, sequence, body: tall(capture.poses.frame(sequence.first_frame)) })
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
        let feet = pipeline::feet::feet(topology, timeline, poses);
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
        let mut edited = EditedPoses::new(&mut source, (timeline, &feet), topology.weights(), editor, document)
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
    fn rows(&self, lists: &[(Vec<Value>, Range<u32>)], caption: String) -> Result<Picture, EvaluateError> {
        let mut rows = Vec::new();
        for (edits, frames) in lists {
            let last = SHOWN as u32 - 1;
            let length = frames.end.saturating_sub(frames.start + 1);
            let frames: Vec<u32> = (0..SHOWN as u32).map(|k| frames.start + length * k / last).collect();
            rows.push(frames.iter().map(|&frame| Shown::plain(self.pose(frame), RECORDED)).collect());
            let made = self.edited(edits, &frames)?;
            rows.push(made.iter().map(|pose| Shown::plain(pose, EDITED)).collect());
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

    /// Figure 12: a step aside, a head that ducks, a hand elsewhere.
    fn corrected(&self) -> Result<Picture, EvaluateError> {
        let toe = self.end("foot_l");
        let step = self.swing("foot_l");
        let aside = self.ahead(step).cross(Vec3::Y) * -(0.15 * self.body);
        let middle = self.sequence.frame_count / 2;
        let head = self.edit(middle, &[(self.end("head"), Vec3::Y * -(0.18 * self.body))], &json!({}));
        let by = self.ahead(middle) * (0.15 * self.body) + Vec3::Y * (0.2 * self.body);
        let hand = self.edit(middle, &[(self.end("forearm_r"), by)], &json!({}));
        let foot = self.edit(step, &[(toe, aside)], &json!({}));
        let lists =
            [(vec![foot], self.shown(step)), (vec![head], self.shown(middle)), (vec![hand], self.shown(middle))];
        self.rows(&lists, "Fig. 12: recorded (blue) over edited: the left foot steps aside; the head ducks; the right hand goes elsewhere".into())
    }

    fn shown(&self, frame: u32) -> Range<u32> {
        let [first, last] = self.around(frame);
        first as u32..last as u32 + 1
    }

    /// Figure 13: onto a platform: a foot, its leg and the body rise.
    fn platform(&self) -> Result<Picture, EvaluateError> {
        let toe = self.end("foot_l");
        let step = self.swing("foot_l");
        let by = Vec3::Y * (0.16 * self.body) + self.ahead(step) * (0.06 * self.body);
        let edit = self.edit(step, &[(toe, by)], &json!({}));
        self.rows(
            &[(vec![edit], self.shown(step))],
            "Fig. 13: recorded (blue) over edited: the left foot steps high, as onto a platform".into(),
        )
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
        self.rows(&[(self.along(moves), 0..self.sequence.frame_count)], caption.into())
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
        self.rows(&[(self.along(moves), 0..self.sequence.frame_count)], caption)
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
