//! Handles beyond the reach of a surface without bones: they stop where the surface would be drawn out.
//!
//! Nothing tells a surface how far its limbs reach: modes are blown up, and edges stretched, until its handles are where they are wanted. So a
//! surface that has come to rest is looked at. Where too much of it is drawn out, modes are first made rarer, up to next to none: they are no guide
//! so far from what was recorded. Where that does not do, its handles go less far, as far as it stays whole.

use glam::{Quat, Vec3};

use crate::carry::spread;
use crate::error::EditError;
use crate::grab::{By, Editor, Grab, HOLD};
use crate::pull::STRETCH;

/// A surface is whole where at most one edge in so many is longer than this, beside how long it was. Chosen on crane + jumping (`docs/results`):
/// edits within reach are below, recorded frames beside one another far above.
const ONE_IN: usize = 100;
const LONGEST: f32 = 1.35;
/// How close to that is close enough, and how often it is looked for.
const CLOSE: f32 = 0.05;
const TRIES: usize = 4;

/// By how much modes are made rarer at a time, and how often.
const RARER: f64 = 30.0;
const TIMES: i32 = 2;

/// How far handles may go: what was found so far.
#[derive(Clone, Debug)]
pub(crate) struct Drawn {
    /// Whether handles are wanted beyond what any surface reaches.
    pub(crate) is_far: bool,
    /// How often modes were made rarer.
    rarer: i32,
    /// No handle goes farther than this, in metres.
    cap: f32,
    /// The farthest cap at which the surface was whole, the nearest at which it was not, and how long its edges were there.
    low: (f32, f32),
    high: Option<(f32, f32)>,
    tries: usize,
}

impl Default for Drawn {
    fn default() -> Self {
        Self { is_far: false, rarer: 0, cap: f32::INFINITY, low: (0.0, 1.0), high: None, tries: 0 }
    }
}

impl Drawn {
    /// The weight of the modes' prior, which is `prior` where nothing is drawn out.
    pub(crate) fn prior(&self, prior: f64) -> f64 {
        prior * RARER.powi(self.rarer)
    }

    /// The next cap where edges are as long as `length` by the one that there is; nothing where that is as it is to be.
    fn next(&mut self, length: f32) -> Option<f32> {
        let is_whole = length <= LONGEST;
        let is_close = length > LONGEST * (1.0 - CLOSE);
        if is_whole && (self.high.is_none() || is_close || self.tries >= TRIES) {
            return None;
        }
        self.tries += 1;
        match is_whole {
            true => self.low = (self.cap, length),
            false => (self.high, self.is_far) = (Some((self.cap, length)), true),
        }
        let (low, (high, most)) = (self.low, self.high?);
        if self.tries > TRIES {
            // Enough: the last at which it was whole. What still is not, is as good as it gets.
            return (self.tries == TRIES + 1).then_some(low.0);
        }
        let share = (LONGEST * (1.0 - 0.5 * CLOSE) - low.1) / (most - low.1).max(1e-6);
        Some(low.0 + share.clamp(0.1, 0.9) * (high - low.0))
    }
}

impl Editor {
    /// Takes handles back where too much of a surface without bones is drawn out: whether it has to come to rest again.
    pub(crate) fn draw_in(&mut self, grab: &mut Grab) -> bool {
        if matches!(grab.by, By::Bones(_)) {
            return false;
        }
        let farthest = grab.asked.iter().map(|asked| asked.length()).fold(0.0, f32::max);
        grab.drawn.cap = grab.drawn.cap.min(farthest);
        let length = self.deformer.nearly_longest(&grab.pose, &grab.displacements, ONE_IN);
        if let (By::Modes { learned, .. }, true) = (&mut grab.by, length > LONGEST && grab.drawn.rarer < TIMES) {
            grab.drawn.rarer += 1;
            learned.set_prior(grab.drawn.prior(self.prior));
            return true;
        }
        let Some(cap) = grab.drawn.next(length) else { return false };
        grab.drawn.cap = cap;
        grab.wanted = grab.asked.iter().map(|asked| asked.clamp_length_max(cap)).collect();
        true
    }
}

/// How far from a handle what is around it is looked at, as a share of the body's size, and where that begins.
const RING: f32 = 0.03;
const INNER: f32 = 0.6;
/// A handle may be off from where what is around it would have it by this share of that distance.
const POINT: f32 = 0.2;
/// How often what it is off is spread.
const SPREADS: usize = 3;

impl Editor {
    /// Where handles are drawn out of a surface without bones to points, spreads that over what is near, as far as that stretches. Handles out of
    /// reach go back by what is left; others are where they are wanted.
    pub(crate) fn soften(&mut self, grab: &mut Grab) -> Result<(), EditError> {
        let count = grab.pose.len();
        let (turns, rest) = match &grab.by {
            By::Bones(_) => return Ok(()),
            By::Surface { turns, .. } => (turns.clone(), vec![Vec3::ZERO; count]),
            By::Modes { learned, .. } => (learned.turns().to_vec(), learned.rest().to_vec()),
        };
        let handles = grab.grip().handles.clone();
        let near: Vec<Vec<(u32, f32)>> =
            handles.iter().map(|&vertex| self.deformer.near(&grab.pose, vertex, HOLD * grab.size)).collect();
        let mut totals = vec![Vec3::ZERO; handles.len()];
        grab.drawn_out = Vec::new();
        for round in 0..=SPREADS {
            let off: Vec<Vec3> = handles.iter().map(|&handle| self.off(grab, handle, (&turns, &rest))).collect();
            if off.iter().all(|off| *off == Vec3::ZERO) {
                break;
            }
            for ((total, off), wanted) in totals.iter_mut().zip(off).zip(&mut grab.wanted) {
                let most = STRETCH * grab.size;
                let next = if round < SPREADS { (*total + off).clamp_length_max(most) } else { *total };
                if grab.drawn.is_far {
                    *wanted -= *total + off - next;
                }
                *total = next;
            }
            grab.drawn_out = spread(near.iter().map(Vec::as_slice), &totals, count);
            self.resolve(grab, (&turns, &rest))?;
        }
        Ok(())
    }

    /// How much too far the vertex `handle` is from where what is around it would have it.
    fn off(&self, grab: &Grab, handle: u32, (turns, rest): (&[Quat], &[Vec3])) -> Vec3 {
        let radius = RING * grab.size;
        let at = |vertex: usize| grab.pose[vertex] + rest[vertex];
        let drawn = |vertex: usize| grab.drawn_out.get(vertex).copied().unwrap_or_default();
        let now = |vertex: usize| grab.pose[vertex] + grab.displacements[vertex] - drawn(vertex);
        let (mut sum, mut count) = (Vec3::ZERO, 0.0_f32);
        let handle = handle as usize;
        for (vertex, distance) in self.deformer.distances(&grab.pose, &[handle as u32], radius).into_iter().enumerate()
        {
            if (INNER * radius..=radius).contains(&distance) {
                sum += now(vertex) + turns[vertex] * (at(handle) - at(vertex));
                count += 1.0;
            }
        }
        let off = if count > 0.0 { now(handle) - sum / count } else { Vec3::ZERO };
        off * (1.0 - POINT * radius / off.length().max(f32::MIN_POSITIVE)).max(0.0)
    }

    /// The surface for turns and modes as they are.
    fn resolve(&mut self, grab: &mut Grab, (turns, rest): (&[Quat], &[Vec3])) -> Result<(), EditError> {
        let by_modes: Vec<Vec3> = grab.pose.iter().zip(rest).map(|(&point, &rest)| point + rest).collect();
        let held = grab.held.vertices().iter().zip(grab.held_wanted());
        let left: Vec<Vec3> = held.map(|(&vertex, wanted)| wanted - rest[vertex as usize]).collect();
        let told = vec![Vec3::ZERO; rest.len()];
        let moved = self.deformer.solve_over(&grab.held, &by_modes, (turns, &told), &grab.drawn_out, &left)?;
        grab.displacements = moved.iter().zip(rest).map(|(&moved, &rest)| moved + rest).collect();
        Ok(())
    }
}
