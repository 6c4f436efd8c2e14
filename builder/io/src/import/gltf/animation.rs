//! Animation clips: which channels a file's animations have, and what they make of its nodes at any time.

use glam::{Vec3, Vec4};
use gltf::json::Value;

use super::super::warning::Warning;
use super::animation_json::{SamplerJson, TargetJson};
use super::channel::{Channel, Interpolation, Property, unit};
use super::document::Document;
use super::nodes::{Nodes, Transform};
use crate::import::error::ImportError;

/// What a frame and a keyframe may lie apart and still mean the same time, as a part of a frame.
const SAME_FRAME: f64 = 0.05;

/// One clip.
pub(super) struct Clip {
    /// Its name.
    pub name: String,
    /// Time of the first keyframe in seconds.
    pub start: f64,
    /// Time of the last keyframe in seconds.
    pub end: f64,
    /// What it moves.
    pub channels: Vec<Channel>,
    /// Whether the file names it.
    pub named: bool,
}

/// What a clip says about the nodes at one time.
pub(super) struct AnimatedNodes {
    /// Local transforms of all nodes.
    pub transforms: Vec<Transform>,
    /// Morph weights of the nodes that a channel drives.
    pub weights: Vec<(usize, Vec<f32>)>,
}

/// All animations of `document` as clips; `stem` names what has no name. Sentences for the user go to `warnings`.
pub(super) fn clips(
    document: &Document,
    nodes: &Nodes,
    stem: &str,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Clip>, ImportError> {
    let animations = document.animations();
    let mut clips = Vec::new();
    let mut left_out = Vec::new();
    for (index, animation) in animations.iter().enumerate() {
        let name = animation.name.clone().filter(|name| !name.is_empty());
        let named = name.is_some();
        let alone = animations.len() == 1;
        let name = name.unwrap_or_else(|| if alone { stem.to_owned() } else { format!("{stem} {index}") });
        let channels = read_channels(document, nodes, index, &mut left_out)?;
        clips.push(Clip::new(name, channels, named));
    }
    if let Some(first) = left_out.first() {
        if document.requires("KHR_animation_pointer") {
            let extension = format!("KHR_animation_pointer ({first})");
            return Err(ImportError::Extension { path: document.path().to_owned(), extension });
        }
        warnings.push(Warning::new(
            "W_GLTF_CHANNEL",
            format!(
                "{}: {} channel(s) move something else than nodes and are left out, the first {first}",
                document.path().display(),
                left_out.len()
            ),
        ));
    }
    Ok(clips)
}

/// The channels of animation `index` that move nodes; what the others move goes to `left_out`.
fn read_channels(
    document: &Document,
    nodes: &Nodes,
    index: usize,
    left_out: &mut Vec<String>,
) -> Result<Vec<Channel>, ImportError> {
    let Some(animation) = document.animations().get(index) else { return Ok(Vec::new()) };
    let mut channels = Vec::new();
    for (k, channel) in animation.channels.iter().enumerate() {
        let user = format!("animation {index}, channel {k}");
        let (node, property) = match target(&channel.target) {
            Ok(target) => target,
            Err(what) => {
                left_out.push(format!("{what} ({user})"));
                continue;
            }
        };
        if node >= nodes.rest.len() {
            return Err(document.wrong(format!("{user} names node {node}, which does not exist")));
        }
        let sampler = animation.samplers.get(channel.sampler);
        let sampler = sampler.ok_or_else(|| document.wrong(format!("{user} names a sampler that does not exist")))?;
        let interpolation = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            Some(other) => return Err(document.wrong(format!("{user} has the unknown interpolation {other}"))),
        };
        channels.push(read_channel(document, (node, property), interpolation, sampler, &user)?);
    }
    Ok(channels)
}

/// The node and property that a channel moves, or what it moves instead.
fn target(target: &TargetJson) -> Result<(usize, Property), String> {
    let property = |path: &str| {
        Some(match path {
            "translation" => Property::Translation,
            "rotation" => Property::Rotation,
            "scale" => Property::Scale,
            "weights" => Property::Weights,
            "extensions/KHR_node_visibility/visible" => Property::Visible,
            _ => return None,
        })
    };
    if target.path != "pointer" {
        let found = target.node.zip(property(&target.path));
        let without = || if target.node.is_none() { "no node" } else { target.path.as_str() }.to_owned();
        return found.ok_or_else(without);
    }
    let pointer = target.extensions.get("KHR_animation_pointer").and_then(|e| e.get("pointer")).and_then(Value::as_str);
    let pointer = pointer.unwrap_or("an unknown pointer");
    let node_and_path = pointer.strip_prefix("/nodes/").and_then(|rest| rest.split_once('/'));
    let found = node_and_path.and_then(|(node, path)| Some((node.parse().ok()?, property(path)?)));
    found.ok_or_else(|| pointer.to_owned())
}

fn read_channel(
    document: &Document,
    (node, property): (usize, Property),
    interpolation: Interpolation,
    sampler: &SamplerJson,
    user: &str,
) -> Result<Channel, ImportError> {
    let times: Vec<f32> = document.floats::<1>(sampler.input, user)?.into_iter().flatten().collect();
    if times.is_empty() || !times.is_sorted() || times.iter().any(|t| !t.is_finite()) {
        return Err(document.wrong(format!("{user}: the keyframe times are missing or not ascending")));
    }
    let values: Vec<f32> = match property {
        Property::Translation | Property::Scale => document.floats::<3>(sampler.output, user)?.concat(),
        Property::Rotation => document.floats::<4>(sampler.output, user)?.concat(),
        Property::Weights | Property::Visible => document.floats::<1>(sampler.output, user)?.concat(),
    };
    let cubic = interpolation == Interpolation::CubicSpline;
    let points = times.len() * if cubic { 3 } else { 1 };
    let width = values.len() / points;
    let fits = match property {
        Property::Translation | Property::Scale => width == 3,
        Property::Rotation => width == 4,
        Property::Weights => width > 0,
        Property::Visible => width == 1,
    };
    if !fits || values.len() != width * points {
        return Err(document.wrong(format!("{user}: {} times but {} numbers", times.len(), values.len())));
    }
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(
            document.wrong(format!("{user}: the value of keyframe {} is not finite", at * times.len() / values.len()))
        );
    }
    let interpolation = if property == Property::Visible { Interpolation::Step } else { interpolation };
    Ok(Channel { node, property, interpolation, times, values, width, cubic })
}

impl Clip {
    pub fn new(name: String, channels: Vec<Channel>, named: bool) -> Self {
        let ends = channels.iter().filter_map(|c| Some((*c.times.first()?, *c.times.last()?)));
        let (start, end) = ends.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), (c, d)| (a.min(c), b.max(d)));
        let (start, end) = if start <= end { (f64::from(start), f64::from(end)) } else { (0.0, 0.0) };
        Self { name, start, end, channels, named }
    }

    /// A clip of one frame in which nothing moves.
    pub fn still(name: &str) -> Self {
        Self::new(name.to_owned(), Vec::new(), false)
    }

    /// Number of frames at `fps`: one every 1/fps seconds from the first keyframe on, and one at the last keyframe.
    ///
    /// Where the clip lasts no whole number of frames, the last frame comes early: its pose is the clip's end, which a
    /// loop needs to close.
    pub fn frame_count(&self, fps: f64) -> u64 {
        // A saturating cast, so absurd times are caught by the frame limit.
        (((self.end - self.start) * fps - SAME_FRAME).ceil().max(0.0) as u64).saturating_add(1)
    }

    /// The time of frame `frame` in seconds.
    pub fn time(&self, frame: usize, fps: f64) -> f64 {
        if frame as u64 + 1 >= self.frame_count(fps) { self.end } else { self.start + frame as f64 / fps }
    }

    /// Applies the clip at the time of frame `frame` to the nodes at rest.
    pub fn apply_frame(&self, frame: usize, fps: f64, rest: &[Transform]) -> AnimatedNodes {
        self.apply(self.time(frame, fps), SAME_FRAME / fps, rest)
    }

    /// Applies the clip at `time` (seconds) to the nodes at rest; steps are taken up to `slack` seconds early.
    pub fn apply(&self, time: f64, slack: f64, rest: &[Transform]) -> AnimatedNodes {
        let mut nodes = AnimatedNodes { transforms: rest.to_vec(), weights: Vec::new() };
        for channel in &self.channels {
            let value = channel.sample(time, slack);
            let Some(transform) = nodes.transforms.get_mut(channel.node) else { continue };
            match (channel.property, value.as_slice()) {
                (Property::Translation, &[x, y, z]) => transform.translation = Vec3::new(x, y, z),
                (Property::Scale, &[x, y, z]) => transform.scale = Vec3::new(x, y, z),
                (Property::Rotation, &[x, y, z, w]) => transform.rotation = unit(Vec4::new(x, y, z, w)),
                (Property::Weights, _) => nodes.weights.push((channel.node, value)),
                (Property::Visible, &[shown]) => transform.visible = shown != 0.0,
                _ => {}
            }
            if matches!(channel.property, Property::Translation | Property::Scale | Property::Rotation) {
                transform.matrix = None;
            }
        }
        nodes
    }

    /// How many poses a second a clip jumps through that has nothing between its keyframes; `None` where all runs
    /// smoothly, or the jumps have no rate.
    pub fn key_rate(&self) -> Option<f64> {
        let jumps = |channel: &&Channel| {
            matches!(channel.interpolation, Interpolation::Step | Interpolation::Nearest)
                && (1..channel.times.len()).any(|key| channel.value(key) != channel.value(0))
        };
        let mut times: Vec<f64> = self
            .channels
            .iter()
            .filter(jumps)
            .flat_map(|channel| channel.times.iter().copied().map(f64::from))
            .collect();
        times.sort_by(f64::total_cmp);
        times.dedup_by(|later, earlier| *later - *earlier < 1e-3);
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let middle = *steps.get(steps.len() / 2)?;
        let even = times.len() > 2 && steps.iter().all(|step| (step / middle - (step / middle).round()).abs() < 0.02);
        // The mean of the whole is more exact than one step of numbers of 32 bits.
        let count: f64 = steps.iter().map(|step| (step / middle).round()).sum();
        even.then(|| count / (times[times.len() - 1] - times[0]))
    }
}
