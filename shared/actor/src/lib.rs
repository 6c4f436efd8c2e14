//! What an actor is: the data that every side works with.
//!
//! A capture becomes an actor once its sequences ([`timeline`]), what is drawn ([`surface`]), its poses ([`capture`],
//! [`pose_source`]), what stands on the ground ([`contacts`], [`feet`]), which parts hold together ([`ties`]), what its surface carries ([`carry`]), how it moves over the ground ([`motion`], [`ground`]) and its
//! transitions ([`temporal_warp`], [`graph`]) are known; [`families`] says which sequences do the same, faster or slower; [`files`] remembers what it was read from. A [`walk`] is a way through the
//! graph; [`blend`] says where on the ground both sides of a transition are, and [`components`] which frames lead to which.
//! Searches, synthesis and the file format all build on this and on nothing of each other.
//!
//! Documents from outside are read by [`json`].
//!
//! This crate does no input or output and knows no GPU, no thread and no page.
//!
//! Conventions: right-handed coordinates, +Y up, metres, seconds, radians; the ground is the XZ plane; vectors are
//! columns. Frames are counted over the whole capture (all sequences of one subject, one after another), from 0.

pub mod alternatives;
pub mod blend;
pub mod capture;
pub mod carry;
pub mod components;
pub mod contacts;
pub mod families;
pub mod feet;
pub mod files;
pub mod graph;
pub mod ground;
mod hold;
pub mod json;
pub mod motion;
pub mod pose_source;
pub mod surface;
pub mod temporal_warp;
pub mod ties;
pub mod timeline;
pub mod walk;
