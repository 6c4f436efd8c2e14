//! Which scenes of a file are read: its own one, or, of files that hold one frame a scene, all of them.

use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked;

use super::document::Document;
use super::drawn::{Drawn, Reader};
use super::nodes::Nodes;
use crate::import::error::ImportError;
use crate::import::warning::Warning;

/// What the scenes that are read draw, in the file's order. More than one are the frames of a sequence, with the same
/// triangles in each; that happens only where nothing is animated (`still`).
pub(super) fn read(
    document: &Document,
    nodes: &Nodes,
    reader: &mut Reader<'_>,
    still: bool,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Vec<Drawn>>, ImportError> {
    let meshes = |scene: &Vec<usize>| -> Vec<usize> {
        let draws = |&&node: &&usize| document.root().nodes.get(node).is_some_and(|node| node.mesh.is_some());
        scene.iter().filter(draws).copied().collect()
    };
    let of_scenes: Vec<Vec<usize>> = nodes.scenes.iter().map(meshes).collect();
    let own = &of_scenes[nodes.scene];
    let shape = shape(document, own);
    let others = of_scenes.iter().enumerate().filter(|(k, _)| *k != nodes.scene);
    let may_be_frames = still && others.clone().all(|(_, other)| other != own && self::shape(document, other) == shape);
    let told = |warnings: &mut Vec<Warning>, what: &str| {
        let message = format!("{}: it holds {} scenes: {what}", document.path().display(), of_scenes.len());
        warnings.push(Warning::new("W_GLTF_SCENES", message));
    };
    let mut read = |scene: &Vec<usize>, warnings: &mut Vec<Warning>| -> Result<Vec<Drawn>, ImportError> {
        let drawn = scene.iter().map(|&node| reader.read(node, warnings));
        Ok(drawn.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    };
    if of_scenes.len() > 1 && may_be_frames {
        let mut frames = Vec::new();
        for scene in &of_scenes {
            frames.push(read(scene, warnings)?);
        }
        if frames.iter().all(|frame| same_triangles(frame, &frames[0])) {
            told(warnings, "they have the same triangles, and are read as the frames of one sequence");
            return Ok(frames);
        }
        told(warnings, "their triangles differ, so only its own one is read");
        return Ok(vec![frames.swap_remove(nodes.scene)]);
    }
    if others.clone().any(|(_, other)| other.iter().any(|node| !own.contains(node))) {
        told(warnings, "only its own one is read");
    }
    Ok(vec![read(own, warnings)?])
}

/// Numbers of vertices and indices of all primitives of `scene`, as the accessors have them: equal where two scenes may
/// hold the same triangles.
fn shape(document: &Document, scene: &[usize]) -> Vec<[Option<u64>; 2]> {
    let root = document.root();
    let meshes = scene.iter().filter_map(|&node| root.get(root.nodes.get(node)?.mesh?));
    let count = |index| root.get(index).map(|accessor: &gltf::json::Accessor| accessor.count.0);
    meshes
        .flat_map(|mesh| &mesh.primitives)
        .map(|primitive| {
            let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            [positions.copied().and_then(count), primitive.indices.and_then(count)]
        })
        .collect()
}

/// Whether two scenes draw the same triangles over the same numbers of vertices.
fn same_triangles(a: &[Drawn], b: &[Drawn]) -> bool {
    let shapes = |drawn: &[Drawn]| -> Vec<(usize, usize)> {
        let pieces = drawn.iter().flat_map(|drawn| &drawn.pieces);
        pieces.map(|piece| (piece.shape.len(), piece.triangles.len())).collect()
    };
    let triangles = |drawn: &'_ [Drawn]| -> Vec<[u32; 3]> {
        drawn.iter().flat_map(|drawn| &drawn.pieces).flat_map(|piece| piece.triangles.iter().copied()).collect()
    };
    shapes(a) == shapes(b) && triangles(a) == triangles(b)
}
