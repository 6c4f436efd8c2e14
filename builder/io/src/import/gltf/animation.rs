//! Animation clips: channels of keyframes, sampled at any time.

use std::collections::HashSet;

use glam::{Quat, Vec3, Vec4};
use gltf::json::animation::{Animation, Interpolation, Property};
use gltf::json::validation::Checked;

use super::super::warning::Warning;
use super::document::Document;
use super::nodes::Transform;
use crate::import::error::ImportError;

/// One clip.
pub(super) struct Clip {
    /// Its name.
    pub name: String,
    /// Time of the first keyframe in seconds.
    pub start: f64,
    /// Time of the last keyframe in seconds.
    pub end: f64,
    channels: Vec<Channel>,
}

struct Channel {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    /// Times of the keyframes in seconds, ascending; not empty.
    times: Vec<f32>,
    /// `width` numbers a keyframe; three times as many for cubic splines (in-tangent, value, out-tangent).
    values: Vec<f32>,
    width: usize,
}

/// What a clip says about the nodes at one time.
pub(super) struct AnimatedNodes {
    /// Local transforms of all nodes.
    pub transforms: Vec<Transform>,
    /// Morph weights of the nodes that a channel drives.
    pub weights: Vec<(usize, Vec<f32>)>,
}

/// All clips of `document`; `stem` names what has no name. Sentences for the user go to `warnings`.
pub(super) fn clips(document: &Document, stem: &str, warnings: &mut Vec<Warning>) -> Result<Vec<Clip>, ImportError> {
    let animations = &document.root().animations;
    if animations.is_empty() {
        return Ok(vec![Clip { name: stem.to_owned(), start: 0.0, end: 0.0, channels: Vec::new() }]);
    }
    if belong_together(animations) {
        warnings.push(Warning::new(
            "W_GLTF_CLIPS_JOINED",
            format!(
                "{}: {} unnamed animations move a node each: they are read as one clip, \"{stem}\"",
                document.path().display(),
                animations.len()
            ),
        ));
        let mut channels = Vec::new();
        for index in 0..animations.len() {
            channels.extend(read_channels(document, index, warnings)?);
        }
        return Ok(vec![Clip::new(stem.to_owned(), channels)]);
    }
    let mut clips = Vec::new();
    for (index, animation) in animations.iter().enumerate() {
        let name = animation.name.clone().filter(|name| !name.is_empty());
        let alone = animations.len() == 1;
        let name = name.unwrap_or_else(|| if alone { stem.to_owned() } else { format!("{stem} {index}") });
        clips.push(Clip::new(name, read_channels(document, index, warnings)?));
    }
    Ok(clips)
}

/// Whether several animations are the pieces of one clip: none has a name, and no two move the same thing.
fn belong_together(animations: &[Animation]) -> bool {
    let unnamed = animations.iter().all(|a| a.name.as_ref().is_none_or(String::is_empty));
    let mut moved = HashSet::new();
    let targets = animations.iter().flat_map(|a| &a.channels).filter_map(|c| match c.target.path {
        Checked::Valid(property) => Some((c.target.node.value(), property as u8)),
        Checked::Invalid => None,
    });
    animations.len() > 1 && unnamed && targets.into_iter().all(|target| moved.insert(target))
}

fn read_channels(document: &Document, index: usize, warnings: &mut Vec<Warning>) -> Result<Vec<Channel>, ImportError> {
    let Some(animation) = document.root().animations.get(index) else { return Ok(Vec::new()) };
    let mut channels = Vec::new();
    for (k, channel) in animation.channels.iter().enumerate() {
        let user = format!("animation {index}, channel {k}");
        let Checked::Valid(property) = channel.target.path else {
            warnings.push(Warning::new(
                "W_GLTF_CHANNEL",
                format!("{}: {user} moves something unknown and is left out", document.path().display()),
            ));
            continue;
        };
        document.get(channel.target.node, "node", &user)?;
        let sampler = animation.samplers.get(channel.sampler.value());
        let sampler = sampler.ok_or_else(|| document.wrong(format!("{user} names a sampler that does not exist")))?;
        let Checked::Valid(interpolation) = sampler.interpolation else {
            return Err(document.wrong(format!("{user} has an unknown interpolation")));
        };
        let times: Vec<f32> = document.floats::<1>(sampler.input, &user)?.into_iter().flatten().collect();
        if times.is_empty() || !times.is_sorted() || times.iter().any(|t| !t.is_finite()) {
            return Err(document.wrong(format!("{user}: the keyframe times are missing or not ascending")));
        }
        let values: Vec<f32> = match property {
            Property::Translation | Property::Scale => flat(document.floats::<3>(sampler.output, &user)?),
            Property::Rotation => flat(document.floats::<4>(sampler.output, &user)?),
            Property::MorphTargetWeights => flat(document.floats::<1>(sampler.output, &user)?),
        };
        let points = times.len() * if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let width = values.len() / points;
        let fits = match property {
            Property::Translation | Property::Scale => width == 3,
            Property::Rotation => width == 4,
            Property::MorphTargetWeights => width > 0,
        };
        if !fits || values.len() != width * points {
            return Err(document.wrong(format!("{user}: {} times but {} numbers", times.len(), values.len())));
        }
        let node = channel.target.node.value();
        channels.push(Channel { node, property, interpolation, times, values, width });
    }
    Ok(channels)
}

fn flat<const N: usize>(values: Vec<[f32; N]>) -> Vec<f32> {
    values.into_iter().flatten().collect()
}

impl Clip {
    fn new(name: String, channels: Vec<Channel>) -> Self {
        let ends = channels.iter().filter_map(|c| Some((*c.times.first()?, *c.times.last()?)));
        let (start, end) = ends.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), (c, d)| (a.min(c), b.max(d)));
        let (start, end) = if start <= end { (f64::from(start), f64::from(end)) } else { (0.0, 0.0) };
        Self { name, start, end, channels }
    }

    /// Number of frames at `fps`: one at the first keyframe, and one every 1/fps seconds to the last.
    pub fn frame_count(&self, fps: f64) -> u64 {
        // A thousandth of a frame of rounding; a saturating cast, so absurd times are caught by the frame limit.
        (((self.end - self.start) * fps + 1e-3).floor().max(0.0) as u64).saturating_add(1)
    }

    /// Applies the clip at `time` (seconds) to the nodes at rest.
    pub fn apply(&self, time: f64, rest: &[Transform]) -> AnimatedNodes {
        let mut nodes = AnimatedNodes { transforms: rest.to_vec(), weights: Vec::new() };
        for channel in &self.channels {
            let value = channel.sample(time as f32);
            let Some(transform) = nodes.transforms.get_mut(channel.node) else { continue };
            match (channel.property, value.as_slice()) {
                (Property::Translation, &[x, y, z]) => transform.translation = Vec3::new(x, y, z),
                (Property::Scale, &[x, y, z]) => transform.scale = Vec3::new(x, y, z),
                (Property::Rotation, &[x, y, z, w]) => transform.rotation = unit(Vec4::new(x, y, z, w)),
                (Property::MorphTargetWeights, _) => nodes.weights.push((channel.node, value)),
                _ => {}
            }
        }
        nodes
    }
}

impl Channel {
    /// The value at `time`; before the first and after the last keyframe it holds still.
    fn sample(&self, time: f32) -> Vec<f32> {
        let next = self.times.partition_point(|&t| t <= time);
        let (last, cubic) = (self.times.len() - 1, self.interpolation == Interpolation::CubicSpline);
        let value = |key: usize| if cubic { self.point(3 * key + 1) } else { self.point(key) };
        if next == 0 {
            return value(0).to_vec();
        }
        if next > last || self.interpolation == Interpolation::Step {
            return value(next - 1).to_vec();
        }
        let (from, to) = (next - 1, next);
        let length = self.times[to] - self.times[from];
        let s = (time - self.times[from]) / length;
        if cubic {
            let tangents = (self.point(3 * from + 2), self.point(3 * to));
            return hermite(value(from), tangents.0, value(to), tangents.1, s, length);
        }
        if self.property == Property::Rotation {
            return unit(vec4(value(from))).slerp(unit(vec4(value(to))), s).to_array().to_vec();
        }
        value(from).iter().zip(value(to)).map(|(a, b)| a + (b - a) * s).collect()
    }

    fn point(&self, k: usize) -> &[f32] {
        &self.values[k * self.width..(k + 1) * self.width]
    }
}

/// The cubic spline of the glTF specification, appendix C.5: `s` from 0 to 1, tangents per second.
fn hermite(p0: &[f32], m0: &[f32], p1: &[f32], m1: &[f32], s: f32, length: f32) -> Vec<f32> {
    let (s2, s3) = (s * s, s * s * s);
    let (a, b, c, d) =
        (2.0 * s3 - 3.0 * s2 + 1.0, length * (s3 - 2.0 * s2 + s), -2.0 * s3 + 3.0 * s2, length * (s3 - s2));
    (0..p0.len()).map(|k| a * p0[k] + b * m0[k] + c * p1[k] + d * m1[k]).collect()
}

fn vec4(v: &[f32]) -> Vec4 {
    match *v {
        [x, y, z, w] => Vec4::new(x, y, z, w),
        _ => Vec4::W,
    }
}

/// The rotation that `v` points to; none where it points nowhere.
pub(super) fn unit(v: Vec4) -> Quat {
    Quat::from_vec4(v.try_normalize().unwrap_or(Vec4::W))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(interpolation: Interpolation, property: Property, values: Vec<f32>, width: usize) -> Channel {
        Channel { node: 0, property, interpolation, times: vec![1.0, 2.0, 4.0], values, width }
    }

    #[test]
    fn steps_hold_and_lines_run() {
        let step = channel(Interpolation::Step, Property::MorphTargetWeights, vec![1.0, 2.0, 3.0], 1);
        let line = channel(Interpolation::Linear, Property::MorphTargetWeights, vec![1.0, 2.0, 3.0], 1);
        for (time, stepped, linear) in
            [(0.0, 1.0, 1.0), (1.5, 1.0, 1.5), (2.0, 2.0, 2.0), (3.0, 2.0, 2.5), (9.0, 3.0, 3.0)]
        {
            assert_eq!(step.sample(time), [stepped]);
            assert_eq!(line.sample(time), [linear]);
        }
    }

    #[test]
    fn rotations_take_the_short_way_at_even_speed() {
        let a = Quat::from_rotation_y(0.2);
        let b = -Quat::from_rotation_y(1.0);
        let values = [a, b, b].iter().flat_map(|q| q.to_array()).collect();
        let found = channel(Interpolation::Linear, Property::Rotation, values, 4).sample(1.25);
        let expected = Quat::from_rotation_y(0.4);
        assert!(vec4(&found).dot(Vec4::from(expected)).abs() > 1.0 - 1e-6);
    }

    #[test]
    fn cubic_splines_reproduce_a_cubic() {
        let (f, slope) = (|t: f32| t * t * t - 2.0 * t, |t: f32| 3.0 * t * t - 2.0);
        let values = [1.0, 2.0, 4.0].iter().flat_map(|&t| [slope(t), f(t), slope(t)]).collect();
        let cubic = channel(Interpolation::CubicSpline, Property::MorphTargetWeights, values, 1);
        for k in 0..=30 {
            let time = 1.0 + 0.1 * k as f32;
            assert!((cubic.sample(time)[0] - f(time)).abs() < 1e-4, "{time}");
        }
    }
}
