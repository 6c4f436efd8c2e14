//! Makes the search graph, some transitions at a time.

use glam::{Vec2, Vec2Swizzles, Vec3, Vec3Swizzles};

use super::{Edge, SAMPLE_STRIDE, Sample, SearchGraph};
use crate::behaviours::behaviours;
use crate::components::main_component;
use crate::ground_pose::{GroundPose, half_turn, turn_of};
use crate::members::members;
use actor::blend::Blend;
use actor::graph::{EssentialGraph, Transition};
use actor::motion::Motion;
use actor::pose_source::PoseError;
use actor::timeline::Timeline;
use actor::walk::steps_of;

/// Makes [`SearchGraph`], some transitions at a time: about a tenth of a second of work for 80,000 of them.
#[derive(Clone, Debug)]
pub struct SearchGraphBuilder {
    search_graph: SearchGraph,
    frame: u32,
}

impl SearchGraphBuilder {
    /// Nothing is surveyed yet. `group` are vertices and their mean point in each frame ([`actor::motion::measure_group`]), to be
    /// followed instead of the centre of mass.
    ///
    /// # Errors
    /// Motion or points that do not fit the timeline, or a graph over other frames.
    pub fn new(
        graph: &EssentialGraph,
        timeline: &Timeline,
        motion: &Motion,
        group: Option<(Vec<u32>, Vec<Vec3>)>,
    ) -> Result<Self, PoseError> {
        let frames = timeline.frame_count();
        let (group, points) = group.unwrap_or_else(|| (Vec::new(), motion.centres.clone()));
        let fits = motion.fits(timeline) && graph.frame_count() == frames && points.len() == frames as usize;
        if !fits || !points.iter().all(|point| point.is_finite()) {
            return Err(PoseError::OutOfRange(frames));
        }
        let edges = frames as usize + graph.transitions().len();
        // Lists that are long are never moved: that would take longer than a page may.
        let of = |transition: &Transition| transition.warp.duration().div_ceil(SAMPLE_STRIDE as usize).max(1);
        let samples = frames as usize + graph.transitions().iter().map(of).sum::<usize>();
        let mut first_sample = Vec::with_capacity(edges + 1);
        first_sample.push(0);
        let search_graph = SearchGraph {
            travelled: travelled(timeline, &points),
            fps: f64::from(timeline.fps()),
            alpha: graph.alpha(),
            points,
            group,
            facings: motion.facings.clone(),
            faces: motion.facings.iter().map(|&facing| turn_of(facing).yx()).collect(),
            main: Vec::new(),
            live: Vec::new(),
            best_speed: 0.0,
            best_turn: 0.0,
            sequence_of_frame: (0..frames).map(|frame| timeline.sequence_index(frame).unwrap_or(0) as u32).collect(),
            behaviours: behaviours(timeline),
            members: members(timeline),
            edges: Vec::with_capacity(edges),
            first_edge: vec![0],
            samples: Vec::with_capacity(samples),
            first_sample,
        };
        Ok(Self { search_graph, frame: 0 })
    }

    /// Surveys at least `transitions` more transitions, and all those of a frame together; whether that was all. The first call
    /// only finds out which frames are dead ends.
    ///
    /// # Errors
    /// A transition whose segments leave their sequences.
    pub fn advance(
        &mut self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        motion: &Motion,
        transitions: usize,
    ) -> Result<bool, PoseError> {
        if self.search_graph.live.is_empty() {
            // As much work as many transitions.
            let found = main_component(graph, timeline);
            (self.search_graph.main, self.search_graph.live) = (found.main, found.live);
            return Ok(self.search_graph.frame_count() == 0);
        }
        let end = self.search_graph.edges.len().saturating_add(transitions);
        while self.frame < self.search_graph.frame_count() && self.search_graph.edges.len() < end {
            self.survey_frame(graph, timeline, motion)?;
        }
        Ok(self.frame == self.search_graph.frame_count())
    }

    /// The search graph, once [`Self::advance`] has said that that was all; before, but after its first call, it has the edges of
    /// the frames that were surveyed, which is enough for all targets but places and paths.
    #[must_use]
    pub fn finish(self) -> SearchGraph {
        self.search_graph
    }

    fn survey_frame(&mut self, graph: &EssentialGraph, timeline: &Timeline, motion: &Motion) -> Result<(), PoseError> {
        let frame = self.frame;
        if let Some(next) = timeline.next(frame).filter(|&next| self.search_graph.live[next as usize]) {
            let wrap = timeline.sequence_index(frame).and_then(|sequence| motion.wraps.get(sequence));
            let ground_pose = if next == frame + 1 {
                GroundPose::IDENTITY
            } else {
                wrap.map_or(GroundPose::IDENTITY, GroundPose::from)
            };
            let (here, point) =
                (self.search_graph.points[frame as usize], self.search_graph.point_at(next, ground_pose));
            let sample = Sample {
                point,
                on_ground: here.xz().distance(point.xz()),
                in_space: here.distance(point),
                steps: 1,
                looks_like: next,
            };
            let (cost, deformation) = (graph.alpha(), 0.0);
            let edge = Edge { to: next, steps: 1, cost, deformation, nodes: 1, ground_pose, transition: None, rank: 0 };
            self.push(frame, edge, &[sample]);
        }
        for (index, rank) in graph.transitions_from(frame).zip(ranks(graph, frame)) {
            let transition = &graph.transitions()[index];
            if !self.search_graph.live[transition.to as usize] {
                continue;
            }
            let edge = Edge {
                to: transition.to,
                steps: steps_of(transition),
                cost: transition.cost(graph.alpha()),
                deformation: f64::from(transition.deformation),
                nodes: transition.warp.duration() as u32,
                ground_pose: GroundPose::from(&transition.placement),
                transition: Some(index as u32),
                rank,
            };
            let samples = self.sample(graph, timeline, motion, index)?;
            self.push(frame, edge, &samples);
        }
        self.search_graph.first_edge.push(self.search_graph.edges.len() as u32);
        self.frame += 1;
        Ok(())
    }

    /// The followed point along a transition. Where both sides stand follows from facings instead of from poses, which
    /// drifts a little; the end is known exactly, and the drift is taken back along the way.
    fn sample(
        &self,
        graph: &EssentialGraph,
        timeline: &Timeline,
        mut motion: &Motion,
        index: usize,
    ) -> Result<Vec<Sample>, PoseError> {
        let transition = &graph.transitions()[index];
        let points = &self.search_graph.points;
        let start = kernels::align::Placement::IDENTITY;
        let mut blend = Blend::of(timeline, &mut motion, transition, start, graph.contacts())?;
        let mut track = vec![(points[transition.from as usize], transition.from)];
        while let Some(next) = blend.next(timeline, &mut motion, &transition.warp, graph.contacts())? {
            blend = next;
            let side = |side: usize| {
                let (next, point) = (&blend.next[side], points[blend.frames[side] as usize]);
                blend.placements[side].apply(point.lerp(next.step.apply(points[next.frame as usize]), next.share))
            };
            let looks_like = blend.nearest(usize::from(blend.lambda >= 0.5));
            track.push((side(0).lerp(side(1), blend.lambda), looks_like));
        }
        let end = transition.placement.apply(points[transition.to as usize]);
        if track.len() == 1 {
            track.push((end, transition.to));
        }
        let nodes = track.len() - 1;
        let drift = end - track[nodes].0;
        for (node, (point, _)) in track.iter_mut().enumerate() {
            *point += drift * (node as f32 / nodes as f32);
        }
        Ok(sampled(&track))
    }

    fn push(&mut self, frame: u32, edge: Edge, samples: &[Sample]) {
        let search_graph = &mut self.search_graph;
        let mut point = search_graph.points[frame as usize];
        for sample in samples {
            let speed = f64::from(sample.in_space.max(point.distance(sample.point))) / f64::from(sample.steps);
            search_graph.best_speed = search_graph.best_speed.max(speed);
            point = sample.point;
        }
        let turn =
            edge.ground_pose.heading() + search_graph.facings[edge.to as usize] - search_graph.facings[frame as usize];
        search_graph.best_turn = search_graph.best_turn.max(f64::from(half_turn(turn).abs()) / f64::from(edge.steps));
        search_graph.edges.push(edge);
        search_graph.samples.extend_from_slice(samples);
        search_graph.first_sample.push(search_graph.samples.len() as u32);
    }
}

/// [`Edge::rank`] of all transitions that leave `frame`: how far from each the next cheaper one arrives.
fn ranks(graph: &EssentialGraph, frame: u32) -> Vec<u32> {
    let transitions = &graph.transitions()[graph.transitions_from(frame)];
    let mut order: Vec<usize> = (0..transitions.len()).collect();
    let key = |index: usize| (transitions[index].deformation, transitions[index].to);
    order.sort_unstable_by(|&a, &b| key(a).0.total_cmp(&key(b).0).then(key(a).1.cmp(&key(b).1)));
    let (mut ranks, mut cheaper) = (vec![0; transitions.len()], Vec::with_capacity(transitions.len()));
    for index in order {
        let to = transitions[index].to;
        let at = cheaper.partition_point(|&other| other < to);
        let beside = [at.checked_sub(1), Some(at)].into_iter().flatten().filter_map(|at| cheaper.get(at));
        ranks[index] = match beside.map(|other: &u32| other.abs_diff(to)).min().unwrap_or(u32::MAX) {
            16.. => 0,
            8.. => 1,
            4.. => 2,
            2.. => 3,
            _ => 4,
        };
        cheaper.insert(at, to);
    }
    ranks
}

/// For each frame the metres travelled from its sequence's first frame.
fn travelled(timeline: &Timeline, points: &[Vec3]) -> Vec<[f32; 2]> {
    let mut travelled = Vec::with_capacity(points.len());
    for sequence in timeline.sequences() {
        let mut sum = [0.0_f32; 2];
        for frame in sequence.first_frame as usize..sequence.end_frame() as usize {
            if frame > sequence.first_frame as usize {
                let (from, to) = (points[frame - 1], points[frame]);
                sum = [sum[0] + from.xz().distance(to.xz()), sum[1] + from.distance(to)];
            }
            travelled.push(sum);
        }
    }
    travelled
}

/// Every [`SAMPLE_STRIDE`]-th point of a track and its last one.
fn sampled(track: &[(Vec3, u32)]) -> Vec<Sample> {
    let mut samples = Vec::with_capacity(track.len() / SAMPLE_STRIDE as usize + 1);
    let (mut on_ground, mut in_space, mut steps) = (0.0, 0.0, 0);
    for (node, pair) in track.windows(2).enumerate() {
        let (before, (point, looks_like)) = (pair[0].0, pair[1]);
        on_ground += Vec2::distance(before.xz(), point.xz());
        in_space += before.distance(point);
        steps += 1;
        if steps == SAMPLE_STRIDE || node + 2 == track.len() {
            samples.push(Sample { point, on_ground, in_space, steps, looks_like });
            (on_ground, in_space, steps) = (0.0, 0.0, 0);
        }
    }
    samples
}
