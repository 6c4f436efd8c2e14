//! From which frames each is tracked next: along the tree, from what is beside it in time, and, where all that is known is far,
//! from several.

use super::survey::Survey;

/// Where a frame is far from all that are known, it is tried from so many of them, and from the template.
const FAR_TRIES: usize = 4;
/// And with those that are strained least, of other sequences, from so many in all.
const FAR_MOST: usize = 7;
/// What is far is tried so often: again when more is known.
const FAR_ROUNDS: usize = 2;
/// Frames that are nearer in time than so many are too much alike to try both.
const APART: usize = 8;
/// Frames that are so many times more unlike than those that follow each other are far.
const STEP: f32 = 1.5;

/// How a frame is come by.
#[derive(Clone, Debug)]
pub(crate) enum Way {
    /// It is the template's own.
    Root,
    /// From a frame that is near.
    Near(usize),
    /// From each of some that are far, of which the best is kept.
    Far(Vec<usize>),
}

impl Way {
    /// The frames that it is tracked from.
    pub fn parents(&self) -> &[usize] {
        match self {
            Self::Root => &[],
            Self::Near(parent) => std::slice::from_ref(parent),
            Self::Far(parents) => parents,
        }
    }
}

/// What became of a frame so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Known {
    /// Whether it is tracked.
    pub tracked: bool,
    /// The frames that it was tried from.
    pub tried: Vec<usize>,
    /// How often it was tried as a frame that is far from all.
    pub far: usize,
    /// How much the template is strained on it, where it is tracked ([`super::checks::Fit::strain`]).
    pub strain: f64,
}

/// Chooses ways.
pub(crate) struct Ways<'a> {
    survey: &'a Survey,
    parents: &'a [Option<usize>],
    root: usize,
    /// The sequence of each frame.
    sequences: Vec<usize>,
    /// Frames that are more unlike than this are farther apart than those that follow each other usually are.
    step: f32,
}

impl<'a> Ways<'a> {
    /// For the frames of `survey` along a tree of `root` and `parents`; `sequence` is that of a frame of the source.
    pub fn new(
        survey: &'a Survey,
        (root, parents): (usize, &'a [Option<usize>]),
        sequence: impl Fn(usize) -> usize,
    ) -> Self {
        let sequences = survey.frames.iter().map(|&frame| sequence(frame)).collect();
        let mut ways = Self { survey, parents, root, sequences, step: f32::INFINITY };
        let pairs = (1..survey.frames.len()).filter(|&k| ways.follow(k - 1, k));
        let mut steps: Vec<f32> = pairs.map(|k| ways.unlike(k - 1, k)).collect();
        let middle = steps.len() / 2;
        if !steps.is_empty() {
            ways.step = STEP * *steps.select_nth_unstable_by(middle, f32::total_cmp).1;
        }
        ways
    }

    /// What is to be done next, side by side; nothing where nothing is left that could help.
    pub fn next(&self, known: &[Known]) -> Vec<(usize, Way)> {
        let able = |k: usize, parent: usize| known[parent].tracked && !known[k].tried.contains(&parent);
        let waiting: Vec<usize> = (0..known.len()).filter(|&k| !known[k].tracked).collect();
        let of_tree = |&k: &usize| self.parents[k].filter(|&p| able(k, p)).map(|p| (k, self.way(k, p, known)));
        let open: Vec<(usize, Way)> = waiting.iter().filter_map(of_tree).collect();
        if !open.is_empty() {
            return open;
        }
        let beside = |&k: &usize| self.beside(k, &able).map(|p| (k, Way::Near(p)));
        let open: Vec<(usize, Way)> = waiting.iter().filter_map(beside).collect();
        if open.is_empty() { self.far(&waiting, known) } else { open }
    }

    /// How `k` is come by from `parent`, which is beside it in the tree: as far ones are, where it is farther than steps of time.
    fn way(&self, k: usize, parent: usize, known: &[Known]) -> Way {
        let grouped = self.survey.groups[k] == self.survey.groups[parent];
        if grouped || self.near_in_time(k, parent) || self.unlike(k, parent) <= self.step {
            return Way::Near(parent);
        }
        let mut parents = self.nearest(k, known);
        if !parents.contains(&parent) {
            parents.push(parent);
        }
        Way::Far(parents)
    }

    /// The frame beside `k` in time that it can be tried from, the more alike where both can.
    fn beside(&self, k: usize, able: &impl Fn(usize, usize) -> bool) -> Option<usize> {
        let found = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter(|&p| self.follow(p, k) && able(k, p));
        found.min_by(|&a, &b| self.unlike(k, a).total_cmp(&self.unlike(k, b)))
    }

    /// Of every run of frames that wait, the one that is most alike to tracked frames, and these: the others may follow it. Runs
    /// that are much farther than others wait until more is known; what failed is tried again when all else is known.
    fn far(&self, waiting: &[usize], known: &[Known]) -> Vec<(usize, Way)> {
        for tries in 0..FAR_ROUNDS {
            let of = |&k: &usize| {
                let parents = self.nearest(k, known);
                Some((self.unlike(k, *parents.first()?), k, parents))
            };
            let best = |run: &[usize]| {
                let able = run.iter().filter(|&&k| known[k].far == tries).filter_map(of);
                able.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            };
            let mut open: Vec<_> = waiting.chunk_by(|&a, &b| self.follow(a, b)).filter_map(best).collect();
            let least = open.iter().map(|run| run.0).fold(f32::INFINITY, f32::min);
            open.retain(|run| run.0 <= STEP * least);
            if !open.is_empty() {
                return open.into_iter().map(|(_, k, parents)| (k, Way::Far(parents))).collect();
            }
        }
        Vec::new()
    }

    /// Tracked frames that are most alike to `k`, and not too much to each other; the template is one of them, for from there
    /// nothing has drifted yet, and so are calm poses of other sequences.
    pub fn nearest(&self, k: usize, known: &[Known]) -> Vec<usize> {
        let mut tracked: Vec<usize> = (0..known.len()).filter(|&p| known[p].tracked).collect();
        tracked.sort_by(|&a, &b| self.unlike(k, a).total_cmp(&self.unlike(k, b)).then(a.cmp(&b)));
        let mut apart: Vec<usize> = Vec::new();
        for &frame in &tracked {
            if apart.len() < FAR_TRIES && !apart.iter().any(|&other| self.near_in_time(frame, other)) {
                apart.push(frame);
            }
        }
        if known[self.root].tracked && !apart.contains(&self.root) {
            apart.push(self.root);
        }
        // Calm poses are twisted least, however far they are.
        tracked.sort_by(|&a, &b| known[a].strain.total_cmp(&known[b].strain).then(a.cmp(&b)));
        for &frame in &tracked {
            let is_other = apart.iter().all(|&other| self.sequences[other] != self.sequences[frame]);
            if apart.len() < FAR_MOST && is_other {
                apart.push(frame);
            }
        }
        apart
    }

    /// Whether frames follow each other in a sequence.
    pub fn follow(&self, a: usize, b: usize) -> bool {
        let frames = &self.survey.frames;
        a.max(b) < frames.len() && frames[a].abs_diff(frames[b]) == 1 && self.sequences[a] == self.sequences[b]
    }

    /// Whether frames are near in one sequence.
    pub fn near_in_time(&self, a: usize, b: usize) -> bool {
        let frames = &self.survey.frames;
        frames[a].abs_diff(frames[b]) < APART && self.sequences[a] == self.sequences[b]
    }

    fn unlike(&self, a: usize, b: usize) -> f32 {
        self.survey.dissimilarity.get(a, b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dissimilarity::Dissimilarity;
    use crate::tree::{Candidate, Tree};

    /// Frames on a line, two sequences of three.
    fn survey(places: &[f32]) -> Survey {
        Survey {
            frames: (0..places.len()).collect(),
            candidates: vec![Candidate { parts: 1, handles: 0, area: 2.0 }; places.len()],
            dissimilarity: Dissimilarity::of_values(places.len(), |s, t| 0.1 + (places[s] - places[t]).abs()),
            lost: Vec::new(),
            turned: Vec::new(),
            littered: Vec::new(),
            mended: Vec::new(),
            groups: (0..places.len()).collect(),
        }
    }

    #[test]
    fn frames_are_tracked_along_the_tree_then_from_beside_then_from_afar() {
        let survey = survey(&[0.0, 0.01, 0.02, 5.0, 5.01, 5.02]);
        let tree = Tree::new(&survey.dissimilarity, 0);
        let ways = Ways::new(&survey, (tree.root, &tree.parents), |frame| frame / 3);
        let mut known = vec![Known::default(); 6];
        known[0].tracked = true;
        let next = |known: &[Known]| {
            ways.next(known)
                .into_iter()
                .map(|(k, way)| (k, matches!(way, Way::Far(_)), way.parents().to_vec()))
                .collect::<Vec<_>>()
        };
        // Shortest paths go in small steps.
        assert_eq!(next(&known), [(1, false, vec![0])]);
        (known[1].tracked, known[2].tracked) = (true, true);
        // The other sequence hangs on this one, far away: from what is nearest, the template, and nothing beside these.
        assert_eq!(next(&known), [(3, true, vec![2, 0])]);
        // Where that failed, its neighbour in time is tried by the tree no more, but from afar: every frame is, and then again.
        (known[3].tried, known[3].far) = (vec![2, 0], 1);
        assert_eq!(next(&known), [(4, true, vec![2, 0])]);
        (known[4].tried, known[4].tracked) = (vec![2, 0], true);
        // What is beside a tracked frame follows it.
        assert_eq!(next(&known), [(5, false, vec![4])]);
        known[5].tracked = true;
        assert_eq!(next(&known), [(3, false, vec![4])]);
        known[3].tried.push(4);
        assert_eq!(next(&known), [(3, true, vec![4, 2, 0])]);
        known[3].far = 2;
        assert!(next(&known).is_empty());
    }

    #[test]
    fn what_is_far_is_tried_from_calm_poses_of_other_takes_too() {
        // Eight takes of one frame: the last one is far from all, and those most unlike it are strained less than the others.
        let places = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 20.0];
        let survey = survey(&places);
        let parents: Vec<Option<usize>> = (0..8).map(|k| (k == 7).then_some(6)).collect();
        let ways = Ways::new(&survey, (6, &parents), |frame| frame);
        let strains = [0.05, 0.09, 0.04, 0.1, 0.1, 0.1, 0.0];
        let strain = |k: usize| strains.get(k).copied();
        let known: Vec<Known> = (0..8)
            .map(|k| Known { tracked: strain(k).is_some(), strain: strain(k).unwrap_or(0.0), ..Known::default() })
            .collect();
        assert_eq!(ways.nearest(7, &known), [6, 5, 4, 3, 2, 0, 1]);
    }
}
