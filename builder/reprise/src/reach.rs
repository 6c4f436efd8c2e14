//! Which sequences have no way to which others, by name.

use actor::timeline::{Sequence, Timeline};
use capture_io::import::Warning;

/// Sequences named in one clause, and clauses, before the rest is counted.
const NAMED: usize = 6;

/// Seconds at the ends of a sequence that are lost to transitions without a word.
const MOMENT: f32 = 1.0;

/// A sentence about the `pairs` of frames that have no way from the first to the second in the graph of recorded steps
/// and of `edges`; `None` where there are none, and where these are but the moments at the ends of sequences that no transition is
/// short enough for.
pub(crate) fn unreachable(timeline: &Timeline, edges: &[(u32, u32)], pairs: u64) -> Option<Warning> {
    if pairs == 0 {
        return None;
    }
    let sequences = timeline.sequences();
    let reached: Vec<Vec<bool>> = sequences.iter().map(|from| sequences_reached(timeline, edges, from)).collect();
    let others = |k: usize| (0..sequences.len()).filter(move |&other| other != k);
    let names = |which: Vec<usize>| {
        let named: Vec<&str> = which.iter().take(NAMED).map(|&k| sequences[k].name.as_str()).collect();
        let more = which.len().saturating_sub(NAMED);
        if more > 0 { format!("{} and {more} more", named.join(", ")) } else { named.join(", ") }
    };
    let alone: Vec<usize> =
        (0..sequences.len()).filter(|&k| sequences.len() > 1 && others(k).all(|to| !reached[k][to])).collect();
    let unmet: Vec<usize> =
        (0..sequences.len()).filter(|&k| sequences.len() > 1 && others(k).all(|from| !reached[from][k])).collect();
    let mut clauses = Vec::new();
    if !alone.is_empty() {
        clauses.push(format!("nothing leads from {} to any other sequence", names(alone.clone())));
    }
    if !unmet.is_empty() {
        clauses.push(format!("nothing leads to {} from any other sequence", names(unmet.clone())));
    }
    let mut partly = 0;
    for from in (0..sequences.len()).filter(|from| !alone.contains(from)) {
        let missing: Vec<usize> = others(from).filter(|&to| !reached[from][to] && !unmet.contains(&to)).collect();
        if !missing.is_empty() {
            partly += 1;
            if partly <= NAMED {
                clauses.push(format!("nothing leads from {} to {}", sequences[from].name, names(missing)));
            }
        }
    }
    if partly > NAMED {
        clauses.push(format!("and so it is with {} sequences more", partly - NAMED));
    }
    if clauses.is_empty() {
        clauses = ends(timeline, edges, &names);
    }
    if clauses.is_empty() {
        return None;
    }
    let message = format!(
        "{pairs} pairs of frames have no way from one to the other: {}. Record what joins them, or allow longer transitions \
         (--longest)",
        clauses.join("; ")
    );
    Some(Warning::new("W_UNREACHABLE", message))
}

/// Which sequences can be reached from the first frame of `from`, from where all its frames can.
fn sequences_reached(timeline: &Timeline, edges: &[(u32, u32)], from: &Sequence) -> Vec<bool> {
    let mut leaves = vec![Vec::new(); timeline.frame_count() as usize];
    for &(from, to) in edges {
        leaves[from as usize].push(to);
    }
    let mut seen = vec![false; timeline.frame_count() as usize];
    let mut stack = vec![from.first_frame];
    let mut reached = vec![false; timeline.sequences().len()];
    while let Some(frame) = stack.pop() {
        if std::mem::replace(&mut seen[frame as usize], true) {
            continue;
        }
        if let Some(sequence) = timeline.sequence_index(frame) {
            reached[sequence] = true;
        }
        stack.extend(timeline.next(frame));
        stack.extend(&leaves[frame as usize]);
    }
    reached
}

/// Where every sequence leads to every other, but not from everywhere in it: those of which more than a moment at the end
/// leads nowhere, or more than a moment at the beginning is reached by nothing. A moment is what every sequence loses that is
/// no loop, for a transition takes some frames.
fn ends(timeline: &Timeline, edges: &[(u32, u32)], names: &dyn Fn(Vec<usize>) -> String) -> Vec<String> {
    let moment = (MOMENT * timeline.fps()) as u32;
    let sequences = timeline.sequences();
    let longer = |frames: &dyn Fn(&Sequence) -> u32| -> Vec<usize> {
        (0..sequences.len()).filter(|&k| !sequences[k].cyclic && frames(&sequences[k]) > moment).collect()
    };
    let last_left = |sequence: &Sequence| edges.iter().map(|edge| edge.0).filter(|&from| sequence.contains(from)).max();
    let first_met = |sequence: &Sequence| edges.iter().map(|edge| edge.1).filter(|&to| sequence.contains(to)).min();
    let after = longer(&|s| s.end_frame() - last_left(s).map_or(s.first_frame, |from| from + 1));
    let before = longer(&|s| first_met(s).unwrap_or(s.end_frame()) - s.first_frame);
    let mut clauses = Vec::new();
    if !after.is_empty() {
        clauses.push(format!("nothing leads on from the end (a second or more) of {}", names(after)));
    }
    if !before.is_empty() {
        clauses.push(format!("nothing leads to the beginning (a second or more) of {}", names(before)));
    }
    clauses
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timeline(names: &[&str], frames: u32) -> Timeline {
        let sequence = |(k, name): (usize, &&str)| Sequence {
            name: (*name).into(),
            labels: vec![],
            first_frame: k as u32 * frames,
            frame_count: frames,
            cyclic: false,
        };
        Timeline::new(25.0, names.iter().enumerate().map(sequence).collect()).unwrap()
    }

    #[test]
    fn sequences_without_a_way_are_named() {
        let timeline = timeline(&["walk", "run", "jump"], 10);
        let told = |edges: &[(u32, u32)]| unreachable(&timeline, edges, 7).unwrap().message;
        assert_eq!(unreachable(&timeline, &[], 0), None);
        // Walk and run lead to each other; jump is an island.
        let island = told(&[(5, 12), (15, 2)]);
        assert!(island.contains("7 pairs of frames"), "{island}");
        assert!(island.contains("nothing leads from jump to any other"), "{island}");
        assert!(island.contains("nothing leads to jump from any other"), "{island}");
        // Walk leads to run and jump, which lead to each other, and nothing leads back.
        let one_way = told(&[(5, 12), (15, 22), (25, 12)]);
        assert!(one_way.contains("nothing leads to walk from any other"), "{one_way}");
        // Run leads to jump, but not back; walk reaches both and is reached from jump.
        let partly = told(&[(5, 12), (15, 2), (5, 22)]);
        assert!(partly.contains("nothing leads from jump to any other"), "{partly}");
    }

    #[test]
    fn long_ends_are_told_and_moments_are_not() {
        let timeline = timeline(&["walk", "run", "jump"], 50);
        assert_eq!(unreachable(&timeline, &[(45, 52), (95, 102), (145, 2)], 7), None);
        let ends = unreachable(&timeline, &[(45, 82), (95, 102), (121, 2)], 7).unwrap().message;
        assert!(ends.contains("from the end (a second or more) of jump; "), "{ends}");
        assert!(ends.contains("to the beginning (a second or more) of run."), "{ends}");
    }
}
