//! Registration: one template mesh is moved through all frames of a scan, of which each has its own mesh.
//!
//! ```text
//! scans -> Surface -> descriptors -> dissimilarity, turn -> tree -> track along it -> checks, detail -> one topology
//!                                                             ^ template, deformation graphs
//! ```
//!
//! This work is based on: F. Prada et al., *Motion Graphs for Unstructured Textured Meshes*, 2016, sections 4 and A.1, for
//! descriptors and the tree; R. Sumner et al., *Embedded Deformation for Shape Manipulation*, 2007, and H. Li et al., *Robust
//! Single-View Geometry and Motion Reconstruction*, 2009, for the deformation.
//!
//! Lengths are metres, +Y is up. What a length of this crate's own means is that of a person: bodies of another size are
//! measured by the square root of their area ([`template::Template::scale`]).

pub mod candidates;
mod carried;
pub mod checks;
pub mod colouring;
pub mod cut;
pub mod cycle;
pub mod descriptor;
pub mod detail;
pub mod dissimilarity;
pub mod energy;
pub mod far;
pub mod flare;
pub mod graph;
pub mod groups;
pub mod headings;
mod join;
pub mod projection;
pub mod register;
mod registrar;
pub mod round;
pub mod scan;
pub mod slip;
pub mod surface;
mod survey;
pub mod template;
pub mod track;
mod tracked;
pub mod transport;
pub mod tree;
pub mod twists;
pub mod unite;
mod ways;
pub mod windows;
pub mod written;
