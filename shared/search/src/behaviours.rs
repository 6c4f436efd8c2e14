//! What behaviours a capture has, and which sequences show them. Everybody asks here: searches, links and the page.

use std::ops::RangeInclusive;

use actor::timeline::Timeline;
use thiserror::Error;

/// By as much of a family's range a member may be farther from what is asked for than the nearest one, and be taken for it: a
/// recorded cycle and the sample of the same speed are one.
const AS_NEAR: f32 = 0.01;

/// A behaviour by name, and for every sequence whether it shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Behaviour {
    /// A label, or the name of a sequence that is no label; of a member of a family the family's.
    pub name: String,
    /// By sequence.
    pub shown_by: Vec<bool>,
    /// The frames that show it, as far as their sequences do.
    pub within: RangeInclusive<u32>,
    /// What a member of a family is asked by: `NAME@VALUE`. Such have no name of their own.
    pub value: Option<f32>,
}

impl Behaviour {
    /// Whether `frame`, which is in the sequence of this number, shows it.
    #[must_use]
    pub fn shows(&self, sequence: usize, frame: u32) -> bool {
        self.shown_by[sequence] && self.within.contains(&frame)
    }

    fn is_named(&self, name: &str) -> bool {
        self.value.is_none() && self.name == name
    }
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

/// All behaviours: the labels, then the sequences whose name is no label, then the members of families. A label wins over a
/// sequence of the same name.
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
        found.push(Behaviour { name: name.clone(), shown_by, within: 0..=u32::MAX, value: None });
    }
    for family in timeline.families() {
        for member in &family.members {
            let [first, last] = member.frames;
            let shown_by = sequences.iter().map(|sequence| sequence.name == member.sequence).collect();
            let value = Some(member.value);
            found.push(Behaviour { name: family.name.clone(), shown_by, within: first..=last, value });
        }
    }
    found
}

/// The number among `behaviours` of the one with this name; `NAME@VALUE` is the member nearest to that value of the family of
/// that name, or of the one that has a member that shows that behaviour.
///
/// # Errors
/// There is none; the error lists those that there are.
pub fn find_behaviour(behaviours: &[Behaviour], name: &str) -> Result<usize, UnknownBehaviour> {
    let found = behaviours.iter().position(|behaviour| behaviour.is_named(name));
    found.or_else(|| find_member(behaviours, name)).ok_or_else(|| {
        let named = behaviours.iter().filter(|behaviour| behaviour.value.is_none());
        UnknownBehaviour { name: name.into(), known: named.map(|behaviour| behaviour.name.clone()).collect() }
    })
}

/// The number of the member of a family that is asked for by `NAME@VALUE`.
fn find_member(behaviours: &[Behaviour], asked: &str) -> Option<usize> {
    let (name, value) = asked.rsplit_once('@')?;
    let value = decimal(value)?;
    let shown_by = behaviours.iter().find(|behaviour| behaviour.is_named(name)).map(|behaviour| &behaviour.shown_by);
    let shows = |member: &Behaviour| {
        let both = |shown: &Vec<bool>| shown.iter().zip(&member.shown_by).any(|(&a, &b)| a && b);
        member.value.is_some() && shown_by.is_some_and(both)
    };
    let is_family = |family: &&Behaviour| family.value.is_some() && family.name == name;
    let family = behaviours.iter().find(is_family).or_else(|| behaviours.iter().find(|member| shows(member)))?;
    let members = || {
        let of_family = (0..).zip(behaviours).filter(|(_, member)| member.name == family.name);
        of_family.filter_map(|(number, member)| Some((number, member.value?)))
    };
    let least = |all: &mut dyn Iterator<Item = f32>| all.fold(f32::INFINITY, f32::min);
    let range = -least(&mut members().map(|member| -member.1)) - least(&mut members().map(|member| member.1));
    let near = least(&mut members().map(|member| (member.1 - value).abs())) + AS_NEAR * range;
    let found = members().find(|member| (member.1 - value).abs() <= near);
    found.map(|(number, _)| number)
}

/// A number as people write it, such as `-1.4`; the library's own reader would weigh more than all of this.
fn decimal(text: &str) -> Option<f32> {
    let (sign, text) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let (mut value, mut unit, mut after) = (0.0_f64, 1.0, false);
    for byte in text.bytes() {
        match byte {
            b'0'..=b'9' => value = value * 10.0 + f64::from(byte - b'0'),
            b'.' if !after => after = true,
            _ => return None,
        }
        if after && byte != b'.' {
            unit *= 10.0;
        }
    }
    (!text.is_empty() && text != ".").then_some((sign * value / unit) as f32).filter(|value| value.is_finite())
}

/// The frames that show `behaviour`, in order.
#[must_use]
pub fn frames_of(behaviour: &Behaviour, timeline: &Timeline) -> Vec<u32> {
    let shown = timeline.sequences().iter().zip(&behaviour.shown_by).filter(|&(_, &shown)| shown);
    let frames = shown.flat_map(|(sequence, _)| sequence.first_frame..sequence.end_frame());
    frames.filter(|frame| behaviour.within.contains(frame)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use actor::families::{Family, FamilyMember};
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

    #[test]
    fn members_of_families_are_asked_for_by_a_number() {
        let names = [("walk", "walk"), ("run", "run"), ("gait 1.50 m/s", "gait"), ("gait 3.00 m/s", "gait")];
        let sequences = (0..).zip(names).map(|(index, (name, label))| Sequence {
            name: name.into(),
            labels: vec![label.into()],
            first_frame: 10 * index,
            frame_count: 10,
            cyclic: index > 1,
        });
        let member = |number: usize, frames: [u32; 2], value: f32| FamilyMember {
            sequence: names[number].0.into(),
            frames,
            value,
        };
        let gait = Family {
            name: "gait".into(),
            parameter: "speed".into(),
            unit: "m/s".into(),
            members: vec![
                member(2, [20, 29], 1.5),
                member(3, [30, 39], 2.995),
                member(0, [3, 8], 1.0),
                member(1, [10, 19], 3.0),
            ],
        };
        let timeline = Timeline::new(25.0, sequences.collect()).unwrap();
        let misplaced = Family { members: vec![member(0, [3, 12], 1.0)], ..gait.clone() };
        assert!(timeline.clone().with_families(vec![misplaced]).is_err());
        let timeline = timeline.with_families(vec![gait]).unwrap();
        let found = behaviours(&timeline);
        let frames = |name: &str| frames_of(&found[find_behaviour(&found, name).unwrap()], &timeline);
        assert_eq!(frames("gait@1.4"), frames("gait 1.50 m/s"));
        assert_eq!(
            frames("gait@-3"),
            [3, 4, 5, 6, 7, 8],
            "nothing is below the walk, of which only the cycle is a member"
        );
        assert_eq!(frames("run@1.4"), frames("gait@1.4"), "by what a member shows");
        assert_eq!(
            frames("gait@3"),
            frames("gait 3.00 m/s"),
            "the sample is as good as what was recorded, and comes first"
        );
        assert_eq!(frames("gait"), frames_of(&found[2], &timeline), "by its label all samples");
        for wrong in ["gait@", "gait@fast", "gait@1.2.3", "gait@.", "fly@1", "@1", "gait@-", "gait@1e3"] {
            let refused = find_behaviour(&found, wrong).unwrap_err();
            assert_eq!(refused.known, ["walk", "run", "gait", "gait 1.50 m/s", "gait 3.00 m/s"], "{wrong}");
        }
        assert_eq!([decimal("1.25"), decimal("-0.5"), decimal("12"), decimal(".5")], [1.25, -0.5, 12.0, 0.5].map(Some));
    }
}
