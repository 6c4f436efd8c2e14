//! Section 12: families of cycles and what lies between them (Tejera, Casas and Hilton 2013, section IV, figures 7 and 8).
//!
//! On the capture under evaluation as far as its manifest asks for families or it has cycles, and on steady steps and jumps of the built-in performer, of which one
//! that lies between is the truth.

mod measure;
mod performed;
mod pictures;

use actor::capture::Capture;
use family::{Family, FamilyError, Parameter, Recorded, Sample, Wanted};
use glam::{Vec3, Vec3Swizzles};
use job::Job;
use kernels::align::{align_heading, centre_of_mass, rotate};
use performer::Kind;
use rayon::prelude::*;
use reprise::families::{Ground, resolved};

use self::measure::{Measures, Motion};
use self::performed::{HIGH, JOG, LEFT, LOW, MIDDLE, RIGHT, RUN, WALK, performed};
use self::pictures::strips;
use super::EvaluateError;
use super::document::{Agreement, Cell, SectionReport, Table, Verdict};
use super::subject::Subject;

/// Samples of a family that are measured.
const SAMPLES: usize = 9;
/// Samples of a strip.
const SHOWN: usize = 5;
/// Phases at which a sample is compared with the truth.
const PHASES: usize = 24;
/// Places within a cycle from which the comparison is begun.
const SHIFTS: usize = 96;
/// The marks: parts of the parameter in percent, millimetres per fiftieth of a second, millimetres.
const PARAMETER: f64 = 3.0;
const SLIDE: f64 = 0.7;
const LOWEST: f64 = -5.0;

/// The worst of all samples of a capture.
#[derive(Default)]
struct Worst {
    parameter: f64,
    slide: f64,
    lowest: f64,
    samples: usize,
}

/// Makes the section.
pub fn section(subject: &Subject, job: &Job) -> Result<SectionReport, EvaluateError> {
    let mut section = SectionReport {
        text: vec![
            "Cycles are cut where a foot lands, closed, aligned by their landings and blended; the parameter is measured on the \
             result and inverted. Every second of the samples asked for lies between two rows of that table. Slide is that of vertices of \
             soles within 2 cm of the ground in two frames in a row, where their mean is slower than 0.25 m/s; what touches and is \
             faster is counted beside it. Acceleration and volume are compared with both members, by the sample's weight."
                .into(),
        ],
        tables: vec![members_table(), samples_table(), truth_table()],
        ..SectionReport::default()
    };
    let mut worst = Worst { lowest: f64::INFINITY, ..Worst::default() };
    let ground = Ground::of(&subject.capture);
    let recorded = ground.recorded(&subject.capture);
    for (name, wanted) in wanted(subject, &recorded) {
        let name = format!("{}: {name}", subject.capture.name);
        match Family::new(recorded, &wanted, job) {
            Ok(family) => of_family(&recorded, (&name, &family), &mut section, &mut worst, job)?,
            Err(FamilyError::Stopped(stopped)) => return Err(stopped.into()),
            Err(error) => section.text.push(format!("{name}: no family, for {error}.")),
        }
    }
    if worst.samples == 0 {
        section.text.push("No two sequences of this capture make a family.".into());
    }
    let steady = performed(Kind::Woman, subject.options.seed);
    of_performer(&steady, &mut section, &mut worst, job)?;
    section.agreements = agreements(&worst);
    Ok(section)
}

/// The families of the manifest, or else those that are found.
fn wanted(subject: &Subject, recorded: &Recorded) -> Vec<(String, Wanted)> {
    if subject.families.is_empty() {
        let found = family::found(recorded);
        let proposals = family::proposals(recorded, &found).into_iter();
        return proposals.map(|proposal| (proposal.name.to_owned(), proposal.wanted)).collect();
    }
    subject.families.iter().map(|family| (family.name.clone(), resolved(recorded, family))).collect()
}

fn members_table() -> Table {
    let columns =
        ["family", "sequence", "frames", "value", "apart mm", "slide mm", "fast %", "lowest mm", "acceleration"];
    Table::new("family_members", "What families are made of, as it was recorded", &columns)
}

fn samples_table() -> Table {
    let columns = [
        "family",
        "between",
        "weight",
        "asked",
        "measured",
        "off %",
        "frames",
        "slide mm",
        "fast %",
        "lowest mm",
        "acceleration of both's",
        "peak of both's",
        "volume of both's",
    ];
    let caption = "Samples: asked against measured, slide per 1/50 s, soles, acceleration (mean and peak) and volume beside both members'";
    Table::new("family_samples", caption, &columns)
}

fn truth_table() -> Table {
    let columns = [
        "sequence",
        "parameter",
        "asked",
        "measured",
        "sample mm",
        "nearer member mm",
        "other member mm",
        "best weight",
        "best mm",
    ];
    let caption = "Samples against what was performed and not learned from: root mean square over vertices and phases, each phase turned \
                   and moved onto the truth; at the right of the weight that is nearest, whatever its parameter";
    Table::new("family_truth", caption, &columns)
}

/// Measures the samples of a family, and shows some.
fn of_family(
    recorded: &Recorded,
    (name, family): (&str, &Family),
    section: &mut SectionReport,
    worst: &mut Worst,
    job: &Job,
) -> Result<(), EvaluateError> {
    let parameter = family.parameter();
    let sequence = |index: usize| recorded.timeline.sequences()[index].name.clone();
    let mut sources: Vec<(usize, Measures)> = Vec::new();
    for ((member, apart), value) in family.members().zip(family.member_values()) {
        let measures = Motion::recorded(recorded, member.sequence, &member.frames).measures(recorded);
        let first = recorded.timeline.sequences()[member.sequence].first_frame;
        let frames = [member.frames.first(), member.frames.last()].map(|frame| frame.map_or(0, |frame| frame - first));
        section.tables[0].rows.push(vec![
            name.into(),
            sequence(member.sequence).into(),
            format!("{}-{}", frames[0], frames[1]).into(),
            Cell::Number(value.into(), 3),
            Cell::Number(f64::from(apart) * 1e3, 0),
            Cell::Number(measures.slide, 2),
            Cell::Number(measures.fast, 1),
            Cell::Number(measures.lowest, 1),
            Cell::Number(measures.acceleration[0], 1),
        ]);
        sources.push((member.sequence, measures));
    }
    let mut shown = Vec::new();
    for (k, value) in family.values(SAMPLES).into_iter().enumerate() {
        job.tell("samples", k as u64, SAMPLES as u64)?;
        let sample = ask(family, value)?;
        let own = Motion::of_sample(&sample).measures(recorded);
        let index = sample.member;
        let lambda = f64::from(sample.lambda);
        let of_both = |of: &dyn Fn(&Measures) -> f64| {
            of(&own)
                / ((1.0 - lambda) * of(&sources[index].1) + lambda * of(&sources[index + 1].1)).max(f64::MIN_POSITIVE)
        };
        let found = sample.measured.value(parameter);
        let off = f64::from((found - value).abs() / value.abs().max(parameter.grain())) * 100.0;
        worst.parameter = worst.parameter.max(off);
        worst.slide = worst.slide.max(own.slide);
        worst.lowest = worst.lowest.min(own.lowest);
        worst.samples += 1;
        section.tables[1].rows.push(vec![
            name.into(),
            format!("{}, {}", sequence(sample.sequences[0]), sequence(sample.sequences[1])).into(),
            Cell::Number(lambda, 3),
            Cell::Number(value.into(), 3),
            Cell::Number(found.into(), 3),
            Cell::Number(off, 2),
            Cell::Count(sample.poses.len() as u64),
            Cell::Number(own.slide, 2),
            Cell::Number(own.fast, 1),
            Cell::Number(own.lowest, 1),
            Cell::Number(of_both(&|measures| measures.acceleration[0]), 2),
            Cell::Number(of_both(&|measures| measures.acceleration[1]), 2),
            Cell::Number(of_both(&|measures| measures.volume), 3),
        ]);
        if k.is_multiple_of((SAMPLES - 1) / (SHOWN - 1)) {
            shown.push(sample);
        }
    }
    let told: Vec<String> = shown.iter().map(|sample| parameter.told(sample.measured.value(parameter))).collect();
    let caption = format!("{name} by {parameter}, from above: {}. Grey is recorded, red is blended.", told.join(", "));
    section.pictures.push(strips(recorded, &shown, caption)?);
    Ok(())
}

fn ask(family: &Family, value: f32) -> Result<Sample, EvaluateError> {
    family.ask(value).map_err(EvaluateError::Family)
}

/// Families of the built-in performer, and the truth between.
fn of_performer(
    capture: &Capture,
    section: &mut SectionReport,
    worst: &mut Worst,
    job: &Job,
) -> Result<(), EvaluateError> {
    let ground = Ground::of(capture);
    let recorded = ground.recorded(capture);
    let family = |names: &[&str], parameter: Parameter| {
        let number = |name: &&str| recorded.timeline.sequences().iter().position(|one| one.name == *name);
        let sequences = names.iter().filter_map(number).map(|sequence| (sequence, None)).collect();
        Family::new(recorded, &Wanted { parameter, sequences }, job).map_err(EvaluateError::Family)
    };
    let made = [
        ("steady gait", family(&[WALK, RUN], Parameter::Speed)?),
        ("steady turn", family(&[LEFT, WALK, RIGHT], Parameter::Turn)?),
        ("jump height", family(&[LOW, HIGH], Parameter::Height)?),
        ("jump length", family(&[LOW, HIGH], Parameter::Length)?),
    ];
    for (name, family) in &made {
        of_family(&recorded, (name, family), section, worst, job)?;
    }
    let truths = [
        (JOG, &made[0].1, family(&[WALK, JOG], Parameter::Speed)?),
        (MIDDLE, &made[2].1, family(&[LOW, MIDDLE], Parameter::Height)?),
        (MIDDLE, &made[3].1, family(&[LOW, MIDDLE], Parameter::Length)?),
    ];
    for (name, between, with_truth) in &truths {
        // The member with the greater value of the second family is the truth.
        let truth = with_truth.at(1.0).map_err(EvaluateError::Family)?;
        let value = truth.measured.value(between.parameter());
        let sample = ask(between, value)?;
        let weights = (0..=10).map(|k| k as f32 / 10.0);
        let far: Vec<(f64, f32)> = weights
            .map(|weight| Ok((off(&recorded, &truth, &between.at(weight).map_err(EvaluateError::Family)?), weight)))
            .collect::<Result<_, EvaluateError>>()?;
        let (best, weight) = far.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
        let [low, high] = [far[0].0, far[far.len() - 1].0];
        section.tables[2].rows.push(vec![
            (*name).into(),
            between.parameter().to_string().into(),
            Cell::Number(value.into(), 3),
            Cell::Number(sample.measured.value(between.parameter()).into(), 3),
            Cell::Number(off(&recorded, &truth, &sample) * 1e3, 1),
            Cell::Number(low.min(high) * 1e3, 1),
            Cell::Number(low.max(high) * 1e3, 1),
            Cell::Number(weight.into(), 1),
            Cell::Number(best * 1e3, 1),
        ]);
    }
    Ok(())
}

/// Root of the mean square distance of a sample's vertices from the truth's at the same phases, in metres; where both repeat, begun
/// where it is least, for they may be cut at other feet.
fn off(recorded: &Recorded, truth: &Sample, sample: &Sample) -> f64 {
    let weights = recorded.topology.weights();
    let frame = |of: &Sample, phase: f32| -> Vec<Vec3> {
        let count = of.poses.len();
        let at = phase * if of.cyclic { count } else { count - 1 } as f32;
        let (k, share) = (at.floor() as usize, at - at.floor());
        if of.cyclic && k + 1 >= count {
            return of.poses[k % count].clone();
        }
        let (here, next) = (&of.poses[k], &of.poses[(k + 1).min(count - 1)]);
        here.iter().zip(next).map(|(here, next)| here.lerp(*next, share)).collect()
    };
    let last = if sample.cyclic { PHASES } else { PHASES - 1 } as f32;
    let truths: Vec<Vec<Vec3>> = (0..PHASES).map(|k| frame(truth, k as f32 / last)).collect();
    let apart = |truth: &[Vec3], pose: &[Vec3]| {
        let turn = align_heading(truth, pose, weights);
        let to = centre_of_mass(truth, weights).xz() - rotate(turn, centre_of_mass(pose, weights).xz());
        let one = |(truth, point): (&Vec3, &Vec3)| {
            let ground = rotate(turn, point.xz()) + to;
            f64::from(Vec3::new(ground.x, point.y, ground.y).distance_squared(*truth))
        };
        truth.iter().zip(pose).map(one).sum::<f64>() / truth.len() as f64
    };
    let shifted = |shift: usize| {
        let phase = |k: usize| {
            let phase = k as f32 / last + shift as f32 / SHIFTS as f32;
            if sample.cyclic { phase.fract() } else { phase }
        };
        let phases = truths.iter().enumerate();
        let sum: f64 = phases.map(|(k, truth)| apart(truth, &frame(sample, phase(k)))).sum();
        (sum / PHASES as f64).sqrt()
    };
    let shifts = if sample.cyclic { 0..SHIFTS } else { 0..1 };
    shifts.into_par_iter().map(shifted).collect::<Vec<f64>>().into_iter().fold(f64::INFINITY, f64::min)
}

fn agreements(worst: &Worst) -> Vec<Agreement> {
    let agreement = |papers: &str, found: String, holds: bool| Agreement {
        papers: papers.into(),
        found,
        verdict: Verdict::of(holds, holds),
        why: String::new(),
    };
    vec![
        agreement(
            "Mark: a sample has what was asked for to 3 %",
            format!("{:.2} % at most, of {} samples", worst.parameter, worst.samples),
            worst.parameter <= PARAMETER,
        ),
        agreement(
            "Mark: what stands slides at most 0.7 mm per 1/50 s",
            format!("{:.2} mm at most", worst.slide),
            worst.slide <= SLIDE,
        ),
        agreement(
            "Mark: no sole is below -5 mm",
            format!("{:.1} mm at the lowest", worst.lowest),
            worst.lowest >= LOWEST,
        ),
    ]
}
