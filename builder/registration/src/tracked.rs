//! What tracking finds, and who is given it.

use std::collections::BTreeMap;

use glam::Vec3;

use super::checks::Fit;
use super::survey::{Lost, Source};
use super::template::Template;
use super::track::Target;

/// A frame that was tracked.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracked {
    /// The frame.
    pub frame: usize,
    /// The frame that it was tracked from; none for the template's own.
    pub parent: Option<usize>,
    /// How the template lies on it, without detail.
    pub fit: Fit,
    /// From how many frames it was tried.
    pub tries: usize,
    /// Whether it followed its parent, of which every point is known, instead of being tracked.
    pub followed: bool,
    /// The frame of another template, by which it was found that this one belongs here; none where it was tracked by itself.
    pub through: Option<usize>,
}

/// A frame just tracked, for whoever writes it.
#[derive(Debug)]
pub struct Found<'a, X> {
    /// The template.
    pub template: &'a Template,
    /// What was found.
    pub tracked: &'a Tracked,
    /// The template's pose on the frame, with detail.
    pub pose: &'a [Vec3],
    /// The frame's surface, ready for closest points.
    pub target: &'a Target,
    /// Texture coordinates of the corners of its triangles; empty where there are none.
    pub uvs: &'a [[glam::Vec2; 3]],
    /// What else it holds.
    pub extra: X,
}

/// Who is given every frame that is tracked, from many threads at once.
pub type Emit<'a, S> = &'a (dyn Fn(Found<'_, <S as Source>::Extra>) -> Result<(), <S as Source>::Error> + Sync);

/// What became of all frames.
#[derive(Clone, Debug)]
pub struct Registered {
    /// The frames that were tracked, in order.
    pub tracked: Vec<Tracked>,
    /// The frames that were lost, in order, and why.
    pub lost: Vec<(usize, Lost)>,
    /// The template's pose on each frame of `tracked`, without detail.
    pub poses: BTreeMap<usize, Vec<Vec3>>,
    /// The first frames of sequences whose colours have nothing to do with the template's: these were found by their shape alone.
    pub recoloured: Vec<usize>,
}
