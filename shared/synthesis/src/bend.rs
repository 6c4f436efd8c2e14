//! Walks that are bent ([`actor::walk::Walk::bend`]): finished frames are put elsewhere, and feet stand meanwhile.
//!
//! Not in the papers. Frames are made as if nothing was bent, and then put where the bend has them. A foot that stands is put
//! where the bend had it in the middle of its stance, all the time, and the leg follows as it does in transitions
//! ([`actor::feet`]); between two stances it goes from one to the other while it is in the air.

use actor::blend::ease;
use actor::feet::{Feet, FootVertex};
use actor::graph::EssentialGraph;
use actor::timeline::Timeline;
use actor::walk::Leg;
use glam::{Vec2, Vec3};
use kernels::align::Placement;

use crate::lean::{lean, share};
use crate::steps::foot_steps;
use crate::walker::{Step, Walker};

/// Seconds for which a foot still touches the ground before and after it is said to stand.
const TOUCHES: f32 = 0.06;
/// Seconds for which a foot that stands may be said not to.
const FLICKER: f32 = 0.08;

/// Where frames are put from where the legs alone lead.
pub(crate) struct Bending {
    /// In the frame shown, and after each step from there on; beyond the last one as that one. Never empty.
    ahead: Vec<Placement>,
    /// Steps taken since.
    taken: usize,
    feet: Vec<Foot>,
}

/// A foot on a walk that is bent.
#[derive(Default)]
struct Foot {
    /// Its stances: first and last step, and where it stands.
    stances: Vec<(usize, usize, Placement)>,
    /// Where it is put in the frame shown.
    now: Option<Placement>,
}

impl Default for Bending {
    fn default() -> Self {
        Self { ahead: vec![Placement::IDENTITY], taken: 0, feet: Vec::new() }
    }
}

impl Bending {
    fn at(&self, step: usize) -> Placement {
        self.ahead[step.min(self.ahead.len() - 1)]
    }

    /// Where the frame is put that is shown after so many steps more.
    pub fn after(&self, steps: usize) -> Placement {
        self.at(self.taken + steps)
    }

    /// Whether frames are put where the legs lead, from now on.
    pub fn is_straight(&self) -> bool {
        self.ahead.len() == 1 && self.feet.is_empty()
    }

    /// From `steps` steps on all is put as `bend` says, seen from where it would be then: where nothing is said, as then.
    pub fn replace(&mut self, steps: usize, bend: &[[f32; 3]]) {
        let last = self.after(steps);
        self.ahead = (0..=steps).map(|step| self.after(step)).collect();
        self.taken = 0;
        let placement = |&[heading, x, z]: &[f32; 3]| Placement { heading, translation: Vec2::new(x, z) }.after(&last);
        self.ahead.extend(bend.iter().skip(1).map(placement));
        while self.ahead.len() > 1 && self.ahead[self.ahead.len() - 2] == self.ahead[self.ahead.len() - 1] {
            self.ahead.pop();
        }
    }

    /// Finds the stances of the route that `walker` is on.
    pub fn plan(&mut self, graph: &EssentialGraph, timeline: &Timeline, walker: &Walker) {
        let feet = graph.feet();
        let is_straight =
            self.ahead.len() == 1 && self.feet.iter().all(|foot| foot.now.is_none_or(|now| now == self.at(0)));
        if feet.count() == 0 || is_straight {
            self.feet.clear();
            return;
        }
        self.feet.resize_with(feet.count(), Foot::default);
        let stands = standing(graph, timeline, walker, self.ahead.len() + (timeline.fps() * 2.0) as usize);
        let ahead = &self.ahead;
        let at = |step: usize| ahead[step.min(ahead.len() - 1)];
        for (index, foot) in self.feet.iter_mut().enumerate() {
            let last = stands[index].len() - 1;
            let margin = (TOUCHES * timeline.fps()).round() as usize;
            let stances = runs(&stands[index], (FLICKER * timeline.fps()) as usize + 1, margin, last);
            let now = foot.now.unwrap_or(at(0));
            let mut placed: Vec<(usize, usize, Placement)> = Vec::with_capacity(stances.len() + 1);
            // A foot in the air comes from where it is.
            if stances.first().is_none_or(|stance| stance.0 > 0) {
                placed.push((0, 0, now));
            }
            placed.extend(stances.into_iter().map(|(first, end)| match (first, end == last) {
                (0, _) => (first, end, now),
                // The walk ends as it was recorded.
                (_, true) => (first, end, at(end)),
                _ => (first, end, at((first + end) / 2)),
            }));
            foot.stances = placed;
        }
    }

    /// Says where frames are put now; from now on they are taken to be there already.
    pub fn fold(&mut self) -> Placement {
        let here = self.at(self.taken);
        let back = here.inverse();
        (self.ahead, self.taken) = (vec![Placement::IDENTITY], 0);
        for foot in &mut self.feet {
            foot.stances.clear();
            foot.now = foot
                .now
                .filter(|now| *now != here)
                .map(|now| if here == Placement::IDENTITY { now } else { now.after(&back) });
        }
        here
    }

    /// A step was taken.
    pub fn take(&mut self) {
        self.taken += 1;
        if self.ahead.len() == 1 && self.feet.is_empty() {
            self.taken = 0;
        }
    }

    /// Puts a finished frame where it belongs.
    pub fn apply(&mut self, feet: &Feet, weights: &[f32], pose: &mut [Vec3]) {
        let here = self.at(self.taken);
        if here != Placement::IDENTITY {
            here.apply_all(pose);
        }
        let mut carried = Vec3::ZERO;
        for (index, foot) in self.feet.iter_mut().enumerate() {
            let (from, to) = foot.places(self.taken, here);
            foot.now = Some(to.map_or(from, |(to, share)| between(&from, &to, share)));
            if from != here || to.is_some_and(|(to, _)| to != here) {
                let back = here.inverse();
                let moved = |point: Vec3| {
                    let [a, b] = [from, to.map_or(from, |to| to.0)].map(|place| place.after(&back).apply(point));
                    a.lerp(b, to.map_or(0.0, |to| to.1))
                };
                carried += step(feet.vertices(index), moved, weights, pose);
            }
        }
        lean(feet, carried, weights, pose);
    }
}

impl Foot {
    /// Where it stands after a step; or where it comes from, where it goes and how far it is on the way there.
    fn places(&self, step: usize, here: Placement) -> (Placement, Option<(Placement, f32)>) {
        let next = self.stances.partition_point(|stance| stance.0 <= step);
        let Some(&(_, end, from)) = next.checked_sub(1).and_then(|index| self.stances.get(index)) else {
            return (self.now.unwrap_or(here), None);
        };
        match self.stances.get(next) {
            _ if step <= end => (from, None),
            Some(&(first, _, to)) => (from, Some((to, ease((step - end) as f32 / (first - end) as f32)))),
            // It is not put down any more.
            None => (from, Some((here, ease(((step - end) as f32 / 10.0).min(1.0))))),
        }
    }
}

fn between(from: &Placement, to: &Placement, share: f32) -> Placement {
    Placement {
        heading: from.heading + (to.heading - from.heading) * share,
        translation: from.translation.lerp(to.translation, share),
    }
}

/// Moves a foot as a whole, and its leg with it. Returns how far that carries the centre of mass by `weights`.
fn step(vertices: &[FootVertex], moved: impl Fn(Vec3) -> Vec3, weights: &[f32], pose: &mut [Vec3]) -> Vec3 {
    let (mut by, mut weight) = (Vec3::ZERO, 0.0);
    for vertex in vertices {
        let point = pose[vertex.vertex as usize];
        by += (moved(point) - point) * f32::from(vertex.sole);
        weight += f32::from(vertex.sole);
    }
    by /= weight;
    let mut carried = Vec3::ZERO;
    for vertex in vertices {
        let point = &mut pose[vertex.vertex as usize];
        let besides = moved(*point) - *point - by;
        let by = by * share(vertex.leg) + besides * share(vertex.sole);
        *point += by;
        carried += by * weights[vertex.vertex as usize];
    }
    carried
}

/// For each foot whether it stands now and after each of the next steps of a route, `most` of them.
fn standing(graph: &EssentialGraph, timeline: &Timeline, walker: &Walker, most: usize) -> Vec<Vec<bool>> {
    let feet = graph.feet();
    let mut walker = walker.clone();
    let mut stands: Vec<Vec<bool>> = vec![Vec::new(); feet.count()];
    let mut inside = None;
    let mut push = |step: Option<Step>, at: u32| {
        for (foot, stands) in stands.iter_mut().enumerate() {
            stands.push(match step {
                Some(Step::Node { transition, node }) => {
                    let plan = match &inside {
                        Some((index, plan)) if *index == transition => plan,
                        _ => {
                            let Some(to) = graph.transitions().get(transition as usize) else { continue };
                            &inside.insert((transition, foot_steps(feet, timeline, to))).1
                        }
                    };
                    let Some(to) = graph.transitions().get(transition as usize) else { continue };
                    let first = timeline.offset(to.to, 1 - to.warp.lengths().1 as i64);
                    let [source, destination] = [(0, Some(to.from)), (1, first)].map(|(side, first)| {
                        let pace = actor::temporal_warp::Pace::of(&to.warp, side, timeline.fps());
                        let place = pace.place(&to.warp, side, node as usize);
                        let way = i64::from(place / actor::temporal_warp::PLACES_A_FRAME);
                        first
                            .and_then(|first| timeline.offset(first, way))
                            .is_some_and(|frame| feet.stands(frame, foot))
                    });
                    match plan[foot].map(|step| step.weight(node as usize)) {
                        Some(weight) if weight <= 0.0 => source,
                        Some(weight) if weight >= 1.0 => destination,
                        _ => false,
                    }
                }
                Some(Step::Forward(frame) | Step::Back(frame)) => feet.stands(frame, foot),
                None => feet.stands(at, foot),
            });
        }
    };
    push(None, walker.departure(graph));
    for _ in 0..most {
        let Some(step) = walker.next(timeline) else { break };
        push(Some(step), 0);
        walker.take(graph, timeline);
    }
    stands
}

/// First and last index of what is true in a row, where shorter pauses than `flicker` do not count.
fn runs(values: &[bool], flicker: usize, margin: usize, last: usize) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for at in (0..values.len()).filter(|&at| values[at]) {
        match runs.last_mut() {
            Some(run) if at - run.1 <= flicker => run.1 = at,
            _ => runs.push((at, at)),
        }
    }
    // What is left between two of them is shared.
    let wide: Vec<(usize, usize)> = (0..runs.len())
        .map(|at| {
            let (first, end) = runs[at];
            let before = at.checked_sub(1).map_or(first, |before| (first - runs[before].1) / 3);
            let after = runs.get(at + 1).map_or(last - end, |next| (next.0 - end) / 3);
            (first - margin.min(before), end + margin.min(after))
        })
        .collect();
    wide
}

/// Steps that a route has from where `walker` is until what comes next can be chosen freely.
pub(crate) fn until_departure(graph: &EssentialGraph, walker: &Walker) -> usize {
    let taken = match walker.inside() {
        Some(transition) => (Leg::Synthetic(transition).steps(graph), walker.taken()),
        None => (0, 0),
    };
    taken.0.saturating_sub(taken.1) as usize
}
