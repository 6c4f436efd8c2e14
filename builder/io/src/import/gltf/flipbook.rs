//! Flip-books: meshes that are shown in turn, one a frame, by scales of 0 or by `KHR_node_visibility`. Where they share
//! their triangles they are one mesh that moves; where not, they are no capture, and the file is refused with a sentence.

use std::collections::HashMap;

use super::animation::Clip;
use super::channel::{Channel, Interpolation, Property};
use super::document::Document;
use super::drawn::Drawn;
use super::nodes::{Nodes, Transform};
use super::shape::Joints;
use crate::import::error::ImportError;
use crate::import::warning::Warning;

/// A mesh scaled to less than this part of its size is hidden.
const HIDDEN: f32 = 0.01;
/// Keyframes of different nodes this many seconds apart mean the same time.
const SAME_TIME: f64 = 1e-3;
/// Most nodes looked at, over all times.
const MAX_LOOKS: usize = 1 << 28;

/// Meshes of the same triangles of which always the same number is shown.
pub(super) struct Book {
    /// The meshes, as indices of what is drawn, in the file's order.
    pub pages: Vec<usize>,
    /// How many of them are shown at a time.
    pub shown: usize,
}

/// What is shown when.
#[derive(Default)]
pub(super) struct Shown {
    /// The flip-books.
    pub books: Vec<Book>,
    /// What is drawn but never shown, as indices.
    pub never: Vec<usize>,
    /// For each drawn mesh its largest extent, against which it counts as hidden.
    largest: Vec<f32>,
}

/// The meshes that some clip hides, and for each time of each clip whether they are shown.
struct Survey {
    candidates: Vec<usize>,
    /// Clip, time in seconds, and whether each candidate is shown.
    looks: Vec<(usize, f64, Vec<bool>)>,
}

impl Shown {
    /// Finds the flip-books among `drawn`.
    ///
    /// # Errors
    /// Meshes that are shown in turn but have different triangles, or that are not all there.
    pub fn find(
        document: &Document,
        nodes: &Nodes,
        skins: &[Joints],
        clips: &[Clip],
        drawn: &[Drawn],
        warnings: &mut Vec<Warning>,
    ) -> Result<Self, ImportError> {
        let (survey, largest) = Survey::take(document, nodes, skins, clips, drawn)?;
        let mut rest: Vec<usize> = (0..survey.candidates.len()).collect();
        let (mut books, mut uneven) = (Vec::new(), Vec::new());
        for group in survey.of_same_triangles(drawn) {
            let [least, most] = survey.range(&group);
            let turns = group.len() > 1 && most < group.len();
            if turns && least == most && most > 0 {
                rest.retain(|candidate| !group.contains(candidate));
                books.push(Book { pages: group.iter().map(|&c| survey.candidates[c]).collect(), shown: most });
            } else {
                uneven.push(group);
            }
        }
        if rest.len() > 2 && survey.range(&rest) == [1, 1] {
            return Err(survey.different(document, nodes, drawn, &uneven));
        }
        if let Some(group) = uneven.iter().find(|group| group.len() > 2 && survey.mostly_hidden(group)) {
            return Err(survey.unsteady(document, clips, group));
        }
        for book in &books {
            warnings.push(Warning::new(
                "W_GLTF_FLIPBOOK",
                format!(
                    "{}: {} meshes with the same triangles are shown in turn: they are read as one mesh that moves",
                    document.path().display(),
                    book.pages.len()
                ),
            ));
        }
        survey.warn_about_hidden(document, nodes, drawn, &rest, warnings);
        let in_a_book = |d: &usize| books.iter().any(|book: &Book| book.pages.contains(d));
        let never = (0..drawn.len()).filter(|d| largest[*d] == 0.0 && !in_a_book(d)).collect();
        Ok(Self { books, never, largest })
    }

    /// The pages of `book` that are shown for the local transforms `transforms`, as positions in its list.
    pub fn pages(
        &self,
        book: &Book,
        nodes: &Nodes,
        skins: &[Joints],
        drawn: &[(usize, Option<usize>)],
        transforms: &[Transform],
    ) -> Vec<usize> {
        let extents = Extents::new(nodes, skins, transforms);
        let shown = |&(_, &d): &(usize, &usize)| {
            let Some(&(node, skin)) = drawn.get(d) else { return false };
            extents.of(node, skin) > HIDDEN * self.largest.get(d).copied().unwrap_or(0.0)
        };
        book.pages.iter().enumerate().filter(shown).map(|(k, _)| k).collect()
    }

    /// Makes the scales that turn the pages of the books switches: an exporter that knows no steps writes lines between
    /// one keyframe and the next, and half a page is never meant.
    pub fn settle(&self, nodes: &Nodes, drawn: &[Drawn], clips: &mut [Clip]) {
        let pages = self.books.iter().flat_map(|book| &book.pages);
        let turners: Vec<usize> = pages.flat_map(|&d| nodes.upwards(drawn[d].node)).collect();
        for channel in clips.iter_mut().flat_map(|clip| &mut clip.channels) {
            if channel.interpolation != Interpolation::Step && turners.contains(&channel.node) && is_switch(channel) {
                channel.interpolation = Interpolation::Nearest;
            }
        }
    }
}

impl Survey {
    /// Looks at all meshes that some clip hides, at all keyframes of what hides them; and the largest extent of every
    /// mesh.
    fn take(
        document: &Document,
        nodes: &Nodes,
        skins: &[Joints],
        clips: &[Clip],
        drawn: &[Drawn],
    ) -> Result<(Self, Vec<f32>), ImportError> {
        let mut hiders = vec![false; nodes.rest.len()];
        clips.iter().flat_map(|clip| &clip.channels).filter(|c| hides(c)).for_each(|c| hiders[c.node] = true);
        let moved_by = |drawn: &Drawn| -> Vec<usize> {
            let skin = drawn.skin.and_then(|skin| skins.get(skin));
            skin.map_or(&[][..], Joints::nodes).iter().copied().chain([drawn.node]).collect()
        };
        let hidden_by_some = |d: usize| moved_by(&drawn[d]).iter().any(|&n| nodes.upwards(n).any(|n| hiders[n]));
        let all: Vec<usize> = (0..drawn.len()).collect();
        let measure = |transforms: &[Transform], which: &[usize]| -> Vec<f32> {
            let extents = Extents::new(nodes, skins, transforms);
            which.iter().map(|&d| extents.of(drawn[d].node, drawn[d].skin)).collect()
        };
        let mut largest = measure(&nodes.rest, &all);
        let candidates: Vec<usize> = (0..drawn.len()).filter(|&d| largest[d] == 0.0 || hidden_by_some(d)).collect();

        let mut times = Vec::new();
        for (clip_index, clip) in clips.iter().enumerate().filter(|_| !candidates.is_empty()) {
            times.extend(key_times(clip, &hiders).into_iter().map(|time| (clip_index, time)));
        }
        if times.len().saturating_mul(nodes.rest.len()) > MAX_LOOKS {
            let reason = format!("{} keyframes show and hide its meshes", times.len());
            return Err(ImportError::TooLarge { path: document.path().to_owned(), reason });
        }
        let mut measured = Vec::new();
        for (clip, time) in times {
            let extents = measure(&clips[clip].apply(time, SAME_TIME, &nodes.rest).transforms, &candidates);
            for (&d, &extent) in candidates.iter().zip(&extents) {
                largest[d] = largest[d].max(extent);
            }
            measured.push((clip, time, extents));
        }
        let shown = |extents: Vec<f32>| -> Vec<bool> {
            candidates.iter().zip(extents).map(|(&d, extent)| extent > HIDDEN * largest[d]).collect()
        };
        let looks = measured.into_iter().map(|(clip, time, extents)| (clip, time, shown(extents))).collect();
        Ok((Self { candidates, looks }, largest))
    }

    /// Candidates in groups of the same triangles, without those that are never shown.
    fn of_same_triangles(&self, drawn: &[Drawn]) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut known = HashMap::new();
        let ever_shown = |(candidate, _): &(usize, &usize)| self.looks.iter().any(|(_, _, look)| look[*candidate]);
        for (candidate, &d) in self.candidates.iter().enumerate().filter(ever_shown) {
            let pieces = drawn[d].pieces.iter();
            let shape: Vec<_> = pieces.map(|piece| (piece.shape.len(), piece.triangles.as_slice())).collect();
            let group = *known.entry(shape).or_insert(groups.len());
            if group == groups.len() {
                groups.push(Vec::new());
            }
            groups[group].push(candidate);
        }
        groups
    }

    fn count(&self, group: &[usize], look: &[bool]) -> usize {
        group.iter().filter(|&&candidate| look[candidate]).count()
    }

    /// The least and the largest number of `group` that is shown at a time.
    fn range(&self, group: &[usize]) -> [usize; 2] {
        let counts = || self.looks.iter().map(|(_, _, look)| self.count(group, look));
        [counts().min().unwrap_or(0), counts().max().unwrap_or(0)]
    }

    /// Whether each of `group` is hidden at more times than it is shown.
    fn mostly_hidden(&self, group: &[usize]) -> bool {
        let shown = |candidate: usize| self.looks.iter().filter(|(_, _, look)| look[candidate]).count();
        group.iter().all(|&candidate| 2 * shown(candidate) < self.looks.len())
    }

    /// An error about meshes in turn of which not always the same number is shown.
    fn unsteady(&self, document: &Document, clips: &[Clip], group: &[usize]) -> ImportError {
        let odd = self.looks.iter().find(|(_, _, look)| self.count(group, look) != 1);
        let (name, time, count) = odd.map_or(("", 0.0, 0), |(clip, time, look)| {
            (clips.get(*clip).map_or("", |clip| clip.name.as_str()), *time, self.count(group, look))
        });
        let reason = format!(
            "{} meshes with the same triangles are shown in turn, but at {time:.3} s of clip \"{name}\" {count} of them are \
             shown",
            group.len()
        );
        ImportError::ChangingMesh { path: document.path().to_owned(), reason }
    }

    /// An error about meshes in turn that have different triangles; each of `groups` has its own.
    fn different(&self, document: &Document, nodes: &Nodes, drawn: &[Drawn], groups: &[Vec<usize>]) -> ImportError {
        let told = |group: &Vec<usize>| {
            let mesh = group.first().and_then(|&candidate| drawn.get(self.candidates[candidate]));
            mesh.map_or(String::new(), |mesh| {
                let triangles: usize = mesh.pieces.iter().map(|piece| piece.triangles.len()).sum();
                let vertices: usize = mesh.pieces.iter().map(|piece| piece.shape.len()).sum();
                format!("{} has {triangles} triangles over {vertices} vertices", nodes.name(mesh.node))
            })
        };
        let reason = format!(
            "{} meshes are shown in turn, and their triangles differ: {}",
            groups.iter().map(Vec::len).sum::<usize>(),
            groups.iter().take(2).map(told).collect::<Vec<_>>().join(", ")
        );
        ImportError::ChangingMesh { path: document.path().to_owned(), reason }
    }

    fn warn_about_hidden(
        &self,
        document: &Document,
        nodes: &Nodes,
        drawn: &[Drawn],
        rest: &[usize],
        warnings: &mut Vec<Warning>,
    ) {
        let sometimes = |&&candidate: &&usize| {
            let mut shown = self.looks.iter().map(|(_, _, look)| look[candidate]);
            shown.clone().any(|shown| shown) && shown.any(|shown| !shown)
        };
        let hidden: Vec<&usize> = rest.iter().filter(sometimes).collect();
        // Where all is hidden at once, reading names the frame.
        let lasting = drawn.len() > hidden.len();
        if let Some(first) = hidden.first().filter(|_| lasting) {
            warnings.push(Warning::new(
                "W_GLTF_HIDDEN",
                format!(
                    "{}: {} of its meshes are hidden at times, the first {}: the capture keeps their triangles in all \
                     frames, as points where their scale is 0",
                    document.path().display(),
                    hidden.len(),
                    nodes.name(drawn[self.candidates[**first]].node)
                ),
            ));
        }
    }
}

/// How large nodes make what they draw; 0 where they hide it.
struct Extents<'a> {
    skins: &'a [Joints],
    of_nodes: Vec<f32>,
    shown: Vec<bool>,
}

impl<'a> Extents<'a> {
    fn new(nodes: &Nodes, skins: &'a [Joints], transforms: &[Transform]) -> Self {
        let longest = |world: glam::Mat4| {
            let axes = [world.x_axis, world.y_axis, world.z_axis];
            axes.iter().map(|axis| axis.truncate().length()).fold(0.0, f32::max)
        };
        let of_nodes = nodes.world_from_nodes(transforms).into_iter().map(longest).collect();
        Self { skins, of_nodes, shown: nodes.shown(transforms) }
    }

    fn of(&self, node: usize, skin: Option<usize>) -> f32 {
        if !self.shown.get(node).copied().unwrap_or(true) {
            return 0.0;
        }
        let extent = |node: usize| self.of_nodes.get(node).copied().unwrap_or(0.0);
        match skin.and_then(|skin| self.skins.get(skin)) {
            Some(skin) => skin.nodes().iter().map(|&joint| extent(joint)).fold(0.0, f32::max),
            None => extent(node),
        }
    }
}

/// The size of a scale at each keyframe; of a visibility, 1 or 0.
fn sizes(channel: &Channel) -> impl Iterator<Item = f32> {
    let size = |value: &[f32]| value.iter().fold(0.0_f32, |size, v| size.max(v.abs()));
    (0..channel.times.len()).map(move |key| size(channel.value(key)))
}

/// Whether a channel hides its node at some of its keyframes.
fn hides(channel: &Channel) -> bool {
    let largest = sizes(channel).fold(0.0, f32::max);
    match channel.property {
        Property::Scale => sizes(channel).any(|size| size <= HIDDEN * largest),
        Property::Visible => sizes(channel).any(|size| size == 0.0),
        _ => false,
    }
}

/// Whether a channel's scales are all either full or hidden.
fn is_switch(channel: &Channel) -> bool {
    let largest = sizes(channel).fold(0.0, f32::max);
    channel.property == Property::Scale
        && sizes(channel).all(|size| size <= HIDDEN * largest || size >= (1.0 - HIDDEN) * largest)
}

/// The times at which a clip shows or hides something, ascending; its beginning where it does not.
fn key_times(clip: &Clip, hiders: &[bool]) -> Vec<f64> {
    let turning = |channel: &&Channel| {
        matches!(channel.property, Property::Scale | Property::Visible) && hiders.get(channel.node) == Some(&true)
    };
    let mut times: Vec<f64> =
        clip.channels.iter().filter(turning).flat_map(|c| c.times.iter().copied().map(f64::from)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup_by(|later, earlier| *later - *earlier < SAME_TIME);
    if times.is_empty() { vec![clip.start] } else { times }
}
