//! An idle that lasts: what is shown of it in ten minutes, and what of that had been shown before.

use std::collections::HashSet;
use std::sync::Arc;

use actor::alternatives::Alternatives;
use actor::timeline::Sequence;
use synthesis::Varied;

/// What a frame shows: its number, and the stretch and the alternative, where it is not as recorded.
type Shown = (u32, Option<(usize, usize)>);

/// What ten minutes show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lasting {
    /// Times that the sequence was gone through.
    pub passes: usize,
    /// Different passes among them.
    pub different: usize,
    /// The longest passage that had been shown exactly so before, in seconds.
    pub longest: f64,
    /// Passages of ten seconds that had been shown exactly so before, as a share of all.
    pub repeated: f64,
    /// Passes that were the same as the one before.
    pub in_a_row: usize,
}

/// What is shown of `sequence` when it is gone through again and again for `seconds`, its alternatives drawn by `seed`.
pub fn lasting(all: &Arc<Alternatives>, sequence: &Sequence, fps: f32, seconds: f64, seed: u64) -> Lasting {
    let mut varied = Varied::new(Arc::clone(all), seed, 1.0);
    let total = (seconds * f64::from(fps)) as usize;
    let length = sequence.frame_count as usize;
    let mut shown: Vec<Shown> = Vec::with_capacity(total);
    for k in 0..total {
        let frame = sequence.first_frame + (k % length) as u32;
        varied.enters(frame);
        shown.push((frame, varied.present()));
    }
    let passes: Vec<&[Shown]> = shown.chunks_exact(length).collect();
    let mut unlike: Vec<_> = passes.clone();
    unlike.sort_unstable();
    unlike.dedup();
    let window = (10.0 * fps) as usize;
    let mut seen: HashSet<&[Shown]> = HashSet::new();
    let windows = shown.windows(window);
    let repeated = windows.clone().filter(|window| !seen.insert(window)).count();
    Lasting {
        passes: passes.len(),
        different: unlike.len(),
        longest: longest(&shown) as f64 / f64::from(fps),
        repeated: repeated as f64 / windows.count().max(1) as f64,
        in_a_row: passes.windows(2).filter(|pair| pair[0] == pair[1]).count(),
    }
}

/// The length of the longest passage that occurs twice without overlapping itself.
fn longest<T: PartialEq>(shown: &[T]) -> usize {
    let mut best = 0;
    // Ends of equal runs at each distance.
    for apart in 1..shown.len() {
        let mut run = 0;
        for k in apart..shown.len() {
            run = if shown[k] == shown[k - apart] { (run + 1).min(apart) } else { 0 };
            best = best.max(run);
        }
        if best >= shown.len() - apart {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_passage_is_found() {
        assert_eq!(longest(&[1, 2, 3, 9, 1, 2, 3, 4]), 3);
        assert_eq!(longest(&[1, 1, 1, 1]), 2);
        assert_eq!(longest(&[1, 2, 3]), 0);
    }

    #[test]
    fn what_has_no_alternatives_repeats_itself() {
        let sequence = Sequence { name: "a".into(), labels: vec![], first_frame: 0, frame_count: 50, cyclic: false };
        let found = lasting(&Arc::new(Alternatives::default()), &sequence, 25.0, 60.0, 1);
        assert_eq!((found.passes, found.different, found.in_a_row), (30, 1, 29));
        assert!(found.longest >= 28.0 && found.repeated > 0.5, "{found:?}");
    }
}
