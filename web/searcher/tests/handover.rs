//! What one module's memory hands to the other's comes out as it went in, and nothing else comes out.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use actor::contacts::{Contact, Contacts};
use actor::graph::{EssentialGraph, Transition};
use actor::motion::Motion;
use actor::temporal_warp::{Move, TemporalWarp};
use actor::timeline::{Sequence, Timeline};
use actor::walk::{Leg, Walk};
use fixtures::Random;
use glam::{Vec2, Vec3};
use kernels::align::Placement;
use search::Start;
use searcher::scene::{Known, Reading, words};
use searcher::walk::{from_numbers, numbers};

/// An actor of random numbers.
fn known(seed: u64) -> Known {
    let mut random = Random::new(seed);
    let mut sequences = Vec::new();
    let mut first_frame = 0;
    for (name, labels) in [("gehen", &["walk", "größer"][..]), ("", &[]), ("ende", &["walk"])] {
        let frame_count = 12 + random.below(20) as u32;
        let labels = labels.iter().map(|&label| label.to_owned()).collect();
        sequences.push(Sequence { name: name.into(), labels, first_frame, frame_count, cyclic: random.below(2) == 1 });
        first_frame += frame_count;
    }
    let timeline = Timeline::new(23.976, sequences).unwrap();
    let mut float = || random.signed();
    let placement =
        |float: &mut dyn FnMut() -> f32| Placement { heading: float(), translation: Vec2::new(float(), float()) };
    let moves = [Move::Both, Move::Source, Move::Destination];
    let transitions = (0..12).map(|from| Transition {
        from,
        to: from + 12,
        deformation: float().abs(),
        warp: TemporalWarp::new((0..from as usize).map(|at| moves[at * at % 3]).collect()),
        placement: placement(&mut float),
        turn: float(),
    });
    let transitions: Vec<_> = transitions.filter(|transition| fits(&timeline, transition)).collect();
    assert!(transitions.len() > 2);
    let contacts = (0..2 * first_frame).map(|_| Contact::rounded(Vec2::new(float(), float()), float()));
    let contacts = Contacts::new(2, contacts.collect(), &timeline).unwrap();
    let graph = EssentialGraph::new(0.013, transitions, &timeline).unwrap().with_contacts(contacts);
    let motion = Motion {
        centres: (0..first_frame).map(|_| Vec3::new(float(), float(), float())).collect(),
        facings: (0..first_frame).map(|_| float()).collect(),
        wraps: timeline.sequences().iter().map(|_| placement(&mut float)).collect(),
    };
    Known { timeline, graph, motion, vertex_count: 77 }
}

fn fits(timeline: &Timeline, transition: &Transition) -> bool {
    EssentialGraph::new(0.01, vec![transition.clone()], timeline).is_ok()
}

#[test]
fn an_actor_comes_out_as_it_went_in() {
    for seed in 0..20 {
        let known = known(seed);
        let words = words(&known.timeline, &known.graph, &known.motion, known.vertex_count);
        assert_eq!(Known::from_words(words.clone()).as_ref(), Some(&known));
        for end in (0..words.len()).step_by(7) {
            assert_eq!(Known::from_words(words[..end].to_vec()), None, "cut after {end} words");
        }
        // The same where it is read a few transitions at a time; what is not all there is nothing.
        let mut reading = Reading::new(words.clone()).unwrap();
        assert_eq!(reading.clone().finish(), None);
        let slices = (1..).take_while(|_| !reading.advance(2).unwrap()).count();
        assert_eq!(slices, (known.graph.transitions().len() - 1) / 2);
        assert_eq!(reading.finish().as_ref(), Some(&known));
    }
}

#[test]
fn a_walk_comes_out_as_it_went_in() {
    let legs = vec![
        Leg::Recorded { first: 3, last: 9, steps: 6 },
        Leg::Synthetic(81_234),
        Leg::Back { first: 40, last: 31, steps: 9 },
    ];
    let placement = Placement { heading: 0.1, translation: Vec2::new(-1.3, 2.7) };
    let answer = search::Answer {
        start_frame: 3,
        start_placement: [0.1, -1.3, 2.7],
        walk: Walk { legs, bend: vec![[0.0; 3], [0.125, 2.5, -1.5]], ..Walk::default() },
        version: 1,
        steps: 0,
        seconds: 0.0,
        end_frame: 31,
        end_placement: [0.0; 3],
        parts: Vec::new(),
        progress: search::Progress::Ended,
        expanded: 0,
    };
    let numbers = numbers(&answer);
    assert_eq!(from_numbers(&numbers), Some((Start { frame: 3, placement }, answer.walk.clone())));
    assert_eq!(from_numbers(&numbers[..3]), None);
    assert_eq!(from_numbers(&numbers[..6]), None);
    for (at, number) in [(4, 4.0), (21, f64::NAN), (22, 1e9)] {
        let mut other = numbers.clone();
        other[at] = number;
        assert_eq!(from_numbers(&other), None);
    }
}
