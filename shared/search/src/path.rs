//! Following a path: the centre of mass, or a group of vertices, against the point of equal arc length of a curve, over
//! stretches that may demand a behaviour (thesis section 3.5.1; TVCG section 4.3.1).

use glam::Vec3Swizzles;

use super::bend::{Bend, Bending};
use super::curve::Curve;
use super::ground_pose::{GroundPose, half_turn};
use super::search_graph::{SAMPLE_STRIDE, SearchGraph};
use super::steer::Steering;
use super::task::{Found, LEAST_STEP_COST, Outlook, State, Task, cell_of};

/// Metre-seconds that each metre costs by which a walk ends before the path does.
const LEFT_OVER: f64 = 20.0;
/// Seconds for which the distance at the walk's end counts once more: the actor stands there.
const AT_THE_END: f64 = 1.0;
/// What a frame that shows another behaviour than the one demanded costs: as much as being this many metres off.
const WRONG_BEHAVIOUR: f64 = 3.0;
/// Metres off the path that are hard to bend back, and how many times more what is above it counts.
const NEARLY: f64 = 0.1;
const LOST: f64 = 5.0;
/// Metres off the path that facing aside counts as, facing back twice as many.
const ASIDE: f64 = 0.2;
/// A walk gives up when it has been under way for as long as it takes at this speed, in metres a second, and
/// [`PATIENCE`] seconds more.
const SLOWEST: f64 = 0.1;
const PATIENCE: f64 = 10.0;
/// How much each pass trusts the walk found so far, and how many seconds of a distance it takes to come back from it: passes
/// that err in different ways find what the others miss.
const TRUST: [f64; 4] = [1.0, 0.7, 1.0, 0.85];
const OFF: [f64; 4] = [1.0, 0.7, 1.5, 1.0];
/// What a metre of path costs where nothing is known yet, in metre-seconds, and the usual J of a transition.
const A_METRE: f64 = 0.3;
const A_TRANSITION: f64 = 4.0;
/// Looks ahead along the recording a second, and how many.
const GLANCES: f64 = 5.0;
const MOST_GLANCES: u32 = 12;
/// Metres of path in a layer.
const LAYER: f64 = 0.1;
/// Most layers of a path.
const MOST_LAYERS: f64 = 4096.0;

/// A stretch of a path that demands a behaviour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Where it begins, in metres along the path.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// The behaviour, by its number in [`SearchGraph`].
    pub behaviour: usize,
}

/// The task of following a path.
///
/// J_c (thesis equation 3.5; TVCG equation 11) is, in metre-seconds, the sum over the walk's frames of the distance to
/// the path's point of equal arc length, plus `realism` times the walk's cost J in the graph, plus what demands and an
/// early end cost. A transition's frames are sampled every [`SAMPLE_STRIDE`] steps. The walk ends once it has travelled
/// as far as the path is long.
#[derive(Clone, Debug)]
pub struct PathTask {
    /// The path, in the world.
    pub curve: Curve,
    /// Stretches that demand behaviours; of several at a place the last one counts.
    pub demands: Vec<Demand>,
    /// Where the actor may begin.
    pub starts: Vec<State>,
    /// Weight of the graph's cost against metre-seconds of deviation.
    pub realism: f64,
    /// How far the walk may be bent onto the path, from 0 (not at all) to 1: searches count on it.
    pub exactness: f64,
    seconds_per_step: f64,
    step_cost: f64,
    most_steps: u32,
    layer_length: f64,
}

impl PathTask {
    /// Following `curve` from one of `starts`.
    #[must_use]
    pub fn new(
        search_graph: &SearchGraph,
        curve: Curve,
        demands: Vec<Demand>,
        starts: Vec<State>,
        realism: f64,
    ) -> Self {
        let seconds = PATIENCE + curve.length() / SLOWEST;
        Self {
            layer_length: LAYER.max(curve.length() / MOST_LAYERS),
            most_steps: (seconds * search_graph.fps).min(1e6) as u32,
            seconds_per_step: 1.0 / search_graph.fps,
            step_cost: (realism * search_graph.alpha).max(LEAST_STEP_COST),
            curve,
            demands,
            starts,
            realism,
            exactness: 0.0,
        }
    }

    /// Places where `frame` may begin the path: at its first point, facing along it.
    #[must_use]
    pub fn start_on(search_graph: &SearchGraph, curve: &Curve, frame: u32) -> Option<State> {
        let facing = search_graph.facings.get(frame as usize)?;
        let heading = half_turn(curve.first_heading() - facing);
        Some(State::start(
            frame,
            GroundPose::turning(heading, search_graph.points[frame as usize].xz(), curve.at(0.0).xz()),
        ))
    }

    /// What `travelled` metres of path demand of a frame: whether it shows another behaviour.
    fn is_wrong(&self, search_graph: &SearchGraph, travelled: f64, frame: u32) -> bool {
        let demand = self.demands.iter().rev().find(|demand| (demand.from..demand.to).contains(&travelled));
        demand.is_some_and(|demand| !search_graph.shows(demand.behaviour, frame))
    }

    /// Follows the samples of an edge: for each the arc length, the point in the world, the steps and the frame it looks
    /// like.
    fn along(
        &self,
        search_graph: &SearchGraph,
        from: &State,
        edge: u32,
        mut visit: impl FnMut(f64, glam::Vec3, u32, u32),
    ) -> f64 {
        let mut travelled = from.travelled;
        for sample in search_graph.samples(edge) {
            travelled += f64::from(if self.curve.is_flat() { sample.on_ground } else { sample.in_space });
            visit(travelled, from.ground_pose.apply(sample.point), sample.steps, sample.looks_like);
        }
        travelled
    }

    /// What searches count on; `None` where the walk is not bent, and where it is not the body that follows the path along the
    /// ground: a hand's way is not the body's, which need not face along it.
    fn steering(&self, search_graph: &SearchGraph) -> Option<Steering> {
        let is_steered = self.exactness > 0.0 && self.curve.is_flat() && search_graph.group.is_empty();
        is_steered.then(|| Steering::new(self.exactness, search_graph.fps))
    }

    /// Begins to bend a walk that was found onto the path; `None` where it is to stay as it is.
    pub(super) fn bending(&self, search_graph: &SearchGraph, found: &Found, is_free: bool) -> Option<Bending> {
        let (track, fps) = (found.track(search_graph), search_graph.fps as f32);
        Bending::new(&self.curve, &track, fps, self.exactness as f32, is_free)
    }

    /// How a walk that was found is bent onto the path by a bending that has had its last pass, and how well it follows it then. A
    /// walk that has little to do with the path can be led away from it by limits: that one stays as it is.
    pub(super) fn bent(
        &self,
        search_graph: &SearchGraph,
        found: &Found,
        bending: Option<Bending>,
    ) -> (Bend, PathReport) {
        let plain = self.judge(search_graph, found);
        let Some(bending) = bending else { return (Bend::default(), plain) };
        let bend = bending.finish(&self.curve);
        let bent = self.judge_bent(search_graph, found, &bend);
        let is_nearer = bent.mean_aside <= plain.mean_aside || bent.max_aside <= plain.max_aside;
        if is_nearer { (bend, bent) } else { (Bend::default(), plain) }
    }

    /// How well a walk that was found follows the path as it is.
    #[must_use]
    pub fn judge(&self, search_graph: &SearchGraph, found: &Found) -> PathReport {
        self.judge_bent(search_graph, found, &Bend::default())
    }

    /// The same once it is bent.
    fn judge_bent(&self, search_graph: &SearchGraph, found: &Found, bend: &Bend) -> PathReport {
        let curve = self.curve.polyline(0.05).iter().map(|point| point.to_array()).collect();
        let mut report =
            PathReport { length: self.curve.length(), curve, flat: self.curve.is_flat(), ..PathReport::default() };
        let (mut steps, mut demanded, mut kept) = (0_u32, 0_u32, 0_u32);
        // Where it leads by itself: searches that count on a bend take it to lead elsewhere.
        let mut state = found.start;
        let (mut before, mut way) = (None, 0.0);
        for &edge in &found.edges {
            let planned = self.along(search_graph, &state, edge, |travelled, point, weight, frame| {
                let mut travelled = travelled;
                let mut point = point;
                if let Some(pose) = bend.0.get((steps + weight) as usize) {
                    // What it travels is longer or shorter than planned.
                    point = pose.apply(point);
                    let start = || bend.0[0].apply(search_graph.point_at(state.frame, state.ground_pose));
                    let step = point - before.unwrap_or_else(start);
                    way += f64::from(if self.curve.is_flat() { step.xz().length() } else { step.length() });
                    (before, travelled) = (Some(point), way);
                }
                let (off, aside) = (self.curve.distance(point, travelled), self.curve.nearest(point, travelled));
                report.mean += off * f64::from(weight);
                report.max = report.max.max(off);
                report.mean_aside += aside * f64::from(weight);
                report.max_aside = report.max_aside.max(aside);
                report.track.push([travelled as f32, point.x, point.y, point.z]);
                steps += weight;
                if self.demands.iter().any(|demand| (demand.from..demand.to).contains(&travelled)) {
                    demanded += weight;
                    kept += if self.is_wrong(search_graph, travelled, frame) { 0 } else { weight };
                }
            });
            report.travelled = if bend.0.is_empty() { planned } else { way };
            let taken = search_graph.edge(edge);
            state = State {
                frame: taken.to,
                ground_pose: state.ground_pose.after(&taken.ground_pose),
                travelled: planned,
                ..state
            };
        }
        report.mean /= f64::from(steps.max(1));
        report.mean_aside /= f64::from(steps.max(1));
        report.demands_kept = (demanded > 0).then(|| f64::from(kept) / f64::from(demanded));
        report
    }
}

/// How well a walk follows a path; lengths in metres.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct PathReport {
    /// Length of the path.
    pub length: f64,
    /// Length that was travelled.
    pub travelled: f64,
    /// Mean distance over the frames to the path's point of equal arc length.
    pub mean: f64,
    /// The largest such distance.
    pub max: f64,
    /// Mean distance over the frames to the nearest point of the path.
    pub mean_aside: f64,
    /// The largest such distance.
    pub max_aside: f64,
    /// Share of the frames on demanding stretches that show what is demanded; `None` where nothing is.
    pub demands_kept: Option<f64>,
    /// The path as it was asked for, with the way to its beginning: points (x, y, z), at height 0 on the ground.
    pub curve: Vec<[f32; 3]>,
    /// Whether it lies on the ground.
    pub flat: bool,
    /// The walk's way: for each sample metres travelled and the followed point (x, y, z).
    pub track: Vec<[f32; 4]>,
}

impl Task for PathTask {
    fn starts(&self, _: &SearchGraph) -> Vec<State> {
        self.starts.clone()
    }

    fn follow(&self, search_graph: &SearchGraph, from: &State, index: u32) -> Option<State> {
        let edge = search_graph.edge(index);
        let mut error = 0.0;
        let steering = self.steering(search_graph);
        let travelled = self.along(search_graph, from, index, |travelled, point, steps, frame| {
            let wrong = if self.is_wrong(search_graph, travelled, frame) { WRONG_BEHAVIOUR } else { 0.0 };
            let off = self.curve.distance(point, travelled);
            // No bend brings that onto the path.
            let lost = if steering.is_some() { LOST * (off - NEARLY).max(0.0) } else { 0.0 };
            error += f64::from(steps) * (off + lost + wrong);
        });
        let graph = (self.realism * edge.cost).max(self.step_cost * f64::from(edge.steps));
        let mut next = State {
            frame: edge.to,
            ground_pose: from.ground_pose.after(&edge.ground_pose),
            travelled,
            steps: from.steps + edge.steps,
            cost: from.cost + error * self.seconds_per_step + graph,
        };
        if let Some(steering) = steering {
            let face = search_graph.face_at(next.frame, next.ground_pose);
            let away = f64::from(1.0 - face.dot(self.curve.direction(travelled)));
            next.cost += ASIDE * away * f64::from(edge.steps) * self.seconds_per_step;
            let way = (travelled - from.travelled) as f32;
            next.cost += steering.apply(&self.curve, search_graph, &mut next, way, edge.steps);
        }
        Some(next)
    }

    /// The rest of the path takes time even at the best speed v, and a distance d to the path shrinks by 2 v a step at
    /// most: actor and point both move; and by what a bend may move it. Or the walk ends early, for a price.
    fn remaining(&self, search_graph: &SearchGraph, state: &State) -> f64 {
        let left = self.curve.length() - state.travelled;
        let speed = search_graph.best_speed;
        if left <= 0.0 || speed <= 0.0 {
            return 0.0;
        }
        let steps = left / speed;
        let off = self.curve.distance(search_graph.point_at(state.frame, state.ground_pose), state.travelled);
        // Samples are taken at the ends of up to SAMPLE_STRIDE steps: sums from below by the integral from there on.
        let nearer = 2.0 * speed + self.steering(search_graph).map_or(0.0, |steering| steering.shift());
        let area = |step: f64| step * (off - nearer / 2.0 * step);
        let (from, to) = (f64::from(SAMPLE_STRIDE), steps.min(off / nearer));
        let error = if to > from { area(to) - area(from) } else { 0.0 };
        let walked = steps * self.step_cost + error * self.seconds_per_step;
        // Between those ends the sum is least where the error begins to count, or at an end.
        let a_little = from.min(steps);
        let given_up = a_little * self.step_cost + (left - speed * a_little) * LEFT_OVER;
        walked.min(given_up).min(left * LEFT_OVER)
    }

    /// The recording is followed for as long as that pays, then a transition is taken, and the rest costs what it did on the
    /// best walk so far. What cannot turn is found out early, and what follows the path for long is preferred.
    fn guess(&self, search_graph: &SearchGraph, state: &State, outlook: &Outlook) -> f64 {
        let pass = outlook.pass as usize % TRUST.len();
        let rest = |travelled: f64, off: f64| {
            let left = (self.curve.length() - travelled).max(0.0);
            let rest = outlook.after(travelled / self.layer_length).unwrap_or(left * A_METRE);
            self.realism * A_TRANSITION + OFF[pass] * off + TRUST[pass] * rest
        };
        let stride = ((search_graph.fps / GLANCES) as u32).max(1);
        let (mut error, mut least) = (0.0, f64::INFINITY);
        for glance in 1..=MOST_GLANCES {
            let Some((point, [on_ground, in_space])) =
                search_graph.ahead(state.frame, state.ground_pose, glance * stride)
            else {
                break;
            };
            let travelled = state.travelled + f64::from(if self.curve.is_flat() { on_ground } else { in_space });
            let off = self.curve.distance(point, travelled);
            error += off * f64::from(stride) * self.seconds_per_step;
            let is_over = travelled >= self.curve.length();
            // A transition goes on like the recording at first.
            if glance > 1 || is_over {
                least = least.min(error + rest(travelled, off));
            }
            if is_over {
                break;
            }
        }
        if least.is_finite() {
            return least;
        }
        rest(
            state.travelled,
            self.curve.distance(search_graph.point_at(state.frame, state.ground_pose), state.travelled),
        )
    }

    fn ending(&self, search_graph: &SearchGraph, state: &State) -> Option<f64> {
        let off = self.curve.distance(search_graph.point_at(state.frame, state.ground_pose), self.curve.length());
        Some((self.curve.length() - state.travelled).max(0.0) * LEFT_OVER + off * AT_THE_END)
    }

    fn halts(&self, _: &SearchGraph, state: &State) -> bool {
        state.travelled >= self.curve.length() || state.steps >= self.most_steps
    }

    fn layer(&self, state: &State) -> usize {
        (state.travelled / self.layer_length) as usize
    }

    fn cell(&self, _: &SearchGraph, state: &State, fineness: u32) -> u64 {
        let finer = (1 << fineness.min(8)) as f32;
        cell_of(state, (8 >> fineness.min(3), 0.2 / finer, 0.2 / finer))
    }
}
