//! Which frames of a chunk are coded by themselves and which from others.

use kernels::sort::{key, numbers, sort};

/// Distances in frames that independent frames may have.
pub const GROUPS: [u32; 5] = [1, 2, 4, 8, 16];
/// Levels that residuals are counted apart for: independent frames, then ever finer differences.
pub const CLASSES: usize = 4;

/// How a frame is coded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coding {
    /// 0 for an independent frame, otherwise one more than the coarser of its references.
    pub level: usize,
    /// The two frames of the chunk whose mean it is coded from; `None` for an independent frame.
    pub references: Option<(u32, u32)>,
}

impl Coding {
    /// Which class of residuals it belongs to.
    #[must_use]
    pub fn class(&self) -> usize {
        self.level.min(CLASSES - 1)
    }
}

/// How frame `local` of a chunk of `count` frames is coded, independent frames lying `group` frames apart.
///
/// The last frame of a chunk is always independent, so that chunks do not need each other.
#[must_use]
pub fn coding(local: u32, count: u32, group: u32) -> Coding {
    let (mut low, mut level) = (local / group * group, 0);
    if local == low || local + 1 >= count {
        return Coding { level, references: None };
    }
    let mut high = (low + group).min(count - 1);
    loop {
        let middle = low + (high - low) / 2;
        level += 1;
        if local == middle {
            return Coding { level, references: Some((low, high)) };
        }
        if local < middle { high = middle } else { low = middle }
    }
}

/// The frames of a chunk in an order in which references come first.
#[must_use]
pub fn coding_order(count: u32, group: u32) -> Vec<(u32, Coding)> {
    let mut order: Vec<_> =
        (0..count).map(|local| key([0, 0, coding(local, count, group).level as u32, local])).collect();
    sort(&mut order);
    let locals = order.into_iter().map(|place| numbers(place)[3]);
    locals.map(|local| (local, coding(local, count, group))).collect()
}

/// Divides the `frame_count` frames of a sequence into chunks of at most `longest` frames.
#[must_use]
pub fn chunk_lengths(frame_count: u32, longest: u32) -> Vec<u32> {
    let (mut rest, mut lengths) = (frame_count, Vec::new());
    while rest > 0 {
        let length = rest.min(longest);
        lengths.push(length);
        rest -= length;
    }
    lengths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_come_first_and_few_are_needed() {
        for group in GROUPS {
            for count in 1..70 {
                let order = coding_order(count, group);
                let mut done = vec![false; count as usize];
                for &(local, coding) in &order {
                    if let Some((low, high)) = coding.references {
                        assert!(low < local && local < high && done[low as usize] && done[high as usize]);
                    }
                    done[local as usize] = true;
                }
                assert!(done.iter().all(|&done| done));
                let most = (0..count).map(|local| needed(local, count, group)).max().unwrap();
                assert!(most <= 2 + group.ilog2() as usize, "group {group}, {count} frames: {most}");
            }
        }
    }

    fn needed(local: u32, count: u32, group: u32) -> usize {
        let (mut open, mut seen) = (vec![local], std::collections::BTreeSet::new());
        while let Some(local) = open.pop() {
            if seen.insert(local)
                && let Some((low, high)) = coding(local, count, group).references
            {
                open.extend([low, high]);
            }
        }
        seen.len()
    }

    #[test]
    fn chunks_cover_a_sequence() {
        assert_eq!(chunk_lengths(70, 33), [33, 33, 4]);
        assert_eq!(chunk_lengths(1, 33), [1]);
    }
}
