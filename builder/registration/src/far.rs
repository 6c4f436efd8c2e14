//! Moving the template onto a frame whose pose is far from every one that is known: where closest points would pull a limb to the
//! nearest other one, area is transported as a whole, and the coarse deformation graph follows it, stiff at first.

use glam::Vec3;

use super::energy::{Pull, deform};
use super::graph::Motion;
use super::template::Template;
use super::track::{Target, TrackOptions, refine, track};
use super::transport::{Samples, Strictness, transport};

/// Samples of each surface.
const SAMPLES: usize = 1000;
/// Transports.
const ROUNDS: usize = 8;
/// Width of the cost of distance, metres on a person, entropy and stiffness: in the first round and in the last.
const WIDTHS: [f32; 2] = [0.3, 0.1];
const ENTROPIES: [f32; 2] = [0.1, 0.02];
const STIFFNESSES: [f32; 2] = [1.0, 0.1];
/// What goes less far than about this is free to slip along the surface, metres on a person: a skirt looks the same wherever it is
/// turned, and should turn with what it hangs on.
const SLIP: f32 = 0.05;
/// Colours count so many times more where they are to.
const COLOUR: f32 = 10.0;
/// Steps of the graph in a round.
const STEPS: usize = 3;

/// How a pose is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// By closest points alone, for frames that follow each other.
    Near,
    /// By transport, which only comes near.
    Approach,
    /// By closest points, the finer ones, from what has come near.
    Refine,
    /// The same, where colours count more: folds of cloth, which are not where they were, pull less then.
    Coloured,
}

impl Manner {
    /// The template's pose on `target`, from the pose `near`, turned and moved to where the target is; it is held against `start`.
    #[must_use]
    pub fn track(
        self,
        template: &Template,
        (start, near): (&[Vec3], &[Vec3]),
        target: &Target,
        options: &TrackOptions,
    ) -> Vec<Vec3> {
        let coloured = TrackOptions { colour: COLOUR * options.colour };
        match self {
            Self::Near => track(template, start, target, options),
            Self::Approach => approach(template, start, target, options),
            Self::Refine => refine(template, (start, near), target, options),
            Self::Coloured => refine(template, (start, near), target, &coloured),
        }
    }
}

/// A pose near that of `target`, from `start`, turned and moved to where the target is.
#[must_use]
pub fn approach(template: &Template, start: &[Vec3], target: &Target, options: &TrackOptions) -> Vec<Vec3> {
    let level = &template.levels[0];
    let of = Samples::new(&template.surface, SAMPLES);
    let on = Samples::new(&target.surface, SAMPLES);
    let mut moving = template.surface.posed(start.to_vec());
    let mut motions = vec![Motion::NONE; level.graph.nodes.len()];
    for round in 0..ROUNDS {
        let share = round as f32 / (ROUNDS - 1) as f32;
        let between = |[first, last]: [f32; 2]| first * (last / first).powf(share);
        let strictness =
            Strictness { width: between(WIDTHS) * template.scale, entropy: between(ENTROPIES), colour: options.colour };
        let found = transport((&moving, &of), (&target.surface, &on), &strictness);
        for _ in 0..STEPS {
            let mut pulls = vec![Pull::NONE; start.len()];
            for (&vertex, to) in of.vertices.iter().zip(&found) {
                let off = moving.mesh.positions[vertex as usize] - to.place;
                let slip = SLIP * template.scale;
                let held = off.length_squared() / (off.length_squared() + slip * slip);
                let normal = moving.normals[vertex as usize];
                let pull = &mut pulls[vertex as usize];
                pull.add_point(to.mass * held, off);
                pull.add(to.mass * (1.0 - held), normal, normal.dot(off));
            }
            let (kept, stiffness) = (motions.clone(), f64::from(between(STIFFNESSES)));
            if level.system.step(&level.graph, start, &pulls, stiffness, &mut motions).is_none() {
                motions = kept;
                break;
            }
            moving.pose(&deform(&level.graph, start, &motions));
        }
    }
    moving.mesh.positions
}

#[cfg(test)]
mod tests {
    use geometry::polygonise::polygonise;

    use super::*;
    use crate::checks::{Fault, Limits, fit};
    use crate::surface::Surface;

    /// A trunk with two arms, of which one ends at `hand`.
    fn body(hand: Vec3, cell: f32) -> Surface {
        let bone = |p: Vec3, a: Vec3, b: Vec3, radius: f32| {
            let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance(a + (b - a) * share) - radius
        };
        let distance = |p: Vec3| {
            let trunk = bone(p, Vec3::new(0.0, 0.2, 0.0), Vec3::new(0.0, 1.5, 0.0), 0.2);
            let arm = bone(p, Vec3::new(0.2, 1.5, 0.0), hand, 0.07);
            let other = bone(p, Vec3::new(-0.2, 1.5, 0.0), Vec3::new(-0.7, 1.1, 0.3), 0.07);
            trunk.min(arm).min(other)
        };
        Surface::new(polygonise(Vec3::new(-1.2, -0.4, -1.0), Vec3::new(1.3, 2.6, 1.0), cell, distance), None)
    }

    #[test]
    fn an_arm_that_was_raised_is_found() {
        let down = Vec3::new(0.55, 0.85, 0.0);
        let template = Template::new(body(down, 0.045)).unwrap();
        let start = template.surface.mesh.positions.clone();
        let target = Target::new(body(Vec3::new(0.75, 2.0, 0.0), 0.04), template.scale);
        let fault = |manner: Manner| {
            let options = TrackOptions::default();
            let mut pose = manner.track(&template, (&start, &start), &target, &options);
            if manner == Manner::Approach {
                pose = Manner::Refine.track(&template, (&start, &pose), &target, &options);
                pose = Manner::Refine.track(&template, (&pose, &pose), &target, &options);
            }
            let found = fit(&template, &template.surface.posed(pose), &start, &target.surface);
            found.fault(&Limits::default(), template.scale)
        };
        assert_eq!(fault(Manner::Near), Some(Fault::Uncovered));
        assert_eq!(fault(Manner::Approach), None);
    }
}
