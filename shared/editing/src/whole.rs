//! A surface without bones is kept whole: handles out of its reach go back, and none is drawn out to a point.

use glam::{Quat, Vec3};

use crate::carry::spread;
use crate::drawn::{LONGEST, ONE_IN, TIMES};
use crate::error::EditError;
use crate::grab::{By, Editor, Grab, HOLD};
use crate::pull::STRETCH;

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
