//! Welding: file vertices that share a position in every frame become one vertex of the topology.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

/// Welds `frames` of `vertex_count` file vertices each, laid one after the other.
///
/// Vertices closer than `tolerance` metres in the first frame are put together, and every other frame is asked
/// whether they stay together; where they part, so does the weld. In the end every file vertex lies within
/// `tolerance` of its representative in every frame. Returns the representative (a file vertex, the lowest of its
/// group) of each file vertex.
pub(super) fn weld(frames: &[Vec3], vertex_count: usize, tolerance: f64) -> Vec<u32> {
    let mut frames_iter = frames.chunks_exact(vertex_count.max(1));
    let Some(first) = frames_iter.next() else { return (0..vertex_count as u32).collect() };
    let mut representative = group(first, &(0..vertex_count as u32).collect::<Vec<_>>(), tolerance);
    if representative.iter().enumerate().all(|(v, &r)| v == r as usize) {
        return representative;
    }
    // Splitting a group may put vertices together that parted in an earlier frame, so ask until nothing changes.
    let mut changed = true;
    while changed {
        changed = false;
        for frame in frames.chunks_exact(vertex_count) {
            changed |= split(frame, &mut representative, tolerance);
        }
    }
    representative
}

/// Splits the groups that part in `frame`; whether there were any.
fn split(frame: &[Vec3], representative: &mut [u32], tolerance: f64) -> bool {
    let parted: Vec<u32> = (0..frame.len() as u32)
        .filter(|&v| !near(frame[v as usize], frame[representative[v as usize] as usize], tolerance))
        .collect();
    // Those that left one group together may still belong together.
    let mut leavers: HashMap<u32, Vec<u32>> = HashMap::new();
    for &v in &parted {
        leavers.entry(representative[v as usize]).or_default().push(v);
    }
    for group in leavers.values() {
        let mut leaders: Vec<u32> = Vec::new();
        for &v in group {
            let leader = leaders.iter().find(|&&l| near(frame[v as usize], frame[l as usize], tolerance));
            representative[v as usize] = leader.copied().unwrap_or(v);
            if leader.is_none() {
                leaders.push(v);
            }
        }
    }
    !parted.is_empty()
}

/// For each of `vertices` the first of them within `tolerance` in `frame` that is its own representative.
fn group(frame: &[Vec3], vertices: &[u32], tolerance: f64) -> Vec<u32> {
    // Cells must hold few leaders, and their numbers must fit an integer exactly.
    let extent = frame.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
    let cell_size = tolerance.max(f64::from(extent) * 1e-12).max(f64::MIN_POSITIVE);
    let cell_of = |p: DVec3| (p / cell_size).floor().as_i64vec3();
    let mut leaders: HashMap<[i64; 3], Vec<u32>> = HashMap::with_capacity(vertices.len());
    vertices
        .iter()
        .map(|&v| {
            let p = frame[v as usize];
            let low = cell_of(p.as_dvec3() - tolerance);
            let high = cell_of(p.as_dvec3() + tolerance);
            let mut best = v;
            for x in low.x..=high.x {
                for y in low.y..=high.y {
                    for z in low.z..=high.z {
                        let near_by = leaders.get(&[x, y, z]).into_iter().flatten();
                        let found = near_by.copied().filter(|&l| near(p, frame[l as usize], tolerance)).min();
                        best = best.min(found.unwrap_or(v));
                    }
                }
            }
            if best == v {
                leaders.entry(cell_of(p.as_dvec3()).to_array()).or_default().push(v);
            }
            best
        })
        .collect()
}

fn near(a: Vec3, b: Vec3, tolerance: f64) -> bool {
    a.as_dvec3().distance_squared(b.as_dvec3()) <= tolerance * tolerance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_that_part_later_are_not_welded() {
        // Lips: upper 0 and 2 (a seam), lower 1 and 3, closed in the first frame; 4 is elsewhere.
        let closed = [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::X];
        let open = [Vec3::Y, -Vec3::Y, Vec3::Y, -Vec3::Y, Vec3::X];
        let frames: Vec<Vec3> = [closed, closed, open, closed].concat();
        assert_eq!(weld(&frames, 5, 1e-5), [0, 1, 0, 1, 4]);
        assert_eq!(weld(&frames[..5], 5, 1e-5), [0, 0, 0, 0, 4]);
    }

    #[test]
    fn every_vertex_stays_near_its_representative() {
        // A chain of steps smaller than the tolerance must not weld end to end.
        let frame: Vec<Vec3> = (0..50).map(|k| Vec3::X * k as f32 * 0.4e-3).collect();
        let moved: Vec<Vec3> = frame.iter().map(|p| Vec3::new(p.x * 1.7, 1.0, -3.0)).collect();
        let frames = [frame, moved].concat();
        let representative = weld(&frames, 50, 1e-3);
        for frame in frames.chunks_exact(50) {
            for (v, &r) in representative.iter().enumerate() {
                assert!(r as usize <= v && representative[r as usize] == r);
                assert!(near(frame[v], frame[r as usize], 1e-3));
            }
        }
        assert!(representative[1] == 0 && representative[49] != 0);
    }

    #[test]
    fn zero_tolerance_welds_equal_positions_only() {
        let frame = [Vec3::ZERO, Vec3::new(-0.0, 0.0, 0.0), Vec3::new(1e-30, 0.0, 0.0)];
        assert_eq!(weld(&frame, 3, 0.0), [0, 0, 2]);
    }
}
