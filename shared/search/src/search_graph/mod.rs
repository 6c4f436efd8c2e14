//! The essential graph as searches walk it over the ground: for every edge where it leads, how long it takes and how the
//! actor travels along it. Made once for a graph; all searches read it.

mod builder;

pub use builder::SearchGraphBuilder;

use glam::{Vec2, Vec3};

use super::behaviours::{Behaviour, find_behaviour};
use super::ground_pose::GroundPose;
use super::members::{Member, find_member};
use super::request::RequestError;
use actor::graph::EssentialGraph;
use actor::motion::Motion;
use actor::pose_source::PoseError;
use actor::timeline::Timeline;

/// Frames between two samples of a transition: the path's error is taken at every fourth frame of it.
pub const SAMPLE_STRIDE: u32 = 4;

/// A place along an edge, as seen from the frame that it leaves, standing as it was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where the followed point is, in metres.
    pub point: Vec3,
    /// Metres travelled on the ground since the sample before.
    pub on_ground: f32,
    /// Metres travelled in space since the sample before.
    pub in_space: f32,
    /// Steps since the sample before, at most [`SAMPLE_STRIDE`].
    pub steps: u32,
    /// The recorded frame that this part looks like most: whose behaviour it shows.
    pub looks_like: u32,
}

/// An edge of the graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// The frame that it leads to.
    pub to: u32,
    /// Steps that it takes.
    pub steps: u32,
    /// Its cost E = D + alpha L.
    pub cost: f64,
    /// D; 0 for a recorded step.
    pub deformation: f64,
    /// L: nodes of a transition; 1 for a recorded step.
    pub nodes: u32,
    /// Where `to` stands once the frame left stands as it was recorded.
    pub ground_pose: GroundPose,
    /// The transition; `None` for a recorded step.
    pub transition: Option<u32>,
    /// How much it resembles a cheaper one from the same frame: 0 where none arrives within 16 frames of it, 1 within 8, 2
    /// within 4, 3 within 2. The first passes of a search take the lower ranks only.
    pub rank: u32,
}

/// All edges of a graph with their motion over the ground.
#[derive(Clone, Debug)]
pub struct SearchGraph {
    /// Frames per second.
    pub fps: f64,
    /// Cost of a recorded step.
    pub alpha: f64,
    /// The followed point of each frame as it was recorded: the centre of mass, or a group of vertices.
    pub points: Vec<Vec3>,
    /// The vertices whose mean is followed; empty where it is the centre of mass.
    pub group: Vec<u32>,
    /// Which way the body faces in each frame as it was recorded.
    pub facings: Vec<f32>,
    /// The same as unit vectors along (X, Z).
    faces: Vec<Vec2>,
    /// Whether each frame is in the main component.
    pub main: Vec<bool>,
    /// Whether each frame leads into the main component; edges to other frames are left out.
    pub live: Vec<bool>,
    /// The largest distance in metres that the followed point moves in a step, in space.
    pub best_speed: f64,
    /// The largest turn in radians that the body makes in a step.
    pub best_turn: f64,
    /// Metres travelled on the ground and in space from the sequence's first frame to each.
    travelled: Vec<[f32; 2]>,
    sequence_of_frame: Vec<u32>,
    behaviours: Vec<Behaviour>,
    members: Vec<Member>,
    edges: Vec<Edge>,
    first_edge: Vec<u32>,
    samples: Vec<Sample>,
    first_sample: Vec<u32>,
}

impl SearchGraph {
    /// The search graph of the centre of mass.
    ///
    /// # Errors
    /// Motion that does not fit the timeline, or a graph over other frames.
    pub fn new(graph: &EssentialGraph, timeline: &Timeline, motion: &Motion) -> Result<Self, PoseError> {
        let mut survey = SearchGraphBuilder::new(graph, timeline, motion, None)?;
        while !survey.advance(graph, timeline, motion, usize::MAX)? {}
        Ok(survey.finish())
    }

    /// Takes another weight of a frame's duration, as the graph has taken it ([`EssentialGraph::set_alpha`]).
    pub fn set_alpha(&mut self, alpha: f64) {
        self.alpha = alpha;
        for edge in &mut self.edges {
            edge.cost = edge.deformation + alpha * f64::from(edge.nodes);
        }
    }

    /// Number of frames.
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        self.points.len() as u32
    }

    /// Indices of the edges that leave `frame`, for [`Self::edge`]; none for a frame that does not exist.
    #[must_use]
    pub fn from(&self, frame: u32) -> std::ops::Range<u32> {
        match self.first_edge.get(frame as usize..).and_then(|rest| rest.get(..2)) {
            Some(&[start, end]) => start..end,
            _ => 0..0,
        }
    }

    /// The edge with this index, which must exist.
    #[must_use]
    pub fn edge(&self, index: u32) -> &Edge {
        &self.edges[index as usize]
    }

    /// The samples along an edge, which must exist; the last one is at its end.
    #[must_use]
    pub fn samples(&self, index: u32) -> &[Sample] {
        let index = index as usize;
        &self.samples[self.first_sample[index] as usize..self.first_sample[index + 1] as usize]
    }

    /// The behaviours ([`behaviours`](crate::behaviours)).
    #[must_use]
    pub fn behaviours(&self) -> &[Behaviour] {
        &self.behaviours
    }

    /// The number of the behaviour with this name, or beyond those that have one, of the member of a family that `NAME@VALUE` asks
    /// for ([`Self::member`]).
    ///
    /// # Errors
    /// There is none.
    pub fn behaviour(&self, name: &str) -> Result<usize, RequestError> {
        let unknown = match find_behaviour(&self.behaviours, name) {
            Ok(number) => return Ok(number),
            Err(unknown) => unknown,
        };
        let shows = |number: usize, frame: u32| self.shows(number, frame);
        let found = find_member(&self.members, &self.behaviours, shows, name).ok_or(unknown)?;
        Ok(self.behaviours.len() + found)
    }

    /// The member of a family that a behaviour of this number is; `None` where it has a name of its own.
    #[must_use]
    pub fn member(&self, behaviour: usize) -> Option<&Member> {
        self.members.get(behaviour.checked_sub(self.behaviours.len())?)
    }

    /// Whether `frame` shows a behaviour.
    #[must_use]
    pub fn shows(&self, behaviour: usize, frame: u32) -> bool {
        if let Some(member) = self.member(behaviour) {
            return (member.frames[0]..=member.frames[1]).contains(&frame);
        }
        let (Some(behaviour), Some(&sequence)) =
            (self.behaviours.get(behaviour), self.sequence_of_frame.get(frame as usize))
        else {
            return false;
        };
        behaviour.shown_by[sequence as usize]
    }

    /// Where the followed point of `frame`, standing at `ground_pose`, will be in `steps` if the recording goes on, and how far it
    /// will have travelled: on the ground and in space. `None` where the recording ends before. The frame must exist.
    #[must_use]
    pub fn ahead(&self, frame: u32, ground_pose: GroundPose, steps: u32) -> Option<(Vec3, [f32; 2])> {
        let ahead = frame as usize + steps as usize;
        if *self.sequence_of_frame.get(ahead)? != self.sequence_of_frame[frame as usize] {
            return None;
        }
        let (before, after) = (self.travelled[frame as usize], self.travelled[ahead]);
        Some((ground_pose.apply(self.points[ahead]), [after[0] - before[0], after[1] - before[1]]))
    }

    /// Which way the body faces in `frame`, standing at `ground_pose`: a unit vector along (X, Z). The frame must exist.
    #[must_use]
    pub fn face_at(&self, frame: u32, ground_pose: GroundPose) -> Vec2 {
        ground_pose.rotate(self.faces[frame as usize])
    }

    /// The frame of the main component that is nearest to `frame` in its sequence: where the actor can get to. The first
    /// frames of a sequence have no room for a transition that arrives.
    #[must_use]
    pub fn substitute(&self, frame: u32) -> Option<u32> {
        let sequence = *self.sequence_of_frame.get(frame as usize)?;
        let same = |other: &u32| self.sequence_of_frame[*other as usize] == sequence && self.main[*other as usize];
        (0..self.frame_count()).filter(same).min_by_key(|other| other.abs_diff(frame))
    }

    /// Index of the sequence of `frame`, which must exist.
    #[must_use]
    pub fn sequence(&self, frame: u32) -> usize {
        self.sequence_of_frame[frame as usize] as usize
    }

    /// Where the followed point of `frame` is, standing at `ground_pose`; the frame must exist.
    #[must_use]
    pub fn point_at(&self, frame: u32, ground_pose: GroundPose) -> Vec3 {
        ground_pose.apply(self.points[frame as usize])
    }
}
