//! When each foot goes from where the source has it to where the destination has it: its step.
//!
//! Not in the papers. Before its step a foot is where the source, played on alone, would have it; after it, where the
//! destination has it. So what stands there stays. A step is best where the foot is in the air on both sides; where it stands on
//! both all the time, it has to be taken nevertheless, not too fast, near the middle of the blend, and best while another
//! foot bears.

use actor::feet::Feet;
use actor::graph::Transition;
use actor::temporal_warp::{PLACES_A_FRAME, Pace, ease};
use actor::timeline::Timeline;

/// The shortest step in seconds; shorter transitions are one step.
const SHORTEST: f32 = 0.2;
/// The longest step, in shortest ones.
const LONGEST: usize = 3;
/// The part of its step for which a foot that stood is only lifted, and for which one that will stand is only put down.
const RAISED: f32 = 0.3;
/// What a step as short as can be costs, against one that slides all along, which costs 1.
const HASTE: f32 = 0.15;
/// What a step costs that is all the time on another side than the blend.
const APART: f32 = 0.5;
/// What a step costs while nothing else bears.
const FALLS: f32 = 0.3;

/// The step of one foot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootStep {
    /// The node at which it begins.
    pub begin: usize,
    /// Nodes that it takes.
    pub width: usize,
    /// How much of it the foot stands on the side that it leaves and on the one that it comes to, each from 0 to 1/2: then it has
    /// to be lifted.
    pub stands: [f32; 2],
    /// How much of it no other foot bears, from 0 to 1: what is lifted then is the whole body.
    pub alone: f32,
}

impl FootStep {
    /// How far the step is at a node, from 0 to 1.
    #[must_use]
    pub fn progress(&self, node: usize) -> f32 {
        ((node as f32 - self.begin as f32) / self.width.max(1) as f32).clamp(0.0, 1.0)
    }

    /// Weight of the destination at a node, from 0 to 1. What stands is lifted before it goes, and is there before it is
    /// put down.
    #[must_use]
    pub fn weight(&self, node: usize) -> f32 {
        let [leaving, coming] = self.stands.map(|stands| RAISED * (4.0 * stands).min(1.0));
        ease(((self.progress(node) - leaving) / (1.0 - leaving - coming)).clamp(0.0, 1.0))
    }

    /// How much of it nothing else bears, from 0 to 1, where the others bear so much at each node.
    fn unborne(&self, bears: &[f32]) -> f32 {
        let moves = |(node, bears): (usize, &f32)| (self.weight(node + 1) - self.weight(node)) * (1.0 - bears);
        bears.iter().enumerate().map(moves).sum()
    }

    /// How far it is lifted in its middle, from 0 to 1: fully where it stands for half of its step.
    #[must_use]
    pub fn lifted(&self) -> f32 {
        (2.0 * (self.stands[0] + self.stands[1])).min(1.0)
    }
}

/// The steps of all feet in a transition; `None` for a foot that stands on neither side.
#[must_use]
pub fn foot_steps(feet: &Feet, timeline: &Timeline, transition: &Transition) -> Vec<Option<FootStep>> {
    let standing: Vec<[Vec<f32>; 2]> =
        (0..feet.count()).map(|foot| [0, 1].map(|side| stands(feet, timeline, transition, foot, side))).collect();
    steps_of_standing(&standing, timeline.fps())
}

/// The same where it is known how firmly each foot stands at each node of the source and of the destination.
#[must_use]
pub fn steps_of_standing(standing: &[[Vec<f32>; 2]], fps: f32) -> Vec<Option<FootStep>> {
    let last = standing.first().map_or(0, |sides| sides[0].len().saturating_sub(1));
    let shortest = ((SHORTEST * fps).round() as usize).clamp(1, last.max(1));
    let feet: Vec<usize> =
        (0..standing.len()).filter(|&foot| standing[foot].iter().flatten().any(|&stands| stands > 0.0)).collect();
    let mut steps = chosen(standing, &feet, None, shortest);
    if feet.len() > 1 {
        // Feet that go at the same time may be the best that each can do beside the other, though one after the other is better: so
        // what comes of it is looked at, too, where the first goes as early as it can, and as late.
        let mut least = all_cost(standing, &steps, shortest);
        for begin in [0, last.saturating_sub(shortest)] {
            let first = FootStep { begin, width: shortest, ..FootStep::default() };
            let other = chosen(standing, &feet, Some(first), shortest);
            let cost = all_cost(standing, &other, shortest);
            if cost < least {
                (steps, least) = (other, cost);
            }
        }
    }
    let alone = |(foot, step): (usize, &Option<FootStep>)| {
        let step = (*step)?;
        Some(FootStep { alone: step.unborne(&all_bearing(foot, standing, &steps)), ..step })
    };
    steps.iter().enumerate().map(alone).collect()
}

/// The steps of `feet`, each the best beside those of the others; `first` is where that of the first of them begins to be looked for.
fn chosen(
    standing: &[[Vec<f32>; 2]],
    feet: &[usize],
    first: Option<FootStep>,
    shortest: usize,
) -> Vec<Option<FootStep>> {
    let mut steps: Vec<Option<FootStep>> = vec![None; standing.len()];
    let mut open = feet;
    if let (Some((&foot, others)), Some(step)) = (feet.split_first(), first) {
        let (_, stands) = cost(&step, &standing[foot], &[], shortest);
        steps[foot] = Some(FootStep { stands, ..step });
        open = others;
    }
    // The first ones are chosen before those of the others are known; so all are chosen once more.
    for &foot in open.iter().chain(feet) {
        steps[foot] = Some(best(foot, standing, &steps, shortest));
    }
    steps
}

/// What the steps of all feet cost.
fn all_cost(standing: &[[Vec<f32>; 2]], steps: &[Option<FootStep>], shortest: usize) -> f32 {
    let cost = |(foot, step): (usize, &Option<FootStep>)| {
        step.map_or(0.0, |step| cost(&step, &standing[foot], &all_bearing(foot, standing, steps), shortest).0)
    };
    steps.iter().enumerate().map(cost).sum()
}

/// The step of `foot` beside those of the other feet, as far as they are chosen; `shortest` is the shortest one's width.
fn best(foot: usize, standing: &[[Vec<f32>; 2]], steps: &[Option<FootStep>], shortest: usize) -> FootStep {
    let sides = &standing[foot];
    let last = sides[0].len().saturating_sub(1);
    let bears = all_bearing(foot, standing, steps);
    let (mut found, mut least) = (FootStep { width: last, ..FootStep::default() }, f32::INFINITY);
    // Halves of the shortest step from one width to the next.
    for halves in 2..=2 * LONGEST {
        let width = (shortest * halves / 2).min(last);
        for begin in 0..=last - width {
            let step = FootStep { begin, width, ..FootStep::default() };
            let (cost, stands) = cost(&step, sides, &bears, shortest);
            if cost < least {
                (found, least) = (FootStep { stands, ..step }, cost);
            }
        }
        if width == last {
            break;
        }
    }
    found
}

/// What a step costs of a foot that stands so on both `sides`, and [`FootStep::stands`]. The step's own is not looked at: it would not be the same
/// step otherwise.
fn cost(step: &FootStep, sides: &[Vec<f32>; 2], bears: &[f32], shortest: usize) -> (f32, [f32; 2]) {
    let step = FootStep { stands: [0.0; 2], ..*step };
    let last = sides[0].len().saturating_sub(1);
    let (mut stands, mut apart) = ([0.0; 2], 0.0);
    for node in 0..last {
        let (here, next) = (step.weight(node), step.weight(node + 1));
        let middle = (here + next) / 2.0;
        let firm = |side: usize| (sides[side][node] + sides[side][node + 1]) / 2.0;
        stands[0] += (next - here) * (1.0 - middle) * firm(0);
        stands[1] += (next - here) * middle * firm(1);
        let blend = ease((node as f32 + 0.5) / last as f32);
        apart += (middle - blend) * (middle - blend) / last as f32;
    }
    let haste = HASTE * shortest as f32 / step.width.max(1) as f32;
    // It goes only once it is lifted.
    let unborne = FootStep { stands, ..step }.unborne(bears);
    ((stands[0] + stands[1]) * (1.0 + FALLS * unborne) + haste + APART * apart, stands)
}

/// How firmly the firmest of the other feet stands from each node to the next one.
fn all_bearing(foot: usize, standing: &[[Vec<f32>; 2]], steps: &[Option<FootStep>]) -> Vec<f32> {
    (0..standing[foot][0].len()).map(|node| bearing(foot, standing, steps, node)).collect()
}

/// How firmly the firmest of the other feet stands from a node to the next one; all bear as long as none is chosen.
fn bearing(foot: usize, standing: &[[Vec<f32>; 2]], steps: &[Option<FootStep>], node: usize) -> f32 {
    if standing.len() > 1 && steps.iter().all(Option::is_none) {
        return 1.0;
    }
    let mut most = 0.0_f32;
    for (other, (sides, step)) in standing.iter().zip(steps).enumerate() {
        let Some(step) = step.filter(|_| other != foot) else { continue };
        let weight = step.weight(node);
        let moves = step.weight(node + 1) - weight;
        let stands = (1.0 - weight) * sides[0][node] + weight * sides[1][node];
        most = most.max(if moves > 0.0 { 0.0 } else { stands });
    }
    most
}

/// How firmly a foot stands on one side at each node: between frames, as much as both are near.
fn stands(feet: &Feet, timeline: &Timeline, transition: &Transition, foot: usize, side: usize) -> Vec<f32> {
    let warp = &transition.warp;
    let pace = Pace::of(warp, side, timeline.fps());
    let first = match side {
        0 => Some(transition.from),
        _ => timeline.offset(transition.to, 1 - warp.lengths().1 as i64),
    };
    let node = |node: usize| -> Option<f32> {
        let place = pace.place(warp, side, node);
        let frame = timeline.offset(first?, i64::from(place / PLACES_A_FRAME))?;
        let share = (place % PLACES_A_FRAME) as f32 / PLACES_A_FRAME as f32;
        let of = |frame: u32| f32::from(u8::from(feet.stands(frame, foot)));
        let next = if share > 0.0 { of(timeline.next(frame)?) } else { 0.0 };
        Some(of(frame) * (1.0 - share) + next * share)
    };
    (0..warp.duration()).map(|index| node(index).unwrap_or(0.0)).collect()
}
