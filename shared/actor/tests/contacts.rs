//! What stands on both sides of a transition stays where it is.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail loudly")]

use actor::blend::Blend;
use actor::contacts::{Contact, Contacts, MOST_PARTS};
use actor::motion::Motion;
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use glam::{Vec2, Vec3};
use kernels::align::Placement;
use proptest::prelude::*;

const FRAMES: u32 = 12;

/// Two sequences of as many frames.
fn timeline() -> Timeline {
    let sequence = |name: &str, first_frame| Sequence {
        name: name.into(),
        labels: vec![],
        first_frame,
        frame_count: FRAMES,
        cyclic: false,
    };
    Timeline::new(25.0, vec![sequence("a", 0), sequence("b", FRAMES)]).unwrap()
}

/// Bodies that sway and turn over feet that stand elsewhere in each sequence; a foot of `planted` stands.
fn scene(sway: [f32; 2], stands: [Vec2; 2], planted: &[f32]) -> (Motion, Contacts) {
    let mut motion = Motion { centres: vec![], facings: vec![], wraps: vec![Placement::IDENTITY; 2] };
    let mut contacts = Vec::new();
    for sequence in 0..2 {
        for frame in 0..FRAMES {
            let t = frame as f32 / 4.0;
            let lean = sway[sequence] * Vec2::new(t.sin(), (1.3 * t).cos());
            motion.centres.push(Vec3::new(lean.x, 1.0, lean.y));
            motion.facings.push(0.1 * sway[sequence] * t);
            for (part, &weight) in planted.iter().enumerate() {
                contacts.push(Contact::rounded(stands[sequence] + part as f32 * Vec2::X, weight));
            }
        }
    }
    (motion, Contacts::new(planted.len(), contacts, &timeline()).unwrap())
}

/// Where part `part` of the blended surface is at each node.
fn track(motion: &Motion, contacts: &Contacts, part: usize) -> Vec<Vec2> {
    let (timeline, warp) =
        (timeline(), TemporalWarp::new(vec![Move::Both, Move::Source, Move::Both, Move::Destination, Move::Both]));
    let start = Placement { heading: 0.7, translation: Vec2::new(3.0, -2.0) };
    let mut ground = motion;
    let mut blend = Some(Blend::begin(&timeline, &mut ground, (2, FRAMES + 8), &warp, start).unwrap());
    let mut track = Vec::new();
    while let Some(node) = blend {
        let side = |side: usize| {
            let point = contacts.of(node.frames[side])[part].point;
            let placed = node.placements[side].apply(Vec3::new(point.x, 0.0, point.y));
            Vec2::new(placed.x, placed.z)
        };
        track.push(side(0).lerp(side(1), node.lambda));
        blend = node.next(&timeline, &mut ground, &warp, contacts).unwrap();
    }
    track
}

fn slide(track: &[Vec2]) -> f32 {
    track.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f32::max)
}

proptest! {
    #[test]
    fn a_foot_that_stands_on_both_sides_does_not_move(
        sway in prop::array::uniform2(-0.3_f32..0.3),
        stands in prop::array::uniform4(-0.4_f32..0.4),
    ) {
        let stands = [Vec2::new(stands[0], stands[1]), Vec2::new(stands[2], stands[3])];
        let (motion, contacts) = scene(sway, stands, &[1.0]);
        let held = slide(&track(&motion, &contacts, 0));
        prop_assert!(held < 1e-5, "{held}");
    }

    #[test]
    fn two_feet_share_what_no_step_can_give_both(sway in prop::array::uniform2(-0.3_f32..0.3), apart in 0.1_f32..0.4) {
        let (motion, contacts) = scene(sway, [Vec2::ZERO, Vec2::new(apart, 0.1)], &[1.0, 1.0]);
        let tracks = [0, 1].map(|part| track(&motion, &contacts, part));
        for (a, b) in tracks[0].windows(2).zip(tracks[1].windows(2)) {
            prop_assert!((a[1] - a[0] + b[1] - b[0]).length() < 1e-5);
        }
    }
}

#[test]
fn what_does_not_stand_changes_nothing() {
    let stands = [Vec2::ZERO, Vec2::new(0.3, -0.2)];
    let (motion, absent) = scene([0.2, -0.1], stands, &[0.0]);
    let free = |contacts: &Contacts| {
        let (timeline, warp) = (timeline(), TemporalWarp::new(vec![Move::Both; 4]));
        let mut ground = &motion;
        let mut blend = Blend::begin(&timeline, &mut ground, (2, FRAMES + 8), &warp, Placement::IDENTITY).unwrap();
        while let Some(next) = blend.next(&timeline, &mut ground, &warp, contacts).unwrap() {
            blend = next;
        }
        blend.centre
    };
    assert_eq!(free(&absent), free(&Contacts::default()));
    let (_, standing) = scene([0.2, -0.1], stands, &[1.0]);
    assert!(free(&standing).distance(free(&absent)) > 0.01, "a foot that stands elsewhere carries the body along");
}

#[test]
fn numbers_that_do_not_fit_are_refused() {
    let (timeline, contact) = (timeline(), Contact { point: Vec2::ZERO, weight: 1.0 });
    let made = |parts: usize, count: usize, contact: Contact| Contacts::new(parts, vec![contact; count], &timeline);
    let frames = 2 * FRAMES as usize;
    assert!(made(1, frames, contact).is_some());
    assert!(made(1, frames - 1, contact).is_none());
    assert!(made(MOST_PARTS + 1, frames * (MOST_PARTS + 1), contact).is_none());
    assert!(made(1, frames, Contact { weight: 1.5, ..contact }).is_none());
    assert!(made(1, frames, Contact { point: Vec2::NAN, ..contact }).is_none());
    assert!(Contacts::default().of(u32::MAX).is_empty());
}
