//! Triangles in an order in which each lies beside one that came shortly before: then they cost little.

use std::collections::HashMap;

use glam::Vec3;

use super::ScannedGroup;

/// `group` with its triangles in an order that is cheap to store, and with corners and vertices numbered as triangles use them;
/// what no triangle uses is left out. The surface is the same.
#[must_use]
pub fn ordered(group: &ScannedGroup) -> ScannedGroup {
    let triangles = beside_each_other(&group.triangles);
    let (mut corner_of, mut vertex_of) = (vec![u32::MAX; group.corners.len()], HashMap::new());
    let (mut corners, mut vertices) = (Vec::new(), Vec::new());
    let mut number = |corner: u32| {
        let slot = &mut corner_of[corner as usize];
        if *slot == u32::MAX {
            *slot = corners.len() as u32;
            let mut corner = group.corners[corner as usize];
            let from = corner.vertex;
            corner.vertex = *vertex_of.entry(from).or_insert_with(|| {
                vertices.push(from);
                vertices.len() as u32 - 1
            });
            corners.push(corner);
        }
        *slot
    };
    let triangles = triangles.iter().map(|triangle| triangle.map(&mut number)).collect();
    let pick = |pose: &Vec<Vec3>| vertices.iter().map(|&vertex| pose[vertex as usize]).collect();
    let colours = if group.colours.is_empty() {
        Vec::new()
    } else {
        vertices.iter().map(|&vertex| group.colours[vertex as usize]).collect()
    };
    let poses = group.poses.iter().map(pick).collect();
    ScannedGroup { corners, triangles, poses, colours, ..group.clone() }
}

/// The triangles, turned but not turned over, each beside an earlier one where there is one.
fn beside_each_other(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut across: HashMap<(u32, u32), Vec<(u32, usize)>> = HashMap::new();
    for (number, triangle) in (0..).zip(triangles) {
        for side in 0..3 {
            across.entry((triangle[side], triangle[(side + 1) % 3])).or_default().push((number, side));
        }
    }
    let mut done = vec![false; triangles.len()];
    let (mut order, mut open) = (Vec::with_capacity(triangles.len()), Vec::new());
    for first in 0..triangles.len() {
        if std::mem::replace(&mut done[first], true) {
            continue;
        }
        let mut next = Some(triangles[first]);
        while let Some([a, b, c]) = next.take() {
            order.push([a, b, c]);
            // The side that the next triangle of a strip lies at comes last, for it is looked at first.
            open.extend([(b, a), (a, c), (c, b)]);
            while let (None, Some(edge)) = (next, open.pop()) {
                let beside = across.get(&edge).into_iter().flatten();
                if let Some(&(number, side)) = beside.clone().find(|(number, _)| !done[*number as usize]) {
                    done[number as usize] = true;
                    let triangle = triangles[number as usize];
                    next = Some([0, 1, 2].map(|corner| triangle[(side + corner) % 3]));
                    // There may be more than one.
                    open.push(edge);
                }
            }
        }
    }
    order
}
