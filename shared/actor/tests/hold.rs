//! The foot that has no time to step stays, and the body is carried to where it needs to be; others go where they have to.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

use actor::blend::{Blend, transition_placement, transition_way};
use actor::contacts::{Contact, Contacts, Facings, Held};
use actor::graph::{TURN_STEP, Transition};
use actor::motion::Motion;
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use glam::{Vec2, Vec3, Vec3Swizzles};
use kernels::align::Placement;
use kernels::scalar::half_turn;
use proptest::prelude::*;

const FRAMES: u32 = 16;
const STEPS: u32 = 14;
/// Half of the frames are those of a step: 0.2 s.
const FPS: f32 = 35.0;

fn timeline() -> Timeline {
    let sequence = |name: &str, first_frame| Sequence {
        name: name.into(),
        labels: vec![],
        first_frame,
        frame_count: FRAMES,
        cyclic: false,
    };
    Timeline::new(FPS, vec![sequence("a", 0), sequence("b", FRAMES)]).unwrap()
}

/// A foot: where it is in each sequence, and in which frames of them it stands.
type Foot<'a> = ([Vec2; 2], &'a dyn Fn(u32) -> bool);

/// Bodies that sway and turn over feet.
fn scene(sway: [f32; 2], feet: &[Foot]) -> (Motion, Contacts) {
    let mut motion = Motion { centres: vec![], facings: vec![], wraps: vec![Placement::IDENTITY; 2] };
    let mut contacts = Vec::new();
    for sequence in 0..2 {
        for frame in 0..FRAMES {
            let t = frame as f32 / 4.0;
            let lean = sway[sequence] * Vec2::new(t.sin(), (1.3 * t).cos());
            motion.centres.push(Vec3::new(lean.x, 1.0, lean.y));
            motion.facings.push(0.3 * sway[sequence] * t);
            let foot = |(places, stands): &Foot| Contact::rounded(places[sequence], f32::from(u8::from(stands(frame))));
            contacts.extend(feet.iter().map(foot));
        }
    }
    (motion, Contacts::new(feet.len(), contacts, &timeline()).unwrap())
}

/// From the first frame of the one sequence to the last but one of the other.
fn transition(motion: &Motion, contacts: &Contacts) -> Transition {
    let (ends, warp) = ((0, FRAMES + STEPS), TemporalWarp::new(vec![Move::Both; STEPS as usize]));
    let mut ground = motion;
    let placement = transition_placement(&timeline(), &mut ground, ends, &warp, contacts).unwrap();
    Transition { from: ends.0, to: ends.1, deformation: 0.0, warp, placement, turn: 0.0 }
}

/// How far the transition takes a foot: from where its source has it to where its destination will.
fn moved(transition: &Transition, feet: &Foot) -> f32 {
    let [source, destination] = feet.0;
    let arrives = transition.placement.apply(Vec3::new(destination.x, 0.0, destination.y)).xz();
    arrives.distance(Contact::rounded(source, 1.0).point)
}

fn always(_: u32) -> bool {
    true
}

/// In the air for eight frames in a row: a step.
fn steps(frame: u32) -> bool {
    !(4..12).contains(&frame)
}

proptest! {
    #[test]
    fn what_cannot_step_stays_and_what_can_goes(
        sway in prop::array::uniform2(-0.1_f32..0.1),
        at in prop::array::uniform4(-0.1_f32..0.1),
    ) {
        let place = |shift: Vec2| [Vec2::new(at[0], at[1]) + shift, Vec2::new(at[2], at[3]) - shift];
        let feet: [Foot; 2] = [(place(Vec2::ZERO), &always), (place(0.1 * Vec2::X), &steps)];
        let (motion, contacts) = scene(sway, &feet);
        let transition = transition(&motion, &contacts);
        prop_assert!(moved(&transition, &feet[0]) < 1e-3, "{}", moved(&transition, &feet[0]));
    }

    #[test]
    fn a_blend_goes_smoothly_from_where_the_source_would_be_to_where_it_arrives(sway in prop::array::uniform2(-0.2_f32..0.2)) {
        let feet: [Foot; 1] = [([Vec2::ZERO, Vec2::new(0.3, -0.1)], &always)];
        let (motion, contacts) = scene(sway, &feet);
        let transition = transition(&motion, &contacts);
        let start = Placement { heading: 0.7, translation: Vec2::new(3.0, -2.0) };
        let (timeline, mut ground) = (timeline(), &motion);
        let mut blend = Blend::of(&timeline, &mut ground, &transition, start, &contacts).unwrap();
        let mut centres = vec![blend.centre];
        while let Some(next) = blend.next(&timeline, &mut ground, &transition.warp, &contacts).unwrap() {
            blend = next;
            centres.push(blend.centre);
        }
        let arrives = start.after(&transition.placement);
        prop_assert!(blend.placements[1].translation.distance(arrives.translation) < 1e-4);
        // Beside what both sides do themselves, at most 1.5 of the way in a step: the steepest that an ease is.
        let sway = sway[0].abs().max(sway[1].abs());
        for pair in centres.windows(2) {
            prop_assert!(pair[0].distance(pair[1]) < 1.6 * (0.4 + 2.0 * sway) / STEPS as f32 + sway / 2.0);
        }
    }
}

#[test]
fn feet_that_are_in_the_air_on_both_sides_carry_nothing() {
    let place = [Vec2::ZERO, Vec2::new(0.2, 0.1)];
    let free = scene([0.1, -0.2], &[(place, &|_| false)]);
    let stepping = scene([0.1, -0.2], &[(place, &steps)]);
    let of = |(motion, contacts): &(Motion, Contacts)| transition(motion, contacts).placement;
    assert_eq!(of(&free), of(&stepping));
    let standing = scene([0.1, -0.2], &[(place, &always)]);
    assert!(of(&standing).translation.distance(of(&free).translation) > 0.05);
}

#[test]
fn of_two_feet_that_stand_one_stays_and_the_other_steps() {
    let feet: [Foot; 2] =
        [([Vec2::ZERO, Vec2::new(0.1, 0.0)], &always), ([Vec2::X, Vec2::new(1.2, 0.0)], &|frame| frame > 2)];
    let (motion, contacts) = scene([0.1, -0.1], &feet);
    let transition = transition(&motion, &contacts);
    assert!(moved(&transition, &feet[0]) < 1e-3 && moved(&transition, &feet[1]) > 0.05);
}

#[test]
fn actors_packed_before_hold_all_alike() {
    let feet: [Foot; 2] = [([Vec2::ZERO, Vec2::new(0.1, 0.0)], &always), ([Vec2::X, Vec2::new(1.2, 0.0)], &always)];
    let (motion, contacts) = scene([0.0, 0.0], &feet);
    assert!(contacts.steers());
    let earlier = contacts.held(Held::Alike);
    assert!(!earlier.steers());
    let transition = transition(&motion, &earlier);
    let ways = [0, 1].map(|foot| moved(&transition, &feet[foot]));
    assert!((ways[0] - ways[1]).abs() < 1e-3 && ways[0] > 0.02, "{ways:?}");
}

#[test]
fn a_segment_may_go_round_a_loop_more_than_once() {
    let sequence = |name: &str, first_frame, frame_count, cyclic| Sequence {
        name: name.into(),
        labels: vec![],
        first_frame,
        frame_count,
        cyclic,
    };
    let timeline = Timeline::new(FPS, vec![sequence("a", 0, 16, false), sequence("loop", 16, 5, true)]).unwrap();
    let centres = (0..21).map(|frame| Vec3::new(0.03 * frame as f32, 1.0, 0.01 * frame as f32)).collect();
    // Each round of the loop goes on by 15 cm.
    let wrap = Placement { heading: 0.0, translation: Vec2::new(0.15, 0.05) };
    let motion = Motion { centres, facings: vec![0.0; 21], wraps: vec![Placement::IDENTITY, wrap] };
    let contact = |frame: u32| Contact::rounded(Vec2::new(0.03 * frame as f32, 0.1), 1.0);
    let contacts = Contacts::new(1, (0..21).map(contact).collect(), &timeline).unwrap();
    let (ends, warp) = ((0, 18), TemporalWarp::new(vec![Move::Both; 12]));
    let mut ground = &motion;
    let placement = transition_placement(&timeline, &mut ground, ends, &warp, &contacts).unwrap();
    let transition = Transition { from: ends.0, to: ends.1, deformation: 0.0, warp, placement, turn: 0.0 };
    let mut blend = Blend::of(&timeline, &mut ground, &transition, Placement::IDENTITY, &contacts).unwrap();
    while let Some(next) = blend.next(&timeline, &mut ground, &transition.warp, &contacts).unwrap() {
        blend = next;
    }
    assert!(blend.placements[1].translation.distance(placement.translation) < 1e-4, "{blend:?}");
}

proptest! {
    #[test]
    fn a_body_turns_so_that_what_cannot_step_does_not(
        sway in prop::array::uniform2(-0.1_f32..0.1),
        points in prop::array::uniform2(-0.25_f32..0.25),
    ) {
        let feet: [Foot; 2] = [([Vec2::ZERO, Vec2::new(0.1, -0.05)], &always), ([Vec2::X; 2], &steps)];
        let (motion, contacts) = scene(sway, &feet);
        let facing = |frame: u32| [points[(frame / FRAMES) as usize], 0.4];
        let facings = Facings::new(2, (0..2 * FRAMES).flat_map(facing).collect());
        let (timeline, mut ground) = (timeline(), &motion);
        let (ends, warp) = ((0, FRAMES + STEPS), TemporalWarp::new(vec![Move::Both; STEPS as usize]));
        let way = transition_way(&timeline, &mut ground, ends, &warp, (&contacts, &facings)).unwrap();
        let transition = Transition { from: ends.0, to: ends.1, deformation: 0.0, warp, placement: way.0, turn: way.1 };
        prop_assert!(moved(&transition, &feet[0]) < 1e-3);
        let facing = half_turn(transition.placement.heading + points[1] - points[0]);
        prop_assert!(facing.abs() < TURN_STEP, "turns by {facing}");
        let mut blend = Blend::of(&timeline, &mut ground, &transition, Placement::IDENTITY, &contacts).unwrap();
        while let Some(next) = blend.next(&timeline, &mut ground, &transition.warp, &contacts).unwrap() {
            blend = next;
        }
        let arrives = blend.placements[1];
        prop_assert!(half_turn(arrives.heading - transition.placement.heading).abs() < 1e-4);
        prop_assert!(arrives.translation.distance(transition.placement.translation) < 1e-4);
    }
}

#[test]
fn nothing_turns_far_nor_for_what_can_step() {
    let place = [Vec2::ZERO, Vec2::new(0.1, 0.0)];
    let turn = |stands: &dyn Fn(u32) -> bool, apart: f32| {
        let (motion, contacts) = scene([0.0; 2], &[(place, stands)]);
        let facings = Facings::new(1, (0..2 * FRAMES).map(|frame| apart * (frame / FRAMES) as f32).collect());
        let warp = TemporalWarp::new(vec![Move::Both; STEPS as usize]);
        let mut ground = &motion;
        transition_way(&timeline(), &mut ground, (0, FRAMES + STEPS), &warp, (&contacts, &facings)).unwrap().1
    };
    assert!((turn(&always, 0.3) + 0.3).abs() < TURN_STEP);
    assert!((turn(&always, 2.0) + 0.6).abs() < TURN_STEP);
    assert_eq!((turn(&steps, 0.3), turn(&|_| false, 0.3)), (0.0, 0.0));
}
