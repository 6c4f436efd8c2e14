//! Strongly connected components: which frames can reach each other.

use actor::timeline::Timeline;

/// The strongly connected components of a graph over frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// The component of each frame, numbered by first frame.
    pub component_of_frame: Vec<u32>,
    /// The component of the most frames; of several, the one of the first frame.
    pub largest: u32,
}

impl Components {
    /// The frames of the largest component, in order: from each, every other can be reached.
    pub fn largest_frames(&self) -> impl Iterator<Item = u32> {
        let frames = self.component_of_frame.iter().enumerate();
        frames.filter(|&(_, &component)| component == self.largest).map(|(frame, _)| frame as u32)
    }

    /// Which frames reach which, over the same recorded steps and `edges` as these components.
    #[must_use]
    pub fn reach(&self, timeline: &Timeline, edges: &[(u32, u32)]) -> Reach {
        let component = |frame: u32| self.component_of_frame[frame as usize] as usize;
        let count = self.component_of_frame.iter().max().map_or(0, |&last| last as usize + 1);
        let mut sizes = vec![0_u64; count];
        self.component_of_frame.iter().for_each(|&component| sizes[component as usize] += 1);
        let recorded = (0..timeline.frame_count()).filter_map(|frame| Some((frame, timeline.next(frame)?)));
        let mut onwards = vec![Vec::new(); count];
        for (from, to) in recorded.chain(edges.iter().copied()).map(|(from, to)| (component(from), component(to))) {
            if from != to {
                onwards[from].push(to as u32);
            }
        }
        onwards.iter_mut().for_each(|next| {
            next.sort_unstable();
            next.dedup();
        });
        // Each component after those that it leads to, so that what these reach is known.
        let mut order = Vec::with_capacity(count);
        let mut seen = vec![false; count];
        (0..count as u32).for_each(|start| visit(&onwards, start, &mut seen, &mut order));
        let words = count.div_ceil(64);
        let mut reached = vec![0_u64; count * words];
        let mut unreachable_pairs = 0;
        let mut dead_ends = Vec::new();
        let frames = self.component_of_frame.len() as u64;
        let mut reach_of = vec![0_u64; count];
        for &component in &order {
            let component = component as usize;
            let mut row = vec![0_u64; words];
            row[component / 64] |= 1 << (component % 64);
            for &next in &onwards[component] {
                let further = &reached[next as usize * words..][..words];
                row.iter_mut().zip(further).for_each(|(word, further)| *word |= further);
            }
            let members = row.iter().enumerate().flat_map(|(word, &bits)| {
                (0..64).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| 64 * word + bit)
            });
            reach_of[component] = members.map(|member| sizes[member]).sum::<u64>() - 1;
            unreachable_pairs += sizes[component] * (frames - 1 - reach_of[component]);
            reached[component * words..][..words].copy_from_slice(&row);
        }
        for (frame, &component) in self.component_of_frame.iter().enumerate() {
            if reach_of[component as usize] == 0 {
                dead_ends.push(frame as u32);
            }
        }
        Reach { unreachable_pairs, dead_ends }
    }
}

/// Which frames reach which.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reach {
    /// Number of pairs (i, j), i != j, with no path from i to j.
    pub unreachable_pairs: u64,
    /// Frames that nothing leads on from.
    pub dead_ends: Vec<u32>,
}

/// The components of the graph of recorded steps and of `edges` (from, to), whose frames must exist.
///
/// Kosaraju and Sharir's algorithm: linear in frames and edges.
#[must_use]
pub fn strongly_connected(timeline: &Timeline, edges: &[(u32, u32)]) -> Components {
    let frame_count = timeline.frame_count();
    let recorded = (0..frame_count).filter_map(|frame| Some((frame, timeline.next(frame)?)));
    let all: Vec<(u32, u32)> = recorded.chain(edges.iter().copied()).collect();
    let forwards = adjacency(frame_count, all.iter().copied());
    let backwards = adjacency(frame_count, all.iter().map(|&(from, to)| (to, from)));

    let mut seen = vec![false; frame_count as usize];
    let mut finished = Vec::new();
    for frame in 0..frame_count {
        visit(&forwards, frame, &mut seen, &mut finished);
    }
    let mut component_of_frame = vec![u32::MAX; frame_count as usize];
    let mut seen = vec![false; frame_count as usize];
    for &frame in finished.iter().rev() {
        let mut members = Vec::new();
        visit(&backwards, frame, &mut seen, &mut members);
        let name = members.iter().copied().min().unwrap_or(frame);
        members.iter().for_each(|&member| component_of_frame[member as usize] = name);
    }
    numbered(component_of_frame)
}

/// Numbers components, so far named by their first frames, and finds the largest.
fn numbered(mut component_of_frame: Vec<u32>) -> Components {
    let mut sizes: Vec<u32> = Vec::new();
    for frame in 0..component_of_frame.len() {
        let name = component_of_frame[frame] as usize;
        if name == frame {
            component_of_frame[frame] = sizes.len() as u32;
            sizes.push(1);
        } else {
            // The first frame came before and has its number already.
            component_of_frame[frame] = component_of_frame[name];
            sizes[component_of_frame[frame] as usize] += 1;
        }
    }
    let largest = (0..sizes.len()).rev().max_by_key(|&component| sizes[component]).unwrap_or(0) as u32;
    Components { component_of_frame, largest }
}

fn adjacency(frame_count: u32, edges: impl Iterator<Item = (u32, u32)>) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); frame_count as usize];
    for (from, to) in edges {
        lists[from as usize].push(to);
    }
    lists
}

/// Appends what can be reached from `start` and was not seen, each node after what it leads to.
fn visit(lists: &[Vec<u32>], start: u32, seen: &mut [bool], finished: &mut Vec<u32>) {
    if std::mem::replace(&mut seen[start as usize], true) {
        return;
    }
    let mut stack = vec![(start, 0)];
    while let Some((node, next)) = stack.last_mut() {
        match lists[*node as usize].get(*next) {
            Some(&to) => {
                *next += 1;
                if !std::mem::replace(&mut seen[to as usize], true) {
                    stack.push((to, 0));
                }
            }
            None => {
                finished.push(*node);
                stack.pop();
            }
        }
    }
}
