//! Which frames lead to which: the directed graph of recorded steps and transitions, and its strongly connected components.

use crate::timeline::Timeline;

/// The recorded steps, then `transitions` (from, to), without what names frames that do not exist.
#[must_use]
pub fn with_recorded(timeline: &Timeline, transitions: impl IntoIterator<Item = (u32, u32)>) -> Vec<(u32, u32)> {
    let frames = timeline.frame_count();
    let recorded = (0..frames).filter_map(|frame| Some((frame, timeline.next(frame)?)));
    recorded.chain(transitions).filter(|&(a, b)| a < frames && b < frames).collect()
}

/// The nodes that each node of a directed graph leads to.
#[derive(Clone, Debug)]
pub struct Adjacency {
    first: Vec<u32>,
    ends: Vec<u32>,
}

impl Adjacency {
    /// Of `edges` (from, to) between nodes below `count`; counted rather than sorted, since pages do it too.
    #[must_use]
    pub fn new(count: u32, edges: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut first = vec![0; count as usize + 1];
        for (from, _) in edges.clone() {
            first[from as usize + 1] += 1;
        }
        for node in 0..count as usize {
            first[node + 1] += first[node];
        }
        let (mut next, mut ends) = (first.clone(), vec![0; first[count as usize] as usize]);
        for (from, to) in edges {
            ends[next[from as usize] as usize] = to;
            next[from as usize] += 1;
        }
        Self { first, ends }
    }

    /// What `node` leads to.
    #[must_use]
    pub fn of(&self, node: u32) -> &[u32] {
        &self.ends[self.first[node as usize] as usize..self.first[node as usize + 1] as usize]
    }

    /// Marks in `seen` what can be reached from `start` and was not seen, and gives it: each node after what it leads to.
    #[must_use]
    pub fn visit(&self, start: u32, seen: &mut [bool]) -> Vec<u32> {
        let mut finished = Vec::new();
        if std::mem::replace(&mut seen[start as usize], true) {
            return finished;
        }
        let mut way = vec![(start, 0)];
        while let Some((node, next)) = way.last_mut() {
            match self.of(*node).get(*next) {
                Some(&end) => {
                    *next += 1;
                    if !std::mem::replace(&mut seen[end as usize], true) {
                        way.push((end, 0));
                    }
                }
                None => {
                    finished.push(*node);
                    way.pop();
                }
            }
        }
        finished
    }
}

/// The strongly connected components of a graph over frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StrongComponents {
    /// The component of each frame, numbered by first frame.
    pub component_of_frame: Vec<u32>,
    /// The component of the most frames; of several, the one of the first frame.
    pub largest: u32,
    /// All frames, those of a component together, and each component after all that it leads to.
    pub finished: Vec<u32>,
}

impl StrongComponents {
    /// The frames of the largest component, in order: from each, every other can be reached.
    pub fn largest_frames(&self) -> impl Iterator<Item = u32> {
        let frames = self.component_of_frame.iter().enumerate();
        frames.filter(|&(_, &component)| component == self.largest).map(|(frame, _)| frame as u32)
    }

    /// For every frame, whether a walk leads from it into the largest component. `ends` are what each frame leads to, as
    /// [`components_of`] was told.
    pub fn leading_into_largest<I: Iterator<Item = u32>>(&self, ends: impl Fn(u32) -> I) -> Vec<bool> {
        let component = |frame: u32| self.component_of_frame[frame as usize];
        let mut leads = vec![false; self.component_of_frame.len()];
        for members in self.finished.chunk_by(|&a, &b| component(a) == component(b)) {
            let into = component(members[0]) == self.largest
                || members.iter().any(|&member| ends(member).any(|end| leads[end as usize]));
            members.iter().for_each(|&member| leads[member as usize] = into);
        }
        leads
    }
}

/// The components of the graph of recorded steps and of `transitions` (from, to); those that name frames that do not exist
/// are ignored.
#[must_use]
pub fn strongly_connected(timeline: &Timeline, transitions: &[(u32, u32)]) -> StrongComponents {
    let frames = timeline.frame_count();
    let edges = with_recorded(timeline, transitions.iter().copied());
    let adjacency = Adjacency::new(frames, edges.iter().copied());
    components_of(frames, |frame| adjacency.of(frame).iter().copied())
}

/// The components of a graph over nodes below `count`, each of which leads to its `ends`.
///
/// Tarjan's algorithm (1972), with a stack of its own: it looks at every edge once, and wants none turned round.
pub fn components_of<I: Iterator<Item = u32>>(count: u32, ends: impl Fn(u32) -> I) -> StrongComponents {
    let mut search = Search::new(count);
    let mut way = Vec::new();
    for start in 0..count {
        let mut next = (search.low[start as usize] == NEW).then_some(start);
        loop {
            if let Some(node) = next {
                way.push((node, search.open(node), ends(node)));
            }
            let Some((node, number, rest)) = way.last_mut() else { break };
            next = search.look(*node, rest);
            if next.is_some() {
                continue;
            }
            let (node, number) = (*node, *number);
            way.pop();
            let low = search.low[node as usize];
            if low == number {
                search.close(node);
            } else if let Some((parent, ..)) = way.last() {
                search.lower(*parent, low);
            }
        }
    }
    numbered(search.component_of_frame, search.finished)
}

/// The number of a node that was not reached.
const NEW: u32 = u32::MAX;
/// The number of a node whose component is known: it lowers no other.
const DONE: u32 = u32::MAX - 1;

/// What Tarjan's algorithm knows so far.
struct Search {
    /// Nodes have numbers in the order in which they are reached: the lowest of an open node that each is known to lead to.
    low: Vec<u32>,
    /// Nodes that were reached and whose component is not known.
    open: Vec<u32>,
    /// Numbers that were given.
    reached: u32,
    component_of_frame: Vec<u32>,
    finished: Vec<u32>,
}

impl Search {
    fn new(count: u32) -> Self {
        let count = count as usize;
        let (low, component_of_frame) = (vec![NEW; count], vec![0; count]);
        Self { low, open: Vec::new(), reached: 0, component_of_frame, finished: Vec::with_capacity(count) }
    }

    /// Gives a node its number.
    fn open(&mut self, node: u32) -> u32 {
        let number = self.reached;
        self.reached += 1;
        self.low[node as usize] = number;
        self.open.push(node);
        number
    }

    fn lower(&mut self, node: u32, low: u32) {
        self.low[node as usize] = self.low[node as usize].min(low);
    }

    /// The next of the nodes that `node` leads to which was not reached.
    fn look(&mut self, node: u32, ends: &mut impl Iterator<Item = u32>) -> Option<u32> {
        let mut least = self.low[node as usize];
        let found = ends.find(|&end| {
            let low = self.low[end as usize];
            // Not reached is the highest of numbers.
            least = least.min(low);
            low == NEW
        });
        self.low[node as usize] = least;
        found
    }

    /// All that was reached since `node`, with it, is a component.
    fn close(&mut self, node: u32) {
        let first = self.open.iter().rposition(|&other| other == node).unwrap_or(0);
        let members = self.open.split_off(first);
        let name = members.iter().copied().min().unwrap_or(node);
        for &member in &members {
            self.low[member as usize] = DONE;
            self.component_of_frame[member as usize] = name;
        }
        self.finished.extend(members);
    }
}

/// Numbers components, so far named by their first frames, and finds the largest.
fn numbered(mut component_of_frame: Vec<u32>, finished: Vec<u32>) -> StrongComponents {
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
    StrongComponents { component_of_frame, largest, finished }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timeline::Sequence;

    #[test]
    fn frames_are_together_where_they_reach_each_other() {
        let sequence = |first_frame, frame_count, cyclic| Sequence {
            name: format!("s{first_frame}"),
            labels: vec![],
            first_frame,
            frame_count,
            cyclic,
        };
        let timeline = Timeline::new(25.0, vec![sequence(0, 6, false), sequence(6, 4, true), sequence(10, 5, false)]);
        let (timeline, frames) = (timeline.unwrap(), 15_usize);
        for seed in 0..60_u32 {
            let edges: Vec<_> = (0..8).map(|k| ((seed * 7 + k * 11) % 16, (seed * 5 + k * 13 + k * k) % 16)).collect();
            // Warshall's closure is the oracle; frame 15 does not exist.
            let mut reaches = vec![vec![false; frames]; frames];
            (0..frames).for_each(|frame| reaches[frame][frame] = true);
            for (a, b) in with_recorded(&timeline, edges.iter().copied()) {
                reaches[a as usize][b as usize] = true;
            }
            for via in 0..frames {
                for a in 0..frames {
                    for b in 0..frames {
                        reaches[a][b] |= reaches[a][via] && reaches[via][b];
                    }
                }
            }
            let found = strongly_connected(&timeline, &edges);
            let of = &found.component_of_frame;
            for a in 0..frames {
                for b in 0..frames {
                    assert_eq!(of[a] == of[b], reaches[a][b] && reaches[b][a], "{a} and {b} by {edges:?}");
                }
                assert!(of[a] <= of[..a].iter().max().map_or(0, |&most| most + 1), "numbered by first frame");
            }
            let size = |component: u32| of.iter().filter(|&&other| other == component).count();
            let most = (0..frames).map(|frame| size(of[frame])).max().unwrap();
            let first = (0..frames).find(|&frame| size(of[frame]) == most).unwrap();
            assert_eq!(found.largest_frames().next(), Some(first as u32));
            let adjacency = Adjacency::new(frames as u32, with_recorded(&timeline, edges.iter().copied()).into_iter());
            let leads = found.leading_into_largest(|frame| adjacency.of(frame).iter().copied());
            assert!((0..frames).all(|frame| leads[frame] == reaches[frame][first]), "by {edges:?}");
        }
    }
}
