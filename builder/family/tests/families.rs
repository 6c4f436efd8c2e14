//! Families of what the built-in performer does steadily.
#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::sync::OnceLock;

use actor::capture::Poses;
use actor::feet::Feet;
use actor::timeline::{Sequence, Timeline};
use family::{Family, FamilyError, Parameter, Recorded, Wanted, found, proposals};
use glam::{Vec3, Vec3Swizzles};
use job::Job;
use kernels::align::{Placement, align_heading};
use kernels::topology::{Topology, barycentric_areas};
use performer::Kind;
use performer::figure::Figure;
use performer::motion::{leap, steady};
use performer::perform::perform_motion;

const FPS: f32 = 50.0;
const WALK: usize = 0;
const RUN: usize = 1;
const STAND: usize = 2;
const LOW: usize = 3;
const HIGH: usize = 4;
const SHORT: usize = 5;

struct Performed {
    topology: Topology,
    timeline: Timeline,
    poses: Poses,
    feet: Feet,
    floors: Vec<f32>,
}

impl Performed {
    fn recorded(&self) -> Recorded<'_> {
        let Self { topology, timeline, poses, feet, floors } = self;
        Recorded { topology, timeline, poses, feet, floors }
    }

    fn family(&self, parameter: Parameter, sequences: &[usize]) -> Result<Family<'_>, FamilyError> {
        let sequences = sequences.iter().map(|&sequence| (sequence, None)).collect();
        Family::new(self.recorded(), &Wanted { parameter, sequences }, &Job::silent())
    }
}

/// Walk, run, stand, two jumps, and three frames, performed once for all tests.
fn performed() -> &'static Performed {
    static PERFORMED: OnceLock<Performed> = OnceLock::new();
    PERFORMED.get_or_init(|| {
        let figure = Figure::of(Kind::Woman, 1500, 128);
        let motions = [
            (steady(2.4, 1, 1.3, 0.0), 120),
            (steady(2.4, 2, 3.0, 0.0), 120),
            (steady(2.4, 3, 0.0, 0.0), 30),
            (leap(4, 0.4, 0.42), 108),
            (leap(5, 0.8, 0.54), 112),
            (steady(2.4, 1, 1.3, 0.0), 3),
        ];
        let mut poses = Poses::new(figure.mesh.positions.len());
        let mut sequences = Vec::new();
        for (number, (motion, count)) in motions.iter().enumerate() {
            let frames = perform_motion(&figure, motion, *count, FPS);
            let (first_frame, frame_count) = (poses.len() as u32, frames.len() as u32);
            let name = format!("s{number}");
            sequences.push(Sequence { name, labels: vec![], first_frame, frame_count, cyclic: false });
            frames.iter().for_each(|frame| poses.push(&frame.positions));
        }
        let triangles = figure.mesh.triangles.clone();
        let weights = barycentric_areas(&triangles, poses.frame(0));
        let topology = Topology::new(poses.vertex_count() as u32, triangles, weights).unwrap();
        let timeline = Timeline::new(FPS, sequences).unwrap();
        let feet = pipeline::feet::feet(&topology, &timeline, &poses);
        let floors = pipeline::contacts::floors(&timeline, &poses);
        Performed { topology, timeline, poses, feet, floors }
    })
}

fn step(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum::<f32>() / a.len() as f32
}

#[test]
fn a_speed_that_is_asked_for_is_walked_without_sliding() {
    let performed = performed();
    let recorded = performed.recorded();
    let family = performed.family(Parameter::Speed, &[RUN, WALK]).unwrap();
    let (low, high) = family.range();
    assert!((low - 1.3).abs() < 0.08 && (high - 3.0).abs() < 0.2, "{low} to {high}");
    assert!(family.is_monotone());
    for asked in [1.5, 1.8, 2.1, 2.5, 2.8] {
        let sample = family.ask(asked).unwrap();
        // The speed that is seen: from a centre of mass to the same one a cycle later.
        let first = recorded.centre(&sample.poses[0]);
        let again = sample.end.apply(Vec3::new(first.x, 0.0, first.y)).xz();
        let speed = again.distance(first) / (sample.poses.len() as f32 / FPS);
        assert!((speed / asked - 1.0).abs() < 0.03, "asked {asked}, walks {speed}");
        assert!(sample.measured.slide.unwrap() < 0.0007, "{asked}: {:?}", sample.measured);
        assert!(sample.measured.lowest > -0.005, "{asked}: {:?}", sample.measured);
        // Its end meets its beginning as frames meet each other.
        let mut next = sample.poses[0].clone();
        sample.end.apply_all(&mut next);
        let wrap = step(&sample.poses[sample.poses.len() - 1], &next);
        let most = sample.poses.windows(2).map(|pair| step(&pair[0], &pair[1])).fold(0.0, f32::max);
        assert!(wrap < 1.1 * most, "{asked}: {wrap} against {most}");
    }
    assert!(family.ask(9.0).unwrap().measured.speed <= high * 1.001, "the fastest that there is");
}

#[test]
fn the_ends_of_a_family_are_what_was_recorded() {
    let performed = performed();
    let recorded = performed.recorded();
    let family = performed.family(Parameter::Speed, &[WALK, RUN]).unwrap();
    let sample = family.at(0.0).unwrap();
    let (member, _) = family.members().next().unwrap();
    assert!(member.seam > 0);
    // In the middle of the cycle nothing is closed: the sample is the recorded frame, moved along the ground, but for its soles.
    for frame in member.seam..member.frames.len() - member.seam {
        let (truth, pose) = (performed.poses.frame(member.frames[frame]), &sample.poses[frame]);
        let turn = align_heading(pose, truth, performed.topology.weights());
        let placement = Placement::turning(turn, recorded.centre(truth), recorded.centre(pose));
        let apart: Vec<f32> = truth.iter().zip(pose).map(|(a, b)| placement.apply(*a).distance(*b)).collect();
        let mean = apart.iter().sum::<f32>() / apart.len() as f32;
        assert!(mean < 0.005, "frame {frame}: {mean}");
    }
}

#[test]
fn jumps_are_as_high_and_as_far_as_is_asked() {
    let performed = performed();
    let height = performed.family(Parameter::Height, &[LOW, HIGH]).unwrap();
    let length = performed.family(Parameter::Length, &[LOW, HIGH]).unwrap();
    for (family, parameter) in [(&height, Parameter::Height), (&length, Parameter::Length)] {
        for asked in family.values(4) {
            let sample = family.ask(asked).unwrap();
            let found = sample.measured.value(parameter);
            assert!((found / asked - 1.0).abs() < 0.03, "{parameter} {asked}: {found}");
            assert!(
                sample.measured.slide.unwrap() < 0.0007 && sample.measured.lowest > -0.005,
                "{:?}",
                sample.measured
            );
            assert!(!sample.cyclic);
        }
    }
    let (low, high) = length.range();
    assert!((low - 0.4).abs() < 0.06 && (high - 0.8).abs() < 0.08, "{low} to {high}");
}

#[test]
fn the_capture_proposes_its_families() {
    let performed = performed();
    let recorded = performed.recorded();
    let found = found(&recorded);
    let proposals = proposals(&recorded, &found);
    let names: Vec<&str> = proposals.iter().map(|proposal| proposal.name).collect();
    assert_eq!(names, ["gait", "jump height", "jump length"]);
    assert_eq!(proposals[0].wanted.sequences, [(WALK, None), (RUN, None)]);
    assert_eq!(proposals[1].wanted.sequences, [(LOW, None), (HIGH, None)]);
}

#[test]
fn what_is_no_family_is_refused_with_a_sentence() {
    let performed = performed();
    let told = |parameter, sequences: &[usize]| performed.family(parameter, sequences).err().unwrap().to_string();
    assert!(told(Parameter::Speed, &[WALK]).contains("two sequences at least"));
    assert!(told(Parameter::Speed, &[WALK, STAND]).contains("\"s2\" has no cycle"));
    assert!(told(Parameter::Speed, &[WALK, HIGH]).contains("\"s4\" has no cycle"));
    assert!(told(Parameter::Height, &[WALK, HIGH]).contains("\"s0\" has no cycle"));
    assert!(told(Parameter::Speed, &[SHORT, WALK]).contains("\"s5\" has no cycle"));
    assert!(told(Parameter::Speed, &[WALK, WALK]).contains("nearly the same speed, 1.3"));
    let frames = |frames| Wanted { parameter: Parameter::Speed, sequences: vec![(WALK, Some(frames)), (RUN, None)] };
    let named = |range| Family::new(performed.recorded(), &frames(range), &Job::silent()).err().unwrap().to_string();
    assert!(named((5, 120)).contains("has frames 0 to 119"));
    assert!(named((5, 20)).contains("\"s0\" has no cycle"));
    let none = Feet::default();
    let floating = Recorded { feet: &none, ..performed.recorded() };
    let error = Family::new(floating, &frames((0, 119)), &Job::silent()).err().unwrap();
    assert!(matches!(error, FamilyError::NoContacts));
}
