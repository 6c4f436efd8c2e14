//! Search: walks through the essential graph that do what is asked.
//!
//! ```text
//! graph, timeline -> cheapest_walk            (a pose)
//! graph, timeline, Motion -> SearchGraph -> Search   (paths, key poses, places, behaviours, wandering, queues of them)
//! ```
//!
//! [`Direction`] is the whole of it behind one call: a [`Request`], checked, is worked on in slices and can be asked for its
//! best [`Answer`] at any time. The searches below it can be used by themselves. `docs/directing.md` describes requests
//! and answers as JSON.
//!
//! This work is based on: Boukhayma and Boyer, TVCG section 4.3; Boukhayma, thesis (2017), section 3.5; Prada and others
//! (2016), section 7. Where they search depth-first, the tool searches by layers that grow ([`Anytime`]); [`depth_first`] is
//! the oracle.

mod answer;
mod anytime;
mod behaviour;
mod behaviours;
mod bend;
mod components;
mod curve;
mod depth_first;
mod detour;
mod direct;
mod ground_pose;
mod key_plan;
mod keys;
mod members;
mod meter;
mod notes;
mod path;
mod path_work;
mod place;
mod plan;
mod pool;
mod queue;
mod random;
mod request;
mod scene;
mod search_graph;
mod shortest;
mod steer;
mod tail;
mod task;
mod wander;
mod work;

pub use answer::{Answer, Goal, KeyRow, Part};
pub use anytime::{Anytime, Progress};
pub use behaviour::{Hold, LoopSearch, holding_loop, walk_to_any, walk_to_behaviour};
pub use behaviours::{Behaviour, UnknownBehaviour, behaviours, find_behaviour, frames_of};
pub use components::{MainComponent, main_component, main_component_of, reached, reaching};
pub use curve::{Curve, Shape};
pub use depth_first::{Exhausted, depth_first};
pub use direct::{DEFAULT_EFFORT, Direction};
pub use ground_pose::GroundPose;
pub use keys::{KeyLeg, LegEnd};
pub use members::{Member, find_member, members};
pub use meter::edges_looked_at;
pub use path::{Demand, PathReport, PathTask};
pub use place::{PlaceReport, PlaceTask};
pub use plan::plan_walk;
pub use random::{Chain, Optimiser};
pub use request::{
    BehaviourRequest, DEFAULT_EXACTNESS, DEFAULT_REALISM, FrameRef, Json, Key, KeysRequest, PATH_REALISM, PathRequest,
    PlaceRequest, Request, RequestError, Stretch, Target, VERSION, WanderRequest, WithinSequence, limits,
};
pub use scene::{Scene, Start};
pub use search_graph::{Edge, SAMPLE_STRIDE, Sample, SearchGraph, SearchGraphBuilder};
pub use shortest::{Measure, cheapest_walk, to_targets, walk_down};
pub use task::{Found, LEAST_STEP_COST, Outlook, State, Task};
pub use wander::Wander;
