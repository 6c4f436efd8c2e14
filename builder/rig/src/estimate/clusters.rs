//! Parts of the surface that move as rigid ones, found by splitting.
//!
//! This work is based on: Le and Deng, "Smooth skinning decomposition with rigid bones" (2012), whose clusters are where bones
//! begin: the part that is explained worst is split, and every vertex goes to the bone that explains it best.

use std::collections::BTreeMap;

use editing::Rigid;
use editing::rotation::Fit;
use glam::Vec3;
use rayon::prelude::*;

use super::keys::Keys;

/// Rounds of assigning and fitting after each split.
const ROUNDS: usize = 2;
/// Vertices around a seed that it is fitted to.
const PATCH: usize = 16;
/// A cluster is not split below twice so many vertices.
const LEAST: usize = 10;
/// Pieces of a cluster that lie apart and are smaller than this share of it go to their neighbours.
const ISLAND: f32 = 0.3;

/// The parts: which one each vertex belongs to, and by part and key frame the transform from the rest pose.
#[derive(Clone)]
pub struct Clusters {
    /// Part of each vertex.
    pub of_vertex: Vec<usize>,
    /// By part and key frame.
    pub motions: Vec<Vec<Rigid>>,
}

/// Splits the surface until there are `count` parts, or each moves rigidly within `least` metres (root of the mean square).
/// `around` are the neighbours of each vertex.
#[must_use]
pub fn split(keys: &Keys, around: &[Vec<u32>], count: usize, least: f32) -> Clusters {
    let n = keys.poses[0].len();
    let mut clusters = Clusters { of_vertex: vec![0; n], motions: Vec::new() };
    clusters.refit(keys, 1);
    let mut unsplittable: Vec<bool> = vec![false];
    while clusters.motions.len() < count {
        let errors: Vec<f32> =
            (0..n).into_par_iter().map(|v| error(keys, v, &clusters.motions[clusters.of_vertex[v]])).collect();
        let mut sums = vec![(0.0_f64, 0_usize); clusters.motions.len()];
        for (&part, &error) in clusters.of_vertex.iter().zip(&errors) {
            sums[part].0 += f64::from(error);
            sums[part].1 += 1;
        }
        let worth = |part: usize| {
            let (sum, size) = sums[part];
            let rigid = sum <= f64::from(least * least) * size as f64;
            if unsplittable[part] || rigid || size < 2 * LEAST { 0.0 } else { sum }
        };
        let worst = (0..sums.len()).fold(0, |best, part| if worth(part) > worth(best) { part } else { best });
        if worth(worst) == 0.0 {
            break;
        }
        if clusters.split(keys, around, worst, &errors) {
            unsplittable.push(false);
            for _ in 0..ROUNDS {
                clusters.assign(keys, around);
                clusters.remove_islands(around);
                clusters.refit(keys, unsplittable.len());
            }
        } else {
            unsplittable[worst] = true;
        }
    }
    clusters.drop_empty(keys);
    clusters
}

/// Mean square distance, over the key frames, of vertex `v` from where `motions` take it.
pub fn error(keys: &Keys, v: usize, motions: &[Rigid]) -> f32 {
    let rest = keys.poses[0][v];
    let sum: f32 =
        keys.poses.iter().zip(motions).map(|(pose, motion)| motion.apply(rest).distance_squared(pose[v])).sum();
    sum / motions.len() as f32
}

/// The transforms that take `vertices` of the rest pose best to each key frame.
#[must_use]
pub fn fit(keys: &Keys, vertices: &[u32]) -> Vec<Rigid> {
    let rest = &keys.poses[0];
    let one = |pose: &Vec<Vec3>| {
        let mut fit = Fit::default();
        vertices.iter().for_each(|&v| fit.add(rest[v as usize], pose[v as usize], 1.0));
        fit.rigid()
    };
    keys.poses.iter().map(one).collect()
}

impl Clusters {
    /// The vertices of each part.
    #[must_use]
    pub fn members(&self) -> Vec<Vec<u32>> {
        let mut members = vec![Vec::new(); self.motions.len()];
        self.of_vertex.iter().enumerate().for_each(|(vertex, &part)| members[part].push(vertex as u32));
        members
    }

    fn refit(&mut self, keys: &Keys, count: usize) {
        let mut members = vec![Vec::new(); count];
        self.of_vertex.iter().enumerate().for_each(|(vertex, &part)| members[part].push(vertex as u32));
        let old = std::mem::take(&mut self.motions);
        // A part that has lost its vertices keeps its motion: it may win some again.
        self.motions = members
            .par_iter()
            .enumerate()
            .map(|(part, members)| match old.get(part) {
                Some(old) if members.len() < 3 => old.clone(),
                _ => fit(keys, members),
            })
            .collect();
    }

    /// Splits part `worst` between its vertex that is explained worst and the one that this one's surroundings explain
    /// worst; whether both halves have enough vertices.
    fn split(&mut self, keys: &Keys, around: &[Vec<u32>], worst: usize, errors: &[f32]) -> bool {
        let members: Vec<u32> = (0..errors.len() as u32).filter(|&v| self.of_vertex[v as usize] == worst).collect();
        let largest =
            |of: &dyn Fn(u32) -> f32| members.iter().copied().reduce(|a, b| if of(b) > of(a) { b } else { a });
        let Some(first) = largest(&|v| errors[v as usize]) else { return false };
        let patch = |seed: u32| fit(keys, &self.patch(around, seed, worst));
        let one = patch(first);
        let Some(second) = largest(&|v| error(keys, v as usize, &one)) else { return false };
        let mut two = [one, patch(second)];
        let new = self.motions.len();
        let mut moved = Vec::new();
        for _ in 0..4 {
            let nearer: Vec<bool> = members
                .par_iter()
                .map(|&v| error(keys, v as usize, &two[0]) <= error(keys, v as usize, &two[1]))
                .collect();
            let half = |first: bool| -> Vec<u32> {
                members.iter().zip(&nearer).filter(|(_, nearer)| **nearer == first).map(|(v, _)| *v).collect()
            };
            let halves = [half(true), half(false)];
            if halves.iter().any(|half| half.len() < LEAST) {
                return false;
            }
            two = [fit(keys, &halves[0]), fit(keys, &halves[1])];
            moved.clone_from(&halves[1]);
        }
        // Only now: nothing has changed where a half is too small.
        moved.iter().for_each(|&v| self.of_vertex[v as usize] = new);
        let [one, other] = two;
        self.motions[worst] = one;
        self.motions.push(other);
        true
    }

    /// Vertices of the part around `seed`, breadth first.
    fn patch(&self, around: &[Vec<u32>], seed: u32, part: usize) -> Vec<u32> {
        let mut patch = vec![seed];
        let mut next = 0;
        while next < patch.len() && patch.len() < PATCH {
            for &other in &around[patch[next] as usize] {
                if self.of_vertex[other as usize] == part && !patch.contains(&other) {
                    patch.push(other);
                }
            }
            next += 1;
        }
        patch
    }

    /// Each vertex to the part that explains it best, among its own and those of the vertices around its part.
    fn assign(&mut self, keys: &Keys, around: &[Vec<u32>]) {
        let beside = self.beside(around);
        self.of_vertex = (0..self.of_vertex.len())
            .into_par_iter()
            .map(|v| {
                let own = self.of_vertex[v];
                let mut best = (error(keys, v, &self.motions[own]), own);
                for &other in beside[own].keys() {
                    let error = error(keys, v, &self.motions[other]);
                    if error < best.0 {
                        best = (error, other);
                    }
                }
                best.1
            })
            .collect();
    }

    /// By part, the parts beside it and how many edges lead there.
    #[must_use]
    pub fn beside(&self, around: &[Vec<u32>]) -> Vec<BTreeMap<usize, usize>> {
        let mut beside = vec![BTreeMap::new(); self.motions.len()];
        for (v, around) in around.iter().enumerate() {
            for &other in around {
                let (own, other) = (self.of_vertex[v], self.of_vertex[other as usize]);
                if own != other {
                    *beside[own].entry(other).or_insert(0) += 1;
                }
            }
        }
        beside
    }

    /// Small pieces that lie apart from the rest of their part go to the part that they touch most.
    fn remove_islands(&mut self, around: &[Vec<u32>]) {
        let n = self.of_vertex.len();
        let mut piece_of = vec![usize::MAX; n];
        let mut pieces: Vec<Vec<u32>> = Vec::new();
        for start in 0..n {
            if piece_of[start] != usize::MAX {
                continue;
            }
            let mut piece = vec![start as u32];
            piece_of[start] = pieces.len();
            let mut next = 0;
            while next < piece.len() {
                for &other in &around[piece[next] as usize] {
                    let same = self.of_vertex[other as usize] == self.of_vertex[start];
                    if same && piece_of[other as usize] == usize::MAX {
                        piece_of[other as usize] = pieces.len();
                        piece.push(other);
                    }
                }
                next += 1;
            }
            pieces.push(piece);
        }
        let mut largest = vec![0; self.motions.len()];
        for piece in &pieces {
            let part = self.of_vertex[piece[0] as usize];
            largest[part] = largest[part].max(piece.len());
        }
        let before = self.of_vertex.clone();
        for piece in &pieces {
            let part = before[piece[0] as usize];
            if piece.len() as f32 >= ISLAND * largest[part] as f32 {
                continue;
            }
            let mut touched: BTreeMap<usize, usize> = BTreeMap::new();
            for &v in piece {
                for &other in &around[v as usize] {
                    if before[other as usize] != part {
                        *touched.entry(before[other as usize]).or_insert(0) += 1;
                    }
                }
            }
            if let Some((&to, _)) = touched.iter().max_by_key(|(part, edges)| (**edges, std::cmp::Reverse(**part))) {
                piece.iter().for_each(|&v| self.of_vertex[v as usize] = to);
            }
        }
    }

    fn drop_empty(&mut self, keys: &Keys) {
        let members = self.members();
        let mut numbers = vec![0; members.len()];
        let mut count = 0;
        for (part, members) in members.iter().enumerate() {
            numbers[part] = count;
            count += usize::from(!members.is_empty());
        }
        self.of_vertex.iter_mut().for_each(|part| *part = numbers[*part]);
        self.motions = Vec::new();
        self.refit(keys, count);
    }
}
