//! Reprise turns 4D surface captures - mesh sequences of a performer over one connectivity - into an actor that can be
//! directed: asked for a pose, a place, a path, it goes there through recorded and synthesised motion.
//!
//! ```text
//! files -> Capture -> Measured -> EssentialGraph -> bundle bytes -> BundleReader -> Walk -> frames -> GLB, OBJ, PLY, PNG
//! ```
//!
//! [`pack::pack`] goes the whole way from files to a bundle. Each stage can also be called by itself; here they all are, on a
//! capture made in memory ([`example::cloth`]):
//!
//! ```
//! use reprise::distance::{DistanceOptions, measure};
//! use reprise::export::{ExportOptions, Output, export, play, Actor};
//! use reprise::graph::{GraphOptions, essential_graph};
//! use reprise::pack::{PackOptions, pack_capture};
//! use reprise::{BundleReader, Job, Placement, cheapest_walk};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let capture = reprise::example::cloth();
//! let job = Job::silent();
//!
//! // Pose distances of all pairs of frames, in radians (TVCG equation 2).
//! let measured = measure(&capture.topology, &capture.poses, &DistanceOptions::default(), &job)?;
//! assert_eq!(measured.distances.get(3, 3), 0.0);
//!
//! // The transitions that lie on a cheapest way from somewhere to somewhere (TVCG section 4.1).
//! let graphed = essential_graph(&capture, &measured, &GraphOptions::default(), &job)?;
//! assert!(!graphed.graph.transitions().is_empty());
//!
//! // All of that, and the bundle that the player opens.
//! let (bytes, report) = pack_capture(&capture, &PackOptions::default(), &job)?;
//! assert_eq!(report.capture.frames, capture.timeline.frame_count());
//!
//! // A walk from frame 5 to frame 50, which is in another sequence.
//! let mut reader = BundleReader::from_bytes(&bytes)?;
//! let graph = reader.graph().expect("the bundle is whole").clone();
//! let timeline = reader.timeline().expect("the bundle is whole").clone();
//! let walk = cheapest_walk(&graph, &timeline, 5, 50).expect("every frame of the cloth leads to every other");
//! assert!(walk.transition_count() >= 1);
//!
//! // Its frames, as one animated GLB.
//! let actor = Actor::of(&reader)?;
//! let mut played = play(&mut reader, &graph, &timeline, (5, Placement::IDENTITY), &walk)?;
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("walk.glb");
//! let written = export(&actor, &mut played, &Output::Glb(path.clone()), &ExportOptions::default(), &job)?;
//! assert_eq!(written.frames, played.frames);
//! # assert!(path.metadata()?.len() > 1000);
//! # Ok(())
//! # }
//! ```
//!
//! Conventions: right-handed coordinates, +Y up, metres, seconds, radians; the ground is the XZ plane. Frames are counted
//! over the whole capture, from 0. The same input gives the same bytes, whatever the number of threads. Long work takes a
//! [`Job`]: it says how far it is, stops when it is told to, and keeps results of stages in a [`WorkFolder`].

#[cfg(feature = "mocap")]
pub mod drive;
pub mod example;
mod failure;
pub mod families;
mod found_parts;
#[cfg(feature = "variations")]
pub mod frame_maps;
pub mod hybrid;
#[cfg(feature = "scans")]
pub mod look;
mod options;
pub mod pack;
mod packed;
pub mod preflight;
mod reach;
#[cfg(feature = "scans")]
mod registered;
pub mod rigged;
#[cfg(feature = "scans")]
pub mod scan_headings;
#[cfg(feature = "scans")]
mod scan_others;
#[cfg(feature = "scans")]
mod scan_report;
#[cfg(feature = "scans")]
mod scan_source;
#[cfg(feature = "scans")]
mod scan_truth;
#[cfg(feature = "scans")]
mod scan_warnings;
#[cfg(feature = "scans")]
pub mod scan_windows;
#[cfg(feature = "scans")]
mod scan_writer;
#[cfg(feature = "scans")]
pub mod scans;
#[cfg(feature = "variations")]
pub mod transfer;
#[cfg(feature = "variations")]
mod varied_families;
#[cfg(feature = "variations")]
pub mod vary;
#[cfg(feature = "scans")]
mod windows;

pub use actor::capture::{Capture, CaptureError, Poses};
pub use actor::graph::{EssentialGraph, Transition};
pub use actor::pose_source::{PoseError, PoseSource};
pub use actor::surface::{Corner, Image, ImageFormat, Material, Part, Surface};
pub use actor::timeline::{Sequence, Timeline};
pub use actor::walk::{Leg, Walk};
pub use bundle::{BundleError, BundleReader, validate};
pub use capture_io::{export, import};
pub use job::work::WorkFolder;
pub use job::{Job, Progress, Stopped};
pub use kernels::align::Placement;
pub use kernels::topology::{Topology, barycentric_areas};
pub use pipeline::{distance, graph, transitions};
pub use rig::RigFile;
pub use search::{Answer, Direction, Request, Scene, cheapest_walk};
pub use synthesis::Synthesiser;
