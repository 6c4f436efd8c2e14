//! Variations of what lies between two cycles: the blends of their variations.
//!
//! Thesis section 6.7, and Tejera, Casas and Hilton (2013), section IV: a sample of a family blends a cycle of one sequence with one of
//! another. Blended of the variations of both, by the same weight, it varies as they do, and its feet stand as those of any
//! sample. What is learned from a sample itself would be learned from one short cycle.

use std::collections::{BTreeMap, HashSet};

use actor::timeline::Timeline;
use capture_io::import::{FamilySamples, Imported, ManifestFamily, Warning};
use job::Job;

use crate::families::{self, FamilySummary, Ground, MadeFamily, MemberSummary};
use crate::options::PackError;

/// Seconds around a cycle within which that of a variation is looked for: it lands a little sooner or later.
const AROUND: f32 = 0.25;

/// The names of all samples of families.
pub(crate) fn samples(families: &[FamilySummary]) -> HashSet<String> {
    families.iter().flat_map(|family| &family.samples).map(|sample| sample.sequence.clone()).collect()
}

/// Adds to a capture, whose sequences have the variations `varied`, those of its families' samples: `gait 1.57 m/s~2` lies between
/// `walk~2` and `run~2`. Where a variation is no family any more, a warning says so and it is left out; how many were added.
pub(crate) fn add(
    imported: &mut Imported,
    families: &[FamilySummary],
    varied: &BTreeMap<String, Vec<String>>,
    job: &Job,
) -> Result<usize, PackError> {
    // Those whose members are all recorded have no samples.
    let wanted: Vec<ManifestFamily> =
        imported.families.iter().filter(|family| family.values.is_none()).cloned().collect();
    let ground = Ground::of(&imported.capture);
    let mut taken = families::names(&imported.capture.timeline);
    let (mut made, mut lost) = (Vec::new(), Vec::new());
    {
        let recorded = ground.recorded(&imported.capture);
        for (asked, summary) in wanted.iter().zip(families) {
            let variations = |member: &MemberSummary| varied.get(&member.sequence);
            let count = summary.members.iter().map(|member| variations(member).map_or(0, Vec::len)).min().unwrap_or(0);
            for number in 0..count {
                let asked = of_variations(asked, summary, &imported.capture.timeline, |name| {
                    varied.get(name).map(|names| names[number].as_str())
                });
                match families::make_one(&recorded, &asked, &mut taken, &mut Vec::new(), job) {
                    Ok(family) => made.push(renamed(family, summary, number, &mut taken)),
                    Err(failure) if failure.is_stopped() => return Err(failure.into()),
                    Err(failure) => lost.push((summary.name.clone(), number + 1, failure)),
                }
            }
        }
    }
    for (name, number, failure) in lost {
        let message = format!("variation {number} of family \"{name}\" is left out, for {}", failure.cause);
        imported.warnings.push(Warning::new("W_VARIATION_FAMILY", message));
    }
    families::append(imported, &made)?;
    Ok(made.iter().map(|family| family.samples.len()).sum())
}

/// The same family of other sequences: of about the same frames of each, at the values of its samples.
fn of_variations<'a>(
    asked: &ManifestFamily,
    summary: &FamilySummary,
    timeline: &Timeline,
    variation: impl Fn(&str) -> Option<&'a str>,
) -> ManifestFamily {
    let around = (AROUND * timeline.fps()) as u32;
    let last = |name: &str| {
        let sequence = timeline.sequences().iter().find(|sequence| sequence.name == name);
        sequence.map_or(0, |sequence| sequence.frame_count.saturating_sub(1))
    };
    let window = |member: &MemberSummary| {
        let (from, to) = member.frames;
        vec![from.saturating_sub(around), (to + around).min(last(&member.sequence))]
    };
    let members = summary.members.iter();
    ManifestFamily {
        sequences: members.clone().filter_map(|member| variation(&member.sequence)).map(str::to_owned).collect(),
        samples: Some(FamilySamples::At(summary.samples.iter().map(|sample| sample.asked).collect())),
        frames: Some(members.map(window).collect()),
        ..asked.clone()
    }
}

/// Samples have the names and labels of those that they vary: asked for one, the actor does any of them.
fn renamed(mut family: MadeFamily, summary: &FamilySummary, number: usize, taken: &mut HashSet<String>) -> MadeFamily {
    for ((told, (labels, _)), base) in family.summary.samples.iter_mut().zip(&mut family.samples).zip(&summary.samples)
    {
        taken.remove(&told.sequence);
        let mut name = format!("{}~{}", base.sequence, number + 1);
        while !taken.insert(name.clone()) {
            name.push('~');
        }
        told.sequence = name;
        *labels = vec![summary.name.clone(), base.sequence.clone()];
    }
    family
}
