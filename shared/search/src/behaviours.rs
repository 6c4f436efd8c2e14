//! What behaviours a capture has, and which sequences show them. Everybody asks here: searches, links and the page.

use actor::timeline::Timeline;
use thiserror::Error;

/// A behaviour by name, and for every sequence whether it shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Behaviour {
    /// A label, or the name of a sequence that is no label.
    pub name: String,
    /// By sequence.
    pub shown_by: Vec<bool>,
}

/// A behaviour that the capture does not have.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no behaviour {name:?}; there are: {}", known.join(", "))]
pub struct UnknownBehaviour {
    /// The name asked for.
    pub name: String,
    /// The names that there are.
    pub known: Vec<String>,
}

/// All behaviours: the labels, then the sequences whose name is no label. A label wins over a sequence of the same name.
#[must_use]
pub fn behaviours(timeline: &Timeline) -> Vec<Behaviour> {
    let sequences = timeline.sequences();
    let labels = sequences.iter().flat_map(|sequence| &sequence.labels);
    let names = labels.chain(sequences.iter().map(|sequence| &sequence.name));
    let mut found: Vec<Behaviour> = Vec::new();
    for name in names {
        if found.iter().any(|behaviour| behaviour.name == *name) {
            continue;
        }
        let by_label: Vec<bool> = sequences.iter().map(|sequence| sequence.labels.contains(name)).collect();
        let by_name = || sequences.iter().map(|sequence| sequence.name == *name).collect();
        let shown_by = if by_label.contains(&true) { by_label } else { by_name() };
        found.push(Behaviour { name: name.clone(), shown_by });
    }
    found
}

/// The number among `behaviours` of the one with this name.
///
/// # Errors
/// There is none; the error lists those that there are.
pub fn find_behaviour(behaviours: &[Behaviour], name: &str) -> Result<usize, UnknownBehaviour> {
    behaviours.iter().position(|behaviour| behaviour.name == name).ok_or_else(|| UnknownBehaviour {
        name: name.into(),
        known: behaviours.iter().map(|behaviour| behaviour.name.clone()).collect(),
    })
}

/// The frames that show `behaviour`, in order.
#[must_use]
pub fn frames_of(behaviour: &Behaviour, timeline: &Timeline) -> Vec<u32> {
    let shown = timeline.sequences().iter().zip(&behaviour.shown_by).filter(|&(_, &shown)| shown);
    shown.flat_map(|(sequence, _)| sequence.first_frame..sequence.end_frame()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::timeline::Sequence;

    #[test]
    fn a_label_wins_over_a_sequence_of_the_same_name() {
        let list = [("walk", &["locomotion"][..]), ("run", &["locomotion", "walk"]), ("jump", &[])];
        let sequences = (0..).zip(list).map(|(index, (name, labels))| Sequence {
            name: name.into(),
            labels: labels.iter().map(|&label| label.into()).collect(),
            first_frame: 3 * index,
            frame_count: 3,
            cyclic: false,
        });
        let timeline = Timeline::new(25.0, sequences.collect()).unwrap();
        let found = behaviours(&timeline);
        let names: Vec<_> = found.iter().map(|behaviour| behaviour.name.as_str()).collect();
        assert_eq!(names, ["locomotion", "walk", "run", "jump"]);
        let frames = |name: &str| frames_of(&found[find_behaviour(&found, name).unwrap()], &timeline);
        assert_eq!(frames("locomotion"), [0, 1, 2, 3, 4, 5]);
        assert_eq!(frames("walk"), [3, 4, 5]);
        assert_eq!(frames("jump"), [6, 7, 8]);
        let unknown = find_behaviour(&found, "fly").unwrap_err();
        assert_eq!(unknown.to_string(), r#"there is no behaviour "fly"; there are: locomotion, walk, run, jump"#);
    }
}
