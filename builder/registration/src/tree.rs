//! The order in which frames are tracked: shortest paths over likeness, from the template's frame to all others.

use std::collections::BTreeMap;

use super::dissimilarity::Dissimilarity;

/// Edges cost the excess of their dissimilarity to this power: several small steps rather than a large one.
const POWER: i32 = 4;

/// For every frame the frame that it is tracked from.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// The frame whose mesh is the template.
    pub root: usize,
    /// Frame by frame the parent; `None` for the root alone.
    pub parents: Vec<Option<usize>>,
    /// The cost of the way from the root.
    pub costs: Vec<f64>,
    /// Frames from the root outwards: a parent is before its children.
    pub order: Vec<usize>,
}

impl Tree {
    /// Shortest paths from `root`, by Dijkstra's algorithm over all pairs.
    #[must_use]
    pub fn new(dissimilarity: &Dissimilarity, root: usize) -> Self {
        let frames = dissimilarity.frames();
        let least = (0..frames).map(|k| dissimilarity.get(k, k)).fold(f32::INFINITY, f32::min);
        let weight = |a: usize, b: usize| f64::from((dissimilarity.get(a, b) - least).max(1e-9)).powi(POWER);
        let (mut costs, mut parents) = (vec![f64::INFINITY; frames], vec![None; frames]);
        let (mut open, mut order): (Vec<usize>, Vec<usize>) = ((0..frames).collect(), Vec::with_capacity(frames));
        if let Some(cost) = costs.get_mut(root) {
            *cost = 0.0;
        }
        while let Some(at) = (0..open.len()).min_by(|&a, &b| costs[open[a]].total_cmp(&costs[open[b]])) {
            let frame = open.remove(at);
            order.push(frame);
            for &next in &open {
                let cost = costs[frame] + weight(frame, next);
                if cost < costs[next] {
                    (costs[next], parents[next]) = (cost, Some(frame));
                }
            }
        }
        Self { root, parents, costs, order }
    }

    /// The same where frames of one group, which have equal numbers in `groups`, are tracked from the first of them.
    #[must_use]
    pub fn grouped(mut self, groups: &[usize]) -> Self {
        let mut firsts = BTreeMap::new();
        for &frame in &self.order {
            // Parents come before their children: none becomes its own ancestor.
            let first = *firsts.entry(groups[frame]).or_insert(frame);
            if first != frame {
                self.parents[frame] = Some(first);
            }
        }
        self
    }

    /// Frames by their depth, the root alone first.
    #[must_use]
    pub fn levels(&self) -> Vec<Vec<usize>> {
        let mut levels = vec![vec![self.root]];
        loop {
            let Some(above) = levels.last() else { return levels };
            let next: Vec<usize> =
                (0..self.parents.len()).filter(|&k| self.parents[k].is_some_and(|p| above.contains(&p))).collect();
            if next.is_empty() {
                return levels;
            }
            levels.push(next);
        }
    }
}

/// What is known of a frame before a template is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Connected parts.
    pub parts: usize,
    /// Handles, by the Euler number: webs between limbs make some.
    pub handles: i64,
    /// Area, square metres.
    pub area: f32,
}

/// The frame whose mesh is the best template: of the fewest parts and handles; among those the one with the best sum of ranks
/// by area, for limbs that touch hide some, and by its mean dissimilarity to all others.
#[must_use]
pub fn choose_root(candidates: &[Candidate], dissimilarity: &Dissimilarity) -> usize {
    let simplest = candidates.iter().map(|c| (c.parts, c.handles)).min();
    let mut able: Vec<usize> =
        (0..candidates.len()).filter(|&k| Some((candidates[k].parts, candidates[k].handles)) == simplest).collect();
    let mean = |k: usize| (0..candidates.len()).map(|j| f64::from(dissimilarity.get(k, j))).sum::<f64>();
    let mut ranks = vec![0; candidates.len()];
    able.sort_by(|&a, &b| candidates[b].area.total_cmp(&candidates[a].area).then(a.cmp(&b)));
    able.iter().enumerate().for_each(|(rank, &k)| ranks[k] += rank);
    able.sort_by(|&a, &b| mean(a).total_cmp(&mean(b)).then(a.cmp(&b)));
    able.iter().enumerate().for_each(|(rank, &k)| ranks[k] += rank);
    able.into_iter().min_by_key(|&k| (ranks[k], k)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use kernels::random::signed;

    use super::*;

    /// Dissimilarities of points on a line.
    fn line(places: &[f32]) -> Dissimilarity {
        Dissimilarity::of_values(places.len(), |s, t| 0.1 + (places[s] - places[t]).abs())
    }

    #[test]
    fn ways_go_in_small_steps() {
        let tree = Tree::new(&line(&[2.0, 0.0, 1.0, 3.0, 4.0]), 1);
        assert_eq!(tree.parents, [Some(2), None, Some(1), Some(0), Some(3)]);
        assert_eq!(tree.levels(), [vec![1], vec![2], vec![0], vec![3], vec![4]]);
    }

    #[test]
    fn costs_are_those_of_all_paths_tried() {
        let values: Vec<f32> = (0..36).map(|k| 0.5 + 0.5 * signed(7, k).abs()).collect();
        let dissimilarity =
            Dissimilarity::of_values(6, |s, t| if s == t { 0.2 } else { values[s.min(t) * 6 + s.max(t)] });
        let tree = Tree::new(&dissimilarity, 2);
        let mut costs = vec![f64::INFINITY; 6];
        costs[2] = 0.0;
        for _ in 0..6 {
            for s in 0..6 {
                for t in 0..6 {
                    let weight = f64::from(dissimilarity.get(s, t) - 0.2).powi(4);
                    costs[t] = f64::min(costs[t], costs[s] + if s == t { 0.0 } else { weight });
                }
            }
        }
        for (got, wanted) in tree.costs.iter().zip(&costs) {
            assert!((got - wanted).abs() < 1e-9, "{got} for {wanted}");
        }
        assert_eq!(tree.levels().concat().len(), 6);
    }

    #[test]
    fn frames_of_a_group_hang_on_its_first() {
        // The way from 1 goes 1, 2, 0, 3, 4.
        let tree = Tree::new(&line(&[2.0, 0.0, 1.0, 3.0, 4.0]), 1).grouped(&[7, 8, 8, 7, 7]);
        assert_eq!(tree.order, [1, 2, 0, 3, 4]);
        assert_eq!(tree.parents, [Some(2), None, Some(1), Some(0), Some(0)]);
        assert_eq!(tree.levels(), [vec![1], vec![2], vec![0], vec![3, 4]]);
    }

    #[test]
    fn the_template_has_few_handles_and_is_like_the_others() {
        let of = |handles, area| Candidate { parts: 1, handles, area };
        let candidates = [of(1, 3.0), of(0, 2.0), of(0, 2.2), of(0, 2.1)];
        assert_eq!(choose_root(&candidates, &line(&[0.0, 0.1, 0.0, 5.0])), 2);
    }
}
