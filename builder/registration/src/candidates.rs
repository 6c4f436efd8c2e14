//! Candidate windows: pairs of frames between whose surroundings a transition can be made (Prada 2016, section 4, thresholds of A.1).

use super::dissimilarity::Dissimilarity;

/// When a pair of frames is a candidate. The default is the paper's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CandidateOptions {
    /// k: windows reach so many frames to both sides, and lie inside their sequence.
    pub reach: usize,
    /// Frames of one sequence that are nearer to each other are none.
    pub apart: usize,
    /// Both ends of two candidates are not so near to each other.
    pub spread: usize,
    /// The dissimilarity is at most so many times that of consecutive frames, on average.
    pub most: f32,
}

impl Default for CandidateOptions {
    fn default() -> Self {
        Self { reach: 10, apart: 60, spread: 20, most: 3.0 }
    }
}

/// Pairs (s, t), s before t, the least unlike first. `windowed` is that of windows of the options' reach, `sequence` tells the sequence of each
/// frame. Each pair is handed to `succeeds`: where that fails, others near it may follow. All that were handed over, and what became of them.
pub fn candidates(
    windowed: &Dissimilarity,
    sequence: &[usize],
    options: &CandidateOptions,
    mut succeeds: impl FnMut(usize, usize) -> bool,
) -> Vec<((usize, usize), bool)> {
    let frames = windowed.frames();
    let consecutive: Vec<f32> =
        (1..frames).filter(|&k| sequence[k - 1] == sequence[k]).map(|k| windowed.get(k - 1, k)).collect();
    let most = options.most * consecutive.iter().sum::<f32>() / consecutive.len().max(1) as f32;
    let whole = |frame: usize| {
        let inside = |other: usize| sequence.get(other) == Some(&sequence[frame]);
        frame >= options.reach && inside(frame - options.reach) && inside(frame + options.reach)
    };
    let may = |&(s, t): &(usize, usize)| {
        whole(s) && whole(t) && (sequence[s] != sequence[t] || t - s >= options.apart) && windowed.get(s, t) <= most
    };
    let mut pairs: Vec<(usize, usize)> =
        (0..frames).flat_map(|s| (s + 1..frames).map(move |t| (s, t))).filter(may).collect();
    pairs.sort_by(|a, b| windowed.get(a.0, a.1).total_cmp(&windowed.get(b.0, b.1)).then(a.cmp(b)));
    let mut tried: Vec<((usize, usize), bool)> = Vec::new();
    for (s, t) in pairs {
        let near = |&((a, b), good): &((usize, usize), bool)| {
            // A pair that failed stands in nobody's way but its own neighbours', half as far.
            let spread = if good { options.spread } else { options.spread / 2 };
            s.abs_diff(a) < spread && t.abs_diff(b) < spread
        };
        if !tried.iter().any(near) {
            let good = succeeds(s, t);
            tried.push(((s, t), good));
        }
    }
    tried
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two takes of 100 frames; what is done in frame 30 of the first is done in 30 and 80 of both.
    fn unlike() -> (Dissimilarity, Vec<usize>) {
        let phase = |frame: usize| (frame % 50) as f32;
        let of = |s: usize, t: usize| (phase(s) - phase(t)).abs().min(50.0 - (phase(s) - phase(t)).abs()) + 0.01;
        (Dissimilarity::of_values(200, of), (0..200).map(|frame| frame / 100).collect())
    }

    #[test]
    fn they_are_alike_apart_and_spread() {
        let (windowed, sequence) = unlike();
        let options = CandidateOptions::default();
        let found = candidates(&windowed, &sequence, &options, |_, _| true);
        assert!(found.len() > 4);
        for (k, &((s, t), good)) in found.iter().enumerate() {
            assert!(good && windowed.get(s, t) <= 3.1, "{s} {t}");
            assert!(sequence[s] != sequence[t] || t - s >= 60, "{s} {t}");
            assert!([s, t].iter().all(|frame| (10..90).contains(&(frame % 100))), "{s} {t}: a window is cut off");
            for &((a, b), _) in &found[..k] {
                assert!(s.abs_diff(a) >= 20 || t.abs_diff(b) >= 20, "{s} {t} beside {a} {b}");
            }
        }
        assert!(candidates(&windowed, &sequence, &CandidateOptions { most: 0.0, ..options }, |_, _| true).is_empty());
    }

    #[test]
    fn where_one_fails_others_near_it_may_follow() {
        let (windowed, sequence) = unlike();
        let options = CandidateOptions::default();
        let good = candidates(&windowed, &sequence, &options, |_, _| true);
        let ((s, t), _) = good[0];
        let found = candidates(&windowed, &sequence, &options, |a, b| (a, b) != (s, t));
        assert_eq!(found[0], ((s, t), false));
        let beside = |&&((a, b), good): &&((usize, usize), bool)| good && a.abs_diff(s) < 20 && b.abs_diff(t) < 20;
        assert!(found.iter().any(|one| beside(&one)), "{found:?}");
    }
}
