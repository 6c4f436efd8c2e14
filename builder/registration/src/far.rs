//! Moving the template onto a frame whose pose is far from every one that is known: where closest points would pull a limb to the
//! nearest other one, area is transported as a whole, and the coarse deformation graph follows it, stiff at first.

use glam::Vec3;

use super::energy::{Pull, deform};
use super::graph::Motion;
use super::template::Template;
use super::track::{Target, TrackOptions, track, track_on};
use super::transport::{Samples, Strictness, transport};

/// How a far frame is approached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Samples of each surface.
    pub samples: usize,
    /// Transports.
    pub rounds: usize,
    /// Width of the cost of distance, metres on a person, entropy and stiffness: in the first round and in the last.
    pub widths: [f32; 2],
    /// As above.
    pub entropies: [f32; 2],
    /// As above.
    pub stiffnesses: [f64; 2],
}

impl Default for Approach {
    fn default() -> Self {
        Self { samples: 1000, rounds: 8, widths: [0.3, 0.1], entropies: [0.1, 0.02], stiffnesses: [1.0, 0.1] }
    }
}

/// Steps of the graph in a round.
const STEPS: usize = 3;

/// The template's pose on `target`, which is far from `start`.
#[must_use]
pub fn track_far(template: &Template, start: &[Vec3], target: &Target, options: &TrackOptions) -> Vec<Vec3> {
    let near = approach(template, start, target, options, &Approach::default());
    let pose = track_on(template, (start, &near), target, options);
    // Once more, held against what was found: what was far from the start may bend now.
    track(template, &pose, target, options)
}

/// A pose near that of `target`, from `start`, turned and moved to where the target is.
#[must_use]
pub fn approach(
    template: &Template,
    start: &[Vec3],
    target: &Target,
    options: &TrackOptions,
    how: &Approach,
) -> Vec<Vec3> {
    let level = &template.levels[0];
    let mut moving = template.surface.posed(start.to_vec());
    let of = Samples::new(&template.surface, how.samples);
    let on = Samples::new(&target.surface, how.samples);
    let mut motions = vec![Motion::NONE; level.graph.nodes.len()];
    for round in 0..how.rounds {
        let share = round as f32 / (how.rounds.max(2) - 1) as f32;
        let between = |[first, last]: [f32; 2]| first * (last / first).powf(share);
        let strictness = Strictness {
            width: between(how.widths) * template.scale,
            entropy: between(how.entropies),
            colour: options.colour,
        };
        let stiffness = between(how.stiffnesses.map(|s| s as f32));
        let found = transport((&moving, &of), (&target.surface, &on), &strictness);
        for _ in 0..STEPS {
            let mut pulls = vec![Pull::NONE; start.len()];
            for (&vertex, to) in of.vertices.iter().zip(&found) {
                pulls[vertex as usize].add_point(to.mass, moving.mesh.positions[vertex as usize] - to.place);
            }
            let kept = motions.clone();
            if level.system.step(&level.graph, start, &pulls, f64::from(stiffness), &mut motions).is_none() {
                motions = kept;
                break;
            }
            moving.pose(&deform(&level.graph, start, &motions));
        }
    }
    moving.mesh.positions
}
