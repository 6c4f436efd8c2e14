//! What is joined to a recording, and edits of it that are tried.

use driving::plant::Free;
use driving::{Aim, Body};
use glam::Vec3;
use serde::Serialize;

/// What an end was edited by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EditedBy {
    /// The clip's bones, before feet were planted.
    Bones,
    /// The surface, by the rig.
    Surface,
}

/// Makes driven frames with their ends edited towards recorded postures; nothing where they cannot be made.
pub type Remake<'a> = dyn Fn(&[Aim]) -> Option<Vec<Vec<Vec3>>> + 'a;

/// Frames that are joined to a recording, and how they are made again.
#[derive(Clone, Copy)]
pub struct DrivenFrames<'a> {
    /// What they are called.
    pub name: &'a str,
    /// The actor.
    pub body: &'a Body,
    /// The frames as they were driven.
    pub poses: &'a [Vec<Vec3>],
    /// What its bones do in them before feet are planted.
    pub free: &'a Free,
    /// The same frames with their ends edited towards recorded postures; nothing where they cannot be made.
    pub remade: &'a Remake<'a>,
}

/// An edit that was tried: its frames from the first one on, and what it is.
pub(super) struct Tried {
    /// A frame of the whole capture.
    pub first: u32,
    /// The frames from there on.
    pub poses: Vec<Vec<Vec3>>,
    /// What was edited.
    pub by: EditedBy,
    /// The edit, where it is one of bones.
    pub aim: Option<Aim>,
}
