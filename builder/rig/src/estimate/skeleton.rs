//! A skeleton over the parts of a surface: which parts make a bone, and how bones hang together.

use glam::Vec3;

use super::clusters::Clusters;
use super::joints::Joint;

/// A bone that will be.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Its name.
    pub name: String,
    /// Index of its parent, before it; itself for the first one.
    pub parent: usize,
    /// Where it meets its parent, in the rest pose; of the first one its middle.
    pub joint: Vec3,
    /// How far both disagree on that, in metres.
    pub gap: f32,
    /// Its limb; 0 is the trunk.
    pub limb: u32,
    /// The parts whose motion is its motion.
    pub core: Vec<usize>,
}

/// Segments, and the one that each part belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// Parents first.
    pub segments: Vec<Segment>,
    /// By part.
    pub of_part: Vec<usize>,
    /// Whether it was taken for that of a human, and its bones named so.
    pub is_human: bool,
}

impl Skeleton {
    /// A skeleton of these segments; parts that belong to none go to the nearest one in `tree`.
    #[must_use]
    pub fn new(segments: Vec<Segment>, tree: &[Joint], parts: usize, is_human: bool) -> Self {
        let mut of_part = vec![usize::MAX; parts];
        for (index, segment) in segments.iter().enumerate() {
            segment.core.iter().for_each(|&part| of_part[part] = index);
        }
        loop {
            let mut reached = Vec::new();
            for joint in tree {
                let [a, b] = joint.parts;
                match (of_part[a], of_part[b]) {
                    (usize::MAX, usize::MAX) => {}
                    (usize::MAX, own) => reached.push((a, own, joint.gap)),
                    (own, usize::MAX) => reached.push((b, own, joint.gap)),
                    _ => {}
                }
            }
            if reached.is_empty() {
                break;
            }
            // In a tree a part can be reached from one side at a time only, but from two sides in one round.
            reached.sort_by(|a, b| a.2.total_cmp(&b.2).then(a.0.cmp(&b.0)));
            for (part, own, _) in reached {
                if of_part[part] == usize::MAX {
                    of_part[part] = own;
                }
            }
        }
        of_part.iter_mut().filter(|own| **own == usize::MAX).for_each(|own| *own = 0);
        Self { segments, of_part, is_human }
    }

    /// Segments at most `steps` joints away from `segment`, itself included.
    #[must_use]
    pub fn near(&self, segment: usize, steps: usize) -> Vec<usize> {
        let mut near = vec![segment];
        for _ in 0..steps {
            for index in 1..self.segments.len() {
                let parent = self.segments[index].parent;
                let (has, has_parent) = (near.contains(&index), near.contains(&parent));
                if has && !has_parent {
                    near.push(parent);
                }
            }
            let before = near.clone();
            for index in 1..self.segments.len() {
                if before.contains(&self.segments[index].parent) && !near.contains(&index) {
                    near.push(index);
                }
            }
        }
        near
    }
}

/// A skeleton of all parts but loose ones at the ends, hair and cloth, whose joints gape wider than `loosest` metres; parts
/// in `ends` are kept. The root is the part `middle`, or the nearest one that is left.
#[must_use]
pub fn plain(
    clusters: &Clusters,
    tree: &[Joint],
    rest: &[Vec3],
    middle: usize,
    ends: &[usize],
    loosest: f32,
) -> Skeleton {
    let parts = clusters.motions.len();
    let mut left: Vec<Joint> = tree.to_vec();
    let mut is_left = vec![true; parts];
    loop {
        let count = |part: usize| left.iter().filter(|joint| joint.parts.contains(&part)).count();
        let loose = |part: usize| part != middle && !ends.contains(&part) && count(part) == 1;
        let found = left.iter().position(|joint| joint.gap > loosest && joint.parts.iter().any(|&part| loose(part)));
        let Some(at) = found else { break };
        let part = if loose(left[at].parts[0]) { left[at].parts[0] } else { left[at].parts[1] };
        is_left[part] = false;
        left.remove(at);
    }
    let members = clusters.members();
    let centre =
        |part: usize| members[part].iter().map(|&v| rest[v as usize]).sum::<Vec3>() / members[part].len().max(1) as f32;
    let mut segments =
        vec![Segment { name: "root".into(), parent: 0, joint: centre(middle), gap: 0.0, limb: 0, core: vec![middle] }];
    let mut next = 0;
    while next < segments.len() {
        let own = segments[next].core[0];
        for joint in &left {
            let other = match joint.parts {
                [a, b] if a == own => b,
                [a, b] if b == own => a,
                _ => continue,
            };
            if segments.iter().any(|segment| segment.core[0] == other) {
                continue;
            }
            let limb =
                if next == 0 { segments.iter().map(|s| s.limb).max().unwrap_or(0) + 1 } else { segments[next].limb };
            let name = format!("bone_{}", segments.len());
            segments.push(Segment { name, parent: next, joint: joint.place, gap: joint.gap, limb, core: vec![other] });
        }
        next += 1;
    }
    debug_assert_eq!(segments.len(), is_left.iter().filter(|left| **left).count());
    Skeleton::new(segments, tree, parts, false)
}
