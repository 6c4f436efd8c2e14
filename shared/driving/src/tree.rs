//! The tree of a clip's joints: its ends, the ways between joints, how long and how high they are.

use glam::Vec3;

use crate::clip::Clip;
use crate::hints;

/// Frames that heights are taken from.
const SAMPLES: usize = 200;

/// Shape of a skeleton.
pub struct Tree<'a> {
    clip: &'a Clip,
    /// Frames that are looked at.
    pub frames: Vec<usize>,
    /// Length from each joint to its parent, in metres.
    lengths: Vec<f32>,
    /// Mean height of each joint in metres.
    pub heights: Vec<f32>,
    /// Joints that nothing hangs on.
    pub ends: Vec<usize>,
    /// How large the skeleton is, in metres.
    pub size: f32,
}

impl<'a> Tree<'a> {
    /// The tree of `clip`.
    #[must_use]
    pub fn new(clip: &'a Clip) -> Self {
        let joints = clip.joints();
        let frames: Vec<usize> = (0..clip.len()).step_by(clip.len().div_ceil(SAMPLES)).collect();
        let mean = |of: &dyn Fn(&[Vec3]) -> f32| {
            frames.iter().map(|&frame| of(clip.positions(frame))).sum::<f32>() / frames.len() as f32
        };
        let length = |joint: usize| joints[joint].parent.map_or(0.0, |up| mean(&|at| at[joint].distance(at[up])));
        let lengths = (0..joints.len()).map(length).collect();
        let heights: Vec<f32> = (0..joints.len()).map(|joint| mean(&|at| at[joint].y)).collect();
        // Controls hang on joints and end nothing.
        let is_body: Vec<bool> = joints.iter().map(|joint| !hints::is_helper(&joint.name)).collect();
        let mut is_end = is_body.clone();
        for joint in (0..joints.len()).rev() {
            if let Some(parent) = joints[joint].parent.filter(|_| is_body[joint]) {
                is_end[parent] = false;
            }
        }
        let ends = (0..joints.len()).filter(|&joint| is_end[joint]).collect();
        Self { clip, frames, lengths, heights, ends, size: clip.height().max(1e-6) }
    }

    /// The clip.
    #[must_use]
    pub fn clip(&self) -> &'a Clip {
        self.clip
    }

    /// The name of a joint.
    #[must_use]
    pub fn name(&self, joint: usize) -> &'a str {
        &self.clip.joints()[joint].name
    }

    /// The joints on the way from `from` to `to`, both included; none where nothing joins them.
    #[must_use]
    pub fn way(&self, from: usize, to: usize) -> Vec<usize> {
        let (mut up, mut down) = (vec![from], vec![to]);
        let (mut a, mut b) = (from, to);
        // Parents come before their children, so that the later of two is never above the other.
        while a != b {
            let (side, at) = if a > b { (&mut up, &mut a) } else { (&mut down, &mut b) };
            let Some(parent) = self.clip.joints()[*at].parent else { return Vec::new() };
            *at = parent;
            side.push(parent);
        }
        down.pop();
        up.extend(down.into_iter().rev());
        up
    }

    /// The length of a way in metres.
    #[must_use]
    pub fn length(&self, way: &[usize]) -> f32 {
        way.windows(2).map(|pair| self.lengths[pair[0].max(pair[1])]).sum()
    }

    /// The joint at which the ways between three joints meet.
    #[must_use]
    pub fn fork(&self, a: usize, b: usize, c: usize) -> usize {
        let way = self.way(a, b);
        self.way(c, a).into_iter().find(|joint| way.contains(joint)).unwrap_or(a)
    }
}
