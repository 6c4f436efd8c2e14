//! Which of a file's clips are sequences: those that move what is drawn, and pieces of one clip together.

use std::collections::HashSet;

use super::animation::Clip;
use super::channel::{Channel, Property};
use super::document::Document;
use super::drawn::Drawn;
use super::nodes::Nodes;
use super::shape::Joints;
use crate::import::error::ImportError;
use crate::import::warning::Warning;

/// The clips that move something that is drawn; sentences about the others.
pub(super) fn moving<'d>(
    clips: Vec<Clip>,
    document: &Document,
    nodes: &Nodes,
    skins: &[Joints],
    drawn: impl Iterator<Item = &'d Drawn>,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Clip>, ImportError> {
    // What moves a mesh: its node and those above, or, where it is skinned, the joints and those above.
    let mut movers = vec![false; nodes.rest.len()];
    let mut targets = vec![0; nodes.rest.len()];
    for Drawn { node, skin, pieces, .. } in drawn {
        targets[*node] = pieces.iter().map(|piece| piece.shape.target_count()).fold(targets[*node], usize::max);
        let joints = skin.and_then(|skin| skins.get(skin)).map_or(&[][..], Joints::nodes);
        // A mesh that is skinned ignores its node, but is hidden with it; so the node counts for all.
        let ends = joints.iter().copied().chain([*node]);
        ends.flat_map(|end| nodes.upwards(end)).for_each(|node| movers[node] = true);
    }
    let mut kept = Vec::new();
    for clip in clips {
        let too_few = |c: &&Channel| c.property == Property::Weights && c.width < targets[c.node];
        if let Some(channel) = clip.channels.iter().find(too_few) {
            let reason = format!(
                "clip \"{}\" has {} weights for the {} morph targets of {}",
                clip.name,
                channel.width,
                targets[channel.node],
                nodes.name(channel.node)
            );
            return Err(document.wrong(reason));
        }
        let moves =
            |property, node: usize| if property == Property::Weights { targets[node] > 0 } else { movers[node] };
        if clip.channels.iter().any(|channel| moves(channel.property, channel.node)) {
            kept.push(clip);
            continue;
        }
        warnings.push(Warning::new(
            "W_GLTF_CLIP_EMPTY",
            format!(
                "{}: clip \"{}\" moves nothing that is drawn and is left out",
                document.path().display(),
                clip.name
            ),
        ));
    }
    let sheared = |channel: &&Channel| nodes.rest[channel.node].is_sheared() && movers[channel.node];
    if let Some(channel) = kept.iter().flat_map(|clip| &clip.channels).find(sheared) {
        warnings.push(Warning::new(
            "W_GLTF_MATRIX",
            format!(
                "{}: {} is animated although it has a matrix with a shear: the shear is left out where it moves",
                document.path().display(),
                nodes.name(channel.node)
            ),
        ));
    }
    Ok(kept)
}

/// Several animations that are the pieces of one clip, because none has a name and no two move the same thing, become
/// one, `stem`; clips with names that look like such pieces are told.
pub(super) fn join(clips: Vec<Clip>, document: &Document, stem: &str, warnings: &mut Vec<Warning>) -> Vec<Clip> {
    let path = document.path().display();
    let moved = |clip: &Clip| -> HashSet<(usize, Property)> {
        clip.channels.iter().map(|channel| (channel.node, channel.property)).collect()
    };
    let mut together = HashSet::new();
    let apart = clips.iter().flat_map(moved).all(|target| together.insert(target));
    if clips.len() > 1 && apart && clips.iter().all(|clip| !clip.named) {
        warnings.push(Warning::new(
            "W_GLTF_CLIPS_JOINED",
            format!(
                "{path}: {} unnamed animations move a node each: they are read as one clip, \"{stem}\"",
                clips.len()
            ),
        ));
        let channels = clips.into_iter().flat_map(|clip| clip.channels).collect();
        return vec![Clip::new(stem.to_owned(), channels, false)];
    }
    let pair = clips.iter().enumerate().flat_map(|(k, a)| clips[k + 1..].iter().map(move |b| (a, b)));
    let same_time = |a: &Clip, b: &Clip| (a.start - b.start).abs() < 1e-3 && (a.end - b.end).abs() < 1e-3;
    let mut pieces = pair.filter(|(a, b)| same_time(a, b) && a.end > a.start && moved(a).is_disjoint(&moved(b)));
    if let Some((a, b)) = pieces.next() {
        warnings.push(Warning::new(
            "W_GLTF_CLIPS_APART",
            format!(
                "{path}: \"{}\" and \"{}\" last equally long and move different things: if they belong together, export \
                 them as one animation (in Blender: tracks of one name)",
                a.name, b.name
            ),
        ));
    }
    clips
}
