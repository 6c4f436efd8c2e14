//! Members of families, asked for by a number: `gait@1.4` is what is nearest to 1.4 metres a second.

use actor::timeline::Timeline;
use kernels::decimal::decimal;

use super::behaviours::Behaviour;

/// By as much of a family's range a member may be farther from what is asked for than the nearest one, and be taken for it: a
/// recorded cycle and the sample of the same speed are one.
const AS_NEAR: f32 = 0.01;

/// A member of a family, as searches know it.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Number of its family.
    pub family: usize,
    /// The name of that.
    pub name: String,
    /// Its first and its last frame.
    pub frames: [u32; 2],
    /// What it is asked by.
    pub value: f32,
}

/// The members of all families, family by family.
#[must_use]
pub fn members(timeline: &Timeline) -> Vec<Member> {
    let families = timeline.families().iter().enumerate();
    let of_family = |(number, family): (usize, &actor::families::Family)| {
        let name = family.name.clone();
        let member = move |member: &actor::families::FamilyMember| {
            let (name, frames, value) = (name.clone(), member.frames, member.value);
            Member { family: number, name, frames, value }
        };
        family.members.iter().map(member).collect::<Vec<_>>()
    };
    families.flat_map(of_family).collect()
}

/// The number among `members` of the one that `NAME@VALUE` asks for: the member nearest to that value of the family of that name, or
/// of the first one that has a member which shows that behaviour; `shows` says whether a frame shows one, by its number.
#[must_use]
pub fn find_member(
    members: &[Member],
    behaviours: &[Behaviour],
    shows: impl Fn(usize, u32) -> bool,
    asked: &str,
) -> Option<usize> {
    let (name, value) = asked.rsplit_once('@')?;
    let value = decimal(value)? as f32;
    let behaviour = behaviours.iter().position(|behaviour| behaviour.name == name);
    let is_shown = |member: &&Member| behaviour.is_some_and(|behaviour| shows(behaviour, member.frames[0]));
    let family = members.iter().find(|member| member.name == name).or_else(|| members.iter().find(is_shown))?.family;
    let (mut near, mut low, mut high) = (f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY);
    for member in members.iter().filter(|member| member.family == family) {
        near = near.min((member.value - value).abs());
        (low, high) = (low.min(member.value), high.max(member.value));
    }
    let reach = near + AS_NEAR * (high - low);
    members.iter().position(|member| member.family == family && (member.value - value).abs() <= reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::behaviours::behaviours;
    use actor::families::{Family, FamilyMember};
    use actor::timeline::Sequence;

    #[test]
    fn members_are_asked_for_by_a_number() {
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
        let (named, all) = (behaviours(&timeline), members(&timeline));
        let shows = |behaviour: usize, frame: u32| named[behaviour].shown_by[timeline.sequence_index(frame).unwrap()];
        let value = |name: &str| find_member(&all, &named, shows, name).map(|number| all[number].value);
        assert_eq!(value("gait@1.4"), Some(1.5));
        assert_eq!(value("gait@-3"), Some(1.0), "nothing is below the walk");
        assert_eq!(value("run@1.4"), Some(1.5), "by what a member shows");
        assert_eq!(value("gait@1e3"), Some(2.995), "the sample is as good as what was recorded, and comes first");
        for wrong in ["gait", "gait@", "gait@fast", "gait@1.2.3", "gait@.", "fly@1", "@1", "gait@-"] {
            assert_eq!(value(wrong), None, "{wrong}");
        }
    }
}
