//! Which frames can reach which, through the strongly connected components.

use actor::components::{Adjacency, StrongComponents, with_recorded};
use actor::timeline::Timeline;

/// Which frames reach which.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reach {
    /// Number of pairs (i, j), i != j, with no path from i to j.
    pub unreachable_pairs: u64,
    /// Frames that nothing leads on from.
    pub dead_ends: Vec<u32>,
}

/// Which frames reach which, over the same recorded steps and `edges` as `components`.
#[must_use]
pub fn reach(components: &StrongComponents, timeline: &Timeline, edges: &[(u32, u32)]) -> Reach {
    let component = |frame: u32| components.component_of_frame[frame as usize] as usize;
    let count = components.component_of_frame.iter().max().map_or(0, |&last| last as usize + 1);
    let mut sizes = vec![0_u64; count];
    components.component_of_frame.iter().for_each(|&component| sizes[component as usize] += 1);
    let mut onwards = vec![Vec::new(); count];
    let all = with_recorded(timeline, edges.iter().copied());
    for (from, to) in all.into_iter().map(|(from, to)| (component(from), component(to))) {
        if from != to {
            onwards[from].push(to as u32);
        }
    }
    onwards.iter_mut().for_each(|next| {
        next.sort_unstable();
        next.dedup();
    });
    // Each component after those that it leads to, so that what these reach is known.
    let leads = |from: usize| onwards[from].iter().map(move |&to| (from as u32, to));
    let adjacency = Adjacency::new(count as u32, (0..count).flat_map(leads));
    let mut seen = vec![false; count];
    let order: Vec<u32> = (0..count as u32).flat_map(|start| adjacency.visit(start, &mut seen)).collect();
    let words = count.div_ceil(64);
    let mut reached = vec![0_u64; count * words];
    let mut unreachable_pairs = 0;
    let mut dead_ends = Vec::new();
    let frames = components.component_of_frame.len() as u64;
    let mut reach_of = vec![0_u64; count];
    for &component in &order {
        let component = component as usize;
        let mut row = vec![0_u64; words];
        row[component / 64] |= 1 << (component % 64);
        for &next in &onwards[component] {
            let further = &reached[next as usize * words..][..words];
            row.iter_mut().zip(further).for_each(|(word, further)| *word |= further);
        }
        let members = row
            .iter()
            .enumerate()
            .flat_map(|(word, &bits)| (0..64).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| 64 * word + bit));
        reach_of[component] = members.map(|member| sizes[member]).sum::<u64>() - 1;
        unreachable_pairs += sizes[component] * (frames - 1 - reach_of[component]);
        reached[component * words..][..words].copy_from_slice(&row);
    }
    for (frame, &component) in components.component_of_frame.iter().enumerate() {
        if reach_of[component as usize] == 0 {
            dead_ends.push(frame as u32);
        }
    }
    Reach { unreachable_pairs, dead_ends }
}
