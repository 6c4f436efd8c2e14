//! The recorded frames that a transition blends.

use actor::graph::Transition;
use actor::timeline::Timeline;

/// The recorded frames that each node of a transition blends: that of the source, that of the destination. A frame on which a side pauses
/// is there several times.
pub(crate) fn nodes(timeline: &Timeline, transition: &Transition) -> Vec<[u32; 2]> {
    let length = transition.warp.lengths().1 as i64;
    let frames = transition.warp.nodes().filter_map(|(n, m)| {
        let source = timeline.offset(transition.from, n as i64)?;
        Some([source, timeline.offset(transition.to, 1 - length + m as i64)?])
    });
    frames.collect()
}

/// The same of each side, each frame once.
pub(crate) fn sides(timeline: &Timeline, transition: &Transition) -> [Vec<u32>; 2] {
    let nodes = nodes(timeline, transition);
    [0, 1].map(|side| {
        let mut frames: Vec<u32> = nodes.iter().map(|node| node[side]).collect();
        frames.dedup();
        frames
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::temporal_warp::{Move, TemporalWarp};
    use actor::timeline::Sequence;
    use kernels::align::Placement;

    #[test]
    fn nodes_are_those_of_the_warp_and_sides_have_each_frame_once() {
        let sequence = |name: &str, first_frame: u32| {
            let cyclic = false;
            Sequence { name: name.into(), labels: vec![], first_frame, frame_count: 10, cyclic }
        };
        let timeline = Timeline::new(25.0, vec![sequence("a", 0), sequence("b", 10)]).unwrap();
        // The destination waits for the source, and then goes on with it.
        let warp = TemporalWarp::new(vec![Move::Source, Move::Both]);
        let transition =
            Transition { from: 4, to: 15, deformation: 0.0, warp, placement: Placement::IDENTITY, turn: 0.0 };
        assert_eq!(nodes(&timeline, &transition), [[4, 14], [5, 14], [6, 15]]);
        assert_eq!(sides(&timeline, &transition), [vec![4, 5, 6], vec![14, 15]]);
        // What lies beyond the end of its sequence was not recorded.
        let late = Transition { from: 8, ..transition };
        assert_eq!(nodes(&timeline, &late), [[8, 14], [9, 14]]);
    }
}
